#!/usr/bin/env python3
"""The power fails while the map is saved, again and again: after each cut the old or the new map is there, and the daemon
finds itself in it. The store lies on an ext4 of its own, whose shutdown without flushing its journal (the ioctl that file
systems are tested with) leaves on the disk what a machine stopped dead leaves there; then it is mounted anew, as at boot.
power_cut_test.py SLAMSENSOR SLAMSENSORD. SLAMSENSOR_POWER_CUTS: how often (50). Status 77: skipped, needs root, loop
devices and ext4."""
import fcntl
import os
import pathlib
import random
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest

from sensor import Refused, Sensor

PROGRAMS = sys.argv[1:3]
CUTS = int(os.environ.get("SLAMSENSOR_POWER_CUTS", "50"))
SKIPPED = 77
EXT4_IOC_SHUTDOWN, WITHOUT_LOG_FLUSH = 0x8004587D, 2
DISK_BYTES = 64 << 20


class Disk:
    """An ext4 in a file, mounted at a folder."""

    def __init__(self, folder):
        self.image, self.mount_point = folder / "disk", folder / "maps"
        self.mount_point.mkdir()
        with self.image.open("wb") as image:
            image.truncate(DISK_BYTES)
        subprocess.run(["mkfs.ext4", "-q", str(self.image)], check=True, capture_output=True)

    def mount(self):
        subprocess.run(["mount", "-o", "loop", str(self.image), str(self.mount_point)], check=True, capture_output=True)

    def unmount(self):
        subprocess.run(["umount", "-l", str(self.mount_point)], check=True, capture_output=True)

    def cut_power(self):
        folder = os.open(self.mount_point, os.O_RDONLY)
        fcntl.ioctl(folder, EXT4_IOC_SHUTDOWN, struct.pack("I", WITHOUT_LOG_FLUSH))
        os.close(folder)


def enter_own_mounts():
    """Starts this program again where its mounts end with it."""
    if os.geteuid() != 0 or os.environ.get("IN_OWN_MOUNTS"):
        return
    os.environ["IN_OWN_MOUNTS"] = "tried"
    if subprocess.run(["unshare", "-m", "true"], capture_output=True).returncode == 0:
        os.execvp("unshare", ["unshare", "-m", sys.executable, "-B", *sys.argv])


def has_disks():
    with tempfile.TemporaryDirectory() as folder:
        try:
            disk = Disk(pathlib.Path(folder))
            disk.mount()
            disk.unmount()
        except (OSError, subprocess.CalledProcessError):
            return False
    return True


class PowerCuts(unittest.TestCase):
    def setUp(self):
        self.sensor = Sensor(PROGRAMS, settings={"map.autosave_s": 0.1})
        self.addCleanup(self.sensor.close)
        self.disk = Disk(self.sensor.folder)
        self.disk.mount()
        self.addCleanup(self.disk.unmount)
        self.sensor.start_head()

    def save_until(self, over):
        """Saves as fast as the daemon does it; how many were done."""
        saves = 0
        while not over.is_set():
            try:
                self.sensor.ask("map save")
                saves += 1
            except (Refused, ConnectionError, OSError):
                break
        return saves

    def save_and_cut(self):
        over, saves = threading.Event(), []
        saver = threading.Thread(target=lambda: saves.append(self.save_until(over)))
        saver.start()
        time.sleep(random.uniform(0.0, 0.4))
        self.disk.cut_power()
        over.set()
        saver.join()
        self.sensor.kill()
        self.disk.unmount()
        self.disk.mount()
        return saves[0]

    def test_old_or_new_map_never_none(self):
        self.sensor.start()
        self.sensor.wait_fix()
        self.sensor.ask("map save")
        saves, previous, fixes = 0, 0, 0
        for cut in range(CUTS):
            saves += self.save_and_cut()
            self.sensor.log_path.write_text("")
            self.sensor.start()
            status = self.sensor.wait_status(lambda s: s["slam"]["scans"] > 0, "a scan")
            previous += "the previous generation" in self.sensor.log()
            self.assertEqual(status["fix"]["status"], "fix", f"cut {cut}: {self.sensor.log()}")
            self.assertGreater(status["fix"]["matches"], 5, f"cut {cut}: a map begun anew; {self.sensor.log()}")
            self.assertFalse(self.sensor.is_wrong(status["fix"]), status["fix"])
            fixes += 1
        print(f"\n{fixes} of {CUTS} power cuts left a map in which the first scan found itself ({saves} saves were "
              f"done before the cuts, {previous} times the previous generation was loaded)")
        self.assertEqual(fixes, CUTS)


if __name__ == "__main__":
    enter_own_mounts()
    if os.geteuid() != 0 or not has_disks():
        print("SKIPPED: needs root, loop devices and ext4 (mkfs.ext4)")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
