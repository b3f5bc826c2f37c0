"""Sets and reads states from Python: a soft ball is thrown, and stopped in flight.

Without forces, a ball whose nodes all have the velocity v moves by v t, and keeps its kinetic energy
m v^2 / 2."""
import palpate  # before NumPy, so that OpenBLAS starts as in the program
import numpy as np

SPEED, TIME = 2.0, 0.1  # [m/s], [s]

scene = palpate.Scene({
    "scene": {"name": "a ball in flight", "duration_s": 2 * TIME},
    "body": [{
        "name": "ball",
        "mesh": {"generator": "ball", "radius_m": 0.03, "element_size_m": 0.01},
        "youngs_modulus_pa": 1e4,
        "poissons_ratio": 0.4,
        "density_kg_m3": 1000.0,
    }],
    "integrator": {"name": "implicit-midpoint", "step_s": 5e-3},
    "record": {"states": False, "state_period_s": 0.01},
})
simulation = palpate.Simulation(scene, energy=True)
ball = simulation.body("ball")
start = ball.positions.copy()  # a view: it follows the simulation, and is copied to keep its values
ball.set_state(velocities=np.tile([SPEED, 0.0, 0.0], (len(start), 1)))
simulation.advance(TIME)
moved = (ball.positions - start)[:, 0]
print(f"moved by {moved.mean():.6f} m, by theory {SPEED * TIME:.6f} m; kinetic energy "
      f"{simulation.energy['kinetic_j']:.6f} J, by theory {0.5 * ball.masses.sum() * SPEED**2:.6f} J")

ball.set_state(positions=start, velocities=np.zeros_like(start))
simulation.run()
print(f"put back and stopped: moved by {np.abs(ball.positions - start).max():.1e} m in {TIME:g} s")
