"""`crosscheck solve` prints the bounds at once, and the prediction after it."""

import json
from pathlib import Path

import pytest
from paths import with_reports
from printed_tables import names_in

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, CANNOT_STAND, INTERRUPTED
from la_core.coulomb import PathProgress
from la_core.scene import shipped

LEAST = "363.297"  # N, of two pads


@pytest.mark.parametrize(("name", "main_row"), [("two_pads", "reaction"), ("ferris_tin_loi_1", "multiplier")])
def test_bounds_are_printed_before_the_prediction_begins_and_nothing_twice(
    name: str, main_row: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    printed: list[str] = []
    with_reports(monkeypatch, lambda report: printed.append(capsys.readouterr().out))
    assert main(["solve", name, "-q"]) == AGREE
    first, rest = printed[0], capsys.readouterr().out
    assert not any(printed[1:])
    assert {"status", main_row, f"{main_row} sharp", "seconds"} <= set(names_in(first))
    assert {f"Coulomb: {main_row}", "Coulomb: status", f"expected {main_row}"} <= set(names_in(rest))
    everything = names_in(first + rest)
    assert len(everything) == len(set(everything))
    assert not any("Coulomb" in row for row in names_in(first))


def test_both_tables_have_their_columns_in_one_place(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pads", "-q"]) == AGREE
    rows = [line for line in capsys.readouterr().out.splitlines() if LEAST in line]
    assert len(rows) == 4  # least reaction, prediction, and both ends of its interval
    assert len({line.index(LEAST) for line in rows}) == 1


def test_json_comes_alone_and_after_the_prediction(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    before: list[tuple[str, str]] = []
    with_reports(monkeypatch, lambda report: before.append(tuple(capsys.readouterr())))
    assert main(["solve", "two_pads", "--json"]) == AGREE
    assert json.loads(capsys.readouterr().out)["limit_analysis"]["coulomb"]["status"] == "solved"
    assert not any(out for out, _ in before)
    assert "bounds: R 363.3 to 2154 N, R/W 0.1683 to 0.9980" in before[0][1]


def test_bounds_of_attempts_at_an_accuracy_are_narrated_and_those_of_the_answer_are_printed_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "pads.toml"
    path.write_text(f"accuracy = 0.002\n{shipped.find('two_pads').read_text()}")
    assert main(["solve", str(path)]) == AGREE
    captured = capsys.readouterr()
    assert captured.err.count("limit analysis: bounds: R ") > 1
    assert names_in(captured.out).count("reaction") == 1 and "Coulomb: reaction" in names_in(captured.out)


def test_a_structure_that_cannot_stand_has_bounds_and_no_path(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "overhang.toml"
    text = shipped.find("two_pads").read_text().split("[expected]")[0].replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]")
    path.write_text(text.replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]"))
    assert main(["solve", str(path), "-q"]) == CANNOT_STAND
    printed = capsys.readouterr().out
    assert printed.startswith("overhang cannot stand.") and '"block" would fall' in printed.splitlines()[0]
    assert names_in(printed).index("blocks that fall") < names_in(printed).index("Coulomb: status") and printed.count("infeasible") == 2


def test_an_interruption_of_the_path_leaves_the_bounds_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def stop(report: PathProgress) -> None:
        raise KeyboardInterrupt

    with_reports(monkeypatch, stop)
    assert main(["solve", "two_pads", "--results", str(tmp_path / "out")]) == INTERRUPTED
    captured = capsys.readouterr()
    assert "reaction max" in captured.out and "Coulomb" not in captured.out
    assert captured.err.count("error: stopped") == 1 and "Traceback" not in captured.err
    assert not list(tmp_path.iterdir())
