#!/usr/bin/env python3
"""Runs every command of a page, in order, as a new user would: in one folder, with the files that the page
asks to save there.

    readme_test.py PROGRAM Readme|FirstTouch|TouchYourMesh|ChooseAnIntegrator|IsMyLoopStable
                           |BringYourDevice|Studies
"""
import csv
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.dom.minidom
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
TREE = Path(__file__).resolve().parents[2]
# Tested elsewhere: the launcher's own commands (cli.launcher), installation (package.install), a Slurm
# cluster (cli.study_slurm).
ELSEWHERE = [r"\./palpate test$", r"\./palpate build$", r"cmake --install build/release --prefix ",
             r"\./palpate study .* --slurm"]


class Page:
    """Common code of the tests of a page; they define `page` and `least`, the minimum number of commands."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="palpate-page-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        (cls.folder / "palpate").symlink_to(PROGRAM)
        for name in ("examples", "include", "scenes"):  # a page is read in the folder of a clone
            (cls.folder / name).symlink_to(TREE / name)
        text = (TREE / cls.page).read_text()
        cls.said, cls.failed = {}, []
        for language, content in re.findall(r"^```(\w+)\n(.*?)^```$", text, re.M | re.S):
            if language == "toml":
                name = re.match(r"# (\S+\.toml)\n", content)
                if not name:
                    cls.failed.append("a scene begins with its file's name")
                    continue
                (cls.folder / name.group(1)).write_text(content)
            if language == "sh":
                for line in re.sub(r"\\\n\s*", "", content).splitlines():
                    cls.run_line(line)

    @classmethod
    def run_line(cls, line):
        if any(re.match(pattern, line) for pattern in ELSEWHERE):
            return
        if not re.match(r"\./palpate |cc -shared |(head|tail) -n 1 ", line):
            cls.failed.append(f"{line}: a command that no test runs")
            return
        done = subprocess.run(["bash", "-c", line], cwd=cls.folder, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=900)
        cls.said[line] = done.stdout
        if done.returncode != 0:
            cls.failed.append(f"{line}: status {done.returncode}\n{done.stdout}{done.stderr}")

    def said_by(self, *words):
        return next(text for line, text in self.said.items() if all(word in line for word in words))

    def test_every_command(self):
        self.assertEqual(self.failed, [])
        self.assertGreaterEqual(len(self.said), self.least)

    def test_files_it_names_exist(self):
        pattern = r"`([\w./-]+/[\w.-]*\.\w+|\.packages|CMakePresets\.json|[a-z]+/)`"
        for name in re.findall(pattern, (TREE / self.page).read_text()):
            made = name.startswith("out/")
            self.assertTrue(((self.folder if made else TREE) / name).exists(), name)


class Readme(Page, unittest.TestCase):
    page = "README.md"
    least = 10

    def test_demo(self):
        """The page contains all five items that README.md lists, without external resources."""
        folder = self.folder / "out/demo"
        page = (folder / "report.html").read_text()
        xml.dom.minidom.parseString(page)
        self.assertIn("data:image/png;base64,", page)
        self.assertGreaterEqual(page.count('class="plot-data"'), 3)
        for word in ("Force on the hand", "Error against run time", "Error due to the exchange period",
                     "Contact methods"):
            self.assertIn(word, page)
        self.assertGreaterEqual(len((folder / "methods.csv").read_text().splitlines()), 1 + 2)
        self.assertFalse(re.search(r'(src|href)="(?!data:|#)', page), "it needs no other file")

    def test_what_it_promises_of_runs(self):
        names = {path.name for path in (self.folder / "out/press-ball").iterdir()}
        self.assertLessEqual({"run.vtkhdf", "force.csv", "summary.json", "picture.png", "report.html"}, names)
        self.assertIn("first-touch", self.said_by("./palpate help"))
        self.assertRegex(self.said_by("--against-monolithic"), r"force error \S+ N RMS")


class FirstTouch(Page, unittest.TestCase):
    page = "docs/first-touch.md"
    least = 8

    def test_a_folder_has_what_the_page_lists(self):
        listed = re.findall(r"^- `([\w.]+)`:", (TREE / self.page).read_text(), re.M)
        self.assertEqual(len(listed), 5)
        for name in listed:
            self.assertGreater((self.folder / "out/touch" / name).stat().st_size, 0, name)

    def test_the_force_is_what_the_page_says(self):
        with open(self.folder / "out/touch/force.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 300)
        last = float(rows[-1]["force_z_n"])
        self.assertGreater(last, 0.05)  # the ball exerts an upward force on the hand
        self.assertLess(abs(float(rows[5]["force_z_n"])), 0.02)  # no contact yet
        second = self.said_by("run touch.toml --picture").splitlines()[1]
        self.assertRegex(second, r"^on the hand: at most \S+ N ")
        most = max(float(row["force_z_n"]) for row in rows)
        self.assertAlmostEqual(float(second.split()[5]), most, places=2)

    def test_a_stiffer_ball_pushes_harder(self):
        force = []
        for folder in ("touch", "stiffer"):
            with open(self.folder / f"out/{folder}/force.csv", encoding="utf-8") as file:
                force.append(float(list(csv.DictReader(file))[-1]["force_z_n"]))
        self.assertGreater(force[1], 1.3 * force[0])
        self.assertRegex(self.said_by("diff"), r"\d")

    def test_a_typing_error_is_answered_as_the_page_says(self):
        done = subprocess.run(["./palpate", "run", "touch.toml", "--set", "body.0.youngs_module_pa=1e5"],
                              cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1)
        self.assertIn("youngs_modulus_pa", done.stderr)

    def test_errors_are_printed(self):
        self.assertRegex(self.said_by("--against-monolithic"), r"force error \S+ N RMS \(\S+ % of the peak")
        table = self.said_by("compare touch.toml")
        for method in ("cvode-bdf", "linearly-implicit-euler"):
            self.assertGreaterEqual(len(re.findall(rf"^{method} +\S", table, re.M)), 3)
        self.assertTrue((self.folder / "out/compare/report.html").exists())


class TouchYourMesh(Page, unittest.TestCase):
    page = "docs/touch-your-mesh.md"
    least = 7

    def test_the_scene_touches_the_mesh(self):
        with open(self.folder / "out/bracket/force.csv", encoding="utf-8") as file:
            force = [float(row["force_z_n"]) for row in csv.DictReader(file)]
        self.assertGreater(max(force), 0.01)
        self.assertLess(abs(force[0]), 0.05 * max(force))  # it starts at the surface, unloaded

    def test_its_numbers_have_their_rules(self):
        comments = [line for line in (self.folder / "bracket.toml").read_text().splitlines() if "#" in line]
        self.assertGreater(len(comments), 15)

    def test_pictures_and_page_are_there(self):
        for name in ("start.png", "out/bracket/picture.png", "out/bracket/report.html"):
            self.assertGreater((self.folder / name).stat().st_size, 5000, name)

    def test_the_error_due_to_the_mesh_is_printed(self):
        self.assertIn("%", self.said_by("compare --mesh"))


class BringYourDevice(Page, unittest.TestCase):
    page = "docs/bring-your-device.md"
    least = 3

    def test_the_driver_presses(self):
        said = self.said_by("device.type=plugin")
        force = re.search(r"on the hand: at most (\S+) N", said)
        self.assertGreater(float(force.group(1)), 0.1)
        self.assertRegex(said, r"\d+ us in longest driver call")

    def test_the_limit_is_printed(self):
        self.assertRegex(self.said_by("stability --haptic"), r"coupling")


class ChooseAnIntegrator(Page, unittest.TestCase):
    page = "docs/choose-an-integrator.md"
    least = 5

    def test_the_exchange_error_is_what_the_page_says(self):
        said = self.said_by("--against-monolithic")
        share = re.search(r"force error \S+ N RMS \((\S+) % of the peak", said)
        self.assertLess(abs(float(share.group(1)) - 0.3), 0.1)

    def test_the_comparison_says_what_the_page_says(self):
        said = self.said_by("compare press-ball")
        for heading in ("position error at most", "fitted order", "out of time"):
            self.assertIn(heading, said)
        euler = re.search(r"^linearly-implicit-euler +(\S+) in step_s", said, re.M)
        self.assertLess(abs(float(euler.group(1)) - 1.0), 0.2)
        self.assertTrue((self.folder / "out/choice/report.html").exists())

    def test_nobody_notices_the_tighter_tolerance(self):
        self.assertIn("noticeable (over 7 %) in 0 % of the ticks", self.said_by("diff"))


class IsMyLoopStable(Page, unittest.TestCase):
    page = "docs/is-my-loop-stable.md"
    least = 7

    def energy(self, *words):
        """Returns the minimum and the final energy at the port that the run printed [J]."""
        found = re.search(r"minimum (\S+) J, at the end (\S+) J", self.said_by(*words))
        return float(found.group(1)), float(found.group(2))

    def test_the_limit_is_what_the_page_shows(self):
        shown = re.search(r"```text\n(.*?)```", (TREE / self.page).read_text(), re.S).group(1)
        self.assertIn(" ".join(shown.split()), self.said_by("-o out/limits"))
        self.assertTrue(self.said_by("-o out/stiff").endswith("unstable\n"))

    def test_the_table_is_what_the_runs_print(self):
        text = (TREE / self.page).read_text()
        rows = re.findall(r"^\| (\d+) \| (\S+) \| (\S+) \| (\S+) \|$", text, re.M)
        self.assertEqual([row[0] for row in rows], ["300", "3000", "8000"])
        for stiffness, buzz, *energies in rows:
            words = ("observe", f"-o out/k{stiffness}")
            printed = float(re.search(r"buzz: (\S+) N", self.said_by(*words)).group(1))
            self.assertLess(abs(printed - float(buzz)), 0.1 * printed)
            for shown, energy in zip(energies, self.energy(*words)):
                self.assertLess(abs(float(shown) - energy), 1e-3 * 0.06 + 0.1 * abs(energy))

    def test_the_remedies_help(self):
        stiff = self.energy("observe", "-o out/k8000")
        self.assertGreater(self.energy("-o out/no-delay")[0], 0.5 * stiff[0])
        least, end = self.energy("-o out/control")
        self.assertGreater(least, 0.02 * stiff[0])
        self.assertGreater(end, 0.0)


class Studies(Page, unittest.TestCase):
    page = "docs/studies.md"
    least = 5

    def rows(self):
        with open(self.folder / "out/softness/study.csv", encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def test_the_table_begins_as_the_page_shows(self):
        self.assertIn("24 tasks: 24 ok", self.said_by("-o out/softness"))
        shown = re.search(r"```text\n(task.*?)```", (TREE / self.page).read_text(), re.S).group(1)
        lines = self.said_by("-o out/softness").splitlines()
        for line in shown.splitlines():
            self.assertTrue(any(said.startswith(line) for said in lines), line)

    def test_the_folder_has_what_the_page_lists(self):
        listed = re.findall(r"^- `([\w.-]+)`(?: and `([\w.]+)`)?:", (TREE / self.page).read_text(), re.M)
        names = [name for pair in listed for name in pair if name]
        self.assertEqual(len(names), 6)
        for name in names:
            self.assertTrue((self.folder / "out/softness" / name).exists(), name)

    def test_every_status_is_in_the_page(self):
        names = re.search(r"kNames = {(.*?)};", (TREE / "src/experiments/status.cpp").read_text(), re.S)
        known = set(re.findall(r'"([a-z ]+)"', names.group(1))) - {"not tried"}  # in comparisons only
        self.assertEqual(len(known), 6)
        self.assertEqual(known, set(re.findall(r"^\| `([a-z ]+)` \|", (TREE / self.page).read_text(), re.M)))

    def test_stiffer_is_felt_and_a_coarse_step_spoils_it(self):
        force = {}
        for row in self.rows():
            key = row["integrator"], float(row["body.0.youngs_modulus_pa"])
            force.setdefault(key, []).append(float(row["peak_force_n"]))
        mean = {key: sum(values) / len(values) for key, values in force.items()}
        for integrator in ("cvode-bdf", "linearly-implicit-euler"):
            self.assertGreater(mean[integrator, 4e4], 1.5 * mean[integrator, 5e3])
        self.assertEqual({len(values) for values in force.values()}, {3})


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
