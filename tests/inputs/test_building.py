"""Walls of several leaves, openings under lintels and flat arches, walls that interlock: their geometry agrees with counts by hand."""

import itertools
from collections import defaultdict

import numpy as np
import pytest
import scenes

from la_core.errors import SceneError
from la_core.geometry.interfaces import find_interfaces
from la_core.limit.associated import solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

ROUND_OFF = 1e-9  # relative, of volumes and weights that are sums of products
SAME = 1e-6  # of the weight: residuals of a solved answer are below this
LENGTH, THICK, HIGH = BLOCK = (0.4, 0.2, 0.2)
PLANS = {  # overall size, and total length of the walls (volume over height and thickness), crossings counted once
    "rectangle": ((4.0, 3.2), 2 * (4.0 + 3.2) - 4 * THICK),
    "L": ((4.0, 3.2), 4.0 + 3.2 - THICK),
    "T": ((4.0, 3.2), 4.0 + 3.2 - THICK),
    "cross": ((4.0, 3.2), 4.0 + 3.2 - THICK),
}
every_plan = pytest.mark.parametrize("plan", PLANS)
WHOLE = {"from": (-9.0, -9.0), "to": (1.1, 9.0)}


def building(plan: str = "rectangle", courses: int = 6, extra: str = "", **entries) -> Scene:
    entries = {"plan": plan, "origin": (0.0, 0.0, 0.0), "size": PLANS[plan][0], "block": BLOCK, "courses": courses, **entries}
    foundation = entries.pop("foundation", {"height": 0.2, "settling": WHOLE})
    options = {name: entries.pop(name) for name in ("live", "friction") if name in entries}
    parts = [scenes.table("[building]", **entries), extra]
    if foundation:
        parts.append(scenes.table("building.foundation", **foundation))
    return scenes.build(*parts, **options)


def opening(side: str, low: tuple[float, float], high: tuple[float, float], bearing: float = 0.3, **entries) -> str:
    own = {"from": low, "to": high, "bearing": bearing, **entries}
    return scenes.table("[building.opening]", side=side, **own)


def free_volume(scene: Scene) -> float:
    return float(scene.blocks.volume[scene.blocks.free].sum())


@every_plan
def test_walls_have_the_volume_of_their_plan(plan) -> None:
    assert free_volume(building(plan)) == pytest.approx(PLANS[plan][1] * THICK * 6 * HIGH, rel=ROUND_OFF)


@every_plan
def test_openings_take_their_volume_away(plan) -> None:
    side = "along x" if plan == "cross" else "south"
    for head in ({"head": "lintel"}, {"head": "flat arch", "voussoirs": 4, "bearing": 0.05}):
        cut = building(plan, extra=opening(side, (0.8, 0.4), (1.4, 0.8), **{"bearing": 0.3, **head}))
        assert free_volume(building(plan)) - free_volume(cut) == pytest.approx(0.6 * 0.4 * THICK, rel=1e-6)


@every_plan
def test_every_block_stands_on_another_and_none_overlap(plan) -> None:
    blocks = building(plan).blocks
    interfaces = find_interfaces(blocks)  # refuses overlaps and blocks that touch nothing
    up = interfaces.normal[:, 2]
    standing = set(interfaces.block_b[up > 0.5]) | set(interfaces.block_a[up < -0.5])  # normals point from a to b
    assert standing >= set(np.flatnonzero(blocks.free))


def head_joints(scene: Scene) -> dict[int, list[np.ndarray]]:
    """Middle (x, y) and absolute normal (x, y) of every upright joint, by course."""
    interfaces = find_interfaces(scene.blocks)
    upright = np.abs(interfaces.normal[:, 2]) < 0.5
    middle = np.add.reduceat(interfaces.polygon, interfaces.polygon_start[:-1]) / np.diff(interfaces.polygon_start)[:, None]
    joints = defaultdict(list)
    for place, normal in zip(middle[upright], interfaces.normal[upright], strict=True):
        joints[round((place[2] - HIGH / 2.0) / HIGH)].append(np.concatenate([place[:2], np.abs(normal[:2])]))
    return joints


@every_plan
def test_no_upright_joint_runs_on_into_the_next_course(plan) -> None:
    joints = head_joints(building(plan))
    assert sorted(joints) == list(range(6))
    for lower, upper in itertools.pairwise(sorted(joints)):
        for one, other in itertools.product(joints[lower], joints[upper]):
            same_plane = np.allclose(one[2:], other[2:]) and np.linalg.norm(one[:2] - other[:2]) < LENGTH / 5.0
            assert not same_plane, (one, other)


