#!/usr/bin/env python3
"""`palpate model` as a person meets it: outcome, messages, the same bytes again; and palpate itself links none of it."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PALPATE = sys.argv.pop(1)


def run(*words, cwd=None):
    return subprocess.run([PALPATE, *map(str, words)], capture_output=True, text=True, cwd=cwd, timeout=300)


def octahedron(folder, name="body.obj", faces=None):
    """A bipyramid with a square waist: eight faces, four vertices and two tips."""
    faces = faces or [(1, 2, 5), (2, 3, 5), (3, 4, 5), (4, 1, 5), (2, 1, 6), (3, 2, 6), (4, 3, 6), (1, 4, 6)]
    points = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    path = Path(folder) / name
    path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in points) + "".join(f"f {a} {b} {c}\n" for a, b, c in faces))
    return path


def scene_of(model, more=""):
    """One body of a model's file, and what else is said of it."""
    return f"""
[scene]
name = "body"
duration_s = 0.002
[[body]]
name = "body"
youngs_modulus_pa = 1e5
density_kg_m3 = 1000.0
mesh = {{ file = "{model}" }}
{more}
[integrator]
name = "linearly-implicit-euler"
step_s = 0.001
"""


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = Path(self.folder.name)

    def test_outcome_and_the_same_bytes_again(self):
        source = octahedron(self.path)
        options = ["--tetrahedra", "600", "--proxies", "8"]
        done = run("model", source, "-o", self.path / "a.h5", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        for word in ("smallest dihedral angle [deg]", "volume error [%]", "worst aspect ratio", "fill with tetrahedra", "peak memory", "written:"):
            self.assertIn(word, done.stdout)
        self.assertEqual(done.stderr, "")  # no terminal: no bar
        again = run("model", source, "-o", self.path / "b.h5", *options)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.path / "a.h5").read_bytes(), (self.path / "b.h5").read_bytes())
        count = int(next(line for line in done.stdout.splitlines() if line.startswith("tetrahedra")).split()[-1])
        self.assertAlmostEqual(count, 600, delta=18)

    def test_a_scene_takes_the_model(self):
        source = octahedron(self.path)
        self.assertEqual(run("model", source, "-o", self.path / "body.h5", "--tetrahedra", "600", "-q").returncode, 0)
        (self.path / "scene.toml").write_text(scene_of("body.h5"))
        done = run("inspect", self.path / "scene.toml")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_default_output_stands_here(self):
        source = octahedron(self.path)
        self.assertEqual(run("model", source, "--tetrahedra", "600", "-q", cwd=self.path).returncode, 0)
        self.assertTrue((self.path / "body.h5").exists())

    def test_messages(self):
        open_body = octahedron(self.path, "open.obj", [(1, 2, 5), (2, 3, 5), (3, 4, 5), (4, 1, 5)])
        for words, expected in [
            ((open_body,), "the surface is open there: a hole of 4 edges"),
            ((self.path / "none.obj",), "none.obj: no such file"),
            ((open_body, "--tetrahedra", "many"), "--tetrahedra"),
            ((open_body, "--creases", "some"), "--creases some: must be auto, none, or an angle in degrees"),
            ((open_body, "--tetrahedra", "500", "--element-size-m", "1"), "excludes"),
            ((open_body, "--picture", "a.jpg"), "pictures are PNG files"),
            ((open_body, "--scale", "-1"), "-1 must be a positive, finite number"),
        ]:
            done = run("model", *words, "-o", self.path / "out.h5")
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("palpate: error: ", done.stderr)
            self.assertIn(expected, done.stderr)
            self.assertFalse((self.path / "out.h5").exists())

    def test_regions_from_the_surface_to_the_scene(self):
        source = octahedron(self.path)
        core = octahedron(self.path, "core.obj")
        core.write_text("".join(f"v {' '.join(str(0.5 * float(x)) for x in line.split()[1:])}\n" if line.startswith("v") else line + "\n" for line in core.read_text().splitlines()))
        options = ["--tetrahedra", "3000", "--proxies", "0", "--region", f"core={core}"]
        done = run("model", source, "-o", self.path / "a.h5", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        row = next(line for line in done.stdout.splitlines() if line.startswith("core"))
        volume, wanted = (float(word) for word in row.split()[2:4])
        self.assertAlmostEqual(wanted, 4 / 3 / 8, places=6)  # an octahedron of unit radius has 4/3
        self.assertLess(abs(volume / wanted - 1), 0.1)
        self.assertEqual(run("model", source, "-o", self.path / "b.h5", *options, "-q").returncode, 0)
        self.assertEqual((self.path / "a.h5").read_bytes(), (self.path / "b.h5").read_bytes())
        (self.path / "named.toml").write_text(scene_of("a.h5", '[[body.region]]\nname = "core"\nyoungs_modulus_pa = 1e7\ndensity_kg_m3 = 3000.0'))
        (self.path / "silent.toml").write_text(scene_of("a.h5"))
        named = run("inspect", self.path / "named.toml")
        self.assertEqual(named.returncode, 0, named.stderr)
        row = next(line for line in named.stdout.splitlines() if " core " in line)
        self.assertIn("its own", row)
        self.assertIn("1e+07", row)
        silent = run("inspect", self.path / "silent.toml")
        self.assertIn("the body's", next(line for line in silent.stdout.splitlines() if " core " in line))
        self.assertIn("does not name it: core of a.h5", silent.stderr + silent.stdout)
        for words, expected in [((source, "--region", "core"), "--region core: must be NAME=FILE"), ((source, "--region", "core=none.obj"), "none.obj: no such file"),
                                ((source, "--region", "bone=skeleton"), "the model has no bones")]:
            done = run("model", *words, "-o", self.path / "out.h5", "--tetrahedra", "600")
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(expected, done.stderr)

    def test_help(self):
        self.assertIn("--tetrahedra", run("model", "--help").stdout)
        self.assertIn("model", run("--help").stdout)

    def test_palpate_links_and_loads_nothing_of_it(self):
        linked = subprocess.run(["ldd", PALPATE], capture_output=True, text=True).stdout.lower()
        symbols = subprocess.run(["nm", "-DC", "--undefined-only", PALPATE], capture_output=True, text=True).stdout
        for library in ("cgal", "gmsh", "mpfr", "pugixml", "qhull"):
            self.assertNotIn(library, linked)
        symbols += subprocess.run(["nm", "-C", PALPATE], capture_output=True, text=True).stdout
        self.assertIn("palpate::", symbols)
        self.assertEqual([line for line in symbols.splitlines() if any(word in line for word in ("CGAL::", "gmshOpen", "gmshInitialize", "mpfr_"))], [])
        own = subprocess.run(["ldd", str(Path(PALPATE).parent / "palpate-model")], capture_output=True, text=True).stdout.lower()
        self.assertNotIn("gmsh", own)  # opened when a file needs it
        self.assertIn("gmp", own)


if __name__ == "__main__":
    unittest.main()
