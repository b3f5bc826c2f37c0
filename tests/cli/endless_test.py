#!/usr/bin/env python3
"""`palpate run --realtime --duration inf`: until Ctrl-C, with complete files."""
import json
import os
import signal
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
from program import PROGRAM, Cli


class Endless(Cli):
    def test_it_runs_beyond_the_scene_until_it_is_stopped(self):
        run = subprocess.Popen([str(PROGRAM), "run", "press-ball", "--realtime", "--duration", "inf"],
                               cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                               env=dict(os.environ))
        self.addCleanup(run.kill)
        self.assertEqual(run.stdout.readline(), "press-ball: runs until Ctrl-C\n")
        time.sleep(3.0)
        run.send_signal(signal.SIGINT)
        out, err = run.communicate(timeout=120)
        self.assertEqual(run.returncode, 130, out + err)
        summary = json.loads((self.folder / "out/press-ball/summary.json").read_text())
        self.assertGreater(summary["figures"]["timings"]["simulated_s"], 0.5, "the scene lasts 0.4 s")
        self.assertIn("--duration-s inf --realtime", summary["command"])
        rows = (self.folder / "out/press-ball/clock.csv").read_text().splitlines()
        self.assertEqual(len(rows) - 1, summary["figures"]["real_time"]["ticks_timed"])
        self.assertIn("bitwise", self.good("replay", "out/press-ball"))

    def test_it_needs_the_wall_clock(self):
        self.assertIn("add --realtime", self.refused("run", "press-ball", "--duration-s", "inf"))
        self.assertFalse((self.folder / "out").exists())
        message = self.refused("run", "press-ball", "--realtime", "--duration", "inf", "--against-monolithic")
        self.assertIn("--against-monolithic", message)
        for value in ("-inf", "nan", "0", "forever"):
            self.assertIn("must be a positive number of seconds, or inf",
                          self.refused("run", "press-ball", f"--duration-s={value}"))


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[2:])
