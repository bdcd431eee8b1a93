"""The conclusion of a comparison: one verdict from all checks, its reason, the next step, and remarks."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from comparison.numbers import plural, said_once, sentences
from comparison.verdict.check import SEVERE, Check, Verdict, overall

MOST_NAMES = 5  # blocks that a reason names
FINER = "Repeat both methods with finer settings of their own: `crosscheck run --try-harder`."
HARDER = "`crosscheck run --try-harder` does this."
BOTH_METHODS = "Let YADE confirm it: `crosscheck run` or `crosscheck campaign` without `--no-yade`."
TRIED = "This run had the finer settings of a second attempt already. Compare the scene with its source, or model a smaller part."
LOOK = f"Look at both mechanisms and both curves of the reaction in the report. {FINER}"
SUPPORT_IT = (
    "Look for a gap, a missing support, or a joint without contact or with too little friction where these blocks rest (`crosscheck show` "
    "draws the joints). Contact at an edge or a corner alone is no joint: cut the edge to a face of some millimetres. If scene and "
    "friction are right, the structure is too thin or needs more support."
)
CHECK_LOADS = (
    "Look at the loads and ties on these blocks (`crosscheck show` draws them), and whether the structure stands without them. Then look "
    "for a gap, a missing support, or a joint without contact or with too little friction where these blocks rest."
)
SMALLER_INSET = (
    "The structure stands on the edge of some joint: any worn edge makes it fall. The values for sharp edges hold for perfect "
    "blocks alone. Try a smaller [joint] inset to see how much rounding the structure bears."
)
SLOW = "The structure falls so slowly that YADE's run ended before the fall."
BEARS_NOTHING = (
    "The structure is in balance without its live load, but bears none of it: the multiplier is 0, and no finer setting changes this. Look "
    "at the friction, the shape and the dead loads (`crosscheck show`). If they are right, 0 is the answer."
)
CARRIED_OUT = ("plateau", "no plateau", "collapsed")  # statuses of a run of YADE that reached its end
UNCONFIRMED = ("", None, Verdict.EXPECTED_MET)  # verdicts on limit analysis alone, whose mark shows the next step; "" in a table cell
DEFAULT_STEPS = {Verdict.DISAGREE: LOOK, Verdict.UNEXPECTED: LOOK, Verdict.INCONCLUSIVE: FINER}


@dataclass(frozen=True)
class Conclusion:
    """The conclusion of a comparison.

    Attributes
    ----------
    verdict : Verdict or None
        Verdict on the whole comparison; None if nothing was compared.
    reason : str
        Reason in sentences; "" if both methods agree.
    next_step : str
        Next step for a user; "" only if both methods agree or nothing was compared.
    remarks : tuple of str
        Notes of the passed checks, such as stick-slip.
    """

    verdict: Verdict | None
    reason: str = ""
    next_step: str = ""
    remarks: tuple[str, ...] = ()


def conclusion(
    checks: list[Check],
    yade: Mapping[str, Any] | None,
    falling: Sequence[str] | None = None,
    is_finest: bool = False,
    is_loaded: bool = False,
    rounded: float = 0.0,
    cause: str = "",
    step: str = "",
) -> Conclusion:
    """Return the conclusion from every check.

    Parameters
    ----------
    checks : list of Check
        All checks.
    yade : mapping or None
        Summary of YADE's run, with its status; None if YADE was not requested, so that there is no agreement of two methods.
    falling : sequence of str or None
        Names of the blocks that fall if limit analysis proves that the structure cannot stand; otherwise None.
    is_finest : bool
        Whether the scene has the finer settings of a second attempt: the next step is then no further attempt with the same settings.
    is_loaded : bool
        Whether dead loads or ties act on the structure in addition to its weight.
    rounded : float
        Inset, m, of a structure that falls but stands with sharp edges; otherwise 0.
    cause : str
        Sentence on the cause of the fall; "" if unknown.
    step : str
        Next step of an inconclusive verdict instead of the checks' own; "" to use theirs.
    """
    verdict, reason = overall(checks)
    if verdict is Verdict.UNEXPECTED and yade is not None and yade.get("status") in CARRIED_OUT:
        verdict = Verdict.DISAGREE  # limit analysis misses an expected value, and YADE's agreement does not outweigh this
    remarks = tuple(said_once(check.reason for check in checks if check.verdict is Verdict.AGREE))
    if falling is not None and verdict not in SEVERE[0]:
        what = SMALLER_INSET if rounded else CHECK_LOADS if is_loaded else SUPPORT_IT
        return Conclusion(Verdict.CANNOT_STAND, _falls(falling, yade, is_loaded, rounded, cause), what, remarks)
    if step and verdict is Verdict.INCONCLUSIVE:
        return Conclusion(verdict, reason, step, remarks)
    if verdict in DEFAULT_STEPS:
        alike = next(alike for alike in SEVERE if verdict in alike)
        steps = [check.next_step for check in checks if check.verdict in alike and check.next_step]
        step = steps[0] if steps else DEFAULT_STEPS[verdict]
        return Conclusion(verdict, reason, _after_second_attempt(step) if is_finest else step, remarks)
    if yade is None:
        met = any(check.verdict is Verdict.EXPECTED_MET for check in checks)
        return Conclusion(Verdict.EXPECTED_MET if met else None, _alone(met), BOTH_METHODS if met else "", remarks)
    return Conclusion(Verdict.AGREE if checks else None, "", "", remarks)


def _after_second_attempt(step: str) -> str:
    """Return a next step with TRIED instead of the advice of a second attempt, and with the option for the time limit of that attempt."""
    said = sentences(step)
    advised = [one for one, following in zip(said, [*said[1:], ""], strict=True) if "--try-harder" in one or following == HARDER]
    step = " ".join([*(one for one in said if one not in advised), TRIED]) if advised else step
    return step.replace("--time-limit", "--try-harder-limit")


def named_blocks(names: Sequence[str]) -> str:
    """Return the first names in quotes, and the number of further blocks."""
    quoted = ", ".join(f'"{name}"' for name in names[:MOST_NAMES])
    return quoted + (f" and {plural(len(names) - MOST_NAMES, 'more block')}" if len(names) > MOST_NAMES else "")


def _falls(falling: Sequence[str], yade: Mapping[str, Any] | None, is_loaded: bool, rounded: float, cause: str) -> str:
    status = "" if yade is None else str(yade.get("status"))
    message = str((yade or {}).get("message") or "").splitlines()[:1]
    ended = ": ".join([f"YADE's run ended as {status}", *message]) + "."
    other = {"": "YADE was not run.", "collapsed": "The structure collapsed in YADE, too."}.get(
        status, SLOW if "plateau" in status else ended
    )
    under = "weight, loads and ties" if is_loaded else "own weight"
    edges = f" where edges are rounded by {1e3 * rounded:g} mm, as both methods need" if rounded else ""
    proof = f"Limit analysis proves that no equilibrium exists under the structure's {under}{edges}"
    said = [
        f"{proof}: {named_blocks(falling)} would fall." if falling else f"{proof}.",
        cause,
        "With sharp edges the structure stands." if rounded else "",
    ]
    return " ".join([*filter(None, said), other])


def _alone(met: bool) -> str:
    found = "Limit analysis meets the expected value" if met else "The scene expects no value"
    return f"{found}; YADE was not run, so no second method has confirmed the answer."
