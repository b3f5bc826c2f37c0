"""Haptic rendering of soft bodies from Python: SI units, arrays with one row per point.

Step a scene, and read its state as NumPy arrays without copies:

    import palpate
    simulation = palpate.Simulation(palpate.load("scenes/press-ball.toml"))
    simulation.advance(0.2)
    print(simulation.force, simulation.body("ball").positions)

Move the hand by a function, which is called once per tick:

    def hand(time, force, torque):
        return 0.0, 0.0, 0.082 - 0.05 * time
    simulation = palpate.Simulation(palpate.load("scenes/press-ball.toml"), hands=hand)

Run a scene with the files of `palpate run`, in virtual or in real time:

    run = palpate.run("press-ball", folder="out", picture=True)

Scenes        load, Scene, new_scene (a scene that touches a mesh), make_model (models of surfaces)
Simulations   Simulation, and its Body, Bone, Hand, Contact; HandlePose for a function that moves a hand
Runs          run, resume, movie; Run
Live          touch (a scene in a cell of a notebook, whose tool the mouse moves); Touch
Studies       compare, validate; Comparison, Measurement
Errors        Error (invalid input), IntegratorError (a step failed)

palpate.plot has charts (Matplotlib) and palpate.device a peer for [device] type = "udp"; import them
separately.  docs/python.md has examples.
"""
from ._blas import settings_of_the_program

with settings_of_the_program():
    from ._palpate import (Body, Bone, Contact, Error, Hand, HandlePose, IntegratorError, Measurement, Scene,
                           Simulation, load, validate)

from ._compare import Comparison, compare
from ._model import make_model, new_scene
from ._run import Run, movie, resume, run
from ._touch import Touch, touch

__all__ = ["Body", "Bone", "Comparison", "Contact", "Error", "Hand", "HandlePose", "IntegratorError",
           "Measurement", "Run", "Scene", "Simulation", "Touch", "compare", "load", "make_model", "movie",
           "new_scene", "resume", "run", "touch", "validate"]
