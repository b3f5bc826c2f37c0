#!/usr/bin/env python3
"""Failures around a run: each case gives a clear message, and nothing is lost.

    bad_input_test.py PROGRAM [CORPORA]
"""
import os
import random
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

from failing_run import Case
from program import LONG, PROGRAM

CORPORA = Path(__file__).resolve().parents[1] / "fuzz/corpus"
# A separate mount namespace: by root, or by a user if the kernel permits it.
NAMESPACE = ["unshare", "--mount", *([] if os.geteuid() == 0 else ["--user", "--map-root-user"])]


def can_mount():
    """Returns whether a small separate file system can be mounted."""
    if not shutil.which("unshare"):
        return False
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([*NAMESPACE, "mount", "-t", "tmpfs", "-o", "size=64k", "none", folder],
                              capture_output=True, check=False)
    return done.returncode == 0


def on_full_disk(size, then):
    """Runs the program in `full`, a disk of that size, and copies the disk's content to `then` afterwards."""
    script = (f'mount -t tmpfs -o size={size} none full && "$@"; s=$?; '
              f'cp -r --sparse=always full {then}; exit $s')
    return [*NAMESPACE, "sh", "-c", script, "sh"]


@unittest.skipUnless(can_mount(), "no mounts (root, or user namespaces)")
class FullDisk(Case):
    def setUp(self):
        super().setUp()
        (self.folder / "full").mkdir()

    def test_a_run_keeps_what_it_recorded(self):
        self.good("run", "press-ball", "-o", "whole")
        all_times = self.steps("whole")
        counts = []
        for size in ("600k", "1200k", "2400k"):
            with self.subTest(size=size):
                text = self.refused("run", "press-ball", "-o", "full/x", wrapped=on_full_disk(size, size))
                self.assertIn("full/x/", text)
                self.assertIn("No space left on device", text)
                self.assertIn("data written so far are complete", text)
                times = self.steps(f"{size}/x")
                self.assertEqual(times, all_times[:len(times)])
                counts.append(len(times))
                self.assertIn(self.summary(f"{size}/x")["outcome"], ("failed", "unfinished"))
                self.good("report", f"{size}/x", "-o", "page.html")
        self.assertEqual(counts, sorted(counts))
        self.assertGreater(counts[-1], 1)
        self.assertLess(counts[-1], len(all_times))

    def test_no_room_at_all(self):
        for command in (["run", "press-ball"], ["run", "one-tet"], ["modes", "one-tet"],
                        ["validate", "patch-test"]):
            with self.subTest(command=command):
                text = self.refused(*command, "-o", "full/x", wrapped=on_full_disk("4k", "_".join(command)))
                self.assertRegex(text, r"full/x/[\w.]+: ")
                self.assertIn("No space left on device", text)

    def test_an_export_and_a_report_leave_what_is_there(self):
        self.good("run", "press-ball", "--duration-s", "0.05", "-o", "run")
        for command in (["export", "../run", "--to", "vtu", "-o", "x"],
                        ["report", "../run", "-o", "page.html"]):
            with self.subTest(command=command):
                script = ('mount -t tmpfs -o size=8k none full; cd full; echo mine > mine; "$@"; s=$?; '
                          'ls -A . > ../left; cat mine >> ../left; exit $s')
                text = self.refused(*command, wrapped=[*NAMESPACE, "sh", "-c", script, "sh"])
                self.assertIn("No space left on device", text)
                self.assertEqual((self.folder / "left").read_text(), "mine\nmine\n")


