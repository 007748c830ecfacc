"""The manual pages: rendered without a warning, and nothing left out of them.
Usage: man_test.py SLAMSENSOR SLAMSENSORD SOURCE_TREE"""
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

PROGRAM, DAEMON, TREE = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
PAGES = sorted((TREE / "tools" / "man").glob("*.[1-9]"))


def output_of(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, timeout=60)
    return done.stdout + done.stderr


def rendered(name):
    """The page as a reader sees it, one long line, without overstrikes and hyphenation."""
    text = subprocess.run(["mandoc", "-Tutf8", "-O", "width=200", str(TREE / "tools" / "man" / name)], capture_output=True,
                          text=True, check=True, timeout=60).stdout
    return re.sub(r"\s+", " ", re.sub(r".\x08", "", text).replace("−", "-"))


class Manual(unittest.TestCase):
    def test_all_pages_are_there(self):
        self.assertEqual([page.name for page in PAGES], ["slamsensor-control.7", "slamsensor-time-and-frames.7", "slamsensor.1",
                                                         "slamsensor.toml.5", "slamsensord.8"])

    def test_mandoc_has_nothing_to_say(self):
        for page in PAGES:
            told = [line for line in output_of("mandoc", "-Tlint", "-Wwarning", page).splitlines() if line]
            self.assertEqual(told, [])

    def test_man_renders_them_without_a_warning(self):
        if shutil.which("man") is None or "man-db" not in output_of("man", "--version") and not re.match(r"man \d", output_of("man", "--version")):
            self.skipTest("man-db is not installed: tools/setup test")
        for page in PAGES:
            done = subprocess.run(["man", "--warnings", "-l", str(page)], capture_output=True, text=True, timeout=60,
                                  env={"LC_ALL": "C.UTF-8", "MANWIDTH": "100", "PATH": "/usr/bin:/bin"})
            self.assertEqual((done.returncode, done.stderr), (0, ""), page.name)
            self.assertIn("SEE ALSO", done.stdout)

    def test_every_verb_and_every_option_is_documented(self):
        page = rendered("slamsensor.1")
        verbs = re.findall(r"^  ([a-z-]+)  ", output_of(PROGRAM, "--help").split("Subcommands:")[1], re.MULTILINE)
        self.assertGreater(len(verbs), 10)
        for verb in verbs + ["map export", "map import", "figure spiderweb", "figure scanline", "figure correspondences"]:
            self.assertRegex(page, rf"\b{verb}\b", verb)
            for option in re.findall(r"^  (?:-\w,)?(--[a-z-]+)", output_of(PROGRAM, *verb.split(), "--help"), re.MULTILINE):
                self.assertRegex(page, rf"{option}\b", f"{verb} {option}")

    def test_every_option_of_the_daemon_is_documented(self):
        page = rendered("slamsensord.8")
        for option in re.findall(r"--[a-z]+", output_of(DAEMON, "--help")):
            self.assertIn(option, page)

    def test_every_request_is_documented(self):
        page = rendered("slamsensor-control.7")
        source = (TREE / "firmware/daemon/daemon.cpp").read_text()
        requests = re.findall(r'ControlVerb\{\s*"([a-z ]+)"', source)
        self.assertGreater(len(requests), 25)
        for request in requests:
            self.assertRegex(page, rf"\b{request}\b", request)

    def test_every_section_of_the_configuration_is_documented_and_every_key_named_is_one(self):
        page = rendered("slamsensor.toml.5")
        default = (TREE / "config/slamsensor.toml").read_text()
        sections = re.findall(r"^(?:# )?\[(\w+)\]$", default, re.MULTILINE)
        self.assertGreater(len(sections), 30)
        for section in sections:
            self.assertIn(f"[{section}]", page)
        keys, section = set(), ""
        for line in default.splitlines():
            if found := re.match(r"(?:# )?\[(\w+)\]$", line):
                section = found[1]
            elif found := re.match(r"(?:# )?(\w+) =", line):
                keys.add(f"{section}.{found[1]}")
        for name in (page.name for page in PAGES):
            for key in re.findall(rf"\b((?:{'|'.join(sections)})\.[a-z_]+)\b", rendered(name)):
                if not re.search(r"\.(?:toml|service|csv|socket)$", key) or key in keys:
                    self.assertIn(key, keys, name)

    def test_pages_refer_to_pages_that_are_there(self):
        for page in PAGES:
            for name, section in re.findall(r"^\.Xr (\S+) (\d)", page.read_text(), re.MULTILINE):
                self.assertTrue((TREE / "tools" / "man" / f"{name}.{section}").exists(), f"{page.name}: {name}({section})")


if __name__ == "__main__":
    if shutil.which("mandoc") is None:
        print("SKIPPED: mandoc is not installed: tools/setup test")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0]], verbosity=1)
