"""The content of one scene in the report: verdict, numbers, figures and evidence, ready for the templates."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

from comparison.judge import METHODS
from comparison.numbers import (
    A_POINT,
    DASH,
    Units,
    exists,
    format_number,
    interval_words,
    plain_number,
    range_words,
    small_number,
)
from comparison.report.details import accuracy_rows, costs, energy_view, measures, moving_joints, reactions
from comparison.report.inputs import input_rows, key_rows, scene_file, setting_rows
from comparison.report.plain_words import notes_of, plain_words
from comparison.report.templating import flat, image_address, paper_width
from comparison.report.values import associated_of, expected_rows, range_end, rounding_words, stiffening_of, value_rows, values_of
from comparison.report.viewer import embedded
from comparison.run_folder import name_in_results
from comparison.verdict import VERDICTS, check_words
from la_core.scene import change_rows

OF_FORCES = {"reaction", "forces"}  # figures that are empty where blocks fall
FIGURES = {  # in the order of the page: first the motion, then the values and their causes
    "mechanisms": ("Mechanism", "{moves}"),
    "reaction": ("Reaction", "{reaction}{record}{levels}"),
    "forces": ("Forces", "Resultant force of each joint at its centre of pressure; its length shows its size.{thrust}"),
    "assembly": ("Structure", "Blocks by role, interfaces with their contact points, and the motion or load that drives the structure."),
    "dissipation": ("Friction", "Where friction dissipates in limit analysis' mechanism: joints by power, contact points by state."),
    "animation": ("Animation", "The motion as an animation: the mechanism of each method that was run, and YADE's record."),
}
EVIDENCE = {
    "equilibrium_residual": "largest unbalanced force, over the mean block weight",
    "cone_violation": "largest tension or excess of friction, over the mean block weight",
    "mechanism_violation": "largest violation of the flow rule, over the fastest block's speed",
    "duality_gap": "reaction from forces less reaction from work, over the mean block weight",
}
PASSED = ("agree", "expected")  # verdicts of checks that leave nothing open
COULOMB_EVIDENCE = {
    "equilibrium_residual": EVIDENCE["equilibrium_residual"],
    "cone_violation": EVIDENCE["cone_violation"],
    "dilatancy_residual": "power of the normal forces at parting joints, over the power put in",
    "sliding_residual": "dissipation less the power of friction against the slip, over the power put in",
    "strain_residual": "power of the weights less dissipation and power of the reaction, over the power put in",
    "drift": "relative change of the mean value from the second quarter of the travel to its second half",
    "travel": "motion of the support, or mean displacement along the load, at the end of the path, over YADE's travel",
}


def view_of_scene(folder: Path, index: int, comparison: dict[str, Any], units: Units) -> dict[str, Any]:
    """Return everything that the templates show of one scene, by name; the templates only lay it out.

    Parameters
    ----------
    folder : Path
        Folder of the run; the scene's figures, its interactive view and its copy of the scene are in `folder/<scene>/`.
    index : int
        Number of the scene on the page, from 1; its section has the anchor `scene-<index>`.
    comparison : dict
        The content of the scene's `comparison.json`. Parts that are missing leave their part of the view empty.
    units : Units
        Units of the report.
    """
    scene = name_in_results(comparison)
    symbol, word = VERDICTS.get(comparison.get("verdict"), VERDICTS[None])
    results = values_of(comparison, units)
    checks = [_check_view(check, units) for check in comparison.get("checks") or []]
    text = scene_file(folder / scene)
    return {
        "anchor": f"scene-{index}",
        "name": scene,
        "title": comparison.get("title") or scene,
        "source": comparison.get("source") or "",
        "symbol": symbol,
        "word": word,
        "sentence": units.words(_sentence(comparison)),
        "conclusion": plain_words(comparison, units),
        "next_step": units.words(comparison.get("next_step") or ""),
        "first_prediction": units.words((comparison.get("first_prediction") or {}).get("sentence") or ""),
        "notes": [units.words(note) for note in _notes(comparison)],
        "warnings": comparison.get("warnings") or [],
        "checks": checks,
        "checks_open": [check for check in checks if not check["passed"]],
        "checks_well": [check for check in checks if check["passed"]],
        "figures": list(_figures(folder / scene, scene, comparison)),
        "view": embedded(folder / scene),
        "results": results,
        "quantities": list(value_rows(results)),
        "inputs": input_rows(comparison, units),
        "geometry": list(change_rows(comparison["geometry"])) if comparison.get("geometry") else [],
        "given": key_rows(text) if text else [],
        "scene_file": text,
        "files": list(((comparison.get("structure") or {}).get("files") or {}).items()),
        "expected": list(expected_rows(comparison)),
        "rounding": rounding_words(comparison, units),
        "costs": list(costs(comparison, results, EVIDENCE, units)),
        "accuracy": list(accuracy_rows(comparison)),
        "energy": energy_view(comparison),
        "measures": list(measures(comparison, results["live"], units)),
        "joints": moving_joints(comparison, units),
        "ground": reactions(comparison, units),
        "effects": list(_effects(comparison, units)),
        "evidence": list(_evidence(comparison)),
        "settings": setting_rows(comparison),
        "provenance": list(flat(comparison.get("provenance") or {})),
    }


def _notes(comparison: dict[str, Any]) -> Iterator[str]:
    """Yield the sentences before the figures: earlier attempt, notes, small rotations, joints of one method only."""
    yield from _first_verdict(comparison)
    yield from notes_of(comparison)
    effects = {} if associated_of(comparison).get("status") == "infeasible" else comparison.get("effects") or {}  # a fall is no answer
    if effects.get("friction") == "coulomb" and effects.get("rotation") == "small" and (reason := effects["reasons"].get("rotation")):
        yield f"Rotations of the blocks are small: {reason}."  # results of version 0.2.0 have no reason
    yield from _joint_notes(comparison)


def _joint_notes(comparison: dict[str, Any]) -> Iterator[str]:
    """Yield a sentence for each method whose mechanism opens or slides in joints that rest in the other method's mechanism."""
    for name, alone in ((comparison.get("structure") or {}).get("joints_of_one_method") or {}).items():
        if alone["count"]:
            names, rest = "; ".join(f'"{pair}"' for pair in alone["names"]), alone["count"] - len(alone["names"])
            more = f" and {rest} more" if rest else ""
            yield (
                f"Only in the mechanism of {METHODS.get(name, name)} these joints open or slide: {names}{more}. "
                "Where joints are equal by symmetry, or several mechanisms have the same reaction, both methods may be right."
            )


