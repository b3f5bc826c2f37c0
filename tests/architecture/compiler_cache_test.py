#!/usr/bin/env python3
"""The compiler cache, with the settings of cmake/compiler_cache.cmake, never returns an object that was
compiled from an earlier text: a header that changes while a file is being compiled is the case that a cache
can get wrong. An object of old text beside objects of new text links without a message, and two versions of
one inline function then run in one program."""
import os
import re
import shutil
import stat
import subprocess
import tempfile
import unittest
from pathlib import Path

SETTINGS = Path(__file__).resolve().parents[2] / "cmake" / "compiler_cache.cmake"
HEADER = '#pragma once\ninline const char* text() { return "%s text"; }\n'
# The compiler that has read its input when somebody saves a new text.
COMPILER = """#!/bin/sh
{compiler} "$@" || exit
if [ -e edit ]; then sleep 1.1; mv edit text.h; fi
"""


def settings():
    """Returns the variables that the build sets for ccache."""
    return {name: value for name, value in re.findall(r"(CCACHE_\w+)=(\S+)", SETTINGS.read_text())
            if "$" not in value}


@unittest.skipUnless(shutil.which("ccache") and shutil.which("g++"), "no ccache or no g++ here")
class CompilerCache(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        compiler = self.folder / "g++"
        compiler.write_text(COMPILER.format(compiler=shutil.which("g++")))
        compiler.chmod(compiler.stat().st_mode | stat.S_IXUSR)
        (self.folder / "text.h").write_text(HEADER % "old")
        (self.folder / "unit.cpp").write_text('#include "text.h"\nconst char* unit() { return text(); }\n')

    def object_of(self):
        """Compiles the unit as the build does; returns the object's bytes."""
        environment = {**os.environ, **settings(), "CCACHE_DIR": str(self.folder / "cache")}
        subprocess.run(["ccache", "./g++", "-MD", "-MF", "unit.d", "-c", "unit.cpp", "-o", "unit.o"],
                       cwd=self.folder, env=environment, check=True)
        return (self.folder / "unit.o").read_bytes()

    def test_edit_during_compilation(self):
        (self.folder / "edit").write_text(HEADER % "new")
        self.assertTrue(b"old text" in self.object_of())
        self.assertIn("new", (self.folder / "text.h").read_text())
        self.assertTrue(b"new text" in self.object_of(), "the cache returned the object of the old text")

    def test_settings_are_found(self):
        self.assertIn("CCACHE_SLOPPINESS", settings())


if __name__ == "__main__":
    unittest.main()
