"""The page of slamsensor view in a real browser: what it draws and says, from a recording and live.
Usage: view_test.py SLAMSENSOR. SLAMSENSOR_SHOTS=FOLDER keeps pictures of the page."""
import json
import math
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time
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


class RecordingTest(PageTest):
    def opened(self, size=DESKTOP, **more):
        view = self.serve(self.recording())
        self.assertEqual(view.said, "a recording")
        page = self.look(size, **more)
        page.open(view.url)
        page.wait("return slamsensorView.story.map.x.length === 100", "the map")
        self.settle(page)
        return page

    def test_the_end_of_the_drive_is_drawn_and_said(self):
        page = self.opened()
        self.assertEqual(page.text("#words"), "Fix")
        fix = page.run(LIST, "#fix")
        x, y, _ = drive.pose_at(29)
        self.assertEqual(fix["Heading"], "62.32°")
        self.assertEqual(fix["x, y"], f"{x:.3f}, {y:.3f} m")
        self.assertEqual(fix["Protection radius"], "2.50 m")
        self.assertEqual(fix["Matches"], "22 of 28 seen")
        # 1 sigma of the covariance (0.09, 0.02, 0.04): the eigenvalues' roots.
        self.assertEqual(fix["Sigma in the map"], "0.311 × 0.182 m, 0.57°")
        self.assertEqual(fix["Map"], "home (1)")
        self.assertIn("pan-tilt unit", page.text("#devices").lower())
        self.assertIn("PTU-46-17.5", page.text("#devices"))
        self.assertIn("searches cut", page.text("#counters"))
        self.assertRegex(page.run("return document.getElementById('map').getAttribute('aria-label')"),
                         r"Map with 100 landmarks, 25 fixes on the path; the sensor at x 17\.\d, y -9\.\d metres")
        page.shot("recording-desktop")
        # Each landmark has the colour of its xi, away from the sensor's own marks.
        seen = 0
        for i, (px, py) in enumerate(self.points):
            if (px - x) ** 2 + (py - y) ** 2 > 27.0 ** 2 and drive.xi_of(i) in (0, 8):
                near = [q for q in self.points if 0 < (q[0] - px) ** 2 + (q[1] - py) ** 2 < 1]
                if not near:
                    want = page.run(COLOUR, "--xi0" if drive.xi_of(i) == 0 else "--xi4")
                    self.assert_near(page.run(PIXEL, px, py), want)
                    seen += 1
        self.assertGreater(seen, 5)
        self.assert_near(page.run(PIXEL, x, y), page.run(COLOUR, "--sigma"))
        self.assertEqual(page.errors(), [])

    def test_scrubbing_shows_what_was_then(self):
        page = self.opened()
        self.seek(page, 24.5)  # scan 12
        self.assertEqual(page.text("#state-words"), "ambiguous")
        self.assertEqual(page.run("return slamsensorView.story.path.filter((v) => v === null).length"), 0)
        self.assertIn("another place", page.text("#words").lower())
        self.seek(page, 31.0)  # scan 15
        self.assertIn("absent", page.text("#devices").lower())
        self.assertIn("look at its cable", page.text("#problem"))
        self.seek(page, 45.5)  # scan 22: in a local map
        self.assertIn("local map", page.text("#words").lower())
        self.assertEqual(page.run(LIST, "#fix")["Map"], "local 2")
        self.assertIn("local map 2", page.run("return document.getElementById('frame').innerText"))
        self.assertGreater(page.run("return slamsensorView.story.local_maps['2'].points.length"), 20)
        self.assertEqual(page.run("return slamsensorView.view.frame"), "2")
        page.shot("recording-local-map")
        self.seek(page, 4.5)
        self.assertEqual(page.text("#words"), "Fix")
        self.assertEqual(page.run("return slamsensorView.story.fixes"), 3)
        self.assertEqual(page.run("return document.querySelectorAll('#events li').length"), 1)
        self.seek(page, 58.0)
        # The line of the path is broken where scan 12 and scans 20 to 23 gave no fix.
        self.assertEqual(page.run("return slamsensorView.story.path.filter((v) => v === null).length"), 4)
        events = page.text("#events")
        for said in ("13:05:24", "look at its cable", "rangefinder: absent", "the sensor head scans again", "local map"):
            self.assertIn(said, events)
        self.assertIn("13:05:58 UTC, 58 of 58 s", page.text("#clock"))

    def test_the_rivals_of_an_ambiguous_scan_are_drawn_and_said(self):
        page = self.opened()
        self.seek(page, 24.5)  # scan 12
        self.assert_rivals_are_drawn(page, drive.RIVALS)
        self.assertEqual(page.text("#rivals"),
                         "The likeliest of 3 places is drawn hollow, with 22 matches. Rival 1: x -12.5, y 8.3 m, heading 57°, 21 matches. "
                         "Rival 2: x 6.0, y -30.0 m, heading 245°, 17 matches.")
        self.assertIn("; rival 2 of this scan at x 6.0, y -30.0 m, heading 245°",
                      page.run("return document.getElementById('map').getAttribute('aria-label')"))
        self.assertIn("rival place", page.text("#legend"))
        page.shot("recording-ambiguous")
        self.seek(page, 26.5)  # scan 13 is a fix again
        self.assertTrue(page.run("return document.getElementById('rivals').hidden"))
        self.assertNotIn("rival", page.run("return document.getElementById('map').getAttribute('aria-label')"))
        self.assertNotEqual(page.run(PIXEL, *drive.RIVALS[1][:2]), page.run(COLOUR, "--rival"))
        with self.assertRaises(AssertionError):
            self.assert_rivals_are_drawn(page, drive.RIVALS)

    def test_it_plays(self):
        page = self.opened()
        self.seek(page, 0)
        page.run("document.getElementById('speed').value = '64'; document.getElementById('play').click()")
        self.assertEqual(page.text("#play"), "Pause")
        page.wait("return document.getElementById('play').textContent === 'Play'", "the end")
        page.wait("return slamsensorView.story.fixes === 25", "the whole path")

    def test_keys_move_zoom_and_follow(self):
        page = self.opened()
        page.run("document.getElementById('map').focus()")
        before = page.run("return [slamsensorView.view.x, slamsensorView.view.scale]")
        page.keys(ARROW_RIGHT, "+")
        after = page.run("return [slamsensorView.view.x, slamsensorView.view.scale]")
        self.assertGreater(after[0], before[0])
        self.assertAlmostEqual(after[1], 1.3 * before[1], places=6)
        page.keys("f")
        self.settle(page)
        x, y, _ = drive.pose_at(29)
        self.assertAlmostEqual(page.run("return slamsensorView.view.x"), x, places=3)
        self.assertEqual(page.run("return document.getElementById('follow').getAttribute('aria-pressed')"), "true")
        page.keys("0")
        self.assertAlmostEqual(page.run("return slamsensorView.view.scale"), before[1], places=6)

    def test_everything_has_a_name_and_the_tab_key_reaches_it(self):
        page = self.opened()
        nameless = page.run("""return [...document.querySelectorAll('button, input, select, canvas[role], section')]
          .filter((e) => !e.closest('[hidden]') && !e.getAttribute('aria-label') && !e.getAttribute('aria-labelledby') &&
            !e.textContent.trim() && !(e.labels && e.labels.length)).map((e) => e.outerHTML)""")
        self.assertEqual(nameless, [])
        reached = set()
        page.run("document.body.focus()")
        for _ in range(20):
            page.keys("\ue004")
            reached.add(page.run("return document.activeElement.id"))
        self.assertLessEqual({"map", "zoom-in", "fit", "follow", "frame", "play", "speed", "time", "theme"}, reached)
        self.assertEqual(page.run("return document.documentElement.lang"), "en")

    def test_phone(self):
        page = self.opened(PHONE)
        page.shot("recording-phone")
        self.assertEqual(page.run("return window.innerWidth"), 390)
        self.assertLessEqual(page.run("return document.documentElement.scrollWidth"), 390)
        small = page.run("""return [...document.querySelectorAll('button')].filter((b) => b.offsetParent &&
          (b.getBoundingClientRect().width < 32 || b.getBoundingClientRect().height < 32)).map((b) => b.id)""")
        self.assertEqual(small, [])
        self.assertTrue(page.run("const b = document.getElementById('map').getBoundingClientRect(); return b.top >= 0 && b.width > 340"))
        page.run("document.getElementById('h-fix').scrollIntoView()")
        page.shot("recording-phone-fix")

    def test_dark_and_light(self):
        page = self.opened()
        first = page.run("return document.documentElement.dataset.theme")
        for _ in range(2):
            page.run("document.getElementById('theme').click()")
            self.settle(page)
            theme = page.run("return document.documentElement.dataset.theme")
            corner = page.run("""const c = document.getElementById('map').getContext('2d');
              return [...c.getImageData(3, 300, 1, 1).data].slice(0, 3)""")
            self.assertEqual(theme == "dark", max(corner) < 60, f"{theme}: {corner}")
            # WCAG's contrast of text on its card is 4.5 at least.
            contrast = page.run("""const rgb = (name) => { const c = document.createElement('canvas').getContext('2d');
                c.fillStyle = getComputedStyle(document.documentElement).getPropertyValue(name); c.fillRect(0, 0, 1, 1);
                return [...c.getImageData(0, 0, 1, 1).data].slice(0, 3); };
              const light = (c) => c.map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
                .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
              return ['--ink', '--soft', '--good', '--warn', '--bad'].map((name) => {
                const [a, b] = [light(rgb(name)), light(rgb('--card'))];
                return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05); });""")
            self.assertGreater(min(contrast), 4.5, f"{theme}: {contrast}")
            page.shot(f"recording-{theme}")
        self.assertEqual(theme, first)

    def test_the_sigma_of_each_landmark_is_a_circle(self):
        page = self.opened()
        self.assertIn("0.20 m, at most 0.35 m", page.run(LIST, "#about-map")["Their sigma"])
        spread = page.run(COLOUR, "--spread")
        x, y, _ = drive.pose_at(29)
        seen = 0
        for i, (px, py) in enumerate(self.points):
            reach = 3.0 * drive.sigma_of(i)
            if reach < 0.6 or math.hypot(px - x, py - y) < 28.0 or any(0 < math.hypot(qx - px, qy - py) < 2.5 for qx, qy in self.points):
                continue
            pixel_m = 1.0 / page.run("return slamsensorView.view.scale")
            met = 0
            for a in (0.4, 1.2, 2.0, 2.8, 4.0, 4.8, 5.5):  # a line of a pixel may fall between two
                near = [page.run(PIXEL, px + r * math.cos(a), py + r * math.sin(a)) for r in (reach - 0.5 * pixel_m, reach + 0.5 * pixel_m)]
                met += any(max(abs(a - b) for a, b in zip(pixel, spread)) < 60 for pixel in near)
            self.assertGreaterEqual(met, 4, f"landmark {i}")
            seen += 1
        self.assertGreater(seen, 3)

    def test_ten_thousand_landmarks(self):
        view = self.serve(self.recording(10_000, 400.0))
        page = self.look()
        page.open(view.url)
        page.wait("return slamsensorView.story.map.x.length === 10000", "the map")
        self.settle(page)
        page.shot("recording-10000")
        # A drag of 100 frames; the landmarks are drawn anew when they no longer cover the window, and when the hand rests.
        begin = page.run("""const stats = slamsensorView.stats; stats.worst_ms = stats.drawn_ms = 0;
                            return [stats.frames, stats.bases]""")
        took_ms = page.do("POST", "/execute/async", {"args": [], "script": """const done = arguments[0], view = slamsensorView.view;
          let left = 100, begin = performance.now();
          const step = () => { view.x += 2; view.dirty = true;
            if (--left > 0) requestAnimationFrame(step); else requestAnimationFrame(() => done(performance.now() - begin)); };
          requestAnimationFrame(step);"""})
        frames, bases, drawn_ms, worst_ms = page.run("const s = slamsensorView.stats; return [s.frames, s.bases, s.drawn_ms, s.worst_ms]")
        frames, bases = frames - begin[0], bases - begin[1]
        print(f"10,000 landmarks, dragged: {1000 * frames / took_ms:.0f} frames a second, drawn in {drawn_ms / frames:.1f} ms each, worst "
              f"{worst_ms:.1f} ms, all landmarks {bases} times in {frames} frames; view process {view.memory_kb()} kB")
        self.assertGreaterEqual(frames, 99)
        self.assertLess(bases, frames // 4)
        self.settle(page)
        self.assertEqual(page.run("return slamsensorView.view.base_view"), page.run("const v = slamsensorView.view; return [v.x, v.y, v.scale].join()"))
        point = next((px, py) for px, py in self.points if page.run(
            "const [x, y] = slamsensorView.toScreen(arguments[0], arguments[1]); return x > 400 && x < 900 && y > 100 && y < 700", px, py))
        self.assertNotEqual(page.run(PIXEL, *point), page.run(COLOUR, "--canvas"))

    def test_messages_of_somebody_else_do_no_harm(self):
        """Anyone on the network can send: numbers that are none, or so large that nothing can be drawn."""
        points, events = drive.recording()
        huge, none = 1e300, float("nan")
        worse = [drive.pose_message(40, (huge, -huge, none)), drive.pose_message(41, (1e9, 0, 0), covariance=[none] * 9),
                 drive.pose_message(42, (1, 1, 1), covariance=[huge] * 9, protection_radius_m=huge),
                 *drive.map_messages([(huge, huge), (none, 1.0), (2.0, -huge)], revision=9),
                 drive.rivals_message(44, [(huge, -huge, huge), (none, 1.0, none)], [-3, 2**31 - 1]), drive.pose_message(44, (1, 1, 1), 1, 3),
                 drive.scan_message(43, (0, 0, 0), [(none, none)]), drive.pose_message(43, (2, 2, 0), 2, 0, map_number=-7),
                 drive.status_message(map_name="<img src=x onerror=document.title=1>", problem="<b>&\"'", pan_rad=none,
                                      readings_hz=huge, line=10**15, lines=-3)]
        path = self.folder / "bad.lcmlog"
        lcm_types.write_log(path, events + [(drive.T0 + 60 + i, *message) for i, message in enumerate(worse)])
        page = self.look()
        page.open(self.serve(path).url)
        page.wait("return slamsensorView.story.status !== undefined", "the story")
        for i in range(len(worse)):
            self.seek(page, 60.0 + i)
            frames = page.run("slamsensorView.view.dirty = true; return slamsensorView.stats.frames")
            page.wait(f"return slamsensorView.stats.frames > {frames}", f"a frame after message {i}")
        self.assertEqual(page.run(LIST, "#about-map")["Name"], "<img src=x onerror=document.title=1>")
        self.assertEqual(page.run("return document.title"), "slamsensor")
        self.assertEqual(page.text("#problem"), "<b>&\"'")
        self.seek(page, 10.0)
        self.assertEqual(page.text("#words"), "Fix")
        self.assertEqual(page.errors(), [])

    def test_files_that_are_no_recordings_are_refused(self):
        path = self.folder / "x.lcmlog"
        path.write_text("hello")
        done = subprocess.run([PROGRAM, "view", path], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 65)
        self.assertIn("x.lcmlog: is no recording", done.stderr)
        lcm_types.write_log(path, [(drive.T0, "OTHER", b"12345678")])
        done = subprocess.run([PROGRAM, "view", path], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 65)
        self.assertIn("--prefix", done.stderr)


def multicast_works():
    try:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, socket.inet_aton("239.255.76.68") + bytes(4))
        return True
    except OSError:
        return False