def _sentence(comparison: dict[str, Any]) -> str:
    """Return the verdict, its reason and the remarks of its checks as sentences."""
    verdict, reason = comparison.get("verdict"), comparison.get("reason") or ""
    openings = {
        "agree": "The two methods agree.",
        "disagree": "The comparison fails.",
        "inconclusive": "No verdict can be given.",
        "expected": "",
        "unexpected": "",
        "cannot stand": "The structure cannot stand.",
    }
    sentences = (openings.get(str(verdict), "Nothing was compared."), reason, " ".join(comparison.get("remarks") or []))
    return " ".join(sentence for sentence in sentences if sentence)


def _first_verdict(comparison: dict[str, Any]) -> Iterator[str]:
    """Yield the sentence about an earlier attempt with coarser settings; nothing where there was none."""
    if first := comparison.get("first_verdict"):
        before = f'The verdict of the first one, "{first["scene"]}", was: {VERDICTS.get(first["verdict"], VERDICTS[None])[1]}.'
        yield f"Second attempt, with finer settings of both methods. {before} {first['reason']}"


def _check_view(check: dict[str, Any], units: Units) -> dict[str, Any]:
    """Return a check as texts; numbers below the tolerance have its decimal places."""
    symbol, word = check_words(check.get("verdict"))
    unit = check.get("unit") or ""
    words = (check.get(name) for name in ("reason", "next_step"))
    low, high = (range_end(end, unit, units) for end in check.get("range") or (None, None))
    predicted, yade, difference, tolerance = (
        units.value(check.get(name), unit) for name in ("limit_analysis", "yade", "difference", "tolerance")
    )
    return {
        "limit_analysis": _compared(predicted, tolerance),
        "yade": _compared(yade, tolerance),
        "difference": small_number(difference, tolerance),
        "tolerance": plain_number(tolerance),
        "name": check.get("name"),
        "passed": check.get("verdict") in PASSED,
        "unit": units.of(unit)[1],
        "symbol": symbol,
        "word": word,
        "reason": units.words(" ".join(sentence for sentence in words if sentence)),
        "range": range_words(low, high, 5),
    }


def _compared(value: float | None, tolerance: float | None) -> str:
    """Return a compared value as text; a value smaller than the tolerance has the decimal places of the tolerance."""
    outweighed = exists(value) and exists(tolerance) and abs(value) < tolerance
    return small_number(value, tolerance) if outweighed else format_number(value, 5)


def _figures(folder: Path, scene: str, comparison: dict[str, Any]) -> Iterator[dict[str, str]]:
    live, tilts = "multiplier" in associated_of(comparison), bool((comparison.get("structure") or {}).get("tilt"))
    words = {
        "moves": _motion(comparison, live, tilts),
        "reaction": _curve(comparison, tilts),
        "record": _record_words(comparison.get("yade") or {}),
        "levels": _level_words(comparison),
        "thrust": " The line of thrust joins the centres of pressure."
        if (comparison.get("structure") or {}).get("has_thrust_line")
        else "",
    }
    drawn = {name: figure for name, figure in FIGURES.items() if not (_is_falling_alone(comparison) and name in OF_FORCES)}
    for name, (heading, caption) in drawn.items():
        kind = "gif" if name == "animation" else "png"
        path = folder / f"{name}.{kind}"
        if path.is_file():
            image, address = path.read_bytes(), f"{quote(scene)}/{path.name}"
            shown = {"data": image_address(image, kind), "width": f"{paper_width(image):.0f}mm"}
            yield {"name": name, "heading": heading, "caption": caption.format(**words), "path": address} | shown


