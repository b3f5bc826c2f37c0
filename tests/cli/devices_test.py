#!/usr/bin/env python3
"""Devices from outside: a driver in a shared object, a SpaceMouse and a game pad, each with a stand-in, and
the peers of docs/devices.md and of the Python package.

    devices_test.py PROGRAM
"""
import contextlib
import json
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
TREE = Path(__file__).resolve().parents[2]
PEER = TREE / "src/python/palpate/device.py"
LIMIT_S = 120  # for a process that does not end
BROKEN = """
#include "palpate/device/plugin.h"
static const char* specification(const char* options, PalpatePluginSpecification* out) {
  (void)options; out->name[0] = 'x'; return 0;
}
static const char* open_device(const char* options, void** device) {
  (void)device; return options[0] == 'n' ? "no device on /dev/ttyUSB0" : 0;
}
static const char* sample(void* device, double t, PalpatePluginSample* out) {
  (void)device; out->valid = 1; out->rotation_wxyz[0] = 1; out->position_m[2] = 0.082;
  if (t > 0.05) *(volatile int*)8 = 1;
  return 0;
}
static void close_device(void* device) { (void)device; }
PALPATE_DEVICE_PLUGIN(specification, open_device, sample, 0, close_device);
"""


def compile_driver(source, library):
    """Compiles a driver against the installed headers' folder alone."""
    subprocess.run(["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-shared", "-fPIC",
                    f"-I{TREE / 'include'}", source, "-lm", "-o", library], check=True)


