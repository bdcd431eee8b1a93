"""Numbers of the reaction's figure: levels and interval of limit analysis, units and limits of the axes."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from comparison.numbers import POINT, SAME_STIFFNESS, force_unit, format_number
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis
from la_core.coulomb import is_changed_by_release
from la_core.limit import Drive, Solution, Status
from la_core.text_table import without_round_off

NEAR = 2.5  # times the range of all other values: a greatest reaction or an interval's end beyond is written, not drawn
PLATEAU = ("reaction", "uncertainty", "slope", "plateau_start")


@dataclass(frozen=True)
class Scales:
    """Units of the axes.

    Attributes
    ----------
    settlement : float
        SI value of the unit of the settlement, m or rad: values are divided by it.
    settlement_unit : str
        Name of that unit.
    reaction : float
        SI value of the unit of the reaction, N or N m, or 1 for a multiplier: values are divided by it.
    reaction_unit : str
        Name of that unit, "" for a multiplier.
    """

    settlement: float
    settlement_unit: str
    reaction: float
    reaction_unit: str


def has_plateau(run: Run | None) -> bool:
    """Return whether there is a run that ended on a plateau."""
    return run is not None and run.status == "plateau" and bool(np.isfinite([run.result[name] for name in PLATEAU]).all())


def obstacle_of(analysis: LimitAnalysis) -> str:
    """Return the reason why limit analysis has no reaction to draw; "" where it has one."""
    scene = analysis.scene
    status, value = analysis.bounds[analysis.main].status, analysis.main_answer.value
    if status is Status.INFEASIBLE:
        return f"Limit analysis: the structure cannot stand; no {scene.quantity} exists."
    return "" if np.isfinite(value) else f"Limit analysis ended with the status {status}; no {scene.quantity} is known."


def levels(analysis: LimitAnalysis) -> dict[str, float]:
    """Return the finite values of limit analysis, N, N m or multipliers, by name: least, sharp, greatest, coulomb, released."""
    named = {
        "least": _value(analysis.bounds, analysis.main),
        "sharp": _value(analysis.sharp.bounds, analysis.main),
        "greatest": _value(analysis.bounds, Drive.PUSHING),
    }
    if analysis.coulomb is not None:
        named["coulomb"] = analysis.coulomb.value
        if is_changed_by_release(analysis.coulomb, analysis.assembly.in_value_unit(analysis.assembly.weight)):
            named["released"] = analysis.coulomb.released
    size = _size(analysis)
    return {name: without_round_off(value, size) for name, value in named.items() if np.isfinite(value)}


def _size(analysis: LimitAnalysis) -> float:
    """Return the size beside which a value may be round-off: the weight, N, or 1 for a multiplier."""
    return 1.0 if analysis.main is Drive.LIVE else analysis.assembly.weight


def greatest_level(analysis: LimitAnalysis) -> float:
    """Return the greatest reaction, N or N m; infinite where nothing bounds it, NaN where it is unknown."""
    greatest = analysis.bounds.get(Drive.PUSHING)
    unbounded = greatest is not None and greatest.status is Status.UNBOUNDED
    return np.inf if unbounded else levels(analysis).get("greatest", np.nan)


def interval_of(analysis: LimitAnalysis) -> tuple[float, float] | None:
    """Return the Coulomb interval; either end may be infinite. None where the interval is unknown or a point."""
    if analysis.coulomb is None or np.isnan([analysis.coulomb.value, *analysis.coulomb.interval]).any():
        return None
    low, high = (without_round_off(end, _size(analysis)) for end in analysis.coulomb.interval)
    return (low, high) if high - low > POINT * abs(analysis.coulomb.value) else None


def largest_settlement(results: Results) -> float:
    """Return the largest settlement of the run, else of the path, else of the prediction's curve over its first travel, m or rad.

    It is 0 without all three. Figures cut a path or a curve that goes beyond the run.
    """
    analysis, run = results.analysis, results.run
    recorded = float(run.settling("settlement").max(initial=0.0)) if run is not None else 0.0
    followed = float(analysis.path.settlement.max(initial=0.0)) if analysis.path is not None else 0.0
    travelled = float(analysis.coulomb.path_settlement.max(initial=0.0)) if analysis.coulomb is not None else 0.0
    return recorded or followed or min(travelled, analysis.stiffness.travel)


def curve_of(results: Results, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Return settlement (P,), m or rad, and value (P,) of the prediction's curve from rest to a settlement; empty without a curve.

    Each settlement is that at which the stiffer joints of YADE's run have the same strain, or have released as much.
    """
    analysis = results.analysis
    known = analysis.coulomb is not None and len(analysis.coulomb.path_settlement) >= 2 and math.isfinite(results.stiffening)
    if analysis.coulomb is None or not known or not end > 0.0:
        return np.zeros(0), np.zeros(0)
    settlement, value = analysis.coulomb.path_settlement / results.prediction_scale, analysis.coulomb.path_value
    inside = (settlement >= 0.0) & (settlement < end)
    last = min(end, float(settlement[-1]))
    return np.append(settlement[inside], last), np.append(value[inside], np.interp(last, settlement, value))


