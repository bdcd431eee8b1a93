"""The checks of YADE's run, and the choice of the checks that a run allows."""

import math
from collections.abc import Iterator

import numpy as np

from comparison.judge.checks import next_steps
from comparison.judge.checks.energy import check_energy
from comparison.judge.checks.prediction import FELL
from comparison.judge.checks.reaction import check_prediction, leaves_plateau
from comparison.judge.checks.reduced_model import check_displacement, check_plane, check_reach
from comparison.judge.checks.sections import check_sections
from comparison.judge.checks.tolerances import falls_slowly, reaction_tolerance, unbalanced
from comparison.numbers import format_number, plural
from comparison.verdict import CARRIED_OUT, Check, Verdict, inside, named_blocks, within, without_contradiction
from comparison.yade import Results, Run
from la_core.limit import Drive, Status
from la_core.measures import residuals
from la_core.scene import Scene

SLIPPED = "The blocks stood at rest. A later jump may throw a block. A block that slides by about the inset may slip off its joint."
BELOW = "multiplier below its upper bound"
SPEED = 0.05  # of the speed along a live load: the servo's spring still stretches a little while the multiplier changes
SETTLEMENT = 1e-3  # of the imposed settlement: the support is driven, so imposed and reached settlement differ only by round-off


def check_run(results: Results) -> list[Check]:
    """Return every check that YADE's run and limit analysis allow."""
    return [next_steps.own_settings_first(check, results.scene) for check in _checks_of(results)]


def _checks_of(results: Results) -> list[Check]:
    """Return the checks in their order; the list is shorter for a run without a value or out of balance."""
    scene, analysis, run = results.scene, results.analysis, results.recorded
    bound, answer = analysis.bounds[analysis.main], analysis.main_answer
    if run.status not in CARRIED_OUT:
        reason = f"YADE's run ended as {run.status}: {run.result.message}."
        step = next_steps.MORE_TIME if run.status == "timeout" else next_steps.after_a_failure(run.result.message)
        return [Check("YADE's run", Verdict.INCONCLUSIVE, reason=reason, next_step=step)]
    if bound.status is Status.INFEASIBLE:
        return [_check_standing(results)]
    moved = list(check_displacement(results))
    if run.status == "collapsed":
        return [*(check for check in moved if check.reason), _check_standing(results)]
    if answer.status is not Status.SOLVED:
        reason = f"Limit analysis ended as {bound.status}, so YADE's {scene.quantity} cannot be compared."
        return [Check("limit analysis", Verdict.INCONCLUSIVE, reason=reason, next_step=next_steps.without_value(analysis))]
    driven = _check_settlement(scene, run) if scene.live is None else _check_speed(results)
    checks = [driven, *(moved or [_check_contacts(results)]), _check_equilibrium(results)]
    checks += [*check_plane(analysis), *check_energy(analysis.assembly, run)]
    if run.status == "no plateau":
        checks = [driven, *map(without_contradiction, checks[1:])]  # rattling blocks may touch others
        reason = f"YADE's {scene.quantity} was not steady when the run ended: {run.result.message}."
        return [*checks, Check("plateau", Verdict.INCONCLUSIVE, reason=reason, next_step=next_steps.LONGER)]
    checks.append(balance := _check_balance(results))
    is_on_its_way = balance.verdict is not Verdict.AGREE and balance.difference is not None
    return checks if is_on_its_way else [*checks, *_check_reaction(results)]


def _check_reaction(results: Results) -> Iterator[Check]:
    """Yield the checks of the reaction.

    A mean state of YADE that is out of equilibrium does not contradict the prediction, because inertia may cause the difference. A plateau
    that YADE leaves does not contradict it, either. But a state may also be out of equilibrium because of other weights in YADE. So bounds
    and force sums still count for it, unless YADE leaves such a state.
    """
    is_in_balance, is_passing = _imbalance(results) <= unbalanced(results), leaves_plateau(results)
    for make in (_check_bounds, check_reach, check_prediction, check_sections):
        may_contradict = is_in_balance and not is_passing if make is check_prediction else is_in_balance or not is_passing
        yield from make(results) if may_contradict else map(without_contradiction, make(results))


