#!/usr/bin/env python3
"""A survey as the map of the running daemon: it finds itself there with its first scan, in the survey's frame, and changes
nothing. survey_test.py SLAMSENSOR SLAMSENSORD"""
import csv
import math
import random
import re
import subprocess
import sys
import time
import unittest

from sensor import HERE, Sensor, error_of, wait_for

PROGRAMS = sys.argv[1:3]
ORIGIN = (545_000.0, 4_701_000.0)  # near a place of a national grid
TURN = math.radians(40.0)
NOISE_M = 0.05
URL = f"udpm://239.255.76.70:{7800 + int(time.time()) % 90}?ttl=0"


def surveyed(pose, noise=lambda: 0.0):
    """Where a pose (x, y, ...) of the sensor's map lies in the grid, as the surveyors measure it."""
    c, s = math.cos(TURN), math.sin(TURN)
    return (ORIGIN[0] + 120.0 + c * pose[0] - s * pose[1] + noise(), ORIGIN[1] - 80.0 + s * pose[0] + c * pose[1] + noise())


class Survey(unittest.TestCase):
    def setUp(self):
        self.sensor = Sensor(PROGRAMS)
        self.addCleanup(self.sensor.close)

    def slamsensor(self, *arguments):
        done = subprocess.run([PROGRAMS[0], *map(str, arguments)], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def make_survey(self):
        """An inventory of what stands there: a map of an earlier drive, in another frame and with other errors."""
        sensor = self.sensor
        sensor.start_head()
        sensor.start()
        sensor.wait_fix()
        for _ in range(len(sensor.stands) - 1):
            sensor.next_stand()
            sensor.wait_scans(2)
        sensor.ask("map save walk")
        self.assertEqual(sensor.terminate()[0], 0, sensor.log())
        sensor.stop_head()
        table = self.slamsensor("map", "export", "walk", "--store", sensor.maps, "--format", "csv")
        draw = random.Random(3)
        inventory = sensor.folder / "inventory.csv"
        with inventory.open("w") as file:
            file.write("tree;E;N\n")
            for row in csv.DictReader(table.splitlines()):
                if row["kind"] == "landmark":
                    e, n = surveyed((float(row["x_m"]), float(row["y_m"])), lambda: draw.gauss(0.0, NOISE_M))
                    file.write(f"T{row['id']};{e:.3f};{n:.3f}\n")
        return inventory

    def check_fix(self, status):
        """The fix is where the sensor stands, in the survey's frame less its origin."""
        self.assertEqual(status["fix"]["status"], "fix")
        pose = self.sensor.pose()
        east, north = surveyed(pose)
        metres, radians = error_of(status["fix"], (east - ORIGIN[0], north - ORIGIN[1], pose[2] + TURN))
        print(f"\nstand {self.sensor.stand}: {metres:.3f} m, {math.degrees(radians):.2f} deg, "
              f"{status['fix']['matches']} of {status['fix']['landmarks_seen']} landmarks, xi {status['fix']['error_xi']}", end="")
        self.assertLess(metres, 0.3)
        self.assertLess(radians, math.radians(1.0))

    def test_the_first_scan_in_a_survey_is_a_fix_and_changes_nothing(self):
        sensor = self.sensor
        inventory = self.make_survey()
        said = self.slamsensor("map", "import", inventory, "--columns", "E", "N", "--origin", *ORIGIN, "--out", "survey",
                               "--store", sensor.maps)
        landmarks = int(re.search(r"landmarks  (\d+)", said)[1])
        before = (sensor.maps / "survey.slammap").read_bytes()
        sensor.start_head()
        sensor.start({"map.name": "survey", "map.autosave_s": 1.0, "lcm.enabled": "true", "lcm.url": f'"{URL}"'})
        self.check_fix(sensor.wait_fix())
        status = sensor.status()
        self.assertTrue(status["map"]["frozen"])
        self.assertEqual(status["map"]["landmarks"], landmarks)
        self.assertEqual(status["slam"]["local_maps"], 0)
        self.check_planner()
        for _ in range(2):
            sensor.next_stand()
            sensor.wait_scans(2)
            self.check_fix(sensor.wait_fix())
        self.assertEqual(sensor.status()["map"]["landmarks"], landmarks)
        self.assertIn("marked frozen", sensor.log())
        self.assertEqual(sensor.terminate()[0], 0, sensor.log())
        self.assertEqual((sensor.maps / "survey.slammap").read_bytes(), before)

    def check_planner(self):
        """The path planner's example plans in the survey, from what the daemon sends."""
        if "no route" in self.sensor.log():
            print("\nno route for multicast: the planner is not tried", end="")
            return
        east, north = surveyed((10.0, 2.0))
        done = subprocess.run([sys.executable, str(HERE / "../../tools/examples/plan_path.py"), f"{east - ORIGIN[0]:.2f}",
                               f"{north - ORIGIN[1]:.2f}", "--once", "--url", URL.split("?")[0]],
                              capture_output=True, text=True, timeout=120)
        print(f"\n{done.stdout.splitlines()[-1] if done.stdout else done.stderr}", end="")
        self.assertIn("from ", done.stdout)

    def test_a_survey_is_loaded_and_let_grow_on_request(self):
        sensor = self.sensor
        inventory = self.make_survey()
        sensor.start_head()
        sensor.start({"map.name": "other"})
        sensor.wait_fix()
        # A map is put beside those of a running daemon.
        self.slamsensor("map", "import", inventory, "--columns", "E", "N", "--origin", *ORIGIN, "--out", "survey",
                        "--store", sensor.maps)
        self.assertIn("marked frozen", sensor.ask("map load survey")[1])
        self.assertTrue(sensor.status()["map"]["frozen"])
        sensor.wait_scans(2)
        self.check_fix(sensor.wait_fix())
        sensor.ask("map unfreeze")
        wait_for(lambda: not sensor.status()["map"]["frozen"], "the map to be let grow")
        sensor.ask("map save")
        self.assertIn("a sensor may change it", self.slamsensor("map", "survey", "--store", sensor.maps))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
