#!/usr/bin/env python3
"""The user interface of `palpate model`: outcome, messages, questions, Ctrl-C, the budget, reproducible
output; and palpate itself links none of it.
"""
import os
import pty
import re
import resource
import signal
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PALPATE = sys.argv.pop(1)
DATA = os.environ.get("PALPATE_TEST_DATA")
DOCUMENT = Path(__file__).parents[2] / "docs" / "models.md"


def run(*words, cwd=None):
    return subprocess.run([PALPATE, *map(str, words)], capture_output=True, text=True, cwd=cwd, timeout=300)


def octahedron(folder, name="body.obj", faces=None):
    """A bipyramid with a square waist: eight faces, four vertices and two tips."""
    faces = faces or [(1, 2, 5), (2, 3, 5), (3, 4, 5), (4, 1, 5), (2, 1, 6), (3, 2, 6), (4, 3, 6), (1, 4, 6)]
    points = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    path = Path(folder) / name
    path.write_text("".join(f"v {x} {y} {z}\n" for x, y, z in points)
                    + "".join(f"f {a} {b} {c}\n" for a, b, c in faces))
    return path


def scaled(source, name, factor):
    """Writes a scaled copy of a file of octahedron()."""
    out = source.parent / name
    out.write_text("".join(
        f"v {' '.join(str(factor * float(x)) for x in line.split()[1:])}\n" if line.startswith("v")
        else line + "\n" for line in source.read_text().splitlines()))
    return out


def flat_tetrahedra(folder):
    """The octahedron as four tetrahedra around its axis, and a fifth, flat one."""
    path = Path(folder) / "flat.msh"
    points = [(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1), (0.36, 0.36, 0.36)]
    tets = [(5, 6, 1, 2), (5, 6, 2, 3), (5, 6, 3, 4), (5, 6, 4, 1), (1, 2, 5, 7)]
    path.write_text("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n7\n"
                    + "".join(f"{i + 1} {x} {y} {z}\n" for i, (x, y, z) in enumerate(points))
                    + "$EndNodes\n$Elements\n5\n"
                    + "".join(f"{i + 1} 4 2 1 1 {a} {b} {c} {d}\n" for i, (a, b, c, d) in enumerate(tets))
                    + "$EndElements\n")
    return path


def open_terminal():
    """Returns both ends of a terminal; skips the test with a message where the machine has none (no
    /dev/pts)."""
    try:
        return pty.openpty()
    except OSError as error:
        raise unittest.SkipTest(f"this machine has no terminals: {error}") from error


class Terminal:
    """The program with a terminal for its input and messages."""

    def __init__(self, *words):
        self.leader, follower = open_terminal()
        environment = dict(os.environ, TERM="xterm")
        self.process = subprocess.Popen([PALPATE, *map(str, words)], stdin=follower, stderr=follower,
                                        stdout=subprocess.DEVNULL, env=environment)
        os.close(follower)
        self.text = ""

    def read_until(self, pattern):
        """Waits until the output matches, or the program has ended."""
        while not re.search(pattern, self.text):
            try:
                more = os.read(self.leader, 4096)
            except OSError:  # all writers have ended
                more = b""
            if not more:
                return False
            self.text += more.decode()
        return True

    def type(self, text):
        os.write(self.leader, text.encode())

    def end(self):
        self.read_until(r"\Z.\A")  # all of it
        status = self.process.wait(timeout=60)
        os.close(self.leader)
        return status


def scene_of(model, more=""):
    """Returns a scene with one body of a model file, and additional settings."""
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


