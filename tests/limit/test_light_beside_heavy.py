"""A reaction of light blocks beside heavy ones: the error of its value is known, however small the residuals of the heavy blocks are."""

from dataclasses import replace

import numpy as np
import pytest
import scenes

from la_core.analysis import analyse
from la_core.exchange import SUPPORT
from la_core.limit import Solution, Status, solve_associated, value_error
from la_core.limit.problem import Drive
from la_core.measures import residuals
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

GRAVITY, DENSITY = 9.81, 2000.0
LIGHT = 100.0  # N: of a stone
SIZES = [0.2, 1.0, 5.0, 30.0]  # of a cube beside a stone of 12.8 kg, m: its mass is 1.25 to 4 million times the stone's
TOLD = 2.0  # times the error that is told to first order


def doorstep(cube: float) -> Scene:
    """A stone of 0.2 x 0.2 x 0.16 m on two pads of 0.06 m, of which the right one settles, and a cube on ground of its own."""
    return scenes.build(
        scenes.box("ground", (0.0, 0.0, -0.2), (cube, cube, 0.0), "fixed"),
        scenes.box("cube", (0.0, 0.0, 0.0), (cube, cube, cube)),
        scenes.box("left pad", (40.0, 0.0, -0.2), (40.06, 0.2, 0.0), "fixed"),
        scenes.box("right pad", (40.14, 0.0, -0.2), (40.2, 0.2, 0.0), "support"),
        scenes.box("stone", (40.0, 0.0, 0.0), (40.2, 0.2, 0.16)),
        friction=0.6,
        settlement=scenes.DOWN,
        model="coulomb",
    )


def beside(size: float, role: str) -> Scene:
    """Two stones on a settling pad, against a long block that is fixed, or free and heavy."""
    return scenes.build(
        scenes.box("ground", (-size, 0.0, -0.2), (0.0, 0.2, 0.0), "fixed"),
        scenes.box("wall", (-size, 0.0, 0.0), (0.0, 0.2, 0.9), role),
        scenes.box("pad", (0.1, 0.0, -0.2), (0.2, 0.2, 0.0), "support"),
        scenes.box("low", (0.0, 0.0, 0.0), (0.2, 0.2, 0.2)),
        scenes.box("middle", (0.0, 0.0, 0.2), (0.25, 0.2, 0.4)),
        friction=0.5,
        settlement=scenes.DOWN,
    )


def error_told(assembly: Assembly, solution: Solution) -> float:
    """Largest error of a bound, N: what it tells to first order, with room for the second."""
    return TOLD * value_error(assembly, solution) + 1e-9 * LIGHT


@pytest.mark.parametrize("cube", SIZES)
def test_the_reaction_of_a_stone_beside_a_cube_is_that_of_statics(cube: float) -> None:
    """It turns about the inner or the outer edge of the left pad: R = W 0.04 / 0.14 and W 0.10 / 0.14."""
    scene = doorstep(cube)
    assembly, weight = assemble(scene), 0.2 * 0.2 * 0.16 * DENSITY * GRAVITY
    for drive, share in ((Drive.YIELDING, 0.04 / 0.14), (Drive.PUSHING, 0.10 / 0.14)):
        solution = solve_associated(assembly, drive)
        error = abs(solution.value - share * weight)
        assert solution.status is Status.SOLVED
        assert error <= error_told(assembly, solution)
        assert error <= max(1e-3 * weight, 1e-8 * assembly.weight)
    analysis = analyse(scene)
    assert analysis.coulomb is not None
    of_rounded_edges = (0.04 + analysis.assembly.inset) / 0.14 * weight
    assert abs(analysis.coulomb.value - of_rounded_edges) <= TOLD * analysis.coulomb.uncertainty + 1e-9 * LIGHT


@pytest.mark.parametrize("size", [1.0, 10.0, 100.0, 1000.0])
def test_a_heavy_block_that_rests_is_as_good_as_ground(size: float) -> None:
    """The bounds of two stones beside it are those beside a fixed block, to within the error that they tell."""
    heavy, fixed = (assemble(beside(size, role)) for role in ("free", "fixed"))
    for drive in (Drive.YIELDING, Drive.PUSHING):
        bound, other = solve_associated(heavy, drive), solve_associated(fixed, drive)
        assert bound.status is other.status is Status.SOLVED
        assert abs(bound.value - other.value) <= error_told(heavy, bound) + error_told(fixed, other)


def test_forces_out_of_balance_are_an_error_of_the_value() -> None:
    """The forces balance a stone that is 3 N lighter on the settling pad. The reaction is too small by 3 N, and this is its error."""
    assembly = assemble(doorstep(0.2))
    solution = solve_associated(assembly, Drive.YIELDING)
    on_pad = (assembly.blocks.role == SUPPORT)[np.column_stack(assembly.contact_blocks)].any(axis=1)
    pressed = on_pad & (np.abs(solution.forces[:, 2]) > 1.0)
    lighter = solution.forces.copy()
    lighter[pressed, 2] *= 1.0 - 3.0 / np.abs(solution.forces[pressed, 2]).sum()
    assert residuals.reaction(assembly, lighter) == pytest.approx(solution.value - 3.0, rel=1e-9)
    assert residuals.power_of_unbalanced(assembly, solution.twists, lighter) == pytest.approx(3.0, rel=1e-6)
    assert value_error(assembly, solution) <= 1e-6
    assert value_error(assembly, replace(solution, forces=lighter)) == pytest.approx(3.0, rel=1e-6)
