"""Installed copy of the build, shared by the tests of this folder."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCE = HERE.parents[1]
BUILD = Path(sys.argv[1]).resolve()
COMPILER = sys.argv[2] if len(sys.argv) > 2 else "c++"
CLEAN = {key: value for key, value in os.environ.items()
         if key not in ("LD_LIBRARY_PATH", "CMAKE_PREFIX_PATH", "palpate_DIR")}


def call(*command, env=CLEAN, **options):
    done = subprocess.run([str(piece) for piece in command], capture_output=True, text=True, env=env,
                          **options)
    return done.returncode, done.stdout + done.stderr


def figures_in(text, pattern):
    """Returns the numbers of a program's output; NUMBER in the pattern represents each of them."""
    match = re.fullmatch(pattern.replace("NUMBER", r"(-?[\d.e+-]+)"), text.strip())
    if match is None:
        raise AssertionError(f"not as expected: {text}")
    return [float(number) for number in match.groups()]


class Installed(unittest.TestCase):
    """Installs the build and moves the installed tree to `prefix`, whose name contains a blank."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="palpate-package-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        first = cls.folder / "first"
        status, text = call("cmake", "--install", BUILD, "--prefix", first)
        if status != 0:
            raise AssertionError(text)
        cls.prefix = cls.folder / "moved elsewhere/palpate"
        cls.prefix.parent.mkdir()
        first.rename(cls.prefix)

    def configure(self, source, build, *more):
        return call("cmake", "-S", source, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    f"-DCMAKE_CXX_COMPILER={COMPILER}",
                    f"-DCMAKE_PREFIX_PATH={self.prefix}", *more)

    def build(self, source, name, *settings):
        """Configures and builds a project; returns its build folder."""
        folder = self.folder / name
        for status, text in (self.configure(source, folder, *settings),
                             call("cmake", "--build", folder)):
            self.assertEqual(status, 0, text)
        return folder
