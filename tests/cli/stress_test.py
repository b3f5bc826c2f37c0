#!/usr/bin/env python3
"""Limits, damage and hostile input: each run ends correctly or is rejected in one sentence, and none hangs.

    stress_test.py PROGRAM
"""
import os
import re
import resource
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
from bad_input_test import NAMESPACE, PROGRAM, Case, can_mount  # noqa: E402

MIB = 1 << 20
LONGEST_S = 120  # per run, on a busy machine
MODEL = PROGRAM.parent / "palpate-model"


class Bounded(Case):
    """Like Case, but a run that does not end is a failure."""

    def call(self, *arguments, before=None, wrapped=(), **options):
        environment = {key: options.pop(key) for key in list(options) if key.isupper()}
        streams = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "stdin": subprocess.DEVNULL,
                   **options}
        done = subprocess.run([*wrapped, str(PROGRAM), *map(str, arguments)], text=True, cwd=self.folder,
                              timeout=LONGEST_S, env=dict(os.environ, **environment), preexec_fn=before,
                              check=False, errors="replace", **streams)
        done.stdout, done.stderr = done.stdout or "", done.stderr or ""
        self.assertIn(done.returncode, (0, 1, 3), done.stdout + done.stderr)
        self.assertNotIn("internal error", done.stderr)
        self.assertNotIn("terminate called", done.stderr)
        return done


class MemoryLimits(Bounded):
    """For any limit: the correct result, or a rejection with figures."""

    FINE = ["press-ball", "--set", "body.0.mesh.element_size_m=0.0025", "--duration-s", "0.01"]
    SCENES = {"cholmod": [*FINE, "--set", "integrator.linear_solver=cholmod"],
              "pcg": [*FINE, "--set", "integrator.linear_solver=pcg-single"],
              "threads": [*FINE, "--set", "integrator.threads=4"],
              "unsymmetric": [*FINE, "--set", "integrator.linear_solver=umfpack"]}
    KINDS = {"addresses": resource.RLIMIT_AS, "data": resource.RLIMIT_DATA}

    def is_loaded(self, limit):
        """Returns whether the system's loader can map the program and its libraries: otherwise main() is not
        reached."""
        done = subprocess.run([str(PROGRAM), "list", "integrators"], capture_output=True, preexec_fn=limit,
                              timeout=LONGEST_S, check=False)
        return done.returncode == 0

    def test_between_half_and_twice_of_the_estimate(self):
        ended, refused = 0, 0
        for name, scene in self.SCENES.items():
            words = [word for word in scene if word not in ("--duration-s", "0.01")]
            text = self.good("inspect", "--all", *words)
            said = float(re.search(r"estimated memory of a run \[MiB\] +(\d+)", text).group(1))
            for kind, number in self.KINDS.items():
                for share in (0.5, 0.8, 1.0, 1.2, 1.5, 2.0):
                    size = int(share * said * MIB)
                    with self.subTest(scene=name, kind=kind, share=share):
                        def limit(number=number, size=size):
                            resource.setrlimit(number, (size, size))
                        if not self.is_loaded(limit):
                            continue
                        done = self.call("run", *scene, "-o", "x", before=limit)
                        if done.returncode == 0:
                            ended += 1
                            continue
                        refused += 1
                        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                        self.assertRegex(done.stderr, r"^palpate: error: .*[\d.]+ (MiB|GiB)")
        self.assertGreater(ended, 0)
        self.assertGreater(refused, 0)

    def test_what_the_blas_works_in_is_refused_with_figures(self):
        """The estimate fits, but the buffer of OpenBLAS does not."""
        scene = ["one-tet", "--integrator", "linearly-implicit-euler", "--set",
                 "integrator.linear_solver=cholmod",
                 "--set", "integrator.step_s=0.01", "--duration-s", "0.02"]
        outcomes = set()
        for size in range(140, 420, 20):
            with self.subTest(mib=size):
                done = self.call("run", *scene, "-o", "x", "--beyond-memory",
                                 before=lambda: resource.setrlimit(resource.RLIMIT_AS,
                                                                   (size * MIB, size * MIB)))
                outcomes.add(done.returncode)
                if done.returncode != 0:
                    self.assertRegex(done.stderr, r"[\d.]+ MiB")
        self.assertIn(0, outcomes)

    def test_threads_that_cannot_be_had(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (700 * MIB, 700 * MIB))
            resource.setrlimit(resource.RLIMIT_STACK, (64 * MIB, 64 * MIB))
        text = self.refused("run", "press-ball", "--set", "integrator.threads=64", "--duration-s", "0.01",
                            "-o", "x",
                            before=limit)
        self.assertRegex(text, r"[\d.]+ (MiB|GiB)|thread \d+ of 64 cannot be started")


