"""Reads the sensor's NMEA 0183 sentences. Used by the tests beside it."""
import math
import os
import select
import socket
import time

PATIENCE_S = 10.0


def fields_of(line):
    """Of a sentence whose checksum and line end are right."""
    assert line.startswith("$") and line.endswith("\r\n"), repr(line)
    body, _, checksum = line[1:-2].partition("*")
    found = 0
    for character in body.encode("ascii"):
        found ^= character
    assert checksum == f"{found:02X}", repr(line)
    return body.split(",")


def pose_of(fields):
    """x, y (m) and heading (rad) of a sentence PSLMA,POSE with a fix; else none."""
    return (float(fields[6]), float(fields[7]), math.radians(float(fields[8]))) if fields[3] == "A" else None


class Reader:
    """Sentences from a descriptor, each checked."""

    def __init__(self, descriptor):
        self.descriptor = descriptor
        self.rest = b""

    @classmethod
    def tcp(cls, port):
        stream = socket.create_connection(("127.0.0.1", port), PATIENCE_S)
        return cls(stream.detach())

    def sentence(self):
        end = time.monotonic() + PATIENCE_S
        while b"\n" not in self.rest:
            readable, _, _ = select.select([self.descriptor], [], [], max(0.0, end - time.monotonic()))
            assert readable, f"no sentence within {PATIENCE_S:.0f} s"
            more = os.read(self.descriptor, 65536)
            assert more, "the sensor has closed the connection"
            self.rest += more
        line, _, self.rest = self.rest.partition(b"\n")
        return fields_of(line.decode("ascii") + "\n")

    def of_kind(self, kind):
        """The next sentence of that kind ("RMC", "PSLMA")."""
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            fields = self.sentence()
            if fields[0] == kind or fields[0][2:] == kind:
                return fields
        raise AssertionError(f"no {kind} within {PATIENCE_S:.0f} s")

    def close(self):
        os.close(self.descriptor)
