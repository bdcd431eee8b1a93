"""What a reduced model left out changed nothing: motion out of the plane, blocks out of reach, contacts that come into being."""

from collections.abc import Iterator

import numpy as np

from comparison.judge.check import Check, Verdict
from comparison.judge.tolerances import UNBALANCED
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis, reach
from la_core.geometry import Blocks
from la_core.limit import Status, residual_in_space

IN_SPACE = 1e-5  # of the mean block weight, or of the fastest block: ten times what limit analysis leaves in the plane


def check_plane(analysis: LimitAnalysis) -> Iterator[Check]:
    """Lifted to the model in space, a plane answer has to be an answer there; nothing for a model in space."""
    least = analysis.bounds[analysis.main]
    if not analysis.assembly.effects.plane or least.status is not Status.SOLVED:
        return
    worst = residual_in_space(analysis.assembly, least.twists, least.forces)
    holds = worst <= IN_SPACE
    reason = "" if holds else "In space the plane answer is out of equilibrium or blocks penetrate; ask for effects.plane = false."
    verdict = Verdict.AGREE if holds else Verdict.INCONCLUSIVE
    yield Check("plane answer in space", verdict, worst, None, None, IN_SPACE, "of a block", reason)


def check_reach(results: Results) -> Iterator[Check]:
    """Whether the blocks set aside stand under YADE's forces, as far as its state is balanced, and its mechanism ends before them.

    Nothing where all were modelled.
    """
    analysis, run = results.analysis, results.recorded
    part = analysis.assembly
    if not part.effects.reach:
        return
    obstacle = reach.why_not_valid(analysis.whole, part, run.mechanism(), run.plateau_forces(), UNBALANCED)
    verdict = Verdict.INCONCLUSIVE if obstacle else Verdict.AGREE
    reason = f"In YADE {obstacle}: model the whole structure ([effects] reach = false)." if obstacle else ""
    yield Check("what was set aside stands", verdict, reason=reason)


def check_displacement(results: Results) -> Iterator[Check]:
    """Two blocks come nearer by at most twice the largest displacement, so half the least gap bounds it; nothing for finite ones."""
    analysis, run = results.analysis, results.recorded
    if analysis.assembly.effects.displacement != "small" or not len(run.poses.displacement):
        return
    blocks, limit = analysis.assembly.blocks, 0.5 * analysis.least_gap
    moved = largest_displacements(blocks, run)
    most = int(np.argmax(moved))  # the first undefined one, if any is undefined
    name, found = "displacements within the least gap", float(moved[most])
    if found <= limit:
        yield Check(name, Verdict.AGREE, 0.0, found, found, limit, "m")
        return
    reason = (
        f'In YADE block "{blocks.names[most]}" moved {found:.3g} m, more than half the least gap of {analysis.least_gap:.3g} m between '
        'blocks without a joint, so contacts may have been missed: run it with displacement = "finite" in the table [effects].'
    )
    yield Check(name, Verdict.INCONCLUSIVE, 0.0, found, found, limit, "m", reason)


def largest_displacements(blocks: Blocks, run: Run) -> np.ndarray:
    """Upper bound (B,) of the displacement of any point of each block over the stored states, m."""
    owner = np.repeat(np.arange(len(blocks)), np.diff(blocks.vertex_start))
    size = np.zeros(len(blocks))
    np.maximum.at(size, owner, np.linalg.norm(blocks.vertices - blocks.centroid[owner], axis=1))
    shift, turn = (np.linalg.norm(getattr(run.poses, name), axis=2) for name in ("displacement", "rotation"))
    bound: np.ndarray = (shift + turn * size).max(axis=0)
    return bound
