"""Compares what slamsensor wrote with the truth. Python standard library only.

A fix is wrong when it lies beyond 1 m or 2 degrees of the truth, grossly wrong beyond 5 m. The map of a drive is
aligned with the truth by the pose of the first fix. Fixes of local maps (`map` is not `home`) are only counted;
each home map is aligned by its own first fix.
Columns are found by their names; a column that is absent leaves its figure out.
"""

import csv
import dataclasses
import math

from geometry import wrap

WRONG_POSITION_M = 1.0
WRONG_HEADING_RAD = math.radians(2.0)
GROSS_POSITION_M = 5.0
HEADING_ARM_M = 10.0
CHI2_3DOF_95 = 7.815
CHI2_3DOF_999 = 16.266


def is_wrong(error_m, turn_rad):
    return error_m > WRONG_POSITION_M or abs(turn_rad) > WRONG_HEADING_RAD


@dataclasses.dataclass
class Verdict:
    """Counts and errors of one or more runs; `add` joins the runs of a kind."""

    runs: int = 1
    scans: int = 0
    fixes: int = 0
    right: int = 0
    wrong: int = 0
    gross: int = 0
    ambiguous: int = 0
    no_fix: int = 0
    local: int = 0  # fixes in local maps, not judged
    no_truth: int = 0  # fixes of scans without a true pose, not judged
    errors_m: list = dataclasses.field(default_factory=list)
    best_wrong: int = 0  # after the best rigid alignment of all fixes of a run
    best_errors_m: list = dataclasses.field(default_factory=list)
    normalised: list = dataclasses.field(default_factory=list)  # squared normalised errors, 3 degrees of freedom
    radii_m: list = dataclasses.field(default_factory=list)
    violations: int = 0  # position errors beyond the protection radius
    times_ms: list = dataclasses.field(default_factory=list)
    last_times_ms: list = dataclasses.field(default_factory=list)  # of the last tenth of each run
    foreign_claims: list = dataclasses.field(default_factory=list)  # expected false alarms of scans without a true pose

    def add(self, other):
        for field in dataclasses.fields(self):
            setattr(self, field.name, getattr(self, field.name) + getattr(other, field.name))

    def judge_pose(self, pose, truth):
        """Counts one fix; both poses are (x_m, y_m, heading_rad) in one frame. Returns the errors."""
        dx_m, dy_m, turn_rad = pose[0] - truth[0], pose[1] - truth[1], wrap(pose[2] - truth[2])
        error_m = math.hypot(dx_m, dy_m)
        self.errors_m.append(error_m)
        if is_wrong(error_m, turn_rad):
            self.wrong += 1
            self.gross += error_m > GROSS_POSITION_M
        else:
            self.right += 1
        return dx_m, dy_m, turn_rad

    def judge_best_alignment(self, pairs):
        """Counts the errors of the pairs of poses (estimate, truth) after their best alignment."""
        to_map = best_alignment(pairs) if pairs else None
        for pose, truth in pairs:
            aligned = to_map(truth)
            error_m = math.hypot(pose[0] - aligned[0], pose[1] - aligned[1])
            self.best_errors_m.append(error_m)
            self.best_wrong += is_wrong(error_m, wrap(pose[2] - aligned[2]))

    def count_time(self, row):
        if row.get("milliseconds"):
            self.times_ms.append(float(row["milliseconds"]))


def read_rows(path):
    with open(path, encoding="ascii", newline="") as file:
        return list(csv.DictReader(file))


def read_tum(path):
    """{scan: (x_m, y_m, heading_rad)} of the plane poses of a TUM file."""
    poses = {}
    with open(path, encoding="ascii") as file:
        for line in file:
            if line.strip() and not line.startswith("#"):
                t, x_m, y_m, _, qx, qy, qz, qw = (float(field) for field in line.split())
                heading_rad = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
                poses[round(t)] = x_m, y_m, heading_rad
    return poses


def pose_of(row):
    return float(row["x_m"]), float(row["y_m"]), float(row["heading_rad"])


def alignment(truth, pose):
    """A function that takes true poses to the frame in which the pose `truth` reads as `pose`."""
    turn_rad = pose[2] - truth[2]
    c, s = math.cos(turn_rad), math.sin(turn_rad)

    def apply(p):
        dx_m, dy_m = p[0] - truth[0], p[1] - truth[1]
        return pose[0] + c * dx_m - s * dy_m, pose[1] + s * dx_m + c * dy_m, wrap(p[2] + turn_rad)

    return apply


