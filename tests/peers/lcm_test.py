#!/usr/bin/env python3
"""Real readers of the sensor's LCM and NMEA: lcm_test.py SENDER SLAMSENSOR SOURCE_FOLDER. The examples in C++, C,
Python and shell are built as their own first lines say and must print every pose that SENDER sends; lcm-logger must
record all of it and lcm-logplayer play it back; `slamsensor top` must show it. Skips (77) where multicast cannot be
had."""
import fcntl
import os
import pathlib
import pty
import re
import select
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import termios
import time

SKIPPED = 77
POSES = 300
PATIENCE_S = 60.0  # before something that must happen counts as not happening
OWN_NETWORK = "IN_OWN_NETWORK"
PACKAGES = {"lcm-gen": "liblcm-bin", "lcm-logger": "liblcm-bin", "lcm-logplayer": "liblcm-bin", "g++": "g++",
            "gcc": "gcc", "pkg-config": "pkg-config", "bash": "bash"}


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(SKIPPED)


def enter_own_network():
    """As root, starts this program again where nothing else is on the network."""
    if os.environ.get(OWN_NETWORK) or os.geteuid() != 0 or not shutil.which("unshare") or not shutil.which("ip"):
        return
    setup = "ip link set lo up multicast on && ip route add 224.0.0.0/4 dev lo && exec \"$@\""
    os.environ[OWN_NETWORK] = "tried"
    if subprocess.run(["unshare", "-n", "true"], capture_output=True).returncode == 0:
        os.execvp("unshare", ["unshare", "-n", "sh", "-c", setup, "sh", sys.executable, *sys.argv])


def check_network():
    try:
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM).connect(("239.255.76.67", 7667))
    except OSError as error:
        skip(f"no route for multicast ({error}); run as root, or: ip route add 224.0.0.0/4 dev lo")


def check_programs():
    for program, package in PACKAGES.items():
        if not shutil.which(program):
            skip(f"{program} is not installed (package {package})")


def wait_for(condition, what):
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, f"waited {PATIENCE_S:.0f} s for {what}"
        time.sleep(0.02)


