"""Values of one scene for the report: bounds, prediction, YADE's reaction, expected values, influence of the inset."""

import math
from collections.abc import Iterator
from typing import Any

from comparison.numbers import (
    DASH,
    SAME_STIFFNESS,
    Units,
    exists,
    format_number,
    half_width,
    interval_words,
    several_plateaus,
    share_of,
    signed,
    small_number,
    value_range,
    with_uncertainty,
)
from la_core.text_table import without_round_off

_STONE = "the Coulomb prediction is limit analysis' answer with the friction of stone."
LIMITS = f"No state in balance on these contact points lies below R_min or above R_max; {_STONE}"
MEANINGS = {  # meaning of the values, by their unit
    "N": f"R is the force of the support against its motion, W the weight of the free blocks and the loads on them. {LIMITS}",
    "N m": f"R is the moment of the support against its rotation, W the weight of the free blocks and the loads on them. {LIMITS}",
    "": "The multiplier is the live load over the weight of the blocks; of a tilt it is the tangent of the angle. No state in balance on "
    f"these contact points lies above the associated one; {_STONE}",
}
NOT_STATED = "not stated: thresholds of slip, or paths, give different intervals"  # reason for an interval that `stated_interval` withholds
UNLIMITED = "unlimited"
NO_CHANGE = 1e-5  # of a value: a smaller change by the inset is an error of the solver


def associated_of(comparison: dict[str, Any]) -> dict[str, Any]:
    """Return the associated answer in the content of `comparison.json`; empty where it is missing."""
    return (comparison.get("limit_analysis") or {}).get("associated") or {}


def stiffening_of(comparison: dict[str, Any]) -> float:
    """Return the stiffness of YADE's joints over that of limit analysis; 1 where they are equal or one is unknown."""
    own, of_yade = (comparison.get("joints") or {}).get("normal"), (comparison.get("settings") or {}).get("normal_stiffness")
    if not (exists(own) and own and exists(of_yade)) or math.isclose(own, of_yade, rel_tol=SAME_STIFFNESS):
        return 1.0
    return of_yade / own


def _interval_text(predicted: Any, low: Any, high: Any, unit: str, status: Any) -> str:
    """Return an interval, or the reason why it is unknown; only a prediction has one. Files of earlier versions have no status."""
    if exists(low) or exists(high) or not exists(predicted):
        return interval_words(low, high, unit)
    return {"not stated": NOT_STATED, "unlimited": UNLIMITED}.get(status, DASH)


class _Answers:
    """The answers in the content of `comparison.json`, at the inset of both methods, and their values in the report's units."""

    def __init__(self, comparison: dict[str, Any], units: Units) -> None:
        self.associated, self.yade = associated_of(comparison), comparison.get("yade") or {}
        self.coulomb = (comparison.get("limit_analysis") or {}).get("coulomb") or {}
        self.bounds = self.associated.get("shared_inset") or self.associated
        self.prediction = self.coulomb.get("shared_inset") or self.coulomb
        self.live = "multiplier" in self.associated
        self.quantity = "multiplier" if self.live else "reaction"
        self.si_unit = comparison.get("unit", "" if self.live else "N")
        self.is_steady = self.yade.get("status", "plateau") == "plateau"
        self.weight = comparison.get("weight")
        self._units = units

    def shown(self, value: Any) -> float | None:
        """Return a value in the report's unit, 0 where it is only round-off; None where it is undefined."""
        return self._units.value(without_round_off(value, 1.0) if self.live and exists(value) else value, self.si_unit)

    def compared(self) -> float | None:
        """Return the value that YADE is compared with: the prediction, or else the bound."""
        predicted = self.shown(self.prediction.get(self.quantity))
        return predicted if exists(predicted) else self.shown(self.bounds.get(self.quantity))

    def reactions(self) -> dict[str, float | None]:
        """Return every reaction, or multiplier, by name, with its uncertainty; YADE's exist only on a plateau."""
        compared, recorded = self.compared(), self.shown(self.yade.get("reaction")) if self.is_steady else None
        return {
            "least": self.shown(self.bounds.get("reaction")),
            "greatest": self.shown(self.bounds.get("reaction_max")),
            "yade": recorded,
            "uncertainty": self.shown(self.yade.get("uncertainty")) if self.is_steady else None,
            "coulomb": self.shown(self.prediction.get(self.quantity)),
            "coulomb_uncertainty": self.shown(self.prediction.get("uncertainty")),
            "released": self.shown(self.prediction.get("released")),
            "released_uncertainty": self.shown(self.prediction.get("released_uncertainty")),
            "difference": recorded - compared if exists(compared) and exists(recorded) else None,
        }

    def angles(self) -> dict[str, tuple[Any, Any]]:
        """Return the angle of a tilt and its uncertainty, degrees, by the name of the answer."""
        sources = (("associated", self.bounds), ("Coulomb", self.prediction), ("YADE", self.yade if self.is_steady else {}))
        return {name: (angle_of(answer), answer.get("angle_uncertainty")) for name, answer in sources if "angle" in answer}


