"""A sensor of processes: an emulated head, the daemon on it, and ways to talk to both. Used by the tests beside it."""
import ctypes
import json
import math
import os
import pathlib
import signal
import socket
import subprocess
import tempfile
import threading
import time
import tomllib

HERE = pathlib.Path(__file__).parent
PATIENCE_S = 30.0  # before something that must happen counts as not happening
WRONG_M, WRONG_RAD = 1.0, math.radians(2.0)  # a fix farther off than this is a wrong one
STOP_MAX_S = 1.0
NOTIFY, PACE_S = "NOTIFY_SOCKET", 0.02


def wait_for(condition, what, patience_s=PATIENCE_S):
    """What `condition` gives when it gives something."""
    end = time.monotonic() + patience_s
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > end:
            raise AssertionError(f"waited {patience_s:.0f} s for {what() if callable(what) else what}")
        time.sleep(PACE_S)


def free_port():
    """A TCP port of this machine that nobody has."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def stands_of(scenario):
    with open(scenario, "rb") as file:
        return [(stand["x_m"], stand["y_m"], math.radians(stand.get("heading_deg", 0.0)))
                for stand in tomllib.load(file)["stand"]]


def relative(pose, origin):
    """`pose` seen from `origin`: the map's frame is that of the first scan."""
    dx, dy = pose[0] - origin[0], pose[1] - origin[1]
    c, s = math.cos(origin[2]), math.sin(origin[2])
    return (c * dx + s * dy, c * dy - s * dx, math.remainder(pose[2] - origin[2], math.tau))


def error_of(fix, pose):
    """Metres and radians between a fix and the pose where the sensor is."""
    return (math.hypot(fix["x_m"] - pose[0], fix["y_m"] - pose[1]),
            abs(math.remainder(fix["heading_rad"] - pose[2], math.tau)))


class Refused(Exception):
    """An ERROR answer of the control socket: its code and text."""

    def __init__(self, text):
        super().__init__(text)
        self.code, _, self.text = text.partition(": ")


class Control:
    """A client of the control socket."""

    def __init__(self, path):
        self.socket = socket.socket(socket.AF_UNIX)
        self.socket.settimeout(PATIENCE_S)
        try:
            self.socket.connect(str(path))
        except OSError:
            self.socket.close()
            raise
        self.stream = self.socket.makefile("rw", encoding="utf-8", newline="\n")

    def ask(self, request):
        self.send(request)
        return self.answer()

    def send(self, request):
        self.stream.write(request + "\n")
        self.stream.flush()

    def answer(self):
        """The lines of the next answer, and its last one without OK."""
        lines = []
        for line in self.stream:
            if not line.endswith("\n"):
                break
            line = line[:-1]
            if not line.startswith(" "):
                word, _, rest = line.partition(" ")
                if word == "OK":
                    return lines, rest
                assert word == "ERROR", line
                raise Refused(rest)
            lines.append(line[1:])
        raise ConnectionError("no whole answer")

    def close(self):
        try:
            self.stream.close()
        except OSError:
            pass  # what was not sent has nobody to read it
        self.socket.close()


class Manager:
    """What the daemon tells a service manager (sd_notify): (time, message) in order."""

    def __init__(self, path):
        self.path = path
        self.told = []
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.bind(str(path))
        threading.Thread(target=self._listen, daemon=True).start()

    def _listen(self):
        while True:
            try:
                message = self.socket.recv(65536).decode()
            except OSError:
                return
            self.told.append((time.monotonic(), message))

    def times(self, begin):
        return [at for at, message in list(self.told) if message.startswith(begin)]

    def last(self, begin):
        found = [message for _, message in list(self.told) if message.startswith(begin)]
        return found[-1] if found else ""

    def forget(self):
        self.told = []

    def close(self):
        self.socket.close()


class FrozenThread:
    """One thread of another process stands still inside of the with statement (ptrace(2))."""
    CONT, SEIZE, INTERRUPT, DETACH = 7, 0x4206, 0x4207, 17
    WALL = 0x40000000

    def __init__(self, process, name):
        tasks = pathlib.Path(f"/proc/{process}/task")
        self.thread = next(int(task.name) for task in tasks.iterdir() if (task / "comm").read_text().strip() == name)
        self.libc = ctypes.CDLL(None, use_errno=True)
        self._trace(self.SEIZE)  # it goes on until it is interrupted

    def _trace(self, request):
        if self.libc.ptrace(ctypes.c_long(request), ctypes.c_long(self.thread), ctypes.c_void_p(), ctypes.c_void_p()):
            raise PermissionError(ctypes.get_errno(), "ptrace")

    def __enter__(self):
        self._trace(self.INTERRUPT)
        os.waitpid(self.thread, self.WALL)
        return self

    def __exit__(self, *_):
        self._trace(self.DETACH)


