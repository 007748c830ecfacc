#!/usr/bin/env python3
"""Plans a way for a carrier of the sensor, around the landmarks of its map. Needs nothing but Python.

  plan_path.py X Y                                    to the point (X, Y) of the home map, m, from where the sensor is
  plan_path.py X Y --url udpm://239.255.76.67:7667    the LCM network of the sensor
  plan_path.py X Y --landmark-radius 0.4 --carrier-radius 0.5 --once

Listens for SLAMSENSOR_POSE and SLAMSENSOR_MAP, and plans again at each fix. A line per plan:

  from X Y HEADING to X Y: LENGTH m, CLEARANCE m clear: X,Y X,Y ...

or why there is none. A pose without a fix is not driven from: the line says the reason, and a carrier should stand still,
for the sensor needs it to while it scans. Each landmark is a disc: its own radius, where the sensor has measured one, else
--landmark-radius, the carrier's, and three sigma of the fix relative to the landmarks about it. What is no landmark (a ditch, a fence) is
not in the map: a planner that drives needs sensors for that.

The way is that of A* on a grid, with its corners cut as far as nothing is in the way."""
import argparse
import heapq
import math
import os
import signal
import socket
import struct
import sys
from urllib.parse import urlsplit

# slamsensor.pose_t and slamsensor.map_t as the .lcm files have them, behind the fingerprints that tell the types.
POSE, POSE_FINGERPRINT = struct.Struct(">Q 10q 4b 3d 9d 4q d 3q 2q d 9d"), 0xDF2A5E439E4A5851
MAP, MAP_FINGERPRINT = struct.Struct(">Q 3q 4i 25q 25d 25d 25d 25d 25i 25i 25i"), 0xD1E81E90487C9F6A
STATUS = ("no_fix", "ambiguous", "fix")
REASON = ("none", "too_few_landmarks", "no_overlap", "symmetric", "deadline", "stale", "device", "moved", "timing", "copy",
          "local_map", "no_scan")
CELL_M = 0.5
CELLS_MAX = 400_000  # of a search: 300 m by 300 m
MARGIN_M = 15.0      # how far a way may lead around the outermost landmark


class Obstacles:
    """Discs (x, y, radius), found by place."""

    def __init__(self, discs):
        self.cell_m = max([1.0] + [2 * disc[2] for disc in discs])
        self.cells = {}
        for disc in discs:
            self.cells.setdefault(self.cell(*disc[:2]), []).append(disc)

    def cell(self, x, y):
        return math.floor(x / self.cell_m), math.floor(y / self.cell_m)

    def near(self, x0, y0, x1, y1):
        """The discs that may touch the box."""
        (a0, b0), (a1, b1) = self.cell(min(x0, x1), min(y0, y1)), self.cell(max(x0, x1), max(y0, y1))
        for a in range(a0 - 1, a1 + 2):
            for b in range(b0 - 1, b1 + 2):
                yield from self.cells.get((a, b), ())

    def distance(self, x0, y0, x1, y1):
        """From the line to the edge of the nearest disc near it; negative within."""
        length = math.hypot(x1 - x0, y1 - y0)
        best = math.inf
        for px, py, radius in self.near(x0, y0, x1, y1):
            along = 0.0 if length == 0 else max(0.0, min(1.0, ((px - x0) * (x1 - x0) + (py - y0) * (y1 - y0)) / length ** 2))
            best = min(best, math.hypot(x0 + along * (x1 - x0) - px, y0 + along * (y1 - y0) - py) - radius)
        return best

    def is_free(self, *line):
        return self.distance(*line) > 0.0


def plan(start, goal, discs):
    """Corners of a way from `start` to `goal`, both included, that stays out of the discs (x, y, radius); a text that says
    why, when there is none."""
    # The carrier stands where it stands: a landmark that it touches already does not keep it from leaving.
    discs = [d for d in discs if math.hypot(d[0] - start[0], d[1] - start[1]) > d[2]]
    obstacles = Obstacles(discs)
    if not obstacles.is_free(*goal, *goal):
        return "the goal is too near to a landmark"
    xs, ys = [d[0] for d in discs] + [start[0], goal[0]], [d[1] for d in discs] + [start[1], goal[1]]
    box = (min(xs) - MARGIN_M, min(ys) - MARGIN_M, max(xs) + MARGIN_M, max(ys) + MARGIN_M)
    way = a_star(start, goal, obstacles, box)
    return way if isinstance(way, str) else cut_corners(way, obstacles)


def a_star(start, goal, obstacles, box):
    """The shortest way over the corners of a grid through `start`."""
    def place(node):
        return start[0] + CELL_M * node[0], start[1] + CELL_M * node[1]

    def left(node):
        x, y = place(node)
        return math.hypot(goal[0] - x, goal[1] - y)
    costs, origins, queue, done = {(0, 0): 0.0}, {}, [(left((0, 0)), (0, 0))], set()
    while queue:
        _, node = heapq.heappop(queue)
        if node in done:
            continue
        done.add(node)
        here = place(node)
        if left(node) <= CELL_M and obstacles.is_free(*here, *goal):
            way = [goal]
            while node in origins:
                way.append(place(node))
                node = origins[node]
            return [start] + way[::-1]
        if len(done) > CELLS_MAX:
            return "the search was given up: the goal is too far"
        for dx, dy in ((1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)):
            then = node[0] + dx, node[1] + dy
            x, y = place(then)
            cost = costs[node] + CELL_M * math.hypot(dx, dy)
            if cost < costs.get(then, math.inf) and box[0] <= x <= box[2] and box[1] <= y <= box[3] and \
                    obstacles.is_free(*here, x, y):
                costs[then], origins[then] = cost, node
                heapq.heappush(queue, (cost + left(then), then))
    return "no way leads to the goal: landmarks are all around"


