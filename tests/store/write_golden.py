#!/usr/bin/env python3
"""The golden map file: what the format is, written down a second time.
    write_golden.py HEADER           writes it as a C++ header
    write_golden.py --check HEADER   fails when HEADER is not what would be written
The map in it is the one of tests/unit/firmware/store/sample_map.hpp."""
import pathlib
import struct
import sys
import zlib

MAGIC = b"\x89SLM\r\n\x1a\n"
NONE = 0xFFFFFFFF
NAME = b"orchard-7"
CREATED, SAVED = 1767225600, 1795439109  # 2026-01-01T00:00:00Z, 2026-11-23T13:05:09Z
WEIGHT, EVICTED, THINNINGS, NEXT_ID, SCANS, SAVES = 5000000019, 3, 1, 9, 40, 12
METHOD = (0.5, 0.25, 0.009, 2, 30)
DATUM = (59.3325, 18.0649, 28.5, 90.0)
# id, xi, parents, sightings, chances, first, last, x, y, sigma, ln diameter, its sightings
LANDMARKS = [
    (0, 0, (NONE, NONE, NONE), 21, 22, 0, 38, 1.5, -2.25, 0.0, -1.5, 21.0),
    (1, 0, (NONE, NONE, NONE), 4, 4, 0, 3, -7.125, 0.0, 0.0625, 0.0, 0.0),
    (2, 0, (NONE, NONE, NONE), 9, 30, 0, 37, 0.1, 12.7, 0.125, 0.75, 8.0),
    (5, 1, (0, 1, 2), 2, 3, 4, 39, -64000.0, 33.0, 2.5, -0.125, 1.0),
    (8, 2, (5, 2, 1), 1, 1, 39, 39, 8.0, 8.5, 0.375, 0.0, 0.0),
]
# scan, xi, x, y, heading
PATH = [(0, 0, 0.0, 0.0, 0.0), (4, 1, 1.25, -0.5, -3.0), (39, 2, 2.5, 0.75, 3.125)]
LEARNED = [0.25 * (i + 1) for i in range(76)]
LEARNED[6] = 0.125  # m, to the middle of a trunk


def section(tag, records, record_bytes, payload):
    head = tag + struct.pack("<II", records, record_bytes)
    return head + struct.pack("<I", zlib.crc32(head + payload)) + payload


def file(version, sections):
    body = b"".join(sections)
    prefix = MAGIC + struct.pack("<IIQ", version, len(sections), 28 + len(body))
    return prefix + struct.pack("<I", zlib.crc32(prefix)) + body


def text(characters):
    return struct.pack("<H", len(characters)) + characters


def golden(flags=1, version=5):
    """Flags: 1 it has a datum, 2 it is marked frozen, 4 it is a survey, which is frozen too. Version 4 has no sizes, and this one what was
    learned with it; 3 ends with PATH."""
    info = struct.pack("<QqqQQQII", SAVES, CREATED, SAVED, WEIGHT, EVICTED, THINNINGS, NEXT_ID, SCANS)
    info += struct.pack("<dddII", *METHOD) + struct.pack("<Bdddd", flags, *DATUM) + text(NAME)
    sized = version > 4
    land = b"".join(struct.pack("<9Iddfff", l[0], l[1], *l[2], *l[3:])[:64 if sized else 56] for l in LANDMARKS)
    path = b"".join(struct.pack("<IIddd", *pose) for pose in PATH)
    sections = [section(b"INFO", 1, len(info), info), section(b"LAND", len(LANDMARKS), 64 if sized else 56, land),
                section(b"PATH", len(PATH), 32, path)]
    if version == 4:
        sections.append(section(b"RATE", 1, 336, struct.pack("<8d68f", *LEARNED)))
    elif sized:
        sections.append(section(b"RATE", 0, 352, b""))
    return file(version, sections)


def literal(name, content):
    digits = content.hex()
    lines = [f'    "{digits[i:i + 96]}"' for i in range(0, len(digits), 96)]
    return f"inline constexpr std::string_view {name} =\n" + "\n".join(lines) + ";\n"


def header():
    return ("#pragma once\n\n#include <string_view>\n\nnamespace slamsensor::tests {\n\n"
            "/// The sample map in hex: written by tests/store/write_golden.py.\n"
            + literal("kGoldenMap", golden()) + literal("kGoldenFrozenMap", golden(3))
            + literal("kGoldenMapOfVersion4", golden(version=4))
            + literal("kGoldenMapOfVersion3", golden(version=3))
            + "\n}  // namespace slamsensor::tests\n")


def main():
    path = pathlib.Path(sys.argv[-1])
    if sys.argv[1] != "--check":
        path.write_text(header())
    elif path.read_text() != header():
        sys.exit(f"{path} is not what write_golden.py writes")


if __name__ == "__main__":
    main()
