"""`crosscheck solve` prints the bounds at once, then how far the prediction is, then the prediction; `--bounds` stops before it."""

import dataclasses
import io
import itertools
import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from paths import REPORTS, with_reports
from rich.console import Console

from comparison import progress
from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, CANNOT_STAND, INCONCLUSIVE, INTERRUPTED, USAGE
from comparison.progress import LINE_EVERY, Narration
from la_core.analysis import analyse, one_pass
from la_core.coulomb import PathProgress
from la_core.limit import Drive, Status
from la_core.scene import load, shipped, variant

LEAST, WEIGHT = "363.297", 2158.2  # N, of two pads


@pytest.fixture
def ticks(monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """Narration's clock, which advances by so many seconds whenever it is looked at."""

    def by(seconds: float) -> None:
        clock = itertools.count(step=seconds)
        monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: next(clock)))

    return by


@pytest.fixture
def nothing_predicted(monkeypatch: pytest.MonkeyPatch) -> None:
    def predicted(*arguments: object) -> None:
        raise AssertionError("a prediction was begun")

    monkeypatch.setattr(one_pass, "with_prediction", predicted)


def names_in(printed: str) -> list[str]:
    """Names of the rows of printed tables."""
    return [line.split("   ")[0].strip() for line in printed.splitlines() if line.startswith("  ") and line.strip()]


# --- order --------------------------------------------------------------------------------------------------------------------


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


# --- progress -----------------------------------------------------------------------------------------------------------------


def test_lines_tell_share_value_and_time_left_where_there_is_no_terminal(
    ticks: Callable[[float], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ticks(LINE_EVERY)
    with_reports(monkeypatch)
    assert main(["solve", "two_pads"]) == AGREE
    lines = [line for line in capsys.readouterr().err.splitlines() if ": path " in line]
    assert len(lines) == len(REPORTS)
    for line, report in zip(lines, REPORTS, strict=True):
        assert f"two_pads: path {report.path} of 2: {100 * report.share:.0f} %, R {report.value:g} N" in line
        assert f"R/W {report.value / WEIGHT:.4g}" in line
        assert ("min left" in line) == (report.share > 0.0)


def test_lines_are_few_where_there_is_no_terminal(
    ticks: Callable[[float], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ticks(LINE_EVERY / 100.0)
    with_reports(monkeypatch)
    assert main(["solve", "two_pads"]) == AGREE
    assert ": path " not in capsys.readouterr().err


def test_a_multiplier_has_no_weight(
    ticks: Callable[[float], None], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    ticks(LINE_EVERY)
    with_reports(monkeypatch, reports=(PathProgress(0.5, 0.5, 0.25, 0.01, 1, 1),))
    assert main(["solve", "ferris_tin_loi_1", "--json"]) == AGREE
    said = capsys.readouterr().err
    assert "bound: multiplier 0.6429" in said and "ferris_tin_loi_1: path: 50 %, multiplier 0.2500\n" in said


def test_a_run_narrates_bounds_and_path(
    ticks: Callable[[float], None],
    plain_figures: None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    ticks(LINE_EVERY)
    with_reports(monkeypatch)
    assert main(["run", "two_pads", "ferris_tin_loi_1", "--no-yade", "-o", str(tmp_path)]) == AGREE
    said = capsys.readouterr().err.splitlines()
    for name in ("two_pads", "ferris_tin_loi_1"):
        told = [line.removeprefix(f"{name}: ").split(":")[0] for line in said if line.startswith(f"{name}: ")]
        assert told == ["limit analysis", "limit analysis", *["path 1 of 2"] * 2, *["path 2 of 2"] * 2, "comparison"]


def shown(monkeypatch: pytest.MonkeyPatch, terminal: str) -> str:
    """What a terminal of this kind gets to see of two reports."""
    monkeypatch.setenv("TERM", terminal)
    screen = io.StringIO()
    with Narration(Console(file=screen, force_terminal=True, width=120)) as narration:
        narration.bounds(analyse(load("two_pads")))
        for report in REPORTS:
            narration.path(report)
            narration._bars.refresh()
    return screen.getvalue()


def test_a_terminal_shows_a_bar_and_a_dumb_one_does_not(monkeypatch: pytest.MonkeyPatch) -> None:
    screen = shown(monkeypatch, "xterm")
    assert "━" in screen and "path 2 of 2: 75 %, R 103 N, R/W 0.04772" in screen
    dumb = shown(monkeypatch, "dumb")
    assert "━" not in dumb and "path" not in dumb and "bounds: R 363.3 to 2154 N" in dumb


def test_the_time_left_follows_the_pace_and_starts_anew_where_the_share_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    times = iter([0.0, 30.0, 100.0, 160.0, 170.0])
    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=lambda: next(times)))
    pace = progress._Pace()
    assert pace.time_left(0.2) == ""
    assert pace.time_left(0.5) == ", about 0:50 min left"  # 0.3 in 30 s
    assert pace.time_left(0.1) == ""  # the travel turned out to be longer
    assert pace.time_left(0.4) == ", about 2:00 min left"  # 0.3 in 60 s
    assert pace.time_left(1.0) == ""


@pytest.mark.parametrize(
    ("status", "words"),
    [
        (Status.INFEASIBLE, "bounds: infeasible"),
        (Status.SOLVED, "bounds: R 363.3 to 2154 N, R/W 0.1683 to 0.9980"),
    ],
)
def test_bounds_in_words(status: Status, words: str) -> None:
    analysis = analyse(load("two_pads"))
    bounds = {drive: dataclasses.replace(bound, status=status) for drive, bound in analysis.bounds.items()}
    changed = dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, bounds=bounds))
    assert progress.bounds_words(changed) == words


def test_bounds_without_an_upper_one_in_words() -> None:
    analysis = analyse(load("two_pads"))
    bounds = dict(analysis.bounds)
    bounds[Drive.PUSHING] = dataclasses.replace(bounds[Drive.PUSHING], status=Status.UNBOUNDED, value=float("inf"))
    changed = dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, bounds=bounds))
    assert progress.bounds_words(changed) == "bounds: R at least 363.3 N, R/W at least 0.1683"


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


