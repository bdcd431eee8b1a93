"""Made-up comparisons with hostile texts for tests of reports, and their pages."""

from pathlib import Path
from typing import Any

from comparison.report import report

HOSTILE = '<script>alert(1)</script> | `a` "b" https://example.org'
NUMBERS = ("limit_analysis", "yade", "difference", "tolerance")


def comparison_of(**changes: Any) -> dict[str, Any]:
    return {
        "scene": "two pads",
        "title": HOSTILE,
        "source": HOSTILE,
        "weight": 2158.2,
        "unit": "N",
        "free_blocks": 1,
        "interfaces": 2,
        "contact_points": 4,
        "effects": {
            "plane": True,
            "friction": "coulomb",
            "reasons": {"plane": HOSTILE},
            "table": [
                {"effect": "plane", "what": HOSTILE, "on": False, "modelled": "plane", "reason": HOSTILE, "saved": {"unknowns": 3}}
                | {"seconds": None},
                {"effect": "friction", "what": "sliding", "on": True, "modelled": "coulomb", "reason": "", "saved": {}, "seconds": 0.25},
            ],
        },
        "expected": {"reaction_over_weight": 0.16667, "reaction_max_over_weight": None, "tolerance": 1e-4, "kind": "exact"},
        "limit_analysis": {
            "associated": {
                "status": "solved", "reaction": 363.3, "reaction_max": 2153.9, "reaction_max_status": "solved", "reaction_sharp": 359.7,
                "reaction_max_sharp": 2158.2, "inset": 0.001, "equilibrium_residual": 1e-12, "cone_violation": 0.0,
                "mechanism_violation": 0.0, "duality_gap": 1e-10, "iterations": 7, "seconds": 0.01,
            },
            "coulomb": None,
        },
        "yade": {"status": "plateau", "reaction": 363.5, "uncertainty": 0.3, "steps": 34233, "seconds": 8.1, "slope": float("nan")},
        "checks": [
            {"name": HOSTILE, "verdict": "agree", "unit": "N", "reason": ""} | dict(zip(NUMBERS, (363.3, 363.5, 0.2, 3.6), strict=True)),
            {"name": "unknown", "verdict": "inconclusive", "unit": "", "reason": HOSTILE} | dict.fromkeys(NUMBERS),
        ],
        "verdict": "inconclusive",
        "reason": HOSTILE,
        "notes": [HOSTILE],
        "settings": {"time_step": 1e-6, "name": HOSTILE},
        "provenance": {"python": "3.11"},
        **changes,
    }  # fmt: skip


def values_part(page: str) -> str:
    """Return the table of both methods' values of the first scene."""
    part = page[page.index('id="scene-1-values"') :]
    return part[: part.index("</table>")]


def frictional_comparison(**changes: Any) -> dict[str, Any]:
    """Return a comparison with all entries of a scene with sliding joints."""
    comparison = comparison_of(title="A wall", source="", reason="", notes=[], checks=[], **changes)
    comparison["limit_analysis"]["coulomb"] = {
        "status": "solved", "reaction": 366.0, "reaction_interval": [363.3, 371.3], "reaction_sharp": 362.0,
        "reaction_interval_sharp": [360.0, 368.0], "reaction_at_rest": 800.0, "drift": 1.5e-5, "dilatancy_residual": 2.5e-6,
        "strain_residual": 3.5e-5, "equilibrium_residual": 1e-10, "cone_violation": 0.0, "iterations": 19, "seconds": 0.23,
        "uncertainty": 0.75, "plateaus": [], "steps": 1207, "travel": 2.0, "viscosities": [0.01, 0.001], "sliding_residual": 0.0,
    }  # fmt: skip
    comparison["limit_analysis"]["path"] = {
        "settlement": [0.0, 1e-5, 1e-4], "reaction": [800.0, 500.0, 366.1], "strain_residual": [None, 4.5e-4, 2e-4],
        "converged": [True, False, True], "solves": [2, 30, 11], "seconds": 0.57,
    }  # fmt: skip
    counts = {"opening": 2.0, "sliding": 8.0, "sticking": 3.0, "idle": 1.0}
    measures = {"dissipated_power": 51.25, "dissipated_share": 0.1375, "participation_index": 0.0815, "moving_mass_share": 0.25}
    comparison["mechanism_measures"] = {
        "associated": {**measures, **counts, "participation_index": 0.9125},
        "coulomb": {**measures, **counts},
        "yade": dict.fromkeys((*measures, *counts)),
    }
    return comparison


def page_and_markdown(folder: Path, comparison: dict[str, Any]) -> tuple[str, str]:
    page = report.write_report(folder, [comparison], {}).read_text(encoding="utf-8")
    return page, (folder / "report.md").read_text(encoding="utf-8")
