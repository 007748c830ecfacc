#!/usr/bin/env python3
"""The daemon where something is missing or broken: it says so, keeps its outputs alive, and recovers by itself; or it
does not start, and says why. degraded_test.py SLAMSENSOR SLAMSENSORD"""
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

import nmea
from sensor import HERE, STOP_MAX_S, Control, Sensor, free_port, wait_for

PROGRAMS = sys.argv[1:3]
# Succeeds where neither memory can be locked nor a priority taken.
HAS_NO_RIGHTS = """
import ctypes, os, sys
try:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
except PermissionError:
    sys.exit(ctypes.CDLL(None).mlockall(3) == 0)
sys.exit(1)
"""
# A sanitizer's mlockall() does nothing, and says that it did.
MEMORY_TOLD = [] if os.environ.get("SLAMSENSOR_SANITIZED") else ["memory cannot be locked"]
OK, USAGE, UNAVAILABLE, OSERR, NOPERM, CONFIG = 0, 64, 69, 71, 77, 78


def able(*command):
    return shutil.which(command[0]) and subprocess.run(command, capture_output=True).returncode == 0


class Degraded(unittest.TestCase):
    def setUp(self):
        self.sensor = Sensor(PROGRAMS)
        self.addCleanup(self.sensor.close)

    def ends(self, expected=OK):
        status, seconds = self.sensor.terminate()
        self.assertEqual(status, expected, self.sensor.log())
        self.assertLess(seconds, STOP_MAX_S)

    def refuses(self, expected, *parts, **options):
        status, log = self.sensor.run_to_end(**options)
        self.assertEqual(status, expected, log)
        for part in parts:
            self.assertIn(part, log)
        self.assertIn(" error: ", log)
        return log

    # Memory.

    def locks_at_most(self, mebibytes, landmarks):
        self.sensor.start({"capacities.map_landmarks": landmarks, "capacities.map_edges": 12 * landmarks,
                           "capacities.sightings": 10 * landmarks, "mapping.hypotheses_max": 3})
        self.sensor.wait_status(lambda s: s["devices"]["pan_tilt"]["problem"], "a problem")
        text = pathlib.Path(f"/proc/{self.sensor.daemon.pid}/status").read_text()
        locked, resident = (int(re.search(rf"{key}:\s+(\d+) kB", text)[1]) / 1024 for key in ("VmLck", "VmHWM"))
        self.ends()
        if locked == 0:
            self.skipTest("memory cannot be locked here")
        self.assertLess(locked, mebibytes)
        self.assertLess(resident, mebibytes)

    @unittest.skipIf("SLAMSENSOR_SANITIZED" in os.environ, "a sanitizer takes more than the program")
    def test_a_map_of_10_000_landmarks_and_3_hypotheses_locks_64_mebibytes(self):
        self.locks_at_most(64, 10_000)

    @unittest.skipIf("SLAMSENSOR_SANITIZED" in os.environ, "a sanitizer takes more than the program")
    def test_a_map_of_100_000_landmarks_locks_128_mebibytes(self):
        self.locks_at_most(128, 100_000)

    # Devices.

    def test_without_devices_it_waits_and_its_outputs_live(self):
        port = free_port()
        self.sensor.start({"nmea.tcp": "true", "nmea.tcp_port": port})
        status = self.sensor.wait_status(lambda s: s["devices"]["pan_tilt"]["problem"], "a problem")
        self.assertEqual(status["state"], "starting")
        self.assertEqual(status["fix"]["status"], "no_fix")
        reader = nmea.Reader.tcp(port)
        self.addCleanup(reader.close)
        self.assertEqual(reader.of_kind("RMC")[2], "V")
        self.assertEqual(reader.of_kind("PSLMA")[3], "V")
        manager = self.sensor.manager
        whole = "STATUS=starting, .*pan-tilt: serial port .*/ptu: open: No such file.*; rangefinder: serial port .*/finder: open: No "
        wait_for(lambda: re.match(whole, manager.last("STATUS=")),
                 lambda: "a status text, not " + manager.last("STATUS="))
        self.assertEqual(manager.times("READY=1"), [])
        self.assertTrue(manager.times("EXTEND_TIMEOUT_USEC="))
        self.sensor.start_head()
        self.sensor.wait_fix()
        wait_for(lambda: manager.times("READY=1"), "READY=1")
        wait_for(lambda: reader.of_kind("PSLMA")[3] == "A", "a fix in NMEA")
        self.ends()

    def test_a_head_that_is_pulled_and_put_back(self):
        self.sensor.start_head()
        self.sensor.start()
        self.sensor.wait_fix()
        self.sensor.stop_head()
        lost = self.sensor.wait_status(lambda s: s["state"] == "faulted", "the loss", 3.0)
        self.assertEqual((lost["fix"]["status"], lost["fix"]["reason"]), ("no_fix", "device"))
        wait_for(lambda: "rangefinder lost" in self.sensor.log(), "the loss to be told")
        self.sensor.start_head()
        self.sensor.wait_scans()
        status = self.sensor.wait_fix()
        self.assertFalse(self.sensor.is_wrong(status["fix"]))
        self.assertGreater(status["fix"]["matches"], 5)
        for device in status["devices"].values():
            self.assertGreaterEqual(device["recoveries"], 1)
        self.ends()

    def test_a_short_loss_is_told_with_its_reason(self):
        with tempfile.TemporaryDirectory() as folder:
            scenario = pathlib.Path(folder) / "short.toml"
            world = (HERE / "../../config/worlds/park.toml").resolve()
            scenario.write_text((HERE / "park.toml").read_text().replace("../../config/worlds/park.toml", str(world)) +
                                '\n[[fault_rate]]\ndevice = "rangefinder"\nkind = "cable_out"\nrhythm = "regular"\n'
                                "mean_gap_s = 6.0\nfrom_s = 6.0\nuntil_s = 13.0\nduration_s = 0.1\n")
            self.sensor.scenario = scenario
            self.sensor.start_head()
            self.sensor.start()
            status = self.sensor.wait_status(lambda s: s["devices"]["rangefinder"]["recoveries"] > 0, "a recovery")
            self.assertRegex(status["devices"]["rangefinder"]["last_loss"], "serial port .*/finder: hung up")
            wait_for(lambda: "rangefinder recovered" in self.sensor.log(), "the recovery to be told")
            self.assertRegex(self.sensor.log(), "warning: rangefinder lost: serial port .*/finder: hung up")
            self.assertRegex("\n".join(self.sensor.ask("devices")[0]), "last lost: serial port .*/finder: hung up")
            self.ends()

    # Configurations of a former version.

    def test_keys_of_a_former_version_are_named_and_keep_nobody_from_starting(self):
        former = self.sensor.config.read_text() + "\n[pan_fit]\npolls_min = 4\n"
        line = former[:former.index("polls_min")].count("\n") + 1
        told = f"sensor.toml:{line}:1: pan_fit.polls_min: has no effect any more; remove it"
        self.sensor.config.write_text(former)
        checked = subprocess.run([PROGRAMS[0], "check-config", self.sensor.config], capture_output=True, text=True)
        self.assertEqual(checked.returncode, OK, checked.stderr)
        self.assertEqual(checked.stderr.count(told), 1, checked.stderr)
        self.assertIn("nmea.rate_hz", checked.stdout)
        self.sensor.start_head()
        self.sensor.start()
        self.sensor.wait_fix()
        self.assertRegex(self.sensor.log(), f" warning: .*{re.escape(told)}")
        self.assertEqual(self.sensor.log().count(told), 1, self.sensor.log())
        self.assertIn(told, "\n".join(self.sensor.ask("config reload")[0]))
        self.assertEqual(self.sensor.log().count(told), 2, self.sensor.log())
        self.ends()
        self.sensor.config.write_text(former + "pols_min = 4\n")
        self.refuses(CONFIG, f"sensor.toml:{line + 1}:1: pan_fit.pols_min: unknown key")

    # The machine.

    def test_no_network(self):
        if not able("unshare", "-n", "true"):
            self.skipTest("SKIPPED: no right to a network of its own")
        self.sensor.start_head()
        self.sensor.start({"lcm.enabled": "true", "map.autosave_s": 1.0}, prefix=("unshare", "-n"))
        self.sensor.wait_fix()
        wait_for(lambda: (self.sensor.maps / "default.slammap").exists(), "the map to be saved")
        self.assertIn("no route for multicast", self.sensor.log())
        self.ends()

    def on_tmpfs(self, options, then="true"):
        """What starts a program whose map folder is a file system of its own; its path as seen from here."""
        if not able("unshare", "-m", "true"):
            self.skipTest("SKIPPED: no right to mount")
        self.sensor.maps.mkdir()
        script = f'mount -t tmpfs -o {options} tmpfs "$0" && {then} && exec "$@"'
        return ("unshare", "-m", "sh", "-c", script, str(self.sensor.maps))

    def test_a_full_disk(self):
        self.sensor.start_head()
        full = self.on_tmpfs("size=8k", 'head -c 8192 /dev/zero > "$0/ballast"')
        self.sensor.start({"map.autosave_s": 0.3}, prefix=full)
        self.sensor.wait_fix()
        wait_for(lambda: "No space left" in self.sensor.log(), "the full disk to be told")
        self.assertTrue(self.sensor.wait_scans()["map"]["unsaved"])
        maps = f"/proc/{self.sensor.daemon.pid}/root{self.sensor.maps}"
        os.unlink(f"{maps}/ballast")
        wait_for(lambda: os.path.exists(f"{maps}/default.slammap"), "the map to be saved after all")
        self.sensor.wait_status(lambda s: not s["map"]["unsaved"], "the status to say so")
        self.assertLess(self.sensor.log().count("No space left"), 10, "a flood in the log")
        self.ends()

    def test_a_map_folder_that_cannot_be_written(self):
        self.sensor.start_head()
        self.sensor.start({"map.autosave_s": 0.3}, prefix=self.on_tmpfs("size=8k,ro"))
        self.sensor.wait_fix()
        log = self.sensor.log()
        self.assertIn("Read-only file system", log)
        self.assertIn("running without saving", log)
        self.ends()

    def test_two_daemons_cannot_share_socket_or_maps(self):
        self.sensor.start_head()
        self.sensor.start()
        self.sensor.wait_fix()
        other = Sensor(PROGRAMS)
        self.addCleanup(other.close)
        status, log = other.run_to_end({"control.socket": self.sensor.folder / "control"})
        self.assertEqual(status, UNAVAILABLE, log)
        self.assertIn("another slamsensord answers there", log)
        other.log_path.write_text("")
        other.start({"map.directory": self.sensor.maps})
        other.status()
        self.assertIn("another process saves maps there", other.log())
        other.kill()
        self.sensor.wait_scans()
        self.ends()

    def test_a_taken_tcp_port_is_told_and_tried_again(self):
        with socket.socket() as taken:
            taken.bind(("127.0.0.1", 0))
            taken.listen()
            port = taken.getsockname()[1]
            self.sensor.start({"nmea.tcp": "true", "nmea.tcp_port": port})
            wait_for(lambda: "another program has this port" in self.sensor.log(), "the taken port to be told")

        def connected():
            try:
                return nmea.Reader.tcp(port)
            except ConnectionRefusedError:
                return None
        reader = wait_for(connected, "the port to be opened")
        self.addCleanup(reader.close)
        self.assertEqual(reader.of_kind("RMC")[2], "V")
        self.ends()

    def test_a_client_beyond_the_limit_is_told_in_the_log(self):
        port = free_port()
        self.sensor.start({"nmea.tcp": "true", "nmea.tcp_port": port})
        self.sensor.ask("version")
        for _ in range(8):
            reader = wait_for(lambda: nmea.Reader.tcp(port), "a client to be taken in")
            self.addCleanup(reader.close)
            self.assertEqual(reader.of_kind("RMC")[2], "V")
        told = "clients? (was|were) refused, 8 of at most 8 are connected; end one of them, or connect gpsd"
        for _ in range(3):
            late = nmea.Reader.tcp(port)
            self.addCleanup(late.close)
            wait_for(lambda: re.search(told, self.sensor.log()), "the refusal to be told")
        self.assertEqual(len(re.findall(told, self.sensor.log())), 1, self.sensor.log())
        self.assertNotIn("NMEA output goes on", self.sensor.log())
        self.ends()

    def test_a_control_socket_that_is_removed_is_made_again(self):
        self.sensor.start()
        self.sensor.ask("version")
        (self.sensor.folder / "control").unlink()
        wait_for((self.sensor.folder / "control").exists, "the socket")
        self.sensor.ask("version")  # the connection from before
        other = Control(self.sensor.folder / "control")
        self.addCleanup(other.close)
        other.ask("version")
        self.assertIn("its file was gone and is made again", self.sensor.log())
        self.ends()

    # The map at start.

    def test_a_map_that_is_too_large_for_the_capacities_is_not_called_bad(self):
        self.sensor.maps.mkdir()
        trees = self.sensor.folder / "trees.csv"
        trees.write_text("x_m,y_m\n" + "".join(f"{5 * (i % 10)},{7 * (i // 10)}\n" for i in range(80)))
        subprocess.run([PROGRAMS[0], "map", "import", trees, "--out", "plot", "--store", self.sensor.maps],
                       check=True, capture_output=True)
        self.sensor.start({"capacities.map_landmarks": 50})
        lines, _ = self.sensor.ask("map list")
        self.assertIn("plot: too large for the configured capacities", lines)
        self.assertIn("raise capacities.map_landmarks to 80", "\n".join(lines))
        self.ends()

    def test_a_damaged_map_is_left_alone_until_a_save_sets_it_aside(self):
        self.sensor.maps.mkdir()
        damaged = b"\x89SLM\r\n\x1a\n" + bytes(100)
        (self.sensor.maps / "default.slammap").write_bytes(damaged)
        self.sensor.start_head()
        self.sensor.start({"map.autosave_s": 0})
        self.sensor.wait_fix()
        self.assertIn("starting without it", self.sensor.log())
        self.assertEqual((self.sensor.maps / "default.slammap").read_bytes(), damaged)
        self.sensor.ask("map save")
        aside = list(self.sensor.maps.glob("default.slammap.bad-*"))
        self.assertEqual([path.read_bytes() for path in aside], [damaged])
        self.assertIn("set aside", self.sensor.log())
        self.ends()

    # Rights.

    def without_rights(self):
        taken = "-sys_nice,-ipc_lock"
        limited = ("setpriv", "--inh-caps", taken, "--ambient-caps", taken)
        if os.geteuid() == 0:
            limited += ("--bounding-set", taken)
        limited += ("prlimit", "--rtprio=0", "--memlock=65536")
        if not able(*limited, sys.executable, "-c", HAS_NO_RIGHTS):
            self.skipTest("SKIPPED: setpriv and prlimit cannot take rights away here")
        return limited

    def test_without_real_time_rights_it_runs_and_says_so(self):
        self.sensor.start_head()
        self.sensor.start({"realtime.mode": "optional"}, prefix=self.without_rights())
        self.assertFalse(self.sensor.wait_fix()["realtime"])
        log = self.sensor.log()
        for part in ("no right to SCHED_FIFO", "running without real-time rights", *MEMORY_TOLD):
            self.assertIn(part, log)
        self.ends()

    def test_required_real_time_is_refused_without_rights(self):
        limit = "LimitMEMLOCK" if MEMORY_TOLD else "LimitRTPRIO"
        self.refuses(NOPERM, limit, settings={"realtime.mode": "required"}, prefix=self.without_rights())

    def test_wrong_words_on_the_command_line(self):
        for words in (["--fly"], ["--set", "nmea.rate_hz"], ["surplus"]):
            done = subprocess.run([PROGRAMS[1], *words], capture_output=True, text=True, timeout=30)
            self.assertEqual(done.returncode, USAGE, done.stderr)
            self.assertIn("slamsensord", done.stderr)

    # What it shares the machine with.

    def test_a_log_that_nobody_reads_stops_nothing(self):
        os.mkfifo(self.sensor.log_path)
        reader = os.open(self.sensor.log_path, os.O_RDONLY | os.O_NONBLOCK)
        writer = os.open(self.sensor.log_path, os.O_WRONLY | os.O_NONBLOCK)
        self.addCleanup(os.close, writer)
        self.addCleanup(os.close, reader)
        try:
            while os.write(writer, bytes(4096)):
                pass
        except BlockingIOError:
            pass
        self.sensor.start_head()
        self.sensor.start()
        self.sensor.wait_scans()
        lost = next(line for line in self.sensor.ask("counters")[0] if "log_lines_lost" in line)
        self.assertGreater(int(re.findall(r"\d+", lost)[-1]), 0)
        status, seconds = self.sensor.terminate()
        self.assertEqual(status, OK)
        self.assertLess(seconds, STOP_MAX_S)

    def test_a_reload_waits_for_no_pipe(self):
        self.sensor.start()
        self.sensor.ask("version")
        self.sensor.config.unlink()
        os.mkfifo(self.sensor.config)
        self.sensor.daemon.send_signal(signal.SIGHUP)
        wait_for(lambda: "is not read again" in self.sensor.log(), "the reload to be refused")
        self.assertIn("is a pipe or a socket", self.sensor.log())
        self.sensor.ask("version")
        self.ends()

    def test_a_signal_that_means_nothing_ends_nothing(self):
        self.sensor.start_head()
        self.sensor.start({"map.autosave_s": 3600})
        self.sensor.ask("version")
        for number in (signal.SIGUSR2, signal.SIGALRM, signal.SIGRTMIN):
            self.sensor.daemon.send_signal(number)
        self.sensor.wait_fix()
        self.sensor.daemon.send_signal(signal.SIGQUIT)
        self.assertEqual(self.sensor.daemon.wait(30), OK, self.sensor.log())
        self.assertTrue((self.sensor.maps / "default.slammap").exists(), "no last save: " + self.sensor.log())

    def test_too_few_descriptors_are_refused(self):
        if not able("prlimit", "--nofile=20:20", "true"):
            self.skipTest("SKIPPED: prlimit is not here")
        self.refuses(OSERR, "only 20 files may be open", "LimitNOFILE=", prefix=("prlimit", "--nofile=20:20"))

    def test_too_little_memory_is_refused(self):
        limited = ("prlimit", "--as=30000000")
        if os.environ.get("SLAMSENSOR_SANITIZED") or not able(*limited, "true"):
            self.skipTest("SKIPPED: prlimit is not here, or a sanitizer takes the memory")
        self.refuses(OSERR, "out of memory", "[capacities]", prefix=limited)

    def test_a_stop_while_it_starts(self):
        self.sensor.start_head()
        for _ in range(3):
            self.sensor.start()
            wait_for(lambda: "running" in self.sensor.log(), "the start")
            self.sensor.log_path.write_text("")
            self.ends()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
