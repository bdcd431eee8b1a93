"""Runs, campaigns, studies, exports and animations are made, read, shown and refused from Python."""

import copy
import dataclasses
import math
import os
import pickle
import subprocess
import sys
import tomllib
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from figure_scenes import synthetic_run
from PIL import Image

import comparison
import la_core
from comparison.errors import FolderInUseError
from comparison.figures import report_figures
from comparison.run_folder import alone_in
from comparison.studies import whole_studies
from comparison.studies.cost_limit_analysis import limit_analysis_methods
from comparison.verdict import Check, Checks
from comparison.yade import Results
from la_core.errors import seconds_or_none
from la_core.exchange.checksummed_file import ExchangeError

ELASTIC = 1e-3  # of the weight: joints are elastic in the prediction


WRONG_ARGUMENTS = {
    "a campaign": (lambda result: comparison.run_campaign({"sweep": []}), "campaign = .*: must be a path"),
    "a campaign's folder": (lambda result: comparison.run_campaign("seed_paper", 5), "folder = 5: must be a path"),
    "a folder to read": (lambda result: comparison.read_campaign(5), "folder = 5: must be a path"),
    "a campaign to compare": (lambda result: comparison.compare("one", 5), "after = 5: must be a path"),
    "a folder of meshes": (lambda result: la_core.build({}, folder=None), "folder: must be a path"),
    "a folder of results": (lambda result: comparison.run("two_pads", None), "folder: must be a path"),
    "a file for results": (lambda result: comparison.run("two_pads", "file"), "folder = 'file': a file, file, stands where"),
    "a file within a path": (lambda result: comparison.run("two_pads", "file/in"), "folder = 'file/in': a file, file, stands where"),
    "results to read": (lambda result: comparison.read(None), "folder: must be a path"),
    "a file for an export": (lambda result: comparison.export(result, "file"), "folder = 'file': a file, file, stands where"),
    "a path of an animation": (lambda result: comparison.animate(result, None), "path: must be a path"),
    "no folder of an animation": (lambda result: comparison.animate(result, "nodir/x.gif"), "nodir/x.gif: its folder nodir does not"),
    "no folder of a figure": (lambda result: result.plot().save("nodir/x.png"), "nodir/x.png: its folder nodir does not exist"),
    "a second attempt": (lambda result: comparison.run("two_pads", try_harder="no"), "try_harder = 'no': must be True or False"),
    "its time": (lambda result: comparison.run("two_pads", try_harder_limit=0), "try_harder_limit = 0: must be a positive number"),
    "another result": (lambda result: result.report(5), "others = 'int': must be results"),
}


@pytest.fixture(scope="module")
def any_result(tmp_path_factory: pytest.TempPathFactory) -> comparison.Result:
    return comparison.run("two_pads", tmp_path_factory.mktemp("results"), yade=False, quiet=True)


