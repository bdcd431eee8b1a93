"""Tables for the terminal (rich); a number that does not exist is a dash."""

import math
from typing import Any

from rich import box
from rich.markup import escape
from rich.table import Table

from comparison.bought import METHODS as ACCURACY_METHODS
from comparison.bought import percent
from comparison.check import Check
from comparison.doctor import Finding
from comparison.effects_table import effects_summary
from la_core.analysis import answer_table
from la_core.model import Assembly
from la_core.scene import Expected, Scene
from la_core.text_table import number, over_weight

VERDICT_HEADINGS = ("scene", "least", "Coulomb", "greatest", "YADE", "verdict", "LA s", "YADE s")
VERDICT_TITLE = "reaction over the weight W of the free blocks: limit analysis' bounds and prediction, YADE's plateau"
MARKS = {"agree": "[green]✓ agree[/]", "disagree": "[red]✗ disagree[/]", "inconclusive": "[yellow]? inconclusive[/]", None: "–"}


def _table(*headings: str, title: str | None = None) -> Table:
    table = Table(*headings, title=title, box=box.SIMPLE_HEAD, title_justify="left")
    for column in table.columns:
        column.overflow = "fold"
    return table


def scene_table(scenes: list[Scene]) -> Table:
    """Shipped scenes with what is expected of them."""
    table = _table("scene", "title", "expected", "kind", "source")
    for scene in scenes:
        expected = scene.expected
        shown = "–" if expected is None else _expected(expected, scene.live is not None)
        table.add_row(_plain(scene.name), _plain(scene.title), shown, expected.kind if expected else "–", _plain(scene.source))
    return table


def _expected(expected: Expected, live: bool) -> str:
    """The value of the scene's own friction, else the associated one, which is named so."""
    value = expected.multiplier if live else expected.reaction_over_weight
    associated = expected.associated_multiplier if live else expected.associated_reaction_over_weight
    return f"{number(associated)} associated" if value is None and associated is not None else number(value)


def _plain(text: str) -> str:
    """Text of a scene with nothing that the terminal library would take for markup."""
    return escape(text)


def scene_facts(scene: Scene, assembly: Assembly) -> dict[str, Any]:
    """Counts and weight of a scene, and the effects it calls for."""
    roles = {name: int((scene.blocks.role == code).sum()) for code, name in enumerate(("free", "fixed", "support"))}
    facts: dict[str, Any] = {"scene": scene.name, "weight": scene.weight, **{f"{name}_blocks": count for name, count in roles.items()}}
    facts |= {"interfaces": len(assembly.interfaces), "contact_points": len(assembly.points)}
    facts |= {"friction_coefficient": scene.friction, "inset": scene.inset}
    return facts | {"effects": effects_summary(scene, assembly)}


def facts_table(title: str, facts: dict[str, Any]) -> Table:
    """Scene facts, one a row, effects left out."""
    units = {"weight": "N", "inset": "m"}
    table = _table("what", "value", "unit", title=_plain(title))
    for name, value in facts.items():
        if name != "effects":
            table.add_row(name.replace("_", " "), number(value) if isinstance(value, float) else str(value), units.get(name, ""))
    return table


def effects_table(effects: dict[str, Any]) -> Table:
    """Effects of a scene, one a row: on or off, how it is modelled, why, and what leaving it out saves."""
    table = _table("effect", "what", "", "modelled", "reason", "saves")
    for row in effects["table"]:
        saved = ", ".join(f"{count} {name}" for name, count in row["saved"].items())
        table.add_row(row["effect"], row["what"], "on" if row["on"] else "off", row["modelled"], _plain(row["reason"]), saved)
    return table


def solution_table(scene: Scene, summary: dict[str, Any], checks: list[Check]) -> Table:
    """Limit analysis of one scene: values in their unit and over the weight, residuals, checks against expected values."""
    table = _table(*answer_table.headings(scene), title=_plain(scene.title))
    for row in answer_table.rows(scene, summary["limit_analysis"]):
        table.add_row(*map(_plain, row))
    for check in checks:
        table.add_row(check.name, number(check.limit_analysis), MARKS[check.verdict])
    return table


