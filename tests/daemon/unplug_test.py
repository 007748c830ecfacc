#!/usr/bin/env python3
"""Each device's cable is pulled and put back again and again while the daemon runs: it recovers each time, nothing is
restarted, and no fix is wrong. unplug_test.py SLAMSENSOR SLAMSENSORD. SLAMSENSOR_UNPLUGS: how often for each device
(default 4)."""
import csv
import os
import pathlib
import re
import statistics
import sys
import time
import unittest

from sensor import HERE, Sensor

PROGRAMS = sys.argv[1:3]
UNPLUGS = int(os.environ.get("SLAMSENSOR_UNPLUGS", "4"))
PATIENCE_S = 20.0  # for one recovery
OUT_S, GAP_S = 0.7, 10.0
FIRST_S = 8.0  # time to start and find a first fix
DEVICES = {"ptu": "pan_tilt", "rangefinder": "rangefinder"}


def scenario(folder):
    """That of park.toml with the two cables pulled in turn, UNPLUGS times each."""
    world = (HERE / "../../config/worlds/park.toml").resolve()
    text = (HERE / "park.toml").read_text().replace("../../config/worlds/park.toml", str(world))
    for index, device in enumerate(DEVICES):
        begin = FIRST_S + index * GAP_S / len(DEVICES)  # a gap before the first
        text += (f'\n[[fault_rate]]\ndevice = "{device}"\nkind = "cable_out"\nrhythm = "regular"\n'
                 f"mean_gap_s = {GAP_S}\nfrom_s = {begin}\nuntil_s = {begin + (UNPLUGS + 0.5) * GAP_S}\n"
                 f"duration_s = {OUT_S}\n")
    path = pathlib.Path(folder) / "unplugged.toml"
    path.write_text(text)
    return path


class Unplugged(unittest.TestCase):
    def setUp(self):
        self.sensor = Sensor(PROGRAMS)
        self.addCleanup(self.sensor.close)
        self.sensor.scenario = scenario(self.sensor.folder)
        self.sensor.start_head()
        self.begun = time.monotonic()
        self.sensor.start()
        self.sensor.wait_fix()

    def follow(self):
        """Seconds from each replug to the recovery of its device, by device; fixes, wrong ones."""
        recovered = {device: [] for device in DEVICES.values()}
        seen = {device: 0 for device in recovered}
        fixes, wrong, last_scan = 0, [], -1
        over = self.begun + FIRST_S + (UNPLUGS + 1) * GAP_S  # all cables have been out and in
        while min(map(len, recovered.values())) < UNPLUGS or time.monotonic() < over:
            self.assertLess(time.monotonic(), over + PATIENCE_S, self.sensor.log())
            status = self.sensor.status()
            for name, device in status["devices"].items():
                if device["recoveries"] > seen[name]:
                    self.assertEqual(device["recoveries"], seen[name] + 1)
                    seen[name] += 1
                    recovered[name].append(max(0.0, device["last_recovery_s"] - OUT_S))
            fix = status["fix"]
            if fix["status"] == "fix" and fix["scan"] != last_scan:
                last_scan = fix["scan"]
                fixes += 1
                if self.sensor.is_wrong(fix):
                    wrong.append(fix)
            time.sleep(0.05)
        return recovered, fixes, wrong

    def test_every_device_comes_back_each_time(self):
        process = self.sensor.daemon.pid
        recovered, fixes, wrong = self.follow()
        for name, seconds in recovered.items():
            self.assertGreaterEqual(len(seconds), UNPLUGS, self.sensor.log())
            print(f"\n{name}: {len(seconds)} recoveries, s after the replug: min {min(seconds):.2f} median "
                  f"{statistics.median(seconds):.2f} worst {max(seconds):.2f}", end="", flush=True)
            self.assertLess(max(seconds), PATIENCE_S)
        print(f"\n{fixes} fixes, {len(wrong)} wrong", flush=True)
        self.assertEqual(wrong, [])
        self.assertGreater(fixes, UNPLUGS)
        self.assertEqual(self.sensor.daemon.pid, process)
        self.assertIsNone(self.sensor.daemon.poll())
        self.assertEqual(len(re.findall("slamsensord .* starts", self.sensor.log())), 1)
        self.sensor.wait_fix()
        self.sensor.stop_head()
        with (self.sensor.folder / "truth.events.csv").open() as file:
            pulled = [row["device"] for row in csv.DictReader(file) if row["fault"] == "cable_out"]
        for device, name in DEVICES.items():
            print(f"{name}: pulled {pulled.count(device)} times, recovered {len(recovered[name])} times", flush=True)
            self.assertEqual(pulled.count(device), UNPLUGS)
            self.assertGreaterEqual(len(recovered[name]), UNPLUGS)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
