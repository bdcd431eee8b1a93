"""Plain words and units for the parameters that a campaign sweeps and for the quantities that its cases give."""

import re
from collections.abc import Mapping
from typing import Any

from comparison.report_numbers import number

NAMES = {
    "joint.friction": "friction mu (-)",
    "joint.inset": "inset (m)",
    "stone.density": "density (kg/m³)",
    "settlement.direction": "direction of the settlement",
    "live.direction": "direction of the live load",
    "effects.plane": "plane model",
    "effects.friction": "friction law",
    "classic.relaxation": "classic relaxation b (-)",
    "classic.slope": "classic slope a (-)",
    "classic.cohesion": "classic cohesion (mean block weights)",
    "classic.tolerance": "classic tolerance (mean block weights)",
    "classic.iterations": "classic: most programmes",
    "accuracy": "accuracy asked for (share)",
    "inset": "inset (m)",
    "friction": "friction mu (-)",
    "density": "density (kg/m³)",
    "gravity": "gravity (m/s²)",
    "radius": "radius (m)",
    "thickness": "thickness (m)",
    "depth": "depth (m)",
    "length": "length (m)",
    "height": "height (m)",
    "embrace": "embrace (degrees)",
    "degrees": "turn (degrees)",
    "courses": "courses",
    "per_course": "blocks in a course",
    "voussoirs": "voussoirs",
    "origin": "origin (m)",
    "block": "block size (m)",
    "size": "size (m)",
    "settlement": "settlement (m)",
}
COMPONENTS = ("x", "y", "z")
CLASSIC = "classic."  # parameters that only the classic iteration knows
QUANTITY = {"N": "reaction over weight, R / W (-)", "N m": "reaction over weight, R / W (m)", "": "collapse multiplier (-)"}


def label(parameter: str, named: Mapping[str, str] | None = None) -> str:
    """Axis label of a parameter by its dotted path: what it is and its unit; the path's own words where it has no name here.

    named: short names that the campaign gives its parameters; they take the place of the words, not of the unit.
    """
    if parameter in (named or {}):
        unit = re.search(r" \([^()]*\)$", NAMES.get(parameter, NAMES.get(_last(parameter), "")))
        return (named or {})[parameter] + (unit[0] if unit else "")
    if parameter in NAMES:
        return NAMES[parameter]
    *parents, last = _parts(parameter)
    component = ""
    if last.isdigit() and parents:
        component, last = COMPONENTS[int(last)] if int(last) < len(COMPONENTS) else last, parents.pop()
    words = NAMES.get(last, _plain(last)) + (f", {component}" if component else "")
    table = " ".join(_plain(part) if not part.isdigit() else str(int(part) + 1) for part in parents)
    return f"{table}: {words}" if table else words


def short(parameter: str, named: Mapping[str, str] | None = None) -> str:
    """The label without its unit."""
    return re.sub(r" \([^()]*\)", "", label(parameter, named))


def words_of(held: Mapping[str, Any], named: Mapping[str, str] | None = None) -> str:
    """Parameters with their values, in words; "" for none."""
    return ", ".join(f"{short(name, named)} {shown(value)}" for name, value in held.items())


def shown(value: Any) -> str:
    """A parameter's value in a few signs; a dash for none."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return "(" + ", ".join(shown(part) for part in value) + ")"
    if isinstance(value, int | float):
        return f"{value:.6g}".replace("-", "−", 1) if value < 0 else f"{value:.6g}"
    return number(None) if value is None else str(value)


def quantity(unit: str | None) -> str:
    """Axis label of a reaction over the weight, or of a multiplier, by the unit of the reaction."""
    return QUANTITY.get(unit or "", QUANTITY["N"])


def _parts(parameter: str) -> list[str]:
    return [part for part in re.split(r"[.\[\]]+", parameter) if part]


def _last(parameter: str) -> str:
    """The last name in the path."""
    return next((part for part in reversed(_parts(parameter)) if not part.isdigit()), "")


def _plain(word: str) -> str:
    return word.replace("_", " ")
