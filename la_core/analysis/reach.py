"""Reach: model only the region that the support's motion affects; hold all other free blocks at rest ("set aside").

The bounds always belong to the whole structure. Joints that dilate by the associated flow rule push all their
neighbours, up to the far end of a wall, and a bound costs one programme only. The region saves work in the prediction,
which needs many programmes, and in YADE. An answer of the region holds for the whole structure under two conditions:
    1. The blocks set aside stand under their own weight and the forces of the region, with the same friction. Both
       parts together are then a state of force of the whole structure, in equilibrium and within the friction law.
    2. Layers of blocks at rest lie between the blocks set aside and all blocks that move or rest on the support. The
       history of friction there is then the same as beside free neighbours.
The first condition is not enough for friction without dilatancy, because its states of force are not unique: a wall may
hang between rigid flanks.
"""

from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order

from la_core.coulomb import ACCEPTED_RESIDUAL
from la_core.exchange import FIXED, SUPPORT
from la_core.geometry import near_pairs
from la_core.limit import box_limits, maximise, scaled_problem
from la_core.measures import MOVING_SHARE, block_speeds, fastest_speed, residuals
from la_core.model import Assembly, global_forces, twists_of
from la_core.scene import Scene

# Walls of 6 and 12 courses, mu 0.3 to 0.9, whose middle or end settles: without a layer around all blocks that rest on the support the
# prediction may lose the whole reaction. With 1 layer it is off by 11 %, with 2 by 8 %, with 4 by less than 1 %, and on large random walls
# by up to 1.5 %. Where the history of friction matters more, shorter steps change the whole structure's answer by more than that, towards
# the region's.
LAYERS = (4, 8)  # of neighbours around all blocks that rest on the support, one attempt each
MARGIN = 3  # layers of blocks at rest between a mechanism and the blocks set aside
# Of the free blocks. A smaller share is not worth a proof that may fail. If the proof holds, prediction and YADE model fewer blocks.
# If it fails, the prediction is made again. The proof failed on two of nine random walls of 530 to 910 blocks, so that a share below about
# 2/9 would cost the prediction more than it saves. That was before a failing region was given up after its coarsest path.
LEAST_SHARE, LEAST_BLOCKS = 0.25, 100
RESTS_ON = 0.1  # component along gravity of an interface's normal, from which on one block rests on the other
PATH_IS_REQUESTED = "a path is requested, and at its start every block sags"  # reason to model the whole structure
TOLERANCE = 0.025 * ACCEPTED_RESIDUAL  # of the solver for the proof's programme, in mean block weights


def candidate_masks(scene: Scene, assembly: Assembly, may_meet: float) -> tuple[list[np.ndarray], str]:
    """Return masks (B,) of free blocks to set aside in the order to try them, and the reason for the whole structure otherwise.

    scene: its [effects] reach allows masks, forbids them or leaves them to the program. assembly: the whole structure's.
    may_meet: distance (m) within which two blocks without a joint may meet.
    """
    request, free = scene.effects.reach, assembly.blocks.free
    if scene.support_twist is None:
        return [], "a live load acts on every block"
    if request is False:
        return [], "the scene requests the whole structure"
    if request == "auto" and assembly.effects.elasticity == "path":
        return [], PATH_IS_REQUESTED
    small, large = (free & ~region(assembly, layers) for layers in LAYERS)
    masks = [small, large] if large.sum() < small.sum() else [small]
    least = 1 if request is True else max(LEAST_BLOCKS, LEAST_SHARE * free.sum())
    masks = [mask for mask in masks if mask.sum() >= least]
    unjoined = apart(assembly, may_meet)
    if unjoined.any() and not any(np.array_equal(unjoined, mask) for mask in masks):
        masks.append(unjoined)
    why_whole = "the motion of the support may affect every free block"
    if small.any():
        too_few = f"fewer than {LEAST_BLOCKS} or than {100.0 * LEAST_SHARE:.0f} % are not worth setting aside"
        why_whole = f"{small.sum()} of {free.sum()} free blocks lie far enough from the support to be set aside; {too_few}"
    return masks, why_whole


def reason(reduced: Assembly) -> str:
    """Return why a reduced assembly is enough, with the number of blocks set aside."""
    count = int(reduced.aside.sum())
    total = count + int(reduced.blocks.free.sum())
    return f"{count} of {total} free blocks are set aside: they stand at rest under the forces of the modelled region"


