"""Applies forces from Python: a bar that is fixed at one end is pulled at the other.

A force F on the face of area A stretches a bar of length L by F L / (E A)."""
import palpate  # before NumPy, so that OpenBLAS starts as in the program
import numpy as np

LENGTH, WIDTH, YOUNG, FORCE = 0.08, 0.02, 1e5, 0.5  # [m], [m], [Pa], [N]

scene = palpate.Scene({
    "scene": {"name": "a bar", "duration_s": 1.0},
    "body": [{
        "name": "bar",
        "mesh": {"generator": "box", "size_m": [LENGTH, WIDTH, WIDTH], "element_size_m": 0.01},
        "youngs_modulus_pa": YOUNG,
        "poissons_ratio": 0.0,
        "density_kg_m3": 1000.0,
        "stiffness_damping_s": 0.01,
        "attachment": [{"box_min_m": [-1.0, -1.0, -1.0], "box_max_m": [-LENGTH / 2 + 1e-6, 1.0, 1.0]}],
    }],
    "integrator": {"name": "backward-euler", "step_s": 5e-3},
    "record": {"states": False, "state_period_s": 0.01},
})
simulation = palpate.Simulation(scene, external_forces=True)
bar = simulation.body("bar")

# Shares of the nodes in the area of the face at the right end: on an edge a half, in a corner a quarter.
at_end = np.abs(bar.positions[:, 0] - LENGTH / 2) < 1e-6
on_edge = sum((np.abs(np.abs(bar.positions[:, axis]) - WIDTH / 2) < 1e-6).astype(int) for axis in (1, 2))
share = np.where(at_end, 0.5 ** on_edge, 0.0)
forces = np.zeros_like(bar.positions)
forces[:, 0] = FORCE * share / share.sum()
bar.apply_forces(forces)
simulation.run()
stretched = bar.positions[at_end, 0].mean() - LENGTH / 2
print(f"longer by {stretched:.4g} m, by theory F L / (E A) = {FORCE * LENGTH / (YOUNG * WIDTH**2):.4g} m")
