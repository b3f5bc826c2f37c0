#!/usr/bin/env python3
"""States that are set, external forces, energies, bones, pictures and models."""
import os
import stat
import tempfile
import unittest
from pathlib import Path

from built import PROGRAM, SCENES
import numpy as np
import palpate

BLOCK = {"name": "block", "youngs_modulus_pa": 1e4, "poissons_ratio": 0.3, "density_kg_m3": 1000.0,
         "mesh": {"generator": "box", "size_m": [0.1, 0.1, 0.1], "element_size_m": 0.05}}


def scene_of(**more):
    return palpate.Scene({"scene": {"name": "block", "duration_s": 0.2}, "body": [BLOCK],
                          "integrator": {"name": "implicit-midpoint", "step_s": 0.01},
                          "record": {"states": False, "state_period_s": 0.01}, **more})


class States(unittest.TestCase):
    def test_forces_accelerate_by_newtons_law_and_stop_when_removed(self):
        for integrator in ({"name": "implicit-midpoint", "step_s": 0.01}, {"name": "cvode-bdf", "rtol": 1e-6},
                           {"name": "backward-euler", "step_s": 0.01}):
            with self.subTest(integrator=integrator["name"]):
                simulation = palpate.Simulation(scene_of(integrator=integrator), external_forces=True)
                block = simulation.body("block")
                np.testing.assert_array_equal(block.external_forces, 0.0)
                acceleration = np.array([3.0, 0.0, -1.0])
                block.apply_forces(block.masses[:, None] * acceleration)
                start = block.positions.copy()
                simulation.advance(0.1)
                np.testing.assert_allclose(block.velocities, np.tile(0.1 * acceleration, (len(start), 1)),
                                           atol=1e-5)
                block.apply_forces(np.zeros_like(start))
                simulation.advance(0.1)
                np.testing.assert_allclose(block.velocities, np.tile(0.1 * acceleration, (len(start), 1)),
                                           atol=1e-5)

    def test_without_the_request_nothing_is_added(self):
        simulation = palpate.Simulation(scene_of())
        block = simulation.body("block")
        with self.assertRaisesRegex(palpate.Error, r"Simulation\(scene, external_forces=True\)"):
            block.apply_forces(np.zeros_like(block.positions))
        with self.assertRaisesRegex(palpate.Error, r"Simulation\(scene, energy=True\)"):
            simulation.energy  # pylint: disable=pointless-statement

    def test_a_state_that_was_read_is_continued(self):
        first = palpate.Simulation(scene_of())
        block = first.body("block")
        velocities = np.zeros_like(block.positions)
        velocities[:, 0] = 5.0 * block.positions[:, 1]  # shears
        block.set_state(velocities=velocities)
        np.testing.assert_array_equal(block.velocities, velocities)
        first.advance(0.05)
        second = palpate.Simulation(scene_of())
        copy = second.body("block")
        copy.set_state(block.positions, block.velocities)
        first.advance(0.1)
        second.advance(0.1)
        self.assertGreater(np.abs(block.positions - block.rest_positions).max(), 1e-3)
        np.testing.assert_allclose(copy.positions, block.positions, rtol=0, atol=1e-9)

    def test_fixed_nodes_keep_their_place(self):
        body = {**BLOCK, "attachment": [{"box_min_m": [-1, -1, -1], "box_max_m": [-0.049, 1, 1]}]}
        simulation = palpate.Simulation(scene_of(body=[body]))
        block = simulation.body("block")
        fixed = block.positions[:, 0] < -0.049
        before = block.positions.copy()
        block.set_state(block.positions + 0.01)
        np.testing.assert_array_equal(block.positions[fixed], before[fixed])
        np.testing.assert_array_equal(block.positions[~fixed], before[~fixed] + 0.01)

    def test_bad_arrays(self):
        simulation = palpate.Simulation(scene_of(), external_forces=True)
        block = simulation.body("block")
        n = len(block.positions)
        before = block.positions.copy()
        for value, message in ((np.zeros((n, 2)), rf"positions must have the shape \({n}, 3\)"),
                               (np.zeros(3 * n), rf"and has \({3 * n}\)"),
                               (np.full((n, 3), np.nan), "positions must be finite"), ("abc", "an array of")):
            with self.assertRaisesRegex(palpate.Error, message):
                block.set_state(positions=value)
        with self.assertRaisesRegex(palpate.Error, "forces must be finite"):
            block.apply_forces(np.full((n, 3), np.inf))
        np.testing.assert_array_equal(block.positions, before)

    def test_energy_is_kept_in_free_flight(self):
        simulation = palpate.Simulation(scene_of(), energy=True)
        block = simulation.body("block")
        velocities = np.zeros_like(block.positions)
        velocities[:, 0] = 5.0 * block.positions[:, 1]
        block.set_state(velocities=velocities)
        at_start = 0.5 * (block.masses[:, None] * velocities**2).sum()
        simulation.run()
        energy = simulation.energy
        self.assertAlmostEqual(energy["kinetic_j"] + energy["elastic_j"], at_start, delta=0.01 * at_start)
        self.assertGreater(energy["elastic_j"], 0.01 * at_start)


