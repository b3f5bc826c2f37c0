#!/usr/bin/env python3
"""The page of `palpate touch` in a headless Chromium, used like a person does, against a stand-in of the
server (mock.py)."""
import math
import time
import unittest

from ball import Ball
from in_browser import READING, InBrowser, text
from mock import Scene

SHIFT, ALT = 8, 1


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
        moved = [b - a for a, b in zip(start[:3], self.settled()[:3])]
        self.tab.drag((x, y), (x - 100, y + 50), button="left")
        for a, b in zip(start, self.settled()):  # the same way back: nothing was lost
            self.assertAlmostEqual(a, b, delta=1e-6)
        self.assertGreater(math.hypot(*moved), 0.005)
        self.assertGreater(moved[2], 0.1 * math.hypot(*moved), "up is up")
        self.tab.wheel((x, y), -100)
        self.wait_until(lambda: self.pose() != start)
        into = [b - a for a, b in zip(start[:3], self.settled()[:3])]
        along = sum(a * b for a, b in zip(moved, into)) / math.hypot(*moved) / math.hypot(*into)
        self.assertAlmostEqual(along, 0.0, delta=1e-4)  # at a right angle to the view's plane
        self.assertGreater(into[1], 0.0, "away from the eye, which is on the tool's side of the ball")

    def test_shift_turns_and_right_drag_orbits(self):
        self.take()
        x, y = self.middle()
        self.tab.drag((x, y), (x + 50, y), modifiers=SHIFT)
        self.wait_until(lambda: self.pose()[3] < 0.999)
        pose = self.settled()
        self.assertAlmostEqual(math.hypot(*pose[3:]), 1.0, delta=1e-6)
        self.assertAlmostEqual(2 * math.acos(pose[3]), 50 * 0.008, delta=0.01)
        self.assertLess(math.dist(pose[:3], self.mock.scene.start), 1e-7)
        before = self.tool_point()
        self.tab.drag((x, y), (x + 80, y), button="right")
        self.tab.drag((x, y), (x + 80, y), modifiers=ALT)
        self.assertEqual(self.settled(), pose)
        after = self.tool_point()
        self.assertGreater(math.dist(before, after), 20)
        self.tab.value("document.getElementById('reset-view').click()")
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
        rest = self.settled()
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
        moved = self.settled()
        self.assertGreater(math.dist(moved[:3], start[:3]), 0.003)
        self.assertAlmostEqual(moved[2], start[2], delta=1e-6)  # sideways only
        before = self.tool_point()
        self.touch("touchStart", (x - 50, y), (x + 50, y))
        for step in range(1, 11):
            self.touch("touchMove", (x - 50, y + 6 * step), (x + 50, y + 6 * step))
        self.touch("touchEnd")
        self.assertEqual(self.settled(), moved, "two fingers in parallel do not move the handle")
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

    def test_a_scene_without_a_hand_is_shown(self):
        self.mock.scene = Scene(Ball(), hand=False)
        self.tab.wait_for(f"{text('holder')} === 'No handle to take in this scene'", 10)
        frames = self.tab.value("palpateTest.frames()")
        self.mock.scene.nodes = [[1.1 * one for one in node] for node in self.mock.scene.nodes]
        self.tab.wait_for(f"palpateTest.frames() > {frames}", 10)
        hidden = "['reading', 'force', 'take', 'settings'].map((id) => document.getElementById(id).hidden)"
        self.assertEqual(self.tab.value(hidden), [True] * 4)
        self.tab.wait_for(f"{text('light-late')}.trim() === 'no haptic ticks in this scene'", 10)
        self.tab.wait_for("document.getElementById('light-rate').className === 'good'", 15)
        self.assertNotIn("ticks", self.tab.value(text("figures")))
        self.assertEqual(self.tab.errors, [])

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


if __name__ == "__main__":
    unittest.main()
