"""One block slides, tips and twists as closed forms say."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scenes
from associated_values import EXACT, in_plane_and_3d, value

from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

AZIMUTHS = [math.radians(degrees) for degrees in (0, 10, 30, 45, 72, 90, 135, 200, 290, 333)]


def column(breadth: float, height: float, friction: float, tilt: float = 0.0, azimuth: float = 0.0, **options) -> Scene:
    """Block of square base on a plane tilted by `tilt`, downhill along `azimuth`, with a live load downhill."""
    half = breadth / 2.0
    downhill = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    return scenes.build(
        scenes.box("plane", (-9.0, -half, -1.0), (9.0, half, 0.0), "fixed"),
        scenes.box("block", (-half, -half, 0.0), (half, half, height)),
        friction=friction,
        gravity=9.81 * (math.sin(tilt) * downhill + math.cos(tilt) * np.array(scenes.DOWN)),
        live=downhill,
        **options,
    )


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize(("breadth", "height", "friction"), [(1.0, 0.5, 0.6), (1.0, 2.5, 0.6), (0.4, 0.5, 0.35), (1.0, 1.0, 1.2)])
def test_block_under_a_horizontal_load_slides_or_tips(breadth, height, friction, azimuth) -> None:
    """lambda = min(mu, b/h) for a load across an edge. Under an oblique load, the block tips over the edge most nearly square to it."""
    tipping = breadth / height / max(abs(math.cos(azimuth)), abs(math.sin(azimuth)))
    scene = column(breadth, height, friction, azimuth=azimuth, plane=False)
    assert value(scene, Drive.LIVE) == pytest.approx(min(friction, tipping), abs=EXACT)


@in_plane_and_3d
@pytest.mark.parametrize(("breadth", "height", "friction"), [(1.0, 0.5, 0.6), (1.0, 2.5, 0.6)])
def test_inclined_plane_in_both_models(breadth, height, friction, plane) -> None:
    critical = min(friction, breadth / height)
    tilt = 0.5 * math.atan(critical)
    live = value(column(breadth, height, friction, tilt, plane=plane), Drive.LIVE)
    # The live load is along the plane: it adds lambda W to the downhill component of the weight.
    assert live == pytest.approx(critical * math.cos(tilt) - math.sin(tilt), abs=EXACT)


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize("height", [0.5, 2.5])
def test_inclined_plane_stands_up_to_its_angle_and_not_beyond(height, azimuth) -> None:
    critical = min(0.6, 1.0 / height / max(abs(math.cos(azimuth)), abs(math.sin(azimuth))))
    margin = 1e-5  # rad
    below = column(1.0, height, 0.6, math.atan(critical) - margin, azimuth, plane=False)
    above = column(1.0, height, 0.6, math.atan(critical) + margin, azimuth, plane=False)
    assert solve_associated(assemble(below), Drive.LIVE).status is Status.SOLVED
    fallen = solve_associated(assemble(above), Drive.LIVE)
    assert fallen.status is Status.INFEASIBLE and fallen.falling == ("block",)


@pytest.mark.parametrize(("side", "friction"), [(1.0, 0.6), (0.3, 0.2), (2.0, 1.5)])
def test_torsion_of_a_square_joint_on_its_four_corners(side, friction) -> None:
    assembly = assemble(column(side, 0.5, friction, plane=False))
    moment = np.zeros_like(assembly.live_load)
    moment[assembly.blocks.names.index("block"), 5] = 1.0
    torque = value(replace(assembly, live_load=moment), Drive.LIVE)
    assert torque / (friction * assembly.weight * side / math.sqrt(2.0)) == pytest.approx(1.0, abs=EXACT)
