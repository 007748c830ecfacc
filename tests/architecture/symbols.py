#!/usr/bin/env python3
"""What the compiled core calls and keeps: symbols.py LIBRARY [NM [SIZE]]. The library may call only itself, libm and the
memory functions that compilers put in; so it cannot allocate, throw, lock, print, open or read a clock, whichever
header a call came from. It keeps no variables of its own."""
import re
import subprocess
import sys

import house

MEMORY = "memcmp memcpy memmove memset"
MATH = (
    "acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erf erfc exp exp2 expm1 fabs fdim floor fma fmax "
    "fmin fmod frexp hypot ilogb ldexp llrint llround log log10 log1p log2 logb lrint lround modf nearbyint nextafter "
    "pow remainder rint round scalbn sin sincos sinh sqrt tan tanh trunc"
)
ALLOWED = (
    set(MEMORY.split())
    | set(MATH.split())
    | {name + "f" for name in MATH.split()}
    | {"_GLOBAL_OFFSET_TABLE_"}
    # 128-bit integers (exact predicates) where the machine has none
    | {"__multi3", "__divti3", "__udivti3", "__modti3", "__umodti3"}
)
VARIABLES = re.compile(r"^\.(?:data|bss|tdata|tbss)(?!\.rel\.ro)\b|^COMMON$")


def run(command):
    return subprocess.run(command, capture_output=True, check=True, text=True).stdout.splitlines()


def undefined(library, nm):
    """(member, symbol) of everything that is called but not defined in the library itself."""
    defined = set()
    called = []
    member = library
    for line in run([nm, "-P", "-A", library]):
        place, rest = line.split(": ", 1)
        member = place.split("[")[-1].rstrip("]")
        name, kind = rest.split()[:2]
        if kind in "UwvX?" and kind != "X":
            called.append((member, name))
        else:
            defined.add(name)
    return sorted({(where, name) for where, name in called if name not in defined})


def readable(name):
    try:
        return run(["c++filt", name])[0]
    except (OSError, subprocess.CalledProcessError):
        return name


def variables(library, size):
    """(member, section, bytes) of all that can be written."""
    member = library
    for line in run([size, "-A", library]):
        if heading := re.match(r"^(\S+)\s+(?::|\(ex )", line):
            member = heading.group(1)
        parts = line.split()
        if len(parts) == 3 and VARIABLES.match(parts[0]) and parts[1] != "0":
            yield member, parts[0], parts[1]


def check(library, nm="nm", size="size"):
    findings = [house.Finding(member, 0, f"core must not call {readable(name)}")
                for member, name in undefined(library, nm) if name not in ALLOWED]
    findings += [house.Finding(member, 0, f"core must keep no variables: {count} bytes in {section}")
                 for member, section, count in variables(library, size)]
    return findings


if __name__ == "__main__":
    house.finish(check(*sys.argv[1:]), f"symbols of {sys.argv[1].split('/')[-1]}")
