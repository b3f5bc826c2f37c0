"""Charts by Matplotlib: `from palpate import plot`."""
from __future__ import annotations

from typing import TYPE_CHECKING

from . import Comparison, Simulation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_LABELS = {"position_error_rel_l2": "position error, relative to the deformation",
           "force_error_rms_n": "RMS error of the force on the hand [N]",
           "torque_error_rms_n_m": "RMS error of the torque on the hand [N m]"}


def _axes(axes: Axes | None) -> Axes:
    if axes is not None:
        return axes
    try:
        from matplotlib import pyplot
    except ImportError as missing:
        raise ImportError("palpate.plot needs Matplotlib (Debian's python3-matplotlib, or pip install "
                          "matplotlib)") from missing
    return pyplot.subplots(layout="constrained")[1]


def force(simulation: Simulation, hand: str = "tool", axes: Axes | None = None) -> Axes:
    """Force on a hand over time: its three components and its magnitude.  Returns the axes."""
    axes = _axes(axes)
    felt = simulation.hand(hand)
    for component, name in zip(felt.forces.T, "xyz"):
        axes.plot(felt.times, component, label=name, linewidth=1)
    axes.plot(felt.times, (felt.forces ** 2).sum(axis=1) ** 0.5, label="magnitude", color="black")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("force on the hand [N]")
    axes.legend()
    return axes


def work_precision(comparison: Comparison, error: str = "position_error_rel_l2",
                   axes: Axes | None = None) -> Axes:
    """Error over run time, one line per label, without points that have no error.  Returns the axes."""
    axes = _axes(axes)
    labels, cost, errors = comparison["label"], comparison.cost, comparison[error]
    for label in dict.fromkeys(labels):
        shown = (labels == label) & (errors > 0) & (cost > 0)
        if shown.any():
            axes.loglog(cost[shown], errors[shown], marker="o", markersize=4, label=str(label))
    axes.set_xlabel("CPU time [s]")
    axes.set_ylabel(_LABELS.get(error, error))
    axes.legend(fontsize="small")
    return axes
