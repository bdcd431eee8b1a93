"""Inputs of a scene: all data that a reader without the program needs to know about the calculation."""

import math
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from comparison.numbers import SAME_STIFFNESS, Units, class_words, format_number, plural
from comparison.report.templating import flat
from la_core.exchange import setting_unit
from la_core.scene import given_keys
from la_core.text_table import coordinate_text, exists

Rows = list[tuple[str, str]]


def input_rows(comparison: dict[str, Any], units: Units) -> Rows:
    """Return the inputs of a scene as pairs of name and text."""
    facts = comparison.get("structure") or {}
    loaded = [*_materials(facts), *_loads(facts, units)]
    return [*_structure(comparison, facts, units), *loaded, *_motion(comparison, facts, units), *_methods(comparison)]


def scene_file(folder: Path) -> str:
    """Return the text of the scene in a folder of results; "" where it is missing."""
    try:
        return (folder / "scene.toml").read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError):
        return ""


def key_rows(text: str) -> list[tuple[str, str, str]]:
    """Return key, value with unit, and meaning of every key that a scene's text gives; empty for a text that cannot be read."""
    try:
        return [(given.key, f"{given.value} {given.unit}".rstrip(), given.meaning) for given in given_keys(text)]
    except (ValueError, KeyError, TypeError, AttributeError, StopIteration):
        return []


def setting_rows(comparison: dict[str, Any]) -> Rows:
    """Return name and value with its SI unit of every setting of YADE's run; nothing where it did not run."""
    turns = comparison.get("unit") == "N m"  # a moment is the reaction of a support that turns, in rad
    return [(name, f"{text} {setting_unit(name, turns)}".rstrip()) for name, text in flat(comparison.get("settings") or {})]


def _structure(comparison: dict[str, Any], facts: dict[str, Any], units: Units) -> Iterator[tuple[str, str]]:
    blocks = facts.get("blocks")
    if blocks:
        yield "blocks", f"{blocks['free']} free, {blocks['fixed']} fixed (ground), {blocks['support']} on the moving support"
        yield "dimensions of the free blocks together (x, y, z)", _extent(facts["size"])
        least, greatest = facts["block_size"]["least"], facts["block_size"]["greatest"]
        yield "one free block, least to greatest (x, y, z)", _extent_range(least, greatest)
    else:
        yield "free blocks", format_number(comparison.get("free_blocks"))
    carried = " and the loads on them" if facts.get("loads") else ""
    yield f"weight of the free blocks{carried}, W", units.text(comparison.get("weight"), "N", 5)
    yield (
        "interfaces and contact points",
        f"{format_number(comparison.get('interfaces'))} and {format_number(comparison.get('contact_points'))}",
    )


def _materials(facts: dict[str, Any]) -> Iterator[tuple[str, str]]:
    if not facts:
        return
    densities = facts["densities"]
    each = (f"{_given(row['density'])} kg/m3" + (f" ({plural(row['blocks'], 'block')})" if len(densities) > 1 else "") for row in densities)
    yield "density", ", ".join(each)
    if exists(facts.get("floor_mass")):
        yield "mass of floors on the blocks", f"{_given(facts['floor_mass'])} kg"
    gravity = np.array(facts["gravity"])
    down = "downwards (−z)" if gravity[2] < 0.0 and not np.any(gravity[:2]) else f"along {_vector(gravity)}"
    yield "gravity", f"{_given(float(np.linalg.norm(gravity)))} m/s2 {down}"
    angles = (f"{_given(mu)} ({format_number(math.degrees(math.atan(mu)), 3)}°)" for mu in facts["friction"])
    yield "friction coefficient mu (angle of friction)", ", ".join(angles)
    for joints in facts.get("joint_classes") or ():
        yield f"friction coefficient of {class_words(joints)}", _given(joints["friction"])
    yield "mortar, cohesion, tension, crushing", "none"
    inset = f"{_given(1e3 * facts['inset'])} mm"
    both = facts.get("inset_of_both")
    shared = f"; both methods are compared at {_given(1e3 * both)} mm" if exists(both) and both != facts["inset"] else ""
    yield "inset of the contact points (rounded edges)", f"{inset}{shared}"


def _loads(facts: dict[str, Any], units: Units) -> Iterator[tuple[str, str]]:
    for load in facts.get("loads") or ():
        force = ", ".join(units.text(part, "N", 4) for part in load["force"])
        mass = f", {_given(load['mass'])} kg" if exists(load["mass"]) else ""
        place = f", resultant through {_point(load['point'])} m" if load.get("point") else ""  # older results have none
        yield f"dead load {load['name']} (x, y, z)", f"({force}) on {plural(load['blocks'], 'block')}{mass}{place}"
    for tie in facts.get("ties") or ():
        place = f", from {' to '.join(f'{_point(end)} m' for end in tie['ends'])}" if tie.get("ends") else ""
        yield f"tie {tie['name']}, tension", f"{units.text(tie['tension'], 'N', 4)}, between {' and '.join(tie['between'])}{place}"


