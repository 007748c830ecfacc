"""The path planner's example: ways around landmarks, and what it says without a fix. Usage: plan_test.py SOURCE_TREE"""
import argparse
import math
import pathlib
import random
import socket
import subprocess
import sys
import threading
import time
import unittest

TREE = pathlib.Path(sys.argv[1])
sys.path[:0] = [str(TREE / "tools" / "examples"), str(TREE / "tests" / "view")]
import drive  # noqa: E402
import lcm_types  # noqa: E402
import plan_path  # noqa: E402

WISHES = argparse.Namespace(landmark_radius=0.4, carrier_radius=0.5)


def discs(points, radius):
    return [(x, y, radius) for x, y in points]


def clearance(way, points):
    def to_line(p, a, b):
        length = math.dist(a, b)
        along = 0.0 if length == 0 else max(0.0, min(1.0, ((p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])) / length ** 2))
        return math.dist(p, (a[0] + along * (b[0] - a[0]), a[1] + along * (b[1] - a[1])))
    return min(to_line(p, a, b) for p in points for a, b in zip(way, way[1:]))


class Plan(unittest.TestCase):
    def test_without_landmarks_the_way_is_straight(self):
        self.assertEqual(plan_path.plan((0, 0), (7.3, -4.1), []), [(0, 0), (7.3, -4.1)])

    def test_a_wall_is_gone_around(self):
        wall = [(5.0, 0.8 * y) for y in range(-12, 13)]
        way = plan_path.plan((0, 0), (10, 0), discs(wall, 0.9))
        self.assertGreater(clearance(way, wall), 0.9)
        self.assertGreater(sum(math.dist(a, b) for a, b in zip(way, way[1:])), 20.0)
        self.assertLess(len(way), 12, "corners are cut")

    def test_ways_through_random_woods_keep_their_distance(self):
        for seed in range(20):
            draw = random.Random(seed)
            trees = [(draw.uniform(-40, 40), draw.uniform(-40, 40)) for _ in range(150)]
            goal = (35.0, draw.uniform(-35, 35))
            way = plan_path.plan((-35.0, 0.0), goal, discs(trees, 1.2))
            if isinstance(way, str):
                self.assertIn("too near", way)
                continue
            self.assertEqual((way[0], way[-1]), ((-35.0, 0.0), goal))
            apart = [t for t in trees if math.dist(t, way[0]) > 1.2]
            self.assertGreater(clearance(way, apart), 1.2, seed)

    def test_goals_that_cannot_be_reached_are_told(self):
        ring = [(20 + 3 * math.cos(a / 4), 3 * math.sin(a / 4)) for a in range(26)]
        self.assertIn("all around", plan_path.plan((0, 0), (20, 0), discs(ring, 0.6)))
        self.assertIn("too near", plan_path.plan((0, 0), (20, 3), discs(ring, 0.6)))

    def test_a_landmark_that_is_touched_does_not_keep_the_carrier(self):
        self.assertEqual(plan_path.plan((0, 0), (9, 0), [(-0.3, 0, 1.0)]), [(0, 0), (9, 0)])

    def test_each_landmark_has_its_own_radius(self):
        way = plan_path.plan((0, 0), (20, 0), [(6, 0.5, 3.0), (14, -0.5, 0.6)])
        self.assertGreater(clearance(way, [(6, 0.5)]), 3.0)
        self.assertGreater(clearance(way, [(14, -0.5)]), 0.6)
        self.assertLess(clearance(way, [(14, -0.5)]), 3.0)


