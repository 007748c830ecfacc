"""A made drive of a sensor as LCM messages, of which every number is known: what the page must show."""
import math
import random

import lcm_types

T0 = 1_795_439_100.0  # 2026-11-23T13:05:00Z
FIX, AMBIGUOUS, NO_FIX = 2, 1, 0
NO_OVERLAP, SYMMETRIC, LOCAL_MAP = 2, 3, 10


def landmarks(count, reach_m, seed=1):
    draw = random.Random(seed)
    return [(round(draw.uniform(-reach_m, reach_m), 3), round(draw.uniform(-reach_m, reach_m), 3)) for _ in range(count)]


def xi_of(i):
    return i % 9


def sigma_of(i):
    """Of every fifth landmark nothing is known."""
    return 0.0 if i % 5 == 0 else 0.05 * (1 + i % 7)


def diameter_of(i):
    """Of every fifth landmark nothing is known."""
    return i % 5 * 0.25


def map_messages(points, revision=1):
    per = 25
    chunks = max(1, -(-len(points) // per))
    for chunk in range(chunks):
        part = range(chunk * per, min(len(points), (chunk + 1) * per))
        yield "SLAMSENSOR_MAP", lcm_types.encode(
            "map_t", initialization=7, revision=revision, landmarks=len(points), chunk=chunk, chunks=chunks,
            count=len(part), id=list(part), x_m=[points[i][0] for i in part], y_m=[points[i][1] for i in part], sigma_m=[sigma_of(i) for i in part],
            diameter_m=[diameter_of(i) for i in part],
            xi=[xi_of(i) for i in part], sightings=[3 + i % 5 for i in part])


def pose_message(scan, pose, status=FIX, reason=0, map_number=1, **more):
    second = 1_000_000_000
    x, y, heading = pose
    covariance = [0.09, 0.02, 0, 0.02, 0.04, 0, 0, 0, 0.0001]
    fields = dict(initialization=7, scan=scan, status=status, reason=reason, x_m=x, y_m=y, heading_rad=heading,
                  covariance=covariance, covariance_near=[c / 9 for c in covariance], error_xi=2, matches=22,
                  landmarks_seen=28, landmarks_in_map=100, expected_false_alarms=1e-12, weight_best=220,
                  weight_runner_up=0, map=map_number, home=1, protection_radius_m=2.5, search_end=1,
                  time_to_first_fix_ns=5 * second, uptime_ns=(10 + scan) * second, report_monotonic_ns=50 * second,
                  scan_end_monotonic_ns=49 * second, scan_end_utc_ns=2 * second, scan_middle_utc_ns=1 * second)
    fields.update(more)
    return "SLAMSENSOR_POSE", lcm_types.encode("pose_t", **fields)


def scan_message(scan, pose, points, range_m=25.0):
    x, y, heading = pose
    seen = []
    for px, py in points:
        dx, dy = px - x, py - y
        if math.hypot(dx, dy) < range_m:
            seen.append((dx * math.cos(heading) + dy * math.sin(heading), -dx * math.sin(heading) + dy * math.cos(heading)))
    seen = seen[:40]
    return "SLAMSENSOR_SCAN", lcm_types.encode("scan_t", initialization=7, scan=scan, landmarks=len(seen), chunk=0,
                                               chunks=1, count=len(seen), x_m=[p[0] for p in seen],
                                               y_m=[p[1] for p in seen], weight=[1.0] * len(seen))


def rivals_message(scan, poses, matches):
    return "SLAMSENSOR_RIVALS", lcm_types.encode("rivals_t", initialization=7, scan=scan, count=len(poses), x_m=[p[0] for p in poses],
                                                 y_m=[p[1] for p in poses], heading_rad=[p[2] for p in poses], matches=matches)


def status_message(state=2, **more):
    fields = dict(initialization=7, state=state, phase="scanning", device_state=[2, 2],
                  device_model=["PTU-46-17.5", "LW20"], line=12, lines=40, pan_rad=0.6, tilt_rad=0.1, readings_hz=998.0,
                  scans=30, fixes=28, landmarks=100, hypotheses=1, process_last_ns=3_000_000, process_max_ns=8_000_000,
                  wake_latency_max_ns=400_000, map_name="garden", map_saved_ago_ns=-1, realtime=True)
    fields.update(more)
    return "SLAMSENSOR_STATUS", lcm_types.encode("status_t", **fields)


def counters_message():
    return "SLAMSENSOR_COUNTERS", lcm_types.encode("counters_t", initialization=7, station=3, part=0, parts=1, count=2,
                                                   value=[4, 17], name=["searches_cut", "landmarks_cut"])


def pose_at(scan):
    angle = 0.2 * scan
    return (20.0 * math.cos(angle), 20.0 * math.sin(angle), angle + math.pi / 2)


RIVALS = [(-12.5, 8.25, 1.0), (6.0, -30.0, -2.0)]


def recording(count=100, reach_m=40.0):
    """30 scans, two seconds apart: fixes; scan 12 ambiguous, with two rivals; 20 to 23 in a local map; then fixes again."""
    points = landmarks(count, reach_m)
    events = [(T0, *message) for message in map_messages(points)]
    for scan in range(30):
        t = T0 + 2.0 * scan
        pose = pose_at(scan)
        if scan == 12:
            made = pose_message(scan, pose, AMBIGUOUS, SYMMETRIC, search_end=2)
            events.append((t + 0.015, *rivals_message(scan, RIVALS, [21, 17])))
        elif 20 <= scan < 24:
            pose = (scan - 20.0, 0.0, 0.0)
            made = pose_message(scan, pose, NO_FIX, LOCAL_MAP, map_number=2, expected_false_alarms=1.0)
        else:
            made = pose_message(scan, pose)
        events.append((t, *scan_message(scan, pose, points)))
        events.append((t + 0.01, *made))
        local = 1 if 20 <= scan < 24 else 0
        broken = scan in (15, 16)
        events.append((t + 0.02, *status_message(3 if scan == 12 else 6 if broken else 4 if local else 2, local_maps=local, local_landmarks=20 * local,
                                                 device_state=[2, 0 if broken else 2], device_recoveries=[0, int(scan > 16)],
                                                 problem="no reading for 2 s: look at its cable" if broken else "")))
        events.append((t + 0.03, *counters_message()))
    return points, events
