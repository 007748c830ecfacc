#!/usr/bin/env python3
"""The size of the house in figures: figures.py ROOT [FOLDER...]. For each room, or for each folder named, its lines, its
files, the median and the largest file, its functions over 60 lines; then the files of each folder that holds sources."""
import collections
import pathlib
import statistics
import sys

import house
import sizes


def figures_of(root, names):
    """Lines, files, median, largest and its name, functions, those over the limit; of the C++ files `names`."""
    lengths = {name: house.read(root, name).count("\n") for name in names}
    functions = [length for name in names for _, _, length in sizes.functions(house.read(root, name))]
    largest = max(lengths, key=lengths.get)
    return (sum(lengths.values()), len(names), round(statistics.median(lengths.values())), lengths[largest], largest,
            len(functions), sum(length > sizes.FUNCTION_LINES_MAX for length in functions))


def rows(root, parts):
    """(part, its figures) of each part that holds C++ files, and of all together."""
    held = {part: [name for name in house.cpp_files(root, house.ROOMS + ("tests",)) if name.startswith(part + "/")]
            for part in parts}
    held = {part: names for part, names in held.items() if names}
    product = sorted({name for part, names in held.items() if part.split("/")[0] != "tests" for name in names})
    if product and len(held) > 1:
        held["product"] = product
    return [(part, figures_of(root, names)) for part, names in held.items()]


def folders(root, parts):
    """(folder, number of C++ files directly in it, their lines), the fullest first."""
    count, lines = collections.Counter(), collections.Counter()
    for name in house.cpp_files(root, house.ROOMS + ("tests",)):
        if any(name.startswith(part + "/") for part in parts):
            folder = str(pathlib.PurePath(name).parent)
            count[folder] += 1
            lines[folder] += house.read(root, name).count("\n")
    return [(folder, files, lines[folder]) for folder, files in count.most_common()]


def main(root, parts):
    print(f"{'':28}{'lines':>7}{'files':>7}{'median':>8}{'largest':>9}{'functions':>11}{'over 60':>9}")
    for part, (lines, files, median, longest, name, functions, over) in rows(root, parts):
        print(f"{part:28}{lines:7}{files:7}{median:8}{longest:9}{functions:11}{over:9}  {name}")
    print(f"\n{'folder':36}{'files':>7}{'lines':>8}")
    for folder, files, lines in folders(root, parts):
        print(f"{folder:36}{files:7}{lines:8}")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]), sys.argv[2:] or house.ROOMS + ("tests",))
