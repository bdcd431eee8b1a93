"""Blocks that touch only along an edge or at a corner are reported with their place. No other blocks are."""

import numpy as np
import pytest
import scenes

from la_core.geometry import edge_contacts
from la_core.scene import Scene

GROUND = scenes.box("ground", (0.0, 0.0, -0.2), (4.0, 1.0, 0.0), "fixed")
WALL = scenes.box("wall", (2.0, 0.0, 0.0), (2.5, 1.0, 3.0), "fixed")
PLANK = ((0.8, 0.0), (0.9, 0.0), (2.0, 2.0), (1.95, 2.05))  # its upper right corner is at the wall
CUT = ((0.8, 0.0), (0.9, 0.0), (2.0, 1.995), (2.0, 2.0), (1.95, 2.05))
NO_JOINT = "that is no joint and holds nothing in either method; where it should hold, cut the edge to a face of some millimetres."


def pushed(*parts: str) -> Scene:
    return scenes.build(*parts, live=(1.0, 0.0, 0.0), settlement=None)


def leaning(profile: tuple[tuple[float, float], ...]) -> Scene:
    return pushed(GROUND, WALL, scenes.block("plank", prism=(profile, (0.0, 1.0))))


def told(scene: Scene) -> list[str]:
    return [words for words in scene.warnings if "no joint and holds nothing" in words]


def test_an_edge_that_leans_on_a_face_is_told_with_both_blocks_and_the_place() -> None:
    assert told(leaning(PLANK)) == [f'blocks "wall" and "plank" touch along an edge alone, near (2, 0.5, 2) m: {NO_JOINT}']
    assert not told(leaning(CUT))


def test_the_place_is_in_full_far_from_the_origin() -> None:
    stones = [scenes.box(f"stone {k}", (-20000.0 + k, 0.0, k), (-19999.0 + k, 1.0, k + 1.0)) for k in range(2)]
    (words,) = told(pushed(scenes.box("ground", (-20000.0, 0.0, -0.2), (-19998.0, 1.0, 0.0), "fixed"), *stones))
    assert "near (−19999, 0.5, 1) m:" in words


