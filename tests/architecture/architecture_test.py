#!/usr/bin/env python3
"""The tree keeps the allowed dependencies between parts; planted violations show that the check detects
them."""
import re
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import arrows

TREE = Path(__file__).resolve().parents[2]

SOUND = {
    "include/palpate/core/types.h": "#pragma once\n",
    "include/palpate/fem/spec.h": "#pragma once\n",
    "include/palpate/device/spec.h": '#pragma once\n#include "palpate/fem/spec.h"\n',
    "include/palpate/fem/body.h": '#include "palpate/core/types.h"\n#include "palpate/fem/spec.h"\n',
    "src/gl/context.h": "#include <epoxy/gl.h>\n",
    "include/palpate/scene/description.h": '#include "palpate/fem/spec.h"\n',
    "include/palpate/experiments/compare.h": '#include "palpate/scene/description.h"\n',
    "validation/validation.h": '#include "palpate/fem/body.h"\n',
    "src/store/CMakeLists.txt": "palpate_shared_headers(store\n  csv.h)\n",
    "src/store/csv.h": '#include "palpate/core/types.h"\n',
    "src/report/table.cpp": '#include "store/csv.h"\n',
    "src/fem/body.cpp": '#include "palpate/fem/body.h"\n#include "element.h"\n#include <vector>\n',
    "src/fem/element.h": '#pragma once\n#include "../fem/shape.h"\n',
    "src/fem/shape.h": "#pragma once\n",
    "src/cli/main.cpp": "#include <CLI/CLI.hpp>\n",
    "src/fem/CMakeLists.txt": "palpate_part(fem PUBLIC palpate::core)  # not palpate::tool\n",
    "validation/case.cpp": '#include "palpate/fem/body.h"\n',
    "benchmarks/product/fem.h": '#include "palpate/fem/body.h"\n',
    "benchmarks/product/program/main.cpp": '#include "product/fem.h"\n#include <CLI/CLI.hpp>\n',
    "tests/fem/body_test.cpp": '#include "fem/element.h"\n',
}


def breaches_of(extra):
    with tempfile.TemporaryDirectory() as folder:
        for path, text in {**SOUND, **extra}.items():
            file = Path(folder) / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        return arrows.check(folder)


class Tree(unittest.TestCase):
    def test_arrows_of_the_tree(self):
        self.assertEqual(arrows.check(TREE), [])

    def test_table_covers_every_part_and_has_no_cycle(self):
        parts = {path.name for folder in ("include/palpate", "src")
                 for path in (TREE / folder).iterdir() if path.is_dir()}
        self.assertEqual(parts - set(arrows.ALLOWED), set())
        table = {part: list(below) for part, below in arrows.ALLOWED.items() if part != "validation"}
        self.assertIsNone(arrows.find_cycle(table))

    def test_one_header_knows_the_releases_of_sundials(self):
        words = re.compile("SUNDIALS_VERSION_M|SUNContext_Create|SUN_COMM_NULL|ErrHandlerFn|PushErrHandler")
        files = [path for folder in ("src", "include") for path in (TREE / folder).rglob("*.[ch]*")]
        self.assertGreater(len(files), 500)
        self.assertEqual([path.relative_to(TREE).as_posix() for path in files
                          if words.search(path.read_text(encoding="utf-8"))],
                         ["src/integrate/sundials/release.h"])


