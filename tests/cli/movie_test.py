#!/usr/bin/env python3
"""Movies of runs: number of frames, their content, and the message when there is none.

    movie_test.py PROGRAM
"""
import json
import os
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

from apng import Animation

PROGRAM = Path(sys.argv[1]).resolve()
WIDTH, HEIGHT = 240, 218
STRIP = HEIGHT * 150 // 870  # the curve's part of it
SMALL = ["--size", f"{WIDTH}x{HEIGHT}"]
FFMPEG, FFPROBE = shutil.which("ffmpeg"), shutil.which("ffprobe")


def marks(frame):
    """Columns of the mark at the current time, found by its colour half-way down the strip."""
    row = frame[HEIGHT - STRIP // 2]
    pixels = [row[3 * x:3 * x + 3] for x in range(WIDTH)]
    return [x for x, p in enumerate(pixels) if p[0] > 180 and p[1] < 120 and p[2] < 70]


def different(one, other, rows):
    return sum(one[y][3 * x:3 * x + 3] != other[y][3 * x:3 * x + 3] for y in rows for x in range(WIDTH))


def unlike(one, other):
    """Pixels that differ by more than rounding of surface positions."""
    return sum(max(abs(a - b) for a, b in zip(one[y][3 * x:3 * x + 3], other[y][3 * x:3 * x + 3])) > 3
               for y in range(HEIGHT) for x in range(WIDTH))


class Movie(unittest.TestCase):
    def setUp(self):
        self.folder = Path(tempfile.mkdtemp(prefix="palpate-movie-"))
        self.addCleanup(shutil.rmtree, self.folder)

    def call(self, *arguments, preexec=None, **environment):
        return subprocess.run([str(PROGRAM), *arguments], capture_output=True, text=True, cwd=self.folder,
                              timeout=600, env=dict(os.environ, **environment), stdin=subprocess.DEVNULL,
                              preexec_fn=preexec)

    def good(self, *arguments, **environment):
        done = self.call(*arguments, **environment)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *arguments, **environment):
        done = self.call(*arguments, **environment)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertTrue(done.stderr.startswith("palpate: error: "), done.stderr)
        self.assertEqual(done.stdout, "", "refused before anything is simulated")
        return done.stderr

    def incomplete(self, *arguments, **environment):
        done = self.call(*arguments, **environment)
        self.assertEqual(done.returncode, 3, done.stdout + done.stderr)
        last = done.stderr.splitlines()[-1]
        self.assertTrue(last.startswith("palpate: incomplete: missing movie "), done.stderr)
        return last

    def press(self, seconds, *arguments):
        return ["run", "press-ball", "--duration-s", str(seconds), *SMALL, *arguments]

    def fake_ffmpeg(self, script):
        """A fake program of that name, first on the PATH."""
        (self.folder / "bin").mkdir()
        program = self.folder / "bin/ffmpeg"
        program.write_text("#!/bin/sh\n" + script)
        program.chmod(0o755)
        return {"PATH": f"{program.parent}:{os.environ['PATH']}"}


