"""Loads along a line in plan: a line on an edge, a ridge or a joint is treated alike at every angle, in spite of round-off."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import la_core
from la_core.errors import SceneError
from la_core.scene import Scene
from la_core.scene.loads.top_faces import _reached

ANGLES = (0.0, 1.0, 2.5, 30.0, 45.0, 46.5, 90.0, 123.4, -60.0)
LOAD = 10_000.0  # N/m


def turned(angle: float, u: float, v: float) -> list[float]:
    """A point (u, v) of a wall's plan, turned about the origin by an angle in degrees."""
    cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return [cosine * u - sine * v, sine * u + cosine * v]


def loaded_wall(angle: float, ends: tuple[tuple[float, float], tuple[float, float]]) -> Scene:
    """A wall of two blocks a course, 1.2 m long and 0.4 m thick, with a load along a line in its plan."""
    wall = {
        "bond": "stack", "origin": [0.0, 0.0, 0.0], "block": [0.6, 0.4, 0.3], "per_course": 2, "courses": 1, "angle": angle,
        "footing": {"height": 0.3, "settling": [0.6, 1.2]},
    }  # fmt: skip
    start, end = (turned(angle, *point) for point in ends)
    load = {"blocks": ["wall 1.*"], "per": "m", "from": start, "to": end, "force": [0.0, 0.0, -LOAD]}
    return built({"wall": [wall], "load": [load], "settlement": {"direction": [0.0, 0.0, -1.0]}})


def built(tables: dict[str, Any]) -> Scene:
    return la_core.build({"stone": {"density": 2000.0}, "joint": {"friction": 0.6}, **tables})


def carried(scene: Scene) -> float:
    """Length (m) or area (m2) of the load that blocks carry."""
    return float(-scene.loads.force[:, 2].sum() / LOAD)


@pytest.mark.parametrize("angle", ANGLES)
def test_a_line_along_a_joint_is_refused_at_every_angle(angle: float) -> None:
    """Round-off decided whether the line lay on one block, on the other or on both."""
    with pytest.raises(SceneError, match="the line runs along a joint between two of them, so that the load would count twice"):
        loaded_wall(angle, ((0.6, 0.0), (0.6, 0.4)))


def course(place: tuple[float, float], angle: float, count: int, size: float, load: dict[str, Any]) -> Scene:
    """A loaded course of `count` blocks of 1.5 x 1 x 0.75 `size` (m). It starts at a place and is turned in plan by an angle in degrees."""
    wall = {
        "bond": "stack", "origin": [*place, 0.0], "block": [1.5 * size, size, 0.75 * size], "per_course": count, "courses": 1,
        "angle": angle, "footing": {"height": size, "settling": [0.0, 1.5 * size]},
    }  # fmt: skip
    return built({"wall": [wall], "load": [{"blocks": ["wall 1.*"], **load}], "settlement": {"direction": [0.0, 0.0, -1.0]}})


FAR = {
    "at the origin": ((0.0, 0.0), 0.4),
    "300 m away": ((300.0, 0.0), 0.4),
    "10 km away": ((1e4, 1e4), 0.4),
    "100 km away": ((-1e5, 1e5), 0.4),
    "a model of millimetres": ((0.0, 0.0), 0.001),
    "a model of millimetres 10 m away": ((10.0, 10.0), 0.001),
}


@pytest.mark.parametrize(("place", "size"), FAR.values(), ids=FAR)
@pytest.mark.parametrize("angle", [0.0, 30.0, 123.4])
def test_a_load_does_not_depend_on_the_origin_or_on_the_unit(angle: float, place: tuple[float, float], size: float) -> None:
    """Neighbours were reported to lie above each other, because the length of round-off grew with the distance from the origin."""
    count, along = 12, 12 * 1.5 * size
    start, end = ((np.array(place) + turned(angle, u, 0.5 * size)).tolist() for u in (0.0, along))
    on_line = course(place, angle, count, size, {"per": "m", "from": start, "to": end, "force": [0.0, 0.0, -LOAD]})
    on_area = course(place, angle, count, size, {"per": "m2", "force": [0.0, 0.0, -LOAD]})
    for scene, each in ((on_line, 1.5 * size), (on_area, 1.5 * size * size)):
        by_block = np.bincount(scene.loads.block, weights=-scene.loads.force[:, 2] / LOAD)
        assert by_block[by_block > 0.0] == pytest.approx(np.full(count, each), rel=1e-6)
        middle = scene.loads.point.mean(axis=0) - np.array([*place, 0.0])
        assert middle == pytest.approx([*turned(angle, 0.5 * along, 0.5 * size), 0.75 * size], abs=1e-6 * along)


