"""One judgement: what was compared, how far apart, how far it may be, and why."""

import enum
import math
from dataclasses import dataclass


class Verdict(enum.StrEnum):
    """Verdict of one check or of a whole comparison; a comparison has the gravest verdict of its checks.

    Attributes
    ----------
    AGREE
        Both methods agree within the tolerance.
    DISAGREE
        They differ by more than the tolerance.
    INCONCLUSIVE
        A number does not exist, or it is too uncertain for a verdict.
    """

    AGREE = "agree"
    DISAGREE = "disagree"
    INCONCLUSIVE = "inconclusive"


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
        YADE's value minus the reference, in `unit`. None where one of them does not exist.
    tolerance : float or None
        Largest accepted size of the difference, in `unit`. None where the check has no tolerance.
    unit : str
        Unit of the numbers, such as "N" or "of the mass".
    reason : str
        Reason in sentences; "" only for AGREE.
    """

    name: str
    verdict: Verdict
    limit_analysis: float | None = None
    yade: float | None = None
    difference: float | None = None
    tolerance: float | None = None
    unit: str = ""
    reason: str = ""


def overall(checks: list[Check]) -> tuple[Verdict | None, str]:
    """The gravest verdict of all checks, with its reasons unless it is agree; None when nothing was judged."""
    for verdict in (Verdict.DISAGREE, Verdict.INCONCLUSIVE):
        reasons = [check.reason for check in checks if check.verdict is verdict]
        if reasons:
            return verdict, " ".join(dict.fromkeys(reasons))
    return (Verdict.AGREE, "") if checks else (None, "")


def within(name: str, expected: float, found: float, tolerance: float, unit: str, reason: str) -> Check:
    """Compare two numbers; an undefined one makes the check inconclusive, never agree."""
    difference = found - expected
    if not (math.isfinite(difference) and math.isfinite(tolerance)):
        missing = f"{name}: a value does not exist."
        return Check(name, Verdict.INCONCLUSIVE, finite_or_none(expected), finite_or_none(found), None, tolerance, unit, missing)
    verdict = Verdict.AGREE if abs(difference) <= tolerance else Verdict.DISAGREE
    return Check(name, verdict, expected, found, difference, tolerance, unit, "" if verdict is Verdict.AGREE else reason)


def inside(name: str, bounds: tuple[float, float], found: float, tolerance: float, unit: str, reason: str) -> Check:
    """Compare a number with a range: the check shows the nearer bound, and the range in its reason."""
    low, high = bounds
    if any(math.isnan(bound) for bound in (low, high, tolerance)) or not math.isfinite(found):
        return within(name, math.nan, found, tolerance, unit, reason)
    fits = low - tolerance <= found <= high + tolerance
    nearer = low if found - low <= high - found else high
    span = f"Range: {low:.6g} to {high:.6g} {unit}." if math.isfinite(high) else f"Range: {low:.6g} {unit} and more."
    shown = span if fits else f"{reason} {span}"
    verdict = Verdict.AGREE if fits else Verdict.DISAGREE
    return Check(name, verdict, finite_or_none(nearer), found, finite_or_none(found - nearer), tolerance, unit, shown)


def finite_or_none(value: float) -> float | None:
    """The value, None where it is not finite."""
    return value if math.isfinite(value) else None
