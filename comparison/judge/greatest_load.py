"""The greatest live load on the way to a plateau: friction may lock a thrust in, and the structure carries more until blocks slip.

Both methods follow the motion of the blocks. Their answer is the plateau, the load that keeps the blocks moving. Their curves may pass
a greater load. A structure under a load that only grows, as on a tilting table, may stand up to there. But the drag of a path and the
inertia of a run also lift a curve while blocks gain speed, so that its greatest value is no load to rely on.
"""

from typing import Any

import numpy as np

from comparison.numbers import format_number
from comparison.yade import Results
from la_core.limit import Status
from la_core.scene import tilt_angles

# Of the multiplier. Of 36 random structures the drag of the usual paths made up to 4 %, and inertia in YADE up to 8 %, which vanished
# with a hundredth of the drag and an eighth of the speed. So YADE's greatest load is told only beside one of limit analysis.
LEAST_MORE = 0.05
LEAST_MULTIPLIER = 0.01  # an excess over less than this is relative to this
WORDS = {"limit_analysis": "in limit analysis", "yade": "in YADE"}


def greatest_load_summary(results: Results) -> dict[str, Any] | None:
    """Return the greatest multiplier on the way by method, and a sentence on it; None where none is clearly above its plateau.

    A method whose greatest multiplier is not above its plateau by LEAST_MORE and its uncertainty is left out, and so is one whose curve
    rises above the associated bound: no state in balance is there, so its greatest load is unknown. Where a curve leaves its plateau, what
    comes after it does not count. YADE's is told only beside that of limit analysis.
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
        if plateau + more < greatest <= (bound.value if bound.status is Status.SOLVED else np.inf):
            found[method] = greatest
    return found | {"words": _words(results, found)} if "limit_analysis" in found else None


def _words(results: Results, found: dict[str, float]) -> str:
    """Return what the greatest multipliers mean."""

    def text(value: float) -> str:
        angles = tilt_angles(results.scene.tilt, value, float("nan"))
        return format_number(value, 3) + (f" ({format_number(angles['angle'], 3)} degrees)" if angles else "")

    values = " and ".join(f"{text(value)} {WORDS[method]}" for method, value in found.items())
    return (
        f"On the way to this plateau the multiplier rose to about {values}. Under a load that only grows the structure may stand up to "
        "there, but drag and inertia have a part in it, and a shock may make the structure fail at any load from the plateau on. "
        "The plateau is the load that keeps the blocks moving."
    )
