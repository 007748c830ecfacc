#!/usr/bin/env python3
"""The installed service files: units_test.py SYSTEMD_SOURCES UNITS, where UNITS holds the configured units. Needs the
tools of systemd, but no systemd that runs. Exit status 77: skipped, they are not there."""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCES, UNITS = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
EXPOSURE_MAX = 2.0
SKIPPED = 77
# Names under which the kernel's drivers list their ports (/proc/devices): PC, USB, CDC, PL011 (Raspberry Pi), i.MX, LPUART,
# STM32, Jetson, OMAP, Zynq, UARTLite, Samsung, Amlogic, Armada, Qualcomm, SiFive, SC16IS7xx, MAX310x; Exar, WCH, Moxa.
BOARD_PORTS = ("ttyS ttyUSB ttyACM ttyAMA ttymxc ttyLP ttySTM ttyTHS ttyO ttyPS ttyUL ttySAC ttyAML ttyMV ttyMSM ttyHS ttySIF "
               "ttySC ttyMAX ttyXRUSB ttyCH341USB ttyCH343USB ttyMXUSB pts gpiochip").split()


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


class Units(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        # The programs need not be installed for the units to be looked at.
        for unit in UNITS.glob("*.service"):
            text = re.sub(r"^(Exec\w+=)\S*/slamsensord?\b", r"\1/bin/true", unit.read_text(), flags=re.MULTILINE)
            (self.folder / unit.name).write_text(text)

    def verify(self, *names):
        status, told = run("systemd-analyze", "verify", "--man=no", *(str(self.folder / name) for name in names))
        # The machine's own units are read as well; what they say is not ours.
        own = [line for line in told.splitlines() if "slamsensor" in line]
        self.assertEqual(own, [], told)
        self.assertEqual(status, 0, told)

    def test_verify(self):
        self.verify("slamsensor.service", "slamsensor-emulator.service", "slamsensor-multicast-route.service",
                    "slamsensor-view.service")

    def test_verify_with_the_emulated_head(self):
        conf = re.sub(r"^(ExecStart=)\S+/slamsensord", r"\1/bin/true", (UNITS / "emulated.conf").read_text(),
                      flags=re.MULTILINE)
        drop_ins = self.folder / "slamsensor.service.d"
        drop_ins.mkdir()
        (drop_ins / "emulated.conf").write_text(conf)
        self.verify("slamsensor.service", "slamsensor-emulator.service")

    def test_a_mistake_is_found(self):
        unit = self.folder / "slamsensor.service"
        unit.write_text(unit.read_text().replace("NoNewPrivileges=", "NoNewPrivilege="))
        with self.assertRaises(AssertionError):
            self.verify("slamsensor.service")

    def test_exposure(self):
        for name in ("slamsensor.service", "slamsensor-emulator.service", "slamsensor-view.service"):
            with self.subTest(name):
                _, told = run("systemd-analyze", "security", "--offline=yes", "--no-pager", str(self.folder / name))
                score = re.search(r"Overall exposure level for \S+: ([\d.]+)", told)
                self.assertIsNotNone(score, told)
                print(f"{name}: exposure {score.group(1)}", end=" ", flush=True)
                self.assertLessEqual(float(score.group(1)), EXPOSURE_MAX, told)

    def test_installed_paths_are_absolute_and_whole(self):
        for name in ("slamsensor.service", "slamsensor-emulator.service", "slamsensor-view.service", "emulated.conf"):
            text = (UNITS / name).read_text()
            self.assertNotRegex(text, "@[A-Z_]+@", name)
            for command in re.findall(r"^ExecStart=(\S+)", text, re.MULTILINE):
                self.assertTrue(command.startswith("/"), command)

    def test_watchdog_and_restarts(self):
        text = (UNITS / "slamsensor.service").read_text()
        for line in ("Type=notify", "WatchdogSec=10", "Restart=always", "RestartPreventExitStatus=64 78",
                     "ExecReload=/bin/sh -c 'kill -HUP ${MAINPID}'"):
            self.assertIn(f"\n{line}\n", text)

    def test_ports_of_boards_in_use_are_allowed(self):
        text = (UNITS / "slamsensor.service").read_text()
        self.assertIn("\nDevicePolicy=closed\n", text)
        for name in BOARD_PORTS:
            self.assertRegex(text, rf"(?m)^DeviceAllow=char-{name} rw$", name)
        for line in re.findall(r"(?m)^DeviceAllow=.*$", text):  # a terminal's driver, or one of those that are no terminal
            self.assertRegex(line, r"^DeviceAllow=char-(tty\w+|pts|gpiochip) rw$")

    def test_user_and_folders_are_made(self):
        root = self.folder / "root"
        (root / "etc").mkdir(parents=True)
        status, told = run("systemd-sysusers", f"--root={root}", str(SOURCES / "sysusers.conf"))
        self.assertEqual(status, 0, told)
        self.assertRegex((root / "etc/passwd").read_text(),
                         r"(?m)^slamsensor:x:\d+:\d+:SLAM sensor:/var/lib/slamsensor:/\S*nologin$")
        self.assertRegex((root / "etc/group").read_text(), r"(?m)^dialout:x:\d+:slamsensor$")
        status, told = run("systemd-tmpfiles", "--create", f"--root={root}", str(SOURCES / "tmpfiles.conf"))
        self.assertEqual(status, 0, told)
        for name in ("maps", "recordings"):
            folder = root / "var/lib/slamsensor" / name
            self.assertEqual(folder.stat().st_mode & 0o7777, 0o750)

    def test_rules(self):
        text = (SOURCES / "99-slamsensor.rules").read_text()
        lines = [line for line in text.splitlines() if line and not line.startswith("#")]
        match = r'[A-Z_]+(\{[^}]+\})?(==|!=|\+=|=)"[^"]*"'
        for line in lines:
            self.assertRegex(line, rf"^{match}(, {match})*$")
        for label in re.findall(r'GOTO="(\w+)"', text):
            self.assertEqual(text.count(f'LABEL="{label}"'), 1)
        status, told = run("udevadm", "--version")
        if status == 0 and int(told.split()[0]) >= 254:  # verify came then
            # Its group is made when it is installed: not here.
            status, told = run("udevadm", "verify", "--no-summary", "--resolve-names=never",
                               str(SOURCES / "99-slamsensor.rules"))
            self.assertEqual(status, 0, told)


if __name__ == "__main__":
    for tool in ("systemd-analyze", "systemd-sysusers", "systemd-tmpfiles"):
        if shutil.which(tool) is None:
            print(f"SKIPPED: {tool} is not installed (package systemd)")
            sys.exit(SKIPPED)
    unittest.main(argv=sys.argv[:1], verbosity=2)
