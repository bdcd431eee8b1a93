"""Details of one scene: accuracy and cost of each method's answer, energies of the run, measures and joints of the mechanisms."""

from collections.abc import Iterable, Iterator
from typing import Any

from comparison.judge import METHODS as BOTH_METHODS
from comparison.numbers import A_POINT, DASH, LEAST_UNCERTAINTY, Units, format_number, percent, plain_number, plural, small_number
from comparison.verdict import ANSWERS
from la_core.text_table import exists, place_text

MEASURES = (
    "dissipated_power", "dissipated_share", "participation_index", "moving_mass_share", "opening", "sliding", "sticking", "idle"
)  # fmt: skip


def costs(comparison: dict[str, Any], results: dict[str, Any], evidence: Iterable[str], units: Units) -> Iterator[dict[str, str]]:
    """Yield accuracy, work and seconds of each method's answer, one row for each method.

    Parameters
    ----------
    comparison : dict
        The content of the scene's `comparison.json`.
    results : dict
        Numbers of both methods, as `scene_view` collects them.
    evidence : iterable of str
        Names of the residuals of the associated answer; the row gives the largest.
    units : Units
        Units of the report.
    """
    answers = comparison.get("limit_analysis") or {}
    associated, coulomb, path = (answers.get(name) or {} for name in ("associated", "coulomb", "path"))
    is_of_0_2_0 = coulomb.get("steps") and not coulomb.get("viscosities")  # its path was a sequence of associated programmes
    counted = "associated programmes" if is_of_0_2_0 else "Newton iterations"
    yield _cost_of_bound(associated, results, evidence)
    if coulomb:
        yield _cost_of_prediction(coulomb, results, counted)
    if path:
        yield _cost_of_path(path, results, counted, units, str(comparison.get("unit", "N")))
    if yade := comparison.get("yade") or {}:
        accuracy = _stated(results["uncertainty"], results["ratios"]["uncertainty"], results) or DASH
        value = _answer_text(results["yade"], results, results["yade_status"])
        yield _cost_row(ANSWERS["yade"], value, accuracy, f"{format_number(yade.get('steps'))} steps", yade.get("seconds"))


def _cost_row(method: str, answer: str, accuracy: str, work: str, seconds: Any) -> dict[str, str]:
    return {"method": method, "answer": answer, "accuracy": accuracy, "work": work, "seconds": format_number(seconds, 2)}


def _answer_text(value: Any, results: dict[str, Any], status: str) -> str:
    """Return the value of an answer with its unit, or its status where it has none."""
    return f"{format_number(value, 5)} {results['unit']}".rstrip() if exists(value) else status


def _cost_of_bound(associated: dict[str, Any], results: dict[str, Any], evidence: Iterable[str]) -> dict[str, str]:
    """Return the row of the associated answer; parameters as in `costs`."""
    residuals = [associated[name] for name in evidence if exists(associated.get(name))]
    accuracy = f"largest residual {format_number(max(residuals), 2)}" if residuals else DASH
    value = _answer_text(results["multiplier"] if results["live"] else results["least"], results, results["status"])
    work = f"{format_number(associated.get('iterations'))} iterations"
    return _cost_row(ANSWERS["associated"], value, accuracy, work, associated.get("seconds"))


def _cost_of_prediction(coulomb: dict[str, Any], results: dict[str, Any], counted: str) -> dict[str, str]:
    """Return the row of the Coulomb prediction. counted: name of its iterations."""
    half = results["half_width"]
    has_width = half and results["interval"] != A_POINT
    width = f", half-width {plain_number(half)} {results['unit']}".rstrip() if has_width else ""
    stated = _stated(results["coulomb_uncertainty"], results["ratios"]["coulomb_uncertainty"], results)
    accuracy = "; ".join(part for part in (stated, results["plateaus"], f"interval {results['interval']}{width}") if part)
    paths = plural(len(coulomb["viscosities"]), "path") + ", " if coulomb.get("viscosities") else ""
    work = f"{paths}{format_number(coulomb.get('steps'))} steps, {format_number(coulomb.get('iterations'))} {counted}"
    value = _answer_text(results["coulomb"], results, results["coulomb_status"])
    return _cost_row(ANSWERS["coulomb"], value, accuracy, work, coulomb.get("seconds"))


