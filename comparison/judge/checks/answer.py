"""The checks of limit analysis alone: the expected values of a scene, and the existence of an answer."""

import math
from collections.abc import Iterator
from dataclasses import replace

from comparison.judge.checks import next_steps
from comparison.judge.checks.prediction import FELL
from comparison.judge.checks.tolerances import accuracy_share
from comparison.numbers import format_number
from comparison.verdict import Check, Verdict, within
from la_core.analysis import LimitAnalysis
from la_core.coulomb import CoulombSolution
from la_core.limit import Drive, Solution, Status

SLIP = 0.01  # share by which a value in a wrong unit, rounded by hand, may differ from that of limit analysis
OF_ONE_METHOD = {
    Verdict.AGREE: Verdict.EXPECTED_MET,
    Verdict.DISAGREE: Verdict.UNEXPECTED,
}  # verdicts without a second method


def check_expected(analysis: LimitAnalysis) -> Iterator[Check]:
    """Yield a check of limit analysis for sharp edges against each value of the scene's table [expected].

    The expected reaction or multiplier is compared with the answer for the scene's own friction, at its own inset if joints slide. The
    greatest reaction and the values with "associated" in their names are compared with the associated answer. An answer that was not
    requested is not compared.
    """
    scene = analysis.scene
    expected = scene.expected
    if expected is None:
        return
    main, greatest = analysis.sharp.bounds[analysis.main], analysis.sharp.bounds.get(Drive.PUSHING)
    is_bound = scene.effects.friction in ("associated", "none-slides")
    answer = analysis.sharp.coulomb or analysis.coulomb or (main if is_bound else None)  # None if only the bounds were requested
    value, associated = expected.reaction_over_weight, expected.associated_reaction_over_weight
    if scene.live is not None:
        value, associated = expected.multiplier, expected.associated_multiplier
    comparisons = (
        (f"expected {scene.quantity}", value, answer),
        (f"expected associated {scene.quantity}", associated, main),
        ("expected greatest reaction", expected.reaction_max_over_weight, greatest),
    )
    for name, number, solution in comparisons:
        if number is not None and solution is not None:
            tolerance = max(expected.tolerance, accuracy_share(analysis) * abs(number))
            check = _of_value(name, analysis, solution, number, tolerance)
            verdict = OF_ONE_METHOD.get(check.verdict, check.verdict)
            yield replace(check, verdict=verdict, yade=None)  # the number is an expected value of the scene, not a value of YADE


def _of_value(name: str, analysis: LimitAnalysis, solution: Solution | CoulombSolution, number: float, tolerance: float) -> Check:
    """Return the check of one answer against an expected number; number and tolerance are shares of the weight, or multipliers."""
    scene = analysis.scene
    over_weight = "m (R/W)" if scene.is_rotation else "of W"  # the reaction of a rotating support is a moment
    divisor, unit = (1.0, "") if scene.live is not None else (scene.weight, over_weight)
    solved = solution.status is Status.SOLVED
    computed = solution.value / divisor if solved else math.nan
    rounded = analysis.assembly.inset if solution is analysis.coulomb else 0.0
    edges = f"an inset of {1e3 * rounded:g} mm" if rounded else "sharp edges"
    reason = f"Limit analysis gives {computed:.6g} for {edges}, but the scene expects {number:.6g}."
    check = within(name, computed, number, tolerance, unit, reason, _likely_slip(analysis, solution, number, tolerance))
    if solved:
        return check
    unknown = f"Limit analysis for {edges} ended as {solution.status}, but the scene expects {number:.6g}."
    if _fell(solution) and solution is not analysis.coulomb:  # `check_answer` already reports this for analysis.coulomb
        unknown += f" {FELL[0].upper()}{FELL[1:]}."
    return replace(check, reason=unknown, next_step=_step_without_value(analysis, solution))


