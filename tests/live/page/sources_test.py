#!/usr/bin/env python3
"""The sources of the page of `palpate touch`, and the stand-in of its server, without a browser."""
import math
import re
import unittest
import urllib.error
import urllib.request
from pathlib import Path

from ball import COUPLING_N_M, STIFFNESS_N_M, Ball
from mock import TOOL_RADIUS_M, Mock, Scene

HERE = Path(__file__).resolve().parent


class StandIn(unittest.TestCase):
    """The stand-in refuses what the program refuses, and its ball is right."""

    def test_a_wrong_token_is_refused(self):
        mock = Mock()
        for path in ("/", "/?token=wrong", "/scenes", "/socket?token=wrong"):
            with self.subTest(path), self.assertRaises(urllib.error.HTTPError) as caught:
                urllib.request.urlopen(f"http://127.0.0.1:{mock.port}{path}", timeout=10)
            self.assertEqual(caught.exception.code, 403)
            caught.exception.close()
        mock.close()

    def test_weights_give_the_skin_and_springs_balance(self):
        ball = Ball(cells=3, rings=6, sectors=8)
        for vertex, tet, weights in zip(ball.skin, ball.tet_of, ball.weights):
            self.assertGreaterEqual(min(weights), -1e-12)
            for k in range(3):
                at = sum(w * ball.rest[n][k] for w, n in zip(weights, ball.tets[tet]))
                self.assertAlmostEqual(at, vertex[k], delta=1e-12)
        scene = Scene(ball)
        scene.pose[1] = -0.1
        scene.touch()
        stretch = math.dist(scene.pose[:3], scene.tool[:3])
        self.assertAlmostEqual(COUPLING_N_M * stretch, math.hypot(*scene.force), delta=1e-9)
        self.assertAlmostEqual(scene.depth, ball.radius + TOOL_RADIUS_M - math.hypot(*scene.tool[:3]),
                               delta=1e-9)
        self.assertAlmostEqual(math.hypot(*scene.force), STIFFNESS_N_M * scene.depth, delta=1e-12)


class Sources(unittest.TestCase):
    SOURCE = HERE.parents[2] / "src/live/page/src"

    def test_no_inline_script_and_no_address(self):
        page = (self.SOURCE / "viewer.html").read_text("utf-8")
        self.assertEqual(re.findall(r"<script(?![^>]*\bsrc=)|\son\w+=|\sstyle=|javascript:", page), [])
        for path in self.SOURCE.iterdir():
            with self.subTest(path.name):
                self.assertNotRegex(path.read_text("utf-8"), r"https?://|//[a-z]+\.[a-z]+/")

    def test_every_identifier_of_the_scripts_is_in_the_page(self):
        page = (self.SOURCE / "viewer.html").read_text("utf-8")
        known = set(re.findall(r'\bid="([\w-]+)"', page))
        used = set()
        for path in self.SOURCE.glob("*.js"):
            used |= set(re.findall(r'\b(?:element|light)\("([\w-]+)"', path.read_text("utf-8")))
        self.assertGreater(len(used), 20)
        self.assertEqual(used - known, set())

    def test_colours_are_those_of_pictures(self):
        table = HERE.parents[2] / "src/core/object_colours.h"
        if not table.exists():
            self.skipTest("src/core/object_colours.h is absent")
        ramp = re.search(r"kRamp = \{([^}]*)\}", table.read_text("utf-8")).group(1)
        script = re.search(r"RAMP = \[([^\]]*)\]", (self.SOURCE / "ramp.js").read_text("utf-8")).group(1)
        self.assertEqual(re.findall("#[0-9a-f]{6}", script), re.findall("#[0-9a-f]{6}", ramp))
        self.assertEqual(len(re.findall("#[0-9a-f]{6}", script)), 17)


if __name__ == "__main__":
    unittest.main()
