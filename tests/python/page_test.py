#!/usr/bin/env python3
"""The examples of docs/python.md print the page's output, each in a separate Python process; the notebook
runs from its first cell to its last, with the results that its text states; the program of examples/ agrees
with theory."""
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

from built import PACKAGE, PROGRAM, TREE

sys.path.insert(0, str(TREE / "tests/docs"))
from pages import fences  # noqa: E402

try:
    import matplotlib
except ImportError:
    matplotlib = None
HAS_TOUCH = (PROGRAM.parent / "palpate-touch").is_file()
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(PACKAGE), "MPLBACKEND": "Agg"}


def examples(text):
    """Returns (code, output) of each example; output is None where the page shows none."""
    blocks = fences(text)
    after = blocks[1:] + [("", "")]
    return [(code, following if kind == "text" else None)
            for (language, code), (kind, following) in zip(blocks, after) if language == "python"]


def run(code, folder):
    done = subprocess.run([sys.executable, "-B", "-c", code], cwd=folder, env=ENVIRONMENT, text=True,
                          capture_output=True, check=False)
    return done.stdout if done.returncode == 0 else done.stdout + done.stderr


def in_scope(cells, scope):
    """Runs the code cells in order in one scope, as a kernel does."""
    for number, source in enumerate(cells, 1):
        exec(compile(source, f"cell {number}", "exec"), scope)


class Page(unittest.TestCase):
    found = examples((TREE / "docs/python.md").read_text())

    def test_examples(self):
        self.assertGreaterEqual(len(self.found), 8)
        self.assertGreaterEqual(sum(output is not None for _, output in self.found), 7)
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "scenes").symlink_to(TREE / "scenes")
            for code, output in self.found:
                with self.subTest(code=code):
                    self.assertLessEqual(len(re.findall(r"^(?!import|from)", code.strip(), re.M)), 5)
                    if "plot" in code and matplotlib is None or "touch" in code and not HAS_TOUCH:
                        continue
                    self.assertEqual(run(code, folder), output or "")
            if matplotlib is not None:
                self.assertGreater((Path(folder) / "force.png").stat().st_size, 5000)

    def test_a_wrong_example_is_found(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertIn("No module named 'palpat'", run("import palpat", folder))
            self.assertEqual(examples("```python\nx\n```\n\n```text\ny\n```\n```python\nz\n```\n"),
                             [("x\n", "y\n"), ("z\n", None)])


class Example(unittest.TestCase):
    def test_result_of_scene_from_python(self):
        text = run((TREE / "examples/scene_from_python.py").read_text(), TREE)
        number = r"([\d.e+-]+)"
        found = re.findall(rf"^at {number} Pa/m: force {number} N, by theory {number} N; "
                           rf"penetration {number} m, by theory {number} m$", text, re.M)
        self.assertEqual(len(found), 2, text)
        self.assertEqual(len(found), len(text.splitlines()), text)
        for row, stiffness in zip(found, (5e7, 2.5e7)):
            used, force, weight, depth, theory = map(float, row)
            self.assertEqual(used, stiffness)
            self.assertAlmostEqual(weight, 1000.0 * 0.05**3 * 9.81, delta=1e-5)
            self.assertAlmostEqual(theory, 1000.0 * 9.81 * 0.05 / stiffness, delta=1e-10)
            self.assertAlmostEqual(force, weight, delta=1e-4 * weight)
            self.assertAlmostEqual(depth, theory, delta=3e-3 * theory)  # the loaded face widens by nu p / E


    def test_result_of_hand_from_python(self):
        lines = run((TREE / "examples/hand_from_python.py").read_text(), TREE).splitlines()
        self.assertEqual(len(lines), 6, lines)
        ticks, force, lower = re.fullmatch(
            r"(\d+) ticks; force ([\d.]+) N, target 0.3 N; handle ([\d.]+) mm lower", lines[-1]).groups()
        self.assertEqual(ticks, "1500")
        self.assertAlmostEqual(float(force), 0.3, delta=0.003)
        self.assertGreater(float(lower), 3.0)

    def test_result_of_forces_from_python(self):
        text = run((TREE / "examples/forces_from_python.py").read_text(), TREE)
        longer, theory = map(float, re.fullmatch(
            r"longer by ([\d.e-]+) m, by theory F L / \(E A\) = ([\d.e-]+) m\n", text).groups())
        self.assertAlmostEqual(theory, 0.5 * 0.08 / (1e5 * 4e-4), delta=1e-9)
        self.assertAlmostEqual(longer, theory, delta=0.02 * theory)

    def test_result_of_states_from_python(self):
        text = run((TREE / "examples/states_from_python.py").read_text(), TREE)
        number = r"([\d.e-]+)"
        moved, by_theory, energy, energy_by_theory, back = map(float, re.fullmatch(
            rf"moved by {number} m, by theory {number} m; kinetic energy {number} J, by theory {number} J\n"
            rf"put back and stopped: moved by {number} m in 0.1 s\n", text).groups())
        self.assertEqual(by_theory, 0.2)
        self.assertAlmostEqual(moved, by_theory, delta=2e-6)
        self.assertAlmostEqual(energy, energy_by_theory, delta=2e-6)
        self.assertGreater(energy, 0.1)
        self.assertLess(back, 1e-9)


class Notebook(unittest.TestCase):
    @unittest.skipIf(matplotlib is None, "Matplotlib is missing (Debian package python3-matplotlib)")
    def test_it_runs(self):
        notebook = json.loads((TREE / "docs/python.ipynb").read_text())
        self.assertEqual(notebook["nbformat"], 4)
        cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
        self.assertGreaterEqual(len(cells), 5)
        if not HAS_TOUCH:
            cells = [cell for cell in cells if "view" not in cell]
        self.assertEqual(len({cell["id"] for cell in notebook["cells"]}), len(notebook["cells"]))
        for cell in notebook["cells"]:  # its stored output is not executed
            self.assertEqual(cell.get("outputs", []), [])
        os.environ["MPLBACKEND"] = "Agg"
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(TREE / "docs")
        scope = {"__name__": "__main__"}
        in_scope(cells, scope)
        self.assertEqual(len(scope["times"]), 39 + 1)
        self.assertGreater(max(scope["dents"]), 3e-3)
        self.assertGreater(scope["pressing"].sum(), 1)
        self.assertGreater(scope["forces"][4e4], 1.1 * scope["forces"][1e4])
        self.assertEqual(len(scope["axes"].get_lines()), 2)
        if HAS_TOUCH:
            self.assertRegex(scope["view"].address, r"^http://127\.0\.0\.1:\d+/\?token=")
            self.assertEqual((scope["view"].running, scope["view"].error), (False, ""))

    def test_a_cell_that_fails_is_found(self):
        with self.assertRaises(NameError):
            in_scope(["x = 1", "y = x + z"], {})


if __name__ == "__main__":
    unittest.main(argv=[__file__])
