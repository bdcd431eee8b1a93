"""Space has no preferred axes: closed forms hold for structures turned and shifted at random, for associated and Coulomb friction."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scenes

from la_core.coulomb import predict
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

EXACT = 1e-6  # of the weight or the multiplier: residuals of a solved answer are below this
AS_PLANE = 1e-5  # of the weight: allowed difference between the plane and the 3D model of one structure
ELASTIC = 2e-3  # relative: joints in Coulomb limit analysis sag by 1/300 of the travel
SEEDS = range(4)
MU, HEIGHT = 0.6, 0.5

any_orientation = pytest.mark.parametrize("seed", SEEDS)


def turned(scene: Scene, seed: int, order: bool = True) -> tuple[Scene, np.ndarray]:
    """The scene after a random rotation and shift, with its blocks shuffled, and the rotation."""
    chance = np.random.default_rng(seed)
    turn = scenes.rotation(chance.normal(size=3), chance.uniform(0.0, 2.0 * math.pi))
    shuffled = chance.permutation(len(scene.blocks)) if order else None
    return scenes.moved(scene, turn, shift=chance.uniform(-30.0, 30.0, 3), order=shuffled, plane=False), turn


def associated(assembly: Assembly) -> float:
    """Least reaction over the weight, or multiplier."""
    solution = solve_associated(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING)
    assert solution.status is Status.SOLVED
    return solution.value / (1.0 if assembly.has_live_load else assembly.weight)


def coulomb(assembly: Assembly) -> float:
    solution = predict(
        assembly, joint_stiffness(assembly, {}), solve_associated(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING)
    )
    assert solution.status is Status.SOLVED
    return solution.value / (1.0 if assembly.has_live_load else assembly.weight)


def block_on_plane(height: float, live: tuple[float, float, float], tilt: float = 0.0) -> Scene:
    return scenes.build(
        scenes.box("plane", (-2.0, -2.0, -1.0), (2.0, 2.0, 0.0), "fixed"),
        scenes.box("block", (-0.5, -0.5, 0.0), (0.5, 0.5, height)),
        friction=MU,
        gravity=9.81 * np.array([math.sin(tilt), 0.0, -math.cos(tilt)]),
        live=live,
        plane=False,
    )


@any_orientation
def test_slab_on_four_corners(seed) -> None:
    assembly = assemble(turned(scenes.shipped("slab_four_corners"), seed)[0])
    sharp = assembly.with_inset(scenes.shipped("slab_four_corners"), 0.0)
    assert associated(sharp) == pytest.approx(0.3, abs=EXACT)
    assert coulomb(sharp) == pytest.approx(0.3, rel=ELASTIC)


@any_orientation
@pytest.mark.parametrize("height", [0.5, 2.5])
def test_inclined_plane(seed, height) -> None:
    """Sliding at tan(theta) = mu, tipping at b / h. The live load acts along the plane and adds to the downhill component of the weight."""
    critical = min(MU, 1.0 / height)
    tilt = 0.5 * math.atan(critical)
    assembly = assemble(turned(block_on_plane(height, (1.0, 0.0, 0.0), tilt), seed)[0])
    expected = critical * math.cos(tilt) - math.sin(tilt)
    assert associated(assembly) == pytest.approx(expected, abs=EXACT)
    assert coulomb(assembly) == pytest.approx(expected, rel=ELASTIC)


@any_orientation
def test_sliding_along_any_azimuth(seed) -> None:
    azimuth = np.random.default_rng(100 + seed).uniform(0.0, 2.0 * math.pi)
    scene, _ = turned(block_on_plane(HEIGHT, (math.cos(azimuth), math.sin(azimuth), 0.0)), seed)
    assert associated(assemble(scene)) == pytest.approx(MU, abs=EXACT)
    assert coulomb(assemble(scene)) == pytest.approx(MU, rel=ELASTIC)


@any_orientation
def test_torsion_of_a_square_joint_on_its_four_corners(seed) -> None:
    """T = mu N a / sqrt(2), by a moment about the joint's normal as live load."""
    scene, turn = turned(block_on_plane(HEIGHT, (1.0, 0.0, 0.0)), seed)
    assembly = assemble(scene)
    moment = np.zeros_like(assembly.live_load)
    moment[assembly.blocks.names.index("block"), 3:] = turn @ [0.0, 0.0, 1.0]
    twisted = replace(assembly, live_load=moment)
    torque = MU * assembly.weight / math.sqrt(2.0)
    assert associated(twisted) == pytest.approx(torque, rel=EXACT)
    assert coulomb(twisted) == pytest.approx(torque, rel=ELASTIC)


