"""Every command of the README that needs neither hardware nor root is run here, as the README shows it, on an emulated sensor;
those that are not are named with the reason. Usage: commands_test.py SLAMSENSOR SLAMSENSORD SOURCE_TREE"""
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

from readme import Readme

PROGRAM, DAEMON, TREE = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
BUILD = pathlib.Path(PROGRAM).resolve().parent
sys.path[:0] = [str(TREE / "tests" / "daemon")]
from sensor import Sensor, wait_for  # noqa: E402

README = Readme(TREE)
GROUP = "239.255.76.69"
PATIENCE_S = 60.0
DATUM = {"datum.latitude_deg": 48.0, "datum.longitude_deg": 11.0, "datum.height_m": 500.0, "datum.bearing_deg": 90.0}

# What runs each command (a test below), or why none does.
ACCOUNT = [
    (r"tools/demo$|tools/test$", "not here: the test `demo` runs the one, and the other runs this test"),
    (r"--view$|--fast$", "test_scripts_say_how_they_are_called"),
    (r"gpsd -n -b|cgps|gpspipe", "test_gpsd_reads_it"),
    (r"tools/examples/read_pose\.py|tcp://HOST|read_pose\.sh|plan_path\.py", "test_examples_that_need_nothing"),
    (r"tools/examples/read_pose\.cpp|read_pose\.c$", "test_examples_are_built_by_their_first_lines"),
    (r"slamsensor view|view RECORDING", "test_the_page"),
    (r"slamsensor top", "test_top"),
    (r"tools/setup run && tools/preset release && sudo cmake --install", "test_it_installs"),
    (r"sudo systemd-|sudoedit|systemctl|journalctl|ip link|ip route", "not here: it changes the machine; tests/system runs it in a guest"),
    (r"slamsensor check-config", "test_check_config"),
    (r"tools/setup packages|tests/system|tools/setup arm64|tools/setup$", "test_scripts_say_how_they_are_called"),
    (r"slamsensor ctl|ctl map load|ctl record|map reset|datum set|config reload", "test_requests_of_the_daemon"),
    (r"slamsensor map import|map import|map export", "test_a_survey_becomes_a_map"),
    (r"slamsensor replay|eval|report$|figure$|edges$|spiderweb|scanline$|correspondences", "test_scans_are_replayed_judged_and_drawn"),
    (r"build/release/tests|tests/comparison/run|tests/bench/run|tests/bench/soak/soak", "test_programs_that_measure_are_there"),
    (r"man slamsensor", "test_manual_pages"),
]
COMMAND = re.compile(r"^(?:sudo |SLAMSENSOR_DATA=\S+ )?(?:slamsensor (?!-)|tools/(?:demo|test|setup|preset|examples/)|tests/(?:system|comparison/run|bench/)|"
                     r"build/release/tests|gpsd -|cgps$|gpspipe|read_pose|plan_path|man |systemctl|journalctl|ip (?:link|route)|sudoedit|ctl |map (?:import|export|reset))")


def run(*command, patience_s=PATIENCE_S, **more):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=patience_s, **more)
    return done.returncode, done.stdout, done.stderr


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def multicast_works():
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(GROUP) + bytes(4))
        return True
    except OSError:
        return False


class Accounted(unittest.TestCase):
    def test_every_command_is_run_or_has_its_reason(self):
        commands = [line for title in ("Two commands", "Plug it in", "The daemon") for line in README.indented(title)]
        commands += [quoted for quoted in README.quoted() if COMMAND.match(quoted)]
        self.assertGreater(len(commands), 35)
        tests = {name for case in (Accounted, Scans, Live) for name in dir(case)}
        for command in commands:
            found = [by for pattern, by in ACCOUNT if re.search(pattern, command)]
            self.assertTrue(found, f"nothing runs {command!r}")
            self.assertTrue(found[0].startswith("not here: ") or found[0] in tests, found[0])


