"""Check that a reduced model is valid: with plane motion alone, with blocks within reach alone, or without new contacts."""

from collections.abc import Iterator

import numpy as np

from comparison.judge.checks.tolerances import UNBALANCED
from comparison.verdict import Check, Verdict
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis, reach
from la_core.geometry import Blocks
from la_core.limit import Status, residual_in_space

IN_SPACE_STEP = "Set plane = false in the scene's [effects] table."
ALL_BLOCKS_STEP = "Set reach = false in the scene's [effects] table to model all blocks."
FINITE_STEP = 'Set displacement = "finite" in the scene\'s [effects] table.'
IN_SPACE = 1e-5  # of the mean block weight, or of the fastest block's speed: ten times the residual of limit analysis in the plane


def check_plane(analysis: LimitAnalysis) -> Iterator[Check]:
    """Yield the check that the answer of a plane model also solves the model in space; no check for a model in space."""
    answer = analysis.main_answer
    if not analysis.assembly.effects.plane or answer.status is not Status.SOLVED:
        return
    worst = residual_in_space(analysis.assembly, answer.twists, answer.forces)
    holds = worst <= IN_SPACE
    misses = f"In space the plane answer is out of equilibrium or lets blocks penetrate by {worst:.1e} of a block ({IN_SPACE:g} accepted)"
    verdict, reason, step = (Verdict.AGREE, "", "") if holds else (Verdict.INCONCLUSIVE, f"{misses}.", IN_SPACE_STEP)
    yield Check("plane answer in space", verdict, worst, None, None, IN_SPACE, "of a block", reason, step)


def check_reach(results: Results) -> Iterator[Check]:
    """Yield the check that the blocks set aside would stand under YADE's forces, and that YADE's mechanism does not include them.

    The tolerance of their equilibrium is the accuracy of YADE's own state. There is no such check if all blocks were modelled.
    """
    analysis, run = results.analysis, results.recorded
    region = analysis.assembly
    if not region.effects.reach:
        return
    obstacle = reach.why_not_valid(analysis.whole, region, run.mechanism(), run.plateau_forces(), UNBALANCED)
    verdict, reason, step = (Verdict.INCONCLUSIVE, f"In YADE {obstacle}.", ALL_BLOCKS_STEP) if obstacle else (Verdict.AGREE, "", "")
    yield Check("what was set aside stands", verdict, reason=reason, next_step=step)


def check_displacement(results: Results) -> Iterator[Check]:
    """Yield the check that no block moved more than half the least gap, so that no new contact was missed.

    Two blocks approach each other by at most twice the largest displacement. There is no such check for finite displacements.
    """
    analysis, run = results.analysis, results.recorded
    if analysis.assembly.effects.displacement != "small" or not len(run.poses.displacement):
        return
    blocks, limit = analysis.assembly.blocks, 0.5 * analysis.least_gap
    moved = largest_displacements(blocks, run)
    most = int(np.argmax(moved))  # the first undefined one, if any is undefined
    name, largest = "displacements within the least gap", float(moved[most])
    if largest <= limit:
        yield Check(name, Verdict.AGREE, 0.0, largest, largest, limit, "m")
        return
    reason = (
        f'In YADE block "{blocks.names[most]}" moved {largest:.3g} m, more than half the least gap of {analysis.least_gap:.3g} m '
        "between blocks without a joint, so contacts may have been missed."
    )
    yield Check(name, Verdict.INCONCLUSIVE, 0.0, largest, largest, limit, "m", reason, FINITE_STEP)


def largest_displacements(blocks: Blocks, run: Run) -> np.ndarray:
    """Return an upper bound (B,) of the displacement of any point of each block over the stored states, m."""
    owner = blocks.vertex_block
    size = np.zeros(len(blocks))
    np.maximum.at(size, owner, np.linalg.norm(blocks.vertices - blocks.centroid[owner], axis=1))
    shift, turn = (np.linalg.norm(getattr(run.poses, name), axis=2) for name in ("displacement", "rotation"))
    bound: np.ndarray = (shift + turn * size).max(axis=0)
    return bound
