"""Words and units for the parameters that a campaign varies and for the quantities that its cases give."""

import re
from collections.abc import Mapping
from typing import Any

from comparison.numbers import format_number
from la_core.exchange import SETTING_UNITS

NAMES = {
    "joint.friction": "friction mu (-)",
    "joint.inset": "inset (m)",
    "stone.density": "density (kg/m³)",
    "settlement.direction": "direction of the settlement",
    "live.direction": "direction of the live load",
    "tilt.axis": "axis of the tilt",
    "effects.plane": "plane model",
    "effects.friction": "friction law",
    "classic.relaxation": "classic relaxation b (-)",
    "classic.slope": "classic slope a (-)",
    "classic.cohesion": "classic cohesion (mean block weights)",
    "classic.tolerance": "classic tolerance (mean block weights)",
    "classic.iterations": "classic: maximum of programmes",
    "accuracy": "requested accuracy (share)",
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
}
UNITS = {  # by unit: keys whose own names are clear, with the part of their path that makes them unique
    "m": "from to centre point vertices profile y shift bearing",
    "m or rad": "path.settlement",
    "m per unit": "scale",
    "degrees": "oculus sector",
    "kg": "mass",
    "kg, kg/m or kg/m2": "load.mass",
    "N, N/m or N/m2": "load.force",
    "N": "tie.force",
    "periods": "yade.travel_periods",
    "-": "yade.damping_ratio yade.threads yade.stiffening yade.least_stiffening yade.plateau_share yade.quick_speed yade.rattling "
    "yade.servo_frequency yade.servo_damping yade.added_mass yade.swing_damping yade.time_step_share yade.gravity_damping "
    "yade.rest_unbalanced yade.plateau_uncertainty yade.plateau_drift yade.stop_uncertainty "
    "yade.reaction_floor yade.settings_uncertainty zone.ratio drawing.scale",
}
UNIT_OF = {key: unit for unit, keys in UNITS.items() for key in keys.split()}
UNIT_OF |= {f"yade.{name}": unit for name, unit in SETTING_UNITS.items()}
COMPONENTS = {  # names of an array's entries, by the end of the key's path
    "": ("x", "y", "z"),
    "profile": ("x", "z"),
    "opening.from": ("along the wall", "z"),
    "opening.to": ("along the wall", "z"),
    "prism.y": ("near end", "far end"),
    "dome.support": ("first lune", "last lune"),
}
UNIT = re.compile(r" \([^()]*\)")
CLASSIC = "classic."  # parameters that only the classic iteration knows
QUANTITY = {"N": "reaction over weight, R / W (-)", "N m": "reaction over weight, R / W (m)", "": "collapse multiplier (-)"}


def label(parameter: str, named: Mapping[str, str] | None = None) -> str:
    """Return the axis label of a parameter: its name and unit.

    parameter: dotted path; a path without an entry here gives its own words. named: the campaign's short names of parameters. A short
    name replaces the words; the unit is added unless the short name has one.
    """
    whole = _whole(parameter)
    short_name = (named or {}).get(parameter)
    if short_name is None:
        return whole
    unit = UNIT.search(whole)
    return short_name if unit is None or UNIT.search(short_name) else short_name + unit[0]


def short(parameter: str, named: Mapping[str, str] | None = None) -> str:
    """Return the label without its unit."""
    return UNIT.sub("", label(parameter, named))


def _whole(parameter: str) -> str:
    """Return table, words, unit and component of a parameter; [0] is the first table of a kind, as in the parameter itself."""
    if parameter in NAMES:
        return NAMES[parameter]
    *parents, last = steps = _parts(parameter)
    indices: list[int] = []
    while last.isdigit() and parents:
        indices.insert(0, int(last))
        *parents, last = parents
    ends = _ends([step for step in steps if not step.isdigit()])
    words = next((NAMES[end] for end in ends if end in NAMES), _plain(last))
    unit = next((UNIT_OF[end] for end in ends if end in UNIT_OF), None)
    if unit is not None and not UNIT.search(words):
        words += f" ({unit})"
    table = " ".join(_plain(step) if not step.isdigit() else f"[{step}]" for step in parents).replace(" [", "[")
    return (f"{table}: {words}" if table else words) + _component(ends, indices)


def _ends(path: list[str]) -> list[str]:
    """Return all ends of a path, the longest first."""
    return [".".join(path[k:]) for k in range(len(path))]


def _component(ends: list[str], indices: list[int]) -> str:
    """Return the name of a parameter that is an entry of an array; "" for a whole value."""
    if not indices:
        return ""
    *points, index = indices
    components = next(COMPONENTS[end] for end in (*ends, "") if end in COMPONENTS)
    component = components[index] if index < len(components) else f"[{index}]"
    return "".join(f", point [{point}]" for point in points) + f", {component}"


def words_of(held: Mapping[str, Any], named: Mapping[str, str] | None = None) -> str:
    """Return parameters with their values in words; "" without any."""
    return ", ".join(f"{short(name, named)} {shown(value)}" for name, value in held.items())


def shown(value: Any) -> str:
    """Return a parameter's value as short text; a dash for None. Of a table, the keys that have a value."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return "(" + ", ".join(shown(entry) for entry in value) + ")"
    if isinstance(value, dict):
        return ", ".join(f"{_plain(key)} {shown(entry)}" for key, entry in value.items() if entry not in (None, [], {}))
    if isinstance(value, int | float):
        return f"{value:.6g}".replace("-", "−", 1) if value < 0 else f"{value:.6g}"
    return format_number(None) if value is None else str(value)


def quantity(unit: str | None) -> str:
    """Return the axis label of a reaction over the weight; unit: of the reaction, empty for a multiplier."""
    return QUANTITY.get(unit or "", QUANTITY["N"])


def _parts(parameter: str) -> list[str]:
    return [step for step in re.split(r"[.\[\]]+", parameter) if step]


def _plain(word: str) -> str:
    return word.replace("_", " ")
