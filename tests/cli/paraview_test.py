#!/usr/bin/env python3
"""ParaView opens runs and exports as time series, and shows the run's content. Skipped where ParaView is not
installed (Debian package paraview with python3-paraview: large, and not otherwise needed).

    paraview_test.py PROGRAM
"""
import json
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"{missing}: what ParaView shows is not checked")
    sys.exit(77)

PROGRAM = Path(sys.argv[1]).resolve()
PROBE = Path(__file__).resolve().parent / "paraview_probe.py"
PVPYTHON = shutil.which("pvpython")
if not PVPYTHON:
    print("pvpython is missing (apt-get install paraview python3-paraview): nothing is checked")
    sys.exit(77)
TEMPORAL_VTKHDF = [5, 12]  # first ParaView that reads its steps


class ParaView(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="palpate-paraview-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.call("run", "press-ball", "--duration-s", "0.1", "-o", "run")
        cls.call("export", "run", "--to", "vtu")
        cls.call("export", "run", "--to", "ply", "--no-skin")
        with h5py.File(cls.folder / "run/run.vtkhdf") as file:
            cls.times = file["VTKHDF/Steps/Values"][()].tolist()
            n = int(file["VTKHDF/NumberOfPoints"][0])
            cls.points = file["VTKHDF/Points"][()].reshape(-1, n, 3)
            cls.speed_x = file["VTKHDF/PointData/velocity"][:, 0].reshape(-1, n)
            cls.stress = file["VTKHDF/PointData/stress"][()].reshape(-1, n)
            cls.cells = int(file["VTKHDF/NumberOfCells"][0])
        files = {"XDMFReader": "run.xdmf", "Xdmf3ReaderS": "run.xdmf", "Xdmf3ReaderT": "run.xdmf",
                 "any": "run.xdmf", "VTKHDFReader": "run.vtkhdf", "PVDReader": "vtu/run.pvd",
                 "PLYReader": "ply/run_0010.ply"}
        done = subprocess.run([PVPYTHON, str(PROBE), *(f"{reader}:{cls.folder / 'run' / name}"
                                                       for reader, name in files.items())],
                              capture_output=True, text=True, timeout=600, check=False)
        lines = [line for line in done.stdout.splitlines() if line.startswith("SHOWN ")]
        if not lines:
            raise AssertionError(done.stdout + done.stderr)
        shown = json.loads(lines[0][len("SHOWN "):])
        cls.version, cls.said = shown["version"], done.stderr
        cls.shown = {one["reader"]: one for one in shown["files"]}
        print(f"ParaView {cls.version[0]}.{cls.version[1]}")

    @classmethod
    def call(cls, *arguments):
        subprocess.run([str(PROGRAM), *arguments], check=True, cwd=cls.folder, stdout=subprocess.DEVNULL)

    def expect_state(self, grids, step):
        self.assertEqual(sum(grid["points"] for grid in grids), self.points.shape[1])
        self.assertEqual(sum(grid["cells"] for grid in grids), self.cells)
        bounds = np.array([grid["bounds"] for grid in grids])
        points = self.points[step]
        np.testing.assert_allclose(bounds[:, ::2].min(axis=0), points.min(axis=0), rtol=0, atol=1e-15)
        np.testing.assert_allclose(bounds[:, 1::2].max(axis=0), points.max(axis=0), rtol=0, atol=1e-15)
        for grid in grids:
            self.assertEqual(set(grid["point_data"]), {"displacement", "velocity", "stress"})
            self.assertEqual(set(grid["cell_data"]), {"body"})
            self.assertEqual([grid["point_data"][name][0] for name in ("displacement", "velocity", "stress")],
                             [3, 3, 1])
        for name, values in (("velocity", self.speed_x), ("stress", self.stress)):
            self.assertEqual(min(grid["point_data"][name][1] for grid in grids), values[step].min())
            self.assertEqual(max(grid["point_data"][name][2] for grid in grids), values[step].max())

    def expect_series(self, reader):
        one = self.shown[reader]
        self.assertEqual(len(one["times"]), 11)
        np.testing.assert_allclose(one["times"], self.times, rtol=0, atol=1e-12)
        self.assertEqual(sorted(map(int, one["steps"])), [0, 5, 10])
        for step, grids in one["steps"].items():
            self.expect_state(grids, int(step))

    def test_the_run_moves(self):
        self.assertGreater(abs(self.points[10] - self.points[0]).max(), 1e-3)
        self.assertGreater(abs(self.points[5] - self.points[0]).max(), 1e-4)

    def test_sidecar_is_a_time_series_for_each_reader(self):
        for reader in ("any", "XDMFReader", "Xdmf3ReaderS", "Xdmf3ReaderT"):
            with self.subTest(reader=reader):
                self.expect_series(reader)
                self.assertEqual(len(self.shown[reader]["steps"]["0"]), 2, "a block a part")

    def test_exported_collection_is_a_time_series(self):
        self.expect_series("PVDReader")

    def test_no_error_is_shown(self):
        self.assertNotIn("ERR|", self.said)
        self.assertNotIn("unrecognized", self.said)

    def test_run_file(self):
        if self.version >= TEMPORAL_VTKHDF:
            self.expect_series("VTKHDFReader")
            return
        print("this ParaView knows no steps of VTKHDF: of run.vtkhdf only the first state is checked")
        self.assertEqual(self.shown["VTKHDFReader"]["times"], [])
        self.expect_state(self.shown["VTKHDFReader"]["steps"]["0"], 0)

    def test_exported_surface(self):
        ply, = self.shown["PLYReader"]["steps"]["0"]
        bounds = np.array(ply["bounds"])
        np.testing.assert_allclose(bounds[::2], self.points[10].min(axis=0), rtol=0, atol=1e-7)
        np.testing.assert_allclose(bounds[1::2], self.points[10].max(axis=0), rtol=0, atol=1e-7)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
