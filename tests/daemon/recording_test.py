#!/usr/bin/env python3
"""A recording of the running daemon, with a kidnap and a pulled cable in it: its replay gives the fixes that were sent,
bit for bit. recording_test.py SLAMSENSOR SLAMSENSORD"""
import csv
import re
import shutil
import struct
import subprocess
import sys
import time
import unittest

from sensor import HERE, STOP_MAX_S, Refused, Sensor

PROGRAMS = sys.argv[1:3]
EVENT = struct.Struct(">IqqII")
SYNC = 0xEDA1DA01
POSE = struct.Struct(">Q 10q 4b 3d 9d 4q d 3q 2q d 9d")  # slamsensor.pose_t behind its fingerprint
STATUS = ("no_fix", "ambiguous", "fix")
FIX = 2
WITHDRAWN = (5, 6, 7, 8, 11)  # reasons: stale, device, moved, timing, no scan
LOCAL_MAP = 10
SKIPPED, OWN_NETWORK = 77, ("unshare", "-n")
UNPLUG_AT_S, OUT_S = 14.0, 0.7


def events(path):
    """(channel, data) of an LCM event log."""
    content = path.read_bytes()
    at = 0
    while at < len(content):
        sync, _, _, name, size = EVENT.unpack_from(content, at)
        assert sync == SYNC, f"no event at byte {at}"
        at += EVENT.size
        yield content[at:at + name].decode(), content[at + name:at + name + size]
        at += name + size


def sent_fixes(path, begun_ns):
    """The first message of each scan that ended after `begun_ns`, without those that withdraw a fix between two scans.
    A fix is sent again when the devices are back."""
    fixes = {}
    for channel, data in events(path):
        if channel == "SLAMSENSOR_POSE":
            fields = POSE.unpack(data)
            if fields[12] not in WITHDRAWN and fields[5] > begun_ns:  # reason, scan_end_monotonic_ns
                fixes.setdefault(fields[5], fields)
    return list(fixes.values())


def row_of(fields):
    """What fixes.csv says of a message, as far as both say it."""
    status = STATUS[fields[11]]
    row = {"status": status, "matches": str(fields[28]), "landmarks_seen": str(fields[29]),
           "landmarks_in_map": str(fields[30]), "jumps": str(fields[34]), "weight_best": str(fields[32]),
           "map": str(fields[35]), "home": str(fields[36])}
    if status != "no_fix" or fields[12] == LOCAL_MAP:
        row |= {"x_m": f"{fields[15]:.6f}", "y_m": f"{fields[16]:.6f}", "heading_rad": f"{fields[17]:.9f}",
                "error_xi": str(fields[27]), "protection_radius_m": f"{fields[37]:.6f}"}
    return row


class Recorded(unittest.TestCase):
    def setUp(self):
        self.sensor = Sensor(PROGRAMS, settings={"lcm.enabled": "true"})
        self.addCleanup(self.sensor.close)
        world = (HERE / "../../config/worlds/park.toml").resolve()
        scenario = self.sensor.folder / "recorded.toml"
        scenario.write_text((HERE / "park.toml").read_text().replace("../../config/worlds/park.toml", str(world)) +
                            f'\n[[fault]]\ndevice = "rangefinder"\nkind = "cable_out"\nat_s = {UNPLUG_AT_S}\n'
                            f'duration_s = {OUT_S}\n\n[[fault]]\ndevice = "ptu"\nkind = "cable_out"\n'
                            f"at_s = {UNPLUG_AT_S + 8}\nduration_s = {OUT_S}\n")
        self.sensor.scenario = scenario
        self.sensor.start_head()
        # In a network of its own, without a route: a recording hears what would have been sent.
        self.sensor.start(prefix=OWN_NETWORK)
        self.sensor.wait_fix()

    def record(self, name):
        self.assertIn("recording to", self.sensor.ask(f"record start {name}")[1])
        self.begun_ns = time.monotonic_ns()

    def replay(self, recording):
        out = self.sensor.folder / "replayed"
        done = subprocess.run([PROGRAMS[0], "replay", str(recording), "--out", str(out)], capture_output=True,
                              text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr + done.stdout)
        with (out / "fixes.csv").open() as file:
            return list(csv.DictReader(file)), (out / "trajectory.tum").read_text().split("\n")[:-1], done.stdout

    def live_run(self):
        """Scans at several stands, among them a kidnap, until both cables have been out and in again."""
        sensor = self.sensor
        sensor.wait_scans(2)
        for _ in range(len(sensor.stands) - 1):
            sensor.next_stand()
            sensor.wait_scans(2)
        sensor.wait_status(lambda s: all(d["recoveries"] > 0 for d in s["devices"].values()), "both recoveries")
        sensor.wait_scans(2)

    def check_replay(self, recording):
        """Its replay says what was sent; how many fixes were sent."""
        sent = sent_fixes(recording, self.begun_ns)
        rows, trajectory, output = self.replay(recording)
        alike = re.search(r"as recorded\s+(\d+) of (\d+) fixes, bit for bit", output)
        self.assertIsNotNone(alike, output)
        print(f"\n{len(sent)} fixes sent, {len(rows)} scans replayed, {alike.group(0)}", end="", flush=True)
        self.assertEqual([int(count) for count in alike.groups()], [len(sent)] * 2, output)
        self.assertEqual(len(rows), len(sent), output)
        for fields, row in zip(sent, rows):
            expected = row_of(fields)
            self.assertEqual({key: row[key] for key in expected}, expected)
        self.assertEqual(len(trajectory), sum(fields[11] == FIX for fields in sent))
        return len(sent)

    def test_replay_gives_what_was_sent(self):
        sensor = self.sensor
        with self.assertRaises(Refused):
            sensor.ask("record stop")
        self.record("walk")
        self.assertTrue(sensor.wait_status(lambda s: s["recording"], "recording"))
        with self.assertRaises(Refused):
            sensor.ask("record start again")
        self.live_run()
        self.assertIn("walk.lcm", sensor.ask("record status")[1])
        self.assertNotIn("not whole", sensor.ask("record stop")[1])
        sensor.wait_scans()
        self.assertFalse(sensor.status()["recording"])
        self.assertGreaterEqual(self.check_replay(sensor.recordings / "walk.lcm"), 2 * len(sensor.stands))

    def test_a_map_that_was_frozen_by_request_is_replayed_so(self):
        self.sensor.ask("map freeze")
        self.record("frozen")
        self.sensor.next_stand()
        self.sensor.wait_scans(3)
        self.sensor.ask("map unfreeze")
        self.sensor.wait_scans(3)
        self.sensor.ask("record stop")
        self.check_replay(self.sensor.recordings / "frozen.lcm")

    def test_an_end_of_the_daemon_ends_the_recording(self):
        self.record("ended")
        self.sensor.wait_scans(2)
        status, seconds = self.sensor.terminate()
        self.assertEqual(status, 0, self.sensor.log())
        self.assertLess(seconds, STOP_MAX_S)
        self.assertIn("is complete", self.sensor.log())
        self.check_replay(self.sensor.recordings / "ended.lcm")


if __name__ == "__main__":
    if not shutil.which("unshare") or subprocess.run([*OWN_NETWORK, "true"], capture_output=True).returncode:
        print("SKIPPED: no right to a network of its own; run as root")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