def _cost_of_path(path: dict[str, Any], results: dict[str, Any], counted: str, units: Units, si_unit: str) -> dict[str, str]:
    """Return the row of the requested path from rest. counted: name of its iterations; si_unit: SI unit of its values."""
    values = path.get("multiplier" if results["live"] else "reaction") or []
    solves = [count for count in path.get("solves") or [] if exists(count)]
    residuals = [residual for residual in path.get("strain_residual") or [] if exists(residual)]
    missed = (path.get("converged") or []).count(False)
    accuracy = f"largest share of drag {format_number(max(residuals, default=None), 2)}"
    accuracy += f"; {plural(missed, 'increment')} not reached" if missed else ""
    work = f"{format_number(max(len(values) - 1, 0))} increments, {format_number(sum(solves) or None)} {counted}"
    value = _answer_text(units.value(values[-1], si_unit) if values else None, results, DASH)
    return _cost_row("limit analysis, path", value, accuracy, work, path.get("seconds"))


def _stated(uncertainty: Any, share: Any, results: dict[str, Any]) -> str:
    """Return an uncertainty in the unit of the answer, and its share of the weight unless the answer is a multiplier.

    An uncertainty below LEAST_UNCERTAINTY of the weight is round-off; an unknown one is "".
    """
    size = uncertainty if results["live"] else share
    if not exists(size):
        return ""
    if size < LEAST_UNCERTAINTY:
        return "± round-off"
    stated = f"± {plain_number(uncertainty)} {results['unit']}".rstrip()
    return stated if results["live"] else f"{stated}, {plain_number(share)} {results['ratio_unit']}"


def accuracy_rows(comparison: dict[str, Any]) -> Iterator[dict[str, str]]:
    """Yield every attempt at the requested accuracy: method, choice and reason, error by parts, success, seconds."""
    record = comparison.get("accuracy") or {}
    for method in (name for name in BOTH_METHODS if name in record):
        for attempt in record[method]["attempts"]:
            parts = ", ".join(f"{name} {percent(value)}" for name, value in attempt["parts"].items())
            error, requested = attempt["error"], record["asked"]
            yield {
                "method": BOTH_METHODS[method],
                "asked": percent(requested),
                "chosen": attempt["chosen"],
                "error": f"{percent(error)}: {parts}",
                "kept": "yes" if exists(error) and error <= requested else "no",
                "seconds": format_number(attempt["seconds"], 2),
            }


ENERGIES = {
    "weights": "work of the weights",
    "support": "work of the support",
    "load": "work of the live load",
    "kinetic": "gained as kinetic energy",
    "elastic": "gained as elastic energy of the joints",
    "friction": "dissipated by friction",
    "viscous": "dissipated by damping",
}
DRIVES = ("support", "load")  # one of them acts; the other one does no work
ENERGY_NOTE = (
    "The turnover is the sum of the work on each block, of weight and live load together, and of the support's work, all without their "
    "signs. Where weight and live load oppose each other, each of them may do more work than this. The forces between two "
    "stored states are taken as their mean. The error of this mean is work that is not accounted for, and may make a small dissipation "
    "negative. Where the turnover is less than the work of 1 % of the weight over the settlement, the check takes its shares of this work."
)

GROUND_NOTE = (
    "Force of each block of the ground and of the support on the structure through its joints, at the plateau. Where the structure is "
    "statically indeterminate, single forces depend on the history of the joints, and both methods may be right."
)
TILT_NOTE = (
    " Axes turn with the ground. Both methods keep the whole weight across it and add the weight times the multiplier along it: on ground "
    "that tilts by the angle, all forces are smaller, by its cosine."
)
JOINTS_NOTE = (
    "The joints that move most come first. Opening and slip are the largest of the joint's contact points, and the rotation is that of its "
    "blocks against each other, all per unit motion of the support; under a live load or a tilt per unit of the mean displacement along "
    "it. Friction used is the shear over its limit, friction coefficient times normal force; its inverse is the safety against sliding. "
    "A joint that turns in its own plane slides although it uses less than 1, because its shear forces cancel each other in part. "
    "The eccentricity of the centre of pressure is 0 in the middle of the joint, 0.333 at the end of the middle third, and 1 at the edge: "
    "there a joint that opens turns as a hinge."
)


