"""What the README says, held against the tree and the programs. Usage: readme_test.py SLAMSENSOR SLAMSENSORD SOURCE_TREE"""
import errno
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from readme import Readme

PROGRAM, DAEMON, TREE = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
README = Readme(TREE)
LINES_MAX = 150

# Names in backticks that are paths but not of this tree: installed, written by a run, or a name the reader chooses.
ELSEWHERE = re.compile(r"^(?:out/|/var/|/etc/|http|share/slamsensor|plot\.svg|hindsight\.tum|truth\.tum|trees\.csv|f\.toml)")


def said(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=60)
    return done.returncode, done.stdout + done.stderr


def checksum(sentence):
    body, _, told = sentence[1:].partition("*")
    value = 0
    for c in body.encode():
        value ^= c
    return told == f"{value:02X}"


class Text(unittest.TestCase):
    def test_it_can_be_read_in_five_minutes(self):
        self.assertLessEqual(len(README.lines), LINES_MAX)

    def test_every_profile_is_named_and_is_right(self):
        for profile in sorted((TREE / "config").glob("*.toml")):
            named = profile.name in README.text or (profile.name.startswith("experiment-") and "experiment-*.toml" in README.text)
            self.assertTrue(named or profile.name == "slamsensor.toml", profile.name)
            status, text = said(PROGRAM, "check-config", "--config", profile)
            self.assertEqual(status, 0, f"{profile.name}: {text}")

    def test_every_path_in_it_is_there(self):
        seen = 0
        for quoted in README.quoted() + re.findall(r"^    (tools/\w+)", README.text, re.MULTILINE):
            for word in re.split(r"[\s;,|]+", quoted):
                if ELSEWHERE.match(word) or not re.match(r"^(?:build/release/)?(?:core|hal|firmware|tools|tests|config|systemd)/", word):
                    continue
                word = word.rstrip(".:")
                if word.startswith("build/release/"):  # a program of the tests: its folder makes it
                    folder, name = TREE / pathlib.Path(word).relative_to("build/release").parent, pathlib.Path(word).name
                    self.assertIn(name, (folder / "CMakeLists.txt").read_text(), word)
                else:
                    self.assertTrue(list(TREE.glob(word)) or list(TREE.glob(word + "*")), word)
                seen += 1
        self.assertGreater(seen, 25)

    def test_files_named_by_their_names_alone_are_there(self):
        names = {path.name for folder in ("config", "systemd", "tools/examples") for path in (TREE / folder).rglob("*")}
        names |= {path.name.removesuffix(".in") for path in (TREE / "systemd").rglob("*.in")}
        for word in re.findall(r"[\w*-]+\.(?:toml|rules|conf|py|sh|c|cpp|service)\b", README.text):
            if not ELSEWHERE.match(word) and "*" not in word and word != "gpsdctl" and not word.startswith("slamsensor.toml"):
                self.assertIn(word, names)

    def test_every_verb_has_a_row_and_every_row_its_verbs(self):
        verbs = set(re.findall(r"^  ([a-z-]+)  ", said(PROGRAM, "--help")[1].split("Subcommands:")[1], re.MULTILINE))
        told = {name for row in README.table("The command slamsensor") for name in re.findall(r"`([a-z-]+)`", row[0])}
        self.assertEqual(told, verbs)

    def test_every_setting_is_one(self):
        default = (TREE / "config/slamsensor.toml").read_text()
        keys, section = set(), ""
        for line in default.splitlines():
            if found := re.match(r"(?:# )?\[(\w+)\]$", line):
                section = found[1]
                keys.add(f"[{section}]")
            elif found := re.match(r"(?:# )?(\w+) =", line):
                keys.add(f"{section}.{found[1]}")
        sections = {key[1:-1] for key in keys if key.startswith("[")}
        for quoted in README.quoted():
            for word in re.findall(r"\[\w+\]|\b[a-z_]+\.[a-z_]+\b", quoted):
                if word.startswith("[") or word.split(".")[0] in sections - {"record", "head", "slamsensor"}:
                    self.assertIn(word.replace("tolerence", "tolerance"), keys, quoted)

    def test_every_folder_of_the_method_is_named(self):
        for folder in (f for f in (TREE / "core").iterdir() if f.is_dir()):
            self.assertTrue(f"`{folder.name}`" in README.text or folder.name == "geometry", folder.name)

    def test_every_lcm_type_is_named(self):
        for path in (TREE / "firmware/lcm/types").glob("slamsensor_*_t.lcm"):
            name = path.stem.removeprefix("slamsensor_").removesuffix("_t").upper()
            if name != "COUNTERS":
                self.assertRegex(README.text, rf"SLAMSENSOR_{name}\b|`_{name}`", path.name)