class Frames(Movie):
    def test_every_frame_is_there_and_moves(self):
        text = self.good(*self.press(0.2, "--movie", "deep/in/press.png", "--frames", "--slow", "4",
                                     "-o", "here"))
        self.assertIn("20 of 20 frames in deep/in/press.png, one every 0.01 s of simulated time; "
                      "25 per second",
                      text)
        self.assertIn("--movie deep/in/press.png --slow 4 --size 240x218 ",
                      json.loads((self.folder / "here/summary.json").read_text())["command"])
        movie = Animation(self.folder / "deep/in/press.png")
        self.assertEqual((movie.width, movie.height), (WIDTH, HEIGHT))
        self.assertEqual(movie.delays, [0.04] * 20)
        pictures = sorted((self.folder / "here/frames").iterdir())
        self.assertEqual([path.name for path in pictures], [f"{i:04}.png" for i in range(20)])
        for path, frame in zip(pictures, movie.frames):  # lossless, by another encoder
            self.assertEqual(Animation(path).frames[0], frame, path.name)

        # the mark moves uniformly over the strip, from its left end to its right
        columns = [sum(marks(frame)) / len(marks(frame)) for frame in movie.frames]
        steps = [b - a for a, b in zip(columns, columns[1:])]
        for step in steps[1:]:  # the curve begins with the first tick
            self.assertAlmostEqual(step, sum(steps[1:]) / len(steps[1:]), delta=1.01)
        self.assertGreater(columns[-1] - columns[0], 0.6 * WIDTH)
        # the scene moves: the tool comes down and the ball is dented, while the sky at the left edge does not
        # change
        scene = range(0, HEIGHT - STRIP)
        for one, other in zip(movie.frames[3:12], movie.frames[4:13]):
            self.assertGreater(different(one, other, scene), 100)
        for frame in movie.frames:
            self.assertEqual(frame[HEIGHT // 4][:9], movie.frames[0][HEIGHT // 4][:9])
        self.assertFalse(list(self.folder.rglob("*.part")) + list(self.folder.rglob(".instants*")))

    def test_a_run_that_is_over_looks_as_it_did(self):
        # a rigid tool, and bones in a limb: their positions are found from their surfaces
        for scene, seconds in (("press-ball", 0.2), ("swung-limb", 0.2)):
            with self.subTest(scene=scene):
                self.good("run", scene, "--duration-s", str(seconds), *SMALL, "--movie", "a.png",
                          "-o", "here", "--set", "record.state_period_s=0.01")
                for cut_off in (False, True):
                    if cut_off:  # files that a killed run does not write
                        (self.folder / "here/summary.json").unlink()
                        (self.folder / "here/scene.toml").unlink()
                    text = self.good("movie", "here", *SMALL, "-o", "b.png")
                    self.assertIn("5 of 5 frames in b.png, one every 0.04 s of simulated time; 25 per second",
                                  text)
                    was, now = Animation(self.folder / "a.png"), Animation(self.folder / "b.png")
                    self.assertEqual(was.delays, now.delays)
                    moved = 0
                    for i, (one, other) in enumerate(zip(was.frames, now.frames)):
                        self.assertLess(unlike(one, other), WIDTH * HEIGHT / 5000, i)
                        moved += different(one, was.frames[0], range(HEIGHT - STRIP))
                    self.assertGreater(moved, 1000, "and it moves")

    def test_of_a_run_that_is_over_only_what_it_kept(self):
        self.good(*self.press(0.05, "--movie", "a.png", "-o", "here"))
        self.good("movie", "here", *SMALL, "--shade", "stress", "--slow", "4", "-o", "b.png")
        self.assertEqual(Animation(self.folder / "b.png").delays, [0.04] * 5)
        self.good("movie", "here", *SMALL, PATH="/nowhere")  # default formats require no other program
        self.assertEqual(Animation(self.folder / "here/movie.png").delays, [0.04] * 2)
        self.assertIn("runs do not record penetration",
                      self.refused("movie", "here", "--shade", "penetration"))
        self.assertIn("one per 0.01 s", self.refused("movie", "here", "--fps", "200", "-o", "c.png"))
        self.assertIn("run.vtkhdf: no such file", self.refused("movie", "nowhere"))
        (self.folder / "here/run.vtkhdf").write_bytes(b"no HDF5")
        self.refused("movie", "here", "-o", "c.png")
        self.assertFalse((self.folder / "c.png").exists())

    def test_the_rate_is_that_of_what_is_played(self):
        for options, frames, delay in [([], 4, 0.04), (["--fps", "50"], 8, 0.02), (["--slow", "2"], 8, 0.04),
                                       (["--slow", "100"], 15, 1.0), (["--slow", "0.5"], 2, 0.04)]:
            with self.subTest(options=options):
                self.good(*self.press(0.15, "--movie", "a.apng", *options, "-o", "here"))
                movie = Animation(self.folder / "a.apng")
                self.assertEqual(len(movie.frames), frames)
                self.assertEqual(set(movie.delays), {delay})

    def test_monolithic_real_time_and_other_shades(self):
        for options in (["--set", "exchange.scheme=monolithic"], ["--realtime"], ["--shade", "penetration"]):
            with self.subTest(options=options):
                self.good(*self.press(0.08, "--movie", "a.png", "--fps", "50", *options))
                movie = Animation(self.folder / "a.png")
                self.assertEqual(len(movie.frames), 4)
                columns = [marks(frame)[0] for frame in movie.frames]
                self.assertEqual(columns, sorted(set(columns)))

    def test_without_a_tool_there_is_the_force_of_contact_and_without_contact_no_curve(self):
        self.good("run", "falling-ball", "--duration-s", "0.1", "--movie", "ball.png", *SMALL)
        movie = Animation(self.folder / "ball.png")
        self.assertEqual(len(movie.frames), 3)
        self.assertTrue(all(marks(frame) for frame in movie.frames))
        self.good("run", "cantilever", "--duration-s", "0.1", "--movie", "beam.png", *SMALL)
        movie = Animation(self.folder / "beam.png")
        self.assertEqual((movie.width, movie.height), (WIDTH, HEIGHT))
        self.assertFalse(any(marks(frame) for frame in movie.frames))

    def test_another_movie_of_this_name_is_replaced_by_a_whole_one_only(self):
        (self.folder / "a.png").write_text("of yesterday")
        self.good(*self.press(0.05, "--movie", "a.png"))
        self.assertEqual(len(Animation(self.folder / "a.png").frames), 2)
        before = (self.folder / "a.png").read_bytes()
        last = self.incomplete(*self.press(0.05, "--movie", "a.png"),
                               __EGL_VENDOR_LIBRARY_FILENAMES="/nowhere.json")
        self.assertIn("movie a.png (", last)
        self.assertEqual((self.folder / "a.png").read_bytes(), before)

    def test_ctrl_c_leaves_a_movie_of_what_was_drawn(self):
        process = subprocess.Popen([str(PROGRAM), "run", "press-ball", "--movie", "cut.png", "--fps", "100"],
                                   cwd=self.folder, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        draft = self.folder / "cut.png.part"
        while process.poll() is None and not (draft.exists() and draft.stat().st_size > 200000):
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 130, err)
        self.assertIn("those written are complete", err)
        count = int(re.search(r"(\d+) of 40 frames in cut.png", out).group(1))
        self.assertLess(count, 40)
        data = (self.folder / "cut.png").read_bytes()
        self.assertEqual(data.count(b"fcTL"), count)
        self.assertTrue(data.endswith(b"IEND\xaeB\x60\x82"))


class Refusals(Movie):
    def test_arguments(self):
        for name in "a.gif", "a.mkv", "a", "png", "a.png.txt":
            self.assertIn(".mp4 or .webm (by ffmpeg), .png or .apng",
                          self.refused(*self.press(0.1, "--movie", name)))
        movie = self.press(0.1, "--movie", "a.png")
        self.assertIn("100 per second of simulated time", self.refused(*movie, "--fps", "101"))
        self.assertIn("--fps 25 --slow 5", self.refused(*movie, "--fps", "25", "--slow", "5"))
        for option in "--fps", "--slow":
            for value in "0", "-1", "nan", "inf", "fast":
                self.assertIn(option, self.refused(*movie, option, value))
            self.assertIn("need --movie", self.refused("run", "press-ball", option, "3"))
        self.assertIn("use --fps and --slow", self.refused(*movie, "--frames", "--frames-per-s", "10"))
        for size in "640", "640x481", "20x20", "640x99999", "axb":
            self.assertIn(f"--size {size}: ", self.refused("run", "press-ball", "--movie", "a.png", "--size",
                                                           size))
        self.assertIn("needs --frames or --movie", self.refused("run", "press-ball", *SMALL))
        self.assertFalse(list(self.folder.iterdir()))

    def test_places(self):
        (self.folder / "file").write_text("")
        self.assertIn("--movie file/a.png: cannot be written",
                      self.refused(*self.press(0.1, "--movie", "file/a.png")))
        (self.folder / "a.png").mkdir()
        self.assertIn("--movie a.png: is a folder", self.refused(*self.press(0.1, "--movie", "a.png")))
        (self.folder / "b.png.part").mkdir()
        self.assertIn("--movie b.png: cannot be written",
                      self.refused(*self.press(0.1, "--movie", "b.png")))

    def test_full_disk(self):
        scene = PROGRAM.parent.parent / "share/palpate/scenes/press-ball.toml"
        text = scene.read_text()
        (self.folder / "bare.toml").write_text(text[:text.index("[record]")])

        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # writes then fail, as on a full disk
            resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))
        last = self.incomplete("run", "bare.toml", "--duration-s", "0.1", "--movie", "a.png", preexec=limit)
        self.assertIn("movie a.png (a.png.part: the animation cannot be written: File too large", last)
        self.assertFalse(list(self.folder.glob("a.png*")))

    def test_no_ffmpeg(self):
        text = self.refused(*self.press(0.1, "--movie", "a.webm"), PATH="/nowhere")
        self.assertIn("install the package ffmpeg", text)
        self.assertIn("give a file name that ends in .png", text)
        self.good(*self.press(0.05, "--movie", "a.png"), PATH="/nowhere")

    def test_ffmpeg_that_fails(self):
        at_once = self.fake_ffmpeg("echo Unknown encoder: vp9 >&2; exit 7\n")
        last = self.incomplete(*self.press(0.2, "--movie", "a.webm"), **at_once)
        self.assertIn("movie a.webm (ffmpeg failed (exit status 7): Unknown encoder: vp9)", last)
        (self.folder / "bin/ffmpeg").write_text("#!/bin/sh\ncat >/dev/null\nkill -9 $$\n")
        last = self.incomplete(*self.press(0.2, "--movie", "a.webm"), **at_once)
        self.assertIn("movie a.webm (ffmpeg failed (exit status 137): no message)", last)
        self.assertFalse(list(self.folder.glob("a.webm*")))

    def test_ffmpeg_is_given_every_frame(self):
        path = self.fake_ffmpeg('printf "%s\\n" "$*" >arguments\nfor draft; do :; done\n'
                                'cat >"${draft#file:}"\n')
        self.good(*self.press(0.2, "--movie", "a.webm"), **path)
        self.assertEqual((self.folder / "a.webm").stat().st_size, 5 * WIDTH * HEIGHT * 4)
        self.assertIn(f"-video_size {WIDTH}x{HEIGHT} -framerate 10000/400 ",
                      (self.folder / "arguments").read_text())


    def test_mp4_requires_an_encoder(self):
        text = self.refused(*self.press(0.1, "--movie", "a.mp4"), PATH="/nowhere")
        self.assertIn("install the package ffmpeg", text)
        lists = 'if [ "$2" = -encoders ]; then echo " V....D libvpx-vp9  VP9 "; exit 0; fi\n'
        script = 'printf "%s\\n" "$*" >arguments\nfor draft; do :; done\ncat >"${draft#file:}"\n'
        path = self.fake_ffmpeg(lists + script)
        text = self.refused(*self.press(0.1, "--movie", "a.mp4"), **path)
        self.assertIn("no encoder libx264", text)
        self.assertIn(".webm or .png", text)
        (self.folder / "bin/ffmpeg").write_text(
            "#!/bin/sh\n" + lists.replace("libvpx-vp9  VP9", "libx264  H.264") + script)
        self.good(*self.press(0.2, "--movie", "a.MP4"), **path)
        self.assertEqual((self.folder / "a.MP4").stat().st_size, 5 * WIDTH * HEIGHT * 4)
        arguments = (self.folder / "arguments").read_text()
        for word in "-c:v libx264", "-pix_fmt yuv420p", "-movflags +faststart", "-f mp4", "file:a.MP4.part":
            self.assertIn(word, arguments)


class Encoded(Movie):
    def test_webm_plays(self):
        self.plays("a.webm", "vp9")

    def test_mp4_plays(self):
        self.plays("a.mp4", "h264")

    @unittest.skipUnless(FFMPEG and FFPROBE, "SKIPPED: there is no ffmpeg (package ffmpeg)")
    def plays(self, name, codec):
        self.good(*self.press(0.4, "--movie", name, "--slow", "2", "-o", "here"))
        probe = [FFPROBE, "-v", "error", "-count_frames", "-show_streams", "-of", "json", name]
        streams = json.loads(subprocess.run(probe, cwd=self.folder, check=True, capture_output=True).stdout)
        video, = streams["streams"]
        self.assertEqual(video["codec_name"], codec)
        self.assertEqual((video["width"], video["height"]), (WIDTH, HEIGHT))
        self.assertEqual(video["nb_read_frames"], "20")
        self.assertEqual(video["r_frame_rate"], "25/1")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
