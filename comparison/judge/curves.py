"""Compare the whole curves: the reaction that YADE records while the support moves, and that of the prediction's path.

YADE's joints may be stiffer: only travel over sag counts, so the path is put to the settlement at which YADE's joints strain as much.
The verdict rests on the plateaus; where the curves part, inertia matters or another joint gives way first.
"""

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from comparison.yade import Results


@dataclass(frozen=True)
class CurveDifference:
    """How far YADE's recorded reaction is from the curve of the prediction.

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
    """Return the difference of both curves from rest on, as far as both go; None where one of them does not exist.

    There is no difference either where the stiffness of YADE's joints is undefined: the path cannot be put to it.
    """
    coulomb, run = results.analysis.coulomb, results.run
    if coulomb is None or run is None or len(coulomb.path_settlement) < 2 or math.isnan(results.stiffening):
        return None
    settlement, reaction = run.settling("settlement"), run.settling("reaction")
    path = coulomb.path_settlement / results.stiffening
    shared = (settlement >= path[0]) & (settlement <= path[-1]) & np.isfinite(reaction)
    at, size = settlement[shared], reaction[shared]
    if len(at) < 2 or not at[-1] > at[0]:
        return None
    apart = np.abs(size - np.interp(at, path, coulomb.path_value))
    worst = int(np.argmax(apart))
    mean = float(np.sum((apart[1:] + apart[:-1]) / 2.0 * np.diff(at)) / (at[-1] - at[0]))
    return CurveDifference(float(apart[worst]), float(at[worst]), mean, float(at[-1]))


def curves_summary(results: Results) -> dict[str, Any] | None:
    """Return the difference of the curves by name, or None where there is none."""
    found = compare_curves(results)
    return None if found is None else dataclasses.asdict(found)
