"""The interactive 3D view of a scene in the report: its data as JSON, and the page's scripts with their digests.

Data are little-endian arrays in base64, read by the scripts in `web`. Lengths are in m, from the middle of the structure. Forces are the
resultants of the joints, N, each at its centre of pressure. Loads are arrows and rods in their place at rest, each end with its block.
"""

import base64
import hashlib
import json
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from comparison.figures import ROLE_FACE, ROLE_NAME, Motion, Motions, OuterFaces, canvas, motions, push_arrow, push_name
from comparison.numbers import force_unit, format_number
from comparison.yade import Results
from la_core.geometry import Blocks, next_corners
from la_core.measures import joint_centres, joint_forces, mechanism, thrust_line
from la_core.model import Assembly
from la_core.scene import GROUND, Scene, loads_as_dicts

FILE = "viewer.json"
WEB = Path(__file__).parent / "web"
LARGEST = 600_000  # bytes of the states of one method; fewer states are kept where each is large
MOST_STATES = 24
MOST_ARROWS = 400  # of dead loads
SCRIPTS = {"library": ("three.min.js",), "viewer": ("method.js", "frame.js", "picking.js", "viewer.js")}


def viewer_text(results: Results) -> str:
    """Return the text of `viewer.json`."""
    scene, analysis = results.scene, results.analysis
    assembly, moving = analysis.assembly, motions(results)
    _, _, toward = canvas.view_axes(assembly.effects.plane)
    chain = thrust_line(assembly)
    parts = [_method(assembly, method, len(ROLE_NAME) + k) for k, method in enumerate(moving.methods)]
    divisor, unit = force_unit(scene.weight, "N")
    content = {
        "title": scene.title,
        "toward": toward.tolist(),
        "see_through": assembly.effects.plane or len(assembly.blocks) <= canvas.FEW,
        **_travel(scene, moving),
        **_geometry(assembly, toward),
        "palette": [{"name": name, "colour": ROLE_FACE[role]} for role, name in ROLE_NAME.items()]
        + [_key(method) for method in moving.methods],
        "methods": [part for part, _ in parts],
        "largest_force": max((largest for _, largest in parts), default=0.0),
        "force_unit": unit,
        "force_unit_size": divisor,
        "thrust": _array(chain, "<u4"),
        "names": list(assembly.blocks.names),
        "weights": _array(np.nan_to_num(assembly.blocks.mass) * float(np.linalg.norm(scene.gravity)), "<f4"),
        "friction": _array(_friction(assembly), "<f4"),
        "loads": list(_loads(scene, assembly, divisor, unit)),
    }
    return json.dumps(content, ensure_ascii=False, allow_nan=False, separators=(",", ":")) + "\n"


