#!/usr/bin/env python3
"""The page of `palpate touch` in a headless Chromium, used like a person does, against a stand-in of the
server (mock.py)."""
import copy
import math
import re
import sys
import time
import unittest
import urllib.error
import urllib.request
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "cli"))

import browser  # noqa: E402
from ball import COUPLING_N_M, STIFFNESS_N_M, Ball  # noqa: E402
from mock import TOOL_RADIUS_M, Mock, Scene  # noqa: E402

if not browser.program():
    print("no Chromium here (Debian package chromium): the page of palpate touch was not tried in a browser")
    sys.exit(77)

READING = "document.getElementById('reading').dataset"
SHIFT, ALT = 8, 1


def text(name):
    return f"document.getElementById('{name}').textContent"


class InBrowser(unittest.TestCase):
    """One tab, and a stand-in of the server per test."""

    @classmethod
    def setUpClass(cls):
        cls.tab = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.tab.close()

    def setUp(self):
        self.mock = Mock()
        self.expected_errors = 0
        self.show()

    def tearDown(self):
        self.assertEqual(self.tab.errors[self.expected_errors:], [])
        outside = [url for url in self.tab.requests
                   if not url.startswith((f"http://127.0.0.1:{self.mock.port}/",
                                          f"ws://127.0.0.1:{self.mock.port}/", "data:", "blob:"))]
        self.assertEqual(outside, [], "the page asks for something outside")
        self.mock.close()

    def show(self, query="", width=1280, height=800, dark=False):
        self.tab.size(width, height, dark)
        self.tab.open(self.mock.address + query)
        self.tab.wait_for("window.palpateTest && palpateTest.frames() > 2 && "
                          f"{READING}.pose !== undefined", 60)

    def messages(self, kind):
        """Returns what the viewers sent."""
        return [one for one in self.mock.received if one["type"] == kind]

    def wait_until(self, condition, patience_s=30.0):
        until = time.monotonic() + patience_s
        while not condition():
            self.assertLess(time.monotonic(), until, "never true")
            time.sleep(0.05)

    def middle(self):
        return self.tab.value("(() => { const r = document.getElementById('view').getBoundingClientRect(); "
                              "return [r.x + r.width / 2, r.y + r.height / 2]; })()")

    def tool_point(self):
        """Returns where the tool's blue is on the screen [CSS pixels]."""
        return self.tab.value(
            "(async () => { await new Promise(requestAnimationFrame); const view = "
            "document.getElementById('view'); palpateTest.draw(); const copy = "
            "document.createElement('canvas'); "
            "copy.width = view.clientWidth; copy.height = view.clientHeight; "
            "const pen = copy.getContext('2d'); pen.drawImage(view, 0, 0, copy.width, copy.height); "
            "const d = pen.getImageData(0, 0, copy.width, copy.height).data; let n = 0, x = 0, y = 0; "
            "for (let i = 0; i < d.length; i += 4) if (d[i + 2] > d[i] + 60) "
            "{ ++n; x += (i / 4) % copy.width; "
            "y += Math.floor(i / 4 / copy.width); } const r = view.getBoundingClientRect(); "
            "return n > 50 ? [r.x + x / n, r.y + y / n] : null; })()")

    def take(self):
        self.tab.value("document.getElementById('take').click()")
        self.tab.wait_for(f"{text('holder')} === 'You hold the handle'", 10)

    def pose(self):
        return list(self.mock.scene.pose)


