"""Facts of a structure and its mechanisms that a report states: they go into `comparison.json` beside the results, in SI units."""

import hashlib
from collections.abc import Iterator
from typing import Any

import numpy as np

from comparison.figures import Motion, motions, shown_answer
from comparison.yade import Results
from la_core.exchange import FIXED, FREE, SUPPORT
from la_core.geometry import Blocks
from la_core.measures import ContactState, contact_states, ground_reactions, joint_rows, joint_states, mechanism, thrust_line
from la_core.model import Assembly
from la_core.scene import Scene, classes_as_dicts, loads_as_dicts, motions_as_dicts, ties_as_dicts

MOST_NAMES = 12  # blocks or joints that a report names
MOST_ROWS = 24  # joints that open or slide, or blocks of the ground and the support, in their tables


def structure_facts(results: Results) -> dict[str, Any]:
    """Return the inputs and the mechanisms of a scene as a JSON object; lengths in m, forces in N.

    `size` and `block_size` are extents along x, y and z: of all free blocks together, and the least and the greatest of one.
    `moving_blocks` counts the blocks that move, by method. `joints_of_one_method` names the joints that open or slide in one
    method only. `moving_joints` counts those of limit analysis; its rows are the joints that move most. `ground_reactions` counts the
    fixed and the support blocks that touch the structure; its rows are the largest forces on the structure, by method. `files` has the
    SHA-256 of the scene and of each file that it reads, by the name of its copy.
    """
    scene, analysis = results.scene, results.analysis
    blocks = scene.blocks
    extent = (blocks.high - blocks.low)[blocks.free]
    low, high = blocks.low[blocks.free].min(axis=0), blocks.high[blocks.free].max(axis=0)
    roles = {name: int((blocks.role == role).sum()) for name, role in (("free", FREE), ("fixed", FIXED), ("support", SUPPORT))}
    facts: dict[str, Any] = {
        "project": scene.project,
        "author": scene.author,
        "date": scene.date,
        "files": _digests(scene),
        "gravity": scene.gravity.tolist(),
        "friction": np.unique(analysis.whole.points.friction).tolist(),
        "inset": scene.inset,
        "inset_of_both": analysis.assembly.inset,
        "densities": list(_densities(stone_density(scene)[blocks.free])),
        "floor_mass": None if scene.floor_mass is None else float(scene.floor_mass.sum()),
        "blocks": roles,
        "size": (high - low).tolist(),
        "block_size": {"least": extent.min(axis=0).tolist(), "greatest": extent.max(axis=0).tolist()},
        "joint_classes": classes_as_dicts(scene.joint_classes),
        "loads": loads_as_dicts(scene.loads, scene.load_names),
        "ties": ties_as_dicts(scene.ties, blocks.names),
        "motion": scene.support_twist.tolist() if scene.support_twist is not None else None,
        "live": scene.live.tolist() if scene.live is not None else None,
        "motions": [] if scene.own_twists is None else motions_as_dicts(scene.support_twists, blocks),
        "tilt": scene.tilt.tolist() if scene.tilt is not None else None,
        "support": _support(blocks),
        "accuracy": scene.accuracy,
        "has_thrust_line": bool(len(thrust_line(analysis.assembly))),
    }
    return facts | _mechanism_facts(results) | {"ground_reactions": _ground_reactions(results)}


def _digests(scene: Scene) -> dict[str, str]:
    """Return the SHA-256 of a scene and of its drawings and meshes, by name, as they were read."""
    contents = {"scene.toml": scene.text.encode()} | {str(mesh.path): mesh.content for mesh in scene.meshes}
    return {name: hashlib.sha256(content).hexdigest() for name, content in contents.items()}


def stone_density(scene: Scene) -> np.ndarray:
    """Return the density (B,) of each block without the floors that it carries, kg/m3; NaN for a held block without density."""
    blocks = scene.blocks
    return blocks.density - (0.0 if scene.floor_mass is None else scene.floor_mass / blocks.volume)


def _densities(density: np.ndarray) -> Iterator[dict[str, Any]]:
    """Yield each density (n,) of blocks, kg/m3, with the number of blocks that have it, the most frequent first."""
    values, counts = np.unique(np.round(density, 6), return_counts=True)
    for k in np.argsort(-counts, kind="stable"):
        yield {"density": float(values[k]), "blocks": int(counts[k])}


