"""The page of slamsensor view in a real browser: what it draws and says of a recording.
Usage: view_test.py SLAMSENSOR. SLAMSENSOR_SHOTS=FOLDER keeps pictures of the page."""
import math
import subprocess

import drive
import lcm_types
from pages import ARROW_RIGHT, COLOUR, DESKTOP, LIST, PHONE, PIXEL, PROGRAM, PageTest, main


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
        self.assertIn("LW20; back once", page.text("#devices"))
        self.assertIn("searches cut", page.text("#counters"))
        self.assertRegex(page.run("return document.getElementById('map').getAttribute('aria-label')"),
                         r"Home map: 100 landmarks, 25 fixes on the path; the sensor at x 17\.\d, y -9\.\d metres in it")
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
        self.assertEqual(page.run(LIST, "#fix")["Search"], "cut off: its share of the time was used")
        self.assertEqual(page.run("return slamsensorView.story.path.filter((v) => v === null).length"), 0)
        self.assertIn("another place", page.text("#words").lower())
        self.seek(page, 31.0)  # scan 15
        self.assertIn("absent", page.text("#devices").lower())
        self.assertIn("look at its cable", page.text("#problem"))
        self.seek(page, 45.5)  # scan 22: in a local map
        self.assertIn("local map", page.text("#words").lower())
        self.assertEqual(page.run(LIST, "#fix")["Map"], "local 2")
        self.assertEqual(page.run(LIST, "#fix")["Chance poses expected"], "1.0")
        self.assertIn("local map 2", page.run("return document.getElementById('frame').innerText"))
        self.assertGreater(page.run("return slamsensorView.story.local_maps['2'].points.length"), 20)
        self.assertEqual(page.run("return slamsensorView.view.frame"), "2")
        count = page.run("return slamsensorView.story.local_maps['2'].points.length") // 2
        label = "return document.getElementById('map').getAttribute('aria-label')"
        self.assertEqual(page.run(label), f"Local map 2, not yet tied: {count} landmarks; the sensor at x 2.0, y 0.0 metres in it")
        self.assertEqual(page.run(LIST, "#about-map")["Drawn"], f"local map 2, {count} landmarks")
        page.run("const frame = document.getElementById('frame'); frame.value = 'home'; frame.dispatchEvent(new Event('change'))")
        self.assertEqual(page.run(label), "Home map: 100 landmarks, 19 fixes on the path; the sensor is in another map")
        page.run("const frame = document.getElementById('frame'); frame.value = 'auto'; frame.dispatchEvent(new Event('change'))")
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
        for name, words, status in ((self.folder / "none.lcm", "does not exist", 65), (self.folder, "is a folder", 65)):
            done = subprocess.run([PROGRAM, "view", name], capture_output=True, text=True, timeout=60)
            self.assertEqual(done.returncode, status)
            self.assertIn(words, done.stderr)
        done = subprocess.run([PROGRAM, "view", path, "--control-token-file", path], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 64)
        self.assertIn("a recording cannot be controlled", done.stderr)
        done = subprocess.run([PROGRAM, "view", path], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 65)
        self.assertIn("x.lcmlog: is no recording", done.stderr)
        lcm_types.write_log(path, [(drive.T0, "OTHER", b"12345678")])
        done = subprocess.run([PROGRAM, "view", path], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 65)
        self.assertIn("--prefix", done.stderr)


    def test_places_on_the_earth_are_by_the_recordings_datum_or_said_to_be_by_the_configurations(self):
        datum = [part for key in ("latitude_deg=10", "longitude_deg=20", "height_m=0", "bearing_deg=0") for part in ("--set", "datum." + key)]
        page = self.look()
        page.open(self.serve(self.recording(), *datum).url)
        page.wait("return slamsensorView.story.map.x.length === 100", "the map")
        self.assertEqual(page.run(LIST, "#about-map")["Whose datum"], "of the configuration")
        self.assertEqual(page.run(LIST, "#fix")["By the datum"], "of the configuration")


if __name__ == "__main__":
    main()
