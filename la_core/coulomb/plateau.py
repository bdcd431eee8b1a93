"""Plateau of a curve: its flatness, its value and its uncertainty.

Differences are relative to the value or to a share of the weight, whichever is larger, so that a curve at zero can be flat, too.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from la_core.exchange import UNCERTAIN

FLAT = 5e-4  # of the value: change between the means over two successive stretches of a flat curve
LEAST = 1e-3  # of the weight, or a multiplier: differences of smaller values are relative to this
ALIKE = 1e-2  # of the value: plateaus closer than this are one
# Largest further change of a curve that is not flat, over its last change. On a wall of 1,024 blocks every doubling of the travel
# changed the value by about three quarters of the change before; such changes add up to three times the last one.
UNFINISHED = 3.0
EARLY = UNCERTAIN  # of the value: largest doubt about a plateau that is reported although the curve leaves it
LEFT = 3.0  # times the doubt about a plateau: a curve with a larger doubt later on, or whose end is farther away, has left it
TAIL = 0.05  # share of a stretch with the largest values, and with the smallest, that are left out as stray: a jump is in progress


@dataclass(frozen=True)
class Plateau:
    """Plateau of one path; all numbers are scaled.

    Attributes
    ----------
    value : float
        Value at the certified end of the path.
    mean : float
        Mean over the second half of the travel.
    change : float
        Difference between the means over the second half and over the quarter before it.
    scatter : float
        Largest distance of the values over the last quarter of the travel from the value, without stray values.
    travel : float
        Progress at the end, over the travel.
    """

    value: float
    mean: float
    change: float
    scatter: float
    travel: float

    @property
    def is_flat(self) -> bool:
        """Whether the curve is flat over the second half of its way."""
        return self.change <= FLAT * reference_size(self.mean)

    @property
    def unfinished(self) -> float:
        """Amount by which the value may still change as the curve goes on."""
        return self.change if self.is_flat else UNFINISHED * self.change

    @property
    def doubt(self) -> float:
        """Uncertainty of the value that the curve itself shows."""
        return float(np.fmax(self.unfinished, self.scatter))

    @property
    def is_known(self) -> bool:
        """Whether the value is known well enough to be reported although the curve leaves it."""
        return self.doubt <= EARLY * reference_size(self.value)

    def is_left_at(self, later: "Plateau") -> bool:
        """Whether a plateau further on is so much more doubtful that the curve has left this one."""
        return not later.doubt <= max(LEFT * self.doubt, EARLY * reference_size(self.value))


def reference_size(value: float) -> float:
    """Size that differences of a scaled value are relative to."""
    return max(abs(value), LEAST)


def plateau_of(progress: np.ndarray, values: np.ndarray, end: float, value: float) -> Plateau:
    """Plateau of a curve with `values` (P,) over `progress` (P,), followed to the progress `end`; `value` is that at its certified end."""
    last, before = _mean(progress, values, end / 2.0, end), _mean(progress, values, end / 4.0, end / 2.0)
    length = _lengths(progress, 0.75 * end, end)
    order = np.argsort(values)
    weight = length[order] / max(length.sum(), 1e-300)
    share = np.cumsum(weight)
    kept = values[order][(share >= TAIL) & (share - weight <= 1.0 - TAIL)]
    scatter = float(np.abs(kept - value).max()) if len(kept) else float("nan")
    return Plateau(value, last, abs(last - before), scatter, end)


def peak_before(values: np.ndarray, level: float, near: float) -> float:
    """Greatest value of a curve (P,) on the way to a level: before it comes within `near` of the level for the last time.

    Later values do not count. If the curve never comes so near, all of its values count.
    """
    at_level = np.flatnonzero(np.abs(values - level) <= near)
    return float(values[: at_level[-1]].max(initial=-np.inf) if len(at_level) else values.max())


def _lengths(progress: np.ndarray, low: float, high: float) -> np.ndarray:
    """Length of every step within a stretch; a value holds over the step that it ends."""
    inside = np.clip(progress, low, high)
    return np.diff(inside, prepend=inside[0])


def _mean(progress: np.ndarray, values: np.ndarray, low: float, high: float) -> float:
    length = _lengths(progress, low, high)
    return float(np.sum(length * values) / np.sum(length)) if length.any() else float("nan")


def groups(values: Sequence[float]) -> list[list[int]]:
    """Indices of the values in groups; within a group, neighbours in size differ by at most ALIKE."""
    order = np.argsort(values)
    found = [[int(order[0])]]
    for left, right in itertools.pairwise(order):
        if values[right] - values[left] > ALIKE * reference_size(values[right]):
            found.append([])
        found[-1].append(int(right))
    return found
