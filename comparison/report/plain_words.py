"""The plain conclusion of a scene: the moving blocks, the force that the support still carries, the methods and the assumptions."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from comparison.numbers import A_POINT, DASH, Units, first_names, format_number, several_plateaus, with_uncertainty
from comparison.report.values import NOT_STATED, UNLIMITED, angle_of, associated_of, rounding_change, rounding_words, values_of
from comparison.verdict import Verdict
from la_core.text_table import PLACES, coordinate_text, exists, without_round_off

BOUND = "associated"  # the answer that is a bound where no Coulomb prediction is known
LOWER = "this is the lower bound of limit analysis, because no Coulomb prediction is known"
UPPER = "this is the upper bound of limit analysis, because no Coulomb prediction is known"
ALL_PUSHED = "its weight"  # W, where a live load pushes all of it
STEEP = 0.99999  # cosine of the angle to the vertical, 0.26 degrees: farther from it a motion is neither up nor down
HELD_BACK = 1e-6  # of W (or of W times 1 m): a smaller negative reaction is a rounding error
LARGE_CHANGE = 0.05  # of a value: a larger change by the inset is told beside the conclusion; in most shipped scenes it is below 1 %
IN_NEWTONS = Units(0.0)  # units of a light structure, as in all notes: N and mm


def plain_words(comparison: dict[str, Any], units: Units) -> list[str]:
    """Return the conclusion as sentences for a reader who does not know the program; empty where nothing is known.

    comparison: content of the scene's `comparison.json`. units: those of the report.
    """
    return [sentence for sentence in _sentences(comparison, units) if sentence]


def _sentences(comparison: dict[str, Any], units: Units) -> Iterator[str]:
    associated = associated_of(comparison)
    facts = comparison.get("structure") or {}
    if associated.get("status") == "infeasible":
        if comparison.get("verdict") != Verdict.CANNOT_STAND:  # else the verdict itself names the blocks that fall
            yield _falls(associated.get("falling") or [])
        yield "No forces between the blocks can hold the structure, so there is no reaction."
    elif "multiplier" in associated:
        yield from _under_load(comparison, facts, units)
    else:
        yield from _on_support(comparison, facts, units)
    yield from _how_well_known(comparison, units)
    if facts:
        yield _assumed(facts)


def _falls(names: list[str]) -> str:
    falling = f": {len(names)} block{' falls' if len(names) == 1 else 's fall'} ({first_names(names, 8)})" if names else ""
    return f"The structure cannot stand{falling}."


def _on_support(comparison: dict[str, Any], facts: dict[str, Any], units: Units) -> Iterator[str]:
    """Yield sentences on the blocks that a moving support sets in motion, and on the force that it still carries."""
    predicted, yade = predicted_value(comparison), comparison.get("yade") or {}
    is_bound = _is_bound(comparison, "reaction")
    moves = _motion_words(facts)
    if moves:
        yield f"When {_support_words(facts)} {moves}, {_moving_words(comparison, facts)}."
    weight, unit = comparison.get("weight"), comparison.get("unit", "N")
    is_held_back = exists(predicted) and exists(weight) and predicted < -HELD_BACK * weight
    if exists(predicted) and exists(weight) and weight:
        percentage = format_number(100.0 * without_round_off(predicted, weight) / weight, 3)
        share = f", {percentage} % of the weight W = {units.text(weight, 'N', 4)}" if unit == "N" else ""
        by_motion = "settles" in moves or not moves
        carries_it = by_motion and not is_held_back
        of_force = "The support then still carries" if carries_it else "The force on the support along its motion is then"
        carries = _of_shares(facts, unit) or (of_force if unit == "N" else "The moment on the support is then")
        value = f"{units.text(predicted, unit, 4)}{share}"
        yield f"{carries} at least {value}: {LOWER}." if is_bound else f"{carries} {value}, by limit analysis."
    given = units.text(yade["reaction"], unit, 4) if exists(yade.get("reaction")) else ""
    yield from _of_yade(comparison, given)
    if is_held_back and not is_bound:
        effort = "a force of this size must move" if unit == "N" else "a moment of this size must turn"
        yield f"The minus says that the structure holds the support back: {effort} it."


def _of_shares(facts: dict[str, Any], unit: str) -> str:
    """Return the beginning of the sentence on a value of supports with shares of the motion; "" where all move alike."""
    motions = facts.get("motions") or []
    if not motions:
        return ""
    quantity, motion = ("forces", "settlement") if unit == "N" else ("moments", "rotation")
    is_single = sum(len(one["names"]) for one in motions) == 1
    if is_single and unit != "N":
        return "The moment on the support, times its share of the rotation, is then"
    supports = "support" if is_single else "supports"
    return f"The {quantity} on the {supports}, each times the share of the {motion} at its place, are then together"


def _of_yade(comparison: dict[str, Any], given: str) -> Iterator[str]:
    """Yield the sentence on YADE's value. given: the value with its unit, "" for none."""
    yade = comparison.get("yade") or {}
    if given and yade.get("status") == "plateau":
        yield f"YADE gives {given}."
    elif not yade:
        yield from [] if comparison.get("reason") else ["YADE was not run: this is the answer of one method."]  # the reason says it
    else:
        yield f"YADE gives no steady value ({yade.get('status')})."