@unittest.skipUnless(multicast_works(), "no route for multicast: ip route add 224.0.0.0/4 dev lo")
class LiveTest(PageTest):
    URL = ("239.255.76.68", 7700 + int(time.time()) % 200)

    def send(self, *messages):
        for channel, message in messages:
            self.sender.send(channel, message)

    def setUp(self):
        super().setUp()
        self.sender = lcm_types.Sender(*self.URL)
        self.addCleanup(self.sender.socket.close)

    def live(self, *more, **named):
        return self.serve("--url", "udpm://{}:{}?ttl=0".format(*self.URL), *more, **named)

    def test_a_sensor_is_followed_and_the_page_finds_it_again(self):
        view = self.live("--set", "datum.latitude_deg=42.4627", "--set", "datum.longitude_deg=-2.4449", "--set",
                         "datum.height_m=384", "--set", "datum.bearing_deg=60")
        self.assertEqual(view.said, "read-only")
        page = self.look()
        page.open(view.url)
        page.wait("return document.getElementById('state-words').textContent === 'waiting for a sensor'", "the page")
        points = drive.landmarks(100, 40.0)
        self.send(*drive.map_messages(points))
        for scan in range(3):
            self.send(drive.scan_message(scan, drive.pose_at(scan), points), drive.pose_message(scan, drive.pose_at(scan)),
                      drive.status_message())
        page.wait("return slamsensorView.story.fixes === 3 && slamsensorView.story.map.x.length === 100", "three fixes")
        self.settle(page)
        self.assertEqual(page.text("#state-words"), "fixed")
        self.assertTrue(page.run("return document.getElementById('control').hidden"))
        fix = page.run(LIST, "#fix")
        self.assertRegex(fix["Latitude, longitude"], r"^42\.46\d{5}, -2\.44\d{5}$")
        self.assertIn("60.00° true", page.run(LIST, "#about-map")["x axis towards"])
        page.shot("live-desktop")
        # An ambiguous scan whose rivals are not known, then one with a rival.
        self.send(drive.pose_message(3, drive.pose_at(3), drive.AMBIGUOUS, drive.SYMMETRIC, weight_best=18, weight_runner_up=17))
        page.wait("return document.getElementById('rivals').textContent.includes('18 here, 17 at the rival')", "the scan without rivals")
        self.send(drive.pose_message(4, drive.pose_at(4), drive.AMBIGUOUS, drive.SYMMETRIC), drive.rivals_message(4, drive.RIVALS[:1], [20]))
        page.wait("return document.getElementById('rivals').textContent.includes('Rival 1')", "the rival")
        self.settle(page)
        self.assert_rivals_are_drawn(page, drive.RIVALS[:1])
        page.wait("return document.getElementById('state-words').textContent.startsWith('silent')", "the silence")
        # The process ends and another takes its port: the page goes on by itself.
        port = view.port
        self.assertEqual(view.close(), 0)
        page.wait("return !document.getElementById('link').hidden", "the loss to be said")
        self.live(port=port)
        self.send(*drive.map_messages(points), drive.pose_message(5, drive.pose_at(5)), drive.status_message())
        end = time.monotonic() + browser.PATIENCE_S
        while page.run("return slamsensorView.story.pose ? slamsensorView.story.pose.scan : -1") != 6:
            self.assertLess(time.monotonic(), end, "the page did not come back")
            self.send(drive.pose_message(6, drive.pose_at(6)), drive.status_message())
            time.sleep(0.3)
        page.wait("return document.getElementById('link').hidden", "the link")

    def test_what_a_stream_costs(self):
        view = self.live()
        page = self.look()
        page.open(view.url)
        points = drive.landmarks(10_000, 400.0)
        self.send(*drive.map_messages(points))
        for scan in range(40):
            self.send(drive.pose_message(scan, drive.pose_at(scan)), drive.status_message())
            time.sleep(0.1)
        page.wait("return slamsensorView.story.fixes === 40", "the fixes")
        for _ in range(5):  # messages that were lost come again with the next map
            if page.run("return slamsensorView.story.map.x.length") == 10_000:
                break
            self.send(*drive.map_messages(points))
            time.sleep(1.0)
        page.wait("return slamsensorView.story.map.x.length === 10000", "the map")

        def rate(seconds=4):
            first = page.run("return [slamsensorView.stats.bytes, performance.now()]")
            time.sleep(seconds)
            then = page.run("return [slamsensorView.stats.bytes, performance.now()]")
            return (then[0] - first[0]) / (then[1] - first[1]) * 1000
        print(f"a page that is open: {rate():.0f} bytes a second when nothing changes; view process {view.memory_kb()} kB")
        self.assertLess(rate(), 2000)
        # The same map again is nothing new; of another one only what has changed is sent.
        stamp, sent = page.run("return [slamsensorView.story.map_stamp, slamsensorView.stats.bytes]")
        self.send(*drive.map_messages(points), drive.pose_message(41, drive.pose_at(41)))
        page.wait("return slamsensorView.story.fixes === 41", "the next fix")
        time.sleep(1.0)
        self.assertEqual(page.run("return slamsensorView.story.map_stamp"), stamp)
        points[4321] = (0.125, -0.25)
        self.send(*drive.map_messages(points, revision=2))
        page.wait("return slamsensorView.story.map.x[4321] === 0.125", "the landmark that moved")
        self.assertEqual(page.run("return slamsensorView.story.map.x.length"), 10_000)
        self.assertLess(page.run("return slamsensorView.stats.bytes") - sent, 30_000)
        page.shot("live-10000")

    def test_only_who_has_the_token_may_tell_the_sensor(self):
        token = self.folder / "token"
        token.write_text("0123456789abcdefgh\n")
        view = self.live("--control-token-file", token, "--socket", self.folder / "none")
        self.assertEqual(view.said, "control with the token")
        body = b'{"request": "scan now"}'
        self.assertEqual(view.get("api/ctl", "POST", body)[0], 401)
        self.assertEqual(view.get("api/ctl", "POST", body, Authorization="Bearer 0123456789abcdefgX")[0], 401)
        right = {"Authorization": "Bearer 0123456789abcdefgh"}
        self.assertEqual(view.get("api/ctl", "POST", b'{"request": "config set a b"}', **right)[0], 400)
        self.assertEqual(view.get("api/ctl", "POST", b"x", **right)[0], 400)
        status, answer, _ = view.get("api/ctl", "POST", body, **right)
        self.assertEqual(status, 200)
        self.assertFalse(json.loads(answer)["ok"])
        self.assertIn("daemon", json.loads(answer)["text"])
        page = self.look()
        page.open(view.url)
        page.wait("return !document.getElementById('control').hidden", "the orders")
        page.run("document.getElementById('token').value = 'wrong'; document.querySelector('#orders button').click()")
        page.wait("return document.getElementById('answer').textContent === 'scan now: that is not the token'", "the refusal")
        read_only = self.live()
        self.assertEqual(read_only.get("api/ctl", "POST", body, **right)[0], 403)
        token.write_text("short\n")
        done = subprocess.run([PROGRAM, "view", "--control-token-file", token], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 65)
        self.assertIn("needs 16", done.stderr)

    def test_what_a_web_server_must_not_do(self):
        view = self.live()
        self.assertEqual(view.get("", Host="sensor.example:80")[0], 403)
        self.assertEqual(view.get("", Host="localhost:80")[0], 200)
        self.assertEqual(view.get("../etc/passwd")[0], 404)
        self.assertEqual(view.get("api/at?t=1")[0], 404)
        _, text, headers = view.get("")
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertNotIn(b"http://", text.replace(b"http://www.w3.org", b""))
        self.assertNotIn(b"https://", text)
        recording = self.serve(self.recording())
        for bad in ("x", "", "-1", "nan", "1e300", "inf"):
            self.assertEqual(recording.get(f"api/at?t={bad}")[0], 400, bad)

    def test_who_floods_it_takes_neither_its_memory_nor_its_threads(self):
        view = self.live()
        host = f"Host: 127.0.0.1:{view.port}\r\n".encode()

        def knock(request):
            link = socket.create_connection(("127.0.0.1", view.port), 10)
            link.settimeout(10)
            self.addCleanup(link.close)
            try:
                link.sendall(request)
            except OSError:
                pass  # refused while it is sent
            return link

        def answer(link):
            try:
                return link.recv(12)
            except OSError:
                return b""

        before_kb = view.memory_kb()
        for lines in (b"X: a\r\n" * 1_000_000, b"X: " + b"a" * 6_000_000 + b"\r\n", b"\r\n".join([b"X"] * 300)):
            self.assertNotEqual(answer(knock(b"GET / HTTP/1.1\r\n" + host + lines + b"\r\n")), b"HTTP/1.1 200")
        self.assertLess(view.memory_kb() - before_kb, 4000)
        stream = b"GET /api/stream HTTP/1.1\r\n" + host + b"\r\n"
        pages = [knock(stream) for _ in range(16)]
        self.assertEqual([answer(page) for page in pages], [b"HTTP/1.1 200"] * 16)
        knocking = [knock(stream) for _ in range(500)]
        self.assertEqual(view.get("")[0], 200)
        told = [link.recv(4000) for link in knocking]
        self.assertTrue(all(text.startswith(b"HTTP/1.1 503") for text in told))
        self.assertTrue(all(b"connection: close" in text.lower() for text in told))
        self.assertEqual(view.get("")[0], 200)

    def test_a_port_that_is_taken_and_an_address_that_is_none(self):
        view = self.live()
        for at, status in ((f"127.0.0.1:{view.port}", 69), ("203.0.113.1:0", 69), ("8210", 64), ("127.0.0.1:http", 64)):
            done = subprocess.run([PROGRAM, "view", "--listen", at], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, status, done.stderr)
            self.assertIn("--listen", done.stderr)


if __name__ == "__main__":
    if not browser.is_there():
        print("SKIPPED: chromium and chromedriver (chromium-driver) are not installed: tools/setup test")
        sys.exit(77)
    unittest.main(argv=[sys.argv[0]] + sys.argv[2:], verbosity=1)
