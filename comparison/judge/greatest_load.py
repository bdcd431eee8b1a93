"""The greatest live load on the way to a plateau: friction may lock a thrust in, and the structure carries more until blocks slip.

Both methods follow the motion of the blocks. Their answer is the plateau, the load that keeps the blocks moving. A load
that only grows, as on a tilting table, makes the structure fail at its greatest value on the way. This value depends on
how the load came about and on the stiffness of the joints. A shock may make the structure fail before, at any load from
the plateau on.
"""

from typing import Any

import numpy as np

from comparison.numbers import format_number
from comparison.yade import Results
from la_core.limit import Status
from la_core.scene import tilt_angles

LEAST_MORE = 0.01  # of the multiplier: a smaller excess is no other answer
LEAST_MULTIPLIER = 0.01  # an excess over less than this is relative to this
WORDS = {"limit_analysis": "in limit analysis", "yade": "in YADE"}


def greatest_load_summary(results: Results) -> dict[str, Any] | None:
    """Return the greatest multiplier on the way by method, and a sentence on it; None where none is clearly above its plateau.

    A method whose greatest multiplier is not above its plateau by LEAST_MORE and its uncertainty is left out. No value is above the
    associated bound: no state in balance is there, and a jump of blocks may show more for a moment. Where a curve leaves its plateau, what
    comes after it does not count.
    """
    analysis, run = results.analysis, results.run
    if analysis.scene.live is None:
        return None
    bound, found = analysis.bounds[analysis.main], {}
    ways = {}
    if analysis.coulomb is not None and len(analysis.coulomb.path_value):
        ways["limit_analysis"] = (analysis.coulomb.path_value, analysis.coulomb.value, analysis.coulomb.uncertainty)
    if run is not None and run.status == "plateau":
        ways["yade"] = (run.settling("reaction"), run.reaction, run.uncertainty)
    for method, (curve, plateau, uncertainty) in ways.items():
        more = uncertainty + LEAST_MORE * max(abs(plateau), LEAST_MULTIPLIER)
        at_plateau = np.flatnonzero(np.abs(curve - plateau) <= more)
        greatest = float(curve[: at_plateau[-1]].max(initial=-np.inf)) if len(at_plateau) else float(curve.max())
        greatest = min(greatest, bound.value) if bound.status is Status.SOLVED else greatest
        if greatest > plateau + more:
            found[method] = greatest
    return found | {"words": _words(results, found)} if found else None


def _words(results: Results, found: dict[str, float]) -> str:
    """Return what the greatest multipliers mean."""

    def text(value: float) -> str:
        angles = tilt_angles(results.scene.tilt, value, float("nan"))
        return format_number(value, 3) + (f" ({format_number(angles['angle'], 3)} degrees)" if angles else "")

    values = " and ".join(f"{text(value)} {WORDS[method]}" for method, value in found.items())
    return (
        f"On the way to this plateau the multiplier rose to about {values}. A load that only grows makes the structure fail there. "
        "The plateau is the load that keeps the blocks moving; a shock may make the structure fail at any load from the plateau on."
    )
