"""Rows of the tables in a campaign's report, as texts; the templates only lay them out."""

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any

from comparison.campaign.mechanism_changes import MechanismChange
from comparison.campaign.parameter_labels import CLASSIC, QUANTITY, short, shown, words_of
from comparison.campaign.report.verdict_matrix import FAILURE, verdict_symbol
from comparison.campaign.row_groups import key
from comparison.campaign.row_values import (
    WORDS,
    Row,
    compared_with,
    costs_once,
    deviation,
    difference,
    failed,
    least_tolerance,
    link,
    over_weight,
    own_folder,
    sweep_of,
    uncertainty_of,
    worst_first,
)
from comparison.campaign.table import CampaignTable
from comparison.numbers import DASH, format_number, interval_words, share_of, small_number, with_uncertainty
from comparison.report import image_address
from comparison.verdict import ANSWERS, UNCONFIRMED, VERDICTS
from la_core.text_table import exists

MOST_PICTURES = 12  # of mechanisms on a page, which embeds them
PREDICTED_BY = {"coulomb": "Coulomb", "coulomb_released": "Coulomb, after a release", "least": "associated"}
SECONDS = ("limit_analysis_seconds", "classic_seconds", "yade_seconds")
Words = dict[str, Any]
Varying = dict[str, set[str]]


SIGNS = (*VERDICTS.values(), FAILURE)  # of cases, with their words


def counts(table: CampaignTable) -> list[Words]:
    """Return the number of cases of each verdict, and of failures; without zeros."""
    numbers = Counter(verdict_symbol(row) for row in table.rows)
    return [{"symbol": sign, "word": word, "count": numbers[sign, word]} for sign, word in SIGNS if numbers[sign, word]]


def compared(table: CampaignTable) -> list[Words]:
    """Return every case that did not fail, the largest deviation first."""
    varying = _varying(table)
    return [_compared(table, row, varying) for row in worst_first([row for row in table.rows if not failed(row)])]


def _compared(table: CampaignTable, row: Row, varying: Varying) -> Words:
    predicted, apart = compared_with(row), difference(row)
    comparable = abs(row.get(predicted) or 0.0) > least_tolerance(row)  # a share of zero is undefined
    sign, word = verdict_symbol(row)
    plateaus = row.get("coulomb_plateaus")
    return _named(table, row, varying) | {
        "symbol": sign,
        "word": word,
        "predicted": with_uncertainty(over_weight(row, predicted), over_weight(row, uncertainty_of(predicted))),
        "plateaus": f"one of {plateaus} plateaus" if exists(plateaus) and plateaus > 1 else "",
        "by": PREDICTED_BY[predicted] if row.get(predicted) is not None else row.get("associated_status") or DASH,
        "interval": interval_words(over_weight(row, "coulomb_low"), over_weight(row, "coulomb_high"), ""),
        "yade": with_uncertainty(over_weight(row, "yade"), over_weight(row, "yade_uncertainty")),
        "yade_status": row.get("yade_status") or "not run",
        "found": exists(row.get("yade")),
        "share": share_of(apart, row[predicted], 3) if comparable else DASH,
        "deviation": small_number(deviation(row), 1.0),
        "reason": row.get("reason") or "",
        "is_said": row.get("verdict") in UNCONFIRMED,  # the words of the verdict give the reason already
    }


def _named(table: CampaignTable, row: Row, varying: Varying) -> Words:
    held = {name: row[name] for name in table.axes if row.get(name) is not None and name in varying[sweep_of(row)]}
    return {
        "case": str(row.get("case")),
        "href": link(table.folder, row),
        "scene": sweep_of(row),
        "varied": words_of(held, table.labels),
    }


def _varying(table: CampaignTable) -> Varying:
    """Return the parameters with several values, by sweep."""
    values: dict[str, dict[str, set[str]]] = {}
    for row in table.rows:
        of_sweep = values.setdefault(sweep_of(row), {})
        for name in table.axes:
            of_sweep.setdefault(name, set()).add(key(row.get(name)))
    return {scene: {name for name, keys in of_sweep.items() if len(keys) > 1} for scene, of_sweep in values.items()}


def failures(table: CampaignTable) -> list[Words]:
    """Return the failed cases with their reasons."""
    varying = _varying(table)
    return [_named(table, row, varying) | {"reason": row.get("reason") or "unknown reason"} for row in table.rows if failed(row)]


def changed(table: CampaignTable, changes: list[MechanismChange], lettered: Mapping[str, Mapping[str, str]]) -> Iterator[Words]:
    """Yield changes of mechanism; `between` holds the two values, each with the address of its case's report.

    changes: changes to show. lettered: letters of mechanisms, by scene and label.
    """
    links = {str(row.get("case")): link(table.folder, row) for row in table.rows}
    for change in changes:
        letter_of = lettered[change.scene]
        ends = (change.low, change.high)
        yield {
            "scene": change.scene,
            "held": change.held,
            "parameter": short(change.parameter, table.labels),
            "between": [{"case": shown(value), "href": links[case]} for value, case in zip(ends, change.cases, strict=True)],
            "method": WORDS[change.method],
            "mechanisms": f"{letter_of[change.before]} to {letter_of[change.after]}",
            "slope_before": format_number(change.slope_before, 3),
            "slope_after": format_number(change.slope_after, 3),
        }


