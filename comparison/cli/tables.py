"""Tables for the terminal (rich); a number that does not exist is a dash."""

from collections.abc import Sequence
from typing import Any

from rich.table import Table

from comparison.judge import METHODS as ACCURACY_METHODS
from comparison.numbers import percent
from comparison.run_folder import name_in_results
from comparison.verdict import VERDICT_HEADINGS, Check, Verdict, check_words, new_table, plain, verdict_cells, verdict_title
from la_core.analysis import answer_headings, answer_rows
from la_core.scene import Expected, Scene, change_rows
from la_core.text_table import OVER_WEIGHT, number_text, over_weight

ANSWER_WIDTHS = (34, 11)  # of names and values, so that the table of the prediction continues that of the bounds
COLOURS = {"agree": "green", "disagree": "red", "unexpected": "red", "inconclusive": "yellow", "cannot stand": "red"}
EVIDENCE = ("residual", "violation", "gap", "drift", "travel", "iterations")  # ends of the names of rows that only `--long` shows
LONGEST_NAME = 40  # columns for the names of scenes; longer names are broken
VERDICT_CAN_GO = ("LA s", "YADE s", "greatest", "least")  # columns that a narrow table leaves out, in this order


def scene_table(scenes: list[Scene], width: int, long: bool = False) -> Table:
    """Return a table of scenes and expected values, one row for each scene, at most `width` columns wide; long: also kind and source."""
    table = new_table("scene", "blocks", "title", "expected", *(("kind", "source") if long else ()))
    _keep_names_whole(table, [scene.name for scene in scenes])
    rows = []
    for scene in scenes:
        expected = scene.expected
        value = "–" if expected is None else _expected(expected, scene.live is not None)
        more = (expected.kind if expected else "–", scene.source) if long else ()
        rows.append([scene.name, str(int(scene.blocks.free.sum())), scene.title, value, *more])
    taken = sum(max(len(row[k]) for row in [[str(column.header) for column in table.columns], *rows]) for k in (0, 1, 3))
    room = width - taken - 3 * len(table.columns) - 2
    for row in rows:
        if not long and len(row[2]) > room:
            row[2] = f"{row[2][: room - 1]}…"
        table.add_row(*map(plain, row))
    return table


def _expected(expected: Expected, live: bool) -> str:
    """Return the expected value for the scene's own friction law, else the associated value, marked as such."""
    value = expected.multiplier if live else expected.reaction_over_weight
    associated = expected.associated_multiplier if live else expected.associated_reaction_over_weight
    return f"{number_text(associated)} associated" if value is None and associated is not None else number_text(value)


def coloured(words: str, verdict: str | None) -> str:
    """Return words in the colour of a verdict, as markup of the terminal library."""
    return f"[{COLOURS[verdict]}]{words}[/]" if verdict in COLOURS else words


def changes_table(changes: dict[str, Any]) -> Table:
    """Return a table of the changes of the geometry when it was read, one per row."""
    table = new_table("changed in the geometry", "how much")
    for what, how_much in change_rows(changes):
        table.add_row(plain(what), plain(how_much))
    return table


def effects_table(effects: dict[str, Any], long: bool = False) -> Table:
    """Return a table of effects, one per row: on or off and the model; long: also its meaning, the reason, and the savings without it."""
    if not long:
        short = new_table("effect", "", "modelled")
        for row in effects["table"]:
            short.add_row(row["effect"], "on" if row["on"] else "off", row["modelled"])
        return short
    table = new_table("effect", "what", "", "modelled", "reason", "saves")
    for row in effects["table"]:
        saved = ", ".join(f"{count} {name}" for name, count in row["saved"].items())
        table.add_row(row["effect"], row["what"], "on" if row["on"] else "off", row["modelled"], plain(row["reason"]), saved)
    return table


def bounds_table(scene: Scene, answer: dict[str, Any], long: bool = False) -> Table:
    """Return the bounds of one scene, in their unit and over the weight; long: also residuals. answer: values as of `solve --json`."""
    return _answer_table(answer_headings(scene), _shown(_rows_of_bounds(scene, answer), long), scene.title)


