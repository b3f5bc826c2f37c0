#!/usr/bin/env python3
"""Ctrl-C promptly ends a step as a KeyboardInterrupt, and Python's handler is restored."""
import os
import signal
import threading
import time
import unittest

from built import SCENES
import numpy as np
import palpate


def long_simulation():
    """Minutes in one period: only the integrator's steps are short."""
    scene = palpate.load(str(SCENES / "one-tet.toml"))
    scene.set("integrator.max_steps", 1000000000)
    scene.set("record.state_period_s", 1000.0)
    scene.set("scene.duration_s", 1000.0)
    scene.set("integrator.name", "symplectic-euler")
    scene.set("integrator.step_s", 1e-5)
    scene.set("body.0.stiffness_damping_s", 0.0)
    return palpate.Simulation(scene)


class Stop(unittest.TestCase):
    def interrupt_after(self, seconds):
        timer = threading.Timer(seconds, os.kill, (os.getpid(), signal.SIGINT))
        timer.start()
        self.addCleanup(timer.cancel)

    def test_within_a_period(self):
        simulation = long_simulation()
        before = signal.getsignal(signal.SIGINT)
        start = time.monotonic()
        self.interrupt_after(0.5)
        with self.assertRaises(KeyboardInterrupt):
            simulation.step()
        self.assertGreater(time.monotonic() - start, 0.4)
        self.assertLess(time.monotonic() - start, 30.0)
        self.assertIs(signal.getsignal(signal.SIGINT), before)
        self.assertTrue(np.isfinite(simulation.body("tet").positions).all())
        with self.assertRaisesRegex(palpate.Error, "stopped"):
            simulation.step()
        with self.assertRaises(KeyboardInterrupt):  # Python's handler is active again
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(5.0)

    def test_a_handler_of_ones_own_is_called(self):
        called = []
        before = signal.signal(signal.SIGINT, lambda *_: called.append(1))
        self.addCleanup(signal.signal, signal.SIGINT, before)
        self.interrupt_after(0.5)
        with self.assertRaisesRegex(palpate.Error, "stopped"):
            long_simulation().run()
        self.assertEqual(called, [1])


if __name__ == "__main__":
    unittest.main(argv=[__file__])