@pytest.mark.parametrize(("place", "size"), FAR.values(), ids=FAR)
@pytest.mark.parametrize("angle", [0.0, 30.0, 123.4])
def test_a_line_along_a_joint_is_refused_wherever_the_origin_is(angle: float, place: tuple[float, float], size: float) -> None:
    start, end = ((np.array(place) + turned(angle, 1.5 * size, v)).tolist() for v in (0.0, size))
    with pytest.raises(SceneError, match="the line runs along a joint between two of them, so that the load would count twice"):
        course(place, angle, 2, size, {"per": "m", "from": start, "to": end, "force": [0.0, 0.0, -LOAD]})


def test_a_line_over_very_many_joints_counts_once() -> None:
    """Each joint adds a length of round-off. With 700 joints, the load was reported to count twice."""
    scene = course((0.0, 0.0), 0.0, 700, 0.1, {"per": "m", "from": [0.0, 0.05], "to": [105.0, 0.05], "force": [0.0, 0.0, -LOAD]})
    assert carried(scene) == pytest.approx(105.0, rel=1e-5)


@pytest.mark.parametrize("shift", [0.0, 1e4])
def test_a_load_on_the_area_of_two_levels_is_refused_wherever_the_origin_is(shift: float) -> None:
    """The upper block lies over a strip of 1 mm of the lower one."""
    ground = {"name": "ground", "role": "fixed", "box": {"from": [shift, 0.0, -0.2], "to": [shift + 1.0, 1.0, 0.0]}}
    lower = {"name": "lower", "box": {"from": [shift, 0.0, 0.0], "to": [shift + 0.5, 1.0, 0.3]}}
    upper = {"name": "upper", "box": {"from": [shift + 0.499, 0.0, 0.3], "to": [shift + 1.0, 1.0, 0.6]}}
    load = {"blocks": ["lower", "upper"], "per": "m2", "force": [0.0, 0.0, -LOAD]}
    with pytest.raises(SceneError, match="some of the chosen top faces lie above each other"):
        built({"block": [ground, lower, upper], "load": [load], "live": {"direction": [1.0, 0.0, 0.0]}})


@pytest.mark.parametrize("across", [0.0, 0.1, 0.4])
@pytest.mark.parametrize("angle", ANGLES)
def test_a_line_along_a_wall_lies_on_it_up_to_both_its_faces(angle: float, across: float) -> None:
    scene = loaded_wall(angle, ((-0.1, across), (1.0, across)))
    assert carried(scene) == pytest.approx(1.0, rel=1e-7)
    by_block = np.bincount(scene.loads.block, weights=-scene.loads.force[:, 2] / LOAD)
    assert by_block[by_block > 0.0] == pytest.approx([0.6, 0.4], rel=1e-7)
    assert [warning for warning in scene.warnings if "of its line" in warning] == [
        'load "load": only 1 of 1.1 m of its line lie over top faces of its blocks; the rest is left out.'
    ]


@pytest.mark.parametrize("angle", ANGLES)
def test_a_line_along_a_ridge_counts_once(angle: float) -> None:
    """The two slopes of a roof-shaped stone meet in the ridge. A line along the ridge was refused."""
    corners = [(u, v, 0.0) for u in (0.0, 1.0) for v in (0.0, 0.4)] + [(u, 0.2, 0.3) for u in (0.0, 1.0)]
    stone = {"name": "roof", "polyhedron": {"vertices": [[*turned(angle, u, v), z] for u, v, z in corners]}}
    ground = {"name": "ground", "role": "fixed", "box": {"from": [-2.0, -2.0, -0.2], "to": [2.0, 2.0, 0.0]}}
    load = {"blocks": ["roof"], "per": "m", "from": turned(angle, 0.0, 0.2), "to": turned(angle, 1.0, 0.2), "force": [0.0, 0.0, -LOAD]}
    scene = built({"block": [ground, stone], "load": [load], "live": {"direction": [1.0, 0.0, 0.0]}})
    assert carried(scene) == pytest.approx(1.0, rel=1e-7)


