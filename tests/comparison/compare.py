#!/usr/bin/env python3
"""The same drives given to MRPT's SLAM with odometry and to this sensor without, and the same pairs of scans to PCL's global
registration: compare.py SLAMSENSOR FOLDER_OF_PEERS OUT [DRIVES OF EACH KIND [DRIVES OF EACH SWEEP AND KIND]]

Writes OUT/table.md (also printed) and OUT/picture.svg; the figures that the README shows go to build/results. A carrier among
trees stops every few metres and scans. Of two sorts of drives:

  lists            random trees; a scan is the list of those that were seen, with noise, misses and things that are no trees
  experiment I-IV  `slamsensor simulate --experiment N` in the bush of config/worlds, at the same stands; a scan is its readings.
                   This sensor takes the readings; the others get the landmarks that it finds in them (`replay --landmarks`)

And of three kinds:

  loop      one and a half laps of a circle
  slip      the same; for three steps the wheels spin: odometry tells ten times the way, and misses a turn
  kidnap    the same; after a lap the carrier is put somewhere else on the lap, turned, and odometry tells nothing

A pose is right within 1 m and 2 degrees of the truth in the frame of the first scan; a pose of this sensor names its map, and
where a poor first scan did not become the home map, it is compared in the frame of the first fix in that map. This sensor may say that it has no
fix: that is no pose and counts neither as right nor as wrong. The others always say one.

A pair is two scans of one loop, 1, 2, 4 or 8 steps apart or a lap; the pose of the one in the frame of the other is asked for."""
import collections
import csv
import math
import os
import pathlib
import random
import resource
import signal
import subprocess
import sys
import tempfile

RANGE_M, DENSITY, SIGMA_RANGE_M, SIGMA_BEARING_RAD = 30.0, 0.008, 0.1, 0.005
SEEN, CLUTTER = 0.9, 1
RADIUS_M = 35.0
RIGHT_M, RIGHT_RAD = 1.0, math.radians(2.0)
KINDS = ("loop", "slip", "kidnap")
# Steps of the circle, scans of a drive, the scans at which the wheels slip and the carrier is kidnapped, and where to; steps
# between the scans of a pair.
Course = collections.namedtuple("Course", "step_m scans slip_at kidnap_at kidnap_to apart")
LISTS = Course(3.0, 110, 60, 80, 20, (1, 2, 4, 8, 73))
SWEEPS = Course(5.0, 56, 32, 46, 12, (1, 2, 4, 8, 44))
# What a drive is: true poses, true map, per scan (odometry, landmarks as x, y, weight); what the peers are told of the sensor's noise; and, where
# readings were scanned, this sensor's fixes and its peak kB of each experiment that has that sweep.
Drive = collections.namedtuple("Drive", "course kind poses trees scans sensor ours", defaults=(None,))
# Of EKF SLAM the data association, noise in range (m) and bearing (rad), and how far it expects landmarks (m); of the particle filter the spread of
# the likelihood (m).
Sensor = collections.namedtuple("Sensor", "association range_m bearing_rad reach_m likelihood_m")
PEER_CPU_S = 300  # of a peer for a drive; scans that it has not come to by then have no pose
EXPERIMENTS = {1: "I", 2: "II", 3: "III", 4: "IV"}
TREE = pathlib.Path(__file__).resolve().parents[2]
# What is compared; the order is that of the table and of the picture.
PEERS = {"ekf": "EKF SLAM, odometry (MRPT)", "icp": "ICP, odometry (MRPT)",
         "particles": "particle filter, odometry, true map given (MRPT)", "slamsensor": "slamsensor, no odometry"}
