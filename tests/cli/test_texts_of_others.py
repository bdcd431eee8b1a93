"""Neither the terminal, nor the library that draws its tables, nor a page obeys markup or control characters in texts of others."""

import io
import os
from collections.abc import Callable
from contextlib import suppress
from html.parser import HTMLParser
from pathlib import Path

import pytest
from faulty_runs import Fake
from rich.console import Console
from rich.table import Table

from comparison.campaign.report.compare import Change, Comparison
from comparison.campaign.report.compare_report import terminal_tables
from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, CANNOT_STAND
from comparison.cli.layout import show_table
from comparison.studies.cost import CostStudy, cost_table
from comparison.studies.sensitivity import Sensitivity, sensitivity_table
from la_core.errors import visible
from la_core.limit import ClassicParameters
from la_core.scene.scene import load_scene

OBEYED = {"escape": "\\u001b[2J", "C1": "\\u009b2J", "bell": "\\u0007", "backspace": "\\b", "carriage return": "\\r", "override": "\\u202e"}


@pytest.mark.parametrize("control", OBEYED.values(), ids=OBEYED)
@pytest.mark.parametrize("key", ['title   = "', 'name    = "', 'source  = "', '[settlement]\n"'])
def test_what_a_terminal_obeys_is_refused_and_not_repeated(
    control: str, key: str, tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "scene.toml"
    text = two_pads.replace("[settlement]\n", '[settlement]\n"odd" = 1\n') if key.startswith("[") else two_pads
    assert key in text
    path.write_text(text.replace(key, key + control, 1))
    assert main(["solve", str(path)]) == 2
    captured = capsys.readouterr()
    assert captured.out == "" and captured.err.startswith("error: ") and visible(captured.err) == captured.err


def test_an_argument_is_not_obeyed_either(capsys: pytest.CaptureFixture[str]) -> None:
    for line in ("show two_pads -o x\x1b[31m.foo", "run two_pads --workers \x1b[31m", "show two_pads --\x1b[2J"):
        words = line.split()
        with suppress(SystemExit):
            assert main(words) == 2
        said = capsys.readouterr().err
        assert said.startswith("error: ") and "\x1b" not in said and "\\x1b" in said, words


def test_new_lines_tabs_and_letters_of_any_script_are_harmless(tmp_path: Path, two_pads: str) -> None:
    title = "Zwei Böcke\\n\\tδύο 二 \U0001f9f1 می‌خواهم"
    path = tmp_path / "scene.toml"
    path.write_text(two_pads.replace('title   = "', f'title   = "{title}', 1))
    assert load_scene(path).title.startswith("Zwei Böcke\n\tδύο")


def test_a_file_s_name_is_not_obeyed_either(tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str]) -> None:
    for name in ("\x1b[2J", "\u202ex", os.fsdecode(b"\xff")):
        path = tmp_path / f"{name}.toml"
        path.write_text(two_pads)
        assert main(["run", str(path), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
        said = capsys.readouterr().err
        assert "must be printable text" in said and visible(said) == said
    assert not (tmp_path / "out").exists()


MARKUP = "[red]a[/blue] [/] \\\\[bold] :smile: <script>alert(1)</script> <img src=x onerror=y> ![x](y) `c` | &amp; {{ 7 * 7 }} %s $HOME"


class Page(HTMLParser):
    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.data: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        assert not [name for name, _ in attrs if name.startswith("on")]

    def handle_data(self, data: str) -> None:
        self.data.append(data)


def test_markup_in_titles_and_names_stays_text_wherever_it_is_shown(
    tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "[red]x[bold].toml"
    text = two_pads.split("[expected]", maxsplit=1)[0].replace('name    = "block"', f'name    = "{MARKUP}"')
    shown = MARKUP.replace("\\\\", "\\")
    overhang = ("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]"), ("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]")
    for old, new in overhang:  # so that the block falls, and its name is in every answer
        assert old in text
        text = text.replace(old, new)
    path.write_text(text.replace('title   = "', f'title   = "{MARKUP} ', 1))
    for command, code in ((["solve", str(path)], CANNOT_STAND), (["show", str(path), "-o", str(tmp_path / "f.png")], AGREE)):
        assert main(command) == code
        assert shown in " ".join(capsys.readouterr().out.split())
    out = tmp_path / "out"
    assert main(["run", str(path), "-o", str(out), "--no-yade"]) == CANNOT_STAND
    captured = capsys.readouterr()
    assert "[red]x[bold]" in captured.out and "[red]x[bold]" in captured.err
    page = Page((out / "report.html").read_text(encoding="utf-8"))
    assert page.tags.count("script") == 3 and shown in " ".join("".join(page.data).split())
    markdown = (out / "report.md").read_text(encoding="utf-8")
    assert "script" in markdown and "<script" not in markdown.replace("\\<", "") and "![x]" not in markdown and "[red]x" not in markdown


def table_of_costs() -> Table:
    return cost_table(CostStudy("s", MARKUP, "reaction", "N", {"prediction": (0.5, "the exact value")}, ()), "prediction")


def table_of_sensitivity() -> Table:
    return sensitivity_table(Sensitivity(MARKUP, "reaction", "N", 1.0, ClassicParameters(), ()), {"associated": (1.0, 1)})


def table_of_changes() -> Table:
    change = Change(MARKUP, "verdict", "verdict", "agree", "disagree")
    (table,) = terminal_tables(Comparison(("a", "b"), ("a", "b"), 1, [], [], [], [change], [], [], []))
    return table


@pytest.mark.parametrize("made", [table_of_costs, table_of_sensitivity, table_of_changes])
def test_markup_stays_text_in_the_tables_of_studies_and_comparisons(made: Callable[[], Table]) -> None:
    """A bracket in a title once lost the results that a study had measured for minutes."""
    console = Console(file=io.StringIO(), width=500, soft_wrap=True, emoji=False)
    show_table(console, made())
    assert MARKUP in console.file.getvalue()  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    "said", [r"printf '\033[31m0.0\n'; exit 0", r"printf '\033[31mno YADE\n' >&2; exit 1"], ids=["version", "complaint"]
)
def test_what_the_interpreter_of_yade_says_is_not_obeyed(
    said: str, fake_python: Fake, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A script in the place of YADE's Python once controlled the terminal by its output."""
    fake_python(r"printf '\033[32mboo\n'; exit 7", said)
    for words in (["doctor"], ["run", "two_pads", "-o", str(tmp_path / "out")]):
        main(words)
        told = "".join(capsys.readouterr())
        assert r"\x1b" in told and "\x1b" not in told, words
