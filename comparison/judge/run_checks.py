"""The judge: each check compares one thing, with a tolerance and the reason for it, and says agree, disagree or inconclusive."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from comparison.judge.check import Check, Verdict, inside, within
from comparison.judge.energy import check_energy
from comparison.judge.prediction import check_prediction
from comparison.judge.reduced_model import check_displacement, check_plane, check_reach
from comparison.judge.sections import check_sections
from comparison.judge.tolerances import REACTION, UNBALANCED, accuracy_share, reaction_tolerance
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis
from la_core.limit import Drive, Status
from la_core.measures import residuals
from la_core.scene import Scene

SETTLEMENT = 1e-3  # of the settlement asked for: the support is driven, so only round-off may separate the two


def check_expected(analysis: LimitAnalysis) -> Iterator[Check]:
    """The scene's own expected values against limit analysis for sharp arrises.

    Reaction and multiplier are judged with the scene's own friction, the greatest reaction and what is named so as associated.
    """
    scene = analysis.scene
    expected = scene.expected
    if expected is None:
        return
    main, greatest = analysis.sharp.bounds[analysis.main], analysis.sharp.bounds.get(Drive.PUSHING)
    own = analysis.sharp.coulomb or main
    value, associated = expected.reaction_over_weight, expected.associated_reaction_over_weight
    if scene.live is not None:
        value, associated = expected.multiplier, expected.associated_multiplier
    asked = (
        (f"expected {scene.quantity}", value, own),
        (f"expected associated {scene.quantity}", associated, main),
        ("expected greatest reaction", expected.reaction_max_over_weight, greatest),
    )
    divisor, unit = (1.0, "") if scene.live is not None else (scene.weight, "of W")
    for name, number, solution in asked:
        if number is not None and solution is not None:
            found = solution.value / divisor if solution.status is Status.SOLVED else math.nan
            over = f" ({solution.status})" if solution.status is not Status.SOLVED else ""
            reason = f"Limit analysis gives {found:.6g}{over} for sharp arrises, the scene expects {number:.6g}."
            check = within(name, found, number, max(expected.tolerance, accuracy_share(analysis) * abs(number)), unit, reason)
            yield replace(check, yade=None)  # what was compared is the scene's own number, which the report names as such


def check_run(results: Results) -> list[Check]:
    """Everything YADE's run can say about limit analysis and limit analysis about YADE's run."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    least = analysis.bounds[Drive.YIELDING]
    if run.status not in ("plateau", "no plateau", "collapsed"):
        return [Check("YADE's run", Verdict.INCONCLUSIVE, reason=f"YADE's run ended as {run.status}: {run.result['message']}")]
    if least.status is Status.INFEASIBLE:
        return [_check_standing(results)]
    moved = list(check_displacement(results))
    if run.status == "collapsed":
        return [*(check for check in moved if check.reason), _check_standing(results)]
    if least.status is not Status.SOLVED:
        reason = f"Limit analysis ended as {least.status}, so there is nothing to judge by."
        return [Check("limit analysis", Verdict.INCONCLUSIVE, reason=reason)]
    checks = [_check_settlement(scene, run), *(moved or [_check_contacts(results)]), _check_equilibrium(results)]
    checks += [*check_plane(analysis), *check_energy(analysis.assembly, run)]
    if run.status == "no plateau":
        reason = f"YADE's reaction had not settled when the run ended: {run.result['message']}"
        return [*checks, Check("plateau", Verdict.INCONCLUSIVE, reason=reason)]
    checks.append(balance := _check_balance(results))
    is_on_its_way = balance.verdict is not Verdict.AGREE and balance.difference is not None
    return checks if is_on_its_way else [*checks, *_check_reaction(results)]


def _check_reaction(results: Results) -> Iterator[Check]:
    """What a reaction says that is one of equilibrium."""
    yield _check_bounds(results)
    yield from check_reach(results)
    yield from check_prediction(results)
    yield from check_sections(results)


