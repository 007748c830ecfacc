#!/usr/bin/env python3
"""Worlds with known truth for `slamsensor replay` and `slamsensor locate`. Python standard library only.

    worlds.py KIND --seed N --out FOLDER        writes landmarks.csv and truth.tum (drives), or
                                                map.csv, scans.csv and truth.csv (cases of locate)
    worlds.py --list                            names all kinds

A kind and a seed give the same bytes on every run. Seeds below 1001 are for tuning; seeds from 1001 on are held
out: nothing may be tuned on them. A scan that sees nothing has no row; only its number is skipped.
"""

import argparse
import dataclasses
import math
import os
import pathlib
import random
import sys
import typing

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import geometry as geo  # noqa: E402

HELD_OUT_FIRST_SEED = 1001


@dataclasses.dataclass
class Sensor:
    """How a landmark sensor sees a world. All seeds of a kind share it, except where the kind says otherwise."""

    range_m: float = 25.0
    dropped: float = 0.3  # chance that a landmark within range is not seen in a scan
    spurious: float = 2.0  # mean count of points per scan that are no landmark
    sigma_m: float = 0.15  # of each coordinate
    landmarks_max: int = 60
    tells_diameter: bool = True  # else every diameter reads about 0.3 m
    random_weights: bool = False  # else the nearest landmark weighs most


@dataclasses.dataclass
class Scan:
    number: int
    pose: tuple  # true x_m, y_m, heading_rad
    landmarks: list  # (x_m, y_m, diameter_m, weight) in the sensor's frame, heaviest first


@dataclasses.dataclass
class Case:
    """A frozen map and independent scans in it; a pose of None: the scan was not taken in this map."""

    map: list
    scans: list


def poisson(rng, mean):
    """A Poisson number by Knuth's product of uniform numbers; the mean is small."""
    count, product, limit = 0, rng.random(), math.exp(-mean)
    while product > limit:
        count += 1
        product *= rng.random()
    return count


def sighting(rng, sensor, point_L, diameter_m):
    seen_m = diameter_m if sensor.tells_diameter else 0.3
    return (point_L[0] + rng.gauss(0.0, sensor.sigma_m), point_L[1] + rng.gauss(0.0, sensor.sigma_m),
            max(0.02, seen_m * (1.0 + rng.gauss(0.0, 0.1))))


def spurious_point(rng, sensor, range_m):
    distance_m, bearing_rad = range_m * math.sqrt(rng.random()), rng.uniform(-math.pi, math.pi)
    return (distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad),
            geo.trunk_diameter_m(rng) if sensor.tells_diameter else 0.3 * (1.0 + rng.gauss(0.0, 0.1)))


def observe(rng, sensor, pose, landmarks):
    """What the sensor reports at the pose of the world's landmarks near it, heaviest first."""
    seen = []
    for landmark in landmarks:
        if rng.random() >= sensor.dropped:
            seen.append(sighting(rng, sensor, geo.to_sensor(pose, landmark), landmark[2]))
    if landmarks:
        seen += [spurious_point(rng, sensor, sensor.range_m) for _ in range(poisson(rng, sensor.spurious))]
    return by_weight(sensor, seen)[:sensor.landmarks_max]


def by_weight(sensor, seen):
    """The sightings (x_m, y_m, diameter_m) with their weights, heaviest first."""

    def weight(x_m, y_m):
        if sensor.random_weights:  # drawn from the place: the drive's own random numbers stay what they are
            return 100.0 * random.Random(f"{x_m}:{y_m}").random()
        return 100.0 / (1.0 + math.hypot(x_m, y_m))

    return sorted(((x, y, d, weight(x, y)) for x, y, d in seen), key=lambda sighted: -sighted[3])


def drive_through(rng, sensor, poses, world):
    """The scans of a drive. `world` gives the landmarks near a pose: a Grid or a function (scan, pose)."""
    scans = []
    for number, pose in enumerate(poses):
        if isinstance(world, geo.Grid):
            near = world.within(pose[0], pose[1], sensor.range_m)
        else:
            near = world(number, pose)
        scans.append(Scan(number, pose, observe(rng, sensor, pose, near)))
    return scans


