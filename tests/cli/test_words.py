"""The command line gives help without arguments, guesses misspelt words, fits the terminal, and takes either folder of results."""

import io
import itertools
import json
import re
import shutil
from collections.abc import Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from rich.console import Console
from rich.table import Table

from comparison import progress
from comparison.cli import tables
from comparison.cli.arguments import parser
from comparison.cli.commands import main
from comparison.cli.context import PIPE_WIDTH, _results_console
from comparison.cli.guessing_parser import parse
from comparison.cli.layout import say, show_table
from comparison.progress import CampaignNarration, Narration
from comparison.report import pdf
from la_core.scene import load_scene, shipped


def refusal(capsys: pytest.CaptureFixture[str], *words: str) -> str:
    with pytest.raises(SystemExit) as stop:
        main(words)
    assert stop.value.code == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.startswith("error: ") and captured.err.count("\n") == 1
    return captured.err


def test_alone_it_shows_its_commands_and_the_tutorials(capsys: pytest.CaptureFixture[str]) -> None:
    for words in ((), ("-q",)):
        assert main(words) == 0
        printed = capsys.readouterr().out
        assert "crosscheck tutorial" in printed and "wall limit" not in printed and "solve" in printed


def test_a_misspelt_command_or_option_is_guessed(capsys: pytest.CaptureFixture[str]) -> None:
    assert 'did you mean "solve"?' in refusal(capsys, "slove", "two_pads")
    assert 'did you mean "--no-yade"?' in refusal(capsys, "run", "two_pads", "--noyade")
    assert "valid options: --help, --quiet, --json, --output" in refusal(
        capsys, "run", "two_pads", "--results", "x"
    )  # no other option is similar
    assert 'did you mean "bash"?' in refusal(capsys, "completion", "bahs")
    assert "one argument too many" in refusal(capsys, "solve", "two_pads", "two_blocks")


def test_options_of_every_command_may_stand_before_it(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["-q", "--json", "solve", "two_pads", "--bounds"]) == 0
    captured = capsys.readouterr()
    assert json.loads(captured.out)["scene"] == "two_pads" and captured.err == ""


@pytest.mark.parametrize(
    ("line", "names"),
    [
        ("run a --no-yade -o out b", ["a", "b"]),
        ("run a b --workers 2 c --long d", ["a", "b", "c", "d"]),
        ("run --no-y a -q b", ["a", "b"]),
        ("run a --no-yade -- -b c", ["a", "-b", "c"]),
        ("-q cost a --no-yade b", ["a", "b"]),
        ("report a --pdf b", [Path("a"), Path("b")]),
    ],
)
def test_scenes_and_folders_may_stand_on_both_sides_of_an_option(line: str, names: list[Any]) -> None:
    options = parse(parser(), line.split())
    assert options is not None and vars(options).get("scenes", vars(options).get("folders")) == names


def test_a_wrong_option_between_scenes_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    assert '"--noyade": unknown option' in refusal(capsys, "run", "two_pads", "--long", "two_blocks", "--noyade", "slab")


