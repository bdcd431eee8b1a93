"""The content of one scene in the report: verdict, numbers, figures and evidence, ready for the templates."""

import base64
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

from comparison.numbers import DASH, exists, format_number, half_width, interval_words, several_plateaus, signed, value_range
from comparison.report.details import accuracy_rows, costs, energies, measures
from comparison.report.templating import flat
from comparison.report.viewer import embedded

VERDICTS = {"agree": ("✓", "agree"), "disagree": ("✗", "disagree"), "inconclusive": ("?", "inconclusive"), None: (DASH, "not compared")}
FIGURES = {
    "assembly": "The structure: blocks by role, interfaces with their contact points, and the motion or load that drives it.",
    "mechanisms": "Mechanisms of both methods for the same motion of the support; marks show contact points that open or slide.",
    "reaction": "Reaction against settlement from rest, or live load against displacement. YADE: the record, and its plateau "
    "extrapolated to the undeformed geometry. Limit analysis: the associated bounds and, where known, the Coulomb prediction with its "
    "uncertainty, the interval of reactions that its mechanism allows, and its curve from rest on joints of the same stiffness.",
    "dissipation": "Where friction dissipates in limit analysis' mechanism: joints by power, contact points by state.",
    "animation": "The settlement as an animation: mechanisms of both methods, and YADE's recorded reaction.",
}
EVIDENCE = {
    "equilibrium_residual": "largest unbalanced force, over the mean block weight",
    "cone_violation": "largest tension or excess of friction, over the mean block weight",
    "mechanism_violation": "largest violation of the flow rule, over the fastest block's speed",
    "duality_gap": "reaction from forces less reaction from work, over the mean block weight",
}
COULOMB_EVIDENCE = {
    "equilibrium_residual": EVIDENCE["equilibrium_residual"],
    "cone_violation": EVIDENCE["cone_violation"],
    "dilatancy_residual": "power of the normal forces at parting joints, over the power put in",
    "sliding_residual": "dissipation less the power of friction against the slip, over the power put in",
    "strain_residual": "power of the weights less dissipation and power of the reaction, over the power put in",
    "drift": "relative change of the mean value from the second quarter of the travel to its second half",
    "travel": "motion of the support at the end of the path, over YADE's travel",
}


def view_of_scene(folder: Path, index: int, comparison: dict[str, Any]) -> dict[str, Any]:
    """Return everything that the templates show of one scene, by name; the templates only lay it out.

    Parameters
    ----------
    folder : Path
        Folder of the run; the scene's figures and its interactive view are in `folder/<scene>/`.
    index : int
        Number of the scene on the page, from 1; its section has the anchor `scene-<index>`.
    comparison : dict
        The content of the scene's `comparison.json`. Parts that are missing leave their part of the view empty.
    """
    scene = str(comparison.get("scene"))
    symbol, word = VERDICTS.get(comparison.get("verdict"), VERDICTS[None])
    results = _results(comparison)
    return {
        "anchor": f"scene-{index}",
        "name": scene,
        "title": comparison.get("title") or scene,
        "source": comparison.get("source") or "",
        "symbol": symbol,
        "word": word,
        "sentence": _sentence(comparison),
        "first_prediction": (comparison.get("first_prediction") or {}).get("sentence") or "",
        "notes": comparison.get("notes") or [],
        "warnings": comparison.get("warnings") or [],
        "checks": [_check_view(check) for check in comparison.get("checks") or []],
        "figures": list(_figures(folder / scene, scene)),
        "view": embedded(folder / scene),
        "results": results,
        "expected": list(_expected(comparison)),
        "rounding": _rounding(comparison),
        "costs": list(costs(comparison, results, EVIDENCE)),
        "accuracy": list(accuracy_rows(comparison)),
        "energies": energies(comparison),
        "measures": list(measures(comparison, results["live"])),
        "model": list(_model(comparison)),
        "effects": list(_effects(comparison)),
        "evidence": list(_evidence(comparison)),
        "settings": list(flat(comparison.get("settings") or {})),
        "provenance": list(flat(comparison.get("provenance") or {})),
    }


