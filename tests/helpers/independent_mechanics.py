"""Equilibrium, cones, flow rule and duality by lines of their own: what answers of `la_core` are held against, and other solvers."""

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

RESIDUAL = 1e-6  # of the mean block weight, or of the fastest block: what la_core promises of an answer called solved
FACETS = 16  # of the pyramids that bracket a cone in space
VERDICTS = (Status.SOLVED, Status.INFEASIBLE, Status.UNBOUNDED)


def drives(assembly: Assembly) -> list[Drive]:
    return [Drive.LIVE] if assembly.has_live_load else [Drive.YIELDING, Drive.PUSHING]


def kept(assembly: Assembly) -> list[int]:
    """Freedoms of a block in the plane or in space."""
    return [0, 2, 4] if assembly.effects.plane else list(range(6))


def jumps(assembly: Assembly, twists: np.ndarray) -> np.ndarray:
    """Velocity (C, 3) of block b relative to block a at every contact point."""

    def velocity(block: np.ndarray) -> np.ndarray:
        return twists[block, :3] + np.cross(twists[block, 3:], assembly.points.position - assembly.blocks.centroid[block])

    interface = assembly.points.interface
    return velocity(assembly.interfaces.block_b[interface]) - velocity(assembly.interfaces.block_a[interface])


def fastest(assembly: Assembly, twists: np.ndarray) -> float:
    """Greatest speed of a block's corner."""
    owner = np.repeat(np.arange(len(assembly.blocks)), np.diff(assembly.blocks.vertex_start))
    arm = assembly.blocks.vertices - assembly.blocks.centroid[owner]
    return float(np.linalg.norm(twists[owner, :3] + np.cross(twists[owner, 3:], arm), axis=1).max())


def unbalanced(scene: Scene, assembly: Assembly, forces: np.ndarray, multiplier: float = 0.0) -> np.ndarray:
    """Force and moment over the blocks' mean size (F, 6) that are left on every free block."""
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
    """Normal component (C,) and size of the rest (C,)."""
    normal = assembly.interfaces.normal[assembly.points.interface]
    along = np.einsum("ij,ij->i", vectors, normal)
    return along, np.linalg.norm(vectors - along[:, None] * normal, axis=1)


def cone_residual(assembly: Assembly, forces: np.ndarray) -> float:
    """Most by which a contact force pulls or exceeds its friction, N."""
    push, shear = parts(assembly, forces)
    return max(0.0, -push.min(), (shear - assembly.points.friction * push).max())


def flow_residual(assembly: Assembly, twists: np.ndarray) -> float:
    """Largest distance of a relative velocity from u_n >= mu |u_t|, over the fastest block."""
    opening, slip = parts(assembly, jumps(assembly, twists))
    friction = assembly.points.friction
    return float(np.maximum((friction * slip - opening) / np.hypot(1.0, friction), -opening).max() / fastest(assembly, twists))


def reaction(assembly: Assembly, forces: np.ndarray) -> float:
    """Minus the power of the forces on the structure under the support's unit motion."""
    held = np.where(assembly.blocks.free[:, None], 0.0, assembly.support_twist)
    return float(np.sum(forces * jumps(assembly, held)))


def work(assembly: Assembly, twists: np.ndarray) -> float:
    """Power of the weights."""
    return float(np.sum(assembly.dead_load * twists))


def slack(assembly: Assembly, twists: np.ndarray, forces: np.ndarray, residual: float = RESIDUAL) -> float:
    """Most by which virtual power of a mechanism and of forces may miss a duality when both keep their residuals."""
    scaled = np.abs(twists * np.array([1.0, 1.0, 1.0, *[assembly.length] * 3]))[assembly.blocks.free]
    relative = np.linalg.norm(jumps(assembly, twists), axis=1)
    resisted = RESIDUAL * fastest(assembly, twists) * np.linalg.norm(forces, axis=1).sum()
    return float(residual * assembly.mean_weight * (scaled.sum() + 2.0 * relative.sum()) + resisted)


def value_slack(assembly: Assembly, drive: Drive, first: Solution | StaticSolution, second: Solution | StaticSolution) -> float:
    """Most by which the values of two answers to one problem may differ: crosswise, forces of one on the mechanism of the other."""
    unit = 1.0 if drive is Drive.LIVE else assembly.mean_weight * fastest_support(assembly)
    cross = slack(assembly, first.twists, second.forces) + slack(assembly, second.twists, first.forces)
    return cross + 2.0 * RESIDUAL * unit