def _motion(comparison: dict[str, Any], facts: dict[str, Any], units: Units) -> Iterator[tuple[str, str]]:
    joints, yade = comparison.get("joints") or {}, comparison.get("yade") or {}
    unit = "rad" if "m" in str(comparison.get("unit", "")) else "m"
    if facts.get("live"):
        yield "live load, in proportion to weight", f"along {_vector(facts['live'])}"
    if facts.get("tilt"):
        yield "tilt of the ground, right-handed", f"about {_vector(facts['tilt'])}"
    if facts.get("motion"):
        yield from _support(facts)
    if exists(yade.get("settlement")):
        imposed = f"{'rotation' if unit == 'rad' else 'settlement'} imposed in YADE"
        yield "mean displacement along the load in YADE" if facts.get("live") else imposed, units.text(yade["settlement"], unit, 4)
    if joints:
        yield from _stiffness(joints, comparison.get("settings") or {}, units)
        moved = "displacement of the fastest block" if facts.get("live") else "rotation" if unit == "rad" else "settlement"
        yield f"largest {moved} (travel)", units.text(joints.get("travel"), unit, 4)
    if exists(facts.get("accuracy")):
        yield "requested accuracy", f"{format_number(100.0 * facts['accuracy'], 3)} %"


def _support(facts: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Yield the motion of the support, its blocks with another motion, and its place, for a scene with a settlement."""
    velocity, spin = np.split(np.array(facts["motion"], dtype=float), 2)
    turns = bool(np.any(spin))
    if turns:
        nearest = np.cross(spin, velocity)  # the point of the axis that is nearest to the origin
        yield "rotation of the support, right-handed", f"about the axis {_vector(spin)} through the point {_point(nearest)} m"
    else:
        yield "motion of the support, unit vector (x, y, z)", _vector(velocity)
    for own in facts.get("motions") or ():
        turn = f" in its middle, angular {_vector(own['spin'])} {'rad/rad' if turns else 'rad/m'}" if any(own["spin"]) else ""
        yield f"of it, motion of {', '.join(own['names'])}", f"{_vector(own['velocity'])}{turn}"
    support = facts.get("support") or {}
    if support:
        places = (
            f"{axis} {coordinate_text(a)} to {coordinate_text(b)} m"
            for axis, a, b in zip("xyz", support["low"], support["high"], strict=True)
        )
        yield "support", f"{', '.join(support['names'])}: {', '.join(places)}"


def _stiffness(joints: dict[str, Any], settings: dict[str, Any], units: Units) -> Iterator[tuple[str, str]]:
    """Yield the stiffness of a contact point in limit analysis and in YADE: `joints` of the case, and the settings of YADE's run."""
    for name in ("normal", "shear"):
        own, of_yade, row = joints.get(name), settings.get(f"{name}_stiffness"), f"{name} stiffness of a contact point"
        text = units.text(own, "N/m", 4)
        if not exists(of_yade):
            yield f"{row}, limit analysis", text
        elif exists(own) and math.isclose(own, of_yade, rel_tol=SAME_STIFFNESS):
            yield f"{row}, both methods", text
        else:
            times = f", {format_number(of_yade / own, 3)} times that of limit analysis" if exists(own) and own else ""
            yield f"{row}, limit analysis", text
            yield f"{row}, YADE", f"{units.text(of_yade, 'N/m', 4)}{times}"


def _methods(comparison: dict[str, Any]) -> Iterator[tuple[str, str]]:
    provenance, yade = comparison.get("provenance") or {}, comparison.get("yade") or {}
    if provenance.get("crosscheck"):
        yield "limit analysis", f"Crosscheck {provenance['crosscheck']}, solver Clarabel {provenance.get('clarabel', '–')}"
    if yade.get("version"):
        yield "discrete elements", f"YADE {yade['version']}"


def _given(value: float) -> str:
    """Return a given number without the round-off digits of calculations."""
    return f"{round(value, 9) + 0.0:.6g}".replace("-", "−")


def _point(parts: Iterable[float]) -> str:
    """Return a point as its coordinates, m; a coordinate below 1 m has as many digits as those of a vector."""
    return f"({', '.join(_given(x) if abs(x) < 1.0 else coordinate_text(x) for x in map(float, parts))})"


def _vector(parts: Iterable[float]) -> str:
    """Return a vector that was given, such as "(0, 0, −1)"."""
    return f"({', '.join(_given(float(part)) for part in parts)})"


def _extent(size: list[float]) -> str:
    return f"{' × '.join(_given(round(1e3 * length, 1)) for length in size)} mm"


def _extent_range(least: list[float], greatest: list[float]) -> str:
    """Return the extents of one block along each axis, from the least to the greatest of all blocks."""
    ends = [[_given(round(1e3 * length, 1)) for length in size] for size in (least, greatest)]
    each = (low if low == high else f"{low} to {high}" for low, high in zip(*ends, strict=True))
    return f"{' × '.join(each)} mm"
