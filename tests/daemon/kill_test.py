#!/usr/bin/env python3
"""The daemon is killed at random moments of starts, loads, scans and saves. The map afterwards is always one that was
there or the next one, and after every restart that is waited for the first scan finds itself in it.
kill_test.py SLAMSENSOR SLAMSENSORD. SLAMSENSOR_KILLS: how many (default 24), SLAMSENSOR_SENSORS: at a time (default 3),
SLAMSENSOR_SEED."""
import os
import random
import re
import struct
import sys
import threading
import time
import unittest
import zlib

from sensor import HERE, PATIENCE_S, Refused, Sensor

PROGRAMS = sys.argv[1:3]
KILLS = int(os.environ.get("SLAMSENSOR_KILLS", "24"))
SENSORS = int(os.environ.get("SLAMSENSOR_SENSORS", "3"))
SEED = int(os.environ.get("SLAMSENSOR_SEED", "1"))
WAITED_SHARE = 0.7  # of the restarts whose first scan is waited for
START_S, RUN_S = 0.4, 2.5  # a kill comes within this of a start, of a first fix
STARVED_S = 0.02  # a scan thread that is woken so late does not get what the first scan takes
PREFIX, INFO_AT = struct.Struct("<8sIIQI"), 44
LOADED = re.compile(r"map 'default' loaded: (\d+) landmarks")


def saves_of(path):
    """How often the map had been saved with the file; none when the file is not whole. The daemon checks the rest."""
    content = path.read_bytes()
    if len(content) < INFO_AT + 8:
        return None
    magic, _, _, size, checksum = PREFIX.unpack_from(content)
    is_whole = (magic == b"\x89SLM\r\n\x1a\n" and size == len(content) and
                checksum == zlib.crc32(content[:PREFIX.size - 4]))
    return struct.unpack_from("<Q", content, INFO_AT)[0] if is_whole else None


class Saver(threading.Thread):
    """Has the map saved again and again, so that kills come while it is saved."""

    def __init__(self, sensor):
        super().__init__(daemon=True)
        self.sensor, self.saves = sensor, 0
        self.start()

    def run(self):
        try:
            while True:
                self.sensor.control().ask("map save")
                self.saves += 1
        except (OSError, ValueError, Refused):
            pass  # it was killed, or there is no map yet


class Round:
    """One sensor that is killed again and again."""

    def __init__(self, index, kills):
        self.random = random.Random(SEED * 1000 + index)
        self.sensor = Sensor(PROGRAMS, settings={"map.autosave_s": 0.01})
        self.left = kills
        self.kills = {"while it started": 0, "after its first fix": 0}
        self.saves_on_disk = 0
        self.saves = self.waited = self.fixed = self.starved = self.previous = 0
        self.problems = []

    def run(self):
        try:
            self.sensor.start_head()
            self.first()
            while self.left > 0 and len(self.problems) < 3:
                self.once()
                self.left -= 1
        except Exception as error:  # told with the rest by the thread that waits for this one
            self.problems.append(f"{error!r}\n{self.sensor.log()[-3000:]}")
        finally:
            self.sensor.close()

    def first(self):
        self.sensor.start()
        self.sensor.wait_fix()
        self.sensor.ask("map save")
        self.sensor.kill()
        self.check_files(1)

    def once(self):
        sensor = self.sensor
        sensor.log_path.write_text("")
        sensor.start()
        saver = None
        if self.random.random() >= WAITED_SHARE:
            time.sleep(self.random.uniform(0.0, START_S))
            kind = "while it started"
        else:
            self.check_first_scan()
            saver = Saver(sensor) if self.random.random() < 0.8 else None
            time.sleep(self.random.uniform(0.0, RUN_S))
            kind = "after its first fix"
        sensor.daemon.kill()
        sensor.daemon.wait(PATIENCE_S)
        acknowledged = 0
        if saver:
            saver.join(PATIENCE_S)
            acknowledged = saver.saves
        sensor.kill()
        self.saves += acknowledged
        self.kills[kind] += 1
        self.check_files(acknowledged)

    def check_first_scan(self):
        status = self.sensor.wait_status(lambda s: s["slam"]["scans"] >= 1, "the first scan")
        log = self.sensor.log()
        self.waited += 1
        self.previous += "the previous generation" in log
        if not LOADED.search(log):
            self.problems.append(f"no map was loaded:\n{log}")
        fix = status["fix"]
        if status["slam"]["fixes"] != status["slam"]["scans"] or fix["status"] != "fix" or fix["matches"] < 5:
            if status["head"]["wake_latency_max_s"] > STARVED_S:
                self.starved += 1
                return
            self.problems.append(f"no fix with the first scan: {fix}\n{log}")
        elif self.sensor.is_wrong(fix):
            self.problems.append(f"a wrong fix: {fix} instead of {self.sensor.pose()}")
        else:
            self.fixed += 1

    def check_files(self, acknowledged):
        """The map is one that was there or the next one: not older than the last save that was told done."""
        found = sorted(path.name for path in self.sensor.maps.iterdir())
        generations = [self.sensor.maps / name for name in ("default.slammap", "default.slammap.1")]
        saves = [saves_of(path) for path in generations if path.exists()]
        if not saves or None in saves or max(saves) < self.saves_on_disk + acknowledged:
            self.problems.append(f"{found} with {saves} saves, after {self.saves_on_disk} and {acknowledged}")
        if any(".bad-" in name for name in found):
            self.problems.append(f"a map was found bad: {found}")
        self.saves_on_disk = max((count for count in saves if count), default=0)


class Killed(unittest.TestCase):
    def test_the_map_outlives_every_kill(self):
        print(f"seed {SEED}", flush=True)
        rounds = [Round(index, KILLS // SENSORS + (index < KILLS % SENSORS)) for index in range(SENSORS)]
        threads = [threading.Thread(target=one.run) for one in rounds]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        total = lambda count: sum(count(one) for one in rounds)
        for kind in rounds[0].kills:
            print(f"{total(lambda one: one.kills[kind])} kills {kind}")
        print(f"{total(lambda one: one.saves)} saves by request before them; "
              f"{total(lambda one: one.waited)} restarts whose first scan was waited for, "
              f"{total(lambda one: one.fixed)} of them with a right fix, "
              f"{total(lambda one: one.starved)} without, on a machine that was too busy, "
              f"{total(lambda one: one.previous)} on the previous generation", flush=True)
        results = HERE.parent.parent / "build" / "results"  # tests/readme holds the README's numbers against them
        results.mkdir(parents=True, exist_ok=True)
        (results / "kills.csv").write_text(f"figure,value\nkills,{KILLS}\nwaited,{total(lambda one: one.waited)}\n"
                                           f"fixed,{total(lambda one: one.fixed)}\nproblems,{sum(len(one.problems) for one in rounds)}\n")
        problems = [problem for one in rounds for problem in one.problems]
        self.assertEqual(len(problems), 0, f"seed {SEED}\n" + "\n".join(problems))
        self.assertEqual(total(lambda one: sum(one.kills.values())), KILLS)
        self.assertEqual(total(lambda one: one.fixed + one.starved), total(lambda one: one.waited))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