class Bones(unittest.TestCase):
    def test_a_bone_falls(self):
        bone = {"name": "stone", "mass_kg": 0.2, "inertia_kg_m2": [1e-4, 1e-4, 1e-4]}
        block = {**BLOCK, "attachment": [{"to": "stone", "centre_m": [0.0, 0.0, 0.0], "radius_m": 0.06}]}
        scene = scene_of(bone=[bone], body=[block])
        scene.set("scene.gravity_m_s2", [0.0, 0.0, -10.0])
        simulation = palpate.Simulation(scene)
        (stone,) = simulation.bones
        self.assertEqual((stone.name, stone.mass), ("stone", 0.2))
        np.testing.assert_array_equal(stone.position, (0.0, 0.0, 0.0))
        simulation.run()
        stone = simulation.bone("stone")
        np.testing.assert_allclose(stone.position, (0.0, 0.0, -0.5 * 10.0 * 0.2**2), atol=1e-6)
        np.testing.assert_allclose(stone.velocity, (0.0, 0.0, -2.0), atol=1e-6)
        np.testing.assert_allclose(stone.rotation, (1.0, 0.0, 0.0, 0.0), atol=1e-6)
        np.testing.assert_allclose(stone.angular_velocity, 0.0, atol=1e-4)
        np.testing.assert_allclose((stone.force, stone.torque), np.zeros((2, 3)), atol=1e-4)
        # thrown upwards, the tissue pulls the bone up
        tissue = simulation.body("block")
        tissue.set_state(positions=tissue.positions + [0.0, 0.0, 0.001])
        self.assertGreater(stone.force[2], 0.1)
        with self.assertRaisesRegex(palpate.Error, 'the scene has no bone "ston" .did you mean "stone"'):
            simulation.bone("ston")
        with self.assertRaisesRegex(palpate.Error, "no \\[\\[bone\\]\\]"):
            palpate.Simulation(scene_of()).bone("stone")


class Pictures(unittest.TestCase):
    def test_the_present_state_is_drawn(self):
        simulation = palpate.Simulation(palpate.load(SCENES / "press-ball.toml"))
        simulation.advance(0.05)
        with tempfile.TemporaryDirectory(prefix="palpate-python-") as folder:
            sizes = {}
            for shade in ("displacement", "stress"):
                path = simulation.picture(Path(folder) / f"{shade}.png", shade=shade)
                self.assertEqual(path.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
                sizes[shade] = path.stat().st_size
            self.assertGreater(min(sizes.values()), 5000)
            later = simulation.time
            simulation.advance(0.1)
            self.assertGreater(simulation.time, later, "drawing changes nothing")
            self.assertNotEqual(simulation.picture(Path(folder) / "later.png").read_bytes(),
                                (Path(folder) / "displacement.png").read_bytes())
        with self.assertRaisesRegex(palpate.Error, "needs the contact of a query"):
            simulation.picture("x.png", shade="penetration")
        with self.assertRaisesRegex(palpate.Error, "displacment"):
            simulation.picture("x.png", shade="displacment")

    def test_drawing_does_not_change_the_simulation(self):
        positions = []
        for draws in (False, True):
            simulation = palpate.Simulation(palpate.load(SCENES / "press-ball.toml"))
            simulation.advance(0.1)
            if draws:
                with tempfile.TemporaryDirectory(prefix="palpate-python-") as folder:
                    simulation.picture(Path(folder) / "now.png")
            simulation.advance(0.05)
            positions.append(simulation.body("ball").positions.copy())
        np.testing.assert_array_equal(*positions)


class Models(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="palpate-python-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_a_shape_is_made_and_simulated(self):
        if not (PROGRAM.parent / "palpate-model").exists():
            self.skipTest("palpate-model was not built")
        model = palpate.make_model("ball", self.folder / "ball.h5", tetrahedra=500, proxies=0)
        self.assertEqual(model, self.folder / "ball.h5")
        body = {**BLOCK, "mesh": {"file": str(model)}}
        simulation = palpate.Simulation(scene_of(body=[body]))
        self.assertAlmostEqual(len(simulation.body("block").tetrahedra), 500, delta=25)
        with self.assertRaisesRegex(palpate.Error, "nothing.obj"):
            palpate.make_model(self.folder / "nothing.obj")

    def test_options_and_messages_of_the_program(self):
        program = self.folder / "palpate"
        program.write_text('#!/bin/sh\nfor a; do printf "%s\\n" "$a"; done >"$0.calls"\n'
                           'echo "palpate: error: the surface is open" >&2\nexit $(cat "$0.status")\n')
        program.chmod(program.stat().st_mode | stat.S_IXUSR)
        os.environ["PALPATE_PROGRAM"] = str(program)
        self.addCleanup(os.environ.pop, "PALPATE_PROGRAM")
        (self.folder / "palpate.status").write_text("0")
        made = palpate.make_model("liver.obj", element_size_m=0.01, remesh=True, largest_shell=False,
                                  region=["a=a.obj", "b=b.obj"])
        self.assertEqual(made, Path("liver.h5"))
        self.assertEqual((self.folder / "palpate.calls").read_text().splitlines(),
                         ["model", "liver.obj", "-o", "liver.h5", "--quiet", "--element-size-m", "0.01",
                          "--remesh", "--region", "a=a.obj", "--region", "b=b.obj"])
        (self.folder / "palpate.status").write_text("1")
        with self.assertRaisesRegex(palpate.Error, "^the surface is open$"):
            palpate.make_model("liver.obj")
        os.environ["PALPATE_PROGRAM"] = "/nowhere/palpate"
        with self.assertRaisesRegex(palpate.Error, r"program palpate is missing \(/nowhere/palpate\)"):
            palpate.make_model("liver.obj")


if __name__ == "__main__":
    unittest.main(argv=[__file__])
