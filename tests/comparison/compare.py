#!/usr/bin/env python3
"""The same drives given to MRPT's SLAM with odometry and to this sensor without, and the same pairs of scans to PCL's global
registration: compare.py SLAMSENSOR FOLDER_OF_PEERS OUT [DRIVES OF EACH KIND]

Writes OUT/table.md (also printed) and OUT/picture.svg; the figures that the README shows go to build/results. A drive of
landmarks is a carrier among random trees that stops every 3 m and scans; each scan gives the trees it saw, with noise,
misses and things that are no trees. The kinds:

  loop      one and a half laps of a circle
  slip      the same; for three steps the wheels spin: odometry tells ten times the way, and misses a turn
  kidnap    the same; after a lap the carrier is put somewhere else on the lap, turned, and odometry tells nothing

A pose is right within 1 m and 2 degrees of the truth in the frame of the first scan; a pose of this sensor names its map, and
where a poor first scan did not become the home map, it is compared in the frame of the first fix in that map. This sensor may say that it has no
fix: that is no pose and counts neither as right nor as wrong. The others always say one.

A pair is two scans of one drive, 1, 2, 4 or 8 steps apart or a lap; the pose of the one in the frame of the other is asked for."""
import csv
import math
import os
import pathlib
import random
import subprocess
import sys

RANGE_M, DENSITY, SIGMA_RANGE_M, SIGMA_BEARING_RAD = 30.0, 0.008, 0.1, 0.005
SEEN, CLUTTER = 0.9, 1
RADIUS_M, STEP_M, SCANS = 35.0, 3.0, 110
SLIP_AT, KIDNAP_AT, KIDNAP_TO = 60, 80, 20
RIGHT_M, RIGHT_RAD = 1.0, math.radians(2.0)
KINDS = ("loop", "slip", "kidnap")
EVENTS = {"slip": SLIP_AT, "kidnap": KIDNAP_AT}
APART = (1, 2, 4, 8, 73)  # steps between the scans of a pair; 73 steps of 3 m are a lap of the circle
TREE = pathlib.Path(__file__).resolve().parents[2]
# What is compared; the order is that of the table and of the picture.
PEERS = {"ekf": "EKF SLAM, JCBB, odometry (MRPT)", "icp": "ICP, odometry (MRPT)",
         "particles": "particle filter, odometry, true map given (MRPT)", "slamsensor": "slamsensor, no odometry"}
SETTINGS = """Settings. World: {density} trees/m2, sensor {range} m all round, {seen} of the trees seen, {clutter} false one per scan, noise {sr} m and {sb} rad.
Odometry: 2 % of the way and 0.5 deg per step (sigma); its model in MRPT is MRPT's default, which allows for more.
MRPT 2.5 (Debian): CRangeBearingKFSLAM2D, joint compatibility (JCBB), chi2 0.99, the true noise of the sensor; CICP with 80
iterations, correspondences within 2 m down to 0.3 m (trees are metres apart), no decimation, accepted above goodness 0.4, points
0.5 m apart added to the map; CMonteCarloLocalization2D with 2,000 particles, systematic resampling at 0.5, likelihood sigma
0.3 m, in the true map. Nothing tells any of them that the wheels slipped or that it was kidnapped. slamsensor: config/oxford_forest.toml, which is for lists of trees, landmarks_max 60, order
nearest, tolerance 0.6 m: three times the noise. PCL 1.13 (Debian): KFPCSInitialAlignment as
tests/bench/pcl_peer.cpp sets it (delta 0.2 m, overlap 0.3, 60 bases, no early end), the best transform that does not turn the plane
over; it cannot say that two scans have nothing in common. slamsensor on pairs: `locate` with the settings of the drives."""


def moved(pose, dx, dy, turn):
    x, y, h = pose
    return (x + dx * math.cos(h) - dy * math.sin(h), y + dx * math.sin(h) + dy * math.cos(h), h + turn)


def between(a, b):
    dx, dy, c, s = b[0] - a[0], b[1] - a[1], math.cos(a[2]), math.sin(a[2])
    return (c * dx + s * dy, c * dy - s * dx, math.remainder(b[2] - a[2], math.tau))