# What the landmarks of readings in the bush are off the middles of trees, bushes and rocks: 0.33 m of range (sigma; besides half a
# metre towards the sensor, which sees their near sides) and 0.004 rad.
NOISE_OF_READINGS = Sensor("nn", 0.35, 0.005, 300.0, 0.6)
KFPCS_DELTA_M, KFPCS_DELTA_OF_READINGS_M = 0.2, 0.7
SETTINGS = """Settings. Lists: {seeds} drives of each kind, {lists.scans} scans each, {lists.step_m} m apart; {density} trees/m2, sensor {range} m all round,
{seen} of the trees seen, {clutter} false one per scan, noise {sr} m and {sb} rad. Experiments: {again} drive of each kind and sweep (I and II have one,
III and IV the other), {sweeps.scans} scans each, {sweeps.step_m} m apart, config/worlds/bush.toml, sweeps of the paper.
Odometry: 2 % of the way and 0.5 deg per step (sigma); its model in MRPT is MRPT's default, which allows for more. Nothing tells any of
them that the wheels slipped or that it was kidnapped.
MRPT 2.5 (Debian): CRangeBearingKFSLAM2D, chi2 0.99, of lists data association by joint compatibility (JCBB), the noise of the sensor, landmarks
expected within 100 m; of the experiments, where JCBB takes seconds for the 30 landmarks of a scan and finds no more, nearest neighbours (MRPT's
default), {noise.range_m} m and {noise.bearing_rad} rad, as landmarks there are off, and {noise.reach_m} m. CICP with 80 iterations, correspondences within 2 m
down to 0.3 m (trees are metres apart), no decimation, accepted above goodness 0.4, points 0.5 m apart added to the map.
CMonteCarloLocalization2D with 2,000 particles, systematic resampling at 0.5, likelihood sigma 0.3 m (experiments: {noise.likelihood_m} m), in the true map.
slamsensor: of lists config/oxford_forest.toml, which is for lists of trees, landmarks_max 60, order nearest, tolerance 0.6 m: three times
the noise; of the experiments config/experiment-N.toml. Its time there has the finding of landmarks in the readings in it, theirs has not.
PCL 1.13 (Debian): KFPCSInitialAlignment as tests/bench/pcl_peer.cpp sets it (delta 0.2 m, of experiments 0.7 m, overlap 0.3, 60 bases, no
early end), the best transform that does not turn the plane over; none given where no base was found. slamsensor on pairs: `locate` with the settings of the drives."""


def moved(pose, dx, dy, turn):
    x, y, h = pose
    return (x + dx * math.cos(h) - dy * math.sin(h), y + dx * math.sin(h) + dy * math.cos(h), h + turn)


def between(a, b):
    dx, dy, c, s = b[0] - a[0], b[1] - a[1], math.cos(a[2]), math.sin(a[2])
    return (c * dx + s * dy, c * dy - s * dx, math.remainder(b[2] - a[2], math.tau))


def drive_of(kind, course, draw):
    """Per stand the true pose, and what odometry tells of the way to it."""
    turn = course.step_m / RADIUS_M
    pose, poses = (RADIUS_M, 0.0, math.pi / 2 + turn / 2), []
    for number in range(course.scans):
        then = pose if number == 0 else moved(pose, course.step_m, draw.gauss(0.0, 0.2), turn + draw.gauss(0.0, 0.02))
        drift = math.hypot(then[0], then[1]) - RADIUS_M  # held on the circle
        if number > 0:
            then = (then[0], then[1], then[2] + 0.02 * drift)
        told = between(pose, then)
        if kind == "slip" and course.slip_at <= number < course.slip_at + 3:
            then = moved(pose, 0.1 * course.step_m, 0.0, math.radians(8.0))
            told = (course.step_m, 0.0, 0.0)
        if kind == "kidnap" and number == course.kidnap_at:
            x, y, h = poses[course.kidnap_to]
            then, told = (x + 1.0, y - 0.7, h + draw.uniform(1.0, 2.5)), (0.0, 0.0, 0.0)
        elif number > 0:
            told = (told[0] * (1 + draw.gauss(0, 0.02)), told[1] * (1 + draw.gauss(0, 0.02)), told[2] + draw.gauss(0, math.radians(0.5)))
        if kind == "kidnap" and number > course.kidnap_at:
            # Back to the circle: straight on from wherever it was put, then around.
            then = moved(pose, course.step_m, 0.0, math.radians(6.0))
            exact = between(pose, then)
            told = (exact[0] * (1 + draw.gauss(0, 0.02)), 0.0, exact[2] + draw.gauss(0, math.radians(0.5)))
        pose = then
        poses.append(pose)
        yield pose, told if number else (0.0, 0.0, 0.0)


