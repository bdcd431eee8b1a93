"""The visible faces of the blocks, their drawing order, and the points that blocks hide.

A block that is not convex has no edges where its convex parts meet. Its faces that lie in one plane and face the same way are therefore
joined to one face. Where a face of another part lies in that plane and faces the other way, the area is inside the block.

Convex blocks that touch each other hide each other in a known order; they are drawn back to front in that order. Mplot3d sorts
single faces by their mean depth instead, and draws a long foundation over the short blocks on it.
"""

import heapq
from collections.abc import Iterator, Sequence

import numpy as np
import shapely

from la_core.geometry import Blocks, group_members, next_corners
from la_core.model import Assembly

NEAR = 1e-4  # of the largest extent of a block: boxes and faces that are nearer than this touch
IN_PLANE = 1e-6  # of a block's size, and of a normal: faces this close to one plane lie in it
GRID = 1e-7  # of the structure's size: joined faces have their corners on a grid this fine
SLIVER = 10.0  # times the grid: a polygon narrower than about this is round-off
LEVEL = 1e-9  # cosine between a face's normal and the view, below which the face is seen edge-on
AT_A_TIME = 500  # blocks that are compared with all others in one array, or points with the parts before them


def back_to_front(assembly: Assembly, toward: np.ndarray) -> np.ndarray:
    """Return the blocks (B,) in drawing order, for a unit vector (3,) `toward` the viewer.

    Of two blocks that touch, the one on the viewer's side comes later. Other blocks are ordered by depth, the farthest first.
    """
    interfaces = assembly.interfaces
    a, b = _touching(assembly.blocks, np.flatnonzero(assembly.aside), toward)
    facing = interfaces.normal @ toward > 0.0
    behind = np.concatenate([np.where(facing, interfaces.block_a, interfaces.block_b), a])
    before = np.concatenate([np.where(facing, interfaces.block_b, interfaces.block_a), b])
    depth = assembly.blocks.centroid @ toward
    waiting = np.bincount(before, minlength=len(depth))
    hides: list[list[int]] = [[] for _ in depth]
    for back, front in zip(behind, before, strict=True):
        hides[back].append(int(front))
    # Blocks that interlock in a ring have no right order. Then the block that waits for the fewest others is drawn, the farthest of these.
    queue = [(int(waiting[k]), float(depth[k]), k) for k in range(len(depth))]
    heapq.heapify(queue)
    order: list[int] = []
    drawn = np.zeros(len(depth), dtype=bool)
    while queue:
        count, _, block = heapq.heappop(queue)
        if drawn[block] or count != waiting[block]:
            continue
        drawn[block] = True
        order.append(block)
        for other in hides[block]:
            waiting[other] -= 1
            heapq.heappush(queue, (int(waiting[other]), float(depth[other]), other))
    return np.array(order)