def at_joints_of_yade(results: Results) -> str:
    """Return the end of the name of a curve that is drawn at the settlement of YADE's joints; "" for equal or unknown stiffnesses."""
    times = results.stiffening
    if math.isnan(times) or math.isclose(times, 1.0, rel_tol=SAME_STIFFNESS):
        return ""
    scene = results.scene
    motion = "displacement" if scene.live is not None else "rotation" if scene.is_rotation else "settlement"
    return f"\nat the {motion} of YADE's joints ({format_number(times, 3)} times as stiff)"


def scales_of(results: Results) -> Scales:
    """Return the units of a report: kN, or N for a light structure, and mm or mrad."""
    scene = results.scene
    divisor, name = force_unit(scene.weight, scene.unit)
    return Scales(1e-3, scene.settlement_unit, divisor, name)


def _padded(low: float, high: float) -> tuple[float, float]:
    pad = max(0.08 * (high - low), POINT * max(abs(low), abs(high))) or 0.1
    return low - pad, high + pad


def whole_limits(results: Results) -> tuple[float, float]:
    """Return the axis' limits for the whole run: zero, the record and limit analysis.

    The greatest reaction is inside only where it is near.
    """
    analysis, run = results.analysis, results.run
    lines, curve = levels(analysis), curve_of(results, largest_settlement(results))[1]
    alone = run is None and analysis.path is None and not len(curve)
    values = [value for name, value in lines.items() if name != "greatest" or alone]
    if alone and analysis.main is Drive.LIVE:  # a scale from zero on would draw levels this close as one line
        values += [value for value in interval_of(analysis) or () if np.isfinite(value)]
        return _padded(min(values, default=0.0), max(values, default=1.0))
    values += [0.0, *curve]
    if analysis.path is not None:
        values += list(analysis.path.value)
    if run is not None:
        record = run.settling("reaction")
        values += [float(value) for value in record[np.isfinite(record)]]
    far = [lines["greatest"]] if "greatest" in lines else []
    return _padded(*_with_near(values, [*far, *(interval_of(analysis) or ())]))


def plateau_limits(results: Results) -> tuple[float, float]:
    """Return the axis' limits around the fitted line, its uncertainty, the least reactions and the record's noise."""
    analysis, run = results.analysis, results.run
    values = [value for name, value in levels(analysis).items() if name != "greatest"]
    if run is not None and has_plateau(run):
        reaction, uncertainty = run.result.reaction, run.result.uncertainty
        late = run.settling("reaction")[run.settling("settlement") >= run.result.plateau_start]
        values += [reaction - 2.0 * uncertainty, reaction + 2.0 * uncertainty, *np.quantile(late, (0.02, 0.98))]
    elif analysis.path is not None:
        values += list(analysis.path.value[len(analysis.path.value) // 2 :])
    else:
        end = largest_settlement(results)
        settlement, value = curve_of(results, end)
        values += list(value[settlement >= 0.5 * end])
    return _padded(*_with_near(values, interval_of(analysis) or ()))


def _with_near(values: Sequence[float], far: Sequence[float]) -> tuple[float, float]:
    """Return the range of the values, and of each far value that does not extend it too much (NEAR)."""
    low, high = min(values, default=0.0), max(values, default=1.0)
    near = [value for value in far if max(value, high) - min(value, low) <= NEAR * (high - low)]
    return min([low, *near]), max([high, *near])


def has_sharp(analysis: LimitAnalysis) -> bool:
    """Return whether the associated answer for sharp edges differs from that at the shared inset."""
    lines = levels(analysis)
    return "sharp" in lines and not abs(lines["sharp"] - lines.get("least", np.inf)) <= POINT * abs(lines["sharp"])


def is_joint(analysis: LimitAnalysis) -> bool:
    """Return whether the Coulomb prediction equals the associated answer, as it does where no joint slides."""
    lines = levels(analysis)
    return "coulomb" in lines and abs(lines["coulomb"] - lines.get("least", np.inf)) <= POINT * abs(lines["coulomb"])


def _value(solutions: dict[Drive, Solution], drive: Drive) -> float:
    return solutions[drive].value if drive in solutions else float("nan")
