"""Models of surfaces and scenes that touch a mesh, made by the programs `palpate model` and `palpate new`."""
from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

from ._palpate import Scene, load
from ._program import error_of, program


def _arguments(options: dict[str, Any]) -> list[str]:
    """Returns options as the program's: tetrahedra=5000 is --tetrahedra 5000, remesh=True is --remesh."""
    out = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is True:
            out.append(option)
        elif value is not False and value is not None:
            for one in value if isinstance(value, (list, tuple)) else [value]:
                out += [option, str(one)]
    return out


def _call(caller: str, command: str, *arguments: str) -> None:
    """Calls a command of the program.  Raises Error with its message if it fails."""
    done = subprocess.run([program(caller), command, *arguments], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise error_of(done.stderr, f"palpate {command}", done.returncode)


def make_model(surface: str | os.PathLike[str], file: str | os.PathLike[str] = "", **options: Any) -> Path:
    """Makes a layered model of a closed surface with `palpate model`, and returns the path of its file.

    `surface` is a file (OBJ, STL, PLY, ...) or a shape of the paper such as "gear"; `file` is by default
    NAME.h5 in the current folder.  `options` are those of the program, with `_` for `-`: tetrahedra=5000,
    scale=0.001, remesh=True, region=["bone=femur.obj"].  A scene uses the model as mesh = {"file": ...}.
    Raises Error if the surface or the mesh is rejected, and if the program is missing.
    """
    path = Path(file) if os.fspath(file) else Path(Path(surface).stem + ".h5")
    _call("make_model", "model", os.fspath(surface), "-o", str(path), "--quiet", *_arguments(options))
    return path


def new_scene(mesh: str | os.PathLike[str], file: str | os.PathLike[str] = "", **options: Any) -> Scene:
    """Writes a scene in which a hand presses a round tool on a mesh, with `palpate new`, and loads it.

    `mesh` is a surface (OBJ, STL, PLY, ...), a mesh of tetrahedra (Gmsh, VTK, ...) or a shape such as "head";
    `file` is by default NAME.toml in the current folder.  `options` are those of the program, with `_` for
    `-`: unit="mm", size_m=0.2, up="y", material="silicone", tool_radius_m=0.01, force=True to overwrite.
    Each number in the file has its rule beside it; change any with Scene.set().
    Raises Error if the mesh is rejected, if the file exists, and if the program is missing.
    """
    path = Path(file) if os.fspath(file) else Path(Path(mesh).stem + ".toml")
    _call("new_scene", "new", os.fspath(mesh), "-o", str(path), *_arguments(options))
    return load(str(path))
