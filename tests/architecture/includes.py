#!/usr/bin/env python3
"""Who may include what: includes.py ROOT. Core sees itself, Eigen and a short list of standard headers; hal nothing of
core, firmware or tools; firmware nothing of tools; nobody the tests."""
import pathlib
import re
import sys

import house

MAY_SEE = {
    "core": {"core"},
    "hal": {"hal"},
    "firmware": {"core", "hal", "firmware"},
    "tools": {"core", "hal", "firmware", "tools"},
    "tests": {"core", "hal", "firmware", "tools", "tests"},
}

# Headers that neither allocate, throw, lock, read a clock nor do I/O; what some of them also offer is a forbidden word.
CORE_STANDARD = set(
    "algorithm array bit chrono climits cmath compare concepts cstddef cstdint cstdlib cstring initializer_list iterator "
    "limits numbers numeric optional ratio span string_view tuple type_traits utility variant".split()
)
CORE_ALSO = {"core/memory/arena.hpp": {"new"}}  # placement only
CORE_WORDS = re.compile(
    r"\b(throw|try|catch|dynamic_cast|typeid|thread_local|co_await|co_yield|goto|asm|malloc|calloc|realloc|printf|"
    r"\w*_clock|std::(?:string|vector|function|map|set|deque|list|unique_ptr|shared_ptr|mutex|thread|atomic)|"
    r"(?<!::)new|delete(?!\s*;))\b(?!_)"
)

TEST_ONLY = re.compile(r"^(gtest|gmock|benchmark|rapidcheck|CGAL)/")
INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"\n]*)"|<([^>\n]*)>|(\S.*))', re.MULTILINE)


def check_core(name, text, add):
    allowed = CORE_STANDARD | CORE_ALSO.get(name, set())
    for match in INCLUDE.finditer(text):
        header = match.group(2)
        if header and header not in allowed and not header.startswith("Eigen/"):
            add(match, f"core must not include <{header}>")
    code = INCLUDE.sub(lambda match: " " * len(match.group(0)), house.without_comments(text))
    for match in CORE_WORDS.finditer(code):
        if match.group(0) != "delete" or not re.search(r"=\s*$", code[: match.start()]):
            add(match, f"core must not use '{match.group(0)}'")


def check(root):
    findings = []
    known = set(house.files_of(root))
    for name in house.cpp_files(root, MAY_SEE):
        room = name.split("/")[0]
        text = house.without_comments(house.read(root, name), keep_strings=True)

        def add(match, message, name=name, text=text):
            findings.append(house.Finding(name, house.line_of(text, match.start()), message))

        for match in INCLUDE.finditer(text):
            own, system, computed = match.groups()
            if computed:
                add(match, "an include that is computed cannot be checked")
            elif own is not None and own.split("/")[0] not in MAY_SEE[room]:
                add(match, f'{room} must not include "{own}" (paths start with the room, and {room} sees '
                           f"{', '.join(sorted(MAY_SEE[room]))})")
            elif own is not None and own not in known:
                add(match, f'"{own}" is no file of the house')
            elif system and system.split("/")[0] in MAY_SEE and room != "core":
                add(match, f"a header of the house stands in quotes: <{system}>")
            elif system and TEST_ONLY.match(system) and room not in ("core", "tests"):
                add(match, f"{room} must not include <{system}>")
        if room == "core":
            check_core(name, text, add)
        if name.endswith(".hpp") and not re.search(r"^#pragma once$", text, re.MULTILINE):
            findings.append(house.Finding(name, 1, "a header without #pragma once"))
    return findings


if __name__ == "__main__":
    house.finish(check(pathlib.Path(sys.argv[1])), "include rule")