def _check_standing(results: Results) -> Check:
    """One method, or both, say that the structure falls.

    A proof that no equilibrium exists binds every method. An equilibrium that exists need not be found: with friction that does
    not dilate the safe theorem fails, and blocks laid without thrust may slide although thrust could hold them.
    """
    analysis, run = results.analysis, results.recorded
    least, name = analysis.bounds[Drive.YIELDING], "the structure stands"
    outcome = "it collapsed in YADE" if run.status == "collapsed" else f"YADE's run ended as {run.status}"
    if least.status is Status.INFEASIBLE:
        verdict = Verdict.AGREE if run.status == "collapsed" else Verdict.DISAGREE
        proof = f"Limit analysis proves that the structure cannot stand ({', '.join(least.falling[:5])} would fall)"
        return Check(name, verdict, reason="" if verdict is Verdict.AGREE else f"{proof}, but {outcome}.")
    if least.status is Status.SOLVED and not analysis.assembly.points.friction.any():
        return Check(name, Verdict.DISAGREE, reason=f"Without friction an equilibrium that exists holds, but {outcome}.")
    found = "Limit analysis finds an equilibrium" if least.status is Status.SOLVED else f"Limit analysis ends as {least.status}"
    reason = f"{found}, but {outcome} ({run.result['message']}): friction holds only the thrust that the blocks were laid with."
    return Check(name, Verdict.INCONCLUSIVE, reason=reason)


def _check_settlement(scene: Scene, run: Run) -> Check:
    asked, achieved = run.result.asked_settlement, run.result.settlement
    return within(
        "settlement achieved",
        asked,
        achieved,
        SETTLEMENT * abs(asked),
        "rad" if scene.is_rotation else "m",
        "The support did not move as it was asked to.",
    )


def _check_contacts(results: Results) -> Check:
    analysis, run = results.analysis, results.recorded
    names, extra = analysis.assembly.blocks.names, run.extra_contacts
    listed = len(analysis.assembly.points)
    if not len(extra):
        return Check("contact lists", Verdict.AGREE, float(listed), float(listed), 0.0, 0.0, "points")
    pairs = ", ".join(f"{names[a]} and {names[b]}" for a, b in extra[:3])
    reason = f"In YADE {len(extra)} contacts appeared that limit analysis does not know ({pairs})."
    return Check("contact lists", Verdict.DISAGREE, float(listed), float(listed + len(extra)), float(len(extra)), 0.0, "points", reason)


def _check_equilibrium(results: Results) -> Check:
    analysis, run = results.analysis, results.recorded
    forces = run.plateau_forces()
    residual = residuals.equilibrium_residual(analysis.assembly, forces)
    violation = residuals.cone_violation(analysis.assembly, forces)
    worst = max(residual, violation)
    reason = "YADE's mean state on the plateau is out of equilibrium or breaks the friction law, so its reaction is not a quasi-static one."
    rests = worst <= UNBALANCED
    verdict = Verdict.AGREE if rests else Verdict.INCONCLUSIVE
    name, unit = "equilibrium of the YADE state", "of the mean block weight"
    return Check(name, verdict, 0.0, worst, worst, UNBALANCED, unit, "" if rests else reason)


def _check_balance(results: Results) -> Check:
    """What YADE's mean state is out of balance by, as a reaction: its power on limit analysis' mechanism for a unit motion of the support.

    By virtual power the reaction of a state in equilibrium differs by that much; a slow sway under a tall block shows here alone.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    unbalanced = analysis.assembly.contact_wrenches(run.plateau_forces()) + analysis.assembly.dead_load
    free = analysis.assembly.blocks.free
    power = float(np.sum(unbalanced[free] * analysis.bounds[Drive.YIELDING].twists[free]))
    reason = "YADE's mean state is on its way: what it is out of balance by would change the reaction. Run it slower ([yade] speed)."
    check = within("balance along the mechanism", 0.0, power, reaction_tolerance(results), scene.unit, reason)
    return replace(check, verdict=Verdict.AGREE if check.verdict is Verdict.AGREE else Verdict.INCONCLUSIVE)


def _check_bounds(results: Results) -> Check:
    """Any quasi-static state on the same contact points is statically admissible, so its reaction lies between the bounds."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    reaction, tolerance = run.result.reaction, reaction_tolerance(results, max(REACTION, accuracy_share(analysis)))
    least, greatest = analysis.bounds[Drive.YIELDING].value, analysis.bounds[Drive.PUSHING]
    above = math.inf if greatest.status is Status.UNBOUNDED else greatest.value if greatest.status is Status.SOLVED else math.nan
    reason = "YADE's reaction lies outside what equilibrium and friction allow on these contact points: one of the two models is wrong."
    return inside("reaction within bounds", (least, above), reaction, tolerance, scene.unit, reason)
