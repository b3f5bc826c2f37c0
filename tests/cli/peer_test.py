#!/usr/bin/env python3
"""A peer on the network holds the tool: the wait for it, the packets that it may send, and those it receives
when a run ends.

    peer_test.py PROGRAM
"""
import contextlib
import json
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
POSE = struct.Struct("<IHHQd3d4d3d3dI")
WRENCH = struct.Struct("<IHHQd3d3d")
MAGIC = 0x54504C50
LIMIT_S = 120  # for a process that does not end


def pose(sequence, position, velocity=(0.0, 0.0, 0.0)):
    return POSE.pack(MAGIC, 1, 1, sequence, 0.0, *position, 1.0, 0.0, 0.0, 0.0, *velocity, 0.0, 0.0, 0.0, 0)


class Peer:
    """Sends a pose for each received wrench, and occasionally without one."""

    def __init__(self, port, position):
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", port))
        self.socket.settimeout(0.002)
        self.position = position
        self.extra = []  # packets that are sent once, before the next pose
        self.forces = []
        self.pressed = threading.Event()
        self.over = threading.Event()
        self.thread = threading.Thread(target=self.work)
        self.thread.start()

    def work(self):
        sequence = 0
        while not self.over.is_set():
            sequence += 1
            packets, self.extra = self.extra, []
            for packet in packets + [pose(sequence, self.position)]:
                with contextlib.suppress(OSError):  # no listener
                    self.socket.send(packet)
            self.receive()

    def receive(self):
        with contextlib.suppress(OSError):
            force = WRENCH.unpack(self.socket.recv(256))[5:8]
            self.forces.append(force)
            if max(map(abs, force)) > 0.1:
                self.pressed.set()

    def end(self):
        """Receives the remaining packets."""
        self.over.set()
        self.thread.join()
        self.socket.setblocking(False)
        count = -1
        while count != len(self.forces):
            count = len(self.forces)
            self.receive()
        self.socket.close()


class WithPeer(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-peer-"))
        self.addCleanup(shutil.rmtree, self.folder)
        with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as one:
            one.bind(("127.0.0.1", 0))
            self.port = one.getsockname()[1]

    def start(self, *arguments, keys=""):
        device = f'device={{type="udp",port={self.port}{keys}}}'
        return subprocess.Popen([PROGRAM, "run", "press-ball", "-o", "out", "--set", device, *arguments],
                                cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def peer(self, position=(0.0, 0.0, 0.075)):
        return Peer(self.port, position)

    def summary(self):
        return json.loads((self.folder / "out/summary.json").read_text())

    def test_a_run_says_where_it_waits_and_for_how_long(self):
        out, error = self.start("--realtime", keys=",wait_s=0.2").communicate(timeout=LIMIT_S)
        place = f"127.0.0.1, UDP port {self.port}"
        self.assertEqual(out, f"waiting for the first pose at {place}, for up to 0.2 s\n")
        self.assertIn(f"device: no pose arrived at {place}, within 0.2 s; start the peer", error)
        self.assertEqual(self.summary()["outcome"], "failed")

    def test_a_peer_needs_real_time(self):
        run = self.start()
        out, error = run.communicate(timeout=LIMIT_S)
        self.assertEqual((run.returncode, out), (1, ""), error)
        self.assertIn("by the wall clock; run in real time (palpate run --realtime)", error)
        self.assertFalse((self.folder / "out").exists(), "it was refused before anything was written")

    def test_absurd_packets_end_no_run(self):
        peer = self.peer()
        run = self.start("--realtime", "--duration-s", "3", keys=",ramp_s=0.0")
        peer.pressed.wait(LIMIT_S)
        peer.extra = [pose(10**6, (1e250, 0.0, 0.07)), pose(10**6, (0.0, 0.0, 0.07), (1e200, 0.0, 0.0)),
                      pose(2**64 - 1, (0.0, 0.0, 0.07))]
        out, error = run.communicate(timeout=LIMIT_S)
        peer.end()
        self.assertEqual(run.returncode, 0, error)
        (device,) = self.summary()["figures"]["hands"]
        self.assertGreaterEqual(device["packets_out_of_bounds"], 2)
        self.assertEqual(device["packets_far_ahead"], 1)
        self.assertGreater(device["packets_accepted"], 100)

    def test_a_stopped_run_leaves_no_force_in_the_hand(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            with self.subTest(signal=number.name):
                peer = self.peer()
                run = self.start("--realtime", "--duration-s", "600", keys=",ramp_s=0.0")
                pressed = peer.pressed.wait(LIMIT_S)
                run.send_signal(number)
                _, error = run.communicate(timeout=LIMIT_S)
                peer.end()
                self.assertTrue(pressed, error)
                self.assertEqual(run.returncode, 130, error)
                self.assertIn("stopped at t = ", error)
                self.assertEqual(peer.forces[-1], (0.0, 0.0, 0.0))
                self.assertEqual(self.summary()["outcome"], "interrupted")

    def test_a_stopped_process_goes_on_with_its_clock(self):
        peer = self.peer()
        run = self.start("--realtime", "--duration-s", "5", keys=",ramp_s=0.1")
        pressed = peer.pressed.wait(LIMIT_S)
        run.send_signal(signal.SIGSTOP)
        threading.Event().wait(1.0)
        run.send_signal(signal.SIGCONT)
        out, error = run.communicate(timeout=LIMIT_S)
        peer.end()
        self.assertTrue(pressed, error)
        self.assertEqual(run.returncode, 0, error)
        figures = self.summary()["figures"]["real_time"]
        self.assertGreater(figures["left_out_ticks"], 900)
        self.assertGreaterEqual(figures["stalls"], 1)
        self.assertRegex(out, r"the clock was restarted .* [0-9]+ ticks were skipped")
        self.assertEqual(figures["ticks_timed"], 5000)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