def _how_well_known(comparison: dict[str, Any], units: Units) -> Iterator[str]:
    """Yield sentences on the stated uncertainties, but not on those of angles, and on the values that friction's history leaves open."""
    r = values_of(comparison, units)
    quantity = "multiplier" if r["live"] else "moment" if comparison.get("unit") == "N m" else "reaction"
    unit = f" {r['unit']}" if r["unit"] else ""
    values = {"by limit analysis": (r["coulomb"], r["coulomb_uncertainty"]), "in YADE": (r["yade"], r["uncertainty"])}
    stated = [f"{words}{unit} {method}" for method, pair in values.items() if "±" in (words := with_uncertainty(*pair))]
    if stated and not r["angles"]:
        yield f"With the uncertainty that each method states, the {quantity} is {' and '.join(stated)}."
    if r["interval"] in (A_POINT, DASH):
        return
    if r["interval"] == NOT_STATED:
        yield f"How far another history of friction changes the {quantity} is unknown."
    else:
        allowed = f"every {quantity}" if r["interval"] == UNLIMITED else f"a {quantity} of {r['interval']}"
        yield f"With another history of friction the same mechanism allows {allowed}."
    if exists(r["least"]):
        outside = f"outside {r['bounds']}" if exists(r["greatest"]) else f"below {format_number(r['least'], 5)}"
        yield f"No state in balance on these contact points has a {quantity} {outside}{unit}."


def _under_load(comparison: dict[str, Any], facts: dict[str, Any], units: Units) -> Iterator[str]:
    predicted = without_round_off(predicted_value(comparison), 1.0)
    direction = f" along {_vector(facts['live'])}" if facts.get("live") else ""
    weight, size = _pushed_weight(comparison, facts)
    if facts.get("tilt"):
        yield angle_words(comparison)
    elif exists(predicted):
        most, bound = ("no more than ", f": {UPPER}") if _is_bound(comparison, "multiplier") else ("", "")
        yield (
            f"Pushed{direction} by a share of every block's weight, {_moves_at(comparison)} {most}{format_number(predicted, 4)} times "
            f"{weight}, {'W = ' if weight == ALL_PUSHED else ''}{units.text(size, 'N', 4)}{bound}."
        )
        if exists(size):
            yield f"The push is then {most}{units.text(predicted * size, 'N', 4)}."
    if exists(predicted):
        yield f"Then {_moving_words(comparison, facts)}."
    yade = comparison.get("yade") or {}
    reaction = yade.get("reaction")
    if not (facts.get("tilt") and "YADE" in angle_words(comparison)):  # which gives the angles of both methods
        given = f"{format_number(without_round_off(reaction, 1.0), 4)} times {weight}" if exists(reaction) else ""
        yield from _of_yade(comparison, given)


def _pushed_weight(comparison: dict[str, Any], facts: dict[str, Any]) -> tuple[str, float | None]:
    """Return words for the weight that a live load pushes, and its size, N: W without dead loads given as forces, which are not pushed."""
    weight = comparison.get("weight")
    down = np.array(facts.get("gravity") or (0.0, 0.0, -1.0))
    forces = [load["force"] for load in facts.get("loads") or () if not exists(load["mass"])]
    idle = sum(max(0.0, float(np.dot(force, down / np.linalg.norm(down)))) for force in forces)
    return ("the pushed weight", weight - idle) if exists(weight) and idle > 0.0 else (ALL_PUSHED, weight)


def angle_words(comparison: dict[str, Any]) -> str:
    """Return the angle of the ground at which a tilted structure fails, by both methods, as a sentence; "" without a tilt."""
    name, answer = _best_answer(comparison, "angle")
    yade = comparison.get("yade") or {}
    if not name:
        return ""
    found = f"{with_uncertainty(angle_of(answer), answer.get('angle_uncertainty'))} degrees by limit analysis"
    if name == BOUND:
        found = f"at most {found} ({UPPER})"
    if exists(yade.get("angle")) and yade.get("status") == "plateau":
        found += f" and of {with_uncertainty(angle_of(yade), yade.get('angle_uncertainty'))} degrees in YADE"
    axis = (comparison.get("structure") or {}).get("tilt")
    about = f" about {_vector(axis)}" if axis else ""
    moves = _moves_at(comparison)
    return f"{moves[0].upper()}{moves[1:]} a tilt of the ground{about} of {found}; the multiplier is the tangent of this angle."


def notes_of(comparison: dict[str, Any]) -> Iterator[str]:
    """Yield the notes of a comparison: those of the run, a greater load before the plateau, several plateaus, a large effect of the inset.

    Forces are in N, as everywhere in a comparison.
    """
    yield from comparison.get("notes") or []
    if greatest := comparison.get("greatest_load"):
        yield greatest["words"]
    yield from _plateau_words(comparison)
    if rounding_change(comparison) > LARGE_CHANGE:
        yield f"{rounding_words(comparison, IN_NEWTONS)} If the edges are less worn, set a smaller [joint] inset."