def _support(blocks: Blocks) -> dict[str, Any] | None:
    """Return names and extent of the moving supports; None without any."""
    moved = np.flatnonzero(blocks.role == SUPPORT)
    if not len(moved):
        return None
    names = [blocks.names[k] for k in moved[:MOST_NAMES]]
    return {"names": names, "low": blocks.low[moved].min(axis=0).tolist(), "high": blocks.high[moved].max(axis=0).tolist()}


def _mechanism_facts(results: Results) -> dict[str, Any]:
    """Return the number of moving blocks by method, the moving joints, and the joints in which two known mechanisms differ."""
    assembly = results.analysis.assembly
    shown = {"yade" if method.label == "YADE" else "limit_analysis": method for method in motions(results).methods}
    known = {name: method for name, method in shown.items() if np.isfinite(method.twists).all()}
    moving = {name: int(mechanism.moving(assembly, method.twists).sum()) for name, method in known.items()}
    facts: dict[str, Any] = {"moving_blocks": moving, "joints_of_one_method": {}}
    if method := known.get("limit_analysis"):
        facts["moving_joints"] = _moving_joints(assembly, method)
    if len(known) == 2:
        gives = [_opens_or_slides(method.joints) for method in known.values()]
        clearly = [_opens_or_slides(_without_slow_slip(assembly, method)) for method in known.values()]
        interfaces, names = assembly.interfaces, assembly.blocks.names
        for name, own, other in zip(known, clearly, reversed(gives), strict=True):
            alone = np.flatnonzero(own & ~other)
            pairs = [f"{names[interfaces.block_a[k]]} and {names[interfaces.block_b[k]]}" for k in alone[:MOST_NAMES]]
            facts["joints_of_one_method"][name] = {"count": len(alone), "names": pairs}
    return facts


def _opens_or_slides(states: np.ndarray) -> np.ndarray:
    """Return a mask of the joints that open or slide."""
    return np.isin(states, (ContactState.OPENING, ContactState.SLIDING))


def _without_slow_slip(assembly: Assembly, method: Motion) -> np.ndarray:
    """Return the states of the joints where slow slip counts as rest, so that a joint near the least speed does not tell methods apart."""
    forces = method.forces[-1]
    return joint_states(assembly, contact_states(assembly, method.twists, forces, slow_slip=False), forces)


def _moving_joints(assembly: Assembly, method: Motion) -> dict[str, Any]:
    """Return the number of joints that open or slide in a mechanism, and as rows the joints that move most, in SI units."""
    rows = joint_rows(assembly, method.twists, method.forces[-1])
    moved = [row for row in rows if row["state"] in ("opening", "sliding")]
    speed = np.array([max(row["opening"], row["slip"]) for row in moved])
    rounded = np.round(speed / (speed.max(initial=0.0) or 1.0), 6)
    order = np.argsort(-rounded, kind="stable")  # joints that move alike but for round-off keep their order
    return {"count": len(moved), "rows": [moved[k] for k in order[:MOST_ROWS]]}


def _ground_reactions(results: Results) -> dict[str, Any]:
    """Return the number of fixed and support blocks that touch the structure, and as rows the forces on it, N, of the most loaded blocks.

    Both methods hold the free blocks that are set aside. These blocks are no ground: they have no row, and `aside` is their number.
    """
    assembly, run = results.analysis.assembly, results.run
    forces = {"limit_analysis": shown_answer(results.analysis)[1].forces}
    if run is not None and run.status == "plateau":
        forces["yade"] = run.plateau_forces()
    known = {name: ground_reactions(assembly, each) for name, each in forces.items() if np.isfinite(each).all()}
    if "limit_analysis" not in known:
        return {"count": 0, "rows": [], "aside": 0}
    size = np.linalg.norm(known["limit_analysis"], axis=1)
    held, interfaces = np.flatnonzero(~assembly.blocks.free & ~assembly.aside), assembly.interfaces
    touched = np.intersect1d(held, np.append(interfaces.block_a, interfaces.block_b))
    largest = touched[np.argsort(-size[touched], kind="stable")][:MOST_ROWS]
    names = assembly.blocks.names
    rows = [{"block": names[k]} | {name: each[k].tolist() for name, each in known.items()} for k in np.sort(largest).tolist()]
    return {"count": len(touched), "rows": rows, "aside": int(assembly.aside.sum())}
