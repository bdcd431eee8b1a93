"""Tangles of lines and heaps of outlines are refused before they cost minutes. Hatches and contours are not refused."""

import numpy as np
import pytest

from la_core.drawing import Drawn, Outline, cleaned, cleaning, enclosing

LINEAR = 1.1  # allowed growth over that of the drawing
PLACE = ("WALL", "7")


def grid(count: int) -> list[np.ndarray]:
    """`count` level and `count` upright lines. Each line crosses all lines of the other kind."""
    at = np.arange(1.0, count + 1.0)
    across = [np.array([[0.0, z], [count + 1.0, z]]) for z in at]
    return [*across, *(line[:, ::-1] for line in across)]


def boxes(count: int, apart: float) -> list[Outline]:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return [Outline(corners + k * apart * np.array([1.0, 0.01]), *PLACE) for k in range(count)]


def test_lines_that_cross_far_too_often_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(enclosing, "MOST_CROSSINGS", 2_000)
    with pytest.raises(ValueError, match=r"its 100 lines cross each other some .* times; at most 2,000 are followed: .*`ignore`"):
        cleaned(Drawn(1.0, lines={PLACE: grid(50)}), 0.0)
    assert len(cleaned(Drawn(1.0, lines={PLACE: grid(40)}), 0.0).outlines) == 39**2


def test_a_few_lines_across_all_others_are_no_tangle(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(enclosing, "MOST_CROSSINGS", 50)
    axes = [np.array([[0.0, 0.0], [101.0, x]]) for x in (0.3, 0.6)]
    upright = [np.array([[x, -1.0], [x, 1.0]]) for x in np.arange(1.0, 101.0)]
    enclosing._refuse_a_tangle([*upright[:24], *axes])
    with pytest.raises(ValueError, match="its 102 lines cross each other"):
        enclosing._refuse_a_tangle([*upright, *axes])


def test_outlines_in_a_heap_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cleaning, "MOST_PAIRS", 2_000)
    with pytest.raises(ValueError, match=r"its 300 outlines lie upon each other, in more than 2,000 pairs; .*`ignore`"):
        cleaned(Drawn(1.0, outlines=boxes(300, 0.1)), 0.0)
    assert len(cleaned(Drawn(1.0, outlines=boxes(300, 1.5)), 0.0).outlines) == 300


@pytest.mark.parametrize("order", [(0, 1, 2), (0, 2, 1), (1, 0, 2), (2, 0, 1)])
def test_ends_of_lines_meet_in_any_order(order: tuple[int, ...]) -> None:
    """Three ends, each at 0.9 of the merging distance from the next, and one end far away."""
    ends = np.array([[0.0, 0.0], [0.9, 0.0], [1.8, 0.0]])[list(order)]
    merged = enclosing._merged(np.concatenate([ends, [[9.0, 0.0]]]), 1.0)
    assert np.array_equal(merged, np.concatenate([np.tile(ends[0], (3, 1)), [[9.0, 0.0]]]))
    assert np.array_equal(enclosing._merged(ends, 0.0), ends)


def test_four_times_the_outlines_that_lines_divide_take_four_times_the_looks(monkeypatch: pytest.MonkeyPatch) -> None:
    """A line across all outlines of its layer divides each of them into two halves."""
    gathered: list[int] = []

    def counted(members=()):
        found = set(members)
        gathered[-1] += len(found)
        return found

    monkeypatch.setattr(cleaning, "set", counted, raising=False)
    for count in (20, 80):
        across = np.array([[-1.0, 0.5], [1.5 * count, 0.5 + 0.015 * count]])  # the boxes rise by 1 %
        gathered.append(0)
        assert len(cleaned(Drawn(1.0, boxes(count, 1.5), {PLACE: [across]}), 0.0).outlines) == 2 * count
    assert 0 < gathered[1] < LINEAR * 4.0 * gathered[0]