def test_a_corner_on_a_face_and_an_edge_across_an_edge_are_told() -> None:
    """A pyramid stands on its tip. Two ridges cross, and no corner of one block touches the other block."""
    tip = [[0.5, 0.5, 1.0], [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [1.0, 1.0, 2.0], [0.0, 1.0, 2.0]]
    pyramid = pushed(GROUND, scenes.box("base", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), scenes.block("pyramid", polyhedron=tip))
    assert told(pyramid) == [f'blocks "base" and "pyramid" touch at a corner alone, near (0.5, 0.5, 1) m: {NO_JOINT}']
    lower = [[x, y, z] for x in (0.0, 2.0) for y, z in ((0.0, 0.0), (1.0, 0.0), (0.5, 0.5))]
    upper = [[x, y, z] for y in (-1.0, 2.0) for x, z in ((0.7, 1.0), (1.7, 1.0), (1.2, 0.5))]
    ridges = pushed(GROUND, scenes.block("lower", polyhedron=lower), scenes.block("upper", polyhedron=upper))
    found = edge_contacts(ridges.blocks)
    assert found.place[0] == pytest.approx([1.2, 0.5, 0.5]) and found.length[0] == 0.0


def test_blocks_apart_that_no_face_separates_are_not_told() -> None:
    """A face of each block lies in one common plane, and no face plane separates the blocks. They seem near but do not touch."""
    low = [[x, y, 1.0 + z] for y in (0.0, 1.0) for x, z in ((0.0, -1.0), (0.4, -1.0), (0.0, 0.0), (1.0, 0.0))]
    high = [[x + lean, y, z] for lean, z in ((0.0, 1.0), (-0.8, 2.0)) for x, y in ((1.1, 0.5), (1.6, 0.0), (2.1, 0.5), (1.6, 1.0))]
    pad = scenes.box("pad", (1.2, 0.0, 0.0), (2.0, 1.0, 1.0))
    with np.errstate(all="raise"):
        assert not told(pushed(GROUND, pad, scenes.block("low", polyhedron=low), scenes.block("high", polyhedron=high)))


def test_blocks_across_a_step_are_told_and_several_pairs_in_one_sentence() -> None:
    steps = [scenes.box(f"step {k}", (k, 0.0, k), (k + 1.0, 1.0, k + 1.0)) for k in range(3)]
    (words,) = told(pushed(GROUND, *steps))
    assert words.startswith(
        '2 pairs of blocks touch along an edge or at a corner alone ("step 0" and "step 1" near (1, 0.5, 1) m, "step 1" and "step 2" near'
    )


def test_blocks_across_a_cross_of_joints_are_not_told() -> None:
    """The blocks beside a diagonal pair have joints with both blocks of the pair. Without them, the pair shares only an edge."""
    stack = {(i, k): scenes.box(f"{i} {k}", (i, 0.0, k), (i + 1.0, 1.0, k + 1.0)) for i in range(3) for k in range(3)}
    assert not told(pushed(GROUND, *stack.values()))
    open_ones = [text for place, text in stack.items() if place not in [(0, 1), (1, 0)]]
    assert len(told(pushed(GROUND, *open_ones))) == 1


def test_blocks_whose_other_parts_share_a_joint_are_not_told() -> None:
    step = ((0.0, 0.0), (2.0, 0.0), (2.0, 0.5), (1.0, 0.5), (1.0, 1.0), (0.0, 1.0))
    assert not told(pushed(GROUND, scenes.block("step", prism=(step, (0.0, 1.0))), scenes.box("on it", (1.0, 0.0, 0.5), (2.0, 1.0, 1.0))))


@pytest.mark.parametrize("name", ["stack_bond_wall", "corner_settling_end", "vault_spreading", "dome_sector", "facade", "rubble_wall"])
def test_shipped_walls_arches_and_domes_are_told_nothing(name: str) -> None:
    assert not len(edge_contacts(scenes.shipped(name).blocks).pairs)


@pytest.mark.parametrize("depth", [0.02, 0.3])
def test_blocks_that_share_volume_do_not_touch_along_an_edge(depth: float) -> None:
    """A block that is drawn too deep into its ground has no joint with it. The refusal names the overlap, and no warning contradicts it."""
    sunk = pushed(GROUND, WALL, scenes.box("sunk", (0.5, 0.0, -depth), (1.5, 1.0, 1.0 - depth)))
    assert not told(sunk) and not len(edge_contacts(sunk.blocks).pairs)


def cubes(left_out: set[tuple[int, int, int]]) -> Scene:
    """Two by two by two cubes of 1 m on ground, without the cubes in `left_out`."""
    places = [place for place in np.ndindex(2, 2, 2) if place not in left_out]
    parts = [scenes.box("cube {} {} {}".format(*p), p, tuple(k + 1.0 for k in p)) for p in places]
    return pushed(scenes.box("floor", (0.0, 0.0, -1.0), (2.0, 2.0, 0.0), "fixed"), *parts)


@pytest.mark.parametrize(
    ("left_out", "count"),
    [
        (set(), 0),  # four pairs of opposite cubes meet in the middle
        ({(0, 0, 1)}, 0),  # joints still lead around the middle
        ({(0, 0, 1), (0, 1, 1)}, 0),
        ({(0, 1, 1), (1, 0, 1), (0, 0, 1)}, 0),
        ({(0, 1, 1), (1, 0, 1), (0, 0, 1), (1, 1, 0)}, 3),  # nothing is below the upper cube: it meets three at an edge or a corner
    ],
)
def test_opposite_cubes_that_others_join_are_not_told(left_out: set[tuple[int, int, int]], count: int) -> None:
    found = edge_contacts(cubes(left_out).blocks)
    assert len(found.pairs) == count
