"""What reading changed in the geometry of a scene: drawings, closed joints, dropped joints; as values and as sentences."""

from collections.abc import Iterator
from typing import Any

from la_core.scene.scene import Scene

LISTED = 10  # of the places that could not be repaired
WHAT_WAS_LEFT = {
    "doubles": "outlines drawn twice, dropped",
    "specks": "outlines without area, dropped",
    "loose_lines": "lines that enclose nothing, dropped",
    "in_openings": "outlines within openings, dropped",
    "straightened": "outlines made convex within the tolerance",
    "compounds": "blocks that are not convex, of several parts",
}


def geometry_changes(scene: Scene, slivers: int, short: int) -> dict[str, Any] | None:
    """Every change of the geometry as plain values; None where nothing was changed.

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
    """What was changed, and how much, one row a change."""
    for drawing in changes["drawings"]:
        yield f"blocks from {drawing['file']}", str(drawing["blocks"])
        for key, what in WHAT_WAS_LEFT.items():
            if drawing[key]:
                yield f"  {what}", str(drawing[key])
        if drawing["ignored"]:
            yield "  not read", ", ".join(f"{count} {kind}" for kind, count in drawing["ignored"].items())
    repairs = changes["repairs"]
    if repairs is not None:
        yield "open joints closed, overlapping faces parted", f"{repairs['gaps_closed']}, {repairs['overlaps_closed']}"
        yield "overlapping corners cut off", str(repairs["overlaps_cut"])
        if repairs["moved_block"]:
            yield f'largest move of a corner, of "{repairs["moved_block"]}"', f"{1e3 * repairs['largest_move']:.3g} mm"
    if changes["joints_dropped"]:
        yield "joints dropped, too short to count", str(changes["joints_dropped"])
    if changes["short_joints"]:
        yield "short joints with an inset of their own", str(changes["short_joints"])
    unclosed = repairs["unclosed"] if repairs is not None else ()
    for one in unclosed[:LISTED]:
        where = ", ".join(f"{value:.4g}" for value in one["vertex"])
        first, second = one["blocks"]
        yield f'not closed: "{first}" and "{second}", at ({where}) m', f"{1e3 * one['gap']:.3g} mm"
    if len(unclosed) > LISTED:
        yield "more places that are not closed", str(len(unclosed) - LISTED)
