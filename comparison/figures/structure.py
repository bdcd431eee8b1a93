"""Figures of the structure: the assembly with its drive, and the mechanisms of both methods.

Every function returns a new `matplotlib.figure.Figure`, without pyplot's global state.
"""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from comparison.figures.canvas import (
    ARROW,
    ASIDE,
    FAINT,
    FEW,
    INK,
    LOAD_COLOUR,
    ROLE_FACE,
    ROLE_HATCH,
    Canvas,
    canvases,
    drawn_roles,
    loops,
    method_colour,
    push_arrow,
    structure_size,
    tint,
    window,
)
from comparison.figures.motion import DRAWN, drawn_motion
from comparison.figures.save import own_style
from comparison.numbers import format_number, plain_number
from la_core.exchange import FIXED, FREE, SUPPORT
from la_core.measures import ContactState, joint_centres, mechanism
from la_core.model import Assembly
from la_core.scene import Scene

SHORT = 0.2  # of the longest arrow: shorter arrows of a turning support are left out
TITLE_WIDTH = 90  # characters
TITLE_LINE = 0.19  # inches: each line of a title after the first
ROLE_NAME = {FREE: "free block", FIXED: "fixed (ground)", SUPPORT: "support", ASIDE: "set aside, at rest"}
LEAST_DOT = 1.2  # pt: contact points of large structures would be smaller, and are left out
POINT = {"marker": "o", "markerfacecolor": "white", "markeredgecolor": INK}
UNCLOSED = {"marker": "x", "markeredgecolor": "tab:red"}  # where two faces stayed apart
UNCLOSED_SIZE = 9.0  # points
SLIDES = {"marker": "X", "markerfacecolor": INK, "markeredgecolor": "white"}
MARKED = {ContactState.OPENING: ("opens", POINT), ContactState.SLIDING: ("slides", SLIDES)}  # joints that are marked in a mechanism


@own_style()
def assembly_figure(scene: Scene, assembly: Assembly, title: str | None = None, spots: Sequence[Sequence[float]] = ()) -> Figure:
    """Draw the structure: blocks by role, interfaces, contact points, gravity, and the support's motion or live load.

    By default the title is that of the scene. spots: places of faults, (x, y, z) in m, with the mark of gaps that a tolerance
    could not close.
    """
    ties = None if scene.ties is None else scene.ties.ends
    figure = blank_figure(assembly, 1, scene.title if title is None else title, ties)
    (canvas,) = canvases(figure, assembly, 1, ties)
    blocks, interfaces = assembly.blocks, assembly.interfaces
    canvas.solids(blocks.vertices, *looks(assembly))
    if not canvas.plane:
        canvas.hidden_edges(blocks.role == SUPPORT)
    if canvas.plane or canvas.few:
        canvas.outlines(loops(interfaces.polygon, interfaces.polygon_start), INK, float(np.clip(canvas.dot / 2.5, 0.7, 1.3)))
    position = assembly.points.position
    has_points = len(position) > 0 and (canvas.few or canvas.dot > LEAST_DOT)
    if has_points:
        canvas.marks(position[canvas.seen(position)], markersize=canvas.dot, markeredgewidth=canvas.dot / 5.0, **POINT)
    unclosed = [*(one.vertex for one in scene.repairs.unclosed), *spots] if scene.repairs is not None else [*spots]
    if unclosed:
        canvas.marks(np.array(unclosed), markersize=UNCLOSED_SIZE, **UNCLOSED)
    if canvas.few:
        canvas.names()
    drawn, total = canvas.loads(scene.loads.point, scene.loads.force), len(scene.loads)
    load_name = "dead load" if drawn == total else f"dead load ({drawn} of {total} drawn)"
    load_keys = [_arrow_key(load_name, LOAD_COLOUR)] if total else []
    if ties is not None:
        canvas.rods(ties)
        load_keys.append(Line2D([], [], color=LOAD_COLOUR, linewidth=1.6, label="tie"))
    driven = _draw_drive(canvas, assembly, push_name(scene))
    canvas.gravity(assembly.down)
    present = [role for role in ROLE_NAME if role in drawn_roles(assembly)]
    handles = [_area(ROLE_NAME[role], ROLE_FACE[role], ROLE_HATCH[role]) for role in present]
    points_key = [_mark("contact point", POINT)] if has_points else []
    unclosed_key = [_mark("to correct" if spots else "not closed", UNCLOSED)] if unclosed else []
    arrows = [_arrow_key(driven, INK), _arrow_key("gravity", FAINT)]
    legend_below(figure, [*handles, *points_key, *unclosed_key, *load_keys, *arrows])
    return figure


