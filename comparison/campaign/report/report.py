"""The report of a campaign: one self-contained offline HTML page, the same as Markdown that diffs well, and as JSON."""

import base64
import json
from pathlib import Path
from typing import Any

from comparison.campaign.figures.campaign_figures import KINDS, Drawing, draw_campaign
from comparison.campaign.mechanism_changes import change_view, letters, mechanism_changes_along
from comparison.campaign.report import rows
from comparison.campaign.report.verdict_matrix import matrix_panels
from comparison.campaign.report.yade_versions import with_versions
from comparison.campaign.row_groups import sweeps_of
from comparison.campaign.row_values import deviation, difference, failed, prediction, worst_first
from comparison.campaign.table import CampaignTable
from comparison.judge import without_undefined
from comparison.report import flat, template_environment
from comparison.run_folder import write_text

LIMITATIONS = (
    "What one case cannot say, no campaign of such cases can: each case's own report lists what its comparison leaves open.",
    "A difference is measured here by what sliding joints are allowed, 1 % of YADE's reaction or 1e-4 of the weight, and YADE's "
    "uncertainty, so that cases can be put in an order; the verdict is that of the case's own checks, which judge more than the reaction.",
    "A mechanism's label is the set of blocks that move. Blocks that barely move may or may not be counted: two labels that differ "
    "need not be two mechanisms, least of all in a large wall.",
    "A mechanism changes somewhere between two neighbouring values of a parameter; where between them, more values would say.",
    "Seconds are those of the machine that ran the cases, several at a time: they compare methods and cases, not machines.",
)


def write_campaign_report(table: CampaignTable) -> Path:
    """Write report.html, report.md and report.json, with figures/, into the campaign's folder; returns the page's path.

    Each file is whole or the one that was there before.
    """
    table = with_versions(table)
    page = _page(table, draw_campaign(table))
    for name in ("report.md", "report.html"):
        write_text(table.folder / name, template_environment(name).get_template(f"campaign.{name.split('.')[1]}.j2").render(page))
    text = json.dumps(stored_campaign_report(table), indent=2, sort_keys=True, ensure_ascii=False, allow_nan=False)
    write_text(table.folder / "report.json", text + "\n")
    return table.folder / "report.html"


def stored_campaign_report(table: CampaignTable) -> dict[str, Any]:
    """What report.json holds: the table, and what the report makes of it."""
    found = sweeps_of(table)
    lettered = letters(found)
    worst = [
        {"case": row.get("case"), "prediction": prediction(row), "difference": difference(row), "deviation": deviation(row)}
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
                "mechanism_changes": [change_view(change, lettered) for change in mechanism_changes_along(found)],
                "provenance": table.provenance,
            }
        )
    )


def _page(table: CampaignTable, drawn: list[Drawing]) -> dict[str, Any]:
    """Everything that the templates show, by name."""
    found = sweeps_of(table)
    lettered = letters(found)
    return {
        "title": table.title or "Campaign",
        "cases": len(table.rows),
        "counts": rows.counts(table),
        "units": rows.units(table),
        "panels": matrix_panels(table),
        "figures": {kind: [_figure(one) for one in drawn if one.kind == kind] for kind in KINDS},
        "compared": rows.compared(table),
        "failures": rows.failures(table),
        "changes": list(rows.changed(table, list(mechanism_changes_along(found)), lettered)),
        "mechanisms": list(rows.mechanisms(table, lettered)),
        "classic": list(rows.classic(table)),
        "totals": list(rows.totals(table)),
        "dearest": rows.dearest(table),
        "limitations": LIMITATIONS,
        "provenance": list(flat(table.provenance)),
    }


def _figure(drawn: Drawing) -> dict[str, str]:
    data = base64.b64encode(drawn.content).decode()
    return {"kind": drawn.kind, "caption": drawn.caption, "path": drawn.path, "data": f"data:image/png;base64,{data}"}
