"""Compare YADE's mechanism with that of limit analysis, if limit analysis determines it.

Speeds are compared with the unit motion of the support. So noise is never compared with noise: if no block moves in either method, the
mechanisms are the same. If joints slide without dilatancy, the mechanism need not be unique, even if the reaction is.
"""

from collections.abc import Iterator

import numpy as np

from comparison.judge.checks.tolerances import reaction_tolerance
from comparison.numbers import percent
from comparison.verdict import Check, Verdict
from comparison.yade import Results
from la_core.measures import MOVING_SHARE, block_speeds, fastest_speed, mechanism, residuals

SIMILAR = 0.95  # least modal assurance of two mechanisms that look the same
ADMISSIBLE = 0.02  # of the fastest block's speed: elastic strain of the joints in YADE's mechanism, which the flow rule does not include
SAME_MASS = 0.05  # share of the mass that may move in one method and not in the other

NEARLY_AT_REST = (
    f"A block counts as moving from {percent(MOVING_SHARE)} of the fastest speed on. Some blocks are just above it in one method and just "
    "below it in the other: their speeds agree."
)
MORE_STATES = "Let YADE store more states ([yade] poses)."
COMPARE_MECHANISMS = "Look at both mechanisms in the report's 3D view, and run the scene with a little lower and a little higher friction."
BOUNDS_LEFT = (
    "Work with the bounds and YADE's value. Where a support settles, a thrust ([yade] wedging) may hold the blocks in limit analysis."
)

EXCLUDED = "Joints slide in YADE, but the scene excludes sliding in limit analysis."
DILATES = "Sliding joints dilate in the associated mechanism and not in YADE."


def check_mechanism(results: Results, predicted: np.ndarray, determined: bool, is_alone: bool) -> Iterator[Check]:
    """Yield the checks of similarity and of the moving blocks.

    Parameters
    ----------
    results : Results
        Both methods' results.
    predicted : (B, 6) array
        Predicted mechanism for a unit motion of the support.
    determined : bool
        Whether no joint slides, so that limit analysis determines the mechanism.
    is_alone : bool
        Whether joints slide and the mechanism is that of the associated answer, in which sliding joints dilate.
    """
    assembly, twists = results.analysis.assembly, results.recorded.mechanism()
    blocks = assembly.blocks
    if np.isnan(twists).any():
        reason = "YADE stored fewer than two states on the plateau, so its mechanism is unknown."
        yield Check("mechanism similarity", Verdict.INCONCLUSIVE, reason=reason, next_step=MORE_STATES)
        return
    moves = [mechanism.moving(assembly, motion) for motion in (predicted, twists)]
    at_rest = not any(moving.any() for moving in moves)
    alike = 1.0 if at_rest else mechanism.similarity(blocks, predicted, twists)
    mass = 0.0 if at_rest else _mass_in_one_only(results, predicted, moves)
    other, why = _otherwise(results, twists, determined, is_alone)
    step = "" if other is Verdict.AGREE else COMPARE_MECHANISMS
    same = alike >= SIMILAR
    reason = "" if same else f"The mechanisms differ (modal assurance {alike:.3f}, at least {SIMILAR} for agreement).{why}"
    reason = "No block moves in either method: only the support moves." if at_rest else reason
    numbers = 1.0, alike, alike - 1.0, 1.0 - SIMILAR
    yield Check("mechanism similarity", Verdict.AGREE if same else other, *numbers, "", reason, "" if same else step)
    same = mass <= SAME_MASS
    reason = "" if same else f"Blocks with {percent(mass)} of the mass move in one method only ({percent(SAME_MASS)} accepted).{why}"
    shares = [mechanism.moving_mass_share(assembly, motion) for motion in (predicted, twists)]
    reason = NEARLY_AT_REST if same and abs(shares[1] - shares[0]) > SAME_MASS else reason
    numbers = shares[0], shares[1], mass, SAME_MASS
    yield Check("moving blocks", Verdict.AGREE if same else other, *numbers, "of the mass", reason, "" if same else step)


def _mass_in_one_only(results: Results, predicted: np.ndarray, moves: list[np.ndarray]) -> float:
    """Return the share of the mass that moves in one method only.

    A block counts only if its two velocities also differ by more than the threshold. So a block just above the threshold in one method
    and just below it in the other does not count.
    """
    assembly, twists = results.analysis.assembly, results.recorded.mechanism()
    blocks = assembly.blocks
    fastest = max(fastest_speed(assembly, motion) for motion in (predicted, twists))
    apart = block_speeds(blocks, twists - predicted) > MOVING_SHARE * fastest
    return float(blocks.mass[(moves[0] != moves[1]) & apart].sum() / assembly.movable_mass)


def _otherwise(results: Results, twists: np.ndarray, determined: bool, is_alone: bool) -> tuple[Verdict, str]:
    """Return the verdict on mechanisms that differ, and the reason."""
    if is_alone and results.analysis.assembly.effects.friction == "none-slides":
        return Verdict.INCONCLUSIVE, f" {EXCLUDED}"
    if is_alone:
        return Verdict.INCONCLUSIVE, f" {DILATES}"
    if not determined:
        return Verdict.INCONCLUSIVE, " Where joints slide without dilatancy, the mechanism need not be unique."
    if _is_collapse_mechanism(results, twists):
        return Verdict.AGREE, " YADE's mechanism is admissible and does the same work, so the collapse mechanism is not unique."
    return Verdict.DISAGREE, ""


def _is_collapse_mechanism(results: Results, twists: np.ndarray) -> bool:
    """Return whether twists (B, 6) for a unit motion of the support also solve limit analysis: by the flow rule and by their work."""
    analysis = results.analysis
    work = float(np.sum(analysis.assembly.dead_load * results.per_drive(twists)))
    value = -work if results.scene.live is not None else work
    misses = abs(value - analysis.bounds[analysis.main].value)
    obeys = residuals.flow_rule_violation(analysis.assembly, twists) <= ADMISSIBLE
    return obeys and misses <= reaction_tolerance(results)