def energies(comparison: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the energy balance of YADE's run with its drift, in J and as shares of the turnover, as text.

    The list is empty without a run.
    """
    audit = comparison.get("energy") or {}
    if not exists(audit.get("drift")):
        return []
    turnover = audit["turnover"]
    acting = [name for name in ENERGIES if name not in DRIVES or audit.get(name)]
    parts = {ENERGIES[name]: audit[name] for name in acting} | {"not accounted for": audit["drift"] * turnover}
    return [
        {"name": name, "joule": small_number(value, turnover, 4), "share": f"{small_number(100.0 * value / turnover, 100.0, 5)} %"}
        for name, value in parts.items()
    ]


def energy_view(comparison: dict[str, Any]) -> dict[str, Any]:
    """Return the energies for the templates: their rows, the part of the run over which they add up, and a note on their meaning."""
    on_plateau = (comparison.get("effects") or {}).get("recording") == "plateau"  # only its states were stored
    span = "from its first to its last stored state on the plateau" if on_plateau else "from rest under gravity to its end"
    return {"rows": energies(comparison), "span": span, "note": ENERGY_NOTE}


def moving_joints(comparison: dict[str, Any], units: Units) -> dict[str, Any]:
    """Return headings, rows of text and a note for the table of the joints that open or slide in limit analysis.

    There are no rows where no joint moves. A number that is round-off beside the largest of its kind is shown as zero.
    """
    facts = comparison.get("structure") or {}
    found = facts.get("moving_joints") or {"count": 0, "rows": []}
    rows, turns = found["rows"], comparison.get("unit") == "N m"
    motion = max((max(row["opening"], row["slip"]) for row in rows), default=0.0)
    rotation = max((row["rotation"] for row in rows), default=0.0)
    scales = {"opening": motion, "slip": motion, "rotation": max(rotation, motion / max(facts["size"]))} if rows else {}
    force, largest = units.of("N")[1], max((abs(row["normal"]) for row in rows), default=0.0)
    axes = "xz" if (comparison.get("effects") or {}).get("plane") else "xyz"

    def texts(row: dict[str, Any]) -> Iterator[str]:
        yield f"{row['block_a']} and {row['block_b']}"
        yield {"opening": "opens", "sliding": "slides"}[row["state"]]
        yield from (small_number(row[name], scale) for name, scale in scales.items())
        yield from (small_number(units.value(row[name], "N"), units.value(largest, "N"), 4) for name in ("normal", "shear"))
        yield from (small_number(row[name], 1.0) for name in ("friction_used", "eccentricity"))
        yield place_text([row[axis] for axis in axes]) if exists(row["x"]) else DASH

    per = "mrad" if turns else "mm"
    motions = (("opening", f"mm/{per}"), ("slip", f"mm/{per}"), ("rotation", f"mrad/{per}"))
    numbers = (*motions, ("normal force", force), ("shear", force), ("friction used", ""), ("eccentricity", ""))
    headings = [("joint", "", ""), ("state", "", ""), *((*name, "number") for name in numbers)]
    headings.append(("centre of pressure", f"({', '.join(axes)})", "place"))
    rest = found["count"] - len(rows)
    more = f"{plural(rest, 'more joint')} {'moves' if rest == 1 else 'move'} no farther. " if rest else ""
    return {"headings": headings, "rows": [list(texts(row)) for row in rows], "note": more + JOINTS_NOTE + _tilt_note(facts)}


def reactions(comparison: dict[str, Any], units: Units) -> dict[str, Any]:
    """Return headings, rows of text and a note for the table of the forces of the ground and the support.

    There are no rows where limit analysis knows no forces.
    """
    facts = comparison.get("structure") or {}
    found = facts.get("ground_reactions") or {"count": 0, "rows": [], "aside": 0}
    rows, aside = found["rows"], found["aside"]
    axes = (0, 2) if (comparison.get("effects") or {}).get("plane") else (0, 1, 2)
    methods = [name for name in BOTH_METHODS if rows and name in rows[0]]
    largest = max((abs(part) for row in rows for name in methods for part in row[name]), default=0.0)

    def text(part: float) -> str:
        return small_number(units.value(part, "N"), units.value(largest, "N"), 4)

    headings = [("block", "")] + [
        (f"{BOTH_METHODS[name]}, {'xyz'[axis]}, {units.of('N')[1]}", "number") for name in methods for axis in axes
    ]
    rest = found["count"] - len(rows)
    more = f"{plural(rest, 'more block')} {'carries' if rest == 1 else 'carry'} no more. " if rest else ""
    if aside:
        more += f"The table lacks what the ground bears under the {plural(aside, 'block')} set aside. "
    return {
        "headings": headings,
        "rows": [[row["block"], *(text(row[name][axis]) for name in methods for axis in axes)] for row in rows],
        "note": more + GROUND_NOTE + _tilt_note(facts),
    }


def _tilt_note(facts: dict[str, Any]) -> str:
    return TILT_NOTE if facts.get("tilt") else ""


def measures(comparison: dict[str, Any], live: bool, units: Units) -> Iterator[dict[str, Any]]:
    """Yield the measures of each known mechanism; power per unit motion of the support is a force, in the report's unit."""
    for method, measured in (comparison.get("mechanism_measures") or {}).items():
        if measured and exists(measured.get("moving_mass_share")):
            row = {name: measured.get(name) for name in MEASURES}
            row["dissipated_power"] = units.value(row["dissipated_power"], str(comparison.get("unit", "" if live else "N")))
            yield {"method": ANSWERS.get(method, method), **row}
