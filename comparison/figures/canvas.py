"""Blocks, interfaces, points and arrows on a canvas, and the colours of all figures.

A plane scene is seen along y. Any other scene is drawn in a parallel projection, with its blocks from back to front.
"""

from collections.abc import Sequence
from typing import Any

import matplotlib.patheffects
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure, SubFigure

from comparison.figures.drawing_order import OuterFaces, are_behind, back_to_front, unit_normals
from comparison.figures.line_labels import axis_numbers, beside_axis, extent, fitted_name
from la_core.exchange import FIXED, FREE, SUPPORT
from la_core.geometry import Blocks
from la_core.model import Assembly

LIMIT_ANALYSIS = "#1f4e8c"  # dark blue and light orange: their luminance differs, so that they differ in greyscale too
YADE = "#f39c34"
INK = "#222222"
FAINT = "#9a9a9a"
LOAD_COLOUR = "#1b7837"  # of dead loads and ties
LOAD_LENGTH = 0.08  # of the structure's size: the arrow of the largest load
MOST_LOADS = 40  # arrows in one figure
LARGE_LOAD = 0.5  # of the largest load: a few loads above this share are all drawn
ASIDE = 3  # drawn as a fourth role: a free block that was left out of the modelled region and is held at rest
ROLE_FACE = {FREE: "#eeebe4", FIXED: "#8d8d8d", SUPPORT: "#c4c4c4", ASIDE: "#d9d9d9"}
ROLE_HATCH = {FREE: "", FIXED: "////", SUPPORT: "....", ASIDE: ""}
LINE = 0.5  # pt, block outlines
FEW = 25  # blocks: at most this number are named, and show the contact points behind them
MARGIN = 0.12  # of the structure's size: room for arrows around it
ARROW = 0.1  # of the structure's size: arrow of a motion
ELEVATION, AZIMUTH = np.radians([24.0, -62.0])  # of the viewer: from the front, the right and above
LIGHT = np.array([-0.35, -0.55, 0.75])
HIDING = 0.02  # of the structure's size: a contact point under less stone than this is seen
HALO = [matplotlib.patheffects.withStroke(linewidth=2.0, foreground="white")]


def method_colour(label: str) -> str:
    """Return the colour of a method: YADE's where the label starts with "yade" in any case, else limit analysis'."""
    return YADE if label.casefold().startswith("yade") else LIMIT_ANALYSIS


def drawn_roles(assembly: Assembly) -> list[int]:
    """Return the role of each block in figures: that of the scene, or ASIDE."""
    return [int(role) for role in np.where(assembly.aside, ASIDE, assembly.blocks.role)]


def tint(colour: str, white: float = 0.4) -> str:
    """Return a lighter shade of a colour with a share of white; the default is that of areas under black edges and marks."""
    red, green, blue = ((1.0 - white) * channel + white for channel in to_rgb(colour))
    return to_hex((red, green, blue))


def structure_size(blocks: Blocks) -> float:
    """Return the largest extent of the structure along x, y or z, m."""
    return float((blocks.high.max(axis=0) - blocks.low.min(axis=0)).max())


def load_arrows(blocks: Blocks, point: np.ndarray, force: np.ndarray, most: int = MOST_LOADS) -> tuple[np.ndarray, np.ndarray]:
    """Return the indices (M,) of the forces that are drawn, and the starts (M, 3) of their arrows, m.

    Of more than `most` forces (N, 3), evenly spaced ones are drawn, and the largest ones if these are few. Arrows end at `point` (N, 3),
    m; a greater force has a longer one.
    """
    size = np.linalg.norm(force, axis=1)
    large = np.flatnonzero(size > LARGE_LOAD * size.max(initial=0.0))
    large = large if len(large) <= most // 2 else large[:0]
    others = np.setdiff1d(np.arange(len(size)), large)
    shown = np.union1d(large, others[np.linspace(0, len(others) - 1, min(most - len(large), len(others))).astype(int)])
    length = LOAD_LENGTH * structure_size(blocks) * (0.4 + 0.6 * size[shown] / size.max(initial=0.0))
    return shown, point[shown] - (length / size[shown])[:, None] * force[shown]


def push_arrow(assembly: Assembly) -> tuple[np.ndarray, np.ndarray]:
    """Return start and end (3,) of the arrow of a live load, m: ahead of the free blocks, on the line through their centroid.

    Inside the structure the arrow would lie on joints, or cover the name of a block.
    """
    blocks = assembly.blocks
    load = assembly.live_load[:, :3].sum(axis=0)
    direction = load / np.linalg.norm(load)
    middle = np.average(blocks.centroid[blocks.free], axis=0, weights=blocks.mass[blocks.free])
    start = middle + ((blocks.vertices[blocks.free[blocks.vertex_block]] - middle) @ direction).max() * direction
    return start, start + 2.0 * ARROW * structure_size(blocks) * direction


