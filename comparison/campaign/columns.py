"""Columns of a campaign's tables: their names, units and meanings, and their values for one case."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any, Literal, NamedTuple

Kind = Literal["text", "number", "count"]


class Column(NamedTuple):
    """Description of a column.

    Attributes
    ----------
    unit : str
        Unit of its values; "" without one.
    meaning : str
        One phrase for the pages and the HDF5 file.
    kind : str
        Type of all its values: 'text', 'number' or 'count'. It does not depend on the outcomes; an undefined value is None.
    """

    unit: str
    meaning: str
    kind: Kind = "text"


METHODS = ("associated", "coulomb", "yade")
ANSWER = "as column unit says"  # N, N m or a pure number, depending on the scene

BEFORE_KEYS = {
    "case": Column("", "name of the case, unique in the campaign"),
    "sweep": Column(
        "", "name of the case's sweep; by default the name of its scene, after its folder's name where two scenes have one name"
    ),
    "scene": Column("", "original scene of the case"),
}
AFTER_KEYS = {
    "state": Column("", "done or failed"),
    "verdict": Column("", "agree, disagree, inconclusive, cannot stand; where YADE was not run, expected or unexpected; empty without one"),
    "reason": Column("", "reason for any other verdict than agree, or for the failure"),
    "next_step": Column("", "what to do next; empty where both methods agree or nothing was compared"),
    "unit": Column("", "unit of the answers: N, N m for a turning support, empty for a multiplier"),
    "weight": Column("N", "weight W of the free blocks and of the loads on them", "number"),
    "least_tolerance": Column(
        ANSWER, "always allowed difference: 1e-4 of the weight, of a moment times the size of a mean block; 1e-4 for multipliers", "number"
    ),
    "free_blocks": Column("", "free blocks of the scene", "count"),
    "associated_status": Column("", "how associated limit analysis ended"),
    "least": Column(ANSWER, "least reaction, or the multiplier, of associated limit analysis at the methods' shared inset", "number"),
    "greatest": Column(ANSWER, "greatest reaction by associated limit analysis at that inset", "number"),
    "coulomb_status": Column("", "how the Coulomb prediction ended"),
    "coulomb": Column(ANSWER, "Coulomb prediction at that inset", "number"),
    "coulomb_uncertainty": Column(ANSWER, "uncertainty that the Coulomb prediction states", "number"),
    "coulomb_released": Column(ANSWER, "Coulomb prediction after turning blocks have released thrusts; empty where unknown", "number"),
    "coulomb_released_uncertainty": Column(ANSWER, "uncertainty of coulomb_released", "number"),
    "coulomb_peak": Column(
        "", "greatest multiplier on the way to the plateau of the prediction; empty where it does not exceed the plateau", "number"
    ),
    "coulomb_peak_uncertainty": Column("", "uncertainty of coulomb_peak", "number"),
    "coulomb_plateaus": Column("", "number of plateaus on which the paths of the prediction end", "count"),
    "coulomb_low": Column(ANSWER, "least value that the mechanism of the prediction allows", "number"),
    "coulomb_high": Column(ANSWER, "greatest value that the mechanism of the prediction allows", "number"),
    "coulomb_sharp": Column(
        ANSWER, "Coulomb prediction for sharp edges; empty where joints slide and the scene's edges are rounded", "number"
    ),
    "yade_status": Column("", "how YADE's run ended"),
    "yade": Column(ANSWER, "reaction on YADE's plateau", "number"),
    "yade_uncertainty": Column(ANSWER, "uncertainty of YADE's reaction", "number"),
    "classic": Column(ANSWER, "converged value of the classic iteration at that inset", "number"),
    "classic_status": Column("", "solved where the classic iteration converged, inaccurate where it did not, else how it ended"),
    "classic_iterations": Column("", "programmes that the classic iteration solved", "count"),
}
MEASURES = {  # by the column's ending: (name in comparison.json, column)
    "participation": ("participation_index", Column("", "how evenly the interfaces share the dissipation, from 1/J to 1", "number")),
    "moving_mass": ("moving_mass_share", Column("", "mass of the moving blocks over that of all free blocks", "number")),
    "opening": ("opening", Column("", "contact points that open", "count")),
    "sliding": ("sliding", Column("", "contact points that slide", "count")),
    "sticking": ("sticking", Column("", "contact points that stick", "count")),
    "dissipation": (
        "dissipated_power",
        Column(ANSWER, "power of friction per unit motion of the support, or unit power of the live load", "number"),
    ),
}
MECHANISM = "moving blocks, as their number and a digest of their names: equal for equal sets"
COSTS = {
    "case": Column("", "name of the case"),
    "seconds": Column("s", "wall time of the whole case, figures and report included", "number"),
    "limit_analysis_seconds": Column("s", "solver time of both bounds and the prediction, for both insets", "number"),
    "associated_iterations": Column("", "solver iterations of one bound", "count"),
    "coulomb_iterations": Column("", "Newton iterations of the prediction", "count"),
    "classic_seconds": Column("s", "solver time of the classic iteration", "number"),
    "classic_iterations": Column("", "programmes that the classic iteration solved", "count"),
    "yade_seconds": Column("s", "wall time inside YADE", "number"),
    "yade_steps": Column("", "time steps of YADE", "count"),
}


def result_columns(keys: Sequence[str], numeric: Collection[str] = ()) -> dict[str, Column]:
    """Return every column of results.csv in order.

    keys: varied keys of the campaign. numeric: the varied keys whose values are all numbers.
    """
    columns = dict(BEFORE_KEYS)
    for key in keys:
        columns[key] = Column("as in the scene file", "key of the scene that the campaign varies", "number" if key in numeric else "text")
    columns |= AFTER_KEYS
    for method in METHODS:
        for name, (_, measure) in MEASURES.items():
            columns[f"{method}_{name}"] = measure._replace(meaning=f"{method}: {measure.meaning}")
        columns[f"{method}_mechanism"] = Column("", f"{method}: {MECHANISM}")
    return columns


def answers_of(summary: Mapping[str, Any], labels: Mapping[str, str | None]) -> dict[str, Any]:
    """Return the answers of a row of results.csv; None where undefined.

    summary: object of comparison.json. labels: labels of the mechanisms, by method.
    """
    answers, yade = summary["limit_analysis"], summary["yade"] or {}
    main, predicted = answers["associated"], answers["coulomb"] or {}  # at the insets of limit analysis itself
    associated, coulomb = main.get("shared_inset") or main, predicted.get("shared_inset") or predicted
    name = "multiplier" if "multiplier" in main else "reaction"
    low, high = coulomb.get(f"{name}_interval") or (None, None)
    row = {
        "verdict": summary["verdict"],
        "reason": summary["reason"],
        "next_step": summary.get("next_step") or "",
        "unit": summary["unit"],
        "weight": summary["weight"],
        "least_tolerance": summary.get("least_tolerance"),
        "free_blocks": summary["free_blocks"],
        "associated_status": main["status"],
        "least": associated.get(name),
        "greatest": associated.get("reaction_max"),
        "coulomb_status": predicted.get("status"),
        "coulomb": coulomb.get(name),
        "coulomb_uncertainty": coulomb.get("uncertainty"),
        "coulomb_released": coulomb.get("released"),
        "coulomb_released_uncertainty": coulomb.get("released_uncertainty"),
        "coulomb_peak": coulomb.get("peak"),
        "coulomb_peak_uncertainty": coulomb.get("peak_uncertainty"),
        "coulomb_plateaus": len(plateaus) or 1 if (plateaus := coulomb.get("plateaus")) is not None else None,
        "coulomb_low": low,
        "coulomb_high": high,
        "coulomb_sharp": predicted.get(f"{name}_sharp"),
        "yade_status": yade.get("status"),
        "yade": yade.get("reaction"),
        "yade_uncertainty": yade.get("uncertainty"),
    }
    for method in METHODS:
        measures = summary["mechanism_measures"].get(method) or {}
        row |= {f"{method}_{ending}": measures.get(name) for ending, (name, _) in MEASURES.items()}
        row[f"{method}_mechanism"] = labels.get(method)
    return row


def costs_of(summary: Mapping[str, Any]) -> dict[str, Any]:
    """Return the costs of a row of costs.csv; summary: object of comparison.json."""
    answers, yade = summary["limit_analysis"], summary["yade"] or {}
    associated, coulomb = answers["associated"], answers["coulomb"] or {}
    return {
        "limit_analysis_seconds": associated["seconds"] + (coulomb.get("seconds") or 0.0),
        "associated_iterations": associated["iterations"],
        "coulomb_iterations": coulomb.get("iterations"),
        "yade_seconds": yade.get("seconds"),
        "yade_steps": yade.get("steps"),
    }
