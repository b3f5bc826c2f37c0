#!/usr/bin/env python3
"""Comparisons as arrays, and cases with a known result."""
import math
import sys
import threading
import types
import unittest
from unittest import mock

from built import SCENES
import numpy as np
import palpate


class Compare(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        other = threading.Event()  # a second thread, as in notebooks
        thread = threading.Thread(target=other.wait)
        thread.start()
        scene = palpate.load(str(SCENES / "one-tet.toml"))
        scene.set("body.0.youngs_modulus_pa", 9e4)
        try:
            cls.found = palpate.compare(scene, ["cvode-bdf", "implicit-midpoint"], limit_s=2.0, repeats=1)
        finally:
            other.set()
            thread.join()

    def test_errors_and_costs(self):
        found = self.found
        self.assertEqual(set(found["label"]), {"cvode-bdf", "implicit-midpoint"})
        self.assertTrue(all(len(column) == len(found) for column in found.columns.values()))
        good = found["status"] == "ok"
        self.assertGreater(good.sum(), 6)
        self.assertTrue((found.cost[good] > 0.0).all())
        self.assertTrue(np.isfinite(found.error[good]).all())
        self.assertEqual(found["unresolved"].dtype, bool)
        for label in set(found["label"]):
            errors = found.error[good & (found["label"] == label)]
            with self.subTest(label=label):
                self.assertLess(errors.min(), 0.05 * errors.max())

    def test_the_observed_order_is_the_methods(self):
        found = self.found
        used = (found["label"] == "implicit-midpoint") & (found.error < 0.05) & ~found["unresolved"]
        step, error = np.log(found["setting"][used]), np.log(found.error[used])
        self.assertGreaterEqual(used.sum(), 3)
        self.assertAlmostEqual(np.polyfit(step, error, 1)[0], 2.0, delta=0.3)

    def test_what_is_said_of_the_reference(self):
        self.assertIn("checked against", self.found.facts["reference"])
        self.assertLess(self.found.facts["reference_position_error_rel_l2"], 1e-6)

    def test_an_unknown_column_is_named(self):
        with self.assertRaisesRegex(KeyError, "no column 'cost'.*cpu_s_median"):
            self.found["cost"]

    def test_a_frame_where_pandas_is_there(self):
        class DataFrame(dict):
            pass
        try:
            import pandas
        except ImportError:  # a stand-in
            pandas = types.SimpleNamespace(DataFrame=DataFrame)
        with mock.patch.dict(sys.modules, pandas=pandas):
            frame = self.found.frame()
        self.assertIsInstance(frame, pandas.DataFrame)
        self.assertEqual(list(frame), list(self.found.columns))
        np.testing.assert_array_equal(frame["setting"], self.found["setting"])
        with mock.patch.dict(sys.modules, pandas=None), self.assertRaisesRegex(ImportError, "needs pandas"):
            self.found.frame()

    def test_a_wrong_name_is_refused(self):
        with self.assertRaisesRegex(palpate.Error, "cvode-bdff.*did you mean \"cvode-bdf\""):
            palpate.compare(palpate.load(str(SCENES / "one-tet.toml")), ["cvode-bdff"])


class Validate(unittest.TestCase):
    def test_a_case(self):
        measured = palpate.validate(["patch-test"])
        self.assertGreater(len(measured), 3)
        for one in measured:
            self.assertEqual(one.case, "patch-test")
            self.assertTrue(one.passed, one.quantity)
            self.assertLessEqual(one.error, one.bar)
            self.assertTrue(math.isfinite(one.computed))

    def test_a_wrong_name_is_refused(self):
        with self.assertRaisesRegex(palpate.Error, "no case \"patch-tset\".*did you mean \"patch-test\""):
            palpate.validate(["patch-tset"])


if __name__ == "__main__":
    unittest.main(argv=[__file__])
