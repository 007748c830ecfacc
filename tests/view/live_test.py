"""The page of slamsensor view in a real browser, live: what it draws and says, what it allows and what it costs.
Usage: live_test.py SLAMSENSOR. SLAMSENSOR_SHOTS=FOLDER keeps pictures of the page."""
import json
import math
import socket
import subprocess
import threading
import time
import unittest

import browser
import drive
import lcm_types
from pages import COLOUR, LIST, PIXEL, PROGRAM, PageTest, main


class FakeDaemon:
    """A control socket that answers what the page's server asks."""

    def __init__(self, path):
        self.datum = ("50.5", "7.25", "100", "30")
        self.stale_s = "600"
        self.server = socket.socket(socket.AF_UNIX)
        self.server.bind(str(path))
        self.server.listen(8)
        threading.Thread(target=self.run, daemon=True).start()

    def run(self):
        while True:
            try:
                link, _ = self.server.accept()
            except OSError:
                return
            with link, link.makefile("rw") as talk:
                for line in talk:
                    talk.write(self.answer(line.strip()))
                    talk.flush()

    def answer(self, request):
        if request == "status json":
            return ' {"initialization": 7, "fix": {"home_replaced": false}}\nOK\n'
        if request == "datum show":
            return "".join(f" {key}: {value}\n" for key, value in zip(("latitude_deg", "longitude_deg", "height_m", "bearing_deg"), self.datum)) + "OK\n"
        return f" value: {self.stale_s}\nOK\n"

    def close(self):
        self.server.shutdown(socket.SHUT_RDWR)
        self.server.close()


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

    def test_the_datum_is_that_of_the_daemon(self):
        daemon = FakeDaemon(self.folder / "control")
        view = self.live("--socket", self.folder / "control", "--set", "datum.latitude_deg=10", "--set", "datum.longitude_deg=20",
                         "--set", "datum.height_m=0", "--set", "datum.bearing_deg=0")
        page = self.look()
        page.open(view.url)
        page.wait("return document.getElementById('state-words').textContent === 'waiting for a sensor'", "the page")
        self.send(drive.pose_message(0, (0.0, 0.0, 0.0)), drive.status_message())
        page.wait("return slamsensorView.story.pose !== undefined", "the pose")
        page.wait("return document.getElementById('about-map').textContent.includes('50.5000000, 7.2500000, 100.0 m')", "the daemon's datum")
        self.assertEqual(page.run(LIST, "#fix")["Latitude, longitude"], "50.5000000, 7.2500000")
        self.assertEqual(page.run(LIST, "#fix")["True heading"], "30.0°")
        self.assertNotIn("of the configuration", page.text("#cards"))
        daemon.datum = ("51.5", "8.25", "0", "40")
        page.wait("return document.getElementById('fix').textContent.includes('51.5000000, 8.2500000')", "the datum that was set since")
        daemon.datum = ()
        page.wait("return document.getElementById('about-map').textContent.includes('none: metres only')", "the datum to be cleared")
        self.assertNotIn("Latitude, longitude", page.run(LIST, "#fix"))
        daemon.close()
        page.wait("return document.getElementById('fix').textContent.includes('of the configuration')", "the configuration's")
        self.assertEqual(page.run(LIST, "#fix")["Latitude, longitude"], "10.0000000, 20.0000000")

    def test_a_sensor_that_is_silent_has_no_fix_for_long(self):
        view = self.live("--set", "fix.stale_s=8")
        page = self.look()
        page.open(view.url)
        points = drive.landmarks(100, 40.0)
        pose = drive.pose_at(0)
        page.wait("return document.getElementById('state-words').textContent === 'waiting for a sensor'", "the page")
        self.send(*drive.map_messages(points), drive.scan_message(0, pose, points), drive.pose_message(0, pose), drive.status_message())
        page.wait("return document.getElementById('words').className === 'good' && slamsensorView.story.stale_s === 8", "the fix")
        self.settle(page)
        beam = [(pose[0] + r * math.cos(pose[2] + 0.6), pose[1] + r * math.sin(pose[2] + 0.6))
                for r in (50 / page.run("return slamsensorView.view.scale"),)][0]
        self.assert_near(page.run(PIXEL, *beam), page.run(COLOUR, "--beam"))
        page.run("""window.changes = []; new MutationObserver((seen) => changes.push(...seen.map(() => document.getElementById('state').textContent)))
                      .observe(document.getElementById('state'), {subtree: true, childList: true, characterData: true})""")
        page.wait("return document.getElementById('state-words').textContent === 'silent'", "the silence")
        self.settle(page)
        self.assertEqual(page.text("#words"), "The last fix before the sensor fell silent")
        self.assertEqual(page.run("return document.getElementById('words').className"), "warn")
        self.assertEqual(page.text("#devices").count("not known"), 2)
        self.assertEqual(page.run(LIST, "#sensor"), {"Head": "not known"})
        self.assertNotEqual(page.run(PIXEL, *beam), page.run(COLOUR, "--beam"))
        page.wait("return document.getElementById('words').className === 'bad'", "the end of the fix")
        self.settle(page)
        self.assertIn("No fix: stale", page.text("#words"))
        self.assertIn("Last x, y", page.run(LIST, "#fix"))
        self.assertRegex(page.run("return document.getElementById('map').getAttribute('aria-label')"), "the sensor was last at x .*; no fix: stale")
        self.assertGreater(max(abs(a - b) for a, b in zip(page.run(PIXEL, *pose[:2]), page.run(COLOUR, "--sigma"))), 40)
        self.assertRegex(page.text("#silence"), r"^for \d+\.\d s$")
        self.assertEqual(page.run("return window.changes"), ["silent"], "what a screen reader says")
        page.shot("live-silent")

    def test_the_page_that_is_one_too_many_is_told(self):
        view = self.live()
        links = []
        for _ in range(16):
            links.append(socket.create_connection(("127.0.0.1", view.port), 10))
            self.addCleanup(links[-1].close)
            links[-1].sendall(f"GET /api/stream HTTP/1.1\r\nHost: 127.0.0.1:{view.port}\r\n\r\n".encode())
            self.assertEqual(links[-1].recv(12), b"HTTP/1.1 200")
        page = self.look()
        page.open(view.url)
        page.wait("return document.getElementById('link').textContent === 'enough pages are open; close one'", "the reason")
        links[0].close()
        page.wait("return document.getElementById('link').hidden", "the stream")

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
        page.run("document.getElementById('token').value = 'schlüssel €'; document.querySelector('#orders button').click()")
        page.wait("return document.getElementById('answer').textContent.endsWith('only printable ASCII characters')", "the odd token to be refused")
        self.assertEqual(view.close(), 0)
        page.run("document.getElementById('token').value = '0123456789abcdefgh'; document.querySelector('#orders button').click()")
        page.wait("return document.getElementById('answer').textContent.startsWith('scan now: the connection to slamsensor view is lost')", "the loss")
        read_only = self.live()
        self.assertEqual(read_only.get("api/ctl", "POST", body, **right)[0], 403)
        token.write_text("short\n")
        done = subprocess.run([PROGRAM, "view", "--control-token-file", token], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 65)
        self.assertIn("needs 16", done.stderr)
        token.write_text("schlüssel-lang-genug\n")
        done = subprocess.run([PROGRAM, "view", "--control-token-file", token], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 65)
        self.assertIn("only printable ASCII", done.stderr)

    def test_what_a_web_server_must_not_do(self):
        view = self.live()
        self.assertEqual(view.get("", Host="sensor.example:80")[0], 403)
        self.assertEqual(view.get("", Host="localhost:80")[0], 200)
        self.assertEqual(view.get("../etc/passwd")[0], 404)
        status, text, headers = view.get("api/at?t=1")
        self.assertEqual((status, headers["Content-Type"]), (404, "text/plain"))
        self.assertEqual(text, b"nothing is here; look at / for the page, /api/about or /api/stream\n")
        _, text, headers = view.get("")
        self.assertIn("default-src 'none'", headers["Content-Security-Policy"])
        self.assertNotIn(b"http://", text.replace(b"http://www.w3.org", b""))
        self.assertNotIn(b"https://", text)
        recording = self.serve(self.recording())
        self.assertIn(b"/api/at?t=SECONDS", recording.get("api/stream")[1])
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
    main()
