"""Supports that move by different shares of one settlement: statics by hand, both methods, and refused motions."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import Silent
from independent_mechanics import static_form_of_rectangles
from numpy.testing import assert_allclose

from comparison.cli.scene_verbs.show import facts_table, scene_facts
from comparison.numbers import Units
from comparison.report.inputs import input_rows
from comparison.report.plain_words import plain_words
from comparison.workflow import run_scene
from la_core.analysis import analyse, decided_model
from la_core.errors import SceneError
from la_core.limit import Drive
from la_core.measures import residuals
from la_core.model import assemble
from la_core.scene import Scene

INSET, PER_MILLE = 1e-3, 1e-3
DOWN = [0.0, 0.0, -1.0]
GRAVITY = 9.81


def columns(**settlement: Any) -> Scene:
    """Two columns apart, each on a support of its own, with 600 and 1200 kg."""
    parts = []
    for name, x, height in (("left", 0.0, 1.0), ("right", 2.0, 2.0)):
        parts.append(scenes.box(name, (x, 0.0, 0.0), (x + 0.6, 0.5, height)))
        parts.append(scenes.box(f"{name} pad", (x - 0.1, 0.0, -0.2), (x + 0.7, 0.5, 0.0), "support"))
    motion = settlement if "axis" in settlement else {"direction": DOWN, **settlement}
    return scenes.build(*parts, settlement=motion, inset=INSET, model="auto")


def beam(**settlement: Any) -> Scene:
    """A rigid beam of 1200 kg on pads at its ends and in the middle; it lies on two of them as soon as one pad leaves it."""
    pads = [scenes.box(f"pad {k}", (x, 0.0, -0.2), (x + 0.2, 0.5, 0.0), "support") for k, x in enumerate((0.0, 1.0, 2.2))]
    return scenes.build(
        *pads, scenes.box("beam", (0.0, 0.0, 0.0), (2.4, 0.5, 0.5)), settlement={"direction": DOWN, **settlement}, inset=INSET, model="auto"
    )


LEFT, RIGHT = 600.0 * GRAVITY, 1200.0 * GRAVITY
# Force on the outer edge of pad 2, where the beam sinks most, as it turns about the inner edge of pad 0.
ON_TWO = 1200.0 * GRAVITY * (1.2 - 0.2 + INSET) / (2.4 - 0.2)
CLOSED_FORMS = {  # reaction: sum over the supports of their force times their share of the settlement
    "two ratios": (lambda: columns(zone=[{"blocks": ["right pad"], "ratio": 0.5}]), LEFT + 0.5 * RIGHT),
    "one is held": (lambda: columns(zone=[{"blocks": ["right*"], "ratio": 0.0}]), LEFT),
    "trough": (lambda: columns(profile=[[-0.1, 1.0], [0.7, 1.0], [1.9, 0.25], [2.7, 0.25]]), LEFT + 0.25 * RIGHT),
    # The middle pad sinks twice as fast as the right one, and so it leaves the beam.
    "the middle pad leaves": (
        lambda: beam(zone=[{"blocks": ["pad 0"], "ratio": 0.0}, {"blocks": ["pad 1"], "ratio": 2.0}]),
        ON_TWO,
    ),
}


@pytest.mark.yade
@pytest.mark.parametrize("name", [n if n == "two ratios" else pytest.param(n, marks=pytest.mark.slow) for n in CLOSED_FORMS])
def test_both_methods_find_the_power_of_all_supports(name: str, tmp_path: Path) -> None:
    build, exact = CLOSED_FORMS[name]
    summary = run_scene(build(), tmp_path / "results", Silent(), with_yade=True)
    assert summary["verdict"] == "agree", summary["reason"]
    assert summary["unit"] == "N"
    assert summary["limit_analysis"]["coulomb"]["reaction"] == pytest.approx(exact, rel=PER_MILLE)
    assert summary["yade"]["reaction"] == pytest.approx(exact, rel=PER_MILLE)
    assert abs(summary["yade"]["settlement"] / summary["yade"]["asked_settlement"] - 1.0) <= PER_MILLE


def turning(low: float, *profile: tuple[float, float], top: float = 0.0) -> Scene:
    """A rigid beam of 1.2 m on two pads of 0.2 m, the first from x = 0 and the second from x = `low` on, which turn along a profile."""
    pads = [scenes.box(f"pad {k}", (x, 0.0, top - 0.2), (x + 0.2, 0.5, top), "support") for k, x in enumerate((0.0, low))]
    lying = scenes.box("beam", (0.0, 0.0, top), (1.2, 0.5, top + 0.5))
    settlement = {"direction": DOWN, "profile": [list(point) for point in profile]}
    return scenes.build(*pads, lying, settlement=settlement, inset=INSET, model="auto", friction=0.4)


def on_edges(left: float, right: float, *profile: tuple[float, float]) -> float:
    """Reaction over W of a beam of 1.2 m that lies on two edges: the share of each by moments, times the settlement of the edge."""
    on_right = (0.6 - left) / (right - left)
    places, ratios = np.array(profile).T
    return float((1.0 - on_right) * np.interp(left, places, ratios) + on_right * np.interp(right, places, ratios))


TROUGH, HUMP = ((0.0, 0.4), (0.6, 1.0), (1.2, 0.8)), ((0.0, 1.0), (0.6, 0.4), (1.2, 0.8))
TURNING = {  # both pads turn: in a trough the beam lies on their outer edges, on a hump on their inner ones
    "trough": (lambda: turning(1.0, *TROUGH), on_edges(INSET, 1.2 - INSET, *TROUGH)),
    "hump": (lambda: turning(0.9, *HUMP), on_edges(0.2 - INSET, 0.9 + INSET, *HUMP)),
    # The beam moves with its pads: its whole weight, times the settlement of its middle.
    "slope": (lambda: turning(1.0, (0.0, 1.0), (1.2, 0.4)), 0.7),
}


@pytest.mark.yade
@pytest.mark.parametrize("name", [n if n == "trough" else pytest.param(n, marks=pytest.mark.slow) for n in TURNING])
def test_both_methods_find_the_power_of_supports_that_turn(name: str, tmp_path: Path) -> None:
    build, exact = TURNING[name]
    scene = build()
    summary = run_scene(scene, tmp_path / "results", Silent(), with_yade=True, figures=lambda _: {})
    assert summary["verdict"] == "agree", summary["reason"]
    assert np.all(scene.support_twists[:2, 4] != 0.0)  # type: ignore[index]
    for found in (summary["limit_analysis"]["coulomb"]["reaction"], summary["yade"]["reaction"]):
        assert found / scene.weight == pytest.approx(exact, rel=PER_MILLE)


def test_the_last_zone_that_names_a_support_gives_its_share() -> None:
    """A support that no zone names takes the whole settlement; a zone names every support that one of its patterns chooses."""
    for zones, sinks in (
        ([(["pad 0", "pad 1"], 0.5)], [0.5, 0.5, 1.0]),
        ([(["pad 0", "pad 1"], 0.5), (["pad 1", "pad 2"], 0.25)], [0.5, 0.25, 0.25]),
        ([(["*"], 0.5), (["pad 2"], -1.0)], [0.5, 0.5, -1.0]),
    ):
        scene = beam(zone=[{"blocks": names, "ratio": ratio} for names, ratio in zones])
        assert scene.support_twists is not None
        assert_allclose(scene.support_twists, np.outer([*sinks, 0.0], [*DOWN, 0.0, 0.0, 0.0]))


@pytest.mark.parametrize("top", [-3.0, 0.7, 50.0])
def test_a_profile_means_the_same_at_every_height(top: float) -> None:
    """Tops of supports sink straight down, wherever z = 0 is. Otherwise the height would change the friction on them."""
    low, moved = (analyse(turning(1.0, *TROUGH, top=height)) for height in (0.0, top))
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert moved.bounds[drive].value == pytest.approx(low.bounds[drive].value, rel=1e-6)
    twists = moved.scene.support_twists
    assert twists is not None
    for x in (0.0, 0.1, 0.2):
        assert_allclose((twists[0, :3] + np.cross(twists[0, 3:], [x, 0.3, top]))[:2], 0.0, atol=1e-12)


def test_a_report_names_the_motion_of_each_support(tmp_path: Path) -> None:
    scene = columns(zone=[{"blocks": ["right pad"], "ratio": 0.5}])
    summary = run_scene(scene, tmp_path, Silent(), with_yade=False)
    rows = dict(input_rows(summary, Units(scene.weight)))
    assert rows["of it, motion of left pad"] == "(0, 0, −1)" and rows["of it, motion of right pad"] == "(0, 0, −0.5)"
    words = " ".join(plain_words(summary, Units(scene.weight)))
    assert (
        "moves by different shares of the settlement" in words
        and "The forces on the supports, each times the share of the settlement at its place" in words
    )


@pytest.mark.parametrize(
    ("settlement", "row"),
    [
        ({}, ("share of the settlement, right pad", "(0, 0, −0.5)", "")),
        (
            {"axis": [0.0, 1.0, 0.0], "point": [0.0] * 3},
            ("motion in the middle per rad of the rotation, right pad", "(−0.05, 0, −1.15)", "m"),
        ),
    ],
    ids=["translation", "rotation"],
)
def test_show_states_the_unit_of_the_motion_of_each_support(settlement: dict[str, Any], row: tuple[str, str, str]) -> None:
    """The motion by a rotation was called a share of the settlement, without its unit."""
    scene = columns(**settlement, zone=[{"blocks": ["right pad"], "ratio": 0.5}])
    table = facts_table("columns", scene_facts(scene, decided_model(scene)))
    assert row in [tuple(map(str, cells)) for cells in zip(*(column.cells for column in table.columns), strict=True)]


@pytest.mark.parametrize(
    ("settlement", "moves"),
    [
        ({"profile": [[0.0, 1.0], [1.0, 0.5]]}, "moves by shares of the settlement that differ along it"),
        ({"zone": [{"blocks": ["pad"], "ratio": 0.5}]}, "moves by a share of the settlement"),
    ],
    ids=["profile", "zone"],
)
def test_a_report_on_a_single_support_speaks_of_one(settlement: dict[str, object], moves: str, tmp_path: Path) -> None:
    pad, block = scenes.box("pad", (0.0, 0.0, -0.2), (1.0, 0.5, 0.0), "support"), scenes.box("block", (0.1, 0.0, 0.0), (0.9, 0.5, 0.6))
    scene = scenes.build(pad, block, settlement={"direction": DOWN, **settlement}, inset=INSET)
    words = " ".join(plain_words(run_scene(scene, tmp_path, Silent(), with_yade=False), Units(scene.weight)))
    assert f"{moves}," in words and "The forces on the support, each times the share of the settlement at its place, are" in words


def test_a_drop_with_a_turn_is_a_turn_about_a_point_beside() -> None:
    """A profile that falls from 1 to 0.5 over the pad is the rotation about the point where it would be 0, in N instead of N m."""
    pad, block = scenes.box("pad", (0.0, 0.0, -0.2), (1.0, 0.5, 0.0), "support"), scenes.box("block", (0.1, 0.0, 0.0), (0.9, 0.5, 0.6))
    falling = scenes.build(pad, block, settlement={"direction": DOWN, "profile": [[0.0, 1.0], [1.0, 0.5]]}, inset=INSET)
    turning = scenes.build(pad, block, settlement={"axis": [0.0, -1.0, 0.0], "point": [2.0, 0.0, 0.0]}, inset=INSET)
    one, other = analyse(falling), analyse(turning)
    assert_allclose(one.assembly.support_twist, 0.5 * other.assembly.support_twist, atol=1e-12)
    assert one.scene.unit == "N" and other.scene.unit == "N m"
    reaction = one.bounds[Drive.YIELDING].value
    assert reaction == pytest.approx(0.75 * one.scene.weight, rel=1e-6)  # all of the weight, at the middle of the pad
    assert other.bounds[Drive.YIELDING].value == pytest.approx(2.0 * reaction, rel=1e-6)


def test_a_support_whose_ends_move_as_much_up_as_down_turns_about_its_middle() -> None:
    pad, block = scenes.box("pad", (0.0, 0.0, -0.1), (1.0, 0.2, 0.0), "support"), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.4))
    scene = scenes.build(pad, block, settlement={"direction": DOWN, "profile": [[0.0, 1.0], [1.0, -1.0]]}, inset=INSET)
    assert scene.own_twists is not None
    velocity, spin = scene.own_twists[0, :3], scene.own_twists[0, 3:]
    for x, sinks in ((0.0, 1.0), (0.5, 0.0), (1.0, -1.0)):  # points of its top
        np.testing.assert_allclose(velocity + np.cross(spin, [x, 0.1, 0.0]), [0.0, 0.0, -sinks], atol=1e-12)


def test_supports_follow_a_profile_at_both_ends() -> None:
    profile = [[0.0, 0.0], [1.0, 1.0], [3.0, 0.2]]
    scene = beam(profile=profile)
    assert scene.support_twists is not None
    for name, low, high in (("pad 0", 0.0, 0.2), ("pad 1", 1.0, 1.2), ("pad 2", 2.2, 2.4)):
        twist = scene.support_twists[scene.blocks.names.index(name)]
        for end in (low, high):
            sinks = -(twist[:3] + np.cross(twist[3:], [end, 0.0, 0.0]))[2]
            assert sinks == pytest.approx(np.interp(end, *np.array(profile).T))
    assert not scene.support_twists[scene.blocks.names.index("beam")].any()


@pytest.mark.parametrize("seed", range(4))
def test_random_shares_have_the_reaction_of_the_static_form(seed: int) -> None:
    """A wall on four supports with random shares or a random profile, against an independent programme of forces."""
    rng = np.random.default_rng(seed)
    ends = np.linspace(0.0, 3.2, 5).round(9).tolist()
    pads = [scenes.box(f"pad {k}", (ends[k], 0.0, -0.2), (ends[k + 1], 0.3, 0.0), "support") for k in range(4)]
    ratios = rng.uniform(-0.2, 1.5, 5).round(3).tolist()
    if seed % 2:
        settlement: dict[str, Any] = {"profile": [[end, ratio] for end, ratio in zip(ends, ratios, strict=True)]}
    else:
        settlement = {"zone": [{"blocks": [f"pad {k}"], "ratio": ratio} for k, ratio in enumerate(ratios[:4])]}
    wall = scenes.wall(8, 5)[0]
    scene = scenes.build(wall, *pads, settlement={"direction": DOWN, **settlement}, friction=0.5)
    analysis = analyse(scene)
    for drive, sign in ((Drive.YIELDING, 1.0), (Drive.PUSHING, -1.0)):
        expected = static_form_of_rectangles(scene, sign)
        found = analysis.sharp.bounds[drive]
        assert found.value / scene.weight == pytest.approx(expected, abs=1e-6)
        assert residuals.reaction(analysis.sharp.assembly, found.forces) == pytest.approx(found.value, abs=1e-5 * scene.weight)


@pytest.mark.parametrize(
    ("settlement", "message"),
    [
        ({"zone": [{"blocks": ["middle pad"], "ratio": 0.5}]}, r'settlement.zone\[0\].blocks: no support has the name "middle pad"'),
        ({"zone": [{"blocks": ["left"], "ratio": 0.5}]}, 'no support has the name "left"; did you mean "left pad"'),
        ({"zone": [{"blocks": ["*"], "ratio": 0.0}]}, "settlement: no support moves: every ratio is 0"),
        ({"zone": [{"blocks": ["*"], "ratio": 0.5}], "profile": [[0.0, 0.0], [1.0, 1.0]]}, "needs either `zone` or `profile`"),
        ({"profile": [[1.0, 0.0], [0.0, 1.0]]}, "the places of a `profile` must rise"),
        ({"profile": [[0.0, 0.0], [1.0, 1.0]], "direction": [1.0, 0.0, -1.0]}, "a `profile` needs a `direction` at right angles"),
    ],
)
def test_what_moves_no_support_or_has_no_one_meaning_is_refused(settlement: dict[str, Any], message: str) -> None:
    with pytest.raises(SceneError, match=message):
        columns(**settlement)


def test_supports_that_move_alike_are_one_motion() -> None:
    """Shares of 1, written out, are the settlement itself: the same assembly, and no more fields in the file."""
    plain, spelt = columns(), columns(zone=[{"blocks": ["*"], "ratio": 1.0}])
    assert spelt.own_twists is None and columns(zone=[{"blocks": ["*"], "ratio": 0.5}]).own_twists is not None
    np.testing.assert_array_equal(assemble(plain).support_twist, assemble(spelt).support_twist)
