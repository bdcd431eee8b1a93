"""Walls have the volumes, closed joints and reactions of formulas, and walls that cannot be built are refused."""

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import scenes
from measured_shapes import DEPTH, EXACT, ROUND_OFF, SPREADS, exposed, free_volume, reaction, upright

from la_core.errors import SceneError
from la_core.model.assembly import assemble

LENGTH, HEIGHT, COURSES, PER_COURSE = 0.6, 0.3, 6, 8
WIDE, HIGH = PER_COURSE * LENGTH, COURSES * HEIGHT


def wall(**changes: Any) -> str:
    entries = {
        "bond": "running", "origin": (0.3, -0.2, 0.1), "block": (LENGTH, DEPTH, HEIGHT), "per_course": PER_COURSE, "courses": COURSES,
        "footing": {"height": 0.3, "settling": (3.0, WIDE)},
    }  # fmt: skip
    return scenes.table("[wall]", **(entries | changes))


def window(**changes: Any) -> dict[str, Any]:
    return {"from": (1.8, 0.3), "to": (3.0, 0.6), "bearing": 0.3, "head": "arch", "rise": 0.6, "voussoirs": 7} | changes


def chords(half: float, outer: float) -> float:
    """Length of the inner face of a semicircle over courses of 0.3 m, from its springing: two courses, then a key in three parts."""
    angles = [0.0, math.asin(HEIGHT / outer), math.asin(2.0 * HEIGHT / outer)]
    angles += [angles[-1] + (math.pi - 2.0 * angles[-1]) * k / 3.0 for k in (1, 2, 3)] + [math.pi - angles[1], math.pi]
    return sum(2.0 * half * math.sin((b - a) / 2.0) for a, b in pairwise(angles))


def under_arch(half: float, outer: float) -> float:
    """Area below the chords of `chords`, m2."""
    angles = [0.0, math.asin(HEIGHT / outer), math.asin(2.0 * HEIGHT / outer)]
    angles += [angles[-1] + (math.pi - 2.0 * angles[-1]) * k / 3.0 for k in (1, 2, 3)] + [math.pi - angles[1], math.pi]
    return sum(half**2 * math.sin(b - a) / 2.0 for a, b in pairwise(angles))


