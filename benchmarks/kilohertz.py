#!/usr/bin/env python3
"""Measures the single-rate scheme beside the partitioned one: the tables and the chart of docs/kilohertz.md.

    benchmarks/kilohertz.py PROGRAM [error] [steps] [scale] [clock] [busy] [pairs] [hand] [passive]
        [--seconds S] [--scenes NAME...] [-o FOLDER]

error   error of the force on the hand against the monolithic solution, and CPU time, by scheme
steps   time of one step by its parts, beside an exchange in every tick
scale   time of one step against the number of tetrahedra, and its growth
clock   runs in real time: lateness, work, skipped ticks
busy    the same while another process keeps one processor busy
pairs   time of one step of two bodies in contact
hand    a simulated hand that holds the device: force above 30 Hz, by stiffness of the coupling
passive friction of the device that makes small vibrations of the pressed tool passive, by frequency

Without a name all are measured. Results are printed as tables in Markdown; FOLDER receives runs and chart.
"""
import argparse
import json
import math
import statistics
import subprocess
import sys
from pathlib import Path

import numpy

SINGLE = ["exchange.scheme=single_rate", "integrator.linear_rtol=1e-2"]
BDF2 = [*SINGLE, "integrator.name=linearly-implicit-bdf2"]
EACH_TICK = ["exchange.exchange_period_s=0.001", "exchange.contact_refresh_s=0.001",
             "integrator.linear_rtol=1e-2"]
# the scene's own integrator has error control
FIXED = ["integrator.name=linearly-implicit-euler", "integrator.linear_solver=auto",
         "integrator.step_s=0.002"]
STIFF = ["body.0.youngs_modulus_pa=2e5", "tool.coupling.stiffness_n_m=1500", "tool.coupling.damping_n_s_m=9"]
# of second order: its error is a hundredth of that of the best scheme below
REFERENCE = ["exchange.scheme=monolithic", "integrator.name=implicit-midpoint", "integrator.step_s=2.5e-4",
             "integrator.linear_rtol=1e-8", "exchange.contact_refresh_s=5e-4"]
SCHEMES = {
    "partitioned, points, 10 ms": [],
    "partitioned, condensed, 10 ms": ["exchange.linearisation=condensed"],
    "partitioned, frozen, 10 ms": ["exchange.linearisation=frozen"],
    "partitioned, points, 2 ms": ["exchange.exchange_period_s=0.002", "exchange.contact_refresh_s=0.002"],
    "partitioned, frozen, 1 ms": [*EACH_TICK, "exchange.linearisation=frozen"],
    "single rate, Euler": SINGLE,
    "single rate, BDF2": BDF2,
    "single rate, BDF2, ticks of 2 ms": [*BDF2, "tool.tick_s=0.002"],
}


class Bench:
    def __init__(self, program, folder):
        self.program, self.folder, self.count, self.last = program, folder, 0, None

    def run(self, scene, changes, *options):
        """Returns the figures of a run."""
        self.count += 1
        self.last = out = self.folder / f"run-{self.count}"
        command = [self.program, "run", scene, "-o", str(out), *options]
        for change in changes:
            command += ["--set", change]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}\n{done.stderr}")
        return json.loads((out / "summary.json").read_text())["figures"]

    def best(self, scene, changes, *options, repeats=3):
        """Returns the figures of the run with the least loop time."""
        return min((self.run(scene, changes, *options) for _ in range(repeats)),
                   key=lambda figures: figures["timings"]["loop_wall_s"])


def forces(run):
    """Returns force and torque on the hand in a run's folder: times, n x 3, n x 3."""
    rows = numpy.genfromtxt(run / "force.csv", delimiter=",", names=True)
    columns = [[rows[f"{what}_{axis}_{unit}"] for axis in "xyz"]
               for what, unit in (("force", "n"), ("torque", "n_m"))]
    return rows["time_s"], *(numpy.array(one).T for one in columns)


def errors(run, reference):
    """Returns RMS and largest error of the force, and the RMS error of the torque, relative to the peaks of
    the reference, at the ticks of the run; None without torque."""
    t, *ours = forces(run)
    t_reference, *true = forces(reference)
    at = numpy.searchsorted(t_reference, t - 1e-9)
    out = []
    for mine, other in zip(ours, true):
        apart = numpy.linalg.norm(mine - other[at], axis=1)
        peak = numpy.linalg.norm(other, axis=1).max()
        if peak < 1e-9:
            return *out, None
        out += [math.sqrt((apart**2).mean()) / peak, apart.max() / peak]
    return out[0], out[1], out[2]