@pytest.mark.parametrize("turn", [0.0, 20.0, 35.0, 70.0])
@pytest.mark.parametrize("line", [((0.0, 0.4), (1.0, 0.4)), ((0.4, 0.0), (0.4, 1.0))])
def test_a_line_along_a_cut_within_a_stone_counts_once(turn: float, line: tuple[tuple[float, float], ...], tmp_path: Path) -> None:
    """A stone with an L-shaped plan has two convex parts. One line lies on the cut between them, the other on an edge of both."""
    plan = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.4), (0.4, 0.4), (0.4, 1.0), (0.0, 1.0)]
    ground = [(-2.0, -2.0), (2.0, -2.0), (2.0, 2.0), (-2.0, 2.0)]
    text = upright("ground", ground, -0.2, 0.0, 0) + upright("ell", [tuple(turned(turn, *point)) for point in plan], 0.0, 0.3, 4)
    (tmp_path / "stones.obj").write_text(text)
    start, end = (turned(turn, *point) for point in line)
    (tmp_path / "scene.toml").write_text(
        "[stone]\ndensity = 2000.0\n[joint]\nfriction = 0.6\n[live]\ndirection = [1, 0, 0]\n"
        "[[mesh]]\nfile = 'stones.obj'\nfixed = ['ground']\n"
        f"[[load]]\nblocks = ['ell']\nper = 'm'\nfrom = {start}\nto = {end}\nforce = [0, 0, {-LOAD}]\n"
    )
    assert carried(la_core.load(tmp_path / "scene.toml")) == pytest.approx(1.0, rel=1e-7)


def upright(name: str, plan: list[tuple[float, ...]], low: float, high: float, before: int) -> str:
    """An upright prism in the format OBJ, after 2 `before` corners of other bodies."""
    count, first = len(plan), 2 * before + 1
    corners = [f"v {x:.17g} {y:.17g} {z}" for z in (low, high) for x, y in plan]
    loops = [range(count - 1, -1, -1), range(count, 2 * count)]
    loops += [(k, (k + 1) % count, count + (k + 1) % count, count + k) for k in range(count)]
    return "\n".join([f"o {name}", *corners, *("f " + " ".join(str(first + k) for k in loop) for loop in loops)]) + "\n"


# --- top faces by hand ------------------------------------------------------------------------------------------------------------


def on_area(blocks: list[dict[str, Any]], loaded: list[str]) -> Scene:
    ground = {"name": "ground", "role": "fixed", "box": {"from": [-5.0, -5.0, -0.2], "to": [5.0, 5.0, 0.0]}}
    load = {"blocks": loaded, "per": "m2", "force": [0.0, 0.0, -LOAD]}
    return built({"block": [ground, *blocks], "load": [load], "live": {"direction": [1.0, 0.0, 0.0]}})


def prism(name: str, profile: list[tuple[float, float]]) -> dict[str, Any]:
    """A stone with this profile, 1 m deep."""
    return {"name": name, "prism": {"profile": [list(corner) for corner in profile], "y": [0.0, 1.0]}}


@pytest.mark.parametrize("line", [False, True])
@pytest.mark.parametrize(("left", "right"), [(0.2, 0.8), (0.8, 0.2), (0.5, 0.5)])
def test_a_load_lies_on_a_slope_at_its_height(left: float, right: float, line: bool) -> None:
    """The face rises or falls from (0, left) to (1, right). Its middle is at x = 1/2; that of a line up to x = 1/2 is at x = 1/4."""
    stone = prism("stone", [(0.0, 0.0), (1.0, 0.0), (1.0, right), (0.0, left)])
    if line:
        ground = {"name": "ground", "role": "fixed", "box": {"from": [-5.0, -5.0, -0.2], "to": [5.0, 5.0, 0.0]}}
        load = {"blocks": ["stone"], "per": "m", "from": [0.0, 0.5], "to": [0.5, 0.5], "force": [0.0, 0.0, -LOAD]}
        scene = built({"block": [ground, stone], "load": [load], "live": {"direction": [1.0, 0.0, 0.0]}})
    else:
        scene = on_area([stone], ["stone"])
    at = 0.25 if line else 0.5
    assert scene.loads.point == pytest.approx(np.array([[at, 0.5, left + (right - left) * at]]))