def best_alignment(pairs):
    """The alignment that makes the squared distances of the pairs of poses (estimate, truth) least.

    A heading counts as a point at HEADING_ARM_M ahead of the pose, so that few or close poses have an alignment, too.
    """
    ex, ey, tx, ty = (sum(pair[i][k] for pair in pairs) / len(pairs) for i in (0, 1) for k in (0, 1))
    sine = cosine = 0.0
    for e, t in pairs:
        a, b, c, d = e[0] - ex, e[1] - ey, t[0] - tx, t[1] - ty
        sine += c * b - d * a + HEADING_ARM_M**2 * math.sin(e[2] - t[2])
        cosine += c * a + d * b + HEADING_ARM_M**2 * math.cos(e[2] - t[2])
    return alignment((tx, ty, 0.0), (ex, ey, math.atan2(sine, cosine)))


def normalised_error(row, error):
    """error^T C^-1 error with the covariance C of the row; None when the row has none or knows a part exactly."""
    names = ("sigma_x_m", "sigma_y_m", "sigma_heading_rad", "corr_x_y", "corr_x_heading", "corr_y_heading")
    if not all(row.get(name) for name in names):
        return None
    sx, sy, st, a, b, c = (float(row[name]) for name in names)
    determinant = 1.0 + 2.0 * a * b * c - a * a - b * b - c * c
    if min(sx, sy, st) <= 0.0 or determinant <= 1e-9:
        return None
    u, v, w = error[0] / sx, error[1] / sy, error[2] / st
    quadratic = ((1 - c * c) * u * u + (1 - b * b) * v * v + (1 - a * a) * w * w
                 + 2 * (b * c - a) * u * v + 2 * (a * c - b) * u * w + 2 * (a * b - c) * v * w)
    return quadratic / determinant


def is_home(row):
    return row.get("map") in (None, "", row.get("home", "0"))


def judge_drive(fixes_csv, truth):
    """The verdict on the fixes of one replay."""
    verdict, to_map, pairs = Verdict(), {}, {}
    for row in read_rows(fixes_csv):
        verdict.scans += 1
        verdict.count_time(row)
        if row["status"] != "fix":
            verdict.ambiguous += row["status"] == "ambiguous"
            verdict.no_fix += row["status"] == "no_fix"
            continue
        verdict.fixes += 1
        true_pose = truth.get(int(row["scan"]))
        if not is_home(row):
            verdict.local += 1
        elif true_pose is None:
            verdict.no_truth += 1
        else:
            home = row.get("home")
            to_home = to_map.setdefault(home, alignment(true_pose, pose_of(row)))
            judge_fix(verdict, row, to_home(true_pose))
            pairs.setdefault(home, []).append((pose_of(row), true_pose))
    for of_home in pairs.values():
        verdict.judge_best_alignment(of_home)
    verdict.last_times_ms = verdict.times_ms[-max(1, len(verdict.times_ms) // 10):]
    return verdict


def judge_fix(verdict, row, truth_in_map):
    error = verdict.judge_pose(pose_of(row), truth_in_map)
    normalised = normalised_error(row, error)
    if normalised is not None:
        verdict.normalised.append(normalised)
    if row.get("protection_radius_m"):
        radius_m = float(row["protection_radius_m"])
        verdict.radii_m.append(radius_m)
        verdict.violations += math.hypot(error[0], error[1]) > radius_m


def judge_case(poses_csv, truth_csv):
    """The verdict on the answers of one `locate`; every fix of a scan without a true pose is wrong."""
    verdict, truth = Verdict(), {int(row["scan"]): pose_of(row) for row in read_rows(truth_csv)}
    for row in read_rows(poses_csv):
        verdict.scans += 1
        verdict.count_time(row)
        true_pose = truth.get(int(row["scan"]))
        if true_pose is None:
            verdict.foreign_claims.append(float(row.get("expected_false_alarms") or 1.0))
        if row["status"] != "fix":
            verdict.ambiguous += row["status"] == "ambiguous"
            verdict.no_fix += row["status"] == "no_fix"
            continue
        verdict.fixes += 1
        if true_pose is None:
            verdict.wrong += 1
            verdict.gross += 1
        else:
            verdict.judge_pose(pose_of(row), true_pose)
    return verdict


def quantile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))] if values else None


def root_mean_square(values):
    return math.sqrt(sum(v * v for v in values) / len(values)) if values else None


def share_within(values, limit):
    return sum(v <= limit for v in values) / len(values) if values else None


def share_beyond(values, limit):
    return sum(v > limit for v in values) / len(values) if values else None
