"""An analysis reports its bounds before its prediction, and ends with the bounds where only they are requested."""

import numpy as np
import pytest
import scenes

import la_core
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.settings import AnalysisSettings
from la_core.analysis.stage import analyse
from la_core.coulomb.followed_path import PathProgress
from la_core.errors import SceneError
from la_core.limit import Drive, Status


class Heard:
    """A listener that keeps every report."""

    def __init__(self) -> None:
        self.found: list[LimitAnalysis | PathProgress] = []

    def bounds(self, analysis: LimitAnalysis) -> None:
        self.found.append(analysis)

    def path(self, report: PathProgress) -> None:
        self.found.append(report)


@pytest.mark.parametrize("name", ["two_pads", "two_blocks", "ferris_tin_loi_1"])
def test_bounds_are_told_before_the_prediction_and_are_those_of_the_answer(name: str) -> None:
    heard = Heard()
    analysis = analyse(scenes.shipped(name), listener=heard)
    early, *reports = heard.found
    shares = [report.share for report in reports if isinstance(report, PathProgress)]
    assert len(shares) == len(reports) and (len(shares) > 0) == (analysis.assembly.effects.friction == "coulomb")
    assert all(0.0 < share <= 1.0 for share in shares)
    assert isinstance(early, LimitAnalysis) and early.coulomb is None and early.sharp.coulomb is None and early.path is None
    for before, after in ((early.at_inset, analysis.at_inset), (early.sharp, analysis.sharp)):
        assert {drive: bound.value for drive, bound in before.bounds.items()} == {
            drive: bound.value for drive, bound in after.bounds.items()
        }
    assert analysis.coulomb is not None


@pytest.mark.parametrize("name", ["wall_third", "wall_low_friction"])
def test_paths_that_are_followed_on_are_half_of_the_work_from_the_start(name: str) -> None:
    """Two paths with finite rotations continue the first two."""
    heard = Heard()
    coulomb = analyse(scenes.shipped(name), listener=heard).coulomb
    assert coulomb is not None and np.isfinite(coulomb.released)
    reports = [report for report in heard.found if isinstance(report, PathProgress)]
    last = {report.path: report.share for report in reports}
    assert list(last) == [1, 2, 3, 4] and list(last.values()) == pytest.approx([0.25, 0.5, 0.75, 1.0])
    assert min(report.share for report in reports if report.path > 2) >= 0.5


@pytest.mark.parametrize("name", ["wall_third", "ferris_tin_loi_1"])
def test_bounds_do_not_depend_on_the_number_of_threads(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    found = []
    for threads in ("1", "2"):
        monkeypatch.setenv("OMP_NUM_THREADS", threads)
        analysis = analyse(scenes.shipped(name), AnalysisSettings(bounds_only=True))
        found.append([(drive, bound.value) for answers in (analysis.at_inset, analysis.sharp) for drive, bound in answers.bounds.items()])
    assert len(found[0]) == 2 * len(analysis.bounds) and found[0] == found[1]


def test_every_attempt_at_an_accuracy_tells_its_own_bounds() -> None:
    heard = Heard()
    scene = la_core.variant(scenes.shipped("two_pads"), {"accuracy": 0.002})
    analysis = analyse(scene, listener=heard)
    assert analysis.accuracy is not None and len(analysis.accuracy.limit_analysis) == len(heard.found) > 1
    insets = [early.assembly.inset for early in heard.found if isinstance(early, LimitAnalysis)]
    assert insets[0] > insets[-1] == analysis.assembly.inset


def test_an_answer_of_python_takes_a_listener() -> None:
    heard = Heard()
    answer = la_core.solve(scenes.shipped("two_pads"), listener=heard)
    (early,) = heard.found
    assert isinstance(early, LimitAnalysis) and early.bounds[Drive.YIELDING].value == answer.least


@pytest.fixture
def nothing_predicted(monkeypatch: pytest.MonkeyPatch) -> None:
    """A prediction raises an error as soon as it begins."""

    def predicted(*arguments: object) -> None:
        raise AssertionError("a prediction was begun")

    monkeypatch.setattr("la_core.analysis.one_pass.with_prediction", predicted)
    monkeypatch.setattr("la_core.analysis.one_pass.follow_path", predicted)


@pytest.mark.usefixtures("nothing_predicted")
@pytest.mark.parametrize("name", ["two_pads", "wall_low_friction", "ferris_tin_loi_1", "trilith"])
def test_bounds_alone_are_those_of_a_whole_analysis(name: str) -> None:
    heard, scene = Heard(), scenes.shipped(name)
    answer = la_core.solve(scene, bounds_only=True, listener=heard)
    assert np.isnan([answer.coulomb, answer.coulomb_sharp, *answer.interval]).all()
    assert answer.values["coulomb"] is None and answer.values["path"] is None
    effects = answer.analysis.assembly.effects
    assert (effects.friction, effects.elasticity, effects.reach) == ("associated", "none", False)
    assert effects.reasons["friction"] == "only the bounds were requested"
    assert answer.analysis.sharp.assembly.effects == answer.analysis.whole.effects == effects
    assert heard.found == [answer.analysis]


def test_bounds_alone_have_the_values_that_come_with_a_prediction() -> None:
    whole, alone = la_core.solve(scenes.shipped("two_blocks")), la_core.solve(scenes.shipped("two_blocks"), bounds_only=True)
    for name in ("least", "greatest", "least_sharp", "greatest_sharp", "status"):
        assert getattr(alone, name) == getattr(whole, name)


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_leave_out_a_requested_path_and_accuracy() -> None:
    scene = la_core.variant(scenes.shipped("two_blocks"), {"accuracy": 0.001, "path": {"increments": 5}})
    analysis = analyse(scene, AnalysisSettings(bounds_only=True))
    assert analysis.path is None and analysis.accuracy is None
    assert analysis.assembly.inset == scene.inset


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_keep_a_law_that_is_one_of_bounds() -> None:
    scene = la_core.variant(scenes.shipped("two_pads"), {"effects.friction": "none-slides"})
    effects = analyse(scene, AnalysisSettings(bounds_only=True)).assembly.effects
    assert effects.friction == "none-slides" and effects.reasons["friction"] == "requested in the scene"


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_of_what_cannot_stand_say_so() -> None:
    overhang = scenes.build(*scenes.base(0.2, 0.4), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), model="auto")
    answer = la_core.solve(overhang, bounds_only=True)
    assert answer.status is Status.INFEASIBLE and answer.values["associated"]["falling"] == ["block"]


def test_a_path_is_no_bound() -> None:
    with pytest.raises(SceneError, match=r"bounds_only = true: a path is no bound; leave out"):
        la_core.solve(scenes.shipped("two_pads"), path=True, bounds_only=True)