class Listening(unittest.TestCase):
    def heard(self, *messages):
        sensor = plan_path.Sensor()
        for _, message in messages:
            sensor.take(message)
        return sensor

    def test_only_a_fix_is_driven_from(self):
        points = drive.landmarks(80, 40.0)
        maps = list(drive.map_messages(points))
        sensor = self.heard(*maps[:-1])
        self.assertFalse(sensor.whole)
        sensor = self.heard(*maps, drive.pose_message(1, (1, 2, 0.5)))
        self.assertTrue(sensor.whole)
        self.assertEqual([(x, y) for x, y, _ in sensor.landmarks()], points)
        self.assertEqual([d for _, _, d in sensor.landmarks()][:6], [0.0, 0.25, 0.5, 0.75, 1.0, 0.0])
        self.assertAlmostEqual(sensor.sigma_m, 0.311 / 3, places=3)
        self.assertIn("from 1.00 2.00 28.6 to 9.00 9.00: ", plan_path.told(sensor, (9.0, 9.0), WISHES))
        for status, reason, word in ((0, 2, "no_overlap"), (1, 3, "symmetric"), (0, 10, "local_map")):
            sensor = self.heard(*maps, drive.pose_message(1, (1, 2, 0.5)), drive.pose_message(2, (1, 2, 0.5), status, reason))
            self.assertEqual(plan_path.told(sensor, (9.0, 9.0), WISHES), f"no fix ({word}): stand still and wait")

    def test_over_the_network(self):
        port = 7900 + int(time.time()) % 90
        try:
            sender = lcm_types.Sender("239.255.76.69", port)
            sender.send("X", b"")
        except OSError as error:
            self.skipTest(f"no route for multicast ({error}): ip route add 224.0.0.0/4 dev lo")
        self.addCleanup(sender.socket.close)
        process = subprocess.Popen([sys.executable, str(TREE / "tools/examples/plan_path.py"), "9", "9", "--once", "--url",
                                    f"udpm://239.255.76.69:{port}"], stdout=subprocess.PIPE, text=True)
        ended = threading.Event()

        def send():
            while not ended.wait(0.2):
                for channel, message in [*drive.map_messages([(5.0, 5.0), (20.0, 3.0)]), drive.pose_message(1, (0, 0, 0))]:
                    sender.send(channel, message)
        thread = threading.Thread(target=send)
        thread.start()
        try:
            output, _ = process.communicate(timeout=60)
        finally:
            ended.set()
            thread.join()
            process.kill()
        self.assertEqual(process.returncode, 0)
        self.assertRegex(output, r"^from 0\.00 0\.00 0\.0 to 9\.00 9\.00: 1[23]\.\d\d m, 0\.81 m clear: 0\.00,0\.00 .* 9\.00,9\.00\n$")


class Mistakes(unittest.TestCase):
    """What a user mistypes, or who is not there, is one line and a status; never a traceback."""

    def run_example(self, *arguments):
        done = subprocess.run([sys.executable, "-B", TREE / "tools" / "examples" / arguments[0], *arguments[1:]],
                              capture_output=True, text=True, timeout=30)
        self.assertNotIn("Traceback", done.stderr)
        return done.returncode, done.stderr.strip().split("\n")[-1]

    def test_of_the_command_line(self):
        for words in (["nan", "1"], ["1", "inf"], ["1", "1", "--url", "x"], ["1", "1", "--url", "udpm://a:b"],
                      ["1", "1", "--carrier-radius", "-1"], ["1", "1", "--carrier-radius", "0", "--landmark-radius", "0"]):
            status, line = self.run_example("plan_path.py", *words)
            self.assertEqual(status, 2, words)
            self.assertIn("plan_path.py: error: ", line)
        for word in ("x", "tcp://host:port", "tcp://"):
            self.assertEqual(self.run_example("read_pose.py", word),
                             (64, f"read_pose.py: {word} is neither udpm://GROUP:PORT nor tcp://HOST:PORT"))

    def test_nobody_listens(self):
        self.assertEqual(self.run_example("read_pose.py", "tcp://127.0.0.1:1"), (69, "read_pose.py: tcp://127.0.0.1:1: Connection refused"))
        self.assertEqual(self.run_example("plan_path.py", "1", "1", "--url", "udpm://192.0.2.1:7667")[0], 69)

    def test_who_reads_the_poses_may_end_first(self):
        body = "PSLMA,POSE,030838.00,A,S,0,-7.030,13.003,54.938,0.127,0.41,1,21,27,2,1,0.67"
        checksum = 0
        for character in body.encode():
            checksum ^= character
        with socket.create_server(("127.0.0.1", 0)) as server:
            process = subprocess.Popen([sys.executable, "-B", TREE / "tools" / "examples" / "read_pose.py",
                                        f"tcp://127.0.0.1:{server.getsockname()[1]}"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            link, _ = server.accept()
            with link:
                link.sendall(f"${body}*{checksum:02X}\r\n".encode())
                self.assertIn(" fix -7.030", process.stdout.readline())
                process.stdout.close()
                link.sendall(f"${body}*{checksum:02X}\r\n".encode() * 2)
                self.assertEqual(process.wait(timeout=30), -13)
            self.assertEqual(process.stderr.read(), "")
            process.stderr.close()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]], verbosity=1)