class Planted(unittest.TestCase):
    def expect(self, extra, *words):
        breaches = breaches_of(extra)
        self.assertEqual(len(breaches), 1, breaches)
        for word in words:
            self.assertIn(word, breaches[0])

    def test_sound_tree_passes(self):
        self.assertEqual(breaches_of({}), [])

    def test_arrow_upwards(self):
        self.expect({"src/core/bad.cpp": '\n#include "palpate/fem/body.h"\n'},
                    "src/core/bad.cpp:2:", "core may not include fem")

    def test_arrow_in_a_public_header_with_angle_brackets(self):
        self.expect({"include/palpate/device/bad.h": "#include <palpate/fem/body.h>\n"},
                    "device may not include fem")

    def test_arrow_through_a_relative_path(self):
        self.expect({"src/core/bad.cpp": '#include "../../include/palpate/fem/body.h"\n'},
                    "core may not include fem")

    def test_scene_knows_only_plain_data(self):
        self.expect({"src/scene/load.cpp": '#include "palpate/fem/body.h"\n'}, "scene may not include fem")

    def test_plain_data_is_made_of_plain_data_only(self):
        self.expect({"include/palpate/mesh/spec.h": '#include "palpate/fem/body.h"\n'},
                    "mesh may not include fem")

    def test_comparison_sees_scenes_not_their_parts(self):
        self.expect({"src/experiments/compare.cpp": '#include "palpate/fem/body.h"\n'},
                    "experiments may not include fem")

    def test_validation_does_not_know_the_command_line(self):
        self.expect({"include/palpate/cli/bad.h": "\n",
                     "validation/bad.cpp": '#include "palpate/cli/bad.h"\n'},
                    "validation may not include cli")

    def test_the_matrix_is_no_part_of_the_library(self):
        row = {"validation/stability/row.h": "\n"}
        self.expect({**row, "src/haptic_stability/bad.cpp": '#include "stability/row.h"\n'},
                    "haptic_stability may not include stability")
        self.expect({**row, "validation/bad.cpp": '#include "stability/row.h"\n'},
                    "validation may not include stability")

    def test_benchmarks_stand_above_the_library_and_below_their_program(self):
        self.expect({"src/loop/bad.cpp": '#include "product/fem.h"\n'}, "loop may not include bench")
        self.expect({"include/palpate/cli/bad.h": "\n",
                     "benchmarks/product/bad.cpp": '#include "palpate/cli/bad.h"\n'},
                    "bench may not include cli")

    def test_private_header_of_another_part(self):
        self.expect({"src/contact/a.h": "\n", "src/loop/bad.cpp": '#include "contact/a.h"\n'},
                    "contact/a.h is private to contact")

    def test_lower_folder_of_a_part_does_not_see_the_rest_of_it(self):
        world = {"include/palpate/loop/world.h": "#pragma once\n",
                 "src/loop/coupling/step.h": '#include "palpate/dynamics/system.h"\n',
                 "include/palpate/dynamics/system.h": "#pragma once\n"}
        self.assertEqual(breaches_of({**world, "src/loop/run.cpp": '#include "coupling/step.h"\n'}), [])
        self.expect({**world, "src/loop/coupling/step.cpp": '#include "step.h"\n'
                     '#include "palpate/loop/world.h"\n'},
                    "src/loop/coupling/step.cpp:2:", "rest of loop", "world.h")

    def test_wrapped_library_is_for_those_that_may_include_it(self):
        wrapper = {"src/simbody/headers.h": "#include <SimTKsimbody.h>\n"}
        self.assertEqual(breaches_of({**wrapper, "src/tool/body.h": '#include "simbody/headers.h"\n'}),
                         [])
        breaches = breaches_of({**wrapper, "src/fem/bad.cpp": '#include "simbody/headers.h"\n'})
        self.assertTrue(any("fem may not include simbody" in breach for breach in breaches), breaches)

    def test_promised_header_includes_one_that_is_not_installed(self):
        self.expect({"include/palpate/fem/bad.h": '#include "fem/element.h"\n'},
                    "include/palpate/fem/bad.h:1:", "fem/element.h", "not installed")
        self.expect({"src/core/CMakeLists.txt": "palpate_shared_headers(core shared.h)\n",
                     "src/core/shared.h": "\n",
                     "include/palpate/fem/bad.h": '#include "core/shared.h"\n'},
                    "include/palpate/fem/bad.h:1:", "core/shared.h", "not installed")

    def test_shared_headers_keep_the_arrows(self):
        self.expect({"src/fem/bad.cpp": '#include "store/csv.h"\n'}, "fem may not include store")
        self.expect({"src/core/bad.h": '#include "palpate/fem/body.h"\n'},
                    "src/core/bad.h:1:", "core may not include fem")

    def test_shared_header_that_no_other_part_includes(self):
        self.expect({"src/fem/CMakeLists.txt": "palpate_shared_headers(fem element.h)\n"},
                    "src/fem/element.h:1:", "no other part includes it")

    def test_unknown_part(self):
        self.expect({"src/magic/wand.cpp": "\n"}, "not in the table")

    def test_header_that_does_not_exist(self):
        self.expect({"src/fem/bad.cpp": '#include "palpate/fem/gone.h"\n'}, "does not exist")

    def test_cycle_of_files_in_one_part(self):
        self.expect({"src/fem/shape.h": '#include "element.h"\n'},
                    "include cycle", "src/fem/element.h", "src/fem/shape.h")

    def test_cycle_of_units_in_one_part(self):
        # b.h needs a type of a.h, and a.cpp calls a function of b.h: the type belongs in a third header.
        planted = {"src/fem/a.h": '#pragma once\n', "src/fem/a.cpp": '#include "a.h"\n#include "b.h"\n',
                   "src/fem/b.h": '#pragma once\n#include "a.h"\n'}
        self.expect(planted, "fem: ", "a, b")
        self.expect({**planted, "src/fem/a.cpp": "\n", "src/fem/a_impl.h": '#include "fem/b.h"\n'}, "a, b")
        self.expect({**planted, "src/fem/a.h": "\n", "src/fem/b.h": '#include "palpate/fem/a.h"\n',
                     "include/palpate/fem/a.h": '#pragma once\n'}, "a, b")
        self.expect({"validation/stability/a.h": "\n",
                     "validation/stability/a.cpp": '#include "stability/b.h"\n',
                     "validation/stability/b.cpp": '#include "stability/a.h"\n',
                     "validation/stability/b.h": "\n"}, "stability: ", "a, b")

    def test_cycle_of_three_units_beside_a_sound_chain(self):
        self.expect({"src/fem/a.h": "\n", "src/fem/b.h": "\n", "src/fem/c.h": "\n",
                     "src/fem/a.cpp": '#include "b.h"\n', "src/fem/b.cpp": '#include "c.h"\n',
                     "src/fem/c.cpp": '#include "a.h"\n#include "shape.h"\n'}, "fem: ", "cycle: a, b, c")

    def test_units_of_the_same_name_in_two_parts_are_two(self):
        self.assertEqual(breaches_of({"include/palpate/core/a.h": "\n", "include/palpate/fem/a.h": "\n",
                                      "src/core/a.cpp": '#include "b.h"\n', "src/core/b.h": "\n",
                                      "src/fem/b.h": "#include <palpate/core/a.h>\n"}), [])

    def test_outside_libraries_stay_where_they_belong(self):
        planted = {"cvode/cvode.h": "SUNDIALS", "nvector/nvector_serial.h": "SUNDIALS",
                   "Simbody.h": "Simbody",
                   "SimTKmath.h": "Simbody",
                   "EGL/egl.h": "EGL", "epoxy/gl.h": "EGL", "ccd/ccd.h": "libccd",
                   "libqhull_r/qhull_ra.h": "Qhull",
                   "suitesparse/cholmod.h": "SuiteSparse",
                   "cholmod.h": "SuiteSparse", "CLI/CLI.hpp": "CLI11",
                   "toml++/toml.h": "toml++", "hdf5.h": "HDF5"}
        for header, library in planted.items():
            for folder in ("src/fem", "tests/fem", "validation"):
                with self.subTest(header=header, folder=folder):
                    self.expect({f"{folder}/bad.cpp": f"# include <{header}>\n"},
                                library, f"{folder}/bad.cpp:1:")

    def test_links(self):
        self.expect({"src/core/CMakeLists.txt": "palpate_part(core\n  PUBLIC palpate::fem)\n"},
                    "src/core/CMakeLists.txt:2:",
                    "core may not link palpate::fem")
        self.expect({"benchmarks/product/CMakeLists.txt": "target_link_libraries(b PRIVATE palpate::cli)\n"},
                    "benchmarks/product/CMakeLists.txt:1:", "bench may not link palpate::cli")

    def test_long_file(self):
        self.assertEqual(breaches_of({"src/fem/long.cpp": "\n" * 400}), [])
        self.expect({"src/fem/long.cpp": "\n" * 401}, "src/fem/long.cpp:401:", "401 lines")
        self.expect({"tests/fem/long_test.cpp": "\n" * 500}, "tests/fem/long_test.cpp", "500 lines")
        self.expect({"tests/cli/long_test.py": "\n" * 401}, "tests/cli/long_test.py:401:", "401 lines")



if __name__ == "__main__":
    unittest.main()