@pytest.mark.parametrize(("run", "carried_on"), [(0.05, 1), (0.21, 2), (0.3, 2)])
def test_a_flank_is_a_top_face_from_a_normal_of_a_tenth_upwards(run: float, carried_on: int) -> None:
    """The right flank of a trapezium of 1 m height projects by `run` (m). The upward part of its normal is run / sqrt(1 + run^2)."""
    stone = prism("stone", [(0.0, 0.0), (1.0 + run, 0.0), (1.0, 1.0), (0.0, 1.0)])
    scene = on_area([stone], ["stone"])
    assert len(scene.loads.block) == carried_on
    assert carried(scene) == pytest.approx(1.0 + (run if carried_on == 2 else 0.0))


@pytest.mark.parametrize(("cover", "area"), [(0.6, 2.0), (0.85, 2.0), (0.95, 1.0)])
def test_a_face_is_a_joint_where_nine_tenths_of_it_are_covered(cover: float, area: float) -> None:
    """Another stone covers a part of the slope of a stone, which is 1 m2 in plan. The level face beside the slope is open."""
    stone = prism("stone", [(0.0, 0.0), (2.0, 0.0), (2.0, 0.5), (1.0, 1.0), (0.0, 1.0)])
    rider = {"name": "rider", "prism": {"profile": [[1.0, 1.0], [2.0, 0.5], [2.0, 1.5], [1.0, 1.5]], "y": [0.0, cover]}}
    scene = on_area([stone, rider], ["stone"])
    assert carried(scene) == pytest.approx(area)


def test_a_load_on_the_area_of_a_stone_lies_on_what_is_seen_from_above() -> None:
    """A stone with the profile of an E: a roof of 1 m, a tongue of 0.5 m below it, and a foot that reaches 0.4 m farther than the roof."""
    loads = on_area([prism("stone", E_STONE)], ["stone"]).loads
    found = sorted(zip(loads.point.tolist(), loads.force[:, 2].tolist(), strict=True))
    total = {height: sum(size for place, size in found if place[2] == pytest.approx(height)) for height in (0.2, 0.5, 0.8)}
    assert total == pytest.approx({0.2: -0.4 * LOAD, 0.5: 0.0, 0.8: -LOAD})
    assert [place for place, _ in found if place[2] == pytest.approx(0.2)] == [pytest.approx([1.2, 0.5, 0.2])]
    assert all(size < 0.0 for _, size in found)  # no load on a face that is hidden from above


E_STONE = [
    (0.0, 0.0), (1.4, 0.0), (1.4, 0.2), (0.2, 0.2), (0.2, 0.4), (0.5, 0.4), (0.5, 0.5), (0.2, 0.5), (0.2, 0.7), (1.0, 0.7),
    (1.0, 0.8), (0.0, 0.8),
]  # fmt: skip


@pytest.mark.parametrize(("reach", "area"), [(0.1, 1.4), (0.2, 1.4), (0.5, 1.4), (0.85, 1.4), (0.95, 0.4), (1.0, 0.4)])
def test_a_face_that_is_cut_into_convex_parts_is_one_face(reach: float, area: float) -> None:
    """The roof of an E is cut into the tops of its spine, 0.2 m, and its arm. A cap over the whole spine alone leaves the roof open."""
    cap = prism("cap", [(0.0, 0.8), (reach, 0.8), (reach, 1.0), (0.0, 1.0)])
    assert carried(on_area([prism("stone", E_STONE), cap], ["stone"])) == pytest.approx(area)


@pytest.mark.parametrize("right", [1.0, 0.9, 1.005])
def test_teeth_of_one_stone_are_faces_of_their_own(right: float) -> None:
    """Under a cap on the left tooth, the gap and the right tooth carry the load, 1 m2 each, whatever the height of the right tooth."""
    teeth = [(0.0, 0.0), (3.0, 0.0), (3.0, right), (2.0, right), (2.0, 0.5), (1.0, 0.5), (1.0, 1.0), (0.0, 1.0)]
    cap = prism("cap", [(0.0, 1.0), (1.0, 1.0), (1.0, 1.5), (0.0, 1.5)])
    assert carried(on_area([prism("stone", teeth), cap], ["stone"])) == pytest.approx(2.0)