def _likely_slip(analysis: LimitAnalysis, solution: Solution | CoulombSolution, number: float, tolerance: float) -> str:
    """Return the next step for an expected value that is not met: a likely slip of the pen, or a comparison of scene and source."""
    scene, bounds, main = analysis.scene, analysis.sharp.bounds, analysis.sharp.bounds[analysis.main]
    divisor, key = (1.0, "multiplier") if scene.live is not None else (scene.weight, "reaction_over_weight")
    computed = solution.value / divisor

    def near(value: float) -> bool:
        return abs(number - value) <= SLIP * abs(value)

    def is_that(other: Solution | None) -> bool:
        return other is not None and other is not solution and abs(number - other.value / divisor) <= tolerance

    shift = abs(main.value - analysis.bounds[analysis.main].value) / divisor  # of the bound, by the inset
    pushed = bounds.get(Drive.PUSHING)
    slips = (
        (solution is analysis.coulomb and abs(number - computed) <= 2.0 * shift, next_steps.SHARP_EDGES),
        (computed > 0.0 and near(-computed), next_steps.SIGN.format(quantity=scene.quantity)),
        (computed < 0.0 and near(-computed), next_steps.MINUS),
        (
            scene.live is None and near(solution.value) and not near(computed),
            next_steps.IN_NEWTONS.format(unit=scene.unit, weight=scene.weight),
        ),
        (near(100.0 * computed), next_steps.PERCENT),
        (scene.tilt is not None and near(math.degrees(math.atan(computed))), next_steps.ANGLE),
        (is_that(pushed), next_steps.OTHER_KEY.format(meaning="greatest reaction, against the settlement", key="reaction_max_over_weight")),
        (solution is pushed and is_that(main), next_steps.OTHER_KEY.format(meaning="reaction along the settlement", key=key)),
        (is_that(main), next_steps.OTHER_KEY.format(meaning="one of the associated flow rule", key=f"associated_{key}")),
    )
    return next((step for found, step in slips if found), next_steps.CHECK_SOURCE)


def check_answer(analysis: LimitAnalysis) -> Iterator[Check]:
    """Yield a check with the reason for a missing or uncertain answer of limit analysis; none if it is solved, or nothing can stand."""
    associated, coulomb = analysis.bounds[analysis.main], analysis.coulomb
    if associated.status not in (Status.SOLVED, Status.INFEASIBLE) and not analysis.is_without_bound:
        reason = f"Limit analysis ended as {associated.status}, so it has no answer."
        yield Check("limit analysis", Verdict.INCONCLUSIVE, reason=reason, next_step=next_steps.without_value(analysis))
    elif coulomb is not None and coulomb.status in (Status.INACCURATE, Status.FAILED):
        reason = ended_words(coulomb, analysis.scene.unit)
        yield Check("Coulomb limit analysis", Verdict.INCONCLUSIVE, reason=reason, next_step=_step_without_value(analysis, coulomb))


def _fell(solution: Solution | CoulombSolution) -> bool:
    return isinstance(solution, CoulombSolution) and math.isinf(solution.uncertainty)


def _step_without_value(analysis: LimitAnalysis, solution: Solution | CoulombSolution) -> str:
    """Return the next step for an answer that is not solved: without a value to compare with the source, it depends on the cause."""
    if solution.status is Status.INFEASIBLE:
        return next_steps.CHECK_SOURCE
    if not isinstance(solution, CoulombSolution) or solution.status is Status.UNBOUNDED:
        return next_steps.without_value(analysis)
    return next_steps.for_a_thrust(analysis.scene) if _fell(solution) else next_steps.FINER_PATHS


def ended_words(coulomb: CoulombSolution, unit: str) -> str:
    """Return a sentence on how a prediction ended that is not solved, and on its fault. unit: of its value, N, N m or none."""
    return f"Coulomb limit analysis ended as {coulomb.status}{_doubt(coulomb, unit)}."


def _doubt(coulomb: CoulombSolution, unit: str) -> str:
    """Return the fault of a prediction that is not solved, as the end of a sentence."""
    if _fell(coulomb):
        return f": {FELL}"
    if coulomb.status is not Status.INACCURATE:
        return ", so it has no value"
    value = f"{format_number(coulomb.value, 5)} ± {format_number(coulomb.uncertainty, 2)} {unit}".rstrip()
    return f": its value is {value}, and the largest residual of its limit state {coulomb.certificate:.1e}"