def table(head, rows):
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")
    print(flush=True)


def percent(value):
    return "none" if value is None else f"{100 * value:.2g} %"


def error(bench):
    """Prints the error table and draws error against CPU time."""
    points = {}
    for name, scene, changes in [("touch-human", "touch-human", []), ("touch-head", "touch-head", []),
                                 ("touch-head, E x 10, coupling x 5", "touch-head", STIFF),
                                 ("twist-ball", "twist-ball", FIXED)]:
        rows = []
        bench.run(scene, [*changes, *REFERENCE, "record.states=false"])
        reference = bench.last
        for scheme, own in SCHEMES.items():
            figures = bench.best(scene, [*changes, *own, "record.states=false"])
            force, largest, torque = errors(bench.last, reference)
            cpu = figures["timings"]["loop_cpu_s"] / figures["timings"]["simulated_s"]
            rows.append([scheme, percent(force), percent(largest), percent(torque), f"{cpu:.2f}"])
            points.setdefault(name, []).append((scheme, cpu, force))
        print(f"{name}\n")
        table(["scheme", "force error, RMS of the peak", "largest", "torque error, RMS of the peak",
               "CPU time per simulated second [s]"], rows)
    draw(points, bench.folder / "error-against-time.svg")


def draw(points, path):
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot
    pyplot.rcParams["svg.hashsalt"] = "palpate"
    figure, axes = pyplot.subplots(1, len(points), figsize=(3.6 * len(points), 3.6), sharey=True)
    for place, (name, rows) in zip(axes, points.items()):
        for i, (scheme, cpu, value) in enumerate(rows):
            single = scheme.startswith("single")
            place.loglog([cpu], [100 * value], "o" if single else "s", color=f"C{i}", markersize=8,
                         fillstyle="full" if single else "none", label=scheme)
        place.set_title(name, fontsize=9)
        place.set_xlabel("CPU time per simulated second [s]")
        place.grid(True, which="both", alpha=0.3)
    axes[0].set_ylabel("force error, RMS [% of the peak]")
    axes[-1].legend(fontsize=6, loc="lower right")
    figure.tight_layout()
    figure.savefig(path, metadata={"Date": None})
    print(f"chart: {path}\n")


def steps(bench):
    rows = []
    for scene in "touch-human", "touch-head":
        for name, changes in [("partitioned, frozen, an exchange in each tick",
                               [*EACH_TICK, "exchange.linearisation=frozen"]),
                              ("single rate", SINGLE)]:
            for threads in 1, 2:
                figures = bench.best(scene, [*changes, f"integrator.threads={threads}"], repeats=5)
                t, n = figures["timings"], figures["counts"]["steps"]
                parts = [t[key] for key in ("contact_query_s", "linearise_s", "force_s", "tangent_s",
                                            "factor_s", "solve_s", "loop_wall_s")]
                rows.append([scene, name, str(threads), *(f"{1e3 * part / n:.2f}" for part in parts)])
    table(["scene", "scheme", "threads", "query", "linearise", "forces", "tangent", "packing", "solve",
           "whole step [ms]"], rows)


def scale(bench):
    rows, sizes, times = [], [], []
    for cells in 0.0085, 0.0058, 0.004, 0.00275, 0.0019, 0.00128, 0.00088:
        row = []
        for threads in 1, 2:
            changes = [*SINGLE, f"body.0.mesh.element_size_m={cells}", f"integrator.threads={threads}",
                       "integrator.name=linearly-implicit-euler", "integrator.linear_solver=pcg-single",
                       "record.states=false"]
            figures = bench.best("press-ball", changes, "--duration-s", "0.1", repeats=2)
            tets = figures["sizes"]["tetrahedra"]
            step = figures["timings"]["loop_wall_s"] / figures["counts"]["steps"]
            row.append(step)
            if threads == 1:
                sizes.append(math.log(tets))
                times.append(math.log(step))
        rows.append([f"{tets:,}", *(f"{1e3 * step:.2f}" for step in row),
                     *(f"{1 / step:,.0f}" for step in row)])
    table(["tetrahedra", "step, one thread [ms]", "two threads [ms]", "steps per second, one thread",
           "two threads"], rows)
    exponent = statistics.linear_regression(sizes[2:], times[2:]).slope
    print(f"growth exponent from {math.exp(sizes[2]):,.0f} tetrahedra on: {exponent:.2f}\n")


