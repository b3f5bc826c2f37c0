#!/usr/bin/env python3
"""Runs that are killed and resumed from their last checkpoint: all their files are bitwise equal to those of
an uninterrupted run.

    resume_test.py PROGRAM
"""
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

try:
    import h5py
    import numpy
except ImportError:  # package python3-h5py
    sys.exit("python3-h5py is missing")

PROGRAM = Path(sys.argv[1]).resolve()

TOUCHING = ["--duration-s", "0.2"]
# name: scene, simulated time between checkpoints, options
RUNS = {
    "body alone, adaptive": ("cantilever", 0.05, []),
    "body alone, implicit steps": ("cantilever", 0.05, [
        "--integrator", "implicit-midpoint", "--set", "integrator.step_s=0.002"]),
    "body alone, several steps back": ("cantilever", 0.05, [
        "--integrator", "bdf2", "--set", "integrator.step_s=0.002"]),
    "contact with friction, linearly implicit": ("falling-ball", 0.05, [
        "--integrator", "linearly-implicit-euler", "--set", "integrator.step_s=0.002",
        "--set", "contact.0.friction=0.4", "--set", "record.energy=true"]),
    # in contact from 0.06 s on
    "tool in exchange, points": ("press-ball", 0.05, [*TOUCHING, "--set", "exchange.latency_ticks=3"]),
    "tool in exchange, condensed": ("press-ball", 0.05, [
        *TOUCHING, "--set", "exchange.linearisation=condensed"]),
    "tool and body as one system": ("press-ball", 0.05, [*TOUCHING, "--set", "exchange.scheme=monolithic"]),
    "contact in images": ("press-ball", 0.05, [*TOUCHING, "--set", "contact.1.method=image"]),
    "contact by nearest points": ("press-ball", 0.05, [
        *TOUCHING, "--set", "contact.0.method=distance", "--set", "contact.1.method=distance"]),
    "simulated hand, passivity": ("press-ball", 0.05, [
        *TOUCHING, "--set", "device.type=hand", "--set", "device.encoder_resolution_m=1e-5",
        "--set", "device.delay_s=0.002", "--passivity", "control"]),
    "two bodies, tool, friction, energy": ("press-stack", 0.05, [
        *TOUCHING, "--integrator", "linearly-implicit-euler", "--set", "integrator.step_s=0.002"]),
    "bones": ("swung-limb", 0.1, []),
    "a grasp": ("lift-ball", 0.3, ["--duration-s", "1.2"]),
    "two hands": ("two-hands", 0.2, ["--duration-s", "0.8"]),
}
CLOCKS = ("_s", "peak_memory_mib", "started_utc")


def data_sets(path):
    out = {}
    with h5py.File(path, "r") as file:
        def take(name, item):
            if isinstance(item, h5py.Dataset):
                out[name] = (item.shape, item[()].tobytes() if item.shape else str(item[()]))
            for key, value in item.attrs.items():
                out[f"{name}@{key}"] = str(value)
        file.visititems(take)
    return out


def figures(path):
    """Returns the content of summary.json, except for clocks and sizes of the process."""
    out = {}

    def walk(value, at):
        if isinstance(value, dict):
            for key, inner in value.items():
                walk(inner, f"{at}/{key}")
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            for row in value:
                walk(row, f"{at}/{next(iter(row.values()))}")
        elif at.startswith("/figures/constructions/gl."):
            pass  # every process that makes a query opens OpenGL
        elif not at.endswith(CLOCKS) or at.endswith(("simulated_s", "every_s", "period_s", "step_s")):
            out[at] = value
    walk(json.loads(path.read_text()), "")
    return out


