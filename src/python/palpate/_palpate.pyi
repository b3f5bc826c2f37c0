"""Scenes, simulations and studies of palpate; SI units, arrays with one row per point."""
import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

_Floats = npt.NDArray[np.float64]
_Integers = npt.NDArray[np.int32]

class Error(ValueError):
    """A scene, a name or a value is invalid; the message says what is wrong, where, and what to do."""

class IntegratorError(RuntimeError):
    """An integrator failed; the state is the last valid one."""

class Scene:
    """A scene, given by a TOML file or by a dict of the same structure."""
    def __init__(self, tables: Mapping[str, Any], folder: str | os.PathLike[str] = "") -> None: ...
    @staticmethod
    def parse(text: str, path: str = "scene", changes: Sequence[str] = ...) -> Scene:
        """A scene from the text of a TOML file; meshes are looked for in the folder of `path`."""
    def set(self, path: str, value: Any) -> None:
        """Changes one key by its dotted path, as --set does."""
    def copy(self) -> Scene:
        """An independent copy."""
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
        """Changes made by set(), as PATH=VALUE."""
    @property
    def not_carried_over(self) -> list[str]:
        """Keys that are ignored, because they do not apply to the choices made by set()."""

def load(path: str | os.PathLike[str]) -> Scene:
    """Reads and checks a scene file (TOML)."""

class Body:
    """One body of a simulation.  Nodes are in the order of the state, not of the mesh file."""
    @property
    def name(self) -> str: ...
    @property
    def positions(self) -> _Floats:
        """Positions of the nodes in the world, (n, 3) [m]: a view that follows the simulation."""
    @property
    def velocities(self) -> _Floats:
        """Velocities of the nodes, (n, 3) [m/s]: a view that follows the simulation."""
    @property
    def rest_positions(self) -> _Floats:
        """Initial positions of the nodes in the world, (n, 3) [m]."""
    @property
    def masses(self) -> _Floats:
        """Lumped masses of the nodes, (n,) [kg]."""
    @property
    def forces(self) -> _Floats:
        """Sum of all forces on each node at present, (n, 3) [N]; computed on access."""
    @property
    def tetrahedra(self) -> _Integers:
        """Node numbers of each tetrahedron, (m, 4)."""
    @property
    def file_node(self) -> _Integers:
        """Number of each node in the mesh file, (n,): out[file_node] = values reorders."""
    @property
    def has_skin(self) -> bool:
        """Whether the surface is a skin, and not the boundary of the tetrahedra."""
    @property
    def surface_faces(self) -> _Integers:
        """Faces of the surface for contact and pictures: vertex numbers, (k, 3)."""
    @property
    def surface_positions(self) -> _Floats:
        """Present positions of that surface's vertices, (v, 3) [m]; computed on access."""
    @property
    def external_forces(self) -> _Floats:
        """Forces set by apply_forces, (n, 3) [N]: a view."""
    def apply_forces(self, forces: npt.ArrayLike) -> None:
        """Sets external forces on the nodes, (n, 3) [N], that act until the next call."""
    def set_state(self, positions: npt.ArrayLike | None = None,
                  velocities: npt.ArrayLike | None = None) -> None:
        """Sets positions [m] and velocities [m/s] of the nodes, (n, 3) each; None leaves them."""

class Bone:
    """One rigid bone of a simulation; values at present, computed on access."""
    @property
    def name(self) -> str: ...
    @property
    def mass(self) -> float:
        """Mass of a free bone [kg]; 0 for a fixed or scripted one."""
    @property
    def position(self) -> _Floats:
        """Position of the origin of its axes, (3,) [m]."""
    @property
    def rotation(self) -> _Floats:
        """Orientation: unit quaternion w, x, y, z, (4,)."""
    @property
    def velocity(self) -> _Floats:
        """Velocity of the origin, (3,) [m/s]."""
    @property
    def angular_velocity(self) -> _Floats:
        """Angular velocity, (3,) [rad/s]."""
    @property
    def force(self) -> _Floats:
        """Force of the tissue on the bone, (3,) [N]."""
    @property
    def torque(self) -> _Floats:
        """Torque of the tissue about the origin, (3,) [N m]."""

class HandlePose:
    """Pose of a handle, as a function given to `Simulation(hands=...)` may return it."""
    def __init__(self, position: npt.ArrayLike, rotation: npt.ArrayLike | None = None,
                 velocity: npt.ArrayLike | None = None, angular_velocity: npt.ArrayLike | None = None,
                 switches: int = 0, valid: bool = True) -> None:
        """position [m]; rotation: unit quaternion w, x, y, z; velocities [m/s, rad/s]: None computes them."""
    @property
    def position(self) -> _Floats: ...
    @property
    def rotation(self) -> _Floats: ...
    @property
    def switches(self) -> int: ...
    @property
    def valid(self) -> bool: ...

_Move = Callable[[float, _Floats, _Floats], npt.ArrayLike | HandlePose]

