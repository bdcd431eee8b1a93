"""Loads along a line in plan: a line on an edge, a ridge or a joint is decided by the structure, and not by round-off of its angle."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import la_core
from la_core.errors import SceneError
from la_core.scene import Scene

ANGLES = (0.0, 1.0, 2.5, 30.0, 45.0, 46.5, 90.0, 123.4, -60.0)
LOAD = 10_000.0  # N/m


def turned(angle: float, u: float, v: float) -> list[float]:
    """A point of a wall's own plan, which is turned about the origin by an angle in degrees."""
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
    """Length of the line that blocks carry, m."""
    return float(-scene.loads.force[:, 2].sum() / LOAD)


@pytest.mark.parametrize("angle", ANGLES)
def test_a_line_along_a_joint_is_refused_at_every_angle(angle: float) -> None:
    """It was on one block, on the other one or on both, as round-off had it."""
    with pytest.raises(SceneError, match="the line runs along a joint between two of them, so that the load would count twice"):
        loaded_wall(angle, ((0.6, 0.0), (0.6, 0.4)))


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
    """The two slopes of a roof-shaped stone meet in the ridge. It was refused."""
    corners = [(u, v, 0.0) for u in (0.0, 1.0) for v in (0.0, 0.4)] + [(u, 0.2, 0.3) for u in (0.0, 1.0)]
    stone = {"name": "roof", "polyhedron": {"vertices": [[*turned(angle, u, v), z] for u, v, z in corners]}}
    ground = {"name": "ground", "role": "fixed", "box": {"from": [-2.0, -2.0, -0.2], "to": [2.0, 2.0, 0.0]}}
    load = {"blocks": ["roof"], "per": "m", "from": turned(angle, 0.0, 0.2), "to": turned(angle, 1.0, 0.2), "force": [0.0, 0.0, -LOAD]}
    scene = built({"block": [ground, stone], "load": [load], "live": {"direction": [1.0, 0.0, 0.0]}})
    assert carried(scene) == pytest.approx(1.0, rel=1e-7)


@pytest.mark.parametrize("turn", [0.0, 20.0, 35.0, 70.0])
@pytest.mark.parametrize("line", [((0.0, 0.4), (1.0, 0.4)), ((0.4, 0.0), (0.4, 1.0))])
def test_a_line_along_a_cut_within_a_stone_counts_once(turn: float, line: tuple[tuple[float, float], ...], tmp_path: Path) -> None:
    """A stone with an L as its plan is of two convex parts. One line lies on the cut between them, the other one on an edge of both."""
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
