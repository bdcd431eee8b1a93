"""The value of a turning support is the moment of its reaction. About a far axis it is the force times the distance."""

import pytest
import scenes
from scenes_of_laws import INDEPENDENT, WALL, solutions, values


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parametrize(("pivot_x", "pivot_z"), [(0.0, 0.0), (-1.0, 0.4), (0.4, 0.0)])
def test_turning_pad_feels_the_moment_of_its_reaction(pivot_x, pivot_z, plane) -> None:
    """Block [0, 1] on a fixed pad [0, 0.4] and a pad [0.5, 1] that turns about y, clockwise seen with x right and z up:
    the pad's points sink in proportion to x - pivot, so the reaction acts on the block at one edge of the pad."""
    scene = scenes.build(
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)),
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 1.0, 0.0), "fixed"),
        scenes.box("turning pad", (0.5, 0.0, -0.1), (1.0, 1.0, 0.0), "support"),
        settlement={"axis": (0.0, 1.0, 0.0), "point": (pivot_x, 0.0, pivot_z)},
        friction=0.0,  # only vertical forces: statics of a beam
        plane=plane,
    )
    assert scene.is_rotation and scene.unit == "N m"
    # Vertical force P at x in [0.5, 1] with P x + Q q = W/2, P + Q = W, q in [0, 0.4]: M = P (x - pivot) over the extreme points.
    moments = []
    for at in (0.5, 1.0):
        for other in (0.0, 0.4):
            force = (0.5 - other) / (at - other)
            moments.append(force * (at - pivot_x))
    least, greatest = (s.value / a.weight for a, _, s in solutions(scene))
    assert [least, greatest] == pytest.approx([min(moments), max(moments)], abs=INDEPENDENT)


def test_far_axis_is_a_translation() -> None:
    far = 1e4
    turning = scenes.load(WALL.replace("direction = [0.0, 0.0, -1.0]", f"axis = [0.0, 1.0, 0.0]\npoint = [{-far}, 0.0, 0.0]"))
    reaction = [solution.value / (assembly.weight * far) for assembly, _, solution in solutions(turning)]
    assert reaction == pytest.approx(values(scenes.load(WALL)), abs=3.0 / far)  # lever arms differ by the wall's own length
