"""Tables for the terminal (rich); a number that does not exist is a dash."""

from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table

from comparison.judge import METHODS as ACCURACY_METHODS
from comparison.judge import VERDICT_HEADINGS, VERDICT_TITLE, Check, effects_summary, percent, verdict_cells
from la_core.analysis import DecidedModel, answer_headings, answer_rows
from la_core.scene import Expected, Scene, change_rows, geometry_changes
from la_core.text_table import number_text, over_weight

ANSWER_WIDTHS = (34, 11)  # of names and values, so that the table of the prediction continues that of the bounds
MARKS = {"agree": "[green]✓ agree[/]", "disagree": "[red]✗ disagree[/]", "inconclusive": "[yellow]? inconclusive[/]", None: "–"}


def new_table(*headings: str, title: str | None = None) -> Table:
    """Return an empty table in the program's style; long words fold."""
    table = Table(*headings, title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for column in table.columns:
        column.overflow = "fold"
    return table


def scene_table(scenes: list[Scene]) -> Table:
    """Return a table of scenes with their expected values."""
    table = new_table("scene", "title", "expected", "kind", "source")
    for scene in scenes:
        expected = scene.expected
        value = "–" if expected is None else _expected(expected, scene.live is not None)
        kind = expected.kind if expected else "–"
        table.add_row(plain(scene.name), plain(scene.title), value, kind, plain(scene.source))
    return table


def _expected(expected: Expected, live: bool) -> str:
    """Return the expected value for the scene's own friction law, else the associated value, marked as such."""
    value = expected.multiplier if live else expected.reaction_over_weight
    associated = expected.associated_multiplier if live else expected.associated_reaction_over_weight
    return f"{number_text(associated)} associated" if value is None and associated is not None else number_text(value)


def plain(text: str) -> str:
    """Return a scene's text with the terminal library's markup escaped."""
    return escape(text)


def scene_facts(scene: Scene, decided: DecidedModel) -> dict[str, Any]:
    """Return the counts, the weight (N) and the effects of a scene."""
    assembly = decided.assembly
    roles = {name: int((scene.blocks.role == code).sum()) for code, name in enumerate(("free", "fixed", "support"))}
    facts: dict[str, Any] = {"scene": scene.name, "warnings": list(scene.warnings), "weight": scene.weight}
    facts |= {f"{name}_blocks": count for name, count in roles.items()}
    facts |= {"interfaces": len(assembly.interfaces), "contact_points": len(assembly.points)}
    facts |= {"friction_coefficient": scene.friction, "inset": scene.inset}
    facts["geometry"] = geometry_changes(scene, decided.whole.slivers, decided.whole.short_joints)
    return facts | {"effects": effects_summary(scene, decided.whole, assembly)}


def facts_table(title: str, facts: dict[str, Any]) -> Table:
    """Return a table of scene facts, one per row, without the effects and the warnings."""
    units = {"weight": "N", "inset": "m"}
    table = new_table("what", "value", "unit", title=plain(title))
    for name, value in facts.items():
        if name not in ("effects", "geometry", "warnings"):
            text = number_text(value) if isinstance(value, float) else str(value)
            table.add_row(name.replace("_", " "), text, units.get(name, ""))
    return table


def changes_table(changes: dict[str, Any]) -> Table:
    """Return a table of what reading changed in the geometry, one change per row."""
    table = new_table("changed in the geometry", "how much")
    for what, how_much in change_rows(changes):
        table.add_row(plain(what), plain(how_much))
    return table


def effects_table(effects: dict[str, Any]) -> Table:
    """Return a table of effects, one per row: on or off, the model, the reason, and the saving if it is off."""
    table = new_table("effect", "what", "", "modelled", "reason", "saves")
    for row in effects["table"]:
        saved = ", ".join(f"{count} {name}" for name, count in row["saved"].items())
        table.add_row(row["effect"], row["what"], "on" if row["on"] else "off", row["modelled"], plain(row["reason"]), saved)
    return table


def bounds_table(scene: Scene, answer: dict[str, Any]) -> Table:
    """Return the bounds of one scene, in their unit and over the weight, with residuals. answer: values as of `solve --json`."""
    return _answer_table(answer_headings(scene), _rows_of_bounds(scene, answer), plain(scene.title))


def prediction_table(scene: Scene, answer: dict[str, Any], checks: list[Check]) -> Table | None:
    """Return what `bounds_table` leaves out: the prediction, and checks against expected values; None where there is neither."""
    _, unit, share = answer_headings(scene)
    rows = list(answer_rows(scene, answer))[len(_rows_of_bounds(scene, answer)) :]
    if not rows and not checks:
        return None
    table = _answer_table(("prediction" if rows else "check", unit, share), rows)
    for check in checks:
        table.add_row(check.name, number_text(check.limit_analysis), MARKS[check.verdict])
    return table


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
    table = new_table(drive, f"{scene.quantity} {scene.unit}".strip(), "over W" if scene.live is None else "", "strain residual", "solves")
    columns = (path[name] for name in ("settlement", scene.quantity, "strain_residual", "converged", "solves"))
    for settlement, value, residual, converged, solves in zip(*columns, strict=True):
        ratio = number_text(over_weight(value, scene.weight)) if scene.live is None else ""
        residual_text = number_text(residual, 2) + ("" if converged else " not converged")
        table.add_row(number_text(settlement, 4), number_text(value), ratio, residual_text, str(solves))
    return table


def verdict_table(comparisons: list[dict[str, Any]]) -> Table:
    """Return one row per scene: bounds, prediction and YADE's reaction over the weight, the verdict, the time of each method."""
    table = new_table(*VERDICT_HEADINGS, title=VERDICT_TITLE)
    for comparison in comparisons:
        scene, *values, limit_seconds, yade_seconds = verdict_cells(comparison)
        table.add_row(plain(scene), *values, MARKS[comparison["verdict"]], limit_seconds, yade_seconds)
    return table


def accuracy_table(comparisons: list[dict[str, Any]]) -> Table:
    """Return one row per scene and method with a requested accuracy: the estimated error, the chosen settings and their cost."""
    title = "requested accuracy, as a share of the answer"
    table = new_table("scene", "method", "requested", "error", "chosen and why", "runs", "s", title=title)
    for comparison in comparisons:
        accuracy = comparison.get("accuracy") or {}
        for method in (name for name in ACCURACY_METHODS if name in accuracy):
            answer = accuracy[method]
            error = f"{MARKS['agree' if answer['kept'] else 'inconclusive'].split()[0]}[/] {percent(answer['error'])}"
            cost = [str(len(answer["attempts"])), number_text(answer["seconds"], 2)]
            cells = [percent(accuracy["asked"]), error, answer["chosen"], *cost]
            table.add_row(plain(comparison["scene"]), ACCURACY_METHODS[method], *cells)
    return table
