"""The greatest live load on the way to a plateau: friction may lock a thrust in, and the structure carries more until blocks slip.

Both methods follow the motion of the blocks. Their answer is the plateau, the load that keeps the blocks moving. Their curves may have a
peak before it. Under a load that only grows, as on a tilting table, a structure stands up to this peak. Limit analysis gives the peak with
an uncertainty. In a run of YADE inertia raises the record while blocks gain speed, so its greatest value is not reliable.
"""

from typing import Any, NamedTuple

import numpy as np

from comparison.numbers import exists, format_number, with_uncertainty
from comparison.yade import Results
from la_core.coulomb import peak_before
from la_core.exchange import UNCERTAIN
from la_core.limit import Status
from la_core.scene import tilt_angles

# Least excess of a peak, as a share of the multiplier. On 36 small structures the drag of the usual paths raised the peak by up to 4 %, and
# inertia in YADE by up to 8 %. Both effects vanished with a hundredth of the drag and an eighth of the speed. So YADE's greatest load is
# reported only together with that of limit analysis. On large structures, whose peak is unknown, drag may add more, as the sentence says.
LEAST_MORE = 0.05
LEAST_MULTIPLIER = 0.01  # the excess over a smaller multiplier is relative to this value


class _Way(NamedTuple):
    """Greatest multiplier of one method on the way to its plateau; its uncertainty is NaN if drag or inertia may have raised it."""

    greatest: float
    uncertainty: float = float("nan")


def greatest_load_summary(results: Results) -> dict[str, Any] | None:
    """Return the greatest multiplier by method, and a sentence on it; None if no method has one clearly above its plateau.

    The peak of limit analysis is reported if it is above the plateau by more than both uncertainties and UNCERTAIN. A greatest multiplier
    without an uncertainty (of YADE, or of a large structure) must be above its plateau by more than LEAST_MORE and the uncertainty of the
    plateau. A multiplier above the associated bound is left out, because no equilibrium exists there. YADE's multiplier is reported only
    together with that of limit analysis.
    """
    analysis, run = results.analysis, results.run
    if analysis.scene.live is None:
        return None
    bound, coulomb, ways = analysis.bounds[analysis.main], analysis.coulomb, dict[str, _Way | None]()
    most = bound.value if bound.status is Status.SOLVED else np.inf
    if coulomb is not None and len(coulomb.peak):
        ways["limit_analysis"] = _of_peak(coulomb.peak, coulomb.value, coulomb.uncertainty, most)
    elif coulomb is not None and len(coulomb.path_value):
        ways["limit_analysis"] = _of_curve(coulomb.path_value, coulomb.value, coulomb.uncertainty, most)
    if run is not None and run.status == "plateau" and ways.get("limit_analysis"):
        ways["yade"] = _of_curve(run.settling("reaction"), run.reaction, run.uncertainty, most)
    told = {method: way for method, way in ways.items() if way is not None}
    if not told:
        return None
    found = {method: way.greatest for method, way in told.items()}
    stated = {f"{method}_uncertainty": way.uncertainty for method, way in told.items() if exists(way.uncertainty)}
    return found | stated | {"words": _words(results, told)}


def _of_peak(known: np.ndarray, level: float, uncertainty: float, most: float) -> _Way | None:
    """Return a known peak (2,: value and uncertainty); None if it is not clearly above its plateau, or is above the bound."""
    peak, stated = known.tolist()
    more = stated + uncertainty + UNCERTAIN * max(abs(level), LEAST_MULTIPLIER)
    return _Way(min(peak, most), stated) if level + more < peak <= most + stated else None


def _of_curve(curve: np.ndarray, level: float, uncertainty: float, most: float) -> _Way | None:
    """Return the greatest value of a curve before its plateau; None if it is not clearly above the plateau, or is above the bound."""
    more = uncertainty + LEAST_MORE * max(abs(level), LEAST_MULTIPLIER)
    greatest = peak_before(curve, level, more)
    return _Way(greatest) if level + more < greatest <= most else None


def _words(results: Results, told: dict[str, _Way]) -> str:
    """Return the sentences on the meaning of the greatest multipliers."""

    def text(way: _Way) -> str:
        angles = tilt_angles(results.scene.tilt, way.greatest, way.uncertainty)
        if exists(way.uncertainty):
            angle = f" ({with_uncertainty(angles['angle'], angles['angle_uncertainty'])} degrees)" if angles else ""
            return with_uncertainty(way.greatest, way.uncertainty) + angle
        return f"about {format_number(way.greatest, 3)}" + (f" ({format_number(angles['angle'], 3)} degrees)" if angles else "")

    of_analysis = told["limit_analysis"]
    values = f"{text(of_analysis)} in limit analysis" + (f" and {text(told['yade'])} in YADE" if "yade" in told else "")
    if exists(of_analysis.uncertainty):
        stands = "By limit analysis the structure stands up to there under a load that only grows slowly from nothing"
        stands += "; inertia has a part in the value of YADE" if "yade" in told else ""
        stands += ". A shock may make it fail at any load from the plateau on."
    else:
        part = "drag and inertia have" if "yade" in told else "the drag of the path has"
        stands = f"Under a load that only grows the structure may stand up to there, but {part} a part in it, and a shock "
        stands += "may make the structure fail at any load from the plateau on."
    return f"On the way to this plateau the multiplier rose to {values}. {stands} The plateau is the load that keeps the blocks moving."
