#!/usr/bin/env python3
"""`palpate export`: the content of each format equals the recorded run; rejected requests, and files left by
them.

    export_test.py PROGRAM
"""
import csv
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

try:
    import h5py
    import numpy as np
except ImportError:  # package python3-h5py
    sys.exit("python3-h5py is missing")

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "store"))
import foreign

PROGRAM = Path(sys.argv[1]).resolve()


class Run:
    """A run file, read by h5py only."""

    def __init__(self, path):
        with h5py.File(path) as file:
            self.steps = int(file["VTKHDF/Steps"].attrs["NSteps"])
            self.times = file["VTKHDF/Steps/Values"][:self.steps]
            n = int(file["VTKHDF/NumberOfPoints"][0])
            self.all_points = file["VTKHDF/Points"][:self.steps * n].reshape(self.steps, n, 3)
            data = file["VTKHDF/PointData"]
            self.velocity = data["velocity"][:self.steps * n].reshape(self.steps, n, 3)
            self.displacement = data["displacement"][:self.steps * n].reshape(self.steps, n, 3)
            self.stress = data["stress"][:self.steps * n].reshape(self.steps, n)
            self.parts, first = {}, 0
            for i in range(int(file["palpate/parts"].attrs["count"])):
                part = file[f"palpate/parts/{i}"]
                size = len(part["reference"])
                self.parts[part.attrs["name"].decode()] = slice(first, first + size)
                first += size

    def points(self, name, step):
        return self.all_points[step, self.parts[name]]


class Export(unittest.TestCase):
    """Runs are made once; each test exports into a separate folder."""

    @classmethod
    def setUpClass(cls):
        cls.runs = Path(tempfile.mkdtemp(prefix="palpate-export-runs-"))
        cls.addClassCleanup(shutil.rmtree, cls.runs)
        cls.ball = cls.make("ball", "press-ball", "--duration-s", "0.1")

    @classmethod
    def make(cls, name, scene, *options):
        subprocess.run([PROGRAM, "run", scene, *options, "-o", cls.runs / name], check=True,
                       stdout=subprocess.DEVNULL)
        return Run(cls.runs / name / "run.vtkhdf")

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-export-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def call(self, *arguments, **options):
        return subprocess.run([str(PROGRAM), "export", *map(str, arguments)], capture_output=True, text=True,
                              cwd=self.folder, timeout=300, stdin=subprocess.DEVNULL, **options)

    def good(self, run, *arguments):
        done = self.call(self.runs / run, *arguments, "-o", "out")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(done.stderr, "")
        self.said = done.stdout
        return sorted(path.name for path in (self.folder / "out").iterdir())

    def refused(self, *arguments, **options):
        done = self.call(*arguments, **options)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def out(self, name):
        return self.folder / "out" / name