class Page(InBrowser):
    def test_a_drag_of_the_tool_takes_the_handle_and_dents_the_body(self):
        self.assertEqual(self.tab.value(text("holder")), "Nobody holds the handle")
        self.assertEqual(self.tab.value(text("force-now")), "0.0 mN")
        x, y = self.tool_point()
        self.tab.drag((x, y), (x + 60, y))  # starts the drag; the first part may pass before it is granted
        self.tab.wait_for(f"{text('holder')} === 'You hold the handle'", 10)
        self.tab.drag((x + 60, y), (x + 220, y))
        self.wait_until(lambda: self.mock.scene.depth > 1e-3)
        force = self.mock.scene.force
        self.tab.wait_for(f"Math.abs({READING}.force.split(' ')[1] - {force[1]}) < 1e-5", 10)
        shown = float(self.tab.value(text("force-now")).split()[0])
        self.assertAlmostEqual(shown, math.hypot(*force), delta=0.006)
        self.assertIn(" N", self.tab.value(text("force-now")))

    def test_a_drag_moves_in_the_plane_of_the_view_by_what_the_pointer_moves(self):
        self.take()
        x, y = self.middle()
        start = self.pose()
        self.tab.drag((x, y), (x + 100, y - 50), button="left")
        self.wait_until(lambda: len(self.messages("handle")) > 0)
        time.sleep(0.3)
        moved = [b - a for a, b in zip(start[:3], self.pose()[:3])]
        self.tab.drag((x, y), (x - 100, y + 50), button="left")
        time.sleep(0.3)
        for a, b in zip(start, self.pose()):  # the same way back: nothing was lost
            self.assertAlmostEqual(a, b, delta=1e-6)
        self.assertGreater(math.hypot(*moved), 0.005)
        self.assertGreater(moved[2], 0.1 * math.hypot(*moved), "up is up")
        self.tab.wheel((x, y), -100)
        self.wait_until(lambda: self.pose() != start)
        time.sleep(0.2)
        into = [b - a for a, b in zip(start[:3], self.pose()[:3])]
        along = sum(a * b for a, b in zip(moved, into)) / math.hypot(*moved) / math.hypot(*into)
        self.assertAlmostEqual(along, 0.0, delta=1e-4)  # at a right angle to the view's plane
        self.assertGreater(into[1], 0.0, "away from the eye, which is on the tool's side of the ball")

    def test_shift_turns_and_right_drag_orbits(self):
        self.take()
        x, y = self.middle()
        self.tab.drag((x, y), (x + 50, y), modifiers=SHIFT)
        self.wait_until(lambda: self.pose()[3] < 0.999)
        pose = self.pose()
        self.assertAlmostEqual(math.hypot(*pose[3:]), 1.0, delta=1e-6)
        self.assertAlmostEqual(2 * math.acos(pose[3]), 50 * 0.008, delta=0.01)
        self.assertLess(math.dist(pose[:3], self.mock.scene.start), 1e-7)
        before = self.tool_point()
        self.tab.drag((x, y), (x + 80, y), button="right")
        self.tab.drag((x, y), (x + 80, y), modifiers=ALT)
        time.sleep(0.2)
        self.assertEqual(self.pose(), pose)
        after = self.tool_point()
        self.assertGreater(math.dist(before, after), 20)
        self.tab.value("document.getElementById('reset-view').click()")
        time.sleep(0.2)
        self.assertLess(math.dist(before, self.tool_point()), 3)

    def test_keys_move_turn_and_give_back(self):
        self.tab.value("document.getElementById('view').focus()")
        self.tab.key("t", code="KeyT", text="t")
        self.tab.wait_for(f"{text('holder')} === 'You hold the handle'", 10)
        start = self.pose()
        press = {"type": "rawKeyDown", "key": "w", "code": "KeyW"}
        self.tab.call("Input.dispatchKeyEvent", **press)
        self.wait_until(lambda: math.dist(self.pose()[:3], start[:3]) > 0.002)
        self.tab.call("Input.dispatchKeyEvent", **{**press, "type": "keyUp"})
        time.sleep(0.3)
        rest = self.pose()
        time.sleep(0.3)
        self.assertEqual(self.pose(), rest, "it moves only while the key is down")
        self.tab.key("Escape")
        self.tab.wait_for(f"{text('holder')} === 'Nobody holds the handle'", 10)
        self.tab.key("t", code="KeyT", text="t")
        self.tab.wait_for(f"{text('holder')} === 'You hold the handle'", 10)
        self.tab.key(" ", code="Space", text=" ")
        self.wait_until(lambda: not self.mock.running)
        self.tab.wait_for(f"{text('pause')} === 'Continue'", 10)

    def touch(self, kind, *points):
        """Touches the screen with as many fingers as points."""
        self.tab.call("Input.dispatchTouchEvent", type=kind,
                      touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])

    def test_one_finger_moves_and_two_fingers_orbit_or_pinch_for_depth(self):
        self.take()
        x, y = self.middle()
        start = self.pose()
        self.touch("touchStart", (x, y))
        for step in range(1, 11):
            self.touch("touchMove", (x + 6 * step, y))
        self.touch("touchEnd")
        self.wait_until(lambda: self.pose() != start)
        time.sleep(0.2)
        moved = self.pose()
        self.assertGreater(math.dist(moved[:3], start[:3]), 0.003)
        self.assertAlmostEqual(moved[2], start[2], delta=1e-6)  # sideways only
        before = self.tool_point()
        self.touch("touchStart", (x - 50, y), (x + 50, y))
        for step in range(1, 11):
            self.touch("touchMove", (x - 50, y + 6 * step), (x + 50, y + 6 * step))
        self.touch("touchEnd")
        time.sleep(0.2)
        self.assertEqual(self.pose(), moved, "two fingers in parallel do not move the handle")
        self.assertGreater(math.dist(before, self.tool_point()), 3)
        self.touch("touchStart", (x - 50, y), (x + 50, y))
        for step in range(1, 11):
            self.touch("touchMove", (x - 50 - 4 * step, y), (x + 50 + 4 * step, y))
        self.touch("touchEnd")
        self.wait_until(lambda: self.pose() != moved)

    def test_only_the_holder_moves(self):
        self.mock.holder = object()
        self.tab.wait_for(f"{text('holder')} === 'Another viewer holds the handle'", 10)
        disabled = "['take', 'pause', 'reset', 'record'].map((id) => document.getElementById(id).disabled)"
        self.assertEqual(self.tab.value(disabled), [True] * 4)
        self.tab.drag(self.tool_point(), self.middle())
        time.sleep(0.3)
        self.assertEqual(self.messages("handle") + self.messages("take"), [])
        self.mock.holder = None
        self.tab.wait_for(f"{text('holder')} === 'Nobody holds the handle'", 10)
        self.assertEqual(self.tab.value(disabled), [False] * 4)

    def test_buttons_sliders_and_scenes_send_what_they_say(self):
        self.tab.value("document.getElementById('record').click()")
        self.wait_until(lambda: self.mock.recording)
        self.tab.wait_for(f"{text('recording')}.startsWith('Recording into out/ball')", 10)
        self.assertEqual(self.tab.value(text("record")), "Stop recording")
        self.tab.value("document.getElementById('record').click()")
        self.tab.wait_for(f"{text('recording')}.includes('palpate replay out/ball')", 10)
        self.assertEqual(self.messages("record"), [{"type": "record", "on": True},
                                                   {"type": "record", "on": False}])
        self.tab.value("(() => { const s = document.querySelector('#sliders input'); s.value = 200; "
                       "s.dispatchEvent(new Event('input')); s.dispatchEvent(new Event('change')); })()")
        self.wait_until(lambda: self.messages("set"))
        self.assertEqual(self.messages("set"), [{"type": "set", "key": "tool.coupling.stiffness_n_m",
                                                 "value": 3000}])
        self.assertIn("3 kN/m", self.tab.value(text("sliders")))
        self.tab.value("document.getElementById('open-scenes').click()")
        self.tab.wait_for("document.querySelectorAll('#scene-list button').length === 2", 10)
        self.tab.value("document.querySelectorAll('#scene-list button')[1].click()")
        self.wait_until(lambda: self.messages("open"))
        self.assertEqual(self.messages("open"), [{"type": "open", "scene": "other"}])
        self.tab.value("document.getElementById('reset').click()")
        self.wait_until(lambda: self.messages("reset"))

    def test_lights_have_words(self):
        lights = ("Array.from(document.querySelectorAll('#lights li'), "
                  "(one) => [one.className, one.textContent])")
        self.tab.wait_for("document.querySelectorAll('#lights .good').length === 4", 10)
        self.mock.extra = {"rate_hz": 600.0, "late_share": 0.4, "skipped_ticks": 12, "energy_j": None,
                           "passivity": {"observed": True, "energy_j": 1e-3, "min": -2e-3}}
        self.tab.wait_for("document.querySelectorAll('#lights .bad').length === 3", 10)
        self.assertEqual(self.tab.value(lights), [
            ["bad", "slower than real time: 60 % of it"],
            ["bad", "40 % of the ticks late, 12 skipped in 10 s"],
            ["bad", "active: the hand got 2 mJ more than it put in"], ["", "energy is not computed"]])

    def test_energy_that_nobody_put_in_is_reported(self):
        light = "document.getElementById('light-energy')"
        self.mock.extra = {"energy_j": 1e-3}
        self.tab.wait_for(f"{light}.textContent === 'energy of the bodies 1 mJ'", 10)
        self.mock.extra = {"energy_j": 5e-3}
        self.tab.wait_for(f"{light}.className === 'bad'", 10)
        self.assertRegex(self.tab.value(f"{light}.textContent"),
                         r"energy of the bodies 5 mJ: [\d.]+ mJ more than the hand put in")

    def test_a_lost_connection_is_made_again_and_an_end_is_said(self):
        cover = "document.getElementById('cover').hidden"
        self.assertTrue(self.tab.value(cover))
        self.take()
        self.mock.drop_viewers(1011)
        self.tab.wait_for(f"!{cover}", 10)
        self.assertIn("lost", self.tab.value(text("cover-text")))
        self.tab.wait_for(cover, 20)
        self.assertEqual(self.tab.value(text("link")), "connected")
        self.tab.wait_for(f"{text('holder')} === 'Nobody holds the handle'", 10)
        self.mock.close(1001)
        self.tab.wait_for(f"!{cover}", 10)
        self.assertIn("palpate has ended", self.tab.value(text("cover-text")))
        time.sleep(1.5)  # attempts to connect are errors in the browser's console
        self.assertIn("palpate has ended", self.tab.value(text("cover-text")))
        self.expected_errors = len(self.tab.errors)
        self.assertGreater(self.expected_errors, 0, "it does not try again")

    def test_messages_are_shown_once_as_text_and_can_be_closed(self):
        for _ in range(2):
            self.mock.tell({"type": "notice", "level": "warning", "text": "<b>late</b> & more"})
        self.tab.wait_for("document.querySelectorAll('#notices li').length === 1", 10)
        self.assertIn("<b>late</b> & more", self.tab.value(text("notices")))
        self.tab.value("document.querySelector('#notices button').click()")
        self.assertEqual(self.tab.value("document.querySelectorAll('#notices li').length"), 0)

    def test_the_strip_chart_draws_peaks_with_their_unit(self):
        drawn = ("(() => { const c = document.getElementById('chart'); const d = c.getContext('2d')"
                 ".getImageData(0, 0, c.width, c.height).data; let top = c.height; for (let i = 0; "
                 "i < d.length; i += 4) if (d[i + 3] > 200 && d[i + 1] > d[i] + 60) "
                 "top = Math.min(top, Math.floor(i / 4 / c.width)); return top / c.height; })()")
        flat = self.tab.value(drawn)
        self.assertGreater(flat, 0.5, "no force: the curve lies on the axis")
        self.mock.scene.pose[1] = -0.08
        self.mock.scene.touch()
        self.tab.wait_for(f"{drawn} < 0.4", 10)
        label = self.tab.value("document.getElementById('chart').getAttribute('aria-label')")
        self.tab.wait_for("document.getElementById('chart').getAttribute('aria-label').includes("
                          f"'force at most {float('%.3g' % math.hypot(*self.mock.scene.force)):g} N')", 10)
        self.assertRegex(label, r"Force and torque of the last 10 s")

    def test_no_width_scrolls_sideways_and_nothing_overlaps(self):
        for width, height in ((400, 860), (1280, 800)):
            for dark in (False, True):
                self.tab.size(width, height, dark)
                time.sleep(0.3)
                with self.subTest(width=width, dark=dark):
                    self.assertLessEqual(self.tab.value("document.documentElement.scrollWidth"), width)
                    boxes = self.tab.value(
                        "['reading', 'holding', 'legend', 'view-buttons', 'hint'].map((id) => { const r = "
                        "document.getElementById(id).getBoundingClientRect(); "
                        "return [id, r.left, r.top, r.right, r.bottom]; })")
                    for i, (a, *one) in enumerate(boxes):
                        for b, *other in boxes[:i]:
                            apart = (one[0] >= other[2] or other[0] >= one[2] or one[1] >= other[3] or
                                     other[1] >= one[3])
                            self.assertTrue(apart, f"{a} {one} over {b} {other}")

    def test_elements_have_accessible_names(self):
        self.tab.value("document.getElementById('open-controls').click()")
        nodes = self.tab.call("Accessibility.getFullAXTree")["nodes"]
        nameless = [one["role"]["value"] for one in nodes
                    if one.get("role", {}).get("value") in ("button", "slider", "checkbox", "combobox",
                                                            "application", "image", "dialog", "img")
                    and not one.get("ignored") and not one.get("name", {}).get("value")]
        self.assertEqual(nameless, [])
        self.assertGreater(len(nodes), 50)


