#!/usr/bin/env python3
"""Runs every command of README.md, in order, as a newcomer would: in one folder, with the files that
README.md says to save there.

    readme_test.py PROGRAM
"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import xml.dom.minidom
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
README = Path(__file__).resolve().parents[2] / "README.md"
# Done by other tests: the launcher's own commands (cli.launcher), installation (package.install).
ELSEWHERE = [r"git clone ", r"cd palpate$", r"\./palpate test$", r"\./palpate build$",
             r"cmake --install build/release --prefix "]


def fences():
    """(language, text) of each fenced block."""
    return re.findall(r"^```(\w+)\n(.*?)^```$", README.read_text(), re.M | re.S)


class Readme(unittest.TestCase):
    def test_every_command(self):
        folder = Path(tempfile.mkdtemp(prefix="palpate-readme-"))
        self.addCleanup(shutil.rmtree, folder)
        (folder / "palpate").symlink_to(PROGRAM)
        ran = []
        for language, text in fences():
            if language == "toml":
                name = re.match(r"# (\S+\.toml)\n", text)
                self.assertTrue(name, "a scene in README.md begins with its file's name")
                (folder / name.group(1)).write_text(text)
            if language != "sh":
                continue
            for line in text.splitlines():
                if any(re.match(pattern, line) for pattern in ELSEWHERE):
                    continue
                self.assertRegex(line, r"^\./palpate ", "a command that no test runs")
                with self.subTest(command=line):
                    done = subprocess.run(["bash", "-c", line], cwd=folder, capture_output=True, text=True,
                                          stdin=subprocess.DEVNULL, timeout=900)
                    self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
                    ran.append(line)
        self.assertIn("./palpate demo", ran)
        self.assertGreater(len(ran), 12)
        self.check_demo(folder / "out/demo")

    def check_demo(self, folder):
        """The page holds all five things that README.md lists, in itself."""
        page = (folder / "report.html").read_text()
        xml.dom.minidom.parseString(page)
        self.assertIn("data:image/png;base64,", page)
        self.assertGreaterEqual(page.count("<svg"), 3)
        for word in ("Force on the hand", "Error against run time", "Error of the exchange period",
                     "Ways to find the contact"):
            self.assertIn(word, page)
        self.assertGreaterEqual(len((folder / "methods.csv").read_text().splitlines()), 1 + 2)
        self.assertFalse(re.search(r'(src|href)="(?!data:|#)', page), "it needs no other file")

    def test_files_it_names_exist(self):
        pattern = r"`([\w./-]+/[\w.-]*\.\w+|\.packages|CMakePresets\.json|[a-z]+/)`"
        for name in re.findall(pattern, README.read_text()):
            if not name.startswith("out/"):
                self.assertTrue((README.parent / name).exists(), name)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
