"""Compare the whole curves: the reaction that YADE records while the support moves, and the reaction along the path of the prediction.

YADE's joints may be stiffer. So the settlements of the path are scaled to those at which YADE's joints strain as much, or have released as
much. The verdict depends on the plateaus alone. Curves differ if inertia matters or another joint yields first. If YADE's plateau differs
from the prediction, an earlier part of its curve may agree with the prediction.
"""

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from comparison.numbers import settlement_text
from comparison.yade import Results
from la_core.exchange import LATEST_START

LEAST_STRETCH = 0.2  # of the settlement at the start of the plateau: least length of a level, so that two rows at rest do not count


@dataclass(frozen=True)
class CurveDifference:
    """The difference between YADE's recorded reaction and the curve of the prediction.

    Attributes
    ----------
    largest : float
        Largest size of the difference, N or N m.
    settlement : float
        Settlement at which it occurs, m or rad.
    mean : float
        Mean size of the difference over the settlement, N or N m.
    until : float
        Settlement up to which both curves are known, m or rad.
    """

    largest: float
    settlement: float
    mean: float
    until: float


def compare_curves(results: Results) -> CurveDifference | None:
    """Return the difference of both curves over the settlements that they have in common; None if one of them does not exist.

    It is also None if the stiffness of YADE's joints is undefined, because the path cannot be scaled to it.
    """
    coulomb, run = results.analysis.coulomb, results.run
    if coulomb is None or run is None or len(coulomb.path_settlement) < 2 or math.isnan(results.stiffening):
        return None
    settlement, reaction = run.settling("settlement"), run.settling("reaction")
    path = coulomb.path_settlement / results.prediction_scale
    shared = (settlement >= path[0]) & (settlement <= path[-1]) & np.isfinite(reaction)
    at, size = settlement[shared], reaction[shared]
    if len(at) < 2 or not at[-1] > at[0]:
        return None
    apart = np.abs(size - np.interp(at, path, coulomb.path_value))
    worst = int(np.argmax(apart))
    mean = float(np.sum((apart[1:] + apart[:-1]) / 2.0 * np.diff(at)) / (at[-1] - at[0]))
    return CurveDifference(float(apart[worst]), float(at[worst]), mean, float(at[-1]))


def curves_summary(results: Results) -> dict[str, Any] | None:
    """Return the difference of the curves by name, or None without a difference."""
    found = compare_curves(results)
    return None if found is None else dataclasses.asdict(found)


def earlier_agreement(results: Results, value: float, tolerance: float) -> str:
    """Return a sentence on the settlements before the plateau at which YADE's reaction was within a tolerance of a predicted value.

    It is "" without such settlements.

    The longest stretch of the settlement counts. It must be long enough for a plateau, whose line begins at LATEST_START of its settlement
    at the latest. A steep curve has no such stretch; a curve that passes the value slowly may have one.

    value, tolerance: N, or N m; without unit for a multiplier.
    """
    scene, run = results.scene, results.recorded
    settlement, reaction = run.settling("settlement"), run.settling("reaction")
    near = (np.abs(reaction - value) <= tolerance) & (settlement < run.result.plateau_start)
    edges = np.flatnonzero(np.diff(near, prepend=False, append=False))  # the first row of a stretch, and the first after it, in turn
    first, last = settlement[edges[::2]], settlement[edges[1::2] - 1]
    is_long = (first <= LATEST_START * last) & (last - first >= LEAST_STRETCH * run.result.plateau_start)
    if not is_long.any():
        return ""
    longest = int(np.argmax(np.where(is_long, last - first, 0.0)))
    begin, end = (settlement_text(place[longest], scene.settlement_unit) for place in (first, last))
    return f"Before its plateau, from {begin} to {end}, YADE's {scene.quantity} was within the tolerance of the prediction."
