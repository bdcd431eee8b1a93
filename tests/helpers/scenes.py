"""Scenes for the tests, built from the TOML text that a user would write, and moved copies of them.

No function here calls a solver. The inset is 0 unless given, because closed forms hold for sharp edges.
"""

import json
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import la_core
from la_core.analysis.modelling import structural_model
from la_core.geometry.blocks import ROLES
from la_core.scene.scene import Scene, load_scene

SHIPPED = Path(la_core.__file__).parent / "scenes"
DOWN = (0.0, 0.0, -1.0)
ROLE_NAMES = {number: name for name, number in ROLES.items()}


def shipped(name: str) -> Scene:
    """Load a shipped scene."""
    return load_scene(SHIPPED / f"{name}.toml")


def inline(value: Any) -> str:
    """Return a value as TOML: arrays, inline tables, strings, numbers and booleans."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {inline(item)}" for key, item in value.items()) + " }"
    if isinstance(value, str | bool):
        return json.dumps(value)
    if isinstance(value, Iterable):
        return "[" + ", ".join(inline(item) for item in value) + "]"
    return repr(value.item() if isinstance(value, np.generic) else value)


def block(name: str, role: str = "free", density: float | None = None, **shape: Any) -> str:
    """A [[block]] table; the shape is one of box=(low, high), prism=(profile, y), polyhedron=vertices."""
    ((kind, numbers),) = shape.items()
    keys = {"box": ("from", "to"), "prism": ("profile", "y"), "polyhedron": ("vertices",)}[kind]
    table = dict(zip(keys, numbers if kind != "polyhedron" else (numbers,), strict=True))
    lines = ["[[block]]", f"name = {inline(name)}", f"role = {inline(role)}", f"{kind} = {inline(table)}"]
    return "\n".join(lines + ([f"density = {inline(density)}"] if density is not None else []))


def table(name: str, /, **entries: Any) -> str:
    """Any other table, such as table("[wall]", courses=3) or table("joint", friction=0.6)."""
    return "\n".join([f"[{name}]", *(f"{key} = {inline(value)}" for key, value in entries.items())])


def text(
    *parts: str,
    friction: float = 0.6,
    inset: float = 0.0,
    density: float = 2000.0,
    gravity: Sequence[float] = (0.0, 0.0, -9.81),
    settlement: Sequence[float] | dict[str, Any] | None = DOWN,
    live: Sequence[float] | None = None,
    tilt: Sequence[float] | None = None,
    plane: bool | str = "auto",
    model: str = "associated",
    effects: dict[str, Any] | None = None,
    reach: bool | str = "auto",
) -> str:
    """A whole scene file. `live` or `tilt` replaces `settlement`, a direction or a table. `effects` adds to plane, model and reach."""
    lines = [f"gravity = {inline(gravity)}", table("stone", density=density), table("joint", friction=friction, inset=inset), *parts]
    lines.append(table("effects", **({"plane": plane, "friction": model, "reach": reach} | (effects or {}))))
    if live is not None:
        lines.append(table("live", direction=live))
    elif tilt is not None:
        lines.append(table("tilt", axis=tilt))
    elif settlement is not None:
        lines.append(table("settlement", **(settlement if isinstance(settlement, dict) else {"direction": settlement})))
    return "\n".join(lines) + "\n"


def load(toml: str, name: str = "scene") -> Scene:
    """Load a scene from its text."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / f"{name}.toml"
        path.write_text(toml, encoding="utf-8")
        return load_scene(path)


def build(*parts: str, **options: Any) -> Scene:
    """Load the scene that `text` describes."""
    return load(text(*parts, **options))


def box(name: str, low: Sequence[float], high: Sequence[float], role: str = "free", density: float | None = None) -> str:
    """A [[block]] with a box."""
    return block(name, role, density, box=(low, high))


def base(split: float, length: float, depth: float = 1.0) -> tuple[str, str]:
    """Fixed base up to x = split, settling base from there to `length`, both with their top at z = 0."""
    return (
        box("fixed base", (0.0, 0.0, -0.2), (split, depth, 0.0), "fixed"),
        box("settling base", (split, 0.0, -0.2), (length, depth, 0.0), "support"),
    )