class Reader:
    """A program that prints lines into a file."""

    def __init__(self, folder, name, command):
        self.name = name
        self.path = folder / f"{name}.out"
        self.process = subprocess.Popen(command, stdout=self.path.open("w"))

    def lines(self):
        return self.path.read_text().splitlines()

    def stop(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait()


def commands_of(source):
    """The build commands in the comment at the head of an example."""
    head = source.read_text().split("#include")[0]
    return [line.strip(" /*") for line in head.splitlines() if re.match(r"[ /*]*(lcm-gen|g\+\+|gcc) ", line)]


def build(source, folder):
    """The program of an example, built by the commands that it gives."""
    place = folder / source.suffix[1:]
    place.mkdir()
    shutil.copy(source, place)
    shutil.copy(source.parents[2] / "firmware/lcm/types/slamsensor_pose_t.lcm", place)
    commands = commands_of(source)
    assert len(commands) == 2, f"{source.name} does not say how to build it: {commands}"
    for command in commands:
        subprocess.run(command, shell=True, check=True, cwd=place, stdout=subprocess.DEVNULL)
    return str(place / "read_pose")


class Sender:
    def __init__(self, program):
        self.process = subprocess.Popen([program], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.port = self.process.stdout.readline().strip()
        assert self.port, "the sender does not start"

    def command(self, text):
        self.process.stdin.write(text + "\n")
        self.process.stdin.flush()

    def send(self, poses):
        """Sends so many poses; what a reader must print of them."""
        self.command(f"send {poses}")
        return list(iter(lambda: self.process.stdout.readline().strip(), "done"))

    def warm(self, until, what):
        def heard():
            self.command("warm")
            return until()
        wait_for(heard, what)

    def stop(self):
        self.process.stdin.close()
        assert self.process.wait() == 0


def same_poses(reader, expected):
    """The last lines of the shell example: a time of day, and three decimals of the heading."""
    got = reader.lines()[-len(expected):]
    for line, wanted in zip(got, expected):
        fields, wants = line.split(), wanted.split()
        if fields[1] != wants[1] or len(fields) != len(wants):
            return False
        if any(abs(float(a) - float(b)) > 1e-3 for a, b in zip(fields[2:], wants[2:])):
            return False
    return len(got) == len(expected)


def events(log):
    """(channel, message) of every event in a log of lcm-logger."""
    data = log.read_bytes()
    while len(data) >= 28:
        sync, _, _, channel_size, size = struct.unpack(">IqqII", data[:28])
        assert sync == 0xEDA1DA01, "lcm-logger's log is broken"
        end = 28 + channel_size + size
        if len(data) < end:
            return  # not written yet
        yield data[28:28 + channel_size].decode(), data[28 + channel_size:end]
        data = data[end:]


def check_readers(sender, readers, shell, log):
    everyone = readers + [shell]
    sender.warm(lambda: all(reader.lines() for reader in everyone) and log.exists() and log.stat().st_size > 0,
                "every reader to hear a first pose")
    expected = sender.send(POSES)
    assert len(expected) == POSES
    wait_for(lambda: all(reader.lines()[-1] == expected[-1] for reader in readers), "the last pose")
    wait_for(lambda: len(shell.lines()) >= POSES and same_poses(shell, expected), "the shell's poses")
    for reader in readers:
        got = reader.lines()[-POSES:]
        assert got == expected, f"{reader.name}: {sum(a != b for a, b in zip(got, expected))} of {POSES} poses differ"
        print(f"{reader.name}: {POSES} of {POSES} poses")
    print(f"{shell.name}: {POSES} of {POSES} poses")
    return expected


def check_log(sender, log, expected):
    def counts():
        found = {}
        for channel, _ in events(log):
            found[channel] = found.get(channel, 0) + 1
        return found

    rounds = (POSES + 9) // 10
    wanted = {"POSE": sum(" fix " in line for line in expected), "SLAMSENSOR_STATUS": rounds,
              "SLAMSENSOR_COUNTERS": 6 * rounds, "SLAMSENSOR_SCAN": 2 * rounds, "SLAMSENSOR_MAP": 4 * rounds}
    # It writes what it has when more comes.
    sender.warm(lambda: wanted.items() <= counts().items(), f"lcm-logger to have {wanted}")
    print(f"lcm-logger: {sum(wanted.values())} events beside the poses, none lost")


def check_replay(folder, log, example, expected):
    reader = Reader(folder, "replayed", [sys.executable, example])
    # The player has no way to wait for readers: it plays again until this one has been there from the start.
    try:
        def played():
            subprocess.run(["lcm-logplayer", log], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            return "\n".join(expected) in reader.path.read_text()
        wait_for(played, "every pose out of lcm-logplayer")
    finally:
        reader.stop()
    print(f"lcm-logplayer: {len(expected)} of {len(expected)} poses")


def check_top_once(sender, slamsensor):
    for page, wanted in (("sensor", "state        fixed (emulated)"), ("counters", "resynchronised"),
                         ("channels", "bot_core.pose_t")):
        top = subprocess.Popen([slamsensor, "top", "--once", "--page", page, "--wait", "4"], stdout=subprocess.PIPE,
                               text=True)
        while top.poll() is None:
            sender.send(11)
        text = top.stdout.read()
        assert top.returncode == 0 and wanted in text, text
    silent = subprocess.run([slamsensor, "top", "--once", "--wait", "0.2", "--prefix", "NOBODY_"], capture_output=True,
                            text=True)
    assert silent.returncode == 69 and "nothing heard from a sensor on NOBODY_*" in silent.stdout, silent
    print("slamsensor top --once: three pages, and silence")


def resize(terminal, process, rows, columns):
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
    process.send_signal(signal.SIGWINCH)


def check_top_live(sender, slamsensor):
    """On a terminal: every page by its key, sizes from tiny to large, no colour when none is wanted, q ends it."""
    for no_color in ("", "1"):
        terminal, line = pty.openpty()
        fcntl.ioctl(line, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 110, 0, 0))
        top = subprocess.Popen([slamsensor, "top"], stdin=line, stdout=line, stderr=line,
                               env=os.environ | {"TERM": "xterm-256color", "NO_COLOR": no_color})
        os.close(line)
        drawn = b""

        def drawn_after(wanted):
            nonlocal drawn
            seen = b""

            def is_there():
                nonlocal seen
                sender.send(11)
                while select.select([terminal], [], [], 0)[0]:
                    seen += os.read(terminal, 65536)
                return wanted in seen
            wait_for(is_there, f"{wanted} on the terminal")
            drawn += seen

        drawn_after(b"first fix after")
        os.write(terminal, b"2")
        drawn_after(b"resynchronised")
        os.write(terminal, b"3j")
        drawn_after(b"bot_core.pose_t")
        for rows, columns in ((1, 1), (5, 20), (24, 80), (100, 300)):
            resize(terminal, top, rows, columns)
            sender.send(1)
        os.write(terminal, b"1")
        drawn_after(b"m wide")
        coloured = re.search(rb"\x1b\[[0-9;]*3[0-7]m", drawn) is not None
        assert coloured == (no_color == ""), f"NO_COLOR={no_color}, coloured: {coloured}"
        os.write(terminal, b"q")
        assert top.wait(PATIENCE_S) == 0
        os.close(terminal)
    print("slamsensor top: pages, sizes, colours, end")


def main():
    sender_program, slamsensor, source = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    enter_own_network()
    check_network()
    check_programs()
    os.environ.pop("LCM_DEFAULT_URL", None)
    examples = source / "tools/examples"
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        log = folder / "log"
        cpp, c = build(examples / "read_pose.cpp", folder), build(examples / "read_pose.c", folder)
        python = str(examples / "read_pose.py")
        sender = Sender(sender_program)
        logger = Reader(folder, "lcm-logger", ["lcm-logger", "--quiet", str(log)])
        shell = Reader(folder, "shell, NMEA", [str(examples / "read_pose.sh"), "127.0.0.1", sender.port])
        readers = [Reader(folder, "C++, LCM", [cpp]), Reader(folder, "C, LCM", [c]),
                   Reader(folder, "Python, LCM", [sys.executable, python]),
                   Reader(folder, "Python, NMEA", [sys.executable, python, f"tcp://127.0.0.1:{sender.port}"])]
        try:
            expected = check_readers(sender, readers, shell, log)
            check_log(sender, log, expected)
        finally:
            for reader in [*readers, shell, logger]:
                reader.stop()
        check_replay(folder, log, python, expected)
        check_top_once(sender, slamsensor)
        check_top_live(sender, slamsensor)
        sender.stop()


if __name__ == "__main__":
    main()
