#!/usr/bin/env python3
"""Commands that assess results: compare, validate, stability, bench, and runs compared with others.

    judgements_test.py PROGRAM [unittest's names of tests]
"""
import contextlib
import csv
import json
import os
import re
import socket
import sqlite3
import subprocess
import sys
import time
import unittest
import xml.dom.minidom
from pathlib import Path

from program import PROGRAM, QUICK_COMPARISON, Cli


class Judgements(Cli):
    HAPTIC = ["--set", "compare.haptic.exchange_periods_s=[0.02, 0.01]",
              "--set", "compare.haptic.ticks_s=[0.002, 0.001]", "--set", "compare.haptic.integrators=[]",
              "--set", "compare.haptic.reference_rtol=1e-5",
              "--set", "compare.haptic.reference_refresh_s=2e-3"]

    def rows(self, database):
        try:
            with contextlib.closing(sqlite3.connect(f"file:{database}?mode=rw", uri=True)) as db:
                return db.execute("select count(*) from result where kind = 'point'").fetchone()[0]
        except sqlite3.Error:
            return 0

    def test_compare_prints_orders_and_writes_the_table(self):
        text = self.good("compare", "cantilever", *QUICK_COMPARISON, "-o", "cmp", "--integrator", "cvode-bdf",
                         "--integrator", "linearly-implicit-euler")
        for words in ("fitted order", "reference error", "is the cheapest", "interleaved"):
            self.assertIn(words, text)
        names = {path.name for path in (self.folder / "cmp").iterdir()}
        self.assertEqual({"compare.csv", "reference.json", "report.html", "results.db"}, names)

    def test_compare_takes_several_scenes_and_any_integrator(self):
        arguments = ["compare", "cantilever", "one-tet", "--duration-s", "0.05", "--repeats", "1",
                     "--integrator", "ark-erk-5", "-o", "two",
                     "--limit-s", "5"]  # each run takes about 0.4 s: none is interrupted on a busy machine
        self.good(*arguments)
        table = (self.folder / "two/compare.csv").read_text().splitlines()
        self.assertEqual({line.split(",")[0] for line in table[1:]}, {"cantilever", "one-tet"})
        for scene in ("cantilever", "one-tet"):  # down to the limit of the reference
            rows = [line for line in table if line.startswith(scene + ",")]
            self.assertGreater(len(rows), 4)
            self.assertLess(len(rows), 12)
        page = (self.folder / "two/report.html").read_text()
        xml.dom.minidom.parseString(page)
        self.assertIn("Scene: one-tet", page)
        again = self.good(*arguments)
        self.assertIn("are from earlier runs", again)
        self.assertEqual((self.folder / "two/compare.csv").read_text().splitlines(), table)
        self.assertNotIn("are from earlier runs", self.good(*arguments, "--fresh"))

    def test_compare_goes_on_after_a_kill(self):
        arguments = [str(PROGRAM), "compare", "cantilever", *QUICK_COMPARISON, "-o", "cut",
                     "--integrator", "linearly-implicit-euler", "--integrator", "cvode-bdf", "--jobs", "1"]
        process = subprocess.Popen(arguments, cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        database = self.folder / "cut/results.db"
        end = time.monotonic() + 120
        while self.rows(database) < 3 and process.poll() is None and time.monotonic() < end:
            time.sleep(0.01)
        process.kill()
        process.wait()
        before = self.rows(database)
        self.assertGreaterEqual(before, 3)
        text = self.good(*arguments[1:])
        self.assertIn("are from earlier runs", text)
        with open(self.folder / "cut/compare.csv", newline="") as table:
            run = [row for row in csv.DictReader(table) if row["status"] != "not tried"]
        self.assertEqual(self.rows(database), len(run))

    def test_bench_fem_names_units(self):
        text = self.good("bench", "fem", "--size", "XS", "--threads", "1", "--steps", "3", "--linear-rtol",
                         "1e-3", "--youngs-modulus-pa", "1e5", "--linear-solver", "cholmod", "-o", "out")
        self.assertRegex(text, r"(?m)^size +nodes +E \[Pa\] +h \[ms\] .* step \[ms\] ")
        self.assertRegex(text, r"(?m)^size .* limit \[ms\] *$")
        self.assertRegex(text, r"(?m)^size +thr +stage +least \[ms\] +median \[ms\] +least \[ns/tet\]")
        self.good("report", "out", "-o", "bench.html")
        page = (self.folder / "bench.html").read_text()
        self.assertIn("time of a step, median [ms]", page)
        self.assertIn("E 100000 Pa, 10 ms, 0.001, cholmod, 1 thread", page)

    def test_bench_contact_prints_its_stages(self):
        text = self.good("bench", "contact", "press-ball", "--threads", "1", "-o", "out")
        spread = r"\d+\.\d+ / \d+\.\d+ / \d+\.\d+"
        self.assertRegex(text, rf"(?m)^distance +1 +[1-9]\d* +0\.0 +{spread} +- +\d")
        self.assertRegex(text, rf"(?m)^image +1 +[1-9]\d* +0\.0 +{spread} +\d+\.\d\d +")  # over distance
        self.assertRegex(text, r"(?m)^method .* skins +regions +faces +upload +passes +gather +readback "
                               r"+gaps +rest +forces +tangent *$")
        self.assertRegex(text, r"(?m)^image +1( +\d+\.\d\d){11} *$")
        self.assertRegex(text, r"(?m)^press-ball ")  # costs
        written = json.loads((self.folder / "out/bench-contact.json").read_text())
        points, image = written["scenes"][0]["rows"]
        self.assertEqual((points["method"], image["method"]), ("distance", "image"))
        self.assertRegex(points["device"], r"^.+, (baseline|avx2|avx512)$")
        self.assertIn("4.", image["device"])
        for row in points, image:
            self.assertIn(f"\n  {row['method']}: {row['device']}", text)
        self.assertIn("has no contact with a tool or between bodies",
                      self.refused("bench", "contact", "falling-ball"))

    def test_bench_contact_gives_each_stage_its_spread(self):
        text = self.good("bench", "contact", "press-ball", "--method", "distance", "--threads", "1", "--all")
        self.assertRegex(text, r"(?m)^distance +1( +\d+\.\d+ / \d+\.\d+ / \d+\.\d+){11} *$")

    def test_bench_contact_without_opengl_says_so(self):
        done = self.call("bench", "contact", "press-ball", "--threads", "1",
                         __EGL_VENDOR_LIBRARY_FILENAMES="/nowhere")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"(?m)^image is omitted: .*install ")
        self.assertNotRegex(done.stdout, r"(?m)^image +1 ")

    def test_bench_contact_checks_its_bars(self):
        scene = (PROGRAM.parent / "../share/palpate/scenes/press-ball.toml").read_text()
        scene = scene.split("\n[compare]")[0]
        quick = scene.replace('name = "cvode-bdf"\nrtol = 1e-3',
                              'name = "linearly-implicit-euler"\nstep_s = 0.01')
        self.assertNotEqual(quick, scene)
        (self.folder / "quick.toml").write_text(quick)
        done = self.call("bench", "contact", "quick.toml", "--method", "distance", "--threads", "1",
                         "--check")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(done.stderr, "")
        self.assertRegex(done.stdout, r"(?m)^press-ball +query / step +\S+ +<= 1 +missed *$")
        bars = re.findall(r"(?m)^press-ball .* (?:<=|>=) \S+ +(met|missed) *$", done.stdout)
        self.assertTrue(done.stdout.endswith(f"\n{bars.count('met')} of {len(bars)} limits met\n"),
                        done.stdout)
        # before contact there are few events: in one of several attempts, however busy the machine is
        (self.folder / "apart.toml").write_text(scene.replace("duration_s = 0.4", "duration_s = 0.05"))
        for _ in range(10):
            done = self.call("bench", "contact", "apart.toml", "--method", "distance", "--threads", "1",
                             "--check")
            met = 1 if done.returncode == 0 else 0
            self.assertTrue(done.stdout.endswith(f"\n{met} of 1 limits met\n"), done.stdout + done.stderr)
            if met:
                break
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_run_is_replayed_and_compared(self):
        text = self.good("run", "press-ball", "--duration-s", "0.2", "--realtime", "--passivity", "observe",
                         "-o", "first")
        self.assertIn("clock.csv", os.listdir(self.folder / "first"))
        parts = re.search(r"an exchange takes (\S+) ms on average: query (\S+), linearisation (\S+), "
                          r"step of the bodies (\S+)\n", text)
        whole, *shares = map(float, parts.groups())
        self.assertGreater(whole, 0.0)
        self.assertAlmostEqual(whole, sum(shares), delta=0.25)
        text = self.good("replay", "first")
        self.assertEqual(text, "200 ticks compared, 0.001 to 0.2 s: bitwise identical\n")
        text = self.good("replay", "first", "--set", "exchange.latency_ticks=10", "-o", "late")
        self.assertRegex(text, r"(?m)^force: differs by \S+ N RMS")
        self.assertIn("force: differs by", self.good("diff", "first", "late"))
        self.assertIn("bitwise identical", self.good("diff", "late", "late"))
        done = self.call("diff", "first", "nowhere")
        self.assertEqual(done.returncode, 1)
        self.assertIn("nowhere/haptic.h5: no such file", done.stderr)
        error = self.refused("replay", "first", "--set", "scene.duration_s=0.001")
        self.assertRegex(error, r"^palpate: error: \S*first/scene\.toml:\d+:\d+: ")

    def test_a_hand_is_held_again_by_its_record(self):
        self.good("run", "press-ball", "--duration-s", "0.2", "-o", "first")
        self.good("run", "press-ball", "--duration-s", "0.2", "-o", "again", "--set",
                  f'device={{type="recording",file="{self.folder}/first/haptic.h5"}}')
        self.assertIn("200 ticks compared, 0.001 to 0.2 s: bitwise identical",
                      self.good("diff", "first", "again"))
        error = self.refused("run", "press-ball", "--set",
                             f'device={{type="recording",file="{self.folder}/first/run.h5"}}')
        self.assertIn("run.h5", error)

    def test_real_time_is_always_kept(self):
        scene = Path(self.shipped("press-ball")).read_text()
        (self.folder / "bare.toml").write_text(re.sub(r"\[record\]\n([^\[\n]*\n)*", "", scene))
        text = self.good("run", "bare.toml", "--duration-s", "0.05", "--realtime", "-o", "kept")
        self.assertRegex(text, r"in kept: clock\.csv, force\.csv, haptic\.h5, scene\.toml, summary\.json")
        self.assertIn("50 ticks compared", self.good("replay", "kept"))
        text = self.good("run", "bare.toml", "--duration-s", "0.05", "-o", "virtual")
        self.assertIn("in virtual: scene.toml, summary.json\n", text)

    def test_a_peer_that_sends_nothing_is_told_of(self):
        with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as one:
            one.bind(("127.0.0.1", 0))
            port = one.getsockname()[1]
        with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as peer:
            done = subprocess.Popen([PROGRAM, "run", "press-ball", "--duration-s", "0.4", "--realtime", "-o",
                                     "out", "--set", f'device={{type="udp",port={port},wait_s=0.3}}'],
                                     cwd=self.folder,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while done.poll() is None:
                peer.sendto(b"no packet of ours", ("127.0.0.1", port))
                time.sleep(0.01)
            text, error = done.communicate()
        self.assertEqual(done.returncode, 1, text)
        packets = re.search(r"within 0\.3 s \((\d+) packets were rejected: (\d+) malformed", error)
        self.assertGreater(int(packets[1]), 3)
        self.assertEqual(packets[1], packets[2])

    def test_semi_implicit_beyond_its_limit_is_warned_of(self):
        run = ["run", "press-ball", "--duration-s", "0.02", "-o", "out", "--set",
               "tool.integrator=semi-implicit-euler", "--set"]
        # limit 4 m/h^2 - 2 b/h with 0.01 kg, 3 N s/m and ticks of 1 ms
        done = self.call(*run, "tool.coupling.stiffness_n_m=3.5e4")
        self.assertRegex(done.stderr,
                         r"stiffness_n_m = 35000 N/m is not below its stability limit of 34000 N/m")
        done = self.call(*run, "tool.coupling.stiffness_n_m=3.3e4")
        self.assertNotIn("diverges", done.stderr)
        done = self.call(*run, "tool.coupling.rotational_stiffness_n_m_rad=1e4")
        self.assertRegex(done.stderr, r"rotational_stiffness_n_m_rad = 10000 N m/rad is not below")

    def test_a_single_rate_is_simulated_again_bit_for_bit(self):
        # under error control with a direct solver: a replay with more BLAS threads would differ by rounding
        for clock in [], ["--realtime"]:
            self.good("run", "press-ball", "--duration-s", "0.15", *clock, "--integrator", "cvode-bdf",
                      "--set", "exchange.scheme=single_rate", "--set", "integrator.linear_solver=cholmod",
                      "-o", "single")
            self.assertIn("bitwise identical", self.good("replay", "single"))

    def test_the_choice_of_a_scheme_is_printed_and_kept(self):
        text = self.good("run", "press-ball", "--duration-s", "0.05", "--set", "exchange.scheme=auto",
                         "-o", "run")
        chosen = re.search(r'(?m)^exchange\.scheme = "auto": (\w+), because a step of tool and bodies takes ',
                           text).group(1)
        figures = json.loads((self.folder / "run/summary.json").read_text())["figures"]
        self.assertEqual(figures["options"]["exchange_scheme"], chosen)
        self.assertIn(f"exchange.scheme=\"{chosen}\"", (self.folder / "run/scene.toml").read_text())
        self.assertIn("bitwise identical", self.good("replay", "run"))

    def test_each_of_two_hands_is_replayed_and_compared(self):
        text = self.good("run", "two-hands", "--duration-s", "0.2", "--against-monolithic", "-o", "first",
                         "--set", "compare.haptic.reference_rtol=1e-4",
                         "--set", "compare.haptic.reference_refresh_s=4e-3")
        off = re.findall(r"(?m)^against .*?: (hand left: )?force error \S+ N RMS \((\S+) % of the peak",
                         text)
        self.assertEqual([whose for whose, _ in off], ["", "hand left: "], text)
        for _, share in off:
            self.assertLess(float(share), 10.0, text)
        figures = json.loads((self.folder / "first/summary.json").read_text())["figures"]
        self.assertGreater(figures["against_monolithic"][1]["reference_peak_force_n"], 1.0)
        self.assertEqual([error["hand"] for error in figures["against_monolithic"]], ["tool", "left"])
        same = "200 ticks compared, 0.001 to 0.2 s: bitwise identical\n"
        self.assertEqual(self.good("replay", "first"), f"tool:\n{same}left:\n{same}")
        text = self.good("replay", "first", "--set", "exchange.exchange_period_s=0.005", "-o", "other")
        self.assertRegex(text, r"(?m)^tool:\n(.*\n)*force: differs(.*\n)*left:\n(.*\n)*force: differs")
        self.assertIn("\nleft:\n", self.good("diff", "first", "other"))
        # files of an earlier run are not taken for this run's, and files of the user are kept
        (self.folder / "other/force-measured.csv").write_text("1,2\n")
        self.good("run", "press-ball", "--duration-s", "0.1", "-o", "other")
        self.assertIn("left: not present in other", self.good("diff", "first", "other"))
        self.assertIn("left: not present in other", self.good("diff", "other", "first"))
        self.assertEqual((self.folder / "other/force-measured.csv").read_text(), "1,2\n")

    def test_without_a_tool_nothing_is_replayed(self):
        self.good("run", "falling-ball", "--duration-s", "0.05", "-o", "fallen")
        done = self.call("replay", "fallen")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the scene of fallen has no [tool]", done.stderr)

    def test_what_a_hand_feels_is_compared_with_one_system(self):
        arguments = ["compare", "--haptic", "press-ball", "--duration-s", "0.08", "--repeats", "1",
                     *self.HAPTIC, "-o", "felt"]
        text = self.good(*arguments)
        self.assertRegex(text, r"(?m)^press-ball: reference monolithic solution by cvode-bdf")
        self.assertRegex(text, r"(?m)^observed order by exchange alone: force ")
        for variable in ("exchange period", "exchange alone", "tick", "integrator", "scheme",
                         "linearisation"):
            self.assertRegex(text, rf"(?m)^{variable} ")
        names = {path.name for path in (self.folder / "felt").iterdir()}
        self.assertEqual({"haptic.csv", "summary.json", "report.html", "results.db"}, names)
        figures = json.loads((self.folder / "felt/summary.json").read_text())["figures"]
        self.assertGreater(figures["monolithic_reference"]["peak_force_n"], 0.1)
        self.assertLess(figures["against_monolithic"][0]["force_error_rms_of_peak"], 0.2)
        self.assertIn("Force on the hand against the monolithic solution",
                      (self.folder / "felt/report.html").read_text())
        self.assertIn("are from earlier runs", self.good(*arguments))
        self.assertIn("there is no [tool]", self.refused("compare", "--haptic", "cantilever"))
        self.assertIn("takes one SCENE", self.refused("compare", "--haptic", "press-ball", "twist-ball"))
        self.assertIn("--all", self.refused("compare", "--haptic", "press-ball", "--all"))

    def test_the_error_due_to_the_mesh_is_estimated(self):
        arguments = ["compare", "--mesh", "one-tet", "-o", "mesh"]
        self.assertIn("no mesh of more than one element", self.good(*arguments))
        arguments = ["compare", "--mesh", "cantilever", "--duration-s", "0.02", "--levels", "2",
                     "--coarser", "1", "--set", "body.0.mesh.element_size_m=0.02", "-o", "mesh"]
        text = self.good(*arguments)
        first = text.splitlines()[0]
        self.assertRegex(first, r"^cantilever: peak displacement \S+ m: [+-]\S+ % \+- \S+ % due to the ")
        self.assertNotRegex(text, r"\bnan\b")
        summary = json.loads((self.folder / "mesh/summary.json").read_text())
        errors = summary["figures"]["mesh_errors"]
        self.assertEqual(errors[0]["convergence"], "two levels, order assumed")
        self.assertAlmostEqual(errors[0]["error_m"], errors[0]["value_m"] - errors[0]["estimate_m"])
        self.assertGreater(errors[0]["uncertainty_m"], 0)
        levels = summary["figures"]["mesh_levels"]
        self.assertGreater(levels[1]["elements"], levels[0]["elements"])
        self.assertEqual(json.loads(self.good(*arguments, "--json"))["figures"]["mesh_errors"], errors)
        self.assertIn("Error due to the mesh", (self.folder / "mesh/report.html").read_text())
        self.assertIn("takes one SCENE", self.refused("compare", "--mesh", "press-ball", "twist-ball"))
        self.assertIn("--haptic", self.refused("compare", "--mesh", "press-ball", "--haptic"))
        self.assertIn("--mesh", self.refused("compare", "press-ball", "--json"))

    def test_a_run_says_how_far_it_was_from_one_system(self):
        run = ["run", "press-ball", "--duration-s", "0.1", "--against-monolithic", *self.HAPTIC, "-o", "held"]
        text = self.good(*run)
        self.assertRegex(text,
                         r"(?m)^against .*: force error \S+ N RMS \(\S+ % of the peak of \S+\), at most ")
        self.assertNotIn("recorded motion of the hand", text)
        figures = json.loads((self.folder / "held/summary.json").read_text())["figures"]
        (kept,) = figures["against_monolithic"]
        self.assertLess(kept["force_error_rms_of_peak"], 0.2)
        self.assertIn("with the recorded motion of the hand", self.good(*run, "--realtime"))
        self.assertIn("there is no [tool]", self.refused("run", "one-tet", "--against-monolithic"))

    def test_a_scene_is_judged_as_a_haptic_loop(self):
        text = self.good("stability", "--haptic", "press-ball", "-o", "wall")
        self.assertRegex(text, r"the passive walls are within the stable ones; "
                               r"simulation and theory differ by at most \S+ %")
        self.assertLessEqual({"z_width.csv", "report.html"}, set(os.listdir(self.folder / "wall")))
        self.assertIn("largest stiffness of the wall [N/m]", (self.folder / "wall/report.html").read_text())
        self.assertIn("about the axis of least inertia of the tool", text)
        self.assertNotIn("UNSTABLE", text)
        # the limit 4 I/h^2 of the ball of 80 g and 20 mm is 51 N m/rad
        done = self.call("stability", "--haptic", "press-ball", "-o", "turned", "--set",
                         "tool.integrator=semi-implicit-euler", "--set",
                         "tool.coupling.rotational_stiffness_n_m_rad=1e3")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertRegex(done.stdout, r"the loop of this scene is UNSTABLE: tool in the air \(rotation\)")
        self.assertNotRegex(done.stdout, r"UNSTABLE.*\(translation\)")
        self.assertIn("SCENE requires --haptic", self.refused("stability", "press-ball"))
        self.assertIn("--rows", self.refused("stability", "--rows", "slivers"))

    def test_validate(self):
        self.assertIn("--slow excludes --quick", self.refused("validate", "--quick", "--slow"))
        text = self.good("validate", "rigid-motion", "-o", "val")
        self.assertRegex(text, r"(?m)^rigid-motion +C +any rotation and translation: no force, no energy")
        self.assertRegex(text, r"(?m)^rigid-motion .* pass$")
        cases = json.loads((self.folder / "val/validation.json").read_text())["cases"]
        self.assertEqual([case["name"] for case in cases], ["rigid-motion"])
        self.assertTrue(all(m["passed"] for m in cases[0]["measurements"]))
        for option in ("--inject-faults", "--sabotage"):  # the second is an old name, not in the help
            self.assertIn("fails, as required", self.good("validate", "rigid-motion", option))
        self.assertNotIn("sabotage", self.good("validate", "--help"))

    def test_validate_side_by_side(self):
        cases = ["patch-test", "rigid-motion", "vertex-list"]
        rows = [self.good("validate", *cases, "--jobs", jobs) for jobs in ("1", "3")]
        self.assertEqual(rows[0], rows[1])
        self.assertIn("3 of 3 cases meet their acceptance limits", rows[0])
        passed = re.findall(r"(?m)^([a-z-]+) .* pass$", rows[0])  # as specified, whichever ended first
        self.assertEqual(list(dict.fromkeys(passed)), cases)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
