#!/usr/bin/env python3
"""Writes the seed inputs of the fuzz targets into FOLDER/<target>/: write_seeds.py FOLDER. All are made here by hand."""
import pathlib
import struct
import sys
import zlib

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "store"))
import write_golden  # noqa: E402: of the folder above

# Of block_t.lcm and text_t.lcm in firmware/recording.
BLOCK_FINGERPRINT = 0xD6F70BEC32B1F303
TEXT_FINGERPRINT = 0x584886C04312E07F


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
        "viewpoint": pcd(*xyz, 1, "ascii", b"3 2 1\n").replace(b"0 0 0 1 0 0 0", b"1 2 3 0.6 0 0 0.8"),
        "page_behind": pcd(*xyz, 1, "binary", struct.pack("<3f", 1, 2, 3) + bytes(40)),
        "no_bytes": pcd("x _ y Z", "4 1 4 4", "F U f F", "1 0 1 1", 1, "Binary", struct.pack("<3f", 1, 2, 3)),
        "no_points": pcd(*xyz, 0, "binary_compressed", bytes(8)),
        "huge": pcd(*xyz, 20000000, "binary_compressed", compressed(b"ab", 240000000)),
    }


def wire(text):
    return bytes.fromhex(text)


def event(number, channel, data):
    """An event of an LCM log, at its number in microseconds."""
    return struct.pack(">IqqII", 0xEDA1DA01, number, number, len(channel), len(data)) + channel + data


def text_message(text):
    """A message of the type text_t."""
    return struct.pack(">QqII", TEXT_FINGERPRINT, 1, zlib.crc32(text), len(text) + 1) + text + b"\0"


def block_message(number, data):
    """A message of the type block_t."""
    return struct.pack(">QqqII", BLOCK_FINGERPRINT, 1, number, zlib.crc32(data), len(data)) + data


# The messages of the sensor: fingerprint and length, as in firmware/lcm.
LCM_TYPES = {
    "pose": (0x466A30C62957A78E, 252),
    "bot_core": (0x2E16EFB052B0105E, 144),
    "scan": (0xEB7F62D88331113F, 1280),
    "map": (0x8E1CC5FB9501AED1, 1344),
    "status": (0x7B9DB43E90A8526B, 761),
    "counters": (0x1E8D13D0071E7440, 1180),
}


def datagram(data):
    return struct.pack(">H", len(data)) + data


def lcm_seeds():
    """Datagrams behind their lengths: each message whole and with nothing but zeros in it, and one in fragments."""
    seeds = {}
    for name, (fingerprint, size) in LCM_TYPES.items():
        message = bytearray(struct.pack(">Q", fingerprint) + bytes(size - 8))
        if name in ("scan", "map"):  # no landmarks, in one chunk
            chunks = 8 + (56 if name == "scan" else 24) + 8
            message[chunks : chunks + 4] = struct.pack(">i", 1)
        if name == "counters":  # of the first station, in one part
            message[26] = 1
        seeds[name] = datagram(struct.pack(">4sI", b"LC02", 1) + b"S\0" + message)
    pieces = [bytes(300), bytes(300)]
    seeds["fragments"] = b"".join(
        datagram(struct.pack(">4sIIIHH", b"LC03", 2, 600, 300 * i, i, 2) + (b"S\0" if i == 0 else b"") + piece)
        for i, piece in enumerate(pieces))
    return seeds