class Scans(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)

    def done(self, *command, **more):
        status, output, errors = run(*command, **more)
        self.assertEqual(status, 0, f"{command}: {errors}")
        return output

    def test_scripts_say_how_they_are_called(self):
        for script in ("tools/setup", "tools/demo", "tools/test", "tools/preset", "tests/system/packages", "tests/system/arm64"):
            path = TREE / script
            self.assertTrue(os.access(path, os.X_OK), script)
            self.assertEqual(run("bash", "-n", path)[0], 0, script)
        for script in ("tools/setup", "tools/demo", "tools/test"):
            status, _, errors = run(TREE / script, "--no-such-thing", cwd=TREE)
            self.assertEqual((status, "usage" in errors), (64, True), script)
        for purpose in ("run", "packages", "arm64"):
            self.assertRegex((TREE / "tools/setup").read_text(), rf"(?m)^  {purpose}\) ", purpose)

    def test_the_demo_stays_for_other_programs(self):
        self.assertIn("`--stay`", README.text)
        demo = subprocess.Popen([TREE / "tools/demo", "--stay", BUILD], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=TREE)
        self.addCleanup(demo.stdout.close)
        self.addCleanup(demo.wait)
        self.addCleanup(demo.terminate)
        port = next(found[1] for line in demo.stdout if (found := re.search(r"read_pose\.py tcp://localhost:(\d+)", line)))
        self.assertRegex(next(demo.stdout), r"slamsensor view --socket \S+/control$")
        reader = subprocess.Popen([TREE / "tools/examples/read_pose.py", f"tcp://localhost:{port}"], stdout=subprocess.PIPE, text=True)
        self.addCleanup(reader.stdout.close)
        self.addCleanup(reader.wait)
        self.addCleanup(reader.kill)
        places = set()
        for line in reader.stdout:  # until it was seen at two places
            if " fix " in line:
                places.add(round(float(line.split()[2])))
            if len(places) == 2:
                break
        self.assertEqual(len(places), 2)
        self.assertIsNone(demo.poll())

    def test_it_installs(self):
        self.done("cmake", "--install", BUILD, env={**os.environ, "DESTDIR": str(self.folder)}, patience_s=300)
        installed = {path.name for path in self.folder.rglob("*") if path.is_file()}
        for name in ("slamsensor", "slamsensord", "slamsensor.toml", "99-slamsensor.rules", "slamsensor.service", "slamsensor-view.service",
                     "slamsensor-multicast-route.service", "emulated.conf", "head-ptu-tf03.toml"):
            self.assertIn(name, installed)
        for page in (TREE / "tools/man").glob("*.[1-9]"):
            self.assertTrue(page.name in installed or page.name + ".gz" in installed, page.name)
        program = next(path for path in self.folder.rglob("slamsensor") if path.is_file() and os.access(path, os.X_OK))
        self.assertIn("slamsensor ", self.done(program, "--version"))

    def test_check_config(self):
        for profile in (TREE / "config").glob("*.toml"):
            self.done(PROGRAM, "check-config", "--config", profile)

    def test_a_survey_becomes_a_map(self):
        (self.folder / "trees.csv").write_text("id,x_m,y_m\n1,0,0\n2,7,1\n3,2,9\n4,-5,4\n")
        self.done(PROGRAM, "map", "import", "trees.csv", "--out", "plot3", "--store", self.folder, cwd=self.folder)
        for form in ("geojson", "csv"):
            self.assertIn("landmark", self.done(PROGRAM, "map", "export", "plot3", "--format", form, "--store", self.folder))
        for form in ("gpx", "kml"):
            self.assertIn("landmark", self.done(PROGRAM, "map", "export", "plot3", "--format", form, "--store", self.folder,
                                                "--datum", "48", "11", "500", "90"))

    def test_scans_are_replayed_judged_and_drawn(self):
        shown = next(q for q in README.quoted() if q.startswith("slamsensor replay "))
        scans, out = self.folder / "scans", self.folder / "out/run"
        self.done(PROGRAM, "simulate", TREE / "config/worlds/bush.toml", "--experiment", "3", "--scans", "3", "--out", scans, patience_s=300)
        words = shown.replace("config/experiment-1.toml", "config/experiment-3.toml").replace("truth.tum", str(scans / "truth.tum"))
        words = words.replace("out/run", str(out)).replace("INPUT...", str(scans)).split()
        told = self.done(PROGRAM, *words[1:], cwd=TREE, patience_s=300)
        for name in re.findall(r"`(hindsight\.tum)`", README.text) + ["map.csv", "track.nmea", "plot.svg"]:
            self.assertTrue((out / name).is_file(), name)
        self.assertIn("fixes", told)
        self.assertIn("wrong_fixes", json.loads(self.done(PROGRAM, "eval", "--truth", scans / "truth.tum", "--json", out / "trajectory.tum")))
        self.done(PROGRAM, "report", out, "--truth", scans / "truth.tum")
        profile = ("--config", TREE / "config/experiment-3.toml")
        for figure in ("spiderweb", "scanline", "correspondences"):
            self.assertIn(f"`{figure}`", README.text)
            self.done(PROGRAM, "figure", figure, *profile, "--out", self.folder / f"{figure}.svg", scans, patience_s=300)
        self.done(PROGRAM, "edges", "--points", "50", "--depth", "3", "--sets", "1", "--out", self.folder / "edges.svg")

    def test_programs_that_measure_are_there(self):
        for name in re.findall(r"build/release/(tests/\w+/\w+)", README.text):
            self.assertIn("\n  ", self.done(BUILD / name, "--gtest_list_tests"))
        for script in ("tests/comparison/run", "tests/bench/run", "tests/bench/soak/soak"):
            self.assertTrue(os.access(TREE / script, os.X_OK), script)

    def test_manual_pages(self):
        for page in re.findall(r"\bman (slamsensor[\w-]*)", README.text) + re.findall(r"\b(slamsensor[\w.]*)\(\d\)", README.text):
            self.assertTrue(list((TREE / "tools/man").glob(f"{page}.[1-9]")), page)

    def test_examples_are_built_by_their_first_lines(self):
        if shutil.which("lcm-gen") is None:
            self.skipTest("lcm-gen (liblcm-bin) is not installed: tools/setup test")
        for name in ("read_pose.cpp", "read_pose.c"):
            folder = self.folder / name
            folder.mkdir()
            shutil.copy(TREE / "tools/examples" / name, folder)
            shutil.copy(TREE / "firmware/lcm/types/slamsensor_pose_t.lcm", folder)
            commands = re.findall(r"(?:lcm-gen|g\+\+|gcc) .*", (folder / name).read_text().split("#include")[0])
            self.assertEqual(len(commands), 2)
            for command in commands:
                self.done("bash", "-c", command, cwd=folder, patience_s=300)
            self.assertTrue((folder / "read_pose").is_file())


