"""Where an expected value is not met and its number shows a known slip, the next step names this slip."""

from typing import Any

import pytest

import la_core
from comparison.judge.checks import next_steps
from comparison.judge.checks.answer import check_expected
from comparison.verdict import Verdict
from la_core.analysis import analyse

HEIGHT, FRICTION = 0.3, 0.6  # m, of a block of the corbel


def step(scene: la_core.Scene, expected: dict[str, float]) -> str:
    (check,) = check_expected(analyse(la_core.variant(scene, {"expected": expected | {"kind": "exact"}})))
    assert check.verdict is Verdict.UNEXPECTED
    return check.next_step


def box(name: str, role: str, left: float, right: float, bottom: float, top: float) -> dict[str, Any]:
    return {"name": name, "role": role, "box": {"from": [left, 0.0, bottom], "to": [right, 0.3, top]}}


def corbel(inset: float) -> la_core.Scene:
    """Return three blocks 1 m long, each shifted by 0.4 m over the one below, with a prop under the end of the highest block."""
    stones = [box(f"stone {k}", "free", 0.4 * k, 1.0 + 0.4 * k, HEIGHT * k, HEIGHT * (k + 1)) for k in range(3)]
    held = [box("ground", "fixed", 0.0, 1.0, -0.2, 0.0), box("prop", "support", 1.6, 1.8, 0.0, 2.0 * HEIGHT)]
    joint = {"friction": FRICTION, "inset": inset}
    return la_core.build({"stone": {"density": 2000.0}, "joint": joint, "block": stones + held, "settlement": {"direction": [0, 0, -1]}})


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        ("reaction_over_weight", 359.7, "seems to be in N: divide it by the weight, 2158.2 N"),
        ("reaction_over_weight", 16.67, "seems to be in percent"),
        ("reaction_over_weight", -0.1667, "seems to have the wrong sign: the reaction is positive here"),
        ("reaction_over_weight", 1.0, "give it as `reaction_max_over_weight`"),
        ("reaction_max_over_weight", 1 / 6, "give it as `reaction_over_weight`"),
        ("associated_reaction_over_weight", 1.0, "give it as `reaction_max_over_weight`"),
        ("reaction_over_weight", 0.545, next_steps.CHECK_SOURCE),
    ],
)
def test_a_value_in_another_unit_or_of_another_key_is_recognised(key: str, value: float, expected: str) -> None:
    assert expected in step(la_core.load("two_pads"), {key: value})


def test_a_push_that_is_expected_as_a_positive_reaction_is_recognised() -> None:
    """The pad rises and lifts the block, with W by statics. The reaction is this force with a minus."""
    lifted = la_core.variant("two_pads", {"settlement.direction": [0.0, 0.0, 1.0]})
    found = step(lifted, {"reaction_over_weight": 1.0})
    assert "seems to have the wrong sign: the reaction is negative here, because the structure holds the support back" in found


def test_a_value_of_a_model_that_weighs_a_newton_is_not_said_to_be_in_newtons() -> None:
    """R and R/W are nearly the same number for a weight of 1 N."""
    model = la_core.variant("two_pads", {"gravity": [0.0, 0.0, -9.81 / 2158.2]})
    assert model.weight == pytest.approx(1.0)
    assert step(model, {"reaction_over_weight": 1.005 / 6}) == next_steps.CHECK_SOURCE


def test_a_value_of_the_associated_rule_is_recognised() -> None:
    found = step(la_core.load("two_blocks"), {"reaction_over_weight": 0.5 / 1.36, "tolerance": 1e-3})
    assert "give it as `associated_reaction_over_weight`" in found


def test_an_angle_in_place_of_a_multiplier_is_recognised() -> None:
    blocks = [box("table", "fixed", -1.0, 1.0, -0.1, 0.0), box("block", "free", -0.1, 0.1, 0.0, 0.5)]
    tables = {"stone": {"density": 2000.0}, "joint": {"friction": 0.6}, "block": blocks, "tilt": {"axis": [0.0, 1.0, 0.0]}}
    assert step(la_core.build(tables), {"multiplier": 21.8}) == next_steps.ANGLE


