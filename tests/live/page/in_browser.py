"""A tab of a headless Chromium with the page of `palpate touch`, and a stand-in of its server."""
import sys
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "cli"))

import browser  # noqa: E402
from mock import Mock  # noqa: E402

if not browser.program():
    print("no Chromium here (Debian package chromium): the page of palpate touch was not tried in a browser")
    sys.exit(77)

READING = "document.getElementById('reading').dataset"


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
        self.tab.wait_for("window.palpateTest && palpateTest.frames() > 0 && "
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

    def settled(self):
        """Returns the pose once the page has sent all that its input asks for: it has drawn twice, and for
        half a second no message has come (a follower's last steps are sent frame by frame)."""
        since, count = time.monotonic(), -1
        until = since + 30.0
        while time.monotonic() - since < 0.5:
            self.tab.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))"
                           ".then(() => true)")
            if len(self.mock.received) != count:
                since, count = time.monotonic(), len(self.mock.received)
            self.assertLess(time.monotonic(), until, "the page sends for ever")
            time.sleep(0.02)
        return self.pose()
