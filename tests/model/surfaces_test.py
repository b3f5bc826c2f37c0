#!/usr/bin/env python3
"""Third-party surfaces, and the paper's, become models without any option, within the acceptance limits of
quality, and with reproducible output.

    surfaces_test.py PROGRAM [Class.test ...]      real surfaces are skipped without PALPATE_TEST_DATA
"""
import os
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

PALPATE = sys.argv.pop(1)
DATA = os.environ.get("PALPATE_TEST_DATA")


def figures_of(text):
    out = {}
    for line in text.splitlines():
        words = line.rsplit(maxsplit=1)
        if len(words) == 2:
            out[words[0].strip()] = words[1]
    return out


class Models(unittest.TestCase):
    def make(self, source, dihedral=8.0):
        with tempfile.TemporaryDirectory() as folder:
            files = []
            for name in ("a.h5", "b.h5"):
                start = time.monotonic()
                done = subprocess.run([PALPATE, "model", source, "-o", f"{folder}/{name}"],
                                      capture_output=True, text=True, timeout=600)
                print(f"{source}: {time.monotonic() - start:.1f} s")
                self.assertEqual(done.returncode, 0, done.stderr)
                files.append(Path(folder, name).read_bytes())
            self.assertEqual(files[0], files[1])
        print(done.stdout)
        figures = figures_of(done.stdout)
        self.assertGreaterEqual(float(figures["smallest dihedral angle [deg]"]), dihedral)
        self.assertLessEqual(float(figures["volume error [%]"]), 1.0)
        return figures


@unittest.skipUnless(DATA, "PALPATE_TEST_DATA is not set: real surfaces are not tested")
class RealSurfaces(Models):
    def make_file(self, name):
        self.assertAlmostEqual(float(self.make(str(Path(DATA) / name))["tetrahedra"]), 10000, delta=300)

    def test_spot(self):
        self.make_file("spot.obj")

    def test_femur(self):
        self.make_file("femur.obj")

    def test_patella(self):
        self.make_file("patella.obj")

    def test_liver(self):
        self.make_file("liver-smooth.obj")


class Shapes(Models):
    def test_head(self):
        self.assertGreaterEqual(int(self.make("head")["tetrahedra"]), 10000)

    def test_pumpkin(self):
        self.assertGreaterEqual(int(self.make("pumpkin")["tetrahedra"]), 10000)

    def test_gear(self):
        self.assertGreaterEqual(int(self.make("gear", dihedral=4.0)["tetrahedra"]), 20000)


if __name__ == "__main__":
    unittest.main()
