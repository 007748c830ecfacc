#!/usr/bin/env python3
"""A daemon built for another processor, on an emulated head of this one: it finds itself, and is right about it before and
after a move and after a restart. foreign_test.py SLAMSENSOR SLAMSENSORD (run by tests/system/arm64)"""
import sys
import unittest

from sensor import Sensor

PROGRAMS = sys.argv[1:3]
SLOW_S = 120.0  # an emulated processor


class Foreign(unittest.TestCase):
    def test_fixes_are_right(self):
        sensor = Sensor(PROGRAMS, settings={"map.autosave_s": 0, "lwnx.baud": 460800, "lwnx.rate_hz": 2000.0})
        self.addCleanup(sensor.close)
        sensor.start_head("--any-baud")  # qemu knows no rate above 460800 baud
        sensor.start()
        for move in range(3):
            if move > 0:
                sensor.next_stand()
                sensor.wait_scans(2)  # the one under way may have been begun before the move
            status = sensor.wait_status(lambda s: s["state"] == "fixed", "a fix", SLOW_S)
            self.assertFalse(sensor.is_wrong(status["fix"]), status["fix"])
            print(f"stand {move}: x={status['fix']['x_m']:.3f} m y={status['fix']['y_m']:.3f} m, {status['fix']['matches']} of "
                  f"{status['fix']['landmarks_seen']} landmarks; truth {sensor.pose()}", flush=True)
        sensor.ask("map save")
        status, _ = sensor.terminate()
        self.assertEqual(status, 0, sensor.log())
        sensor.start()
        status = sensor.wait_status(lambda s: s["state"] == "fixed", "a fix in the loaded map", SLOW_S)
        self.assertFalse(sensor.is_wrong(status["fix"]), status["fix"])
        self.assertGreater(status["fix"]["matches"], 5)
        sensor.terminate()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
