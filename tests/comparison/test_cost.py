"""The ladder of accuracy against time: the values of its rungs, the references of their errors, and the output for the user."""

import errno
import json
import math
import os
import threading
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import scenes
from faulty_runs import PATIENCE

from comparison.cli.commands import main
from comparison.cli.exit_codes import CANNOT_STAND, TOOL
from comparison.errors import YadeFailedError
from comparison.studies import cost, cost_yade, whole_studies
from comparison.studies.cost import CostPoint, CostStudy, measure_study, prediction_inset
from comparison.studies.cost_limit_analysis import ASSOCIATED, PREDICTION, Method, MethodOutcome, limit_analysis_methods
from comparison.studies.cost_yade import yade_methods
from comparison.studies.figure_of_cost import cost_figure
from comparison.yade import installation
from la_core import exchange
from la_core.analysis import analyse, write_case
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.model.contact_grid import with_grid
from la_core.scene import variant

pytestmark = pytest.mark.slow

REDUNDANT = 1e-6  # of the reaction: solver tolerance
ROUNDING = 0.05  # of an error: part that YADE adds to the error of rounded edges


@pytest.fixture(autouse=True)
def once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Time every rung once: its value does not depend on the number of repeats."""
    monkeypatch.setattr(cost, "REPEATS", 1)


def chosen(name: str, *families: str) -> CostStudy:
    scene = scenes.shipped(name)
    methods = [m for m in limit_analysis_methods(scene, prediction_inset(scene)) if m.family in (*families, "cone programme")]
    return measure_study(scene, methods, lambda number, words: None)


def errors(ladder: CostStudy, family: str, word: str = "") -> np.ndarray:
    return np.array([rung.error for rung in ladder.rungs if rung.family == family and word in rung.setting])


@pytest.mark.parametrize("plane", [True, False])
def test_points_between_the_corners_add_nothing_where_joints_do_not_twist(plane: bool) -> None:
    assembly = assemble(scenes.build(*scenes.wall(4, 3, 1.0), plane=plane, inset=0.001))
    finer = with_grid(assembly, 3)
    assert len(finer.points) == len(assembly.interfaces) * (3 if plane else 9)
    values = [solve_associated(one, Drive.YIELDING).value for one in (assembly, with_grid(assembly, 2), finer)]
    assert values[1:] == pytest.approx([values[0]] * 2, rel=REDUNDANT)


def test_an_answer_is_as_good_as_it_was_asked_to_be() -> None:
    assembly = assemble(scenes.shipped("wall_third"))
    asked = (1e-3, 1e-6, 1e-8)
    solutions = [solve_associated(assembly, Drive.YIELDING, accuracy=accuracy) for accuracy in asked]
    for accuracy, solution in zip(asked, solutions, strict=True):
        assert solution.status is Status.SOLVED
        assert max(solution.equilibrium_residual, solution.duality_gap, solution.mechanism_violation) <= accuracy
    assert solutions[0].iterations < solutions[-1].iterations


@pytest.mark.slow
def test_facets_bracket_the_cone_and_close_on_it() -> None:
    """The width of the bracket falls as one over the square of the number of facets."""
    ladder = chosen("corner_settling_end", "linearised")
    reference, _ = ladder.references[ASSOCIATED]
    for word, sign in (("inscribed", 1.0), ("circumscribed", -1.0)):
        values = np.array([rung.value for rung in ladder.rungs if rung.family == "linearised" and rung.setting.endswith(f" {word}")])
        assert (sign * (values - reference) >= -REDUNDANT * reference).all()
    widths = errors(ladder, "linearised", " inscribed") + errors(ladder, "linearised", "circumscribed")
    assert widths[0] > 100.0 * widths[-1]


def test_errors_are_held_against_the_exact_value_where_there_is_one() -> None:
    exact, computed = chosen("two_pads", "Coulomb", "inset"), chosen("wall_tall", "Coulomb")
    assert exact.references[PREDICTION] == (pytest.approx(1.0 / 6.0, abs=1e-5), "the exact value, for sharp edges")
    assert (
        "Coulomb prediction on paths and steps ten times finer, at the inset that both methods share, 1 mm"
        in computed.references[PREDICTION][1]
    )
    assert (errors(exact, "Coulomb") <= 1e-4).all()
    sizes, found = [5.0, 2.0, 1.0, 0.5, 0.2, 0.1], errors(exact, "inset")
    assert found / found[0] == pytest.approx(np.array(sizes) / sizes[0], rel=ROUNDING)  # the inset shortens a lever arm


def test_the_front_is_what_nothing_beats_in_time_and_error() -> None:
    scene = scenes.shipped("two_pads")
    exact = scene.expected.reaction_over_weight * scene.weight  # type: ignore[union-attr,operator]

    def made(total: float, error: float, status: str = "solved") -> Method:
        return Method("made up", f"{total} {error}", PREDICTION, lambda: MethodOutcome(exact * (1.0 + error), status, 0.0, total))

    cone = Method("cone programme", "made up", ASSOCIATED, lambda: MethodOutcome(exact, "solved", 0.0, 1.0))
    methods = [cone, made(1.0, 0.1), made(2.0, 0.2), made(3.0, 0.01), made(4.0, 0.01), made(0.5, 0.5), made(0.1, 0.0, "failed")]
    found = measure_study(scene, methods, lambda number, words: None).rungs[1:]
    assert [one.pareto for one in found] == [True, False, True, False, True, False]
    assert math.isnan(found[-1].error)
    assert all(isinstance(one, CostPoint) and one.total == pytest.approx(one.solve, rel=1e-6) for one in found)


def test_rungs_that_may_run_side_by_side_and_keep_their_order() -> None:
    """Two rungs that wait for each other end only if both run at the same time."""
    both = threading.Barrier(2)
    order: list[str] = []

    def outcome(value: float) -> MethodOutcome:
        return MethodOutcome(value, "plateau", 0.0, 1.0)

    def meeting(value: float) -> MethodOutcome:
        both.wait(PATIENCE)
        return outcome(value)

    cone = Method("cone programme", "made up", ASSOCIATED, lambda: MethodOutcome(1.0, "solved", 0.0, 1.0))
    methods = [Method("YADE", "first", PREDICTION, partial(meeting, 1.0), beside=True), cone]
    methods += [
        Method("YADE", "second", PREDICTION, partial(meeting, 2.0), beside=True),
        Method("Coulomb", "own", PREDICTION, partial(outcome, 3.0)),
    ]
    found = measure_study(scenes.shipped("two_pads"), methods, lambda number, words: order.append(f"{number} {words}"), workers=2)
    assert [rung.setting for rung in found.rungs] == ["made up", "own", "first", "second"]
    assert sorted(order)[:2] == ["0 cone programme, made up", "1 Coulomb, own"] and len(order) == 4


def test_a_rung_that_fails_ends_those_beside_it() -> None:
    stopped, begun = threading.Event(), threading.Event()

    def fails() -> MethodOutcome:
        assert begun.wait(PATIENCE)
        raise YadeFailedError("YADE ended with exit code 1")

    def goes_on() -> MethodOutcome:
        begun.set()
        assert stopped.wait(PATIENCE)
        raise InterruptedError("another rung has ended the study")

    methods = [Method("YADE", "long", PREDICTION, goes_on, beside=True), Method("YADE", "broken", PREDICTION, fails, beside=True)]
    with pytest.raises(YadeFailedError, match="exit code 1"):
        measure_study(scenes.shipped("two_pads"), methods, lambda number, words: None, workers=2, stop=stopped.set)


def test_what_a_rung_states_of_itself_is_drawn_and_printed_beside_its_error() -> None:
    scene = scenes.shipped("two_pads")
    exact = scene.expected.reaction_over_weight * scene.weight  # type: ignore[union-attr,operator]
    outcome = MethodOutcome(1.01 * exact, "solved", 0.0, 2.0, 0.02 * exact)
    silent = MethodOutcome(exact, "solved", 0.0, 1.0)
    methods = [Method("cone programme", "made up", ASSOCIATED, lambda: silent), Method("Coulomb", "made up", PREDICTION, lambda: outcome)]
    study = measure_study(scene, methods, lambda number, words: None)
    figure = cost_figure(study)
    drawn = [dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True)) for axes in figure.axes]
    assert [("stated uncertainty" in labels) for labels in drawn] == [False, True]
    assert drawn[1]["stated uncertainty"].get_ydata() == pytest.approx([0.02 / 1.01])
    (value,) = cost.cost_table(study, PREDICTION).columns[3].cells
    assert value == "0.168 ± 0.003"
    figure.canvas.draw()
    assert not any(axes.get_legend().get_window_extent().overlaps(axes.get_window_extent()) for axes in figure.axes)  # no mark is hidden


@pytest.mark.yade
@pytest.mark.parametrize("effects", [{}, {"rotation": "finite"}])
def test_yade_climbs_with_the_settings_of_a_run(effects: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A rung has every setting of a run, also those that follow from the path of limit analysis, as with finite rotations."""

    def ended(*_: object) -> None:
        raise InterruptedError

    scene = variant(scenes.shipped("wall_third"), {f"effects.{name}": value for name, value in effects.items()})
    monkeypatch.setattr(cost_yade, "run_yade", ended)
    with pytest.raises(InterruptedError):
        cost_yade.run_once(scene, scene.inset, dict(scene.yade), installation.find_yade(), tmp_path / "rung", lambda report: None)
    write_case(tmp_path / "run.h5", analyse(scene), "rung")
    files = tmp_path / "rung" / "case.h5", tmp_path / "run.h5"
    rung, run = (exchange.read(path, [field for field in exchange.CASE_FIELDS if field.path == "scene/settings"]) for path in files)
    assert rung == run and rung["scene/settings"]


