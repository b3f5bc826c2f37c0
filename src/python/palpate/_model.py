"""Layered models from surfaces, made by the program `palpate model`."""
from __future__ import annotations

import os
import subprocess
from pathlib import Path
from typing import Any

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


def make_model(surface: str | os.PathLike[str], file: str | os.PathLike[str] = "", **options: Any) -> Path:
    """Makes a layered model of a closed surface with `palpate model`, and returns the path of its file.

    `surface` is a file (OBJ, STL, PLY, ...) or a shape of the paper such as "gear"; `file` is by default
    NAME.h5 in the current folder.  `options` are those of the program, with `_` for `-`: tetrahedra=5000,
    scale=0.001, remesh=True, region=["bone=femur.obj"].  A scene uses the model as mesh = {"file": ...}.
    Raises Error if the surface or the mesh is rejected, and if the program is missing.
    """
    path = Path(file) if os.fspath(file) else Path(Path(surface).stem + ".h5")
    done = subprocess.run([program("make_model"), "model", os.fspath(surface), "-o", str(path), "--quiet",
                           *_arguments(options)], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise error_of(done.stderr, "palpate model", done.returncode)
    return path