def clock_row(bench, scene, threads, tick):
    changes = [*SINGLE, f"integrator.threads={threads}", f"tool.tick_s={tick}",
               "integrator.name=linearly-implicit-euler", "record.states=false"]
    figures = bench.run(scene, changes, "--realtime", "--duration-s", str(bench.seconds))
    t = figures["real_time"]
    times, force, torque = forces(bench.last)
    if not (numpy.isfinite(force).all() and numpy.isfinite(torque).all() and (numpy.diff(times) > 0).all()):
        sys.exit(f"{scene}: a force is stale or not finite")
    felt = figures.get("against_virtual_time", [{}])[0].get("force_error_rms_of_peak")
    return [scene, f"{1e3 * tick:g} ms", str(threads), str(t["ticks_timed"]), str(t["skipped_ticks"]),
            ", ".join(f"{1e3 * t[f'tick_late_{p}_s']:.2f}" for p in ("p50", "p99", "p99_9")),
            ", ".join(f"{1e3 * t[f'tick_work_{p}_s']:.2f}" for p in ("p50", "p99", "p99_9")),
            f"{1e3 * t['exchange_latency_p50_s']:.2f}", percent(felt)]


def clock(bench):
    rows = [clock_row(bench, scene, threads, tick)
            for scene, threads, tick in [("press-ball", 1, 0.001),
                                         ("touch-human", 2, 0.001), ("touch-human", 2, 0.002),
                                         ("touch-head", 2, 0.001), ("touch-head", 2, 0.002)]
            if not bench.scenes or scene in bench.scenes]
    table(CLOCK_HEAD, rows)


CLOCK_HEAD = ["scene", "tick", "threads", "ticks", "skipped", "lateness, median, 99 % and 99.9 % [ms]",
              "work, median, 99 % and 99.9 % [ms]", "handle to force, median [ms]",
              "force error of the skipped ticks, RMS of the peak"]


def busy(bench):
    spinning = subprocess.Popen([sys.executable, "-c", "while True: pass"])
    try:
        clock(bench)
    finally:
        spinning.kill()


def pairs(bench):
    rows = []
    for scene, step in ("two-pumpkins", 0.004), ("two-heads", 0.004), ("gears", 0.01):
        for threads in 1, 2:
            figures = bench.best(scene, [f"integrator.step_s={step}", f"integrator.threads={threads}",
                                         "exchange.exchange_period_s=0.02", "exchange.contact_refresh_s=0.02",
                                         "integrator.linear_rtol=1e-2", "record.states=false"])
            t, n = figures["timings"], figures["counts"]["steps"]
            rows.append([scene, f"{figures['sizes']['tetrahedra']:,}", f"{1e3 * step:g} ms", str(threads),
                         *(f"{1e3 * t[key] / n:.2f}" for key in ("contact_query_s", "force_s", "tangent_s",
                                                                 "factor_s", "solve_s", "loop_wall_s"))])
    table(["scene", "tetrahedra", "step", "threads", "query", "forces", "tangent", "packing", "solve",
           "whole step [ms]"], rows)


def hand(bench):
    rows = []
    for stiffness in 300, 1000, 3000, 10000, 30000:
        row = [f"{stiffness}"]
        for own in SCHEMES["partitioned, points, 10 ms"], SCHEMES["partitioned, frozen, 10 ms"], SINGLE, BDF2:
            changes = [*own, "device.type=hand", f"tool.coupling.stiffness_n_m={stiffness}",
                       f"tool.coupling.damping_n_s_m={math.sqrt(0.1 * stiffness):.3g}",  # half of critical
                       "device.max_force_n=100", "record.states=false"]
            figures = bench.run("touch-human", changes)
            row.append(f"{figures['hands'][0]['buzz_above_30_hz_rms_n']:.3g}")
        rows.append(row)
    table(["coupling [N/m]", "points", "frozen", "single rate, Euler", "single rate, BDF2"], rows)


def pressed(bench, scene):
    """Returns the handle's path [m] up to the largest force, and the direction of that force."""
    bench.run(scene, ["record.states=false", "device.max_force_n=1000"])
    path, force = motion(bench.last)
    at = numpy.argmax((force ** 2).sum(1))
    return path[:at + 1], force[at] / numpy.linalg.norm(force[at])


def motion(run):
    rows = numpy.genfromtxt(run / "force.csv", delimiter=",", names=True)
    return (numpy.stack([rows[f"handle_{axis}_m"] for axis in "xyz"], 1),
            numpy.stack([rows[f"force_{axis}_n"] for axis in "xyz"], 1))


PORT_HZ = numpy.array([11, 29, 64, 95, 152, 223, 331, 447])  # none mirrors another at a period of 10 ms


