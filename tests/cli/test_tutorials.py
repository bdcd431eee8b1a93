"""The walk-throughs for students run, their answers are right, and their notebooks are valid."""

import json
from pathlib import Path

import nbformat
import pytest

from comparison.cli.commands import main
from comparison.cli.help_verbs import tutorial

pytestmark = pytest.mark.slow

CHEAPEST = "pads"  # its runs in YADE take seconds
every_tutorial = pytest.mark.parametrize("name", tutorial.NAMES)


@pytest.fixture(autouse=True)
def no_report_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("comparison.figures.report_figures", lambda *results: {})  # the walk-throughs draw their own


def test_every_script_is_listed_in_the_order_of_reading(capsys: pytest.CaptureFixture[str]) -> None:
    assert sorted(tutorial.NAMES) == sorted(path.stem for path in tutorial.SCRIPTS.glob("*.py"))
    assert main(["tutorial"]) == 0
    lines = [line.split(maxsplit=2) for line in capsys.readouterr().out.splitlines()]
    assert [(name, number) for name, number, _ in lines] == [(name, f"{k}.") for k, name in enumerate(tutorial.NAMES, 1)]


@pytest.mark.yade
@pytest.mark.parametrize("name", [name if name == CHEAPEST else pytest.param(name, marks=pytest.mark.slow) for name in tutorial.NAMES])
def test_a_walk_through_runs_and_its_answer_is_checked(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Each script compares its numbers with hand calculations by itself. The test sees that it runs to its end, with figures."""
    assert main(["tutorial", name, "-o", str(tmp_path / "out"), "--json"]) == 0
    said = capsys.readouterr()
    told = json.loads(said.out)
    assert said.err == ""
    *_, question, check = told["cells"]
    assert "## Question" in question["text"] and "**Answer.**" in question["text"]
    assert "assert" in check["code"] and check["output"]
    figures = [Path(figure) for cell in told["cells"] for figure in cell["figures"]]
    assert figures and all(figure.read_bytes().startswith(b"\x89PNG") for figure in figures)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"results", *(figure.name for figure in figures)}


@every_tutorial
def test_a_notebook_has_the_scripts_cells_and_the_formats_form(name: str) -> None:
    made = nbformat.from_dict(tutorial.notebook(name))
    nbformat.validate(made)
    script = (tutorial.SCRIPTS / f"{name}.py").read_text(encoding="utf-8")
    code = [line for line in script.splitlines() if not line.startswith("#") and line.strip()]
    text = [
        line[2:].replace("**Answer.** ", "")
        for line in script.splitlines()
        if line.startswith("# ") and not line.startswith("# %%") and line[2:].strip()
    ]

    def lines(kind: str) -> list[str]:
        sources = ["".join(cell.source) for cell in made.cells if cell.cell_type == kind]
        return [
            line for source in sources for line in source.splitlines() if line.strip() and not line.startswith(("<details>", "</details>"))
        ]

    assert (lines("code"), lines("markdown")) == (code, text)


@every_tutorial
def test_the_answer_is_folded_in_a_notebook(name: str) -> None:
    (question,) = (cell for cell in tutorial.notebook(name)["cells"] if any("## Question" in line for line in cell["source"]))
    text = "".join(question["source"])
    assert text.count("<details><summary>Answer</summary>") == text.count("</details>") == 1 and text.endswith("</details>")
    assert text.index("## Question") < text.index("<details>")


@every_tutorial
def test_a_cell_knows_its_line(name: str) -> None:
    script = (tutorial.SCRIPTS / f"{name}.py").read_text(encoding="utf-8").splitlines()
    for cell in tutorial.cells(name):
        assert script[cell.line - 1].removeprefix("# " if cell.is_text else "") == cell.source.splitlines()[0]


def test_notebooks_are_written_for_one_or_for_all(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tutorial", "arch", "--notebook", "-o", str(tmp_path / "one")]) == 0
    assert main(["tutorial", "--notebook", "-o", str(tmp_path / "all"), "--json"]) == 0
    first, rest = capsys.readouterr().out.split("\n", 1)
    assert first == str(tmp_path / "one" / "arch.ipynb")
    assert json.loads(rest)["files"] == [str(tmp_path / "all" / f"{name}.ipynb") for name in tutorial.NAMES]
    assert (tmp_path / "one" / "arch.ipynb").read_bytes() == (tmp_path / "all" / "arch.ipynb").read_bytes()
    nbformat.validate(nbformat.read(tmp_path / "one" / "arch.ipynb", as_version=4))


def test_a_notebook_that_a_student_worked_in_is_not_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["tutorial", "--notebook", "-o", str(tmp_path)]
    assert main(command) == main(command) == 0  # unchanged notebooks are written again
    (tmp_path / "arch.ipynb").write_text("an answer", encoding="utf-8")
    (tmp_path / "pads.ipynb").unlink()
    assert main(command) == 2
    assert "arch.ipynb: exists with other content and is not replaced" in " ".join(capsys.readouterr().err.split())
    assert (tmp_path / "arch.ipynb").read_text(encoding="utf-8") == "an answer"
    assert not (tmp_path / "pads.ipynb").exists()  # all of them, or none


@pytest.mark.yade
def test_a_wrong_number_in_a_walk_through_is_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    script = (tutorial.SCRIPTS / "pads.py").read_text(encoding="utf-8")
    changed = script.replace("least, greatest = (0.5 - 0.4)", "least, greatest = (0.5 - 0.39)")
    assert changed != script
    (tmp_path / "pads.py").write_text(changed, encoding="utf-8")
    monkeypatch.setattr(tutorial, "SCRIPTS", tmp_path)
    with pytest.raises(AssertionError) as found:
        list(tutorial.run_cells("pads", tmp_path / "out"))
    place = found.traceback[-1]
    assert (Path(place.path).name, changed.splitlines()[place.lineno]) == (
        "pads.py",
        "assert abs(answer.least_sharp / scene.weight - least) < 1e-6",
    )


def test_a_name_that_is_none_is_answered_with_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["tutorial", "arches"]) == 2
    assert 'did you mean "arch"?' in capsys.readouterr().err


def test_without_yade_nothing_is_begun(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setenv("CROSSCHECK_YADE", str(tmp_path / "nowhere"))
    assert main(["tutorial", "pads", "-o", str(tmp_path / "out")]) == 3
    said = capsys.readouterr()
    assert said.out == "" and "CROSSCHECK_YADE" in said.err
    assert not (tmp_path / "out").exists()
