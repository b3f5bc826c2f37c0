"""Shared by the tests of studies: a scene of milliseconds, one of seconds, and calls of the program."""
import contextlib
import csv
import os
import shutil
import sqlite3
import subprocess
import tempfile
import unittest
from pathlib import Path

BLOCK = (Path(__file__).resolve().parents[1] / "experiments/study/block.toml").read_text()
QUICK = """[study]
scenes = ["block.toml"]
integrators = ["cvode-bdf", "linearly-implicit-euler"]
rtol = [1e-2, 1e-4]
step_s = [2e-3, 1e-3]
seeds = 2
[[sweep]]
key = "body.0.youngs_modulus_pa"
values = [1e4, 4e4]
[[random]]
key = "body.0.density_kg_m3"
min = 900
max = 1100
"""
QUICK_TASKS = 16
# Seconds per task, so that events can occur during it; the values differ from all others by orders of
# magnitude.
LONG = """[study]
scenes = ["block.toml"]
step_s = [2e-7]
duration_s = 0.1
set = ["integrator.max_steps=1000000000"]
limit_s = 300
[[sweep]]
key = "body.0.youngs_modulus_pa"
values = [1e4, 2e4, 3e4, 4e4]
"""
LONG_TASKS = 4


class Studies(unittest.TestCase):
    program = None  # set by the test file
    environment = {}

    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-study-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.put("block.toml", BLOCK)
        self.put("quick.toml", QUICK)
        self.put("long.toml", LONG)

    def put(self, name, text):
        (self.folder / name).write_text(text)

    def words(self, *arguments):
        return [str(self.program), "study", *arguments]

    def call(self, *arguments):
        return subprocess.run(self.words(*arguments), capture_output=True, text=True, cwd=self.folder,
                              timeout=500, env={**os.environ, **self.environment}, stdin=subprocess.DEVNULL)

    def good(self, *arguments):
        done = self.call(*arguments)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        return done.stdout

    def refused(self, *arguments):
        done = self.call(*arguments)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        return done.stderr

    def begin(self, *arguments):
        child = subprocess.Popen(self.words(*arguments), cwd=self.folder, text=True,
                                 env={**os.environ, **self.environment}, stdin=subprocess.DEVNULL,
                                 stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(lambda: (child.kill(), child.wait(), child.stdout.close(), child.stderr.close()))
        return child

    def table(self, folder):
        return (self.folder / folder / "study.csv").read_bytes()

    def rows(self, folder, name="study.csv"):
        with open(self.folder / folder / name, encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))

    def stored(self, folder):
        """Returns key -> (command, time of its end) of all results, whichever process wrote them."""
        out = {}
        for path in [self.folder / folder / "results.db", *(self.folder / folder / "tasks").glob("*.db*")]:
            try:
                with contextlib.closing(sqlite3.connect(f"file:{path}?mode=rw", uri=True)) as db:
                    out.update({key: rest for key, *rest in
                                db.execute("select key, task, ended_utc from result")})
            except sqlite3.Error:  # there is none, or it is being created
                pass
        return out

    def results(self, folder):
        return sorted(self.stored(folder))