def embedded(folder: Path) -> str:
    """Return a scene's stored view as text that cannot end its script element.

    The text is "" where the view is missing or not JSON.
    """
    try:
        content = json.loads((folder / FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return ""
    return json.dumps(content, separators=(",", ":")).replace("<", "\\u003c")


@cache
def scripts() -> dict[str, str]:
    """Return the page's scripts by name, and the `policy` that allows these scripts only.

    No script contains text that could end its element.
    """
    texts = {name: "".join((WEB / file).read_text(encoding="utf-8") for file in files) for name, files in SCRIPTS.items()}
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for text in texts.values()]
    return texts | {"policy": " ".join(f"'sha256-{digest}'" for digest in digests)}


def _travel(scene: Scene, moving: Motions) -> dict[str, Any]:
    """Return the quantity that the slider moves, its unit and range.

    SI values times `unit_per_si` give values in that unit.
    """
    quantity, unit, factor = "settlement", "mm", 1e3
    if scene.live is not None:
        quantity, unit, factor = "growth of the mechanism", "%", 100.0 / (moving.end or 1.0)
    elif scene.is_rotation:
        quantity, unit = "rotation of the support", "mrad"
    magnification = None if scene.live is not None and moving.magnification == 1.0 else moving.magnification
    return {
        "quantity": quantity,
        "unit": unit,
        "unit_per_si": factor,
        "start": moving.start,
        "end": moving.end,
        "magnification": magnification,
    }


def _geometry(assembly: Assembly, toward: np.ndarray) -> dict[str, Any]:
    """Return the blocks as triangles and outer edges, and the joints with their blocks a and b."""
    blocks = assembly.blocks
    middle = _middle(blocks)
    first = np.repeat(blocks.face_start[:-1], np.diff(blocks.face_start))
    fan = np.stack([first, np.arange(len(first)), next_corners(blocks.face_start)], axis=1)
    fan = fan[(fan[:, 0] != fan[:, 1]) & (fan[:, 0] != fan[:, 2])]
    return {
        "size": canvas.structure_size(blocks),
        "vertices": _array(blocks.vertices - middle, "<f4"),
        "owner": _array(blocks.vertex_block, "<u4"),
        "centroids": _array(blocks.centroid - middle, "<f4"),
        "triangles": _array(blocks.face_vertex[fan], "<u4"),
        "edges": _array(OuterFaces(blocks, toward).edges(), "<u4"),
        "points": _array(joint_centres(assembly) - middle, "<f4"),
        "sides": _array(np.stack([assembly.interfaces.block_a, assembly.interfaces.block_b], axis=1), "<u4"),
        "normals": _array(assembly.interfaces.normal, "<f4"),
    }


def _method(assembly: Assembly, motion: Motion, colour: int) -> tuple[dict[str, Any], float]:
    """Return a method's states in at most LARGEST bytes with each block's look and each joint's state, and the largest resultant, N.

    `colour` is the place in the palette of the blocks that move.
    """
    blocks = assembly.blocks
    known = bool(np.isfinite(motion.twists).all())
    marked = mechanism.moving(assembly, motion.twists) if known else np.isin(blocks.names, motion.falling)
    bytes_each = 4 * (motion.displacement[0].size + 6 * len(assembly.interfaces))
    count = int(np.clip(LARGEST // bytes_each, 2, MOST_STATES))
    kept = (
        np.unique(np.linspace(0, len(motion.settlement) - 1, count).round().astype(int)) if len(motion.settlement) > count else slice(None)
    )
    resultants = [
        joint_forces(assembly, np.nan_to_num(forces)) for forces in (motion.forces if len(motion.forces) == 1 else motion.forces[kept])
    ]
    middle, rest = _middle(blocks), joint_centres(assembly)
    centres = np.stack([np.where(np.isfinite(joints.centre), joints.centre, rest) for joints in resultants])
    forces = np.stack([joints.force for joints in resultants])
    return {
        "label": motion.label,
        "note": motion.reason,
        "looks": _array(np.where(marked, colour, canvas.drawn_roles(assembly)), "u1"),
        "joints": _array(motion.joints, "i1"),
        "settlement": _array(motion.settlement[kept], "<f4"),
        "displacement": _array(motion.displacement[kept], "<f4"),
        "forces": _array(forces, "<f4"),
        "centres": _array(centres - middle, "<f4"),
    }, float(np.linalg.norm(forces, axis=-1).max(initial=0.0))


def _loads(scene: Scene, assembly: Assembly, divisor: float, unit: str) -> Iterator[dict[str, Any]]:
    """Yield dead loads, ties and the push with their words: starts and ends (N, 3), and the block of each end, GROUND for none.

    `divisor` and `unit` are those of forces in words.
    """
    middle = _middle(assembly.blocks)

    def item(kind: str, words: str, start: np.ndarray, end: np.ndarray, of_start: Any, of_end: Any) -> dict[str, Any]:
        places = {"start": _array(start - middle, "<f4"), "end": _array(end - middle, "<f4")}
        return {"kind": kind, "words": words, **places, "of_start": _array(of_start, "<i4"), "of_end": _array(of_end, "<i4")}

    shown, start = canvas.load_arrows(assembly.blocks, scene.loads.point, scene.loads.force, MOST_ARROWS)
    for number, load in enumerate(loads_as_dicts(scene.loads, scene.load_names)):
        own = scene.loads.table[shown] == number
        if own.any():
            of, size = scene.loads.block[shown][own], float(np.linalg.norm(load["force"])) / divisor
            words = f"{load['name']}: {format_number(size, 3)} {unit}"
            yield item("dead", words, start[own], scene.loads.point[shown][own], of, of)
    for number, name in enumerate(scene.ties.names if scene.ties is not None else ()):
        assert scene.ties is not None
        ends, of = scene.ties.ends[number], scene.ties.block[number]
        words = f"{name}: {format_number(float(scene.ties.tension[number]) / divisor, 3)} {unit}"
        yield item("tie", words, ends[:1], ends[1:], of[:1], of[1:])
    if scene.live is not None:
        first, last = push_arrow(assembly)
        yield item("push", push_name(scene), first, last, [GROUND], [GROUND])


def _middle(blocks: Blocks) -> np.ndarray:
    return (blocks.low.min(axis=0) + blocks.high.max(axis=0)) / 2.0


def _friction(assembly: Assembly) -> np.ndarray:
    """Return the friction coefficient (I,) of each interface, the least of its contact points."""
    friction = np.full(len(assembly.interfaces), np.inf)
    np.minimum.at(friction, assembly.points.interface, assembly.points.friction)
    return friction


def _key(motion: Motion) -> dict[str, str]:
    verb = "falls" if motion.falling else "moves"
    return {"name": f"{verb}, {motion.label}", "colour": canvas.tint(canvas.method_colour(motion.label))}


def _array(values: np.ndarray, dtype: str) -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=dtype).tobytes()).decode("ascii")
