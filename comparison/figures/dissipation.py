"""Figure of a mechanism's dissipation: interfaces by the power of their friction, contact points by state."""

from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from comparison.figures.canvas import FAINT, INK, ROLE_FACE, ROLE_HATCH, Canvas, canvases, drawn_roles, window
from comparison.figures.motion import drawn_motion
from comparison.figures.save import own_style
from comparison.figures.structure import legend_below, wrapped
from comparison.numbers import force_unit
from la_core.geometry import next_corners, owners
from la_core.measures import ContactState, MechanismMeasures, mechanism
from la_core.model import Assembly

SMALLEST = 0.01  # of the most dissipating interface: interfaces below are not drawn
WIDTH = (1.6, 5.5)  # pt, of an interface that dissipates almost nothing, and of the most dissipating one
# From light to dark, so that it reads in greyscale too; it starts at orange, because paler lines would vanish on the stone.
POWER = LinearSegmentedColormap.from_list("power", ["#f7b267", "#e4572e", "#a4133c", "#3d0814"])
MOVES = "#d8e2ef"  # face of the blocks that move
STYLES: dict[ContactState, tuple[str, float, dict[str, Any]]] = {  # name, size over the canvas' dot, marker; the last on top
    # The circle is wider than the cross's diagonal, so that both are seen where an opening and a sliding point have the same position.
    ContactState.IDLE: ("closed without force", 0.8, {"marker": "s", "markerfacecolor": "white", "markeredgecolor": FAINT}),
    ContactState.STICKING: ("sticks", 0.7, {"marker": "s", "markerfacecolor": INK, "markeredgecolor": INK}),
    ContactState.OPENING: ("opens", 2.8, {"marker": "o", "markerfacecolor": "white", "markeredgecolor": INK}),
    ContactState.SLIDING: ("slides", 1.8, {"marker": "X", "markerfacecolor": INK, "markeredgecolor": "white"}),
}


@own_style()
def dissipation_figure(
    assembly: Assembly, twists: np.ndarray, measures: MechanismMeasures, title: str = "", push: str = "live load"
) -> Figure:
    """Draw the structure displaced by its mechanism: interfaces by dissipated power, contact points by state.

    Parameters
    ----------
    assembly : Assembly
        The structure.
    twists : ndarray
        Mechanism (B, 6) for the unit motion of the drive. Where it is NaN, the structure is drawn at rest and the title says that no
        mechanism is known.
    measures : MechanismMeasures
        Measures of the same mechanism.
    title : str
        Shown above the figure.
    push : str
        Name of the live load, if one drives the structure.
    """
    known = bool(np.isfinite(twists).all())
    motion = twists if known else np.zeros_like(twists)
    displacement = motion * drawn_motion(assembly, {title: motion})
    figure = _figure(assembly, has_scale=measures.dissipated_power > 0.0)
    (canvas,) = canvases(figure, assembly, 1)
    _headings(canvas, title, _summary(assembly, measures, push) if known else "no mechanism is known")
    _draw_blocks(canvas, assembly, displacement)
    _draw_interfaces(canvas, assembly, displacement, measures.dissipation_per_interface)
    _draw_points(canvas, assembly, displacement, measures.states)
    _power_scale(figure, canvas, assembly, measures, push)
    legend_below(figure, _handles(measures))
    return figure


def _headings(canvas: Canvas, title: str, summary: str) -> None:
    """Write the title above the axes, and the summary between them in smaller letters."""
    above = {"xycoords": "axes fraction", "textcoords": "offset points", "ha": "center", "va": "bottom"}
    canvas.axes.annotate(summary, (0.5, 1.0), (0.0, 6.0), fontsize=8.5, linespacing=1.3, parse_math=False, **above)
    canvas.axes.set_title(wrapped(title), fontsize=11, pad=13.0 + 12.0 * len(summary.splitlines()), parse_math=False)


def _summary(assembly: Assembly, measures: MechanismMeasures, push: str) -> str:
    """Return the power, its share of the settling weight's work, participation index and moving mass as text."""
    moving = f"{100.0 * measures.moving_mass_share:.3g} % of the mass moves"
    if not measures.dissipated_power > 0.0:
        return f"friction dissipates nothing  ·  {moving}"
    divisor, unit = _unit(assembly)
    power = f"friction dissipates {measures.dissipated_power / divisor:.4g} {unit or f'per unit power of the {push}'}"
    share = f" = {100.0 * measures.dissipated_share:.3g} % of the settling weight's work" if np.isfinite(measures.dissipated_share) else ""
    count = len(assembly.interfaces)
    equal = f"as if shared equally by {measures.participation_index * count:.3g} of the {count} interfaces"
    return f"{power}{share}  ·  {moving}\nparticipation index {measures.participation_index:.3g}: {equal}"


def _unit(assembly: Assembly) -> tuple[float, str]:
    """Return divisor and unit of a power per unit motion of the drive; under a live load it has no unit."""
    if assembly.has_live_load:
        return 1.0, ""
    return force_unit(assembly.weight, "N m" if assembly.is_rotation else "N")