def loops(points: np.ndarray, start: np.ndarray) -> list[np.ndarray]:
    """Split concatenated points into polygons, each (n, 3); `start` has the first row of each polygon, and the end."""
    return np.split(points, start[1:-1])


class Canvas:
    """Axes that show one structure at equal scale, x to the right and z upwards; positions are (3,) or (N, 3) in m."""

    def __init__(self, axes: Any, assembly: Assembly, width: float, ties: np.ndarray | None = None) -> None:
        """Prepare the axes for a structure and the ends (T, 2, 3) of its ties, m; `width` is the width of the axes on paper, in points."""
        self.axes = axes
        self.blocks = assembly.blocks
        self.plane = assembly.effects.plane
        self.few = len(assembly.blocks) <= FEW
        self.right, self.up, self.toward = view_axes(self.plane)
        self.order = np.arange(len(self.blocks)) if self.plane else back_to_front(assembly, self.toward)
        self.outer = OuterFaces(self.blocks, self.toward)
        low, high = window(assembly, ties)
        self.scale = width / (high - low)[0]  # pt per m
        self.dot = float(np.clip(np.median(np.cbrt(self.blocks.volume)) * self.scale / 10.0, 0.8, 3.5))  # pt, contact points
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        axes.set_aspect("equal")
        if self.plane:
            axes.set(xlabel="x (m)", ylabel="z (m)")
            axes.tick_params(labelsize=8)
            axes.locator_params(nbins=7)
            axes.spines[["top", "right"]].set_visible(False)
        else:
            axes.set_axis_off()
            self._scales()

    def flat(self, position: np.ndarray) -> np.ndarray:
        """Project positions (..., 3) onto the axes (..., 2), m."""
        return position @ np.stack([self.right, self.up], axis=1)

    def solids(self, vertices: np.ndarray, face: Sequence[str], hatch: Sequence[str]) -> None:
        """Draw the faces towards the viewer of blocks with vertices (V, 3), by each block's face colour and hatch."""
        blocks = self.blocks
        corners = vertices[blocks.face_vertex]
        normal = unit_normals(corners, blocks.face_start)
        rank = np.argsort(self.order)
        facing = np.flatnonzero(normal @ self.toward > 1e-6)
        facing = facing[np.lexsort((self.outer.order[facing], rank[blocks.face_block[facing]]))]
        seen, polygons = zip(*self.outer.polygons(facing, self.flat(corners)), strict=True)
        shade = np.ones(len(normal)) if self.plane else 0.78 + 0.22 * np.clip(normal @ LIGHT / np.linalg.norm(LIGHT), 0.0, 1.0)
        colours = [shade[f] * np.array(to_rgb(face[blocks.face_block[f]])) for f in seen]
        # A collection has only one hatch. A collection for each run of faces with the same hatch keeps their order.
        hatches = [hatch[blocks.face_block[f]] for f in seen]
        ends = [k for k in range(1, len(seen)) if hatches[k] != hatches[k - 1]]
        for first, last in zip([0, *ends], [*ends, len(seen)], strict=True):
            run = PolyCollection(polygons[first:last], facecolors=colours[first:last], edgecolors=INK, linewidths=LINE)
            run.set(hatch=hatches[first] or None, hatch_linewidth=0.4, joinstyle="round")
            self.axes.add_collection(run)

    def outlines(self, polygons: Sequence[np.ndarray], colour: str, width: float) -> None:
        """Draw closed polygons as lines.

        Parameters
        ----------
        polygons : sequence of ndarray
            Corners (n, 3) of each polygon, m. In a plane scene an interface is seen as a straight line.
        colour : str
            Colour of matplotlib.
        width : float
            Width of the lines, pt.
        """
        self._outlines_in_view([self.flat(polygon) for polygon in polygons], colour, width, "-")

    def _outlines_in_view(self, polygons: Sequence[np.ndarray], colour: str, width: float, style: str, below: bool = False) -> None:
        """Draw closed polygons of the view, each (n, 2) in m; style: of matplotlib's lines; below: whether they lie below the blocks."""
        closed = [np.concatenate([polygon, polygon[:1]]) for polygon in polygons]
        lines = LineCollection(closed, colors=colour, linewidths=width, linestyles=style, capstyle="round", zorder=0.5 if below else 2)
        self.axes.add_collection(lines)

    def block_outlines(self, moved: np.ndarray, colour: str) -> None:
        """Outline the blocks of the mask `moved` (B,) at rest.

        In space, the outlines of large structures are behind the blocks.
        """
        style = "-" if self.plane else "--"
        self._outlines_in_view(self._outer_at_rest(self._facing(moved)), colour, 0.6, style, below=not (self.plane or self.few))

    def hidden_edges(self, some: np.ndarray) -> None:
        """Draw dashed edges of the blocks of the mask `some` (B,) that other blocks hide altogether, over these other blocks."""
        facing = self._facing(some)
        owner = self.blocks.face_block[facing]
        every = loops(self.blocks.vertices[self.blocks.face_vertex], self.blocks.face_start)
        middles = np.array([every[face].mean(axis=0) for face in facing]).reshape(-1, 3)
        is_in_sight = np.isin(owner, owner[~self._is_hidden(middles)])
        self._outlines_in_view(self._outer_at_rest(facing[~is_in_sight]), INK, 0.8, "--")

    def _facing(self, some: np.ndarray) -> np.ndarray:
        """Return the faces towards the viewer of the blocks of a mask (B,)."""
        return np.flatnonzero((self.blocks.face_normal @ self.toward > 1e-6) & some[self.blocks.face_block])

    def _outer_at_rest(self, faces: np.ndarray) -> list[np.ndarray]:
        """Return the visible polygons (n, 2) of faces at rest in the view, m."""
        return [polygon for _, polygon in self.outer.polygons(faces, self.flat(self.blocks.vertices[self.blocks.face_vertex]))]

    def seen(self, position: np.ndarray) -> np.ndarray:
        """Return the mask (N,) of the visible positions: all in a plane or small scene, else those that no block hides."""
        return np.ones(len(position), dtype=bool) if self.plane or self.few else ~self._is_hidden(position)

    def _is_hidden(self, position: np.ndarray) -> np.ndarray:
        """Return the mask (N,) of the positions that blocks hide."""
        view = np.stack([self.right, self.up, self.toward])
        return are_behind(self.blocks.parts, view, position, HIDING * structure_size(self.blocks))

    def marks(self, position: np.ndarray, **style: Any) -> None:
        """Draw markers at positions (N, 3); `style` goes to `Axes.plot`."""
        self.axes.plot(*self.flat(position).T, linestyle="none", zorder=5, **style)

    def arrow(self, start: np.ndarray, end: np.ndarray, colour: str = INK, width: float = 2.0) -> None:
        """Draw a filled arrow between two positions (3,); it may leave the axes. width: of its line, pt."""
        style = arrow_style(colour) | {"linewidth": width, "mutation_scale": 7.0 * width}
        self.axes.annotate("", self.flat(end), self.flat(start), zorder=6, annotation_clip=False, arrowprops=style)

    def loads(self, point: np.ndarray, force: np.ndarray) -> int:
        """Draw forces (N, 3) as arrows that end at their points (N, 3), m; return how many are drawn, see `load_arrows`."""
        shown, start = load_arrows(self.blocks, point, force)
        for first, last in zip(start, point[shown], strict=True):
            self.arrow(first, last, LOAD_COLOUR, 1.2)
        return len(shown)

    def rods(self, ends: np.ndarray) -> None:
        """Draw ties between their ends (T, 2, 3), m."""
        self.outlines(list(ends), LOAD_COLOUR, 1.6)
        self.marks(ends.reshape(-1, 3), marker="s", markersize=4.0, markerfacecolor=LOAD_COLOUR, markeredgecolor=LOAD_COLOUR)

    def gravity(self, direction: np.ndarray) -> None:
        """Draw a grey arrow along a unit vector (3,), in the upper right corner."""
        place = {"xycoords": "axes fraction", "textcoords": "offset points"}
        self.axes.annotate("", (0.975, 0.9), -32.0 * self.flat(direction), **place, arrowprops=arrow_style(FAINT))

    def text(self, position: np.ndarray, words: str, points: float) -> None:
        """Write plain text, without markup, centred at a position (3,), with a white halo; `points` is the font size."""
        style = {"ha": "center", "va": "center", "fontsize": points, "color": INK, "zorder": 5.5}  # below arrows
        self.axes.text(*self.flat(position), words, path_effects=HALO, parse_math=False, **style)

    def names(self) -> None:
        """Write each block's name at its centroid, as large as the block allows there; in space, not over the name of a block before it."""
        blocks, centre = self.blocks, self.flat(self.blocks.centroid)
        room, _, height = ((blocks.high - blocks.low) * self.scale).T
        if self.plane:
            room = self.scale * self.outer.room_beside(centre, self.flat(blocks.vertices[blocks.face_vertex]))
        written: list[np.ndarray] = []  # lower left and upper right corners (2, 2) of names, m
        for block in self.order[::-1]:
            words, size = fitted_name(blocks.names[block], room[block], height[block])
            half = extent(words, size) / 2.0 / self.scale
            corners = centre[block] + np.stack([-half, half])
            if self.plane or not any(np.all((corners[0] < other[1]) & (other[0] < corners[1])) for other in written):
                written.append(corners)
                self.text(blocks.centroid[block], words, size)

    def _scales(self) -> None:
        """Draw axes in space, m: x on the lower front edge, y on the lower right edge, z on the front left edge."""
        low, high = self.blocks.low.min(axis=0), self.blocks.high.max(axis=0)
        gap = 0.03 * structure_size(self.blocks)
        edges = (
            (0, np.array([low[0], low[1] - gap, low[2]]), np.array([0.0, -gap, -gap])),
            (1, np.array([high[0] + gap, low[1], low[2]]), np.array([gap, 0.0, -gap])),
            (2, np.array([low[0] - gap, low[1], low[2]]), np.array([-1.2 * gap, 0.0, 0.0])),
        )
        for axis, corner, outward in edges:
            along, length = np.eye(3)[axis], high[axis] - low[axis]
            count = max(1, round(6.0 * length / structure_size(self.blocks)))
            ticks, words = axis_numbers(low[axis], high[axis], count, self.scale * np.abs(self.flat(along)))
            starts = [corner + (tick - low[axis]) * along for tick in ticks]
            self.outlines([np.array([corner, corner + length * along]), *(np.array([s, s + 0.4 * outward]) for s in starts)], INK, 0.8)
            name, far = f"{'xyz'[axis]} (m)", (2.6 if axis < 2 else 3.4) * outward
            off = beside_axis(words, name, -self.scale * (outward @ self.right)) / self.scale if axis == 2 else np.zeros(2)
            for word, start in zip(words, starts, strict=True):
                self.text(start + 1.2 * outward - off[0] * self.right, word, 7.0)
            self.text(corner + 0.5 * length * along + far - off[1] * self.right, name, 8.0)


