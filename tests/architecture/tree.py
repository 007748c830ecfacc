#!/usr/bin/env python3
"""The state of the house: tree.py entries|words|config|skips|headers|types ROOT."""
import collections
import pathlib
import re
import sys

import house

ENTRIES = {"CMakeLists.txt", "README.md", "firmware", "hal", "core", "config", "systemd", "tests", "tools"}
PRODUCT = ("core", "hal", "firmware", "tools", "config", "systemd", "CMakeLists.txt", "README.md")

# Places on the machine of whoever wrote the line.
MACHINE = re.compile(r"(?<![\w.$}])/(?:work|root|home|Users|mnt)(?:/|\b)")
SCRATCH = re.compile(r"(?<![\w.$}])/(?:var/)?tmp(?:/|\b)")
# A class, struct or enumeration of a namespace; neither a specialisation nor a declaration.
TYPE = re.compile(r"^(?:template <[^>]*>\s*)?(?:class|struct|enum class)\s+([A-Z]\w*)(?![\w:<])[^;{()]*\{", re.MULTILINE)
TYPES_TWICE = {"Config"}  # all settings of the sensor, and core's part of them

UNFINISHED = re.compile(r"\b(?:TO[D]O|FIX[M]E|X[X]X|HA[C]K)\b")


def entries(root):
    """The top level holds the rooms of the house and nothing else, hidden files aside."""
    present = {name.split("/")[0] for name in house.files_of(root)}
    for missing in sorted(ENTRIES - present):
        print(f"note: {missing} is not there (yet)")
    return [house.Finding(name, 0, "not a room of the house")
            for name in sorted(present - ENTRIES) if not name.startswith(".")]


def lines_of(root):
    for name in house.files_of(root):
        try:
            text = house.read(root, name)
        except UnicodeDecodeError:
            continue  # not text
        for number, line in enumerate(text.splitlines(), 1):
            yield name, number, line


def words(root):
    """No file names a place on its author's machine, and none says that it is unfinished."""
    findings = []
    for name, number, line in lines_of(root):
        if MACHINE.search(line) or (name.split("/")[0] in PRODUCT and SCRATCH.search(line)):
            findings.append(house.Finding(name, number, "names a place of one machine"))
        if UNFINISHED.search(line):
            findings.append(house.Finding(name, number, "says that it is not finished"))
    return findings


def config(root):
    """Every profile is one that a reader of the README hears of."""
    if not (root / "README.md").is_file():
        house.skip("there is no README.md that could name the profiles")
    readme = house.read(root, "README.md")
    profiles = [name for name in house.files_of(root) if re.match(r"config/[^/]+\.toml$", name)]
    return [house.Finding(name, 1, "the README does not name this profile")
            for name in profiles if not named(pathlib.PurePath(name).name, readme)]


def named(profile, readme):
    """Whether `readme` has the file name, or a numbered family of it (experiment-1.toml: experiment-*.toml, -N)."""
    stem = re.escape(profile.removesuffix(".toml"))
    family = re.sub(r"\d+$", r"(?:\\*|N|\\d|\\[1-\\d\\]|\\{[\\d,.]+\\})", profile.removesuffix(".toml"))
    return re.search(rf"(?<![\w-])(?:{stem}|{family})\.toml\b", readme) is not None


def skips(root):
    """A test that does not run says why: none is disabled, and GTEST_SKIP has a message."""
    findings = []
    for name in house.cpp_files(root, ("tests",)):
        text = house.without_comments(house.read(root, name))
        for match in re.finditer(r"\bDISABLED_\w*|\bGTEST_SKIP\s*\(\s*\)\s*(?!<<)(?=\S)", text):
            findings.append(house.Finding(name, house.line_of(text, match.start()), f"{match.group(0).strip()}: a test "
                                          "that does not run must say why"))
    return findings


def headers(root):
    """One header name, one meaning: no two headers of the product are called the same."""
    places = collections.defaultdict(list)
    for name in house.cpp_files(root):
        if name.endswith(".hpp"):
            places[pathlib.PurePath(name).name].append(name)
    return [house.Finding(name, 1, f"{places[title][0]} has this header's name too")
            for title in places for name in places[title][1:]]


def types(root):
    """One type name, one meaning: no two headers of the product define a type of the same name."""
    places = collections.defaultdict(list)
    for name in house.cpp_files(root):
        if name.endswith(".hpp"):
            text = house.without_comments(house.read(root, name))
            for match in TYPE.finditer(text):
                places[match.group(1)].append((name, house.line_of(text, match.start(1))))
    return [house.Finding(name, line, f"{places[title][0][0]} has a type {title} too")
            for title in places if title not in TYPES_TWICE for name, line in places[title][1:]]


CHECKS = {check.__name__: check for check in (entries, words, config, skips, headers, types)}

if __name__ == "__main__":
    house.finish(CHECKS[sys.argv[1]](pathlib.Path(sys.argv[2])), sys.argv[1])