class WithFolder(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-devices-"))
        self.addCleanup(shutil.rmtree, self.folder)
        shutil.copy(TREE / "scenes/press-ball.toml", self.folder / "scene.toml")

    def start(self, device, *arguments):
        return subprocess.Popen([PROGRAM, "run", "scene.toml", "-o", "out", "--set", f"device={{{device}}}",
                                 *arguments], cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True)

    def run_to_end(self, device, *arguments):
        run = self.start(device, *arguments)
        out, error = run.communicate(timeout=LIMIT_S)
        return run.returncode, out, error

    def hand(self):
        (hand,) = json.loads((self.folder / "out/summary.json").read_text())["figures"]["hands"]
        return hand

    def free_port(self):
        with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as one:
            one.bind(("127.0.0.1", 0))
            return one.getsockname()[1]


class Drivers(WithFolder):
    def test_the_example_presses_the_ball_in_virtual_time(self):
        compile_driver(TREE / "examples/device_driver.c", self.folder / "driver.so")
        status, out, error = self.run_to_end('type="plugin",library="driver.so",library_options="0.082"',
                                             "--duration-s", "0.4")
        self.assertEqual(status, 0, error)
        hand = self.hand()
        self.assertGreater(hand["peak_force_n"], 0.1)
        self.assertEqual(hand["max_force_n"], 5.0)
        self.assertEqual(hand["max_torque_n_m"], 0.0)
        self.assertEqual(hand["ticks_without_pose"], 0)
        self.assertGreaterEqual(hand["poses_accepted"], 400)
        self.assertEqual(hand["poses_not_finite"], 0)
        self.assertIn("poses accepted", out)

    def test_faults_are_reported_in_one_line(self):
        (self.folder / "broken.c").write_text(BROKEN)
        compile_driver(self.folder / "broken.c", self.folder / "broken.so")
        status, _, error = self.run_to_end('type="plugin",library="broken.so",library_options="none"')
        self.assertEqual(status, 1)
        self.assertRegex(error.splitlines()[0],
                         r'palpate: error: device: device driver "x" \(.*\): open: no device on /dev/ttyUSB0')
        status, _, error = self.run_to_end('type="plugin",library="broken.so"')
        self.assertEqual(status, -signal.SIGSEGV, error)
        self.assertRegex(error, r'palpate: error: device driver "x" \(.*broken\.so\): SIGSEGV in sample; '
                                r"the process ends")
        status, _, error = self.run_to_end('type="plugin",library="nowhere/driver.so"')
        self.assertEqual(status, 1)
        self.assertIn('device: library = "nowhere/driver.so" does not exist', error)


class SpaceMouse(WithFolder):
    def test_pushing_down_presses_the_ball(self):
        path = str(self.folder / "spnav.sock")
        listener = socket.socket(socket.AF_UNIX)
        self.addCleanup(listener.close)
        listener.bind(path)
        listener.listen()
        run = self.start(f'type="spacemouse",input="{path}",max_speed_m_s=0.02,dead_zone=0.0,ramp_s=0.0',
                         "--realtime", "--duration-s", "1")
        listener.settimeout(LIMIT_S)
        client, _ = listener.accept()
        self.addCleanup(client.close)
        client.sendall(struct.pack("=8i", 0, 0, -350, 0, 0, 0, 0, 8))  # y is up
        client.sendall(struct.pack("=8i", 1, 0, 1, 0, 0, 0, 0, 0))
        out, error = run.communicate(timeout=LIMIT_S)
        self.assertEqual(run.returncode, 0, error)
        hand = self.hand()
        self.assertGreater(hand["peak_force_n"], 0.2, "20 mm down in a second, from 3 mm above the ball")
        self.assertEqual((hand["motion_packets"], hand["button_packets"]), (1, 1))
        rows = [line.split(",") for line in (self.folder / "out/force.csv").read_text().splitlines()]
        z = rows[0].index("handle_z_m")
        self.assertAlmostEqual(float(rows[1][z]), 0.082, delta=1e-3)
        self.assertAlmostEqual(float(rows[-1][z]), 0.062, delta=1e-3)
        self.assertEqual(rows[-1][rows[0].index("switches")], "1")

    def test_without_a_daemon_or_real_time_it_is_rejected(self):
        status, _, error = self.run_to_end(f'type="spacemouse",input="{self.folder}/none"', "--realtime")
        self.assertEqual(status, 1)
        self.assertIn("no daemon of a SpaceMouse answers at", error)
        status, _, error = self.run_to_end(f'type="spacemouse",input="{self.folder}/none"')
        self.assertEqual(status, 1)
        self.assertIn("run in real time", error)


class GamePad(WithFolder):
    def test_recorded_events_press_the_ball(self):
        event = struct.Struct("llHHi")
        left_trigger, full = 2, 255
        (self.folder / "events").write_bytes(event.pack(0, 0, 3, left_trigger, full) +
                                             event.pack(0, 0, 0, 0, 0))
        status, _, error = self.run_to_end(
            f'type="gamepad",input="{self.folder}/events",max_speed_m_s=0.02,ramp_s=0.0', "--realtime",
            "--duration-s", "1")
        self.assertEqual(status, 0, error)
        self.assertGreater(self.hand()["peak_force_n"], 0.2)
        self.assertEqual(self.hand()["pad_events"], 1)


class Peers(WithFolder):
    def with_peer(self, port, command, **device):
        keys = "".join(f",{key}={value}" for key, value in device.items())
        run = self.start(f'type="udp",port={port},ramp_s=0.0{keys}', "--realtime", "--duration-s", "0.5")
        peer = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=LIMIT_S,
                              check=False)
        out, error = run.communicate(timeout=LIMIT_S)
        return run.returncode, out, error, peer

    def test_the_program_of_the_page(self):
        page = (TREE / "docs/devices.md").read_text()
        (program,) = [text for text in re.findall(r"^```python\n(.*?)^```$", page, re.M | re.S)
                      if "POSE" in text]
        self.assertLessEqual(len(program.strip().splitlines()), 32)
        port = self.free_port()
        self.assertEqual(program.count("4711"), 1)
        (self.folder / "peer.py").write_text(program.replace("4711", str(port)))
        status, _, error, peer = self.with_peer(port, [sys.executable, "peer.py"], time_out_s=0.02)
        self.assertEqual(status, 0, error)
        force = float(re.fullmatch(r"largest force ([\d.]+) N\n", peer.stdout + peer.stderr)[1])
        self.assertGreater(force, 0.1)
        self.assertAlmostEqual(force, self.hand()["peak_force_n"], delta=0.1 * force)

    def test_the_packets_of_the_page_are_those_of_the_header(self):
        page = (TREE / "docs/devices.md").read_text()
        header = (TREE / "include/palpate/device/udp.h").read_text()
        offsets = [[int(cell) for cell in re.findall(r"\b(\d+)\b", " ".join(row)) if cell] for row in
                   re.findall(r"^///   (\d+) .*?(?:  (\d+) +\w.*)?$", header, re.M)]
        on_page = [[int(cell) for cell in row if cell.strip()] for row in
                   re.findall(r"^\| (\d+) \|[^|]*\| (\d*) ?\|", page, re.M)]
        self.assertEqual([row[0] for row in offsets], [row[0] for row in on_page])
        self.assertGreaterEqual(len(on_page), 9)

    def test_the_ready_peer(self):
        (self.folder / "poses.csv").write_text("time_s,px_m,py_m,pz_m\n0,0,0,0.082\n0.2,0,0,0.072\n"
                                               "0.6,0,0,0.072\n")
        port = self.free_port()
        status, _, error, peer = self.with_peer(port, [sys.executable, PEER, str(port), "poses.csv"],
                                                time_out_s=0.02)
        self.assertEqual(status, 0, error)
        self.assertEqual(peer.returncode, 0, peer.stderr)
        force = float(re.search(r"largest force ([\d.]+) N; \d+ poses sent, \d+ wrenches received",
                                peer.stdout)[1])
        self.assertGreater(force, 0.1)
        self.assertGreaterEqual(len(re.findall(r"^ +[\d.]+ s  force", peer.stdout, re.M)), 5)

    def test_the_ready_peer_reports_faults(self):
        def peer(*arguments):
            done = subprocess.run([sys.executable, PEER, *arguments], cwd=self.folder, capture_output=True,
                                  text=True, timeout=LIMIT_S, check=False)
            return done.returncode, done.stderr
        (self.folder / "poses.csv").write_text("time_s,px_m,py_m,pz_m\n0,0,0,0.082\n")
        status, error = peer(str(self.free_port()), "poses.csv", "--wait-s", "0.2")
        self.assertEqual(status, 1)
        self.assertIn("no run answered within 0.2 s", error)
        (self.folder / "bad.csv").write_text("time_s,x,y\n0,0,0\n")
        status, error = peer("4711", "bad.csv")
        self.assertEqual(status, 1)
        self.assertIn("bad.csv: column px_m is missing (columns: time_s, x, y)", error)

    def test_a_peer_that_falls_silent_leaves_the_force_missing(self):
        (self.folder / "poses.csv").write_text("time_s,px_m,py_m,pz_m\n0,0,0,0.082\n0.05,0,0,0.081\n")
        port = self.free_port()
        status, out, error, _ = self.with_peer(port, [sys.executable, PEER, str(port), "poses.csv"])
        self.assertNotIn(status, (0, -signal.SIGSEGV))
        self.assertRegex(error, r"force on the hand .*sent no pose for 20 ms or more in \d+ of 500 ticks")
        self.assertRegex(out, r"device of the hand: no force in \d+ of 500 ticks")
        self.assertNotRegex(out, r"device of the hand: .*, 0 ", "events that did not occur are not listed")
        self.assertGreater(self.hand()["ticks_without_pose"], 250)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
