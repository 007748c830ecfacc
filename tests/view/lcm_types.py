"""LCM messages of the sensor in pure Python, from firmware/lcm/types/*.lcm: encoding, fingerprints, packets, logs."""
import pathlib
import re
import socket
import struct

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "firmware" / "lcm" / "types"
CODES = {"int8_t": "b", "int32_t": "i", "int64_t": "q", "double": "d", "boolean": "?", "byte": "s"}
SIZES = {"int8_t": 1, "int32_t": 4, "int64_t": 8, "double": 8, "boolean": 1, "byte": 1}
MASK = (1 << 64) - 1


def members_of(name):
    """(name, type, dimensions) of each member of slamsensor.NAME."""
    text = re.sub(r"//[^\n]*", "", (FOLDER / f"slamsensor_{name}.lcm").read_text())
    body = text[text.index("{") + 1: text.rindex("}")]
    out = []
    for statement in body.split(";"):
        words = statement.split(None, 1)
        if len(words) == 2 and words[0] != "const":
            for one in words[1].split(","):
                member = re.match(r"\s*(\w+)((?:\[\d+\])*)", one)
                out.append((member[1], words[0], [int(n) for n in re.findall(r"\d+", member[2])]))
    return out


def fingerprint(members):
    value = 0x12345678

    def step(byte):
        nonlocal value
        carried = (value - (1 << 64) if value >> 63 else value) >> 55
        value = (((value << 8) & MASK) ^ (carried & MASK)) + byte & MASK

    def text(word):
        step(len(word))
        for c in word.encode():
            step(c)
    for name, kind, dimensions in members:
        text(name)
        text(kind)
        step(len(dimensions))
        for size in dimensions:
            step(0)
            text(str(size))
    return ((value << 1) | (value >> 63)) & MASK


def encode(name, /, **values):
    """The message; members that are not given are 0, arrays are filled up with 0."""
    members = members_of(name)
    out = struct.pack(">Q", fingerprint(members))
    for member, kind, dimensions in members:
        out += packed(values.pop(member, None), kind, dimensions)
    if values:
        raise ValueError(f"{name} has no {sorted(values)}")
    return out


def packed(value, kind, dimensions):
    count = 1
    for size in dimensions:
        count *= size
    if kind == "byte":
        if len(dimensions) == 2:
            return b"".join(packed(v, kind, dimensions[1:]) for v in list(value or []) +
                            [""] * (dimensions[0] - len(value or [])))
        return (value or "").encode()[:count].ljust(count, b"\0")
    values = list(value or []) if dimensions else [value or 0]
    values += [0] * (count - len(values))
    return struct.pack(">" + CODES[kind] * count, *values)


def write_log(path, events):
    """An LCM event log of (seconds since 1970, channel, message)."""
    with open(path, "wb") as file:
        for number, (time_s, channel, message) in enumerate(events):
            file.write(struct.pack(">IqqII", 0xEDA1DA01, number, round(time_s * 1e6), len(channel), len(message)))
            file.write(channel.encode() + message)


class Sender:
    """Sends to a multicast group on this machine."""

    def __init__(self, group, port):
        self.to = (group, port)
        self.number = 0
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)

    def send(self, channel, message):
        self.socket.sendto(struct.pack(">4sI", b"LC02", self.number) + channel.encode() + b"\0" + message, self.to)
        self.number += 1
