"""Curves of a drawing as chords that go through the ends of lines and the corners of stones on the curve."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import shapely

LEAST_TURN, MOST_TURN = 1e-6, np.radians(50.0)  # rad, between two chords of a curve: a circle has eight chords or more


@dataclass(frozen=True)
class Curves:
    """The curves of a drawing.

    Attributes
    ----------
    lines : sequence of (n, 2) array
        Chords of each curve, m.
    sagitta : float
        Largest distance between a curve and its chords, m.
    """

    lines: Sequence[np.ndarray] = ()
    sagitta: float = 0.0
    _tree: shapely.STRtree = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_tree", shapely.STRtree([shapely.LineString(line) for line in self.lines]))

    def along(self, line: np.ndarray, snap: float) -> np.ndarray:
        """Mask (n - 1,) of the chords of a line (n, 2) whose ends and middle lie on a curve, to within the sagitta and `snap` (m)."""
        mask = np.zeros(len(line) - 1, dtype=bool)
        if not self.lines:
            return mask
        places = np.concatenate([line[:-1], 0.5 * (line[:-1] + line[1:]), line[1:]])
        place, curve = self._tree.query(shapely.points(places), predicate="dwithin", distance=snap + self.sagitta)
        pairs, hits = np.unique(np.stack([place % len(mask), curve]), axis=1, return_counts=True)
        mask[pairs[0][hits == 3]] = True
        return mask


def with_points(line: np.ndarray, points: np.ndarray, snap: float, curves: Curves, lone: np.ndarray | None = None) -> np.ndarray:
    """A line (n, 2) with the points (m, 2) that lie on its chords inserted as corners.

    Points in the mask `lone` (m,), by default all, are inserted on curves only: near a straight line, the line that ends in such a point
    is extended instead.
    """
    lone = np.ones(len(points), dtype=bool) if lone is None else lone
    point, chord, share = _places_on(line, points, snap, curves, lone)
    _, first = np.unique(points[point], axis=0, return_index=True)
    first = first[np.lexsort((share[first], chord[first]))]
    return np.insert(line, chord[first] + 1, points[point[first]], axis=0)


def through_ends(lines: list[np.ndarray], lone: np.ndarray, snap: float, curves: Curves) -> list[np.ndarray]:
    """Lines (n, 2) with the ends of other lines on them inserted as corners. Lone ends, mask (lines, 2), are inserted on curves only."""
    ends, lone = np.concatenate([line[[0, -1]] for line in lines]), lone.ravel()
    strings, tips = np.array([shapely.LineString(line) for line in lines]), shapely.points(ends)
    tip, line = shapely.STRtree(strings).query(tips, predicate="dwithin", distance=snap + curves.sagitta)
    for end in (0, -1):
        apart = ~shapely.dwithin(tips[tip], shapely.get_point(strings[line], end), snap)
        tip, line = tip[apart], line[apart]
    through = list(lines)
    for j in np.unique(line).tolist():
        on_it = tip[line == j]
        through[j] = with_points(lines[j], ends[on_it], snap, curves, lone[on_it])
    return through


def reaching(line: np.ndarray, free: np.ndarray, reach: float) -> shapely.LineString:
    """A line (n, 2) whose free ends, mask (2,), are extended by `reach` (m)."""
    before = [line[0] + _ahead(line[1], line[0], reach)] if free[0] else []
    after = [line[-1] + _ahead(line[-2], line[-1], reach)] if free[1] else []
    return shapely.LineString(np.concatenate([np.reshape(before, (-1, 2)), line, np.reshape(after, (-1, 2))]))


def _ahead(start: np.ndarray, end: np.ndarray, reach: float) -> np.ndarray:
    length = float(np.hypot(*(end - start)))
    return (end - start) * (reach / length) if length > 0.0 else np.zeros(2)


def _places_on(
    line: np.ndarray, points: np.ndarray, snap: float, curves: Curves, lone: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points (m, 2) that a line (n, 2) has to go through: their indices, the nearest chord of each, and the place along it (0 to 1).

    The distance of a curve from its chord is about an eighth of the chord's length times the turn to the next chord, rad. A point may
    lie off the chord by twice this distance, at most by the sagitta, plus `snap` (m).
    """
    chords = shapely.linestrings(np.stack([line[:-1], line[1:]], axis=1))
    point, chord = shapely.STRtree(chords).query(shapely.points(points), predicate="dwithin", distance=snap + curves.sagitta)
    along = line[chord + 1] - line[chord]
    length = np.hypot(*along.T)
    share = np.clip(((points[point] - line[chord]) * along).sum(axis=1) / np.where(length > 0.0, length**2, 1.0), 0.0, 1.0)
    off = np.hypot(*(line[chord] + share[:, None] * along - points[point]).T)
    order = np.lexsort((chord, off, point))
    nearest = order[np.diff(point[order], prepend=-1) > 0]
    point, chord, share, off = point[nearest], chord[nearest], share[nearest], off[nearest]
    turn = np.concatenate([[0.0], _turns(line), [0.0]])
    bend = np.minimum(curves.sagitta, 0.25 * length[nearest] * np.maximum(turn[chord], turn[chord + 1]))
    bend = np.where(curves.along(line, snap)[chord], bend, 0.0)
    is_on_it = (off <= snap + bend) & ((bend > 0.0) | ~lone[point]) & (share > 0.0) & (share < 1.0)
    return point[is_on_it], chord[is_on_it], share[is_on_it]


def _turns(line: np.ndarray) -> np.ndarray:
    """Turn (n - 2,) from each chord of a line (n, 2) to the next one, rad; 0 at a corner of a stone, which turns by more than MOST_TURN."""
    along = np.diff(line, axis=0)
    angle = np.arctan2(along[:, 1], along[:, 0])
    turn = np.abs((np.diff(angle) + np.pi) % (2.0 * np.pi) - np.pi)
    return np.where((turn > LEAST_TURN) & (turn <= MOST_TURN), turn, 0.0)