def make_drive(kind, seed):
    """True poses, trees, and per scan (odometry, landmarks seen)."""
    draw = random.Random(f"{kind} {seed}")
    reach = RADIUS_M + RANGE_M + 5.0
    trees = []
    while len(trees) < DENSITY * (2 * reach) ** 2:
        tree = (draw.uniform(-reach, reach), draw.uniform(-reach, reach))
        if abs(math.hypot(*tree) - RADIUS_M) > 1.0 and all(math.dist(tree, t) > 1.5 for t in trees):
            trees.append(tree)
    turn = STEP_M / RADIUS_M
    pose, poses, scans = (RADIUS_M, 0.0, math.pi / 2 + turn / 2), [], []
    for number in range(SCANS):
        then = pose if number == 0 else moved(pose, STEP_M, draw.gauss(0.0, 0.2), turn + draw.gauss(0.0, 0.02))
        drift = math.hypot(then[0], then[1]) - RADIUS_M  # held on the circle
        if number > 0:
            then = (then[0], then[1], then[2] + 0.02 * drift)
        told = between(pose, then)
        if kind == "slip" and SLIP_AT <= number < SLIP_AT + 3:
            then = moved(pose, 0.1 * STEP_M, 0.0, math.radians(8.0))
            told = (STEP_M, 0.0, 0.0)
        if kind == "kidnap" and number == KIDNAP_AT:
            x, y, h = poses[KIDNAP_TO]
            then, told = (x + 1.0, y - 0.7, h + draw.uniform(1.0, 2.5)), (0.0, 0.0, 0.0)
        elif number > 0:
            told = (told[0] * (1 + draw.gauss(0, 0.02)), told[1] * (1 + draw.gauss(0, 0.02)), told[2] + draw.gauss(0, math.radians(0.5)))
        if kind == "kidnap" and number > KIDNAP_AT:
            # Back to the circle: straight on from wherever it was put, then around.
            then = moved(pose, STEP_M, 0.0, math.radians(6.0))
            exact = between(pose, then)
            told = (exact[0] * (1 + draw.gauss(0, 0.02)), 0.0, exact[2] + draw.gauss(0, math.radians(0.5)))
        pose = then
        poses.append(pose)
        seen = []
        for tree in trees:
            lx, ly, _ = between(pose, (*tree, 0.0))
            distance = math.hypot(lx, ly)
            if 1.0 < distance < RANGE_M and draw.random() < SEEN:
                distance += draw.gauss(0, SIGMA_RANGE_M)
                bearing = math.atan2(ly, lx) + draw.gauss(0, SIGMA_BEARING_RAD)
                seen.append((distance * math.cos(bearing), distance * math.sin(bearing)))
        for _ in range(CLUTTER):
            distance, bearing = draw.uniform(2.0, RANGE_M), draw.uniform(-math.pi, math.pi)
            seen.append((distance * math.cos(bearing), distance * math.sin(bearing)))
        scans.append((told if number else (0.0, 0.0, 0.0), seen))
    return poses, trees, scans


