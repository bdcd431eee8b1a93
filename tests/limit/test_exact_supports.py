"""Blocks on supports that are statically determinate have the reactions of statics."""

import pytest
import scenes
from associated_values import EXACT, in_plane_and_3d, value

from la_core.analysis.stage import analyse
from la_core.limit.associated import solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble

RECTANGLE = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5))
TRIANGLE = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.5))


@in_plane_and_3d
@pytest.mark.parametrize("friction", [0.05, 0.6, 2.0])
@pytest.mark.parametrize(
    ("profile", "centroid", "fixed", "settling"),
    [
        (RECTANGLE, 0.5, (0.0, 0.4), (0.5, 1.0)),
        (RECTANGLE, 0.5, (0.1, 0.2), (0.7, 0.9)),
        (RECTANGLE, 0.5, (0.0, 0.6), (0.7, 1.0)),
        (RECTANGLE, 0.5, (0.0, 0.1), (0.2, 0.8)),
        (TRIANGLE, 2.0 / 3.0, (0.0, 0.3), (0.75, 1.0)),
        (TRIANGLE, 2.0 / 3.0, (0.25, 0.5), (0.5, 0.75)),
    ],
)
def test_block_on_two_pads(profile, centroid, fixed, settling, friction, plane) -> None:
    scene = scenes.build(
        scenes.block("block", prism=(profile, (0.0, 1.0))),
        scenes.box("fixed pad", (fixed[0], 0.0, -0.1), (fixed[1], 1.0, 0.0), "fixed"),
        scenes.box("settling pad", (settling[0], 0.0, -0.1), (settling[1], 1.0, 0.0), "support"),
        friction=friction,
        plane=plane,
    )
    least = max(0.0, (centroid - fixed[1]) / (settling[1] - fixed[1]))
    greatest = min(1.0, (centroid - fixed[0]) / (settling[0] - fixed[0]))
    assert value(scene) == pytest.approx(least, abs=EXACT)
    assert value(scene, Drive.PUSHING) == pytest.approx(greatest, abs=EXACT)


@in_plane_and_3d
def test_trilith_weighs_on_its_posts_as_statics_says(plane) -> None:
    scene = scenes.build(
        scenes.box("left post", (0.0, 0.0, 0.0), (0.5, 1.0, 2.0)),
        scenes.box("right post", (2.5, 0.0, 0.0), (3.0, 1.0, 2.0)),
        scenes.box("lintel", (0.0, 0.0, 2.0), (3.0, 1.0, 2.5)),
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.5, 1.0, 0.0), "fixed"),
        scenes.box("settling pad", (2.5, 0.0, -0.1), (3.0, 1.0, 0.0), "support"),
        density=1.0,
        gravity=scenes.DOWN,
        plane=plane,
    )
    assembly = assemble(scene)
    assert solve_associated(assembly, Drive.YIELDING).value == pytest.approx(1.6, abs=EXACT)
    assert solve_associated(assembly, Drive.PUSHING).value == pytest.approx(1.9, abs=EXACT)


@pytest.mark.parametrize(("xi", "eta"), [(0.6, 0.7), (0.5, 0.8), (0.3, 0.4), (0.7, 0.75)])
def test_slab_on_four_corner_pads(xi, eta) -> None:
    """Pads of real size placed so that only their outermost points count: see slab_four_corners.toml."""
    size = 0.02
    corners = {"a": (0.0, 0.0), "b": (1.0 - size, -size), "c": (0.0, 1.0 - 2.0 * size), "settling": (1.0, 1.0 - 2.0 * size)}
    pads = [
        scenes.box(name, (px, py, -0.1), (px + size, py + size, 0.0), "support" if name == "settling" else "fixed")
        for name, (px, py) in corners.items()
    ]
    slab = scenes.box("slab", (xi - 1.1, eta - 1.1, 0.0), (xi + 1.1, eta + 1.1, 0.2))
    scene = scenes.build(slab, *pads)
    assert value(scene) == pytest.approx(max(0.0, xi + eta - 1.0), abs=EXACT)
    assert value(scene, Drive.PUSHING) == pytest.approx(min(xi, eta), abs=EXACT)


@pytest.mark.parametrize("inset", [0.001, 0.01])
def test_rounding_shifts_the_lever_arms_by_the_inset(inset, two_pads) -> None:
    """The block rests on points at 0.4 m - inset and 1 m - inset. The answer for sharp edges does not change."""
    scene = scenes.load(two_pads.replace("friction = 0.6", f"friction = 0.6\ninset = {inset}"))
    analysis = analyse(scene)
    assert analysis.assembly.inset == inset
    rounded = (0.5 - (0.4 - inset)) / (1.0 - 0.4)
    assert analysis.bounds[Drive.YIELDING].value / scene.weight == pytest.approx(rounded, abs=EXACT)
    assert analysis.sharp.bounds[Drive.YIELDING].value / scene.weight == pytest.approx(1.0 / 6.0, abs=EXACT)


@pytest.mark.parametrize("width", [0.4, 0.02])
def test_sharp_scene_is_compared_at_the_smallest_inset(width) -> None:
    """YADE's contact spheres need an inset. Limit analysis solves with the same inset and, in addition, with sharp edges."""
    scene = scenes.build(*scenes.base(width, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)))
    analysis = analyse(scene)
    inset = analysis.assembly.inset
    assert 0.0 < inset <= min(0.001, 0.02 * width)
    # The right edges of both bases carry the block; each is moved inwards by the inset.
    fixed = width - inset
    assert analysis.bounds[Drive.YIELDING].value / scene.weight == pytest.approx((0.5 - fixed) / (1.0 - inset - fixed), abs=EXACT)
    assert analysis.sharp.bounds[Drive.YIELDING].value / scene.weight == pytest.approx((0.5 - width) / (1.0 - width), abs=EXACT)
