#!/usr/bin/env python3
"""Simulations: numbers bitwise equal to the program's, arrays that are views, and their meaning."""
import csv
import gc
import tempfile
import threading
import time
import tomllib
import unittest
import weakref
from pathlib import Path

from built import SCENES, run_program
import h5py
import numpy as np
import palpate

BALL = str(SCENES / "press-ball.toml")


class RunOfTheProgram:
    """press-ball by `palpate run`: its last recorded state, and each tick."""

    def __init__(self, *options):
        with tempfile.TemporaryDirectory(prefix="palpate-python-") as folder:
            self.output = run_program("run", BALL, "--duration-s", 0.15, "-o", folder, *options)
            with h5py.File(Path(folder) / "run.vtkhdf") as file:
                steps = int(file["VTKHDF/Steps"].attrs["NSteps"])
                n = int(file["VTKHDF/NumberOfPoints"][0])
                part = file["palpate/parts/0"]
                if part.attrs["name"].decode() != "ball":
                    raise AssertionError("the first part is no ball")
                self.rest = part["reference"][:]
                last = slice((steps - 1) * n, (steps - 1) * n + len(self.rest))
                self.time = float(file["VTKHDF/Steps/Values"][steps - 1])
                self.positions = file["VTKHDF/Points"][last]
                self.velocities = file["VTKHDF/PointData/velocity"][last]
            with open(Path(folder) / "force.csv", newline="") as file:
                rows = list(csv.DictReader(file))
        self.ticks = {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}

    def columns(self, *names):
        return np.stack([self.ticks[name] for name in names], axis=1)


def in_file_order(body, values):
    out = np.empty_like(values)
    out[body.file_node] = values
    return out


class AsTheProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.program = RunOfTheProgram()

    def check(self, simulation, program):
        ball = simulation.body("ball")
        self.assertEqual(program.time, 0.15)
        self.assertEqual(simulation.time, 0.15)
        np.testing.assert_array_equal(in_file_order(ball, ball.positions), program.positions)
        np.testing.assert_array_equal(in_file_order(ball, ball.velocities), program.velocities)
        self.assertGreater(abs(program.positions - in_file_order(ball, ball.rest_positions)).max(), 1e-3)
        hand = simulation.hand()
        np.testing.assert_array_equal(hand.times, program.ticks["time_s"])
        np.testing.assert_array_equal(hand.forces, program.columns("force_x_n", "force_y_n", "force_z_n"))
        np.testing.assert_array_equal(hand.torques, program.columns("torque_x_n_m", "torque_y_n_m",
                                                                    "torque_z_n_m"))
        np.testing.assert_array_equal(hand.handle_positions,
                                      program.columns("handle_x_m", "handle_y_m", "handle_z_m"))
        np.testing.assert_array_equal(hand.tool_positions,
                                      program.columns("tool_x_m", "tool_y_m", "tool_z_m"))
        self.assertEqual(len(hand), 150)
        self.assertGreater(abs(hand.forces).max(), 0.3)
        self.assertIn(f": {simulation.counters['steps']} steps,", program.output)

    def test_in_one_go(self):
        simulation = palpate.Simulation(palpate.load(BALL), duration_s=0.15)
        simulation.run()
        self.check(simulation, self.program)
        self.assertTrue(simulation.finished)

    def test_step_by_step_with_a_look_at_everything(self):
        simulation = palpate.Simulation(palpate.load(BALL))
        ball, steps = simulation.body("ball"), 0
        while simulation.time < 0.1499:
            self.assertTrue(simulation.step())
            steps += 1
            self.assertEqual(simulation.time, steps * 0.01 if steps < 15 else 0.15)
            for array in (ball.forces, ball.surface_positions, simulation.contact.forces, simulation.force):
                self.assertTrue(np.isfinite(array).all())
        self.assertEqual(steps, 15)
        self.check(simulation, self.program)

    def test_of_a_dict(self):
        simulation = palpate.Simulation(palpate.Scene(tomllib.loads(Path(BALL).read_text())), duration_s=0.15)
        simulation.advance(0.15)
        self.check(simulation, self.program)

    def test_of_a_changed_scene(self):
        scene = palpate.load(BALL)
        scene.set("integrator.name", "linearly-implicit-euler")
        scene.set("integrator.step_s", 0.002)
        simulation = palpate.Simulation(scene, 0.15)
        simulation.run()
        other = RunOfTheProgram("--set", "integrator.name=linearly-implicit-euler", "--set",
                                "integrator.step_s=0.002")
        self.check(simulation, other)
        self.assertFalse(np.array_equal(other.positions, self.program.positions))


