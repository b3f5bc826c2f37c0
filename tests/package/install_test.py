#!/usr/bin/env python3
"""Installs the build, moves the installed tree, and builds and runs programs that use only this tree: the
program of docs/library.md, and one with Simbody and SUNDIALS in one process.
examples_test.py runs examples/.

    install_test.py BUILD [CXX]
"""
import re
import sys
import unittest

from installed import BUILD, HERE, SOURCE, Installed, call


class Package(Installed):
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

    def test_every_promised_header_can_be_included(self):
        """Includes all headers together, from the installed folder only."""
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

    def test_program_of_the_documentation(self):
        """The first program of docs/library.md runs the scene of README.md."""
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
        status, text = call(self.prefix / "bin" / "palpate", "list", "scenes")
        self.assertEqual(status, 0, text)
        for scene in sorted((SOURCE / "scenes").glob("*.toml")):
            self.assertIn(scene.stem, text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
