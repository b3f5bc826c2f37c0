#!/usr/bin/env python3
"""A hand that a Python function moves: called once per tick with the force of the tick before; what it may
return, and what happens where it fails."""
import tempfile
import unittest

from built import SCENES
import numpy as np
import palpate

BALL = str(SCENES / "press-ball.toml")
PRESSED = (0.0, 0.0, 0.074)


def simulation_of(hands, scene=None, **options):
    return palpate.Simulation(scene or palpate.load(BALL), duration_s=0.1, hands=hands, **options)


class Hands(unittest.TestCase):
    def test_a_resting_hand_equals_the_script_bitwise(self):
        scene = palpate.load(BALL)
        scene.set("device.keyframe", [{"time_s": 0.0, "position_m": list(PRESSED)}])
        script = palpate.Simulation(scene, duration_s=0.1)
        script.run()
        moved = simulation_of(lambda time, force, torque: PRESSED)
        moved.run()
        self.assertGreater(np.abs(moved.hand().forces).max(), 0.1)
        np.testing.assert_array_equal(moved.hand().forces, script.hand().forces)
        np.testing.assert_array_equal(moved.body("ball").positions, script.body("ball").positions)

    def test_velocities_are_computed_or_given(self):
        def computed(time, force, torque):
            return 0.0, 0.0, 0.082 - 0.08 * time

        def given(time, force, torque):
            return palpate.HandlePose(computed(time, force, torque), velocity=(0.0, 0.0, -0.08))
        forces = []

        def undamped(time, force, torque):
            return palpate.HandlePose(computed(time, force, torque), velocity=(0.0, 0.0, 0.0))
        for hand in (computed, given, undamped):
            simulation = simulation_of(hand)
            simulation.run()
            forces.append(simulation.hand().forces.copy())
        # the first tick alone differs: before it, nothing is known of the velocity
        difference = np.abs(forces[0] - forces[1])[20:].max()
        self.assertGreater(np.abs(forces[1]).max(), 0.05)
        self.assertLess(difference, 1e-3 * np.abs(forces[1]).max())
        self.assertGreater(np.abs(forces[2] - forces[1]).max(), 0.05, "the damper of the coupling sees it")

    def test_it_is_called_once_per_tick_with_the_last_force(self):
        calls = []

        def hand(time, force, torque):
            self.assertEqual((force.shape, torque.shape), ((3,), (3,)))
            calls.append((time, force, torque))
            return PRESSED
        simulation = simulation_of(hand)
        simulation.run()
        record = simulation.hand()
        self.assertEqual(len(record), 100)
        self.assertEqual(len(calls), 101)
        np.testing.assert_array_equal([call[0] for call in calls[1:]], record.times)
        np.testing.assert_array_equal(calls[0][1], np.zeros(3))
        np.testing.assert_array_equal([call[1] for call in calls[2:]], record.forces[:-1])
        np.testing.assert_array_equal([call[2] for call in calls[2:]], record.torques[:-1])

    def test_invalid_poses_take_the_force_away(self):
        def hand(time, force, torque):
            return palpate.HandlePose(PRESSED, valid=time < 0.05)
        simulation = simulation_of(hand)
        simulation.run()
        record = simulation.hand()
        self.assertGreater(np.linalg.norm(record.forces[48]), 0.1)
        np.testing.assert_array_equal(record.forces[record.times > 0.0705], 0.0)

    def test_exceptions_pass_through_and_end_the_simulation(self):
        def hand(time, force, torque):
            if time > 0.03:
                raise KeyError("my own")
            return PRESSED
        simulation = simulation_of(hand)
        with self.assertRaisesRegex(KeyError, "my own"):
            simulation.run()
        self.assertLess(simulation.time, 0.04)
        with self.assertRaisesRegex(palpate.Error, "ended by an exception; create a new simulation"):
            simulation.step()
        self.assertGreater(len(simulation.hand()), 20, "its arrays remain")

    def test_what_it_may_not_return(self):
        for value, message in ((None, "must be 3 numbers"), ((1.0, 2.0), "must be 3 numbers, and has 2"),
                               ((0.0, 0.0, float("nan")), "must be 3 finite numbers"), ("abc", "must be 3")):
            with self.subTest(value=value):
                with self.assertRaisesRegex(palpate.Error, 'hand "tool" at t = 0 s: .*' + message):
                    simulation_of(lambda time, force, torque, value=value: value)
        with self.assertRaisesRegex(palpate.Error, "rotation must be a unit quaternion"):
            palpate.HandlePose(PRESSED, rotation=(1, 1, 0, 0))
        with self.assertRaisesRegex(palpate.Error, "velocity must be 3 numbers, and has 4"):
            palpate.HandlePose(PRESSED, velocity=(1, 1, 0, 0))
        pose = palpate.HandlePose(PRESSED, rotation=(0, 1, 0, 0), switches=5)
        np.testing.assert_array_equal(pose.position, PRESSED)
        np.testing.assert_array_equal(pose.rotation, (0, 1, 0, 0))
        self.assertEqual((pose.switches, pose.valid), (5, True))

    def test_hands_that_do_not_exist(self):
        def still(time, force, torque):
            return PRESSED
        with self.assertRaisesRegex(palpate.Error, 'the scene has no hand "left"'):
            simulation_of({"left": still})
        with self.assertRaisesRegex(palpate.Error, '"tool" is not a function'):
            simulation_of({"tool": 3})
        with self.assertRaisesRegex(palpate.Error, "no \\[tool\\]"):
            palpate.Simulation(palpate.load(SCENES / "one-tet.toml"), hands=still)
        scene = palpate.load(BALL)
        scene.set("exchange.scheme", "monolithic")
        with self.assertRaisesRegex(palpate.Error, "needs the path of the handle in advance"):
            simulation_of(still, scene)

    def test_one_of_two_hands(self):
        scene = palpate.load(SCENES / "two-hands.toml")
        left = next(name for name in scene.toml.split('"') if name == "left")
        simulation = palpate.Simulation(scene, duration_s=0.05,
                                        hands={left: lambda time, force, torque: (-0.2, 0.0, 0.3)})
        simulation.run()
        np.testing.assert_array_equal(simulation.hand(left).handle_positions[-1], (-0.2, 0.0, 0.3))
        self.assertGreater(len(simulation.hand()), 10)

    def test_runs_with_files_in_virtual_and_in_real_time(self):
        def hand(time, force, torque):
            return 0.0, 0.0, 0.082 - 0.05 * min(time, 0.15)
        simulation = palpate.Simulation(palpate.load(BALL), duration_s=0.2, hands=hand)
        simulation.run()
        peak = np.linalg.norm(simulation.hand().forces, axis=1).max()
        with tempfile.TemporaryDirectory(prefix="palpate-python-") as folder:
            run = palpate.run(BALL, folder=f"{folder}/virtual", duration_s=0.2, hands=hand)
            self.assertEqual(run.outcome, "finished")
            self.assertEqual(run.summary["figures"]["hands"][0]["peak_force_n"], peak)
            run = palpate.run(BALL, folder=f"{folder}/real", duration_s=0.2, hands=hand, real_time=True)
            self.assertEqual(run.summary["figures"]["real_time"]["ticks_timed"], 200)
            self.assertGreater(run.summary["figures"]["hands"][0]["peak_force_n"], 0.1 * peak)
            with self.assertRaisesRegex(palpate.Error, "cannot be resumed"):
                palpate.run(BALL, folder=f"{folder}/kept", hands=hand, checkpoint_every_s=0.1)

            def wrong(time, force, torque):
                if time > 0.05:
                    raise LookupError("in the thread of the ticks")
                return hand(time, force, torque)
            for real_time in (False, True):
                with self.assertRaisesRegex(LookupError, "in the thread of the ticks"):
                    palpate.run(BALL, folder=f"{folder}/wrong{real_time}", duration_s=0.2, hands=wrong,
                                real_time=real_time)


if __name__ == "__main__":
    unittest.main(argv=[__file__])
