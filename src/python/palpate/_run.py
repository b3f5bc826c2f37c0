"""`palpate.run`, `palpate.resume` and `palpate.movie`: runs with files, as the program makes them."""
from __future__ import annotations

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _palpate
from ._palpate import Scene, load

INCLUDED = Path(__file__).absolute().parent / "scenes"


@dataclass(frozen=True)
class Run:
    """Result of a run: its summary and its files."""

    folder: Path | None  #: folder of the files; None: the run wrote no file
    summary: dict[str, Any]  #: content of summary.json; docs/files.md lists its keys
    files: list[Path]  #: files that the run wrote; of frames, their folder
    missing: list[str]  #: requested outputs that could not be written, each with the reason

    @property
    def outcome(self) -> str:
        """"finished", or "interrupted" by a signal whose handler raised no exception."""
        return str(self.summary["outcome"])

    @property
    def remarks(self) -> list[str]:
        """Warnings, limits of the result and events, one text per remark."""
        return list(self.summary["remarks"])


def _run_of(result: dict[str, Any]) -> Run:
    return Run(Path(result["folder"]) if result["folder"] else None, json.loads(result["summary"]),
               [Path(file) for file in result["files"]], result["missing"])


def _scene_of(scene: Scene | str | os.PathLike[str]) -> Scene:
    if isinstance(scene, Scene):
        return scene
    included = INCLUDED / f"{os.fspath(scene)}.toml"
    return load(included if not os.path.exists(scene) and included.is_file() else scene)


def run(scene: Scene | str | os.PathLike[str], *, folder: str | os.PathLike[str] = "",
        duration_s: float = 0.0, picture: bool = False, contact_picture: bool = False, frames: bool = False,
        frames_per_s: float = 0.0, movie: str | os.PathLike[str] = "", fps: float = 0.0, slow: float = 1.0,
        size: str = "", shade: str = "displacement", report: bool = False, trace: bool = False,
        passivity: str = "off", real_time: bool = False, against_monolithic: bool = False,
        checkpoint_every_s: float = 0.0, hands: Any = None) -> Run:
    """Runs a scene and writes the files of `palpate run`, whose options have the same meaning.

    `scene` is a Scene, a file or the name of an included scene; `folder` is by default out/NAME, if the scene
    records or an option requests anything.  `hands` is a function that moves the first hand, or a dict of
    hand names and functions, as for Simulation; in real time, it has to return within a tick.  Raises Error
    for invalid input, and IntegratorError if the integrator fails; the files are then complete up to the
    failure.
    """
    options = _palpate._RunOptions()
    for name, value in {**locals(), "folder": os.fspath(folder), "movie": os.fspath(movie)}.items():
        if name not in ("scene", "options", "hands"):
            setattr(options, name, value)
    return _run_of(_palpate._run(_scene_of(scene), options, hands))


def resume(folder: str | os.PathLike[str]) -> Run:
    """Continues an interrupted run from its last checkpoint, with its original options.

    The results are bitwise identical to those of an uninterrupted run.  Returns a finished run as it is.
    Raises Error if there is no checkpoint, or if the scene, its meshes or the version of palpate has changed
    since.
    """
    return _run_of(_palpate._resume(os.fspath(folder)))


def movie(run: str | os.PathLike[str], file: str | os.PathLike[str] = "", *, fps: float = 0.0,
          slow: float = 1.0, size: str = "", shade: str = "displacement") -> Path:
    """Draws a movie of a finished run from its recorded states, as `palpate movie`; returns its path.

    `run` is the folder of the run; `file` ends in .webm, .png or .apng, and is by default movie.png in that
    folder.  Raises Error if the run recorded no states or the movie cannot be written.
    """
    return Path(_palpate._movie(os.fspath(run), os.fspath(file), fps, slow, size, shade))
