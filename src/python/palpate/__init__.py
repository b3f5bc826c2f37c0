"""palpate from Python: load a scene or build one, step it, look at it, run it
with its files, compare integrators.

    import palpate
    simulation = palpate.Simulation(palpate.load("scenes/press-ball.toml"))
    simulation.advance(0.2)
    print(simulation.force, simulation.body("ball").positions)
    run = palpate.run("press-ball", folder="out", picture=True)

SI units throughout; positions are arrays with one row per point.  docs/python.md is the page to begin with.
`palpate.plot` has charts (Matplotlib), and is imported only where it is asked for.
"""
from ._blas import settings_of_the_program

with settings_of_the_program():
    from ._palpate import (Body, Contact, Error, Hand, IntegratorError, Measurement, Scene, Simulation, load,
                           validate)

from ._compare import Comparison, compare
from ._run import Run, movie, resume, run

__all__ = ["Body", "Comparison", "Contact", "Error", "Hand", "IntegratorError", "Measurement", "Run", "Scene",
           "Simulation", "compare", "load", "movie", "resume", "run", "validate"]
