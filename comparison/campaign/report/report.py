"""The report of a campaign: one self-contained offline HTML page, and the same as Markdown and as JSON."""

import json
from pathlib import Path
from typing import Any

from comparison.campaign.figures.campaign_figures import KINDS, Drawing, draw_campaign
from comparison.campaign.mechanism_changes import change_view, letters, mechanism_changes_along
from comparison.campaign.report import rows
from comparison.campaign.report.verdict_matrix import matrix_panels
from comparison.campaign.report.yade_versions import with_versions
from comparison.campaign.row_groups import sweeps_of
from comparison.campaign.row_values import compared_with, deviation, difference, failed, worst_first
from comparison.campaign.table import CampaignTable
from comparison.judge import without_undefined
from comparison.report import flat, image_address, template_environment
from comparison.run_folder import write_text

ORDER = (
    "Cases are sorted by |YADE − prediction| over the allowed difference. It is 0.5 % of YADE's value, at least 1e-4 of the weight "
    "(for a moment, times the size of a mean block; for a multiplier, 1e-4), plus the uncertainties that both methods state. The verdict "
    "comes from all checks of the case."
)
LIMITATIONS = (
    "A campaign has the limitations of its cases: each case's own report lists those of its comparison.",
    "A mechanism's label is the set of blocks that move. A block that barely moves may or may not be counted: two different "
    "labels need not be two mechanisms, above all in a large wall.",
    "A mechanism changes somewhere between two neighbouring values of a parameter; more values would locate the change.",
    "Seconds depend on the machine, and on how many cases it ran at a time: they compare methods and cases, not machines.",
)


def write_campaign_report(table: CampaignTable) -> Path:
    """Write report.html, report.md and report.json, with figures/, into the campaign's folder; returns the page's path.

    Each file is replaced as a whole.
    """
    table = with_versions(table)
    page = _page(table, draw_campaign(table))
    for name in ("report.md", "report.html"):
        write_text(table.folder / name, template_environment(name).get_template(f"campaign.{name.split('.')[1]}.j2").render(page))
    text = json.dumps(stored_campaign_report(table), indent=2, sort_keys=True, ensure_ascii=False, allow_nan=False)
    write_text(table.folder / "report.json", text + "\n")
    return table.folder / "report.html"


def stored_campaign_report(table: CampaignTable) -> dict[str, Any]:
    """Return the content of report.json: the table, and the report's evaluation of it."""
    sweeps = sweeps_of(table)
    lettered = letters(sweeps)
    worst = [
        {"case": row.get("case"), "prediction": compared_with(row), "difference": difference(row), "deviation": deviation(row)}
        for row in worst_first([row for row in table.rows if not failed(row)])
    ]
    return dict(
        without_undefined(
            {
                "title": table.title,
                "counts": {item["word"]: item["count"] for item in rows.counts(table)},
                "axes": table.axes,
                "rows": table.rows,
                "costs": table.costs,
                "worst_first": worst,
                "mechanism_letters": lettered,
                "mechanism_changes": [change_view(change, lettered) for change in mechanism_changes_along(sweeps)],
                "provenance": table.provenance,
            }
        )
    )


def _page(table: CampaignTable, drawn: list[Drawing]) -> dict[str, Any]:
    """Return all values for the templates, by name."""
    sweeps = sweeps_of(table)
    lettered = letters(sweeps)
    return {
        "title": table.title or "Campaign",
        "cases": len(table.rows),
        "unfinished": table.unfinished,
        "counts": (counts := rows.counts(table)),
        "signs": ", ".join(f"{one['symbol']} {one['word']}" for one in counts),
        "units": rows.units(table),
        "panels": matrix_panels(table),
        "methods": "Both methods" if table.ran_yade else "Limit analysis",
        "figures": {kind: [_figure(drawing) for drawing in drawn if drawing.kind == kind] for kind in KINDS},
        "compared": rows.compared(table),
        "order": ORDER,
        "failures": rows.failures(table),
        "changes": list(rows.changed(table, list(mechanism_changes_along(sweeps)), lettered)),
        "mechanisms": list(rows.mechanisms(table, lettered)),
        "mechanism_pictures": list(rows.mechanism_pictures(table, lettered)),
        "classic": list(rows.classic(table)),
        "totals": list(rows.totals(table)),
        "dearest": rows.dearest(table),
        "limitations": LIMITATIONS,
        "provenance": list(flat(table.provenance)),
    }


def _figure(drawn: Drawing) -> dict[str, str]:
    return {"kind": drawn.kind, "caption": drawn.caption, "path": drawn.path, "data": image_address(drawn.content)}
