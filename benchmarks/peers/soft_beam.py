#!/usr/bin/env python3
"""Measures palpate and MuJoCo on one cantilever: the first table of docs/other-systems.md.

    benchmarks/peers/soft_beam.py PROGRAM [--across N ...]

A beam of 0.2 x 0.04 x 0.04 m hangs from one end and swings under a small weight.  Both programs get the same
nodes, tetrahedra, lumped masses, moduli and stiffness-proportional damping, and one thread.  The weight bends
it by a thousandth of its length, so that both materials are linear; the exact motion of the tetrahedra is
then the sum of their modes.  Contact is off.  Poisson's ratio is 0: with another one MuJoCo's body has other
moduli (findings/mujoco-flex-moduli-are-not-those-given.sh).

Needs node, npm (MuJoCo's WebAssembly build, pinned below, goes to a temporary folder), NumPy, SciPy, h5py.
Prints tables in Markdown.
"""
import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy
import scipy.sparse
import scipy.sparse.linalg

MUJOCO = "3.14.0"
LENGTH, HEIGHT = 0.2, 0.04
YOUNG, POISSON, DENSITY, DAMPING = 5e5, 0.0, 1000.0, 2e-3
GRAVITY = 0.0981
DURATION, PERIOD = 0.4, 0.01
STEPS = (0.01, 0.001)
RUNS = 2
EVEN = [(0, 4, 2, 1), (6, 2, 4, 7), (5, 4, 1, 7), (3, 1, 2, 7), (1, 2, 4, 7)]
ODD = [(4, 0, 5, 6), (2, 0, 6, 3), (1, 0, 3, 5), (7, 5, 3, 6), (0, 3, 5, 6)]


def beam(across):
    """Returns nodes [m] and tetrahedra: five in each cube, mirrored from cube to cube."""
    edge, count = HEIGHT / across, (round(LENGTH / HEIGHT) * across, across, across)
    grid = numpy.stack(numpy.meshgrid(*[numpy.arange(n + 1) for n in count], indexing="ij"), -1)
    nodes = grid.reshape(-1, 3) * edge - numpy.array([0, HEIGHT / 2, HEIGHT / 2])
    number = numpy.arange(len(nodes)).reshape(grid.shape[:3])
    tetrahedra = []
    for cell in numpy.ndindex(*count):
        corner = [number[tuple(numpy.add(cell, (c >> 2 & 1, c >> 1 & 1, c & 1)))] for c in range(8)]
        tetrahedra += [[corner[c] for c in tet] for tet in (ODD if sum(cell) % 2 else EVEN)]
    tetrahedra = numpy.array(tetrahedra)
    edges = nodes[tetrahedra[:, 1:]] - nodes[tetrahedra[:, :1]]
    inverted = numpy.linalg.det(edges) < 0
    tetrahedra[inverted] = tetrahedra[inverted][:, [0, 1, 3, 2]]
    return nodes, tetrahedra


def matrices(nodes, tetrahedra):
    """Returns stiffness and lumped masses of linear elasticity."""
    lame, shear = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)), YOUNG / (2 * (1 + POISSON))
    edges = numpy.transpose(nodes[tetrahedra[:, 1:]] - nodes[tetrahedra[:, :1]], (0, 2, 1))
    volume = numpy.linalg.det(edges) / 6
    gradient = numpy.zeros((len(tetrahedra), 4, 3))
    gradient[:, 1:] = numpy.linalg.inv(edges)
    gradient[:, 0] = -gradient[:, 1:].sum(1)
    blocks = (lame * numpy.einsum("eai,ebj->eaibj", gradient, gradient)
              + shear * numpy.einsum("eaj,ebi->eaibj", gradient, gradient)
              + shear * numpy.einsum("eak,ebk,ij->eaibj", gradient, gradient, numpy.eye(3)))
    blocks = (blocks * volume[:, None, None, None, None]).reshape(-1, 12, 12)
    dof = (3 * tetrahedra[:, :, None] + numpy.arange(3)).reshape(-1, 12)
    places = (numpy.repeat(dof, 12, axis=1).ravel(), numpy.tile(dof, (1, 12)).ravel())
    stiffness = scipy.sparse.csc_matrix((blocks.ravel(), places), shape=(3 * len(nodes), 3 * len(nodes)))
    masses = numpy.zeros(len(nodes))
    numpy.add.at(masses, tetrahedra, numpy.repeat(DENSITY * volume / 4, 4).reshape(-1, 4))
    return stiffness, masses


