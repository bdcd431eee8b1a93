"""Joints beside those that a repair closes stay whole when an overlap is cut, and a joint that stays slightly too far open is named."""

import numpy as np
import pytest
import scenes

from la_core.geometry import Blocks, box, find_interfaces
from la_core.repair.facing import facing_faces
from la_core.repair.unclosed import unclosed


def test_a_gap_a_little_wider_than_the_tolerance_closes_is_named() -> None:
    """A lintel lies on two stones. A third stone beside them is 11 mm or 16 mm too low. It carried nothing, and no warning said so."""
    parts = [*scenes.base(0.7, 1.5, 1.0), *(scenes.box(f"{k}", (0.5 * k, 0.0, 0.0), (0.5 * k + 0.5, 1.0, 0.5)) for k in (0, 1))]
    for gap, named in ((0.011, [{"low", "lintel"}]), (0.016, [])):
        low, lintel = scenes.box("low", (1.0, 0.0, 0.0), (1.5, 1.0, 0.5 - gap)), scenes.box("lintel", (0.0, 0.0, 0.5), (1.5, 1.0, 0.8))
        scene = scenes.build(*parts, low, lintel, scenes.table("geometry", tolerance=0.005))
        assert [set(one.blocks) for one in scene.repairs.unclosed] == named
        assert [one.gap for one in scene.repairs.unclosed] == pytest.approx([gap] * len(named))


def test_a_cut_of_an_overlap_leaves_the_joint_beside_it_whole() -> None:
    """The bottom of "left" leans by a degree and lies 10.05 mm too low at its end. The stone below was cut along it, also under "right"."""
    base = scenes.box("stone", (0.0, 0.0, 0.0), (1.0, 1.0, 0.3))
    left = scenes.block("left", prism=([(0.0, 0.28995), (0.398, 0.296), (0.398, 0.6), (0.0, 0.6)], (0.0, 1.0)))
    right = scenes.box("right", (0.4, 0.0, 0.3), (1.0, 1.0, 0.6))
    scene = scenes.build(*scenes.base(0.5, 1.0, 1.0), base, left, right, scenes.table("geometry", tolerance=0.005))
    assert scene.repairs.overlaps_cut == 1
    names, found = scene.blocks.names, find_interfaces(scene.blocks)
    area = {(names[a], names[b]): area for a, b, area in zip(found.block_a, found.block_b, found.area, strict=True)}
    assert area[("stone", "right")] == pytest.approx(0.6, abs=0.003)
    assert area[("stone", "left")] == pytest.approx(0.4, abs=0.003)


@pytest.mark.parametrize("order", [(0, 1, 2), (1, 0, 2), (2, 1, 0)])
@pytest.mark.parametrize(("width", "count"), [(0.008, 0), (0.012, 1)])
def test_what_stays_open_is_named_by_its_width_in_every_direction(width: float, count: int, order: tuple[int, int, int]) -> None:
    """The length was measured along x and z alone. A strip along x too narrow for a joint was named, and a strip along y was not."""
    ends = [((0.0, 0.0, 0.0), (2.0, width, 0.5)), ((0.0, 0.0, 0.504), (2.0, width, 1.0))]
    shapes = [box(*(np.array(corner)[list(order)].tolist() for corner in both)) for both in ends]
    parts = Blocks.gather(["a", "b"], ["fixed"] * 2, [1.0] * 2, shapes)
    pairs = facing_faces(parts, np.arange(2), np.full(2, 0.01))
    found = unclosed(["a", "b"], parts, np.arange(2), pairs, np.ones(len(pairs), dtype=bool), tolerance=0.005)
    assert [one.gap for one in found] == pytest.approx([0.004] * count)
