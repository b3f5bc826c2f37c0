#!/usr/bin/env python3
"""The scenes of the paper for 10 s of simulated time, in which the hand moves in the first second and then
holds: everything remains finite, the hand extracts no energy from the loop, and a held contact does not
vibrate.

    paper_scenes_test.py PROGRAM [Short | Slow.test_...]

The slow ones print one line of figures each; with PALPATE_FIGURES=FILE they also append them to FILE.
"""
import csv
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import h5py
except ImportError:  # package python3-h5py
    sys.exit("python3-h5py is missing")

PROGRAM = Path(sys.argv[1]).resolve()
LEAST_ENERGY_J = -1e-6
BUZZ_N = 10e-3
CONTROL_SHARE = 0.02


class HighPass:
    """Butterworth filter, fourth order, 30 Hz: two biquads by the bilinear transform with frequency
    warping."""

    def __init__(self, tick_s, hz=30.0):
        w = math.tan(math.pi * hz * tick_s)
        self.sections = []
        for i in range(2):
            q = 1.0 / (2.0 * math.cos(math.pi * (2 * i + 1) / 8.0))
            a0 = 1.0 + w / q + w * w
            self.sections.append([1.0 / a0, 2.0 * (w * w - 1.0) / a0, (1.0 - w / q + w * w) / a0] + [0.0] * 4)

    def __call__(self, x):
        for s in self.sections:
            b, a1, a2, x1, x2, y1, y2 = s
            y = b * (x - 2.0 * x1 + x2) - a1 * y1 - a2 * y2
            s[3:] = [x, x1, y, y1]
            x = y
        return x


def buzz(rows, tick_s, start_s):
    """RMS of the force on the hand above 30 Hz from a given time on; the filter starts a second earlier."""
    total, count = 0.0, 0
    filters = [HighPass(tick_s) for _ in range(3)]
    for row in rows:
        if row["time_s"] < start_s - 1.0:
            continue
        force = [f(row[f"force_{axis}_n"]) for f, axis in zip(filters, "xyz")]
        if row["time_s"] >= start_s:
            total += sum(f * f for f in force)
            count += 1
    return math.sqrt(total / count)


class Scenes(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-scenes-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def run_scene(self, scene, duration_s, passivity, more=()):
        """Returns the figures of a run, after checking that it is finite to its end."""
        out = self.folder / f"{scene}-{passivity}"
        command = [str(PROGRAM), "run", scene, "--duration-s", str(duration_s), "--passivity", passivity,
                   "-o", str(out), "--set", "record.state_period_s=0.5"]
        for change in more:
            command += ["--set", change]
        done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        summary = json.loads((out / "summary.json").read_text())["figures"]
        with h5py.File(out / "run.vtkhdf", "r") as states:
            points = states["VTKHDF/Points"]
            self.assertGreater(points.shape[0], 0)
            for start in range(0, points.shape[0], 100_000):
                self.assertTrue(abs(points[start:start + 100_000]).max() < 10.0, "within 10 m, and no NaN")
        forces = out / "force.csv"
        if not forces.exists():
            return None, []
        with forces.open() as lines:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]
        self.assertAlmostEqual(rows[-1]["time_s"], duration_s, delta=1e-6)
        for row in rows:
            self.assertTrue(all(map(math.isfinite, row.values())), row)
        return summary["hands"][0], rows

    def check(self, scene, duration_s=10.0, held_s=5.0, more=(), least_j=LEAST_ENERGY_J, buzz_n=BUZZ_N,
              share=CONTROL_SHARE, pressing_n=0.05):
        """Runs observed, then controlled.
        @param held_s      from here on the hand holds
        @param pressing_n  lower bound on its force at the end: without a force nothing could vibrate"""
        device, rows = self.run_scene(scene, duration_s, "observe", more)
        tick_s = (rows[-1]["time_s"] - rows[0]["time_s"]) / (len(rows) - 1)
        held = buzz(rows, tick_s, held_s)
        pressing = math.hypot(*(rows[-1][f"force_{axis}_n"] for axis in "xyz"))
        figures = {"scene": scene, "least_energy_j": device["port_least_energy_j"],
                   "work_j": device["port_work_j"], "buzz_n": device["buzz_above_30_hz_rms_n"],
                   "held_buzz_n": held, "held_force_n": pressing}
        controlled, _ = self.run_scene(scene, duration_s, "control", more)
        figures["control_share"] = (controlled["passivity_controller_dissipated_j"] /
                                    max(controlled["port_work_j"], 1e-12))
        figures["controlled_least_energy_j"] = controlled["port_least_energy_j"]
        line = json.dumps(figures)
        print(line, flush=True)
        if file := os.environ.get("PALPATE_FIGURES"):
            with open(file, "a") as out:
                out.write(line + "\n")
        self.assertGreater(device["port_work_j"], 1e-5, "the hand felt something")
        if pressing_n is not None:
            self.assertGreater(pressing, pressing_n, "it holds something")
        with self.subTest("passive"):
            self.assertGreaterEqual(figures["least_energy_j"], least_j)
        with self.subTest("buzz"):
            self.assertLess(held, buzz_n)
        with self.subTest("control"):
            self.assertLessEqual(figures["control_share"], share)
        return figures


