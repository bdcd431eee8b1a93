"""Changes of the geometry while a scene is read (outlines of drawings, closed joints, dropped joints), as values and as rows."""

from collections.abc import Iterator
from typing import Any

from la_core.scene.scene import Scene
from la_core.text_table import place_text

LISTED = 10  # places that could not be repaired; further ones are counted
ROUND_OFF = 1e-7  # m: a smaller move changed nothing
WHAT_WAS_LEFT = {
    "openings": "openings, in which nothing is built",
    "doubles": "outlines drawn twice, dropped",
    "specks": "outlines without area or thinner than the tolerance, dropped",
    "loose_lines": "lines that enclose nothing, dropped",
    "in_openings": "outlines within openings, dropped",
    "straightened": "outlines made convex within the tolerance",
    "compounds": "blocks that are not convex, of several parts",
}


def geometry_changes(scene: Scene, slivers: int, short: int) -> dict[str, Any] | None:
    """Every change of the geometry as plain values; None without drawings, repairs, and dropped or short joints.

    Parameters
    ----------
    scene : Scene
        Scene as read.
    slivers : int
        Joints that are dropped because they are too short.
    short : int
        Joints with an inset of their own, because they are short.
    """
    if not (scene.drawn or scene.repairs or slivers or short):
        return None
    return {
        "drawings": [one.as_dict() for one in scene.drawn],
        "repairs": None if scene.repairs is None else scene.repairs.as_dict(),
        "joints_dropped": slivers,
        "short_joints": short,
    }


def change_rows(changes: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Rows of a table, one for each change and its amount. changes: from `geometry_changes`."""
    for drawing in changes["drawings"]:
        yield f"blocks from {drawing['file']}", str(drawing["blocks"])
        for key, what in WHAT_WAS_LEFT.items():
            if drawing.get(key):  # files of earlier versions lack some keys
                yield f"  {what}", str(drawing[key])
        if drawing["ignored"]:
            yield "  not read", ", ".join(f"{count} {kind}" for kind, count in drawing["ignored"].items())
    repairs = changes["repairs"]
    if repairs is not None:
        yield from _repair_rows(repairs)
    if changes["joints_dropped"]:
        yield "joints dropped, too short to count", str(changes["joints_dropped"])
    if changes["short_joints"]:
        yield "short joints with an inset of their own", str(changes["short_joints"])
    unclosed = repairs["unclosed"] if repairs is not None else ()
    if unclosed:
        yield "places that are not closed", str(len(unclosed))
    for one in unclosed[:LISTED]:
        first, second = one["blocks"]
        kind = "gap" if one["gap"] > 0.0 else "overlap"
        yield f'  "{first}" and "{second}", at {place_text(one["vertex"])}', f"{kind} of {1e3 * abs(one['gap']):.3g} mm"
    if len(unclosed) > LISTED:
        yield "  and others", str(len(unclosed) - LISTED)


def _repair_rows(repairs: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """Rows on faces moved and corners cut off within the tolerance; where nothing was moved or cut, one row says so."""
    if made_convex := repairs.get("made_convex"):  # files of earlier versions lack it
        yield "bodies of meshes made convex within the tolerance", str(made_convex)
    allowed = f"within {1e3 * repairs['tolerance']:.3g} mm"
    if repairs["largest_move"] <= ROUND_OFF and not repairs["overlaps_cut"]:
        yield "faces and corners", f"nothing had to be moved {allowed}"
        return
    yield "coordinates", f"may be wrong by {1e3 * repairs['tolerance']:.3g} mm"
    widest = f", up to {1e3 * repairs['joint_width']:.3g} mm wide" if repairs["joint_width"] else ""
    yield f"open joints closed{widest}", str(repairs["gaps_closed"])
    yield "overlapping faces parted", str(repairs["overlaps_closed"])
    deepest = repairs.get("deepest_cut")  # files of earlier versions lack it
    yield f"overlapping corners cut off{f', up to {1e3 * deepest:.3g} mm deep' if deepest else ''}", str(repairs["overlaps_cut"])
    if repairs["largest_move"] > ROUND_OFF:
        yield f'largest move of a corner, of "{repairs["moved_block"]}"', f"{1e3 * repairs['largest_move']:.3g} mm"
