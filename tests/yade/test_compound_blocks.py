"""Blocks of several convex parts in both methods: a clump of YADE must move as the one block of limit analysis does."""

from pathlib import Path

import pytest
import scenes

from comparison.result import run
from comparison.verdict import Verdict

pytestmark = pytest.mark.yade

CORNER = [[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.5, 0.5], [0.5, 1.0], [0.0, 1.0]]


@pytest.mark.slow_after_first
@pytest.mark.parametrize("displacement", ["small", "finite"])
def test_a_corner_block_and_the_block_in_its_corner_settle_alike_in_both_methods(displacement: str, tmp_path: Path) -> None:
    """Together both blocks have the weight and centroid of a box. The corner's own centroid differs, and its faces lie on two levels."""
    parts = (scenes.block("L", prism=(CORNER, [0.0, 1.0])), scenes.box("fill", (0.5, 0.0, 0.5), (1.0, 1.0, 1.0)))
    scene = scenes.build(*scenes.base(0.4, 1.0), *parts, inset=0.001, model="coulomb", effects={"displacement": displacement})
    result = run(scene, tmp_path, quiet=True)
    assert result.verdict == Verdict.AGREE, result.reason
    rounded = (0.5 - 0.399) / (0.999 - 0.399)
    assert result.yade.reaction / scene.weight == pytest.approx(rounded, rel=2e-3)
