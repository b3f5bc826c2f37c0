#!/usr/bin/env python3
"""Results of a run: its files, pictures, pages and lists.  Forces, depths and energies of its contacts are
tested in contact_results_test.py.

    results_test.py PROGRAM [unittest's names of tests]
"""
import csv
import html
import json
import math
import re
import struct
import sys
import unittest
import xml.dom.minidom
from pathlib import Path

try:
    import h5py
except ImportError:  # package python3-h5py
    sys.exit("python3-h5py is missing")

from program import PROGRAM, Cli


class Results(Cli):
    def head_of_page(self, folder):
        """Returns the lines of the head of a page, above its first section."""
        page = (self.folder / folder / "report.html").read_text()
        head = page[page.index("<h1"):page.index("<h2")]
        return [html.unescape(line).strip() for line in re.sub("<[^>]*>", "\n", head).split("\n")]

    def png_size(self, path):
        data = path.read_bytes()
        self.assertTrue(data.startswith(b"\x89PNG") and data.endswith(b"IEND\xaeB\x60\x82"), path)
        return struct.unpack(">II", data[16:24])

    def frames(self, folder):
        return sorted(path.name for path in (self.folder / folder / "frames").iterdir())

    def test_run_writes_what_the_scene_records(self):
        text = self.good("run", "one-tet", "-o", "here", "--duration-s", "0.1",
                         "--set", "body.0.youngs_modulus_pa=2e5", "--report")
        self.assertIn("0.1 s simulated", text)
        peak = int(re.search(r"peak memory (\d+) MiB", text)[1])
        self.assertIn("in here: report.html, run.vtkhdf, run.xdmf, scene.toml, summary.json", text)
        names = {path.name for path in (self.folder / "here").iterdir()}
        self.assertEqual(names, {"run.vtkhdf", "run.xdmf", "summary.json", "scene.toml", "report.html"})
        summary = json.loads((self.folder / "here/summary.json").read_text())
        self.assertAlmostEqual(summary["figures"]["sizes"]["peak_memory_mib"], peak, delta=2.0)
        self.assertEqual(summary["outcome"], "finished")
        self.assertEqual(summary["command"], "palpate run one-tet --set body.0.youngs_modulus_pa=2e5 "
                                             "--duration-s 0.1 --report -o here")
        self.assertEqual(summary["overrides"], ["body.0.youngs_modulus_pa=2e5"])
        with h5py.File(self.folder / "here/run.vtkhdf") as file:
            steps = file["VTKHDF/Steps"]
            self.assertEqual(steps.attrs["NSteps"], 11)
            for step in range(11):
                self.assertAlmostEqual(steps["Values"][step], 0.01 * step, delta=1e-12)
        xml.dom.minidom.parse(str(self.folder / "here/report.html"))

    def test_trace_is_a_table_and_a_plot(self):
        text = self.good("run", "one-tet", "-o", "traced", "--duration-s", "0.1", "--trace", "--report")
        self.assertRegex(text, r"trace: \d+ attempted steps, \d+ rejected")
        lines = (self.folder / "traced/trace.csv").read_text().splitlines()
        columns = "time_s,step_s,order,error,newton_iterations,outcome,worst_body,"
        self.assertTrue(lines[0].startswith(columns))
        self.assertEqual(len(lines) - 1, int(re.search(r"trace: (\d+)", text).group(1)))
        self.assertIn("causes of rejection", (self.folder / "traced/report.html").read_text())

    def test_report_is_one_page_of_any_results(self):
        self.good("run", "one-tet", "-o", "one", "--duration-s", "0.1")
        self.good("validate", "patch-test", "-o", "checked")
        self.assertEqual(self.good("report", "one"), "written: one/report.html\n")
        self.good("report", "one", "checked", "-o", "deep/all.html")
        page = (self.folder / "deep/all.html").read_text()
        xml.dom.minidom.parseString(page)
        part = {name: page.index(f'id="result-{number}"') for number, name in ((1, "run"), (2, "checks"))}
        self.assertLess(page.index("The run finished: 0.1 s simulated"), part["run"], "the answer is first")
        self.assertLess(page.index("The library agrees with theory"), part["run"])
        self.assertLess(part["run"], part["checks"])
        view = json.loads(re.search(r'class="view-data">(.*?)</script>', page)[1])
        with h5py.File(self.folder / "one/run.vtkhdf") as file:
            steps = file["VTKHDF/Steps"]
            self.assertEqual(view["times_s"], list(steps["Values"][:steps.attrs["NSteps"]]))
        self.assertLess(len(page), 1_000_000)

    def test_report_refuses_a_folder_without_results(self):
        (self.folder / "empty").mkdir()
        self.assertIn("empty: contains no results to report", self.refused("report", "empty"))
        self.assertIn("nowhere: is not a directory", self.refused("report", "nowhere"))
        self.assertFalse((self.folder / "empty/report.html").exists())

    def test_modes_are_a_table_and_a_time_series(self):
        text = self.good("modes", "cantilever", "--count", "4", "-o", "here")
        lines = (self.folder / "here/modes.csv").read_text().splitlines()
        self.assertEqual(lines[0], "mode,frequency_hz,omega_rad_s,omega_squared_1_s2,residual")
        frequencies = [float(line.split(",")[1]) for line in lines[1:]]
        self.assertEqual(len(frequencies), 4)
        self.assertEqual(frequencies, sorted(frequencies))
        self.assertIn(f"{frequencies[0]:.6g}", text)
        with h5py.File(self.folder / "here/modes.vtkhdf") as file:
            steps = file["VTKHDF/Steps"]
            self.assertEqual(steps.attrs["NSteps"], 4)
            self.assertEqual(list(steps["Values"]), [1, 2, 3, 4])
            largest = (file["VTKHDF/PointData/displacement"][:] ** 2).sum(axis=1).max() ** 0.5
            size = max(file["VTKHDF/Points"][:].max(axis=0) - file["VTKHDF/Points"][:].min(axis=0))
            self.assertTrue(0.05 * size < largest < 0.15 * size)

    def test_modes_with_a_tool_and_of_a_free_body(self):
        self.good("modes", "press-ball", "--count", "3")
        self.assertEqual(self.good("modes", "falling-ball", "--count", "8", "-o", "ball").count("rigid"), 6)
        self.assertIn("--count", self.refused("modes", "one-tet", "--count", "0"))

    def test_default_folder(self):
        self.good("run", "one-tet", "--duration-s", "0.02")
        self.assertTrue((self.folder / "out/one-tet/summary.json").is_file())

    def test_nothing_recorded_no_file(self):
        scene = Path(self.shipped("one-tet")).read_text()
        (self.folder / "bare.toml").write_text(scene[:scene.index("[record]")])
        text = self.good("run", "bare.toml", "--duration-s", "0.02")
        self.assertEqual(text.splitlines()[-1], "no file was written, because the scene has no [record]")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["bare.toml"])
        text = self.good("run", "bare.toml", "--duration-s", "0.02", "-o", "asked")
        self.assertEqual(text.splitlines()[-2:], ["in asked: scene.toml, summary.json",
                                                  "states were not written, because the scene has no "
                                                  "[record]; --set record.states=true writes them"])

    def test_the_peak_on_each_hand_is_kept(self):
        self.good("run", "two-hands", "--duration-s", "0.06", "-o", "out")
        figures = json.loads((self.folder / "out/summary.json").read_text())["figures"]
        self.assertEqual([hand["name"] for hand in figures["hands"]], ["tool", "left"])
        for hand, file in zip(figures["hands"], ("force.csv", "force-left.csv")):
            rows = [[float(row[f"force_{axis}_n"]) for axis in "xyz"] + [float(row["time_s"])]
                    for row in csv.DictReader((self.folder / "out" / file).read_text().splitlines())]
            *peak, time_s = max(rows, key=lambda row: math.hypot(*row[:3]))
            self.assertGreater(math.hypot(*peak), 0.01)
            self.assertAlmostEqual(hand["peak_force_n"], math.hypot(*peak), delta=1e-5)
            self.assertAlmostEqual(hand["peak_force_at_s"], time_s, delta=1e-9)

    def test_a_bound_beyond_the_target_is_no_error(self):
        """Exchanges within the target are counted, and the bounds of the others listed separately."""
        text = self.good("run", "two-hands", "--duration-s", "0.12", "-o", "out")
        figures = json.loads((self.folder / "out/summary.json").read_text())["figures"]
        beyond = 0
        self.assertEqual([kept["hand"] for kept in figures["reductions"]], ["tool", "left"])
        for kept in figures["reductions"]:
            tool = kept["hand"]
            all_of_them, missed = kept["exchanges"], kept["exchanges_beyond_requested_error"]
            beyond += missed
            line = next(x for x in text.splitlines() if x.startswith(f"{tool}: reduced response"))
            self.assertIn(f"(bound) in {all_of_them - missed} of {all_of_them} exchanges", line)
            self.assertEqual("stopped at its limit" in line, missed > 0)
            self.assertEqual("which are not informative" in line, kept["largest_error_bound"] > 1.0)
            self.assertLessEqual(float(re.search(r"at most (\S+) %", line)[1]),
                                 100.0 * kept["requested_error"])
        self.assertGreater(beyond, 0)  # otherwise the test has no effect

    def test_integrator_option_is_the_one_that_runs(self):
        text = self.good("run", "one-tet", "--duration-s", "0.1", "--integrator", "linearly-implicit-euler",
                         "--set", "integrator.step_s=0.01")
        self.assertIn("linearly-implicit-euler: 10 steps", text)

    def test_a_page_says_first_what_the_terminal_said(self):
        lines = self.good("run", "press-ball", "--realtime", "--duration-s", "0.1", "--report", "-o",
                          "timed").splitlines()
        verdicts = [line for line in lines if line.startswith(("buzz: ", "deepest overlap: ", "real time: "))]
        self.assertGreaterEqual(len(verdicts), 3)
        self.assertLessEqual(set(verdicts), set(self.head_of_page("timed")))

        lines = self.good("stability", "--haptic", "press-ball", "-o", "judged").splitlines()
        verdicts = [line for line in lines if ": stable" in line or ": unstable" in line]
        self.assertEqual(len(verdicts), 6)
        self.good("report", "judged")
        self.assertLessEqual(set(verdicts), set(self.head_of_page("judged")))

    def test_lists(self):
        everything = self.good("list", "--all")
        overview = self.good("list")
        self.assertLess(len(overview.splitlines()), 30)
        for what, member in {"integrators": "cvode-bdf", "linear-solvers": "cholmod",
                             "materials": "liver", "laws": "stable_neo_hookean",
                             "tool-integrators": "simbody-cpodes",
                             "obstacles": "cylinder", "contact-methods": "image", "generators": "tet",
                             "contact-springs": "per_point", "contact-laws": "hunt_crossley",
                             "devices": "script",
                             "cases": "patch-test", "parts": "contact", "scenes": "press-ball"}.items():
            with self.subTest(what=what):
                one = self.good("list", what)
                self.assertRegex(one, rf"(?m)^{member} ")
                self.assertIn(one, everything)
                entries = len(one.splitlines()) - 4  # without title, headers, rule and blank line
                self.assertRegex(overview, rf"(?m)^{what} +{entries} ")
        self.assertIn("--all", self.refused("list", "devices", "--all"))

    def test_models_are_made_once_and_kept(self):
        if not (PROGRAM.parent / "palpate-model").exists():
            self.skipTest("this build makes no models")
        models = str(self.folder / "models")
        scene = ["run", "two-pumpkins", "--duration-s", "0.01", "-o", "kept"]
        first = self.call(*scene, PALPATE_MODELS=models)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(first.stderr.count('making the model "pumpkin", once; stored in '), 1, first.stderr)
        kept = list(Path(models).glob("*/*"))
        self.assertEqual([path.name for path in kept], ["pumpkin.h5"])
        summary = json.loads((self.folder / "kept/summary.json").read_text())
        self.assertEqual(summary["figures"]["models"], [{"name": "pumpkin", "file": str(kept[0])}])
        again = self.call(*scene, PALPATE_MODELS=models)
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        wrong = self.call("run", "two-pumpkins", "--set", 'body.0.mesh.file="model:heed"',
                          PALPATE_MODELS=models)
        self.assertEqual(wrong.returncode, 1, wrong.stderr)
        self.assertIn('unknown shape "heed" (did you mean "head"?)', wrong.stderr)
        self.assertTrue(wrong.stderr.endswith('palpate: error: the model "heed" was not made; see above\n'))
        self.assertEqual(list(Path(models).glob("*/*")), kept)

    def test_frames_are_numbered_whole_and_of_one_size(self):
        run = ["run", "press-ball", "--frames", "-o", "here"]
        (self.folder / "here/frames").mkdir(parents=True)
        for name in "0007.png", "12345.png", "mine.png":
            (self.folder / "here/frames" / name).write_text("of an earlier run")
        text = self.good(*run, "--duration-s", "0.05")
        numbered = [f"{i:04}.png" for i in range(5)]
        self.assertEqual(self.frames("here"), numbered + ["mine.png"])  # the user's file is unchanged
        self.assertIn("5 of 5 frames in here/frames, one every 0.01 s", text)
        self.assertIn("ffmpeg -framerate 100 -i here/frames/%04d.png", text)
        sizes = {self.png_size(self.folder / "here/frames" / name) for name in numbered}
        self.assertEqual(len(sizes), 1)
        self.assertTrue(all(side % 2 == 0 for side in sizes.pop()))  # required by video encoders
        self.good(*run, "--duration-s", "0.05", "--frames-per-s", "50", "--shade", "penetration")
        self.assertEqual(self.frames("here"), numbered[:3] + ["mine.png"])
        self.assertIn("--frames-per-s 50 --shade penetration",
                      json.loads((self.folder / "here/summary.json").read_text())["command"])
        self.assertIn("reduce the frame rate", self.refused(*run, "--frames-per-s", "1000"))
        self.assertIn("--frames", self.refused("run", "press-ball", "--frames-per-s", "10"))

    def test_contact_picture_is_drawn_where_it_is_asked_for(self):
        run = ["run", "press-ball", "--duration-s", "0.1", "--set", "contact.1.method=image"]
        self.good(*run, "-o", "without")
        self.assertFalse(list((self.folder / "without").glob("*.png")))
        self.good(*run, "--contact-picture", "-o", "with")
        names = sorted(path.name for path in (self.folder / "with").glob("*.png"))
        self.assertEqual(names, ["contact.png", "depth.png"])
        self.assertEqual(self.png_size(self.folder / "with/contact.png"), (1600, 800))
        self.assertIn("no [[contact]]", self.refused("run", "cantilever", "--contact-picture"))
        self.assertIn("no [[contact]]",
                      self.refused("run", "cantilever", "--picture", "--shade", "penetration"))

    def test_keys_are_listed_with_unit_range_default_and_meaning(self):
        text = self.good("list", "keys")
        tables = re.findall(r"(?m)^\[([a-z.]+)\]$", text)
        self.assertEqual(len(tables), len(set(tables)))
        for table in ("scene", "body", "body.mesh", "obstacle", "contact", "tool.coupling", "device",
                      "exchange", "integrator", "record", "compare.ladder"):
            self.assertIn(table, tables)
        self.assertRegex(text, r"(?m)^spectral_radius +number +\[0, 1\] +0\.8 +.* generalized-alpha$")
        self.assertRegex(text, r"(?m)^youngs_modulus_pa +number +Pa +> 0 +required +Young's modulus; ")

    def test_another_method_says_what_it_leaves_out(self):
        done = self.call("run", "one-tet", "--integrator", "rk4", "--duration-s", "0.001")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("palpate: integrator.rtol of the scene is ignored: the selection by --integrator or "
                      "--set does not use it\n", done.stderr)
        self.assertEqual(self.call("run", "one-tet", "--duration-s", "0.001").stderr, "")

    def test_keys_of_another_method_are_refused(self):
        text = self.refused("run", "one-tet", "--integrator", "rk4",
                            "--set", "integrator.spectral_radius=0.5")
        self.assertIn("spectral_radius does not apply to integrator \"rk4\", which takes step_s, max_steps, "
                      "threads; remove it (used by generalized-alpha)", text)
        self.assertIn("method = \"vertex\" does not exist; \"analytic\" and \"image\" sample at vertices",
                      self.refused("inspect", "press-ball", "--set", "contact.1.method=vertex"))

    def test_inspect_says_what_is_left_out(self):
        text = self.good("inspect", "falling-ball", "--all")
        self.assertRegex(text, r"(?m)^tool +left out")
        self.assertRegex(text, r"(?m)^gl +left out")
        self.assertRegex(text, r"(?m)^unknowns \(velocities\) +\d+")
        self.assertRegex(self.good("inspect", "press-ball", "--all"), r"(?m)^tool +in use")

    def test_inspect_answers_in_a_screen(self):
        text = self.good("inspect", "press-ball")
        self.assertLess(len(text.splitlines()), 16)
        self.assertNotIn("left out", text)
        self.assertRegex(text, r"(?m)^ball +309 +1280 +\d+ +0\.1\d* +5\d(\.\d+)? x 5\d(\.\d+)? x 5\d")
        self.assertRegex(text, r"(?m)^tool - ball +3(\.\d+)? +apart +yes")
        self.assertNotRegex(text, r"(?m)^tool - floor", "no contact, and far apart")
        self.assertRegex(self.good("inspect", "press-ball", "--all"), r"(?m)^tool - floor +\d.* apart +no")
        self.assertRegex(text, r"\d+ unknowns, cvode-bdf; 0.4 s in periods of 10 ms; a run needs about \d+ ")


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
