#!/usr/bin/env python3
"""Scenes with several hands on the page of `palpate touch`: the page moves one at a time, and any of them."""
import math
import time
import unittest

from ball import Ball
from in_browser import InBrowser, text
from mock import Mock, Scene

NEXT_TO = [0.0, -0.14, 0.07]


class Hands(InBrowser):
    def setUp(self):
        self.mock = Mock(Scene(Ball(), more_hands=[NEXT_TO]))
        self.expected_errors = 0
        self.show()

    def pose_of(self, hand):
        return list(self.mock.scene.poses[hand])

    def tool(self, hand):
        """Returns where the tool is drawn, after the frames that wait to be drawn."""
        self.tab.wait_for(f"palpateTest.tool({hand}) !== null", 30)
        return self.tab.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame("
                              f"() => done(palpateTest.tool({hand})))))")

    def press_key(self, digit):
        self.tab.value("document.getElementById('view').focus()")
        self.tab.key(digit, code=f"Digit{digit}", text=digit)

    def test_a_drag_of_another_tool_moves_its_hand_alone(self):
        x, y = self.tool(1)
        before = self.pose_of(0)
        self.tab.drag((x, y), (x + 20, y))
        self.tab.wait_for(f"{text('holder')} === 'You hold the handle'", 10)
        self.assertEqual(self.tab.value("document.getElementById('hand').value"), "1")
        self.assertIn("hand 2, second", self.tab.value(text("force-title")))
        x, y = self.tool(1)
        self.tab.drag((x, y), (x + 60, y - 30))
        self.wait_until(lambda: math.dist(self.pose_of(1)[:3], NEXT_TO) > 0.005)
        self.settled()
        self.assertEqual(self.pose_of(0), before)
        second = self.pose_of(1)
        x, y = self.tool(0)
        self.tab.drag((x, y), (x + 10, y))  # the first press may come before its pose is known
        self.tab.drag(self.tool(0), self.middle())
        self.wait_until(lambda: math.dist(self.pose_of(0)[:3], before[:3]) > 0.005)
        self.settled()
        self.assertEqual(self.pose_of(1), second, "it stays where it was left")
        self.assertEqual({one["hand"] for one in self.messages("handle")}, {0, 1})

    def test_keys_and_the_list_choose_a_hand_that_starts_where_it_is(self):
        self.take()
        self.press_key("2")
        self.tab.wait_for("document.getElementById('hand').value === '1'", 10)
        time.sleep(0.3)  # a frame of the new hand
        x, y = self.middle()
        self.tab.drag((x, y + 200), (x + 30, y + 200))
        self.wait_until(lambda: self.pose_of(1)[:3] != NEXT_TO)
        moved = self.settled() and self.pose_of(1)
        self.assertLess(math.dist(moved[:3], NEXT_TO), 0.03, "it did not jump to the first hand")
        self.assertAlmostEqual(moved[2], NEXT_TO[2], delta=1e-6)
        self.assertLess(math.dist(self.pose_of(0)[:3], self.mock.scene.start), 1e-6)
        self.press_key("9")
        self.assertEqual(self.tab.value("document.getElementById('hand').value"), "1", "there is no ninth")
        self.tab.value("(() => { const s = document.getElementById('hand'); s.value = 0; "
                       "s.dispatchEvent(new Event('change')); })()")
        time.sleep(0.3)
        self.tab.drag((x, y + 200), (x + 30, y + 200))
        self.wait_until(lambda: math.dist(self.pose_of(0)[:3], self.mock.scene.start) > 1e-3)
        self.settled()
        self.assertEqual(self.pose_of(1), moved)

    def test_a_hand_of_a_device_is_shown_and_not_moved(self):
        self.mock.scene = Scene(Ball(), more_hands=[NEXT_TO], live=[True, False])
        self.tab.wait_for("document.getElementById('hand').options[1].text.includes('device')", 10)
        self.take()
        self.press_key("2")
        self.tab.wait_for(f"{text('holder')} === 'A device moves this hand'", 10)
        self.assertTrue(self.tab.value("document.getElementById('take').hidden"))
        sent = len(self.messages("handle"))
        before = self.tool(1)
        x, y = self.middle()
        self.tab.drag((x, y + 200), (x + 80, y + 200))
        time.sleep(0.3)
        self.assertEqual(len(self.messages("handle")), sent)
        self.assertGreater(math.dist(before, self.tool(1)), 5, "a drag orbits")
        self.press_key("1")
        self.tab.wait_for(f"{text('holder')} === 'You hold the handle'", 10)

    def test_one_hand_needs_no_choice(self):
        self.mock.scene = Scene(Ball())
        self.tab.wait_for("document.getElementById('hand').hidden", 10)
        self.assertEqual(self.tab.value(text("force-title")), "Force on the hand")


class Foot(InBrowser):
    """Legend, hint and buttons below the view."""

    BOXES = ("['legend', 'hint', 'reset-view', 'open-controls', 'reading', 'holding'].map((id) => { "
             "const r = document.getElementById(id).getBoundingClientRect(); "
             "return [r.left, r.top, r.right, r.bottom]; })")

    def check(self, width):
        boxes = self.tab.value(self.BOXES)
        for i, a in enumerate(boxes):
            self.assertGreaterEqual(a[0], 0)
            self.assertLessEqual(a[2], width)
            for b in boxes[:i]:
                apart = a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
                self.assertTrue(apart, boxes)

    def test_nothing_overlaps_at_any_width(self):
        for width in (1280, 900, 640, 400, 340):
            with self.subTest(width):
                self.mock.holder = None
                self.show(width=width)
                self.check(width)
                self.take()
                self.check(width)


if __name__ == "__main__":
    unittest.main()