@pytest.mark.yade
@pytest.mark.slow
def test_yade_climbs_by_its_inset(tmp_path: Path) -> None:
    """The errors of YADE are those of rounded edges in limit analysis: YADE adds nothing."""
    scene = scenes.shipped("two_pads")
    wanted = ("derived settings", "inset x 0.2", "settlement speed x 8")
    methods = [m for m in yade_methods(scene, installation.find_yade(), tmp_path, lambda report: None) if m.setting in wanted]
    cone = [m for m in limit_analysis_methods(scene, 0.0) if m.family == "cone programme"]
    found = {one.setting: one for one in measure_study(scene, [*cone, *methods], lambda number, words: None).rungs if one.family == "YADE"}
    assert found["derived settings"].error == pytest.approx(0.01, rel=ROUNDING)
    assert found["inset x 0.2"].error == pytest.approx(0.002, rel=ROUNDING)
    assert all(one.status == "plateau" and one.uncertainty > 0.0 for one in found.values())


def test_the_command_writes_figure_and_numbers_and_prints_both_tables(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["cost", "two_pads", "--no-yade", "-o", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "associated; errors are relative to" in printed and "prediction; errors are relative to" in printed
    stored = json.loads((tmp_path / "two_pads-cost.json").read_text())
    assert {one["family"] for one in stored["rungs"]} >= {"cone programme", "linearised", "inset", "contact points", "Coulomb", "path"}
    assert stored["provenance"] and (tmp_path / "two_pads-cost.png").stat().st_size > 10_000
    assert main(["cost", "two_pads", "two_pads", "--no-yade", "-o", str(tmp_path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["ladders"][0]["scene"] == "two_pads"


def test_a_setting_limits_the_wall_time_of_every_run_of_yade(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene, limits = scenes.shipped("two_pads"), list[float]()

    def ended(yade: object, folder: Path, inputs: str, limit: float, progress: object) -> None:
        limits.append(limit)
        raise InterruptedError(errno.EINTR, os.strerror(errno.EINTR), str(folder))  # without a file, main would discard pytest's stdout

    monkeypatch.setattr(cost_yade, "run_yade", ended)
    monkeypatch.setattr(whole_studies, "find_yade", lambda: None)
    monkeypatch.setattr(whole_studies, "limit_analysis_methods", lambda *_: [])
    for variable in ("0.2", ""):
        monkeypatch.setenv("CROSSCHECK_TIME_LIMIT", variable)
        main(["cost", "two_pads", "-q", "-o", str(tmp_path)])
    with pytest.raises(InterruptedError):
        cost_yade.run_once(scene, scene.inset, {"time_limit": 60.0}, None, tmp_path, lambda report: None)  # type: ignore[arg-type]
    assert limits == [0.2, cost_yade.TIME_LIMIT, 60.0]


def test_a_folder_that_cannot_be_written_is_told_before_the_measurement(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.run_folder.os.access", lambda path, mode: mode != os.W_OK)
    monkeypatch.setattr("comparison.cli.study_verbs.cost.study_cost", lambda *_: pytest.fail("it was measured"))
    assert main(["cost", "two_pads", "-q", "-o", str(tmp_path / "out")]) == TOOL
    assert f"{tmp_path / 'out'}: Permission denied; choose a folder" in capsys.readouterr().err


def test_a_reference_of_zero_leaves_no_relative_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The block stands without the support. A reaction of round-off is no reference for errors."""
    toml = scenes.text(*scenes.base(0.5, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (0.8, 1.0, 0.3)), inset=0.001)
    (tmp_path / "idle.toml").write_text(toml)
    assert main(["cost", str(tmp_path / "idle.toml"), "--no-yade", "-o", str(tmp_path), "--json"]) == 0
    (stored,) = json.loads(capsys.readouterr().out)["ladders"]
    assert all(rung["error"] is None and not rung["pareto"] for rung in stored["rungs"])
    assert any(rung["value"] == pytest.approx(0.0, abs=1e-8) for rung in stored["rungs"])
    assert (tmp_path / "idle-cost.png").exists()


def test_a_structure_that_cannot_stand_has_no_ladder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    falls = tmp_path / "falls.toml"
    falls.write_text(scenes.text(scenes.arch(11, 0.05), settlement=(1.0, 0.0, 0.0)))
    assert main(["cost", str(falls), "-o", str(tmp_path)]) == CANNOT_STAND
    assert "no reference value" in capsys.readouterr().err
