#!/usr/bin/env python3
"""Shows that the judge calls right right and wrong wrong, and that the worlds repeat: judge_test.py"""

import math
import pathlib
import random
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import geometry as geo  # noqa: E402
import judge  # noqa: E402
import worlds  # noqa: E402

HEADS = ("scan,status,x_m,y_m,heading_rad,sigma_x_m,sigma_y_m,sigma_heading_rad,corr_x_y,corr_x_heading,"
         "corr_y_heading,milliseconds")
EXACT = "0.1,0.1,0.01,0,0,0"
TRUTH = {0: (10.0, 20.0, 1.0), 1: (13.0, 20.0, 1.5), 2: (13.0, 24.0, -3.1)}


def in_map(pose):
    """The true pose in a map whose origin is the true pose of scan 0."""
    x_m, y_m = geo.to_sensor(TRUTH[0], pose)
    return x_m, y_m, geo.wrap(pose[2] - TRUTH[0][2])


class Judge(unittest.TestCase):
    def judged(self, rows, heads=HEADS):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "fixes.csv"
            path.write_text("\n".join([heads, *rows]) + "\n", encoding="ascii")
            return judge.judge_drive(path, TRUTH)

    def row(self, scan, dx_m=0.0, dy_m=0.0, turn_rad=0.0, tail=""):
        x_m, y_m, heading_rad = in_map(TRUTH[scan])
        return f"{scan},fix,{x_m + dx_m},{y_m + dy_m},{heading_rad + turn_rad},{EXACT},2.5{tail}"

    def test_aligned_by_first_fix_all_right(self):
        verdict = self.judged([self.row(0), self.row(1), self.row(2)])
        self.assertEqual((verdict.fixes, verdict.right, verdict.wrong), (3, 3, 0))
        self.assertAlmostEqual(max(verdict.errors_m), 0.0)
        self.assertEqual(verdict.times_ms, [2.5] * 3)

    def test_wrong_beyond_one_metre_or_two_degrees(self):
        rows = [self.row(0), self.row(1, dx_m=0.99), self.row(2, dx_m=1.01)]
        self.assertEqual(self.judged(rows).wrong, 1)
        rows = [self.row(0), self.row(1, turn_rad=math.radians(1.99)), self.row(2, turn_rad=math.radians(-2.01))]
        self.assertEqual((self.judged(rows).wrong, self.judged(rows).gross), (1, 0))
        rows = [self.row(0), self.row(1, dy_m=-5.01), self.row(2)]
        self.assertEqual((self.judged(rows).wrong, self.judged(rows).gross), (1, 1))

    def test_heading_wraps(self):
        rows = [self.row(0), self.row(1, turn_rad=2.0 * math.pi), self.row(2, turn_rad=-2.0 * math.pi)]
        self.assertEqual(self.judged(rows).wrong, 0)

    def test_local_map_is_counted_apart(self):
        rows = [self.row(0, tail=",0"), self.row(1, dx_m=50.0, tail=",1"), self.row(2, tail=",0")]
        verdict = self.judged(rows, HEADS + ",map")
        self.assertEqual((verdict.fixes, verdict.right, verdict.wrong, verdict.local), (3, 2, 0, 1))

    def test_the_home_map_has_its_number(self):
        rows = [self.row(0, tail=",3,3"), self.row(1, dx_m=50.0, tail=",4,3"), self.row(2, dx_m=2.0, tail=",3,3")]
        verdict = self.judged(rows, HEADS + ",map,home")
        self.assertEqual((verdict.fixes, verdict.right, verdict.wrong, verdict.local), (3, 1, 1, 1))

    def test_each_home_map_is_aligned_by_itself(self):
        rows = [self.row(0, tail=",1,1"), self.row(1, dx_m=50.0, tail=",2,2"), self.row(2, dx_m=50.0, tail=",2,2"),
                self.row(2, dx_m=2.0, tail=",1,1")]
        verdict = self.judged(rows, HEADS + ",map,home")
        self.assertEqual((verdict.fixes, verdict.right, verdict.wrong, verdict.local), (4, 3, 1, 0))

    def test_statuses_are_counted(self):
        silent = ",,,,,,,,,,1"
        verdict = self.judged(["0,no_fix" + silent, "1,ambiguous" + silent, self.row(2)])
        self.assertEqual((verdict.scans, verdict.no_fix, verdict.ambiguous, verdict.fixes), (3, 1, 1, 1))

    def test_protection_radius_violation(self):
        rows = [self.row(0, tail=",0.5"), self.row(1, dx_m=0.4, tail=",0.5"), self.row(2, dx_m=0.6, tail=",0.5")]
        verdict = self.judged(rows, HEADS + ",protection_radius_m")
        self.assertEqual((verdict.violations, len(verdict.radii_m)), (1, 3))

    def test_normalised_error_with_correlation(self):
        row = dict(zip(("sigma_x_m", "sigma_y_m", "sigma_heading_rad", "corr_x_y", "corr_x_heading", "corr_y_heading"),
                       ("2", "1", "1", "0.5", "0", "0")))
        # C = [4 1 0; 1 1 0; 0 0 1], inverse [1/3 -1/3 0; -1/3 4/3 0; 0 0 1].
        self.assertAlmostEqual(judge.normalised_error(row, (1.0, 2.0, 3.0)), 1 / 3 - 4 / 3 + 16 / 3 + 9.0)
        row["sigma_x_m"] = "0"
        self.assertIsNone(judge.normalised_error(row, (1.0, 2.0, 3.0)))

    def test_best_alignment_forgives_a_turned_map_and_nothing_else(self):
        truth = [(0.0, 0.0, 0.1), (40.0, 0.0, 0.2), (40.0, 30.0, 0.3), (0.0, 30.0, 0.4)]
        turned = [(*geo.to_world((5.0, -3.0, 2.0), pose), pose[2] + 2.0) for pose in truth]
        verdict = judge.Verdict()
        verdict.judge_best_alignment(list(zip(turned, truth)))
        self.assertAlmostEqual(max(verdict.best_errors_m), 0.0)
        verdict.judge_best_alignment([(turned[1], truth[1])])
        self.assertEqual(verdict.best_wrong, 0)
        stretched = [(1.1 * x_m, y_m, heading_rad) for x_m, y_m, heading_rad in turned]
        verdict.judge_best_alignment(list(zip(stretched, truth)))
        self.assertGreater(verdict.best_wrong, 0)

    def test_foreign_scan_with_a_fix_is_wrong(self):
        with tempfile.TemporaryDirectory() as folder:
            poses, truth = pathlib.Path(folder) / "poses.csv", pathlib.Path(folder) / "truth.csv"
            poses.write_text("scan,status,x_m,y_m,heading_rad,milliseconds\n0,fix,1,2,3,0.1\n1,fix,1,2,3,0.1\n",
                             encoding="ascii")
            truth.write_text("scan,x_m,y_m,heading_rad\n1,1.5,2,3\n", encoding="ascii")
            verdict = judge.judge_case(poses, truth)
        self.assertEqual((verdict.right, verdict.wrong, verdict.scans), (1, 1, 2))


