"""Whether a run with small displacements kept them small: blocks without a joint must not have been able to meet."""

from collections.abc import Iterator

import numpy as np

from comparison.check import Check, Verdict
from comparison.record import Run
from la_core.analysis import LimitAnalysis
from la_core.geometry import Blocks


def check_displacement(analysis: LimitAnalysis, run: Run) -> Iterator[Check]:
    """Two blocks come nearer by at most twice the largest displacement, so half the least gap bounds it; nothing for finite ones."""
    if analysis.assembly.effects.displacement != "small" or not len(run.poses["displacement"]):
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
    shift, turn = (np.linalg.norm(run.poses[name], axis=2) for name in ("displacement", "rotation"))
    bound: np.ndarray = (shift + turn * size).max(axis=0)
    return bound
