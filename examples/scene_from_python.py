"""Builds a scene from Python and runs it: a soft block comes to rest on a floor.

At rest the floor carries the weight m g, and the penetration is rho g h / k, where k is the stiffness of
contact per area. With half the stiffness the penetration is twice as large."""
import palpate  # before NumPy, so that OpenBLAS starts as in the program

DENSITY, HEIGHT, GRAVITY = 1000.0, 0.05, 9.81  # [kg/m^3], [m], [m/s^2]
STIFFNESS = 5e7  # [Pa/m]

# The dict has the shape of a scene's TOML file; `palpate list keys` prints every key.
scene = palpate.Scene({
    "scene": {"name": "a block on a floor", "duration_s": 0.5, "gravity_m_s2": [0.0, 0.0, -GRAVITY]},
    "body": [{
        "name": "block",
        "mesh": {"generator": "box", "size_m": [HEIGHT, HEIGHT, HEIGHT], "element_size_m": 0.0125},
        "position_m": [0.0, 0.0, HEIGHT / 2],
        "density_kg_m3": DENSITY,
        "youngs_modulus_pa": 5e4,
        "poissons_ratio": 0.4,
        "stiffness_damping_s": 0.01,
    }],
    "obstacle": [{"name": "floor", "type": "plane"}],
    "contact": [{"between": ["block", "floor"], "stiffness_pa_m": STIFFNESS}],
    "integrator": {"name": "backward-euler", "step_s": 5e-3},
})

for stiffness in (STIFFNESS, STIFFNESS / 2):
    scene.set("contact.0.stiffness_pa_m", stiffness)
    simulation = palpate.Simulation(scene)
    simulation.run()
    # Arrays have one row per contact sample; a negative gap is penetration.
    contact = simulation.contact
    depth = -(contact.gaps * contact.areas).sum() / contact.areas.sum()
    print(f"at {stiffness:g} Pa/m: force {contact.forces[:, 2].sum():.6g} N, "
          f"by theory {DENSITY * HEIGHT**3 * GRAVITY:.6g} N; "
          f"penetration {depth:.6g} m, by theory {DENSITY * GRAVITY * HEIGHT / stiffness:.6g} m")