class SmallLimits(Bounded):
    def test_no_thread_of_a_library_waits_for_memory(self):
        """The program ends; its loader may find no memory for the libraries (127), or the libraries none for
        their work."""
        codes = []
        for size in range(120, 321, 20):
            with self.subTest(mib=size):
                done = subprocess.run([str(PROGRAM), "list", "integrators"], capture_output=True, timeout=70,
                                      check=False, preexec_fn=lambda: resource.setrlimit(
                                          resource.RLIMIT_AS, (size * MIB, size * MIB)))
                codes.append(done.returncode)
                if done.returncode == 1:
                    self.assertRegex(done.stderr.decode(), rf"{size} MiB of address space .*Raise the limit")
        self.assertLessEqual(set(codes), {0, 1, 127})
        self.assertEqual(codes[-1], 0)


class Outputs(Bounded):
    def test_a_full_standard_output_is_said(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            for command in (["list", "integrators"], ["--help"], ["help", "keys"], ["inspect", "press-ball"]):
                with self.subTest(command=command):
                    done = self.call(*command, stdout=full)
                    self.assertEqual(done.returncode, 1)
                    self.assertIn("standard output is incomplete: No space left on device",
                                  done.stderr)
            done = self.call("run", "one-tet", "--duration-s", "0.02", "-o", "x", stdout=full)
            self.assertEqual(done.returncode, 1)
            self.assertEqual(self.summary("x")["outcome"], "finished")
            if MODEL.exists():
                self.assertEqual(self.call("model", "ball", "-o", "m.h5", stdout=full).returncode, 1)
                self.assertTrue((self.folder / "m.h5").exists())

    def test_a_full_standard_error_changes_no_status(self):
        with open("/dev/full", "w", encoding="utf-8") as full:
            self.assertEqual(self.call("run", "no-such-scene", stderr=full).returncode, 1)
            self.assertEqual(self.call("run", "one-tet", "--duration-s", "0.02", stderr=full).returncode, 0)

    def test_closed_descriptors_are_not_taken_by_results(self):
        for closed in ((0,), (1,), (2,), (0, 1, 2)):
            with self.subTest(closed=closed):
                done = self.call("run", "one-tet", "--duration-s", "0.02", "-o", "x",
                                 before=lambda: [os.close(one) for one in closed])
                self.assertEqual(done.returncode, 0)
                self.assertEqual(len(self.steps("x")), 3)

    def test_control_characters_reach_no_terminal(self):
        name = "\x1b[31mred\x07\x7f"
        scene = (Path(__file__).resolve().parents[2] / "scenes/one-tet.toml").read_text()
        (self.folder / (name + ".toml")).write_text(scene)
        (self.folder / "escape.toml").write_text(re.sub(r'^name = .*$', r'name = "a\\u001b[2J"', scene,
                                                        flags=re.M))
        (self.folder / "key.toml").write_text(scene + '\n["\\u001b[2J"]\n')
        for command in (["run", name], ["run", name + ".toml", "--duration-s", "0.01"],
                        ["run", "one-tet", "-o", name,
                        "--duration-s", "0.01"], ["run", "escape.toml"], ["run", "key.toml"],
                        ["report", name],
                        ["list", name], [name], ["run", "one-tet", "--set", f"scene.name={name}"],
                        ["run", "one-tet", "--integrator", name], ["study", name], ["resume", name]):
            with self.subTest(command=command):
                done = self.call(*command)
                for text in (done.stdout, done.stderr):
                    self.assertNotRegex(text, r"[\x00-\x08\x0b-\x1f\x7f\x80-\x9f]")
        self.assertIn("without control characters", self.refused("run", "escape.toml"))
        self.assertIn("\\x1b[2J", self.refused("run", "key.toml"))


class Surroundings(Bounded):
    def test_a_missing_folder_for_temporary_files(self):
        done = self.call("run", "press-ball", "--duration-s", "0.02", "--report", "-o", "x",
                         TMPDIR="/no/such/folder")
        self.assertIn(done.returncode, (0, 3), done.stderr)
        if done.returncode == 3:
            self.assertIn("TMPDIR", done.stderr)
        text = self.refused("bench", "leave-out", "falling-ball", "--repeats", "1", TMPDIR="/no/such/folder")
        self.assertIn("/no/such/folder", text)
        self.assertIn("TMPDIR", text)

    def test_a_loop_of_links(self):
        (self.folder / "a").symlink_to("b")
        (self.folder / "b").symlink_to("a")
        (self.folder / "a.toml").symlink_to("a.toml")
        (self.folder / "a.h5").symlink_to("a.h5")
        (self.folder / "a.obj").symlink_to("a.obj")
        scene = (Path(__file__).resolve().parents[2] / "scenes/press-ball.toml").read_text()
        scene = re.sub(r"\[\[device.keyframe\]\].*(?=\[exchange\])", "", scene, flags=re.S)
        (self.folder / "recorded.toml").write_text(
            scene.replace('type = "script"', 'type = "recording"\nfile = "a"'))
        self.good("run", "press-ball", "--duration-s", "0.02", "-o", "run")
        for command in (["run", "a"], ["run", "a.toml"], ["run", "one-tet", "-o", "a"],
                        ["run", "one-tet", "-o", "a/b"],
                        ["report", "a"], ["export", "a", "--to", "vtu"],
                        ["export", "run", "--to", "vtu", "-o", "a"],
                        ["study", "a.toml"], ["diff", "a", "run"], ["replay", "a"], ["resume", "a"],
                        ["movie", "a"],
                        ["compare", "one-tet", "--integrator", "cvode-bdf", "-o", "a"],
                        ["run", "recorded.toml"],
                        ["inspect", "press-ball", "--set", 'body.0.mesh={file="a.h5"}'],
                        *([["model", "a.obj"], ["model", "ball", "-o", "a/m.h5"]] if MODEL.exists() else [])):
            with self.subTest(command=command):
                self.refused(*command)

    @unittest.skipUnless(can_mount(), "no mounts (root, or user namespaces)")
    def test_without_proc(self):
        wrapped = [*NAMESPACE, "sh", "-c", 'mount -t tmpfs none /proc && exec "$@"', "sh"]
        for command in (["list", "scenes"], ["inspect", "press-ball"],
                        ["run", "one-tet", "--duration-s", "0.02"],
                        ["run", "press-ball", "--duration-s", "0.02", "-o", "x"], ["report", "x"],
                        ["export", "x", "--to", "csv"],
                        *([["model", "ball", "-o", "m.h5", "--tetrahedra",
                            "500"]] if MODEL.exists() else [])):
            with self.subTest(command=command):
                self.good(*command, wrapped=wrapped)

    def test_extreme_values(self):
        keys = ("scene.duration_s", "body.0.youngs_modulus_pa", "body.0.density_kg_m3",
                "body.0.mesh.radius_m",
                "body.0.mesh.element_size_m", "integrator.step_s", "integrator.rtol",
                "exchange.exchange_period_s",
                "contact.1.stiffness_pa_m", "tool.mass_kg", "tool.tick_s", "record.state_period_s",
                "body.0.position_m.0", "device.keyframe.1.time_s", "device.keyframe.1.position_m.2")
        for key in keys:
            for value in ("1e308", "5e-324", "-1e308", "1e-300", "9007199254740992", "inf", "nan"):
                with self.subTest(key=key, value=value):
                    self.call("inspect", "press-ball", "--integrator", "linearly-implicit-euler", "--set",
                              f"{key}={value}")

    @unittest.skipUnless(MODEL.exists(), "this build makes no models")
    def test_a_model_that_cannot_be_written_is_rejected_before_it_is_made(self):
        (self.folder / "folder").mkdir()
        (self.folder / "file").write_text("")
        for output in ("missing/m.h5", "folder", "file/m.h5", "/proc/m.h5"):
            with self.subTest(output=output):
                done = self.call("model", "head", "-o", output)
                self.assertEqual(done.returncode, 1)
                self.assertIn(f"error: {output}: ", done.stderr)
                self.assertEqual(done.stdout, "", "nothing was begun")
        self.assertEqual(sorted(path.name for path in self.folder.iterdir()), ["file", "folder"])

    def test_the_peak_of_memory_is_the_program_s(self):
        large = bytearray(400 * MIB)  # inherited by a forked child until it executes another program
        text = self.good("run", "one-tet", "--duration-s", "0.02", before=lambda: None)
        self.assertLess(float(re.search(r"peak memory (\d+) MiB", text).group(1)), 300)
        self.assertEqual(len(large), 400 * MIB)


class Places(Bounded):
    """Errors found after loading state the line as well."""

    BODY = ('[scene]\nname = "s"\nduration_s = 0.01\n[[body]]\nname = "block"\nyoungs_modulus_pa = 1e4\n'
            'mesh = { generator = "box", size_m = [0.1, 0.1, 0.1], element_size_m = %s }\n')
    HELD = '[[body.attachment]]\nbox_min_m = [-1, -1, -1]\nbox_max_m = [1, 1, %s]\n'

    def test_generators_and_attachments(self):
        for text, place, what in (
                (self.BODY % "1e-6", "s.toml:7:8: body \"block\": ", "gives about"),
                (self.BODY % "0.05" + self.HELD % "0" + self.HELD % "1", "s.toml:11:1: body \"block\": ",
                 "attachment 2 overlaps attachment 1"),
                (self.BODY % "0.05" + self.HELD % "-0.9", "s.toml:8:1: body \"block\": ",
                 "contains no node")):
            with self.subTest(what=what):
                (self.folder / "s.toml").write_text(text)
                message = self.refused("run", "s.toml")
                self.assertIn(place, message)
                self.assertIn(what, message)


class Studies(Bounded):
    def test_one_study_has_a_folder_at_a_time(self):
        (self.folder / "s.toml").write_text(
            '[study]\nscenes = ["one-tet"]\nduration_s = 2.0\nlimit_s = 60\n'
            '[[sweep]]\nkey = "body.0.youngs_modulus_pa"\nfrom = 1e4\nto = 2e4\ncount = 24\n')
        started = [self.started("study", "s.toml", "-o", "here", "--jobs", "1") for _ in range(3)]
        ends = [process.communicate(timeout=LONGEST_S) for process in started]
        codes = sorted(process.returncode for process in started)
        self.assertEqual(codes, [0, 1, 1], ends)
        for process, (_, errors) in zip(started, ends):
            if process.returncode == 1:
                self.assertIn("here: process ", errors)
                self.assertIn("is writing into this folder", errors)
        self.good("study", "s.toml", "-o", "here", "--task", "0-3")
        self.good("study", "s.toml", "-o", "here", "--merge")


class Resumed(Bounded):
    """A killed run is resumed from complete files only."""

    def setUp(self):
        super().setUp()
        process = self.started("run", "press-ball", "--duration-s", "0.4", "--checkpoint-every", "0.1", "-o",
                               "run")
        self.wait_for((self.folder / "run/checkpoint.h5").exists, process)
        process.kill()
        process.communicate()

    def test_a_flipped_bit_is_found(self):
        for name, at in (("force.csv", 300), ("force.csv", 5000), ("haptic.h5.rows", 40),
                         ("haptic.h5.rows", 9000)):
            with self.subTest(name=name, at=at):
                path = self.folder / "run" / name
                whole = path.read_bytes()
                path.write_bytes(whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
                self.assertIn(f"run/{name}: differs from its content at the checkpoint",
                              self.refused("resume", "run"))
                path.write_bytes(whole)
        self.good("resume", "run")
        self.assertEqual(self.summary("run")["outcome"], "finished")

    def test_a_flipped_bit_in_a_state_is_found(self):
        try:
            import h5py
        except ImportError:
            self.skipTest("h5py")
        path = self.folder / "run/run.vtkhdf"
        for field in ("Points", "PointData/velocity", "PointData/stress"):
            with self.subTest(field=field), h5py.File(path, "r+") as file:
                values = file["VTKHDF"][field]
                kept = values[0]
                values[0] = kept + 1e-9
                file.close()
                self.assertIn("its states differ from those", self.refused("resume", "run"))
                with h5py.File(path, "r+") as again:
                    again["VTKHDF"][field][0] = kept
        self.good("resume", "run")

    def test_other_instructions_are_said(self):
        done = self.call("resume", "run", PALPATE_INSTRUCTIONS="baseline")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("began with another instruction set", done.stderr)
        self.assertIn("baseline", done.stderr)


class Killed(Bounded):
    def test_by_ctrl_c_a_run_under_a_limit_ends(self):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (2048 * MIB, 2048 * MIB))
        process = subprocess.Popen([str(PROGRAM), "run", "one-tet", "--duration-s", "1e6", "-o", "x"],
                                   cwd=self.folder,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=limit)
        self.addCleanup(process.kill)
        self.wait_for((self.folder / "x/run.vtkhdf").exists, process)
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(timeout=LONGEST_S), 130)


if __name__ == "__main__":
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]])
