#!/usr/bin/env python3
"""Runs with files: the same files as by the program, checkpoints, pictures, errors, Ctrl-C."""
import csv
import json
import os
import signal
import tempfile
import threading
import time
import tomllib
import unittest
from pathlib import Path

from built import SCENES, refusal_of_program, run_program
import h5py
import palpate

BALL = SCENES / "press-ball.toml"
BLOCK = {"scene": {"name": "block", "duration_s": 0.05},
         "body": [{"name": "block", "youngs_modulus_pa": 1e4, "poissons_ratio": 0.4, "density_kg_m3": 1e3,
                   "mesh": {"generator": "box", "size_m": [0.1, 0.1, 0.1], "element_size_m": 0.05}}]}


def positions_in(folder):
    with h5py.File(Path(folder) / "run.vtkhdf") as file:
        return file["VTKHDF/Points"][:].tobytes()


def without_clocks(value):
    """Returns a summary without wall times and without what the process or its command differ in."""
    if isinstance(value, dict):
        return {key: without_clocks(inner) for key, inner in value.items()
                if not key.endswith(("_s", "_utc", "_mib")) and key not in ("command", "constructions", "gl")}
    return [without_clocks(inner) for inner in value] if isinstance(value, list) else value


class WithFolder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="palpate-python-")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def interrupt_after_checkpoint(self, folder):
        def wait():
            while not (folder / "checkpoint.h5").exists() and not done.is_set():
                time.sleep(0.002)
            if not done.is_set():
                os.kill(os.getpid(), signal.SIGINT)
        done = threading.Event()
        thread = threading.Thread(target=wait)
        self.addCleanup(thread.join)
        self.addCleanup(done.set)
        thread.start()


class Files(WithFolder):
    def test_they_are_those_of_the_program(self):
        run_program("run", BALL, "--duration-s", 0.15, "-o", self.folder / "program", "--trace")
        run = palpate.run(BALL, folder=self.folder / "python", duration_s=0.15, trace=True)
        self.assertEqual((run.folder, run.outcome, run.missing), (self.folder / "python", "finished", []))
        names = sorted(file.name for file in (self.folder / "program").iterdir())
        self.assertEqual(sorted(file.name for file in run.files), names)
        self.assertTrue(all(file.is_file() for file in run.files))
        self.assertEqual(positions_in(run.folder), positions_in(self.folder / "program"))
        force = (run.folder / "force.csv").read_bytes()
        self.assertEqual(force, (self.folder / "program/force.csv").read_bytes())
        self.assertGreater(len(list(csv.reader(force.decode().splitlines()))), 100)
        self.assertEqual(run.summary, json.loads((run.folder / "summary.json").read_text()))
        program = json.loads((self.folder / "program/summary.json").read_text())
        self.assertEqual(without_clocks(run.summary), without_clocks(program))
        self.assertEqual(run.summary["command"],
                         f"palpate run {BALL} --duration-s 0.15 --trace -o {run.folder}")

    def test_a_run_without_outputs_writes_none(self):
        before = os.getcwd()
        self.addCleanup(os.chdir, before)
        os.chdir(self.folder)
        run = palpate.run(palpate.Scene(BLOCK))
        self.assertEqual((run.folder, run.files, run.outcome), (None, [], "finished"))
        self.assertEqual(list(self.folder.iterdir()), [])
        recorded = palpate.run("one-tet", duration_s=0.1)  # the name of an included scene
        self.assertEqual(recorded.folder, Path("out/one-tet"))
        self.assertTrue((self.folder / "out/one-tet/summary.json").is_file())

    def test_changes_of_a_scene_are_in_the_summary(self):
        scene = palpate.load(SCENES / "one-tet.toml")
        scene.set("body.0.youngs_modulus_pa", 2e4)
        run = palpate.run(scene, folder=self.folder / "out", duration_s=0.1)
        self.assertEqual(run.summary["overrides"], scene.changes)
        kept = tomllib.loads((run.folder / "scene.toml").read_text())
        self.assertEqual(kept["body"][0]["youngs_modulus_pa"], 2e4)

    def test_warnings_are_those_of_the_run(self):
        scene = palpate.load(SCENES / "falling-ball.toml")
        scene.set("contact.0.stiffness_pa_m", 1e4)  # the ball sinks into the floor
        deep = palpate.run(scene, duration_s=0.15, folder=self.folder / "deep")
        self.assertEqual(len([text for text in deep.remarks if "more than half the thickness" in text]), 1,
                         deep.remarks)
        other = palpate.run(BALL, duration_s=0.1, folder=self.folder / "other")
        self.assertEqual([text for text in other.remarks if "half the thickness" in text], [])

    def test_pictures_and_movies(self):
        try:
            run = palpate.run(BALL, folder=self.folder / "out", duration_s=0.1, picture=True, frames=True,
                              movie=self.folder / "touch.png", size="240x218")
        except palpate.Error as error:
            self.skipTest(str(error))
        self.assertEqual(run.missing, [])
        self.assertIn(self.folder / "touch.png", run.files)
        self.assertIn(run.folder / "frames", run.files)
        for file in (run.folder / "picture.png", run.folder / "frames/0001.png", self.folder / "touch.png"):
            self.assertEqual(file.read_bytes()[:8], b"\x89PNG\r\n\x1a\n", file)
        drawn = palpate.movie(run.folder, slow=2.0, size="240x218")
        self.assertEqual(drawn, run.folder / "movie.png")
        self.assertTrue(drawn.is_file())
        with self.assertRaisesRegex(palpate.Error, "run.vtkhdf: no such file"):
            palpate.movie(self.folder)