def drive_of_lists(kind, seed):
    draw = random.Random(f"{kind} {seed}")
    reach = RADIUS_M + RANGE_M + 5.0
    trees = []
    while len(trees) < DENSITY * (2 * reach) ** 2:
        tree = (draw.uniform(-reach, reach), draw.uniform(-reach, reach))
        if abs(math.hypot(*tree) - RADIUS_M) > 1.0 and all(math.dist(tree, t) > 1.5 for t in trees):
            trees.append(tree)
    poses, scans = [], []
    for pose, told in drive_of(kind, LISTS, draw):
        poses.append(pose)
        seen = []
        for tree in trees:
            lx, ly, _ = between(pose, (*tree, 0.0))
            distance = math.hypot(lx, ly)
            if 1.0 < distance < RANGE_M and draw.random() < SEEN:
                distance += draw.gauss(0, SIGMA_RANGE_M)
                bearing = math.atan2(ly, lx) + draw.gauss(0, SIGMA_BEARING_RAD)
                seen.append((distance * math.cos(bearing), distance * math.sin(bearing), 1.0))
        for _ in range(CLUTTER):
            distance, bearing = draw.uniform(2.0, RANGE_M), draw.uniform(-math.pi, math.pi)
            seen.append((distance * math.cos(bearing), distance * math.sin(bearing), 1.0))
        scans.append((told, seen))
    return Drive(LISTS, kind, poses, trees, scans, Sensor("jcbb", SIGMA_RANGE_M, SIGMA_BEARING_RAD, 100.0, 0.3))


def drive_of_readings(program, folder, sweep, kind, seed):
    """The stands are put into the bush; a bush of another seed when one of them would stand in a tree."""
    draw = random.Random(f"sweep {sweep} {kind} {seed}")
    poses, told = zip(*drive_of(kind, SWEEPS, draw))
    world = folder / "world.toml"
    world.write_text((TREE / "config" / "worlds" / "bush.toml").read_text(encoding="ascii") + "".join(
        f"\n[[stand]]\nx_m = {x:.4f}\ny_m = {y:.4f}\nheading_deg = {math.degrees(math.remainder(h, math.tau)):.5f}\n" for x, y, h in poses))
    with tempfile.TemporaryDirectory(dir=folder) as name:
        out = pathlib.Path(name)
        for bush in range(100 * seed, 100 * seed + 99):
            if run([program, "simulate", world, "--experiment", sweep, "--scans", len(poses), "--seed", seed, "--world-seed", bush, "--out",
                    out / "scans"], refused="is inside an obstacle"):
                break
        trees = [(float(row["x_m"]), float(row["y_m"])) for row in rows(out / "scans" / "stems.csv")]
        (out / "scans" / "stems.csv").unlink()
        ours = {}
        for experiment in (sweep, sweep + 1):  # which find the same landmarks
            memory = run([program, "replay", *settings_of(experiment), "--landmarks", out / "landmarks.csv", "--out", out / "run", out / "scans"])
            ours[experiment] = ([{**row, "scan": int(row["scan"]) - 1} for row in rows(out / "run" / "fixes.csv")], memory)
        seen = collections.defaultdict(list)
        for row in rows(out / "landmarks.csv"):
            seen[int(row["scan"]) - 1].append((float(row["x_m"]), float(row["y_m"]), float(row["weight"])))
    scans = [(odometry, seen[i]) for i, odometry in enumerate(told)]
    return Drive(SWEEPS, kind, list(poses), trees, scans, NOISE_OF_READINGS, ours)


def run(command, refused=None):
    """Peak memory of the process, kB; 0 when it failed with a message that has `refused` in it."""
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                               preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (PEER_CPU_S, PEER_CPU_S + 10)))
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stderr.close()
    if process.returncode != 0 and refused is not None and refused in said:
        return 0
    if process.returncode not in (0, -signal.SIGXCPU):
        raise SystemExit(f"{' '.join(map(str, command))}: {said}")
    return usage.ru_maxrss


