#!/usr/bin/env python3
"""The program as a person meets it: help, messages, exit statuses, files, Ctrl-C.

    cli_test.py PROGRAM
"""
import contextlib
import csv
import fcntl
import html
import json
import math
import os
import pty
import re
import resource
import select
import shutil
import signal
import socket
import sqlite3
import struct
import subprocess
import sys
import tempfile
import termios
import time
import unittest
import xml.dom.minidom
from pathlib import Path

try:
    import h5py
except ImportError:  # package python3-h5py
    sys.exit("python3-h5py is missing")

PROGRAM = Path(sys.argv[1]).resolve()
TREE = Path(__file__).resolve().parents[2]
COMMANDS = ["demo", "run", "compare", "study", "modes", "validate", "report", "inspect", "export", "list",
            "help", "bench"]
LONG = ["run", "one-tet", "--duration-s", "1e6"]  # ends only when it is stopped


def open_terminal():
    """Both ends of a terminal; skips the test aloud where the machine has none (no /dev/pts)."""
    try:
        return pty.openpty()
    except OSError as error:
        raise unittest.SkipTest(f"this machine has no terminals: {error}") from error


class Cli(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-cli-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def call(self, *arguments, **environment):
        done = subprocess.run([str(PROGRAM), *arguments], capture_output=True, text=True, cwd=self.folder,
                              timeout=300, env=dict(os.environ, **environment), stdin=subprocess.DEVNULL)
        self.assertNotIn("\033", done.stdout + done.stderr)  # no terminal, no control codes
        return done

    def good(self, *arguments, **environment):
        done = self.call(*arguments, **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *arguments):
        done = self.call(*arguments)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr


class Help(Cli):
    def test_help_teaches_by_example(self):
        for command in [[]] + [[name] for name in COMMANDS]:
            with self.subTest(command=command):
                text = self.good(*command, "--help")
                self.assertRegex(text, r"Examples?:\n  palpate ")
        for name in COMMANDS:
            self.assertIn(f"  {name} ", self.good("--help"))

    def test_no_argument_is_a_question_for_help(self):
        self.assertEqual(self.good(), self.good("--help"))

    def test_help_names_every_list(self):
        known = re.search(r"\(known: (.*)\)", self.refused("list", "nothing"))[1].split(", ")
        self.assertGreater(len(known), 10)
        text = self.good("list", "--help")
        for name in known:
            self.assertRegex(text, rf"[ ,]{name}[,;:]", name)

    def test_every_example_of_the_help_is_understood(self):
        seen = 0
        for command in [[]] + [[name] for name in COMMANDS]:
            for line in re.findall(r"^  palpate (.+?)(?:   .*)?$", self.good(*command, "--help"), re.M):
                # An option that does not exist is refused before --help is heeded; the command is not run.
                known = self.good(line.split()[0], "--help")
                for option in re.findall(r"(?<= )--?[a-z][a-z-]*", line):
                    self.assertRegex(known, rf"(^|[ ,]){option}\b", line)
                seen += 1
        self.assertGreater(seen, 15)

    def test_help_lists_its_topics_and_prints_each(self):
        pages = {page.stem: page.read_text() for page in (TREE / "docs").glob("*.md") if page.stem != "index"}
        listed = self.good("help")
        self.assertGreater(len(pages), 15)
        for topic, markdown in pages.items():
            with self.subTest(topic=topic):
                self.assertRegex(listed, rf"(?m)^{topic} +\w")
                self.assertEqual(self.good("help", topic, "--markdown"), markdown)
                text = self.good("help", topic)
                for heading in re.findall(r"^#+ (\w+)", re.sub(r"```.*?```", "", markdown, flags=re.S), re.M):
                    self.assertIn(heading, text)
                self.assertNotRegex(text, r"\]\(\S+\.md|\n(#+ |```)")

    def test_help_is_filled_to_the_terminal(self):
        for columns in 60, 90:
            leader, follower = open_terminal()
            fcntl.ioctl(follower, termios.TIOCSWINSZ, struct.pack("HHHH", 30, columns, 0, 0))
            child = subprocess.Popen([PROGRAM, "help", "limits"], stdout=follower, stdin=subprocess.DEVNULL)
            os.close(follower)
            text = b""
            with contextlib.suppress(OSError):  # the end of a pseudo-terminal
                while part := os.read(leader, 65536):
                    text += part
            child.wait()
            os.close(leader)
            widest = max(len(line.rstrip("\r")) for line in text.decode().split("\n"))
            self.assertTrue(columns - 15 < widest <= columns, f"{widest} of {columns}")

    def test_help_of_a_command_is_its_own(self):
        self.assertEqual(self.good("help", "inspect"), self.good("inspect", "--help"))
        self.assertIn("matrix", self.good("help", "stability"))  # a page as well: the page

    def test_unknown_topic(self):
        text = self.refused("help", "kys")
        self.assertIn('did you mean "keys"?', text)
        for topic in ("first-touch", "integrators", "limits"):
            self.assertIn(topic, text)
        self.assertIn("topics: first-touch", self.refused("help", "xyzzyxyzzy"))

    def test_version_names_the_build(self):
        self.assertRegex(self.good("--version"), r"^palpate \d+\.\d+\.\d+ \(commit ")


class Refusals(Cli):
    def test_command_lines(self):
        self.assertIn('did you mean "run"?', self.refused("runn", "one-tet"))
        self.assertIn("palpate run --help", self.refused("run"))
        self.assertIn("--frob", self.refused("run", "one-tet", "--frob"))
        self.assertIn("--duration-s", self.refused("run", "one-tet", "--duration-s", "-1"))
        for value in "nan", "inf", "0":
            self.assertIn("positive, finite", self.refused("run", "one-tet", "--duration-s", value))
        self.assertIn("choose a shorter duration", self.refused("run", "one-tet", "--duration-s", "1e300"))
        self.assertIn("--repeats", self.refused("compare", "cantilever", "--repeats", "0"))

    def test_full_disk(self):
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writes then fail, as on a full disk
            resource.setrlimit(resource.RLIMIT_FSIZE, (20000, 20000))
        command = [PROGRAM, "run", "press-ball", "--duration-s", "0.02", "-o", self.folder / "full"]
        done = subprocess.run(command, preexec_fn=limit, capture_output=True, text=True)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("palpate: error: ", done.stderr)
        self.assertIn("File too large", done.stderr)

    def test_names(self):
        self.assertIn('did you mean "press-ball"?', self.refused("run", "pres-ball"))
        self.assertIn('"cvode-bdf"?', self.refused("run", "one-tet", "--integrator", "cvode-bfd"))
        self.assertIn('did you mean "patch-test"?', self.refused("validate", "patch-tset"))
        self.assertIn("scenes", self.refused("list", "nothing"))
        self.assertIn("leave-out", self.refused("bench", "nothing"))
        self.assertIn("cvode-bdf", self.refused("compare", "cantilever", "--integrator", "no-such"))
        self.assertIn("stress", self.refused("run", "one-tet", "--picture", "--shade", "mood"))

    def test_scenes(self):
        self.assertIn("youngs_modulus_pa", self.refused("run", "one-tet", "--set", "body.0.youngs_modulus=1"))
        (self.folder / "bad.toml").write_text("[scene]\nname = 'x'\nduration_s = 'long'\n")
        self.assertRegex(self.refused("run", "bad.toml"), r"bad\.toml:3:\d+: ")
        (self.folder / "noise.toml").write_bytes(bytes(range(256)) * 4)
        self.refused("inspect", "noise.toml")
        self.assertIn("is a folder", self.refused("run", "."))

    def test_folders(self):
        (self.folder / "file").write_text("")
        self.assertIn("-o DIR", self.refused("run", "one-tet", "-o", "file"))

    def test_integrator_that_gives_up_is_an_error_and_keeps_what_was_recorded(self):
        text = self.refused("run", "one-tet", "--set", "integrator.max_steps=5", "-o", "kept")
        self.assertIn("failed at t = ", text)
        self.assertEqual(json.loads((self.folder / "kept/summary.json").read_text())["outcome"], "failed")
        with h5py.File(self.folder / "kept/run.vtkhdf") as file:
            self.assertGreaterEqual(file["VTKHDF/Steps"].attrs["NSteps"], 1)


class Results(Cli):
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
        self.assertIn("why they were rejected", (self.folder / "traced/report.html").read_text())

    def test_report_is_one_page_of_any_results(self):
        self.good("run", "one-tet", "-o", "one", "--duration-s", "0.1")
        self.good("validate", "patch-test", "-o", "checked")
        self.assertEqual(self.good("report", "one"), "written: one/report.html\n")
        self.good("report", "one", "checked", "-o", "deep/all.html")
        page = (self.folder / "deep/all.html").read_text()
        xml.dom.minidom.parseString(page)
        part = {name: page.index(f'id="result-{number}"') for number, name in ((1, "run"), (2, "checks"))}
        self.assertLess(page.index("The run finished: 0.1 s simulated"), part["run"], "the answer is first")
        self.assertLess(page.index("The library answers as theory says"), part["run"])
        self.assertLess(part["run"], part["checks"])
        view = json.loads(re.search(r'class="view-data">(.*?)</script>', page)[1])
        with h5py.File(self.folder / "one/run.vtkhdf") as file:
            steps = file["VTKHDF/Steps"]
            self.assertEqual(view["times_s"], list(steps["Values"][:steps.attrs["NSteps"]]))
        self.assertLess(len(page), 1_000_000)

    def test_report_refuses_a_folder_without_results(self):
        (self.folder / "empty").mkdir()
        self.assertIn("empty: holds no results to report", self.refused("report", "empty"))
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
        self.assertEqual(text.splitlines()[-1], "no file was written: the scene has no [record]")
        self.assertEqual([path.name for path in self.folder.iterdir()], ["bare.toml"])
        text = self.good("run", "bare.toml", "--duration-s", "0.02", "-o", "asked")
        self.assertEqual(text.splitlines()[-2:], ["in asked: scene.toml, summary.json",
                                                  "states were not kept: the scene has no [record]; "
                                                  "--set record.states=true keeps them"])

    def test_the_peak_on_each_hand_is_kept(self):
        self.good("run", "two-hands", "--duration-s", "0.06", "-o", "out")
        figures = json.loads((self.folder / "out/summary.json").read_text())["figures"]
        for section, file in (("on the hand", "force.csv"), ("on the hand left", "force-left.csv")):
            rows = [[float(row[f"force_{axis}_n"]) for axis in "xyz"] + [float(row["time_s"])]
                    for row in csv.DictReader((self.folder / "out" / file).read_text().splitlines())]
            *peak, time_s = max(rows, key=lambda row: math.hypot(*row[:3]))
            self.assertGreater(math.hypot(*peak), 0.01)
            self.assertAlmostEqual(figures[section]["peak_force_n"], math.hypot(*peak), delta=1e-5)
            self.assertAlmostEqual(figures[section]["peak_force_at_s"], time_s, delta=1e-9)

    def shipped(self, name):
        return PROGRAM.parent.parent / "share/palpate/scenes" / f"{name}.toml"

    def test_integrator_option_is_the_one_that_runs(self):
        text = self.good("run", "one-tet", "--duration-s", "0.1", "--integrator", "linearly-implicit-euler",
                         "--set", "integrator.step_s=0.01")
        self.assertIn("linearly-implicit-euler: 10 steps", text)

    def head_of_page(self, folder):
        """The lines of the head of a page, above its first section."""
        page = (self.folder / folder / "report.html").read_text()
        head = page[page.index("<h1"):page.index("<h2")]
        return [html.unescape(line).strip() for line in re.sub("<[^>]*>", "\n", head).split("\n")]

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

    QUICK = ["--duration-s", "0.05", "--repeats", "1", "--set", "body.0.mesh.element_size_m=0.05"]

    def test_compare_prints_orders_and_writes_the_table(self):
        text = self.good("compare", "cantilever", *self.QUICK, "-o", "cmp", "--integrator", "cvode-bdf",
                         "--integrator", "linearly-implicit-euler")
        for words in ("fitted order", "its own error", "is the cheapest", "interleaved"):
            self.assertIn(words, text)
        names = {path.name for path in (self.folder / "cmp").iterdir()}
        self.assertEqual({"compare.csv", "reference.json", "report.html", "study.sqlite"}, names)

    def test_compare_takes_several_scenes_and_any_integrator(self):
        arguments = ["compare", "cantilever", "one-tet", *self.QUICK[:-2], "--integrator", "ark-erk-5",
                     "-o", "two", "--limit-s", "5"]  # each run takes some 0.4 s: a busy machine ends none
        self.good(*arguments)
        table = (self.folder / "two/compare.csv").read_text().splitlines()
        self.assertEqual({line.split(",")[0] for line in table[1:]}, {"cantilever", "one-tet"})
        for scene in ("cantilever", "one-tet"):  # down to where the reference cannot tell errors
            rows = [line for line in table if line.startswith(scene + ",")]
            self.assertGreater(len(rows), 4)
            self.assertLess(len(rows), 12)
        page = (self.folder / "two/report.html").read_text()
        xml.dom.minidom.parseString(page)
        self.assertIn("Scene: one-tet", page)
        again = self.good(*arguments)
        self.assertIn("were done before", again)
        self.assertEqual((self.folder / "two/compare.csv").read_text().splitlines(), table)
        self.assertNotIn("were done before", self.good(*arguments, "--fresh"))

    def test_compare_goes_on_after_a_kill(self):
        arguments = [str(PROGRAM), "compare", "cantilever", *self.QUICK, "-o", "cut",
                     "--integrator", "linearly-implicit-euler", "--integrator", "cvode-bdf", "--jobs", "1"]
        process = subprocess.Popen(arguments, cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        database = self.folder / "cut/study.sqlite"
        end = time.monotonic() + 120
        while self.rows(database) < 3 and process.poll() is None and time.monotonic() < end:
            time.sleep(0.01)
        process.kill()
        process.wait()
        before = self.rows(database)
        self.assertGreaterEqual(before, 3)
        text = self.good(*arguments[1:])
        self.assertIn("were done before", text)
        with open(self.folder / "cut/compare.csv", newline="") as table:
            run = [row for row in csv.DictReader(table) if row["status"] != "not tried"]
        self.assertEqual(self.rows(database), len(run))

    def rows(self, database):
        try:
            with contextlib.closing(sqlite3.connect(f"file:{database}?mode=ro", uri=True)) as db:
                return db.execute("select count(*) from run").fetchone()[0]
        except sqlite3.Error:
            return 0

    def test_lists(self):
        everything = self.good("list")
        for what, member in {"integrators": "cvode-bdf", "linear-solvers": "cholmod",
                             "materials": "stable_neo_hookean", "tool-integrators": "simbody-cpodes",
                             "obstacles": "cylinder", "contact-methods": "gpu", "generators": "tet",
                             "contact-springs": "per_point", "contact-laws": "hunt_crossley",
                             "devices": "script",
                             "cases": "patch-test", "parts": "contact", "scenes": "press-ball"}.items():
            with self.subTest(what=what):
                one = self.good("list", what)
                self.assertRegex(one, rf"(?m)^{member} ")
                self.assertIn(one, everything)

    def test_models_are_made_once_and_kept(self):
        if not (PROGRAM.parent / "palpate-model").exists():
            self.skipTest("this build makes no models")
        models = str(self.folder / "models")
        scene = ["run", "two-pumpkins", "--duration-s", "0.01", "-o", "kept"]
        first = self.call(*scene, PALPATE_MODELS=models)
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(first.stderr.count('making the model "pumpkin", once; kept in '), 1, first.stderr)
        kept = list(Path(models).glob("*/*"))
        self.assertEqual([path.name for path in kept], ["pumpkin.h5"])
        summary = json.loads((self.folder / "kept/summary.json").read_text())
        self.assertEqual(summary["figures"]["models"], {"pumpkin": str(kept[0])})
        again = self.call(*scene, PALPATE_MODELS=models)
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        wrong = self.call("run", "two-pumpkins", "--set", 'body.0.mesh.file="model:heed"',
                          PALPATE_MODELS=models)
        self.assertEqual(wrong.returncode, 1, wrong.stderr)
        self.assertIn('unknown shape "heed" (did you mean "head"?)', wrong.stderr)
        self.assertTrue(wrong.stderr.endswith('palpate: error: the model "heed" was not made; see above\n'))
        self.assertEqual(list(Path(models).glob("*/*")), kept)

    def png_size(self, path):
        data = path.read_bytes()
        self.assertTrue(data.startswith(b"\x89PNG") and data.endswith(b"IEND\xaeB\x60\x82"), path)
        return struct.unpack(">II", data[16:24])

    def frames(self, folder):
        return sorted(path.name for path in (self.folder / folder / "frames").iterdir())

    def test_frames_are_numbered_whole_and_of_one_size(self):
        run = ["run", "press-ball", "--frames", "-o", "here"]
        (self.folder / "here/frames").mkdir(parents=True)
        for name in "0007.png", "12345.png", "mine.png":
            (self.folder / "here/frames" / name).write_text("of an earlier run")
        text = self.good(*run, "--duration-s", "0.05")
        numbered = [f"{i:04}.png" for i in range(5)]
        self.assertEqual(self.frames("here"), numbered + ["mine.png"])  # nobody's own is touched
        self.assertIn("5 of 5 frames in here/frames, one every 0.01 s", text)
        self.assertIn("ffmpeg -framerate 100 -i here/frames/%04d.png", text)
        sizes = {self.png_size(self.folder / "here/frames" / name) for name in numbered}
        self.assertEqual(len(sizes), 1)
        self.assertTrue(all(side % 2 == 0 for side in sizes.pop()))  # as video encoders want
        self.good(*run, "--duration-s", "0.05", "--frames-per-s", "50", "--shade", "penetration")
        self.assertEqual(self.frames("here"), numbered[:3] + ["mine.png"])
        self.assertIn("--frames-per-s 50 --shade penetration",
                      json.loads((self.folder / "here/summary.json").read_text())["command"])
        self.assertIn("at most that", self.refused(*run, "--frames-per-s", "1000"))
        self.assertIn("--frames", self.refused("run", "press-ball", "--frames-per-s", "10"))

    def test_contact_picture_is_drawn_where_it_is_asked_for(self):
        run = ["run", "press-ball", "--duration-s", "0.1", "--set", "contact.1.method=cpu"]
        self.good(*run, "-o", "without")
        self.assertFalse(list((self.folder / "without").glob("*.png")))
        self.good(*run, "--contact-picture", "-o", "with")
        names = sorted(path.name for path in (self.folder / "with").glob("*.png"))
        self.assertEqual(names, ["contact.png", "depth.png"])
        self.assertEqual(self.png_size(self.folder / "with/contact.png"), (1600, 800))
        self.assertIn("no [[contact]]", self.refused("run", "cantilever", "--contact-picture"))
        self.assertIn("no [[contact]]",
                      self.refused("run", "cantilever", "--picture", "--shade", "penetration"))

    def table(self, file):
        return list(csv.DictReader((self.folder / file).read_text().splitlines()))

    def test_the_order_of_a_contacts_names_changes_no_byte(self):
        swapped = [f"contact.{i}.between={names}" for i, names in enumerate(
            ['["floor", "slab"]', '["slab", "ball"]', '["tool", "ball"]', '["floor", "tool"]'])]
        run = ["run", "press-stack", "--duration-s", "0.1"]
        self.good(*run, "-o", "one")
        self.good(*run, *(word for change in swapped for word in ("--set", change)), "-o", "other")
        for file in ("force.csv", "energy.csv"):
            one = (self.folder / "one" / file).read_bytes()
            self.assertGreater(len(one), 1000)
            self.assertEqual(one, (self.folder / "other" / file).read_bytes(), file)
        rows = self.table("one/energy.csv")
        self.assertEqual(len(rows), 50)
        for energy in "contact_j", "elastic_j", "work_of_hand_j":
            self.assertGreater(max(float(row[energy]) for row in rows), 1e-5, energy)

    def test_squeeze_ball_presses_to_forty_percent_and_accounts_for_its_energy(self):
        if not (PROGRAM.parent / "palpate-model").exists():
            self.skipTest("this build makes no models")
        done = self.call("run", "squeeze-ball", "-o", "out", PALPATE_MODELS=str(self.folder / "models"))
        self.assertEqual(done.returncode, 0, done.stderr)
        lowest = min(float(row["tool_z_m"]) for row in self.table("out/force.csv"))
        pressed = 0.06 - (lowest - 0.005)  # the ball's height less that of the plate's lower face
        self.assertAlmostEqual(pressed / 0.03, 0.40, delta=0.005)
        rows = [{name: float(value) for name, value in row.items()} for row in self.table("out/energy.csv")]
        self.assertEqual(len(rows), 1200)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual(summary["figures"]["energy"]["unaccounted_j"], rows[-1]["unaccounted_j"])
        work = max(row["work_of_hand_j"] for row in rows)
        elastic = max(row["elastic_j"] for row in rows)
        self.assertGreater(elastic, 0.4 * work)
        for row in rows:
            self.assertLess(abs(row["unaccounted_j"]), 0.002 * work, row)
        self.assertLess(rows[-1]["elastic_j"], 2e-3 * elastic)  # it has its shape again

    def test_bench_contact_prints_its_stages(self):
        text = self.good("bench", "contact", "press-ball", "--threads", "1", "--pixels", "64", "-o", "out")
        spread = r"\d+\.\d+ / \d+\.\d+ / \d+\.\d+"
        self.assertRegex(text, rf"(?m)^cpu +64 +1 +[1-9]\d* +0\.0 +{spread} +- +\d")
        self.assertRegex(text, rf"(?m)^gpu +64 +1 +[1-9]\d* +0\.0 +{spread} +\d+\.\d\d +- ")  # over cpu
        self.assertRegex(text, r"(?m)^method .* skins +regions +faces +upload +passes +gather +readback "
                               r"+gaps +groups +forces +tangent *$")
        self.assertRegex(text, r"(?m)^cpu +64 +1( +\d+\.\d\d){11} *$")
        for pixels in "wanted", "256":  # prices
            self.assertRegex(text, rf"(?m)^press-ball +{pixels} ")
        written = json.loads((self.folder / "out/bench-contact.json").read_text())
        cpu, gpu = written["scenes"][0]["rows"]
        self.assertEqual((cpu["method"], gpu["method"]), ("cpu", "gpu"))
        self.assertRegex(cpu["device"], r"^.+, (baseline|avx2|avx512)$")
        self.assertIn("4.", gpu["device"])
        for row in cpu, gpu:
            self.assertIn(f"\n  {row['method']}: {row['device']}", text)
        self.assertIn("nothing to see in an image", self.refused("bench", "contact", "falling-ball"))

    def test_bench_contact_gives_each_stage_its_spread(self):
        text = self.good("bench", "contact", "press-ball", "--method", "exact", "--threads", "1", "--all",
                         "--pixels", "64")
        self.assertRegex(text, r"(?m)^exact +64 +1( +\d+\.\d+ / \d+\.\d+ / \d+\.\d+){11} *$")

    def test_bench_contact_without_a_gpu_says_so(self):
        done = self.call("bench", "contact", "press-ball", "--threads", "1", "--pixels", "64",
                         __EGL_VENDOR_LIBRARY_FILENAMES="/nowhere")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"(?m)^gpu is left out: .*install ")
        self.assertNotRegex(done.stdout, r"(?m)^gpu +64 ")

    def test_bench_contact_checks_its_bars(self):
        scene = (PROGRAM.parent / "../share/palpate/scenes/press-ball.toml").read_text()
        scene = scene.split("\n[compare]")[0]
        # in one linear solve 300 nodes are stepped faster than 256 pixels along an edge are looked at
        quick = scene.replace('name = "cvode-bdf"\nrtol = 1e-3',
                              'name = "linearly-implicit-euler"\nstep_s = 0.01')
        self.assertNotEqual(quick, scene)
        (self.folder / "quick.toml").write_text(quick)
        done = self.call("bench", "contact", "quick.toml", "--method", "cpu", "--threads", "1", "--check")
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertEqual(done.stderr, "")
        self.assertRegex(done.stdout, r"(?m)^press-ball +query / step +\S+ +<= 1 +missed *$")
        bars = re.findall(r"(?m)^press-ball .* (?:<=|>=) \S+ +(met|missed) *$", done.stdout)
        self.assertTrue(done.stdout.endswith(f"\n{bars.count('met')} of {len(bars)} bars met\n"), done.stdout)
        # before they touch there is little to look at: in one try of several, however busy the machine is
        (self.folder / "apart.toml").write_text(scene.replace("duration_s = 0.4", "duration_s = 0.05"))
        for _ in range(10):
            done = self.call("bench", "contact", "apart.toml", "--method", "cpu", "--threads", "1", "--check")
            met = 1 if done.returncode == 0 else 0
            self.assertTrue(done.stdout.endswith(f"\n{met} of 1 bars met\n"), done.stdout + done.stderr)
            if met:
                break
        self.assertEqual(done.returncode, 0, done.stdout)

    def test_a_run_is_replayed_and_compared(self):
        text = self.good("run", "press-ball", "--duration-s", "0.2", "--realtime", "--passivity", "observe",
                         "-o", "first")
        self.assertIn("clock.csv", os.listdir(self.folder / "first"))
        parts = re.search(r"an exchange takes (\S+) ms in the mean: query (\S+), linearisation (\S+), "
                          r"step of the bodies (\S+)\n", text)
        whole, *shares = map(float, parts.groups())
        self.assertGreater(whole, 0.0)
        self.assertAlmostEqual(whole, sum(shares), delta=0.25)
        text = self.good("replay", "first")
        self.assertEqual(text, "200 ticks compared, 0.001 to 0.2 s: identical to the last bit\n")
        text = self.good("replay", "first", "--set", "exchange.latency_ticks=10", "-o", "late")
        self.assertRegex(text, r"(?m)^force: differs by \S+ N RMS")
        self.assertIn("force: differs by", self.good("diff", "first", "late"))
        self.assertIn("identical to the last bit", self.good("diff", "late", "late"))
        done = self.call("diff", "first", "nowhere")
        self.assertEqual(done.returncode, 1)
        self.assertIn("nowhere/haptic.h5: no such file", done.stderr)
        error = self.refused("replay", "first", "--set", "scene.duration_s=0.001")
        self.assertRegex(error, r"^palpate: error: \S*first/scene\.toml:\d+:\d+: ")

    def test_a_hand_is_held_again_by_its_record(self):
        self.good("run", "press-ball", "--duration-s", "0.2", "-o", "first")
        self.good("run", "press-ball", "--duration-s", "0.2", "-o", "again", "--set",
                  f'device={{type="recording",file="{self.folder}/first/haptic.h5"}}')
        self.assertIn("200 ticks compared, 0.001 to 0.2 s: identical to the last bit",
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
        packets = re.search(r"within 0\.3 s \((\d+) packets came that are no poses of this scene: "
                            r"(\d+) malformed",
                            error)
        self.assertGreater(int(packets[1]), 3)
        self.assertEqual(packets[1], packets[2])

    def test_semi_implicit_beyond_its_limit_is_warned_of(self):
        run = ["run", "press-ball", "--duration-s", "0.02", "-o", "out", "--set",
               "tool.integrator=semi-implicit-euler", "--set"]
        # 4 m/h^2 - 2 b/h with 0.08 kg, 5 N s/m and ticks of 1 ms
        done = self.call(*run, "tool.coupling.stiffness_n_m=3.2e5")
        self.assertRegex(done.stderr, r"stiffness_n_m of 320000 N/m is not below 310000 N/m")
        done = self.call(*run, "tool.coupling.stiffness_n_m=3e5")
        self.assertNotIn("diverges", done.stderr)
        done = self.call(*run, "tool.coupling.rotational_stiffness_n_m_rad=1e4")
        self.assertRegex(done.stderr, r"rotational_stiffness_n_m_rad of 10000 N m/rad is not below")

    def test_each_of_two_hands_is_replayed_and_compared(self):
        text = self.good("run", "two-hands", "--duration-s", "0.2", "--against-monolithic", "-o", "first",
                         "--set", "compare.haptic.reference_rtol=1e-4",
                         "--set", "compare.haptic.reference_refresh_s=4e-3")
        off = re.findall(r"(?m)^against .*?: (hand left: )?force off by \S+ N RMS \((\S+) % of the peak",
                         text)
        self.assertEqual([whose for whose, _ in off], ["", "hand left: "], text)
        for _, share in off:
            self.assertLess(float(share), 10.0, text)
        figures = json.loads((self.folder / "first/summary.json").read_text())["figures"]
        self.assertGreater(figures["hand left against monolithic"]["peak_force_n"], 1.0)
        same = "200 ticks compared, 0.001 to 0.2 s: identical to the last bit\n"
        self.assertEqual(self.good("replay", "first"), f"tool:\n{same}left:\n{same}")
        text = self.good("replay", "first", "--set", "exchange.exchange_period_s=0.005", "-o", "other")
        self.assertRegex(text, r"(?m)^tool:\n(.*\n)*force: differs(.*\n)*left:\n(.*\n)*force: differs")
        self.assertIn("\nleft:\n", self.good("diff", "first", "other"))
        # what an earlier run left there is not taken for this one's, and what a person put there stays
        (self.folder / "other/force-measured.csv").write_text("1,2\n")
        self.good("run", "press-ball", "--duration-s", "0.1", "-o", "other")
        self.assertIn("left: there is none in other", self.good("diff", "first", "other"))
        self.assertIn("left: there is none in other", self.good("diff", "other", "first"))
        self.assertEqual((self.folder / "other/force-measured.csv").read_text(), "1,2\n")

    def test_without_a_tool_nothing_is_replayed(self):
        self.good("run", "falling-ball", "--duration-s", "0.05", "-o", "fallen")
        done = self.call("replay", "fallen")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the scene of fallen has no [tool]", done.stderr)

    HAPTIC = ["--set", "compare.haptic.exchange_periods_s=[0.02, 0.01]",
              "--set", "compare.haptic.ticks_s=[0.002, 0.001]", "--set", "compare.haptic.integrators=[]",
              "--set", "compare.haptic.reference_rtol=1e-5",
              "--set", "compare.haptic.reference_refresh_s=2e-3"]

    def test_what_a_hand_feels_is_compared_with_one_system(self):
        arguments = ["compare", "--haptic", "press-ball", "--duration-s", "0.08", "--repeats", "1",
                     *self.HAPTIC, "-o", "felt"]
        text = self.good(*arguments)
        self.assertRegex(text, r"(?m)^press-ball: reference tool and bodies as one system by cvode-bdf")
        self.assertRegex(text, r"(?m)^observed order by exchange alone: force ")
        for variable in ("exchange period", "exchange alone", "tick", "integrator", "linearisation"):
            self.assertRegex(text, rf"(?m)^{variable} ")
        names = {path.name for path in (self.folder / "felt").iterdir()}
        self.assertEqual({"haptic.csv", "summary.json", "report.html", "study.sqlite"}, names)
        figures = json.loads((self.folder / "felt/summary.json").read_text())["figures"]
        self.assertGreater(figures["monolithic reference"]["peak_force_n"], 0.1)
        self.assertLess(figures["the scene's own settings"]["force_error_rms_of_peak"], 0.2)
        self.assertIn("Force on the hand against one system", (self.folder / "felt/report.html").read_text())
        self.assertIn("were done before", self.good(*arguments))
        self.assertIn("there is no [tool]", self.refused("compare", "--haptic", "cantilever"))
        self.assertIn("takes one SCENE", self.refused("compare", "--haptic", "press-ball", "twist-ball"))
        self.assertIn("--all", self.refused("compare", "--haptic", "press-ball", "--all"))

    def test_a_run_says_how_far_it_was_from_one_system(self):
        run = ["run", "press-ball", "--duration-s", "0.1", "--against-monolithic", *self.HAPTIC, "-o", "held"]
        text = self.good(*run)
        self.assertRegex(text,
                         r"(?m)^against .*: force off by \S+ N RMS \(\S+ % of the peak of \S+\), at most ")
        self.assertNotIn("as it was recorded", text)
        kept = json.loads((self.folder / "held/summary.json").read_text())["figures"]["against monolithic"]
        self.assertLess(kept["force_error_rms_of_peak"], 0.2)
        self.assertIn("under the hand as it was recorded", self.good(*run, "--realtime"))
        self.assertIn("there is no [tool]", self.refused("run", "one-tet", "--against-monolithic"))

    def test_a_scene_is_judged_as_a_haptic_loop(self):
        text = self.good("stability", "--haptic", "press-ball", "-o", "wall")
        self.assertRegex(text, r"the passive walls are within the stable ones; "
                               r"simulation and theory differ by at most \S+ %")
        self.assertIn("z_width.csv", os.listdir(self.folder / "wall"))
        self.assertIn("about the tool's axis of least inertia", text)
        self.assertNotIn("UNSTABLE", text)
        # 4 I/h^2 of the ball of 80 g and 20 mm is 51 N m/rad
        done = self.call("stability", "--haptic", "press-ball", "-o", "turned", "--set",
                         "tool.integrator=semi-implicit-euler", "--set",
                         "tool.coupling.rotational_stiffness_n_m_rad=1e3")
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertRegex(done.stdout, r"the loop of this scene is UNSTABLE: tool in the air \(rotation\)")
        self.assertNotRegex(done.stdout, r"UNSTABLE.*\(translation\)")
        self.assertIn("SCENE requires --haptic", self.refused("stability", "press-ball"))
        self.assertIn("--rows", self.refused("stability", "--rows", "slivers"))

    def test_keys_are_listed_with_unit_range_default_and_meaning(self):
        text = self.good("list", "keys")
        tables = re.findall(r"(?m)^\[([a-z.]+)\]$", text)
        self.assertEqual(len(tables), len(set(tables)))
        for table in ("scene", "body", "body.mesh", "obstacle", "contact", "tool.coupling", "device",
                      "exchange", "integrator", "record", "compare.ladder"):
            self.assertIn(table, tables)
        self.assertRegex(text, r"(?m)^spectral_radius +number +\[0, 1\] +0\.8 +.* generalized-alpha$")
        self.assertRegex(text, r"(?m)^youngs_modulus_pa +number +Pa +> 0 +required +Young's modulus$")

    def test_another_method_says_what_it_leaves_out(self):
        done = self.call("run", "one-tet", "--integrator", "rk4", "--duration-s", "0.001")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("palpate: integrator.rtol of the scene is left out: what --integrator or --set names "
                      "has no use for it\n", done.stderr)
        self.assertEqual(self.call("run", "one-tet", "--duration-s", "0.001").stderr, "")

    def test_keys_of_another_method_are_refused(self):
        text = self.refused("run", "one-tet", "--integrator", "rk4",
                            "--set", "integrator.spectral_radius=0.5")
        self.assertIn("spectral_radius means nothing to integrator \"rk4\", which takes step_s, max_steps, "
                      "threads; remove it (used by generalized-alpha)", text)
        self.assertIn("method = \"vertex\" is no method; obstacles and spheres",
                      self.refused("inspect", "press-ball", "--set", "contact.1.method=vertex"))

    def test_inspect_says_what_is_left_out(self):
        text = self.good("inspect", "falling-ball")
        self.assertRegex(text, r"(?m)^tool +left out")
        self.assertRegex(text, r"(?m)^gl +left out")
        self.assertRegex(text, r"(?m)^unknowns \(velocities\) +\d+")
        self.assertRegex(self.good("inspect", "press-ball"), r"(?m)^tool +in use")

    def test_validate(self):
        self.assertIn("--slow excludes --quick", self.refused("validate", "--quick", "--slow"))
        text = self.good("validate", "rigid-motion", "-o", "val")
        self.assertRegex(text, r"(?m)^rigid-motion +C +any rotation and translation: no force, no energy")
        self.assertRegex(text, r"(?m)^rigid-motion .* pass$")
        cases = json.loads((self.folder / "val/validation.json").read_text())["cases"]
        self.assertEqual([case["name"] for case in cases], ["rigid-motion"])
        self.assertTrue(all(m["passed"] for m in cases[0]["measurements"]))
        for option in ("--inject-faults", "--sabotage"):  # the second is an old name, not in the help
            self.assertIn("fails, as it must", self.good("validate", "rigid-motion", option))
        self.assertNotIn("sabotage", self.good("validate", "--help"))

    def test_validate_side_by_side(self):
        cases = ["patch-test", "rigid-motion", "vertex-list"]
        rows = [self.good("validate", *cases, "--jobs", jobs) for jobs in ("1", "3")]
        self.assertEqual(rows[0], rows[1])
        self.assertIn("3 of 3 cases keep their bars", rows[0])
        passed = re.findall(r"(?m)^([a-z-]+) .* pass$", rows[0])  # as they were named, whichever ended first
        self.assertEqual(list(dict.fromkeys(passed)), cases)


NO_EGL = {"__EGL_VENDOR_LIBRARY_FILENAMES": "/nowhere.json"}  # libglvnd then finds no driver
NO_GNUPLOT = {"PATH": "/nowhere"}


class Incomplete(Cli):
    """A command that cannot deliver all that it promises says so in its last line, and ends with 3."""

    def incomplete(self, *arguments, **environment):
        done = self.call(*arguments, **environment)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        last = done.stderr.splitlines()[-1]
        self.assertTrue(last.startswith("palpate: incomplete: there is no "), done.stderr)
        return last

    QUICK = ["--duration-s", "0.02", "--repeats", "1", "--integrator", "linearly-implicit-euler",
             "--set", "compare.exchange_periods_s=[0.01]", "--set", "compare.reference_rtol=1e-4",
             "--set", "compare.reference_check_rtol=1e-4"]

    def test_picture_that_cannot_be_drawn(self):
        run = ["run", "one-tet", "--duration-s", "0.02", "--picture", "--report", "-o", "here"]
        self.good(*run)
        last = self.incomplete(*run, **NO_EGL)
        self.assertIn("picture here/picture.png (", last)
        self.assertFalse((self.folder / "here/picture.png").exists(), "that of an earlier run")
        self.assertTrue((self.folder / "here/report.html").exists(), "all else is there")
        last = self.incomplete("modes", "cantilever", "--count", "3", "--picture", **NO_EGL)
        self.assertIn("picture out/modes-cantilever/modes.png (", last)

    def test_frames_and_contact_pictures_that_cannot_be_drawn(self):
        run = ["run", "press-ball", "--duration-s", "0.02", "--frames", "-o", "here"]
        self.assertIn("frame here/frames/0000.png and those behind it (", self.incomplete(*run, **NO_EGL))
        (self.folder / "full").mkdir()
        (self.folder / "full/frames").write_text("a file where the folder would be")
        self.assertIn("full/frames", self.incomplete(*run[:-1], "full"))
        last = self.incomplete("run", "falling-ball", "--duration-s", "0.01", "--contact-picture",
                               "-o", "air")
        self.assertIn("picture air/contact.png (nothing touched in this run)", last)

    def test_figures_that_cannot_be_drawn(self):
        last = self.incomplete("run", "press-ball", "--duration-s", "0.02", "--report", "-o", "here",
                               **NO_GNUPLOT)
        self.assertIn("gnuplot was not found", last)
        self.assertIn("here/report.html", last)
        last = self.incomplete("compare", "cantilever", *Results.QUICK, "-o", "cmp",
                               "--integrator", "linearly-implicit-euler", **NO_GNUPLOT)
        self.assertIn("figures in cmp/report.html (gnuplot was not found", last)

    def test_chart_that_cannot_be_made_and_is_made_again_where_it_can(self):
        compare = ["compare", "press-ball", *self.QUICK, "-o", "cmp"]
        last = self.incomplete(*compare, **NO_EGL)
        self.assertIn('chart of the contact method "gpu" of press-ball (', last)
        text = self.good(*compare)
        self.assertIn("contact found by", text)
        self.assertRegex(text, r"(?m)^gpu ")

    def test_reference_that_cannot_be_checked(self):
        last = self.incomplete("compare", "cantilever", *Results.QUICK, "--reference-limit-s", "0.001",
                               "--integrator", "linearly-implicit-euler")
        self.assertIn("checked reference of cantilever", last)


class LeftOut(Cli):
    """What a scene does not name is not there: by the loader's own account, and by the counters."""

    def loaded(self, *arguments):
        done = self.call(*arguments, LD_DEBUG="files")
        self.assertEqual(done.returncode, 0)
        return set(re.findall(r"calling init: \S*/(lib[^/\s]+)", done.stderr))

    def test_scenes_without_contact_images_load_no_graphics(self):
        for scene in ("falling-ball", "cantilever"):
            with self.subTest(scene=scene):
                names = self.loaded("run", scene, "--duration-s", "0.01", "-o", scene)
                self.assertTrue(any(name.startswith("libpalpate_core") for name in names),
                                "LD_DEBUG did not work")
                graphics = r"lib(EGL|GL|GLX|GLdispatch|OpenGL|gallium|LLVM)[._-]"
                self.assertFalse([name for name in names if re.match(graphics, name)])
                summary = json.loads((self.folder / scene / "summary.json").read_text())
                made = summary["figures"]["constructions"]
                left_out = ("gl.", "tool.", "render.", "proxy.")
                self.assertFalse([name for name in made if name.startswith(left_out)], made)

    def test_the_same_look_finds_graphics_where_a_picture_is_asked_for(self):
        names = self.loaded("run", "one-tet", "--duration-s", "0.01", "--picture", "-o", "pic")
        self.assertTrue([name for name in names if name.startswith("libEGL")], names)
        self.assertTrue((self.folder / "pic/picture.png").read_bytes().startswith(b"\x89PNG"))


def recorded_steps(path):
    """Steps in a run file that is still being written; its size says nothing, for room is made beforehand."""
    try:
        with h5py.File(path, "r", locking=False) as file:
            return int(file["VTKHDF/Steps"].attrs["NSteps"])
    except (OSError, KeyError):
        return 0


class Interrupt(Cli):
    def wait_for(self, condition, process):
        end = time.monotonic() + 120
        while not condition():
            self.assertIsNone(process.poll(), "it ended by itself")
            self.assertLess(time.monotonic(), end, "nothing happened")
            time.sleep(0.05)

    def test_what_was_recorded_is_a_valid_file(self):
        for stop in (signal.SIGINT, signal.SIGTERM):
            with self.subTest(signal=stop):
                process = subprocess.Popen([str(PROGRAM), *LONG, "-o", f"cut-{stop}"], cwd=self.folder,
                                           text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
                path = self.folder / f"cut-{stop}/run.vtkhdf"
                self.wait_for(lambda: recorded_steps(path) > 2, process)
                process.send_signal(stop)
                out, err = process.communicate(timeout=120)
                self.assertEqual(process.returncode, 130, err)
                self.assertIn("stopped at t = ", err)
                self.assertNotIn("\r", err)  # no terminal, no progress bar
                with h5py.File(path) as file:
                    count = file["VTKHDF/Steps"].attrs["NSteps"]
                    self.assertGreater(count, 1)
                    self.assertGreaterEqual(len(file["VTKHDF/Points"]), 4 * count)
                    times = file["VTKHDF/Steps/Values"][:count]
                    self.assertTrue(all(b > a for a, b in zip(times, times[1:])))
                shown = xml.dom.minidom.parse(str(path.parent / "run.xdmf")).getElementsByTagName("Time")
                self.assertEqual([float(one.getAttribute("Value")) for one in shown], list(times))
                summary = json.loads((path.parent / "summary.json").read_text())
                self.assertEqual(summary["outcome"], "interrupted")

    def test_frames_of_a_run_that_was_ended_are_drawn(self):
        process = subprocess.Popen([str(PROGRAM), "run", "press-ball", "--frames", "-o", "cut", "--set",
                                    "integrator.rtol=1e-9"], cwd=self.folder, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.wait_for(lambda: recorded_steps(self.folder / "cut/run.vtkhdf") > 3, process)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, err)
        count = int(re.search(r"(\d+) of \1 frames in cut/frames", out).group(1))
        frames = sorted((self.folder / "cut/frames").iterdir())
        self.assertEqual([path.name for path in frames], [f"{i:04}.png" for i in range(count)])
        self.assertGreater(count, 2)
        self.assertLess(count, 40)

    def test_frames_that_were_drawn_by_then_stay(self):
        process = subprocess.Popen([str(PROGRAM), "run", "press-ball", "--frames", "-o", "cut"],
                                   cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        folder = self.folder / "cut/frames"
        self.wait_for(lambda: folder.is_dir() and len(list(folder.glob("*.png"))) > 2, process)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn("those written are complete", err)
        count = int(re.search(r"(\d+) of 40 frames", out).group(1))
        self.assertLess(count, 40)
        names = sorted(path.name for path in folder.iterdir())
        self.assertEqual(names, [f"{i:04}.png" for i in range(count)])

    def test_compare_ends_and_says_how_to_go_on(self):
        process = subprocess.Popen([str(PROGRAM), "compare", "cantilever", "--integrator", "ark-erk-5",
                                    "--integrator", "linearly-implicit-euler", "--limit-s", "300",
                                    "-o", "cut"],
                                   cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.wait_for(lambda: (self.folder / "cut/study.sqlite").exists(), process)
        start = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, err)
        self.assertLess(time.monotonic() - start, 60)  # its points would take minutes
        self.assertIn("goes on from cut", err)

    def test_validate_ends_cases_that_take_minutes(self):
        process = subprocess.Popen([str(PROGRAM), "validate", "vibration-tolerance", "rigid-motion"],
                                   cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(3)
        process.send_signal(signal.SIGINT)
        start = time.monotonic()
        out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, err)
        self.assertLess(time.monotonic() - start, 60)
        self.assertRegex(out, r"(0 of 0|1 of 1) cases keep their bars; stopped before the other [12]\n$")

    def test_progress_bar_on_a_terminal_with_time_left(self):
        terminal, end = open_terminal()
        process = subprocess.Popen([str(PROGRAM), "run", "one-tet", "--duration-s", "2000", "-o", "tty"],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=end,
                                   env=dict(os.environ, TERM="xterm"))
        os.close(end)
        seen = b""
        try:
            deadline = time.monotonic() + 120
            while b" left" not in seen and time.monotonic() < deadline:
                if select.select([terminal], [], [], 1.0)[0]:
                    seen += os.read(terminal, 65536)
        finally:
            process.send_signal(signal.SIGINT)
            process.wait(timeout=120)
            os.close(terminal)
        self.assertRegex(seen.decode(), r"\[#*-*\] +\d+ % +.* left  running one-tet")
        self.assertEqual(process.returncode, 130)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
