#!/usr/bin/env python3
"""The daemon on an emulated head as its user has it: start, fixes, outputs, requests, reload, stop, restart.
run_test.py SLAMSENSOR SLAMSENSORD"""
import os
import pathlib
import pty
import sys
import time
import tty
import unittest

import nmea
from sensor import STOP_MAX_S, Control, Refused, Sensor, error_of, free_port, wait_for

PROGRAMS = sys.argv[1:3]
DATUM = {"datum.latitude_deg": 48.0, "datum.longitude_deg": 11.0, "datum.height_m": 500.0, "datum.bearing_deg": 90.0}


class Running(unittest.TestCase):
    """A daemon with a fix, for all tests of the class."""

    @classmethod
    def setUpClass(cls):
        cls.port = free_port()
        cls.master, slave = pty.openpty()
        tty.setraw(slave)
        cls.sensor = Sensor(PROGRAMS, settings={"nmea.tcp": "true", "nmea.tcp_port": cls.port,
                                                "nmea.serial_path": os.ttyname(slave), **DATUM})
        os.close(slave)
        cls.addClassCleanup(cls.sensor.close)
        cls.addClassCleanup(os.close, cls.master)
        cls.sensor.start_head()
        cls.sensor.start()
        cls.sensor.wait_fix()

    def ask(self, request):
        return self.sensor.ask(request)

    def refused(self, request, code, *parts):
        with self.assertRaises(Refused) as caught:
            self.ask(request)
        self.assertEqual(caught.exception.code, code, caught.exception.text)
        for part in parts:
            self.assertIn(part, caught.exception.text)

    def test_a_fix_is_where_the_sensor_is(self):
        for _ in range(3):
            status = self.sensor.wait_scans()
            if status["state"] == "fixed":
                metres, radians = error_of(status["fix"], self.sensor.pose())
                self.assertLess(metres, 0.5)
                self.assertLess(radians, 0.02)
        self.assertLess(status["time_to_first_fix_s"], 20.0)
        self.assertEqual(status["source"], "emulated")

    def test_nmea_over_tcp_and_serial_says_the_same(self):
        tcp, serial = nmea.Reader.tcp(self.port), nmea.Reader(self.master)
        self.addCleanup(tcp.close)
        heard = {fields[2]: fields for fields in (serial.of_kind("PSLMA") for _ in range(5))}
        for fields in (tcp.of_kind("PSLMA") for _ in range(10)):
            if fields[2] in heard:
                self.assertEqual(fields, heard[fields[2]])
        pose = nmea.pose_of(tcp.of_kind("PSLMA"))
        if pose:
            fix = {"x_m": pose[0], "y_m": pose[1], "heading_rad": pose[2]}
            self.assertLess(error_of(fix, self.sensor.pose())[0], 0.5)
        kinds = [tcp.sentence()[0] for _ in range(12)]
        for kind in ("GPRMC", "GPGGA", "GPGBS", "GPHDT", "GPGST", "PSLMA"):
            self.assertIn(kind, kinds)

    def test_nmea_names_the_place_on_earth_and_that_it_is_emulated(self):
        reader = nmea.Reader.tcp(self.port)
        self.addCleanup(reader.close)
        def fixed():
            fields = reader.of_kind("GGA")
            return fields if fields[6] == "8" else None
        gga = wait_for(fixed, "a GGA sentence with a fix")
        self.assertEqual((gga[3], gga[5]), ("N", "E"))
        degrees = lambda text, places: float(text[:places]) + float(text[places:]) / 60
        self.assertAlmostEqual(degrees(gga[2], 2), 48.0, delta=0.0001)
        self.assertAlmostEqual(degrees(gga[4], 3), 11.0, delta=0.0001)
        self.assertEqual(reader.of_kind("RMC")[12], "S")

    def test_help_lists_every_request_and_each_is_known(self):
        lines, _ = self.ask("help")
        words = {line.split("  ")[0].split("[")[0].strip() for line in lines}
        for request in ("status", "fix", "counters", "devices", "version", "scan now", "map list", "map info",
                        "map landmarks", "record status", "config list", "datum show"):
            self.assertTrue(any(word == request for word in words), request)
            self.ask(request)
        self.refused("fly", "unknown")
        self.refused("map load", "value")
        self.refused("map load a/b", "value")
        self.refused("x" * 2000, "syntax")

    def test_what_happens_on_a_devices_line_is_counted_with_the_device(self):
        lines = [line.split() for line in self.ask("counters")[0]]
        counters = self.sensor.status()["counters"]
        for device in ("pan_tilt", "rangefinder"):
            self.assertGreaterEqual(counters[device]["opened"], 1)
            self.assertEqual(counters[device]["hang_ups"], 0)
            self.assertEqual(len([line for line in lines if line[0].startswith(device)]), len(counters[device]))

    def test_scanning_pauses_and_goes_on(self):
        self.ask("scan pause")
        held = self.sensor.wait_status(lambda s: s["state"] == "held", "scanning to pause")
        self.assertEqual(held["fix"]["status"], "no_fix")
        scans = held["slam"]["scans"]
        time.sleep(1.0)
        self.assertLessEqual(self.sensor.status()["slam"]["scans"], scans + 1)
        self.ask("scan resume")
        self.sensor.wait_fix()

    def test_single_scans_on_request(self):
        self.ask("scan mode single")
        self.addCleanup(self.ask, "scan mode continuous")
        self.sensor.wait_status(lambda s: s["head"]["phase"] == "waiting", "the scan under way to end")
        time.sleep(0.5)  # it is with SLAM now
        before = self.sensor.status()["slam"]["scans"]
        self.ask("scan now")
        self.sensor.wait_status(lambda s: s["slam"]["scans"] == before + 1, "the scan that was asked for")
        self.sensor.wait_status(lambda s: s["head"]["phase"] == "waiting", "waiting")
        time.sleep(0.5)
        self.assertEqual(self.sensor.status()["slam"]["scans"], before + 1)
        self.refused("scan mode fast", "value")
        self.ask("datum set 48 11 501 90")  # what has nothing to do with it does not set the scanner going again
        time.sleep(1.0)
        self.assertEqual(self.sensor.status()["slam"]["scans"], before + 1)

    def test_maps_are_kept_listed_loaded_frozen_and_removed(self):
        self.assertIn("landmarks", self.ask("map save shed")[1])
        self.assertTrue(any(line.startswith("shed: ") for line in self.ask("map list")[0]))
        self.assertTrue((self.sensor.maps / "shed.slammap").exists())
        self.refused("map load nowhere", "not_found", "nowhere")
        self.assertIn("shed", self.ask("map load shed")[1])
        self.assertIn("name: shed", self.ask("map info")[0])
        names, *landmarks = [line.split() for line in self.ask("map landmarks")[0]]
        self.assertEqual(names, ["id", "x_m", "y_m", "sigma_m", "diameter_m"])
        self.assertGreaterEqual(len(landmarks), 3)
        measured = [float(landmark[4]) for landmark in landmarks if float(landmark[4]) > 0]
        self.assertGreaterEqual(len(measured), 3)
        self.assertTrue(all(0.02 < diameter < 3 for diameter in measured), measured)
        self.refused("map remove shed", "refused", "in use")
        self.sensor.wait_scans()
        self.sensor.wait_fix()

        self.ask("map freeze")
        frozen = (self.sensor.maps / "shed.slammap").read_bytes()
        revision = self.sensor.status()["map"]["revision"]
        self.refused("map reset", "refused", "frozen")
        status = self.sensor.wait_scans()
        self.assertTrue(status["map"]["frozen"])
        self.assertEqual(status["map"]["revision"], revision)
        self.assertEqual((self.sensor.maps / "shed.slammap").read_bytes(), frozen)
        self.ask("map unfreeze")

        self.ask("map save default")
        self.ask("map load default")
        self.ask("map remove shed")
        self.refused("map load shed", "not_found")

    def test_map_reset_begins_anew_and_keeps_the_old_one(self):
        self.sensor.wait_fix()
        self.ask("map save kept")
        self.ask("map reset")
        self.assertEqual(self.sensor.status()["map"]["landmarks"], 0)
        self.sensor.wait_status(lambda s: s["map"]["landmarks"] > 0, "a new map")
        self.assertTrue((self.sensor.maps / "default-before-reset.slammap").exists())
        self.ask("map load kept")
        self.ask("map save default")
        self.ask("map load default")

    def test_nothing_is_saved_while_another_map_is_being_loaded(self):
        """Between the SLAM thread's work and the answer the next map had the last one's name and history."""
        self.sensor.wait_fix()
        self.ask("map save kept")
        self.ask("map save default")
        self.ask("config set map.autosave_s 0.01")
        self.addCleanup(self.ask, "config set map.autosave_s 60")
        other = Control(self.sensor.folder / "control")
        self.addCleanup(other.close)
        with self.sensor.frozen_thread("publish", self):  # the answer comes when the status that others see is that after it
            before = {path.name: path.read_bytes() for path in self.sensor.maps.glob("default*.slammap*")}
            other.send("map load kept")
            time.sleep(1.0)
            for request in ("map save", "map save copy", "map reset", "map freeze"):
                self.refused(request, "busy")
            after = {path.name: path.read_bytes() for path in self.sensor.maps.glob("default*.slammap*")}
        self.assertIn("'kept' loaded", other.answer()[1])
        self.assertEqual(before, after)
        self.ask("map save default")
        self.ask("map load default")

    def test_before_the_first_scan_in_a_map_there_is_no_scan_yet(self):
        self.sensor.wait_fix()
        self.ask("map save kept")
        self.ask("scan mode single")
        self.addCleanup(self.ask, "scan mode continuous")
        self.sensor.wait_status(lambda s: s["head"]["phase"] == "waiting", "the scan under way to end")
        reader = nmea.Reader.tcp(self.port)
        self.addCleanup(reader.close)
        for request in ("map reset", "map load kept"):
            self.ask(request)
            status = self.sensor.wait_status(lambda s: s["fix"]["reason"] == "no_scan", "the truth after " + request)
            self.assertEqual((status["state"], status["fix"]["status"]), ("scanning", "no_fix"))
            self.assertIn("fix:            no fix: no scan yet", self.ask("status")[0])
            wait_for(lambda: reader.of_kind("PSLMA")[5] == "11", "reason 11 in NMEA after " + request)
            self.ask("scan now")
            self.sensor.wait_status(lambda s: s["fix"]["reason"] != "no_scan", "what the scan gave")
        self.ask("map save default")
        self.ask("map load default")

    def test_datum(self):
        self.assertIn("latitude_deg: 48.0", self.ask("datum show")[0])
        self.ask("datum set -33.5 151.25 12 270")
        reader = nmea.Reader.tcp(self.port)
        self.addCleanup(reader.close)
        self.addCleanup(self.ask, "datum set 48 11 500 90")
        wait_for(lambda: reader.of_kind("GGA")[3] == "S", "the new datum in GGA")
        self.refused("datum set 91 0 0 0", "value")
        self.ask("map reset")  # a map that was loaded brings the datum that it was saved with
        self.ask("datum clear")
        self.assertIn("no datum", self.ask("datum show")[1])
        wait_for(lambda: reader.of_kind("GGA")[2] == "", "GGA without a place")

    def test_settings_are_shown_set_and_taken_back(self):
        self.assertIn("value: 10.0", self.ask("config get nmea.rate_hz")[0])
        self.ask("config set nmea.rate_hz 5")
        self.assertIn("value: 5.0", self.ask("config get nmea.rate_hz")[0])
        self.ask("config unset nmea.rate_hz")
        self.assertIn("value: 10.0", self.ask("config get nmea.rate_hz")[0])
        self.refused("config set scan.settle_s 0.5", "config", "needs a restart")
        self.refused("config set nmea.rate_hz 11", "config", "10")
        self.refused("config set nmea.rat 1", "value", "nmea.rat")
        self.ask("log level debug")
        self.ask("log level info")
        self.refused("log level loud", "value")

    def test_frozen_as_a_setting_takes_effect_live(self):
        self.ask("config set map.frozen true")
        self.sensor.wait_status(lambda s: s["map"]["frozen"], "the map to freeze", 5.0)
        self.ask("config unset map.frozen")
        self.sensor.wait_status(lambda s: not s["map"]["frozen"], "the map to thaw", 5.0)

    def test_reload_says_what_is_live_what_waits_and_what_is_wrong(self):
        text = self.sensor.config.read_text()
        self.addCleanup(self.sensor.config.write_text, text)
        reload = lambda: (self.sensor.manager.forget(), self.sensor.daemon.send_signal(1),
                          wait_for(lambda: self.sensor.manager.times("READY=1"), "the reload"))
        self.sensor.config.write_text(text.replace("rate_hz = 10.0", "rate_hz = 2.0"))
        reload()
        self.assertTrue(self.sensor.manager.last("RELOADING=1\nMONOTONIC_USEC="))
        self.assertIn("value: 2.0", self.ask("config get nmea.rate_hz")[0])
        self.sensor.config.write_text(text.replace("settle_s = 0.02", "settle_s = 0.04"))
        reload()
        self.assertIn("scan.settle_s", self.sensor.log())
        self.assertIn("value: 10.0", self.ask("config get nmea.rate_hz")[0])
        self.sensor.config.write_text(text + "\n[scan2]\nx = 1\n")
        reload()
        self.assertIn("scan2", self.sensor.log())
        self.assertIn("the one in force stays", self.sensor.log())
        self.refused("config reload", "config", "scan2")
        self.sensor.config.write_text(text)
        self.ask("config reload")
        self.assertIsNone(self.sensor.daemon.poll())