def mechanisms(table: CampaignTable, lettered: Mapping[str, Mapping[str, str]]) -> Iterator[Words]:
    """Yield every mechanism: letter, label, number of cases for each method, and the range of the moving mass share in these cases."""
    for scene, letter_of in lettered.items():
        rows = [row for row in table.rows if sweep_of(row) == scene]
        for label, letter in letter_of.items():
            having = {method: [row for row in rows if str(row.get(f"{method}_mechanism")) == label] for method in ANSWERS}
            masses = [row.get(f"{method}_moving_mass") for method, some in having.items() for row in some]
            known = [mass for mass in masses if exists(mass)]
            ends = dict.fromkeys(format_number(end(known, default=None), 3) for end in (min, max))
            yield {"scene": scene, "letter": letter, "label": label, "mass": " to ".join(ends)} | {
                method: len(some) for method, some in having.items()
            }


def mechanism_pictures(table: CampaignTable, lettered: Mapping[str, Mapping[str, str]]) -> Iterator[Words]:
    """Yield a picture of every mechanism, from the first case that has it by limit analysis, else by YADE; at most MOST_PICTURES.

    The figure of a case shows the prediction's mechanism. The associated mechanism is drawn only where there is no prediction.
    """
    varying, pictures = _varying(table), 0
    for scene, letter_of in lettered.items():
        rows = [row for row in table.rows if sweep_of(row) == scene]
        for label, letter in letter_of.items():
            for method, row in _drawn_with(rows, label):
                folder = own_folder(table.folder, row)
                drawn = sorted(folder.glob("*/mechanisms.png")) if folder is not None and pictures < MOST_PICTURES else []
                if not drawn:
                    continue
                pictures += 1
                yield _named(table, row, varying) | {
                    "data": image_address(drawn[0].read_bytes()),
                    "caption": f"{scene}, mechanism {letter} by {WORDS[method]}, in the case",
                }
                break


def _drawn_with(rows: list[Row], label: str) -> Iterator[tuple[str, Row]]:
    """Yield the methods and cases whose figure shows the mechanism with this label."""
    for method in ("coulomb", "associated", "yade"):
        for row in rows:
            is_drawn = method != "associated" or row.get("coulomb_mechanism") is None
            if is_drawn and row.get(f"{method}_mechanism") == label:
                yield method, row


def classic(table: CampaignTable) -> Iterator[Words]:
    """Yield the cases with a classic iteration: its status, value and number of programmes beside the prediction."""
    names, varying = [name for name in table.axes if name.startswith(CLASSIC)], _varying(table)
    for row in table.rows:
        if any(row.get(name) is not None for name in names):
            yield _named(table, row, varying) | {
                "status": row.get("classic_status") or DASH,
                "value": format_number(over_weight(row, "classic")),
                "programmes": format_number(row.get("classic_iterations")),
                "coulomb": format_number(over_weight(row, "coulomb")),
                "least": format_number(over_weight(row, "least")),
            }


def totals(table: CampaignTable) -> Iterator[Words]:
    """Yield the seconds of each scene and of all; a run that cases share counts once."""
    scene_of = {row["case"]: sweep_of(row) for row in table.rows}
    scenes, once = list(dict.fromkeys(scene_of.values())), costs_once(table)
    for scene in scenes if len(scenes) > 1 else []:
        of_scene, of_scene_once = ([cost for cost in costs if scene_of.get(cost["case"]) == scene] for costs in (table.costs, once))
        yield _total(scene, of_scene, of_scene_once)
    yield _total("all", table.costs, once)


def _total(name: str, costs: list[Row], once: list[Row]) -> Words:
    sums = {key: [cost[key] for cost in once if exists(cost.get(key))] for key in ("limit_analysis_seconds", "yade_seconds", "seconds")}
    sums["classic_seconds"] = [cost["classic_seconds"] for cost in costs if exists(cost.get("classic_seconds"))]
    return {"scene": name, "cases": len(costs)} | {key: format_number(sum(known) if known else None, 3) for key, known in sums.items()}


def dearest(table: CampaignTable) -> list[Words]:
    """Return the costs of every case, the most expensive first."""
    rows = {row["case"]: row for row in table.rows}
    links = {case: link(table.folder, row) for case, row in rows.items()}
    spent = sorted(table.costs, key=lambda cost: (-sum(cost[key] for key in SECONDS if exists(cost.get(key))), str(cost["case"])))
    counted = ("associated_iterations", "coulomb_iterations", "yade_steps")
    return [
        {
            "case": str(cost["case"]),
            "href": links.get(cost["case"], ""),
            "blocks": format_number(rows.get(cost["case"], {}).get("free_blocks")),
        }
        | {key: format_number(cost.get(key), 3) for key in (*SECONDS, "seconds")}
        | {key: format_number(cost.get(key)) for key in counted}
        for cost in spent
    ]


def units(table: CampaignTable) -> str:
    """Return the quantity and unit of the reactions, for all units that occur."""
    present = dict.fromkeys(str(row.get("unit") or "") for row in table.rows if not failed(row))
    return "; ".join(QUANTITY.get(unit, QUANTITY["N"]) for unit in present)
