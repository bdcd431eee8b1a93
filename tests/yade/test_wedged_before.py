"""Another past may end in another mechanism. Its value keeps within the bounds, but may leave the interval of a prediction."""

from pathlib import Path

import pytest

import comparison
import la_core


def block_under_a_leaning_wall(lift: float) -> la_core.Scene:
    """A block spans from a ledge to a settling pad, below a wall that leans over its end. The pad is first lifted by `lift`, m."""

    def box(name: str, role: str, low: tuple[float, float], high: tuple[float, float]) -> dict[str, object]:
        return {"name": name, "role": role, "box": {"from": [low[0], 0.0, low[1]], "to": [high[0], 0.2, high[1]]}}

    def prism(name: str, role: str, profile: list[list[float]]) -> dict[str, object]:
        return {"name": name, "role": role, "prism": {"profile": profile, "y": [0.0, 0.2]}}

    tables = {
        "title": "Block under a leaning wall",
        "stone": {"density": 2000.0},
        "joint": {"friction": 0.9},
        "block": [
            box("wall", "fixed", (-0.2, 0.1), (0.0, 0.25)),
            box("ledge", "fixed", (0.0, -0.1), (0.1, 0.0)),
            box("pad", "support", (0.8, -0.1), (1.0, 0.0)),
            prism("block", "free", [[0.0, 0.0], [1.0, 0.0], [0.9, 0.25], [0.0, 0.25]]),
            prism("leaning wall", "fixed", [[1.0, 0.0], [1.3, 0.0], [1.3, 0.25], [0.9, 0.25]]),
        ],
        "settlement": {"direction": [0.0, 0.0, -1.0]},
        "yade": {"wedging": lift},
    }
    return la_core.build(tables, "lifted" if lift else "from_rest")


@pytest.mark.slow
def test_a_block_that_was_wedged_leaves_the_interval_that_holds_from_rest(tmp_path: Path) -> None:
    """From rest, moments about the ledge's edge give the reaction. A lift wedges the block between the walls, and it needs no support."""
    from_rest, lifted = (comparison.run(block_under_a_leaning_wall(lift), tmp_path, quiet=True) for lift in (0.0, 5e-4))
    by_moments = ((0.225 * 0.45 + 0.0125 * 2.8 / 3.0) / 0.2375 - 0.099) / (0.999 - 0.099)  # a rectangle and a triangle; edges at the inset
    weight = from_rest.scene.weight
    answer, other = from_rest.answer, lifted.answer
    assert from_rest.verdict == lifted.verdict == "agree"
    assert from_rest.yade is not None and lifted.yade is not None
    assert answer.coulomb == pytest.approx(by_moments * weight, rel=1e-6)
    assert answer.interval == pytest.approx((answer.coulomb, answer.coulomb), rel=1e-6)
    assert from_rest.yade.reaction == pytest.approx(by_moments * weight, rel=5e-3)
    for least in (answer.least, other.least):
        assert least == pytest.approx(0.0, abs=1e-6 * weight)
    assert other.coulomb == pytest.approx(0.0, abs=1e-6 * weight)
    assert lifted.yade.reaction == pytest.approx(0.0, abs=1e-4 * weight)
