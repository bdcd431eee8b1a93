"""Equilibrium, cones, flow rule and duality, written independently of `la_core` to check its answers, and other solvers."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.optimize import linprog
from scipy.sparse import coo_matrix, csc_matrix, csr_matrix, hstack, identity

from la_core.exchange.fields import FREE, SUPPORT
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.linearised import solve_linearised
from la_core.limit.problem import Drive
from la_core.limit.static import StaticSolution, coulomb_limits, solve_static
from la_core.model.assembly import Assembly
from la_core.scene.scene import Scene

RESIDUAL = 1e-6  # over the mean block weight, or the fastest block: largest residual of a solved answer of la_core
FACETS = 16  # of the pyramids that bracket a cone in space
VERDICTS = (Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED)


def drives(assembly: Assembly) -> list[Drive]:
    return [Drive.LIVE] if assembly.has_live_load else [Drive.YIELDING, Drive.PUSHING]


def kept(assembly: Assembly) -> list[int]:
    """Return the indices of a block's freedoms in the plane or in space."""
    return [0, 2, 4] if assembly.effects.plane else list(range(6))


def jumps(assembly: Assembly, twists: np.ndarray) -> np.ndarray:
    """Return the velocity (C, 3) of block b relative to block a at every contact point."""

    def velocity(block: np.ndarray) -> np.ndarray:
        return twists[block, :3] + np.cross(twists[block, 3:], assembly.points.position - assembly.blocks.centroid[block])

    interface = assembly.points.interface
    return velocity(assembly.interfaces.block_b[interface]) - velocity(assembly.interfaces.block_a[interface])


def fastest(assembly: Assembly, twists: np.ndarray) -> float:
    """Return the greatest speed of a block's corner."""
    owner = np.repeat(np.arange(len(assembly.blocks)), np.diff(assembly.blocks.vertex_start))
    arm = assembly.blocks.vertices - assembly.blocks.centroid[owner]
    return float(np.linalg.norm(twists[owner, :3] + np.cross(twists[owner, 3:], arm), axis=1).max())


def unbalanced(scene: Scene, assembly: Assembly, forces: np.ndarray, multiplier: float = 0.0) -> np.ndarray:
    """Return the unbalanced force, and moment over the blocks' mean size, on every free block, N: (F, 6), or (F, 3) in the plane."""
    total = np.zeros((len(scene.blocks), 6))
    weight = scene.blocks.density * scene.blocks.volume * np.linalg.norm(scene.gravity)
    along = scene.gravity / np.linalg.norm(scene.gravity)
    total[:, :3] = weight[:, None] * (along if scene.live is None else along + multiplier * scene.live)
    for sign, block in ((-1.0, assembly.interfaces.block_a), (1.0, assembly.interfaces.block_b)):
        on = block[assembly.points.interface]
        arm = assembly.points.position - scene.blocks.centroid[on]
        np.add.at(total, on, sign * np.hstack([forces, np.cross(arm, forces)]))
    total[:, 3:] /= assembly.length
    return total[scene.blocks.free][:, kept(assembly)]