class Ends(unittest.TestCase):
    """Start and stop."""

    def setUp(self):
        self.sensor = Sensor(PROGRAMS, settings={"map.autosave_s": 1.0})
        self.addCleanup(self.sensor.close)
        self.sensor.start_head()

    def test_ready_then_fixes_then_an_end_within_a_second_and_again(self):
        manager = self.sensor.manager
        self.sensor.start()
        wait_for(lambda: manager.times("READY=1"), "READY=1")
        self.assertIn("SF30/D", self.sensor.log()[:self.sensor.log().find("pan-tilt ready")])
        self.assertTrue(manager.times("EXTEND_TIMEOUT_USEC="))
        self.sensor.wait_fix()
        wait_for(lambda: manager.last("STATUS=").startswith("STATUS=fixed x="), "a status text with the fix")
        for part in ("m heading=", "map 'default'", "landmarks", "pan-tilt ready", "rangefinder ready"):
            self.assertIn(part, manager.last("STATUS="))
        for _ in range(2):
            self.sensor.wait_scans()
            self.sensor.next_stand()
        wait_for(lambda: (self.sensor.maps / "default.slammap").exists(), "the map to be saved by itself")
        status, seconds = self.sensor.terminate()
        print(f"ended in {seconds:.3f} s;", end=" ", flush=True)
        self.assertEqual(status, 0, self.sensor.log())
        self.assertLess(seconds, STOP_MAX_S)
        self.assertTrue(manager.times("STOPPING=1"))
        self.assertFalse((self.sensor.folder / "control").exists())

        self.sensor.start()
        first = self.sensor.wait_status(lambda s: s["slam"]["scans"] >= 1, "a scan")
        self.assertEqual(first["fix"]["status"], "fix", self.sensor.log())
        self.assertGreater(first["fix"]["matches"], 5)
        self.assertFalse(self.sensor.is_wrong(first["fix"]))
        print(f"first fix {first['time_to_first_fix_s']:.2f} s after a restart;", end=" ", flush=True)

    def test_the_watchdog_is_fed_and_starves_while_a_thread_stands_still(self):
        manager = self.sensor.manager
        self.sensor.start(environment={"WATCHDOG_USEC": "900000"})
        wait_for(lambda: len(manager.times("WATCHDOG=1")) > 5, "the watchdog to be fed")
        times = manager.times("WATCHDOG=1")
        self.assertLess(max(b - a for a, b in zip(times, times[1:])), 0.9)
        self.sensor.wait_status(lambda s: s["devices"]["rangefinder"]["state"] == "ready", "the devices")
        with self.sensor.frozen_thread("scan", self):
            wait_for(lambda: "thread scan has made no progress" in self.sensor.log(), "the stall to be told")
            manager.forget()
            time.sleep(1.5)
            self.assertEqual(manager.times("WATCHDOG=1"), [])
            self.assertIsNone(self.sensor.daemon.poll())
        wait_for(lambda: manager.times("WATCHDOG=1"), "the watchdog to be fed again")
        self.sensor.wait_fix()


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