def _check_standing(results: Results) -> Check:
    """Return the check that the structure stands, if it falls in one method or in both.

    A proof that no equilibrium exists holds for every method. But a structure need not reach an existing equilibrium: the safe theorem is
    not valid for friction without dilatancy, and blocks laid without thrust may slide although a thrust could hold them.
    """
    analysis, run = results.analysis, results.recorded
    bound, name = analysis.bounds[analysis.main], "the structure stands"
    outcome = "it collapsed in YADE" if run.status == "collapsed" else f"YADE's run ended as {run.status}"
    if bound.status is Status.INFEASIBLE and run.status == "collapsed":
        return Check(name, Verdict.AGREE)
    if bound.status is Status.INFEASIBLE:
        proof = f"Limit analysis proves that the structure cannot stand ({named_blocks(bound.falling)} would fall)"
        missed = Verdict.INCONCLUSIVE if falls_slowly(analysis.whole) else Verdict.DISAGREE
        return Check(name, missed, reason=f"{proof}, but {outcome}.")
    if bound.status is Status.SOLVED and not analysis.assembly.points.friction.any():
        reason = f"Limit analysis finds an equilibrium, which must hold because no joint has friction, but {outcome}."
        return Check(name, Verdict.DISAGREE, reason=reason)
    came = "finds an equilibrium" if analysis.main_answer.status is Status.SOLVED else f"ended as {bound.status}"
    reason = f"Limit analysis {came}, but {outcome} ({run.result.message})."
    if analysis.coulomb is not None and analysis.coulomb.status is Status.FAILED:
        reason = f"In both methods {FELL}: the path of limit analysis comes to no plateau, and {outcome} ({run.result.message})."
    slides = "" if results.scene.yade.get("wedging") else " Blocks laid without thrust may slide although a thrust could hold them."
    step = next_steps.for_a_thrust(results.scene)
    if _stood_at_rest(results):
        slides, step = f" {SLIPPED}", next_steps.SLOWER_RUN
    return Check(name, Verdict.INCONCLUSIVE, reason=reason + slides, next_step=step)


def _stood_at_rest(results: Results) -> bool:
    """Return whether the fallen blocks stood at rest and need no thrust: the support has moved, and the prediction has a plateau."""
    coulomb, run = results.analysis.coulomb, results.recorded
    is_settling = results.scene.live is None and run.result.settlement > 0.0
    return is_settling and coulomb is not None and coulomb.status is Status.SOLVED


def _check_settlement(scene: Scene, run: Run) -> Check:
    imposed, achieved = run.result.asked_settlement, run.result.settlement
    unit = "rad" if scene.is_rotation else "m"
    reason = f"YADE's support moved by {achieved:.6g} {unit}, but a settlement of {imposed:.6g} {unit} was imposed."
    return within("settlement achieved", imposed, achieved, SETTLEMENT * abs(imposed), unit, reason)


def _check_speed(results: Results) -> Check:
    """Check that the servo of a live load kept the blocks at the set speed: then no part of the load accelerates them.

    The speed is the mean of the blocks' speeds along the load, weighted by mass times speed.
    """
    run, blocks, live = results.recorded, results.analysis.assembly.blocks, results.scene.live
    name, time, moved = "speed along the load", run.settling("time"), run.settling("settlement")
    kept = moved >= run.result.plateau_start
    if np.count_nonzero(kept) < 2:
        reason = "The blocks never moved steadily along the load."
        return Check(name, Verdict.INCONCLUSIVE, reason=reason, next_step=next_steps.LONGER)
    power = blocks.mass[blocks.free] * (along := run.mechanism()[blocks.free, :3] @ live)
    set_speed, mean_speed = float(run.settings["speed"]), float(np.ptp(moved[kept]) / np.ptp(time[kept]))
    speed = mean_speed * float(power @ along / power.sum())
    reason = f"On the plateau the blocks moved at {speed:.3g} m/s on the mean, but {set_speed:.3g} m/s was set."
    return without_contradiction(within(name, set_speed, speed, SPEED * set_speed, "m/s", reason, next_steps.SLOWER_RUN))


def _check_contacts(results: Results) -> Check:
    analysis, run = results.analysis, results.recorded
    names, extra = analysis.assembly.blocks.names, run.extra_contacts
    listed = len(analysis.assembly.points)
    if not len(extra):
        return Check("contact lists", Verdict.AGREE, float(listed), float(listed), 0.0, 0.0, "points")
    pairs = ", ".join(f"{names[a]} and {names[b]}" for a, b in extra[:3])
    reason = f"In YADE {plural(len(extra), 'contact')} formed where limit analysis lists no contact point ({pairs})."
    return Check("contact lists", Verdict.DISAGREE, float(listed), float(listed + len(extra)), float(len(extra)), 0.0, "points", reason)


