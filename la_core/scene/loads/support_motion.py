"""The unit motion of every support: the same for all supports, by shares of the settlement, or by a profile of the settlement."""

from collections.abc import Iterator

import numpy as np

from la_core.errors import SceneError
from la_core.geometry import ROLES, Blocks
from la_core.scene.loads.dead_loads import Fault, chosen_by, not_there
from la_core.scene.schema.motion import support_twist
from la_core.scene.schema.scene_file import SceneFile, Settlement

NO_TURN = 1e-12  # of the settlement, between both ends of a support: round-off


def support_twists(settlement: Settlement | None, blocks: Blocks) -> np.ndarray | None:
    """Twists (B, 6) of all blocks for the unit settlement: velocity of the origin, angular velocity; zero for blocks that are no supports.

    The supports have the twist of one rigid body, times the ratio of the last zone that names the support. With a profile, the profile
    gives the velocities at both ends of a support, and a support whose ends move differently turns. None without a settlement.
    """
    twist = support_twist(settlement)
    if settlement is None or twist is None:
        return None
    support = blocks.role == ROLES["support"]
    if settlement.profile is not None:
        return np.where(support[:, None], _along_profile(settlement, twist[:3], blocks), 0.0)
    ratio = support.astype(float)
    for zone in settlement.zone:
        ratio[_in_zone(zone.blocks, blocks) & support] = zone.ratio
    return ratio[:, None] * twist


def own_twists(settlement: Settlement | None, blocks: Blocks) -> np.ndarray | None:
    """Twists (B, 6) of the supports for the unit settlement; None where all of them move as one rigid body."""
    twists, alike = support_twists(settlement, blocks), support_twist(settlement)
    return None if twists is None or np.all(twists[blocks.role == ROLES["support"]] == alike) else twists


def _in_zone(patterns: tuple[str, ...], blocks: Blocks) -> np.ndarray:
    """Mask (B,) of the blocks that patterns name."""
    return np.any([chosen_by(blocks, pattern) for pattern in patterns], axis=0)


def _along_profile(settlement: Settlement, direction: np.ndarray, blocks: Blocks) -> np.ndarray:
    """Twists (B, 6) with the velocities of a profile at both ends of every block.

    A block turns about its face opposite to `direction` (its top where it sinks), so that this face moves along `direction` alone.
    """
    axis = "xy".index(settlement.along)
    place, ratio = np.array(settlement.profile).T
    low, high = blocks.low[:, axis], blocks.high[:, axis]
    at_low, at_high = np.interp(low, place, ratio), np.interp(high, place, ratio)
    change = np.where(np.abs(at_high - at_low) > NO_TURN, at_high - at_low, 0.0)
    along, slope = np.eye(3)[axis], (change / (high - low))[:, None]
    top = np.minimum.reduceat(blocks.vertices @ direction, blocks.vertex_start[:-1])[:, None]
    at_origin = at_low[:, None] - slope * low[:, None]
    return np.concatenate([at_origin * direction + slope * top * along, slope * np.cross(along, direction)], axis=1)


def bent_over_supports(file: SceneFile, blocks: Blocks) -> Iterator[str]:
    """Yield a warning for a profile that bends between the ends of a support, which stays rigid."""
    settlement = file.settlement
    if settlement is None or settlement.profile is None:
        return
    axis, (place, ratio) = "xy".index(settlement.along), np.array(settlement.profile).T
    for block in np.flatnonzero(blocks.role == ROLES["support"]):
        low, high = blocks.low[block, axis], blocks.high[block, axis]
        straight = np.interp(place, [low, high], np.interp([low, high], place, ratio))
        bent = np.where((place > low) & (place < high), np.abs(ratio - straight), 0.0)
        if bent.max() > NO_TURN:
            at = f"{settlement.along} = {place[bent.argmax()]:g} m"
            yield (
                f'settlement.profile bends at {at}, within the support "{blocks.names[block]}", which moves as a rigid body: only the '
                "ratios at both its ends count. Divide the support there if the ground bends."
            )


def faults_of_settlement(file: SceneFile, blocks: Blocks) -> Iterator[Fault]:
    """Yield a fault for the first pattern of a zone that names no support, or else for a settlement that moves no support."""
    if file.settlement is None:
        return
    support = blocks.role == ROLES["support"]
    names = [name for name, moves in zip(blocks.names, support, strict=True) if moves]
    groups = [own for own, moves in zip(blocks.groups, support, strict=True) if moves]
    for number, zone in enumerate(file.settlement.zone):
        for pattern in zone.blocks:
            if not (chosen_by(blocks, pattern) & support).any():
                rule, hint = not_there(pattern, "support", names, groups)
                told = SceneError(f"settlement.zone[{number}].blocks", rule, hint=hint)
                yield ("settlement",), str(told)
                return
    if support.any() and not np.any(support_twists(file.settlement, blocks)):
        rule = "no support moves: every ratio is 0"
        hint = "give one `zone` another ratio, or the `profile` at one end of a support"
        yield ("settlement",), str(SceneError("settlement", rule, hint=hint))
