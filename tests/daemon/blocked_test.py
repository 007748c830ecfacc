#!/usr/bin/env python3
"""A head whose axes are blocked while both devices answer: every output says so at once, with the device, what was
asked, what was seen and what to do, and stops saying so when the head moves again. Prints what each output said, word for
word. blocked_test.py SLAMSENSOR SLAMSENSORD; status 77 where multicast cannot be had."""
import os
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import nmea
from sensor import HERE, Sensor, free_port, wait_for

PROGRAMS = sys.argv[1:3]
SKIPPED = 77
OWN_NETWORK = "IN_OWN_NETWORK"
GROUP, PORT = "239.255.76.67", 7667
BLOCKED_AT_S, BLOCKED_FOR_S = 20.0, 25.0  # from the head's start on; a fix takes a few seconds
TOLD_MAX_S = 20.0                          # on a busy machine; two moves with their margins take 6
# What a person is told: device, what was asked, what was seen, what to do.
TOLD = re.compile(r"pan-tilt unit: (it was lost in the scan, \d+ times in a row: )?(pan|tilt) was sent from -?[\d.]+ to "
                  r"-?[\d.]+ deg and (has not moved|stands at -?[\d.]+ deg|was seen last at -?[\d.]+ deg) after [\d.]+ s"
                  r"(, \d+ times in a row)?; check what blocks it, its .*supply, its cable")
STATE_FAULTED, REASON_DEVICE = 6, 6


def enter_own_network():
    """As root, starts this program again where nothing else is on the network."""
    if os.environ.get(OWN_NETWORK) or os.geteuid() != 0 or not shutil.which("unshare") or not shutil.which("ip"):
        return
    os.environ[OWN_NETWORK] = "tried"
    setup = 'ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo && exec "$@"'
    if subprocess.run(["unshare", "-n", "true"], capture_output=True).returncode == 0:
        os.execvp("unshare", ["unshare", "-n", "sh", "-c", setup, "sh", sys.executable, "-B", *sys.argv])


class LcmReader:
    """Status and pose as they come over the network: (state, problem) and (status, reason)."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.bind((GROUP, PORT))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               struct.pack("4s4s", socket.inet_aton(GROUP), socket.inet_aton("127.0.0.1")))
        self.socket.settimeout(0.05)
        self.status = self.pose = None

    def listen(self):
        try:
            while True:
                self._take(self.socket.recv(65536))
        except TimeoutError:
            return self

    def _take(self, packet):
        channel, _, message = packet[8:].partition(b"\0")
        if channel == b"SLAMSENSOR_STATUS":
            state = message[8 + 4 * 8]
            begin = 8 + 4 * 8 + 7 + 16  # state, source, five booleans, phase
            self.status = state, message[begin:begin + 192].rstrip(b"\0").decode("ascii")
        elif channel == b"SLAMSENSOR_POSE":
            self.pose = message[8 + 10 * 8], message[8 + 10 * 8 + 1]

    def close(self):
        self.socket.close()


class Blocked(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        scenario = pathlib.Path(folder.name) / "blocked.toml"
        text = (HERE / "park.toml").read_text().replace("../../config", str((HERE / "../../config").resolve()))
        scenario.write_text(text + f'\n[[fault]]\ndevice = "ptu"\nkind = "blocked"\nat_s = {BLOCKED_AT_S}\n'
                                   f'duration_s = {BLOCKED_FOR_S}\n')
        self.port = free_port()
        self.sensor = Sensor(PROGRAMS, scenario, {"nmea.tcp": "true", "nmea.tcp_port": self.port, "lcm.enabled": "true",
                                                  "lcm.url": f"udpm://{GROUP}:{PORT}?ttl=0"})
        self.addCleanup(self.sensor.close)

    def told_by_every_output(self, reader, lcm):
        """What each output says, by the output's name; none until all of them tell of it."""
        status = self.sensor.status()
        lcm.listen()
        pslma = reader.of_kind("PSLMA")
        told = {
            "ctl status, state": next(line for line in self.sensor.ask("status")[0] if line.startswith("state:")),
            "ctl status, fix": next(line for line in self.sensor.ask("status")[0] if line.startswith("fix:")),
            "ctl status, scan": next(line for line in self.sensor.ask("status")[0] if line.startswith("scan:")),
            "ctl status json": f"state {status['state']}, reason {status['fix']['reason']}, problem {status['head']['problem']}",
            "NMEA PSLMA": ",".join(pslma),
            "NMEA RMC": ",".join(reader.of_kind("RMC")),
            "LCM status": f"state {lcm.status[0]}, problem {lcm.status[1]}" if lcm.status else "",
            "LCM pose": f"status {lcm.pose[0]}, reason {lcm.pose[1]}" if lcm.pose else "",
            "STATUS=": self.sensor.manager.last("STATUS="),
            "log": next((line for line in self.sensor.log().splitlines() if "no scan comes about" in line), ""),
        }
        texts = (told["ctl status, scan"], status["head"]["problem"], lcm.status and lcm.status[1], told["STATUS="], told["log"])
        complete = (all(text and TOLD.search(text) for text in texts) and status["state"] == "faulted"
                    and status["fix"]["reason"] == "device" and pslma[3] == "V" and pslma[5] == str(REASON_DEVICE)
                    and lcm.status[0] == STATE_FAULTED and lcm.pose == (0, REASON_DEVICE)
                    and "faulted" in told["ctl status, state"])
        return told if complete else None

    def test_every_output_tells_of_blocked_axes_and_of_their_end(self):
        self.sensor.start_head()
        begun = time.monotonic()
        self.sensor.start()
        self.sensor.wait_fix()
        lcm = LcmReader()
        self.addCleanup(lcm.close)
        self.assertLess(time.monotonic(), begun + BLOCKED_AT_S, "the machine is too slow for this test")
        while time.monotonic() < begun + BLOCKED_AT_S:
            lcm.listen()
        faulted = self.sensor.wait_status(lambda s: lcm.listen() and s["state"] == "faulted", "the blocked axes", TOLD_MAX_S)
        first_s = time.monotonic() - begun - BLOCKED_AT_S
        self.assertEqual(faulted["fix"]["status"], "no_fix")
        reader = nmea.Reader.tcp(self.port)
        self.addCleanup(reader.close)
        told = wait_for(lambda: self.told_by_every_output(reader, lcm), lambda: "every output to tell; the log:\n" + self.sensor.log(),
                        TOLD_MAX_S)
        print(f"\nno fix any more {first_s:.1f} s after the axes were blocked; all outputs told after "
              f"{time.monotonic() - begun - BLOCKED_AT_S:.1f} s:")
        for output, text in told.items():
            print(f"  {output:18} {text}")
        self.assertNotIn("looks like the map", self.sensor.log(), "no scan was held against a map")
        self.sensor.wait_status(lambda s: s["state"] == "fixed", "a fix after the axes are free",
                                BLOCKED_FOR_S + 30.0)
        self.assertEqual(self.sensor.status()["head"]["problem"], "")
        wait_for(lambda: "scans come about again" in self.sensor.log(), "the log to say so")
        self.assertLess(self.sensor.log().count("no scan comes about"), 3, "a flood in the log")


if __name__ == "__main__":
    enter_own_network()
    try:
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM).connect((GROUP, PORT))
    except OSError as error:
        print(f"SKIPPED: no route for multicast ({error}); run as root, or: ip route add 224.0.0.0/4 dev lo")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
