#!/usr/bin/env python3
"""Writes the seed inputs of the fuzz targets into FOLDER/<target>/: write_seeds.py FOLDER. All are made here by hand."""
import pathlib
import struct
import sys


def pcd(fields, sizes, types, counts, points, data, body):
    """The bytes of a PCD file."""
    header = (
        f"# .PCD v0.7\nVERSION 0.7\nFIELDS {fields}\nSIZE {sizes}\nTYPE {types}\nCOUNT {counts}\n"
        f"WIDTH {points}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {points}\nDATA {data}\n"
    )
    return header.encode() + body


def lzf_literals(raw):
    """`raw` as LZF without a single copy."""
    parts = [raw[i : i + 32] for i in range(0, len(raw), 32)]
    return b"".join(bytes([len(part) - 1]) + part for part in parts)


def compressed(packed, size):
    """The body of a binary_compressed file."""
    return struct.pack("<II", len(packed), size) + packed


def pcd_seeds():
    xyzr = ("x y z ring", "4 4 4 2", "F F F U", "1 1 1 1")
    xyz = ("x y z", "4 4 4", "F F F", "1 1 1")
    points = [(1.0, 2.0, 0.5, 3), (-4.0, 0.0, 1.0, 3), (float("nan"), 0.0, 0.0, 4), (0.0, -7.0, -1.0, 4)]
    columns = b"".join(struct.pack("<4f", *[p[i] for p in points]) for i in range(3))
    columns += struct.pack("<4H", *[p[3] for p in points])
    # Sixteen zero bytes, then "1.0" twice: one literal and a long copy, then a short one.
    copies = b"\x00\x00\xe0\x06\x00" + b"\x03" + struct.pack("<f", 1.0) + b"\x40\x03"
    return {
        "ascii": pcd(*xyz, 3, "ascii", b"1 2 3\n-4 5e0 6\nnan nan nan\n"),
        "ascii_crlf": pcd(*xyz, 1, "ascii", b"1 2 3\n").replace(b"\n", b"\r\n"),
        "binary": pcd(*xyzr, 4, "binary", b"".join(struct.pack("<fffH", *p) for p in points)),
        "padded": pcd("_ z y x _", "1 8 2 4 4", "U F I I F", "3 1 1 1 2", 1, "binary",
                      struct.pack("<3xdhi8x", 1.5, -20, 30)),
        "literals": pcd(*xyzr, 4, "binary_compressed", compressed(lzf_literals(columns), len(columns))),
        "copies": pcd(*xyz, 2, "binary_compressed", compressed(copies, 24)),
        "short": pcd(*xyz, 2, "binary", struct.pack("<3f", 1, 2, 3)),
        "huge": pcd(*xyz, 20000000, "binary_compressed", compressed(b"ab", 240000000)),
    }


def wire(text):
    return bytes.fromhex(text)


SEEDS = {
    "lwnx": {
        "reading": wire("AA40012CD2043900E02A" * 3),
        "raw": wire("AA00022803D204D304FFFF580E"),
        "name": wire("AA4004004C573230") + bytes(12) + wire("1CCC"),
    },
    "benewake": {
        "readings": wire("5959D204B00400003C" * 3),
        "over_range": wire("595950460C00000054" * 2),
        "reply": wire("5A050200615A0603E8034E"),
    },
    "point_laser": {
        "ascii": b"\x00" + b"00012.345\r\n" * 3 + b"DE02\r\n",
        "free": b"\x01" + b"12.3\r\n99.9\r\n",
        "hex": b"\x02" + b"00001384\r\n" * 3,
        "packed": b"\x03" + wire("895289528952"),
        "pair": b"\x04" + wire("04D204D204D2"),
    },
    "ptu_reply": {
        "terse": b"* 22\r\n* -2500\r\n!P!T* 185.1428\r\n",
        "verbose": b"PP * Current Pan position is 22\r\n! Illegal argument\r\n",
        "banner": b"\r\n### PAN-TILT CONTROLLER\r\nInitializing...*\r\n!T!T!P!P*\r\n",
    },
    "sdo_reply": {
        "value": wire("084364600040E20100"),
        "abort": wire("088064600000000206"),
        "segment": wire("0801505455 343600".replace(" ", "")),
    },
    "pcd": pcd_seeds(),
    "readings_csv": {
        "plain": b"pan_deg,tilt_deg,range_m\n0,0,5\n0.5,0,\n0,1,7.25\n",
        "other": b"\xef\xbb\xbf# note\r\nrange_m,pan_deg,tilt_deg\r\n+1e1,-180,-30\r\n",
        "bad": b"pan_deg,tilt_deg,range_m\n0,0,nan\n",
    },
    "landmark_csv": {
        "plain": b"scan,x_m,y_m\n0,1,2\n1,3,4\n0,5,6\n",
        "full": b"weight,scan,y_m,diameter_m,x_m\n0.5,7,1,0.3,2\n0.5,7,-1,0.4,2\n",
        "bad": b"scan,x_m,y_m\n1.5,0,0\n",
    },
    "map_csv": {
        "plain": b"id,x_m,y_m\n1,0,0\n2,10.5,-3\n",
        "more": b"y_m,xi,id,x_m\n1,0,9,2\n",
        "twice": b"id,x_m,y_m\n1,0,0\n1,1,1\n",
    },
    "tum": {
        "plain": b"# t x y z qx qy qz qw\n1 0 0 0 0 0 0 1\n0.5 1 2 3 0 0 0.70710678 0.70710678\n",
        "bad": b"1 0 0 0 0 0 0 0\n",
        "upright": b"1 0 0 0 0 0.70710678 0 0.70710678\n",
    },
}


def main():
    folder = pathlib.Path(sys.argv[1])
    for target, seeds in SEEDS.items():
        (folder / target).mkdir(parents=True, exist_ok=True)
        for name, content in seeds.items():
            (folder / target / name).write_bytes(content)


if __name__ == "__main__":
    main()