# --- bounds alone -------------------------------------------------------------------------------------------------------------


def summary(capsys: pytest.CaptureFixture[str], *command: str) -> dict[str, Any]:
    assert main(["solve", *command, "--json"]) == AGREE
    return dict(json.loads(capsys.readouterr().out))


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_end_without_a_prediction(capsys: pytest.CaptureFixture[str]) -> None:
    answer = summary(capsys, "two_pads", "--bounds")
    assert answer["limit_analysis"]["coulomb"] is None and answer["limit_analysis"]["path"] is None
    assert answer["limit_analysis"]["associated"]["reaction"] == pytest.approx(363.297, abs=1e-3)
    assert answer["effects"]["reasons"]["friction"] == "only the bounds were requested"
    assert main(["solve", "two_pads", "--bounds", "-q"]) == AGREE
    printed = capsys.readouterr().out
    assert names_in(printed).count("reaction") == 1 and "Coulomb" not in printed


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_are_printed_for_a_scene_with_an_accuracy(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pads.toml"
    path.write_text(f"accuracy = 0.002\n{shipped.find('two_pads').read_text()}")
    assert main(["solve", str(path), "--bounds"]) == AGREE
    captured = capsys.readouterr()
    assert names_in(captured.out).count("reaction") == 1 and "bounds:" not in captured.err


@pytest.mark.usefixtures("nothing_predicted")
@pytest.mark.parametrize(
    ("name", "judged"),
    [
        ("two_pads", ["expected greatest reaction"]),
        ("wall_low_friction", []),
        ("ferris_tin_loi_1", ["expected associated multiplier"]),
    ],
)
def test_bounds_alone_are_held_against_what_is_expected_of_bounds(name: str, judged: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", name, "--bounds", "-q"]) == AGREE
    assert [row for row in names_in(capsys.readouterr().out) if row.startswith("expected")] == judged


@pytest.mark.usefixtures("nothing_predicted")
def test_bounds_alone_of_a_law_of_bounds_are_held_against_its_expected_value(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pads.toml"
    path.write_text(shipped.find("two_pads").read_text() + '\n[effects]\nfriction = "associated"\n')
    assert main(["solve", str(path), "--bounds", "-q"]) == AGREE
    assert "expected reaction" in names_in(capsys.readouterr().out)


@pytest.mark.usefixtures("nothing_predicted")
@pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING])
def test_the_status_of_every_bound_decides_the_exit_code(drive: Drive, monkeypatch: pytest.MonkeyPatch) -> None:
    original = one_pass.solve_associated

    def inaccurate(assembly, asked, problem):
        solution = original(assembly, asked, problem)
        return dataclasses.replace(solution, status=Status.INACCURATE) if asked is drive else solution

    monkeypatch.setattr(one_pass, "solve_associated", inaccurate)
    assert main(["solve", "two_pads", "--bounds", "-q"]) == INCONCLUSIVE


def test_bounds_alone_and_a_path_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main(["solve", "two_pads", "--bounds", "--path"])
    assert stop.value.code == USAGE and "not allowed with" in capsys.readouterr().err


def test_bounds_alone_can_be_drawn(tmp_path: Path) -> None:
    assert main(["solve", "two_pads", "--bounds", "-q", "-o", str(tmp_path / "bounds.png")]) == AGREE
    assert (tmp_path / "bounds.png").read_bytes().startswith(b"\x89PNG")


def test_a_variant_without_a_prediction_prints_one_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = variant(load("two_pads"), {"expected": None, "effects.friction": "associated"})
    path = tmp_path / "bound.toml"
    path.write_text(scene.text)
    assert main(["solve", str(path), "-q"]) == AGREE
    assert capsys.readouterr().out.count("over W") == 1