@every_plan
def test_walls_run_through_their_crossings_in_turn(plan) -> None:
    scene = building(plan)
    blocks = scene.blocks
    node = {"rectangle": (0.1, 0.1), "L": (0.1, 0.1), "T": (1.95, 0.1), "cross": (1.95, 1.55)}[plan]
    for course in range(6):
        point = np.array([*node, (course + 0.5) * HIGH])
        inside = np.all((blocks.low < point) & (point < blocks.high), axis=1) & blocks.free
        (owner,) = np.flatnonzero(inside)
        extent = blocks.high[owner] - blocks.low[owner]
        assert bool(extent[0] > extent[1]) is (course % 2 == 0)


def test_a_floor_adds_its_weight_and_nothing_else() -> None:
    floors = scenes.table("[building.floor]", course=3, mass=500.0, sides=["south", "north"])
    bare, loaded = building(), building(extra=floors)
    length = 2 * PLANS["rectangle"][0][0]  # the third course of the long walls runs through
    assert loaded.weight - bare.weight == pytest.approx(500.0 * length * 9.81, rel=1e-9)
    assert loaded.blocks.centroid == pytest.approx(bare.blocks.centroid)


def test_a_floor_without_sides_lies_on_all_walls() -> None:
    loaded = building(extra=scenes.table("[building.floor]", course=3, mass=500.0))
    assert loaded.weight - building().weight == pytest.approx(500.0 * PLANS["rectangle"][1] * 9.81, rel=1e-9)


@pytest.mark.parametrize(("course", "is_warned_of"), [(2, False), (3, True), (4, True), (5, False)])
def test_a_floor_on_a_course_that_an_arch_cuts_is_warned_of(course: int, is_warned_of: bool) -> None:
    """Voussoirs carry no floor. A floor just above the crown lost more than half of its mass without a warning."""
    arch = opening("south", (0.8, 0.2), (1.6, 0.4), 0.2, head="arch", rise=0.2, voussoirs=5)
    floors = [scenes.table("[building.floor]", course=course, mass=100.0, **sides) for sides in ({"sides": ["south"]}, {"sides": ["west"]})]
    told = [words for words in building("L", extra="\n".join([arch, *floors])).warnings if "floor" in words]
    assert len(told) == is_warned_of
    if is_warned_of:
        assert f'voussoirs in course {course} of the wall "south"' in told[0]


@pytest.mark.parametrize(
    ("region", "settling"),
    [
        ({"from": (3.0, 0.0), "to": (4.0, 1.0)}, 1.0 * THICK + 0.8 * THICK),  # a corner
        ({"from": (1.0, 0.0), "to": (2.5, 0.2)}, 1.5 * THICK),  # a strip of one wall
        (WHOLE, 3.2 * THICK + 2 * 0.9 * THICK),  # a whole end
    ],
)
def test_foundations_settle_within_the_region_and_nowhere_else(region, settling) -> None:
    scene = building(foundation={"height": 0.3, "settling": region})
    held = ~scene.blocks.free
    assert scene.blocks.volume[held].sum() == pytest.approx(PLANS["rectangle"][1] * THICK * 0.3)
    assert scene.blocks.volume[scene.blocks.role == 2].sum() == pytest.approx(settling * 0.3)


def test_a_pushed_building_stands_on_strips_that_do_not_settle() -> None:
    """Two courses slide at a push of mu times the weight, before any stack of blocks tips."""
    scene = building("L", courses=2, foundation={"height": 0.3}, live=(1.0, 0.0, 0.0), friction=0.25)
    held = ~scene.blocks.free
    assert set(scene.blocks.role[held]) == {1}
    assert scene.blocks.volume[held].sum() == pytest.approx(PLANS["L"][1] * THICK * 0.3)
    assert solve_associated(assemble(scene), Drive.LIVE).value == pytest.approx(0.25, rel=SAME)


def test_a_building_without_a_settling_part_has_no_support() -> None:
    with pytest.raises(SceneError, match=r"no block has the role of support; .* a building a `foundation` with a `settling` part"):
        building(foundation={"height": 0.2})


