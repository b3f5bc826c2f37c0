#!/usr/bin/env python3
"""Every scene that is part of palpate records the files that README.md states for a run: the states of its
bodies, the force on each hand, a summary and the scene. The settings for this are checked in all scenes;
scenes without a model, which takes minutes to make, are run.

    scenes_test.py PROGRAM
"""
import csv
import json
import subprocess
import sys
import tempfile
import tomllib
import unittest
from pathlib import Path

import h5py

PROGRAM = Path(sys.argv[1]).resolve()
SCENES = sorted((Path(__file__).resolve().parents[2] / "scenes").glob("*.toml"))


def tools_of(scene):
    """Returns the names of the files with the forces on the hands."""
    return ["force.csv"] * ("tool" in scene) + [f"force-{hand['name']}.csv" for hand in scene.get("hand", [])]


def needs_model(scene):
    meshes = [body.get("mesh", {}) for body in scene.get("body", [])] + [scene.get("tool", {}).get("mesh",
                                                                                                   {})]
    return any(mesh.get("file", "").startswith("model:") for mesh in meshes)


class Scenes(unittest.TestCase):
    def test_every_scene_records_states_and_forces(self):
        self.assertGreaterEqual(len(SCENES), 23)
        for path in SCENES:
            with self.subTest(path.stem):
                scene = tomllib.loads(path.read_text())
                self.assertIn("record", scene, "a run of it would keep nothing")
                record = scene["record"]
                self.assertTrue(record.get("states", True))
                self.assertTrue(record.get("forces", True))
                self.assertGreaterEqual(scene["scene"]["duration_s"],
                                        5 * record.get("state_period_s", 0.02), "a movement has states")

    def test_a_run_keeps_what_the_readme_promises(self):
        ran = 0
        for path in SCENES:
            scene = tomllib.loads(path.read_text())
            if needs_model(scene):
                continue
            ran += 1
            with self.subTest(path.stem), tempfile.TemporaryDirectory() as folder:
                duration_s = 2 * scene["record"].get("state_period_s", 0.02)
                done = subprocess.run([str(PROGRAM), "run", path.stem, "--duration-s", str(duration_s),
                                       "-o", folder], capture_output=True, text=True, timeout=300)
                self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                kept = {one.name for one in Path(folder).iterdir()}
                self.assertLessEqual({"run.vtkhdf", "summary.json", "scene.toml", *tools_of(scene)}, kept)
                summary = json.loads((Path(folder) / "summary.json").read_text())
                self.assertEqual(summary["outcome"], "finished")
                with h5py.File(Path(folder) / "run.vtkhdf") as states:
                    steps = states["VTKHDF/Steps"]
                    self.assertGreaterEqual(steps.attrs["NSteps"], 2)
                    self.assertAlmostEqual(steps["Values"][-1], duration_s, places=9)
                for name in tools_of(scene):
                    with (Path(folder) / name).open() as lines:
                        times = [float(row["time_s"]) for row in csv.DictReader(lines)]
                    self.assertAlmostEqual(times[-1], duration_s, places=9)
                    self.assertGreater(len(times), 10)
        self.assertGreaterEqual(ran, 10)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