def region(assembly: Assembly, layers: int) -> np.ndarray:
    """Return the mask (B,) of the free blocks that the support's motion may affect.

    They are the blocks on the support and all blocks that rest on these, then `layers` of neighbours and all blocks that rest on those.
    """
    blocks, interfaces = assembly.blocks, assembly.interfaces
    support, a, b = blocks.role == SUPPORT, interfaces.block_a, interfaces.block_b
    start = np.zeros(len(blocks), dtype=bool)
    start[a[support[b]]] = start[b[support[a]]] = True
    rise = -interfaces.normal @ assembly.down
    below = np.concatenate([a[rise > RESTS_ON], b[rise < -RESTS_ON]])
    above = np.concatenate([b[rise > RESTS_ON], a[rise < -RESTS_ON]])
    bears = blocks.free[below] & blocks.free[above]
    resting = below[bears], above[bears]
    return _closed(_grown(assembly, _closed(start & blocks.free, *resting), layers), *resting)


def apart(assembly: Assembly, may_meet: float) -> np.ndarray:
    """Return the mask (B,) of the free blocks that no chain of blocks joins to the support: its motion cannot affect them.

    A fixed block ends a chain. Blocks whose bounding boxes are at most `may_meet` (m) apart count as joined.
    """
    blocks, interfaces = assembly.blocks, assembly.interfaces
    parts, owner = blocks.parts, blocks.part_block
    near = owner[near_pairs(parts, np.full(len(parts), 0.5 * may_meet))]
    pairs = np.concatenate([near, np.stack([interfaces.block_a, interfaces.block_b], axis=1)])
    a, b = pairs[(blocks.role[pairs] != FIXED).all(axis=1)].T
    return blocks.free & ~_closed(blocks.role == SUPPORT, np.concatenate([a, b]), np.concatenate([b, a]))


def _closed(blocks: np.ndarray, below: np.ndarray, above: np.ndarray) -> np.ndarray:
    """Return the mask (B,) of `blocks` (B,) and all that rests on them, directly or not; above[i] rests on below[i]."""
    first, size = np.flatnonzero(blocks), len(blocks)  # an extra node in the graph bears the first blocks
    edges = np.concatenate([below, np.full(len(first), size)]), np.concatenate([above, first])
    graph = sparse.csr_matrix((np.ones(len(edges[0])), edges), shape=(size + 1, size + 1))
    reached = np.zeros(size + 1, dtype=bool)
    reached[breadth_first_order(graph, size, return_predecessors=False)] = True
    return reached[:size]


def _grown(assembly: Assembly, blocks: np.ndarray, layers: int) -> np.ndarray:
    """Return the mask (B,) of the free blocks `blocks` (B,) and `layers` of free neighbours around them."""
    free, interfaces = assembly.blocks.free, assembly.interfaces
    between = free[interfaces.block_a] & free[interfaces.block_b]
    a, b = interfaces.block_a[between], interfaces.block_b[between]
    grown = blocks.copy()
    for _ in range(layers):
        near_a, near_b = a[grown[b]], b[grown[a]]
        grown[near_a] = grown[near_b] = True
    return grown


def set_aside(assembly: Assembly, aside: np.ndarray) -> Assembly:
    """Hold the free blocks `aside` (B,) at rest, as ground: without load, and without contacts between held blocks."""
    return replace(_hold(assembly, aside), aside=assembly.aside | aside)


def kept_points(assembly: Assembly, aside: np.ndarray) -> np.ndarray:
    """Return the mask (C,) of the contact points that remain when `aside` (B,) is held."""
    free = assembly.blocks.free & ~aside
    a, b = assembly.contact_blocks
    return np.asarray(free[a] | free[b])


