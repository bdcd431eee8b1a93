"""One course of a wall: its blocks between vertical joints, its cuts, and the heads that bridge openings."""

import bisect
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Self

from la_core.errors import SceneError
from la_core.scene.generators.arched_heads import Cut, Span, arched_head
from la_core.scene.schema.masonry import Opening

SHORTEST_PIECE = 0.25  # of a block's length: a shorter remainder beside an opening joins its neighbour
ON_LINE = 1e-6  # of a block's length: openings this close to a course line lie on it
LESS_BEARING = "take a smaller bearing, or leave more wall beside the opening"


@dataclass(frozen=True)
class Piece:
    """A block of a course. Its foot and its head differ beside and in arches, and at an end of the wall that leans.

    Attributes
    ----------
    foot : Span
        Start and end of its lower edge along the wall, m.
    head : Span
        Start and end of its upper edge along the wall, m.
    """

    foot: Span
    head: Span

    def corners(self, bottom: float, top: float) -> list[tuple[float, float]]:
        """Corners (along the wall, up) between two heights, m; three at the apex of a gable, where the head has no length."""
        foot, head = ([(x, z) for x in dict.fromkeys(span)] for span, z in ((self.foot, bottom), (self.head, top)))
        return [*foot, *reversed(head)]


@dataclass(frozen=True)
class Face:
    """A wall seen from its front.

    Attributes
    ----------
    where : str
        Name of the wall in messages.
    total : float
        Length of the wall at its foot, m.
    lines : tuple of float
        Heights of the course lines above the foot of the wall, from 0 to its top, m.
    block : float
        Length of a block, m.
    ends : tuple of Span
        Start and end of the wall along each course line, m.
    """

    where: str
    total: float
    lines: tuple[float, ...]
    block: float
    ends: tuple[Span, ...]

    @classmethod
    def upright(cls, where: str, total: float, height: float, courses: int, block: float) -> Self:
        """A rectangular wall of courses of one height."""
        return cls(where, total, tuple(course * height for course in range(courses + 1)), block, ((0.0, total),) * (courses + 1))

    @property
    def courses(self) -> int:
        """Number of courses."""
        return len(self.lines) - 1

    def pieces(
        self, course: int, first_joint: float, blocked: Sequence[Span], openings: Iterable[Opening], pitch: float = 1.0
    ) -> list[Piece]:
        """Blocks of one course from left to right.

        Parameters
        ----------
        course : int
            Number of the course, from 0 at the bottom.
        first_joint : float
            Position of the first vertical joint along the wall, m.
        blocked : sequence of Span
            Stretches of this course that other walls occupy, m.
        openings : iterable of Opening
            Openings of the wall.
        pitch : float
            Distance of the joints over the length of a block.

        Raises
        ------
        SceneError
            Openings, their heads or walls overlap.
        """
        gaps, heads, arches = list(blocked), [], []
        for opening in openings:
            first, past = self.opening_courses(opening)
            self._refuse_blocked(opening, blocked)
            if first <= course < past:
                gaps.append((opening.from_[0], opening.to[0]))
            elif opening.head == "arch":
                arches += [cut for cut in (arched_head(self.where, self.lines, past, opening).cuts.get(course),) if cut is not None]
            elif course == past:
                heads.append(opening)
        cuts = sorted(gaps + [self._head_span(opening) for opening in heads] + [_outer(cut) for cut in arches])
        plain = self._ended(course, [Piece(span, span) for span in self._between(course, first_joint, pitch, cuts)])
        for opening in heads:
            plain = self._bridged(plain, opening)
        for cut in arches:
            plain = self._skewed(plain, cut)
        return sorted(plain, key=lambda piece: sum(piece.foot) + sum(piece.head))

    def opening_courses(self, opening: Opening) -> tuple[int, int]:
        """First course that an opening cuts, and the course of its head; raises SceneError where it does not fit the wall."""
        corners = (opening.from_, opening.to)
        where = f"{self.where}: opening"
        first, past = (self._line_at(z, where, corners) for z in (opening.from_[1], opening.to[1]))
        if first < 0 or past >= self.courses:
            raise SceneError(where, f"must leave a course for the {opening.head}; the wall has {self.courses} courses", value=corners)
        if opening.from_[0] < 0.0 or opening.to[0] > self.total:
            raise SceneError(where, f"must lie within the wall's length of {self.total:g} m", value=corners)
        return first, past

    def _line_at(self, z: float, where: str, corners: object) -> int:
        """Number of the course line at a height (m); -1 below the wall, `courses` above the wall; raises SceneError between lines."""
        step = self.lines[1]
        if abs(z - self.lines[-1]) > ON_LINE * step and not self.lines[0] - ON_LINE * step <= z <= self.lines[-1]:
            return -1 if z < 0.0 else self.courses
        above = bisect.bisect_left(self.lines, z - ON_LINE * step)
        if abs(self.lines[above] - z) <= ON_LINE * step:
            return above
        if all(abs(line - k * step) <= ON_LINE * step for k, line in enumerate(self.lines)):
            rule = f"multiples of {step:g} m"
        else:
            rule = f"of which {self.lines[above - 1]:g} m and {self.lines[above]:g} m are nearest"
        raise SceneError(where, f"bottom and top must lie on course lines, {rule}", value=corners)

    def _inner(self, course: int) -> Span:
        """Stretch along the wall that a course fills over its whole height, m; empty at the apex of a gable."""
        (start, end), (top_start, top_end) = self.ends[course : course + 2]
        return max(start, top_start), min(end, top_end)

    def _ended(self, course: int, plain: list[Piece]) -> list[Piece]:
        """The pieces of a course, with the first and the last piece extended to the ends of the wall, which may lean."""
        low, high = self._inner(course)
        foot, head = self.ends[course : course + 2]
        near = ON_LINE * self.block
        if high - low <= near:
            return [Piece(foot, head)]
        ended = []
        for piece in plain:
            start = (foot[0], head[0]) if abs(piece.foot[0] - low) <= near else (piece.foot[0], piece.head[0])
            end = (foot[1], head[1]) if abs(piece.foot[1] - high) <= near else (piece.foot[1], piece.head[1])
            ended.append(Piece((start[0], end[0]), (start[1], end[1])))
        return ended

    def _skewed(self, plain: list[Piece], cut: Cut) -> list[Piece]:
        """The pieces of a course, with the two pieces beside an arch cut along the sides of the arch."""
        low, high = _outer(cut)
        near = ON_LINE * self.block
        skewed, sides = [], 0
        for piece in plain:
            if abs(piece.foot[1] - low) <= near:
                skewed.append(Piece((piece.foot[0], cut[0][0]), (piece.head[0], cut[1][0])))
            elif abs(piece.foot[0] - high) <= near:
                skewed.append(Piece((cut[0][1], piece.foot[1]), (cut[1][1], piece.head[1])))
            else:
                skewed.append(piece)
                continue
            sides += 1
        if sides != 2:
            rule = "an arch needs a block on either side in every course that it crosses"
            raise SceneError(f"{self.where}: opening", rule, value=cut, hint=LESS_BEARING)
        return skewed

    def _refuse_blocked(self, opening: Opening, blocked: Sequence[Span]) -> None:
        low, high = opening.from_[0] - opening.bearing, opening.to[0] + opening.bearing
        for start, end in blocked:
            if low < end - ON_LINE * self.block and high > start + ON_LINE * self.block:
                rule = f"with its bearing it overlaps the wall that meets this one from {start:g} to {end:g} m"
                raise SceneError(f"{self.where}: opening", rule, value=(opening.from_, opening.to))

    def _head_span(self, opening: Opening) -> Span:
        """Span of the head of an opening in its course, m; a lintel does not extend beyond the wall."""
        low, high = opening.from_[0] - opening.bearing, opening.to[0] + opening.bearing
        return (max(0.0, low), min(self.total, high)) if opening.head == "lintel" else (low, high)

    def _between(self, course: int, first_joint: float, pitch: float, cuts: list[Span]) -> list[Span]:
        """Spans between the cuts, divided at the joints of the course; short remainders join their neighbours."""
        length, step = self.block, pitch * self.block
        joints = [first_joint + k * step for k in range(int((self.total - first_joint) / step) + 2)]
        spans: list[Span] = []
        start, end = self._inner(course)
        for low, high in [*cuts, (end, end)]:
            if low < start - ON_LINE * length:
                raise SceneError(
                    f"{self.where}: course {course + 1}",
                    "openings or their heads overlap here, or reach beyond the wall",
                    value=(low, start),
                )
            if low > start + ON_LINE * length:
                least = SHORTEST_PIECE * length * min(pitch, 1.0)
                inner = [joint for joint in joints if start + least <= joint <= low - least]
                spans += pairwise([start, *inner, low])
            start = high
        return spans

    def _bridged(self, plain: list[Piece], opening: Opening) -> list[Piece]:
        """The pieces of a course with the head of an opening.

        The head is one lintel, or the voussoirs of a flat arch with skewbacks cut on its neighbours.
        """
        low, high = self._head_span(opening)
        if opening.head == "lintel":
            return [*plain, Piece((low, high), (low, high))]
        left, right = opening.from_[0], opening.to[0]
        near = ON_LINE * self.block
        skewed, bare = [], {"left": low, "right": high}  # sides on which the arch has no block yet
        for piece in plain:
            if abs(piece.head[1] - low) <= near:
                skewed.append(replace(piece, foot=(piece.foot[0], left)))
                bare.pop("left", None)
            elif abs(piece.head[0] - high) <= near:
                skewed.append(replace(piece, foot=(right, piece.foot[1])))
                bare.pop("right", None)
            else:
                skewed.append(piece)
        if bare:
            sides = " and ".join(f"the {side}, at {at:g} m" for side, at in bare.items())
            rule = f"a flat arch bears on a block of the same course on either side, and this block is missing on {sides}"
            raise SceneError(f"{self.where}: opening", rule, value=(opening.from_, opening.to), hint=LESS_BEARING)
        feet, crowns = (_divided(span, opening.voussoirs) for span in ((left, right), (low, high)))
        return [*skewed, *(Piece(foot, crown) for foot, crown in zip(pairwise(feet), pairwise(crowns), strict=True))]


def _divided(span: Span, count: int) -> list[float]:
    return [span[0] + (span[1] - span[0]) * k / count for k in range(count + 1)]


def _outer(cut: Cut) -> Span:
    """Widest stretch of an arch in a course, m."""
    foot, head = cut
    return min(foot[0], head[0]), max(foot[1], head[1])
