"""What the architecture checks share: the files of the house, C++ text without comments, and the way to report."""
import os
import pathlib
import subprocess
import sys

CPP = (".cpp", ".hpp")
ROOMS = ("core", "hal", "firmware", "tools")
SKIPPED = 77  # what CTest is told to read as "skipped"


class Finding:
    """A broken rule at a place."""

    def __init__(self, path, line, message):
        self.path, self.line, self.message = path, line, message

    def __str__(self):
        return f"{self.path}:{self.line}: {self.message}"


def files_of(root):
    """Paths relative to `root` of all that git tracks or would track; without git, of all but hidden and build folders."""
    command = ["git", "-c", "safe.directory=*", "-C", str(root), "ls-files", "-z", "--cached", "--others",
               "--exclude-standard"]
    try:
        listed = subprocess.run(command, capture_output=True, check=True).stdout.decode().split("\0")
    except (OSError, subprocess.CalledProcessError):
        listed = walk(root)
    return sorted({name for name in listed if name and (pathlib.Path(root) / name).is_file()})


def walk(root):
    for folder, folders, names in os.walk(root):
        folders[:] = [f for f in folders if not f.startswith((".", "build")) and f not in ("out", "__pycache__")]
        for name in names:
            yield str((pathlib.Path(folder) / name).relative_to(root))


def cpp_files(root, rooms=ROOMS):
    return [name for name in files_of(root) if name.endswith(CPP) and name.split("/")[0] in rooms]


def read(root, name):
    return (pathlib.Path(root) / name).read_text(encoding="utf-8")


def without_comments(text, keep_strings=False):
    """`text` with the same lines, but blanks for comments and, unless told otherwise, for the insides of literals."""
    out = []
    i = 0
    while i < len(text):
        end, is_comment = end_of_skipped(text, i)
        if end == i:
            out.append(text[i])
            i += 1
            continue
        piece = text[i:end]
        if is_comment or not keep_strings:
            blanks = "".join(c if c == "\n" else " " for c in piece)
            piece = blanks if is_comment else piece[0] + blanks[1:-1] + piece[-1]
        out.append(piece)
        i = end
    return "".join(out)


def end_of_skipped(text, i):
    """Where the comment or literal that starts at `i` ends (`i` itself when none does), and whether it is a comment."""
    if text.startswith("//", i):
        return (text + "\n").index("\n", i), True
    if text.startswith("/*", i):
        end = text.find("*/", i + 2)
        return (len(text) if end < 0 else end + 2), True
    if text[i] == '"' and text[i - 1 : i] == "R":
        fence = ")" + text[i + 1 : text.index("(", i)] + '"'
        return text.index(fence, i) + len(fence), False
    # A quote after a letter or digit separates digits (1'000), unless the letter is a prefix of a character.
    if text[i] == '"' or (text[i] == "'" and not text[i - 1 : i].isalnum()):
        end = i + 1
        while end < len(text) and text[end] not in (text[i], "\n"):
            end += 2 if text[end] == "\\" else 1
        return min(end + 1, len(text)), False
    return i, False


def line_of(text, offset):
    return text.count("\n", 0, offset) + 1


def finish(findings, checked):
    """Ends the program: 0 and a line of what was checked, or 1 and a line per finding."""
    for finding in findings:
        print(finding)
    print(f"{checked}: {len(findings)} finding{'' if len(findings) == 1 else 's'}")
    sys.exit(1 if findings else 0)


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(SKIPPED)