def sensor_of(seed, **values):
    """Even seeds measure the trunk's diameter, odd ones do not; of four seeds in a row two weigh at random."""
    return Sensor(tells_diameter=seed % 2 == 0, random_weights=seed // 2 % 2 == 1, **values)


# --- Forests -----------------------------------------------------------------------------------------------------


def forest_loop(rng, seed, sigma_m=0.15):
    """6,000 trees, two rounds of a wavy loop of about 1 km."""
    trees, _ = geo.forest(rng, 6000)
    waves = [(k, rng.uniform(2.0, 12.0) / k, rng.uniform(0.0, 2.0 * math.pi)) for k in (2, 3, 5)]

    def at(angle_rad):
        radius_m = 156.0 + sum(a * math.sin(k * angle_rad + p) for k, a, p in waves)
        return radius_m * math.cos(angle_rad), radius_m * math.sin(angle_rad)

    path = [at(2.0 * math.pi * i / 500.0) for i in range(1001)]
    poses = [geo.shaken(rng, pose) for pose in geo.poses_along(path, 7.0)]
    return drive_through(rng, sensor_of(seed, sigma_m=sigma_m), poses, geo.Grid(trees))


def forest_loop_fine(rng, seed):
    """The loop with a finer sensor: hardly a scan is lost, so that drift and its closing are what is measured."""
    return forest_loop(rng, seed, sigma_m=0.07)


def forest_wide(rng, seed):
    """20,000 trees, a long winding drive of 3.6 km."""
    trees, half_m = geo.forest(rng, 20000)
    poses = geo.winding(rng, half_m - 100.0, 600, 6.0)
    sensor = sensor_of(seed)
    return drive_through(rng, sensor, poses, geo.Grid(trees))


def cold_start(rng, seed):
    """The first scan has two to four landmarks; then a normal drive."""
    trees, half_m = geo.forest(rng, 1500)
    poses = geo.winding(rng, half_m - 40.0, 120, 4.0)
    scans = drive_through(rng, sensor_of(seed), poses, geo.Grid(trees))
    kept = rng.sample(range(len(scans[0].landmarks)), rng.randint(2, 4))
    scans[0].landmarks = [scans[0].landmarks[i] for i in sorted(kept)]
    return scans


def stand(rng, seed):
    """A managed stand, 500 stems a hectare: a winding drive, then 40 kidnaps to places about it."""
    trees, half_m = geo.forest(rng, 2000, area_per_tree_m2=20.0)
    poses = geo.winding(rng, half_m - 30.0, 100, 4.0)
    for _ in range(40):
        x_m, y_m, _ = rng.choice(poses[:100])
        poses.append(geo.shaken(rng, (x_m, y_m, rng.uniform(-math.pi, math.pi)), 2.0, 0.1))
    return drive_through(rng, sensor_of(seed), poses, geo.Grid(trees))


def garden(rng, seed):
    """A sensor of 10 to 15 m reach among trees and posts: a winding drive, then 40 kidnaps to places about it."""
    range_m = rng.uniform(10.0, 15.0)
    trees, half_m = geo.forest(rng, 1000, area_per_tree_m2=0.16 * range_m**2)
    poses = geo.winding(rng, half_m - 0.7 * range_m, 160, 0.15 * range_m)
    for _ in range(40):
        x_m, y_m, _ = rng.choice(poses[:160])
        poses.append(geo.shaken(rng, (x_m, y_m, rng.uniform(-math.pi, math.pi)), 1.0, 0.1))
    return drive_through(rng, sensor_of(seed, range_m=range_m, dropped=0.2, spurious=1.0, sigma_m=0.05), poses,
                         geo.Grid(trees))


def plantation(rng, seed):
    """Rows of trees, 3 by 5 m: a winding drive, then 40 kidnaps."""
    half_m = 75.0
    trees = geo.rows(rng, half_m, jitter_m=rng.uniform(0.1, 0.3))
    poses = geo.winding(rng, half_m - 25.0, 100, 4.0)
    poses += [geo.anywhere(rng, half_m - 15.0) for _ in range(40)]
    sensor = sensor_of(seed, range_m=20.0, sigma_m=0.1)
    return drive_through(rng, sensor, poses, geo.Grid(trees))


# --- Streets -----------------------------------------------------------------------------------------------------

PARKED_CAR_SLOT_M = 6.0
CARS_LEAVE_AFTER_SCANS = 25


class City:
    """Streets along the lines of a grid, lined with lamp posts and trees; parked cars differ between passes."""

    BUILDING_SETBACK_M = 10.0

    def __init__(self, rng, blocks):
        self.rng = rng
        is_regular = rng.random() < 0.5  # every block as long as the next one, or not
        size_m = (rng.uniform(80.0, 120.0), rng.uniform(70.0, 110.0))
        self.lines = [[0.0], [0.0]]  # x of the streets along y, y of the streets along x
        for axis in (0, 1):
            for _ in range(blocks):
                length_m = size_m[axis] if is_regular else size_m[axis] + rng.uniform(-15.0, 15.0)
                self.lines[axis].append(self.lines[axis][-1] + length_m)
        jitter_m, gaps = rng.uniform(0.1, 0.3), rng.uniform(0.1, 0.2)
        self.fixed = geo.Grid()
        self.streets = list(self._streets(blocks))
        self.cars, self.seen_at = {}, {}
        for street in self.streets:
            self._line(street, 25.0, 6.0, 0.05, 0.03, lambda: 0.15)
            self._line(street, 8.0, 8.0, jitter_m, gaps, lambda: geo.trunk_diameter_m(rng))

    def corner(self, i, j):
        return self.lines[0][i], self.lines[1][j]

    def _streets(self, blocks):
        for i in range(blocks + 1):
            for j in range(blocks + 1):
                if i < blocks:
                    yield self.corner(i, j), self.corner(i + 1, j)
                if j < blocks:
                    yield self.corner(i, j), self.corner(i, j + 1)

    @staticmethod
    def _beside(street, along_m, aside_m):
        (ax, ay), (bx, by) = street
        length_m = math.hypot(bx - ax, by - ay)
        ux, uy = (bx - ax) / length_m, (by - ay) / length_m
        return ax + along_m * ux - aside_m * uy, ay + along_m * uy + aside_m * ux

    def _line(self, street, spacing_m, aside_m, jitter_m, gaps, diameter):
        length_m = math.hypot(street[1][0] - street[0][0], street[1][1] - street[0][1])
        for side in (-aside_m, aside_m):
            along_m = 12.5
            while along_m < length_m - 9.0:
                if self.rng.random() >= gaps:
                    x_m, y_m = self._beside(street, along_m, side)
                    self.fixed.add((x_m + self.rng.gauss(0.0, jitter_m), y_m + self.rng.gauss(0.0, jitter_m),
                                    diameter()))
                along_m += spacing_m

    def _parked(self, street):
        length_m = math.hypot(street[1][0] - street[0][0], street[1][1] - street[0][1])
        cars, along_m = [], 12.0
        while along_m < length_m - 12.0:
            for side in (-4.0, 4.0):
                if self.rng.random() < 0.25:
                    x_m, y_m = self._beside(street, along_m + self.rng.uniform(-1.0, 1.0), side)
                    cars.append((x_m, y_m, self.rng.uniform(0.3, 0.8)))
            along_m += PARKED_CAR_SLOT_M
        return cars

    def _is_behind_building(self, pose, point):
        for share in (0.2, 0.4, 0.6, 0.8):
            position = [pose[k] + share * (point[k] - pose[k]) for k in (0, 1)]
            if all(self.lines[k][0] < position[k] < self.lines[k][-1]
                   and min(abs(position[k] - line) for line in self.lines[k]) > self.BUILDING_SETBACK_M
                   for k in (0, 1)):
                return True
        return False

    def near(self, range_m, number, pose):
        found = self.fixed.within(pose[0], pose[1], range_m)
        for street in self.streets:
            (ax, ay), (bx, by) = street
            nearest = max(min(ax, bx), min(pose[0], max(ax, bx))), max(min(ay, by), min(pose[1], max(ay, by)))
            if math.hypot(nearest[0] - pose[0], nearest[1] - pose[1]) > range_m:
                continue
            if number - self.seen_at.get(street, -10**6) > CARS_LEAVE_AFTER_SCANS:
                self.cars[street] = self._parked(street)
            self.seen_at[street] = number
            found += [car for car in self.cars[street]
                      if math.hypot(car[0] - pose[0], car[1] - pose[1]) <= range_m]
        return [landmark for landmark in found if not self._is_behind_building(pose, landmark)]

    def random_path(self, blocks, corners):
        """Corner to corner along the streets, never straight back."""
        i, j = self.rng.randint(1, blocks - 1), self.rng.randint(1, blocks - 1)
        path, back = [self.corner(i, j)], None
        while len(path) < corners:
            ways = [(di, dj) for di, dj in ((1, 0), (-1, 0), (0, 1), (0, -1))
                    if 0 <= i + di <= blocks and 0 <= j + dj <= blocks and (di, dj) != back]
            di, dj = self.rng.choice(ways)
            i, j, back = i + di, j + dj, (-di, -dj)
            path.append(self.corner(i, j))
        return geo.rounded(path, 6.0)


def street(rng, seed):
    """A city grid with lamp posts, trees and parked cars: a car's drive through many blocks."""
    blocks = rng.randint(3, 5)
    city = City(rng, blocks)
    poses = geo.poses_along(city.random_path(blocks, 18), rng.uniform(4.0, 6.0))
    poses = [geo.shaken(rng, pose, 0.3, 0.03) for pose in poses[:rng.randint(150, 400)]]
    sensor = sensor_of(seed, range_m=30.0, dropped=rng.uniform(0.2, 0.3), spurious=1.0, sigma_m=0.1)
    return drive_through(rng, sensor, poses, lambda number, pose: city.near(sensor.range_m, number, pose))


def road(rng, seed):
    """Trees every 10 m on both sides of a straight road, rare distinct things; a pass, then 40 kidnaps."""
    length_m, jitter_m = 600.0, rng.uniform(0.0, 0.2)
    things = []
    for i in range(round(length_m / 10.0)):
        for side in (-6.0, 6.0):
            things.append((10.0 * i + rng.gauss(0.0, jitter_m), side + rng.gauss(0.0, jitter_m),
                           geo.trunk_diameter_m(rng)))
    for _ in range(round(length_m / 80.0)):
        things.append((rng.uniform(0.0, length_m), rng.choice((-1, 1)) * rng.uniform(8.0, 15.0),
                       geo.trunk_diameter_m(rng)))
    poses = [geo.shaken(rng, (x_m, 0.0, 0.0), 0.2, 0.03) for x_m in range(60, 460, 4)]
    for _ in range(40):
        heading_rad = rng.choice((0.0, math.pi))
        poses.append(geo.shaken(rng, (rng.uniform(20.0, 580.0), 0.0, heading_rad), 0.5, 0.1))
    sensor = sensor_of(seed, dropped=0.25, spurious=1.0, sigma_m=0.1)
    return drive_through(rng, sensor, poses, geo.Grid(things))


# --- Copies ------------------------------------------------------------------------------------------------------

COPSE_RADIUS_M = 10.0
COPSE_DISTANCE_M = 60.0


def ring_point(rng, inner_m, outer_m):
    distance_m, bearing_rad = rng.uniform(inner_m, outer_m), rng.uniform(-math.pi, math.pi)
    return distance_m * math.cos(bearing_rad), distance_m * math.sin(bearing_rad)


def copse(rng):
    grid, trees, wanted = geo.Grid(cell_m=5.0), [], rng.randint(10, 20)
    while len(trees) < wanted:
        x_m, y_m = ring_point(rng, 0.0, COPSE_RADIUS_M)
        if grid.is_free(x_m, y_m, 2.0):
            trees.append((x_m, y_m, geo.trunk_diameter_m(rng)))
            grid.add(trees[-1])
    return trees


def two_copses(rng, seed, distinct):
    """Two copies of a copse, `distinct` trees of its own beside each; A, then B, then both in turn."""
    jitter_m, trees = rng.choice((0.0, 0.02, 0.05)), copse(rng)
    places = [(0.0, 0.0, 0.0), (COPSE_DISTANCE_M, 0.0, rng.uniform(-math.pi, math.pi))]
    world = geo.Grid()
    for place, count in zip(places, distinct):
        own = [(*ring_point(rng, COPSE_RADIUS_M + 2.0, 22.0), geo.trunk_diameter_m(rng)) for _ in range(count)]
        for x_m, y_m, diameter_m in trees + own:
            x_W, y_W = geo.to_world(place, (x_m, y_m))
            world.add((x_W + rng.gauss(0.0, jitter_m), y_W + rng.gauss(0.0, jitter_m), diameter_m))

    def visit(which, scans):
        stands = [ring_point(rng, 0.0, 8.0) for _ in range(scans)]
        return [(*geo.to_world(places[which], stand), rng.uniform(-math.pi, math.pi)) for stand in stands]

    drives_between = rng.random() < 0.5  # else the sensor is kidnapped from one to the other
    poses = visit(0, 12)
    for which, scans in [(1, 12)] + [(0, 5), (1, 5)] * 4:
        stands = visit(which, scans)
        if drives_between:
            poses += geo.poses_along([poses[-1][:2], stands[0][:2]], 4.0)[1:]
        poses += stands
    sensor = sensor_of(seed, dropped=0.2, spurious=1.0, sigma_m=0.08)
    return drive_through(rng, sensor, poses, world)


def twin(rng, seed):
    """Twin copses that differ: 0 to 6 distinct trees beside each, at least three in all."""
    distinct = (0, 0)
    while sum(distinct) < 3:
        distinct = rng.randint(0, 6), rng.randint(0, 6)
    return two_copses(rng, seed, distinct)


def twin_bare(rng, seed):
    """Perfect twins with nothing beside them: no single scan can tell one from the other."""
    return two_copses(rng, seed, (0, 0))


def gardens_alike(rng, seed):
    """A garden stands twice in land of its own, and is as wide as the sensor's view: A and B in turn."""
    size_m, range_m = rng.uniform(10.0, 12.0), rng.uniform(12.0, 14.0)
    beds = [(rng.uniform(-0.5, 0.5) * size_m, rng.uniform(-0.5, 0.5) * size_m, 0.2) for _ in range(18)]
    places = [(0.0, 0.0, 0.0), (80.0, 0.0, rng.uniform(-math.pi, math.pi))]
    world = geo.Grid()
    for place in places:
        for x_m, y_m, diameter_m in beds:
            world.add((*geo.to_world(place, (x_m, y_m)), diameter_m))
        for _ in range(40):
            x_m, y_m = rng.uniform(-18.0, 18.0), rng.uniform(-18.0, 18.0)
            if max(abs(x_m), abs(y_m)) > 0.5 * size_m + 1.0:
                world.add((*geo.to_world(place, (x_m, y_m)), 0.2))
    poses = []
    for number in range(90):
        stand = rng.uniform(-6.0, 6.0), rng.uniform(-6.0, 6.0)
        place = places[0 if number < 12 else number % 2]
        poses.append((*geo.to_world(place, stand), rng.uniform(-math.pi, math.pi)))
    sensor = sensor_of(seed, range_m=range_m, dropped=0.08, spurious=0.5, sigma_m=0.04)
    return drive_through(rng, sensor, poses, world)


# --- Real tree positions -----------------------------------------------------------------------------------------


def data_folder():
    default = pathlib.Path(__file__).resolve().parents[2] / "../shared/data"
    return pathlib.Path(os.environ.get("SLAMSENSOR_DATA", default))


def stem_map(rng, name):
    """Rows of numbers of a stem map, with a diameter of our own."""
    with open(data_folder() / "stem_maps" / name, encoding="ascii") as file:
        lines = [line.split(",") for line in file if line[0].isdigit() or line[0] == "-"]
    return [(*(float(field) for field in line), geo.trunk_diameter_m(rng)) for line in lines]


class ChangingForest:
    """Trees of which a third is replaced, each at a random time of the drive, by a new one a few metres away."""

    def __init__(self, rng, trees, scans):
        self.grid = geo.Grid()
        for x_m, y_m, diameter_m in trees:
            if rng.random() >= 1.0 / 3.0:
                self.grid.add((x_m, y_m, diameter_m, 0, scans))
                continue
            at = rng.randrange(scans)
            self.grid.add((x_m, y_m, diameter_m, 0, at))
            dx_m, dy_m = ring_point(rng, 2.0, 6.0)
            self.grid.add((x_m + dx_m, y_m + dy_m, geo.trunk_diameter_m(rng), at, scans))

    def near(self, range_m, number, pose):
        return [t for t in self.grid.within(pose[0], pose[1], range_m) if t[3] <= number < t[4]]


def with_kidnaps(rng, poses, places, count, scans_each):
    """The drive, interrupted `count` times by a few scans around one of the places."""
    interrupted = set(rng.sample(range(20, len(poses) - 1), count))
    result = []
    for number, pose in enumerate(poses):
        result.append(pose)
        if number in interrupted:
            x_m, y_m = rng.choice(places)
            heading_rad = rng.uniform(-math.pi, math.pi)
            for i in range(scans_each):
                there = (x_m + 4.0 * i * math.cos(heading_rad), y_m + 4.0 * i * math.sin(heading_rad), heading_rad)
                result.append(geo.shaken(rng, there))
    return result


PARK_CELL_M = 10.0
PARK_TREES_MIN = 14


def rich_cells(grid, trees, range_m):
    """Centres of the cells from which at least PARK_TREES_MIN trees are within range."""
    cells = {(math.floor(t[0] / PARK_CELL_M), math.floor(t[1] / PARK_CELL_M)) for t in trees}
    centres = [((i + 0.5) * PARK_CELL_M, (j + 0.5) * PARK_CELL_M) for i, j in sorted(cells)]
    return [c for c in centres if len(grid.within(c[0], c[1], range_m)) >= PARK_TREES_MIN]


def connected(cells, reach_m=25.0):
    """The largest group of cells whose members lie within reach of each other."""
    grid, groups, seen = geo.Grid(cells, reach_m), [], set()
    for first in cells:
        if first in seen:
            continue
        group, open_cells = [], [first]
        seen.add(first)
        while open_cells:
            cell = open_cells.pop()
            group.append(cell)
            for other in grid.within(cell[0], cell[1], reach_m):
                if other not in seen:
                    seen.add(other)
                    open_cells.append(other)
        groups.append(group)
    return max(groups, key=len)


def walk_between(cells, start, goal, reach_m=25.0):
    """The shortest chain of cells from start to goal, by breadth first search."""
    grid, came_from, open_cells = geo.Grid(cells, reach_m), {start: None}, [start]
    for cell in open_cells:
        if cell == goal:
            break
        for other in grid.within(cell[0], cell[1], reach_m):
            if other not in came_from:
                came_from[other] = cell
                open_cells.append(other)
    path = [goal]
    while came_from[path[-1]] is not None:
        path.append(came_from[path[-1]])
    return path[::-1]


def park_path(rng, cells, length_m):
    """A closed walk of at least length_m over the cells, and its first 600 m once more."""
    start = rng.choice(cells)
    path, walked_m = [start], 0.0
    while walked_m < length_m or path[-1] != start:
        goal = start if walked_m > length_m - 300.0 else rng.choice(cells)
        leg = walk_between(cells, path[-1], goal)
        walked_m += sum(math.hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(leg, leg[1:]))
        path += leg[1:]
        if len(leg) == 1 and goal == start:
            walked_m = max(walked_m, length_m)
    return geo.rounded(path + path[1:40], 6.0)


def portland(rng, seed):
    """A 5 km drive in one of the largest parks, closed; 100 kidnaps to other parks; a third of the trees replaced."""
    rows = stem_map(rng, "portland_parks.csv")
    trees = [row[1:] for row in rows]
    sensor = sensor_of(seed, range_m=35.0)
    grid = geo.Grid(trees)
    home = rng.randrange(6)
    cells = connected(rich_cells(grid, [row[1:] for row in rows if row[0] == home], sensor.range_m))
    elsewhere = [row[1:] for row in rows if row[0] != home]
    places = rich_cells(grid, rng.sample(elsewhere, 4000), sensor.range_m)
    poses = [geo.shaken(rng, p) for p in geo.poses_along(park_path(rng, cells, 5000.0), 4.0)]
    poses = with_kidnaps(rng, poses, places, 100, 2)
    world = ChangingForest(rng, trees, len(poses))
    return drive_through(rng, sensor, poses, lambda number, pose: world.near(sensor.range_m, number, pose))


def flight(rng, seed):
    """A survey flight over `bei` in lines 45 m apart, and a line across; 40 kidnaps ahead; a third replaced."""
    trees = stem_map(rng, "bei.csv")
    corners = []
    for k, y_m in enumerate(range(40, 470, 45)):
        corners += [(40.0, y_m), (960.0, y_m)] if k % 2 == 0 else [(960.0, y_m), (40.0, y_m)]
    corners += [(500.0, 450.0), (500.0, 40.0), (60.0, 40.0)]
    poses = [geo.shaken(rng, p, 1.0, 0.05) for p in geo.poses_along(geo.rounded(corners, 15.0), 12.0)]
    places = [(rng.uniform(60.0, 940.0), rng.uniform(260.0, 440.0)) for _ in range(60)]
    poses = with_kidnaps(rng, poses[:400], places, 40, 2) + poses[400:]
    sensor = sensor_of(seed, range_m=35.0)
    world = ChangingForest(rng, trees, len(poses))
    return drive_through(rng, sensor, poses, lambda number, pose: world.near(sensor.range_m, number, pose))


# --- Cases of locate ---------------------------------------------------------------------------------------------


@dataclasses.dataclass
class CaseKind:
    trees: int = 1000
    nearest: int = 20
    dropped: float = 0.3
    spurious: int = 5
    sigma_m: float = 0.15
    foreign: bool = False
    rows: bool = False


CASES = {
    "forest_1k": CaseKind(),
    "forest_10k": CaseKind(trees=10000),
    "noisy_1k": CaseKind(sigma_m=0.30),
    "noisy_10k": CaseKind(trees=10000, sigma_m=0.30),
    "few_1k": CaseKind(nearest=10, spurious=2),
    "few_noisy_1k": CaseKind(nearest=10, spurious=2, sigma_m=0.30),
    "half_10k": CaseKind(trees=10000, dropped=0.5, spurious=10, sigma_m=0.30),
    "rows": CaseKind(rows=True),
    "foreign_1k": CaseKind(foreign=True),
    "foreign_10k": CaseKind(trees=10000, foreign=True),
}


def nearest_trees(grid, pose, count):
    radius_m = 10.0
    while True:
        near = grid.within(pose[0], pose[1], radius_m)
        if len(near) >= count:
            return sorted(near, key=lambda t: math.hypot(t[0] - pose[0], t[1] - pose[1]))[:count]
        radius_m *= 1.4


def case_scan(rng, kind, number, pose, grid):
    """The nearest trees without the dropped ones, among spurious points over the same disc, nearest first."""
    near = nearest_trees(grid, pose, kind.nearest)
    range_m = math.hypot(near[-1][0] - pose[0], near[-1][1] - pose[1])
    sensor = Sensor(sigma_m=kind.sigma_m)
    kept = [tree for tree in near if rng.random() >= kind.dropped]
    seen = [sighting(rng, sensor, geo.to_sensor(pose, tree), tree[2]) for tree in kept]
    seen += [spurious_point(rng, sensor, range_m) for _ in range(kind.spurious)]
    return Scan(number, pose, by_weight(sensor, seen))


def make_case(rng, kind, queries):
    def world():
        if kind.rows:
            half_m = 61.0  # about 900 trees
            return geo.rows(rng, half_m), half_m
        return geo.forest(rng, kind.trees)

    trees, half_m = world()
    seen, seen_half_m = world() if kind.foreign else (trees, half_m)
    grid = geo.Grid(seen)
    scans = []
    for number in range(queries):
        scan = case_scan(rng, kind, number, geo.anywhere(rng, seen_half_m - 15.0), grid)
        scans.append(dataclasses.replace(scan, pose=None) if kind.foreign else scan)
    return Case(trees, scans)


# --- Table of kinds and files ------------------------------------------------------------------------------------


@dataclasses.dataclass
class DriveKind:
    make: typing.Callable
    never_wrong: bool = True
    # So far from the first scan that the noise of its heading alone (0.1 to 0.2 degrees) moves the map by a metre: the
    # verdict counts the errors after the best alignment.
    far: bool = False
    needs_data: bool = False


DRIVES = {
    "forest_loop": DriveKind(forest_loop),
    "forest_loop_fine": DriveKind(forest_loop_fine),
    "forest_wide": DriveKind(forest_wide, far=True),
    "street": DriveKind(street),
    "twin": DriveKind(twin),
    "twin_bare": DriveKind(twin_bare, never_wrong=False),
    "gardens_alike": DriveKind(gardens_alike),
    "road": DriveKind(road),
    "stand": DriveKind(stand),
    "garden": DriveKind(garden, far=True),
    "plantation": DriveKind(plantation),
    "cold_start": DriveKind(cold_start),
    "portland": DriveKind(portland, far=True, needs_data=True),
    "flight": DriveKind(flight, far=True, needs_data=True),
}


def seeded(kind, seed):
    return random.Random(f"{kind}:{seed}")


def make_drive(kind, seed):
    return DRIVES[kind].make(seeded(kind, seed), seed)


def write_landmarks(path, scans):
    with open(path, "w", encoding="ascii") as file:
        file.write("scan,x_m,y_m,diameter_m,weight\n")
        for scan in scans:
            for x_m, y_m, diameter_m, weight in scan.landmarks:
                file.write(f"{scan.number},{x_m:.4f},{y_m:.4f},{diameter_m:.3f},{weight:.4f}\n")


def write_drive(folder, scans):
    write_landmarks(folder / "landmarks.csv", scans)
    with open(folder / "truth.tum", "w", encoding="ascii") as file:
        for scan in scans:
            x_m, y_m, heading_rad = scan.pose
            file.write(f"{scan.number} {x_m:.6f} {y_m:.6f} 0 0 0 "
                       f"{math.sin(0.5 * heading_rad):.9f} {math.cos(0.5 * heading_rad):.9f}\n")


def write_case(folder, case):
    write_landmarks(folder / "scans.csv", case.scans)
    with open(folder / "map.csv", "w", encoding="ascii") as file:
        file.write("id,x_m,y_m\n")
        for number, tree in enumerate(case.map):
            file.write(f"{number},{tree[0]:.4f},{tree[1]:.4f}\n")
    with open(folder / "truth.csv", "w", encoding="ascii") as file:
        file.write("scan,x_m,y_m,heading_rad\n")
        for scan in case.scans:
            if scan.pose is not None:
                file.write(f"{scan.number},{scan.pose[0]:.6f},{scan.pose[1]:.6f},{scan.pose[2]:.9f}\n")


def write_world(kind, seed, folder, queries=200):
    folder.mkdir(parents=True, exist_ok=True)
    if kind in CASES:
        write_case(folder, make_case(seeded(kind, seed), CASES[kind], queries))
    else:
        write_drive(folder, make_drive(kind, seed))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("kind", nargs="?", choices=[*DRIVES, *CASES])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--queries", type=int, default=200, help="scans of a case of locate")
    parser.add_argument("--out", type=pathlib.Path)
    parser.add_argument("--list", action="store_true")
    options = parser.parse_args()
    if options.list:
        for kind, drive in DRIVES.items():
            print(f"{kind:12} replay  {drive.make.__doc__.splitlines()[0]}")
        for kind, case in CASES.items():
            print(f"{kind:12} locate  {case}")
        return
    if options.kind is None or options.out is None:
        parser.error("name a KIND and --out FOLDER, or --list")
    write_world(options.kind, options.seed, options.out, options.queries)


if __name__ == "__main__":
    main()
