"""Calls of the program that fail, or are ended: shared by tests of bad input and of limits of the machine."""
import csv
import json
import os
import shutil
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

from program import PROGRAM


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-bad-input-"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def call(self, *arguments, before=None, wrapped=(), **environment):
        done = subprocess.run([*wrapped, str(PROGRAM), *map(str, arguments)], capture_output=True, text=True,
                              cwd=self.folder, timeout=300, env=dict(os.environ, **environment),
                              stdin=subprocess.DEVNULL, preexec_fn=before, check=False, errors="replace")
        self.assertNotIn("HDF5-DIAG", done.stdout + done.stderr)
        self.assertNotIn("internal error", done.stderr)
        return done

    def good(self, *arguments, **options):
        done = self.call(*arguments, **options)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *arguments, **options):
        """Checks for exit status 1 and returns the one sentence on standard error."""
        done = self.call(*arguments, **options)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def started(self, *arguments):
        process = subprocess.Popen([str(PROGRAM), *arguments], cwd=self.folder, text=True,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.addCleanup(process.communicate)
        self.addCleanup(process.kill)
        return process

    def wait_for(self, condition, process):
        end = time.monotonic() + 120
        while not condition():
            self.assertIsNone(process.poll(), "it ended by itself")
            self.assertLess(time.monotonic(), end, "nothing happened")
            time.sleep(0.02)

    def steps(self, run):
        """Returns the times of the recorded states, as found by export."""
        self.good("export", run, "--to", "csv", "-o", "steps")
        with open(self.folder / "steps/nodes.csv", encoding="utf-8") as file:
            times = sorted({float(row["time_s"]) for row in csv.DictReader(file)})
        shutil.rmtree(self.folder / "steps")
        return times

    def summary(self, run):
        return json.loads((self.folder / run / "summary.json").read_text())