class Time(unittest.TestCase):
    def test_it_ends(self):
        simulation = palpate.Simulation(palpate.load(BALL), duration_s=0.025)
        self.assertEqual((simulation.time, simulation.duration, simulation.finished), (0.0, 0.025, False))
        self.assertEqual([simulation.step() for _ in range(5)], [True, True, True, False, False])
        self.assertEqual((simulation.time, simulation.finished), (0.025, True))
        simulation.advance(1.0)
        simulation.run()
        self.assertEqual(simulation.time, 0.025)

    def test_advance_goes_whole_periods(self):
        simulation = palpate.Simulation(palpate.load(BALL))
        for seconds, time in ((0.01, 0.01), (0.03, 0.04), (0.001, 0.05), (0.015, 0.07)):
            simulation.advance(seconds)
            self.assertAlmostEqual(simulation.time, time, 14)

    def test_bad_times_are_refused(self):
        scene = palpate.load(BALL)
        simulation = palpate.Simulation(scene)
        for seconds in (0.0, -1.0, float("nan")):
            with self.subTest(seconds=seconds), self.assertRaises(palpate.Error):
                simulation.advance(seconds)
        for seconds in (-1.0, float("nan"), 1e300):
            with self.subTest(seconds=seconds), self.assertRaises(palpate.Error):
                palpate.Simulation(scene, seconds)
        self.assertEqual(simulation.time, 0.0)


class Views(unittest.TestCase):
    def setUp(self):
        self.simulation = palpate.Simulation(palpate.load(BALL))
        self.ball = self.simulation.body("ball")

    def test_the_state_is_not_copied(self):
        for name in ("positions", "velocities", "rest_positions", "masses", "tetrahedra", "file_node",
                     "surface_faces"):
            with self.subTest(array=name):
                first, second = getattr(self.ball, name), getattr(self.simulation.body("ball"), name)
                self.assertGreater(first.size, 0)
                self.assertEqual(first.__array_interface__["data"][0], second.__array_interface__["data"][0])
                self.assertTrue(np.shares_memory(first, second))

    def test_an_old_view_shows_the_new_state(self):
        positions, velocities = self.ball.positions, self.ball.velocities
        before = positions.copy()
        self.assertEqual(abs(velocities).max(), 0.0)
        self.simulation.advance(0.15)
        self.assertGreater(abs(positions - before).max(), 1e-3)
        self.assertGreater(abs(velocities).max(), 0.0)
        self.assertTrue(np.shares_memory(positions, self.ball.positions))

    def test_none_can_be_written(self):
        self.simulation.advance(0.1)
        contact, hand = self.simulation.contact, self.simulation.hand()
        for array in (self.ball.positions, self.ball.velocities, self.ball.masses, self.ball.forces,
                      self.ball.surface_positions, contact.gaps, contact.forces, hand.forces, hand.times,
                      self.simulation.force):
            self.assertFalse(array.flags.writeable)
            with self.assertRaises(ValueError):
                array[...] = 0

    def test_a_view_keeps_the_simulation_alive_and_nothing_else_does(self):
        simulation = palpate.Simulation(palpate.load(BALL))
        alive = weakref.ref(simulation)
        simulation.advance(0.1)
        positions, expected = simulation.body("ball").positions, simulation.body("ball").positions.copy()
        del simulation
        gc.collect()
        self.assertIsNotNone(alive())
        for _ in range(5):  # freed memory would be reused
            palpate.Simulation(palpate.load(BALL)).step()
        np.testing.assert_array_equal(positions, expected)
        del positions
        gc.collect()
        self.assertIsNone(alive())

    def test_ticks_and_contact_stay_as_they_were(self):
        self.simulation.advance(0.1)
        hand, contact = self.simulation.hand(), self.simulation.contact
        forces, gaps = hand.forces, contact.gaps
        self.assertTrue(np.shares_memory(forces, hand.torques) or np.may_share_memory(forces, hand.torques))
        self.assertTrue(np.shares_memory(gaps, contact.gaps))
        before, gaps_before = forces.copy(), gaps.copy()
        self.simulation.run()
        np.testing.assert_array_equal(forces, before)
        np.testing.assert_array_equal(gaps, gaps_before)
        self.assertEqual(len(hand.forces), 400)
        np.testing.assert_array_equal(hand.forces[:100], before)
        np.testing.assert_array_equal(hand.forces[-1], self.simulation.force)

    def test_lists_of_ticks_that_grew(self):
        scene = palpate.load(BALL)
        scene.set("tool.tick_s", 1e-4)
        simulation = palpate.Simulation(scene)
        simulation.advance(0.1)
        hand = simulation.hand()
        first, before = hand.forces, hand.forces.copy()
        simulation.run()
        self.assertEqual(len(hand), 4000)
        np.testing.assert_array_equal(first, before)
        np.testing.assert_array_equal(hand.forces[:1000], before)
        np.testing.assert_allclose(np.diff(hand.times), 1e-4, rtol=1e-9)