def why_not_valid(whole: Assembly, reduced: Assembly, twists: np.ndarray, forces: np.ndarray, accepted: float = ACCEPTED_RESIDUAL) -> str:
    """Return why the reduced answer does not hold for the whole structure, or "".

    Parameters
    ----------
    whole : Assembly
        Assembly of the whole structure.
    reduced : Assembly
        The same with blocks set aside.
    twists : ndarray, shape (B, 6)
        Mechanism of the reduced assembly; NaN twists are not judged.
    forces : ndarray, shape (C, 3)
        Contact forces of the reduced assembly, N.
    accepted : float
        Largest residual of the blocks set aside, over the mean block weight, at which they count as standing.

    Returns
    -------
    str
        A clause without a full stop that names a block, or "" where the answer holds.
    """
    if not np.isfinite(forces).all():
        return "the region has no answer"
    near = _grown(whole, reduced.aside, MARGIN)
    if (on_support := near & region(whole, 0)).any():
        name = whole.blocks.names[on_support.argmax()]
        return f'block "{name}" rests on the support within {MARGIN} layers of the blocks set aside'
    if np.isfinite(twists).all():
        speed = block_speeds(whole.blocks, twists)
        nearest = np.where(near, speed, 0.0)
        if nearest.max() > MOVING_SHARE * fastest_speed(whole, twists):
            return f'block "{whole.blocks.names[nearest.argmax()]}" moves within {MARGIN} layers of the blocks set aside'
    extended, falls = extend_forces(whole, reduced, forces)
    rest = _hold(whole, whole.blocks.free & ~reduced.aside)
    at_rest = kept_points(whole, whole.blocks.free & ~reduced.aside)
    if max(residuals.equilibrium_residual(rest, extended[at_rest]), residuals.cone_violation(rest, extended[at_rest])) <= accepted:
        return ""
    return f'block "{whole.blocks.names[falls]}", set aside, would not stand under the forces of the region'


def extend_forces(whole: Assembly, reduced: Assembly, forces: np.ndarray) -> tuple[np.ndarray, int]:
    """Extend the contact forces of a reduced assembly to the whole structure.

    Parameters
    ----------
    whole : Assembly
        Assembly of the whole structure, with C contact points.
    reduced : Assembly
        The same with blocks set aside.
    forces : ndarray
        Contact forces of the reduced assembly, N; one row of three per contact point.

    Returns
    -------
    extended : ndarray, shape (C, 3)
        Contact forces of the whole structure, N.
    falling : int
        Index of the block that falls first where the blocks set aside do not stand.

    Notes
    -----
    The blocks set aside carry the forces of the region as loads. The programme maximises the power of all their loads
    over admissible motions of bounded size. Its value is the least sum of unbalanced forces; its multipliers are the
    contact forces.
    """
    in_region = kept_points(whole, reduced.aside)
    extended = np.zeros((len(whole.points), 3))
    extended[in_region] = forces
    others = whole.blocks.free & ~reduced.aside
    rest = _hold(whole, others)
    unknown = ~in_region[kept_points(whole, others)]  # the forces at the region's contact points are known
    load = np.where(reduced.aside[:, None], whole.dead_load + whole.contact_wrenches(extended), 0.0)
    alone = replace(rest, points=rest.points.subset(unknown), dead_load=load)
    problem, count = scaled_problem(alone), int(reduced.aside.sum())
    rows, offset, cones = box_limits(problem)
    answer = maximise(problem.power * count, rows, offset, cones, TOLERANCE, equilibrate=False, refine=False)
    split, limits = problem.cones.equalities, rows.shape[0] - problem.rows.shape[0]
    multipliers = np.delete(answer.multipliers, np.arange(split, split + limits)) / count
    extended[~in_region] = global_forces(alone, problem.flow_rule.T @ multipliers)
    power = np.sum(load * twists_of(alone, answer.x), axis=1)
    return extended, int(power.argmax())


def _hold(assembly: Assembly, held: np.ndarray) -> Assembly:
    """Return the assembly with the blocks `held` (B,) fixed; contacts between held blocks are removed."""
    blocks = replace(assembly.blocks, role=np.where(held, FIXED, assembly.blocks.role))
    interfaces = assembly.interfaces
    keep = blocks.free[interfaces.block_a] | blocks.free[interfaces.block_b]
    remaining = interfaces.subset(keep)
    points = assembly.points.subset(keep[assembly.points.interface])
    points = replace(points, interface=(np.cumsum(keep) - 1)[points.interface])
    dead_load, applied_load = (np.where(held[:, None], 0.0, load) for load in (assembly.dead_load, assembly.applied_load))
    return replace(assembly, blocks=blocks, interfaces=remaining, points=points, dead_load=dead_load, applied_load=applied_load)