def cut_corners(way, obstacles):
    """`way` without the corners that nothing asks for."""
    kept, at = [way[0]], 0
    while at + 1 < len(way):
        then = len(way) - 1
        while then > at + 1 and not obstacles.is_free(*way[at], *way[then]):
            then -= 1
        kept.append(way[then])
        at = then
    return kept


class Sensor:
    """What the messages of a sensor have told of its pose and its map."""

    def __init__(self):
        self.start = None      # (x, y, heading) of the last fix
        self.sigma_m = 0.0     # the larger, relative to the landmarks about
        self.reason = "no_scan"
        self.chunks, self.of = {}, None  # landmarks by chunk, and what map they are of
        self.whole = False

    def take(self, message):
        """Whether `message` is a pose."""
        if len(message) == POSE.size and message[:8] == struct.pack(">Q", POSE_FINGERPRINT):
            fields = POSE.unpack(message)
            is_fix = STATUS[fields[11]] == "fix"
            xx, xy, yy = fields[38], fields[39], fields[42]
            self.start = fields[15:18] if is_fix else None
            self.sigma_m = math.sqrt(max(0.0, (xx + yy) / 2 + math.hypot((xx - yy) / 2, xy)))
            self.reason = REASON[fields[12]]
            return True
        if len(message) == MAP.size and message[:8] == struct.pack(">Q", MAP_FINGERPRINT):
            fields = MAP.unpack(message)
            of, chunk, chunks, count = fields[2:4], fields[5], fields[6], fields[7]
            if of != self.of:
                self.of, self.chunks, self.whole = of, {}, False
            self.chunks[chunk] = list(zip(fields[33:33 + count], fields[58:58 + count], fields[108:108 + count]))
            self.whole = len(self.chunks) == chunks
        return False

    def landmarks(self):
        """(x, y, diameter or 0)"""
        return [landmark for chunk in self.chunks.values() for landmark in chunk]


def messages(group, port):
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    sock.bind((group, port))
    sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + bytes(4))
    while True:
        datagram = sock.recv(65536)
        channel, _, message = datagram[8:].partition(b"\0")
        # "LC02" begins a message in one datagram; poses and chunks of maps fit one.
        if datagram[:4] == b"LC02" and channel.endswith((b"_POSE", b"_MAP")):
            yield message


def told(sensor, goal, arguments):
    """The line of a plan."""
    if sensor.start is None:
        return f"no fix ({sensor.reason}): stand still and wait"
    x, y, heading = sensor.start
    begin = f"from {x:.2f} {y:.2f} {math.degrees(heading) % 360:.1f} to {goal[0]:.2f} {goal[1]:.2f}: "
    apart_m = arguments.carrier_radius + 3.0 * sensor.sigma_m
    discs = [(x_m, y_m, (diameter_m / 2 or arguments.landmark_radius) + apart_m) for x_m, y_m, diameter_m in sensor.landmarks()]
    way = plan((x, y), goal, discs)
    if isinstance(way, str):
        return begin + way
    length = sum(math.dist(a, b) for a, b in zip(way, way[1:]))
    return begin + f"{length:.2f} m, {apart_m:.2f} m clear: " + " ".join(f"{a:.2f},{b:.2f}" for a, b in way)


def finite(text):
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text} is no finite number")
    return value


def radius(text):
    value = finite(text)
    if value < 0.0:
        raise argparse.ArgumentTypeError(f"{text} is negative")
    return value


def network(text):
    """Group and port of udpm://GROUP:PORT."""
    url = urlsplit(text)
    group, port = url.hostname or "239.255.76.67", url.port or 7667
    socket.inet_aton(group)
    if url.scheme != "udpm":
        raise ValueError
    return group, port


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("x", type=finite, help="of the goal in the home map, m")
    parser.add_argument("y", type=finite)
    parser.add_argument("--url", default="udpm://239.255.76.67:7667", metavar="udpm://GROUP:PORT", help="the LCM network")
    parser.add_argument("--landmark-radius", type=radius, default=0.4, help="of a landmark without a measured one, m")
    parser.add_argument("--carrier-radius", type=radius, default=0.5, help="of the circle around the carrier, m")
    parser.add_argument("--once", action="store_true", help="end after the first plan from a fix in a whole map")
    arguments = parser.parse_args()
    try:
        group, port = network(arguments.url)
    except (ValueError, OSError):
        parser.error(f"{arguments.url} is no udpm://GROUP:PORT")
    if arguments.landmark_radius + arguments.carrier_radius == 0.0:
        parser.error("one of the radii must be more than 0")
    sensor, seen = Sensor(), False
    for message in messages(group, port):
        seen = sensor.take(message) or seen
        if seen and sensor.whole:
            seen = False
            line = told(sensor, (arguments.x, arguments.y), arguments)
            print(line, flush=True)
            if arguments.once and line.startswith("from"):
                return 0 if " clear: " in line else 1
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # who reads the lines may end first
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        pass
    except OSError as error:
        print(f"plan_path.py: {error.strerror or error}", file=sys.stderr)
        sys.exit(os.EX_UNAVAILABLE)
