"""Tolerances, and the uncertainty that a verdict allows, from plain numbers: units, signs and the effect of a requested accuracy."""

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from comparison.judge.checks import energy, friction_state, mechanisms, reduced_model, run_checks, sections, tolerances
from comparison.judge.checks.tolerances import FLOOR, LEAST_REACTION, UNBALANCED, UNCERTAIN
from la_core.exchange import AT_STAKE
from la_core.limit import Status

PAGE = (Path(__file__).parents[2] / "comparison" / "README.md").read_text(encoding="utf-8")
WEIGHT, LENGTH = 2000.0, 0.4  # N, m


def results(
    reaction: float, uncertainty: float = 0.0, live: bool = False, turns: bool = False, asked: float | None = None, speed: float = 1.0
) -> Any:
    """Return results of 100 blocks of 20 N. speed: of the support's fastest contact point per unit settlement; m for a turning support."""
    scene = SimpleNamespace(live=object() if live else None, weight=WEIGHT, is_rotation=turns)
    assembly = SimpleNamespace(length=LENGTH, has_live_load=live, support_speed=speed, mean_weight=WEIGHT / 100.0)
    accuracy = None if asked is None else SimpleNamespace(asked=asked)
    analysis = SimpleNamespace(scene=scene, assembly=assembly, accuracy=accuracy)
    recorded = SimpleNamespace(result=SimpleNamespace(reaction=reaction, uncertainty=uncertainty))
    return SimpleNamespace(analysis=analysis, recorded=recorded, scene=scene)


@pytest.mark.parametrize(
    ("check", "tolerance"),
    [
        ("settlement achieved", run_checks.SETTLEMENT),
        ("speed along the load", run_checks.SPEED),
        ("equilibrium of the YADE state", UNBALANCED),
        ("energy of the YADE run", energy.DRIFT),
        ("energy of the YADE run", energy.LEAST_TURNOVER),
        ("reaction against prediction", UNCERTAIN),
        ("reaction against prediction", tolerances.MOST_UNCERTAIN),
        ("YADE's friction state", friction_state.CONSISTENT),
        ("steadiness of the plateau", friction_state.STEADY),
        ("moving blocks", mechanisms.SAME_MASS),
        ("force sums over sections", sections.SECTION),
    ],
)
def test_the_row_of_a_check_states_the_tolerance_that_the_judge_uses(check: str, tolerance: float) -> None:
    (row,) = re.findall(rf"^\| {re.escape(check)}\b.*", PAGE, re.MULTILINE)
    assert re.search(rf"(?<![\d.]){100.0 * tolerance:g} %", row), f"{100.0 * tolerance:g} % is not in: {row}"


def test_the_page_states_the_floor_and_the_tolerances_that_are_no_per_cents() -> None:
    page = " ".join(PAGE.split())
    assert f"The floor is {100.0 * FLOOR:g} % of the reaction, but at least {100.0 * LEAST_REACTION:g} % of the weight" in page
    for value, words in (
        (LEAST_REACTION, r"of a multiplier: (\S+)\)"),
        (mechanisms.SIMILAR, r"modal assurance of both mechanisms is at least (\S+);"),
        (reduced_model.IN_SPACE, r"(\S+) of a block: ten times the residual"),
    ):
        assert [float(stated) for stated in re.findall(words, page)] == [value]


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_floor_is_a_share_of_the_size_of_a_reaction(sign: float) -> None:
    """The floor is positive also for a negative reaction, of a support that pulls."""
    assert tolerances.floor(results(sign * 600.0)) == pytest.approx(FLOOR * 600.0)
    assert tolerances.reaction_tolerance(results(sign * 600.0, 2.0), 1.0) == pytest.approx(FLOOR * 600.0 + 3.0)
    assert tolerances.unsure_methods(results(sign * 600.0, 5.9), 5.9) == []
    (unsure,) = tolerances.unsure_methods(results(sign * 600.0, 6.1), 5.9)
    assert (unsure.method, unsure.allowed, unsure.share) == ("YADE", pytest.approx(6.0), pytest.approx(6.1 / 600.0))


@pytest.mark.parametrize(("given", "least"), [({}, WEIGHT), ({"turns": True}, WEIGHT * LENGTH), ({"live": True}, 1.0)])
def test_a_reaction_of_zero_is_measured_by_the_weight_a_moment_by_a_block_s_length_and_a_multiplier_by_itself(
    given: dict[str, Any], least: float
) -> None:
    assert tolerances.floor(results(0.0, **given)) == pytest.approx(LEAST_REACTION * least)
    assert tolerances.unsure_methods(results(0.0, 0.9 * LEAST_REACTION * least, **given), 0.0) == []
    (unsure,) = tolerances.unsure_methods(results(0.0, 1.1 * LEAST_REACTION * least, **given), 0.0)
    assert unsure.allowed == pytest.approx(LEAST_REACTION * least)


def test_a_method_may_be_as_uncertain_as_the_accuracy_that_was_asked_for() -> None:
    assert tolerances.unsure_methods(results(600.0, asked=0.03), 0.029 * 600.0) == []
    (unsure,) = tolerances.unsure_methods(results(600.0, asked=0.03), 0.031 * 600.0)
    assert unsure.method == "limit analysis" and unsure.allowed == pytest.approx(0.03 * 600.0)
    assert len(tolerances.unsure_methods(results(600.0, asked=0.001), 0.9 * UNCERTAIN * 600.0)) == 0  # a finer accuracy forbids no more


@pytest.mark.parametrize("reaction", [1e4, -1e4])
def test_unbalanced_forces_are_small_beside_the_force_that_a_reaction_stands_for(reaction: float) -> None:
    """A moment of 10 kN m on a support of 5 m is a force of 2 kN. A multiplier is no force, so only a block's weight counts beside it."""
    assert tolerances.unbalanced(results(reaction)) == pytest.approx(UNBALANCED * AT_STAKE * 1e4 / 20.0)
    assert tolerances.unbalanced(results(reaction, turns=True, speed=5.0)) == pytest.approx(UNBALANCED * AT_STAKE * 2e3 / 20.0)
    assert tolerances.unbalanced(results(1.0)) == tolerances.unbalanced(results(reaction, live=True)) == UNBALANCED


@pytest.mark.parametrize(("status", "stated"), [(Status.SOLVED, 3.0), (Status.INACCURATE, 3.0), (Status.FAILED, 0.0)])
def test_a_prediction_states_its_uncertainty_where_it_has_a_value(status: Status, stated: float) -> None:
    analysis: Any = SimpleNamespace(coulomb=SimpleNamespace(status=status, uncertainty=3.0))
    assert tolerances.stated_uncertainty(analysis) == stated
    analysis.coulomb = None
    assert tolerances.stated_uncertainty(analysis) == 0.0
