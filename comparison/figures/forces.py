"""Figure of the forces between the blocks: the resultant of every joint at its centre of pressure, and the line of thrust."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from comparison.figures.canvas import INK, ROLE_FACE, ROLE_HATCH, Canvas, canvases, drawn_roles, structure_size
from comparison.figures.save import own_style
from comparison.figures.structure import blank_figure, legend_below
from comparison.numbers import force_unit, plain_number, round_below
from la_core.measures import joint_forces, thrust_line
from la_core.model import Assembly

LONGEST = 0.2  # of the structure's size: the line of the largest resultant
SMALLEST = 0.01  # of the largest resultant: smaller ones are left out
IN_SIGHT = 0.5  # of the joints that bear a force: where fewer are in sight, the forces are drawn through the blocks
FORCE, THRUST = "#a3181f", "#0b6e4f"
DASHES = (0.0, (3.0, 1.2))  # of the line of thrust, because both colours print as the same grey


@own_style()
def forces_figure(assembly: Assembly, forces: Mapping[str, np.ndarray], title: str = "") -> Figure:
    """Draw the resultant force of every joint, side by side for each method, with a scale.

    A line along the resultant crosses its joint at the centre of pressure; its length shows the size of the force. Where most
    blocks have two joints only, as in an arch, the line of thrust joins the centres of pressure.

    Parameters
    ----------
    assembly : Assembly
        The structure.
    forces : mapping of str to ndarray
        Contact forces (C, 3) on block b, N, by the method's label; NaN where they are unknown.
    title : str
        Shown above the figure.
    """
    figure = blank_figure(assembly, len(forces), title)
    known = {label: joint_forces(assembly, values) for label, values in forces.items() if np.isfinite(values).all()}
    sizes = {label: np.linalg.norm(joints.force, axis=1) for label, joints in known.items()}
    largest = max((float(size.max(initial=0.0)) for size in sizes.values()), default=0.0)
    chain = thrust_line(assembly)
    for canvas, label in zip(canvases(figure, assembly, len(forces)), forces, strict=True):
        roles = drawn_roles(assembly)
        canvas.solids(assembly.blocks.vertices, [ROLE_FACE[role] for role in roles], [ROLE_HATCH[role] for role in roles])
        canvas.axes.set_title(label if label in known else f"{label}\nno forces are known", parse_math=False, fontsize=10)
        if label not in known or not largest > 0.0:
            continue
        joints = known[label]
        shown = np.isfinite(joints.centre).all(axis=1) & (sizes[label] > SMALLEST * largest)
        seen = np.zeros(len(shown), dtype=bool)
        seen[shown] = canvas.seen(joints.centre[shown])
        if np.count_nonzero(seen) < IN_SIGHT * np.count_nonzero(shown):  # a pavement hides all its joints, a wall most of them
            seen = shown
        half = 0.5 * LONGEST * structure_size(assembly.blocks) / largest * joints.force
        _lines(canvas, joints.centre[seen] - half[seen], joints.centre[seen] + half[seen], FORCE, 1.6)
        both = chain[shown[chain].all(axis=1)] if len(chain) else chain
        _lines(canvas, joints.centre[both[:, 0]], joints.centre[both[:, 1]], THRUST, 1.8, DASHES)
        canvas.marks(joints.centre[seen], marker="o", markersize=0.7 * canvas.dot, markerfacecolor=INK, markeredgecolor=INK)
    _draw_scale(figure, assembly, largest)
    handles: list[Patch | Line2D] = [
        Line2D([], [], color=FORCE, linewidth=1.6, label="resultant of a joint"),
        Line2D([], [], color=INK, marker="o", markersize=4, linestyle="none", label="centre of pressure"),
    ]
    if len(chain):
        handles.append(Line2D([], [], color=THRUST, linewidth=1.8, linestyle=DASHES, label="line of thrust"))
    legend_below(figure, handles)
    return figure


def _lines(canvas: Canvas, start: np.ndarray, end: np.ndarray, colour: str, width: float, style: Any = "solid") -> None:
    """Draw lines between positions (N, 3)."""
    pairs = np.stack([canvas.flat(start), canvas.flat(end)], axis=1)
    cap = "round" if style == "solid" else "butt"
    canvas.axes.add_collection(LineCollection(list(pairs), colors=colour, linewidths=width, linestyles=[style], capstyle=cap, zorder=4))


def _draw_scale(figure: Figure, assembly: Assembly, largest: float) -> None:
    """Draw a line of a round force in the upper left corner of the first canvas, with its size."""
    if not largest > 0.0:
        return
    axes, size = figure.axes[0], structure_size(assembly.blocks)
    divisor, unit = force_unit(assembly.weight, "N")
    force = round_below(largest)
    length = LONGEST * size * force / largest
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    x, z = left + 0.03 * (right - left), top - 0.05 * (top - bottom)
    axes.plot([x, x + length], [z, z], color=FORCE, linewidth=2.4, solid_capstyle="butt", zorder=6)
    words = f"{plain_number(force / divisor, 1)} {unit}"
    place: dict[str, Any] = {"xycoords": "data", "textcoords": "offset points", "fontsize": 8, "va": "center"}
    axes.annotate(words, (x + length, z), (4.0, 0.0), color=INK, **place)
