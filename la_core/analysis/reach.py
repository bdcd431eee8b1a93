"""Reach: only the region that the support's motion can touch is modelled, the other free blocks are set aside, held at rest.

The bounds are always those of the whole structure: joints that dilate by the associated flow rule push everything beside them, to the far
end of a wall, and a bound costs a single programme. What the region spares is the work behind many: Coulomb's prediction and YADE.
An answer of the region counts for the whole structure when
    what is set aside stands under its own weight and the forces of the region, with the same friction, so that both parts
    together are a state of force of the whole structure in equilibrium and within the friction law;
    and layers of blocks at rest lie between what is set aside and all that moves or rests on the support, so that friction's history
    there is that of free neighbours.
The first alone is not enough for friction that does not dilate, whose states of force are not unique: a wall may hang between rigid flanks.
"""

from dataclasses import replace

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import breadth_first_order

from la_core.coulomb import ACCEPTED_RESIDUAL
from la_core.exchange import FIXED, SUPPORT
from la_core.geometry import Interfaces
from la_core.limit import box_limits, maximise, scaled_problem
from la_core.measures import MOVING_SHARE, block_speeds, residuals
from la_core.model import Assembly, global_forces, twists_of
from la_core.scene import Scene

# Walls of 6 and 12 courses, mu 0.3 to 0.9, whose middle or end settles: with no layer around all that rests on the support the
# prediction may lose the whole reaction, with 1 it is off by 11 %, with 2 by 8 %. With 4 it is off by less than 1 %, and where friction's
# history has more say the whole structure's own answer moves by more than that with shorter steps, towards the region's.
LAYERS = (4, 8)  # of neighbours around all that rests on the support, one attempt each
MARGIN = 3  # layers of blocks at rest between a mechanism and what is set aside
LEAST_SHARE, LEAST_BLOCKS = 0.4, 100  # of the free blocks: setting aside less is not worth a proof, measured on the shipped scenes
RESTS_ON = 0.1  # component along gravity of an interface's normal, from which on one block rests on the other
TOLERANCE = 0.025 * ACCEPTED_RESIDUAL  # asked of the proof's programme, in mean block weights


def candidate_masks(scene: Scene, assembly: Assembly) -> tuple[list[np.ndarray], str]:
    """Masks (B,) of free blocks to set aside, the boldest first, and why the whole structure is modelled where none may be."""
    asked, free = scene.effects.reach, assembly.blocks.free
    if scene.support_twist is None:
        return [], "a live load acts on every block"
    if asked is False:
        return [], "the whole structure is asked for in the scene"
    if asked == "auto" and assembly.effects.elasticity == "path":
        return [], "a path is asked for, and at its start every block sags"
    small, large = (free & ~region(assembly, layers) for layers in LAYERS)
    masks = [small, large] if large.sum() < small.sum() else [small]
    least = 1 if asked is True else max(LEAST_BLOCKS, LEAST_SHARE * free.sum())
    spared = f"all but {small.sum()} of {free.sum()} free blocks" if small.any() else "every free block"
    few = f"the motion of the support may reach {spared}"
    return [mask for mask in masks if mask.sum() >= least], few


def reason(part: Assembly) -> str:
    """Why the whole structure need not be modelled."""
    count = int(part.aside.sum())
    there = f"{count} of {count + int(part.blocks.free.sum())} free blocks"
    return f"{there} are set aside: they stand at rest under the forces of those that the support's motion can touch"


def region(assembly: Assembly, layers: int) -> np.ndarray:
    """Mask (B,) of the free blocks on the support and all that rests on them, `layers` of neighbours, and all that rests on these."""
    blocks, interfaces = assembly.blocks, assembly.interfaces
    support, a, b = blocks.role == SUPPORT, interfaces.block_a, interfaces.block_b
    start = np.zeros(len(blocks), dtype=bool)
    start[a[support[b]]] = start[b[support[a]]] = True
    gravity = assembly.dead_load[:, :3].sum(axis=0)
    rise = -interfaces.normal @ gravity / np.linalg.norm(gravity)
    below = np.concatenate([a[rise > RESTS_ON], b[rise < -RESTS_ON]])
    above = np.concatenate([b[rise > RESTS_ON], a[rise < -RESTS_ON]])
    bears = blocks.free[below] & blocks.free[above]
    resting = below[bears], above[bears]
    return _closed(_grown(assembly, _closed(start & blocks.free, *resting), layers), *resting)


def _closed(blocks: np.ndarray, below: np.ndarray, above: np.ndarray) -> np.ndarray:
    """The blocks `blocks` (B,) and all that rests on them, directly or not, where each `above` rests on a block `below`."""
    first, size = np.flatnonzero(blocks), len(blocks)  # a node more in the graph bears the first ones
    edges = np.concatenate([below, np.full(len(first), size)]), np.concatenate([above, first])
    graph = sparse.csr_matrix((np.ones(len(edges[0])), edges), shape=(size + 1, size + 1))
    reached = np.zeros(size + 1, dtype=bool)
    reached[breadth_first_order(graph, size, return_predecessors=False)] = True
    return reached[:size]


