"""The predicted mechanism is one of blocks as laid: it pushes no block into its neighbour, although elastic joints may have a gap there."""

from itertools import pairwise

import numpy as np
import pytest
import scenes

import la_core
from la_core.scene import Scene

PUSH = (1.0, 0.0, 0.0)
MU = 0.35


def row(loaded: int, lengths: tuple[float, ...], friction: float = MU, plane: bool | str = "auto") -> Scene:
    """Boxes in a row on the ground, pushed along it; a mass lies on one of them. All slide at the multiplier mu."""
    ends = np.cumsum([0.0, *lengths]).tolist()
    boxes = [scenes.box(f"box {k}", (low, 0.0, 0.0), (high, 0.4, 0.4)) for k, (low, high) in enumerate(pairwise(ends))]
    middle = 0.5 * (ends[loaded] + ends[loaded + 1])
    mass = scenes.table("[load]", mass=100.0, blocks=(f"box {loaded}",), at=(middle, 0.2, 0.4))
    ground = scenes.box("ground", (-0.5, 0.0, -0.3), (ends[-1] + 0.5, 0.4, 0.0), "fixed")
    return scenes.build(ground, *boxes, mass, friction=friction, inset=0.001, live=PUSH, plane=plane, model="auto")


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parametrize("loaded", [0, 1, 2])
def test_blocks_in_a_row_do_not_push_through_each_other(loaded: int, plane: bool) -> None:
    answer = la_core.solve(row(loaded, (0.5, 0.7, 0.6), plane=plane))
    ahead = answer.mechanism[1:, 0]
    assert answer.coulomb == pytest.approx(MU, rel=1e-4)
    assert np.all(np.diff(ahead) >= -1e-6 * ahead.max()), "a block is pushed through the one ahead"