def test_a_value_for_sharp_edges_where_joints_slide_asks_for_the_inset_zero() -> None:
    """By hand: moments of the two upper blocks about the edge of the lowest block. Friction on the prop also holds the sliding stone."""
    by_hand = 2.0 * (1.1 - 1.0) / (0.8 + FRICTION * HEIGHT) / 3.0
    expected = {"reaction_over_weight": by_hand, "kind": "exact"}
    assert step(corbel(0.001), expected) == next_steps.SHARP_EDGES
    (check,) = check_expected(analyse(la_core.variant(corbel(0.0), {"expected": expected})))
    assert check.verdict is Verdict.EXPECTED_MET


@pytest.mark.parametrize(
    ("key", "value", "recognised"),
    [
        ("reaction_over_weight", 16.79, "in percent"),
        ("reaction_over_weight", 16.95, ""),
        ("reaction_over_weight", 16.53, "in percent"),
        ("reaction_over_weight", 16.38, ""),
        ("reaction_over_weight", 1.0 + 0.9e-6, "`reaction_max_over_weight`"),
        ("reaction_over_weight", 1.0 + 2e-6, ""),
        ("reaction_max_over_weight", 1.0 + 2e-6, ""),  # not met, and not the value of another key
        ("associated_reaction_over_weight", 1 / 6 + 2e-6, ""),
        ("reaction_over_weight", 9.4623, ""),  # degrees whose tangent is 1/6, but nothing tilts
    ],
)
def test_a_slip_is_recognised_to_one_per_cent_and_another_key_to_the_tolerance(key: str, value: float, recognised: str) -> None:
    found = step(la_core.load("two_pads"), {key: value, "tolerance": 1e-6})
    assert recognised in found and (found == next_steps.CHECK_SOURCE) is (recognised == "")


def test_a_shift_by_an_inset_is_told_up_to_twice_that_of_the_bound() -> None:
    """The inset takes 1 mm off each end of the joint on the prop, and 1 mm off the edge that the blocks tip about."""
    scene = corbel(0.001)
    (check,) = check_expected(analyse(la_core.variant(scene, {"expected": {"reaction_over_weight": 0.0, "kind": "exact"}})))
    computed = check.limit_analysis
    assert computed is not None and "for an inset of 1 mm, but the scene expects 0." in check.reason
    analysis = analyse(scene)
    shift = abs(analysis.sharp.bounds[analysis.main].value - analysis.bounds[analysis.main].value) / scene.weight
    steps = [step(scene, {"reaction_over_weight": computed + times * shift}) for times in (-1.9, 1.9, -2.1, 2.1)]
    assert steps == 2 * [next_steps.SHARP_EDGES] + 2 * [next_steps.CHECK_SOURCE]


def test_an_answer_for_sharp_edges_is_told_as_one() -> None:
    (check,) = check_expected(analyse(la_core.variant("two_pads", {"expected": {"reaction_over_weight": 0.3, "kind": "exact"}})))
    assert check.reason == "Limit analysis gives 0.166667 for sharp edges, but the scene expects 0.3."


def test_the_sign_of_a_value_below_zero_is_not_said_to_be_positive() -> None:
    """A support that is lifted works against the weight: its reaction along the motion is negative."""
    lifted = la_core.variant("two_pads", {"settlement.direction": [0.0, 0.0, 1.0]})
    analysis = analyse(la_core.variant(lifted, {"expected": {"reaction_over_weight": 0.0, "kind": "exact"}}))
    (check,) = check_expected(analysis)
    assert check.limit_analysis is not None and check.limit_analysis < -0.1
    assert step(lifted, {"reaction_over_weight": -check.limit_analysis}) != next_steps.SIGN.format(quantity="reaction")


@pytest.mark.parametrize("law", ["associated", "none-slides"])
def test_a_bound_that_was_asked_for_is_compared_with_the_expected_value(law: str) -> None:
    scene = la_core.variant("two_pads", {"effects.friction": law, "expected": {"reaction_over_weight": 1 / 6, "kind": "exact"}})
    (check,) = check_expected(analyse(scene))
    assert check.verdict is Verdict.EXPECTED_MET