def run(command):
    """Peak memory of the process, kB."""
    process = subprocess.Popen(list(map(str, command)), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    process.stderr.close()
    if process.returncode != 0:
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
    poses, trees, scans = drive
    (folder / "drive.txt").write_text("".join(f"S {i} {o[0]!r} {o[1]!r} {o[2]!r}\n" + "".join(f"L {x:.4f} {y:.4f}\n" for x, y in seen)
                                              for i, (o, seen) in enumerate(scans)))
    (folder / "map.txt").write_text("".join("{:.4f} {:.4f}\n".format(*between(poses[0], (*t, 0.0))[:2]) for t in trees))


LIST_SETTINGS = ("--config", TREE / "config" / "oxford_forest.toml", "--set", "detection.landmarks_max=60", "--set",
                 "landmark_list.order=nearest", "--set", "association.tolerance_m=0.6")


def run_ours(program, folder, drive):
    """fixes.csv of the drive, and peak kB."""
    lists = folder / "scans.csv"
    lists.write_text("scan,x_m,y_m\n" + "".join(f"{i},{x:.4f},{y:.4f}\n" for i, (_, seen) in enumerate(drive[2]) for x, y in seen))
    memory = run([program, "replay", *LIST_SETTINGS, "--out", folder / "out", lists])
    return rows(folder / "out" / "fixes.csv"), memory


def run_peer(name, programs, folder, drive):
    """scan -> pose, milliseconds per scan, peak kB."""
    if name == "slamsensor":
        table, memory = run_ours(programs[0], folder, drive)
        found = in_first_frame(table, [between(drive[0][0], pose) for pose in drive[0]])
    else:
        write_drive(folder, drive)
        memory = run([programs[1] / "mrpt_peer", name, folder / "drive.txt", folder / "map.txt", folder / "poses.csv", SIGMA_RANGE_M,
                      SIGMA_BEARING_RAD])
        table = rows(folder / "poses.csv")
        found = {int(r["scan"]): (float(r["x_m"]), float(r["y_m"]), float(r["heading_rad"])) for r in table}
    times = sorted(float(r["milliseconds"]) for r in table)
    return found, times, memory


# --- Pairs of scans ---------------------------------------------------------------------------------------------------

def pairs_of(drive):
    """(steps apart, landmarks of the one, of the other, true pose of the second in the frame of the first)."""
    poses, _, scans = drive
    for apart in APART:
        for i in range(0, len(scans) - apart, 12):
            yield apart, scans[i][1], scans[i + apart][1], between(poses[i], poses[i + apart])


def run_pairs(programs, folder, pairs):
    """Per method: pair -> pose, milliseconds, peak kB."""
    (folder / "pairs.txt").write_text("".join(
        f"P {n} 0\n" + "".join(f"A {x:.4f} {y:.4f}\n" for x, y in one) + "".join(f"B {x:.4f} {y:.4f}\n" for x, y in other)
        for n, (_, one, other, _) in enumerate(pairs)))
    memory = run([programs[1] / "pcl_pairs", folder / "pairs.txt", folder / "pcl.csv"])
    results = {"pcl": (rows(folder / "pcl.csv"), memory)}
    table, memory = [], 0
    for n, (_, one, other, _) in enumerate(pairs):
        (folder / "map.csv").write_text("id,x_m,y_m\n" + "".join(f"{i},{x:.4f},{y:.4f}\n" for i, (x, y) in enumerate(one)))
        (folder / "scan.csv").write_text("scan,x_m,y_m\n" + "".join(f"{n},{x:.4f},{y:.4f}\n" for x, y in other))
        memory = max(memory, run([programs[0], "locate", *LIST_SETTINGS, "--map", folder / "map.csv", "--scans", folder / "scan.csv", "--out",
                                  folder / "located.csv"]))
        row = rows(folder / "located.csv")[0]
        table.append({**row, "pair": str(n), **({} if row["status"] == "fix" else {"x_m": ""})})
    results["slamsensor"] = (table, memory)
    return results


def judge_pairs(pairs, results):
    """(method, steps apart) -> [right, wrong, none, pairs, milliseconds], and peak kB per method."""
    counts = {}
    for method, (table, _) in results.items():
        for row in table:
            apart, _, _, true = pairs[int(row["pair"])]
            count = counts.setdefault((method, apart), [0, 0, 0, 0, []])
            count[3] += 1
            count[4].append(float(row["milliseconds"]))
            if row["x_m"] == "":
                count[2] += 1
            else:
                count[0 if is_right((float(row["x_m"]), float(row["y_m"]), float(row["heading_rad"])), true) else 1] += 1
    return counts, {method: memory for method, (_, memory) in results.items()}


def pairs_table(counts, memory):
    names = {"pcl": "KFPCS (PCL)", "slamsensor": "slamsensor"}
    lines = ["| pairs of scans | who | right | wrong | none given | ms a pair, median, worst | peak memory |", "|---|---|---|---|---|---|---|"]
    for apart in APART:
        for method in ("pcl", "slamsensor"):
            right, wrong, none, count, times = counts[method, apart]
            times = sorted(times)
            away = "a lap apart" if apart == APART[-1] else f"{apart * STEP_M:.0f} m apart"
            lines.append(f"| {away} | {names[method]} | {right} of {count} | {wrong} | {none} | {times[len(times) // 2]:.1f}, {times[-1]:.0f} | "
                         f"{memory[method] / 1024:.0f} MB |")
    return "\n".join(lines)


def is_right(pose, truth):
    return math.dist(pose[:2], truth[:2]) <= RIGHT_M and abs(math.remainder(pose[2] - truth[2], math.tau)) <= RIGHT_RAD


def judge(found, truth, event):
    """Right and wrong poses before and from the event on, squared errors of the right, scans until right again."""
    result = {"right": [0, 0], "wrong": [0, 0], "squares": [], "again": None}
    for scan, true in enumerate(truth):
        after = int(event is not None and scan >= event)
        pose = found.get(scan)
        if pose is None:
            continue
        if is_right(pose, true):
            result["right"][after] += 1
            result["squares"].append(math.dist(pose[:2], true[:2]) ** 2)
            if after and result["again"] is None:
                result["again"] = scan - event
        else:
            result["wrong"][after] += 1
    return result


def totals(kind, name, results):
    """Right before and after the event, wrong, squared errors, over all drives of the kind."""
    many = [j for j, _, _ in results[kind, name]]
    right = [sum(j["right"][i] for j in many) for i in (0, 1)]
    return right, sum(sum(j["wrong"]) for j in many), [s for j in many for s in j["squares"]]


def rms(squares):
    return math.sqrt(sum(squares) / len(squares)) if squares else math.inf


def table_of(results):
    lines = ["| drive | who | right before | right after the event | wrong | right again | error RMS of the right | ms a scan, median, worst | peak memory |",
             "|---|---|---|---|---|---|---|---|---|"]
    for kind in KINDS:
        for name, title in PEERS.items():
            many = results[kind, name]
            right, wrong, squares = totals(kind, name, results)
            event = EVENTS.get(kind)
            drives = len(many)
            before = (event if event else SCANS) * drives
            times = sorted(t for _, ts, _ in many for t in ts)
            lost = sum(j["again"] is None for j, _, _ in many)
            again = [j["again"] for j, _, _ in many if j["again"] is not None]
            later = (f"after {max(again)} scans at most" if again else "") + (f"{', ' if again else ''}never in {lost} of {drives}" if lost else "")
            lines.append(f"| {kind} | {title} | {right[0]} of {before} | " + (f"{right[1]} of {SCANS * drives - before}" if event else "-") +
                         f" | {wrong} | " + (later if event else "-") + (f" | {rms(squares):.3f} m" if squares else " | -") +
                         f" | {times[len(times) // 2]:.1f}, {times[-1]:.0f} | {max(m for _, _, m in many) / 1024:.0f} MB |")
    return "\n".join(lines)


def winners(results):
    """Who is best at what, in words."""
    lines = []
    for kind in KINDS:
        errors, right = {}, {}
        for name, title in PEERS.items():
            before_after, _, squares = totals(kind, name, results)
            errors[title], right[title] = rms(squares), sum(before_after)
        most = [title for title in right if right[title] == max(right.values())]
        lines.append(f"{kind}: most scans right: {'; '.join(most)}. Least error where right: {min(errors, key=errors.get)}.")
    return "\n".join(lines)


def picture(paths):
    """A panel per kind and method: the truth in grey, what was said in colour, wrong poses as crosses."""
    size = 240
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{len(PEERS) * size + 90}" height="{len(KINDS) * size + 40}" '
           'font-family="DejaVu Sans, sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>']
    for column, name in enumerate(PEERS):
        out.append(f'<text x="{90 + column * size + size / 2}" y="20" text-anchor="middle">{name}</text>')
    for row, kind in enumerate(KINDS):
        out.append(f'<text x="8" y="{40 + row * size + size / 2}">{kind}</text>')
        for column, name in enumerate(PEERS):
            truth, found = paths[kind, name]
            ox, oy = 90 + column * size + size / 2, 30 + row * size + size / 2
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
    """What the README shows, for tests/readme: after slips and kidnaps together, in loops, on pairs."""
    figures = {"scans_after": sum((SCANS - EVENTS[kind]) * len(results[kind, "ekf"]) for kind in EVENTS)}
    for name in PEERS:
        figures[f"{name}_right_after"] = sum(totals(kind, name, results)[0][1] for kind in EVENTS)
    figures["pairs"] = sum(counts["pcl", apart][3] for apart in APART)
    for method in ("pcl", "slamsensor"):
        figures[f"{method}_pairs_right"] = sum(counts[method, apart][0] for apart in APART)
        figures[f"{method}_pairs_wrong"] = sum(counts[method, apart][1] for apart in APART)
    folder = TREE / "build" / "results"
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "comparison.csv").write_text("figure,value\n" + "".join(f"{name},{value}\n" for name, value in figures.items()))


