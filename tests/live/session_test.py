#!/usr/bin/env python3
"""`palpate touch` as a viewer sees it: scenes, frames, the handle, sliders, recordings, slow viewers."""
import json
import math
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from touch_client import Server

PROGRAM = Path(sys.argv.pop(1)).resolve()

try:
    import h5py
except ImportError:
    h5py = None

PULL = {"rotation": [1.0, 0.0, 0.0, 0.0], "switches": 0, "hand": 0}


class Session(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-touch-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def serve(self, *arguments):
        server = Server(PROGRAM, *arguments, cwd=self.folder)
        self.addCleanup(server.stop)
        return server

    def watch(self, server, **options):
        viewer = server.viewer(**options)
        self.addCleanup(viewer.close)
        viewer.until(lambda: viewer.geometry is not None and len(viewer.frames) >= 2, 60)
        return viewer

    def drag(self, viewer, depth, seconds=0.6):
        """Takes the handle and moves it down, at 60 messages per second."""
        viewer.send(type="take")
        viewer.until(lambda: viewer.states and viewer.states[-1]["holder"] == "you")
        x, y, z = viewer.frames[-1]["hands"][0]["pose"][:3]
        steps = int(60 * seconds)
        for i in range(1, steps + 1):
            viewer.send(type="handle", position=[x, y, z - depth * i / steps], **PULL)
            viewer.listen(1 / 60)
        viewer.listen(0.3)

    def test_a_drag_dents_the_ball_and_the_force_is_that_of_the_record(self):
        server = self.serve("press-ball")
        viewer = self.watch(server)
        scene = viewer.scene
        self.assertEqual((scene["scene"], scene["protocol"]), ("press-ball", 1))
        body = scene["bodies"][0]
        size = 8 + 12 * body["nodes"] + 16 * body["tets"] + 20 * body["vertices"] + 12 * body["triangles"]
        size += sum(12 * (one["vertices"] + one["triangles"]) for one in scene["tools"] + scene["obstacles"])
        self.assertEqual(len(viewer.geometry), size)

        viewer.send(type="record", on=True)
        viewer.until(lambda: viewer.states[-1]["recording"] and len(viewer.frames) >= 2, 60)
        folder = viewer.states[-1]["recording"]["folder"]
        self.assertEqual(folder, "out/press-ball-touch-1")
        rest = viewer.frames[0]["bodies"][0]
        self.drag(viewer, 0.014)
        pressed = viewer.frames[-1]
        moved = max(abs(a - b) for a, b in zip(rest, pressed["bodies"][0]))
        self.assertGreater(moved, 1e-3)
        force = pressed["hands"][0]["force"][2]
        self.assertGreater(force, 0.1)
        self.assertTrue(pressed["hands"][0]["flags"] & 4, "in contact")
        rows = [row for frame in viewer.frames for row in frame["rows"]]
        self.assertGreater(max(row[0][3] for row in rows), 0.9 * force)
        self.assertLessEqual(max(row[0][0] for row in rows), 0.0)
        frames = list(viewer.frames)

        viewer.send(type="record", on=False)
        viewer.until(lambda: any(text["type"] == "recorded" for text in viewer.texts), 60)
        recorded = next(text for text in viewer.texts if text["type"] == "recorded")
        self.assertEqual((recorded["folder"], recorded["replay"]), (folder, f"palpate replay {folder}"))
        self.assertGreater(recorded["duration_s"], 0.2)
        self.compare(frames, self.folder / folder)
        summary = json.loads((self.folder / folder / "summary.json").read_text())
        self.assertEqual(summary["command"], "palpate touch press-ball")
        done = subprocess.run([str(PROGRAM), *recorded["replay"].split()[1:]], cwd=self.folder,
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("bitwise", done.stdout)

    def compare(self, frames, folder):
        """Every frame's force and pose are those of the tick at its time."""
        if h5py is None:
            self.skipTest("no h5py: the forces of frames were not compared with the record")
        with h5py.File(folder / "haptic.h5") as file:
            ticks = file["ticks"][:]
            names = file["ticks"].attrs["columns"].decode().split(",")
        times = ticks[:, names.index("time_s")]
        forces = [ticks[:, names.index(f"device_force_{axis}_n")] for axis in "xyz"]
        by_time = {round(1e6 * float(t)): i for i, t in enumerate(times)}
        compared = 0
        for frame in frames:
            i = by_time.get(round(1e6 * frame["time_s"]))
            if i is None or frame["time_s"] == 0.0:
                continue
            for axis in range(3):
                expected = float(forces[axis][i])
                self.assertAlmostEqual(frame["hands"][0]["force"][axis], expected,
                                       delta=1e-6 * abs(expected) + 1e-9)
            compared += 1
        self.assertGreater(compared, 10)

    def test_a_recording_of_the_single_rate_scheme_replays_bitwise(self):
        server = self.serve("press-ball", "--scheme", "single_rate", "--integrator",
                            "linearly-implicit-euler",
                            "--set", "integrator.step_s=0.001")
        viewer = self.watch(server)
        self.assertEqual(viewer.scene["scheme"], "single_rate")
        viewer.send(type="set", key="body.0.youngs_modulus_pa", value=2e4)  # kept by the recording
        viewer.send(type="record", on=True)
        viewer.until(lambda: viewer.states[-1]["recording"] and len(viewer.frames) >= 2, 60)
        viewer.send(type="set", key="body.0.youngs_modulus_pa", value=3e4)
        viewer.until(lambda: any("recording has one set" in text.get("text", "") for text in viewer.texts))
        self.drag(viewer, 0.014)
        self.assertGreater(viewer.frames[-1]["hands"][0]["force"][2], 0.1)
        viewer.send(type="record", on=False)
        viewer.until(lambda: any(text["type"] == "recorded" for text in viewer.texts), 60)
        folder = self.folder / "out/press-ball-touch-1"
        self.assertIn("youngs_modulus_pa = 20000", (folder / "scene.toml").read_text())
        done = subprocess.run([str(PROGRAM), "replay", str(folder)], cwd=self.folder, capture_output=True,
                              text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("bitwise", done.stdout)

    def test_both_hands_of_a_scene_are_moved_and_replayed_bitwise(self):
        server = self.serve("two-hands")
        viewer = self.watch(server)
        self.assertEqual([one["live"] for one in viewer.scene["hands"]], [True, True])
        viewer.send(type="record", on=True)
        viewer.until(lambda: viewer.states[-1]["recording"] and len(viewer.frames) >= 2, 60)
        viewer.send(type="take")
        viewer.until(lambda: viewer.states[-1]["holder"] == "you")
        starts = [hand["pose"][:3] for hand in viewer.frames[-1]["hands"]]
        for i in range(1, 37):
            for hand, (x, y, z) in enumerate(starts):
                into = -1 if x > 0 else 1
                viewer.send(**{**PULL, "hand": hand}, type="handle",
                            position=[x + into * 0.014 * i / 36, y, z])
            viewer.listen(1 / 60)
        def arrived():
            return all(abs(hand["pose"][0] - start[0] + math.copysign(0.014, start[0])) < 1e-5
                       for hand, start in zip(viewer.frames[-1]["hands"], starts))
        viewer.until(arrived)
        pressed = viewer.frames[-1]["hands"]
        for hand, (x, _, _) in enumerate(starts):
            self.assertGreater(math.copysign(1, x) * pressed[hand]["force"][0], 0.2)
        viewer.send(type="record", on=False)
        viewer.until(lambda: any(text["type"] == "recorded" for text in viewer.texts), 60)
        done = subprocess.run([str(PROGRAM), "replay", "out/two-hands-touch-1"], cwd=self.folder,
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertIn("bitwise", done.stdout)

    def test_one_holds_the_handle_and_others_watch(self):
        server = self.serve("press-ball")
        one, two = self.watch(server), self.watch(server)
        self.drag(one, 0.002, 0.1)
        two.until(lambda: two.states[-1]["holder"] == "other" and two.states[-1]["viewers"] == 2)
        two.send(type="reset")
        two.until(lambda: any("another viewer" in text["text"] for text in two.texts))
        one.close()
        two.until(lambda: two.states[-1]["holder"] == "nobody" and two.states[-1]["viewers"] == 1)

    def test_pause_reset_sliders_and_scenes(self):
        server = self.serve("press-ball")
        viewer = self.watch(server)
        viewer.send(type="pause", on=True)
        viewer.until(lambda: not viewer.states[-1]["running"])
        viewer.listen(0.5)
        time_s = viewer.frames[-1]["time_s"]
        viewer.listen(0.5)
        self.assertEqual(viewer.frames[-1]["time_s"], time_s)
        viewer.send(type="pause", on=False)
        viewer.until(lambda: viewer.frames[-1]["time_s"] > time_s)

        before = viewer.scene
        viewer.send(type="set", key="tool.coupling.stiffness_n_m", value=450.0)
        viewer.until(lambda: viewer.scene is not before and len(viewer.frames) >= 2, 60)
        self.assertEqual(viewer.scene["hands"][0]["stiffness_n_m"], 450.0)
        slider = viewer.scene["sliders"][0]
        self.assertEqual((slider["value"], slider["min"], slider["max"]), (450.0, 30.0, 3000.0))
        self.assertLess(viewer.frames[0]["time_s"], 1.0)

        before = viewer.scene
        viewer.send(type="reset")
        viewer.until(lambda: viewer.scene is not before and len(viewer.frames) >= 2, 60)
        self.assertEqual(viewer.scene["hands"][0]["stiffness_n_m"], 450.0, "a reset keeps the sliders")

        viewer.send(type="open", scene="falling-ball")
        viewer.until(lambda: viewer.scene["scene"] == "falling-ball" and len(viewer.frames) >= 3, 60)
        self.assertEqual(viewer.scene["hands"], [])
        viewer.send(type="take")
        viewer.until(lambda: any("no hand" in text["text"] for text in viewer.texts))
        falls = [frame["bodies"][0][2] for frame in viewer.frames]
        viewer.listen(0.3)
        self.assertLess(viewer.frames[-1]["bodies"][0][2], falls[0], "it falls")

    def test_a_slow_viewer_is_not_sent_old_frames_and_delays_no_tick(self):
        server = self.serve("press-ball")
        fast, slow = self.watch(server), self.watch(server, receive_buffer=4096)
        fast.listen(1.0)
        skipped = fast.states[-1]["skipped_ticks"]
        fast.listen(4.0)  # the slow viewer reads nothing meanwhile
        running = fast.frames[-1]["time_s"]
        self.assertLess(fast.states[-1]["skipped_ticks"] - skipped, 1000, "the simulation went on")
        # The socket holds at most its buffers: everything else is newer than the pause.
        start, newest = slow.frames[-1]["time_s"], 0.0
        count = 0
        while newest < running - 0.5:
            slow.receive()
            newest = slow.frames[-1]["time_s"]
            count += 1
            self.assertLess(count, 400, f"frames of a pause were queued: at {newest} of {running} s")
        missed = slow.frames[-1]["rows"]
        self.assertGreater(running, start + 1.0)
        self.assertLessEqual(len(missed), 2048)

    def test_ctrl_c_ends_viewers_and_a_recording_whole(self):
        server = self.serve("press-ball")
        viewer = self.watch(server)
        viewer.send(type="record", on=True)
        viewer.until(lambda: viewer.states[-1]["recording"] and len(viewer.frames) >= 2, 60)
        viewer.listen(0.5)
        start = time.monotonic()
        self.assertEqual(server.stop(), 130)
        self.assertLess(time.monotonic() - start, 30)
        with self.assertRaises(ConnectionError):
            while True:
                viewer.receive()
        self.assertEqual(viewer.closed, 1001)
        done = subprocess.run([str(PROGRAM), "replay", "out/press-ball-touch-1"], cwd=self.folder,
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)


if __name__ == "__main__":
    unittest.main()
