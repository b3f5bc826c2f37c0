"""`palpate.compare`: error against run time, as arrays."""
from __future__ import annotations

import csv
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ._palpate import Error, Scene

if TYPE_CHECKING:
    import pandas
    from numpy.typing import NDArray


def _array(cells: list[str]) -> NDArray[Any]:
    """Cells of one column of compare.csv: numbers, yes and no, or texts.  An empty cell is no number."""
    import numpy
    if set(cells) <= {"yes", "no"}:
        return numpy.array([cell == "yes" for cell in cells])
    try:
        return numpy.array([float(cell) if cell else float("nan") for cell in cells])
    except ValueError:
        return numpy.array(cells)


class Comparison:
    """Result of a comparison: one array per column of `compare.csv`, one entry per integrator and setting.

    comparison["cpu_s_median"], or comparison.cost and comparison.error for the two that charts show.
    """

    def __init__(self, columns: dict[str, NDArray[Any]], facts: dict[str, Any]):
        self.columns = columns  #: name -> array, one entry per point
        #: "reference": its integrators in words; its own errors; "rules": how runs were repeated and limited
        self.facts = facts

    def __getitem__(self, column: str) -> NDArray[Any]:
        if column not in self.columns:
            raise KeyError(f"no column {column!r}; known are {', '.join(self.columns)}")
        return self.columns[column]

    def __len__(self) -> int:
        return len(self.columns["label"])

    @property
    def error(self) -> NDArray[Any]:
        """Error of positions, relative to the deformation; NaN for points without one."""
        return self["position_error_rel_l2"]

    @property
    def cost(self) -> NDArray[Any]:
        """CPU time of the loop, median of the repeats [s]; NaN for points without one."""
        return self["cpu_s_median"]

    def frame(self) -> pandas.DataFrame:
        """All columns as a pandas frame, one row per point."""
        try:
            import pandas
        except ImportError as missing:
            raise ImportError("Comparison.frame() needs pandas (Debian's python3-pandas, or pip install "
                              "pandas); the arrays are in Comparison.columns") from missing
        return pandas.DataFrame(self.columns)


def compare(scene: Scene, integrators: Sequence[str] = (), *, limit_s: float = 10.0,
            reference_limit_s: float = 120.0, repeats: int = 3, jobs: int = 0,
            linear_solver: str = "cholmod") -> Comparison:
    """Runs integrators over sequences of tolerances or steps against the scene's reference.

    Takes the options of `palpate compare`: `integrators` are names or labels of [[compare.ladder]], none
    means the scene's and all others; `limit_s` is in CPU seconds per point; with `jobs` 0, timed runs run
    alone.
    All runs are in separate processes, so this one is not affected.
    """
    if isinstance(integrators, str):
        integrators = [integrators]
    options = {"integrators": list(integrators), "limit_s": limit_s, "reference_limit_s": reference_limit_s,
               "repeats": repeats, "jobs": jobs, "linear_solver": linear_solver}
    order = {"text": scene.text, "path": scene.path, "changes": scene.changes, "options": options}
    package = str(Path(__file__).absolute().parents[1])  # of a link in a build, not of its target
    paths = [package, *filter(None, [os.environ.get("PYTHONPATH")])]
    with tempfile.TemporaryDirectory(prefix="palpate-compare-") as folder:
        with subprocess.Popen([sys.executable, "-B", "-m", "palpate._worker", folder], text=True,
                              stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              env={**os.environ, "PYTHONPATH": os.pathsep.join(paths)}) as worker:
            try:
                out, said = worker.communicate(json.dumps(order))
            except BaseException:
                worker.kill()  # its runs end with it
                raise
        if worker.returncode != 0:
            raise RuntimeError(f"the process of the comparison ended with {worker.returncode}: {said}")
        facts = json.loads(out)
        if "error" in facts:
            raise Error(facts["error"])
        with open(Path(folder) / "compare.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
    names = list(rows[0]) if rows else []
    return Comparison({name: _array([row[name] for row in rows]) for name in names}, facts)