class Memory(unittest.TestCase):
    def test_what_does_not_fit_is_refused_with_figures(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))
        with tempfile.TemporaryDirectory() as folder:
            command = [PALPATE, "model", str(octahedron(folder)), "--tetrahedra", "9000000", "-o", "x.h5"]
            done = subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=300,
                                  preexec_fn=limit)
            self.assertEqual(done.returncode, 1, done.stderr)
            self.assertRegex(done.stderr, r"body\.obj: 9e\+06 tetrahedra in a surface of 6 vertices need "
                                          r"about 3\.4 GiB of memory, but only \d+ MiB are available "
                                          r"\(the limit on address space, ulimit -v\); fewer "
                                          r"--tetrahedra need less")
            self.assertEqual(done.stdout, "")
            self.assertEqual(os.listdir(folder), ["body.obj"])


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
        for word in ("body: at most 600 s and 1000000 points", "smallest dihedral angle [deg]",
                     "volume error [%]", "worst aspect ratio", "fill with tetrahedra", "peak memory",
                     "written:"):
            self.assertIn(word, done.stdout)
        self.assertEqual(done.stderr, "")  # no terminal: no bar
        again = run("model", source, "-o", self.path / "b.h5", *options)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual((self.path / "a.h5").read_bytes(), (self.path / "b.h5").read_bytes())
        count = next(line for line in done.stdout.splitlines() if line.startswith("tetrahedra")).split()[-1]
        self.assertAlmostEqual(int(count), 600, delta=18)

    def test_a_scene_takes_the_model(self):
        source = octahedron(self.path)
        done = run("model", source, "-o", self.path / "body.h5", "--tetrahedra", "600", "-q")
        self.assertEqual(done.returncode, 0, done.stderr)
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
            ((open_body,), "the surface has a hole of 4 edges"),
            ((self.path / "none.obj",), "none.obj: no such file"),
            ((open_body, "--tetrahedra", "many"), "--tetrahedra"),
            ((open_body, "--creases", "some"), "--creases some: must be auto, none, or an angle in degrees"),
            ((open_body, "--tetrahedra", "500", "--element-size-m", "1"), "excludes"),
            ((open_body, "--picture", "a.jpg"), "pictures are PNG files"),
            ((open_body, "--skin-vertices", "5000"), "open.obj is a file, and its surface is the skin"),
            (("ball", "--skin-vertices", "50"), "skin_vertices = 50 must lie in [1000, 4000000]"),
            (("ball", "--skin-vertices", "-1"), "--skin-vertices"),
            ((open_body, "--scale", "-1"), "-1 must be a positive, finite number"),
        ]:
            done = run("model", *words, "-o", self.path / "out.h5")
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn("palpate: error: ", done.stderr)
            self.assertIn(expected, done.stderr)
            self.assertFalse((self.path / "out.h5").exists())

    def test_regions_from_the_surface_to_the_scene(self):
        source = octahedron(self.path)
        core = scaled(source, "core.obj", 0.5)
        options = ["--tetrahedra", "3000", "--proxies", "0", "--region", f"core={core}"]
        done = run("model", source, "-o", self.path / "a.h5", *options)
        self.assertEqual(done.returncode, 0, done.stderr)
        row = next(line for line in done.stdout.splitlines() if line.startswith("core"))
        volume, wanted = (float(word) for word in row.split()[2:4])
        self.assertAlmostEqual(wanted, 4 / 3 / 8, places=6)  # a unit octahedron has 4/3
        self.assertLess(abs(volume / wanted - 1), 0.1)
        self.assertEqual(run("model", source, "-o", self.path / "b.h5", *options, "-q").returncode, 0)
        self.assertEqual((self.path / "a.h5").read_bytes(), (self.path / "b.h5").read_bytes())
        own = '[[body.region]]\nname = "core"\nyoungs_modulus_pa = 1e7\ndensity_kg_m3 = 3000.0'
        (self.path / "named.toml").write_text(scene_of("a.h5", own))
        (self.path / "silent.toml").write_text(scene_of("a.h5"))
        named = run("inspect", self.path / "named.toml")
        self.assertEqual(named.returncode, 0, named.stderr)
        row = next(line for line in named.stdout.splitlines() if " core " in line)
        self.assertRegex(row, r"\bown\b")
        self.assertIn("1e+07", row)
        silent = run("inspect", self.path / "silent.toml")
        self.assertIn("of the body", next(line for line in silent.stdout.splitlines() if " core " in line))
        self.assertIn("the material of the body applies: core of a.h5", silent.stderr + silent.stdout)
        for words, expected in [((source, "--region", "core"), "--region core: must be NAME=FILE"),
                                ((source, "--region", "core=none.obj"), "none.obj: no such file"),
                                ((source, "--region", "bone=skeleton"), "the model has no bones")]:
            done = run("model", *words, "-o", self.path / "out.h5", "--tetrahedra", "600")
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertIn(expected, done.stderr)

    def test_ctrl_c_ends_it_at_once_and_leaves_nothing(self):
        source = octahedron(self.path)
        before = sorted(self.path.iterdir())
        model = Terminal("model", source, "-o", self.path / "a.h5", "--tetrahedra", "3000000")
        self.assertTrue(model.read_until("fill with tetrahedra"), model.text)  # the bar of this stage
        model.process.send_signal(signal.SIGINT)
        self.assertEqual(model.end(), 130)
        self.assertIn("palpate: stopped, no model was written", model.text)
        self.assertEqual(sorted(self.path.iterdir()), before)

    def test_progress_is_shown_on_a_terminal_and_grows(self):
        source = octahedron(self.path)
        model = Terminal("model", source, "-o", self.path / "a.h5", "--tetrahedra", "3000000")
        # progress within one refinement: nothing was finished yet
        self.assertTrue(model.read_until(r"\] +[2-9] %[^\r]*fill with tetrahedra"), model.text)
        model.process.send_signal(signal.SIGTERM)
        self.assertEqual(model.end(), 130)
        shares = [int(x) for x in re.findall(r"\] +(\d+) %[^\r]*fill with tetrahedra", model.text)]
        self.assertEqual(shares, sorted(shares))
        self.assertGreater(len(set(shares)), 1)
        self.assertNotIn("\\x", model.text)  # the bar's control characters reach the terminal unescaped
        self.assertIn("\r\033[K[", model.text)

    def test_the_budget_ends_it(self):
        source = octahedron(self.path)
        for words, expected in [
            (("--limit-s", "1"), r"within 1 s: .*at \(.*--limit-s"),
            (("--points", "1000"),
             r"about 6e\+05 points, more than the limit of 1000; raise it with --points"),
        ]:
            done = run("model", source, "-o", self.path / "a.h5", "--tetrahedra", "3000000", *words)
            self.assertEqual(done.returncode, 1, done.stdout)
            self.assertRegex(done.stderr, expected)
            self.assertFalse((self.path / "a.h5").exists())

    def test_steps_that_cannot_be_interrupted_end_as_well(self):
        # 1,600 intersecting tetrahedra: CGAL computes their intersections for far longer than a second
        with open(self.path / "tangle.obj", "w", encoding="ascii") as file:
            for i in range(1600):
                for x, y, z in [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]:
                    file.write(f"v {x + i % 40 * 0.11} {y + i // 40 * 0.13} {z + i * 0.001}\n")
                a = 4 * i + 1
                for f in [(a, a + 2, a + 1), (a, a + 1, a + 3), (a + 1, a + 2, a + 3), (a, a + 3, a + 2)]:
                    file.write("f {} {} {}\n".format(*f))
        done = run("model", self.path / "tangle.obj", "-o", self.path / "a.h5", "--limit-s", "0.001")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertRegex(done.stderr, r'tangle.obj.*face \d+ at \(.*\) m: "repair the surface" did not '
                                      r"finish within 0.001 s.*--limit-s")
        self.assertFalse((self.path / "a.h5").exists())

    def test_a_size_that_cannot_be_meant_is_asked_about(self):
        large = scaled(octahedron(self.path), "large.obj", 15)
        make = ["model", large, "-o", self.path / "a.h5", "--tetrahedra", "600", "--proxies", "0"]
        done = run(*make)
        self.assertEqual(done.returncode, 1)
        self.assertEqual(done.stderr, "palpate: error: large.obj: the body is 30 m large: is this intended? "
                                      "If so, use --scale 1; for a file in millimetres, use --scale 0.001 or "
                                      "--unit mm\n")
        for answer, status in [("y\n", 0), ("n\n", 1), ("\n", 1)]:
            asked = Terminal(*make)
            self.assertTrue(
                asked.read_until(r"large.obj: the body is 30 m large: is this intended\? \[y/N\]"))
            asked.type(answer)
            self.assertEqual(asked.end(), status, asked.text)
            self.assertEqual((self.path / "a.h5").exists(), status == 0)
            (self.path / "a.h5").unlink(missing_ok=True)
        for scale in ("1", "0.001"):
            self.assertEqual(run(*make, "--scale", scale).returncode, 0)
        small = scaled(octahedron(self.path), "small.obj", 1e-5)
        self.assertIn("the body is 2e-05 m large: is this intended? If so, use --scale 1; "
                      "for a file in kilometres",
                      run("model", small).stderr)

    def test_flat_tetrahedra_are_refused_filled_anew_or_taken_at_a_price(self):
        flat = flat_tetrahedra(self.path)
        make = ["model", flat, "-o", self.path / "a.h5", "--proxies", "0"]
        done = run(*make)
        self.assertEqual(done.returncode, 1)
        for word in ("dihedral angle", "--remesh", "--accept-angles", "tetrahedron 4 at ("):
            self.assertIn(word, done.stderr)
        done = run(*make, "--accept-angles")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"1 of 5 tetrahedra have angles below 8 degrees.*stable up to steps of "
                                      r"[0-9.e-]+ s.*condition number")
        (self.path / "scene.toml").write_text(scene_of("a.h5"))
        done = run("inspect", self.path / "scene.toml")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("remove one of the options", run(*make, "--accept-angles", "--remesh").stderr)

    @unittest.skipUnless(DATA, "PALPATE_TEST_DATA is not set: real tetrahedra are not tested")
    def test_real_tetrahedra_with_sharp_relief_are_filled_anew(self):
        done = run("model", Path(DATA) / "cow_head.msh", "--remesh", "--proxies", "0", "-o",
                   self.path / "a.h5")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"at \(.*\) m the surface is too sharp or too thin")

    @unittest.skipUnless(DATA, "PALPATE_TEST_DATA is not set: real tetrahedra are not tested")
    def test_real_tetrahedra_are_taken_as_they_are(self):
        for name in ("cow_head.msh", "bar-2523.msh", "sphere1K.msh", "dolphin5K.msh"):
            make = ["model", Path(DATA) / name, "--scale", "1", "--proxies", "0", "-o", self.path / "a.h5"]
            self.assertIn("--remesh", run(*make).stderr)
            done = run(*make, "--accept-angles")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("times as many", done.stdout)

    def test_the_documented_counts_are_those_made(self):
        text = DOCUMENT.read_text(encoding="utf-8")
        counts = "([0-9,]+)"
        documented = [match.groups() for match in (
            re.search(rf"`human`.*\| {counts} with {counts} nodes", text),
            re.search(rf"`human` with {counts} tetrahedra, {counts} nodes", text))]  # by another CGAL
        done = run("model", "human", "-o", self.path / "human.h5", "--proxies", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        made = dict(line.rsplit(maxsplit=1) for line in done.stdout.splitlines() if len(line.split()) == 2)
        self.assertIn((made["tetrahedra"], made["nodes"]),
                      [tuple(count.replace(",", "") for count in pair) for pair in documented])

    def test_a_shape_takes_another_skin(self):
        made = {}
        for skin in ("0", "20000"):
            path = self.path / f"ball{skin}.h5"
            done = run("model", "ball", "--skin-vertices", skin, "-o", path, "--proxies", "0")
            self.assertEqual(done.returncode, 0, done.stderr)
            made[skin] = dict(line.rsplit(maxsplit=1) for line in done.stdout.splitlines() if "  " in line)
        self.assertAlmostEqual(int(made["0"]["skin vertices"]), 6000, delta=60)
        self.assertAlmostEqual(int(made["20000"]["skin vertices"]), 20000, delta=200)
        self.assertEqual(made["0"]["tetrahedra"], made["20000"]["tetrahedra"])

    def test_help(self):
        self.assertIn("--tetrahedra", run("model", "--help").stdout)
        self.assertIn("model", run("--help").stdout)

    def test_palpate_links_and_loads_nothing_of_it(self):
        linked = subprocess.run(["ldd", PALPATE], capture_output=True, text=True).stdout.lower()
        symbols = subprocess.run(["nm", "-DC", "--undefined-only", PALPATE], capture_output=True,
                                 text=True).stdout
        for library in ("cgal", "gmsh", "mpfr", "pugixml", "qhull"):
            self.assertNotIn(library, linked)
        symbols += subprocess.run(["nm", "-C", PALPATE], capture_output=True, text=True).stdout
        self.assertIn("palpate::", symbols)
        # palpate includes only CGAL's triangulation of plane polygons (src/mesh/polygon.cpp)
        foreign = re.compile(r"CGAL::\w*(_3\b|AABB|Surface_mesh|HalfedgeDS|SM_|Polygon_mesh)|gmshOpen|"
                             r"gmshInitialize|\bmpfr_")
        self.assertEqual([line for line in symbols.splitlines() if foreign.search(line)], [])
        own = subprocess.run(["ldd", str(Path(PALPATE).parent / "palpate-model")], capture_output=True,
                             text=True).stdout.lower()
        self.assertNotIn("gmsh", own)  # loaded when a file requires it
        self.assertIn("gmp", own)


if __name__ == "__main__":
    unittest.main()
