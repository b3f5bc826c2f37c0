#!/usr/bin/env python3
"""Measures the page of `palpate touch` in a headless Chromium that draws on the processor (SwiftShader).

    benchmarks/touch_page.py PROGRAM... [--scene NAME] [--seconds S] [--rounds N] [--widths W...]

A viewer without a picture holds the handle and strokes the body with the tool. In each round, every program
runs in turn with the page closed and then open at each width, S seconds each. Measured are the frames per
second that the page draws and the CPU time of the browser per frame, and the lateness of the ticks with the
page open and closed. Medians over the rounds are printed as a table in Markdown, with the least and the
largest value.
"""
import argparse
import math
import os
import statistics
import sys
import threading
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parent / "tests/cli"), str(HERE.parent / "tests/live")]

import browser  # noqa: E402
from touch_client import Server  # noqa: E402

STROKE_M, PERIOD_S, MESSAGES_HZ = 0.02, 2.0, 100.0
HEIGHT_PX, WARM_UP_S = 800, 3.0
TICKS_PER_S = os.sysconf("SC_CLK_TCK")


class Hand(threading.Thread):
    """Holds the handle of a server, presses it into the body and strokes. Keeps the states."""

    def __init__(self, server):
        super().__init__(daemon=True)
        self.viewer, self.ended = server.viewer(), False
        self.viewer.until(lambda: self.viewer.frames, 120)
        first = self.viewer.frames[-1]
        self.start_m = first["hands"][0]["pose"][:3]
        nodes = [x[i:i + 3] for x in first["bodies"] for i in range(0, len(x), 3)]
        self.touch_m = min(nodes, key=lambda node: math.dist(node, self.start_m))
        self.viewer.read_frame = lambda data: None  # taken apart by Python, a frame costs more than to draw
        self.viewer.send(type="take")

    def target(self, time_s):
        """Returns a position: presses the nearest node of the bodies and retreats, in a circle [m]."""
        turn = 2 * math.pi * time_s / PERIOD_S
        share = 0.9 - 0.4 * math.cos(turn)
        x, y, z = (a + share * (b - a) for a, b in zip(self.start_m, self.touch_m))
        return [x + STROKE_M * math.sin(turn / 3), y, z + STROKE_M * math.cos(turn / 3)]

    def run(self):
        began = time.monotonic()
        while not self.ended:
            try:
                self.viewer.listen(1 / MESSAGES_HZ)
            except ConnectionError:
                return  # the server has ended
            self.viewer.frames.clear()
            self.viewer.send(type="handle", position=self.target(time.monotonic() - began),
                             rotation=[1, 0, 0, 0])

    def states_of(self, seconds):
        self.viewer.states.clear()
        time.sleep(seconds)
        return list(self.viewer.states)


def cpu_seconds(root):
    """Returns the CPU time of a process and all processes below it [s]."""
    parents, spent = {}, {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            fields = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue  # it has ended
        parents[int(folder.name)] = int(fields[1])
        spent[int(folder.name)] = (int(fields[11]) + int(fields[12])) / TICKS_PER_S
    below = {root}
    while new := {one for one, parent in parents.items() if parent in below} - below:
        below |= new
    return sum(spent[one] for one in below)


def lateness(states):
    """Returns the median share of late ticks, their 99th percentile [us], and the skipped ticks."""
    return (statistics.median(one["late_share"] for one in states),
            1e6 * statistics.median(one["late_p99_s"] for one in states),
            states[-1]["skipped_ticks"] - states[0]["skipped_ticks"])


def measure_open(server, hand, width, seconds):
    """Returns frames per second, CPU per frame [ms], CPU [share], and the lateness, with the page open."""
    tab = browser.Browser()
    try:
        tab.size(width, HEIGHT_PX)
        tab.open(f"http://127.0.0.1:{server.port}/?token={server.token}")
        tab.wait_for("window.palpateTest && palpateTest.frames() > 10", 120)
        time.sleep(WARM_UP_S)
        frames, cpu, began = tab.value("palpateTest.frames()"), cpu_seconds(tab.process.pid), time.monotonic()
        states = hand.states_of(seconds)
        frames = tab.value("palpateTest.frames()") - frames
        passed, cpu = time.monotonic() - began, cpu_seconds(tab.process.pid) - cpu
        return frames / passed, 1e3 * cpu / max(1, frames), cpu / passed, *lateness(states)
    finally:
        tab.close()


def measure(program, scene, widths, seconds):
    """Returns {"closed" or width: figures} of one program."""
    with Server(program, scene) as server:
        hand = Hand(server)
        hand.start()
        time.sleep(WARM_UP_S)
        out = {"closed": (0.0, 0.0, 0.0, *lateness(hand.states_of(seconds)))}
        for width in widths:
            out[width] = measure_open(server, hand, width, seconds)
        hand.ended = True
        hand.join()
        return out


def text_of(values, digits):
    low, middle, high = (f"{one:.{digits}f}" for one in (min(values), statistics.median(values), max(values)))
    return middle if low == high else f"{middle} ({low} to {high})"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("programs", nargs="+", metavar="PROGRAM", type=Path)
    parser.add_argument("--scene", default="touch-head")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--widths", type=int, nargs="+", default=[1280, 400])
    arguments = parser.parse_args()
    found = {}
    for _ in range(arguments.rounds):
        for program in arguments.programs:
            measured = measure(program.resolve(), arguments.scene, arguments.widths, arguments.seconds)
            for page, figures in measured.items():
                found.setdefault((str(program), page), []).append(figures)
    print("| program | page | frames/s | CPU per frame [ms] | processors used | late ticks [%] | "
          "lateness, 99 % [us] | skipped ticks |\n|---|---|---|---|---|---|---|---|")
    for (program, page), rounds in found.items():
        columns = list(zip(*rounds))
        columns[3] = [100 * one for one in columns[3]]
        texts = [text_of(one, digits) for one, digits in zip(columns, (1, 1, 2, 2, 0, 0))]
        if page == "closed":
            texts[:3] = ["-"] * 3
        print(f"| {program} | {page if page == 'closed' else f'{page} px'} | {' | '.join(texts)} |")


if __name__ == "__main__":
    main()
