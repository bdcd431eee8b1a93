"""The Python interface: its names are stable, its scenes are those of files, its answers those of the command line."""

import ast
import dataclasses
import doctest
import importlib
import inspect
import math
import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from types import FunctionType

import api_page
import numpy as np
import pytest
from PIL import Image

import comparison
import la_core
from comparison.cli.commands import main
from comparison.figures import report_figures
from comparison.studies import whole_studies
from comparison.studies.cost_limit_analysis import limit_analysis_methods
from comparison.workflow import one_scene
from comparison.yade import Results
from la_core.analysis.case_file import scene_digest
from la_core.exchange.checksummed_file import ExchangeError
from la_core.scene import shipped
from la_core.scene.loads.point_forces import PointForces
from la_core.scene.scene import Scene

ROOT = Path(__file__).parent.parent
ROUND_OFF = 1e-6  # of the weight: residuals of a solved cone programme
ELASTIC = 1e-3  # of the weight: joints are elastic in the prediction
both_packages = pytest.mark.parametrize("package", [la_core, comparison], ids=lambda package: package.__name__)


@both_packages
def test_stable_names_are_those_that_type_checkers_read(package) -> None:
    stub = ast.parse((ROOT / package.__name__ / "__init__.pyi").read_text(encoding="utf-8"))
    homes = {alias.name: node.module for node in stub.body if isinstance(node, ast.ImportFrom) for alias in node.names}
    assert package.__all__ == sorted(homes)
    for name, home in homes.items():
        assert getattr(package, name) is getattr(importlib.import_module(home), name)
        assert name in dir(package)
    (listed,) = (ast.literal_eval(node.value) for node in stub.body if isinstance(node, ast.Assign))
    assert listed == package.__all__


@both_packages
def test_help_begins_with_the_stable_names(package) -> None:
    assert set(package.__all__) <= set(re.findall(r"`(\w+)`", package.__doc__))


@both_packages
def test_a_name_that_is_none_is_told_as_python_tells_it(package) -> None:
    with pytest.raises(AttributeError, match=f"module '{package.__name__}' has no attribute 'reticulate'"):
        package.reticulate  # noqa: B018


def test_the_page_of_names_is_that_of_the_docstrings() -> None:
    assert api_page.PAGE.read_text(encoding="utf-8") == api_page.page()


def described(thing: object, heading: str) -> dict[str, str]:
    """Meaning of every entry of a docstring's section, by name."""
    return {entry.name.lstrip("*"): entry.meaning for entry in api_page.entries(api_page.sections(thing).get(heading, ""))}


def assert_call_is_described(function: Callable[..., object]) -> None:
    """A docstring lists every parameter with its type and meaning, in order, and what the function returns."""
    parameters = [name for name in inspect.signature(function).parameters if name != "self"]
    meanings = described(function, "Parameters")
    assert list(meanings) == parameters
    assert all(entry.kind and entry.meaning for entry in api_page.entries(api_page.sections(function).get("Parameters", "")))
    assert any(described(function, "Returns").values())


@both_packages
def test_every_parameter_and_attribute_of_the_names_is_described(package) -> None:
    for thing in (getattr(package, name) for name in package.__all__):
        assert api_page.sections(thing)[""], thing
        if not inspect.isclass(thing):
            assert_call_is_described(thing)
            continue
        meanings = described(thing, "Attributes")
        assert list(meanings) == api_page.fields_of(thing)
        assert all(meanings.values())
        assert all(inspect.getdoc(member) for member in api_page.members_of(thing, property).values())
        for method in api_page.members_of(thing, FunctionType).values():
            assert_call_is_described(method)
    assert list(described(la_core.SceneError, "Parameters")) == list(inspect.signature(la_core.SceneError).parameters)


def test_sections_of_a_docstring_are_read_as_numpydoc_has_them() -> None:
    def area(width: float, *others: float) -> float:
        """Return an area.

        Parameters
        ----------
        width : float
            Width of the
            strip, m.
        *others : float
            More widths, m.

        Returns
        -------
        float
            Area, m2.
        """
        return width + sum(others)

    assert api_page.sections(area)[""] == "Return an area."
    (width, others) = api_page.entries(api_page.sections(area)["Parameters"])
    assert width == ("width", "float", "Width of the strip, m.")
    assert others == ("*others", "float", "More widths, m.")
    assert_call_is_described(area)
    with pytest.raises(AssertionError):
        assert_call_is_described(test_sections_of_a_docstring_are_read_as_numpydoc_has_them)