def angle_of(answer: dict[str, Any]) -> Any:
    """Return the angle of a tilt in an answer, degrees, 0 where it is only round-off; None where it is undefined."""
    angle = answer.get("angle")
    return without_round_off(angle, math.degrees(1.0)) if exists(angle) else angle


def _size_of_weight(comparison: dict[str, Any], live: bool) -> float:
    """Return the size beside which a value may be round-off: W for a reaction, N, 0 where it is unknown; 1 for a multiplier."""
    weight = comparison.get("weight")
    return 1.0 if live else weight if exists(weight) else 0.0


def values_of(comparison: dict[str, Any], units: Units) -> dict[str, Any]:
    """Return both methods' numbers at the shared inset in the report's units: bounds, YADE's reaction, difference, seconds.

    Undefined numbers are None. YADE's reaction exists only on a plateau.
    """
    answers = _Answers(comparison, units)
    reactions, compared, weight = answers.reactions(), answers.compared(), answers.shown(answers.weight)
    ratios = {name: value / weight if exists(value) and weight and not answers.live else None for name, value in reactions.items()}
    low, high = (answers.shown(end) for end in answers.prediction.get(f"{answers.quantity}_interval") or (None, None))
    least_tolerance = answers.shown(comparison.get("least_tolerance")) or 0.0
    is_something = exists(compared) and abs(compared) > least_tolerance  # a per cent of zero is undefined
    unbounded, unit = answers.associated.get("reaction_max_status") == "unbounded", units.of(answers.si_unit)[1]
    return reactions | {
        "ratios": ratios,
        "unit": unit,
        "meaning": MEANINGS[answers.si_unit],
        "ratio_unit": "" if answers.live else "of W" if answers.si_unit == "N" else "m, over W",
        "greatest_status": "no upper limit" if unbounded else "",
        "bounds": value_range(reactions["least"], reactions["greatest"], unbounded, 5),
        "bounds_over_weight": value_range(ratios["least"], ratios["greatest"], unbounded, 4),
        "interval": _interval_text(reactions["coulomb"], low, high, unit, answers.prediction.get("interval_status")),
        "plateaus": several_plateaus([answers.shown(value) for value in answers.prediction.get("plateaus") or []], unit),
        "half_width": half_width(low, high),
        "less": "Coulomb" if exists(reactions["coulomb"]) else "associated" if answers.live else "R_min",
        "coulomb_status": answers.coulomb.get("status") or DASH,
        "live": answers.live,
        "difference_text": small_number(reactions["difference"], compared, 5),
        "difference_words": share_of(reactions["difference"], compared if is_something else None),
        "multiplier": answers.shown(answers.bounds.get("multiplier")),
        "angles": answers.angles(),
        "status": answers.associated.get("status") or DASH,
        "yade_status": answers.yade.get("status") or "not run",
        "limit_analysis_seconds": _sum(answers.associated.get("seconds"), answers.coulomb.get("seconds")),
        "yade_seconds": answers.yade.get("seconds"),
    }


def range_end(end: Any, unit: str, units: Units) -> float | None:
    """Return an end of a check's range in the report's units, 0 where it is only round-off; None where it is undefined."""
    return units.value(without_round_off(end, 1.0) if unit == "" and exists(end) else end, unit)


def _sum(*values: Any) -> float | None:
    defined = [value for value in values if exists(value)]
    return sum(defined) if defined else None


