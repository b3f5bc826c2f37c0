#!/usr/bin/env python3
"""The program's user interface: help, messages, exit statuses, Ctrl-C.

    cli_test.py PROGRAM [unittest's names of tests]
"""
import contextlib
import fcntl
import json
import os
import re
import resource
import select
import signal
import struct
import subprocess
import sys
import termios
import time
import unittest
import xml.dom.minidom

try:
    import h5py
except ImportError:  # package python3-h5py
    sys.exit("python3-h5py is missing")

from program import LONG, NO_EGL, PROGRAM, PROGRESS, QUICK_COMPARISON, TREE, Cli, open_terminal

COMMANDS = ["demo", "run", "compare", "study", "modes", "validate", "report", "inspect", "export", "list",
            "help", "bench"]


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

    def test_unknown_options_are_named_with_the_nearest_one(self):
        self.assertEqual(self.refused("run", "press-ball", "--sett", "x=1"),
                         'palpate: error: there is no option --sett (did you mean "--set"?); '
                         'see `palpate run --help`\n')
        self.assertIn("there is no option --xyzzy; see", self.refused("run", "press-ball", "--xyzzy=3"))
        self.assertIn('"one-tet" is one argument too many; see `palpate run --help`',
                      self.refused("run", "press-ball", "one-tet"))

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
                # An unknown option is rejected before --help is processed; the command is not run.
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
            with contextlib.suppress(OSError):  # end of a pseudo-terminal
                while part := os.read(leader, 65536):
                    text += part
            child.wait()
            os.close(leader)
            widest = max(len(line.rstrip("\r")) for line in text.decode().split("\n"))
            self.assertTrue(columns - 15 < widest <= columns, f"{widest} of {columns}")

    def test_help_of_a_command_is_its_own(self):
        self.assertEqual(self.good("help", "inspect"), self.good("inspect", "--help"))
        self.assertIn("matrix", self.good("help", "stability"))  # a page as well: the page is shown

    def test_the_beginning_of_a_topic_or_its_singular_is_enough(self):
        self.assertEqual(self.good("help", "device"), self.good("help", "devices"))
        self.assertEqual(self.good("help", "scene"), self.good("help", "scenes"))
        self.assertEqual(self.good("help", "insp"), self.good("inspect", "--help"))
        self.assertIn("is the beginning of", self.refused("help", "st"))

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
        self.assertIn("needs the wall clock", self.refused("run", "one-tet", "--duration-s", "inf"))
        for value in "nan", "0":
            said = self.refused("run", "one-tet", "--duration-s", value)
            self.assertIn("a positive number of seconds", said)
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


class Incomplete(Cli):
    """A command that cannot deliver all its outputs reports this in its last line, and ends with status 3."""

    def incomplete(self, *arguments, **environment):
        done = self.call(*arguments, **environment)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        last = done.stderr.splitlines()[-1]
        self.assertTrue(last.startswith("palpate: incomplete: missing "), done.stderr)
        return last

    QUICK = ["--limit-s", "1", "--duration-s", "0.02", "--repeats", "1",
             "--integrator", "linearly-implicit-euler", "--set", "compare.exchange_periods_s=[0.01]",
             "--set", "compare.reference_rtol=1e-4", "--set", "compare.reference_check_rtol=1e-4"]

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
        self.assertIn("frame here/frames/0000.png and all later frames (", self.incomplete(*run, **NO_EGL))
        (self.folder / "full").mkdir()
        (self.folder / "full/frames").write_text("a file where the folder would be")
        self.assertIn("full/frames", self.incomplete(*run[:-1], "full"))
        last = self.incomplete("run", "falling-ball", "--duration-s", "0.01", "--contact-picture",
                               "-o", "air")
        self.assertIn("picture air/contact.png (no contact occurred in this run)", last)

    def test_a_report_needs_no_other_program(self):
        self.good("run", "press-ball", "--duration-s", "0.02", "--report", "-o", "here", PATH="/nowhere")
        self.assertIn('class="plot-data"', (self.folder / "here/report.html").read_text())

    def test_chart_that_cannot_be_made_and_is_made_again_where_it_can(self):
        compare = ["compare", "press-ball", *self.QUICK, "-o", "cmp"]
        last = self.incomplete(*compare, **NO_EGL)
        self.assertIn('chart of the contact method "image" of press-ball (', last)
        text = self.good(*compare)
        self.assertIn("contact method", text)
        self.assertRegex(text, r"(?m)^image ")

    def test_reference_that_cannot_be_checked(self):
        last = self.incomplete("compare", "cantilever", *QUICK_COMPARISON, "--reference-limit-s", "0.001",
                               "--integrator", "linearly-implicit-euler")
        self.assertIn("checked reference of cantilever", last)


class LeftOut(Cli):
    """Parts that a scene does not specify are absent, according to the loader and to the counters."""

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
                made = [one["name"] for one in summary["figures"]["constructions"]]
                self.assertTrue(made)
                left_out = ("gl.", "tool.", "render.", "proxy.")
                self.assertFalse([name for name in made if name.startswith(left_out)], made)

    def test_the_same_look_finds_graphics_where_a_picture_is_asked_for(self):
        names = self.loaded("run", "one-tet", "--duration-s", "0.01", "--picture", "-o", "pic")
        self.assertTrue([name for name in names if name.startswith("libEGL")], names)
        self.assertTrue((self.folder / "pic/picture.png").read_bytes().startswith(b"\x89PNG"))


def recorded_steps(path):
    """Returns the number of steps in a run file that is still being written; its size is not significant,
    because space is allocated beforehand."""
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
        self.wait_for(lambda: (self.folder / "cut/results.db").exists(), process)
        start = time.monotonic()
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, err)
        self.assertLess(time.monotonic() - start, 60)  # its points would take minutes
        self.assertIn("resumes from cut", err)

    def test_validate_ends_cases_that_take_minutes(self):
        process = subprocess.Popen([str(PROGRAM), "validate", "vibration-tolerance", "rigid-motion", "-o",
                                    "cut"],
                                   cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(3)
        process.send_signal(signal.SIGINT)
        start = time.monotonic()
        out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, err)
        self.assertLess(time.monotonic() - start, 60)
        self.assertRegex(out, r"(0 of 0|1 of 1) cases meet their acceptance limits; "
                              r"stopped before the other [12]\n$")
        self.assertEqual(PROGRESS.sub("", err), "palpate: stopped; the same command resumes from cut\n")

    def test_a_pipe_gets_a_line_of_progress_every_ten_seconds(self):
        process = subprocess.Popen([str(PROGRAM), "run", "one-tet", "--duration-s", "2000", "-o", "piped"],
                                   cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                   text=True)
        start = time.monotonic()
        try:
            line = process.stderr.readline()
            taken = time.monotonic() - start
        finally:
            process.send_signal(signal.SIGINT)
            process.communicate(timeout=120)
        self.assertRegex(line, PROGRESS)
        self.assertIn("running one-tet", line)
        self.assertGreater(taken, 9)

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
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=2)
