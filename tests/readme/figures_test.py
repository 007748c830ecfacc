"""The README's numbers against the last run of the programs that measure them (build/results). Usage: figures_test.py SOURCE_TREE"""
import csv
import pathlib
import re
import sys
import unittest

from readme import Readme

TREE = pathlib.Path(sys.argv[1])
RESULTS = TREE / "build" / "results"
README = Readme(TREE)


def measured(name):
    """Figures by name; none when that was not measured here."""
    path = RESULTS / f"{name}.csv"
    if not path.is_file():
        return None
    with open(path, encoding="ascii") as file:
        return {row["figure"]: float(row["value"]) for row in csv.DictReader(file)}


def numbers(text):
    return [float(n.replace(",", "")) for n in re.findall(r"\d[\d,]*(?:\.\d+)?", text)]


class Figures(unittest.TestCase):
    def row(self, begin):
        return next(row for row in README.table("Measured") if row[0].startswith(begin))

    def results(self, *names):
        found = [measured(name) for name in names]
        missing = [name for name, figures in zip(names, found) if figures is None]
        if missing:
            self.skipTest(f"not measured here: {', '.join(missing)}")
        return found

    def test_real_data(self):
        for name in ("campus_trees", "oxford_forest", "victoria_park"):
            with self.subTest(name):
                (figures,) = self.results(name)
                row = self.row(name)
                self.assertEqual(numbers(row[1]), [figures["fixes"], figures["scans"]])
                self.assertEqual(int(row[2]), figures["wrong"])
                self.assertEqual(row[3], f"{figures['rms_m']:.2f} m")

    def test_rioja(self):
        (figures,) = self.results("rioja_plots")
        row = self.row("rioja_plots")
        self.assertEqual(numbers(row[1]), [figures["fixes"], figures["scans"]])
        self.assertEqual(int(row[2]), figures["wrong"])

    def test_simulated_bush(self):
        three, four = self.results("bush-experiment-3", "bush-experiment-4")
        if {three["seeds"], four["seeds"]} != {4.0}:
            self.skipTest("the last run had another number of seeds")
        row = self.row("simulated bush")
        self.assertEqual(numbers(row[1]), [three["fixes"], four["fixes"], three["scans"]])
        self.assertEqual(int(row[2]), three["wrong"] + four["wrong"])

    def test_experiments_through_the_bytes(self):
        found = self.results(*(f"bytes-experiment-{i}" for i in (1, 2, 3, 4)))
        row = self.row("experiments I to IV")
        self.assertEqual(numbers(row[1]), [sum(f["fixes"] for f in found), sum(f["scans"] for f in found)])
        self.assertEqual(int(row[2]), sum(f["wrong"] for f in found))
        self.assertEqual(numbers(row[3])[0], max(round(f["pan_rms_mdeg"]) for f in found))

    def test_comparison(self):
        (figures,) = self.results("comparison")
        text = re.sub(r"\s+", " ", README.section("Measured"))
        for figure, value in figures.items():
            shown = f"{value:.2f}" if figure.endswith("_m") else f"{value:,.10g}"
            self.assertRegex(text, rf"(?<![\d.,]){re.escape(shown)}(?![\d])", figure)

    def test_half_an_hour_in_real_time(self):
        (figures,) = self.results("soak")
        if figures["minutes"] < 30:
            self.skipTest("the last run was shorter")
        told = re.search(r"for 30 minutes.*?: no reading lost, no allocation or page fault.*?, ([\d,]+) of (\S+) million steps over 5 ms "
                         r"\(worst (\S+) ms, cyclictest's beside it (\S+) ms\), (\d+) MB, scan end to NMEA (\S+) ms \(worst (\S+?)[;)]",
                         re.sub(r"\s+", " ", README.section("Measured")))
        self.assertIsNotNone(told)
        self.assertEqual([figures[name] for name in ("readings_lost", "allocations", "page_faults")], [0, 0, 0])
        self.assertEqual(list(told.groups()), [f"{figures['steps_late']:,.0f}", f"{figures['steps'] / 1e6:.1f}", f"{figures['worst_ms']:.1f}",
                                               f"{figures['cyclictest_worst_ms']:.1f}", f"{figures['memory_mb']:.0f}",
                                               f"{figures['answer_median_ms']:.1f}", f"{figures['answer_worst_ms']:.1f}"])

    def test_a_thousand_kills(self):
        (figures,) = self.results("kills")
        told = re.search(r"Killed ([\d,]+) times.*?: (\d+) of (\d+) restarts fixed at once", re.sub(r"\s+", " ", README.section("Measured")))
        kills, fixed, waited = numbers(" ".join(told.groups()))
        if figures["kills"] != kills:
            self.skipTest("the last run had another number of kills")
        self.assertEqual((figures["fixed"], figures["waited"], figures["problems"]), (fixed, waited, 0))


if __name__ == "__main__":
    program = unittest.main(argv=[sys.argv[0]], verbosity=1, exit=False)
    if program.result.wasSuccessful() and len(program.result.skipped) > 0 and not RESULTS.is_dir():
        sys.exit(77)
    sys.exit(not program.result.wasSuccessful())