class Short(Scenes):
    """Part of every test run, with a small scene."""

    def test_press_ball(self):
        # held from the second keyframe on: the others are left out
        held = ("device.keyframe=[{time_s=0.0, position_m=[0,0,0.082]}, "
                "{time_s=0.13, position_m=[0,0,0.072]}]",
                "integrator.name=linearly-implicit-euler", "integrator.step_s=0.01")
        figures = self.check("press-ball", 1.5, 1.2, held)
        self.assertGreater(figures["held_force_n"], 0.3)

    def test_the_filter_passes_what_it_should(self):
        tick_s = 1e-3
        for hz, gain in (10.0, 0.012), (30.0, math.sqrt(0.5)), (100.0, 1.0):
            rows = [{"time_s": i * tick_s, "force_x_n": math.sin(2 * math.pi * hz * i * tick_s),
                     "force_y_n": 5.0, "force_z_n": 0.0} for i in range(4000)]
            self.assertAlmostEqual(buzz(rows, tick_s, 2.0) * math.sqrt(2), gain, delta=5e-3)


class Slow(Scenes):
    BONES = {"upper_arm_left": 7, "forearm_left": 9, "forearm_right": 10}

    def angles(self, run):
        """Returns the rotation of the bones at the end [degrees]."""
        with (self.folder / run / "bones.csv").open() as lines:
            rows = list(csv.DictReader(lines))

        def quaternion(row):
            v = [float(row[f"rotation_{axis}_rad"]) for axis in "xyz"]
            angle = math.hypot(*v)
            s = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.5
            return [math.cos(0.5 * angle)] + [s * one for one in v]

        out = {}
        for name, number in self.BONES.items():
            own = [row for row in rows if int(row["bone"]) == number]
            same = abs(sum(a * b for a, b in zip(quaternion(own[0]), quaternion(own[-1]))))
            out[name] = 0.0 if same >= 1.0 - 1e-15 else math.degrees(2.0 * math.acos(same))
        return out

    def test_touch_head(self):
        self.check("touch-head")

    def test_touch_human(self):
        self.check("touch-human")

    def test_posable_human(self):
        # the finger stays: the arm comes to rest against it at its farthest position
        figures = self.check("posable-human", more=(
            "device.keyframe=[{time_s=0.0, position_m=[0.368,0.075,1.03]}, "
            "{time_s=0.9, position_m=[0.368,-0.045,1.03]}]",))
        self.assertGreater(figures["held_force_n"], 0.5)
        angles = self.angles("posable-human-observe")
        self.assertGreater(angles["forearm_left"], 8.0)
        self.assertGreater(angles["upper_arm_left"], 3.0)
        self.assertEqual(angles["forearm_right"], 0.0)

    def test_scrape_pumpkin(self):
        self.check("scrape-pumpkin")

    def test_pumpkin_in_hand(self):
        # held from the second keyframe on: the others are left out
        self.check("pumpkin-in-hand", more=("device.keyframe=[{time_s=0.0, position_m=[0,0,0.092]}, "
                                            "{time_s=0.4, position_m=[0,0,0.072]}]",))

    def test_head_in_hand(self):
        # held cheek to cheek
        self.check("head-in-hand", more=("device.keyframe=[{time_s=0.0, position_m=[0.07,-0.008,-0.04]}, "
                                         "{time_s=0.4, position_m=[0.055,-0.008,-0.04]}]",))

    def test_gear_in_hand(self):
        # held against the teeth
        at = "position_m=[-0.094,0,0]"
        self.check("gear-in-hand", more=(
            "device.keyframe=[{time_s=0.0, position_m=[-0.098,0,0]}, {time_s=0.2, " + at + "}, "
            "{time_s=0.6, " + at + ", rotation_vector_rad=[0,0,-0.12]}]",))

    def test_press_stack(self):
        # held from the second keyframe on: the others are left out
        self.check("press-stack", more=("device.keyframe=[{time_s=0.0, position_m=[0,0,0.081]}, "
                                        "{time_s=0.15, position_m=[0,0,0.071]}]",))

    def test_squeeze_ball(self):
        self.check("squeeze-ball", pressing_n=None)  # it releases the ball

    def test_two_heads(self):
        self.run_scene("two-heads", 10.0, "observe")

    def test_two_pumpkins(self):
        self.run_scene("two-pumpkins", 10.0, "observe")

    def test_gears(self):
        self.run_scene("gears", 10.0, "observe")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:], verbosity=2)
