#!/usr/bin/env python3
"""Broken configurations end the daemon with exit status 78 and their messages; with broken map files it starts, says
what is wrong with them, leaves them as they are, and sets them aside when it saves.
broken_test.py SLAMSENSOR SLAMSENSORD CASES, where CASES is the folder of the broken configurations and their messages.
SLAMSENSOR_BROKEN_MAPS: how many of those (default 12), SLAMSENSOR_SEED."""
import os
import pathlib
import random
import re
import subprocess
import sys
import tempfile
import threading
import unittest

from sensor import Sensor

PROGRAMS, CASES = sys.argv[1:3], pathlib.Path(sys.argv[3])
SEED = int(os.environ.get("SLAMSENSOR_SEED", "1"))
CONFIG = 78
MAPS = int(os.environ.get("SLAMSENSOR_BROKEN_MAPS", "12"))
SENSORS = 3
LINE = re.compile(r"^\S+Z (\w+): ", re.MULTILINE)


def sections(text, mark):
    """Pairs of what stands behind `mark` and what follows."""
    parts = re.split(f"^{mark} (.*)\n", text, flags=re.MULTILINE)
    return parts[0], list(zip(parts[1::2], parts[2::2]))


class Configurations(unittest.TestCase):
    def told(self, folder, text):
        own, drop_ins = sections(text, "----")
        (folder / "f.toml").write_text(own)
        (folder / "f.toml.d").mkdir()
        for name, content in drop_ins:
            (folder / "f.toml.d" / name).write_text(content)
        done = subprocess.run([PROGRAMS[1], "--config", str(folder / "f.toml")], capture_output=True, text=True,
                              timeout=30, env={"PATH": os.environ["PATH"]})
        self.assertEqual(done.returncode, CONFIG, done.stderr)
        self.assertEqual(done.stdout, "")
        self.assertTrue(all(level == "error" for level in LINE.findall(done.stderr)), done.stderr)
        return LINE.sub("", done.stderr).replace(f"{folder}/", "")

    def test_each_is_refused_with_its_message(self):
        messages = dict(sections((CASES / "messages.txt").read_text(), "====")[1])
        cases = sections((CASES / "cases.txt").read_text(), "====")[1]
        self.assertGreaterEqual(len(cases), 60)
        for name, text in cases:
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                self.assertEqual(self.told(pathlib.Path(folder), text), messages[name])
        print(f"{len(cases)} configurations;", end=" ", flush=True)

    def test_a_file_that_is_not_there(self):
        done = subprocess.run([PROGRAMS[1], "--config", "/nowhere.toml"], capture_output=True, text=True, timeout=30)
        self.assertEqual(done.returncode, CONFIG)
        self.assertIn("/nowhere.toml", done.stderr)


def breakages(good, rng):
    """Name and content of broken map files."""
    yield "empty", b""
    yield "text", b"id,x_m,y_m\n1,0,0\n"
    yield "zeros", bytes(len(good))
    yield "png", b"\x89PNG\r\n\x1a\n" + good[8:]
    yield "text mode", good.replace(b"\r\n", b"\n", 1)
    yield "twice", good + good
    yield "newer version", good[:8] + b"\x09" + good[9:]
    for i in range(13):
        size = rng.randrange(1, len(good))
        yield f"cut at {size}", good[:size]
    while True:
        at, bit = rng.randrange(len(good)), rng.randrange(8)
        yield f"bit {bit} of byte {at} turned", good[:at] + bytes([good[at] ^ 1 << bit]) + good[at + 1:]


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        sensor = Sensor(PROGRAMS)
        cls.addClassCleanup(sensor.close)
        sensor.start_head()
        sensor.start()
        sensor.wait_fix()
        sensor.ask("map save")
        cls.good = (sensor.maps / "default.slammap").read_bytes()

    def start_with(self, sensor, content):
        path = sensor.maps / "default.slammap"
        for old in sensor.maps.iterdir():
            old.unlink()
        path.write_bytes(content)
        sensor.log_path.write_text("")
        sensor.start({"map.autosave_s": 0})
        status = sensor.wait_fix()
        message = re.search(r"error: map 'default': not loaded: .*?default\.slammap: (.*); starting without it",
                            sensor.log())
        if not message:
            raise AssertionError(f"not told:\n{sensor.log()}")
        if path.read_bytes() != content:
            raise AssertionError("the broken file was changed by the start")
        if status["fix"]["matches"] != 0:
            raise AssertionError("the fix is none of a new map")
        sensor.ask("map save")
        aside = [old.read_bytes() for old in sensor.maps.glob("default.slammap.bad-*")]
        if aside != [content] or not path.exists():
            raise AssertionError(f"not set aside: {sorted(old.name for old in sensor.maps.iterdir())}")
        sensor.kill()
        return message.group(1)

    def test_the_start_goes_on_and_the_file_is_set_aside(self):
        rng = random.Random(SEED)
        cases = [case for case, _ in zip(breakages(self.good, rng), range(MAPS))]
        told, problems, lock = [], [], threading.Lock()

        def work():
            sensor = Sensor(PROGRAMS)
            sensor.maps.mkdir()
            sensor.start_head()
            try:
                while cases:
                    with lock:
                        if not cases:
                            return
                        name, content = cases.pop(0)
                    try:
                        told.append((name, self.start_with(sensor, content)))
                    except AssertionError as error:
                        problems.append(f"{name}: {error}")
            finally:
                sensor.close()

        threads = [threading.Thread(target=work) for _ in range(SENSORS)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        for name, message in told:
            print(f"\n  {name}: {message}", end="")
        print(flush=True)
        self.assertEqual(problems, [], f"seed {SEED}")
        self.assertEqual(len(told), MAPS)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[4:]], verbosity=2)
