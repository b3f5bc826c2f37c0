#!/usr/bin/env python3
"""The page of `palpate report` in a headless Chromium, used like a reader does.

    report_page_test.py PROGRAM
"""
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import browser

PROGRAM = Path(sys.argv[1]).resolve()
if not browser.program():
    print("no Chromium here (Debian package chromium): the report's page was not tried in a browser")
    sys.exit(77)


def palpate(*words):
    done = subprocess.run([str(PROGRAM), *map(str, words)], capture_output=True, text=True, timeout=600)
    if done.returncode != 0:
        raise RuntimeError(f"{words}: {done.returncode}: {done.stderr}")


COLUMN = "Array.from({table}.tBodies[0].rows, (r) => r.cells[{column}].textContent)"


class ReportPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="palpate-page-"))
        run, compare = cls.folder / "run", cls.folder / "compare"
        palpate("run", "press-ball", "--duration-s", "0.05", "-o", run)
        palpate("compare", "one-tet", "--integrator", "cvode-bdf", "--integrator", "linearly-implicit-euler",
                "--limit-s", "0.5", "--repeats", "1", "-o", compare)
        stability = cls.folder / "stability"
        palpate("stability", "--row", "youngs-modulus", "--integrator", "cvode-bdf", "--integrator",
                "linearly-implicit-euler", "-o", stability)
        cls.page = cls.folder / "page.html"
        palpate("report", run, compare, stability, "-o", cls.page)
        cls.tab = browser.Browser()

    @classmethod
    def tearDownClass(cls):
        cls.tab.close()
        shutil.rmtree(cls.folder)

    def setUp(self):
        self.tab.size(1280)
        self.tab.open(self.page)

    def tearDown(self):
        self.assertEqual(self.tab.errors, [])
        outside = [url for url in self.tab.requests if not re.match(r"(file|data|blob|about):", url)]
        self.assertEqual(outside, [], "the page asks for something outside")

    def seen(self, selector):
        """Scrolls to the first such element, after opening the sections that contain it."""
        self.tab.value(f"(() => {{ const e = document.querySelector('{selector}'); for (let p = e; p; "
                       "p = p.parentElement) if (p.tagName === 'DETAILS') p.open = true; "
                       "e.scrollIntoView({block: 'center'}); })()")

    def test_a_header_sorts_by_click_and_by_key(self):
        table = ("Array.from(document.querySelectorAll('table.sortable')).find((t) => "
                 "t.tBodies[0].rows.length > 3 && t.querySelector('th[data-sort=number]'))")
        self.tab.value(f"window.table = {table}; "
                       "window.header = table.querySelector('th[data-sort=number]'); "
                       "window.column = header.cellIndex; for (let p = table; p; p = p.parentElement) "
                       "if (p.tagName === 'DETAILS') p.open = true; 0")
        cells = COLUMN.format(table="table", column="column")

        def numbers():
            found = [re.search(r"[-+]?\d+\.?\d*(e[-+]?\d+)?", cell) for cell in self.tab.value(cells)]
            return [float(one.group()) for one in found if one]

        before = self.tab.value(cells)
        self.tab.value("header.querySelector('button').click()")
        self.assertEqual(self.tab.value("header.getAttribute('aria-sort')"), "ascending")
        self.assertEqual(numbers(), sorted(numbers()))
        self.assertGreater(len(set(numbers())), 1)
        self.tab.value("header.querySelector('button').focus()")
        self.tab.key("Enter", text="\r")
        self.assertEqual(self.tab.value("header.getAttribute('aria-sort')"), "descending")
        self.assertEqual(numbers(), sorted(numbers(), reverse=True))
        self.assertEqual(sorted(self.tab.value(cells)), sorted(before), "no row is lost")

    def test_a_series_can_be_switched_and_values_read(self):
        self.seen("figure.chart")
        self.tab.wait_for("document.querySelector('figure.chart .legend button') !== null")
        ink = ("(() => { const c = document.querySelector('figure.chart canvas'); "
               "const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data; "
               "let n = 0; for (let i = 3; i < d.length; i += 4) n += d[i] > 0; return n; })()")
        self.tab.wait_for(f"{ink} > 1000")
        before = self.tab.value(ink)
        pressed = "figure.chart .legend button[aria-pressed]"
        count = self.tab.value(f"document.querySelectorAll('{pressed}').length")
        self.assertGreaterEqual(count, 3)
        self.tab.value("document.querySelectorAll('figure.chart .legend button')[3].click()")
        self.tab.wait_for(f"{ink} !== {before}")
        self.assertLess(self.tab.value(ink), before, "a line is gone")
        self.tab.value("document.querySelector('figure.chart .live').focus()")
        self.tab.key("ArrowRight")
        self.tab.wait_for("!document.querySelector('figure.chart .reading').hidden")
        self.assertRegex(self.tab.value("document.querySelector('figure.chart .reading').textContent"),
                         r"time \[s\]: .*x: ")
        reset = "document.querySelector('figure.chart .reset').hidden"
        self.assertTrue(self.tab.value(reset))
        self.tab.key("+", text="+")
        self.tab.wait_for(f"!{reset}")
        self.tab.key("0", text="0")
        self.tab.wait_for(reset)

    def test_a_heat_map_is_read_by_keyboard_and_click(self):
        self.seen("table.heat")
        stops = "document.querySelectorAll('table.heat td[tabindex=\"0\"]').length"
        self.assertEqual(self.tab.value(stops), 1, "one stop of the Tab key")
        read = "document.querySelector('.heatread').textContent"
        self.assertIn("arrow keys", self.tab.value(read))
        self.tab.value("document.querySelector('table.heat td[tabindex]').focus()")
        first = self.tab.value(read)
        self.assertRegex(first, r"(?s)cvode-bdf: .* \(expected: .*s of CPU")
        self.tab.key("ArrowRight")
        right = self.tab.value(read)
        self.assertIn("linearly-implicit-euler: ", right)
        self.tab.key("ArrowRight")
        self.assertEqual(self.tab.value(read), right, "there is nothing beyond the last")
        self.tab.key("ArrowDown")
        below = self.tab.value(read)
        self.assertIn("linearly-implicit-euler: ", below)
        self.assertNotEqual(below, right, "another case")
        self.assertEqual(self.tab.value(stops), 1)
        self.tab.value("document.querySelector('table.heat td:not(.none)').click()")
        self.assertEqual(self.tab.value(read), first)

    def test_charts_of_counts_are_folded_away_and_drawn_when_opened(self):
        self.assertEqual(self.tab.value("document.querySelectorAll('details[open]').length"), 0)
        self.assertGreater(self.tab.value("document.querySelectorAll('details figure.chart').length"), 0)
        self.assertEqual(self.tab.value("document.querySelectorAll('details figure.chart canvas').length"), 0)
        self.seen("details figure.chart")
        self.tab.wait_for("document.querySelectorAll('details figure.chart canvas').length > 0")

    def test_the_view_turns_and_plays(self):
        self.seen(".view")
        self.tab.wait_for("document.querySelector('.view canvas') !== null")
        pixels = "document.querySelector('.view canvas').toDataURL()"
        slider = "document.querySelector('.view input')"
        clock = "document.querySelector('.view output').value"
        self.assertGreater(self.tab.value(f"Number({slider}.max)"), 1)
        set_to = "(() => {{ const s = {slider}; s.value = {to}; s.dispatchEvent(new Event('input')); }})()"
        self.tab.value(set_to.format(slider=slider, to=0))
        first, began = self.tab.value(pixels), self.tab.value(clock)
        self.assertGreater(len(first), 5000, "an empty picture")
        self.tab.value(set_to.format(slider=slider, to=f"{slider}.max"))
        last = self.tab.value(pixels)
        self.assertNotEqual(self.tab.value(clock), began)
        self.assertNotEqual(last, first)
        self.tab.value("document.querySelector('.view canvas').focus()")
        self.tab.key("ArrowLeft")
        self.assertNotEqual(self.tab.value(pixels), last, "it turns")
        self.tab.value(set_to.format(slider=slider, to=0))
        self.tab.value("document.querySelector('.view button').click()")
        self.tab.wait_for(f"Number({slider}.value) > 0")

    def test_narrow_page_does_not_scroll_sideways(self):
        for width in (400, 1280):
            for dark in (False, True):
                self.tab.size(width, dark=dark)
                self.tab.value("document.querySelectorAll('details').forEach((d) => { d.open = true; })")
                self.seen("figure.chart")
                self.tab.wait_for("document.querySelector('figure.chart canvas') !== null")
                self.assertEqual(self.tab.value("document.documentElement.clientWidth"), width)
                # charts adapt to a new width after the browser has reported it
                self.tab.wait_for("document.documentElement.scrollWidth <= "
                                  "document.documentElement.clientWidth", patience_s=10.0)

    def test_a_chart_is_saved_as_a_picture_with_its_legend(self):
        self.tab.size(1280, dark=True)
        self.seen("figure.chart")
        self.tab.wait_for("document.querySelector('figure.chart .save') !== null")
        self.tab.value("HTMLAnchorElement.prototype.click = function () { window.saved = [this.download, "
                       "this.href]; }; document.querySelector('figure.chart .save').click()")
        self.tab.wait_for("window.saved !== undefined")
        self.assertEqual(self.tab.value("saved[0]"), "force-on-the-hand-N.png")
        self.tab.value("(async () => { window.picture = new Image(); picture.src = saved[1]; "
                       "await picture.decode(); return 0; })()")
        chart = self.tab.value("(() => { const c = document.querySelector('figure.chart canvas'); "
                               "return [c.width, c.height]; })()")
        width, height = self.tab.value("[picture.width, picture.height]")
        self.assertGreaterEqual(width, 1600, "two pixels per CSS pixel")
        self.assertEqual(width, chart[0])
        self.assertGreater(height, chart[1], "the legend")
        colours = self.tab.value(
            "(() => { const c = document.createElement('canvas'); c.width = picture.width; "
            "c.height = picture.height; const x = c.getContext('2d'); x.drawImage(picture, 0, 0); "
            f"const legend = x.getImageData(0, {chart[1]}, c.width, c.height - {chart[1]}).data; "
            "let written = 0; for (let i = 0; i < legend.length; i += 4) written += legend[i] < 250; "
            "return [Array.from(x.getImageData(0, 0, 1, 1).data), written]; })()")
        self.assertEqual(colours[0], [255, 255, 255, 255], "a light picture of a dark page")
        self.assertGreater(colours[1], 500)
        self.assertFalse(self.tab.value("document.documentElement.classList.contains('on-paper')"))

    def test_print_draws_every_chart_in_light_colours(self):
        self.tab.size(1280, dark=True)
        charts = "document.querySelectorAll('figure.chart')"
        open_charts = f"Array.from({charts}).filter((one) => !one.closest('details:not([open])'))"
        drawn = f"{open_charts}.filter((one) => one.querySelector('canvas')).length"
        self.assertLess(self.tab.value(drawn), self.tab.value(f"{open_charts}.length"), "some wait")
        self.tab.value("dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(self.tab.value(drawn), self.tab.value(f"{open_charts}.length"))
        ink = "getComputedStyle(document.documentElement).getPropertyValue('--page').trim()"
        self.assertEqual(self.tab.value(ink), "#ffffff")
        self.tab.value("dispatchEvent(new Event('afterprint'))")
        self.assertNotEqual(self.tab.value(ink), "#ffffff")
        shown = ("['.live', '.legend .save'].map((s) => "
                 "getComputedStyle(document.querySelector(s)).display !== 'none')")
        self.assertEqual(self.tab.value(shown), [True, True])
        self.tab.call("Emulation.setEmulatedMedia", media="print")
        self.assertEqual(self.tab.value(shown), [True, False])
        self.tab.call("Emulation.setEmulatedMedia", media="")

    def test_without_script_a_note_names_the_values_and_nothing_is_empty(self):
        notes = "Array.from(document.querySelectorAll('figure.chart .values'), (one) => one.innerText)"
        self.assertEqual(self.tab.value(notes), [], "the script draws")
        self.tab.call("Emulation.setScriptExecutionDisabled", value=True)
        self.tab.open(self.page)
        self.tab.call("Emulation.setScriptExecutionDisabled", value=False)
        self.assertEqual(self.tab.value("document.querySelectorAll('.live, .legend, button.sort').length"), 0)
        self.assertIn("This chart needs JavaScript. Its values are in force.csv.", self.tab.value(notes))
        self.assertEqual(len(self.tab.value(notes)),
                         self.tab.value("document.querySelectorAll('figure.chart').length"))
        self.assertEqual(self.tab.value("document.querySelector('.view').clientHeight"), 0)
        self.assertIn("is the cheapest", self.tab.value("document.querySelector('nav').innerText"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