class Hand:
    """Motion of one hand and force on it so far, one row per tick."""
    @property
    def name(self) -> str: ...
    @property
    def start_position(self) -> _Floats:
        """Position of the tool at the start, (3,) [m]; with start = "touching", where it touches."""
    @property
    def times(self) -> _Floats:
        """Time at the end of each tick, (t,) [s]."""
    @property
    def forces(self) -> _Floats:
        """Forces on the hand, as rendered by the device, (t, 3) [N]."""
    @property
    def torques(self) -> _Floats:
        """Torques on the hand, (t, 3) [N m]."""
    @property
    def handle_positions(self) -> _Floats:
        """Positions of the handle, (t, 3) [m]."""
    @property
    def tool_positions(self) -> _Floats:
        """Positions of the tool's origin, (t, 3) [m]."""
    @property
    def force(self) -> _Floats:
        """Force at the last tick, (3,) [N]; zero before the first."""
    @property
    def torque(self) -> _Floats:
        """Torque at the last tick, (3,) [N m]; zero before the first."""
    def __len__(self) -> int: ...

class Contact:
    """Contact samples of the last query, evaluated at the state on access: one row per sample."""
    @property
    def positions(self) -> _Floats:
        """Positions on the surface that the normals push away, (s, 3) [m]."""
    @property
    def opposite_positions(self) -> _Floats:
        """Positions on the other surface, (s, 3) [m]."""
    @property
    def normals(self) -> _Floats:
        """Unit normals, (s, 3)."""
    @property
    def gaps(self) -> _Floats:
        """Gaps, (s,) [m]; negative is penetration."""
    @property
    def areas(self) -> _Floats:
        """Areas of the samples, (s,) [m^2]."""
    @property
    def pressures(self) -> _Floats:
        """Pressures, (s,) [Pa]; 0 where the surfaces are apart."""
    @property
    def forces(self) -> _Floats:
        """Pressure times area along the normal, (s, 3) [N]; without friction."""
    @property
    def pairs(self) -> _Integers:
        """Index of the [[contact]] in the scene, (s,)."""
    def __len__(self) -> int: ...

class Simulation:
    """A scene that is simulated in virtual time, period by period."""
    def __init__(self, scene: Scene, duration_s: float = 0.0,
                 hands: _Move | Mapping[str, _Move] | None = None, external_forces: bool = False, energy: bool = False) -> None:
        """Assembles a scene.

        duration_s: 0 for the scene's.  hands: a function that moves the first hand, or a dict of hand names
        and functions; it is called once per tick as function(time, force, torque) and returns the position of
        the handle [m], or a HandlePose.  external_forces: whether Body.apply_forces can be used.  energy:
        whether the energy balance is computed in every period.
        """
    def step(self) -> bool:
        """Advances by one period of the scene's loop.  Returns False at the end, without advancing."""
    def advance(self, seconds: float) -> None:
        """Advances by this simulated time, or to the end."""
    def run(self) -> None:
        """Advances to the end."""
    @property
    def time(self) -> float:
        """Simulated time so far [s]."""
    @property
    def duration(self) -> float:
        """Duration of the whole simulation [s]."""
    @property
    def finished(self) -> bool: ...
    @property
    def bodies(self) -> list[Body]: ...
    def body(self, name: str) -> Body:
        """The body of that name."""
    @property
    def bones(self) -> list[Bone]:
        """All bones, in the order of the scene."""
    def bone(self, name: str) -> Bone:
        """The bone of that name."""
    @property
    def energy(self) -> dict[str, float]:
        """Energies and works at the end of the last period [J], by the names of energy.csv."""
    def picture(self, file: str | os.PathLike[str], shade: str = "displacement") -> Path:
        """Draws the present state to a PNG file and returns its path; shade: "displacement" or "stress"."""
    def hand(self, name: str = "tool") -> Hand:
        """Motion of a hand and force on it, by name."""
    @property
    def force(self) -> _Floats:
        """Force on the first hand at the last tick, (3,) [N]."""
    @property
    def torque(self) -> _Floats:
        """Torque on the first hand at the last tick, (3,) [N m]."""
    @property
    def contact(self) -> Contact:
        """The present contact samples."""
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
    """Runs cases with a known answer by name."""

def compare_into(folder: str, scene: Scene, integrators: Sequence[str], limit_s: float,
                 reference_limit_s: float, repeats: int, jobs: int, linear_solver: str) -> dict[str, Any]: ...

class _RunOptions:
    folder: str
    duration_s: float
    picture: bool
    contact_picture: bool
    frames: bool
    frames_per_s: float
    movie: str
    fps: float
    slow: float
    size: str
    shade: str
    report: bool
    trace: bool
    passivity: str
    real_time: bool
    against_monolithic: bool
    checkpoint_every_s: float

def _run(scene: Scene, options: _RunOptions, hands: Any = None) -> dict[str, Any]: ...
def _resume(folder: str) -> dict[str, Any]: ...
def _movie(run: str, file: str, fps: float, slow: float, size: str, shade: str) -> str: ...