def _is_falling_alone(comparison: dict[str, Any]) -> bool:
    """Return whether no method has forces to show: limit analysis says that blocks fall, and YADE did not run."""
    return associated_of(comparison).get("status") == "infeasible" and not comparison.get("yade")


def _motion(comparison: dict[str, Any], live: bool, tilts: bool) -> str:
    """Return the caption of the figure of the mechanisms, with the methods."""
    by = "both methods" if comparison.get("yade") else "limit analysis"
    if associated_of(comparison).get("status") == "infeasible":
        return f"Blocks that fall, by {by}: no forces between the blocks hold them."
    size = "The displacements are enlarged." if comparison.get("yade") or live else "The size of the motion is free."
    return f"Blocks that move when {_drive(live, tilts)}, by {by}; marks show joints that open or slide, where they are seen. {size}"


def _drive(live: bool, tilts: bool) -> str:
    """Return the event that sets the mechanism in motion, as a clause."""
    if tilts:
        return "the structure fails on the tilted ground"
    return "the structure fails under the load" if live else "the support moves"


def _curve(comparison: dict[str, Any], tilts: bool) -> str:
    """Return the quantities of the curve as a sentence."""
    if tilts:
        return "Tangent of the tilt angle, and the angle, against displacement."
    if comparison.get("unit") == "N m":
        return "Moment of the support against its rotation, from rest."
    live = "multiplier" in associated_of(comparison)
    return "Load multiplier against displacement." if live else "Force of the support against its motion, from rest."


def _record_words(yade: dict[str, Any]) -> str:
    """Return the caption of YADE's record in the figure of the reaction; "" without a run."""
    status = yade.get("status", "plateau")
    if not yade:
        return ""
    if status == "plateau":
        return " YADE: the record, and its plateau extrapolated to the undeformed geometry."
    if exists(yade.get("settlement")) and yade["settlement"] > 0.0:
        return f" YADE: the record, which has no plateau ({status})."
    return f" YADE has no record of a settlement ({status})."


def _level_words(comparison: dict[str, Any]) -> str:
    """Return the caption of limit analysis' values in the figure of the reaction."""
    associated, coulomb = associated_of(comparison), (comparison.get("limit_analysis") or {}).get("coulomb") or {}
    curve = (coulomb.get("curve") or {}).get("settlement") or []
    quantity, parts = ("multiplier", ["the upper bound"]) if "multiplier" in associated else ("reaction", ["the bounds"])
    if not exists(associated.get(quantity)):
        return ""
    if exists(coulomb.get(quantity)):
        low, high = coulomb.get(f"{quantity}_interval") or (None, None)
        parts += ["the prediction with its uncertainty"] + ["its curve from rest"] * (len(curve) > 1)
        parts += ["the interval of values that its mechanism allows"] * (interval_words(low, high, "") not in (DASH, A_POINT))
    words = f" Limit analysis: {', '.join(parts[:-1])}{', and ' if len(parts) > 1 else ''}{parts[-1]}."
    return words + (_curve_words(comparison) if len(curve) > 1 else "")


def _curve_words(comparison: dict[str, Any]) -> str:
    """Return a sentence on the motion at which the figure of the reaction draws the prediction's curve; "" for the curve's own motion."""
    number = "" if (times := stiffening_of(comparison)) == 1.0 else format_number(times, 3)
    stiffer = f"{number} times as stiff as those of limit analysis"
    if (comparison.get("effects") or {}).get("rotation") == "finite":
        joints = f"YADE's joints, {stiffer}," if number else "the joints"
        return f" The curve is drawn at the motion at which {joints} have released as much."
    return f" The curve's motion is divided by {number}: YADE's joints are {stiffer}." if number else ""


def _effects(comparison: dict[str, Any], units: Units) -> Iterator[dict[str, str]]:
    """Yield one row for each effect: on or off, its model, the reason, and the savings without it or its time in seconds."""
    for row in (comparison.get("effects") or {}).get("table") or []:
        saved = ", ".join(f"{format_number(count)} {name}" for name, count in (row.get("saved") or {}).items())
        took = f"took {format_number(row['seconds'], 2)} s" if exists(row.get("seconds")) else ""
        yield {
            "effect": str(row.get("effect")),
            "what": str(row.get("what")),
            "state": "on" if row.get("on") else "off",
            "modelled": str(row.get("modelled")),
            "reason": units.words(str(row.get("reason") or "")),
            "cost": f"saves {saved}" if saved else took or DASH,
        }


def _evidence(comparison: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the residuals of the associated and of the Coulomb answer, with their meanings."""
    coulomb = (comparison.get("limit_analysis") or {}).get("coulomb") or {}
    for method, answer, meanings in (("associated", associated_of(comparison), EVIDENCE), ("Coulomb", coulomb, COULOMB_EVIDENCE)):
        for name, meaning in meanings.items():
            if name in answer:
                yield f"{method}: {meaning}", format_number(answer[name], 2)