def _associated(comparison: dict[str, Any]) -> dict[str, Any]:
    return (comparison.get("limit_analysis") or {}).get("associated") or {}


def _results(comparison: dict[str, Any]) -> dict[str, Any]:
    """Return both methods' numbers at the shared inset: bounds, YADE's reaction, difference, seconds.

    Undefined numbers are None.
    """
    associated, yade = _associated(comparison), comparison.get("yade") or {}
    shared = associated.get("shared_inset") or associated
    live = "multiplier" in associated
    coulomb = (comparison.get("limit_analysis") or {}).get("coulomb") or {}
    quantity = "multiplier" if live else "reaction"
    shared_coulomb = coulomb.get("shared_inset") or coulomb
    predicted, (low, high) = shared_coulomb.get(quantity), shared_coulomb.get(f"{quantity}_interval") or (None, None)
    unit = comparison.get("unit", "" if live else "N")
    least, recorded = shared.get("reaction"), yade.get("reaction")
    nearest = predicted if exists(predicted) else least
    reactions = {
        "least": least,
        "greatest": shared.get("reaction_max"),
        "yade": recorded,
        "uncertainty": yade.get("uncertainty"),
        "coulomb": predicted,
        "coulomb_uncertainty": shared_coulomb.get("uncertainty"),
        "difference": recorded - nearest if exists(nearest) and exists(recorded) else None,
    }
    weight = comparison.get("weight")
    ratios = {name: value / weight if exists(value) and weight else None for name, value in reactions.items()}
    unbounded = associated.get("reaction_max_status") == "unbounded"
    return reactions | {
        "ratios": ratios,
        "unit": unit,
        "ratio_unit": "of W" if unit == "N" else "m, over W",
        "bounds": value_range(reactions["least"], reactions["greatest"], unbounded, 5),
        "bounds_over_weight": value_range(ratios["least"], ratios["greatest"], unbounded, 4),
        "interval": interval_words(low, high, unit),
        "plateaus": several_plateaus(shared_coulomb.get("plateaus"), unit),
        "half_width": half_width(low, high),
        "less": "Coulomb" if exists(predicted) else "R_min",
        "coulomb_status": coulomb.get("status") or DASH,
        "live": live,
        "multiplier": associated.get("multiplier"),
        "status": associated.get("status") or DASH,
        "yade_status": yade.get("status") or "not run",
        "limit_analysis_seconds": _sum(associated.get("seconds"), coulomb.get("seconds")),
        "yade_seconds": yade.get("seconds"),
    }


def _sum(*values: Any) -> float | None:
    defined = [value for value in values if exists(value)]
    return sum(defined) if defined else None


def _sentence(comparison: dict[str, Any]) -> str:
    """Return the verdict and its reason as sentences."""
    verdict, reason = comparison.get("verdict"), comparison.get("reason") or ""
    agreement = "The two methods agree." if comparison.get("yade") else "Limit analysis agrees with the expected value; YADE was not run."
    openings = {"agree": agreement, "disagree": "The comparison fails.", "inconclusive": "No verdict can be given."}
    return f"{openings.get(str(verdict), 'Nothing was compared.')} {reason}".strip()


def _check_view(check: dict[str, Any]) -> dict[str, Any]:
    symbol, word = VERDICTS.get(check.get("verdict"), VERDICTS[None])
    names = ("name", "limit_analysis", "yade", "difference", "tolerance")
    return {name: check.get(name) for name in names} | {
        "symbol": symbol, "word": word, "unit": check.get("unit") or "", "reason": check.get("reason") or "",
    }  # fmt: skip


def _figures(folder: Path, scene: str) -> Iterator[dict[str, str]]:
    for name, caption in FIGURES.items():
        kind = "gif" if name == "animation" else "png"
        path = folder / f"{name}.{kind}"
        if path.is_file():
            data = f"data:image/{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"
            yield {"name": name, "caption": caption, "path": f"{quote(scene)}/{path.name}", "data": data}


