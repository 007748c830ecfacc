#!/usr/bin/env python3
"""Files of at most 600 lines, functions of at most 60: sizes.py ROOT. A function is counted from the line of its
opening brace to the line of its closing one; lambdas count in the function that holds them."""
import pathlib
import re
import statistics
import sys

import house

FILE_LINES_MAX = 600
FUNCTION_LINES_MAX = 60
MEDIAN_LINES_MAX = 10

TYPE = re.compile(r"^(?:template\s*<.*>\s*)?(?:typedef\s+)?(?:class|struct|union|enum)\b")
SCOPE = re.compile(r'^(?:inline\s+)?namespace\b|^extern\s*"\s*"$')
TOKEN = re.compile(r"[{}();]")


def matching(text, opening):
    """The offset after the brace that closes the one at `opening`."""
    depth = 0
    for match in re.compile(r"[{}]").finditer(text, opening):
        depth += 1 if match.group(0) == "{" else -1
        if depth == 0:
            return match.end()
    raise ValueError(f"line {house.line_of(text, opening)}: a brace that nothing closes")


def is_type(head):
    return TYPE.match(head) is not None and "(" not in re.sub(r"alignas\s*\([^)]*\)", "", head)


def is_function(head):
    """Whether a brace after `head`, outside functions, opens a body and not an initialiser."""
    if re.search(r"\)\s*(?:noexcept\b.*)?:[^:]", head):  # a constructor's list: a body follows ')', '}' or nothing
        return re.search(r"[)}]\s*$", head) is not None
    assigned = re.search(r"(?<![=!<>])=(?!=)", head)
    operator = re.search(r"operator\s*\S*=", head)
    return "(" in head and (not assigned or operator is not None or assigned.start() > head.index("("))


def functions(text):
    """(line of the head, name, number of lines) of every function body in `text`."""
    text = house.without_comments(text)
    text = re.sub(r"^[ \t]*#(?:[^\n]*\\\n)*[^\n]*", lambda m: "\n" * m.group(0).count("\n"), text, flags=re.MULTILINE)
    found = []
    start = position = depth = 0  # of the declaration that is being read; parentheses that are open
    while match := TOKEN.search(text, position):
        position = match.end()
        token = match.group(0)
        depth += {"(": 1, ")": -1}.get(token, 0)
        if token == "}" or (token == ";" and depth == 0):
            start = position
        if token != "{":
            continue
        raw = text[start : match.start()]
        head = re.sub(r"^(?:\s*(?:public|private|protected)\s*:(?!:))+", "", raw).strip()
        if depth == 0 and (SCOPE.match(head) or is_type(head)):
            start = position
            continue
        end = matching(text, match.start())
        if depth == 0 and is_function(head):
            lines = text.count("\n", match.start(), end) + 1
            name = re.search(r"([\w:~]+|operator\s*\S+?)\s*\(", head)
            found.append((house.line_of(text, match.start()), name.group(1) if name else "?", lines))
            start = end
        position = end
    return found


def check(root):
    findings = []
    lengths = []
    for name in house.cpp_files(root, house.ROOMS + ("tests",)):
        text = house.read(root, name)
        lines = text.count("\n")
        if lines > FILE_LINES_MAX:
            findings.append(house.Finding(name, lines, f"{lines} lines, at most {FILE_LINES_MAX}"))
        for line, function, length in functions(text):
            if not name.startswith("tests/"):
                lengths.append(length)
            if length > FUNCTION_LINES_MAX:
                message = f"{function} has {length} lines, at most {FUNCTION_LINES_MAX}"
                findings.append(house.Finding(name, line, message))
    if lengths:
        median = statistics.median(lengths)
        print(f"{len(lengths)} functions of the product: median {median} lines, longest {max(lengths)}")
        if median > MEDIAN_LINES_MAX:
            message = f"the median function has {median} lines, at most {MEDIAN_LINES_MAX}"
            findings.append(house.Finding(".", 0, message))
    return findings


if __name__ == "__main__":
    house.finish(check(pathlib.Path(sys.argv[1])), "sizes")