def parts(assembly: Assembly, vectors: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the normal component (C,) and the magnitude of the tangential component (C,) at every contact point."""
    normal = assembly.interfaces.normal[assembly.points.interface]
    along = np.einsum("ij,ij->i", vectors, normal)
    return along, np.linalg.norm(vectors - along[:, None] * normal, axis=1)


def cone_residual(assembly: Assembly, forces: np.ndarray) -> float:
    """Return the largest tension of a contact force, or its largest excess over friction, N."""
    push, shear = parts(assembly, forces)
    return max(0.0, -push.min(), (shear - assembly.points.friction * push).max())


def flow_residual(assembly: Assembly, twists: np.ndarray) -> float:
    """Return the largest distance of a relative velocity from u_n >= mu |u_t|, over the speed of the fastest block."""
    opening, slip = parts(assembly, jumps(assembly, twists))
    friction = assembly.points.friction
    return float(np.maximum((friction * slip - opening) / np.hypot(1.0, friction), -opening).max() / fastest(assembly, twists))


def reaction(assembly: Assembly, forces: np.ndarray) -> float:
    """Return minus the power of the forces on the structure under the support's unit motion."""
    held = np.where(assembly.blocks.free[:, None], 0.0, assembly.support_twist)
    return float(np.sum(forces * jumps(assembly, held)))


def work(assembly: Assembly, twists: np.ndarray) -> float:
    """Return the power of the dead loads."""
    return float(np.sum(assembly.dead_load * twists))


def slack(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, residual: float = RESIDUAL) -> float:
    """Return the largest error of a duality between a mechanism and forces whose residuals are within their limits."""
    scaled = np.abs(twists * np.array([1.0, 1.0, 1.0, *[assembly.length] * 3]))[assembly.blocks.free]
    relative = np.linalg.norm(jumps(assembly, twists), axis=1)
    resisted = RESIDUAL * fastest(assembly, twists) * np.linalg.norm(forces, axis=1).sum()
    return float(residual * assembly.mean_weight * (scaled.sum() + 2.0 * relative.sum()) + resisted)


def value_slack(assembly: Assembly, drive: Drive, first: Solution | StaticSolution, second: Solution | StaticSolution) -> float:
    """Return the largest difference of the values of two answers to one problem: the forces of each act on the other's mechanism."""
    unit = 1.0 if drive is Drive.LIVE else assembly.mean_weight * fastest_support(assembly)
    cross = slack(assembly, first.twists, second.forces) + slack(assembly, second.twists, first.forces)
    return cross + 2.0 * RESIDUAL * unit


def fastest_support(assembly: Assembly) -> float:
    return float(np.linalg.norm(jumps(assembly, assembly.support_twist), axis=1).max())


def distance_from_equilibrium(scene: Scene, assembly: Assembly, radius: float) -> float:
    """Return the least sum of unbalanced forces on the free blocks over the weight, by HiGHS. Pyramids of `radius` replace the cones.

    By duality it is the greatest power of the weights in a motion that the pyramids admit, with components of at most one.
    """
    points, plane = assembly.points, assembly.effects.plane
    normal, first = assembly.axes[:, 0], assembly.axes[:, 1]
    second = np.cross(normal, first)
    angles = np.array([0.0, np.pi]) if plane else 2.0 * np.pi * np.arange(FACETS) / FACETS
    edges = [normal + radius * points.friction[:, None] * (np.cos(a) * first + np.sin(a) * second) for a in angles]
    free, sides = np.flatnonzero(assembly.blocks.free), (assembly.interfaces.block_a, assembly.interfaces.block_b)
    effect = np.zeros((len(edges), len(points), len(scene.blocks), 6))  # of a unit force along each edge on each block
    for sign, block in zip((-1.0, 1.0), sides, strict=True):
        on = block[points.interface]
        arm = points.position - scene.blocks.centroid[on]
        for k, edge in enumerate(edges):
            effect[k, np.arange(len(points)), on] += sign * np.hstack([edge, np.cross(arm, edge) / assembly.length])
    nothing = unbalanced(scene, assembly, np.zeros((len(points), 3)))
    rows = csc_matrix(effect[:, :, free][..., kept(assembly)].reshape(len(edges) * len(points), -1).T)
    size, count = rows.shape
    left = identity(size, format="csc")
    cost = np.concatenate([np.zeros(count), np.ones(2 * size)])
    balance = hstack([rows, left, -left]).tocsc()
    answer = linprog(cost, A_eq=balance, b_eq=-nothing.ravel() / assembly.weight, bounds=(0.0, None), method="highs-ds")
    assert answer.status == 0, answer.message
    return float(answer.fun)


@dataclass(frozen=True)
class OtherSolvers:
    """Answers of the static form and of HiGHS to a problem. Values and differences are over the weight; NaN unless all are solved.

    low, high: values of HiGHS with pyramids around and within the cones, equal in the plane. beyond: largest difference of the conic value
    from the static value, or from the interval low to high. allowed: largest difference that the residuals of the answers allow.
    """

    statuses: tuple[Status, Status, Status, Status]  # conic, static, HiGHS within, HiGHS about
    static: float
    low: float
    high: float
    beyond: float
    allowed: float

    @property
    def agree(self) -> bool:
        """True if all statuses are the same and, where solved, all values agree."""
        return len(set(self.statuses)) == 1 and (self.statuses[0] is not Status.SOLVED or self.beyond <= self.allowed)


def ask_other_solvers(assembly: Assembly, drive: Drive) -> OtherSolvers:
    """Compare the conic answer with that of the static form, and with those of HiGHS to the linearised problem."""
    conic, static = solve_associated(assembly, drive), solve_static(assembly, drive, *coulomb_limits(assembly))
    inside, outside = (solve_linearised(assembly, drive, FACETS, inscribed) for inscribed in (True, False))
    statuses = (conic.status, static.status, inside.status, outside.status)
    if set(statuses) != {Status.SOLVED}:
        return OtherSolvers(statuses, *[float("nan")] * 5)
    low, high = sorted((inside.value, outside.value))
    beyond = max(abs(static.value - conic.value), low - conic.value, conic.value - high)
    allowed = max(value_slack(assembly, drive, conic, other) for other in (static, inside, outside))
    return OtherSolvers(statuses, *(value / assembly.weight for value in (static.value, low, high, beyond, allowed)))


# --- walls of rectangles: another form of the problem, which takes only the data of the scene from `la_core` ------------------


@dataclass(frozen=True)
class Rectangles:
    """Axis-parallel rectangles in the xz plane: low and high corners (B, 2), weights (B,), roles."""

    low: np.ndarray
    high: np.ndarray
    weight: np.ndarray
    role: np.ndarray

    @classmethod
    def of(cls, scene: Scene) -> "Rectangles":
        """Take corners, densities and roles of a scene made of boxes."""
        corners = [scene.blocks.vertices[i:j] for i, j in zip(scene.blocks.vertex_start, scene.blocks.vertex_start[1:], strict=False)]
        low, high = np.array([c.min(axis=0) for c in corners]), np.array([c.max(axis=0) for c in corners])
        weight = scene.blocks.density * np.prod(high - low, axis=1) * 9.81
        return cls(low[:, [0, 2]], high[:, [0, 2]], weight, scene.blocks.role)

    def joints(self) -> Iterator[tuple[int, int, int, float, float, float]]:
        """Yield (a, b, axis, place, from, to): b touches the far side of a along `axis` (0: x, 1: z), at `place`, on this segment."""
        near = 1e-9
        for a in range(len(self.low)):
            for axis in (0, 1):
                across = 1 - axis
                start = np.maximum(self.low[:, across], self.low[a, across])
                end = np.minimum(self.high[:, across], self.high[a, across])
                touching = (np.abs(self.low[:, axis] - self.high[a, axis]) < near) & (end - start > near)
                for b in np.flatnonzero(touching):
                    if FREE in (self.role[a], self.role[b]):
                        yield a, int(b), axis, self.high[a, axis], start[b], end[b]


def static_form_of_rectangles(scene: Scene, sign: float = 1.0) -> float:
    """Return the least (sign 1) or greatest (sign -1) reaction over weight, or the multiplier of a live load along x, by the static form.

    The reaction is the power of the forces on each support against its own unit motion, which may differ from support to support.

    The unknowns are the normal and tangential forces at both ends of every joint. Only the data of the scene come from la_core.
    """
    shape = Rectangles.of(scene)
    free = shape.role == FREE
    number = np.cumsum(free) - 1
    total = shape.weight[free].sum()
    middle = (shape.low + shape.high) / 2.0
    rows, columns, entries, cost = [], [], [], []
    count = 0
    for a, b, axis, place, *ends in shape.joints():
        for end in ends:
            point = np.array([place, end]) if axis == 0 else np.array([end, place])
            for kind, tangential in enumerate((False, True)):
                direction = np.zeros(2)
                direction[axis if not tangential else 1 - axis] = 1.0
                for body, turn in ((a, -1.0), (b, 1.0)):
                    arm = point - middle[body]
                    generalised = turn * np.array([*direction, arm[0] * direction[1] - arm[1] * direction[0]])
                    if free[body]:
                        rows += [3 * number[body] + k for k in range(3)]
                        columns += [2 * count + kind] * 3
                        entries += list(generalised)
                # A support at a pushes up on b; the reaction is positive when it holds the structure.
                held, onto = (a, -1.0) if shape.role[a] == SUPPORT else (b, 1.0)
                cost.append(onto * float(_velocity(scene, held, point) @ direction) if shape.role[held] == SUPPORT else 0.0)
            count += 1
    load = np.zeros((int(free.sum()), 3))
    load[:, 1] = shape.weight[free] / total
    load = load.ravel()
    sliding = _friction_of_joint_ends(count, scene.friction)
    if scene.live is not None:
        rows += [3 * k for k in range(int(free.sum()))]
        columns += [2 * count] * int(free.sum())
        entries += list(shape.weight[free] / total)
        objective = np.append(np.zeros(2 * count), -1.0)
    else:
        objective = np.append(sign * np.array(cost), 0.0)
    equilibrium = coo_matrix((entries, (rows, columns)), shape=(len(load), 2 * count + 1)).tocsr()
    bounds = [(0.0, None), (None, None)] * count + [(0.0, None)]
    answer = linprog(objective, A_ub=sliding, b_ub=np.zeros(2 * count), A_eq=equilibrium, b_eq=load, bounds=bounds, method="highs")
    assert answer.status == 0, answer.message
    return float(sign * answer.fun if scene.live is None else -answer.fun)


def _velocity(scene: Scene, block: int, point: np.ndarray) -> np.ndarray:
    """Return the velocity (x, z) of a point (x, z) of a support for the unit settlement; zero for a live load."""
    if scene.support_twists is None:
        return np.zeros(2)
    velocity_x, _, velocity_z, _, spin, _ = scene.support_twists[block]
    return np.array([velocity_x + spin * point[1], velocity_z - spin * point[0]])


def _friction_of_joint_ends(count: int, friction: float) -> csr_matrix:
    """Return the rows |T| - friction N <= 0 of every joint's end. The columns are N and T in turn, and one for the multiplier."""
    return coo_matrix(
        (
            np.concatenate([np.ones(count), np.full(count, -friction), -np.ones(count), np.full(count, -friction)]),
            (
                np.repeat([0, 1], 2 * count) * count + np.tile(np.arange(count), 4),
                np.concatenate([2 * np.arange(count) + k for k in (1, 0, 1, 0)]),
            ),
        ),
        shape=(2 * count, 2 * count + 1),
    ).tocsr()