def fastest_support(assembly: Assembly) -> float:
    return float(np.linalg.norm(jumps(assembly, assembly.support_twist), axis=1).max())


def distance_from_equilibrium(scene: Scene, assembly: Assembly, radius: float) -> float:
    """Least sum of what is left on the free blocks over the weight, forces within pyramids of that radius times friction; by HiGHS.

    It is the greatest work of the weights on a motion that the pyramids admit, no component of it above one.
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
    """What the static form and HiGHS say of a problem. Values and differences are over the weight, NaN where a status differs.

    low, high: HiGHS on pyramids about and within the cones, the same in the plane. beyond: most by which the conic value misses the
    static form's, or leaves the bracket. allowed: what the residuals of the answers can make of it.
    """

    statuses: tuple[Status, Status, Status, Status]  # conic, static, HiGHS within, HiGHS about
    static: float
    low: float
    high: float
    beyond: float
    allowed: float

    @property
    def agree(self) -> bool:
        """Whether all say the same status and, where they have one, the same value."""
        return len(set(self.statuses)) == 1 and (self.statuses[0] is not Status.SOLVED or self.beyond <= self.allowed)


def ask_other_solvers(assembly: Assembly, drive: Drive) -> OtherSolvers:
    """The conic answer beside the static form's, and HiGHS' on the linearised problem."""
    conic, static = solve_associated(assembly, drive), solve_static(assembly, drive, *coulomb_limits(assembly))
    inside, outside = (solve_linearised(assembly, drive, FACETS, inscribed) for inscribed in (True, False))
    statuses = (conic.status, static.status, inside.status, outside.status)
    if set(statuses) != {Status.SOLVED}:
        return OtherSolvers(statuses, *[float("nan")] * 5)
    low, high = sorted((inside.value, outside.value))
    beyond = max(abs(static.value - conic.value), low - conic.value, conic.value - high)
    allowed = max(value_slack(assembly, drive, conic, other) for other in (static, inside, outside))
    return OtherSolvers(statuses, *(value / assembly.weight for value in (static.value, low, high, beyond, allowed)))


# --- walls of rectangles: another form of the problem, and nothing of `la_core` but the corners of the blocks -----------------


@dataclass(frozen=True)
class Rectangles:
    """Axis-parallel rectangles in the xz plane: low and high corners (B, 2), weights (B,), roles."""

    low: np.ndarray
    high: np.ndarray
    weight: np.ndarray
    role: np.ndarray

    @classmethod
    def of(cls, scene: Scene) -> "Rectangles":
        """Of a scene made of boxes; only their corners are taken from it."""
        corners = [scene.blocks.vertices[i:j] for i, j in zip(scene.blocks.vertex_start, scene.blocks.vertex_start[1:], strict=False)]
        low, high = np.array([c.min(axis=0) for c in corners]), np.array([c.max(axis=0) for c in corners])
        weight = scene.blocks.density * np.prod(high - low, axis=1) * 9.81
        return cls(low[:, [0, 2]], high[:, [0, 2]], weight, scene.blocks.role)

    def joints(self) -> Iterator[tuple[int, int, int, float, float, float]]:
        """(a, b, axis, place, from, to): b lies beyond a along `axis` (0: x, 1: z) and they share this segment."""
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
    """Least (sign 1) or greatest (sign -1) reaction over weight, or the multiplier of a live load along x: static form.

    The reaction is the power of the forces on each support against its own unit motion, which may differ from support to support.

    Unknowns: normal and tangential force at both ends of every joint. Independent of la_core but for the corners of the blocks.
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
    """Velocity (x, z) of a point (x, z) of a support for the unit settlement; zero for a live load."""
    if scene.support_twists is None:
        return np.zeros(2)
    velocity_x, _, velocity_z, _, spin, _ = scene.support_twists[block]
    return np.array([velocity_x + spin * point[1], velocity_z - spin * point[0]])


def _friction_of_joint_ends(count: int, friction: float) -> csr_matrix:
    """Rows |T| - friction N <= 0 of every joint's end; columns N, T in turn, and one for the multiplier."""
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
