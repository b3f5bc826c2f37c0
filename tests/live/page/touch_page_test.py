#!/usr/bin/env python3
"""`palpate touch` and its page together: a drag in a headless Chromium dents the head, and the force on the
page is that of the record.

    touch_page_test.py PROGRAM
"""
import math
import re
import shutil
import sys
import tempfile
import time
import unittest
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[1] / "cli"), str(HERE.parent)]

import browser  # noqa: E402
from touch_client import Server  # noqa: E402

PROGRAM = Path(sys.argv.pop(1)).resolve()
if not browser.program():
    print("no Chromium here (Debian package chromium): palpate touch was not tried in a browser")
    sys.exit(77)
try:
    import h5py
except ImportError:
    print("no h5py here (Debian package python3-h5py): palpate touch was not compared with its record")
    sys.exit(77)

LEAST_FORCE_N = 0.3
SAMPLE = ("(() => { const r = document.getElementById('reading').dataset; return [r.time, r.force, r.pose, "
          "document.getElementById('force-now').textContent]; })()")


def text(name):
    return f"document.getElementById('{name}').textContent"


class TouchPage(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-touch-page-"))
        self.addCleanup(shutil.rmtree, self.folder)
        self.server = Server(PROGRAM, "touch-head", cwd=self.folder)
        self.addCleanup(self.server.stop)
        self.tab = browser.Browser()
        self.addCleanup(self.tab.close)
        self.tab.size(1280, 800)
        self.tab.open(f"http://127.0.0.1:{self.server.port}/?token={self.server.token}")
        self.tab.wait_for("window.palpateTest && palpateTest.tool() && "
                          "document.getElementById('reading').dataset.pose !== undefined", 120)

    def sample(self):
        """Returns time [s], force [N], pose and the text of one moment."""
        time_s, force, pose, shown = self.tab.value(SAMPLE)
        numbers = [[float(one) for one in words.split()] for words in (force, pose)]
        return float(time_s), *numbers, shown

    def shares(self):
        """Returns which share of the view's pixels is not background, and which is orange to red."""
        return self.tab.value(
            "(() => { palpateTest.draw(); const view = document.getElementById('view'), copy = "
            "document.createElement('canvas'); copy.width = 300; copy.height = 240; const pen = "
            "copy.getContext('2d', {willReadFrequently: true}); pen.drawImage(view, 0, 0, 300, 240); "
            "const d = pen.getImageData(0, 0, 300, 240).data; let body = 0, warm = 0; "
            "for (let i = 0; i < d.length; i += 4) { warm += d[i] > 1.6 * d[i + 2]; "
            "body += Math.abs(d[i] - d[0]) + Math.abs(d[i + 2] - d[2]) > 24; } "
            "return [body / 72000, warm / 72000]; })()")

    def press(self):
        """Takes the handle and drags the tool to the right, into the face, until a force is shown."""
        self.tab.value("document.getElementById('take').click()")
        self.tab.wait_for(f"{text('holder')} === 'You hold the handle'", 30)
        x, y = self.tab.value("palpateTest.tool()")
        samples = []
        for step in range(60):
            self.tab.drag((x + 8 * step, y), (x + 8 * step + 8, y), steps=2)
            samples.append(self.sample())
            if math.hypot(*samples[-1][1]) > LEAST_FORCE_N and samples[-1][0] > 0:
                break
        self.assertGreater(math.hypot(*samples[-1][1]), LEAST_FORCE_N, samples[-1])
        for _ in range(20):
            time.sleep(0.1)
            samples.append(self.sample())
        return samples

    def test_a_drag_dents_the_head_and_the_force_shown_is_recorded(self):
        body, warm = self.shares()
        self.assertGreater(body, 0.2, "no head")
        self.assertLess(warm, 1e-3)
        self.tab.value("document.getElementById('record').click()")
        self.tab.wait_for(f"{text('recording')}.startsWith('Recording into')", 60)
        samples = self.press()
        moved = float(self.tab.value("document.getElementById('legend').dataset.displacement"))
        self.assertGreater(moved, 1e-3)
        self.assertGreater(self.shares()[1], 2e-3, "the dent is coloured")
        self.tab.value("document.getElementById('record').click()")
        self.tab.wait_for(f"{text('recording')}.includes('palpate replay')", 60)
        said = re.search(r"into (\S+)\. Replay: palpate replay (\S+)$", self.tab.value(text("recording")))
        self.assertEqual(said[1], said[2])
        self.compare(samples, self.folder / said[1])
        self.assertEqual(self.tab.errors, [])
        outside = [url for url in self.tab.requests if not re.match(r"(http|ws)://127\.0\.0\.1:|data:", url)]
        self.assertEqual(outside, [])

    def compare(self, samples, folder):
        with h5py.File(folder / "haptic.h5") as file:
            names = file["ticks"].attrs["columns"].decode().split(",")
            ticks = file["ticks"][:]
        times = ticks[:, names.index("time_s")]
        forces = [ticks[:, names.index(f"device_force_{axis}_n")] for axis in "xyz"]
        rows = {round(1e6 * float(at)): row for row, at in enumerate(times)}
        compared = 0
        for time_s, force, _, shown in samples:
            row = rows.get(round(1e6 * time_s))
            if row is None or time_s == 0.0:
                continue
            expected = [float(axis[row]) for axis in forces]
            for got, true in zip(force, expected):
                self.assertAlmostEqual(got, true, delta=1e-6 * abs(true) + 1e-7)
            number, unit = shown.split()
            scale, decimals = (1e-3 if unit == "mN" else 1.0), len(number.partition(".")[2])
            self.assertAlmostEqual(scale * float(number), math.hypot(*expected),
                                   delta=scale * 0.51 / 10 ** decimals)
            compared += math.hypot(*expected) > 0.5 * LEAST_FORCE_N
        self.assertGreater(compared, 10)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
