"""Plane geometry, tree positions and paths for the generated worlds. Python standard library only."""

import math


def wrap(angle_rad):
    """The same angle in [-pi, pi)."""
    return (angle_rad + math.pi) % (2.0 * math.pi) - math.pi


def to_world(pose, point):
    """A point of the sensor's frame in the frame of the pose (x_m, y_m, heading_rad)."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    return pose[0] + c * point[0] - s * point[1], pose[1] + s * point[0] + c * point[1]


def to_sensor(pose, point):
    """A point of the world in the frame of the sensor at the pose."""
    c, s = math.cos(pose[2]), math.sin(pose[2])
    dx, dy = point[0] - pose[0], point[1] - pose[1]
    return c * dx + s * dy, -s * dx + c * dy


class Grid:
    """Landmarks (x_m, y_m, diameter_m, ...) in square cells, so that the near ones are found quickly."""

    def __init__(self, landmarks=(), cell_m=10.0):
        self.cell_m = cell_m
        self.cells = {}
        for landmark in landmarks:
            self.add(landmark)

    def _key(self, x_m, y_m):
        return math.floor(x_m / self.cell_m), math.floor(y_m / self.cell_m)

    def add(self, landmark):
        self.cells.setdefault(self._key(landmark[0], landmark[1]), []).append(landmark)

    def within(self, x_m, y_m, radius_m):
        """All landmarks within the radius, in a fixed order."""
        low, high = self._key(x_m - radius_m, y_m - radius_m), self._key(x_m + radius_m, y_m + radius_m)
        found = []
        for i in range(low[0], high[0] + 1):
            for j in range(low[1], high[1] + 1):
                for landmark in self.cells.get((i, j), ()):
                    if math.hypot(landmark[0] - x_m, landmark[1] - y_m) <= radius_m:
                        found.append(landmark)
        return found

    def is_free(self, x_m, y_m, spacing_m):
        return not self.within(x_m, y_m, spacing_m)


def trunk_diameter_m(rng):
    return rng.uniform(0.15, 0.6)


def forest(rng, count, area_per_tree_m2=70.0, spacing_m=1.5):
    """Trees thrown at random into a square around the origin, none nearer to another than the spacing."""
    half_m = 0.5 * math.sqrt(count * area_per_tree_m2)
    grid, trees = Grid(cell_m=5.0), []
    while len(trees) < count:
        x_m, y_m = rng.uniform(-half_m, half_m), rng.uniform(-half_m, half_m)
        if grid.is_free(x_m, y_m, spacing_m):
            trees.append((x_m, y_m, trunk_diameter_m(rng)))
            grid.add(trees[-1])
    return trees, half_m


def rows(rng, half_m, between_trees_m=3.0, between_rows_m=5.0, jitter_m=0.2, gaps=0.1):
    """A plantation: trees in rows around the origin, displaced by the jitter, some of them missing."""
    trees = []
    for j in range(round(2.0 * half_m / between_rows_m)):
        for i in range(round(2.0 * half_m / between_trees_m)):
            if rng.random() >= gaps:
                trees.append((-half_m + i * between_trees_m + rng.gauss(0.0, jitter_m),
                              -half_m + j * between_rows_m + rng.gauss(0.0, jitter_m), trunk_diameter_m(rng)))
    return trees


def rounded(corners, radius_m):
    """The polyline with each inner corner replaced by a curve that begins and ends radius_m from the corner."""
    path = [corners[0]]
    for before, corner, after in zip(corners, corners[1:], corners[2:]):
        ends = []
        for other in (before, after):
            length_m = math.hypot(other[0] - corner[0], other[1] - corner[1])
            share = min(0.5, radius_m / max(length_m, 1e-9))
            ends.append((corner[0] + share * (other[0] - corner[0]), corner[1] + share * (other[1] - corner[1])))
        for t in (0.0, 0.25, 0.5, 0.75, 1.0):
            a, b, c = (1 - t) ** 2, 2 * t * (1 - t), t * t
            path.append(tuple(a * p + b * q + c * r for p, q, r in zip(ends[0], corner, ends[1])))
    path.append(corners[-1])
    return path


def poses_along(path, step_m):
    """A pose (x_m, y_m, heading_rad) each step_m along the polyline; the heading follows the path."""
    poses, travelled_m, next_m = [], 0.0, 0.0
    for a, b in zip(path, path[1:]):
        length_m = math.hypot(b[0] - a[0], b[1] - a[1])
        while length_m > 0.0 and next_m <= travelled_m + length_m:
            share = (next_m - travelled_m) / length_m
            poses.append((a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]),
                          math.atan2(b[1] - a[1], b[0] - a[0])))
            next_m += step_m
        travelled_m += length_m
    return poses


def winding(rng, half_m, scans, step_m, start=(0.0, 0.0)):
    """A drive that winds through the square around the origin and turns back before its border."""
    x_m, y_m = start
    heading_rad, turn_rad_per_m, poses = rng.uniform(-math.pi, math.pi), 0.0, []
    while len(poses) < scans:
        poses.append((x_m, y_m, wrap(heading_rad)))
        turn_rad_per_m = 0.9 * turn_rad_per_m + rng.gauss(0.0, 0.006)
        heading_rad += turn_rad_per_m * step_m
        if max(abs(x_m), abs(y_m)) > half_m:
            inward_rad = wrap(math.atan2(-y_m, -x_m) - heading_rad)
            heading_rad += max(-0.4, min(0.4, inward_rad))
        x_m += step_m * math.cos(heading_rad)
        y_m += step_m * math.sin(heading_rad)
    return poses


def shaken(rng, pose, position_m=0.3, heading_rad=0.1):
    """The pose with a little of a driver's unsteadiness, so that no round repeats another exactly."""
    return (pose[0] + rng.gauss(0.0, position_m), pose[1] + rng.gauss(0.0, position_m),
            wrap(pose[2] + rng.gauss(0.0, heading_rad)))


def anywhere(rng, half_m):
    return rng.uniform(-half_m, half_m), rng.uniform(-half_m, half_m), rng.uniform(-math.pi, math.pi)