class Sentences(unittest.TestCase):
    SHOWN = [line.strip() for line in README.lines if line.startswith("    $")]

    def test_they_are_whole_and_in_order(self):
        self.assertEqual([s[1:6] for s in self.SHOWN], ["GPRMC", "GPGGA", "GPGBS", "GPHDT", "GPGST", "PSLMA"])
        for sentence in self.SHOWN:
            self.assertTrue(checksum(sentence), sentence)

    def test_they_are_of_one_fix(self):
        rmc, gga, gbs, hdt, gst, pose = (s.split("*")[0].split(",") for s in self.SHOWN)
        self.assertEqual(len({rmc[1], gga[1], gbs[1], gst[1], pose[2]}), 1)
        self.assertEqual(rmc[3:7], gga[2:6])
        self.assertEqual([gbs[2], gbs[3]], [gst[6], gst[7]])
        self.assertEqual((gga[6], rmc[12], pose[4]), ("8", "S", "S"))
        self.assertEqual(int(gga[7]), int(pose[12]))
        # The demo's datum has x towards 90 degrees.
        self.assertAlmostEqual((90.0 - float(pose[8])) % 360.0, float(hdt[1]), delta=0.006)

    def test_they_are_those_of_the_demo(self):
        """The last stand of the demo's drive is where the sentences say; noise and timing are each run's own."""
        stands = re.findall(r"\[\[stand\]\][^\[]*?x_m = (\S+)\s+y_m = (\S+)\s+heading_deg = (\S+)",
                            (TREE / "config/demo/drive.toml").read_text())
        x, y, heading = map(float, stands[-1])
        pose = self.SHOWN[5].split("*")[0].split(",")
        self.assertAlmostEqual(float(pose[6]), x, delta=0.3)
        self.assertAlmostEqual(float(pose[7]), y, delta=0.3)
        self.assertAlmostEqual(float(pose[8]), heading, delta=0.3)
        live = TREE / "out/demo/live.nmea"
        if not live.is_file():
            return  # the demo has not run here; the long tests run it
        last = [line.strip() for line in live.read_text(errors="replace").splitlines() if re.search(r"RMC,[^,]*,A", line)]
        if last:
            text = live.read_text(errors="replace")
            epoch = text[text.rindex(last[-1]):].split()[:6]
            for shown, made in zip(self.SHOWN, epoch):
                self.assertEqual(len(shown.split(",")), len(made.split(",")), made)
                for one, other in zip(shown.split("*")[0].split(","), made.split("*")[0].split(",")):
                    self.assertEqual(one == "", other == "", f"{shown} is not like {made}")


class Messages(unittest.TestCase):
    def test_what_is_refused_is_refused_in_these_words(self):
        """Each message of the table stands in the sources, what is left out as dots apart."""
        sources = "".join(path.read_text(errors="replace") for room in ("core", "hal", "firmware", "tools")
                          for path in (TREE / room).rglob("*.cpp"))
        sources += "".join(path.read_text(errors="replace") for path in (TREE / "firmware").rglob("*.hpp"))
        joined = re.sub(r'"\s*\n\s*"', "", sources)
        for row in README.table("When something is refused"):
            message = row[0].strip("`")
            for part in re.split(r"\.\.\.| deg and | after |f\.toml:2:1: |association\.tolerance?_m|association\.tolerence_m|: |; |IFACE|slamsensor\.service", message):
                part = part.strip(" ,;:?()")
                if len(part) > 8 and part != os.strerror(errno.ENOENT):
                    self.assertTrue(part in joined, f"{part!r} of {message!r} is nowhere said")

    def test_the_misspelt_key_is_told_as_shown(self):
        shown = next(row[0].strip("`") for row in README.table("When something is refused") if "f.toml:2:1" in row[0])
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "f.toml"
            path.write_text("[association]\ntolerence_m = 1.0\n")
            status, text = said(PROGRAM, "check-config", "--config", path)
        self.assertEqual(status, 78)
        self.assertIn(shown, text.replace(str(path), "f.toml"))

    def test_the_exit_status_table_is_that_of_sysexits(self):
        heading = next(line for line in README.lines if line.startswith("## When something is refused"))
        told = {int(n) for n in re.findall(r"\b(\d\d) ", heading)}
        self.assertEqual(told, {os.EX_USAGE, os.EX_DATAERR, os.EX_NOINPUT, os.EX_UNAVAILABLE, os.EX_OSERR, os.EX_CANTCREAT,
                                os.EX_NOPERM, os.EX_CONFIG})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=1)
