"""Scenes, simulations and studies of palpate; SI units, arrays of one row a point."""
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float64]
_Integers = npt.NDArray[np.int32]

class Error(ValueError):
    """A scene, a name or a value is refused; the message says what, where, and what to do."""

class IntegratorError(RuntimeError):
    """An integrator gave up; the state is its last good one."""

class Scene:
    """A scene: what a TOML file says, or a dict of the same shape."""
    def __init__(self, tables: Mapping[str, Any], folder: str | os.PathLike[str] = "") -> None: ...
    @staticmethod
    def parse(text: str, path: str = "scene", changes: Sequence[str] = ...) -> Scene:
        """A scene from the text of a TOML file; meshes are looked for in the folder of `path`."""
    def set(self, path: str, value: Any) -> None:
        """Changes one key by its dotted path, as --set does."""
    def copy(self) -> Scene:
        """Another one, to be changed by itself."""
    def set_all(self, values: Mapping[str, Any]) -> None:
        """Changes several keys, {path: value}, that are checked together."""
    @property
    def name(self) -> str: ...
    @property
    def path(self) -> str: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def toml(self) -> str:
        """The scene as TOML, changes applied."""
    @property
    def text(self) -> str:
        """The TOML before changes."""
    @property
    def changes(self) -> list[str]:
        """What set() was told, as PATH=VALUE."""
    @property
    def not_carried_over(self) -> list[str]:
        """Keys that are left out, as what set() names has no use for them."""

def load(path: str | os.PathLike[str]) -> Scene:
    """Reads and checks a scene file (TOML)."""

class Body:
    """One body of a simulation.  Nodes are in the order of the state, not of the mesh's file."""
    @property
    def name(self) -> str: ...
    @property
    def positions(self) -> _Floats:
        """Of the nodes, in the world, (n, 3) [m]: a view that follows the simulation."""
    @property
    def velocities(self) -> _Floats:
        """Of the nodes, (n, 3) [m/s]: a view that follows the simulation."""
    @property
    def rest_positions(self) -> _Floats:
        """Of the nodes at the start, in the world, (n, 3) [m]."""
    @property
    def masses(self) -> _Floats:
        """Lumped, (n,) [kg]."""
    @property
    def forces(self) -> _Floats:
        """Sum of all forces on each node as it is now, (n, 3) [N]; computed when it is asked for."""
    @property
    def tetrahedra(self) -> _Integers:
        """Node numbers, (m, 4)."""
    @property
    def file_node(self) -> _Integers:
        """Number of each node in the mesh's file, (n,): out[file_node] = values reorders."""
    @property
    def has_skin(self) -> bool:
        """Whether the surface is a skin's, else that of the tetrahedra."""
    @property
    def surface_faces(self) -> _Integers:
        """Of the surface that is touched and drawn: vertex numbers, (k, 3)."""
    @property
    def surface_positions(self) -> _Floats:
        """Of that surface's vertices as they are now, (v, 3) [m]; computed when it is asked for."""

class Hand:
    """What one hand did and felt, a row a tick, so far."""
    @property
    def name(self) -> str: ...
    @property
    def times(self) -> _Floats:
        """At each tick's end, (t,) [s]."""
    @property
    def forces(self) -> _Floats:
        """On the hand, as the device gives them, (t, 3) [N]."""
    @property
    def torques(self) -> _Floats:
        """On the hand, (t, 3) [N m]."""
    @property
    def handle_positions(self) -> _Floats:
        """(t, 3) [m]."""
    @property
    def tool_positions(self) -> _Floats:
        """Of the tool's origin, (t, 3) [m]."""
    @property
    def force(self) -> _Floats:
        """At the last tick, (3,) [N]; zero before the first."""
    @property
    def torque(self) -> _Floats:
        """At the last tick, (3,) [N m]; zero before the first."""
    def __len__(self) -> int: ...

class Contact:
    """The contact samples of the last query at the state when they were asked for, a row a sample."""
    @property
    def positions(self) -> _Floats:
        """On the surface that normals push away, (s, 3) [m]."""
    @property
    def opposite_positions(self) -> _Floats:
        """On the other surface, (s, 3) [m]."""
    @property
    def normals(self) -> _Floats:
        """Unit vectors, (s, 3)."""
    @property
    def gaps(self) -> _Floats:
        """(s,) [m]; negative is penetration."""
    @property
    def areas(self) -> _Floats:
        """(s,) [m^2]."""
    @property
    def pressures(self) -> _Floats:
        """(s,) [Pa]; 0 where it is apart."""
    @property
    def forces(self) -> _Floats:
        """Pressure times area along the normal, (s, 3) [N]; without friction."""
    @property
    def pairs(self) -> _Integers:
        """Which [[contact]] of the scene, (s,)."""
    def __len__(self) -> int: ...

class Simulation:
    """A scene that is simulated in virtual time, period by period."""
    def __init__(self, scene: Scene, duration_s: float = 0.0) -> None: ...
    def step(self) -> bool:
        """Goes through one period of the scene's loop.  False at the end, where nothing is done."""
    def advance(self, seconds: float) -> None:
        """Steps until so much simulated time has passed, or to the end."""
    def run(self) -> None:
        """Steps to the end."""
    @property
    def time(self) -> float:
        """Simulated so far [s]."""
    @property
    def duration(self) -> float:
        """Of the whole [s]."""
    @property
    def finished(self) -> bool: ...
    @property
    def bodies(self) -> list[Body]: ...
    def body(self, name: str) -> Body:
        """The body of that name."""
    def hand(self, name: str = "tool") -> Hand:
        """What the hand with that tool did and felt."""
    @property
    def force(self) -> _Floats:
        """On the first hand at the last tick, (3,) [N]."""
    @property
    def torque(self) -> _Floats:
        """On the first hand at the last tick, (3,) [N m]."""
    @property
    def contact(self) -> Contact:
        """The contact samples now."""
    @property
    def counters(self) -> dict[str, float]:
        """Counts and times [s] of the run so far, by name."""

class Measurement:
    """One measured quantity of a case with a known answer."""
    @property
    def case(self) -> str: ...
    @property
    def quantity(self) -> str: ...
    @property
    def computed(self) -> float: ...
    @property
    def exact(self) -> float: ...
    @property
    def error(self) -> float: ...
    @property
    def bar(self) -> float: ...
    @property
    def order(self) -> float: ...
    @property
    def passed(self) -> bool: ...

def validate(cases: Sequence[str]) -> list[Measurement]:
    """Runs cases with a known answer by their names."""

def compare_into(folder: str, scene: Scene, integrators: Sequence[str], limit_s: float,
                 reference_limit_s: float, repeats: int, jobs: int, linear_solver: str) -> dict[str, Any]: ...
