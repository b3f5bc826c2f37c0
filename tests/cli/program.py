"""The program under test, called from its command line. Its path is the first argument of each test."""
import os
import pty
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

PROGRAM = Path(sys.argv[1]).resolve()
TREE = Path(__file__).resolve().parents[2]
QUICK_COMPARISON = ["--limit-s", "1", "--duration-s", "0.05", "--repeats", "1",
                    "--set", "body.0.mesh.element_size_m=0.05"]
LONG = ["run", "one-tet", "--duration-s", "1e6"]  # ends only when it is stopped
# What a pipe gets every ten seconds, on a slow machine.
PROGRESS = re.compile(r"^palpate: .+: \d+ %(, .+ left)?\n", re.M)
NO_EGL = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere.json"}  # libglvnd then finds no driver


def open_terminal():
    """Returns both ends of a terminal; skips the test with a message where the machine has none (no
    /dev/pts)."""
    try:
        return pty.openpty()
    except OSError as error:
        raise unittest.SkipTest(f"this machine has no terminals: {error}") from error


class Cli(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-cli-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def call(self, *arguments, **environment):
        done = subprocess.run([str(PROGRAM), *arguments], capture_output=True, text=True, cwd=self.folder,
                              timeout=300, env=dict(os.environ, **environment), stdin=subprocess.DEVNULL)
        self.assertNotIn("\033", done.stdout + done.stderr)  # no terminal, no control codes
        done.stderr = PROGRESS.sub("", done.stderr)
        return done

    def good(self, *arguments, **environment):
        done = self.call(*arguments, **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *arguments):
        done = self.call(*arguments)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def shipped(self, name):
        return PROGRAM.parent.parent / "share/palpate/scenes" / f"{name}.toml"