def value_rows(results: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the values of both methods: name, value with its unit, share of the weight."""
    r, ratios, unit = results, results["ratios"], results["unit"]
    share = "" if r["live"] else f" {r['ratio_unit']}"

    def row(name: str, value: Any, uncertainty: Any = None, ratio: Any = None, more: str = "") -> tuple[str, str, str]:
        text = f"{with_uncertainty(value, uncertainty)} {unit}".rstrip() + (f", {more}" if more else "") if exists(value) else more or DASH
        return name, text, f"{format_number(ratio)}{share}" if exists(ratio) and not r["live"] else ""

    status = "" if r["status"] == "solved" else r["status"]
    if r["live"]:
        yield row("limit analysis: greatest multiplier, associated", r["multiplier"], more=status)
    else:
        yield row("limit analysis: least reaction, R_min", r["least"], None, ratios["least"], status)
        yield row("limit analysis: greatest reaction, R_max", r["greatest"], None, ratios["greatest"], r["greatest_status"])
    if exists(r["coulomb"]) or r["coulomb_status"] != DASH:
        status = ", ".join(part for part in ("" if r["coulomb_status"] == "solved" else r["coulomb_status"], r["plateaus"]) if part)
        yield row("limit analysis: Coulomb prediction", r["coulomb"], r["coulomb_uncertainty"], ratios["coulomb"], status)
        if exists(r["released"]):
            yield row(
                "limit analysis: prediction after turning blocks release thrusts",
                r["released"],
                r["released_uncertainty"],
                ratios["released"],
            )
        yield "limit analysis: interval of the prediction's mechanism", r["interval"], ""
    state = "" if r["yade_status"] == "plateau" else r["yade_status"]
    yield row("YADE: plateau", r["yade"], r["uncertainty"], ratios["yade"], state)
    for name, (angle, uncertainty) in r["angles"].items():
        yield f"angle of the tilt at collapse, {name}", f"{with_uncertainty(angle, uncertainty)} degrees" if exists(angle) else DASH, ""
    if exists(r["difference"]):
        over = f"{small_number(ratios['difference'], ratios['yade'], 4)}{share}" if exists(ratios["difference"]) and not r["live"] else ""
        share_words = "" if r["difference_words"] == DASH else f"({r['difference_words']})"
        difference = " ".join(filter(None, (r["difference_text"], unit, share_words)))
        yield f"YADE less {r['less']}", difference, over


def expected_rows(comparison: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield each expected value beside limit analysis' value for sharp edges, or for the scene's inset where only this one is known."""
    expected, associated = comparison.get("expected") or {}, associated_of(comparison)
    prediction = (comparison.get("limit_analysis") or {}).get("coulomb") or associated
    weight = comparison.get("weight")

    def over(value: Any) -> float | None:
        return without_round_off(value, weight) / weight if exists(value) and weight else None

    def sharpest(quantity: str) -> Any:
        sharp = prediction.get(f"{quantity}_sharp")
        return sharp if exists(sharp) else prediction.get(quantity)

    unit = ", m" if comparison.get("unit") == "N m" else ""  # a turning support's reaction is a moment
    answers = {
        "reaction_over_weight": (f"R / W{unit}", over(sharpest("reaction"))),
        "associated_reaction_over_weight": (f"R_min / W{unit}, associated", over(associated.get("reaction_sharp"))),
        "reaction_max_over_weight": (f"R_max / W{unit}, associated", over(associated.get("reaction_max_sharp"))),
        "multiplier": ("multiplier", sharpest("multiplier")),
        "associated_multiplier": ("multiplier, associated", associated.get("multiplier_sharp")),
    }
    for key, (name, value) in answers.items():
        if exists(expected.get(key)):
            yield {"name": name, "expected": expected[key], "found": value} | {k: expected.get(k) for k in ("tolerance", "kind")}


def rounding_words(comparison: dict[str, Any], units: Units) -> str:
    """Return the influence of the inset on the associated answer as a sentence; "" where the inset is 0 or unknown."""
    quantity, sharp, rounded, inset = _rounding(comparison)
    if not (exists(sharp) and exists(rounded) and exists(inset)) or inset == 0.0:
        return ""
    base = "" if quantity == "multiplier" else comparison.get("unit", "N")
    given = f"The inset of {units.text(inset, 'm', 3)}"
    change = rounded - sharp
    if abs(change) <= NO_CHANGE * abs(sharp):
        return f"{given} does not change the associated {quantity}, {units.text(sharp, base, 5)}."
    share = f" ({signed(100.0 * change / abs(sharp), 2)} %)" if abs(sharp) > abs(change) else ""
    before, after = units.text(sharp, base, 5), units.text(rounded, base, 5)
    return f"{given} changes the associated {quantity} from {before} for sharp edges to {after}{share}."


def rounding_change(comparison: dict[str, Any]) -> float:
    """Return the change of the associated answer by the inset over the answer for sharp edges; 0 where one is unknown or both are 0."""
    _, sharp, rounded, _ = _rounding(comparison)
    if not (exists(sharp) and exists(rounded)) or rounded == sharp:
        return 0.0
    return abs(rounded - sharp) / abs(sharp) if sharp else math.inf


def _rounding(comparison: dict[str, Any]) -> tuple[str, Any, Any, Any]:
    """Return the quantity of the associated answer, its values for sharp edges and for the inset, without round-off, and the inset."""
    associated = associated_of(comparison)
    shared = associated.get("shared_inset") or associated
    quantity = "multiplier" if "multiplier" in associated else "reaction"
    sharp, rounded = associated.get(f"{quantity}_sharp"), shared.get(quantity)
    if exists(sharp) and exists(rounded):
        size = _size_of_weight(comparison, quantity == "multiplier")
        sharp, rounded = without_round_off(sharp, size), without_round_off(rounded, size)
    return quantity, sharp, rounded, shared.get("inset")