def in_first_frame(table, truth):
    """scan -> pose of the fixes, those of each home map after the first moved to where its first fix is true."""
    found, frames = {}, {}
    for row in table:
        if row["status"] == "fix":
            scan, pose = int(row["scan"]), (float(row["x_m"]), float(row["y_m"]), float(row["heading_rad"]))
            if row["home"] not in frames:
                frames[row["home"]] = moved(truth[scan], *between(pose, (0.0, 0.0, 0.0))) if frames else (0.0, 0.0, 0.0)
            found[scan] = moved(frames[row["home"]], *pose)
    return found


def rows(path):
    with open(path, encoding="ascii") as file:
        return list(csv.DictReader(file))


def write_drive(folder, drive):
    """For the peers: drive.txt and map.txt."""
    (folder / "drive.txt").write_text("".join(f"S {i} {o[0]!r} {o[1]!r} {o[2]!r}\n" + "".join(f"L {x:.4f} {y:.4f}\n" for x, y, _ in seen)
                                              for i, (o, seen) in enumerate(drive.scans)))
    (folder / "map.txt").write_text("".join("{:.4f} {:.4f}\n".format(*between(drive.poses[0], (*t, 0.0))[:2]) for t in drive.trees))


def settings_of(group):
    """This sensor's, for the lists or for an experiment."""
    if group == "lists":
        return ("--config", TREE / "config" / "oxford_forest.toml", "--set", "detection.landmarks_max=60", "--set", "landmark_list.order=nearest",
                "--set", "association.tolerance_m=0.6")
    return ("--config", TREE / "config" / f"experiment-{group}.toml")


def run_ours(program, folder, drive):
    """fixes.csv of the drive, and peak kB."""
    lists = folder / "scans.csv"
    lists.write_text("scan,x_m,y_m\n" + "".join(f"{i},{x:.4f},{y:.4f}\n" for i, (_, seen) in enumerate(drive.scans) for x, y, _ in seen))
    memory = run([program, "replay", *settings_of("lists"), "--out", folder / "out", lists])
    return rows(folder / "out" / "fixes.csv"), memory


def run_peer(name, group, programs, folder, drive):
    """scan -> pose, milliseconds per scan, peak kB."""
    if name == "slamsensor":
        table, memory = drive.ours[group] if drive.ours else run_ours(programs[0], folder, drive)
        found = in_first_frame(table, [between(drive.poses[0], pose) for pose in drive.poses])
    else:
        write_drive(folder, drive)
        method = f"ekf-{drive.sensor.association}" if name == "ekf" else name
        memory = run([programs[1] / "mrpt_peer", method, folder / "drive.txt", folder / "map.txt", folder / "poses.csv", *drive.sensor[1:]])
        table = rows(folder / "poses.csv")
        found = {int(r["scan"]): (float(r["x_m"]), float(r["y_m"]), float(r["heading_rad"])) for r in table}
    times = sorted(float(r["milliseconds"]) for r in table)
    return found, times, memory


# --- Pairs of scans ---------------------------------------------------------------------------------------------------

Pair = collections.namedtuple("Pair", "group apart one other true")


def pairs_of(group, drive):
    """`true`: the pose of the second scan in the frame of the first."""
    for number, apart in enumerate(drive.course.apart):
        for i in range(0, drive.course.scans - apart, 12):
            yield Pair(group, number, drive.scans[i][1], drive.scans[i + apart][1], between(drive.poses[i], drive.poses[i + apart]))


