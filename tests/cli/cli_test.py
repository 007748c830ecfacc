"""The command slamsensor as a user calls it: exit status, messages, files. Usage: cli_test.py SLAMSENSOR CONFIG_DIR"""

import csv
import filecmp
import json
import math
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.dom.minidom
import zlib

PROGRAM, CONFIG = sys.argv[1], pathlib.Path(sys.argv[2])
OK, USAGE, DATAERR, NOINPUT, CANTCREAT, CONFIGERR = 0, 64, 65, 66, 73, 78


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=120)
    return done.returncode, done.stdout, done.stderr


def with_other_settings(recording, word, other):
    """The recording with `other`, as long as `word`, in its settings: LCM's text_t of time, CRC-32, length, text."""
    begin = recording.index(b"SLAMSENSOR_CONFIG") + len("SLAMSENSOR_CONFIG")
    size = struct.unpack(">I", recording[begin + 20:begin + 24])[0]
    text = recording[begin + 24:begin + 23 + size].replace(word, other)
    return (recording[:begin + 16] + struct.pack(">I", zlib.crc32(text)) + recording[begin + 20:begin + 24] + text +
            recording[begin + 23 + size:])


def pcd(points, declared=None, data="binary"):
    count = len(points) if declared is None else declared
    header = (f"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH {count}\nHEIGHT 1\n"
              f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA {data}\n").encode()
    return header + b"".join(struct.pack("<fff", *p) for p in points)


def forest(draw, count):
    """Trees of 70 m^2 each in a square about the origin."""
    half = 0.5 * math.sqrt(70.0 * count)
    return [(draw.uniform(-half, half), draw.uniform(-half, half)) for _ in range(count)]


def scan_of(draw, trees, pose, spurious):
    """The 24 nearest trees as seen from a pose: three of ten are missed, some are nothing, sigma is 0.15 m."""
    x, y, heading = pose
    cosine, sine = math.cos(heading), math.sin(heading)
    near = sorted(trees, key=lambda tree: math.dist(tree, (x, y)))[:24]
    shown = [(a - x, b - y) for a, b in near if draw.random() < 0.7]
    seen = [(cosine * a + sine * b, cosine * b - sine * a) for a, b in shown]
    seen = [(a + draw.gauss(0, 0.15), b + draw.gauss(0, 0.15)) for a, b in seen]
    reach = math.dist(near[-1], (x, y))
    for _ in range(spurious):
        away, bearing = reach * math.sqrt(draw.random()), draw.uniform(0, 2 * math.pi)
        seen.append((away * math.cos(bearing), away * math.sin(bearing)))
    return seen


def csv_of(header, rows):
    return header + "\n" + "".join(",".join(map(str, row)) + "\n" for row in rows)


class Cli(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.out = self.folder / "out"

    def tearDown(self):
        self.temporary.cleanup()

    def write(self, name, content):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    def refused(self, path, *fragments, status=(DATAERR, NOINPUT), out=None):
        code, _, errors = run("replay", "--out", out or self.out, path)
        self.assertIn(code, status, errors)
        self.assertEqual(errors.count("fault of the program"), 0, errors)
        for fragment in fragments:
            self.assertIn(fragment, errors)

    def test_no_verb_and_unknown_verbs_are_usage_errors(self):
        self.assertEqual(run()[0], USAGE)
        code, _, errors = run("fly")
        self.assertEqual(code, USAGE)
        self.assertIn("'fly' is no verb", errors)
        self.assertEqual(run("replay")[0], USAGE)
        self.assertEqual(run("--help")[0], OK)
        self.assertRegex(run("--version")[1], r"^slamsensor \d+\.\d+\.\d+\n$")

    def test_truncated_pcd(self):
        self.refused(self.write("scan_1.pcd", pcd([(1, 2, 3)], declared=5)), "scan_1.pcd")

    def test_absurd_pcd(self):
        self.refused(self.write("scan_1.pcd", pcd([(1, 2, 3)], declared=4_000_000_000_000)), "scan_1.pcd")
        self.refused(self.write("scan_2.pcd", b"# .PCD v0.7\nFIELDS a b\n"), "scan_2.pcd")
        self.refused(self.write("scan_3.pcd", pcd([(math.inf, 0, 0)])), "scan_3.pcd")

    def test_pcd_of_nan_alone_has_no_landmarks(self):
        code, output, errors = run("replay", "--out", self.out, self.write("scan_1.pcd", pcd([(math.nan,) * 3])))
        self.assertEqual(code, OK, errors)
        self.assertIn("too_few_landmarks", output)
        self.assertIn("cloud points without a direction: 1", output)

    def test_readings_that_are_none(self):
        head = "pan_deg,tilt_deg,range_m\n"
        self.refused(self.write("scan_1.csv", head + "0,0,zwei\n"), "scan_1.csv:2", "zwei")
        self.refused(self.write("scan_2.csv", head + "0,nan,1\n"), "scan_2.csv:2", "nan")
        self.refused(self.write("scan_3.csv", head + "0,0\n"), "scan_3.csv:2")
        self.refused(self.write("scan_4.csv", "pan_deg,tilt_deg\n0,0\n"), "scan_4.csv")
        self.refused(self.write("scan_5.csv", ""), "scan_5.csv")
        self.refused(self.write("scan_6.csv", head), "scan_6.csv")

    def test_landmarks_that_are_none(self):
        self.refused(self.write("l1.csv", "scan,x_m,y_m\n0,1,zwei\n"), "l1.csv:2", "zwei")
        self.refused(self.write("l2.csv", "scan,x_m,y_m\n-1,1,2\n"), "l2.csv:2")
        self.refused(self.write("l3.csv", "scan,x_m\n0,1\n"), "l3.csv")

    def test_duplicate_scans_name_both_files(self):
        for name in ("a_1600000001.5.pcd", "b_1600000001.50.pcd"):
            self.write(name, pcd([(1, 2, 3)]))
        self.refused(self.folder, "a_1600000001.5.pcd", "b_1600000001.50.pcd", status=(NOINPUT,))

    def test_missing_input_truth_and_config(self):
        self.refused(self.folder / "absent", "absent", status=(NOINPUT,))
        scan = self.write("scan_1.pcd", pcd([(1, 2, 3)]))
        self.assertEqual(run("replay", "--truth", self.folder / "t", "--out", self.out, scan)[0], DATAERR)
        self.assertEqual(run("replay", "--config", self.folder / "c", "--out", self.out, scan)[0], CONFIGERR)

    def test_out_that_is_a_file(self):
        scan = self.write("scan_1.pcd", pcd([(1, 2, 3)]))
        self.refused(scan, "--out", status=(CANTCREAT,), out=self.write("file", "x") / "out")

    def test_configuration_mistakes_are_told_all_at_once(self):
        bad = self.write("bad.toml", "[association]\ntolerence_m = 1\ndepth = -3\n[detection]\nrange_max_m = 'far'\n")
        code, _, errors = run("check-config", bad)
        self.assertEqual(code, CONFIGERR)
        for fragment in ("bad.toml:2", "tolerance_m", "bad.toml:3", "bad.toml:5"):
            self.assertIn(fragment, errors)

    def test_set_lies_on_top_of_the_file_and_says_so(self):
        code, output, _ = run("check-config", CONFIG / "experiment-2.toml", "--set", "association.tolerance_m=0.7",
                              "--set", "acceptance.rule=paper")
        self.assertEqual(code, OK)
        lines = {line.split()[0]: line for line in output.splitlines() if line.strip()}
        self.assertIn("0.7", lines["association.tolerance_m"])
        self.assertIn("--set", lines["association.tolerance_m"])
        self.assertIn("experiment-2.toml", lines["detection.landmarks_max"])
        self.assertIn('"paper"', lines["acceptance.rule"])
        self.assertEqual(run("check-config", "--set", "acceptance.rule=maybe")[0], CONFIGERR)

    def test_memory_plan_adds_up(self):
        code, output, _ = run("memory")
        self.assertEqual(code, OK)
        plan, sizes = output.split("\n\n")
        rows = plan.splitlines()[1:]
        self.assertEqual(sum(int(row.split()[-1]) for row in rows[:-1]), int(rows[-1].split()[-1]))
        sizes = [[float(cell) for cell in row.split()] for row in sizes.splitlines()[1:4]]
        self.assertEqual([row[0] for row in sizes], [1e4, 1e5, 1e6])
        self.assertEqual(int(rows[-1].split()[-1]), sizes[0][3])  # the default's capacity
        for _, index, entry, block, copies in sizes:
            self.assertLessEqual(index, 128)
            self.assertLessEqual(index + entry, 256)
        self.assertLessEqual(sum(sizes[0][3:]), 16 * 2 ** 20)  # what a daemon of 64 MiB has for it
        self.assertLessEqual(sum(sizes[1][3:]), 80 * 2 ** 20)  # of 128 MiB

    def test_edges_draws_the_curve(self):
        code, output, _ = run("edges", "--points", 200, "--depth", 4, "--sets", 2, "--out", self.folder / "e.svg")
        self.assertEqual(code, OK)
        edges = [int(line.split()[1]) for line in output.splitlines()[1:]]
        self.assertEqual(edges, sorted(edges))
        self.assertIn("</svg>", (self.folder / "e.svg").read_text())

    def test_pictures_are_svg_or_png(self):
        for arguments in (["edges"], ["figure", "spiderweb", "x.pcd"], ["figure", "scanline", "x.pcd"]):
            out = self.folder / "e.pdf"
            code, _, errors = run(*arguments, "--out", out)
            self.assertEqual(code, USAGE, errors)
            self.assertIn(".svg or .png", errors)
            self.assertFalse(out.exists())

    def test_figures_of_scans_are_drawn(self):
        for number in (1, 2):
            rows = ["pan_deg,tilt_deg,range_m"]
            for tilt in (0.0, 0.5, 1.0, 1.5):
                for step in range(-1100, 1101):
                    seen = [r for a, r in ((-80, 9), (-33, 14), (5, 6), (41, 21), (66, 11), (90, 17)) if abs(0.1 * step - a - number) < 12.0 / r]
                    rows.append(f"{0.1 * step:.1f},{tilt},{min(seen) if seen else ''}")
            self.write(f"scan_{number}.csv", "\n".join(rows) + "\n")
        for figure, more in (("spiderweb", ("--scan", 2)), ("scanline", ("--scan", 1, "--line", 2)), ("scanline", ()),
                             ("correspondences", ("--scans", 2, 1, "--landmarks", 6))):
            out = self.folder / f"{figure}.svg"
            code, output, errors = run("figure", figure, *more, "--out", out, self.folder / "scan_1.csv", self.folder / "scan_2.csv")
            self.assertEqual(code, OK, errors)
            self.assertEqual(output, f"{out}\n")
            xml.dom.minidom.parse(str(out))
        self.assertIn("6 by 6 landmarks", (self.folder / "correspondences.svg").read_text())
        if shutil.which("rsvg-convert"):
            for command in (("figure", "spiderweb", self.folder / "scan_1.csv"), ("edges", "--points", 50, "--depth", 2, "--sets", 1)):
                code, _, errors = run(*command, "--out", self.folder / "f.png")
                self.assertEqual(code, OK, errors)
                self.assertTrue((self.folder / "f.png").read_bytes().startswith(b"\x89PNG"))
                self.assertTrue((self.folder / "f.svg").is_file())
        for more in (("--scan", 3), ("--line", 4)):
            code, _, errors = run("figure", "scanline", *more, "--out", self.folder / "x.svg", self.folder / "scan_1.csv")
            self.assertEqual(code, DATAERR, errors)
        self.assertEqual(run("figure", "correspondences", "--out", self.folder / "x.svg", self.folder / "scan_1.csv")[0], DATAERR)
        landmarks = self.write("landmarks.csv", "scan,x_m,y_m\n1,1,2\n1,3,4\n")
        code, _, errors = run("figure", "spiderweb", "--out", self.folder / "x.svg", landmarks)
        self.assertEqual((code, "holds landmarks" in errors), (DATAERR, True), errors)
        code, _, errors = run("figure", "spiderweb", "--out", self.folder / "x.svg", self.write("r.lcm", b"\xed\xa1\xda\x01" + bytes(24)))
        self.assertEqual((code, "is a recording; figures are drawn from clouds" in errors), (DATAERR, True), errors)
        self.assertEqual(run("figure")[0], USAGE)

    def test_landmarks_that_were_found_are_a_list_to_replay(self):
        scans = self.simulate()
        listed = self.folder / "landmarks.csv"
        code, _, errors = run("replay", "--config", CONFIG / "experiment-3.toml", "--landmarks", listed, "--out", self.out, scans)
        self.assertEqual(code, OK, errors)
        found = listed.read_text().splitlines()
        self.assertEqual(found[0], "scan,x_m,y_m,diameter_m,weight")
        self.assertEqual({line.split(",")[0] for line in found[1:]}, {"1", "2", "3", "4"})
        code, output, errors = run("replay", "--config", CONFIG / "experiment-3.toml", "--out", self.folder / "again", listed)
        self.assertEqual(code, OK, errors)
        self.assertIn("scans            4", output)

    def simulate(self):
        scans = self.folder / "scans"
        code, _, errors = run("simulate", CONFIG / "worlds/bush.toml", "--out", scans, "--scans", 4, "--experiment", 3)
        self.assertEqual(code, OK, errors)
        return scans

    def test_simulate_replay_eval(self):
        scans = self.simulate()
        for out in ("a", "b"):
            code, output, errors = run("replay", "--no-times", "--config", CONFIG / "experiment-3.toml", "--truth",
                                       scans / "truth.tum", "--out", self.folder / out, scans)
            self.assertEqual(code, OK, errors)
        names = ["trajectory.tum", "hindsight.tum", "fixes.csv", "map.csv", "track.nmea", "plot.svg"]
        self.assertEqual(filecmp.cmpfiles(self.folder / "a", self.folder / "b", names, shallow=False), (names, [], []))
        code, output, _ = run("eval", "--json", "--truth", scans / "truth.tum", self.folder / "a/trajectory.tum")
        self.assertEqual(code, OK)
        self.assertEqual(json.loads(output)["wrong_fixes"], 0)
        self.assertGreaterEqual(json.loads(output)["fixes"], 3)

    def test_eval_compares_within_a_tolerance(self):
        pose = "{} {} 0 0 0 0 0 1\n"
        truth = self.write("t.tum", "".join(pose.format(100 + i, i) for i in range(5)))
        late = self.write("f.tum", "".join(pose.format(100.03 + i, i) for i in range(5)))
        code, output, errors = run("eval", "--truth", truth, late)
        self.assertEqual(code, DATAERR)
        self.assertIn("within 0.01 s", errors)
        code, output, _ = run("eval", "--json", "--time-tolerance", 0.05, "--truth", truth, late)
        self.assertEqual((code, json.loads(output)["fixes_without_truth"]), (OK, 0))

    def test_what_is_not_read_is_named_and_fails(self):
        self.write("scan_1.pcd", pcd([(1, 2, 3)]))
        self.write("notes.md", "")
        code, output, errors = run("replay", "--out", self.out, self.folder)
        self.assertEqual(code, OK, errors)
        self.assertIn("notes.md", errors)
        code, output, errors = run("replay", "--out", self.out, self.folder)
        self.assertEqual(code, OK, "the results of the run before are no input: " + errors)
        self.write("scan_2.ply", "ply")
        code, output, errors = run("replay", "--out", self.out, self.folder)
        self.assertEqual(code, DATAERR)
        self.assertIn("not read: " + str(self.folder / "scan_2.ply"), errors)
        self.assertIn("entries not read 2", output)

    def test_a_landmark_list_that_cannot_be_read_is_refused_as_any_scan(self):
        bad = self.write("bad.csv", "scan,x_m,y_m\n7,1,2\n7,far,3\n")
        self.refused(bad, "bad.csv:3", "far", status=(DATAERR,))
        m = self.write("maps/m.csv", "id,x_m,y_m\n1,1,2\n2,5,9\n3,9,1\n")
        self.assertEqual(run("locate", "--map", m, "--scans", bad, "--out", self.folder / "p.csv")[0], DATAERR)
        self.write("scan_1.pcd", pcd([(1, 2, 3)]))
        self.write("fixes.csv", "scan,status,reason,x_m,y_m\n1,fix,,0,0\n")
        code, output, errors = run("replay", "--out", self.out, self.folder)
        self.assertEqual(code, DATAERR)
        self.assertRegex(output, r"(?m)^scans +1 \(and 1 refused\)$")
        self.assertIn("refused: " + str(bad) + ":3", errors)
        self.assertIn("fixes.csv: holds the fixes of an earlier run", errors)

    def test_eval_needs_a_pose_of_the_truth(self):
        some = self.write("some.tum", "1 0 0 0 0 0 0 1\n")
        code, _, errors = run("eval", "--truth", self.write("none.tum", "# t x y z\n"), some)
        self.assertEqual(code, DATAERR)
        self.assertIn("none.tum: holds no pose", errors)

    def test_simulate_needs_a_world_with_something_in_it(self):
        code, _, errors = run("simulate", self.write("empty.toml", "\n"), "--out", self.out, "--scans", 1)
        self.assertEqual(code, DATAERR)
        self.assertIn("empty.toml: is empty", errors)

    def test_report_of_a_replay_is_drawn(self):
        draw = random.Random(4)
        trees = [(draw.uniform(-60, 60), draw.uniform(-60, 60)) for _ in range(150)]
        lines, truth = ["scan,x_m,y_m"], []
        for scan in range(12):
            x0 = -20.0 + 3.0 * scan
            lines += [f"{scan},{x - x0 + draw.gauss(0, 0.05):.3f},{y + draw.gauss(0, 0.05):.3f}" for x, y in trees
                      if math.hypot(x - x0, y) < 30]
            truth.append(f"{scan} {x0} 0 0 0 0 0 1")
        scans, true = self.write("scans.csv", "\n".join(lines) + "\n"), self.write("truth.tum", "\n".join(truth) + "\n")
        self.assertEqual(run("replay", "--out", self.out, scans)[0], OK)
        code, output, errors = run("report", self.out)
        self.assertEqual(code, OK, errors)
        self.assertEqual([pathlib.Path(line).name for line in output.split()], ["map.svg", "matches.svg", "time.svg"])
        code, output, errors = run("report", self.out, "--truth", true, "--out", self.folder / "report")
        self.assertEqual(code, OK, errors)
        names = [pathlib.Path(line).name for line in output.split()]
        self.assertEqual(names, ["map.svg", "matches.svg", "time.svg", "error.svg", "sigma.svg", "xi.svg"])
        for name in names:
            text = (self.folder / "report" / name).read_text()
            self.assertTrue(text.startswith("<"), name)
            xml.dom.minidom.parseString(text)
        self.assertIn("12 of 12 scans gave a fix", (self.folder / "report" / "matches.svg").read_text())
        self.assertIn("0 of 12 errors exceed the protection radius", (self.folder / "report" / "error.svg").read_text())
        code, _, errors = run("report", self.out, "--png")
        if shutil.which("rsvg-convert"):
            self.assertEqual(code, OK, errors)
            self.assertTrue((self.out / "report" / "matches.png").read_bytes().startswith(b"\x89PNG"))
        else:
            self.assertEqual(code, CANTCREAT)
            self.assertIn("librsvg2-bin", errors)
        self.assertEqual(run("report", self.folder)[0], NOINPUT)
        self.assertEqual(run("report", self.out, "--truth", self.write("late.tum", "99 0 0 0 0 0 0 1\n"))[0], DATAERR)

    def test_locate_finds_the_map_in_itself(self):
        points = [(1.0, 2.0), (9.0, -3.0), (-6.0, 4.0), (12.0, 11.0), (-3.0, -13.0), (17.0, 2.5), (-14.0, -2.0),
                  (5.0, 16.0), (-11.0, 13.0), (3.0, -7.0), (20.0, -12.0), (-19.0, 8.0)]
        m = self.write("map.csv", "id,x_m,y_m\n" + "".join(f"{i},{x},{y}\n" for i, (x, y) in enumerate(points)))
        s = self.write("scans.csv", "scan,x_m,y_m\n" + "".join(f"5,{y},{-x}\n" for x, y in points))
        poses = self.folder / "poses.csv"
        for more in ([], ["--search", "fast"], ["--search", "paper"], ["--no-deadline"]):
            code, output, errors = run("locate", "--map", m, "--scans", s, "--out", poses, *more)
            self.assertEqual(code, OK, errors)
            header, row = poses.read_text().split()
            self.assertEqual(header, "scan,status,reason,x_m,y_m,heading_rad,protection_radius_m,matches,expected_false_alarms,milliseconds")
            cells = row.split(",")
            self.assertEqual(cells[:3], ["5", "fix", "none"], more)
            self.assertAlmostEqual(float(cells[5]), math.pi / 2, places=6)
            self.assertTrue(0.0 < float(cells[6]) < 1.0, cells)
            self.assertEqual(cells[7], "12")
        self.assertEqual(run("locate", "--map", m, "--scans", s, "--out", poses, "--search", "exact")[0], USAGE)

    def agree(self, paper, fast, columns, within, apart=0):
        """The same statuses but of `apart` scans, and poses within the rounding of a fit that may have a match or two
        more or less."""
        self.assertEqual(len(paper), len(fast))
        differ = [(one, other) for one, other in zip(paper, fast) if one["status"] != other["status"]]
        self.assertLessEqual(len(differ), apart, differ)
        for one, other in zip(paper, fast):
            if one["status"] == other["status"] == "fix":
                for column in columns:
                    self.assertLess(abs(float(one[column]) - float(other[column])), within, (one, other))

    def test_both_searches_locate_the_same(self):
        for count in (100, 1000):
            draw = random.Random(count)
            trees = forest(draw, count)
            m = self.write("map.csv", csv_of("id,x_m,y_m", [(i, *tree) for i, tree in enumerate(trees)]))
            half = 0.5 * math.sqrt(70.0 * count) - 15.0
            rows = []
            for scan in range(12):  # the last two of another forest
                pose = draw.uniform(-half, half), draw.uniform(-half, half), draw.uniform(-math.pi, math.pi)
                rows += [(scan, *p) for p in scan_of(draw, trees if scan < 10 else forest(draw, count), pose, 6)]
            s = self.write("scans.csv", csv_of("scan,x_m,y_m", rows))
            poses = {}
            for search in ("paper", "fast"):
                out = self.folder / f"{search}.csv"
                code, _, errors = run("locate", "--map", m, "--scans", s, "--out", out, "--search", search,
                                      "--no-deadline")
                self.assertEqual(code, OK, errors)
                poses[search] = list(csv.DictReader(out.read_text().splitlines()))
            self.assertEqual([row["status"] for row in poses["paper"]], ["fix"] * 10 + ["no_fix"] * 2)
            self.agree(poses["paper"], poses["fast"], ("x_m", "y_m", "heading_rad"), 0.03)

    def test_both_searches_replay_the_same(self):
        draw = random.Random(3)
        trees = forest(draw, 250)
        rows = []
        for scan in range(30):  # a circle that ends where it began
            turn = 2 * math.pi * scan / 28
            pose = 12 * math.cos(turn), 12 * math.sin(turn), draw.uniform(-math.pi, math.pi)
            rows += [(scan, *p) for p in scan_of(draw, trees, pose, 1)]
        scans = self.write("scans.csv", csv_of("scan,x_m,y_m", rows))
        fixes = {}
        for search in ("paper", "fast"):
            out = self.folder / search
            code, _, errors = run("replay", "--out", out, "--set", f"association.search={search}", "--set",
                                  "realtime.slam_deadline_s=100", scans)
            self.assertEqual(code, OK, errors)
            fixes[search] = list(csv.DictReader((out / "fixes.csv").read_text().splitlines()))
        self.assertGreater([row["status"] for row in fixes["paper"]].count("fix"), 25)
        self.agree(fixes["paper"], fixes["fast"], ("x_m", "y_m"), 0.15, apart=1)  # whose maps grew apart

    def test_locate_tells_searches_that_the_deadline_cut(self):
        def points(seed, count, reach):
            draw = random.Random(seed)
            return [(draw.uniform(-reach, reach), draw.uniform(-reach, reach)) for _ in range(count)]
        m = self.write("map.csv", "id,x_m,y_m\n" + "".join(f"{i},{x},{y}\n" for i, (x, y) in
                                                          enumerate(points(1, 3000, 230.0))))
        s = self.write("scans.csv", "scan,x_m,y_m\n" + "".join(f"5,{x},{y}\n" for x, y in points(2, 100, 40.0)))
        code, output, errors = run("locate", "--map", m, "--scans", s, "--out", self.folder / "poses.csv", "--search",
                                   "paper", "--set", "realtime.slam_deadline_s=0.01")
        self.assertEqual(code, OK, errors)
        self.assertIn("cut        1 searches before their end", output)

    # --- what would do harm ---------------------------------------------------------------------------------------

    def scans_and_map(self):
        draw = random.Random(7)
        points = [(draw.uniform(-30, 30), draw.uniform(-30, 30)) for _ in range(14)]
        m = self.write("m.csv", "id,x_m,y_m\n" + "".join(f"{i},{x},{y}\n" for i, (x, y) in enumerate(points)))
        s = self.write("s.csv", "scan,x_m,y_m\n" + "".join(f"5,{x},{y}\n" for x, y in points))
        return m, s

    def test_no_verb_overwrites_its_own_input(self):
        m, s = self.scans_and_map()
        self.out.mkdir()
        scans = self.out / "map.csv"
        scans.write_bytes(s.read_bytes())
        truth = self.out / "hindsight.tum"
        truth.write_text("5 0 0 0 0 0 0 1\n")
        link = self.folder / "link.csv"
        link.symlink_to(s)
        config = self.write("c.toml", "")
        (self.folder / "c.toml.d").mkdir()
        drop_in = self.write("c.toml.d/10.toml", "")
        world = CONFIG / "worlds" / "bush.toml"
        own_world = self.out / "stems.csv"
        own_world.write_bytes(world.read_bytes())
        self.assertEqual(run("map", "import", m, "--out", self.folder / "m.slammap")[0], OK)
        slammap = self.folder / "m.slammap"
        (self.folder / "run" / "report").mkdir(parents=True)
        fixes = self.folder / "run" / "fixes.csv"
        fixes.write_text("")
        scenario = self.write("scenario.toml", f"world = '{own_world}'\n")
        clouds = self.folder / "clouds"
        clouds.mkdir()
        cloud = self.write("clouds/scan_1.pcd", pcd([(1, 2, 3)]))
        beside = self.write("beside.svg", "")
        run_of_s = self.folder / "run_of_s"
        self.assertEqual(run("replay", "--out", run_of_s, s)[0], OK)
        plot = run_of_s / "plot.svg"
        pictures = self.folder / "pictures"
        pictures.mkdir()
        (pictures / "map.svg").symlink_to(plot)
        def picture(of):
            """A name that a picture may have, and that leads to `of`."""
            name = self.folder / f"to_{of.stem}.svg"
            name.symlink_to(of)
            return name

        for inputs, arguments in [
            ([scans], ["replay", "--out", self.out, scans]),
            ([scans], ["replay", "--out", self.out, self.out]),
            ([truth], ["replay", "--out", self.out, "--truth", truth, s]),
            ([s], ["locate", "--map", m, "--scans", s, "--out", s]),
            ([s], ["locate", "--map", m, "--scans", s, "--out", link]),
            ([s], ["locate", "--map", m, "--scans", link, "--out", s]),
            ([m], ["locate", "--map", m, "--scans", s, "--out", m]),
            ([config], ["locate", "--config", config, "--map", m, "--scans", s, "--out", config]),
            ([drop_in], ["locate", "--config", config, "--map", m, "--scans", s, "--out", drop_in]),
            ([drop_in], ["replay", "--config", config, "--out", self.folder / "r", "--landmarks", drop_in, s]),
            ([drop_in, own_world], ["record", own_world, "--config", config, "--out", drop_in]),
            ([plot], ["replay", "--out", run_of_s, "--landmarks", plot, s]),
            ([], ["replay", "--out", self.folder / "r", "--landmarks", self.folder / "." / "r" / "map.csv", s]),
            ([slammap], ["locate", "--map", m, "--scans", s, "--out", slammap]),
            ([slammap], ["map", "export", slammap, "--format", "csv", "--out", slammap]),
            ([slammap], ["map", slammap, "--csv", slammap]),
            ([own_world], ["simulate", own_world, "--out", self.out, "--scans", 1]),
            ([own_world], ["record", own_world, "--out", own_world]),
            ([own_world, slammap], ["record", own_world, "--out", slammap]),
            ([own_world], ["record", own_world, "--out", self.folder / "r.lcm", "--truth", own_world]),
            ([own_world], ["record", scenario, "--out", own_world]),
            ([own_world], ["emulate", scenario, "--truth", own_world]),
            ([fixes], ["demo", "--world", fixes, "--out", self.folder / "run", "--scans", 1]),
            ([s], ["replay", "--out", self.folder / "r", "--landmarks", s, s]),
            ([s], ["replay", "--out", self.folder / "r", "--landmarks", link, s]),
            ([truth], ["replay", "--out", self.folder / "r", "--landmarks", truth, "--truth", truth, s]),
            ([cloud], ["replay", "--out", self.folder / "r", "--landmarks", cloud, clouds]),
            ([cloud], ["figure", "spiderweb", cloud, "--out", picture(cloud)]),
            ([cloud], ["figure", "scanline", clouds, "--out", self.folder / "to_scan_1.svg"]),
            ([s], ["figure", "correspondences", s, "--out", picture(s)]),
            ([config], ["figure", "spiderweb", "--config", config, cloud, "--out", picture(config)]),
            ([beside], ["figure", "spiderweb", cloud, "--config", beside, "--out", beside.with_suffix(".png")]),
            ([plot], ["report", run_of_s, "--out", pictures]),
        ]:
            before = [path.read_bytes() for path in inputs]
            code, _, errors = run(*arguments)
            self.assertEqual(code, CANTCREAT, f"{arguments}: {errors}")
            self.assertIn("name another output", errors)
            self.assertEqual([path.read_bytes() for path in inputs], before, arguments)
        self.assertEqual(run("locate", "--map", m, "--scans", s, "--out", self.folder / "p.csv")[0], OK)

    def test_a_driven_map_is_no_survey_for_locate(self):
        m, s = self.scans_and_map()
        poses = self.folder / "p.csv"
        lines = m.read_text().splitlines()
        driven = self.write("driven.csv", lines[0] + ",sightings\n" + "".join(line + ",5\n" for line in lines[1:]))
        for given in (m, driven):
            code, output, errors = run("locate", "--map", given, "--scans", s, "--out", poses)
            self.assertEqual(code, OK, errors)
            self.assertIn("map        14 landmarks", output)
        self.assertEqual(run("locate", "--map", self.write("bad.csv", "id,x_m,y_m,sightings\n0,1,2,0\n"), "--scans", s,
                             "--out", poses)[0], DATAERR)

    def test_a_foreign_part_or_setting_of_a_recording_is_named_and_takes_nothing(self):
        recording = self.folder / "a.lcm"
        code, _, errors = run("record", CONFIG / "scenarios" / "fast.toml", "--out", recording, "--scans", 1,
                              "--set", "scan.tilt_step_deg=4", "--set", "scan.pan_speed_deg_s=110")
        self.assertEqual(code, OK, errors)
        foreign = b"".join(struct.pack(">IqqII", 0xEDA1DA01, number, number, 6, 4) + b"CAMERA" + b"data"
                           for number in range(2))
        self.assertEqual(run("replay", "--out", self.out, recording)[0], OK)
        landmarks = (self.out / "map.csv").read_text()
        self.assertGreater(len(landmarks.splitlines()), 3)
        for parts in ((recording.read_bytes(), foreign), (foreign, recording.read_bytes())):
            joined = self.folder / "joined.lcm"
            joined.write_bytes(b"".join(parts))
            code, output, errors = run("replay", "--out", self.out, joined)
            self.assertEqual(code, OK, errors)
            self.assertIn("is no recording of scans and was passed over", output)
            self.assertEqual((self.out / "map.csv").read_text(), landmarks)
        older = self.folder / "older.lcm"
        for key in ("point_laser.unit_x", "point_laser.layout"):  # the second is one of a former version
            older.write_bytes(with_other_settings(recording.read_bytes(), b"point_laser.unit_m", key.encode()))
            code, output, errors = run("replay", "--out", self.out, older)
            self.assertEqual(code, OK, errors)
            self.assertIn("(settings): made by another version; without effect are ", output)
            self.assertIn(key, output)
            self.assertEqual(errors, "")

    def test_numbers_of_options_are_numbers(self):
        truth = self.write("t.tum", "1 0 0 0 0 0 0 1\n")
        for value in ("nan", "-1", "inf", "-nan"):
            for arguments in (["eval", "--truth", truth, truth], ["replay", "--out", self.out, self.folder]):
                code, _, errors = run(*arguments, f"--time-tolerance={value}")
                self.assertEqual(code, USAGE, f"{value}: {errors}")
        self.assertEqual(run("eval", "--truth", truth, truth, "--wrong-distance=nan")[0], USAGE)

    def test_eval_of_an_empty_trajectory_is_no_success(self):
        truth = self.write("t.tum", "1 0 0 0 0 0 0 1\n")
        for text in ("", "# t x y z qx qy qz qw\n"):
            empty = self.write("e.tum", text)
            code, _, errors = run("eval", "--json", "--truth", truth, empty)
            self.assertEqual(code, DATAERR)
            self.assertIn("e.tum: holds no pose", errors)

    def test_a_list_that_is_cut_is_told(self):
        draw = random.Random(3)
        points = [(draw.uniform(-60, 60), draw.uniform(-60, 60)) for _ in range(80)]
        s = self.write("s.csv", "scan,x_m,y_m\n" + "".join(f"5,{x},{y}\n" for x, y in points + points[:2]))
        m = self.write("m.csv", "id,x_m,y_m\n" + "".join(f"{i},{x},{y}\n" for i, (x, y) in enumerate(points)))
        for arguments in (["replay", "--out", self.out, s],
                          ["locate", "--map", m, "--scans", s, "--out", self.folder / "p.csv"]):
            code, output, errors = run(*arguments)
            self.assertEqual(code, OK, errors)
            self.assertIn("left out         20 landmarks in 1 scans that list up to 80; "
                          "--set detection.landmarks_max=80 keeps them", output)
            self.assertIn("counted once     2 landmarks", output)
            code, output, errors = run(*arguments, "--set", "detection.landmarks_max=80")
            self.assertNotIn("left out    ", output)

    def test_full_disk_is_an_error(self):
        if not pathlib.Path("/dev/full").exists():
            self.skipTest("no /dev/full here")
        full = self.folder / "full.svg"
        full.symlink_to("/dev/full")
        code, _, errors = run("edges", "--points", 50, "--depth", 2, "--sets", 1, "--out", full)
        self.assertEqual(code, CANTCREAT)
        self.assertIn(str(full), errors)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=1)
