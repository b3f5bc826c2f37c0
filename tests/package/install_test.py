#!/usr/bin/env python3
"""Installs the build, moves the installed tree, and builds and runs programs that use it alone: those of
tests/package/programs, whose results are held against theory, that of docs/library.md, and one that has
Simbody and SUNDIALS in one process.

    install_test.py BUILD [CXX]
"""
import math
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

    def configure(self, source, build, *more):
        return call("cmake", "-S", source, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
                    f"-DCMAKE_CXX_COMPILER={COMPILER}",
                    f"-DCMAKE_PREFIX_PATH={self.prefix}", *more)

    def build(self, source, name, *settings, target="all"):
        """Configures and builds a project outside; its folder."""
        folder = self.folder / name
        for status, text in (self.configure(source, folder, *settings),
                             call("cmake", "--build", folder, "--target", target)):
            self.assertEqual(status, 0, text)
        return folder

    def figures(self, program, pattern):
        """What a program prints, as numbers."""
        status, text = call(program, timeout=120)
        self.assertEqual(status, 0, text)
        match = re.fullmatch(pattern.replace("NUMBER", r"(-?[\d.e+-]+)"), text.strip())
        self.assertIsNotNone(match, text)
        return [float(number) for number in match.groups()]

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

    def test_soft_bodies_ask_for_no_other_library(self):
        """Programs of `fem` and `integrate`, where Simbody, HDF5 and all of pkg-config cannot be found."""
        hidden = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ("Simbody", "HDF5", "PkgConfig")]
        folder = self.build(HERE / "programs", "soft", *hidden)
        longer, theory = self.figures(folder / "step_body", "ok at 2 s after \\d+ steps: longer by NUMBER m, "
                                      "by theory rho g L.2 / 2E = NUMBER m")
        self.assertAlmostEqual(theory, 1000 * 9.81 * 0.1**2 / 2e5, delta=1e-8)
        self.assertAlmostEqual(longer, theory, delta=0.01 * theory)
        shift, theory, energy, before = self.figures(
            folder / "own_force", "ok: shifted by NUMBER m, by theory d cos.w t. = NUMBER m; "
            "energy NUMBER J, at the start NUMBER J")
        self.assertAlmostEqual(theory, 0.02 * math.cos(5.0), delta=1e-8)
        # the midpoint rule at w h = 0.01 turns by w t (1 - (w h)^2/12): 4e-5 rad, of 0.02 sin(5) m
        self.assertAlmostEqual(shift, theory, delta=2e-6)
        self.assertAlmostEqual(energy, before, delta=1e-5 * before)
        for program in ("step_body", "own_force"):
            loaded = call("ldd", folder / program)[1]
            self.assertIn("libpalpate_integrate", loaded)
            self.assertIn("moved elsewhere", loaded)
            self.assertNotRegex(loaded, "(?i)simtk|libEGL|libGL|epoxy|hdf5|sqlite|cairo|not found")
        # and a component that does need them says so
        status, text = self.configure(HERE / "programs", self.folder / "hidden", "-DWITH_LOOP=ON", *hidden)
        self.assertNotEqual(status, 0)
        self.assertIn("Simbody", text)

    def test_device_of_ones_own(self):
        folder = self.build(HERE / "programs", "device", "-DWITH_LOOP=ON", target="own_device")
        height, felt, theory = self.figures(
            folder / "own_device", "ok: 1500 ticks, tool at NUMBER m; on the hand NUMBER N, by theory -m g = "
            "NUMBER N")
        self.assertAlmostEqual(theory, -0.981, delta=1e-9)
        self.assertAlmostEqual(felt, theory, delta=0.01)  # the limiter's curve: 1 % below half the maximum
        # it hangs m g / k below the handle, which has risen for 1.5 s
        self.assertAlmostEqual(height, 0.03 - 0.981 / 300.0, delta=2e-5)

    def test_every_promised_header_can_be_included(self):
        """All of them together, from the installed folder alone."""
        source = self.folder / "headers"
        source.mkdir()
        include = self.prefix / "include"
        headers = sorted(path.relative_to(include).as_posix() for path in include.rglob("*.h"))
        self.assertGreater(len(headers), 60)
        (source / "all.cpp").write_text("".join(f'#include "{header}"\n' for header in headers))
        (source / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.25)\nproject(headers CXX)\nfind_package(palpate REQUIRED)\n"
            "add_library(headers OBJECT all.cpp)\nforeach(part ${palpate_COMPONENTS})\n"
            "  target_link_libraries(headers PRIVATE palpate::${part})\nendforeach()\n")
        self.build(source, "headers-build")

    def test_components_are_the_parts_with_headers(self):
        parts = {path.name for path in (self.prefix / "include/palpate").iterdir()}
        text = next(self.prefix.rglob("palpateConfig.cmake")).read_text()
        components = re.search(r"set\(palpate_COMPONENTS ([\w;]+)\)", text).group(1).split(";")
        self.assertEqual(set(components), parts)
        page = (SOURCE / "docs/library.md").read_text().split("## Components")[1].split("\n## ")[0]
        told = {name for row in re.findall(r"^\| ([a-z, ]+) \|", page, re.M) for name in row.split(", ")}
        self.assertEqual(told - {"component"}, parts)

    def test_page_shows_the_programs(self):
        page = (SOURCE / "docs/library.md").read_text()
        shown = re.findall(r"^```cpp\n(.*?)^```$", page, re.M | re.S)[1:]
        programs = {path: path.read_text() for path in sorted((HERE / "programs").glob("*.cpp"))}
        self.assertEqual(len(shown), len(programs))
        for path, text in programs.items():
            with self.subTest(program=path.name):
                self.assertTrue(any(piece in text for piece in shown))

    def test_program_of_the_documentation(self):
        """docs/library.md's first program runs the scene of README.md."""
        pages = (SOURCE / "docs/library.md").read_text() + (SOURCE / "README.md").read_text()
        source = self.folder / "mine"
        source.mkdir()
        fences = re.findall(r"^```(cmake|cpp|toml)\n(.*?)^```$", pages, re.M | re.S)
        blocks = {language: text for language, text in reversed(fences)}
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
        self.assertRegex(text, r'This palpate has no component\s+"wand"\s+\(it\s+has:\s+core')

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

    def test_version_that_is_not_there_is_refused(self):
        source = self.folder / "newer"
        source.mkdir()
        (source / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.25)\nproject(newer CXX)\n"
                                               "find_package(palpate 99.0 REQUIRED COMPONENTS core)\n")
        status, text = self.configure(source, self.folder / "newer-build")
        self.assertNotEqual(status, 0)
        self.assertIn("99.0", text)

    def test_installed_program_finds_its_libraries_and_scenes(self):
        self.assertTrue((self.prefix / "share/palpate/published_timings.json").exists())
        status, text = call(self.prefix / "bin" / "palpate", "list", "scenes")
        self.assertEqual(status, 0, text)
        for scene in sorted((SOURCE / "scenes").glob("*.toml")):
            self.assertIn(scene.stem, text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