class Contents(Export):
    def test_sidecar_of_a_run_shows_the_run(self):
        steps = foreign.read_xdmf(self.runs / "ball/run.xdmf")
        self.assertEqual(len(steps), self.ball.steps)
        self.assertGreater(len(steps), 5)
        for step, shown in enumerate(steps):
            self.assertEqual(shown["time"], self.ball.times[step])
            self.assertEqual([grid["name"] for grid in shown["grids"]], list(self.ball.parts))
            for grid in shown["grids"]:
                np.testing.assert_array_equal(grid["points"], self.ball.points(grid["name"], step))
        self.assertGreater(abs(steps[-1]["grids"][1]["points"] - steps[0]["grids"][1]["points"]).max(), 1e-4)

    def test_vtu(self):
        names = self.good("ball", "--to", "vtu")
        self.assertEqual(names, sorted([f"run_{i:04}.vtu" for i in range(self.ball.steps)] + ["run.pvd"]))
        self.assertIn(f"{len(names)} files", self.said)
        series = foreign.read_pvd(self.out("run.pvd"))
        self.assertEqual(series, [(t, f"run_{i:04}.vtu") for i, t in enumerate(self.ball.times)])
        for step, (time_s, name) in enumerate(series):
            file = foreign.read_vtu(self.out(name))
            self.assertEqual(file["time"], time_s)
            np.testing.assert_array_equal(file["Points"], self.ball.all_points[step])
            np.testing.assert_array_equal(file["velocity"], self.ball.velocity[step])
            np.testing.assert_array_equal(file["stress"], self.ball.stress[step])
        self.assertEqual(set(file["types"]), {10, 5})

    def test_obj_of_one_body_is_its_boundary(self):
        names = self.good("ball", "--to", "obj", "--body", "ball", "--every", "5")
        self.assertEqual(names, ["run_0000.obj", "run_0005.obj", "run_0010.obj"])
        for step in (0, 5, 10):
            ball, = foreign.read_obj(self.out(f"run_{step:04}.obj"))
            self.assertEqual(ball["name"], "ball")
            nodes = {tuple(p) for p in self.ball.points("ball", step)}
            self.assertTrue(all(tuple(p) in nodes for p in ball["points"]), "to the last bit")
            self.check_closed(ball["faces"], len(ball["points"]))
            self.assertGreater(volume(ball["points"], ball["faces"]), 0, "faces look outwards")

    def check_closed(self, faces, count):
        edges = [(int(f[a]), int(f[b])) for f in faces for a, b in ((0, 1), (1, 2), (2, 0))]
        self.assertEqual(len(edges), len(set(edges)))
        self.assertEqual(set(edges), {(b, a) for a, b in edges})
        self.assertEqual(count - len(edges) // 2 + len(faces), 2, "Euler: a sphere")

    def test_one_range_of_colours_for_all_states(self):
        self.good("ball", "--to", "ply", "--body", "ball")
        first, last = (foreign.read_ply(self.out(f"run_{step:04}.ply"))["vertices"] for step in (0, 10))
        self.assertEqual(len({tuple(v) for v in first[["red", "green", "blue"]]}), 1, "nothing has moved yet")
        self.assertGreater(len({tuple(v) for v in last[["red", "green", "blue"]]}), 10)

    def test_rounding_has_no_colours(self):
        self.good("ball", "--to", "ply", "--body", "ball", "--step", "1")
        ball = foreign.read_ply(self.out("run_0001.ply"))["vertices"]
        self.assertLess(ball["displacement"].max(), 1e-12, "the tool does not touch it yet")
        self.assertEqual(len({tuple(v) for v in ball[["red", "green", "blue"]]}), 1)

    def test_csv(self):
        names = self.good("ball", "--to", "csv", "--every", "2")
        self.assertEqual(names, ["force.csv", "nodes.csv"])
        self.assertEqual(self.out("force.csv").read_bytes(), (self.runs / "ball/force.csv").read_bytes())
        with open(self.out("nodes.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        kept = range(0, self.ball.steps, 2)
        self.assertEqual(len(rows), len(kept) * self.ball.all_points.shape[1])
        at = 0
        for step in kept:
            for part, where in self.ball.parts.items():
                for node, i in enumerate(range(where.start, where.stop)):
                    row, at = rows[at], at + 1
                    self.assertEqual((float(row["time_s"]), int(row["state"]), row["part"], int(row["node"])),
                                     (self.ball.times[step], step, part, node))
                    for axis, key in enumerate("xyz"):
                        self.assertEqual(float(row[f"{key}_m"]), self.ball.all_points[step, i, axis])
                        self.assertEqual(float(row[f"velocity_{key}_m_s"]), self.ball.velocity[step, i, axis])
                    self.assertEqual(float(row["stress_pa"]), self.ball.stress[step, i])

    def test_gltf_is_an_animation(self):
        self.assertEqual(self.good("ball", "--to", "gltf", "--no-skin"), ["run.glb"])
        scene = foreign.Gltf(self.out("run.glb"))
        np.testing.assert_allclose(scene.times(), self.ball.times, atol=1e-7)
        for key in range(self.ball.steps):
            tool = foreign.z_up(scene.shown("tool", key))
            np.testing.assert_allclose(tool, self.ball.points("tool", key), atol=2e-7)
            nodes = self.ball.points("ball", key)
            for p in foreign.z_up(scene.shown("ball", key))[::7]:
                self.assertLess(np.linalg.norm(nodes - p, axis=1).min(), 2e-7)
        moved = scene.shown("ball", 10) - scene.shown("ball", 0)
        self.assertGreater(abs(moved).max(), 1e-4)

    def test_gltf_of_one_state_stands_still(self):
        self.good("ball", "--to", "gltf", "--at", "0.02")
        self.assertRegex(self.said, r"state 2, t = 0\.02 s")
        self.assertNotIn("animations", foreign.Gltf(self.out("run.glb")).json)

    def test_gltf_is_thinned_and_says_so(self):
        subprocess.run([PROGRAM, "run", "one-tet", "--duration-s", "2.5", "-o", self.folder / "long"],
                       check=True, stdout=subprocess.DEVNULL)
        done = self.call("long", "--to", "gltf")
        self.assertIn("100 of 251 states", done.stdout)
        times = foreign.Gltf(self.folder / "long/gltf/run.glb").times()
        self.assertEqual((len(times), times[0]), (100, 0))
        self.assertAlmostEqual(times[-1], 2.5, delta=1e-6)
        self.assertLess(np.diff(times).max(), 0.031)

    def test_modes(self):
        subprocess.run([PROGRAM, "modes", "one-tet", "--count", "3", "-o", self.folder / "modes"], check=True,
                       stdout=subprocess.DEVNULL)
        self.assertEqual(len(foreign.read_xdmf(self.folder / "modes/modes.xdmf")), 3)
        done = self.call("modes/modes.vtkhdf", "--to", "vtu")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([t for t, _ in foreign.read_pvd(self.folder / "modes/vtu/modes.pvd")], [1, 2, 3])

    def test_nearest_state(self):
        for at, step in ((0.024, 2), (0.026, 3), (0, 0), (0.1, 10)):
            self.assertEqual(self.good("ball", "--to", "obj", "--at", at), [f"run_{step:04}.obj"])

    def test_an_earlier_export_does_not_pass_for_this_one(self):
        self.good("ball", "--to", "obj")
        self.out("mine.obj").write_text("of somebody else")
        self.out("other_0001.obj").write_text("of somebody else")
        self.assertEqual(self.good("ball", "--to", "obj", "--every", "5"),
                         ["mine.obj", "other_0001.obj", "run_0000.obj", "run_0005.obj", "run_0010.obj"])


class Skin(Export):
    """A body that has a skin, which requires a model."""

    @classmethod
    def setUpClass(cls):
        if not (PROGRAM.parent / "palpate-model").exists():
            raise unittest.SkipTest("palpate-model is not built")
        super().setUpClass()
        cls.skin = cls.make("skin", "squeeze-ball", "--duration-s", "0.1")

    def test_skin_where_there_is_one(self):
        self.good("skin", "--to", "ply", "--step", "10")
        skin = foreign.read_ply(self.out("run_0010.ply"))
        self.good("skin", "--to", "ply", "--step", "10", "--no-skin")
        tets = foreign.read_ply(self.out("run_0010.ply"))
        self.assertEqual(skin["comments"][1:], [f"object {i} is {n}" for i, n in enumerate(self.skin.parts)])
        body = [file["vertices"][file["vertices"]["object"] == 0] for file in (skin, tets)]
        self.assertGreater(len(body[0]), 2 * len(body[1]), "the skin is the finer one")
        name = list(self.skin.parts)[0]
        points = self.skin.points(name, 10)
        for vertices in body:
            for axis, key in enumerate("xyz"):
                size = np.ptp(points[:, axis])
                self.assertAlmostEqual(vertices[key].min(), points[:, axis].min(), delta=0.05 * size)
                self.assertAlmostEqual(vertices[key].max(), points[:, axis].max(), delta=0.05 * size)
        moved = np.linalg.norm(self.skin.displacement[10, self.skin.parts[name]], axis=1).max()
        self.assertGreater(moved, 1e-3)
        self.assertAlmostEqual(body[1]["displacement"].max(), moved, delta=1e-6 * moved)
        self.assertGreater(len(set(body[0]["green"])), 10, "colours follow the displacement")


class Refusals(Export):
    def nothing_left(self):
        self.assertEqual(list(self.folder.iterdir()), [])

    def test_messages(self):
        ball = self.runs / "ball"
        self.assertIn('--to: unknown "gtlf" (did you mean "gltf"?)', self.refused(ball, "--to", "gtlf"))
        self.assertIn("--to is required", self.refused(ball))
        self.assertIn("nowhere: no such folder", self.refused("nowhere", "--to", "vtu"))
        self.assertIn("run.vtkhdf: no such file", self.refused(self.folder, "--to", "vtu"))
        self.assertIn("cover 0 to 0.1 s", self.refused(ball, "--to", "obj", "--at", "0.11"))
        self.assertIn("cover 0 to 0.1 s", self.refused(ball, "--to", "obj", "--at", "-0.01"))
        self.assertIn("--at nan", self.refused(ball, "--to", "obj", "--at", "nan"))
        self.assertIn("the states 0 to 10", self.refused(ball, "--to", "obj", "--step", "11"))
        self.assertIn("the states 0 to 10", self.refused(ball, "--to", "obj", "--step", "-1"))
        self.assertIn('no "bal" (did you mean "ball"?)', self.refused(ball, "--to", "obj", "--body", "bal"))
        self.assertIn("excludes", self.refused(ball, "--to", "obj", "--at", "0", "--step", "1"))
        self.assertIn("--every", self.refused(ball, "--to", "obj", "--every", "0"))
        self.nothing_left()

    def test_run_without_positions(self):
        subprocess.run([PROGRAM, "run", "press-ball", "--duration-s", "0.01", "--set", "record.states=false",
                        "-o", self.folder / "forces"], check=True, stdout=subprocess.DEVNULL)
        self.assertIn("record.states = true", self.refused("forces", "--to", "vtu"))

    def test_broken_run_file(self):
        (self.folder / "bad").mkdir()
        (self.folder / "bad/run.vtkhdf").write_bytes(b"no HDF5")
        self.assertIn("is not an HDF5 file", self.refused("bad", "--to", "vtu"))
        self.assertEqual([path.name for path in (self.folder / "bad").iterdir()], ["run.vtkhdf"])

    def test_output_that_cannot_be(self):
        (self.folder / "file").write_text("")
        for output in ("file", "file/in it"):
            self.assertIn("-o DIR", self.refused(self.runs / "ball", "--to", "obj", "-o", output))
        self.assertEqual([path.name for path in self.folder.iterdir()], ["file"])

    def test_full_disk_leaves_nothing(self):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writes then fail, as on a full disk
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        for kind in ("vtu", "obj", "ply", "csv", "gltf"):
            error = self.refused(self.runs / "ball", "--to", kind, "-o", "deep/in/it", preexec_fn=limit)
            self.assertRegex(error, "full")
            self.nothing_left()

    def test_scene_that_is_gone(self):
        shutil.copytree(self.runs / "ball", self.folder / "gone")
        (self.folder / "gone/summary.json").unlink()
        with h5py.File(self.folder / "gone/run.vtkhdf", "r+") as file:
            text = file["palpate/scene"][()]
            self.assertIn(b'generator = "ball"', text)
            del file["palpate/scene"]
            file["palpate"]["scene"] = np.bytes_(text.replace(b'generator = "ball"', b'generator = "bal"'))
        error = self.refused("gone", "--to", "obj")
        self.assertIn("--no-skin", error)
        self.assertEqual(self.call("gone", "--to", "obj", "--no-skin").returncode, 0)

    def test_ctrl_c_leaves_nothing(self):
        shutil.copytree(self.runs / "ball", self.folder / "run")
        with h5py.File(self.folder / "run/run.vtkhdf", "r+") as file:  # the same state a thousand times
            steps, n = 3000, int(file["VTKHDF/NumberOfPoints"][0])
            for data, rows in ((file["VTKHDF/Steps/Values"], steps), (file["VTKHDF/Points"], n * steps),
                               *((one, n * steps) for one in file["VTKHDF/PointData"].values())):
                data.resize(rows, axis=0)
            file["VTKHDF/Steps"].attrs.modify("NSteps", steps)
        process = subprocess.Popen([PROGRAM, "export", "run", "--to", "vtu", "-o", "out/vtu"], text=True,
                                   cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        end = time.monotonic() + 60
        while not list(self.folder.glob("out/vtu/.export-*/*.vtu")):
            self.assertIsNone(process.poll(), "it ended by itself")
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, error = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        self.assertIn("nothing was exported", error)
        self.assertEqual([path.name for path in self.folder.iterdir()], ["run"])


def volume(points, faces):
    a, b, c = (points[faces[:, i]] for i in range(3))
    return (np.cross(a, b) * c).sum() / 6


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
