#!/usr/bin/env python3
"""Installs the build, moves the installed tree, and builds and runs a small consumer of it.

    install_test.py BUILD [CXX]
"""
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


def call(*command, **options):
    done = subprocess.run([str(piece) for piece in command], capture_output=True, text=True, env=CLEAN,
                          **options)
    return done.returncode, done.stdout + done.stderr


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="palpate-package-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        first = cls.folder / "first"
        status, text = call("cmake", "--install", BUILD, "--prefix", first)
        if status != 0:
            raise AssertionError(text)
        cls.prefix = cls.folder / "moved elsewhere"
        first.rename(cls.prefix)

    def configure(self, source, build):
        return call("cmake", "-S", source, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    f"-DCMAKE_CXX_COMPILER={COMPILER}",
                    f"-DCMAKE_PREFIX_PATH={self.prefix}")

    def test_nothing_installed_names_the_source_or_the_build(self):
        looked_at = 0
        for path in sorted((self.prefix / "lib").rglob("*.cmake")):
            text = path.read_text()
            self.assertNotIn(str(SOURCE) + "/", text, path)
            self.assertNotIn(str(BUILD), text, path)
            self.assertNotIn(str(self.folder / "first"), text, path)
            looked_at += 1
        self.assertGreaterEqual(looked_at, 4)

    def test_consumer_builds_and_runs_in_both_orders(self):
        build = self.folder / "consumer"
        status, text = self.configure(HERE / "consumer", build)
        self.assertEqual(status, 0, text)
        status, text = call("cmake", "--build", build)
        self.assertEqual(status, 0, text)
        for program in ("integrate_first", "simbody_first"):
            for order in ("sundials-first", "cpodes-first"):
                with self.subTest(program=program, order=order):
                    status, text = call(build / program, order, timeout=120)
                    self.assertEqual(status, 0, text)
                    self.assertEqual(text.count(": right"), 9, text)

    def test_program_of_the_documentation(self):
        """docs/library.md's program runs the scene of README.md."""
        pages = (SOURCE / "README.md").read_text() + (SOURCE / "docs/library.md").read_text()
        source = self.folder / "mine"
        source.mkdir()
        fences = re.findall(r"^```(cmake|cpp|toml)\n(.*?)^```$", pages, re.M | re.S)
        blocks = {language: text for language, text in fences}
        for language, name in {"cmake": "CMakeLists.txt", "cpp": "main.cpp", "toml": "my.toml"}.items():
            (source / name).write_text(blocks[language])
        status, text = self.configure(source, self.folder / "mine-build")
        self.assertEqual(status, 0, text)
        status, text = call("cmake", "--build", self.folder / "mine-build")
        self.assertEqual(status, 0, text)
        status, text = call(self.folder / "mine-build" / "mine", cwd=source, timeout=300)
        self.assertEqual(status, 0, text)
        self.assertRegex(text, r"^0\.2 s in \d+ steps: ok")

    def test_unknown_component_is_refused_by_name(self):
        source = self.folder / "wrong"
        source.mkdir()
        (source / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(wrong CXX)\n"
                                               "find_package(palpate REQUIRED COMPONENTS fem wand)\n")
        status, text = self.configure(source, self.folder / "wrong-build")
        self.assertNotEqual(status, 0)
        self.assertIn("wand", text)

    def test_every_component_can_be_asked_for(self):
        source = self.folder / "all"
        source.mkdir()
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(all CXX)\nfind_package(palpate REQUIRED)\n"
            "foreach(part ${palpate_COMPONENTS})\n  add_library(use_${part} OBJECT use.cpp)\n"
            "  target_link_libraries(use_${part} PRIVATE palpate::${part})\nendforeach()\n")
        (source / "use.cpp").write_text("int use;\n")
        status, text = self.configure(source, self.folder / "all-build")
        self.assertEqual(status, 0, text)

    def test_installed_program_finds_its_libraries_and_scenes(self):
        status, text = call(self.prefix / "bin" / "palpate", "list", "scenes")
        self.assertEqual(status, 0, text)
        for scene in sorted((SOURCE / "scenes").glob("*.toml")):
            self.assertIn(scene.stem, text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