class FullQuota(Case):
    """Without root: files may not grow beyond a size, which fails like a full disk."""

    def test_each_size_ends_with_a_sentence(self):
        self.good("run", "press-ball", "-o", "whole")
        all_times = self.steps("whole")
        largest = (self.folder / "whole/run.vtkhdf").stat().st_size

        def limit(size):
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
        for size in (100, 5000, 60000, largest // 2, largest - 1):
            with self.subTest(size=size):
                text = self.refused("run", "press-ball", "-o", f"x{size}", before=lambda: limit(size))
                self.assertIn(f"x{size}/", text)
                self.assertIn("File too large", text)
        self.assertEqual(self.steps("whole"), all_times)


@unittest.skipUnless(can_mount(), "no mounts (root, or user namespaces)")
class ReadOnly(Case):
    def test_it_is_said_before_anything_is_computed(self):
        (self.folder / "there").mkdir()
        self.good("run", "one-tet", "--duration-s", "0.05", "-o", "there/run")
        script = 'mount --bind there there && mount -o remount,bind,ro there && "$@"'
        for command in (["run", "press-ball"], ["compare", "one-tet", "--integrator", "cvode-bdf"],
                        ["replay", "there/run"], ["export", "there/run", "--to", "vtu"]):
            for place in ("there/run", "there/new"):
                if command[0] == "replay":
                    continue  # a scene without a tool has nothing to replay
                with self.subTest(command=command, place=place):
                    done = self.call(*command, "-o", place, wrapped=[*NAMESPACE, "sh", "-c", script, "sh"])
                    self.assertEqual(done.returncode, 1, done.stderr)
                    self.assertIn(f"{place}: this output folder cannot be", done.stderr)
                    self.assertIn("Read-only file system", done.stderr)
                    self.assertIn("-o DIR", done.stderr)
                    self.assertEqual(done.stdout, "")
        self.assertEqual(len(self.steps("there/run")), 6)


class DamagedModel(Case):
    """A model file in which a part is missing or a byte is changed."""

    def setUp(self):
        super().setUp()
        self.whole = (CORPORA / "model_file/everything.h5").read_bytes()
        self.model = self.folder / "m.h5"
        (self.folder / "s.toml").write_text(
            '[scene]\nname = "m"\nduration_s = 0.01\n[[body]]\nname = "m"\nyoungs_modulus_pa = 1e5\n'
            'mesh = { file = "m.h5" }\nskin = true\n')

    def test_truncated(self):
        self.model.write_bytes(self.whole)
        self.good("inspect", "s.toml")
        end = len(self.whole)
        for size in (0, 1, 7, 8, 100, 1000, end // 2, end - 3000, end - 1):
            with self.subTest(size=size):
                self.model.write_bytes(self.whole[:size])
                text = self.refused("inspect", "s.toml")
                self.assertIn("m.h5: ", text)
                self.assertLess(len(text), 500)

    def test_other_bytes(self):
        rng, outcomes = random.Random(7), set()
        for _ in range(60):
            damaged = bytearray(self.whole)
            for _ in range(rng.randint(1, 8)):
                damaged[rng.randrange(len(damaged))] = rng.randrange(256)
            self.model.write_bytes(damaged)
            done = self.call("inspect", "s.toml")
            self.assertIn(done.returncode, (0, 1), done.stderr)
            outcomes.add(done.returncode)
            if done.returncode == 1:
                self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        self.assertEqual(outcomes, {0, 1})

    def test_a_file_that_the_library_does_not_survive(self):
        found = list((CORPORA / "model_file").glob("kills-hdf5-*"))
        self.assertTrue(found)
        for one in found:
            shutil.copy(one, self.model)
            # HDF5 1.10 crashes, and 1.14 reports that it ran off the end of a buffer
            self.assertRegex(self.refused("inspect", "s.toml"), r"m\.h5.*(is damaged|cannot open)")


class Killed(Case):
    def test_the_last_complete_step_is_readable(self):
        self.good("run", "press-ball", "-o", "whole")
        all_times, rng, counts = self.steps("whole"), random.Random(4), set()
        for i in range(6):
            with self.subTest(kill=i):
                process = self.started("run", "press-ball", "-o", f"cut{i}")
                states = self.folder / f"cut{i}/run.vtkhdf"
                self.wait_for(states.exists, process)
                time.sleep(0.1 + 0.6 * rng.random())
                process.kill()
                process.communicate()
                outcome = self.summary(f"cut{i}")["outcome"]
                if process.returncode == 0 or outcome == "finished":  # or already exiting
                    continue
                times = self.steps(f"cut{i}")
                self.assertEqual(times, all_times[:len(times)])
                counts.add(len(times))
                self.assertEqual(outcome, "unfinished")
                page = self.good("report", f"cut{i}")
                self.assertIn("report.html", page)
                self.assertIn("unfinished", (self.folder / f"cut{i}/report.html").read_text())
                # haptic.h5 may have been truncated: read or rejected
                self.assertIn(self.call("replay", f"cut{i}").returncode, (0, 1))
                # ticks that were written are complete lines
                self.good("export", f"cut{i}", "--to", "csv")
                # its folder is free again
                self.good("run", "press-ball", "--duration-s", "0.01", "-o", f"cut{i}")
                self.assertEqual(self.summary(f"cut{i}")["outcome"], "finished")
        self.assertGreater(max(counts), 1)


class TwoRuns(Case):
    def test_the_second_is_refused_and_the_first_goes_on(self):
        first = self.started(*LONG, "-o", "same")
        states = self.folder / "same/run.vtkhdf"
        self.wait_for(lambda: states.exists() and states.stat().st_size > 0, first)
        for command in (["run", "press-ball"], ["compare", "one-tet", "--integrator", "cvode-bdf"],
                        ["modes", "one-tet"]):
            text = self.refused(*command, "-o", "same")
            self.assertIn(f"same: process {first.pid} ({PROGRAM} run one-tet", text)
            self.assertIn("-o DIR", text)
        text = self.refused("export", "same", "--to", "csv", "-o", "steps")
        self.assertIn("is being written by another process", text)
        blocks = states.stat().st_blocks  # its size includes room for all steps from the start
        self.wait_for(lambda: states.stat().st_blocks > blocks, first)
        first.send_signal(signal.SIGINT)
        self.assertEqual(first.wait(timeout=60), 130)
        self.assertEqual(self.summary("same")["outcome"], "interrupted")
        self.assertGreater(len(self.steps("same")), 1)
        self.good("run", "one-tet", "--duration-s", "0.01", "-o", "same")


class EarlierRun(Case):
    def test_its_files_do_not_pass_for_those_of_the_next(self):
        self.good("run", "press-ball", "--duration-s", "0.02", "--trace", "--report", "-o", "here")
        names = {path.name for path in (self.folder / "here").iterdir()}
        self.assertLessEqual({"force.csv", "haptic.h5", "trace.csv", "report.html"}, names)
        (self.folder / "here/notes.txt").write_text("mine")
        (self.folder / "here/compare.csv").write_text("of a comparison\n")
        text = self.good("run", "one-tet", "--duration-s", "0.02", "-o", "here")
        listed = re.search(r"^in here: (.*)$", text, re.M).group(1).split(", ")
        self.assertEqual(listed, ["run.vtkhdf", "run.xdmf", "scene.toml", "summary.json"])
        self.assertEqual({path.name for path in (self.folder / "here").iterdir()},
                         {*listed, "notes.txt", "compare.csv"})
        self.assertEqual((self.folder / "here/notes.txt").read_text(), "mine")

    def test_a_run_does_not_write_over_what_it_reads(self):
        scene = self.folder / "scene.toml"
        self.good("run", "one-tet", "--duration-s", "0.02", "-o", "one")
        shutil.copy(self.folder / "one/scene.toml", scene)
        before = scene.read_bytes()
        self.assertIn("is the scene of this run", self.refused("run", "scene.toml", "-o", "."))
        self.assertEqual(scene.read_bytes(), before)
        self.good("run", "press-ball", "--duration-s", "0.02", "-o", "press")
        force = (self.folder / "press/force.csv").read_bytes()
        again = (self.folder / "press/scene.toml").read_text().replace(
            'type = "script"', 'type = "recording"\nfile = "force.csv"')
        again = re.sub(r"^\[\[device\.[^\n]*\n(?:(?!\[)[^\n]*\n)*", "", again, flags=re.M)
        (self.folder / "press/again.toml").write_text(again)
        text = self.refused("run", "press/again.toml", "-o", "press")
        self.assertIn("is the recording that the hand replays", text)
        self.assertEqual((self.folder / "press/force.csv").read_bytes(), force)
        self.assertIn("would overwrite the run", self.refused("replay", "press", "--integrator",
                                                          "linearly-implicit-euler", "-o", "press"))


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
