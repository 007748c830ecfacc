#!/usr/bin/env python3
"""The daemon on a carrier that leans, which an accelerometer tells it (a folder that looks like sysfs): it levels its
scans, and gives no fix while it does not know how it leans. leaning_test.py SLAMSENSOR SLAMSENSORD"""
import math
import os
import sys
import unittest

from sensor import HERE, Sensor, wait_for

PROGRAMS = sys.argv[1:3]
ROLL_DEG, PITCH_DEG = 1.5, -2.0
STEPS_PER_G = 16384


class Accelerometer:
    """The files of an accelerometer. A write is whole: a reader never sees half a number."""

    def __init__(self, folder):
        self.folder = folder
        folder.mkdir()
        (folder / "name").write_text("fake-accel\n")
        (folder / "in_accel_scale").write_text(f"{9.80665 / STEPS_PER_G}\n")
        for axis in "xyz":
            (folder / f"in_accel_{axis}_raw").write_text(" " * 9)

    def lean(self, roll_deg, pitch_deg, share=1.0):
        roll, pitch = math.radians(roll_deg), math.radians(pitch_deg)
        up = (-math.sin(pitch), math.cos(pitch) * math.sin(roll), math.cos(pitch) * math.cos(roll))
        for axis, part in zip("xyz", up):
            file = os.open(self.folder / f"in_accel_{axis}_raw", os.O_WRONLY)
            os.pwrite(file, f"{round(share * STEPS_PER_G * part):>8}\n".encode(), 0)
            os.close(file)


class Leaning(unittest.TestCase):
    def setUp(self):
        self.sensor = Sensor(PROGRAMS)
        self.addCleanup(self.sensor.close)
        park = (HERE / "park.toml").read_text().replace('"../../config', f'"{HERE.parent.parent}/config')
        self.sensor.scenario = self.sensor.folder / "leaning.toml"
        self.sensor.scenario.write_text(park + f"\n[mount]\nroll_deg = {ROLL_DEG}\npitch_deg = {PITCH_DEG}\n")
        self.accelerometer = Accelerometer(self.sensor.folder / "iio")
        self.accelerometer.lean(ROLL_DEG, PITCH_DEG)
        self.settings = {"inclination.source": "iio", "inclination.iio_device": self.accelerometer.folder}

    def test_levels_its_scans_and_says_by_what(self):
        self.sensor.start_head()
        self.sensor.start(self.settings)
        status = self.sensor.wait_fix()
        self.assertFalse(self.sensor.is_wrong(status["fix"]))
        self.assertAlmostEqual(math.degrees(status["head"]["roll_rad"]), ROLL_DEG, delta=0.02)
        self.assertAlmostEqual(math.degrees(status["head"]["pitch_rad"]), PITCH_DEG, delta=0.02)
        self.assertEqual(status["devices"]["inclinometer"]["state"], "ready")
        self.assertEqual(status["devices"]["inclinometer"]["model"], "fake-accel")
        lines = "\n".join(self.sensor.ask("devices")[0])
        self.assertIn("inclinometer:", lines)
        self.sensor.next_stand()
        status = self.sensor.wait_scans(2)
        self.assertFalse(status["fix"]["status"] == "fix" and self.sensor.is_wrong(status["fix"]))

    def test_no_fix_while_the_accelerometer_does_not_tell_how_it_leans(self):
        self.sensor.start_head()
        self.sensor.start(self.settings)
        self.sensor.wait_fix()
        self.accelerometer.lean(ROLL_DEG, PITCH_DEG, share=1.2)
        status = self.sensor.wait_status(lambda s: s["state"] == "faulted", "the fault", 5.0)
        self.assertEqual((status["fix"]["status"], status["fix"]["reason"]), ("no_fix", "device"))
        problem = status["devices"]["inclinometer"]["problem"]
        self.assertIn("accelerometer", problem)
        self.assertIn("let the carrier stand still", problem)
        wait_for(lambda: "inclinometer lost" in self.sensor.log(), "the loss to be told")
        self.sensor.wait_status(lambda s: s["head"]["held"], "the scan to be stopped, three seconds later", 10.0)
        self.accelerometer.lean(ROLL_DEG, PITCH_DEG)
        self.sensor.wait_scans()
        status = self.sensor.wait_fix()
        self.assertFalse(self.sensor.is_wrong(status["fix"]))

    def test_without_the_device_it_does_not_scan(self):
        self.sensor.start_head()
        self.sensor.start({**self.settings, "inclination.iio_device": "no-such-accel"})
        status = self.sensor.wait_status(lambda s: s["devices"]["rangefinder"]["state"] == "ready" and
                                         s["devices"]["pan_tilt"]["state"] == "ready", "the head")
        self.assertEqual(status["state"], "starting")
        self.assertEqual(status["slam"]["scans"], 0)
        self.assertIn("no-such-accel", status["devices"]["inclinometer"]["problem"])
        self.assertIn("inclination.iio_device", status["devices"]["inclinometer"]["problem"])

    def test_a_carrier_that_is_tilted_during_a_scan_has_moved(self):
        self.sensor.start_head()
        self.sensor.start(self.settings)
        self.sensor.wait_fix()
        tilts = iter(range(1, 1000))

        def moved():
            self.accelerometer.lean(ROLL_DEG, PITCH_DEG + 3.0 * (next(tilts) // 20 % 2))
            counters = self.sensor.status()["counters"]["head"]
            return counters["scans_aborted_carrier_moved"] > 0
        wait_for(moved, "a scan to be given up")
        self.accelerometer.lean(ROLL_DEG, PITCH_DEG)
        self.sensor.wait_scans()
        self.assertFalse(self.sensor.is_wrong(self.sensor.wait_fix()["fix"]))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
