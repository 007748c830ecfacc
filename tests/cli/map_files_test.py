"""Maps out and in: map export, map import, and a sensor that is found in a survey it never made.
Usage: map_files_test.py SLAMSENSOR CONFIG_DIR"""

import collections
import csv
import json
import math
import os
import pathlib
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "store"))
import write_golden  # noqa: E402: the format of map files, written down a second time

PROGRAM, CONFIG = sys.argv[1], pathlib.Path(sys.argv[2])
DATA = pathlib.Path(os.environ.get("SLAMSENSOR_DATA", CONFIG.parent.parent / "shared" / "data"))
OK, USAGE, DATAERR, CANTCREAT = 0, 64, 65, 73
DATUM = ["42.4627000", "-2.4449000", "384.5", "71.25"]


def run(*arguments):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    return done.returncode, done.stdout, done.stderr


def ogrinfo(path, *options):
    done = subprocess.run(["ogrinfo", "-ro", "-al", *options, str(path)], capture_output=True, text=True, timeout=120)
    if done.returncode != 0:
        raise AssertionError(f"ogrinfo {path}: {done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def random_points(seed, count, reach_m):
    draw = random.Random(seed)
    return [(draw.uniform(-reach_m, reach_m), draw.uniform(-reach_m, reach_m)) for _ in range(count)]


class MapFiles(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.store = self.folder / "maps"
        self.store.mkdir()

    def tearDown(self):
        self.temporary.cleanup()

    def write(self, name, text):
        path = self.folder / name
        path.write_text(text)
        return path

    def survey(self, points, name="survey.csv", header="x_m,y_m"):
        return self.write(name, header + "\n" + "".join(f"{x!r},{y!r}\n" for x, y in points))

    def done(self, *arguments):
        code, output, errors = run(*arguments)
        self.assertEqual(code, OK, f"{arguments}: {output}{errors}")
        return output

    def refused(self, text, *fragments, name="bad.csv", more=(), status=DATAERR):
        path = self.write(name, text)
        code, _, errors = run("map", "import", path, "--out", self.folder / "bad.slammap", *more)
        self.assertEqual(code, status, errors)
        self.assertFalse((self.folder / "bad.slammap").exists())
        for fragment in fragments:
            self.assertIn(fragment, errors)

    def landmarks(self, path):
        """id -> (x, y, xi) by `map --csv`."""
        rows = self.folder / "rows.csv"
        self.done("map", path, "--csv", rows)
        with open(rows, encoding="ascii") as file:
            return {int(r["id"]): (float(r["x_m"]), float(r["y_m"]), int(r["xi"])) for r in csv.DictReader(file)}

    # --- import ---------------------------------------------------------------------------------------------------

    def test_a_survey_in_local_metres_becomes_a_frozen_map_of_the_store(self):
        points = random_points(1, 40, 60.0)
        output = self.done("map", "import", self.survey(points), "--out", "park", "--store", self.store)
        self.assertIn("40, xi 0", output.replace("landmarks  ", ""))
        self.assertIn("datum      none", output)
        told = self.done("map", "park", "--store", self.store)
        self.assertIn("marked frozen", told)
        self.assertIn("xi up to 0", told)
        found = self.landmarks(self.store / "park.slammap")
        self.assertEqual([(round(x, 6), round(y, 6)) for x, y, _ in found.values()],
                         [(round(x, 6), round(y, 6)) for x, y in points])
        self.done("map", "import", self.survey(points), "--out", self.folder / "g.slammap", "--growing")
        self.assertIn("a sensor may change it", self.done("map", self.folder / "g.slammap"))

    def test_a_map_that_is_there_is_not_overwritten_by_accident(self):
        survey = self.survey(random_points(1, 10, 60.0))
        self.done("map", "import", survey, "--out", "park", "--store", self.store)
        code, _, errors = run("map", "import", survey, "--out", "park", "--store", self.store)
        self.assertEqual(code, CANTCREAT)
        self.assertIn("--replace", errors)
        code, _, errors = run("map", "import", survey, "--out", "park", "--store", self.folder / "none")
        self.assertEqual((code, "another store with --store" in errors), (CANTCREAT, True), errors)
        self.done("map", "import", survey, "--out", "park", "--store", self.store, "--replace")
        self.assertTrue((self.store / "park.slammap.1").exists(), "the generation before is kept")

    def test_latitude_and_longitude_about_a_datum_and_about_their_middle(self):
        places = [(42.4627, -2.4449), (42.4636, -2.4449), (42.4627, -2.4437)]
        survey = self.survey(places, header="lat,lon")
        self.done("map", "import", survey, "--out", self.folder / "a.slammap", "--datum", *DATUM[:3], "90")
        found = list(self.landmarks(self.folder / "a.slammap").values())
        self.assertAlmostEqual(math.hypot(*found[0][:2]), 0.0, places=4)
        self.assertAlmostEqual(found[1][0], 0.0, places=2)
        self.assertAlmostEqual(found[1][1], 0.0009 * 111_073.0, delta=0.3)  # metres a degree of latitude there
        self.assertAlmostEqual(found[2][0], 0.0012 * 82_273.0, delta=0.3)
        output = self.done("map", "import", survey, "--out", self.folder / "b.slammap")
        self.assertIn("the middle of the points", output)
        self.assertIn("latitude 42.4630000, longitude -2.4445000", output)

    def test_ids_of_the_survey_are_kept_where_they_can_be(self):
        kept = self.write("kept.csv", "id,x,y\n30,0,0\n7,10,0\n12,0,9\n")
        self.assertIn("ids of the survey", self.done("map", "import", kept, "--out", self.folder / "k.slammap"))
        self.assertEqual(list(self.landmarks(self.folder / "k.slammap")), [7, 12, 30])
        given = self.write("given.csv", "id;x;y\nA1;0;0\nA2;10,5;0\nA3;0;9\n")
        self.assertIn("given in its order", self.done("map", "import", given, "--out", self.folder / "i.slammap"))
        self.assertEqual(self.landmarks(self.folder / "i.slammap")[1][0], 10.5)

    def test_points_at_one_place_count_once(self):
        survey = self.survey([(0, 0), (5, 1), (5.004, 1.002), (2, 8)])
        self.assertIn("1 within 1 cm", self.done("map", "import", survey, "--out", self.folder / "a.slammap"))
        self.assertEqual(len(self.landmarks(self.folder / "a.slammap")), 3)

    def test_a_national_grid_takes_an_origin(self):
        points = [(545_000.0 + x, 4_701_000.0 + y) for x, y in random_points(2, 12, 50.0)]
        survey = self.survey(points, header="E,N")
        more = ["--columns", "E", "N"]
        code, _, errors = run("map", "import", survey, "--out", self.folder / "a.slammap", *more)
        self.assertEqual(code, DATAERR)
        self.assertIn("survey.csv:2: ", errors)
        self.assertIn("--origin 54", errors)
        self.done("map", "import", survey, "--out", self.folder / "a.slammap", *more, "--origin", 545_000, 4_701_000)
        for (x, y, _), (east, north) in zip(self.landmarks(self.folder / "a.slammap").values(), points):
            self.assertAlmostEqual(x, east - 545_000.0, places=4)
            self.assertAlmostEqual(y, north - 4_701_000.0, places=4)

    def test_degrees_take_no_origin(self):
        survey = self.folder / "degrees.csv"
        survey.write_text("Lat,Lng\n-35.1,149.1\n-35.1001,149.1001\n-35.1002,149.1003\n")
        out = self.folder / "a.slammap"
        code, _, errors = run("map", "import", survey, "--out", out, "--origin", 1, 2)
        self.assertEqual(code, USAGE, errors)
        self.assertIn("--datum", errors)
        self.done("map", "import", survey, "--out", out)

    def test_errors_name_file_line_and_remedy(self):
        self.refused("1,2\n3,4\n", "bad.csv:1: ", "--columns X Y")
        self.refused("# made by hand\nx_m,y_m\n1,2\n3,east\n5,6\n", "bad.csv:4: ", 'east')
        self.refused("x_m,y_m\n1,2\n3\n", "bad.csv:3: ")
        self.refused("lat,lon\n1,2\n95,4\n", "bad.csv:3: ", "-90", "90")
        self.refused("x_m,y_m\n1,2\n3,4\n", "three or more")
        self.refused("plot,x_m,y_m\n1,1,2\n", "plot = 4", more=["--where", "plot=4"])
        self.refused("x_m,y_m\n1,2\n", "'plot'", more=["--where", "plot=4"])
        self.refused("x_m,y_m\n1,2\n", "COLUMN=VALUE", more=["--where", "plot"], status=USAGE)
        self.refused("x_m,y_m\n", "no point")
        self.refused("", "bad.csv")

    def test_errors_in_geojson_name_file_line_and_remedy(self):
        def collection(*coordinates, extra=""):
            features = ",\n".join('{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":%s}}' % c
                                  for c in coordinates)
            return '{"type":"FeatureCollection",%s"features":[\n%s\n]}\n' % (extra, features)
        self.refused('{"type":\n"FeatureCollection",\n"features":[}\n', "bad.json:3: ", "no JSON", name="bad.json")
        self.refused(collection("[1,2]", "[1.1,2]", '["a",2]'), "bad.json:4: ", "[longitude, latitude]", name="bad.json")
        self.refused(collection("[1,2]", "[545000,4701000]"), "bad.json:3: ", "EPSG:4326", '"crs": null', name="bad.json")
        self.refused(collection("[1,2]", extra='"crs":{"type":"name","properties":{"name":"EPSG:25830"}},'),
                     "EPSG:25830", "ogr2ogr", name="bad.json")
        self.refused('{"type":"LineString","coordinates":[[1,2],[3,4]]}', "no Point", name="bad.json")
        self.refused('{"a": 1}', "no GeoJSON", name="bad.json")
        self.refused('{"type":5}', "bad.json:1: ", "a text", name="bad.json")
        self.refused('{"type":"FeatureCollection","features":{"a":1}}', "bad.json:1: ", "[...]", name="bad.json")
        self.refused('{"type":"Feature","geometry":{"type":null,"coordinates":[1,2]}}', "bad.json:1: ", name="bad.json")

    def test_numbers_and_names_that_no_map_has_are_usage_errors(self):
        survey = self.survey(random_points(2, 9, 20.0))
        target = self.folder / "x.slammap"
        for more in (["--origin", "nan", "0"], ["--origin", "0", "inf"], ["--datum", "10", "0", "1e308", "0"],
                     ["--datum", "10", "0", "10001", "0"], ["--datum", "10", "0", "nan", "0"]):
            code, _, errors = run("map", "import", survey, "--out", target, *more)
            self.assertEqual(code, USAGE, f"{more}: {errors}")
            self.assertFalse(target.exists())
        code, _, errors = run("map", "import", survey, "--out", self.folder / "x")
        self.assertEqual(code, USAGE, errors)
        self.assertIn(".slammap", errors)
        code, _, errors = run("map", "import", survey, "--out", survey, "--replace")
        self.assertEqual(code, USAGE, errors)
        link = self.folder / "link.slammap"
        link.symlink_to(survey)
        code, _, errors = run("map", "import", survey, "--out", link, "--replace")
        self.assertEqual(code, CANTCREAT, errors)
        self.assertIn("survey itself", errors)

    # --- export ---------------------------------------------------------------------------------------------------

    def with_path(self):
        """A map as a drive leaves it, with xi and a path, written by the second writer of the format."""
        none = 0xFFFFFFFF
        land = b"".join(struct.pack("<9Iddf", i, 0 if i < 60 else 1 + i % 4, *((none,) * 3 if i < 60 else (i % 20, 21, 22)),
                                    3 + i % 9, 20, 0, 11, x, y, 0.05 * (i % 7))
                        for i, (x, y) in enumerate(random_points(5, 120, 60.0)))
        path = b"".join(struct.pack("<IIddd", i, i // 3, -30.0 + 5.0 * i, 0.1 * i, 0.1 * i) for i in range(12))
        info = struct.pack("<QqqQQQII", 3, 1767225600, 1795439109, 99, 0, 0, 120, 12)
        info += struct.pack("<dddII", 0.5, 0.25, 0.009, 2, 30) + struct.pack("<B", 0) + write_golden.text(b"drive")
        target = self.folder / "drive.slammap"
        target.write_bytes(write_golden.file(3, [write_golden.section(b"INFO", 1, len(info), info),
                                                 write_golden.section(b"LAND", 120, 56, land),
                                                 write_golden.section(b"PATH", 12, 32, path)]))
        return target

    def test_every_format_is_read_by_gdal(self):
        if shutil.which("ogrinfo") is None:
            self.skipTest("ogrinfo (gdal-bin) is not installed: tools/setup test")
        drive = self.with_path()
        count = len(self.landmarks(drive))
        self.assertGreater(count, 50)
        # Format, driver, and what the layers hold.
        for name, driver in [("geojson", "GeoJSON"), ("csv", "CSV"), ("gpx", "GPX"), ("kml", "KML")]:
            path = self.folder / f"drive.{name}"
            self.done("map", "export", drive, "--format", name, "--datum", *DATUM, "--out", path)
            told = ogrinfo(path, "-so")
            self.assertIn(f"using driver `{driver}'", told.replace("LIBKML", "KML"))
            counts = [int(line.split(":")[1]) for line in told.splitlines() if line.startswith("Feature Count")]
            if name == "geojson":
                self.assertEqual(counts, [count + 1])
                self.assertIn("sightings: Integer", told)
                self.assertIn("xi: Integer", told)
                self.assertIn("sigma_m: Real", told)
            elif name == "csv":
                self.assertEqual(counts, [count + 12])
            elif name == "gpx":
                self.assertIn(count, counts)  # waypoints
                self.assertIn(12, counts)     # track_points
                self.assertIn("slamsensor_xi", told)
                self.assertIn("slamsensor_sigma_m", told)
                self.assertTrue("xi 0, sightings 3, scans" in path.read_text(), path)
            else:
                self.assertEqual(sorted(counts), [1, count])
        extent = [line for line in ogrinfo(self.folder / "drive.geojson", "-so").splitlines() if "Extent" in line][0]
        corners = [float(v) for v in extent.replace("Extent:", "").replace("-  (", ",").translate(
            str.maketrans("()", "  ")).replace(" - ", ",").replace(", ", ",").split(",") if v.strip()]
        self.assertAlmostEqual(corners[0], -2.445, delta=0.002)
        self.assertAlmostEqual(corners[1], 42.4627, delta=0.002)

    def test_without_a_datum_metres_are_said_to_be_metres(self):
        drive = self.with_path()
        text = self.done("map", "export", drive, "--format", "geojson")
        root = json.loads(text)
        self.assertIn("ENGCRS", root["crs"]["properties"]["name"])
        self.assertIn("local metres", root["slamsensor"]["frame"])
        code, table, said = run("map", "export", drive, "--format", "csv")
        self.assertEqual(code, OK)
        self.assertNotIn("latitude", table)
        self.assertIn("metres in the map's frame, for the map has no datum", said)
        if shutil.which("ogrinfo"):
            path = self.write("local.geojson", text)
            told = ogrinfo(path, "-so")
            self.assertNotIn("WGS 84", told)
            self.assertIn("local metres", told)
        for name in ("gpx", "kml"):
            code, output, errors = run("map", "export", drive, "--format", name)
            self.assertEqual((code, output), (DATAERR, ""))
            self.assertIn("--datum", errors)
            self.assertIn("drive.slammap", errors)

    def test_what_is_exported_comes_back(self):
        drive = self.with_path()
        before = self.landmarks(drive)
        for name in ("geojson", "csv"):
            for datum in ([], ["--datum", *DATUM]):
                text = self.folder / f"back.{name}"
                self.done("map", "export", drive, "--format", name, "--out", text, *datum)
                back = self.folder / "back.slammap"
                told = self.done("map", "import", text, "--out", back, "--replace")
                after = self.landmarks(back)
                self.assertEqual(list(before), list(after), told)
                for key in before:
                    self.assertAlmostEqual(before[key][0], after[key][0], delta=0.001, msg=f"{name} {datum}")
                    self.assertAlmostEqual(before[key][1], after[key][1], delta=0.001, msg=f"{name} {datum}")
                    self.assertEqual(after[key][2], 0)

    def test_maps_that_are_not_there_and_files_that_are_none(self):
        code, _, errors = run("map", "export", "nowhere", "--format", "csv", "--store", self.store)
        self.assertEqual(code, DATAERR)
        self.assertIn("--store", errors)
        code, _, errors = run("map", "export", self.survey([(1, 2)]), "--format", "csv")
        self.assertEqual(code, DATAERR)
        self.assertIn("survey.csv", errors)
        self.assertEqual(run("map")[0], USAGE)
        self.assertEqual(run("map", "export", "x", "--format", "shp")[0], USAGE)

    # --- a survey in, a scan located ------------------------------------------------------------------------------

    def located(self, map_path, scans, *more):
        poses = self.folder / "poses.csv"
        self.done("locate", "--map", map_path, "--scans", scans, "--out", poses, *more)
        with open(poses, encoding="ascii") as file:
            return list(csv.DictReader(file))

    def test_rioja_plots_surveyed_on_the_ground_locate_the_terrestrial_scans(self):
        folder = DATA / "rioja_plots"
        if not folder.is_dir():
            self.skipTest(f"{folder} is not there (SLAMSENSOR_DATA)")
        scans = collections.defaultdict(list)
        with open(folder / "scan.csv", encoding="ascii") as file:
            for row in csv.DictReader(file):
                scans[int(row["plot"])].append((row["x_m"], row["y_m"], row["diameter_m"]))
        with open(folder / "map.csv", encoding="ascii") as file:
            surveyed = [(int(row["plot"]), float(row["x_m"]), float(row["y_m"])) for row in csv.DictReader(file)]
        fixes = 0
        for plot, trees in sorted(scans.items()):
            survey = self.folder / f"plot{plot}.slammap"
            self.done("map", "import", folder / "map.csv", "--where", f"plot={plot}", "--out", survey)
            scan = self.write("scan.csv", "scan,x_m,y_m,diameter_m\n" + "".join(f"{plot},{x},{y},{d}\n" for x, y, d in trees))
            pose = self.located(survey, scan, "--config", CONFIG / "rioja_plots.toml")[0]
            if pose["status"] != "fix":
                print(f"rioja plot {plot:2}: {pose['status']} ({pose['reason']}), {pose['matches']} of {len(trees)} trees")
                continue
            fixes += 1
            x, y, heading = (float(pose[name]) for name in ("x_m", "y_m", "heading_rad"))
            # How far the trees of the scan, carried by the pose, stand from those of the survey.
            apart = []
            for tx, ty, _ in trees:
                px = x + float(tx) * math.cos(heading) - float(ty) * math.sin(heading)
                py = y + float(tx) * math.sin(heading) + float(ty) * math.cos(heading)
                apart.append(min(math.hypot(sx - px, sy - py) for number, sx, sy in surveyed if number == plot))
            paired = [d for d in apart if d < 0.6]
            rms_m = math.sqrt(sum(d * d for d in paired) / len(paired))
            print(f"rioja plot {plot:2}: fix ({pose['reason']}), protection radius {pose['protection_radius_m']} m, {pose['matches']} of "
                  f"{len(trees)} trees, {rms_m:.3f} m from the survey's (RMS), a pose from them "
                  f"is good to {rms_m / math.sqrt(len(paired)):.3f} m; the scan's frame lies {math.hypot(x, y):.2f} m and "
                  f"{math.degrees(heading):.2f} deg from the survey's")
            self.assertLess(rms_m, 0.35, pose)
            self.assertTrue(-11.0 < math.degrees(heading) < -7.0 and math.hypot(x, y) < 2.6, pose)
        self.assertEqual(fixes, 16)

    def test_the_parks_of_a_city_imported_locate_made_scans(self):
        source = DATA / "stem_maps" / "portland_parks.csv"
        if not source.is_file():
            self.skipTest(f"{source} is not there (SLAMSENSOR_DATA)")
        rows = [line.split(",") for line in source.read_text().splitlines() if not line.startswith("#")]
        survey = self.write("portland.csv", "park,x_m,y_m\n" + "".join(",".join(r) + "\n" for r in rows))
        told = self.done("map", "import", survey, "--out", "portland", "--store", self.store, "--datum", "45.52",
                         "-122.66", "15", "90")
        print(told.splitlines()[1])
        trees = [(float(r[1]), float(r[2])) for r in rows]
        draw = random.Random(7)
        lines, truth = ["scan,x_m,y_m"], []
        while len(truth) < 20:
            x0, y0 = draw.choice(trees)
            x0, y0, heading = x0 + draw.uniform(-5, 5), y0 + draw.uniform(-5, 5), draw.uniform(-math.pi, math.pi)
            seen = [(x - x0, y - y0) for x, y in trees if abs(x - x0) < 35 and math.hypot(x - x0, y - y0) < 35]
            if len(seen) < 15:
                continue
            for dx, dy in seen:
                lines.append(f"{len(truth)},{dx * math.cos(heading) + dy * math.sin(heading) + draw.gauss(0, 0.05):.4f},"
                             f"{-dx * math.sin(heading) + dy * math.cos(heading) + draw.gauss(0, 0.05):.4f}")
            truth.append((x0, y0))
        poses = self.located(self.store / "portland.slammap", self.write("scans.csv", "\n".join(lines) + "\n"),
                             "--no-deadline")
        errors = [math.hypot(float(p["x_m"]) - x, float(p["y_m"]) - y)
                  for p, (x, y) in zip(poses, truth) if p["status"] == "fix"]
        print(f"portland: {len(errors)} of 20 scans located among {len(trees)} trees, worst {max(errors):.3f} m")
        self.assertGreaterEqual(len(errors), 15)
        self.assertLess(max(errors), 0.5)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0]] + sys.argv[3:], verbosity=1)