class Live(unittest.TestCase):
    """On a sensor whose head is emulated."""

    @classmethod
    def setUpClass(cls):
        cls.port = free_port()
        cls.url = f"udpm://{GROUP}:{7700 + int(time.time()) % 200}?ttl=0"
        settings = {"nmea.tcp": "true", "nmea.tcp_port": cls.port, "lcm.enabled": "true", "lcm.url": cls.url, **DATUM}
        cls.sensor = Sensor((PROGRAM, DAEMON), settings=settings)
        cls.addClassCleanup(cls.sensor.close)
        cls.sensor.start_head()
        cls.sensor.start()
        cls.sensor.wait_fix()

    def ctl(self, request, *more):
        return run(PROGRAM, "ctl", "--socket", self.sensor.folder / "control", *more, *request.split())

    def first_line(self, *command):
        """What a program that never ends says first."""
        process = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, text=True)
        self.addCleanup(process.stdout.close)
        self.addCleanup(process.wait)
        self.addCleanup(process.kill)
        return process.stdout.readline()

    def test_requests_of_the_daemon(self):
        """Each request of the listing; `|` parts those that begin alike."""
        values = {"[NAME]": "tour", "LAT": "48", "LON": "11", "HEIGHT": "500", "BEARING": "90", "KEY": "nmea.rate_hz", "[VALUE]": "5", "get|set|unset": "get"}
        requests = []
        for line in README.indented("The daemon"):
            for part in line.removeprefix("slamsensor ctl ").split(";"):
                words = part.split()
                alternatives = [[]]
                for word in words:
                    if word == "|":
                        alternatives.append([])
                    else:
                        alternatives[-1].append(values.get(word, word))
                head = alternatives[0][0]
                for i, alternative in enumerate(alternatives):
                    alone = i == 0 or head in ("status",)
                    requests.append(" ".join(alternative if alone else [head, *alternative]))
        requests = [r.replace(" [json]", "") for r in requests]
        self.assertIn("map load garden", requests)
        self.assertIn("scan pause", requests)
        self.assertIn("datum set 48 11 500 90", requests)
        self.assertGreater(len(requests), 18)
        allowed = {"scan now", "map remove garden"}  # in continuous mode, and of the map that is in use
        for request in requests:
            request = request.replace("config get nmea.rate_hz 5", "config get nmea.rate_hz")
            status, output, errors = self.ctl(request)
            if request not in allowed:
                self.assertEqual(status, 0, f"{request}: {output}{errors}")
            else:
                self.assertNotIn("unknown", errors, request)
        for request in ("scan mode continuous", "scan resume", "map unfreeze", "record stop"):
            self.ctl(request)
        self.assertEqual(self.ctl("status", "--json")[0], 0)
        self.assertEqual(self.ctl("help")[0], 0)
        self.sensor.wait_fix()

    @unittest.skipUnless(multicast_works(), "no route for multicast: ip route add 224.0.0.0/4 dev lo")
    def test_examples_that_need_nothing(self):
        examples = TREE / "tools/examples"
        lcm = self.url.split("?", 1)[0]
        self.assertRegex(self.first_line(examples / "read_pose.py", lcm), r"^\d+\.\d\d \w+")
        self.assertRegex(self.first_line(examples / "read_pose.py", f"tcp://127.0.0.1:{self.port}"), r"^\d+\.\d\d \w+")
        self.assertRegex(self.first_line(examples / "read_pose.sh", "127.0.0.1", self.port), r"^\d{6}\.\d\d \w+")
        status, output, errors = run(examples / "plan_path.py", "3", "2", "--url", lcm, "--once")
        self.assertRegex(output, r"(?m)^from .* to 3\.00 2\.00: ", f"{status} {errors}")

    @unittest.skipUnless(multicast_works(), "no route for multicast: ip route add 224.0.0.0/4 dev lo")
    def test_top(self):
        status, output, errors = run(PROGRAM, "top", "--once", "--url", self.url)
        self.assertEqual(status, 0, errors)
        self.assertIn("state", output)

    def test_the_page(self):
        port = free_port()
        line = self.first_line(PROGRAM, "view", "--listen", f"127.0.0.1:{port}", "--url", self.url)
        self.assertIn(f"http://127.0.0.1:{port}/", line)
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=PATIENCE_S) as page:
            self.assertIn(b"slamsensor", page.read())
        self.assertIn("http://127.0.0.1:8210", README.text)
        self.assertIn("--listen ADDRESS:PORT=127.0.0.1:8210", run(PROGRAM, "view", "--help")[1])

    @unittest.skipUnless(shutil.which("gpsd") and shutil.which("gpspipe"), "gpsd is not installed: tools/setup test")
    def test_gpsd_reads_it(self):
        """The README's gpsd at the port of this sensor; in the foreground, with a port of its own."""
        shown = next(q for q in README.quoted() if q.startswith("gpsd "))
        self.assertEqual(shown, "gpsd -n -b tcp://localhost:10110")
        port = free_port()
        gpsd = subprocess.Popen(["gpsd", "-N", "-n", "-b", "-S", str(port), f"tcp://localhost:{self.port}"], stderr=subprocess.DEVNULL)
        self.addCleanup(gpsd.wait)
        self.addCleanup(gpsd.terminate)

        def reports():
            output = run("gpspipe", "-w", "-x", "4", f"localhost:{port}")[1]
            whole = output[:output.rfind("\n") + 1]  # gpspipe may end within a line
            reported = [json.loads(line) for line in whole.splitlines() if line.startswith("{")]
            classes = {report["class"]: report for report in reported}
            return classes if {"TPV", "ATT", "GST"} <= set(classes) and classes["TPV"].get("mode", 0) >= 2 else None
        found = wait_for(reports, "TPV, ATT and GST of gpsd", PATIENCE_S)
        self.assertIn("heading", found["ATT"])


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[4:], verbosity=1)