class Resume(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-resume-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def call(self, *arguments, where=None):
        return subprocess.run([str(PROGRAM), *map(str, arguments)], capture_output=True, text=True,
                              cwd=where or self.folder, timeout=300, stdin=subprocess.DEVNULL)

    def good(self, *arguments, where=None):
        done = self.call(*arguments, where=where)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *arguments):
        done = self.call(*arguments)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def kill(self, command, checkpoints, where, later_s=0.0, sign=signal.SIGKILL):
        """Starts a command that works in where/run, and kills it after the given number of checkpoints."""
        process = subprocess.Popen([str(PROGRAM), *map(str, command)], cwd=where, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        checkpoint, seen = where / "run" / "checkpoint.h5", set()
        begun = checkpoint.stat().st_ino if checkpoint.exists() else None
        while len(seen) < checkpoints and process.poll() is None:
            try:
                seen.add(checkpoint.stat().st_ino)
                seen.discard(begun)
            except FileNotFoundError:
                pass
            time.sleep(0.0005)
        time.sleep(later_s)
        process.send_signal(sign)
        out = process.communicate()
        return process.returncode, out

    def run_killed(self, command, checkpoints, later_s=0.0):
        where = Path(tempfile.mkdtemp(dir=self.folder))
        status, out = self.kill(command, checkpoints, where, later_s)
        self.assertEqual(status, -signal.SIGKILL, f"the run was over before it could be killed: {out}")
        self.assertTrue((where / "run" / "checkpoint.h5").exists())
        return where

    def whole(self, command):
        where = Path(tempfile.mkdtemp(dir=self.folder))
        self.said = self.good(*command, where=where)
        return where

    def assert_same(self, one, other):
        names = [sorted(path.name for path in (where / "run").iterdir()) for where in (one, other)]
        self.assertEqual(*names)
        for name in names[0]:
            a, b = one / "run" / name, other / "run" / name
            if name == "summary.json":
                self.assertEqual(figures(a), figures(b))
            elif a.suffix in (".h5", ".vtkhdf"):
                first, second = data_sets(a), data_sets(b)
                self.assertEqual(first.keys(), second.keys(), name)
                for key in first:
                    self.assertTrue(first[key] == second[key], f"{name}: {key} differs")
            else:
                self.assertTrue(a.read_bytes() == b.read_bytes(), f"{name} differs")

    @staticmethod
    def command(name):
        scene, every, options = RUNS[name]
        return ["run", scene, "--checkpoint-every", every, "-o", "run", *options]

    def test_every_kind_of_run_goes_on_as_if_it_had_never_stopped(self):
        for name in RUNS:
            with self.subTest(name):
                command = self.command(name)
                whole = self.whole(command)
                self.assertRegex(self.said, r"checkpoints: [2-9], one per .* s to write them and .* s to r")
                self.assertFalse((whole / "run" / "checkpoint.h5").exists())
                killed = self.run_killed(command, 2)
                self.assertIn("resumes at t = ", self.good("resume", "run", where=killed))
                self.assert_same(whole, killed)

    def test_kills_at_any_instant_and_again(self):
        command = self.command("tool in exchange, points")
        whole = self.whole(command)
        for i in range(12):
            killed = self.run_killed(command, 1, later_s=0.004 * i)
            for later in (0.001 * i, 0.003 * i):
                status, out = self.kill(["resume", "run"], 1, killed, later)
                self.assertIn(status, (-signal.SIGKILL, 0), out)
            self.good("resume", "run", where=killed)
            self.assert_same(whole, killed)

    def test_a_run_that_ctrl_c_ends_goes_on(self):
        command = self.command("body alone, adaptive")
        whole = self.whole(command)
        where = Path(tempfile.mkdtemp(dir=self.folder))
        status, out = self.kill(command, 2, where, sign=signal.SIGINT)
        self.assertEqual(status, 130, out)
        self.assertIn("`palpate resume run` resumes it", out[1])
        self.good("resume", "run", where=where)
        self.assert_same(whole, where)

    def test_a_complete_run_is_left_alone(self):
        where = self.whole(self.command("body alone, adaptive"))
        before = (where / "run" / "run.vtkhdf").read_bytes()
        self.assertIn("is complete", self.good("resume", "run", where=where))
        self.assertEqual((where / "run" / "run.vtkhdf").read_bytes(), before)

    def test_what_cannot_go_on_is_refused(self):
        self.assertIn("no such folder", self.refused("resume", "nowhere"))
        (self.folder / "empty").mkdir()
        self.assertIn("no checkpoint", self.refused("resume", "empty"))

        source = self.good("run", "cantilever", "--duration-s", "0.02", "-o", "first") and (
            self.folder / "first" / "scene.toml").read_text()
        where = Path(tempfile.mkdtemp(dir=self.folder))
        (where / "mine.toml").write_text(source)
        status, out = self.kill(["run", "mine.toml", "--checkpoint-every", "0.05", "-o", "run"], 2, where)
        self.assertEqual(status, -signal.SIGKILL, out)
        run, checkpoint = where / "run", where / "run" / "checkpoint.h5"
        good = checkpoint.read_bytes()

        with h5py.File(checkpoint, "r") as file:
            at = file["state/bodies.state.q"].id.get_offset() + 100
        for name, content in {"cut short": good[:len(good) // 2], "empty": b"", "no HDF5": b"palpate" * 1000,
                              "one bit": good[:at] + bytes([good[at] ^ 1]) + good[at + 1:]}.items():
            with self.subTest(name):
                checkpoint.write_bytes(content)
                self.assertIn("is not a valid checkpoint", self.refused("resume", run))
        with self.subTest("a run's file in its place"):
            shutil.copy(self.folder / "first" / "run.vtkhdf", checkpoint)
            self.assertIn("a different kind of file", self.refused("resume", run))
        checkpoint.write_bytes(good)

        (where / "mine.toml").write_text(source.replace("poissons_ratio = 0.3", "poissons_ratio = 0.31")
                                         + "\n# changed\n")
        self.assertIn("the scene has changed", self.refused("resume", run))
        (where / "mine.toml").unlink()
        self.assertIn("no longer exists", self.refused("resume", run))
        (where / "mine.toml").write_text(source)

        states = (run / "run.vtkhdf").read_bytes()
        (run / "run.vtkhdf").unlink()
        self.assertIn("run.vtkhdf", self.refused("resume", run))
        (run / "run.vtkhdf").write_bytes(states)
        self.good("resume", run)

    def test_another_version_is_refused(self):
        killed = self.run_killed(self.command("body alone, adaptive"), 2)
        path = killed / "run" / "checkpoint.h5"
        with h5py.File(path, "r+") as file:
            del file.attrs["version"]
            file.attrs["version"] = numpy.bytes_("0.0.1 (older)")
        self.assertIn("was written by palpate 0.0.1 (older)", self.refused("resume", killed / "run"))

    def test_unsupported_options_are_refused_at_the_start(self):
        start = ["run", "press-ball", "--checkpoint-every"]
        for options, reason in ((["--realtime"], "cannot reproduce the clock"), (["--trace"], "--trace"),
                                (["--picture"], "palpate movie"), (["--frames"], "palpate movie"),
                                (["--against-monolithic"], "palpate replay")):
            with self.subTest(options):
                self.assertIn(reason, self.refused(*start, "0.1", *options))
        self.assertIn("which is 0.01 s in this scene", self.refused(*start, "0.001"))
        self.assertIn("before the first checkpoint", self.refused(*start, "9"))
        port = ["--set", 'device={type="udp",port=47000}']
        self.assertIn("moved from outside", self.refused(*start, "0.1", *port))

    def test_a_run_without_checkpoints_leaves_none_of_an_earlier_one(self):
        killed = self.run_killed(self.command("body alone, adaptive"), 2)
        self.good("run", "cantilever", "--duration-s", "0.02", "-o", "run", where=killed)
        self.assertFalse((killed / "run" / "checkpoint.h5").exists())


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=1)