@pytest.mark.parametrize(("call", "said"), WRONG_ARGUMENTS.values(), ids=WRONG_ARGUMENTS)
def test_a_wrong_argument_is_named_with_its_rule(
    call: Callable[[comparison.Result], object], said: str, any_result: comparison.Result, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("file").write_text("mine")
    with pytest.raises(la_core.SceneError, match=f"^{said}"):
        call(any_result)
    assert [path.name for path in tmp_path.iterdir()] == ["file"] and Path("file").read_text() == "mine"


@pytest.mark.parametrize("name", ["", ".", "..", "a/b"])
def test_a_scene_whose_name_cannot_name_a_folder_is_not_run(name: str, tmp_path: Path) -> None:
    nameless = la_core.build(tomllib.loads(la_core.load("two_pads").text), name)
    with pytest.raises(la_core.SceneError, match=r"cannot name a folder of results; .* in Python choose another `name`"):
        comparison.run(nameless, tmp_path / "out", yade=False, quiet=True)
    assert not (tmp_path / "out").exists()


def test_a_folder_in_use_is_told_with_the_argument_that_chooses_another(tmp_path: Path) -> None:
    (tmp_path / "two_pads").mkdir()
    with alone_in(tmp_path / "two_pads"), pytest.raises(FolderInUseError, match=r"process or thread; .* in Python `folder`"):
        comparison.run("two_pads", tmp_path, yade=False, quiet=True)


@pytest.mark.parametrize("judged_before", [True, False])
def test_results_in_a_folder_that_cannot_be_written_are_read(
    judged_before: bool, tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    result = comparison.run("two_pads", tmp_path, yade=False, quiet=True)
    (result.folder / ".lock").unlink()
    if not judged_before:  # as if another version of the program had judged
        (result.folder / "comparison.json").write_text("{}")
    before = {path.name: path.read_bytes() for path in result.folder.iterdir()}
    monkeypatch.setattr("os.access", lambda path, mode: mode != os.W_OK)
    again = comparison.read(result.folder)
    assert (again.verdict, again.predicted) == (result.verdict, result.predicted)
    assert {path.name: path.read_bytes() for path in result.folder.iterdir()} == before


@pytest.mark.yade
def test_a_result_is_run_read_drawn_and_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = comparison.run("two_pads", tmp_path, quiet=True)
    assert capsys.readouterr().err == ""
    assert result.verdict is comparison.Verdict.AGREE and result.reason == ""
    assert result.yade is not None
    assert result.predicted == result.answer.coulomb
    assert result.yade.reaction == pytest.approx(result.predicted, rel=ELASTIC)
    assert {check.verdict for check in result.checks} == {comparison.Verdict.AGREE, comparison.Verdict.EXPECTED_MET}
    again = comparison.read(tmp_path / "two_pads")
    assert (str(again), again.checks) == (str(result), result.checks)
    for name in ("assembly", "dissipation"):
        result.plot(name).save(tmp_path / f"{name}.svg")
        assert (tmp_path / f"{name}.svg").read_text(encoding="utf-8").count("<path") > 5
    untitled = comparison.Picture(report_figures(Results(result.answer.analysis, result.yade))["mechanisms"]())
    assert untitled._repr_png_() == (result.folder / "mechanisms.png").read_bytes() != result.plot()._repr_png_()
    assert "data:image/png;base64," in result._repr_html_()
    with pytest.raises(la_core.SceneError, match='did you mean "mechanisms"'):
        result.plot("mechanism")
    with pytest.raises(la_core.SceneError, match='did you mean "reaction"'):
        result.yade.settling("reactions")
    assert result.report().is_file()
    with pytest.raises(ValueError, match="one folder"):
        result.report(dataclasses.replace(result, folder=tmp_path / "elsewhere" / "two_pads"))
    assert comparison.run("two_pads", tmp_path, yade=False, quiet=True).yade is None  # in spite of the stored run


@pytest.mark.parametrize(
    ("expected", "asked", "folder"),
    [
        (0.2, {}, "pads"),
        (0.2, {"try_harder": True}, "pads_harder"),
        (0.2, {"try_harder_limit": 600}, "pads_harder"),
        (0.2, {"try_harder_limit": 1e-6}, "pads"),
        (1.0 / 6.0, {"try_harder": True}, "pads"),
    ],
)
def test_a_second_attempt_is_made_from_python_where_it_is_asked_for_and_called_for(
    expected: float, asked: dict[str, Any], folder: str, tmp_path: Path, plain_figures: None
) -> None:
    scene = la_core.variant("two_pads", {"expected.reaction_over_weight": expected}, "pads")
    result = comparison.run(scene, tmp_path, yade=False, quiet=True, **asked)
    assert result.folder == tmp_path / folder and result.scene.name == folder
    assert result.scene.effort == ("high" if folder == "pads_harder" else "normal")
    first = result.summary["first_verdict"]
    assert (first["scene"], first["verdict"]) == ("pads", "unexpected") if folder == "pads_harder" else first is None
    assert comparison.read(tmp_path / "pads").verdict is comparison.Verdict("unexpected" if expected == 0.2 else "expected")


@pytest.mark.slow
def test_a_notebook_shows_the_mechanisms_of_the_result_and_not_those_of_a_later_one_in_its_folder(tmp_path: Path) -> None:
    first = comparison.run(la_core.variant("two_pads", {"joint.friction": 0.5}, "pads"), tmp_path, yade=False, quiet=True)
    shown = first._repr_html_()
    other = comparison.run(la_core.variant("trilith", {"joint.friction": 0.5}, "pads"), tmp_path, yade=False, quiet=True)
    assert first.folder == other.folder and first._repr_html_() == shown != other._repr_html_()


def test_what_a_result_hands_out_changes_no_result(any_result: comparison.Result) -> None:
    before = any_result.verdict
    any_result.summary.update(verdict="disagree")
    any_result.summary["checks"].clear()
    assert any_result.verdict == before and any_result.checks and any_result.summary["verdict"] == before


SAME_PART = {"made": dataclasses.replace, "copied": copy.deepcopy, "unpickled": lambda part: pickle.loads(pickle.dumps(part))}


@pytest.mark.parametrize("same", SAME_PART.values(), ids=SAME_PART)
def test_a_record_of_yade_cannot_be_changed(same: Callable[[Any], Any]) -> None:
    run = synthetic_run(la_core.solve("two_pads").analysis)
    for array in (same(run.record).reaction, same(run.poses).displacement, same(run).extra_contacts):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
    with pytest.raises(TypeError):
        same(run).settings["speed"] = 1.0


def test_records_of_yade_are_told_apart() -> None:
    analysis = la_core.solve("two_pads").analysis
    one, other = synthetic_run(analysis), synthetic_run(analysis)
    for part, alike in ((one, other), (one.record, other.record), (one.poses, other.poses)):
        assert part != alike and len({part, alike}) == 2


def test_the_folder_of_a_whole_run_is_told_apart_from_that_of_one_scene(any_result: comparison.Result) -> None:
    with pytest.raises(ExchangeError, match="holds no results of `crosscheck run`; name the folder of one of its scenes: two_pads"):
        comparison.read(any_result.folder.parent)


def test_a_mistyped_folder_of_results_is_told_with_those_beside_it(any_result: comparison.Result) -> None:
    with pytest.raises(ExchangeError, match='holds no results of `crosscheck run`; did you mean "two_pads"'):
        comparison.read(any_result.folder.with_name("two_pds"))


def test_a_folder_without_results_is_told_and_left_as_it_is(tmp_path: Path) -> None:
    of_another = tmp_path / "letter.1.part"
    of_another.touch()
    for folder in (tmp_path, tmp_path / "nothere"):
        with pytest.raises(ExchangeError, match="holds no results"):
            comparison.read(folder)
    assert list(tmp_path.iterdir()) == [of_another]


@pytest.mark.parametrize("seconds", [60, np.float32(60.0), np.longdouble(60.0), Fraction(120, 2)])
def test_a_time_limit_is_a_number_of_any_kind(seconds: float) -> None:
    assert seconds_or_none("time_limit", seconds) == 60.0


@pytest.mark.parametrize("seconds", [-1, 0.0, math.nan, math.inf, 10**400, pytest.param(10**5000, id="thousands of digits")])
def test_a_time_limit_that_is_none_is_refused_before_anything_runs(seconds: float, tmp_path: Path) -> None:
    with pytest.raises(la_core.SceneError, match=r"time_limit = .*: must be a positive number of seconds"):
        comparison.run("two_pads", tmp_path / "results", yade=False, time_limit=seconds, quiet=True)
    assert list(tmp_path.iterdir()) == []


def test_a_figure_in_a_format_that_is_none_is_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(la_core.SceneError, match=r"x\.jpg: the file name of a figure must end in \.png, \.svg or \.pdf"):
        comparison.draw(la_core.load("two_pads")).save(tmp_path / "x.jpg")
    with pytest.raises(la_core.SceneError, match="run = 'str': must be YADE's record"):
        comparison.draw(la_core.solve("two_pads", bounds_only=True), run="results/two_pads/run.h5")  # type: ignore[arg-type]
    assert list(tmp_path.iterdir()) == []


def test_a_record_of_another_scene_is_not_drawn_beside_an_answer() -> None:
    other = synthetic_run(la_core.solve("two_pads").analysis)
    with pytest.raises(la_core.SceneError, match="run: must be the record of the answer's scene; take the answer"):
        comparison.draw(la_core.solve("trilith"), "mechanisms", other)
    for assembly in (la_core.solve("trilith", bounds_only=True).analysis.assembly, None, la_core.load("two_pads")):
        with pytest.raises(la_core.SceneError, match=r"^assembly: must be that of the run, with as many blocks"):
            other.plateau_wrenches(assembly)  # type: ignore[arg-type]


def test_a_folder_is_no_file_of_a_figure_or_an_animation_and_no_scene(tmp_path: Path) -> None:
    places = [tmp_path / "x.png", tmp_path / "x.gif"]
    for place in places:
        place.mkdir()
    answer = la_core.solve("two_pads", bounds_only=True)
    with pytest.raises(la_core.SceneError, match=r"x\.png: is a folder"):
        answer.plot().save(places[0])
    with pytest.raises(la_core.SceneError, match=r"x\.gif: is a folder"):
        comparison.animate(answer, places[1], quiet=True)
    with pytest.raises(la_core.SceneError, match="is a folder, not a scene file"):
        la_core.load(tmp_path)
    with pytest.raises(la_core.SceneError, match=r'^"": names no scene; give the path'):
        la_core.load("")


@pytest.mark.parametrize("name", ["..", "report.html", "a/b"])
def test_a_scene_whose_name_is_no_folders_is_not_run(name: str, tmp_path: Path) -> None:
    scene = dataclasses.replace(la_core.load("two_pads"), name=name)
    with pytest.raises(la_core.SceneError, match="cannot name a folder"):
        comparison.run(scene, tmp_path / "results", yade=False, quiet=True)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_a_campaign_is_run_read_compared_and_shown_from_python(tmp_path: Path) -> None:
    frictions = 'title = "Friction"\nyade = false\n[[sweep]]\nscene = "pads"\nvary = { "joint.friction" = [0.4, 0.6] }\n'
    (tmp_path / "friction.toml").write_text(frictions, encoding="utf-8")
    (tmp_path / "pads.toml").write_text(la_core.load("two_pads").text, encoding="utf-8")
    made = comparison.run_campaign(tmp_path / "friction.toml", tmp_path / "out", workers=1, quiet=True)
    expected = la_core.solve(la_core.load("two_pads")).coulomb
    assert [row["coulomb"] for row in made.rows] == pytest.approx([expected] * 2, rel=1e-6)  # the pads do not slide
    assert made.title in repr(made) and "pads_friction=0.4" in repr(made) and len(repr(made).splitlines()) == 5
    stored = comparison.read_campaign(tmp_path / "out")
    assert stored.rows == made.rows and list(made.to_dataframe()["joint.friction"]) == [0.4, 0.6]
    (tmp_path / "friction.toml").write_text(frictions.replace("0.6", "0.5"), encoding="utf-8")
    other = comparison.run_campaign(tmp_path / "friction.toml", tmp_path / "other", workers=1, quiet=True)
    found = comparison.compare(made, tmp_path / "other")
    assert found.changed and (found.only_before, found.only_after) == (["pads_friction=0.6"], ["pads_friction=0.5"])
    unchanged = comparison.compare(other, other)
    assert not unchanged.changed and found.summary in repr(found)
    assert list(unchanged.to_dataframe().columns) == ["case", "what", "before", "after", "difference", "allowed"]
    again = comparison.run_campaign(tmp_path / "friction.toml", tmp_path / "out", workers=1, quiet=True)
    found = comparison.compare(made, again)  # their common folder has only the second table
    assert (found.only_before, found.only_after) == (["pads_friction=0.6"], ["pads_friction=0.5"])
    with pytest.raises(la_core.SceneError, match="workers"):
        comparison.run_campaign(tmp_path / "friction.toml", workers=0)


@pytest.mark.slow
def test_a_script_that_begins_a_campaign_in_processes_of_its_own_is_told_where_to_call_it(tmp_path: Path) -> None:
    """A worker process of the script's own pool loads the script."""
    begin = 'import multiprocessing as mp\nimport comparison\ncomparison.run_campaign("friction.toml", yade=False)\n'
    script = tmp_path / "script.py"
    script.write_text(f'{begin}if __name__ == "__main__":\n    mp.get_context("spawn").Process(target=print).start()\n')
    (tmp_path / "friction.toml").write_text('[[sweep]]\nscene = "two_pads"\nvary = { "joint.friction" = [0.6] }\n', encoding="utf-8")
    ended = subprocess.run([sys.executable, script], cwd=tmp_path, capture_output=True, text=True, check=True)
    assert "run_campaign: is called while a worker process loads the script; call it below `if __name__" in ended.stderr


@pytest.mark.slow_after_first
@pytest.mark.parametrize("call", [["script.py"], ["-m", "script"], ["-"]])
def test_a_script_runs_a_campaign_wherever_it_comes_from(tmp_path: Path, call: list[str]) -> None:
    """Each worker once ran the script again, or looked for a file named <stdin>."""
    (tmp_path / "pads.toml").write_text(
        'title = "Pads"\nyade = false\n[[sweep]]\nscene = "two_pads"\nvary = { "joint.friction" = [0.4] }\n'
    )
    script = (
        'import comparison\nspec, own = __spec__, globals().get("__file__")\n'
        'print(comparison.run_campaign("pads.toml", "out", workers=1, quiet=True).rows[0]["state"])\n'
        'assert __spec__ is spec and globals().get("__file__") == own\n'
    )
    (tmp_path / "script.py").write_text(script)
    environment = {**os.environ, "PYTHONPATH": str(Path(comparison.__file__).parents[1])}
    given = script if call == ["-"] else ""
    ended = subprocess.run([sys.executable, *call], input=given, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (ended.stdout.strip(), ended.stderr) == ("done", "")


def test_results_are_exported_from_python(tmp_path: Path) -> None:
    files = comparison.export(la_core.solve(la_core.load("two_pads")), tmp_path / "paraview")
    assert files == [tmp_path / "paraview" / "structure.pvd"] and all(path.is_file() for path in files)


def test_an_answer_is_animated_from_python(tmp_path: Path) -> None:
    answer = la_core.solve(la_core.load("two_pads"), bounds_only=True)
    path = comparison.animate(answer, tmp_path / "pads.gif", fps=1, quiet=True)
    with Image.open(path) as movie:
        assert getattr(movie, "n_frames", 1) > 2
    for name, fps, rule in (("pads.avi", 1, "must end in .gif or .mp4"), ("pads.gif", 0, "fps = 0: must be a whole number from 1 to 50")):
        with pytest.raises(la_core.SceneError, match=rule):
            comparison.animate(answer, tmp_path / name, fps, quiet=True)
    assert list(tmp_path.iterdir()) == [path]


def test_the_studies_are_run_shown_and_drawn_from_python(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("comparison.studies.cost.REPEATS", 1)
    few = ("cone programme", "associated", "classic iteration")
    monkeypatch.setattr(
        whole_studies, "limit_analysis_methods", lambda *given: [m for m in limit_analysis_methods(*given) if m.family in few]
    )
    pads = la_core.load("two_pads")
    costs = comparison.cost(pads, yade=False, quiet=True)
    assert {row["family"] for row in costs.rows} == set(few)
    assert {row["target"] for row in costs.rows} == set(costs.references) == {"associated", "prediction"}
    assert [row["value"] for row in costs.rows] == pytest.approx([1.0 / 6.0] * len(costs.rows), rel=ELASTIC)
    assert len(repr(costs).splitlines()) == len(costs.rows) + 3 and "cone programme" in costs._repr_html_()
    runs = comparison.sensitivity("two_pads", quiet=True)
    assert len(runs.rows) == 25 and {row["status"] for row in runs.rows} == {"solved"}
    assert runs.rows[0]["value"] == pytest.approx(la_core.solve(pads).coulomb, rel=ELASTIC)
    assert len(repr(runs).splitlines()) == len(runs.rows) + len(runs.references) + 3
    for result in (costs, runs):
        assert isinstance(result.plot(), comparison.Picture) and len(result.to_dataframe()) == len(result.rows)
    assert capsys.readouterr().err == ""
    with pytest.raises(la_core.SceneError, match="did you mean"):
        comparison.sensitivity("two_padz")


def test_the_prediction_of_sharp_edges_is_that_of_the_inset_of_both_methods(tmp_path: Path) -> None:
    sharp = la_core.variant("two_pads", {"joint.inset": 0.0}, "sharp")
    result = comparison.run(sharp, tmp_path, yade=False, quiet=True)
    shared = result.summary["limit_analysis"]["coulomb"]["shared_inset"]
    assert result.predicted == shared["reaction"] > result.answer.coulomb
    assert math.isnan(dataclasses.replace(result, _summary={"limit_analysis": {"associated": {}, "coulomb": None}}).predicted)


def test_wrong_arguments_are_refused_in_words(tmp_path: Path) -> None:
    pads = la_core.load("two_pads")
    answer = la_core.solve(pads, bounds_only=True)
    tables = tomllib.loads(pads.text)
    for call, words in (
        (lambda: comparison.run(answer, tmp_path), "scene: must be a scene, .* of the type Answer"),
        (lambda: comparison.run(pads, tmp_path, time_limit="10"), "time_limit = '10': must be a positive number of seconds"),
        (lambda: comparison.run(la_core.variant(pads, {"joint.friction": 0.3}, "n" * 300), tmp_path), "longer than the 240 bytes"),
        (
            lambda: comparison.run_campaign("friction_and_inset", tmp_path, workers=1.5),
            "workers = 1.5: must be a whole number from 1 to 1000",
        ),
        (lambda: comparison.run_campaign("seed_paper", tmp_path, workers=1001), "workers = 1001: must be a whole number from 1 to 1000"),
        (lambda: comparison.run_campaign("seed_paper", tmp_path, yade="no"), "yade = 'no': must be True or False"),
        (lambda: comparison.run_campaign("seed_paper", tmp_path, quiet=1), "quiet = 1: must be True or False"),
        (lambda: comparison.run(pads, tmp_path, yade="no"), "yade = 'no': must be True or False"),
        (lambda: comparison.run(pads, tmp_path, yade=False, quiet="yes"), "quiet = 'yes': must be True or False"),
        (lambda: comparison.cost(pads, yade=1), "yade = 1: must be True or False"),
        (lambda: la_core.solve(pads, path="yes"), "path = 'yes': must be True or False"),
        (lambda: la_core.solve(pads, bounds_only=None), "bounds_only: must be True or False"),
        (lambda: comparison.run_campaign("seed_paper", tmp_path, time_limit=math.nan), "time_limit = nan: must be a positive"),
        (lambda: comparison.cost(pads, workers=0), "workers = 0: must be a whole number"),
        (lambda: comparison.animate(answer, "a.gif", fps=2.5), "fps = 2.5: must be a whole number from 1 to 50"),
        (lambda: comparison.animate(pads, "a.gif"), "what = 'Scene': must be an answer"),
        (lambda: comparison.export(pads, tmp_path), "what = 'Scene': must be an answer"),
        (lambda: answer.plot(3), 'figure "3": unknown name'),
        (lambda: answer.plot(["reaction"]), 'unknown name; did you mean "reaction"'),
        (lambda: la_core.variant(pads, [("joint.friction", 0.3)]), "changes = .* must be a table"),
        (lambda: la_core.build(tables, name=3), "name = 3: must be a text"),
        (lambda: la_core.variant(pads, {"joint.friction": 0.3}, name=3), "name = 3: must be a text"),
        (lambda: la_core.build(None), "tables: must be a table"),
    ):
        with pytest.raises(la_core.SceneError, match=words):
            call()
    assert list(tmp_path.iterdir()) == []


def test_a_table_of_checks_shows_the_range_of_a_range_check() -> None:
    within = Check("in its range", comparison.Verdict.AGREE, -219.0, 0.7, 0.0, 3.6, "N", range=(-219.0, 219.0))
    below = Check("below", comparison.Verdict.AGREE, 0.5, 0.4, 0.0, 0.01, "", range=(None, 0.5))
    told = str(Checks([within, below]))
    assert "−219 to 219" in told and "at most 0.50000" in told