def _plateau_words(comparison: dict[str, Any]) -> Iterator[str]:
    """Yield the sentence on several plateaus of limit analysis, unless the reason of the verdict names them."""
    quantity = "multiplier" if "multiplier" in associated_of(comparison) else "reaction"
    unit = "" if quantity == "multiplier" else comparison.get("unit", "N")
    several = several_plateaus(_best_answer(comparison, quantity)[1].get("plateaus"), unit)
    if several and "several plateaus" not in (comparison.get("reason") or ""):
        yield f"Limit analysis finds {several}. A small disturbance decides between them: work with the least favourable one."


def _moves_at(comparison: dict[str, Any]) -> str:
    """Return the words for failure at the load of the answer; where the structure carried more before, the blocks keep moving at it."""
    return "the blocks keep moving at" if comparison.get("greatest_load") else "the structure fails at"


def predicted_value(comparison: dict[str, Any]) -> float:
    """Return the value that limit analysis predicts at the inset of both methods: Coulomb's, else the associated one; NaN without one."""
    quantity = "multiplier" if "multiplier" in associated_of(comparison) else "reaction"
    return float(_best_answer(comparison, quantity)[1].get(quantity, math.nan))


def _best_answer(comparison: dict[str, Any], quantity: str) -> tuple[str, dict[str, Any]]:
    """Return the name and the numbers of the best answer that has a quantity, at the inset of both methods; "" and {} without one."""
    answers = comparison.get("limit_analysis") or {}
    for name in ("coulomb", BOUND):
        answer = answers.get(name) or {}
        shared = answer.get("shared_inset") or answer
        if exists(shared.get(quantity)):
            return name, shared
    return "", {}


def _is_bound(comparison: dict[str, Any], quantity: str) -> bool:
    """Return whether the best answer is the associated one. It is then a bound, because Coulomb's is known where no joint slides."""
    return _best_answer(comparison, quantity)[0] == BOUND


def _moving_words(comparison: dict[str, Any], facts: dict[str, Any]) -> str:
    """Return how many blocks move, and their share of the mass of all blocks, as the rest of a sentence."""
    count, total = (facts.get("moving_blocks") or {}).get("limit_analysis"), (facts.get("blocks") or {}).get("free")
    measures = comparison.get("mechanism_measures") or {}
    share = ((measures.get("coulomb") or measures.get("associated")) or {}).get("moving_mass_share")
    if count is None:
        return "it is unknown which blocks move"
    if count == 0:
        return "no block moves"
    if count == total == 1:
        return "the only block moves"
    if count == total:
        return f"all {total} blocks move"
    mass = f" ({format_number(100.0 * share, 2)} % of their mass)" if exists(share) else ""
    return f"{count} of the {total} blocks{mass} move{'s' if count == 1 else ''}"


def _support_words(facts: dict[str, Any]) -> str:
    support = facts.get("support") or {}
    names = support.get("names") or []
    if not names:
        return "the support"
    (low, *_), (high, *_) = support["low"], support["high"]
    named = f'"{names[0]}"' if len(names) == 1 else f"{len(names)} blocks or more" if len(names) >= 12 else f"{len(names)} blocks"
    places = max(0, 3 - math.floor(math.log10(max(high - low, 10.0**-PLACES))))  # for four digits of the support's length
    return f"the support ({named}, x = {coordinate_text(low, places)} to {coordinate_text(high, places)} m)"


def _motion_words(facts: dict[str, Any]) -> str:
    """Return the motion of the support as a verb; "" where it is unknown."""
    if not facts.get("motion"):
        return ""
    motions, turns = facts.get("motions") or [], np.any(facts["motion"][3:])
    if len(motions) == 1 and np.any(motions[0]["spin"]) and not turns:
        return "moves by shares of the settlement that differ along it"
    if motions:
        share = "a share" if len(motions) == 1 else "different shares"
        return f"turns by {share} of the rotation" if turns else f"moves by {share} of the settlement"
    motion, gravity = np.array(facts["motion"]), np.array(facts.get("gravity") or (0.0, 0.0, -9.81))
    if turns:
        return f"turns about {_vector(motion[3:])}"
    down = float(motion[:3] @ gravity / np.linalg.norm(gravity))
    return "settles" if down > STEEP else "is lifted" if down < -STEEP else f"moves along {_vector(motion[:3])}"


def _vector(entries: Any) -> str:
    """Return a direction: the name of an axis, or its components."""
    values = np.asarray(entries, dtype=float)
    axes = np.flatnonzero(np.abs(values) > 1e-9)
    if len(axes) == 1:
        return f"{'−' if values[axes[0]] < 0.0 else ''}{'xyz'[axes[0]]}"
    return f"({', '.join(format_number(value, 3) for value in values)})"


def _assumed(facts: dict[str, Any]) -> str:
    friction = " to ".join(f"{value:.4g}" for value in dict.fromkeys((facts["friction"][0], facts["friction"][-1])))
    return f"Assumed: friction coefficient {friction}, dry joints without mortar, cohesion or tension, rigid blocks that do not crush."
