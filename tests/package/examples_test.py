#!/usr/bin/env python3
"""Builds and runs the programs of examples/ with the commands of examples/README.md, against an installed
copy, and compares the printed results with theory.

    examples_test.py BUILD [CXX]
"""
import json
import math
import re
import sys
import unittest

from installed import CLEAN, COMPILER, SOURCE, Installed, call, figures_in

EXAMPLES = SOURCE / "examples"
README = (EXAMPLES / "README.md").read_text()
PROGRAMS = sorted(path.stem for path in EXAMPLES.glob("*.cpp"))


class Examples(Installed):
    @classmethod
    def setUpClass(cls):
        """Runs the commands in a folder with only examples/; HOME contains the installed palpate."""
        super().setUpClass()
        cls.clone = cls.folder / "clone"
        cls.clone.mkdir()
        (cls.clone / "examples").symlink_to(EXAMPLES)
        environment = {**CLEAN, "HOME": str(cls.prefix.parent), "CXX": COMPILER, "CMAKE_GENERATOR": "Ninja"}
        commands = re.search(r"^```sh\n(.*?)^```$", README, re.M | re.S).group(1).splitlines()
        if commands[:2] != ["./palpate build installable",
                            'cmake --install build/release --prefix "$HOME/palpate"']:
            raise AssertionError("examples/README.md begins with other commands than the installation")
        cls.printed = {}
        for line in commands[2:]:
            status, text = call("bash", "-c", line, env=environment, cwd=cls.clone, timeout=500)
            if status != 0:
                raise AssertionError(f"{line}: status {status}\n{text}")
            cls.printed[line.removeprefix("build/examples/")] = text

    def figures(self, program, pattern):
        return figures_in(self.printed[program], pattern)

    def test_readme_lists_and_runs_every_example(self):
        self.assertGreaterEqual(len(PROGRAMS), 5)
        listed = re.findall(r"^\| \[(\w+\.(?:cpp|c|py))\]\(\1\) \| [^|]+ \|$", README, re.M)
        files = [path.name for pattern in ("*.cpp", "*.c", "*.py") for path in EXAMPLES.glob(pattern)]
        self.assertEqual(sorted(listed), sorted(files))
        self.assertEqual([program for program in PROGRAMS if program not in self.printed], [])

    def test_every_result_is_checked(self):
        checked = {name.removeprefix("test_result_of_") for name in dir(self)
                   if name.startswith("test_result_of_")}
        self.assertEqual(sorted(checked), PROGRAMS)

    def test_examples_are_short(self):
        for path in EXAMPLES.glob("*.*"):
            self.assertLessEqual(len(path.read_text().splitlines()), 120, path.name)

    def test_result_of_step_body(self):
        longer, theory = self.figures("step_body", "ok at 2 s after \\d+ steps: longer by NUMBER m, "
                                      "by theory rho g L.2 / 2E = NUMBER m")
        self.assertAlmostEqual(theory, 1000 * 9.81 * 0.1**2 / 2e5, delta=1e-8)
        self.assertAlmostEqual(longer, theory, delta=0.01 * theory)

    def test_result_of_custom_force(self):
        shift, theory, energy, before = self.figures(
            "custom_force", "ok: shifted by NUMBER m, by theory d cos.w t. = NUMBER m; "
            "energy NUMBER J, at the start NUMBER J")
        self.assertAlmostEqual(theory, 0.02 * math.cos(5.0), delta=1e-8)
        # the midpoint rule at w h = 0.01 rotates by w t (1 - (w h)^2/12): 4e-5 rad less, times 0.02 sin(5) m
        self.assertAlmostEqual(shift, theory, delta=2e-6)
        self.assertAlmostEqual(energy, before, delta=1e-5 * before)

    def test_result_of_custom_device(self):
        height, force, theory = self.figures(
            "custom_device", "ok: 1500 ticks, tool at NUMBER m; on the hand NUMBER N, "
            "by theory -m g = NUMBER N")
        self.assertAlmostEqual(theory, -0.981, delta=1e-9)
        self.assertAlmostEqual(force, theory, delta=0.01)  # the limiter's curve: 1 % below half the maximum
        # m g / k below the handle, which has risen for 1.5 s
        self.assertAlmostEqual(height, 0.03 - 0.981 / 300.0, delta=2e-5)

    def test_result_of_custom_integrator(self):
        coarse, step, fine, order = self.figures(
            "custom_integrator", "ok: error NUMBER m at NUMBER s, NUMBER m at half the step: order NUMBER, "
            "by theory 2")
        self.assertEqual(step, 1e-4)
        self.assertLess(coarse, 1e-3)
        self.assertAlmostEqual(math.log2(coarse / fine), order, delta=0.02)  # printed with three digits
        self.assertAlmostEqual(order, 2.0, delta=0.05)

    def test_result_of_custom_material(self):
        force, force_theory, width, width_theory = self.figures(
            "custom_material", "ok: force NUMBER N, by theory NUMBER N; width NUMBER m, by theory NUMBER m")
        self.assertAlmostEqual(force_theory, 1e4 / 2 * 1.5 * 1.25 * 0.02**2, delta=1e-9)
        self.assertAlmostEqual(width_theory, 0.02 * math.sqrt(1.0 - 0.3 * 1.25), delta=1e-7)
        self.assertAlmostEqual(force, force_theory, delta=1e-5 * force_theory)
        self.assertAlmostEqual(width, width_theory, delta=1e-5 * width_theory)

    def test_a_wrong_result_is_found(self):
        pattern = "ok: NUMBER m, by theory NUMBER m"
        for text in ("ok: 1 m", "ok: 1 m, by theory 2 m; more", "a step failed: 1 m, by theory 1 m"):
            with self.assertRaises(AssertionError):
                figures_in(text, pattern)
        self.assertEqual(figures_in("ok: -1e-3 m, by theory 2 m\n", pattern), [-1e-3, 2.0])

    def test_soft_bodies_need_no_other_library(self):
        """Builds all but custom_device without Simbody, HDF5 and pkg-config."""
        hidden = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON" for name in ("Simbody", "HDF5", "PkgConfig")]
        folder = self.build(EXAMPLES, "soft", "-DWITH_DEVICE=OFF", *hidden)
        for program in PROGRAMS:
            if program == "custom_device":
                continue
            loaded = call("ldd", folder / program)[1]
            self.assertIn("libpalpate_integrate", loaded)
            self.assertIn("moved elsewhere", loaded)
            self.assertNotRegex(loaded, "(?i)simtk|libEGL|libGL|epoxy|hdf5|sqlite|cairo|not found")
        # a component that needs them reports it
        status, text = self.configure(EXAMPLES, self.folder / "hidden", *hidden)
        self.assertNotEqual(status, 0)
        self.assertIn("Simbody", text)

    def test_driver_needs_the_header_alone_and_moves_a_tool(self):
        self.assertLessEqual(len((EXAMPLES / "device_driver.c").read_text().splitlines()), 60)
        commands = re.findall(r"^```sh\n(.*?)^```$", README, re.M | re.S)[1]
        environment = {**CLEAN, "HOME": str(self.prefix.parent)}
        status, text = call("bash", "-e", "-c", commands, env=environment, cwd=self.clone, timeout=500)
        self.assertEqual(status, 0, text)
        summary = json.loads((self.clone / "out/driver/summary.json").read_text())
        (hand,) = summary["figures"]["hands"]
        self.assertEqual(hand["max_force_n"], 5.0)
        self.assertGreater(hand["peak_force_n"], 0.1)
        # it includes one header of palpate, which includes none
        header = (self.prefix / "include/palpate/device/plugin.h").read_text()
        self.assertEqual(re.findall(r"#include (.*)", header), ["<stdint.h>"])

    def test_page_of_the_library_shows_examples(self):
        page = (SOURCE / "docs/library.md").read_text()
        shown = re.findall(r"^```cpp\n(.*?)^```$", page, re.M | re.S)[1:]
        self.assertGreaterEqual(len(shown), 3)
        programs = [path.read_text() for path in EXAMPLES.glob("*.cpp")]
        for text in shown:
            self.assertTrue(any(text in program for program in programs), text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