def _grown(assembly: Assembly, blocks: np.ndarray, layers: int) -> np.ndarray:
    """The free blocks `blocks` (B,) and `layers` of free neighbours around them."""
    free, interfaces = assembly.blocks.free, assembly.interfaces
    between = free[interfaces.block_a] & free[interfaces.block_b]
    a, b = interfaces.block_a[between], interfaces.block_b[between]
    grown = blocks.copy()
    for _ in range(layers):
        near_a, near_b = a[grown[b]], b[grown[a]]
        grown[near_a] = grown[near_b] = True
    return grown


def set_aside(assembly: Assembly, aside: np.ndarray) -> Assembly:
    """The same assembly with the free blocks `aside` (B,) held at rest, as ground: without load, without contact between held ones."""
    return replace(_hold(assembly, aside), aside=assembly.aside | aside)


def kept_points(assembly: Assembly, aside: np.ndarray) -> np.ndarray:
    """Mask (C,) of the contact points of an assembly that are left when `aside` (B,) is held."""
    free = assembly.blocks.free & ~aside
    a, b = assembly.contact_blocks
    return np.asarray(free[a] | free[b])


def why_not_valid(whole: Assembly, part: Assembly, twists: np.ndarray, forces: np.ndarray, accepted: float = ACCEPTED_RESIDUAL) -> str:
    """Return why an answer of `part`, its twists (B, 6) and forces (C, 3) in N, does not hold for the whole assembly, or "".

    accepted: unbalanced force, over the mean block weight, up to which what is set aside stands. NaN twists are not judged.
    """
    if not np.isfinite(forces).all():
        return "the region has no answer"
    near = _grown(whole, part.aside, MARGIN)
    if (on_support := near & region(whole, 0)).any():
        return f'block "{whole.blocks.names[on_support.argmax()]}", on the support, lies within {MARGIN} blocks of what was set aside'
    if np.isfinite(twists).all():
        speed = block_speeds(whole.blocks, twists)
        nearest = np.where(near, speed, 0.0)
        if nearest.max() > MOVING_SHARE * speed.max():  # the support is among the fastest, so noise is no motion
            return f'block "{whole.blocks.names[nearest.argmax()]}" moves, within {MARGIN} blocks of what was set aside'
    lifted, falls = extend_forces(whole, part, forces)
    rest = _hold(whole, whole.blocks.free & ~part.aside)
    at_rest = kept_points(whole, whole.blocks.free & ~part.aside)
    if max(residuals.equilibrium_residual(rest, lifted[at_rest]), residuals.cone_violation(rest, lifted[at_rest])) <= accepted:
        return ""
    return f'block "{whole.blocks.names[falls]}", set aside, would not stand under the forces of the region'


def extend_forces(whole: Assembly, part: Assembly, forces: np.ndarray) -> tuple[np.ndarray, int]:
    """Contact forces (C, 3) in N of the whole assembly from those of `part`, and the block that falls first where it does not stand.

    The part set aside takes the forces of the region as loads. Its greatest power over admissible motions of bounded size is the least
    sum of forces that nothing balances; the multipliers are its contact forces.
    """
    held = kept_points(whole, part.aside)
    lifted = np.zeros((len(whole.points), 3))
    lifted[held] = forces
    others = whole.blocks.free & ~part.aside
    rest = _hold(whole, others)
    own = ~held[kept_points(whole, others)]  # the region's contact points have their forces
    load = np.where(part.aside[:, None], whole.dead_load + whole.contact_wrenches(lifted), 0.0)
    alone = replace(rest, points=rest.points.subset(own), dead_load=load)
    problem, count = scaled_problem(alone), int(part.aside.sum())
    rows, offset, cones = box_limits(problem)
    answer = maximise(problem.power * count, rows, offset, cones, TOLERANCE, equilibrate=False, refine=False)
    split, limits = problem.cones.equalities, rows.shape[0] - problem.rows.shape[0]
    multipliers = np.delete(answer.multipliers, np.arange(split, split + limits)) / count
    lifted[~held] = global_forces(alone, problem.flow_rule.T @ multipliers)
    power = np.sum(load * twists_of(alone, answer.x), axis=1)
    return lifted, int(power.argmax())


def _hold(assembly: Assembly, held: np.ndarray) -> Assembly:
    """The assembly with the blocks `held` (B,) fixed."""
    blocks = replace(assembly.blocks, role=np.where(held, FIXED, assembly.blocks.role))
    interfaces = assembly.interfaces
    keep = blocks.free[interfaces.block_a] | blocks.free[interfaces.block_b]
    corners = np.diff(interfaces.polygon_start)
    left = Interfaces(
        block_a=interfaces.block_a[keep],
        block_b=interfaces.block_b[keep],
        normal=interfaces.normal[keep],
        area=interfaces.area[keep],
        polygon=interfaces.polygon[np.repeat(keep, corners)],
        polygon_start=np.concatenate([[0], np.cumsum(corners[keep])]),
    )
    points = assembly.points.subset(keep[assembly.points.interface])
    points = replace(points, interface=(np.cumsum(keep) - 1)[points.interface])
    return replace(assembly, blocks=blocks, interfaces=left, points=points, dead_load=np.where(held[:, None], 0.0, assembly.dead_load))
