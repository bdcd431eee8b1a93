"""The friction state of YADE's plateau: a check that all joints slide that should, and a report of stick-slip."""

import math

import numpy as np

from comparison.judge.checks import next_steps
from comparison.judge.checks.tolerances import UNCERTAIN, least_reaction
from comparison.numbers import percent
from comparison.verdict import Check, Verdict, within, without_contradiction
from comparison.yade import Results
from la_core.limit import Status, consistent_reaction
from la_core.measures import residuals

STEADY = 5e-3  # of the reaction: a larger scatter about the plateau's line is stick-slip
CONSISTENT = 1e-2  # of the reaction: slow steady runs differ by less than 1e-4, runs with stick-slip by several per cent


def check_friction_state(results: Results) -> Check:
    """Compare YADE's reaction with the least reaction under its own normal forces; they agree if every joint slides that should.

    A multiplier is compared with the greatest multiplier.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    forces = run.plateau_forces()
    normal = np.maximum(analysis.assembly.split(forces)[0], 0.0)
    is_live = scene.live is not None
    reaction = (residuals.multiplier if is_live else residuals.reaction)(analysis.assembly, forces)
    consistent = consistent_reaction(analysis.assembly, normal)
    name = "YADE's friction state"
    if consistent.status is not Status.SOLVED:
        ended = f"Limit analysis with YADE's mean normal forces on the plateau ended as {consistent.status}"
        reason = f"{ended}, so these forces are not those of one quasi-static state."
        return Check(name, Verdict.INCONCLUSIVE, None, reaction, None, None, scene.unit, reason, next_steps.SLOWER_RUN)
    tolerance = max(CONSISTENT * abs(reaction), least_reaction(analysis)) + float(run.result.uncertainty)
    end = f"{'high' if is_live else 'low'} as {consistent.value:.6g} {scene.unit}".rstrip()
    possible = f"With friction limited by YADE's own normal forces, the {scene.quantity} could be as {end}"
    scatter = _scatter(results)
    slips = f" (stick-slip: scatter {percent(scatter)})" if scatter > STEADY else ""
    reason = f"{possible}: not every joint slides that should{slips}."
    return without_contradiction(within(name, consistent.value, reaction, tolerance, scene.unit, reason, next_steps.SLOWER_RUN))


def check_steadiness(results: Results) -> Check:
    """Report stick-slip; it is no fault, because the plateau's uncertainty includes it."""
    scatter = _scatter(results)
    name, unit = "steadiness of the plateau", "of R"
    if not math.isfinite(scatter):
        reason = "YADE recorded too few rows on the plateau to measure its scatter."
        return Check(name, Verdict.AGREE, None, None, None, STEADY, unit, reason)
    what = results.scene.quantity
    slips = f"Stick-slip: the {what} scatters by {percent(scatter)} about its plateau; the uncertainty of the {what} includes this."
    return Check(name, Verdict.AGREE, None, scatter, None, STEADY, unit, slips if scatter > STEADY else "")


def _scatter(results: Results) -> float:
    """Return the scatter about the plateau's line over the reaction, or over 1 % of the weight if more: noise is no stick-slip."""
    analysis, run = results.analysis, results.recorded
    settlement, reaction = run.settling("settlement"), run.settling("reaction")
    kept = settlement >= run.result.plateau_start
    size = max(abs(run.result.reaction), least_reaction(analysis) / UNCERTAIN)
    return float(np.std((reaction - run.result.reaction - run.result.slope * settlement)[kept]) / size) if kept.any() else math.nan