class Sensor:
    """`programs`: paths of slamsensor and slamsensord. Everything lives in a folder of its own."""

    def __init__(self, programs, scenario=HERE / "park.toml", settings=()):
        self.slamsensor, self.slamsensord = programs
        self.temporary = tempfile.TemporaryDirectory(prefix="sensor-")
        self.folder = pathlib.Path(self.temporary.name)
        self.scenario = scenario
        self.stands = stands_of(scenario)
        self.stand = 0
        self.map_origin = self.stands[0]
        self.settings = dict(settings)
        self.log_path = self.folder / "log"
        self.config = self.folder / "sensor.toml"
        self.config.write_text((HERE / "head.toml").read_text())
        self.maps, self.recordings = self.folder / "maps", self.folder / "recordings"
        self.manager = Manager(self.folder / "notify")
        self.head = self.daemon = self.client = None

    def close(self):
        if self.daemon:
            self.kill()
        self.stop_head()
        self.manager.close()
        self.temporary.cleanup()

    # The emulated head.

    def start_head(self, *options):
        self.stand = 0
        output = (self.folder / "head.log").open("a")
        self.head = subprocess.Popen([self.slamsensor, "emulate", str(self.scenario), "--ptu", str(self.folder / "ptu"),
                                      "--rangefinder", str(self.folder / "finder"), "--truth",
                                      str(self.folder / "truth.tum"), *options],
                                     stdout=output, stderr=subprocess.STDOUT)
        output.close()
        wait_for(lambda: (self.folder / "finder").exists() and (self.folder / "ptu").exists(),
                 lambda: "the emulated head: " + (self.folder / "head.log").read_text())

    def stop_head(self):
        if self.head:
            self.head.send_signal(signal.SIGINT)
            self.head.wait(PATIENCE_S)
            self.head = None

    def next_stand(self):
        self.stand += 1
        self.head.send_signal(signal.SIGUSR1)

    # The daemon.

    def command(self, settings=()):
        values = {"pan_tilt_port.path": self.folder / "ptu", "rangefinder_port.path": self.folder / "finder",
                  "map.directory": self.maps, "record.directory": self.recordings,
                  "control.socket": self.folder / "control", **self.settings, **dict(settings)}
        return [self.slamsensord, "--emulated", "--config", str(self.config),
                *(word for key, value in values.items() for word in ("--set", f"{key}={value}"))]

    def start(self, settings=(), prefix=(), environment=(), **options):
        self.manager.forget()
        with self.log_path.open("a") as log:
            self.daemon = subprocess.Popen([*prefix, *self.command(settings)], stdout=log, stderr=subprocess.STDOUT,
                                           env={**os.environ, NOTIFY: str(self.manager.path), **dict(environment)},
                                           **options)
        self.started = time.monotonic()

    def run_to_end(self, settings=(), prefix=(), **options):
        """Of a daemon that must not start: its exit status and what it said."""
        self.log_path.write_text("")
        self.start(settings, prefix, **options)
        try:
            status = self.daemon.wait(PATIENCE_S)
        finally:
            self.kill()
        return status, self.log()

    def control(self):
        """The control client of this daemon, connected when there is none."""
        if self.client is None:
            def connected():
                assert self.daemon.poll() is None, f"exit status {self.daemon.returncode}:\n{self.log()}"
                try:
                    return Control(self.folder / "control")
                except (FileNotFoundError, ConnectionRefusedError):
                    return None
            self.client = wait_for(connected, "the control socket")
        return self.client

    def ask(self, request):
        return self.control().ask(request)

    def status(self):
        return json.loads(self.ask("status json")[0][0])

    def wait_status(self, condition, what, patience_s=PATIENCE_S):
        def found():
            status = self.status()
            return status if condition(status) else None
        return wait_for(found, lambda: f"{what}; the log:\n{self.log()}", patience_s)

    def wait_scans(self, count=1):
        """The status after `count` scans more."""
        before = self.status()["slam"]["scans"]
        return self.wait_status(lambda s: s["slam"]["scans"] >= before + count, f"{count} scans")

    def wait_fix(self):
        return self.wait_status(lambda s: s["state"] == "fixed", "a fix")

    def pose(self):
        """Where the sensor is in the map."""
        return relative(self.stands[self.stand], self.map_origin)

    def is_wrong(self, fix):
        metres, radians = error_of(fix, self.pose())
        return metres > WRONG_M or radians > WRONG_RAD

    def terminate(self):
        """Ends the daemon in order: exit status and seconds."""
        begun = time.monotonic()
        self._forget_client()
        self.daemon.send_signal(signal.SIGTERM)
        status = self.daemon.wait(PATIENCE_S)
        self.daemon = None
        return status, time.monotonic() - begun

    def kill(self):
        self._forget_client()
        self.daemon.kill()
        self.daemon.wait(PATIENCE_S)
        self.daemon = None

    def frozen_thread(self, name, test):
        """One of the daemon's threads, to stand still inside of a with statement; the test is skipped where that is denied."""
        try:
            return FrozenThread(self.daemon.pid, name)
        except PermissionError as error:
            test.skipTest(f"SKIPPED: a thread cannot be stopped: {error}")

    def _forget_client(self):
        if self.client:
            self.client.close()
            self.client = None

    def log(self):
        return self.log_path.read_text(errors="replace")
