"""What the tests of slamsensor view share: the process, a browser on its page, and what is drawn and said there."""
import math
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.error
import urllib.request

import browser
import drive
import lcm_types

PROGRAM = sys.argv[1]
ARROW_RIGHT = "\ue014"
DESKTOP, PHONE = (1440, 900), (390, 844)

# The colour of the canvas where the map's point (x, y) is drawn, and the colour a variable of the style has.
PIXEL = """const [x, y] = slamsensorView.toScreen(arguments[0], arguments[1]);
const map = document.getElementById('map'), ratio = map.width / map.clientWidth;
return [...map.getContext('2d').getImageData(Math.round(x * ratio), Math.round(y * ratio), 1, 1).data].slice(0, 3);"""
COLOUR = """const probe = document.createElement('canvas').getContext('2d');
probe.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(arguments[0]);
probe.fillRect(0, 0, 1, 1);
return [...probe.getImageData(0, 0, 1, 1).data].slice(0, 3);"""
LIST = """return Object.fromEntries([...document.querySelectorAll(arguments[0] + ' dt')].map(
  (term) => [term.textContent, term.nextElementSibling.textContent]));"""


class View:
    """A process slamsensor view."""

    def __init__(self, *arguments, port=0):
        self.process = subprocess.Popen([PROGRAM, "view", "--listen", f"127.0.0.1:{port}", *map(str, arguments)],
                                        stdout=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)/ \((.*);", line)
        if not found:
            raise AssertionError(f"said {line!r}")
        self.port, self.said = int(found[1]), found[2]
        self.url = f"http://127.0.0.1:{self.port}/"

    def get(self, path, method="GET", body=None, **headers):
        request = urllib.request.Request(self.url + path, body, {k.replace("_", "-"): v for k, v in headers.items()}, method=method)
        try:
            with urllib.request.urlopen(request, timeout=30) as answer:
                return answer.status, answer.read(), answer.headers
        except urllib.error.HTTPError as error:
            return error.code, error.read(), error.headers

    def memory_kb(self):
        text = pathlib.Path(f"/proc/{self.process.pid}/status").read_text()
        return int(re.search(r"VmRSS:\s+(\d+)", text)[1])

    def close(self):
        self.process.terminate()
        status = self.process.wait(timeout=30)
        self.process.stdout.close()
        return status


class PageTest(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def serve(self, *arguments, **more):
        view = View(*arguments, **more)
        self.addCleanup(view.close)
        return view

    def recording(self, count=100, reach_m=40.0):
        self.points, events = drive.recording(count, reach_m)
        path = self.folder / "drive.lcmlog"
        lcm_types.write_log(path, events)
        return path

    def look(self, size=DESKTOP, **more):
        page = browser.Browser(*size, **more)
        self.addCleanup(page.close)
        return page

    def seek(self, page, seconds):
        page.run("""const time = document.getElementById('time'); time.value = arguments[0];
                    time.dispatchEvent(new Event('input'));""", str(seconds))
        page.wait(f"return Math.abs(slamsensorView.player.t - {drive.T0} - {seconds}) < 0.1 && !slamsensorView.player.busy", "the time")
        self.settle(page)

    def settle(self, page):
        page.wait("return !slamsensorView.view.dirty && !slamsensorView.view.resting", "the picture")

    def assert_near(self, one, two, by=40):
        self.assertLess(max(abs(a - b) for a, b in zip(one, two)), by, f"{one} is not {two}")

    def assert_rivals_are_drawn(self, page, rivals):
        """Each as an arrow of the rivals' colour in a ring of it, hollow and turned to its heading, in the picture and in words."""
        rival, canvas = page.run(COLOUR, "--rival"), page.run(COLOUR, "--canvas")
        pixel_m = 1.0 / page.run("return slamsensorView.view.scale")

        def met(x, y, angle, reach_px, colour):
            near = [page.run(PIXEL, x + r * pixel_m * math.cos(angle), y + r * pixel_m * math.sin(angle))
                    for r in (reach_px - 0.5, reach_px, reach_px + 0.5)]
            return any(max(abs(a - b) for a, b in zip(pixel, colour)) < 60 for pixel in near)
        for x, y, heading in rivals:
            ring = [met(x, y, heading + a, 18, rival) for a in (0.4, 1.2, 2.0, 2.8, 4.0, 4.8, 5.5)]
            self.assertGreaterEqual(sum(ring), 6, f"the ring at {x}, {y}")
            self.assertTrue(met(x, y, heading, 12, rival), f"the tip of the arrow at {x}, {y}")
            self.assertFalse(met(x, y, heading + math.pi, 11, rival), f"nothing behind the arrow at {x}, {y}")
            self.assertTrue(met(x, y, heading, 3, canvas), f"the inside of the arrow at {x}, {y}")
        label = page.run("return document.getElementById('map').getAttribute('aria-label')")
        self.assertEqual(label.count("; rival "), len(rivals), label)


def main():
    """Runs the tests of the file that is started: TEST.py SLAMSENSOR [TEST...]."""
    if not browser.is_there():
        print("SKIPPED: chromium and chromedriver (chromium-driver) are not installed: tools/setup test")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0]] + sys.argv[2:], verbosity=1)