def prediction_table(scene: Scene, answer: dict[str, Any], checks: list[Check], long: bool = False) -> Table | None:
    """Return a table of the rows that `bounds_table` leaves out: the prediction and checks against expected values; None without any."""
    _, unit, share = answer_headings(scene)
    rows = _shown(list(answer_rows(scene, answer))[len(_rows_of_bounds(scene, answer)) :], long)
    if not rows and not checks:
        return None
    table = _answer_table(("prediction" if rows else "check", unit, share), rows)
    for check in checks:
        table.add_row(check.name, number_text(check.limit_analysis), coloured(_expected_words(check), check.verdict))
    return table


def _expected_words(check: Check) -> str:
    """Return words that say whether an expected value is met, with the value where it is not."""
    words = " ".join(check_words(check.verdict))
    if check.verdict is not Verdict.UNEXPECTED or check.limit_analysis is None or check.difference is None:
        return words
    return f"{words}: {number_text(check.limit_analysis + check.difference)} is expected"


def _shown(rows: list[tuple[str, str, str]], long: bool) -> list[tuple[str, str, str]]:
    """Return the rows of a short table: without residuals and cost."""
    return rows if long else [row for row in rows if not row[0].endswith(EVIDENCE)]


def _rows_of_bounds(scene: Scene, answer: dict[str, Any]) -> list[tuple[str, str, str]]:
    return list(answer_rows(scene, answer | {"coulomb": None}))


def _answer_table(headings: tuple[str, str, str], rows: list[tuple[str, str, str]], title: str | None = None) -> Table:
    table = new_table(*headings, title=title)
    for column, width in zip(table.columns, ANSWER_WIDTHS, strict=False):
        column.min_width = width
    for row in rows:
        table.add_row(*map(plain, row))
    return table


def path_table(scene: Scene, path: dict[str, Any]) -> Table:
    """Return a table of the reaction's path from rest to the plateau, one row per point."""
    drive = "displacement, m" if scene.live is not None else "settlement, rad" if scene.is_rotation else "settlement, m"
    table = new_table(drive, f"{scene.quantity} {scene.unit}".strip(), OVER_WEIGHT[scene.unit], "strain residual", "solves")
    columns = (path[name] for name in ("settlement", scene.quantity, "strain_residual", "solves"))
    for settlement, value, residual, solves in zip(*columns, strict=True):
        ratio = number_text(over_weight(value, scene.weight)) if scene.live is None else ""
        table.add_row(number_text(settlement, 4), number_text(value), ratio, number_text(residual, 2), str(solves))
    return table


def verdict_table(comparisons: list[dict[str, Any]]) -> Table:
    """Return one row per scene: bounds, prediction and YADE's reaction over the weight, the verdict, the time of each method.

    Names of scenes are never broken.
    """
    table = new_table(*VERDICT_HEADINGS, title=verdict_title({comparison["unit"] for comparison in comparisons}))
    _keep_names_whole(table, [name_in_results(comparison) for comparison in comparisons])
    for comparison in comparisons:
        _, *values, verdict, limit_seconds, yade_seconds = verdict_cells(comparison)
        table.add_row(plain(name_in_results(comparison)), *values, coloured(verdict, comparison["verdict"]), limit_seconds, yade_seconds)
    return table


def _keep_names_whole(table: Table, names: Sequence[str]) -> None:
    """Keep the names in the first column of a table unbroken, up to LONGEST_NAME characters."""
    table.columns[0].min_width = min(max(map(len, names), default=0), LONGEST_NAME)


def accuracy_table(comparisons: list[dict[str, Any]]) -> Table:
    """Return one row per scene and method with a requested accuracy: the estimated error, the chosen settings and their cost."""
    title = "requested accuracy, as a share of the answer"
    table = new_table("scene", "method", "requested", "error", "chosen and why", "runs", "s", title=title)
    for comparison in comparisons:
        accuracy = comparison.get("accuracy") or {}
        for method in (name for name in ACCURACY_METHODS if name in accuracy):
            answer = accuracy[method]
            error = f"{coloured(*('✓', 'agree') if answer['kept'] else ('?', 'inconclusive'))} {percent(answer['error'])}"
            cost = [str(len(answer["attempts"])), number_text(answer["seconds"], 2)]
            cells = [percent(accuracy["asked"]), error, answer["chosen"], *cost]
            table.add_row(plain(name_in_results(comparison)), ACCURACY_METHODS[method], *cells)
    return table