class Meaning(unittest.TestCase):
    def test_forces_at_rest_are_weights(self):
        tet = palpate.Simulation(palpate.load(str(SCENES / "one-tet.toml"))).body("tet")
        weights = tet.masses[:, None] * [0.0, 0.0, -9.81]
        np.testing.assert_allclose(tet.forces, weights, rtol=1e-12, atol=1e-14)
        self.assertAlmostEqual(tet.masses.sum(), 1000.0 * 0.1 ** 3 / 6.0, 12)

    def test_a_body_begins_where_the_scene_places_it(self):
        ball = palpate.Simulation(palpate.load(BALL)).body("ball")
        np.testing.assert_array_equal(ball.positions, ball.rest_positions)
        center = ball.masses @ ball.positions / ball.masses.sum()
        np.testing.assert_allclose(center, [0.0, 0.0, 0.0294675], atol=2e-4)
        self.assertEqual(abs(ball.velocities).max(), 0.0)

    def test_what_presses_on_the_body_is_the_sum_of_its_forces(self):
        simulation = palpate.Simulation(palpate.load(BALL))
        simulation.advance(0.2)
        contact, ball = simulation.contact, simulation.body("ball")
        self.assertGreater(len(contact), 10)
        np.testing.assert_allclose(contact.forces, (contact.pressures * contact.areas)[:, None]
                                   * contact.normals, rtol=1e-14)
        np.testing.assert_allclose(np.linalg.norm(contact.normals, axis=1), 1.0, rtol=1e-12)
        np.testing.assert_allclose(np.einsum("ij,ij->i", contact.normals,
                                             contact.positions - contact.opposite_positions),
                                   contact.gaps, atol=1e-12)
        self.assertTrue((contact.pressures[contact.gaps > 1e-9] == 0.0).all())
        self.assertTrue((contact.pressures[contact.gaps < -1e-5] > 0.0).all())
        self.assertEqual(set(contact.pairs), {0, 1})
        on_tool = contact.forces[contact.pairs == 1].sum(axis=0)
        self.assertGreater(np.linalg.norm(on_tool), 0.3)
        on_ball = contact.forces.sum(axis=0)  # the ball is side a of both pairs
        damped = -40.0 * (ball.masses @ ball.velocities)  # mass_damping_per_s of the scene
        np.testing.assert_allclose(ball.forces.sum(axis=0), on_ball + damped, atol=1e-9)

    def test_surface_is_closed_and_where_the_nodes_are(self):
        ball = palpate.Simulation(palpate.load(BALL)).body("ball")
        self.assertFalse(ball.has_skin)
        faces, points = ball.surface_faces, ball.surface_positions
        a, b, c = points[faces.T]
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
        corners = ball.positions[ball.tetrahedra]
        edges = corners[:, 1:] - corners[:, :1]
        self.assertAlmostEqual(volume, np.linalg.det(edges).sum() / 6.0, 15)
        self.assertAlmostEqual(volume, 4.0 / 3.0 * np.pi * 0.03 ** 3, delta=0.05 * volume)

    def test_bodies_and_hands_by_name(self):
        simulation = palpate.Simulation(palpate.load(str(SCENES / "two-hands.toml")))
        names = [body.name for body in simulation.bodies]
        self.assertEqual(simulation.body(names[0]).name, names[0])
        tables = tomllib.loads((SCENES / "two-hands.toml").read_text())
        other = tables["hand"][0]["name"]
        simulation.step()
        self.assertGreater(len(simulation.hand(other)), 0)
        self.assertFalse(np.array_equal(simulation.hand(other).tool_positions,
                                        simulation.hand().tool_positions))
        with self.assertRaisesRegex(palpate.Error, "no hand \"x\""):
            simulation.hand("x")
        with self.assertRaisesRegex(palpate.Error, "did you mean"):
            simulation.body(names[0] + "s")

    def test_a_scene_without_tool_and_contact(self):
        simulation = palpate.Simulation(palpate.load(str(SCENES / "one-tet.toml")))
        simulation.step()
        self.assertEqual(len(simulation.contact), 0)
        self.assertEqual(simulation.contact.forces.shape, (0, 3))
        with self.assertRaisesRegex(palpate.Error, r"no \[tool\]"):
            simulation.force


