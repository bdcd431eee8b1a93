"""The upper faces of blocks in plan, and the parts of loads that each of them carries."""

from dataclasses import dataclass

import numpy as np
import shapely

from la_core.geometry import Blocks, face_corners, polygons_of

UPWARD = 0.1  # z of a normal from which on a face is a top face; the extrados of an arch carries its fill down to steep flanks
COUNTED_TWICE = 1e-6  # of the whole: overlap in plan that is more than round-off


@dataclass(frozen=True)
class Carried:
    """What N faces carry of a load.

    Attributes
    ----------
    block : (N,) array of int
        Block of each face.
    point : (N, 3) array
        Middle of the loaded part of the face, m.
    share : (N,) array
        Loaded length, m, or area in plan, m2.
    overlaps : bool
        Whether loaded parts lie above each other in plan, so that the load would count more than once.
    """

    block: np.ndarray
    point: np.ndarray
    share: np.ndarray
    overlaps: bool


def carried(blocks: Blocks, chosen: np.ndarray, line: tuple[tuple[float, float], tuple[float, float]] | None) -> Carried:
    """What the top faces of blocks carry of a load along a line, or of one on all their area.

    Parameters
    ----------
    blocks : Blocks
        Blocks of the scene.
    chosen : (B,) array of bool
        Loaded blocks.
    line : two points (x, y), or None
        Line of the load in plan, m; None for the whole area.
    """
    face = np.flatnonzero(chosen[blocks.face_block] & (blocks.face_normal[:, 2] > UPWARD))
    plan = _uncovered(blocks, face, _in_plan(blocks, face))
    if line is None:
        parts, share = plan, shapely.area(plan)
        whole = shapely.area(shapely.union_all(parts))
    else:
        parts = np.atleast_1d(shapely.intersection(plan, shapely.LineString(line)))
        share = shapely.length(parts)
        whole = shapely.length(shapely.union_all(parts))
    kept = share > 0.0
    face, parts, share = face[kept], parts[kept], share[kept]
    middle = shapely.get_coordinates(shapely.centroid(parts)).reshape(-1, 2)
    normal, offset = blocks.face_normal[face], blocks.face_offset[face]
    height = (offset - np.sum(normal[:, :2] * middle, axis=1)) / normal[:, 2]
    overlaps = bool(share.sum() > (1.0 + COUNTED_TWICE) * float(whole))
    return Carried(blocks.face_block[face], np.column_stack([middle, height]), share, overlaps)


def _in_plan(blocks: Blocks, face: np.ndarray) -> np.ndarray:
    """Polygons (N,) of the faces (N,) seen from above."""
    _, corners = face_corners(blocks, face)
    return polygons_of(corners[:, :2], np.diff(blocks.face_start)[face])


def _uncovered(blocks: Blocks, face: np.ndarray, plan: np.ndarray) -> np.ndarray:
    """The polygons (N,) without what lies under a higher face of the same block: only compound blocks have such parts."""
    uncovered, owner = plan.copy(), blocks.face_block[face]
    for block in np.flatnonzero(blocks.is_compound):
        own = np.flatnonzero(owner == block)
        top = [blocks.vertices[blocks.face_vertex[blocks.face_start[k] : blocks.face_start[k + 1]], 2].max() for k in face[own]]
        above = shapely.Polygon()
        for k in own[np.argsort(top, kind="stable")[::-1]]:
            uncovered[k] = shapely.difference(plan[k], above)
            above = shapely.union(above, plan[k])
    return uncovered