def test_away_from_its_corner_a_wall_of_a_building_is_a_wall() -> None:
    wall = scenes.build(*scenes.wall(10, 4, split=1.0, block_size=BLOCK))
    plan = building("L", courses=4, size=(4.0, 0.8))
    south = [k for k, name in enumerate(plan.blocks.names) if " south " in name and "foundation" not in name]
    first = {tuple(np.round(wall.blocks.low[k], 9)) for k in np.flatnonzero(wall.blocks.free)}
    assert {tuple(np.round(plan.blocks.low[k], 9)) for k in south if plan.blocks.low[k, 0] > THICK} <= first


# --- leaves and headers ------------------------------------------------------------------------------------------------------


def leaved(leaves: int, courses: int = 6, extra: str = "", **entries) -> Scene:
    entries = {
        "bond": "running",
        "origin": (0.0, 0.0, 0.0),
        "block": BLOCK,
        "per_course": 5,
        "courses": courses,
        "leaves": leaves,
        **entries,
    }
    base = scenes.box("base", (0.0, 0.0, -0.2), (2.0, leaves * THICK, 0.0), "fixed")
    return scenes.build(scenes.table("[wall]", **entries), extra, base, live=(0.0, 1.0, 0.0))


@pytest.mark.parametrize("leaves", [1, 2, 3])
@pytest.mark.parametrize("headers", [None, 2, 3])
def test_leaves_and_headers_fill_the_wall(leaves, headers) -> None:
    ties = {} if headers is None or leaves == 1 else {"headers_every": headers}
    scene = leaved(leaves, **ties)
    assert free_volume(scene) == pytest.approx(2.0 * leaves * THICK * 6 * HIGH, rel=ROUND_OFF)
    find_interfaces(scene.blocks)


@pytest.mark.parametrize("leaves", [2, 3])
def test_headers_tie_neighbouring_leaves_and_in_three_both_pairs_in_turn(leaves) -> None:
    scene = leaved(leaves, headers_every=2)
    across = scene.blocks.free & (np.ptp(np.stack([scene.blocks.low[:, 1], scene.blocks.high[:, 1]]), axis=0) > 1.5 * THICK)
    courses = {round(low / HIGH) for low in scene.blocks.low[across, 2]}
    assert courses == {1, 3, 5}
    starts = {(round(low[2] / HIGH), round(low[1] / THICK)) for low in scene.blocks.low[across]}
    assert starts == ({(1, 0), (3, 0), (5, 0)} if leaves == 2 else {(1, 0), (3, 1), (5, 0)})


def test_headers_make_leaves_stand_together_against_a_push_across() -> None:
    """A single leaf of breadth b tips at b/h. Two leaves lean on each other. Headers let them resist more, at most as one leaf of 2b."""
    high, breadth = 6 * HIGH, THICK
    loose, tied = leaved(2), leaved(2, headers_every=2)
    multipliers = [solve_associated(assemble(scene), Drive.LIVE).value for scene in (loose, tied)]
    alone = solve_associated(assemble(leaved(1)), Drive.LIVE).value
    assert alone == pytest.approx(breadth / high, abs=SAME)
    assert alone < multipliers[0] < multipliers[1] - 0.01 < 2.0 * breadth / high


def test_an_opening_s_head_spans_all_leaves() -> None:
    cut = scenes.table("[wall.opening]", bearing=0.3, **{"from": (0.8, 0.4), "to": (1.2, 0.8)})
    scene = leaved(2, headers_every=3, extra=cut)
    assert free_volume(scene) == pytest.approx((2.0 * 6 * HIGH - 0.4 * 0.4) * 2 * THICK, rel=ROUND_OFF)
    over = np.array([1.0, THICK, 0.9])
    lintel = np.flatnonzero(np.all((scene.blocks.low < over) & (over < scene.blocks.high), axis=1))
    assert len(lintel) == 1 and scene.blocks.high[lintel[0], 1] - scene.blocks.low[lintel[0], 1] == pytest.approx(2 * THICK)


# --- flat arches -------------------------------------------------------------------------------------------------------------