SEEDS = {
    "control": {"session": b"\x04version\nmap save garden\nstatus json\n# note\n\nscan mode single\nbogus\n",
                "datum": b"\xfddatum set -33.8 151.2 12 90\r\nconfig get association.dept\nhelp map\n",
                "long": b"\x82" + b"x" * 3000 + b"\nversion\n"},
    "lcm": lcm_seeds(),
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
    "tf03_can": {  # size and model, then the data
        "readings": wire("08D204B00400000000" * 3 + "06D204B0040000"),
        "over_range": wire("085046" + "0C0000000000"),
        "reply": wire("085A070101020166" + "00" + "075A070101020166" + "11FFFF0A0000000000"),
    },
    "canopen": {
        "started": wire("03" + "3005062710000010" * 3),
        "emergency": wire("03" + "442031040000000000" + "0A05" + "0B05"),
        "silent": wire("00" + "466043" + "4643640060E2010000"),
    },
    "cia410": {
        "measures": wire("01" + "05" * 2 + "408008100000000206" + "05" + "408010610000000206"
                         + "404B10600038FF0000" + "404B206000F5000000"),
        "emergency": wire("01" + "05" + "44005081" + "0000000000" + "0B00"),
        "silent": wire("00" + "4043001000" + "9A010300"),
    },
    "iio_numbers": {
        "number": b"-0.038307\n",
        "matrix": b"0, -1, 0; 1, 0, 0; 0, 0, 1\n",
    },
    "emulator_ptu": {
        "start": b"\x00ED FT CI I LE V PP TP PR TR PN PX TU TL PB TA ",
        "moves": b"\x00PS1000 PP2500 TP-350 A H PO-20 PD10 R ",
        "modes": b"\x01S PP100 TP-20 A I CV PS-300 TS200 CI LD LE HP HT RE RD RT ",
        "settings": b"\x01@(38400,0,T) U5 _5 _0 u0 EE ED FV FT DS DR DF O XYZ PNU ",
    },
    "emulator_lwnx": {
        "start": b"\x00www\r\n" + wire("AA400000709F" * 3 + "AA41011B110000000EB2" + "AA41011E050000000F40"),
        "raw": b"\x00www\r\n" + wire("AA400000709F" * 3 + "AA810046010D70" + "AA41011E01000000FE8A"),
        "save": b"\x00www\r\n" + wire("AA400000709F" * 2 + "AA40000A3A3E" + "AAC1000C34128070"),
        "text": b"\x01www\r\n?LDF,0\r\n",
        "sf45": b"\x06" + wire("AA8100420C646D" + "AA400000709F" + "AA41011E050000000F40"),
    },
    "emulator_tf03": {
        "settings": b"\x00" + wire("5A04015F" + "5A0603E8034E" + "5A05050165" + "5A08060010" "0E0086"),
    },
    "emulator_point": {
        "lds70a": b"SD 0 1\rSD 2 3\rDT\rXX\r",
    },
    "emulator_sdo": {
        "numbers": wire("4000200000000000" + "2300200012345678" + "8000200000000206"),
        "segments": wire("4000200000000000" + "6000000000000000" + "7000000000000000"),
        "download": wire("2100200009000000" + "0041424344454647" + "1B48490000000000"),
    },
    "event_log": {
        "settings": event(0, b"SLAMSENSOR_CONFIG", text_message(b"scan.settle_s = 0.05\n")),
        "order": event(0, b"SLAMSENSOR_ORDER", text_message(b"reset 12")),
        "tape": event(0, b"SLAMSENSOR_TAPE", block_message(0, wire("10E807E0"))) + event(1, b"POSE", bytes(144)),
        "damaged": b"text" + event(0, b"A", b"") + event(1, b"B", b"\xed\xa1\xda\x01")[:-1],
    },
    "tape": {
        "line": wire("04" "000101804B" "10E807" "60010262" "6140" "1000" "70000261629000E0".replace(" ", "")),
        "steps": wire("01" "10E807" "1000" "1001" "1002" "C00101" "E0"),
        "bus": wire("03" "01010100" "1005" "A10005040102" "B10005040102" "41" "D005"),
        "changes": wire("03" "02000080" "4B" "1005" "22010180" "4B" "820080" "4B" "32010080" "4B" "52" "92" "E0"),
    },
    "pcd": pcd_seeds(),
    "readings_csv": {
        "plain": b"pan_deg,tilt_deg,range_m\n0,0,5\n0.5,0,\n0,1,7.25\n",
        "semicolons": b'\xef\xbb\xbfsep=;\r\n"pan_deg";tilt_deg;"range_m"\r\n-1,5;"2,5";\r\n0;0;1e1\r\n',
        "tabs": b"pan_deg\ttilt_deg\trange_m\n1\t2\t\n",
        "utf_16": "pan_deg,tilt_deg,range_m\n".encode("utf-16"),
        "leaning": b"pan_deg,tilt_deg,range_m,roll_deg,pitch_deg\n0,0,5,1.5,-2\n",
        "other": b"\xef\xbb\xbf# note\r\nrange_m,pan_deg,tilt_deg\r\n+1e1,-180,-30\r\n",
        "bad": b"pan_deg,tilt_deg,range_m\n0,0,nan\n",
    },
    "landmark_csv": {
        "plain": b"scan,x_m,y_m\n0,1,2\n1,3,4\n0,5,6\n",
        "full": b"weight,scan,y_m,diameter_m,x_m\n0.5,7,1,0.3,2\n0.5,7,-1,0.4,2\n",
        "bad": b"scan,x_m,y_m\n1.5,0,0\n",
    },
    "map_file": {"golden": write_golden.golden()},
    "map_csv": {
        "plain": b"id,x_m,y_m\n1,0,0\n2,10.5,-3\n",
        "more": b"y_m,xi,id,x_m\n1,0,9,2\n",
        "twice": b"id,x_m,y_m\n1,0,0\n1,1,1\n",
    },
    "survey_geojson": {
        "points": b'{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"id":1},"geometry":'
                  b'{"type":"Point","coordinates":[1e-4,2e-4]}},{"type":"Feature","properties":null,"geometry":'
                  b'{"type":"MultiPoint","coordinates":[[0,0],[3e-4,0]]}}]}',
        "local": b'{"type":"MultiPoint","crs":null,"coordinates":[[0,0],[10,0],[0,20]]}',
        "datum": b'{"type":"Feature","slamsensor":{"datum":{"latitude_deg":1,"longitude_deg":2,"height_m":3,'
                 b'"bearing_deg":90}},"geometry":{"type":"Point","coordinates":[2,1]}}',
        "wrong": b'{"type":"FeatureCollection","features":{"a":1}}',
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
