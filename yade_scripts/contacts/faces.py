"""The faces in contact with spheres, as YADE bodies: boxes, polyhedra, and slabs with one face."""

import numpy as np
from yade import Body, Box

from la_core.exchange import FREE
from yade_scripts.case import Case
from yade_scripts.contacts.convex_parts import box_extents

try:
    from yade.minieigenHP import Quaternion, Vector3
except ImportError:  # before 2022 YADE used a separate package
    from minieigen import Quaternion, Vector3
try:
    from yade import Polyhedra
except ImportError:  # YADE was built without CGAL, as in Debian 13: only boxes can be faces
    Polyhedra = None

_FREE_FACE, _HELD_FACE = 0b101, 0b010  # masks, see `bodies`
_LEVEL = 1e-4  # of the block's size: contact points farther apart along a normal lie on two faces
_SHAPE_TOLERANCE = 1e-9  # of the block's size


class YadeError(Exception):
    """YADE cannot build the bodies of the case, or has built different ones; the message names the fault."""


def faces_of(case: Case, block: int, touching: np.ndarray) -> list[tuple[Body, np.ndarray]]:
    """Return the massless bodies of a block that other blocks' spheres touch, each with the indices of its contact points.

    A block that is a box has one body. While YADE looks for new contacts, any other block has one body for each of its convex parts.
    Otherwise it has one box for each face in contact instead of a polyhedron: a step is then three to seven times as fast, because YADE
    searches polyhedra triangle by triangle.

    touching: contact points (n,) of the spheres that touch the block.
    """
    if case.boxes[block] is not None or (case.displacement == "finite" and len(case.parts[block]) == 1):
        return [(_solid(case, block, case.vertices[block]), touching)]
    if case.displacement == "finite":
        nearest = _nearest_parts(case, block, touching)
        return [(_solid(case, block, points), touching[nearest == part]) for part, points in enumerate(case.parts[block])]
    outward = np.where(case.block_a[touching] == block, 1.0, -1.0)[:, None] * case.normal[touching]
    normals, which = np.unique(outward, axis=0, return_inverse=True)
    served = [touching[which.ravel() == face] for face in range(len(normals))]
    return [
        (_slab(case, block, normal, level[0]), level)
        for normal, points in zip(normals, served, strict=True)
        for level in _levels(case, block, normal, points)
    ]


def _levels(case: Case, block: int, outward: np.ndarray, points: np.ndarray) -> list[np.ndarray]:
    """Return the contact points of one normal (3,), grouped by plane; a convex block has only one face with a given normal."""
    if len(case.parts[block]) == 1:
        return [points]
    height = case.position[points] @ outward
    order = np.argsort(height, kind="stable")
    steps = np.flatnonzero(np.diff(height[order]) > _LEVEL * np.ptp(case.vertices[block], axis=0).max())
    return [points[np.sort(level)] for level in np.split(order, steps + 1)]


def _nearest_parts(case: Case, block: int, touching: np.ndarray) -> np.ndarray:
    """Return for each contact point in `touching` (n,) the convex part whose bounding box contains it or is nearest to it."""
    low = np.array([points.min(axis=0) for points in case.parts[block]])
    high = np.array([points.max(axis=0) for points in case.parts[block]])
    place = case.position[touching][:, None]
    return np.linalg.norm(np.maximum(np.maximum(low - place, place - high), 0.0), axis=2).argmin(axis=1)


def _slab(case: Case, block: int, outward: np.ndarray, contact: int) -> Body:
    """Return a box around the block whose top is the plane with the normal `outward` (3,) through the contact point."""
    turn = Quaternion()
    turn.setFromTwoVectors(Vector3.UnitZ, Vector3(outward))
    axes = np.array(turn.toRotationMatrix()).reshape(3, 3)
    points = case.vertices[block] @ axes
    low, high = points.min(axis=0), points.max(axis=0)
    high[2] = case.position[contact] @ outward
    body = Body()
    body.shape = Box(extents=0.5 * (high - low))
    body.state.pos, body.state.ori = axes @ (0.5 * (low + high)), turn
    return body


def _solid(case: Case, block: int, vertices: np.ndarray) -> Body:
    """Return the solid of a convex part with these vertices (n, 3), a box or a polyhedron; raises YadeError if YADE cannot build it."""
    body = Body()
    box = box_extents(vertices)
    if box is not None:
        body.shape = Box(extents=0.5 * (box[1] - box[0]))
        body.state.pos = 0.5 * (box[0] + box[1])
    elif Polyhedra is None:
        raise YadeError(
            f"block {block} is not a box along the axes, and this YADE was built without polyhedra (CGAL); use a YADE with them, such as "
            'Debian 12\'s, or set displacement = "small" in [effects] where no new contact can form'
        )
    else:
        # YADE stores a polyhedron's vertices relative to its centroid and principal axes; the pose of the body restores their places.
        body.shape = Polyhedra(v=[Vector3(vertex) for vertex in vertices])
        body.state.pos, body.state.ori = body.shape.GetCentroid(), body.shape.GetOri()
        _check_polyhedron(block, vertices, body)
    body.mask = _FREE_FACE if case.role[block] == FREE else _HELD_FACE
    return body


def _check_polyhedron(block: int, wanted: np.ndarray, body: Body) -> None:
    placed = np.array([body.state.pos + body.state.ori * vertex for vertex in body.shape.v])
    gaps = np.linalg.norm(wanted[:, None, :] - placed[None, :, :], axis=2)
    error = max(gaps.min(axis=0).max(), gaps.min(axis=1).max())
    if len(placed) != len(wanted) or error > _SHAPE_TOLERANCE * np.ptp(wanted, axis=0).max():
        raise YadeError(f"block {block}: YADE's polyhedron has {len(placed)} vertices, up to {error:.3g} m off the block's {len(wanted)}")