def test_joints_of_a_flat_arch_meet_in_one_point() -> None:
    cut = scenes.table("[wall.opening]", bearing=0.1, head="flat arch", voussoirs=5, **{"from": (0.6, 0.4), "to": (1.4, 0.8)})
    wall = scenes.table("[wall]", bond="running", origin=(0.0, 0.0, 0.0), block=BLOCK, per_course=5, courses=6)
    scene = scenes.build(wall, cut, *scenes.base(1.0, 2.0, THICK))
    sides = np.abs(scene.blocks.face_normal[:, 1]) < 1e-9
    inclined = sides & (np.abs(scene.blocks.face_normal[:, 0]) > 1e-6) & (np.abs(scene.blocks.face_normal[:, 2]) > 1e-6)
    assert inclined.sum() == 2 * 6
    centre = np.array([1.0, 0.0, 0.8 - HIGH * 0.4 / 0.1])
    distance = scene.blocks.face_normal[inclined] @ centre - scene.blocks.face_offset[inclined]
    assert distance == pytest.approx(np.zeros(inclined.sum()), abs=1e-9)


@pytest.mark.parametrize(
    ("first", "second", "entries"),
    [(0.4, 1.0, {"bond": "stack"}), (0.5, 1.1, {"bond": "stack", "rake": (0.1, 0.1)})],
    ids=["one block between two arches", "blocks at ends that lean"],
)
def test_a_block_that_is_cut_on_both_sides_bears_a_flat_arch(first, second, entries) -> None:
    def wall(*starts: float) -> float:
        rows = {"origin": (0.0, 0.0, 0.0), "block": BLOCK, "per_course": 5, "courses": 4, **entries}
        cut = {"bearing": 0.05, "head": "flat arch", "voussoirs": 3}
        openings = (scenes.table("[wall.opening]", **cut, **{"from": (at, 0.2), "to": (at + 0.4, 0.6)}) for at in starts)
        return free_volume(scenes.build(scenes.table("[wall]", **rows), *openings, *scenes.base(1.0, 2.0, THICK)))

    assert wall() - wall(first, second) == pytest.approx(2 * 0.4 * 0.4 * THICK, rel=1e-6)


# --- refusals ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("extra", "entries", "complaint"),
    [
        (opening("south", (3.5, 0.4), (4.2, 0.8)), {}, "must lie within the wall's length"),
        (opening("south", (0.4, 0.4), (1.0, 0.8)), {}, "overlaps the wall that meets this one from 0 to 0.2 m"),
        (opening("south", (1.0, 0.4), (1.6, 0.8)) + "\n" + opening("south", (1.4, 0.4), (2.0, 0.8)), {}, "overlap"),
        (opening("south", (1.0, 0.4), (1.6, 1.2)), {}, "must leave a course for the lintel"),
        (opening("south", (1.0, 0.3), (1.6, 0.8)), {}, "must lie on course lines"),
        (opening("attic", (1.0, 0.4), (1.6, 0.8)), {}, 'a plan "rectangle" has no side "attic"'),
        (
            opening("south", (0.8, 0.4), (1.8, 0.8), bearing=0.1, head="flat arch") + "\n" + opening("south", (1.9, 0.2), (2.5, 1.0)),
            {},
            "on either side, and this block is missing on the right, at 1.9 m; take a smaller bearing",
        ),
        (opening("south", (1.0, 0.4), (1.6, 0.8), voussoirs=3), {}, '`voussoirs` go with `head = "flat arch"`'),
        (scenes.table("[building.floor]", course=7, mass=1.0), {}, "but there are 6 `courses`"),
        ("", {"size": (0.6, 3.0)}, "at least two lengths"),
        ("", {"block": (0.2, 0.2, 0.2)}, "longer than thick"),
        ("", {"foundation": {"height": 0.2, "settling": {"from": (20.0, 0.0), "to": (21.0, 1.0)}}}, "contains no part of a foundation"),
        ("", {"foundation": {"height": 0.2, "settling": {"from": (1.0, 0.1), "to": (2.0, 1.0)}}}, "over its whole breadth, 0 to 0.2 m"),
    ],
)
def test_buildings_that_make_no_sense_are_refused_with_the_rule(extra, entries, complaint) -> None:
    with pytest.raises(SceneError, match=complaint):
        building(extra=extra, **entries)


@pytest.mark.parametrize(
    ("entries", "complaint"),
    [
        ({"leaves": 1, "headers_every": 2}, "goes with two or three `leaves`"),
        ({"leaves": 2, "headers_every": 2, "block": (0.4, 0.15, 0.2)}, "must be twice its depth"),
        ({"leaves": 4}, "less than or equal to 3"),
    ],
)
def test_leaves_that_make_no_sense_are_refused_with_the_rule(entries, complaint) -> None:
    with pytest.raises(SceneError, match=complaint):
        leaved(**{"leaves": 2, **entries})