def run_pairs(programs, folder, pairs):
    """Per method: pair -> pose, milliseconds, peak kB."""
    (folder / "pairs.txt").write_text("".join(
        f"P {n} {KFPCS_DELTA_M if pair.group == 'lists' else KFPCS_DELTA_OF_READINGS_M}\n" + "".join(f"A {x:.4f} {y:.4f}\n" for x, y, _ in pair.one) + "".join(f"B {x:.4f} {y:.4f}\n" for x, y, _ in pair.other)
        for n, pair in enumerate(pairs)))
    memory = run([programs[1] / "pcl_pairs", folder / "pairs.txt", folder / "pcl.csv"])
    results = {"pcl": (rows(folder / "pcl.csv"), memory)}
    table, memory = [], 0
    for n, pair in enumerate(pairs):
        (folder / "map.csv").write_text("id,x_m,y_m\n" + "".join(f"{i},{x:.4f},{y:.4f}\n" for i, (x, y, _) in enumerate(pair.one)))
        (folder / "scan.csv").write_text("scan,x_m,y_m,diameter_m,weight\n" + "".join(f"{n},{x:.4f},{y:.4f},0,{w}\n" for x, y, w in pair.other))
        memory = max(memory, run([programs[0], "locate", *settings_of(pair.group), "--map", folder / "map.csv", "--scans", folder / "scan.csv",
                                  "--out", folder / "located.csv"]))
        row = rows(folder / "located.csv")[0]
        table.append({**row, "pair": str(n), **({} if row["status"] == "fix" else {"x_m": ""})})
    results["slamsensor"] = (table, memory)
    return results


def judge_pairs(pairs, results):
    """(method, group, steps apart) -> [right, wrong, none, pairs, milliseconds], and peak kB per method."""
    counts = {}
    for method, (table, _) in results.items():
        for row in table:
            pair = pairs[int(row["pair"])]
            count = counts.setdefault((method, pair.group, pair.apart), [0, 0, 0, 0, []])
            count[3] += 1
            count[4].append(float(row["milliseconds"]))
            if row["x_m"] == "":
                count[2] += 1
            else:
                count[0 if is_right((float(row["x_m"]), float(row["y_m"]), float(row["heading_rad"])), pair.true) else 1] += 1
    return counts, {method: memory for method, (_, memory) in results.items()}


def pair_totals(counts, method, groups):
    """Right, wrong, none, pairs of the groups together."""
    return [sum(count[i] for (who, group, _), count in counts.items() if who == method and group in groups) for i in range(4)]


def pairs_table(counts, memory, groups):
    names = {"pcl": "KFPCS (PCL)", "slamsensor": "slamsensor"}
    lines = ["| pairs of scans | who | right at 1, 2, 4, 8 steps, a lap apart | right | wrong | none given | ms a pair, median, worst | "
             "peak memory |",
             "|---|---|---|---|---|---|---|---|"]
    for group in groups:
        for method, name in names.items():
            right, wrong, none, count = pair_totals(counts, method, [group])
            each = "; ".join(f"{counts[method, group, i][0]} of {counts[method, group, i][3]}" for i in range(len(LISTS.apart)))
            times = sorted(t for i in range(len(LISTS.apart)) for t in counts[method, group, i][4])
            lines.append(f"| {title_of(group)} | {name} | {each} | {right} of {count} | {wrong} | {none} | "
                         f"{times[len(times) // 2]:.1f}, {times[-1]:.0f} | {memory[method] / 1024:.0f} MB |")
    return "\n".join(lines)


# --- Drives -----------------------------------------------------------------------------------------------------------

def title_of(group):
    return group if group == "lists" else f"experiment {EXPERIMENTS[group]}"


def is_right(pose, truth):
    return math.dist(pose[:2], truth[:2]) <= RIGHT_M and abs(math.remainder(pose[2] - truth[2], math.tau)) <= RIGHT_RAD


def event_of(course, kind):
    """The scan at which it happens; in a loop nothing happens."""
    return {"slip": course.slip_at, "kidnap": course.kidnap_at}.get(kind, course.scans)


def judge(found, truth, event):
    """Right poses before and from the event on, the scans of both, the wrong ones, squared errors of the right, scans until right again."""
    result = {"right": [0, 0], "of": [event, len(truth) - event], "wrong": 0, "squares": [], "again": None}
    for scan, true in enumerate(truth):
        pose = found.get(scan)
        if pose is None:
            continue
        if is_right(pose, true):
            result["right"][scan >= event] += 1
            result["squares"].append(math.dist(pose[:2], true[:2]) ** 2)
            if scan >= event and result["again"] is None:
                result["again"] = scan - event
        else:
            result["wrong"] += 1
    return result


def judged(results, name, groups, kinds=KINDS):
    return [j for group in groups for kind in kinds for j, _, _ in results[group, kind, name]]


