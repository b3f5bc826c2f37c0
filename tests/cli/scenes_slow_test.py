#!/usr/bin/env python3
"""The scenes of the paper, each by its name to its end: something presses, nothing goes through unseen.

    scenes_slow_test.py PROGRAM

Their models are made on first use; PALPATE_MODELS, where it is set, keeps them.  Prints simulated over loop
time of each.
"""
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
SCENES = {"touch-head": True, "touch-human": True, "two-heads": False, "two-pumpkins": False, "gears": False,
          "scrape-pumpkin": True}  # and whether a hand feels it


class Scenes(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory(prefix="palpate-scenes-")
        cls.models = os.environ.get("PALPATE_MODELS", str(Path(cls.folder.name) / "models"))

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def numbers(self, table):
        for key, value in table.items():
            if isinstance(value, dict):
                yield from self.numbers(value)
            elif isinstance(value, float):
                yield key, value

    def test_each_runs_to_its_end(self):
        for scene, has_tool in SCENES.items():
            with self.subTest(scene):
                out = Path(self.folder.name) / scene
                done = subprocess.run([str(PROGRAM), "run", scene, "-o", str(out)], capture_output=True,
                                      text=True, timeout=1200, stdin=subprocess.DEVNULL,
                                      env=dict(os.environ, PALPATE_MODELS=self.models))
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertNotIn("went through", done.stderr)
                figures = json.loads((out / "summary.json").read_text())["figures"]
                for key, value in self.numbers(figures):
                    self.assertTrue(math.isfinite(value), key)
                contact, times = figures["contact"], figures["timings"]
                self.assertGreater(contact["pixels_seen"], 1000)
                self.assertGreater(contact["largest_force_after_a_query_n"], 0.01)
                self.assertEqual(sum(figures["tunnelled"].values()), 0)
                self.assertTrue(figures["models"])
                if has_tool:
                    self.assertGreater(figures["counts"]["ticks"], 100)
                print(f"{scene}: {times['simulated_s'] / times['loop_wall_s']:.2f} simulated over loop time, "
                      f"largest force {contact['largest_force_after_a_query_n']:.3g} N", flush=True)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