def main():
    programs, folder = (pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])), pathlib.Path(sys.argv[3])
    seeds = int(sys.argv[4]) if len(sys.argv) > 4 else 5
    folder.mkdir(parents=True, exist_ok=True)
    results, paths, pairs = {}, {}, []
    for kind in KINDS:
        for seed in range(1, seeds + 1):
            drive = make_drive(kind, seed)
            if kind == "loop":
                pairs.extend(pairs_of(drive))
            truth = [between(drive[0][0], pose) for pose in drive[0]]
            for name in PEERS:
                found, times, memory = run_peer(name, programs, folder, drive)
                results.setdefault((kind, name), []).append((judge(found, truth, EVENTS.get(kind)), times, memory))
                paths.setdefault((kind, name), (truth, found))
                print(f"{kind} {seed} {name}: {results[kind, name][-1][0]['right']} right, {results[kind, name][-1][0]['wrong']} wrong",
                      file=sys.stderr, flush=True)
    counts, memory = judge_pairs(pairs, run_pairs(programs, folder, pairs))
    settings = SETTINGS.format(density=DENSITY, range=RANGE_M, seen=SEEN, clutter=CLUTTER, sr=SIGMA_RANGE_M, sb=SIGMA_BEARING_RAD)
    table = "\n\n".join((table_of(results), winners(results), pairs_table(counts, memory),
                         f"{seeds} drives of each kind, {SCANS} scans each. {settings}")) + "\n"
    (folder / "table.md").write_text(table)
    (folder / "picture.svg").write_text(picture(paths))
    keep_figures(results, counts)
    print(table)


if __name__ == "__main__":
    main()