class Shading(InBrowser):
    """The skin under deformation: what is drawn equals the same body drawn as if at rest there."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.ball = Ball(cells=4, rings=16, sectors=32)

    def pixels(self):
        self.tab.value("document.getElementById('coloured').checked && "
                       "document.getElementById('coloured').click()")
        time.sleep(0.3)
        return self.tab.value(
            "(() => { palpateTest.draw(); const view = document.getElementById('view'), copy = "
            "document.createElement('canvas'); copy.width = 200; copy.height = 160; const pen = "
            "copy.getContext('2d', {willReadFrequently: true}); pen.drawImage(view, 0, 0, 200, 160); "
            "return Array.from(pen.getImageData(0, 0, 200, 160).data); })()")

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

    def test_displacement_is_without_rigid_motion_for_free_bodies_only(self):
        c, s = math.cos(0.5), math.sin(0.5)
        turned = self.mapped(self.ball.rest, [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        end = f"Number({text('range-end')}) * (({text('range-unit')} === 'mm') ? 1e-3 : 1e-6)"
        self.shown(self.ball.rest, turned, "", free=True)
        self.tab.wait_for(f"{end} < 1e-3", 10)
        self.shown(self.ball.rest, turned, "", free=False)
        farthest = max(math.dist(a, b) for a, b in zip(self.ball.rest, turned))
        self.tab.wait_for(f"{end} >= {farthest} && {end} < {2 * farthest}", 10)


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
    unittest.main(argv=sys.argv[:1] + [one for one in sys.argv[1:] if not one.startswith("/")])
