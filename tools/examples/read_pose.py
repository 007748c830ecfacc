#!/usr/bin/env python3
"""Prints every pose of a SLAM sensor. Needs nothing but Python.

  read_pose.py                              from LCM, default group
  read_pose.py udpm://239.255.76.67:7667    from LCM
  read_pose.py tcp://sensor.local:10110     from NMEA over TCP

A line per pose: seconds since 1970, status, x (m), y (m), heading (degrees, counter-clockwise from the map's x axis),
number of the map, protection radius (m); those only where there is a fix, or the better of two places."""
import calendar
import math
import os
import signal
import socket
import struct
import sys
import time
from urllib.parse import urlsplit

STATUS = ("no_fix", "ambiguous", "fix")

# slamsensor.pose_t as slamsensor_pose_t.lcm has it, behind the fingerprint that tells the type. lcm-gen writes a class
# for it too: lcm-gen --python slamsensor_pose_t.lcm.
POSE = struct.Struct(">Q 10q 4b 3d 9d 4q d 3q 2q d 9d")
FINGERPRINT = 0xDF2A5E439E4A5851


def show(seconds, status, pose=None):
    place = " {:.3f} {:.3f} {:.2f} {:.0f} {:.2f}".format(*pose) if pose else ""
    print(f"{seconds:.2f} {status}{place}", flush=True)


def read_lcm(group, port):
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
    sock.bind((group, port))
    sock.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton(group) + bytes(4))
    while True:
        datagram = sock.recv(65536)
        # "LC02", the number of the message, its channel and a zero, the message: poses fit one datagram.
        channel, _, message = datagram[8:].partition(b"\0")
        if datagram[:4] != b"LC02" or not channel.endswith(b"_POSE") or len(message) != POSE.size:
            continue
        fields = POSE.unpack(message)
        if fields[0] != FINGERPRINT:
            continue
        status, x, y, heading = fields[11], *fields[15:18]
        pose = (x, y, math.degrees(heading) % 360, fields[35], fields[37]) if status > 0 else None
        show(fields[1] / 1e6, STATUS[status], pose)


def checked(line):
    """The fields of an NMEA sentence whose checksum is right; else none."""
    body, _, checksum = line.strip().lstrip("$").partition("*")
    found = 0
    for character in body.encode():
        found ^= character
    return body.split(",") if checksum == f"{found:02X}" else []


def read_nmea(host, port):
    date = time.strftime("%d%m%y", time.gmtime())
    stream = socket.create_connection((host, port)).makefile("r", encoding="ascii", errors="replace", newline="\r\n")
    for line in stream:
        fields = checked(line)
        if fields and fields[0].endswith("RMC") and fields[9]:
            date = fields[9]
        if fields[:2] != ["PSLMA", "POSE"]:
            continue
        whole, _, fraction = fields[2].partition(".")
        moment = time.strptime(date + whole, "%d%m%y%H%M%S")
        status = {"V": "no_fix", "U": "ambiguous", "A": "fix"}[fields[3]]
        pose = [float(field or "nan") for field in fields[6:9] + fields[15:17]] if status != "no_fix" else None
        show(calendar.timegm(moment) + float("0." + fraction), status, pose)


def fail(text, status):
    print(f"read_pose.py: {text}", file=sys.stderr)
    return status


def main():
    text = sys.argv[1] if len(sys.argv) > 1 else "udpm://239.255.76.67:7667"
    try:
        url = urlsplit(text)
        host, port = url.hostname, url.port
    except ValueError:
        host, port, url = None, None, urlsplit("")
    if url.scheme not in ("tcp", "udpm") or (url.scheme == "tcp" and not host):
        return fail(f"{text} is neither udpm://GROUP:PORT nor tcp://HOST:PORT", os.EX_USAGE)
    try:
        if url.scheme == "udpm":
            read_lcm(host or "239.255.76.67", port or 7667)
        read_nmea(host, port or 10110)
    except OSError as error:
        return fail(f"{text}: {error.strerror or error}", os.EX_UNAVAILABLE)
    return fail(f"{text}: the connection was closed", os.EX_UNAVAILABLE)


if __name__ == "__main__":
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # who reads the lines may end first
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        pass