class Worlds(unittest.TestCase):
    QUICK = ("street", "twin", "twin_bare", "road", "plantation", "cold_start", "few_1k", "rows")

    def written(self, kind, seed):
        with tempfile.TemporaryDirectory() as folder:
            worlds.write_world(kind, seed, pathlib.Path(folder), queries=5)
            return {path.name: path.read_bytes() for path in pathlib.Path(folder).iterdir()}

    def test_a_seed_repeats_and_another_differs(self):
        for kind in self.QUICK:
            with self.subTest(kind):
                self.assertEqual(self.written(kind, 1), self.written(kind, 1))
                self.assertNotEqual(self.written(kind, 1), self.written(kind, 2))

    def test_true_poses_put_the_trees_where_they_stand(self):
        rng, sensor = random.Random(1), worlds.Sensor(dropped=0.0, spurious=0.0, sigma_m=0.0)
        trees, _ = geo.forest(rng, 200)
        for pose in (geo.anywhere(rng, 40.0) for _ in range(20)):
            near = geo.Grid(trees).within(pose[0], pose[1], sensor.range_m)
            for x_m, y_m, _, _ in worlds.observe(rng, sensor, pose, near):
                x_W, y_W = geo.to_world(pose, (x_m, y_m))
                self.assertLess(min(math.hypot(t[0] - x_W, t[1] - y_W) for t in trees), 1e-9)

    def test_heaviest_landmark_comes_first(self):
        for scan in worlds.make_drive("cold_start", 3):
            weights = [landmark[3] for landmark in scan.landmarks]
            self.assertEqual(weights, sorted(weights, reverse=True))
        self.assertLessEqual(len(worlds.make_drive("cold_start", 3)[0].landmarks), 4)


if __name__ == "__main__":
    unittest.main()