@pytest.mark.parametrize("angle", ANGLES)
@pytest.mark.parametrize("place", [(0.0, 0.0), (4.5e5, 5.4e6)])
def test_faces_within_a_stone_carry_nothing(angle: float, place: tuple[float, float], tmp_path: Path) -> None:
    """A T is cut into a web and a flange. Under the course above, the flange carries the load as the top face of a box would."""
    tee = [(0.3, 0.0), (0.7, 0.0), (0.7, 0.5), (1.0, 0.5), (1.0, 0.8), (0.0, 0.8), (0.0, 0.5), (0.3, 0.5)]
    square = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.2), (0.0, 0.2)]
    profiles = {"ground": [(x, z - 0.2) for x, z in square], "tee": tee, "cap": [(x, z + 0.8) for x, z in square]}
    text, before = "", 0
    for name, profile in profiles.items():
        lines = upright(name, profile, -1.0, 0.0, before).splitlines()
        corners = [tuple(map(float, line.split()[1:])) for line in lines if line.startswith("v ")]
        plan = [(turned(angle, x, -height), z) for x, z, height in corners]  # the body lies down: the height of the prism is its depth
        placed = [f"v {x + place[0]:.17g} {y + place[1]:.17g} {z:.17g}" for (x, y), z in plan]
        text += "\n".join([lines[0], *placed, *(line for line in lines if line.startswith("f "))]) + "\n"
        before += len(profile)
    (tmp_path / "stones.obj").write_text(text)
    (tmp_path / "scene.toml").write_text(
        "[stone]\ndensity = 2000.0\n[joint]\nfriction = 0.6\n[live]\ndirection = [1, 0, 0]\n"
        f"[[mesh]]\nfile = 'stones.obj'\nfixed = ['ground']\n[[load]]\nblocks = ['tee']\nper = 'm2'\nforce = [0, 0, {-LOAD}]\n"
    )
    assert carried(la_core.load(tmp_path / "scene.toml")) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("in_the_hollow", [False, True])
def test_what_lies_under_the_overhang_of_a_stone_does_not_cover_its_open_foot(in_the_hollow: bool) -> None:
    """A C-shaped stone has a foot that reaches 0.4 m out of the hollow. The roof of 1 m and these 0.4 m carry the load."""
    profile = [(0.0, 0.0), (1.4, 0.0), (1.4, 0.2), (0.2, 0.2), (0.2, 0.7), (1.0, 0.7), (1.0, 0.8), (0.0, 0.8)]
    inside = [prism("inside", [(0.2, 0.2), (1.0, 0.2), (1.0, 0.7), (0.2, 0.7)])] if in_the_hollow else []
    assert carried(on_area([prism("stone", profile), *inside], ["stone"])) == pytest.approx(1.4)
    beside = prism("beside", [(1.0, 0.2), (1.4, 0.2), (1.4, 0.8), (1.0, 0.8)])
    assert carried(on_area([prism("stone", profile), *inside, beside], ["stone"])) == pytest.approx(1.0)


def test_a_flank_carries_what_a_joint_above_it_does_not_where_it_is_open() -> None:
    """The right flank of the lower stone projects by 0.05 m beyond the loaded stone above. A stone beside it may cover that flank, too."""
    lower = prism("lower", [(0.0, 0.0), (1.05, 0.0), (1.0, 1.0), (0.0, 1.0)])
    upper = prism("upper", [(0.0, 1.0), (1.0, 1.0), (1.0, 1.5), (0.0, 1.5)])
    beside = prism("beside", [(1.05, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)])
    assert carried(on_area([lower, upper], ["lower", "upper"])) == pytest.approx(1.05)
    with pytest.raises(SceneError, match="some of the chosen top faces lie above each other"):
        on_area([lower, upper, beside], ["lower", "upper"])


def test_the_farthest_end_so_far_is_that_of_the_longest_stretch_of_a_group() -> None:
    found = _reached(np.array([5.0, 2.0, 3.0, 4.0, 1.0]), np.array([0, 0, 0, 7, 7]), 10.0)
    assert found[0] == -np.inf and found[1:3].tolist() == [5.0, 5.0] and found[3] < 0.0 and found[4] == 4.0


def test_joints_that_a_line_crosses_add_nothing_to_it() -> None:
    """Each joint added 2e-9 of the line to the load. A thousand blocks added 2e-6, more than the residual of a solver."""
    load = {"per": "m", "from": [0.0, 0.5], "to": [300.0, 0.5], "force": [0.0, 0.0, -LOAD]}
    assert carried(course((0.0, 0.0), 0.0, 200, 1.0, load)) == pytest.approx(300.0, rel=1e-8)