def _draw_blocks(canvas: Canvas, assembly: Assembly, displacement: np.ndarray) -> None:
    """Draw the displaced blocks, and the outlines of the moving blocks at rest."""
    blocks = assembly.blocks
    vertices = blocks.vertices + mechanism.point_velocity(blocks, displacement, blocks.vertices, blocks.vertex_block)
    moves, roles = mechanism.moving(assembly, displacement), drawn_roles(assembly)
    face = [MOVES if is_moving else ROLE_FACE[role] for is_moving, role in zip(moves, roles, strict=True)]
    canvas.solids(vertices, face, [ROLE_HATCH[role] for role in roles])
    canvas.block_outlines(moves | np.any(assembly.support_twist, axis=1), FAINT)


def _draw_interfaces(canvas: Canvas, assembly: Assembly, displacement: np.ndarray, power: np.ndarray) -> None:
    """Draw the edges of the interfaces halfway between their displaced blocks; more power is darker and wider."""
    interfaces = assembly.interfaces
    owner, following = owners(interfaces.polygon_start), next_corners(interfaces.polygon_start)
    middle = _halfway(assembly, displacement, interfaces.polygon, owner)
    share = np.nan_to_num(power) / max(float(np.nan_to_num(power).max(initial=0.0)), np.finfo(float).tiny)
    seen = canvas.seen(interfaces.polygon)
    edges = np.flatnonzero((share[owner] > SMALLEST) & seen & seen[following])
    edges = edges[np.argsort(share[owner[edges]], kind="stable")]  # the strongest on top
    lines = np.stack([canvas.flat(middle[edges]), canvas.flat(middle[following[edges]])], axis=1)
    strength = share[owner[edges]]
    style = {"colors": POWER(strength), "linewidths": WIDTH[0] + (WIDTH[1] - WIDTH[0]) * strength, "capstyle": "round"}
    canvas.axes.add_collection(LineCollection(list(lines), zorder=3, **style))


def _draw_points(canvas: Canvas, assembly: Assembly, displacement: np.ndarray, states: np.ndarray) -> None:
    """Draw the contact points by state, halfway between their displaced blocks."""
    position = assembly.points.position
    middle, seen = _halfway(assembly, displacement, position, assembly.points.interface), canvas.seen(position)
    for state, (_, size, style) in STYLES.items():
        marked = seen & (states == state)
        if marked.any():
            canvas.marks(middle[marked], markersize=size * canvas.dot, markeredgewidth=canvas.dot / 5.0, **style)


def _halfway(assembly: Assembly, displacement: np.ndarray, position: np.ndarray, interface: np.ndarray) -> np.ndarray:
    """Return positions (N, 3) on interfaces (N,), displaced by the mean of the two blocks."""
    sides = (assembly.interfaces.block_a[interface], assembly.interfaces.block_b[interface])
    return position + sum(mechanism.point_velocity(assembly.blocks, displacement, position, side) for side in sides) / 2.0


def _power_scale(figure: Figure, canvas: Canvas, assembly: Assembly, measures: MechanismMeasures, push: str) -> None:
    """Add a colour bar in the unit of the power, where friction dissipates."""
    if not measures.dissipated_power > 0.0:
        return
    divisor, unit = _unit(assembly)
    scale = ScalarMappable(Normalize(0.0, float(measures.dissipation_per_interface.max()) / divisor), POWER)
    per = f"unit power of the {push}" if assembly.has_live_load else "unit motion of the support"
    bar = figure.colorbar(scale, ax=canvas.axes, shrink=0.85, pad=0.02, aspect=28)
    bar.set_label(f"power dissipated in an interface{f' ({unit})' if unit else ''},\nper {per}", fontsize=8)
    bar.ax.tick_params(labelsize=8)


def _handles(measures: MechanismMeasures) -> list[Patch | Line2D]:
    """Return legend entries: the moving blocks, their outlines at rest, and the states with their numbers of points."""
    handles: list[Patch | Line2D] = []
    if np.isfinite(measures.moving_mass_share):
        handles = [Patch(facecolor=MOVES, edgecolor=INK, linewidth=0.5, label="moves"), Line2D([], [], color=FAINT, label="before")]
    for state, (name, size, style) in reversed(STYLES.items()):
        count = int(np.sum(measures.states == state))
        if count:
            key = {"linestyle": "none", "markersize": 3.5 + 1.7 * size, "markeredgewidth": 0.8, **style}
            handles.append(Line2D([], [], label=f"{name} ({count})", **key))
    return handles


def _figure(assembly: Assembly, has_scale: bool) -> Figure:
    """Return a figure; its height fits the structure at the width beside the colour bar."""
    low, high = window(assembly)
    width, height = high - low
    across = 7.0 if has_scale else 7.9  # in
    figure = Figure(figsize=(8.5, float(np.clip(across * height / width, 1.5, 8.0)) + 1.7), layout="compressed")
    FigureCanvasAgg(figure)
    return figure
