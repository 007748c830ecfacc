#!/usr/bin/env python3
"""Pictures of the page, to be looked at: shots.py SLAMSENSOR FOLDER. Of a recording and live, 100 and 10,000 landmarks, 390 and
1,440 pixels wide, light and dark; of the phone also what stands below the map."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

import browser
import drive
import lcm_types

PROGRAM, FOLDER = sys.argv[1], pathlib.Path(sys.argv[2])
SIZES = {"desktop": (1440, 900), "phone": (390, 844)}
GROUP, PORT = "239.255.76.70", 7700 + int(time.time()) % 200


def serve(*arguments):
    process = subprocess.Popen([PROGRAM, "view", "--listen", "127.0.0.1:0", *map(str, arguments)], stdout=subprocess.PIPE, text=True)
    return process, re.search(r"http://[\d.:]+/", process.stdout.readline())[0]


def ready(page, count):
    page.wait(f"return slamsensorView.story.map.x.length === {count} && !slamsensorView.view.dirty && !slamsensorView.view.resting", "the map")


def shoot(url, name, count, before=lambda: None):
    for size, (width, height) in SIZES.items():
        for theme in ("light", "dark"):
            page = browser.Browser(width, height)
            page.open(url)
            before()
            ready(page, count)
            if page.run("return document.documentElement.dataset.theme") != theme:
                page.run("document.getElementById('theme').click()")
                ready(page, count)
            page.shot(f"{name}-{count}-{size}-{theme}")
            if size == "phone":
                page.run("document.getElementById('cards').scrollIntoView()")
                page.shot(f"{name}-{count}-{size}-{theme}-cards")
            page.close()


def main():
    os.environ["SLAMSENSOR_SHOTS"] = str(FOLDER)
    for count, reach_m in ((100, 40.0), (10_000, 400.0)):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "drive.lcmlog"
            points, events = drive.recording(count, reach_m)
            lcm_types.write_log(path, events)
            process, url = serve(path)
            shoot(url, "recording", count)
            process.terminate()
        process, url = serve("--url", f"udpm://{GROUP}:{PORT}?ttl=0", "--set", "datum.latitude_deg=42.4627", "--set",
                             "datum.longitude_deg=-2.4449", "--set", "datum.height_m=384", "--set", "datum.bearing_deg=60")
        sender = lcm_types.Sender(GROUP, PORT)

        def send():
            for _ in range(2):  # a burst may lose some
                for channel, message in drive.map_messages(points):
                    sender.send(channel, message)
                    time.sleep(0.0005)
            for scan in range(3):
                for channel, message in (drive.scan_message(scan, drive.pose_at(scan), points), drive.pose_message(scan, drive.pose_at(scan)),
                                         drive.status_message(), drive.counters_message()):
                    sender.send(channel, message)
        shoot(url, "live", count, send)
        process.terminate()


if __name__ == "__main__":
    main()