def exact(nodes, stiffness, masses, tip):
    """Returns the deflection of the tip [m] at each period and at rest.

    The lowest modes move as damped oscillators; the share of the others, at most a few 1e-5 of the whole, is
    taken at rest.
    """
    free = numpy.flatnonzero(nodes[:, 0] > 1e-9)
    dof = (3 * free[:, None] + numpy.arange(3)).ravel()
    reduced, mass = stiffness[dof][:, dof], numpy.repeat(masses[free], 3)
    weight = numpy.zeros(len(dof))
    weight[2::3] = -GRAVITY * masses[free]
    sag = scipy.sparse.linalg.spsolve(reduced, weight)
    square, modes = scipy.sparse.linalg.eigsh(reduced, 40, scipy.sparse.diags(mass, format="csc"), sigma=0)
    row = numpy.flatnonzero(dof == 3 * tip + 2)[0]
    share = modes[row] * (modes.T @ weight) / square
    decay = DAMPING * square / 2
    spread = numpy.sqrt((decay**2 - square).astype(complex))
    r1, r2 = -decay + spread, -decay - spread
    times = numpy.arange(round(DURATION / PERIOD) + 1) * PERIOD
    swing = [((r2 * numpy.exp(r1 * t) - r1 * numpy.exp(r2 * t)) / (r1 - r2)).real for t in times]
    moved = numpy.array([sag[row] + share @ factor for factor in swing])
    moved[0] = 0.0
    return moved, sag[row], 1 - share.sum() / sag[row]


