#!/usr/bin/env python3
"""Scenes from files, texts and dicts: accepted and rejected input, with the messages."""
import os
import tempfile
import tomllib
import unittest
from pathlib import Path
from unittest import mock

from built import SCENES, refusal_of_program
import numpy as np
import palpate
from palpate import _toml


def tables_of(name):
    return tomllib.loads((SCENES / f"{name}.toml").read_text())


class Read(unittest.TestCase):
    def test_a_file(self):
        scene = palpate.load(str(SCENES / "press-ball.toml"))
        self.assertEqual((scene.name, scene.duration_s), ("press-ball", 0.4))
        self.assertEqual(scene.text, (SCENES / "press-ball.toml").read_text())
        self.assertEqual(scene.path, str(SCENES / "press-ball.toml"))
        self.assertIn("press-ball", repr(scene))

    def test_every_scene_is_the_same_as_a_dict(self):
        seen = 0
        for file in sorted(SCENES.glob("*.toml")):
            with self.subTest(scene=file.stem):
                tables = tomllib.loads(file.read_text())
                text = palpate.Scene(tables, folder=str(SCENES)).toml
                self.assertEqual(tomllib.loads(text), tables)
                seen += 1
        self.assertGreater(seen, 15)

    def test_meshes_of_a_dict_are_looked_for_in_its_folder(self):
        tables = tables_of("user-mesh")
        simulation = palpate.Simulation(palpate.Scene(tables, folder=str(SCENES)))
        self.assertGreater(len(simulation.bodies[0].positions), 4)
        with tempfile.TemporaryDirectory() as folder, self.assertRaises(palpate.Error) as caught:
            palpate.Simulation(palpate.Scene(tables, folder=folder))
        self.assertIn(folder, str(caught.exception))


    def test_a_model_that_was_not_made_yet(self):
        with tempfile.TemporaryDirectory() as folder, mock.patch.dict(os.environ, PALPATE_MODELS=folder):
            scene = palpate.load(SCENES / "gears.toml")
            for refused in (palpate.Simulation, palpate.compare):
                with self.assertRaisesRegex(palpate.Error, f"palpate model gear -o {folder}"):
                    refused(scene)


class Written(unittest.TestCase):
    def test_values_of_python_and_numpy(self):
        for value, text in ((True, "true"), (3, "3"), (0.1, "0.1"), (1e-20, "1e-20"), ("a", '"a"'),
                            ((1, 2.0), "[1, 2.0]"), (np.float64(0.1), "0.1"), (np.int32(4), "4"),
                            (np.array([1.0, 2.5]), "[1.0, 2.5]"), (Path("a/b"), '"a/b"')):
            with self.subTest(value=value):
                self.assertEqual(_toml.value(value), text)

    def test_what_is_written_reads_back(self):
        awkward = {"text": 'quote " back \\ line\n tab\t bell\a \x7f \u00e9', "a b": 1,
                   "floats": [1e300, 5e-324, -0.0],
                   "infinite": [float("inf"), float("-inf")], "empty": [],
                   "table": {"inner": {"x": 1}, "after": 2}, "list": [{"x": 1, "more": [{"y": 2}]}, {}],
                   "mixed": [[1, 2], ["a"]]}
        self.assertEqual(tomllib.loads(_toml.document(awkward)), awkward)

    def test_what_no_scene_holds_is_refused(self):
        for value in (None, 1j, object(), {1: 2}, [None]):
            with self.subTest(value=value), self.assertRaises(palpate.Error):
                _toml.value(value)
        with self.assertRaises(palpate.Error):
            palpate.Scene({"scene": {"name": None}})


class Changed(unittest.TestCase):
    def test_a_change_is_in_the_toml_and_not_in_the_text(self):
        scene = palpate.load(str(SCENES / "press-ball.toml"))
        scene.set("integrator.rtol", 1e-4)
        scene.set_all({"body.0.name": "sphere", "contact.0.between": ["sphere", "floor"],
                       "contact.1.between": ("sphere", "tool")})
        tables = tomllib.loads(scene.toml)
        self.assertEqual(tables["integrator"]["rtol"], 1e-4)
        self.assertEqual(tables["contact"][1]["between"], ["sphere", "tool"])
        self.assertEqual(tomllib.loads(scene.text)["integrator"]["rtol"], 1e-3)
        self.assertEqual(scene.changes[0], "integrator.rtol=0.0001")
        self.assertEqual(len(scene.changes), 4)

    def test_a_refused_change_leaves_the_scene_as_it_was(self):
        scene = palpate.load(str(SCENES / "press-ball.toml"))
        before = scene.toml
        for path, value in (("integrator.rtoll", 1e-3), ("body.0.poissons_ratio", 0.6), ("body.7.name", "x"),
                            ("integrator.rtol", "small"), ("integrator.rtol", None)):
            with self.subTest(path=path), self.assertRaises(palpate.Error):
                scene.set(path, value)
            self.assertEqual(scene.toml, before)
        with self.assertRaises(palpate.Error):
            scene.set_all({"integrator.rtol": 1e-4, "body.0.name": "sphere"})  # contacts refer to a "ball"
        self.assertEqual(scene.toml, before)
        self.assertEqual(scene.changes, [])

    def test_a_copy_is_changed_by_itself(self):
        scene = palpate.load(SCENES / "press-ball.toml")
        other = scene.copy()
        other.set("integrator.rtol", 1e-4)
        self.assertEqual(scene.toml, palpate.load(SCENES / "press-ball.toml").toml)
        self.assertNotEqual(other.toml, scene.toml)

    def test_keys_that_another_integrator_has_no_use_for(self):
        scene = palpate.load(str(SCENES / "press-ball.toml"))
        scene.set("integrator.name", "linearly-implicit-euler")
        self.assertEqual(scene.not_carried_over, ["integrator.rtol"])


class Refused(unittest.TestCase):
    def test_the_message_is_the_programs(self):
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "bad.toml"
            for old, new in (("poissons_ratio = 0.4", "poissons_ratio = 0.5"),
                             ("poissons_ratio", "poisons_ratio"), ('"cvode-bdf"', '"cvode-bfd"'),
                             ("[tool]", "[tool")):
                with self.subTest(new=new):
                    text = (SCENES / "press-ball.toml").read_text()
                    self.assertIn(old, text)
                    file.write_text(text.replace(old, new, 1))
                    with self.assertRaises(palpate.Error) as caught:
                        palpate.load(str(file))
                    self.assertIn(str(file), str(caught.exception))
                    self.assertIn(str(caught.exception).splitlines()[0], refusal_of_program("run", file))

    def test_it_is_a_value_error(self):
        with self.assertRaises(ValueError) as caught:
            palpate.load("no-such-scene.toml")
        self.assertIs(type(caught.exception), palpate.Error)

    def test_a_dict_with_a_wrong_key(self):
        tables = tables_of("press-ball")
        tables["body"][0]["youngs_module_pa"] = 1e4
        with self.assertRaises(palpate.Error) as caught:
            palpate.Scene(tables)
        self.assertRegex(str(caught.exception), r"^dict:\d+:\d+: .*youngs_module_pa.*youngs_modulus_pa")


if __name__ == "__main__":
    unittest.main(argv=[__file__])