@pytest.mark.parametrize("name", ["arch_spreading", "trilith", "wall_third", "wall_half", "stack_bond_wall"])
def test_a_plane_structure_turned_in_space_keeps_its_plane_answer(name) -> None:
    scene = scenes.shipped(name)
    plane = assemble(scene)
    solid = assemble(turned(scene, seed=5)[0])
    assert plane.effects.plane and not solid.effects.plane
    assert associated(solid) == pytest.approx(associated(plane), abs=AS_PLANE)


def studs(count: int, gap: float, high: float) -> list[str]:
    """Two pads 0.4 m and 0.5 m long under a block of 1 m, each cut into count x count studs that touch nothing else."""
    parts = []
    for name, low, length, role in (("fixed", 0.0, 0.4, "fixed"), ("settling", 0.5, 0.5, "support")):
        edges_x, edges_y = (np.linspace(start, start + reach, count + 1) for start, reach in ((low, length), (0.0, 0.3)))
        for i in range(count):
            for j in range(count):
                corner = (edges_x[i] + (gap if i else 0.0), edges_y[j] + (gap if j else 0.0), -high)
                parts.append(scenes.box(f"{name} {i} {j}", corner, (edges_x[i + 1], edges_y[j + 1], 0.0), role))
    return parts


@any_orientation
def test_a_face_on_many_small_patches_counts_only_the_outermost(seed) -> None:
    """R = W (x_G - f1)/(m1 - f1) = W/6, as on two whole pads. The unknown forces on the inner patches do not change it."""
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.3, 0.5))
    assembly = assemble(turned(scenes.build(block, *studs(6, 0.01, 0.1), plane=False), seed)[0])
    assert len(assembly.interfaces) == 72 and len(assembly.points) == 4 * 72
    assert associated(assembly) == pytest.approx(1.0 / 6.0, abs=EXACT)


@any_orientation
@pytest.mark.parametrize("angle", [0.3, 0.7, 1.2])
def test_beams_crossed_askew_share_the_corners_of_their_overlap(seed, angle) -> None:
    """Overlap of two strips of breadth b at an angle: a rhombus of area b^2 / sin(angle) with four crossing-edge corners."""
    breadth, reach = 0.2, 2.0
    across = scenes.rotation((0.0, 0.0, 1.0), angle)
    low = np.array([(x, y, z) for x in (-reach, reach) for y in (-breadth / 2, breadth / 2) for z in (0.0, 0.3)])
    high = (low + np.array([0.0, 0.0, 0.3])) @ across.T
    scene = scenes.build(
        scenes.block("lower", "fixed", polyhedron=low),
        scenes.block("upper", polyhedron=high),
        live=(0.0, 0.0, -1.0),
    )
    assembly = assemble(turned(scene, seed)[0])
    assert assembly.interfaces.area == pytest.approx([breadth**2 / math.sin(angle)])
    assert len(assembly.points) == 4
    arms = assembly.points.position - assembly.points.position.mean(axis=0)
    diagonals = [breadth / math.sin(angle / 2.0), breadth / math.cos(angle / 2.0)]
    assert sorted(2.0 * np.linalg.norm(arms, axis=1)) == pytest.approx(sorted([*diagonals, *diagonals]))