def _check_equilibrium(results: Results) -> Check:
    analysis, run = results.analysis, results.recorded
    violation = residuals.cone_violation(analysis.assembly, run.plateau_forces())
    worst = max(_imbalance(results), violation)
    state = f"YADE's mean state on the plateau is out of equilibrium or breaks the friction law by {worst:.2g} of the mean block weight"
    accepted = unbalanced(results)
    reason = f"{state} ({accepted:.2g} accepted), so its reaction is not quasi-static."
    rests = worst <= accepted
    verdict = Verdict.AGREE if rests else Verdict.INCONCLUSIVE
    name, unit = "equilibrium of the YADE state", "of the mean block weight"
    words = ("", "") if rests else (reason, next_steps.SLOWER_RUN)
    return Check(name, verdict, 0.0, worst, worst, accepted, unit, *words)


def _imbalance(results: Results) -> float:
    """Return the largest unbalanced force of YADE's mean state on the plateau, over the mean block weight."""
    assembly = results.analysis.assembly
    return residuals.equilibrium_residual(assembly, results.recorded.plateau_forces(), _multiplier(results))


def _check_balance(results: Results) -> Check:
    """Check the power of the unbalanced forces of YADE's mean state on the mechanism of limit analysis per unit motion or unit live load.

    By virtual power, these forces change the reaction by that amount. Only this check shows a slow sway of a tall block.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    assembly = analysis.assembly
    left_over = run.plateau_wrenches(assembly) + assembly.dead_load + _multiplier(results) * assembly.live_load
    free = assembly.blocks.free
    power = float(np.sum(left_over[free] * analysis.main_answer.twists[free]))
    tolerance = reaction_tolerance(results)
    sizes = [f"{format_number(size, 3)} {scene.unit}".rstrip() for size in (abs(power), tolerance)]
    worth = f"{sizes[0]} of {scene.quantity}, more than the tolerance of {sizes[1]}"
    reason = f"YADE's mean state is not in equilibrium: its unbalanced forces are worth {worth}."
    name = "balance along the mechanism"
    return without_contradiction(within(name, 0.0, power, tolerance, scene.unit, reason, next_steps.SLOWER_RUN))


def _multiplier(results: Results) -> float:
    """Return the mean multiplier of YADE's live load at the stored states of its plateau; 0 without a live load."""
    if results.scene.live is None:
        return 0.0
    run = results.recorded
    stored = run.poses.settlement[run.poses.settlement >= run.result.plateau_start]  # the states of `Run.plateau_forces`
    at = stored if len(stored) else run.poses.settlement[-1:]
    return float(np.interp(at, run.settling("settlement"), run.settling("reaction")).mean())


def _check_bounds(results: Results) -> Iterator[Check]:
    """Yield the check that a reaction lies between the bounds: any quasi-static state on the same contact points is statically admissible.

    For the same reason no multiplier of a live load is above the associated one. There is no such check if that one is unlimited.
    """
    if results.scene.live is not None:
        if results.analysis.is_without_bound:
            return
        greatest_multiplier = results.analysis.bounds[Drive.LIVE].value
        reason = "YADE's multiplier is above the associated one, an upper bound on these contact points, so one of the models is wrong."
        range_below = (-math.inf, greatest_multiplier)
        yield inside(BELOW, range_below, results.recorded.result.reaction, reaction_tolerance(results), "", reason)
        return
    scene, analysis, run = results.scene, results.analysis, results.recorded
    reaction, tolerance = run.result.reaction, reaction_tolerance(results)
    least = -math.inf if analysis.is_without_bound else analysis.bounds[Drive.YIELDING].value
    greatest = analysis.bounds[Drive.PUSHING]
    above = math.inf if greatest.status is Status.UNBOUNDED else greatest.value if greatest.status is Status.SOLVED else math.nan
    reason = "YADE's reaction lies outside the bounds of equilibrium and friction on these contact points, so one of the models is wrong."
    yield inside("reaction within bounds", (least, above), reaction, tolerance, scene.unit, reason)