def _touching(blocks: Blocks, aside: np.ndarray, toward: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return pairs of touching blocks, the rear one and the front one, of which at least one was set aside.

    A model has no interfaces of blocks that it sets aside. Their order follows from a face whose plane separates two touching parts.
    """
    parts, block = blocks.parts, blocks.part_block
    near, towards = NEAR * float((blocks.high - blocks.low).max()), blocks.face_normal @ toward
    pairs = [np.zeros((0, 2), dtype=int)]
    aside = np.flatnonzero(np.isin(block, aside))
    for some in np.array_split(aside, len(aside) // AT_A_TIME + 1):
        low, high = parts.low[some, None], parts.high[some, None]
        laps = np.minimum(high, parts.high) - np.maximum(low, parts.low)  # (some, P, 3): extents that two boxes share
        one, other = np.nonzero((laps >= -near).all(axis=2) & ((laps > near).sum(axis=2) >= 2) & (block[some][:, None] != block))
        one = some[one]
        (face, pair, gap), (back, back_pair, back_gap) = _parting(parts, one, other, near), _parting(parts, other, one, near)
        pair, gap, along = np.append(pair, back_pair), np.append(gap, back_gap), np.append(towards[face], -towards[back])
        apart, is_before, is_behind = (
            np.bincount(pair[found], minlength=len(one)) > 0 for found in (gap > near, along > LEVEL, along < -LEVEL)
        )
        known = ~apart & (is_before != is_behind)  # else they do not touch, or neither hides a piece of the other
        pairs.append(block[np.where(is_before, [one, other], [other, one])[:, known].T])
    behind, before = np.unique(np.concatenate(pairs), axis=0).T  # each pair once
    in_turn = np.isin(behind * len(blocks) + before, before * len(blocks) + behind)  # each is before a part of the other
    return behind[~in_turn], before[~in_turn]


def _parting(parts: Blocks, one: np.ndarray, other: np.ndarray, near: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the faces of parts `one` (K,) whose planes separate them from parts `other` (K,), with the pair and the gap, m, of each."""
    pair, nth = group_members(np.diff(parts.part_face_start)[one])
    face, beside = parts.part_face_start[one[pair]] + nth, other[pair]
    row, nth = group_members(np.diff(parts.vertex_start)[beside])
    along = np.sum(parts.vertices[parts.vertex_start[beside[row]] + nth] * parts.face_normal[face[row]], axis=1)
    gap = np.minimum.reduceat(along, np.flatnonzero(nth == 0)) - parts.face_offset[face]
    is_parting = gap >= -near
    return face[is_parting], pair[is_parting], gap[is_parting]


def are_behind(parts: Blocks, view: np.ndarray, points: np.ndarray, least: float) -> np.ndarray:
    """Return the mask (N,) of the points (N, 3) with more than `least`, m, of one of the convex parts between them and the viewer.

    The rows of `view` (3, 3) are unit vectors to the right, upwards and towards the viewer. A point is compared only with the parts
    whose bounding boxes in the view cover it.
    """
    flat, places, margin = parts.vertices @ view[:2].T, points @ view[:2].T, NEAR * float((parts.high - parts.low).max())
    low = np.minimum.reduceat(flat, parts.vertex_start[:-1]) - margin
    high = np.maximum.reduceat(flat, parts.vertex_start[:-1]) + margin
    tree = shapely.STRtree(shapely.box(low[:, 0], low[:, 1], high[:, 0], high[:, 1]))
    towards, start = parts.face_normal @ view[2], parts.part_face_start
    hidden = np.zeros(len(points), dtype=bool)
    for some in np.array_split(np.arange(len(points)), len(points) // AT_A_TIME + 1):
        point, part = tree.query(shapely.points(places[some]))
        row, nth = group_members(np.diff(start)[part])  # faces of each part, side by side for all points
        face, first = start[part[row]] + nth, np.flatnonzero(nth == 0)
        along = towards[face]
        inside = parts.face_offset[face] - np.sum(points[some[point[row]]] * parts.face_normal[face], axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            cut = inside / along  # distance towards the viewer to each face's plane
        leave = np.minimum.reduceat(np.where(along > LEVEL, cut, np.inf), first)
        enter = np.maximum.reduceat(np.where(along < -LEVEL, cut, -np.inf), first)
        missed = np.logical_or.reduceat((np.abs(along) <= LEVEL) & (inside < 0.0), first)
        stone = np.where(missed, 0.0, leave - np.maximum(enter, 0.0))
        hidden[some[point[stone > least]]] = True
    return hidden


class OuterFaces:
    """The outer faces of the blocks of a structure, seen from one side.

    Attributes
    ----------
    order : ndarray
        Place (F,) of each face in the drawing order of its block's faces, back to front. It is 0 in a convex block, whose visible faces
        do not hide each other.
    """

    def __init__(self, blocks: Blocks, toward: np.ndarray) -> None:
        """Find the faces of the blocks' convex parts that lie in one plane; `toward` is a unit vector (3,) to the viewer."""
        self.order = np.zeros(len(blocks.face_block), dtype=int)
        self._blocks, self._toward = blocks, toward
        self._is_drawn = np.ones(len(blocks.face_block), dtype=bool)  # for itself, or for all faces that it is joined with
        self._joined: dict[int, tuple[np.ndarray, np.ndarray]] = {}  # by the drawn face: faces joined with it, faces opposite
        self._grid = GRID * float((blocks.high.max(axis=0) - blocks.low.min(axis=0)).max())
        for block in np.flatnonzero(blocks.is_compound).tolist():
            faces = np.arange(*np.searchsorted(blocks.face_block, [block, block + 1]))
            self._join(block, faces)
            self._put_in_order(faces[blocks.face_normal[faces] @ toward > 0.0])

    def _join(self, block: int, faces: np.ndarray) -> None:
        """Find the faces of a block that lie in one plane, and among these the faces that face the same way."""
        blocks = self._blocks
        normal = blocks.face_normal[faces]
        offset = blocks.face_offset[faces] - normal @ blocks.centroid[block]
        near = IN_PLANE * float((blocks.high[block] - blocks.low[block]).max())

        def in_plane(k: int, way: float) -> np.ndarray:
            turned = np.abs(normal - way * normal[k]).max(axis=1)
            return faces[(turned < IN_PLANE) & (np.abs(offset - way * offset[k]) < near)]

        for k, face in enumerate(faces):
            if self._is_drawn[face]:
                alike = in_plane(k, 1.0)
                self._is_drawn[alike[alike != face]] = False
                self._joined[int(face)] = (alike, in_plane(k, -1.0))

    def _put_in_order(self, faces: np.ndarray) -> None:
        """Set the drawing order of the faces of one block: by the number of faces that each may hide, less the number that may hide it.

        Face A may hide face B where a part of A lies before the plane of B, and a part of B lies behind the plane of A.
        """
        blocks = self._blocks
        faces = faces[self._is_drawn[faces]]
        corners = blocks.vertices[blocks.face_vertex]
        whole = [np.concatenate([self._loop(one, corners) for one in self._joined[int(face)][0]]) for face in faces]
        before = np.array([[(of @ blocks.face_normal[face]).max() - blocks.face_offset[face] for face in faces] for of in whole])
        behind = np.array([[(of @ blocks.face_normal[face]).min() - blocks.face_offset[face] for face in faces] for of in whole])
        hides = (before > self._grid) & (behind < -self._grid).T
        self.order[faces] = np.argsort(np.argsort(hides.sum(axis=1) - hides.sum(axis=0), kind="stable"), kind="stable")

    def polygons(self, faces: Sequence[int] | np.ndarray, flat: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
        """Yield the visible polygons (n, 2) of faces, each with its face; a face that is drawn as part of another one has none.

        flat: corners (L, 2) of all faces in the view.
        """
        for face in faces:
            if int(face) in self._joined:
                yield from ((int(face), polygon) for polygon in self._outline(*self._joined[int(face)], flat))
            elif self._is_drawn[face]:
                yield int(face), self._loop(face, flat)

    def room_beside(self, points: np.ndarray, flat: np.ndarray) -> np.ndarray:
        """Return the width (B,), m, of the room centred at a point (B, 2) of each block, up to the block's nearer side.

        In a leaning voussoir this is less than its extent. flat: corners (L, 2) of all faces in the view.
        """
        blocks = self._blocks
        room = np.full(len(blocks), np.inf)
        for face, polygon in self.polygons(np.flatnonzero(blocks.face_normal @ self._toward > IN_PLANE), flat):
            start = polygon - points[blocks.face_block[face]]
            step = np.roll(start, -1, axis=0) - start
            crosses = (start[:, 1] > 0.0) != (start[:, 1] + step[:, 1] > 0.0)
            sides = start[crosses, 0] - start[crosses, 1] * step[crosses, 0] / step[crosses, 1]
            block = blocks.face_block[face]
            room[block] = min(room[block], 2.0 * np.abs(sides).min(initial=np.inf))
        return room

    def edges(self) -> np.ndarray:
        """Return the outer edges (E, 2) of all blocks as pairs of vertices, each once."""
        blocks = self._blocks
        following = next_corners(blocks.face_start)
        is_convex = np.repeat(~blocks.is_compound[blocks.face_block], np.diff(blocks.face_start))
        pairs = [np.stack([blocks.face_vertex, blocks.face_vertex[following]], axis=1)[is_convex]]
        for face, (alike, facing) in self._joined.items():
            across = np.delete(np.arange(3), np.abs(blocks.face_normal[face]).argmax())  # the projection with the largest area
            vertices = np.concatenate([self._loop(one, blocks.face_vertex) for one in (*alike, *facing)])
            for polygon in self._outline(alike, facing, blocks.vertices[blocks.face_vertex][:, across]):
                away = np.linalg.norm(polygon[:, None] - blocks.vertices[vertices][:, across], axis=2)
                corners = vertices[away.argmin(axis=1)]  # each corner of a joined face is one of its faces' corners
                pairs.append(np.stack([corners, np.roll(corners, -1)], axis=1))
        return np.unique(np.sort(np.concatenate(pairs), axis=1), axis=0)

    def _loop(self, face: int, corners: np.ndarray) -> np.ndarray:
        return corners[self._blocks.face_start[face] : self._blocks.face_start[face + 1]]

    def _outline(self, alike: np.ndarray, facing: np.ndarray, flat: np.ndarray) -> list[np.ndarray]:
        """Return the visible polygons (n, 2) of the faces `alike`: their union, without the areas that opposite faces, `facing`, cover."""
        if len(alike) == 1 and not len(facing):
            return [self._loop(alike[0], flat)]
        corners = np.concatenate([self._loop(face, flat) for face in (*alike, *facing)])
        whole, inside = (
            shapely.union_all(
                [shapely.Polygon(_with_corners(self._loop(face, flat), corners, self._grid)) for face in some], grid_size=self._grid
            )
            for some in (alike, facing)
        )
        pieces = shapely.get_parts(shapely.difference(whole, inside, grid_size=self._grid))
        pieces = [piece for piece in pieces if isinstance(piece, shapely.Polygon) and self._is_wide(piece)]
        if any(self._is_wide(shapely.Polygon(hole)) for piece in pieces for hole in piece.interiors):  # matplotlib draws none
            return [self._loop(face, flat) for face in alike]
        return [np.array(piece.exterior.coords)[:-1] for piece in pieces]

    def _is_wide(self, piece: shapely.Polygon) -> bool:
        """Return whether a polygon is wider than the gaps that the grid leaves between two edges in one line."""
        return bool(piece.area > SLIVER * self._grid * piece.length)


def _with_corners(loop: np.ndarray, corners: np.ndarray, near: float) -> np.ndarray:
    """Return a polygon (n, 2) with additional corners: those of `corners` (C, 2) that lie on its edges, within `near`.

    Without them the grid may move a corner of one face off the edge of another face, and leave a gap between the two.
    """
    edges = []
    for start, end in zip(loop, np.roll(loop, -1, axis=0), strict=True):
        length = np.hypot(*(end - start))
        unit = (end - start) / length if length > near else np.zeros(2)
        along = (corners - start) @ unit
        is_on = (along > near) & (along < length - near) & (np.abs((corners - start) @ (-unit[1], unit[0])) < near)
        edges += [start[None], corners[is_on][np.argsort(along[is_on])]]
    return np.concatenate(edges)


def unit_normals(corners: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return unit normals (F, 3) of polygons, by Newell's sum of cross products of successive corners."""
    first = np.repeat(corners[start[:-1]], np.diff(start), axis=0)
    normal = np.add.reduceat(np.cross(corners - first, corners[next_corners(start)] - first), start[:-1])
    return normal / np.linalg.norm(normal, axis=1).clip(np.finfo(float).tiny)[:, None]
