"""Columns of a campaign's tables: their names, units and meanings, and what each holds of one case."""

from collections.abc import Mapping, Sequence
from typing import Any

METHODS = ("associated", "coulomb", "yade")
ANSWER = "as column unit says"  # N, N m or a pure number, by what the scene asks for

BEFORE_KEYS = {
    "case": ("", "name of the case, unique in the campaign"),
    "sweep": ("", "name of the sweep that the case is of: its own, or its scene's"),
    "scene": ("", "scene that the case is made from"),
}
AFTER_KEYS = {
    "state": ("", "done or failed"),
    "verdict": ("", "agree, disagree or inconclusive; empty where nothing was compared"),
    "reason": ("", "why not agree, or why the case failed"),
    "unit": ("", "unit of the answers: N, N m for a turning support, empty for a multiplier"),
    "weight": ("N", "weight of the free blocks"),
    "free_blocks": ("", "free blocks of the scene"),
    "associated_status": ("", "how the associated programme ended"),
    "least": (ANSWER, "least reaction, or the multiplier, by associated limit analysis at the inset that both methods share"),
    "greatest": (ANSWER, "greatest reaction by associated limit analysis at that inset"),
    "coulomb_status": ("", "how the Coulomb prediction ended"),
    "coulomb": (ANSWER, "Coulomb prediction at that inset"),
    "coulomb_low": (ANSWER, "least value that its mechanism allows"),
    "coulomb_high": (ANSWER, "greatest value that its mechanism allows"),
    "coulomb_sharp": (ANSWER, "Coulomb prediction for sharp arrises"),
    "yade_status": ("", "how YADE's run ended"),
    "yade": (ANSWER, "reaction on YADE's plateau"),
    "yade_uncertainty": (ANSWER, "its uncertainty"),
    "classic": (ANSWER, "value that the classic iteration converged to at that inset"),
    "classic_status": ("", "solved where the classic iteration converged, inaccurate where it did not, else how it ended"),
    "classic_iterations": ("", "programmes of the classic iteration"),
}
MEASURES = {  # column's ending: (name in comparison.json, unit, meaning)
    "participation": ("participation_index", "", "how evenly the interfaces share the dissipation, from 1/J to 1"),
    "moving_mass": ("moving_mass_share", "", "mass of the moving blocks over that of all free blocks"),
    "opening": ("opening", "", "contact points that open"),
    "sliding": ("sliding", "", "contact points that slide"),
    "sticking": ("sticking", "", "contact points that stick"),
    "dissipation": ("dissipated_power", ANSWER, "power of friction per unit motion of the support, or unit power of the live load"),
}
MECHANISM = "moving blocks, as their number and a digest of their names: equal for equal sets"
COSTS = {
    "case": ("", "name of the case"),
    "seconds": ("s", "wall time of the whole case, figures and report included"),
    "limit_analysis_seconds": ("s", "solver time of both bounds and the prediction, for both insets"),
    "associated_iterations": ("", "solver iterations of one bound"),
    "coulomb_iterations": ("", "associated programmes of the prediction"),
    "classic_seconds": ("s", "solver time of the classic iteration"),
    "classic_iterations": ("", "its programmes"),
    "yade_seconds": ("s", "wall time inside YADE"),
    "yade_steps": ("", "time steps of YADE"),
}


def result_columns(keys: Sequence[str]) -> dict[str, tuple[str, str]]:
    """Every column of results.csv in order, with unit and meaning; `keys` are the varied ones."""
    columns = BEFORE_KEYS | dict.fromkeys(keys, ("as in the scene file", "key of the scene that the campaign varies")) | AFTER_KEYS
    for method in METHODS:
        columns |= {f"{method}_{name}": (unit, f"{method}: {meaning}") for name, (_, unit, meaning) in MEASURES.items()}
        columns[f"{method}_mechanism"] = ("", f"{method}: {MECHANISM}")
    return columns


def answers_of(summary: Mapping[str, Any], labels: Mapping[str, str | None]) -> dict[str, Any]:
    """What a row takes from an object of comparison.json; None where undefined. labels: of the mechanisms, by method."""
    answers, yade = summary["limit_analysis"], summary["yade"] or {}
    own, own_coulomb = answers["associated"], answers["coulomb"] or {}
    associated, coulomb = own.get("shared_inset") or own, own_coulomb.get("shared_inset") or own_coulomb
    name = "multiplier" if "multiplier" in own else "reaction"
    low, high = coulomb.get(f"{name}_interval") or (None, None)
    row = {
        "verdict": summary["verdict"],
        "reason": summary["reason"],
        "unit": summary["unit"],
        "weight": summary["weight"],
        "free_blocks": summary["free_blocks"],
        "associated_status": own["status"],
        "least": associated.get(name),
        "greatest": associated.get("reaction_max"),
        "coulomb_status": own_coulomb.get("status"),
        "coulomb": coulomb.get(name),
        "coulomb_low": low,
        "coulomb_high": high,
        "coulomb_sharp": own_coulomb.get(f"{name}_sharp"),
        "yade_status": yade.get("status"),
        "yade": yade.get("reaction"),
        "yade_uncertainty": yade.get("uncertainty"),
    }
    for method in METHODS:
        measures = summary["mechanism_measures"].get(method) or {}
        row |= {f"{method}_{ending}": measures.get(found) for ending, (found, _, _) in MEASURES.items()}
        row[f"{method}_mechanism"] = labels.get(method)
    return row


def costs_of(summary: Mapping[str, Any]) -> dict[str, Any]:
    """What a row of costs takes from an object of comparison.json."""
    answers, yade = summary["limit_analysis"], summary["yade"] or {}
    associated, coulomb = answers["associated"], answers["coulomb"] or {}
    return {
        "limit_analysis_seconds": associated["seconds"] + (coulomb.get("seconds") or 0.0),
        "associated_iterations": associated["iterations"],
        "coulomb_iterations": coulomb.get("iterations"),
        "yade_seconds": yade.get("seconds"),
        "yade_steps": yade.get("steps"),
    }