def write_vibration(path, direction, file):
    """Writes a recording: the path, one second of rest, then all frequencies, at 4 mm/s each.

    @returns its duration [s]"""
    k = numpy.arange(1, 5001)
    phases = numpy.random.default_rng(1).uniform(0, 2 * math.pi, len(PORT_HZ))
    way = sum(4e-3 / (2 * math.pi * f) * numpy.sin(2e-3 * math.pi * f * k + phase)
              for f, phase in zip(PORT_HZ, phases))
    way *= numpy.clip((k - 1000) / 500, 0, 1)
    points = numpy.vstack([path, path[-1] + way[:, None] * direction])
    with file.open("w") as out:
        out.write("time_s,px_m,py_m,pz_m,qw,qx,qy,qz\n")
        for i, p in enumerate(points):
            out.write(f"{1e-3 * i:.3f},{p[0]:.17g},{p[1]:.17g},{p[2]:.17g},1,0,0,0\n")
    return 1e-3 * (len(points) - 1)


def needed_friction(run, direction):
    """Returns the device's friction [N s/m] below which each vibration takes energy out of the loop.

    With x_k = Re X e^(i k theta) and F = Z X, the held force gives the hand |X|^2 Re Z (e^(-i theta) - 1) / 2
    per tick; friction b takes at least b |X|^2 (1 - cos theta) / T. Amplitudes by least squares, with a
    quadratic for what has not come to rest."""
    k = numpy.arange(-1000, 1000)
    waves = [numpy.exp(2e-3j * math.pi * f * k) for f in PORT_HZ]
    rest = [k ** 0, k / 1e3, (k / 1e3) ** 2]
    basis = numpy.stack([*(w.real for w in waves), *(-w.imag for w in waves), *rest], 1)
    n, (x, force) = len(PORT_HZ), (values[-2000:] @ direction for values in motion(run))
    fit = [numpy.linalg.lstsq(basis, values, rcond=None)[0] for values in (x, force)]
    ratio = (fit[1][:n] + 1j * fit[1][n:2 * n]) / (fit[0][:n] + 1j * fit[0][n:2 * n])
    theta = 2e-3 * math.pi * PORT_HZ
    return 1e-3 * (ratio * (numpy.exp(-1j * theta) - 1)).real / (2 * (1 - numpy.cos(theta)))


def passive(bench):
    schemes = {"partitioned, points, 10 ms": [],
               "partitioned, frozen, 10 ms": ["exchange.linearisation=frozen"],
               "partitioned, frozen, 1 ms": SCHEMES["partitioned, frozen, 1 ms"],
               "single rate, Euler": SINGLE, "single rate, BDF2": BDF2}
    for scene in "touch-human", "touch-head":
        path, direction = pressed(bench, scene)
        recording = bench.folder / f"{scene}-vibration.csv"
        duration = write_vibration(path, direction, recording)
        rows = []
        for stiffness in 1000, 10000:
            for name, own in schemes.items():
                bench.run(scene, [*own, "device.type=recording", f"device.file={recording.resolve()}",
                                  f"tool.coupling.stiffness_n_m={stiffness}",
                                  f"tool.coupling.damping_n_s_m={math.sqrt(0.1 * stiffness):.3g}",
                                  "device.max_force_n=1000", f"scene.duration_s={duration:.3f}",
                                  "record.states=false"])
                needed = needed_friction(bench.last, direction)
                rows.append([f"{stiffness}", name, *(f"{b:.3g}" for b in needed)])
        print(f"\n{scene}: friction of the device [N s/m] that each frequency needs")
        table(["coupling [N/m]", "scheme", *(f"{f} Hz" for f in PORT_HZ)], rows)


def main():
    parts = {"error": error, "steps": steps, "scale": scale, "clock": clock, "busy": busy, "pairs": pairs,
             "hand": hand, "passive": passive}
    arguments = argparse.ArgumentParser(description=__doc__,
                                        formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program")
    arguments.add_argument("what", nargs="*", choices=[[], *parts], default=[])
    arguments.add_argument("--seconds", type=float, default=10, help="duration of the runs in real time")
    arguments.add_argument("--scenes", nargs="*", default=[], help="scenes of the runs in real time")
    arguments.add_argument("-o", "--output", type=Path, default=Path("out/kilohertz"))
    chosen = arguments.parse_args()
    chosen.output.mkdir(parents=True, exist_ok=True)
    bench = Bench(chosen.program, chosen.output)
    bench.seconds, bench.scenes = chosen.seconds, chosen.scenes
    for name in chosen.what or parts:
        parts[name](bench)


if __name__ == "__main__":
    main()
