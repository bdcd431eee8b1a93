"""Effects of the run in YADE: displacement and recording. They depend on the contact points and the support's travel."""

from dataclasses import replace

import numpy as np

from la_core.errors import SceneError
from la_core.exchange import POSES
from la_core.geometry import Blocks, gaps, near_pairs
from la_core.model.assembly import Assembly
from la_core.model.joints import JointStiffness
from la_core.scene import Scene

GAP_OVER_TRAVEL = 10.0  # two blocks meet across such a gap only if each moves five times the travel; every run is checked
NO_GAP = 1e-6  # of the search distance: a smaller gap is round-off where two blocks meet in an edge
LARGE_RECORD = 200.0  # MB of stored states: of a larger run only the states that are judged are stored
_LISTED = "contacts are then those of the joints alone"


def decide_dem_effects(scene: Scene, assembly: Assembly, stiffness: JointStiffness) -> tuple[Assembly, float]:
    """Decide displacement and recording of the run in YADE.

    Returns the assembly with both effects, and the least gap (m) between blocks without a joint. The gap is NaN where it was
    not computed; a gap beyond the search distance counts as that distance. Raises SceneError where the scene requests
    small displacements although two blocks without a joint can meet.
    """
    displacement, why, gap = _displacement(scene, assembly, stiffness)
    recording = _recording(scene, assembly)
    effects = assembly.effects.with_effect("displacement", displacement, why).with_effect("recording", *recording)
    return replace(assembly, effects=effects), gap


def _displacement(scene: Scene, assembly: Assembly, stiffness: JointStiffness) -> tuple[str, str, float]:
    """Choice of the displacement, its reason, and the least gap (m)."""
    request = scene.effects.displacement
    if request == "finite":
        return request, "requested in the scene", float("nan")
    distance = distance_to_meet(assembly, stiffness)
    moves = "the blocks move along the load by" if assembly.has_live_load else "the support moves"
    moves += f" {distance / GAP_OVER_TRAVEL:.3g} m"
    gap, pair = least_gap(assembly, distance)
    if pair is None:
        why = f"blocks without a joint between them are at least {gap:.3g} m apart, and {moves}: {_LISTED}"
        return "small", f"requested in the scene, and {why}" if request == "small" else why, gap
    names = f'blocks "{assembly.blocks.names[pair[0]]}" and "{assembly.blocks.names[pair[1]]}"'
    near = f"{names} are {gap:.3g} m apart without a joint"
    if request == "small":
        rule = f"{near}, and may meet where {moves}: less than {distance:.3g} m is too near"
        raise scene.located(SceneError("effects.displacement", rule, value=request, hint='take "finite", or leave it out'))
    return "finite", f"{near}, and {moves}", gap


def distance_to_meet(assembly: Assembly, stiffness: JointStiffness) -> float:
    """Distance within which two blocks without a joint may meet, m."""
    return GAP_OVER_TRAVEL * stiffness.travel * assembly.support_speed


def least_gap(assembly: Assembly, distance: float) -> tuple[float, tuple[int, int] | None]:
    """Lower bound (m) of the least gap between blocks without a joint, and the pair of blocks with that gap.

    Beyond `distance` (m) the bound is `distance` and the pair is None. Pairs of two held blocks do not count. The gap
    between the bounding boxes is a lower bound of the gap, and so is the distance of one block from a face plane of the
    other.
    """
    interfaces, whole = assembly.interfaces, assembly.blocks
    blocks, owner = whole.parts, whole.part_block
    pairs = near_pairs(blocks, np.full(len(blocks), 0.5 * distance))
    owners = owner[pairs]
    joined = np.isin(_key(owners, whole), _key(np.stack([interfaces.block_a, interfaces.block_b], axis=1), whole))
    pairs = pairs[~joined & (owners[:, 0] != owners[:, 1]) & blocks.free[pairs].any(axis=1)]
    if not len(pairs):
        return distance, None
    a, b = pairs.T
    gap = gaps(blocks, pairs)
    nearest = int(np.argmin(gap))
    least = float(gap[nearest]) if gap[nearest] > NO_GAP * distance else 0.0
    return (least, (int(owner[a[nearest]]), int(owner[b[nearest]]))) if least < distance else (distance, None)


def _key(pairs: np.ndarray, blocks: Blocks) -> np.ndarray:
    """One number (N,) for each pair (N, 2) of blocks, the lower index first."""
    return pairs[:, 0] * len(blocks) + pairs[:, 1]


def _recording(scene: Scene, assembly: Assembly) -> tuple[str, str]:
    """Choice of the recording, and its reason."""
    request = scene.effects.recording
    if request != "auto":
        return request, "requested in the scene"
    states = int(scene.yade.get("poses", POSES)) + 1
    numbers = states * (6 * len(assembly.blocks) + 3 * len(assembly.points))  # displacements and rotations; contact forces
    size = 8e-6 * numbers
    limit = f"{LARGE_RECORD:g} MB"
    if size > LARGE_RECORD:
        return "plateau", f"{states} states take {size:.3g} MB, more than {limit}"
    return "states", f"{states} states take {size:.3g} MB, no more than {limit}"
