#!/usr/bin/env python3
"""docs/meshes.md quotes the program's messages: each message of the first table is that of its file under
tests/mesh/broken, each of the second occurs in the sources of `palpate model`.

    meshes_test.py PROGRAM
"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from pages import DOCS, TREE, table_rows  # noqa: E402

PROGRAM = Path(sys.argv[1]).resolve()
PAGE = (DOCS / "meshes.md").read_text()
BODY = """[scene]
name = "x"
duration_s = 0.1
[[body]]
name = "body"
mesh = { file = "FILE" }
youngs_modulus_pa = 1e4
[integrator]
name = "linearly-implicit-euler"
step_s = 0.01
"""
TOOL = """[scene]
name = "x"
duration_s = 0.1
[tool]
shape = "mesh"
mesh = { file = "FILE" }
mass_kg = 0.1
inertia_kg_m2 = [1e-5, 1e-5, 1e-5]
[tool.coupling]
stiffness_n_m = 300.0
[[device.keyframe]]
time_s = 0.0
[[obstacle]]
name = "floor"
type = "plane"
[[contact]]
between = ["tool", "floor"]
"""


def messages(heading):
    return [re.search(r"`(.*)`", cells[0]).group(1) for at, cells in table_rows(PAGE) if at == heading
            and cells[0] != "message"]


class Refusals(unittest.TestCase):
    def test_of_a_scene(self):
        quoted = messages("Errors in scenes")
        self.assertGreaterEqual(len(quoted), 15)
        with tempfile.TemporaryDirectory() as folder:
            for file in (TREE / "tests/mesh/broken").iterdir():
                shutil.copy(file, folder)
            for message in quoted:
                with self.subTest(message=message):
                    file = re.match(r"[\w.]+\.(msh|ele|node|obj)", message).group()
                    scene = (TOOL if file.endswith(".obj") else BODY).replace("FILE", file)
                    (Path(folder) / "scene.toml").write_text(scene)
                    done = subprocess.run([PROGRAM, "inspect", "scene.toml"], cwd=folder, capture_output=True,
                                          text=True, timeout=60)
                    self.assertEqual(done.returncode, 1, done.stdout)
                    self.assertEqual(done.stderr.strip(), "palpate: error: " + message)

    def test_of_palpate_model(self):
        quoted = messages("Errors of `palpate model`")
        self.assertGreaterEqual(len(quoted), 12)
        files = [*(TREE / "src/model").glob("*.cpp"), *(TREE / "src/cli/model_program").glob("*.cpp")]
        text = re.sub(r'"\s*"', "", "\n".join(file.read_text() for file in files))
        for message in quoted:
            with self.subTest(message=message):
                pattern = r"[^\n]{0,200}?".join(re.escape(part) for part in re.split(r"\.\.\.", message))
                self.assertTrue(re.search(pattern, text), "no source says so")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
