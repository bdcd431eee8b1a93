"""Joints that are missing because coordinates have too few digits are reported, and the reported tolerance closes them."""

import math
import re
from typing import Any

import numpy as np
import pytest
import scenes

from la_core.analysis import solve
from la_core.geometry import find_interfaces, missed_joints
from la_core.scene import Scene, build

VOUSSOIRS = 8
JOINTS = VOUSSOIRS + 1


def arch(slip: float, tolerance: float = 0.0, seed: int = 1) -> Scene:
    """A semicircular arch of polyhedra whose corners are off by up to `slip`, m, on two boxes."""
    random = np.random.default_rng(seed)
    blocks: list[dict[str, Any]] = []
    for k in range(VOUSSOIRS):
        angles = [math.pi * (k + end) / VOUSSOIRS for end in (0, 1)]
        corners = [(-radius * math.cos(a), y, radius * math.sin(a)) for a in angles for radius in (0.9, 1.1) for y in (0.0, 0.5)]
        blocks.append({"name": f"v{k}", "polyhedron": {"vertices": (np.array(corners) + random.uniform(-slip, slip, (8, 3))).tolist()}})
    for name, role, x in (("left", "fixed", -1.2), ("right", "support", 0.8)):
        blocks.append({"name": name, "role": role, "box": {"from": [x, 0.0, -0.2], "to": [x + 0.4, 0.5, 0.0]}})
    tables = {"stone": {"density": 2000.0}, "joint": {"friction": 0.6}, "block": blocks, "settlement": {"direction": [1.0, 0.0, 0.0]}}
    return build(tables | ({"geometry": {"tolerance": tolerance}} if tolerance else {}), "arch")


def pads(gap: float, turn: float = 0.0) -> Scene:
    """A block on a fixed pad, a gap (m) above a settling pad. The lower face of the block is turned (rad)."""
    block = [(0.0, 0.0), (1.0, 1.0 * turn), (1.0, 0.5), (0.0, 0.5)]
    return scenes.build(
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.box("settling pad", (0.5, 0.0, -0.1), (1.0, 0.2, -gap), "support"),
        scenes.block("block", prism=(block, (0.0, 0.2))),
        settlement=scenes.DOWN,
        inset=0.001,
        model="associated",
    )


@pytest.mark.parametrize(("slip", "seed"), [(1e-5, 1), (1e-4, 1), (1e-4, 5), (1e-5, 6), (1e-4, 35)])
def test_the_tolerance_that_is_told_closes_the_joints(slip: float, seed: int) -> None:
    (told,) = arch(slip, seed=seed).warnings
    pairs = re.match(r'(\d+) pairs of blocks nearly touch \("\w+" and "\w+" across [\d.]+ mm, ', told)
    assert pairs, told
    tolerance = re.search(r"tolerance = (\S+) closes such gaps", told)
    assert tolerance, told
    closed = arch(slip, float(tolerance[1]), seed)
    assert not closed.warnings
    assert len(find_interfaces(closed.blocks)) == JOINTS
    assert slip / 2.0 < float(tolerance[1]) <= 2.0 * slip


@pytest.mark.parametrize("slip", [0.0, 1e-6])
def test_an_arch_with_all_its_joints_is_told_nothing(slip: float) -> None:
    scene = arch(slip)
    assert not scene.warnings
    assert len(find_interfaces(scene.blocks)) == JOINTS


@pytest.mark.parametrize("gap", [5e-6, 2e-3])
def test_a_touching_pad_and_one_that_is_far_away_are_told_nothing(gap: float) -> None:
    assert not pads(gap).warnings


def test_one_missed_joint_is_told_with_its_gap() -> None:
    (told,) = pads(5e-5).warnings
    assert told.startswith('blocks "settling pad" and "block" across 0.05 mm nearly touch, but no joint connects them')
    assert "tolerance = 4e-05" in told


def test_a_gap_at_one_end_is_told() -> None:
    missed = missed_joints(pads(0.0, turn=2e-4).blocks)
    assert missed.gap == pytest.approx(np.array([0.4 * 2e-4, 2e-4]), rel=1e-6)


def test_a_gap_is_told_where_other_parts_of_both_blocks_lie_on_one_plane_side_by_side() -> None:
    step = [(0.0, 0.0), (2.0, 0.0), (2.0, 0.5), (1.0, 0.5), (1.0, 1.0), (0.0, 1.0)]
    notched = [(1.0, 1.0), (1.3, 1.0), (1.3, 0.5001), (2.0, 0.5001), (2.0, 1.5), (1.0, 1.5)]  # one underside is level with the step's top
    (told,) = scenes.build(
        scenes.block("step", "fixed", prism=(step, (0.0, 0.5))),
        scenes.block("notched", prism=(notched, (0.0, 0.5))),
        scenes.box("beside", (2.0, 0.0, 0.0), (2.5, 0.5, 1.5), "support"),
        settlement=scenes.DOWN,
    ).warnings
    assert told.startswith('blocks "step" and "notched" across 0.1 mm nearly touch')


@pytest.mark.parametrize("corner", [1e-3, 1e-4, 3e-5, -3e-5])
def test_a_bent_underside_is_told_until_its_tolerance_closes_it(corner: float) -> None:
    """One corner of a stone on level ground is off (m). The stone would turn about an edge between two halves of its underside."""
    slab = {"name": "ground", "role": "fixed", "box": {"from": [-1.0, -1.0, -0.2], "to": [2.0, 2.0, 0.0]}}
    corners = [[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
    corners[6][2] = corner
    tables = {"stone": {"density": 2000.0}, "joint": {"friction": 0.6, "inset": 0.0}, "live": {"direction": [1.0, 0.0, 0.0]}}
    tables["block"] = [slab, {"name": "stone", "polyhedron": {"vertices": corners}}]
    scene, told = build(tables, "bent"), []
    while scene.warnings:
        told += [float(re.search(r"tolerance = (\S+) closes such gaps", scene.warnings[0])[1])]
        assert told == sorted(set(told)), "a tolerance that left the gap is not told again"
        scene = build(tables | {"geometry": {"tolerance": told[-1]}}, "bent")
    assert 1 <= len(told) <= 3
    assert solve(scene).multiplier == pytest.approx(0.6, rel=1e-3)  # it slides as a stone with a plane underside does


def test_blocks_across_from_each_other_at_a_corner_are_told_nothing() -> None:
    slip = 5e-5  # m, by which the courses of two columns differ, and by which the upper joint between the columns is shifted
    missed = missed_joints(
        scenes.build(
            scenes.box("base", (0.0, 0.0, -0.1), (1.0, 0.5, 0.0), "fixed"),
            scenes.box("settling", (1.0, 0.0, -0.1), (2.0, 0.5, 0.0), "support"),
            scenes.box("lower left", (0.0, 0.0, 0.0), (1.0, 0.5, 0.5)),
            scenes.box("upper left", (0.0, 0.0, 0.5), (1.0 - slip, 0.5, 1.0)),
            scenes.box("lower right", (1.0, 0.0, 0.0), (2.0, 0.5, 0.5 + slip)),
            scenes.box("upper right", (1.0 - slip, 0.0, 0.5 + slip), (2.0, 0.5, 1.0)),
            settlement=scenes.DOWN,
        ).blocks
    )
    assert not len(missed.gap)


@pytest.mark.parametrize("name", sorted(path.stem for path in scenes.SHIPPED.glob("*.toml")))
def test_no_shipped_scene_misses_a_joint(name: str) -> None:
    assert not len(missed_joints(scenes.shipped(name).blocks).gap)
