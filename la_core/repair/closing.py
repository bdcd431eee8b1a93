"""Close the joints of a structure: faces move to common planes, corners follow their faces, and remaining overlaps are cut."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise, product

import numpy as np

from la_core.errors import SceneError
from la_core.geometry import Blocks, Shape, compound, near_pairs, next_corners, overlaps, owners
from la_core.repair.bodies import PLANE, between
from la_core.repair.facing import facing_faces
from la_core.repair.outline_motion import MovedOutline, moved_outline, onto_planes
from la_core.repair.planes import planes_closing_most
from la_core.repair.repairs import Repairs, Unclosed
from la_core.repair.unclosed import lost_joints, unclosed
from la_core.text_table import place_text

MOST_MOVE = 5.0  # over the motion of a face: a corner between oblique faces moves farther than they do
FIT = 1.5  # over the tolerance: largest distance of a corner from a plane fitted to the corners of many blocks
SHORTEST = 2.0  # over the tolerance: a shorter joint may not exist, because both its ends are uncertain
OVERLAP = 1e-6  # of the smaller block's size: a smaller overlap is round-off
FAR = 1024.0  # m: a structure this far from the origin is repaired about an origin of its own
NEARLY = 1.5  # over the depth of the shallowest cut: less deep cuts count as equally shallow, within the errors of the corners
ROUNDS = 4  # a cut may uncover another overlap
CLOSED = 1e-6  # m: a smaller gap counts as closed before the repair


def close_joints(names: Sequence[str], shapes: Sequence[Shape], tolerance: float, joints: np.ndarray) -> tuple[list[Shape], Repairs]:
    """Make blocks touch that nearly touch, and remove overlaps.

    Parameters
    ----------
    names : sequence of str
        Name of each of the B blocks, for messages.
    shapes : sequence of Shape
        Shape of each block.
    tolerance : float
        Largest error of the coordinates, m.
    joints : (B,) array
        Largest width of the open joints of each block, m; 0 where its joints are drawn closed.

    Returns
    -------
    list of Shape
        The repaired shapes.
    Repairs
        Changes, and places that could not be repaired.

    Raises
    ------
    SceneError
        The surface of a block would move too far, or nothing would be left of a block or of a part that is cut.
    """
    # Round-off grows with the distance from the origin, which may be large in the national grid of a survey.
    origin = FAR * np.round(np.mean([shape.vertices.mean(axis=0) for shape in shapes], axis=0) / FAR)
    blocks = Blocks.gather(names, ["fixed"] * len(shapes), [1.0] * len(shapes), [_shifted(shape, -origin) for shape in shapes])
    parts, owner = blocks.parts, blocks.part_block
    reach = joints + 2.0 * tolerance
    pairs = facing_faces(parts, owner, reach[owner])
    limit = (FIT * tolerance + joints / 2.0)[owner[parts.face_block]]
    normal, offset, closed = planes_closing_most(parts, owner, pairs, _twins(parts, owner), limit)
    most = MOST_MOVE * (tolerance + joints.max() / 2.0)
    whole = _moved_outlines(shapes, origin, parts, owner, normal, offset, most)
    single = ~np.isin(owner, list(whole))  # mask of the parts that move one by one
    moved = onto_planes(parts.vertices, parts.face_vertex, normal[owners(parts.face_start)], offset[owners(parts.face_start)])
    moved[~single[parts.vertex_block]] = parts.vertices[~single[parts.vertex_block]]
    _refuse_far(parts, moved, normal, offset, most, origin)
    largest = np.zeros(len(shapes))
    np.maximum.at(largest, owner[parts.vertex_block], np.linalg.norm(moved - parts.vertices, axis=1))
    largest[list(whole)] = [one.largest_move for one in whole.values()]
    farthest = int(np.argmax(largest))
    pieces, owner_left = _pieces(parts, owner, single, moved, normal, offset, origin)
    pieces += [part for one in whole.values() for part in one.parts]
    owner_left = np.concatenate([owner_left, np.repeat(list(whole), [len(one.parts) for one in whole.values()]).astype(int)])
    found = _cut_overlaps(names, pieces, owner_left, _Drawn(parts, owner, float(reach.max())), origin)
    wholes = [compound([pieces[part] for part in np.flatnonzero(owner_left == block)]) for block in range(len(shapes))]
    still_open = [*found.deep.values(), *unclosed(names, parts, owner, pairs, ~closed, tolerance)]
    told = {frozenset(one.blocks) for one in still_open}
    lost = lost_joints(names, parts, owner, reach[owner], _gathered(names, wholes), tolerance)
    still_open += [one for one in lost if frozenset(one.blocks) not in told]
    widest = pairs.gap[pairs.widest]
    repairs = Repairs(
        tolerance=tolerance,
        joint_width=float(joints.max()),
        largest_move=float(largest[farthest]),
        moved_block=names[farthest] if largest[farthest] > 0.0 else "",
        gaps_closed=int(np.sum(closed & (widest > CLOSED))),
        overlaps_closed=int(np.sum(closed & (widest < -CLOSED))),
        overlaps_cut=found.cut,
        deepest_cut=found.deepest,
        shortest_joint=SHORTEST * tolerance,
        unclosed=tuple(replace(one, vertex=tuple((np.array(one.vertex) + origin).tolist())) for one in still_open),
    )
    return [_shifted(whole, origin) for whole in wholes], repairs


def _shifted(shape: Shape, shift: np.ndarray) -> Shape:
    return shape.moved(lambda points: points + shift) if shift.any() else shape


def _twins(parts: Blocks, owner: np.ndarray) -> np.ndarray:
    """Pairs (T, 2) of faces of one compound block that lie on one plane."""
    found: list[tuple[int, int]] = []
    counts = np.bincount(owner)
    for block in np.flatnonzero(counts > 1):
        faces = np.flatnonzero(owner[parts.face_block] == block)
        normal, offset = parts.face_normal[faces], parts.face_offset[faces]
        size = float(np.ptp(parts.vertices[parts.face_vertex[parts.face_start[faces[0]] : parts.face_start[faces[-1] + 1]]], axis=0).max())
        found += [(int(faces[i]), int(faces[j])) for i, j in np.argwhere(_on_one_plane(normal, offset, size))]
    return np.array(found, dtype=int).reshape(-1, 2)


def _on_one_plane(normal: np.ndarray, offset: np.ndarray, size: float) -> np.ndarray:
    """Mask (F, F) of the pairs of a face i and a later face j on one plane, in a body of the size `size` (m)."""
    level = (normal @ normal.T > 1.0 - PLANE) & (np.abs(offset[:, None] - offset[None, :]) < PLANE * size)
    return np.asarray(np.triu(level, 1))


def _moved_outlines(
    shapes: Sequence[Shape], origin: np.ndarray, parts: Blocks, owner: np.ndarray, normal: np.ndarray, offset: np.ndarray, most: float
) -> dict[int, MovedOutline]:
    """Moved outlines, by block, of the blocks of several parts between front and back that can move as a whole, by at most `most` (m)."""
    found = {}
    for block, shape in enumerate(shapes):
        if shape.outline is not None:
            faces = owner[parts.face_block] == block
            moved = moved_outline(_shifted(shape, -origin), normal[faces], offset[faces], most)
            if moved is not None:
                found[block] = moved
    return found


def _refuse_far(parts: Blocks, moved: np.ndarray, normal: np.ndarray, offset: np.ndarray, limit: float, origin: np.ndarray) -> None:
    """Raise SceneError where the surface of a block would move by more than `limit`, m; origin: of the parts in the scene, m.

    A corner between two nearly parallel faces may slide farther along them, because this hardly moves the surface.
    """
    vertex_part = parts.vertex_block
    for vertex in np.flatnonzero(np.linalg.norm(moved - parts.vertices, axis=1) > limit).tolist():
        part = vertex_part[vertex]
        faces, before = slice(*parts.part_face_start[part : part + 2]), parts.vertices[vertex]
        beyond = np.max(parts.face_normal[faces] @ moved[vertex] - parts.face_offset[faces])
        depth = float(max(beyond, np.max(normal[faces] @ before - offset[faces])))
        if depth > limit:
            where, name = place_text(before + origin), parts.names[part]
            rule = f"its surface at the vertex {where} would have to move {depth:.3g} m to close its joints, more than {limit:.3g} m"
            hint = "correct it in the drawing, or take a larger tolerance"
            raise SceneError(f'block "{name}"', rule, hint=hint, blocks=[name])


def _pieces(
    parts: Blocks,
    owner: np.ndarray,
    single: np.ndarray,
    moved: np.ndarray,
    normal: np.ndarray,
    offset: np.ndarray,
    origin: np.ndarray,
) -> tuple[list[Shape], np.ndarray]:
    """The `single` parts with moved vertices, and the block of each part.

    A part that would fold over, or that has two faces on one plane, is rebuilt as the body between its planes. It loses the faces that no
    longer bound it, and corners on straight edges. A part with nothing left is dropped. Raises SceneError for a block without any part.
    """
    size = np.linalg.norm(parts.high - parts.low, axis=1)
    edge = np.linalg.norm(moved[parts.face_vertex[next_corners(parts.face_start)]] - moved[parts.face_vertex], axis=1)
    shortest = np.minimum.reduceat(edge, parts.face_start[:-1][parts.part_face_start[:-1]])
    shapes: list[Shape | None] = []
    for part in np.flatnonzero(single).tolist():
        first, last = parts.vertex_start[part], parts.vertex_start[part + 1]
        low, high = parts.part_face_start[part], parts.part_face_start[part + 1]
        beyond = moved[first:last] @ normal[low:high].T - offset[low:high]
        again = _on_one_plane(normal[low:high], offset[low:high], size[part]).any(axis=0)
        if beyond.max() <= PLANE * size[part] < shortest[part] and not again.any():
            bounds = parts.face_start[low : high + 1].tolist()
            loops = tuple(tuple((parts.face_vertex[i:j] - first).tolist()) for i, j in pairwise(bounds))
            shapes.append(Shape(moved[first:last], loops))
        else:
            planes = normal[low:high][~again], offset[low:high][~again]
            shapes.append(between(*planes, moved[first:last].mean(axis=0), PLANE * size[part]))
    left = np.array([shape is not None for shape in shapes], dtype=bool)
    block = owner[single]
    gone = np.setdiff1d(block, block[left])
    if len(gone):
        raise _nothing_left(parts, int(np.argmax(owner == gone[0])), origin)
    return [shape for shape in shapes if shape is not None], block[left]


def _nothing_left(parts: Blocks, part: int, origin: np.ndarray) -> SceneError:
    name, (x, _, z) = parts.names[part], parts.centroid[part] + origin
    rule = f"is so thin near (x, z) = {place_text((x, z))} that the repair would remove it"
    return SceneError(f'block "{name}"', rule, hint="take a smaller tolerance, or remove the block", blocks=[name])


@dataclass
class _Overlaps:
    """Result of the cuts: number of cuts, depth of the deepest one (m), and overlaps that are too deep to be cut, by their two blocks."""

    cut: int = 0
    deepest: float = 0.0
    deep: dict[tuple[str, str], Unclosed] = field(default_factory=dict)


@dataclass(frozen=True)
class _Drawn:
    """The parts as they were drawn, the block of each, and the deepest overlap that may be cut, m."""

    parts: Blocks
    owner: np.ndarray
    most: float

    def deep(self, a: int, b: int) -> bool:
        """Whether blocks a and b were drawn with an overlap that is too deep to be cut."""
        pairs = np.array(list(product(np.flatnonzero(self.owner == a), np.flatnonzero(self.owner == b))))
        return any(depth > self.most for *_, depth, _ in overlaps(self.parts, pairs, np.full(len(pairs), self.most / 2.0)))


def _cut_overlaps(names: Sequence[str], pieces: list[Shape], owner: np.ndarray, drawn: _Drawn, origin: np.ndarray) -> _Overlaps:
    """Cut every part that overlaps another block, along a face of the other one; `pieces` changes in place.

    An overlap that became too deep only because faces moved is also cut.
    """
    found = _Overlaps()
    for _ in range(ROUNDS):
        parts = _gathered([names[block] for block in owner], pieces).parts
        if (flat := ~np.isfinite(parts.face_normal).all(axis=1)).any():
            raise _nothing_left(parts, int(parts.face_block[np.argmax(flat)]), origin)
        size = np.linalg.norm(parts.high - parts.low, axis=1)
        pairs = near_pairs(parts, np.zeros(len(parts)))
        pairs = pairs[owner[pairs[:, 0]] != owner[pairs[:, 1]]]
        changed: set[int] = set()
        for a, b, depth, middle in overlaps(parts, pairs, OVERLAP * size[pairs].min(axis=1)):
            if depth > drawn.most and drawn.deep(int(owner[a]), int(owner[b])):
                both = parts.names[a], parts.names[b]
                found.deep[both] = Unclosed(both, middle, -depth)
            elif a not in changed and b not in changed:  # the next round finds the other pairs again
                cut, rest, off = _cut_part(parts, a, b, origin)
                pieces[cut] = rest
                found.deepest = max(found.deepest, off)
                changed.add(cut)
        found.cut += len(changed)
        if not changed:
            break
    return found


def _gathered(names: Sequence[str], shapes: Sequence[Shape]) -> Blocks:
    with np.errstate(divide="ignore", invalid="ignore"):  # a face without area has no normal
        return Blocks.gather(list(names), ["fixed"] * len(shapes), [1.0] * len(shapes), list(shapes))


def _cut_part(parts: Blocks, a: int, b: int, origin: np.ndarray) -> tuple[int, Shape, float]:
    """Choose the cut of two overlapping parts. Return the part to cut, its remainder, and the depth of the cut, m.

    Among the cuts that are nearly as shallow as the shallowest one, the cut that removes the least volume is chosen. A long part that is
    cut along a slightly inclined face of a short part might otherwise lose a joint beside it.
    """
    cuts = [*_cuts(parts, a, b), *_cuts(parts, b, a)]
    shallow = NEARLY * max(height for height, _, _ in cuts)
    found = []
    for height, plane, cut in cuts:
        if height < shallow:
            continue
        faces = slice(parts.part_face_start[cut], parts.part_face_start[cut + 1])
        normal = np.concatenate([parts.face_normal[faces], -plane[None, :3]])
        offset = np.concatenate([parts.face_offset[faces], [-plane[3]]])
        rest = between(normal, offset, parts.centroid[cut], PLANE * float(np.linalg.norm(parts.high[cut] - parts.low[cut])))
        if rest is not None:
            left = Blocks.gather([""], ["fixed"], [1.0], [rest]).volume[0]
            found.append((float(parts.volume[cut] - left), cut, rest, -height))
    if not found:
        raise _nothing_left(parts, max(cuts, key=lambda one: one[0])[2], origin)
    return min(found, key=lambda one: one[0])[1:]


def _cuts(parts: Blocks, a: int, b: int) -> Iterator[tuple[float, np.ndarray, int]]:
    """Yield the cuts of part b along the faces of part a: minus the depth of b behind the face, m, the plane (4,) of the face, and b."""
    faces = slice(parts.part_face_start[a], parts.part_face_start[a + 1])
    vertices = parts.vertices[parts.vertex_start[b] : parts.vertex_start[b + 1]]
    planes = np.column_stack([parts.face_normal[faces], parts.face_offset[faces]])
    for height, plane in zip((vertices @ planes[:, :3].T - planes[:, 3]).min(axis=0).tolist(), planes, strict=True):
        yield height, plane, b