@pytest.mark.parametrize(("columns", "width"), [("80", 80), ("10", 40), ("", PIPE_WIDTH), ("wide", PIPE_WIDTH)])
def test_columns_is_obeyed_by_a_pipe_too(columns: str, width: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", columns)
    monkeypatch.setattr("sys.stdout", io.StringIO())
    assert _results_console().width == width


def shown(table: Table, can_go: tuple[str, ...], whole: bool) -> list[str]:
    console = Console(file=io.StringIO(), width=80, soft_wrap=True)
    show_table(console, table, can_go, whole)
    return str(console.file.getvalue()).splitlines()  # type: ignore[attr-defined]


def test_sentences_break_between_words_on_a_terminal_and_stay_whole_in_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    text = f"{'no plateau was reached ' * 8}\n  {'take a longer travel ' * 8}"
    monkeypatch.delenv("COLUMNS", raising=False)
    pipe = Console(file=io.StringIO(), width=60, soft_wrap=True)
    say(pipe, text)
    assert pipe.file.getvalue() == f"{text}\n"  # type: ignore[attr-defined]
    terminal = Console(file=io.StringIO(), width=60, soft_wrap=True, force_terminal=True)
    say(terminal, text)
    lines = terminal.file.getvalue().splitlines()  # type: ignore[attr-defined]
    assert all(len(line) <= 60 for line in lines) and [word for line in lines for word in line.split()] == text.split()
    assert lines[1].startswith("  ") and not lines[0].startswith(" ")


def test_a_narrow_table_loses_the_columns_that_may_go_and_names_them() -> None:
    def table() -> Table:
        made = tables.new_table("name", "value", "seconds", "remarks", title="costs [of a scene]")
        made.add_row("x" * 40, "1.5", "12", "y" * 30)
        return made

    narrow, whole, wide = shown(table(), ("remarks", "seconds"), False), shown(table(), ("remarks",), True), shown(table(), (), False)
    assert narrow[0] == "costs [of a scene] (--long: also remarks)"
    assert all(len(line) <= 80 for line in narrow + wide) and any("12" in line for line in narrow)
    assert any("x" * 40 in line and "y" * 30 in line for line in whole)


def test_numbers_are_never_broken_however_narrow_a_terminal_is() -> None:
    made = tables.new_table("scene", "Coulomb", "verdict", "seconds")
    made.add_row("wall", "0.01558 ± 0.00005", "inconclusive", "12")
    console = Console(file=io.StringIO(), width=30, soft_wrap=True)
    show_table(console, made, ("seconds",))
    lines = str(console.file.getvalue()).splitlines()  # type: ignore[attr-defined]
    assert any("0.01558 ± 0.00005   inconclusive" in line for line in lines) and console.width == 30


def printed(table: object, width: int) -> list[str]:
    console = Console(file=io.StringIO(), width=width, soft_wrap=True)
    console.print(table)
    return str(console.file.getvalue()).splitlines()  # type: ignore[attr-defined]


def test_no_name_is_broken_at_80_columns() -> None:
    scenes = [load_scene(shipped.find(name)) for name in shipped.names()]
    lines = printed(tables.scene_table(scenes, 80), 80)
    assert all(len(line) <= 80 for line in lines)
    assert all(any(line.split()[:1] == [scene.name] for line in lines) for scene in scenes)
    bound = {
        "reaction": 2552.4,
        "reaction_max": 3340.9,
        "reaction_sharp": 2545.0,
        "reaction_max_sharp": 3349.0,
        "seconds": 0.002,
        "status": "solved",
    }
    coulomb = {"status": "solved", "reaction": 2552.4, "uncertainty": 1.0, "seconds": 0.03, "reaction_interval": [2552.4, 2552.4]}
    comparison = {
        "scene": "arch_spreading", "weight": 14593.0, "unit": "N", "verdict": "agree", "reason": "",
        "limit_analysis": {"associated": bound, "coulomb": coulomb},
        "yade": {"status": "plateau", "reaction": 2552.5, "uncertainty": 0.6, "seconds": 2.6},
    }  # fmt: skip
    short, whole = (shown(tables.verdict_table([comparison]), tables.VERDICT_CAN_GO, whole) for whole in (False, True))
    assert any(line.split()[:1] == ["arch_spreading"] for line in short) and all(len(line.rstrip()) <= 80 for line in short[1:])
    assert not any("0.22894" in line for line in short) and any("0.22894" in line for line in whole)


def test_a_short_table_leaves_out_the_evidence_that_long_shows(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pads", "-q", "--bounds"]) == 0
    short = capsys.readouterr().out
    assert main(["solve", "two_pads", "-q", "--bounds", "--long"]) == 0
    whole = capsys.readouterr().out
    assert "reaction sharp" in short and "equilibrium residual" not in short and "equilibrium residual" in whole


def test_a_scene_needs_no_ending_and_an_unknown_one_is_called_a_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shutil.copy(shipped.find("two_pads"), tmp_path / "mywall.toml")
    (tmp_path / "mywall").mkdir()  # the name of its folder of results
    assert shipped.find("mywall") == Path("mywall.toml")
    with pytest.raises(Exception, match='did you mean "two_pads"'):
        shipped.find("two_pds")
    with pytest.raises(Exception, match="valid scenes: "):
        shipped.find("zzz")


def test_report_export_and_animate_take_the_folder_of_a_run_or_of_a_scene(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], plain_figures: None
) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "slab_four_corners", "-o", str(out), "--no-yade", "-q", "--project", "Town hall"]) == 0
    assert "Town hall" in (out / "report.html").read_text(encoding="utf-8")
    for folder in (out, out / "two_pads"):
        capsys.readouterr()
        assert main(["report", str(folder), "--json", "-q"]) == 0
        assert [scene["scene"] for scene in json.loads(capsys.readouterr().out)["comparisons"]] == ["slab_four_corners", "two_pads"]
    monkeypatch.chdir(tmp_path)
    assert main(["export", str(out), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["files"] == ["slab_four_corners-paraview/structure.pvd", "two_pads-paraview/structure.pvd"]
    assert main(["export", str(out), "-o", "both", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["files"] == ["both/slab_four_corners/structure.pvd", "both/two_pads/structure.pvd"]
    assert main(["animate", str(out), "-o", "one.gif"]) == 2
    assert "one file cannot hold several animations" in capsys.readouterr().err


def test_sharp_edges_are_noted_under_the_table(tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "sharp.toml"
    path.write_text(re.sub(r"(?m)^friction.*$", "\\g<0>\ninset = 0.0", shipped.find("two_pads").read_text(encoding="utf-8"), count=1))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "--no-yade", "-q"]) == 0
    assert "sharp: The scene has sharp edges (inset 0)." in " ".join(capsys.readouterr().out.split())


def test_without_a_browser_a_pdf_is_refused_in_one_line(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    assert main(["run", "two_pads", "-o", str(out), "--no-yade", "-q"]) == 0
    monkeypatch.setattr(pdf.shutil, "which", lambda name: None)
    capsys.readouterr()
    assert main(["report", str(out), "--pdf", "-q"]) == 3
    message = capsys.readouterr().err
    assert message.count("\n") == 1 and "Chromium" in message and "report.html" in message


def narrated(monkeypatch: pytest.MonkeyPatch, reports: Sequence[dict[str, Any]], *, all_lines: bool) -> list[str]:
    """Return the lines that reports of a wall's run give, all of them or the announcements alone."""
    monkeypatch.setattr(progress, "time", SimpleNamespace(monotonic=itertools.count(step=100 if all_lines else 0).__next__))
    console = Console(file=io.StringIO(), width=200)
    with Narration(console) as narration:
        for report in reports:
            narration.progress("wall", report)
    return str(console.file.getvalue()).splitlines()  # type: ignore[attr-defined]


def test_a_long_run_is_announced_with_its_time_and_so_is_each_further_attempt(monkeypatch: pytest.MonkeyPatch) -> None:
    heard = (
        (1, None, False),
        (1, 50.0, False),
        (1, 245.0, False),
        (1, 240.0, False),
        (2, 30.0, False),
        (2, 120.0, True),
        (1, 300.0, False),
    )
    reports = [{"stage": "gravity", "attempt": number, "seconds_left": left, "is_late": late} for number, left, late in heard]
    lines = narrated(monkeypatch, [*reports, {"stage": "loaded"}, *reports[2:3]], all_lines=False)
    first = "wall: YADE: about 4:05 min to a plateau, longer if the blocks stick and slip"
    late = "wall: YADE: attempt 2, no plateau yet, about 2:00 min to a plateau, longer if the blocks stick and slip"
    assert lines == [first, late, first], "once for each attempt, and again for a run that loads YADE again"


def test_a_run_that_its_time_limit_will_end_is_announced_so(monkeypatch: pytest.MonkeyPatch) -> None:
    within, beyond = ({"stage": "gravity", "seconds_left": 7500.0, "seconds_to_limit": limit} for limit in (8000.0, 3600.0))
    words = "wall: YADE: about 2 h 05 min to a plateau, longer if the blocks stick and slip"
    assert narrated(monkeypatch, [within], all_lines=False) == [words]
    assert narrated(monkeypatch, [beyond], all_lines=False) == [
        f"{words}; its time limit ends the run in about 1 h 00 min (a larger --time-limit, or time_limit in [yade], allows more)"
    ]
    assert narrated(monkeypatch, [beyond | {"is_second_attempt": True}], all_lines=False) == [
        f"{words}; its time limit ends the run in about 1 h 00 min (a larger --try-harder-limit allows more)"
    ]


def test_lines_of_a_run_say_attempt_lateness_and_time_left(monkeypatch: pytest.MonkeyPatch) -> None:
    settling = {"stage": "settlement", "attempt": 2, "fraction": 0.5, "settlement": 1e-4, "reaction": 50.0, "unit": "mm"}
    more = ({"seconds_left": 41.0}, {"seconds_left": 45.0, "is_late": True}, {"stage": "gravity", "attempt": 1})
    assert narrated(monkeypatch, [settling | one for one in more], all_lines=True) == [
        "wall: YADE: 50 %, attempt 2, moved 0.100 mm, reaction 50 N, about 0:41 min left",
        "wall: YADE: 50 %, attempt 2, no plateau yet, moved 0.100 mm, reaction 50 N, about 0:45 min left",
        "wall: YADE: 50 %, coming to rest under gravity",
    ]


def test_progress_says_the_share_that_is_done_its_units_and_the_last_case() -> None:
    console = Console(file=io.StringIO(), width=200)
    with Narration(console) as narration:
        narration._spoke = -1e9
        narration.progress("wall", {"stage": "settlement", "fraction": 0.25, "settlement": 1e-4, "reaction": 1986.3, "unit": "mm"})
    assert console.file.getvalue() == "wall: YADE: 25 %, moved 0.100 mm, reaction 1986.3 N\n"  # type: ignore[attr-defined]
    console = Console(file=io.StringIO(), width=200)
    with CampaignNarration(console, "sweep") as narration:
        narration.opens(1, 1, 0)
        narration.begins()
        narration.ends("case", "done", "")
    assert console.file.getvalue().endswith("sweep: 1 of 1 done, 0 running, 0 failed\n")  # type: ignore[attr-defined]
