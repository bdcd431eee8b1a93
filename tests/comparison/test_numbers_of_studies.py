"""Numbers of the studies, from made-up runs: the last values of a run that did not converge, and the numbers over the weight."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes

from comparison.studies import cost, sensitivity
from comparison.studies.cost_limit_analysis import ASSOCIATED, PREDICTION, Method, MethodOutcome
from comparison.studies.figure_of_sensitivity import sensitivity_figure
from comparison.studies.sensitivity import Sensitivity, Trial
from la_core.limit import ClassicParameters, Status

WEIGHT = 200.0  # N


def trial(relaxation: float, status: Status, last: float, lowest: float, highest: float) -> Trial:
    value = last if status is Status.SOLVED else float("nan")
    return Trial(relaxation, 0.1, status, value, last, lowest, highest, 12, 0.0, 0.0, 0.0, 1.0)


def test_a_run_that_did_not_converge_is_told_by_its_last_ten_values(monkeypatch: pytest.MonkeyPatch) -> None:
    values = np.array([500.0, 10.0, 90.0, 60.0, 100.0, 70.0, 50.0, 80.0, 55.0, 95.0, 65.0, 75.0])
    ended = SimpleNamespace(
        values=values, violations=values, parameters=ClassicParameters(), status=Status.INACCURATE, value=75.0, iterations=12,
        dilation=0.0, penetration=0.0, seconds=1.0,
    )  # fmt: skip
    monkeypatch.setattr(sensitivity, "solve_sequentially", lambda *given: ended)
    assembly: Any = SimpleNamespace(has_live_load=False, weight=WEIGHT)
    (found,) = sensitivity.study(scenes.shipped("two_blocks"), assembly, (0.4,), (0.1,)).trials
    assert np.isnan(found.value) and (found.last, found.lowest, found.highest) == (75.0, 50.0, 100.0)


def test_values_ranges_and_references_of_a_figure_are_over_the_weight() -> None:
    trials = (trial(0.4, Status.SOLVED, 160.0, 160.0, 160.0), trial(0.6, Status.INACCURATE, 80.0, 50.0, 100.0))
    study = Sensitivity("wall", "reaction", "N", WEIGHT, ClassicParameters(), trials)
    value, count = sensitivity_figure(study, {"associated": (120.0, 3), "Coulomb": (140.0, None)}).axes
    drawn = [np.asarray(line.get_ydata(), dtype=float).tolist() for line in value.lines]
    assert [0.8] in drawn and [0.4] in drawn and [0.25, 0.5] in drawn
    assert [0.6, 0.6] in drawn and [0.7, 0.7] in drawn
    flat = [list(line.get_ydata()) for line in count.lines if len(set(line.get_ydata())) == 1 and len(line.get_ydata()) == 2]
    assert [3, 3] in flat


@pytest.mark.parametrize(("live", "shown"), [(None, 0.5), ((1.0, 0.0, 0.0), 100.0)])
def test_a_reaction_is_told_over_the_weight_and_a_multiplier_as_it_is(live: Any, shown: float) -> None:
    scene: Any = SimpleNamespace(live=live, weight=WEIGHT)
    outcome = MethodOutcome(100.0, "solved", 0.0, 1.0, 2.0)
    method = Method("made up", "once", PREDICTION, lambda: outcome)
    rung = cost._rung(scene, method, outcome, [1.0], [(0.0, 1.0)], 0.8 * shown)
    assert rung.value == shown and rung.uncertainty == 0.02 * shown and rung.error == pytest.approx(0.25)


def test_an_exact_value_is_the_reference_of_the_answer_that_it_is_of() -> None:
    expected = SimpleNamespace(
        kind="exact", multiplier=0.5, associated_multiplier=0.6, reaction_over_weight=0.7, associated_reaction_over_weight=0.4
    )
    for live, values in ((None, (0.4, 0.7)), ((1.0, 0.0, 0.0), (0.6, 0.5))):
        scene: Any = SimpleNamespace(expected=expected, live=live)
        assert cost._known(scene) == dict(zip((ASSOCIATED, PREDICTION), values, strict=True))
    expected.kind = "published"
    assert set(cost._known(scene).values()) == {None}