@own_style()
def mechanism_figure(
    assembly: Assembly,
    mechanisms: Mapping[str, np.ndarray],
    title: str = "",
    falling: Sequence[str] = (),
    reasons: Mapping[str, str] | None = None,
    joints: Mapping[str, np.ndarray] | None = None,
    travel: float = 0.0,
) -> Figure:
    """Draw mechanisms side by side, for the same motion of the support; displacements are linear in that motion.

    Parameters
    ----------
    assembly : Assembly
        The structure.
    mechanisms : mapping of str to ndarray
        Twists (B, 6) for the support's unit motion, by the method's label; NaN where the method has no mechanism. A label that
        starts with "YADE" has YADE's colour.
    title : str
        Shown above the figure.
    falling : sequence of str
        Names of the blocks that cannot stand; they are marked where a method has no mechanism.
    reasons : mapping of str to str, optional
        Why a method has no mechanism, by the method's label.
    joints : mapping of str to ndarray, optional
        States (I,) of the interfaces, by the method's label; see `la_core.measures.joint_states`. Joints that open or slide are
        marked in their middle.
    travel : float
        Motion of the support, m or rad, from which the heading gives the magnification of the displacements; 0 if unknown.
    """
    known = [twists for twists in mechanisms.values() if np.isfinite(twists).all()]
    factor = drawn_motion(assembly, mechanisms)
    heading = "\n".join(line for line in (wrapped(title), _scale_words(assembly, factor, travel) if known else "") if line)
    figure = blank_figure(assembly, len(mechanisms), heading)
    handles: list[Patch | Line2D] = [_area("at rest", ROLE_FACE[FREE])]
    handles += [_area(ROLE_NAME[ASIDE], ROLE_FACE[ASIDE])] if assembly.aside.any() else []
    marked: set[ContactState] = set()
    for canvas, (label, twists) in zip(canvases(figure, assembly, len(mechanisms)), mechanisms.items(), strict=True):
        colour = tint(method_colour(label))
        if np.isfinite(twists).all():
            canvas.axes.set_title(label, parse_math=False, fontsize=10)
            _draw_mechanism(canvas, assembly, twists, factor, colour)
            marked |= _mark_joints(canvas, assembly, factor * twists, (joints or {}).get(label))
            handles.append(_area(f"moves, {label}", colour))
        else:
            reason = textwrap.fill((reasons or {}).get(label, _why_none(falling)), TITLE_WIDTH // 2)
            canvas.axes.set_title(f"{label}\n{reason}", parse_math=False, fontsize=10)
            _draw_falling(canvas, assembly, falling, colour)
            handles += [_area(f"falls, {label}", colour, "xx")] if falling else []
    if known:
        handles.append(Line2D([], [], color=FAINT, linewidth=0.8, label="before"))
    handles += [_mark(f"joint {word}", style) for state, (word, style) in MARKED.items() if state in marked]
    legend_below(figure, handles)
    return figure


def _draw_mechanism(canvas: Canvas, assembly: Assembly, twists: np.ndarray, factor: float, colour: str) -> None:
    blocks = assembly.blocks
    moves = mechanism.moving(assembly, twists)
    vertices = blocks.vertices + factor * mechanism.point_velocity(blocks, twists, blocks.vertices, blocks.vertex_block)
    canvas.solids(vertices, *looks(assembly, moves, colour))
    canvas.block_outlines(moves | np.any(assembly.support_twist, axis=1), FAINT)


def _mark_joints(canvas: Canvas, assembly: Assembly, displacement: np.ndarray, states: np.ndarray | None) -> set[ContactState]:
    """Mark each joint that opens or slides in its middle, halfway between its displaced blocks (B, 6), where it is seen.

    Returns the states of the marked joints.
    """
    if states is None:
        return set()
    blocks, interfaces, centre = assembly.blocks, assembly.interfaces, joint_centres(assembly)
    sides = (mechanism.point_velocity(blocks, displacement, centre, side) for side in (interfaces.block_a, interfaces.block_b))
    middle, seen = centre + sum(sides) / 2.0, canvas.seen(centre)
    drawn = {state: np.flatnonzero((states == state) & seen) for state in MARKED}
    for state, marked in drawn.items():
        if len(marked):
            canvas.marks(middle[marked], markersize=1.6 * canvas.dot, markeredgewidth=canvas.dot / 5.0, **MARKED[state][1])
    return {state for state, marked in drawn.items() if len(marked)}


def _draw_falling(canvas: Canvas, assembly: Assembly, falling: Sequence[str], colour: str) -> None:
    blocks = assembly.blocks
    falls = np.isin(blocks.names, list(falling))
    canvas.solids(blocks.vertices, *looks(assembly, falls, colour, "xx"))
    fallen = np.flatnonzero(falls)
    evenly = np.unique(np.linspace(0, len(fallen) - 1, FEW).astype(int)) if len(fallen) else fallen
    for k in fallen[evenly]:
        canvas.arrow(blocks.centroid[k], blocks.centroid[k] + ARROW * structure_size(blocks) * assembly.down)


def _why_none(falling: Sequence[str]) -> str:
    if not falling:
        return "no mechanism is known"
    return f"cannot stand: {len(falling)} block{'s fall' if len(falling) > 1 else ' falls'}"


def looks(assembly: Assembly, marked: np.ndarray | None = None, colour: str = "", hatch: str = "") -> tuple[list[str], list[str]]:
    """Return face colour and hatch of every block: those of its role, or the given ones.

    Parameters
    ----------
    assembly : Assembly
        The structure.
    marked : ndarray, optional
        Mask (B,) of the blocks that get `colour` and `hatch` instead of those of their role.
    colour, hatch : str
        Face colour and hatch of the marked blocks.
    """
    mask = np.zeros(len(assembly.blocks), dtype=bool) if marked is None else marked
    roles = drawn_roles(assembly)
    face = [colour if is_marked else ROLE_FACE[role] for is_marked, role in zip(mask, roles, strict=True)]
    return face, [hatch if is_marked else ROLE_HATCH[role] for is_marked, role in zip(mask, roles, strict=True)]


def push_name(scene: Scene) -> str:
    """Return the name of the load that pushes a structure without a settlement."""
    return "live load" if scene.tilt is None else "push of the tilt"


def _draw_drive(canvas: Canvas, assembly: Assembly, push: str) -> str:
    """Draw arrows of the support's motion or of the live load, which is named `push`; return their label for the legend."""
    blocks = assembly.blocks
    length = ARROW * structure_size(blocks)
    if assembly.has_live_load:
        start, end = push_arrow(assembly)
        canvas.arrow(start, 0.5 * (start + end))  # the axes have no room for all of it
        return f"{push}, proportional to weight"
    owner = blocks.vertex_block
    driven = np.flatnonzero(np.isin(owner, np.flatnonzero(blocks.role == SUPPORT)))
    velocity = mechanism.point_velocity(blocks, assembly.support_twist, blocks.vertices[driven], owner[driven])
    speed = np.linalg.norm(velocity, axis=1)
    if np.any(assembly.support_twist[:, 3:]):
        for vertex, motion in zip(blocks.vertices[driven], velocity / speed.max(), strict=True):
            if np.linalg.norm(motion) > SHORT:
                canvas.arrow(vertex, vertex + length * motion)
        return "motion of the turning support"
    moves = [k for k in np.unique(owner[driven]) if np.any(assembly.support_twist[k])]
    for k in moves[:FEW]:
        direction = _unit(assembly.support_twist[k, :3])
        ahead = (blocks.vertices[owner == k] - blocks.centroid[k]) @ direction
        start = blocks.centroid[k] + ahead.max() * direction
        share = float(np.linalg.norm(assembly.support_twist[k, :3]) / speed.max())
        canvas.arrow(start, start + length * share * direction)
    return "motion of the support"


def blank_figure(assembly: Assembly, count: int, title: str, ties: np.ndarray | None = None) -> Figure:
    """Return a figure for `count` canvases side by side; its height fits the structure, the ends (T, 2, 3) of ties, m, and the title."""
    low, high = window(assembly, ties)
    width, height = high - low
    inches = 8.5 if count == 1 else 11.0
    of_title = TITLE_LINE * wrapped(title).count("\n")
    of_axes = float(np.clip(0.88 * inches / count * height / width, 1.5, 8.0))
    figure = Figure(figsize=(inches, of_axes + 1.6 + of_title), layout="compressed")
    FigureCanvasAgg(figure)
    if title:
        figure.suptitle(wrapped(title), fontsize=11, parse_math=False)
    return figure


def legend_below(figure: Figure | SubFigure, handles: Sequence[Artist], most: int = 6) -> None:
    """Add a legend below the axes, with as many columns, at most `most`, as fit into the width of the figure."""
    for columns in range(max(min(len(handles), most), 1), 0, -1):
        legend = figure.legend(handles=handles, loc="outside lower center", ncols=columns, columnspacing=1.4, fontsize=8, frameon=False)
        if columns == 1 or legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()


def _area(label: str, face: str, hatch: str = "") -> Patch:
    return Patch(facecolor=face, edgecolor=INK, linewidth=0.5, hatch=hatch or None, label=label)


def _mark(label: str, style: Mapping[str, Any]) -> Line2D:
    return Line2D([], [], linestyle="none", markersize=6, markeredgewidth=0.8, label=label, **style)


def _arrow_key(label: str, colour: str) -> Line2D:
    return Line2D([], [], linestyle="none", marker=r"$\rightarrow$", markersize=11, color=colour, label=label)


def _scale_words(assembly: Assembly, factor: float, travel: float) -> str:
    """Return the scale of the drawn displacements as a sentence; a travel of 0, m or rad, is unknown."""
    free = "shape of the mechanism; its size is arbitrary: drawn with "
    if assembly.has_live_load or not np.any(assembly.support_twist):
        return f"{free}a largest displacement of {plain_number(DRAWN * structure_size(assembly.blocks), 3)} m"
    motion, unit = ("rotation", "mrad") if assembly.is_rotation else ("motion", "mm")
    if travel > 0.0:
        times = format_number(float(f"{factor / travel:.2g}"))
        given = "rotation" if assembly.is_rotation else "settlement"
        return f"displacements enlarged about {times} times, at a {given} of {plain_number(1e3 * travel, 3)} {unit}"
    return f"{free}a support {motion} of {plain_number(1e3 * factor, 3)} {unit}"


def wrapped(title: str) -> str:
    """Return a title in lines of at most TITLE_WIDTH characters."""
    return "\n".join(textwrap.fill(line, TITLE_WIDTH) for line in title.splitlines())


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)