def wall(
    per_course: int,
    courses: int,
    split: float | None = None,
    block_size: tuple[float, float, float] = (0.4, 0.3, 0.2),
    bond: str = "running",
    first: str = "full",
    **entries: Any,
) -> tuple[str, ...]:
    """A wall on a base in two parts that meet at x = split, or on one fixed base when split is None."""
    length, depth = per_course * block_size[0], block_size[1]
    courses_text = table(
        "[wall]", bond=bond, origin=(0.0, 0.0, 0.0), block=block_size, per_course=per_course, courses=courses, first=first, **entries
    )
    below = (box("base", (0.0, 0.0, -0.2), (length, depth, 0.0), "fixed"),) if split is None else base(split, length, depth)
    return (courses_text, *below)


def arch(voussoirs: int, thickness: float, radius: float = 1.0, depth: float = 1.0, right: str = "support") -> str:
    """A semicircular arch about the origin between springers."""
    springers = {"left": "fixed", "right": right}
    centre = (0.0, 0.0, 0.0)
    return table("[arch]", centre=centre, radius=radius, thickness=thickness, depth=depth, voussoirs=voussoirs, springers=springers)


def crossing_beams() -> tuple[str, ...]:
    """Two beams that cross on two piers, one of which settles: a structure that is not plane."""
    return (
        box("left wall", (0.0, 0.0, 0.0), (0.3, 1.0, 1.0)),
        box("right wall", (1.3, 0.1, 0.0), (1.6, 1.1, 1.0)),
        box("beam", (-0.1, 0.3, 1.0), (1.7, 0.55, 1.2)),
        box("upper beam", (0.6, -0.2, 1.2), (0.8, 1.2, 1.4)),
        box("fixed base", (-0.1, -0.1, -0.2), (0.4, 1.2, 0.0), "fixed"),
        box("settling base", (1.2, -0.1, -0.2), (1.7, 1.2, 0.0), "support"),
    )


def rotation(axis: Sequence[float], angle: float) -> np.ndarray:
    """Rotation matrix about an axis (Rodrigues), angle in rad."""
    x, y, z = np.array(axis, dtype=float) / np.linalg.norm(axis)
    skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * skew + (1.0 - np.cos(angle)) * skew @ skew


def moved(
    scene: Scene,
    turn: np.ndarray | None = None,
    shift: Sequence[float] = (0.0, 0.0, 0.0),
    scale: float = 1.0,
    density: float = 1.0,
    order: Sequence[int] | None = None,
    plane: bool | str = "auto",
) -> Scene:
    """Return the scene with x -> scale * turn @ x + shift, turned gravity and motion, densities times `density`, and blocks in `order`.

    `turn` may mirror. Blocks become polyhedra, so that they do not keep the axes of the original.
    """
    turn = np.eye(3) if turn is None else turn
    blocks, parts = scene.blocks, []
    place = scale * blocks.vertices @ turn.T + np.array(shift)
    for k in range(len(blocks)) if order is None else order:
        vertices = place[blocks.vertex_start[k] : blocks.vertex_start[k + 1]]
        own = blocks.density[k] * density
        parts.append(block(blocks.names[k], ROLE_NAMES[int(blocks.role[k])], float(own), polyhedron=vertices))
    twist = scene.support_twist
    settlement: Any = None
    if twist is not None:
        spin = twist[3:]
        if np.any(spin):
            point = scale * turn @ np.cross(spin, twist[:3]) + np.array(shift)
            settlement = {"axis": np.linalg.det(turn) * turn @ spin, "point": point}
        else:
            settlement = turn @ twist[:3]
    return build(
        *parts,
        friction=scene.friction,
        inset=scene.inset * scale,
        gravity=turn @ scene.gravity,
        settlement=settlement,
        live=None if scene.live is None else turn @ scene.live,
        plane=plane,
        model=scene.effects.friction,
    )


def joints(scene: Scene) -> list[tuple[str, str]]:
    """Return the pairs of blocks with a joint in the structural model."""
    found = structural_model(scene).assembly.interfaces
    return sorted((scene.blocks.names[a], scene.blocks.names[b]) for a, b in zip(found.block_a, found.block_b, strict=True))