def arrow_style(colour: str) -> dict[str, Any]:
    """Return the properties of an arrow of this colour."""
    return {"arrowstyle": "-|>", "color": colour, "linewidth": 2.0, "shrinkA": 0, "shrinkB": 0, "mutation_scale": 14}


def canvases(figure: Figure | SubFigure, assembly: Assembly, count: int, ties: np.ndarray | None = None) -> list[Canvas]:
    """Return `count` canvases for the structure and the ends (T, 2, 3) of its ties, m, side by side, at equal scale."""
    grid = figure.subplots(1, count, squeeze=False, sharey=True)[0]
    width = 0.88 * figure.figure.get_figwidth() * 72.0 / count
    return [Canvas(axes, assembly, width, ties) for axes in grid]


def window(assembly: Assembly, ties: np.ndarray | None = None) -> tuple[np.ndarray, np.ndarray]:
    """Return the lower left and the upper right corner (2,) of a canvas, m, in the directions of the view.

    ties: ends (T, 2, 3) of ties, m; the canvas has room for ends that are at most one size of the structure away.
    """
    low, high = assembly.blocks.low.min(axis=0), assembly.blocks.high.max(axis=0)
    corners = np.stack(np.meshgrid(*np.stack([low, high], axis=1)), axis=-1).reshape(-1, 3)
    right, up, _ = view_axes(assembly.effects.plane)
    view, size = np.stack([right, up], axis=1), structure_size(assembly.blocks)
    low, high = (corners @ view).min(axis=0) - MARGIN * size, (corners @ view).max(axis=0) + MARGIN * size
    ends = (corners if ties is None else ties.reshape(-1, 3)) @ view
    return np.clip(ends.min(axis=0) - MARGIN * size, low - size, low), np.clip(ends.max(axis=0) + MARGIN * size, high, high + size)


def view_axes(plane: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return unit vectors (3,) to the right, upwards and towards the viewer, for a plane scene or one in space."""
    if plane:
        return np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]), np.array([0.0, -1.0, 0.0])
    right = np.array([-np.sin(AZIMUTH), np.cos(AZIMUTH), 0.0])
    toward = np.array([np.cos(ELEVATION) * np.cos(AZIMUTH), np.cos(ELEVATION) * np.sin(AZIMUTH), np.sin(ELEVATION)])
    return right, np.cross(toward, right), toward