class Checkpoints(WithFolder):
    def test_a_resumed_run_is_bitwise_equal(self):
        options = {"duration_s": 0.3, "checkpoint_every_s": 0.05}
        whole = palpate.run(BALL, folder=self.folder / "whole", **options)
        self.assertEqual(whole.summary["outcome"], "finished")
        half = self.folder / "half"
        self.interrupt_after_checkpoint(half)
        with self.assertRaises(KeyboardInterrupt):
            palpate.run(BALL, folder=half, **options)
        self.assertEqual(json.loads((half / "summary.json").read_text())["outcome"], "interrupted")
        rest = palpate.resume(half)
        self.assertEqual(rest.outcome, "finished")
        self.assertEqual(positions_in(half), positions_in(whole.folder))
        self.assertEqual((half / "force.csv").read_bytes(), (whole.folder / "force.csv").read_bytes())
        self.assertEqual(without_clocks(rest.summary), without_clocks(whole.summary))
        again = palpate.resume(half)  # finished: nothing is left to do
        self.assertEqual((again.outcome, again.files), ("finished", rest.files))

    def test_a_scene_without_a_file_is_resumed_from_the_checkpoint(self):
        tables = tomllib.loads(BALL.read_text())
        half = self.folder / "half"
        self.interrupt_after_checkpoint(half)
        with self.assertRaises(KeyboardInterrupt):
            palpate.run(palpate.Scene(tables, folder=str(SCENES)), folder=half, duration_s=0.3,
                        checkpoint_every_s=0.05)
        self.assertEqual(palpate.resume(half).outcome, "finished")

    def test_nothing_to_resume(self):
        with self.assertRaisesRegex(palpate.Error, "no checkpoint"):
            palpate.resume(self.folder)


class Refusals(WithFolder):
    def test_messages_are_those_of_the_program(self):
        for options, words in (({"size": "640x480"}, ["--size", "640x480"]),
                               ({"checkpoint_every_s": 0.05, "trace": True},
                                ["--checkpoint-every", "0.05", "--trace"])):
            with self.subTest(options=options):
                with self.assertRaises(palpate.Error) as caught:
                    palpate.run(BALL, folder=self.folder / "out", **options)
                self.assertIn(str(caught.exception),
                              refusal_of_program("run", BALL, "-o", self.folder / "out", *words))
        with self.assertRaisesRegex(palpate.Error, "passivity: unknown mode \"contrl\""):
            palpate.run(BALL, passivity="contrl")
        with self.assertRaises(TypeError):
            palpate.run(BALL, folder=self.folder / "out", no_such_option=1)
        self.assertFalse((self.folder / "out").exists())

    def test_an_integrator_that_fails(self):
        scene = palpate.load(SCENES / "cantilever.toml")
        scene.set_all({"integrator.max_steps": 1, "integrator.rtol": 1e-9})
        with self.assertRaisesRegex(palpate.IntegratorError, "cvode-bdf failed at t = "):
            palpate.run(scene, folder=self.folder / "out")
        self.assertEqual(json.loads((self.folder / "out/summary.json").read_text())["outcome"], "failed")

    def test_two_runs_at_once(self):
        running = threading.Event()

        def run_long():
            running.set()
            palpate.run(BALL, folder=self.folder / "long")
        thread = threading.Thread(target=run_long)
        thread.start()
        self.addCleanup(thread.join)
        running.wait()
        while thread.is_alive() and not (self.folder / "long/summary.json").exists():
            time.sleep(0.002)
        with self.assertRaisesRegex(palpate.Error, "another thread"):
            palpate.run("one-tet", folder=self.folder / "short")


if __name__ == "__main__":
    unittest.main(argv=[__file__])
