"""The numbers that the figure of the reaction shows: levels of limit analysis, its interval, and what the axes span."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from comparison.numbers import POINT
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis
from la_core.limit import Drive, Solution

NEAR = 2.5  # times the range of all other values: a greatest reaction, or an interval's end, farther than this is only named
PREFIXES = ((1e6, "M"), (1e3, "k"), (1.0, ""))
PLATEAU = ("reaction", "uncertainty", "slope", "plateau_start")


@dataclass(frozen=True)
class Scales:
    """Divisors from SI to the axes' units, and the units' names."""

    settlement: float
    settlement_unit: str
    reaction: float
    reaction_unit: str


def has_plateau(run: Run | None) -> bool:
    """Whether YADE's record has a fitted plateau."""
    return run is not None and bool(np.isfinite([run.result[name] for name in PLATEAU]).all())


def levels(analysis: LimitAnalysis) -> dict[str, float]:
    """Finite reactions of limit analysis by label."""
    named = {
        "least": _value(analysis.bounds, analysis.main),
        "sharp": _value(analysis.sharp.bounds, analysis.main),
        "greatest": _value(analysis.bounds, Drive.PUSHING),
    }
    if analysis.coulomb is not None:
        named["coulomb"] = analysis.coulomb.value
    return {name: value for name, value in named.items() if np.isfinite(value)}


def interval_of(analysis: LimitAnalysis) -> tuple[float, float] | None:
    """The Coulomb interval, an end of which may be infinite; None where it is not known or no wider than a point."""
    if analysis.coulomb is None or np.isnan([analysis.coulomb.value, *analysis.coulomb.interval]).any():
        return None
    low, high = analysis.coulomb.interval
    return (low, high) if high - low > POINT * abs(analysis.coulomb.value) else None


def largest_settlement(results: Results) -> float:
    """Largest settlement recorded or followed, m or rad; 0 where none is. A path goes on where a run has stopped: it is cut there."""
    analysis, run = results.analysis, results.run
    recorded = float(run.settling("settlement").max(initial=0.0)) if run is not None else 0.0
    return recorded or (float(analysis.path.settlement.max(initial=0.0)) if analysis.path is not None else 0.0)


def scales_of(results: Results) -> Scales:
    """Units in which the largest value and the reached settlement read well."""
    scene, analysis, run = results.scene, results.analysis, results.run
    values = [abs(value) for value in levels(analysis).values()]
    if run is not None:
        values += list(np.abs(run.settling("reaction")))
    if analysis.path is not None:
        values += list(np.abs(analysis.path.value))
    largest = max((value for value in values if np.isfinite(value)), default=1.0)
    divisor, prefix = next(((d, p) for d, p in PREFIXES if largest >= 10.0 * d), (1.0, ""))
    tiny = largest_settlement(results) < 1e-5
    length = ("µrad" if tiny else "mrad") if scene.is_rotation else ("µm" if tiny else "mm")
    return Scales(1e-6 if tiny else 1e-3, length, divisor, f"{prefix}{scene.unit}")


def _padded(low: float, high: float) -> tuple[float, float]:
    pad = max(0.08 * (high - low), POINT * max(abs(low), abs(high))) or 0.1
    return low - pad, high + pad


def whole_limits(results: Results) -> tuple[float, float]:
    """Reaction range of the whole run: zero, the record and limit analysis; the greatest reaction only where it is near."""
    analysis, run = results.analysis, results.run
    lines = levels(analysis)
    alone = run is None and analysis.path is None
    values = [value for name, value in lines.items() if name != "greatest" or alone]
    if alone and analysis.main is Drive.LIVE:  # levels close together, which a scale from zero on would draw as one
        values += [value for value in interval_of(analysis) or () if np.isfinite(value)]
        return _padded(min(values, default=0.0), max(values, default=1.0))
    values.append(0.0)
    if analysis.path is not None:
        values += list(analysis.path.value)
    if run is not None:
        record = run.settling("reaction")
        values += [float(value) for value in record[np.isfinite(record)]]
    far = [lines["greatest"]] if "greatest" in lines else []
    return _padded(*_with_near(values, [*far, *(interval_of(analysis) or ())]))


def plateau_limits(results: Results) -> tuple[float, float]:
    """Reaction range around the fitted line, its uncertainty and the least reactions, with room for the record's noise."""
    analysis, run = results.analysis, results.run
    values = [value for name, value in levels(analysis).items() if name != "greatest"]
    if run is not None and has_plateau(run):
        reaction, uncertainty = run.result.reaction, run.result.uncertainty
        late = run.settling("reaction")[run.settling("settlement") >= run.result.plateau_start]
        values += [reaction - 2.0 * uncertainty, reaction + 2.0 * uncertainty, *np.quantile(late, (0.02, 0.98))]
    elif analysis.path is not None:
        values += list(analysis.path.value[len(analysis.path.value) // 2 :])
    return _padded(*_with_near(values, interval_of(analysis) or ()))


def _with_near(values: Sequence[float], far: Sequence[float]) -> tuple[float, float]:
    """Range of the values, and of each far one that does not dwarf them."""
    low, high = min(values, default=0.0), max(values, default=1.0)
    near = [value for value in far if max(value, high) - min(value, low) <= NEAR * (high - low)]
    return min([low, *near]), max([high, *near])


def has_sharp(analysis: LimitAnalysis) -> bool:
    """Whether sharp arrises have an associated answer of their own."""
    lines = levels(analysis)
    return "sharp" in lines and not abs(lines["sharp"] - lines.get("least", np.inf)) <= POINT * abs(lines["sharp"])


def is_joint(analysis: LimitAnalysis) -> bool:
    """Whether the Coulomb prediction is the associated answer, as where no joint slides."""
    lines = levels(analysis)
    return "coulomb" in lines and abs(lines["coulomb"] - lines.get("least", np.inf)) <= POINT * abs(lines["coulomb"])


def _value(solutions: dict[Drive, Solution], drive: Drive) -> float:
    return solutions[drive].value if drive in solutions else float("nan")
