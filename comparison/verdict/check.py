"""A check: one comparison of the two methods, with its numbers, tolerance, verdict, reason and next step."""

import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from comparison.numbers import said_once


class Verdict(enum.StrEnum):
    """Verdict of one check or of a whole comparison; a comparison has the most severe verdict of its checks.

    Attributes
    ----------
    AGREE
        Both methods agree within the tolerance.
    DISAGREE
        They differ by more than the tolerance.
    INCONCLUSIVE
        A number does not exist, or it is too uncertain for a verdict.
    EXPECTED_MET
        Limit analysis meets the value that the scene expects. As the verdict of a comparison: YADE was not run.
    UNEXPECTED
        Limit analysis does not meet the value that the scene expects. As the verdict of a comparison: YADE has no result.
    CANNOT_STAND
        The structure has no equilibrium under its weight and dead loads, and YADE does not contradict this.
    """

    AGREE = "agree"
    DISAGREE = "disagree"
    INCONCLUSIVE = "inconclusive"
    EXPECTED_MET = "expected"
    UNEXPECTED = "unexpected"
    CANNOT_STAND = "cannot stand"


SEVERE = ((Verdict.DISAGREE, Verdict.UNEXPECTED), (Verdict.INCONCLUSIVE,))  # verdicts of equal weight, the most severe ones first


@dataclass(frozen=True)
class Check:
    """One check of a comparison: the compared numbers, their difference, the tolerance and the verdict.

    Attributes
    ----------
    name : str
        Name of the check, such as "reaction within bounds".
    verdict : Verdict
        Verdict of this check.
    limit_analysis : float or None
        Reference value, in `unit`: from limit analysis, or the exact one. None where it does not exist.
    yade : float or None
        Value from YADE, in `unit`. None where it does not exist.
    difference : float or None
        YADE's value minus the reference, in `unit`. None where one of them does not exist. In a check of a value that the
        scene expects, where `yade` is None: the expected value minus that of limit analysis. In the check of the moving blocks:
        the share of the mass that moves in one method only.
    tolerance : float or None
        Largest accepted size of the difference, in `unit`. None where the check has no tolerance.
    unit : str
        Unit of the numbers, such as "N" or "of the mass".
    reason : str
        Reason in sentences; for AGREE a remark, or "".
    next_step : str
        Next step for a user, in sentences; "" for AGREE, and if the default next step of the verdict applies.
    range : tuple of float or None, or None
        Ends of the range in which YADE's value must lie, in `unit`, None for an open end; None for a check without a range. With a
        range, the difference is the distance beyond it, 0 inside.
    """

    name: str
    verdict: Verdict
    limit_analysis: float | None = None
    yade: float | None = None
    difference: float | None = None
    tolerance: float | None = None
    unit: str = ""
    reason: str = ""
    next_step: str = ""
    range: tuple[float | None, float | None] | None = None


def overall(checks: list[Check]) -> tuple[Verdict | None, str]:
    """Return the most severe verdict of all checks and the reasons for it, "" for agree; without checks the verdict is None.

    An expected value that is not met is as severe as a disagreement, so the reasons of both are given. A reason that several checks share
    appears once.
    """
    for alike in SEVERE:
        found = [check for check in checks if check.verdict in alike]
        if found:
            verdict = next(verdict for verdict in alike if any(check.verdict is verdict for check in found))
            return verdict, " ".join(said_once(check.reason for check in found))
    return (Verdict.AGREE, "") if checks else (None, "")


def within(name: str, expected: float, observed: float, tolerance: float, unit: str, reason: str, next_step: str = "") -> Check:
    """Compare two numbers; an undefined number makes the check inconclusive, never agree.

    Parameters
    ----------
    name : str
        Name of the check.
    expected, observed : float
        Values of limit analysis and of YADE, in `unit`.
    tolerance : float
        Largest size of the difference for agreement, in `unit`.
    unit : str
        Unit of the three numbers.
    reason : str
        Reason for the check if the numbers differ by more than the tolerance.
    next_step : str
        Next step for a user in this case.
    """
    difference = observed - expected
    if not (math.isfinite(difference) and math.isfinite(tolerance)):
        missing = f'The check "{name}" could not be made, because one of its values is undefined.'
        numbers = finite_or_none(expected), finite_or_none(observed), None, finite_or_none(tolerance)
        return Check(name, Verdict.INCONCLUSIVE, *numbers, unit, missing, next_step)
    if abs(difference) <= tolerance:
        return Check(name, Verdict.AGREE, expected, observed, difference, tolerance, unit)
    return Check(name, Verdict.DISAGREE, expected, observed, difference, tolerance, unit, reason, next_step)


def inside(name: str, bounds: tuple[float, float], observed: float, tolerance: float, unit: str, reason: str, next_step: str = "") -> Check:
    """Compare a number with a range: the check shows the range, the nearer bound, and the distance beyond the range.

    Parameters
    ----------
    name : str
        Name of the check.
    bounds : tuple of float
        Lower and upper bound from limit analysis, in `unit`; either may be infinite.
    observed : float
        Value of YADE, in `unit`.
    tolerance : float
        Largest distance beyond a bound for agreement, in `unit`.
    unit : str
        Unit of all numbers.
    reason : str
        Reason for the check if the number lies outside.
    next_step : str
        Next step for a user in this case.
    """
    low, high = bounds
    if any(math.isnan(bound) for bound in (low, high, tolerance)) or not math.isfinite(observed):
        return within(name, math.nan, observed, tolerance, unit, reason, next_step)
    nearer = low if observed - low <= high - observed else high
    beyond = min(observed - low, 0.0) + max(observed - high, 0.0)
    span = (finite_or_none(low), finite_or_none(high))
    if abs(beyond) <= tolerance:
        return Check(name, Verdict.AGREE, finite_or_none(nearer), observed, beyond, tolerance, unit, range=span)
    return Check(name, Verdict.DISAGREE, finite_or_none(nearer), observed, beyond, tolerance, unit, reason, next_step, span)


def without_contradiction(check: Check) -> Check:
    """Return a check that cannot contradict: it is inconclusive unless it agrees."""
    return check if check.verdict is Verdict.AGREE else replace(check, verdict=Verdict.INCONCLUSIVE)


def stored_check(stored: Mapping[str, Any]) -> Check:
    """Return a check from its object in comparison.json."""
    ends = stored.get("range")
    return Check(**{**stored, "verdict": Verdict(stored["verdict"]), "range": tuple(ends) if ends else None})


def finite_or_none(value: float) -> float | None:
    """Return the value, or None where it is not finite."""
    return value if math.isfinite(value) else None
