"""Overlaps of faces: polygons that share a part of an edge have the overlap that half-planes cut, whatever GEOS returns."""

import numpy as np
import pytest
import scenes
import shapely

from la_core.analysis import analyse
from la_core.geometry import overlap_of
from la_core.limit import Drive

KNOWN = (3, 14, 1)  # version of GEOS that loses some overlaps


def flush_pairs(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Convex polygons, and for each a triangle that has an edge on the line of one of its edges and lies on either side of it."""
    rng = np.random.default_rng(seed)
    hulls = shapely.convex_hull(shapely.multipoints(rng.normal(size=(count, 6, 2))))
    corners = [shapely.get_coordinates(hull)[:-1] for hull in hulls]
    triangles = []
    for corner in corners:
        k = rng.integers(len(corner))
        tail, along = corner[k], corner[(k + 1) % len(corner)] - corner[k]
        low, high = np.sort(rng.uniform(-0.5, 1.5, 2))
        across = rng.choice([-1.0, 1.0]) * rng.uniform(0.1, 1.0) * np.array([-along[1], along[0]])
        ends = tail + low * along, tail + high * along
        triangles.append(shapely.Polygon([*ends, ends[0] + rng.uniform() * (ends[1] - ends[0]) + across]))
    return hulls, np.array(triangles)


@pytest.mark.slow_after_first
@pytest.mark.parametrize("turned", [False, True])
def test_flush_polygons_overlap_as_on_a_grid(turned: bool) -> None:
    """GEOS alone loses some of these overlaps, because it returns points. On a grid it loses none."""
    first, second = flush_pairs(20_000, seed=0)
    if turned:
        first, second = second, shapely.reverse(first)
    found, alone = overlap_of(first, second), shapely.intersection(first, second)
    lost = np.flatnonzero(np.abs(shapely.area(found) - shapely.area(alone)) > 1e-6)
    assert len(lost) >= 20 or shapely.geos_version > KNOWN  # a newer GEOS may lose none
    on_grid = np.array([shapely.intersection(first[k], second[k], grid_size=1e-10).area for k in lost])
    assert np.abs(shapely.area(found[lost]) - on_grid).max() < 1e-8
    some = np.arange(0, len(first), 20)
    on_grid = np.array([shapely.intersection(first[k], second[k], grid_size=1e-10).area for k in some])
    assert np.abs(shapely.area(found[some]) - on_grid).max() < 1e-8


def test_polygons_that_do_not_overlap_have_no_overlap() -> None:
    square = shapely.box(0.0, 0.0, 1.0, 1.0)
    others = np.array(
        [shapely.box(2.0, 0.0, 3.0, 1.0), shapely.box(1.0, 0.0, 2.0, 1.0), shapely.box(1.0, 1.0, 2.0, 2.0), shapely.Polygon()]
    )
    assert shapely.area(overlap_of(np.full(4, square), others)).tolist() == [0.0, 0.0, 0.0, 0.0]
    flat = np.array([shapely.Polygon([(0.5, 0.5)] * 4), shapely.Polygon([(0.0, 0.0), (1.0, 1.0), (0.5, 0.5)])])  # a point and a line
    assert (
        shapely.area(overlap_of(np.full(2, square), flat)).tolist()
        == shapely.area(overlap_of(flat, np.full(2, square))).tolist()
        == [0.0, 0.0]
    )
    assert len(overlap_of(np.zeros(0, dtype=object), np.zeros(0, dtype=object))) == 0


FREE = (
    (0.6459451291723574, 0.0, 0.9235990046815656), (0.6459451291723574, 0.0, 0.5894025827246139),
    (0.0, 0.3348594929168357, 0.9235990046815656), (0.48406141169596756, 0.0, 0.9235990046815656),
    (0.6459451291723574, 0.17320029859354025, 0.07252807756752065), (0.6459451291723574, 0.4936998709276885, 0.9235990046815656),
    (0.0, 0.5824299509204148, 0.9235990046815656), (0.0, 0.45142776636189935, 0.5757291156386537),
)  # fmt: skip
FIXED = (
    (0.6459451291723574, 0.7163592251602431, 0.0), (0.6459451291723574, 0.19750384726110723, 0.0),
    (0.29254728111505324, 0.4419741176422065, 0.0), (0.6459451291723574, 0.17320029859354025, 0.07252807756752065),
    (0.04030302405832792, 0.463781347201401, 0.4556603560726902), (0.6459451291723574, 0.9340139053300989, 0.4556603560726902),
    (0.6459451291723574, 0.31748172978365774, 0.4556603560726902), (0.15412891576037918, 0.3850399324651744, 0.4556603560726902),
)  # fmt: skip
SUPPORT = (
    (0.6459451291723574, 1.1575335412710224, 0.9235990046815656), (0.0, 0.6560089148676101, 0.9235990046815656),
    (0.0, 0.4672656576385344, 0.5284647501449565), (0.6459451291723574, 0.4936998709276885, 0.9235990046815656),
    (0.0, 0.5824299509204148, 0.9235990046815656), (0.0, 0.45142776636189935, 0.5757291156386537),
    (0.04030302405832792, 0.463781347201401, 0.4556603560726902), (0.6459451291723574, 0.9340139053300989, 0.4556603560726902),
    (0.6459451291723574, 0.31748172978365774, 0.4556603560726902), (0.15412891576037918, 0.3850399324651744, 0.4556603560726902),
)  # fmt: skip


def test_a_block_on_two_flush_faces_has_a_joint_with_each() -> None:
    """Gravity acts along the normal of the plane below the block. An independent linear programme with sharp edges and a friction
    pyramid gives 0.41534 W. One joint was lost, and the reaction was 1 W in both methods."""
    down = np.array([1.250797964097431, 9.10567028175415, -3.4290484354976716])
    parts = [
        scenes.block(name, role, 2000.0, polyhedron=vertices)
        for name, role, vertices in (("free", "free", FREE), ("fixed", "fixed", FIXED), ("pad", "support", SUPPORT))
    ]
    analysis = analyse(scenes.build(*parts, friction=0.6, inset=0.0005, gravity=down, settlement=down / np.linalg.norm(down)))
    assert len(analysis.whole.interfaces) == 2
    least, greatest = (analysis.sharp.bounds[drive].value / analysis.scene.weight for drive in (Drive.YIELDING, Drive.PUSHING))
    assert least == pytest.approx(0.41534, abs=1e-5) and greatest == pytest.approx(1.0, abs=1e-6)
