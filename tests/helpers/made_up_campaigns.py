"""Made-up campaigns for tests of reports and comparisons: tables of cases that never ran, and a parsed page."""

from dataclasses import replace
from html.parser import HTMLParser
from itertools import product
from pathlib import Path
from typing import Any

import pytest

from comparison.campaign.columns import COSTS, METHODS, result_columns
from comparison.campaign.table import CampaignTable

MU, INSET, LAW = "joint.friction", "joint.inset", "effects.friction"
FRICTIONS = [0.2, 0.3, 0.4, 0.5, 0.6]
SHAPES: dict[str, list[dict[str, list[Any]]]] = {
    "one case": [{}],
    "scenes": [{}, {}, {}],
    "one axis": [{MU: FRICTIONS}, {MU: FRICTIONS[:3]}],
    "choices": [{LAW: ["coulomb", "associated"]}],
    "two axes": [{MU: FRICTIONS, INSET: [0.001, 0.002]}],
    "three axes": [{MU: FRICTIONS, INSET: [0.001, 0.002], "wall[0].courses": [4, 6, 8]}],
    "different sweeps": [{MU: FRICTIONS}, {INSET: [0.001, 0.002]}, {MU: FRICTIONS, LAW: ["coulomb", "associated"]}, {}],
    "classic": [{"classic.relaxation": [0.2, 0.6, 1.0], "classic.slope": [0.001, 0.01]}],
    "directions": [{"settlement.direction": [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]}],
}
every_shape = pytest.mark.parametrize("shape", SHAPES)


def row_of(name: str, scene: str, place: dict[str, Any], axes: list[str]) -> dict[str, Any]:
    """Return a case whose reaction falls linearly with friction. Slope and mechanism change at mu = 0.45."""
    friction = place.get(MU, 0.6)
    low = friction < 0.45
    reaction = 1000.0 * (0.5 - (0.3 if low else 0.1) * friction)
    row = dict.fromkeys(result_columns(axes)) | {"case": name, "scene": scene} | place
    row |= {"state": "done", "verdict": "agree", "reason": "", "unit": "N", "weight": 1000.0, "free_blocks": 40}
    row |= {"associated_status": "solved", "least": 0.9 * reaction, "greatest": 3.0 * reaction, "coulomb_status": "solved"}
    row |= {"coulomb": reaction, "coulomb_low": 0.95 * reaction, "coulomb_high": 1.1 * reaction, "coulomb_sharp": reaction}
    row |= {"yade_status": "plateau", "yade": 1.002 * reaction, "yade_uncertainty": 0.001 * reaction}
    if any(key.startswith("classic.") for key in place):
        converges = place["classic.relaxation"] < 1.0
        row |= {"classic": reaction if converges else None, "classic_status": "solved" if converges else "inaccurate"}
        row |= {"classic_iterations": 12 if converges else 100}
    for method in METHODS:
        row |= {f"{method}_mechanism": "30-low" if low else "12-high", f"{method}_participation": 0.3, f"{method}_moving_mass": 0.4}
    return row | {"folder": f"cases/{name}"}


def campaign(folder: Path, shape: str = "one axis", title: str = "A campaign", scene: str = "scene") -> CampaignTable:
    """Return a table of made-up cases. The folder of each case has a page."""
    ranges = SHAPES[shape]
    axes: dict[str, list[Any]] = {}
    for sweep in ranges:
        for key, values in sweep.items():
            axes[key] = [*axes.get(key, []), *(value for value in values if value not in axes.get(key, []))]
    rows = []
    for number, sweep in enumerate(ranges):
        for values in product(*sweep.values()):
            place = dict(zip(sweep, values, strict=True))
            name = "_".join([f"{scene}{number}", *(f"{key}={value}" for key, value in place.items())])
            rows.append(row_of(name, f"{scene}{number}", place, list(axes)))
            (folder / "cases" / name).mkdir(parents=True, exist_ok=True)
            (folder / "cases" / name / "report.html").write_text("a case's page")
    costs = [
        dict.fromkeys(COSTS) | {"case": row["case"], "seconds": 9.0, "limit_analysis_seconds": 0.25, "yade_seconds": 4.0} for row in rows
    ]
    return CampaignTable(title, axes, rows, costs, {"program": {"crosscheck": "0.1.0"}}, folder)


def changed(table: CampaignTable, place: int, /, **values: Any) -> CampaignTable:
    """Return the table with other values in one row."""
    rows = [row | values if k == place else row for k, row in enumerate(table.rows)]
    return replace(table, rows=rows)


def left_out(table: CampaignTable, *places: int, **values: Any) -> CampaignTable:
    """Return the table with some or all cases failed. Failed cases have only the given values."""
    empty = dict.fromkeys(set(result_columns([])) - {"case", "sweep", "scene"}) | {"state": "failed", "reason": "it broke"} | values
    return replace(table, rows=[row | empty if not places or k in places else row for k, row in enumerate(table.rows)])


class Page(HTMLParser):
    """Tags, addresses and text of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.addresses: list[str] = []
        self.text = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.addresses += [value or "" for name, value in attrs if name in ("href", "src")]

    def handle_data(self, data: str) -> None:
        if self.tags[-1:] != ["style"]:
            self.text += data
