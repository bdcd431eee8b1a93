"""Known values of friction without dilatancy: closed forms, values of other programs, cases without sliding."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scenes
from coulomb_problems import (
    DIGIT,
    FOUND,
    PLATEAU,
    STRAIN,
    UNSLIDING,
    answer,
    bounds,
    great_wall,
    in_plane_and_3d,
    problem,
    small_wall,
    value,
)

import la_core
from la_core.coulomb import follow_path, predict
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.scene.scene import Scene

PUBLISHED = 3e-3  # relative: the authors iterate otherwise to the same state, and print five digits


@in_plane_and_3d
@pytest.mark.parametrize("mu", [0.2, 0.6, 0.8])
@pytest.mark.parametrize(("columns", "courses", "settling"), [(2, 1, 1), (5, 4, 2), (6, 5, 3)])
def test_stack_bonded_wall_does_not_hang_on_its_neighbour(columns, courses, settling, mu, plane) -> None:
    """No force presses the head joint, so the reaction is the settling weight W_mov; for associated friction it is W_mov/(1 + mu^2)."""
    parts = scenes.wall(columns, courses, (columns - settling) * 0.4, block_size=(0.4, 1.0, 0.2), bond="stack")
    share = settling / columns
    assembly, solution = answer(scenes.build(*parts, friction=mu, plane=plane))
    assert solution.value / assembly.weight == pytest.approx(share, rel=STRAIN)
    assert solution.interval[0] / assembly.weight == pytest.approx(share / (1.0 + mu**2), abs=DIGIT)  # a pressed joint might carry some
    assert solution.interval[1] / assembly.weight == pytest.approx(share, abs=DIGIT)


@pytest.mark.parametrize(
    "name", ["trilith", "two_pads", "slab_four_corners", "flat_arch", "arch_spreading", "arch_settling", "arch_diagonal"]
)
def test_where_nothing_slides_the_associated_answer_is_coulombs(name) -> None:
    scene = scenes.shipped(name)
    assembly, solution = answer(scene, wedging=scene.yade.get("wedging", 0.0))  # without it the voussoirs of the flat arch slide down
    associated = solve_associated(assembly, Drive.YIELDING).value
    assert solution.value == pytest.approx(associated, rel=UNSLIDING)
    assert solution.interval == pytest.approx((associated, associated), rel=UNSLIDING)


@in_plane_and_3d
@pytest.mark.parametrize(("split", "followed"), [(1.6, 0.0703), (1.2, 0.1309)])
def test_running_bond_wall_reaches_the_plateau_of_an_independent_path(split, followed, plane) -> None:
    assert value(great_wall(0.6, split, plane)) == pytest.approx(followed, rel=PLATEAU)


@in_plane_and_3d
@pytest.mark.parametrize(("rows", "published"), [(6, 0.63982), (10, 0.56260)])
def test_walls_of_ferris_and_tin_loi(rows, published, plane) -> None:
    """Ferris & Tin-Loi 2001: friction without dilatancy; the associated multipliers are 0.64286 and 0.58000."""
    parts = scenes.wall(5, rows, block_size=(0.4, 1.0, 0.175), first="half")
    assert value(scenes.build(*parts, friction=0.65, live=(1.0, 0.0, 0.0), plane=plane)) == pytest.approx(published, rel=PUBLISHED)


def block_on_plane(height: float, azimuth: float, mu: float = 0.6, tilt: float = 0.0) -> Scene:
    downhill = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    return scenes.build(
        scenes.box("plane", (-9.0, -9.0, -1.0), (9.0, 9.0, 0.0), "fixed"),
        scenes.box("block", (-0.5, -0.5, 0.0), (0.5, 0.5, height)),
        friction=mu,
        gravity=9.81 * (math.sin(tilt) * downhill + math.cos(tilt) * np.array(scenes.DOWN)),
        live=downhill,
        plane=False,
    )


@pytest.mark.parametrize("azimuth", [math.radians(degrees) for degrees in (0, 10, 30, 45, 72, 135, 200, 290)])
@pytest.mark.parametrize("height", [0.5, 2.5])
def test_block_on_a_plane_slides_or_tips_whatever_the_azimuth(height, azimuth) -> None:
    """lambda = min(mu, b/h) across an edge, as for associated friction. The value is exact, and so is its interval."""
    critical = min(0.6, 1.0 / height / max(abs(math.cos(azimuth)), abs(math.sin(azimuth))))
    scene = block_on_plane(height, azimuth)
    assert value(scene) == pytest.approx(critical, rel=1e-5)
    assert bounds(scene) == pytest.approx([critical, critical], rel=UNSLIDING)  # the direction of slip is known to 0.01 rad


@pytest.mark.parametrize("azimuth", [0.0, 0.5, 2.0])
def test_inclined_plane(azimuth) -> None:
    tilt = 0.5 * math.atan(0.6)
    expected = 0.6 * math.cos(tilt) - math.sin(tilt)
    assert value(block_on_plane(0.5, azimuth, tilt=tilt)) == pytest.approx(expected, rel=1e-5)


@pytest.mark.parametrize(("mu", "side"), [(0.6, 1.0), (1.2, 0.4)])
def test_torsion_of_a_square_joint_on_its_four_corners(mu, side) -> None:
    """T = mu N a / sqrt(2). The live load is a moment about the joint's normal."""
    assembly, stiffness = problem(
        scenes.build(
            scenes.box("base", (-2.0, -2.0, -1.0), (2.0, 2.0, 0.0), "fixed"),
            scenes.box("block", (-side / 2.0, -side / 2.0, 0.0), (side / 2.0, side / 2.0, 0.5)),
            friction=mu, live=(1.0, 0.0, 0.0), plane=False,
        )
    )  # fmt: skip
    moment = np.zeros_like(assembly.live_load)
    moment[assembly.blocks.names.index("block"), 5] = 1.0
    assembly = replace(assembly, live_load=moment)
    solution = predict(assembly, stiffness, solve_associated(assembly, Drive.LIVE))
    assert solution.status is Status.SOLVED
    assert solution.value == pytest.approx(mu * assembly.weight * side / math.sqrt(2.0), rel=1e-5)


