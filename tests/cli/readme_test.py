#!/usr/bin/env python3
"""Runs every command of a page, in order, as a newcomer would: in one folder, with the files that the page
says to save there.

    readme_test.py PROGRAM Readme|FirstTouch
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
# Done by other tests: the launcher's own commands (cli.launcher), installation (package.install).
ELSEWHERE = [r"git clone ", r"cd palpate$", r"\./palpate test$", r"\./palpate build$",
             r"cmake --install build/release --prefix "]


class Page:
    """What the tests of a page share; `page` and `least`, how many commands it has at least, are theirs."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="palpate-page-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        (cls.folder / "palpate").symlink_to(PROGRAM)
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
        if not re.match(r"\./palpate |(head|tail) -n 1 ", line):
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
        """The page holds all five things that README.md lists, in itself."""
        folder = self.folder / "out/demo"
        page = (folder / "report.html").read_text()
        xml.dom.minidom.parseString(page)
        self.assertIn("data:image/png;base64,", page)
        self.assertGreaterEqual(page.count("<svg"), 3)
        for word in ("Force on the hand", "Error against run time", "Error of the exchange period",
                     "Ways to find the contact"):
            self.assertIn(word, page)
        self.assertGreaterEqual(len((folder / "methods.csv").read_text().splitlines()), 1 + 2)
        self.assertFalse(re.search(r'(src|href)="(?!data:|#)', page), "it needs no other file")

    def test_what_it_promises_of_runs(self):
        names = {path.name for path in (self.folder / "out/press-ball").iterdir()}
        self.assertLessEqual({"run.vtkhdf", "force.csv", "summary.json", "picture.png", "report.html"}, names)
        self.assertIn("first-touch", self.said_by("./palpate help"))
        self.assertRegex(self.said_by("--against-monolithic"), r"force off by \S+ N RMS")


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
        self.assertGreater(last, 0.05)  # the ball pushes the hand up
        self.assertLess(abs(float(rows[5]["force_z_n"])), 0.02)  # not yet touched
        third = self.said_by("run touch.toml --picture").splitlines()[2]
        self.assertRegex(third, r"^on the hand: at most \S+ N ")
        most = max(float(row["force_z_n"]) for row in rows)
        self.assertAlmostEqual(float(third.split()[5]), most, places=2)

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
        self.assertRegex(self.said_by("--against-monolithic"), r"force off by \S+ N RMS \(\S+ % of the peak")
        table = self.said_by("compare touch.toml")
        for method in ("cvode-bdf", "linearly-implicit-euler"):
            self.assertGreaterEqual(len(re.findall(rf"^{method} +\S", table, re.M)), 3)
        self.assertTrue((self.folder / "out/compare/report.html").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