def write_mesh(file, nodes, tetrahedra):
    with open(file, "w") as out:
        out.write(f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{len(nodes)}\n")
        out.writelines(f"{i} {x!r} {y!r} {z!r}\n" for i, (x, y, z) in enumerate(nodes.tolist(), 1))
        out.write(f"$EndNodes\n$Elements\n{len(tetrahedra)}\n")
        out.writelines(f"{i} 4 2 1 1 {a} {b} {c} {d}\n" for i, (a, b, c, d) in enumerate(tetrahedra + 1, 1))
        out.write("$EndElements\n")


SCENE = f"""[scene]
name = "beam of equal tetrahedra"
duration_s = {DURATION}
gravity_m_s2 = [0.0, 0.0, {-GRAVITY}]
[[body]]
name = "beam"
youngs_modulus_pa = {YOUNG}
poissons_ratio = {POISSON}
density_kg_m3 = {DENSITY}
stiffness_damping_s = {DAMPING}
mesh = {{ file = "beam.msh" }}
[[body.attachment]]
box_min_m = [-0.001, -0.1, -0.1]
box_max_m = [0.001, 0.1, 0.1]
[record]
state_period_s = {PERIOD}
[integrator]
"""


def run_palpate(program, folder, tip, keys):
    """Returns deflections [m], CPU seconds and steps of one run."""
    scene, out = folder / "beam.toml", folder / "out"
    scene.write_text(SCENE + "\n".join(keys) + "\n")
    subprocess.run([program, "run", scene, "-o", out], check=True, stdout=subprocess.DEVNULL)
    figures = json.loads((out / "summary.json").read_text())["figures"]
    with h5py.File(out / "run.vtkhdf") as file:
        moved = numpy.array(file["VTKHDF/PointData/displacement"])[:, 2]
    count = figures["sizes"]["nodes"]
    return moved.reshape(-1, count)[:, tip], figures["timings"]["loop_cpu_s"], figures["counts"]["steps"]


def run_mujoco(module, folder, step):
    script = Path(__file__).with_suffix(".mjs")
    command = ["node", script, module, folder / "beam.json", *map(str, (step, DURATION, PERIOD))]
    text = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    result = json.loads(text.splitlines()[-1])
    if result["version"] != MUJOCO:
        sys.exit(f"MuJoCo {result['version']} answered, not {MUJOCO}")
    return numpy.array(result["deflection"]), result["cpu_s"], result["steps"]


def measure(program, module, folder, across):
    nodes, tetrahedra = beam(across)
    stiffness, masses = matrices(nodes, tetrahedra)
    tip = int(numpy.argmin(numpy.linalg.norm(nodes - [LENGTH, 0, 0], axis=1)))
    reference, static, rest = exact(nodes, stiffness, masses, tip)
    write_mesh(folder / "beam.msh", nodes, tetrahedra)
    (folder / "beam.json").write_text(json.dumps({
        "nodes": nodes.tolist(), "tetrahedra": tetrahedra.tolist(), "masses": masses.tolist(), "tip": tip,
        "pinned": numpy.flatnonzero(nodes[:, 0] < 1e-9).tolist(), "gravity": GRAVITY, "young": YOUNG,
        "poisson": POISSON, "damping": DAMPING}))
    line, inertia = DENSITY * GRAVITY * HEIGHT**2, HEIGHT**4 / 12
    theory = line * LENGTH**4 / (8 * YOUNG * inertia) + line * LENGTH**2 / (5 / 6 * YOUNG * HEIGHT**2)
    print(f"\n{len(tetrahedra):,} tetrahedra, {len(nodes):,} nodes; at rest their tip sinks by "
          f"{-static:.4e} m, {-static / theory:.3f} of beam theory (modes left out: {rest:.1e} of it)\n")
    print("| program | method | step [ms] | error of the tip, RMS [% of the largest deflection] "
          "| CPU time per step [ms] | CPU time per simulated second [s] |\n|---|---|---|---|---|---|")
    cases = [("MuJoCo", "discrete", h, lambda h=h: run_mujoco(module, folder, h)) for h in STEPS]
    for name in ("linearly-implicit-euler", "linearly-implicit-bdf2"):
        cases += [("palpate", name, h, lambda h=h, name=name: run_palpate(
            program, folder, tip, [f'name = "{name}"', f"step_s = {h}"])) for h in STEPS]
    for rtol in (1e-3, 1e-5):
        cases.append(("palpate", f"cvode-bdf, rtol {rtol:g}", None, lambda rtol=rtol: run_palpate(
            program, folder, tip, ['name = "cvode-bdf"', f"rtol = {rtol}"])))
    peak = numpy.abs(reference).max()
    for label, method, step, run in cases:
        moved, cpu, steps = min((run() for _ in range(RUNS)), key=lambda result: result[1])
        error = numpy.sqrt(numpy.mean((moved - reference) ** 2)) / peak
        print(f"| {label} | {method} | {'chosen' if step is None else f'{1e3 * step:g}'} | {100 * error:.2g} "
              f"| {1e3 * cpu / steps:.2f} | {cpu / DURATION:.2f} |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=Path, help="the palpate program")
    parser.add_argument("--across", type=int, nargs="+", default=[4, 8], help="cubes across the height")
    arguments = parser.parse_args()
    for other in ("node", "npm"):
        if not shutil.which(other):
            sys.exit(f"{other} is missing: MuJoCo runs in it (Debian packages nodejs and npm)")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        install = ["npm", "install", "--silent", "--ignore-scripts", "--no-audit", "--no-fund"]
        subprocess.run([*install, "--prefix", folder, f"@mujoco/mujoco@{MUJOCO}"], check=True,
                       stdout=subprocess.DEVNULL)
        module = folder / "node_modules/@mujoco/mujoco/mujoco.js"
        for across in arguments.across:
            measure(arguments.program.resolve(), module, folder, across)


if __name__ == "__main__":
    main()