@both_packages
def test_examples_of_the_names_are_true(package, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(one_scene, "figures_of", lambda *results: {})  # the report's, which nobody looks at here
    tried = 0
    for name in package.__all__:
        for example in doctest.DocTestFinder(recurse=False).find(getattr(package, name), name, module=False, globs={}):
            result = doctest.DocTestRunner().run(example)
            assert result.failed == 0
            tried += result.attempted
    assert tried


@pytest.mark.yade
def test_the_code_of_the_readme_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(one_scene, "figures_of", lambda *results: {})  # the report's, which nobody looks at here
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(code, {})
    predicted, found, verdict = capsys.readouterr().out.split()
    weight = la_core.load("two_blocks").weight
    assert [float(predicted), float(found)] == pytest.approx([0.5 * weight] * 2, abs=ELASTIC * weight)
    assert verdict == "agree"
    assert (tmp_path / "mechanisms.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("name", [name for name in la_core.names() if name not in shipped.LONG])
def test_the_tables_of_a_file_build_its_scene(name: str) -> None:
    filed = la_core.load(name)
    built = la_core.build(tomllib.loads(filed.text), name, filed.path.parent)
    for field in dataclasses.fields(Scene):
        if field.name not in ("text", "path", "blocks", "meshes"):
            ours, theirs = getattr(built, field.name), getattr(filed, field.name)
            np.testing.assert_equal(*((vars(ours), vars(theirs)) if isinstance(ours, PointForces) else (ours, theirs)))
    np.testing.assert_array_equal(built.blocks.vertices, filed.blocks.vertices)
    np.testing.assert_array_equal(built.blocks.mass, filed.blocks.mass)
    assert built.blocks.names == filed.blocks.names


def test_a_scene_built_of_arrays_is_one_built_of_lists() -> None:
    tables = tomllib.loads(la_core.load("two_pads").text)
    arrays = tables | {"gravity": np.array(tables["gravity"]), "joint": {"friction": np.float64(0.6)}}
    arrays["block"] = tuple(block | {"box": {k: tuple(v) for k, v in block["box"].items()}} for block in tables["block"])
    assert scene_digest(la_core.build(arrays)) == scene_digest(la_core.build(tables))


@pytest.mark.parametrize(
    ("key", "value"),
    [("joint.friction", -0.1), ("joint.fricton", 0.6), ("stone.density", "heavy"), ("wall[0].courses", 2.5), ("settlement", None)],
)
def test_a_mistake_in_code_is_told_as_in_a_file(key: str, value: object, write_scene: Callable[..., Path]) -> None:
    wall = la_core.load("wall_third")
    with pytest.raises(la_core.SceneError) as in_code:
        la_core.variant(wall, {key: value}, "wall")
    tables = tomllib.loads(wall.text)
    words = {"joint.friction": "friction = -0.1", "joint.fricton": "friction = 0.6\nfricton = 0.6"}
    texts = {
        "stone.density": wall.text.replace("density = 2000.0", 'density = "heavy"'),
        "wall[0].courses": re.sub(r"courses +=.*", "courses = 2.5", wall.text),
        "settlement": wall.text.replace("[settlement]\ndirection = [0.0, 0.0, -1.0]", ""),
    }
    text = texts.get(key) or wall.text.replace("friction = 0.6", words[key])
    assert tables != tomllib.loads(text)
    with pytest.raises(la_core.SceneError) as in_file:
        la_core.load(write_scene(text, "wall"))
    told = str(in_file.value).split("wall.toml")[1]
    assert str(in_code.value).removeprefix("variant of wall_third") == re.sub(r": line \d+: ", ": ", told)  # only a file has lines


@pytest.mark.parametrize(
    ("key", "rule"),
    [
        ("joint friction", "must be a dotted path"),
        ("joint.friction.static", "is a value, not a table"),
        ("wall.courses", r"select one of its entries: wall\[0\].courses"),
        ("block[7].density", "has 2 entries"),
        ("joint[0]", "is not an array"),
        ("arch[0].radius", "has no arch"),
    ],
)
def test_a_key_that_leads_nowhere_is_named(key: str, rule: str) -> None:
    with pytest.raises(la_core.SceneError, match=rule) as told:
        la_core.variant(la_core.load("wall_third"), {key: 1.0})
    assert key in str(told.value)


def test_what_toml_cannot_say_is_refused_by_its_key() -> None:
    with pytest.raises(la_core.SceneError, match=r"joint\.friction: a NoneType has no place"):
        la_core.build({"joint": {"friction": None}})


def test_a_variant_keeps_what_its_changes_leave_true() -> None:
    pads = la_core.load("two_pads")
    assert la_core.variant(pads, {"title": "same"}).expected == pads.expected
    assert la_core.variant(pads, {"joint.friction": pads.friction, "yade.speed": 1e-3}).expected == pads.expected
    assert la_core.variant(pads, {"joint.friction": 0.4}).expected is None
    kept = la_core.variant(pads, {"joint.friction": 0.4, "expected.reaction_over_weight": 1 / 6})
    assert kept.expected is not None and kept.expected.reaction_over_weight == 1 / 6
    assert pads.friction == 0.6
    assert la_core.variant(la_core.load("rubble_wall"), {"title": "same"}).meshes


def test_a_variant_is_named_and_titled_by_its_changes() -> None:
    pads = la_core.load("two_pads")
    assert la_core.variant(pads, {"title": "Mine"}).title == "Mine"
    assert la_core.variant(pads, {"joint.friction": 0.4}).title == f"{pads.title}: joint.friction = 0.4"
    assert la_core.variant(pads, {"joint.friction": 0.4}, "own").name == "own"
    assert "/" not in la_core.variant(pads, {"title": "../../a/b"}).name
    assert len(la_core.variant(pads, {"source": 1000 * "x"}).name) < 255  # bytes of a file's name


@pytest.mark.parametrize("friction", [0.3, 0.9])
def test_two_blocks_carry_their_closed_forms_under_any_friction(friction: float) -> None:
    """Right block on the settling pad: W_b without dilatancy, W_b / (1 + mu^2) by the associated law."""
    scene = la_core.variant(la_core.load("two_blocks"), {"joint.friction": friction})
    answer = la_core.solve(scene)
    assert answer.least_sharp / scene.weight == pytest.approx(0.5 / (1 + friction**2), abs=ROUND_OFF)
    assert answer.coulomb / scene.weight == pytest.approx(0.5, abs=ELASTIC)
    assert answer.least <= answer.interval[0] + ROUND_OFF * scene.weight


@pytest.mark.parametrize("name", ["trilith", "wall_low_friction", "ferris_tin_loi_1"])
def test_an_answer_prints_the_table_of_the_command(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    main(["solve", name, "--long"])
    shown = [line.split() for line in capsys.readouterr().out.splitlines() if line.strip() and "seconds" not in line and "─" not in line]
    own = [line.split() for line in str(la_core.solve(la_core.load(name))).splitlines() if "seconds" not in line and "─" not in line]
    assert len(own) > 8
    assert own == [line for line in shown if line[0] not in ("expected", "prediction")]  # checks, and headings of the second table


def test_an_answer_of_a_live_load_has_a_multiplier_and_no_reaction() -> None:
    answer = la_core.solve(la_core.load("ferris_tin_loi_1"))
    assert answer.coulomb <= answer.multiplier
    assert np.isnan([answer.least, answer.greatest, answer.least_sharp]).all()


def test_an_answer_cannot_be_changed() -> None:
    answer = la_core.solve(la_core.load("two_pads"))
    with pytest.raises(dataclasses.FrozenInstanceError):
        answer.scene = la_core.load("trilith")  # type: ignore[misc]
    with pytest.raises(AttributeError):
        answer.least = 0.0  # type: ignore[misc]


def test_what_a_notebook_shows_is_escaped() -> None:
    scene = la_core.variant(la_core.load("two_pads"), {"title": "<script>alert(1)</script>"})
    for shown in (scene._repr_html_(), la_core.solve(scene)._repr_html_()):
        assert "<script" not in shown and "&lt;script" in shown


@pytest.mark.yade
def test_a_result_is_run_read_drawn_and_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    result = comparison.run("two_pads", tmp_path, quiet=True)
    assert capsys.readouterr().err == ""
    assert result.verdict is comparison.Verdict.AGREE and result.reason == ""
    assert result.yade is not None
    assert result.yade.reaction == pytest.approx(result.answer.coulomb, rel=ELASTIC)
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
    assert result.report().is_file()
    with pytest.raises(ValueError, match="one folder"):
        result.report(dataclasses.replace(result, folder=tmp_path / "elsewhere" / "two_pads"))
    assert comparison.run("two_pads", tmp_path, yade=False, quiet=True).yade is None  # whatever lies there from before


def test_a_folder_without_results_is_told_and_left_as_it_is(tmp_path: Path) -> None:
    of_another = tmp_path / "letter.1.part"
    of_another.touch()
    for folder in (tmp_path, tmp_path / "nothere"):
        with pytest.raises(ExchangeError, match="holds no results"):
            comparison.read(folder)
    assert list(tmp_path.iterdir()) == [of_another]


@pytest.mark.parametrize("seconds", [-1, 0.0, math.nan, math.inf])
def test_a_time_limit_that_is_none_is_refused_before_anything_runs(seconds: float, tmp_path: Path) -> None:
    with pytest.raises(la_core.SceneError, match=r"time_limit = .*: must be a positive number of seconds"):
        comparison.run("two_pads", tmp_path / "results", yade=False, time_limit=seconds, quiet=True)
    assert list(tmp_path.iterdir()) == []


def test_a_figure_in_a_format_that_is_none_is_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(la_core.SceneError, match=r"x\.jpg: the file name of a figure must end in \.png, \.svg or \.pdf"):
        comparison.draw(la_core.load("two_pads")).save(tmp_path / "x.jpg")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["..", "report.html", "a/b"])
def test_a_scene_whose_name_is_no_folders_is_not_run(name: str, tmp_path: Path) -> None:
    scene = dataclasses.replace(la_core.load("two_pads"), name=name)
    with pytest.raises(la_core.SceneError, match="cannot name a folder"):
        comparison.run(scene, tmp_path / "results", yade=False, quiet=True)
    assert list(tmp_path.iterdir()) == []


def test_loading_the_packages_draws_nothing() -> None:
    program = "import comparison, la_core, sys; print(any(name in sys.modules for name in ('matplotlib', 'numpy', 'pydantic')))"
    import subprocess

    said = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    assert said.strip() == "False"


def test_a_change_that_changes_nothing_keeps_what_the_scene_expects() -> None:
    """An inset given as what it is by default."""
    pads = la_core.load("two_pads")
    assert la_core.variant(pads, {"joint.inset": pads.inset}).expected == pads.expected
    assert la_core.variant(pads, {"joint.inset": 2.0 * pads.inset}).expected is None


def test_answers_are_told_apart_and_a_key_is_a_text() -> None:
    pads = la_core.load("two_pads")
    assert la_core.solve(pads) != la_core.solve(pads)
    with pytest.raises(la_core.SceneError, match="a key must be a text"):
        la_core.variant(pads, {3: 1})  # type: ignore[dict-item]
    with pytest.raises(la_core.SceneError, match="greater than or equal to 0"):
        la_core.variant(pads, {"yade.speed": -1.0})


def test_an_answer_hands_out_mechanism_forces_joints_and_path() -> None:
    answer = la_core.solve(la_core.load("two_pads"))
    blocks = answer.scene.blocks
    assert answer.mechanism.shape == (len(blocks), 6) and answer.forces.shape == (4, 3)
    (support,) = np.flatnonzero(blocks.role == 2)
    assert answer.mechanism[support] == pytest.approx([0.0, 0.0, -1.0, 0.0, 0.0, 0.0])
    assert answer.forces.sum(axis=0) == pytest.approx([0.0, 0.0, answer.scene.weight], abs=ROUND_OFF * answer.scene.weight)
    fixed, settling = answer.joints
    assert (fixed["block_a"], fixed["block_b"], fixed["state"]) == ("fixed pad", "block", "opening")
    assert settling["normal"] == pytest.approx(answer.coulomb, rel=ELASTIC) and settling["x"] == pytest.approx(0.999, abs=2e-3)
    settlement, value = la_core.solve(la_core.load("two_blocks")).path
    assert len(settlement) == len(value) > 10 and value[-1] == pytest.approx(la_core.solve(la_core.load("two_blocks")).coulomb, rel=1e-2)


def test_tables_of_pandas_are_made_where_it_is_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    answer = la_core.solve(la_core.load("two_pads"), bounds_only=True)
    pytest.importorskip("pandas")
    table = answer.to_dataframe()
    assert list(table.columns) == list(answer.joints[0]) and len(table) == 2
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(la_core.SceneError, match='install the extra "pandas"'):
        answer.to_dataframe()


def test_what_holds_arrays_shows_itself_in_one_line() -> None:
    answer = la_core.solve(la_core.load("two_pads"))
    assert repr(answer.analysis).startswith("<LimitAnalysis of two_pads: solved, bound 363.297, prediction 363.297 N")
    assert "\n" not in repr(answer.analysis) + repr(answer.scene.blocks) and len(repr(answer.scene.blocks)) < 200


def test_scenes_and_answers_draw_themselves() -> None:
    scene = la_core.load("two_pads")
    answer = la_core.solve(scene)
    assert isinstance(scene.draw(), comparison.Picture) and isinstance(answer.plot("reaction"), comparison.Picture)
    with pytest.raises(la_core.SceneError, match='did you mean "forces"'):
        answer.plot("force")


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
    assert not comparison.compare(other, other).changed and found.summary in repr(found)
    with pytest.raises(la_core.SceneError, match="workers"):
        comparison.run_campaign(tmp_path / "friction.toml", workers=0)


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