def counted(many, part):
    """Right and all scans before (0) or after (1) the events."""
    return sum(j["right"][part] for j in many), sum(j["of"][part] for j in many)


def rms(many):
    squares = [s for j in many for s in j["squares"]]
    return math.sqrt(sum(squares) / len(squares)) if squares else math.inf


def table_of(results, groups):
    lines = ["| drives | who | right in loops | error RMS there | right before slip or kidnap | right after the slip | right after the kidnap | "
             "right again | wrong | ms a scan, median, worst | peak memory |", "|---|---|---|---|---|---|---|---|---|---|---|"]
    for group in groups:
        for name, title in PEERS.items():
            loops, events = judged(results, name, [group], ["loop"]), judged(results, name, [group], ["slip", "kidnap"])
            shares = ["{} of {}".format(*counted(many, part)) for many, part in
                      ((loops, 0), (events, 0), (judged(results, name, [group], ["slip"]), 1), (judged(results, name, [group], ["kidnap"]), 1))]
            again = [j["again"] for j in events if j["again"] is not None]
            later = "; ".join(([f"after {max(again)} scans at most"] if again else []) +
                              ([f"never in {len(events) - len(again)} of {len(events)} drives"] if len(again) < len(events) else []))
            times = sorted(t for kind in KINDS for _, ts, _ in results[group, kind, name] for t in ts)
            memory = max(m for kind in KINDS for _, _, m in results[group, kind, name])
            lines.append(f"| {title_of(group)} | {title} | {shares[0]} | {rms(loops):.3f} m | {' | '.join(shares[1:])} | {later} | "
                         f"{sum(j['wrong'] for j in loops + events)} | {times[len(times) // 2]:.1f}, {times[-1]:.0f} | {memory / 1024:.0f} MB |")
    return "\n".join(lines)


def winners(results, groups):
    """Who is best at what, in words."""
    lines = []
    for group in groups:
        right = {title: sum(sum(j["right"]) for j in judged(results, name, [group])) for name, title in PEERS.items()}
        errors = {title: rms(judged(results, name, [group], ["loop"])) for name, title in PEERS.items()}
        most = [title for title in right if right[title] == max(right.values())]
        lines.append(f"{title_of(group)}: most scans right: {'; '.join(most)}. Least error in loops, where right: {min(errors, key=errors.get)}.")
    return "\n".join(lines)


def picture(paths):
    """A panel per drive and method: the truth in grey, what was said in colour, wrong poses as crosses."""
    size, left = 240, 130
    drives = list(dict.fromkeys((group, kind) for group, kind, _ in paths))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{len(PEERS) * size + left}" height="{len(drives) * size + 40}" '
           'font-family="DejaVu Sans, sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>']
    for column, name in enumerate(PEERS):
        out.append(f'<text x="{left + column * size + size / 2}" y="20" text-anchor="middle">{name}</text>')
    for row, (group, kind) in enumerate(drives):
        out.append(f'<text x="8" y="{40 + row * size + size / 2}">{title_of(group)}<tspan x="8" dy="16">{kind}</tspan></text>')
        for column, name in enumerate(PEERS):
            truth, found = paths[group, kind, name]
            ox, oy = left + column * size + size / 2, 30 + row * size + size / 2
            ends = [(min(p[i] for p in truth), max(p[i] for p in truth)) for i in (0, 1)]
            mid = [sum(pair) / 2 for pair in ends]
            scale = (size - 40) / max(1.0, *(high - low for low, high in ends))

            def place(pose, mid=mid, ox=ox, oy=oy, scale=scale):
                return ox + scale * (pose[0] - mid[0]), oy - scale * (pose[1] - mid[1])
            out.append(f'<rect x="{ox - size / 2 + 3}" y="{oy - size / 2 + 3}" width="{size - 6}" height="{size - 6}" fill="none" stroke="#ccc"/>')
            out.append('<polyline fill="none" stroke="#bbb" stroke-width="4" points="' + " ".join("{:.1f},{:.1f}".format(*place(p)) for p in truth) + '"/>')
            for scan, pose in sorted(found.items()):
                x, y = place(pose)
                if not (abs(x - ox) < size / 2 - 4 and abs(y - oy) < size / 2 - 4):
                    continue  # out of the panel
                if is_right(pose, truth[scan]):
                    out.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2" fill="#0b6e5d"/>')
                else:
                    out.append(f'<path d="M{x - 3:.1f} {y - 3:.1f}l6 6m0 -6l-6 6" stroke="#b3261e" stroke-width="1.5"/>')
    return "\n".join(out) + "\n</svg>\n"