SLANT = math.hypot(0.9, HIGH)
RAFTER = math.hypot(WIDE / 2.0, 1.5)
WALLS = {
    "plain": ({}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "turned": ({"angle": 35.0}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "along y": ({"angle": 90.0}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "courses of two heights": ({"heights": (0.4, 0.2)}, upright(WIDE * HIGH, WIDE + 2 * HIGH)),
    "buttress": ({"rake": (0.0, 0.9)}, upright((WIDE - 0.45) * HIGH, WIDE - 0.9 + HIGH + SLANT)),
    "gable": ({"gable": 1.5}, upright(WIDE * HIGH + WIDE * 0.75, 2 * HIGH + 2 * RAFTER)),
    "buttressed gable": (
        {"rake": (0.9, 0.9), "gable": 1.0},
        upright((WIDE - 0.9) * HIGH + (WIDE - 1.8) / 2, 2 * SLANT + 2 * math.hypot((WIDE - 1.8) / 2, 1.0)),
    ),
    "semicircle": (
        {"opening": [window()]},
        upright(WIDE * HIGH - 1.2 * 0.3 - under_arch(0.6, 0.9), WIDE + 2 * HIGH + 1.2 + 0.6 + chords(0.6, 0.9)),
    ),
    "taper": (
        {"taper": (0.05, 0.1)},
        (WIDE * HIGH * (DEPTH - 0.075),
         WIDE * (math.hypot(HIGH, 0.05) + math.hypot(HIGH, 0.1) + DEPTH - 0.15) + 2 * HIGH * (DEPTH - 0.075)),
    ),
    "pier": (
        {"per_course": 1, "bond": "stack", "taper": (0.05, 0.05), "rake": (0.1, 0.1), "footing": {"height": 0.3, "settling": (0.2, 0.6)}},
        (HIGH / 6 * (0.6 * 0.4 + 4 * 0.5 * 0.35 + 0.4 * 0.3),
         0.4 * 0.3 + (0.6 + 0.4) * math.hypot(HIGH, 0.05) + (0.4 + 0.3) * math.hypot(HIGH, 0.1)),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WALLS)
def test_a_wall_has_its_volume_and_is_closed_all_over(name: str) -> None:
    changes, (volume, surface) = WALLS[name]
    scene = scenes.build(wall(**changes))
    assert free_volume(scene) == pytest.approx(volume, rel=ROUND_OFF)
    assert exposed(scene) == pytest.approx(surface, rel=ROUND_OFF)


@pytest.mark.parametrize(
    ("changes", "key_area"),
    [({"rise": 0.3, "bearing": 0.15, "voussoirs": 5}, 0.0), ({"rise": 0.1, "bearing": 0.1, "voussoirs": 5}, 0.0), ({"voussoirs": 11}, 0.0)],
)
def test_an_arched_head_leaves_no_more_than_its_segment_and_closes_with_the_wall(changes: dict[str, Any], key_area: float) -> None:
    """Apart from the wall's own sides, the exposed faces are the jambs and the sill of the opening and a polygon within the arc."""
    scene = scenes.build(wall(opening=[window(**changes)]))
    half, rise = 0.6, changes.get("rise", 0.6)
    radius = (half**2 + rise**2) / (2.0 * rise)
    angle = 2.0 * math.atan2(half, radius - rise)
    segment = radius**2 * (angle - math.sin(angle)) / 2.0
    missing = WIDE * HIGH - 1.2 * 0.3 - free_volume(scene) / DEPTH
    assert 0.75 * segment < missing < segment
    edges = (exposed(scene) - 2.0 * (WIDE * HIGH - 1.2 * 0.3 - missing)) / DEPTH - (WIDE + 2 * HIGH + 1.2 + 0.6)
    assert 0.95 * radius * angle < edges < radius * angle


def test_a_wall_with_an_arched_head_in_its_middle_is_symmetric() -> None:
    for opening in (window(), window(rise=0.25, bearing=0.2)):
        text = wall(opening=[opening], origin=(-WIDE / 2, 0.0, 0.0), footing={"height": 0.3})
        vertices = scenes.build(text, settlement=None, live=SPREADS).blocks.vertices
        assert np.allclose(*(np.unique(np.round(v, 9), axis=0) for v in (vertices, vertices * (-1, 1, 1))), atol=2e-9)


def test_blocks_are_named_by_course_and_by_place_from_the_left() -> None:
    """The page of scenes states these names. Loads and ties choose blocks by them."""
    blocks = scenes.build(wall()).blocks
    sixth = {name: place for name, place in zip(blocks.names, blocks.centroid, strict=True) if name.startswith("wall 6.")}
    assert list(sixth)[:3] == ["wall 6.1", "wall 6.2", "wall 6.3"]
    assert all(before[0] < after[0] for before, after in pairwise(sixth.values()))
    assert min(place[2] for place in sixth.values()) > max(
        c[2] for n, c in zip(blocks.names, blocks.centroid, strict=True) if "wall 5." in n
    )


def test_heights_that_are_all_those_of_a_block_change_nothing() -> None:
    one, other = scenes.build(wall()).blocks, scenes.build(wall(heights=(HEIGHT,))).blocks
    assert one.names == other.names and np.allclose(one.vertices, other.vertices, atol=1e-12)


@pytest.mark.parametrize("angle", [30.0, 90.0, -135.0])
def test_a_turned_wall_carries_what_it_carried(angle: float) -> None:
    small = {"per_course": 3, "courses": 3, "footing": {"height": 0.3, "settling": (1.2, 1.8)}}
    straight = reaction(scenes.build(wall(**small), plane=False))
    assert reaction(scenes.build(wall(**small, angle=angle))) == pytest.approx(straight, abs=EXACT)


def test_a_pier_stands_on_its_footing_as_on_a_balance() -> None:
    """The weight acts at the middle; the fixed part ends at 0.2 m, and the settling part at 0.6 m: R = W (0.3 - 0.2) / (0.6 - 0.2)."""
    changes, _ = WALLS["pier"]
    assert reaction(scenes.build(wall(**changes))) == pytest.approx(0.25, abs=EXACT)


def test_a_footing_without_a_settling_part_is_fixed() -> None:
    scene = scenes.build(wall(footing={"height": 0.3}), settlement=None, live=SPREADS)
    assert not scene.blocks.role.max() > 1 and (~scene.blocks.free).sum() == 1


REFUSED_WALLS = {
    "rise of a lintel": ({"opening": [window(head="lintel", voussoirs=None)]}, '`head = "arch"` needs a `rise`, and only an arch has one'),
    "arch without rise": ({"opening": [window(rise=None)]}, '`head = "arch"` needs a `rise`'),
    "too high an arch": ({"opening": [window(rise=0.7)]}, "the `rise` of an arch over an opening is at most half the opening's width"),
    "arch beyond the wall": (
        {"opening": [window(**{"from": (1.8, 0.6), "to": (3.0, 1.2)})]},
        "the wall ends at 1.8 m, below the key of its arch, which needs 1.95 m; add courses",
    ),
    "too few voussoirs": ({"opening": [window(voussoirs=4)]}, "so many courses that it needs 5 `voussoirs` or more"),
    "arch at the end": ({"opening": [window(**{"from": (0.3, 0.3), "to": (1.5, 0.6)})]}, "an arch needs a block on either side"),
    "bearing beyond the rise": ({"opening": [window(rise=0.3, bearing=1.2)]}, "bears too far into the wall for its rise"),
    "two leaves": ({"leaves": 2, "taper": (0.1, 0.0)}, "`taper`, `rake`, `gable` and openings under an arch go with one leaf"),
    "taper": ({"taper": (0.2, 0.2)}, "the entries of `taper` together must be less than the depth of a `block`"),
    "rake": ({"rake": (2.4, 2.4)}, "the entries of `rake` together must be less than the length of the wall"),
    "settling beyond the wall": ({"footing": {"height": 0.3, "settling": (3.0, 5.0)}}, "must lie within the wall's length, 0 to 4.8 m"),
    "settling backwards": ({"footing": {"height": 0.3, "settling": (3.0, 2.0)}}, "second entry of `settling` must be greater than the"),
    "between courses": (
        {"heights": (0.4, 0.2), "opening": [window(**{"from": (1.8, 0.3)})]},
        "bottom and top must lie on course lines, of which 0 m and 0.4 m are nearest",
    ),
    "opening in a rake": ({"rake": (4.0, 0.0), "opening": [window(head="lintel", rise=None, voussoirs=None)]}, "openings or their heads"),
}


@pytest.mark.parametrize("case", REFUSED_WALLS)
def test_a_wall_that_cannot_be_built_is_refused_with_the_reason(case: str) -> None:
    changes, reason = REFUSED_WALLS[case]
    if "opening" in changes:
        changes = changes | {"opening": [{key: value for key, value in one.items() if value is not None} for one in changes["opening"]]}
    with pytest.raises(SceneError) as error:
        assemble(scenes.build(wall(**changes)))
    assert reason in str(error.value)


def random_wall(chance: np.random.Generator) -> dict[str, Any]:
    """A random wall with an arched or plain opening, which may not fit, and with some further options of walls."""
    block, per_course, courses = chance.uniform(0.2, 0.8, 3), int(chance.integers(2, 9)), int(chance.integers(2, 9))
    length = float(block[0]) * per_course
    heights = chance.choice([0.2, 0.25, 0.4], 2).tolist() if chance.random() < 0.5 else [float(block[2])]
    lines = [0.0, *np.cumsum([heights[k % len(heights)] for k in range(courses)]).tolist()]
    low, high = sorted(chance.choice(len(lines), 2, replace=False).tolist())
    start, end = sorted(chance.uniform(0.0, length, 2).tolist())
    rise = (end - start) / 2.0 * float(chance.choice([1.0, chance.uniform(0.05, 1.0)]))
    opening = {"from": (start, lines[low]), "to": (end, lines[high]), "bearing": float(chance.uniform(0.05, 0.3))}
    arched = {"head": "arch", "rise": rise, "voussoirs": int(chance.integers(1, 15))}
    return {
        "block": block.tolist(), "per_course": per_course, "courses": courses, "heights": heights,
        "bond": str(chance.choice(["running", "stack"])), "angle": float(chance.choice([0.0, 90.0, 37.5])),
        "taper": (chance.uniform(0.0, 0.1, 2) * block[1]).tolist(), "rake": (chance.uniform(0.0, 0.2, 2) * length).tolist(),
        "opening": [opening | arched if chance.random() < 0.7 else opening], "footing": {"height": 0.3},
        **({"gable": float(chance.uniform(0.2, 2.0))} if chance.random() < 0.5 else {}),
    }  # fmt: skip


@pytest.mark.slow
def test_random_walls_are_refused_for_a_reason_or_have_neither_gaps_nor_overlaps() -> None:
    """The assembly would refuse blocks that overlap or touch nothing. This would be a fault of the generator, not of the wall."""
    chance, built = np.random.default_rng(5), 0
    for _ in range(150):
        text = wall(**random_wall(chance))
        try:
            scene = scenes.build(text, settlement=None, live=SPREADS)
        except SceneError as error:
            assert "opening" in str(error) and "convex" not in str(error)
            continue
        assemble(scene)
        built += 1
    assert built > 30