class Failure(unittest.TestCase):
    def test_an_integrator_that_gives_up(self):
        scene = palpate.load(str(SCENES / "one-tet.toml"))
        scene.set("integrator.max_steps", 1)
        simulation = palpate.Simulation(scene)
        for _ in range(2):
            with self.assertRaisesRegex(palpate.IntegratorError, "cvode-bdf failed at t = "):
                simulation.run()
        self.assertFalse(simulation.finished)
        self.assertTrue(np.isfinite(simulation.body("tet").positions).all())


class Threads(unittest.TestCase):
    def test_others_run_while_one_steps_and_none_steps_beside_it(self):
        scene = palpate.load(BALL)
        scene.set("integrator.rtol", 1e-5)
        simulation = palpate.Simulation(scene, 0.1)
        worker = threading.Thread(target=simulation.run)
        worker.start()
        while simulation.time == 0.0 and worker.is_alive():
            time.sleep(1e-3)
        refused = looked = 0
        while worker.is_alive() and simulation.time < 0.1:
            time.sleep(1e-3)
            looked += simulation.body("ball").positions.shape == (309, 3)
            for ask in (lambda: simulation.body("ball").forces, lambda: simulation.hand().forces,
                        lambda: simulation.contact, lambda: simulation.counters, simulation.step):
                try:
                    ask()
                except palpate.Error as error:
                    self.assertIn("another thread", str(error))
                    refused += 1
        worker.join()
        self.assertGreater(looked, 10)
        self.assertGreaterEqual(refused, 5 * (looked - 1))
        self.assertEqual(simulation.time, 0.1)

    def test_simulations_in_threads_are_each_as_alone(self):
        simulations = [palpate.Simulation(palpate.load(BALL), 0.1) for _ in range(3)]
        simulations[0].run()
        workers = [threading.Thread(target=one.run) for one in simulations[1:]]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        for one in simulations[1:]:
            self.assertEqual(one.time, 0.1)
            np.testing.assert_array_equal(one.body("ball").positions, simulations[0].body("ball").positions)

    def test_images_drawn_by_one_thread_after_another(self):
        scene = palpate.load(BALL)
        scene.set("contact.1.method", "image")
        alone, shared = palpate.Simulation(scene, 0.1), palpate.Simulation(scene, 0.1)
        alone.run()
        failures = []

        def step():
            try:
                shared.step()
                palpate.Simulation(scene, 0.01).run()  # dropped here, with what it drew
            except palpate.Error as error:
                failures.append(error)

        while not shared.finished and not failures:
            worker = threading.Thread(target=step)
            worker.start()
            worker.join()
            shared.step()
        self.assertEqual(failures, [])
        np.testing.assert_array_equal(shared.body("ball").positions, alone.body("ball").positions)
        self.assertGreater(abs(alone.hand().forces).max(), 0.1)


if __name__ == "__main__":
    unittest.main(argv=[__file__])
