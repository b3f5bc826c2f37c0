#!/usr/bin/env python3
"""Limits of the machine: memory that a run needs, and instruction sets that it may use.

    machine_limits_test.py PROGRAM [unittest's names of tests]
"""
import os
import re
import resource
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

from failing_run import Case
from program import PROGRAM

SKINNED = """
[scene]
name = "a fine skin"
duration_s = 0.02
[[body]]
name = "ball"
mesh = { file = "fine.h5" }
skin = true
proxies = true
youngs_modulus_pa = 2e4
poissons_ratio = 0.4
[[obstacle]]
name = "floor"
type = "plane"
position_m = [0, 0, -0.029]
[[contact]]
between = ["ball", "floor"]
stiffness_pa_m = 1e6
[integrator]
name = "linearly-implicit-euler"
step_s = 0.01
"""


class Memory(Case):
    def compare(self, *scene):
        text = self.good("inspect", "--all", *scene)
        said = float(re.search(r"estimated memory of a run \[MiB\] +(\d+)", text).group(1))
        with open(os.devnull, "w", encoding="utf-8") as null:
            process = subprocess.Popen([PROGRAM, "run", *scene, "--duration-s", "0.01", "-o", "x"],
                                       cwd=self.folder, stdout=null)
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = status
        self.assertEqual(status, 0)
        peak = usage.ru_maxrss / 1024
        self.assertGreater(peak, 60, "small ones say nothing")
        self.assertLess(max(said / peak, peak / said), 2, f"{said} MiB said, {peak:.0f} at the peak")
        return said

    def test_the_estimate_counts_skins(self):
        if not (Path(PROGRAM).parent / "palpate-model").exists():
            self.skipTest("this build makes no models")
        self.good("model", "ball", "--skin-vertices", "200000", "-o", "fine.h5", "-q")
        (self.folder / "fine.toml").write_text(SKINNED)
        self.assertGreater(self.compare("fine.toml"), 70)  # 41 of these without its skin
        self.assertGreater(self.compare("fine.toml", "--set", 'contact.0.method="distance"'), 200)

    def test_the_estimate_is_within_a_factor_of_two(self):
        scenes = (["press-ball", "--set", "body.0.mesh.element_size_m=0.003"],
                  ["falling-ball", "--set", "body.0.mesh.element_size_m=0.004", "--integrator",
                   "linearly-implicit-euler", "--set", "integrator.step_s=0.002"],
                  ["falling-ball", "--set", "body.0.mesh.element_size_m=0.003", "--integrator",
                   "linearly-implicit-euler", "--set", "integrator.step_s=0.002", "--set",
                   "integrator.linear_solver=pcg-single"])
        for scene in scenes:
            with self.subTest(scene=scene):
                self.compare(*scene)

    def test_what_does_not_fit_is_refused_with_figures(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (600 << 20, 600 << 20))
        big = ["--set", "body.0.mesh.element_size_m=0.0015"]
        text = self.refused("run", "press-ball", *big, "-o", "big", before=limit)
        self.assertRegex(text, r"[\d.]+ (GiB|MiB) of memory .*[\d.]+ (GiB|MiB) are available after reserving "
                               r"[\d.]+ MiB of address space for libraries "
                               r"\(the limit on address space, ulimit -v\)")
        self.assertIn("tetrahedra", text)
        self.assertIn("element_size_m", text)
        self.assertIn("--beyond-memory", text)
        self.assertFalse((self.folder / "big").exists(), "nothing was begun")
        done = self.call("run", "press-ball", *big, "--beyond-memory", "-o", "big", before=limit)
        self.assertEqual(done.returncode, 1)
        # the first to reach the limit depends on the libraries' releases
        self.assertRegex(done.stderr, "no memory for the factor|not enough memory")
        self.good("run", "press-ball", "--duration-s", "0.01", "-o", "small", before=limit)


class Instructions(Case):
    def test_a_set_that_is_not_there_is_refused(self):
        text = self.refused("run", "press-ball", PALPATE_INSTRUCTIONS="sse9")
        self.assertIn('PALPATE_INSTRUCTIONS = "sse9"', text)
        self.assertIn("baseline", text)
        self.good("run", "press-ball", "--duration-s", "0.01", PALPATE_INSTRUCTIONS="baseline")

    def test_code_beyond_the_baseline_is_chosen_at_run_time(self):
        """Vector instructions beyond x86-64's baseline occur only in functions whose names state the
        instruction set."""
        if os.uname().machine != "x86_64" or not shutil.which("objdump"):
            self.skipTest("x86-64 and objdump (package binutils)")
        linked = subprocess.run(["ldd", PROGRAM], capture_output=True, text=True, check=True).stdout
        files = [PROGRAM, *(Path(path) for path in re.findall(r"=> (\S*libpalpate\S*)", linked))]
        model = PROGRAM.parent / "palpate-model"
        chosen, others = 0, []
        for file in [*files, *([model] if model.exists() else [])]:
            ours, not_ours = beyond_baseline(file)
            chosen += ours
            others += [f"{file.name}: {name}" for name in not_ours]
        self.assertEqual(others, [])
        self.assertGreater(chosen, 50, "the kernels themselves must be found")


def beyond_baseline(file):
    """Functions with instructions of AVX or later: number of those named after their set, and list of all
    others."""
    function = re.compile(r"^[0-9a-f]+ <(.*)>:$")
    # VEX and EVEX: a leading v, except for VERR, VERW and virtualisation; and mask register instructions
    vector = re.compile(r"^\s+[0-9a-f]+:\s+(v(?!err|erw|m)[a-z0-9]+|vm(?!call|run|load|save|x|func)[a-z0-9]+|"
                        r"k(?:mov|and|or|xor|not|unpck|shift|test|add|xnor)[a-z]*)\s")
    named = re.compile(r"avx2|avx512|arch_x86_64_v[34]")
    name, ours, others = "", set(), set()
    command = ["objdump", "--disassemble", "--demangle", "--no-show-raw-insn", file]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, errors="replace") as process:
        for line in process.stdout:
            if found := function.match(line):
                name = found.group(1)
            elif vector.match(line):
                (ours if named.search(name) else others).add(name)
    return len(ours), sorted(others)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