def _expected(comparison: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield each expected value beside limit analysis' value for sharp arrises, or for the scene's where only that is known."""
    expected, associated = comparison.get("expected") or {}, _associated(comparison)
    prediction = (comparison.get("limit_analysis") or {}).get("coulomb") or associated
    weight = comparison.get("weight")

    def over(value: Any) -> float | None:
        return value / weight if exists(value) and weight else None

    def sharpest(quantity: str) -> Any:
        sharp = prediction.get(f"{quantity}_sharp")
        return sharp if exists(sharp) else prediction.get(quantity)

    answers = {
        "reaction_over_weight": ("R / W", over(sharpest("reaction"))),
        "associated_reaction_over_weight": ("R_min / W, associated", over(associated.get("reaction_sharp"))),
        "reaction_max_over_weight": ("R_max / W, associated", over(associated.get("reaction_max_sharp"))),
        "multiplier": ("multiplier", sharpest("multiplier")),
        "associated_multiplier": ("multiplier, associated", associated.get("multiplier_sharp")),
    }
    for key, (name, value) in answers.items():
        if exists(expected.get(key)):
            yield {"name": name, "expected": expected[key], "found": value} | {k: expected.get(k) for k in ("tolerance", "kind")}


def _rounding(comparison: dict[str, Any]) -> str:
    """Return the influence of the inset on the associated answer as a sentence; "" where the inset is 0 or unknown."""
    associated, results = _associated(comparison), _results(comparison)
    shared = associated.get("shared_inset") or associated
    quantity = "multiplier" if results["live"] else "reaction"
    sharp, rounded, inset = associated.get(f"{quantity}_sharp"), shared.get(quantity), shared.get("inset")
    if not (exists(sharp) and exists(rounded) and exists(inset)) or inset == 0.0:
        return ""
    change = rounded - sharp
    share = f" ({signed(100.0 * change / abs(sharp), 2)} %)" if abs(sharp) > abs(change) else ""
    unit = f" {results['unit']}".rstrip()
    return (
        f"An inset of {format_number(1e3 * inset, 3)} mm changes the associated {quantity} "
        f"from {format_number(sharp, 5)}{unit} for sharp arrises "
        f"to {format_number(rounded, 5)}{unit}: {signed(change, 3)}{unit}{share}."
    )


def _model(comparison: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the size of the model as pairs of name and text."""
    yield "weight of the free blocks, W", f"{format_number(comparison.get('weight'), 5)} N"
    for name, label in (("free_blocks", "free blocks"), ("interfaces", "interfaces"), ("contact_points", "contact points")):
        yield label, format_number(comparison.get(name))


def _effects(comparison: dict[str, Any]) -> Iterator[dict[str, str]]:
    """Yield one row an effect: on or off, how it is modelled, why, and the savings without it or its time in seconds."""
    for row in (comparison.get("effects") or {}).get("table") or []:
        saved = ", ".join(f"{format_number(count)} {name}" for name, count in (row.get("saved") or {}).items())
        took = f"took {format_number(row['seconds'], 2)} s" if exists(row.get("seconds")) else ""
        yield {
            "effect": str(row.get("effect")),
            "what": str(row.get("what")),
            "state": "on" if row.get("on") else "off",
            "modelled": str(row.get("modelled")),
            "reason": str(row.get("reason") or ""),
            "cost": f"saves {saved}" if saved else took or DASH,
        }


def _evidence(comparison: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the residuals of the associated and of the Coulomb answer, with their meanings."""
    coulomb = (comparison.get("limit_analysis") or {}).get("coulomb") or {}
    for method, answer, meanings in (("associated", _associated(comparison), EVIDENCE), ("Coulomb", coulomb, COULOMB_EVIDENCE)):
        for name, meaning in meanings.items():
            if name in answer:
                yield f"{method}: {meaning}", format_number(answer[name], 2)
