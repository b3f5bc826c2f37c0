#!/usr/bin/env python3
"""Bodies on the page of `palpate touch`: shading and colours under deformation, in a headless Chromium."""
import copy
import math
import time
import unittest

from ball import Ball
from in_browser import InBrowser, text
from mock import Mock, Scene


class Shading(InBrowser):
    """The skin under deformation: what is drawn equals the same body drawn as if at rest there."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ball = Ball(cells=4, rings=16, sectors=32)

    def pixels(self, whole=True):
        """Returns pixels of one picture; `drawn` is then its number of triangles."""
        self.tab.value("document.getElementById('coloured').checked && "
                       "document.getElementById('coloured').click()")
        time.sleep(0.3)
        pixels, self.drawn = self.tab.value(
            f"(() => {{ palpateTest.draw({str(whole).lower()}); const view = "
            "document.getElementById('view'), copy = "
            "document.createElement('canvas'); copy.width = 200; copy.height = 160; const pen = "
            "copy.getContext('2d', {willReadFrequently: true}); pen.drawImage(view, 0, 0, 200, 160); "
            "return [Array.from(pen.getImageData(0, 0, 200, 160).data), palpateTest.triangles()]; })()")
        return pixels

    def shown(self, rest, positions, query, free=True):
        """Returns pixels of the ball whose nodes are at `rest` when it is loaded, and then at `positions`."""
        self.mock.close()
        shape = copy.copy(self.ball)
        shape.rest = rest
        scene = Scene(shape, free)
        scene.positions = positions
        scene.touch()
        self.mock = Mock(scene)
        self.show(query)
        return self.pixels()

    @staticmethod
    def mapped(points, rows):
        return [[sum(a * b for a, b in zip(row, point)) for row in rows] for point in points]

    def test_normals_follow_an_affine_map_in_both_ways(self):
        # stretch, shear and a turn by 40 degrees about z
        c, s = math.cos(0.7), math.sin(0.7)
        rows = [[1.25 * c, -0.8 * s, 0.3], [1.25 * s, 0.8 * c, 0.1], [0.0, 0.1, 0.7]]
        moved = self.mapped(self.ball.rest, rows)
        as_rest = self.shown(moved, moved, "")
        self.assertGreater(len(set(as_rest)), 20, "an empty picture")
        undeformed = self.shown(self.ball.rest, self.ball.rest, "")
        far = max(abs(a - b) for a, b in zip(as_rest, undeformed))
        self.assertGreater(far, 40, "the map changes the picture")
        for query in ("", "&embed"):  # by the processor, and by the vertex shader
            with self.subTest(query):
                deformed = self.shown(self.ball.rest, moved, query)
                differ = [abs(a - b) for a, b in zip(as_rest, deformed)]
                self.assertLess(sum(differ) / len(differ), 0.5)
                self.assertLess(sum(one > 16 for one in differ) / len(differ), 0.005)

    def test_a_large_skin_is_coarser_while_it_moves(self):
        large = Ball(cells=4, rings=90, sectors=180)
        self.assertGreater(len(large.triangles), 30000)
        rows = [[1.2, 0.0, 0.3], [0.0, 0.8, 0.1], [0.0, 0.1, 0.9]]
        self.ball, plain = large, self.ball
        self.addCleanup(setattr, self, "ball", plain)
        whole = self.shown(large.rest, self.mapped(large.rest, rows), "")
        self.assertGreater(self.drawn, len(large.triangles))
        coarse = self.pixels(whole=False)
        self.assertLess(self.drawn, 15000 + 4000)  # those of tool and handle are drawn, too
        self.assertGreater(self.drawn, 8000)
        differ = [abs(a - b) for a, b in zip(whole, coarse)]
        self.assertLess(sum(differ) / len(differ), 0.5)
        self.assertLess(sum(one > 16 for one in differ) / len(differ), 0.005)
        self.tab.wait_for(f"palpateTest.triangles() > {len(large.triangles)}", 10)  # nothing moves any more

    def test_displacement_is_without_rigid_motion_for_free_bodies_only(self):
        c, s = math.cos(0.5), math.sin(0.5)
        turned = self.mapped(self.ball.rest, [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        end = f"Number({text('range-end')}) * (({text('range-unit')} === 'mm') ? 1e-3 : 1e-6)"
        self.shown(self.ball.rest, turned, "", free=True)
        self.tab.wait_for(f"{end} < 1e-3", 10)
        self.shown(self.ball.rest, turned, "", free=False)
        farthest = max(math.dist(a, b) for a, b in zip(self.ball.rest, turned))
        self.tab.wait_for(f"{end} >= {farthest} && {end} < {2 * farthest}", 10)


if __name__ == "__main__":
    unittest.main()