@in_plane_and_3d
def test_the_curve_of_a_push_is_over_the_mean_displacement_of_what_it_pushes(plane) -> None:
    """A block on springs at its edges carries a mass equal to its own on its top. It shears its springs and rocks by both moments."""
    breadth, height = 0.5, 0.7
    ground = scenes.box("ground", (-1.0, 0.0, -0.2), (2.0, 0.3, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (breadth, 0.3, height))
    floor = scenes.table("[load]", blocks=["block"], mass=2000.0 * breadth * 0.3 * height, at=(breadth / 2.0, 0.15, height))
    scene = scenes.build(ground, block, floor, friction=0.9, live=(1.0, 0.0, 0.0), plane=plane)
    assembly, stiffness = problem(scene)
    path = follow_path(assembly, stiffness, 4e-6, 1)
    points, lever = len(assembly.points.friction), 0.75 * height  # the mean height of the pushed masses
    turning, sliding = lever**2 / (points * stiffness.normal * (breadth / 2.0) ** 2), 1.0 / (points * stiffness.shear)
    assert path.value[-1] * assembly.weight * (turning + sliding) == pytest.approx(4e-6, rel=1e-2)


@in_plane_and_3d
def test_frictionless_joints_are_associated(plane) -> None:
    columns = scenes.build(*scenes.wall(4, 3, split=0.8, bond="stack"), friction=0.0, plane=plane)
    assert value(columns) == pytest.approx(0.5, rel=UNSLIDING)
    scene = small_wall(friction=0.0, plane=plane)
    assembly, solution = answer(scene)
    associated = solve_associated(assembly, Drive.YIELDING).value
    assert solution.value == pytest.approx(associated, rel=UNSLIDING)
    assert solution.dilatancy_residual <= 1e-12


def test_without_sliding_the_answer_is_heymans() -> None:
    scene = scenes.build(scenes.arch(11, 0.15), settlement=(1.0, 0.0, 0.0), model="none-slides")
    assembly, solution = answer(scene)
    assert solution.value == pytest.approx(solve_associated(assembly, Drive.YIELDING).value, rel=UNSLIDING)


@in_plane_and_3d
def test_one_block_on_its_support_weighs_what_it_weighs(plane) -> None:
    block = scenes.box("block", (0.6, 0.0, 0.0), (0.9, 1.0, 0.5))
    assembly, solution = answer(scenes.build(*scenes.base(0.5, 1.0), block, plane=plane))
    assert (solution.value, solution.at_rest) == pytest.approx((assembly.weight, assembly.weight), rel=1e-6)


@in_plane_and_3d
def test_a_support_that_carries_nothing_leaves_no_reaction(plane) -> None:
    """The fixed base carries the block without tipping, and the settling base leaves it."""
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5))
    assembly, solution = answer(scenes.build(*scenes.base(0.7, 1.0), block, plane=plane))
    assert solution.at_rest > 0.1 * assembly.weight
    assert abs(solution.value) < FOUND * assembly.weight


@pytest.mark.parametrize("mu", [0.001, 0.01, 0.02, 0.03])
def test_little_friction_that_is_left_out_is_in_the_uncertainty(mu: float) -> None:
    """No force presses the block to the wall along which it sinks: R = W. For little friction its slip counts as none: R = W/(1 + mu^2)."""
    wall = scenes.box("wall", (-1.0, 0.0, 0.0), (0.0, 1.0, 1.0), "fixed")
    pad = scenes.box("pad", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "support")
    scene = scenes.build(wall, pad, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), friction=mu, model="auto")
    found = la_core.solve(scene)
    assert abs(found.coulomb - scene.weight) <= found.uncertainty <= 1e-3 * scene.weight
    low, high = found.interval
    assert low <= scene.weight <= high <= 1.001 * scene.weight
