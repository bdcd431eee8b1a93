"""Joints beside those that a repair closes: one that stays a little too far open is named."""

import pytest
import scenes


def test_a_gap_a_little_wider_than_the_tolerance_closes_is_named() -> None:
    """A lintel lies on two stones, and the lower one beside them is 11 mm or 16 mm too low: without a word it carried nothing."""
    parts = [*scenes.base(0.7, 1.5, 1.0), *(scenes.box(f"{k}", (0.5 * k, 0.0, 0.0), (0.5 * k + 0.5, 1.0, 0.5)) for k in (0, 1))]
    for gap, named in ((0.011, [{"low", "lintel"}]), (0.016, [])):
        low, lintel = scenes.box("low", (1.0, 0.0, 0.0), (1.5, 1.0, 0.5 - gap)), scenes.box("lintel", (0.0, 0.0, 0.5), (1.5, 1.0, 0.8))
        scene = scenes.build(*parts, low, lintel, scenes.table("geometry", tolerance=0.005))
        assert [set(one.blocks) for one in scene.repairs.unclosed] == named
        assert [one.gap for one in scene.repairs.unclosed] == pytest.approx([gap] * len(named))
