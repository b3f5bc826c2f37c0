#!/usr/bin/env python3
"""The charts show the given numbers; Matplotlib is imported only where a chart is drawn."""
import os
import subprocess
import sys
import unittest
from unittest import mock

from built import PACKAGE, SCENES
import numpy as np
import palpate

try:
    os.environ["MPLBACKEND"] = "Agg"
    import matplotlib.pyplot
except ImportError:
    matplotlib = None


def comparison():
    columns = {"label": ["a", "a", "b", "b"], "cpu_s_median": [1.0, 2.0, 3.0, float("nan")],
               "position_error_rel_l2": [0.1, 0.01, 0.2, float("nan")],
               "force_error_rms_n": [4.0, 3.0, 2.0, 1.0]}
    return palpate.Comparison({name: np.array(column) for name, column in columns.items()}, {})


class Lazy(unittest.TestCase):
    def test_nothing_is_imported_that_is_not_asked_for(self):
        code = ("import sys, palpate; print(sorted({'numpy', 'matplotlib', 'pandas'} & set(sys.modules)));"
                "from palpate import plot; print('matplotlib' in sys.modules)")
        out = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, check=True,
                             env={**os.environ, "PYTHONPATH": str(PACKAGE)}).stdout
        # the environment with which it loads OpenBLAS is restored as well
        code = "import os; before = dict(os.environ); import palpate; print(os.environ == before)"
        self.assertEqual(subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True,
                                        env={**os.environ, "PYTHONPATH": str(PACKAGE)}).stdout, "True\n")
        self.assertEqual(out.split("\n")[:2], ["[]", "False"])

    def test_without_matplotlib_the_package_is_named(self):
        from palpate import plot
        with mock.patch.dict(sys.modules, matplotlib=None):
            with self.assertRaisesRegex(ImportError, "needs Matplotlib"):
                plot.work_precision(comparison())


@unittest.skipIf(matplotlib is None, "Matplotlib is missing (Debian package python3-matplotlib)")
class Charts(unittest.TestCase):
    def test_force_over_time(self):
        from palpate import plot
        simulation = palpate.Simulation(palpate.load(str(SCENES / "press-ball.toml")))
        simulation.advance(0.1)
        axes = plot.force(simulation)
        lines = {line.get_label(): line for line in axes.get_lines()}
        self.assertEqual(list(lines), ["x", "y", "z", "magnitude"])
        hand = simulation.hand()
        np.testing.assert_array_equal(lines["z"].get_xdata(), hand.times)
        np.testing.assert_array_equal(lines["z"].get_ydata(), hand.forces[:, 2])
        np.testing.assert_allclose(lines["magnitude"].get_ydata(), np.linalg.norm(hand.forces, axis=1))
        self.assertIn("[N]", axes.get_ylabel())
        self.assertIs(plot.force(simulation, axes=axes), axes)
        axes.figure.canvas.draw()

    def test_work_precision(self):
        from palpate import plot
        axes = plot.work_precision(comparison())
        lines = {line.get_label(): line for line in axes.get_lines()}
        self.assertEqual(list(lines), ["a", "b"])
        np.testing.assert_array_equal(lines["a"].get_xydata(), [[1.0, 0.1], [2.0, 0.01]])
        np.testing.assert_array_equal(lines["b"].get_xydata(), [[3.0, 0.2]])
        self.assertEqual((axes.get_xscale(), axes.get_yscale()), ("log", "log"))
        force = plot.work_precision(comparison(), "force_error_rms_n")
        np.testing.assert_array_equal(force.get_lines()[0].get_ydata(), [4.0, 3.0])
        axes.figure.canvas.draw()


if __name__ == "__main__":
    unittest.main(argv=[__file__])