def keep_figures(results, counts):
    """What the README shows, for tests/readme: after slips and kidnaps together, errors in loops, pairs."""
    figures = {}
    for sort, groups in (("lists", ["lists"]), ("experiments", list(EXPERIMENTS))):
        for name in PEERS:
            right, scans = counted(judged(results, name, groups), 1)
            figures[f"{sort}_{name}_right_after"], figures[f"{sort}_scans_after"] = right, scans
            figures[f"{sort}_{name}_loop_rms_m"] = round(rms(judged(results, name, groups, ["loop"])), 2)
        for method in ("pcl", "slamsensor"):
            right, wrong, _, pairs = pair_totals(counts, method, groups)
            figures[f"{sort}_{method}_pairs_right"], figures[f"{sort}_{method}_pairs_wrong"], figures[f"{sort}_pairs"] = right, wrong, pairs
    folder = TREE / "build" / "results"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "comparison.csv").write_text("figure,value\n" + "".join(f"{name},{value}\n" for name, value in figures.items()))


def measure(programs, folder, drives):
    """(group, kind, peer) -> what it came to on each drive; the same -> truth and poses of one drive; the pairs."""
    results, paths, pairs = collections.defaultdict(list), {}, []
    for sort, kind, seed in drives:
        drive = drive_of_lists(kind, seed) if sort == "lists" else drive_of_readings(programs[0], folder, sort, kind, seed)
        truth = [between(drive.poses[0], pose) for pose in drive.poses]
        answers = {}
        for group in drive.ours or [sort]:
            if kind == "loop":
                pairs.extend(pairs_of(group, drive))
            for name in PEERS:
                if name == "slamsensor" or name not in answers:  # the others know nothing of an experiment's tolerance
                    answers[name] = run_peer(name, group, programs, folder, drive)
                found, times, memory = answers[name]
                judgement = judge(found, truth, event_of(drive.course, kind))
                results[group, kind, name].append((judgement, times, memory))
                if group == "lists" or kind == "kidnap":
                    paths.setdefault((group, kind, name), (truth, found))
                print(f"{title_of(group)} {kind} {seed} {name}: {judgement['right']} of {judgement['of']} right, {judgement['wrong']} wrong",
                      file=sys.stderr, flush=True)
    return results, paths, pairs


def tell(folder, seeds, results, paths, counts, memory):
    groups = ["lists", *EXPERIMENTS]
    settings = SETTINGS.format(lists=LISTS, sweeps=SWEEPS, seeds=seeds[0], again=seeds[1], density=DENSITY, range=RANGE_M, seen=SEEN, clutter=CLUTTER,
                               sr=SIGMA_RANGE_M, sb=SIGMA_BEARING_RAD, noise=NOISE_OF_READINGS)
    table = "\n\n".join((table_of(results, groups), winners(results, groups), pairs_table(counts, memory, groups), settings)) + "\n"
    (folder / "table.md").write_text(table)
    (folder / "picture.svg").write_text(picture(paths))
    keep_figures(results, counts)
    print(table)


def main():
    programs, folder = (pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])), pathlib.Path(sys.argv[3])
    seeds = [int(sys.argv[i]) if len(sys.argv) > i else default for i, default in ((4, 5), (5, 1))]
    folder.mkdir(parents=True, exist_ok=True)
    drives = [(sort, kind, seed) for sort, count in (("lists", seeds[0]), (1, seeds[1]), (3, seeds[1])) for kind in KINDS
              for seed in range(1, count + 1)]
    results, paths, pairs = measure(programs, folder, drives)
    tell(folder, seeds, results, paths, *judge_pairs(pairs, run_pairs(programs, folder, pairs)))


if __name__ == "__main__":
    main()