def path_table(scene: Scene, path: dict[str, Any]) -> Table:
    """The curve from rest to the plateau, a row a point."""
    drive = "displacement, m" if scene.live is not None else "settlement, rad" if scene.is_rotation else "settlement, m"
    table = _table(drive, f"{scene.quantity} {scene.unit}".strip(), "over W" if scene.live is None else "", "strain residual", "solves")
    columns = (path[name] for name in ("settlement", scene.quantity, "strain_residual", "converged", "solves"))
    for settlement, value, residual, converged, solves in zip(*columns, strict=True):
        ratio = number(over_weight(value, scene.weight)) if scene.live is None else ""
        shown = number(residual, 2) + ("" if converged else " not converged")
        table.add_row(number(settlement, 4), number(value), ratio, shown, str(solves))
    return table


def verdict_table(comparisons: list[dict[str, Any]]) -> Table:
    """One row a scene: bounds, prediction and YADE's reaction over the weight, the verdict, the time of each method."""
    table = _table(*VERDICT_HEADINGS, title=VERDICT_TITLE)
    for comparison in comparisons:
        scene, *values, own_seconds, yade_seconds = verdict_cells(comparison)
        table.add_row(_plain(scene), *values, MARKS[comparison["verdict"]], own_seconds, yade_seconds)
    return table


def verdict_cells(comparison: dict[str, Any]) -> list[str]:
    """Cells of a row of the verdict table but for the verdict itself."""
    answer, yade, weight = comparison["limit_analysis"]["associated"], comparison["yade"] or {}, comparison["weight"]
    coulomb = comparison["limit_analysis"]["coulomb"] or {}
    if "multiplier" in answer:
        values = [number(answer["multiplier"], 5), number(coulomb.get("multiplier"), 5), "–", "–"]
    else:
        shared, predicted = answer.get("shared_inset", answer), coulomb.get("shared_inset", coulomb).get("reaction")
        values = [_over(value, weight) for value in (shared["reaction"], predicted, shared["reaction_max"])]
        values.append(with_uncertainty(over_weight(yade.get("reaction"), weight), over_weight(yade.get("uncertainty"), weight)))
    if answer["status"] != "solved":
        values[0] = answer["status"]
    elif coulomb and coulomb["status"] != "solved":
        values[1] = f"{values[1]} {coulomb['status']}"
    if yade and yade["status"] != "plateau":
        values[3] = yade["status"]
    seconds = [number(answer["seconds"] + coulomb.get("seconds", 0.0), 2), number(yade.get("seconds"), 2)]
    return [comparison["scene"], *values, *seconds]


def accuracy_table(comparisons: list[dict[str, Any]]) -> Table:
    """One row a scene and method of which an accuracy was asked: the estimated error, what was chosen and why, what it took."""
    table = _table("scene", "method", "asked", "error", "chosen and why", "runs", "s", title="accuracy asked for, as a share of the answer")
    for comparison in comparisons:
        bought = comparison.get("accuracy") or {}
        for method in (name for name in ACCURACY_METHODS if name in bought):
            found = bought[method]
            error = f"{MARKS['agree' if found['kept'] else 'inconclusive'].split()[0]}[/] {percent(found['error'])}"
            row = [percent(bought["asked"]), error, found["chosen"], str(len(found["attempts"])), number(found["seconds"], 2)]
            table.add_row(_plain(comparison["scene"]), ACCURACY_METHODS[method], *row)
    return table


def _over(value: float | None, weight: float) -> str:
    return number(over_weight(value, weight), 5)


def with_uncertainty(value: float | None, uncertainty: float | None) -> str:
    """A value to the last digit that its uncertainty, given to one digit, leaves meaningful."""
    if value is None or uncertainty is None:
        return number(value, 5)
    digits = 6 if uncertainty <= 0.0 else min(6, max(0, -math.floor(math.log10(uncertainty))))
    return f"{value:.{digits}f} ± {uncertainty:.{digits}f}"


def doctor_table(findings: list[Finding]) -> Table:
    """What is installed and what is not."""
    table = _table("part", "state", "")
    for finding in findings:
        table.add_row(finding.part, _plain(finding.state), "[green]✓[/]" if finding.well else "[red]✗ missing[/]")
    return table


def settings_table(configuration: dict[str, Any]) -> Table:
    """Which settings hold, and from where."""
    table = _table("setting", "value", "from")
    for name, one in configuration["settings"].items():
        table.add_row(name, "–" if one["value"] is None else _plain(str(one["value"])), _plain(one["from"]))
    return table
