"""One course of a wall: its blocks between vertical joints, its cuts, and the heads that bridge openings."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from la_core.errors import SceneError
from la_core.scene.schema.masonry import Opening

SHORTEST_PIECE = 0.25  # of a block's length: a shorter remainder beside an opening joins its neighbour
ON_LINE = 1e-6  # of a block's length: openings this close to a course line lie on it
Span = tuple[float, float]  # from, to along the wall, m


@dataclass(frozen=True)
class Piece:
    """A block of a course. Its foot and its head differ only in a flat arch and its skewbacks.

    Attributes
    ----------
    foot : Span
        Start and end of its lower edge along the wall, m.
    head : Span
        Start and end of its upper edge along the wall, m.
    """

    foot: Span
    head: Span


@dataclass(frozen=True)
class Face:
    """A wall seen from its front.

    Attributes
    ----------
    where : str
        Name of the wall in messages.
    total : float
        Length of the wall, m.
    height : float
        Height of a course, m.
    courses : int
        Number of courses.
    block : float
        Length of a block, m.
    """

    where: str
    total: float
    height: float
    courses: int
    block: float

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
        gaps, heads = list(blocked), []
        for opening in openings:
            first, past = self.opening_courses(opening)
            self._refuse_blocked(opening, blocked)
            if first <= course < past:
                gaps.append((opening.from_[0], opening.to[0]))
            elif course == past:
                heads.append(opening)
        cuts = sorted(gaps + [self._head_span(opening) for opening in heads])
        plain = [Piece(span, span) for span in self._between(course, first_joint, pitch, cuts)]
        for opening in heads:
            plain = self._bridged(plain, opening)
        return sorted(plain, key=lambda piece: sum(piece.foot) + sum(piece.head))

    def opening_courses(self, opening: Opening) -> tuple[int, int]:
        """First course that an opening cuts, and the course of its head; raises SceneError where it does not fit the wall."""
        corners = (opening.from_, opening.to)
        where = f"{self.where}: opening"
        lines = [z / self.height for z in (opening.from_[1], opening.to[1])]
        if any(abs(line - round(line)) > ON_LINE for line in lines):
            raise SceneError(where, f"bottom and top must lie on course lines, multiples of {self.height} m", value=corners)
        first, past = (round(line) for line in lines)
        if first < 0 or past >= self.courses:
            raise SceneError(where, f"must leave a course for the {opening.head}; the wall has {self.courses} courses", value=corners)
        if opening.from_[0] < 0.0 or opening.to[0] > self.total:
            raise SceneError(where, f"must lie within the wall's length of {self.total} m", value=corners)
        return first, past

    def _refuse_blocked(self, opening: Opening, blocked: Sequence[Span]) -> None:
        low, high = opening.from_[0] - opening.bearing, opening.to[0] + opening.bearing
        for start, end in blocked:
            if low < end - ON_LINE * self.block and high > start + ON_LINE * self.block:
                rule = f"with its bearing it overlaps the wall that meets this one from {start:g} to {end:g} m"
                raise SceneError(f"{self.where}: opening", rule, value=(opening.from_, opening.to))

    def _head_span(self, opening: Opening) -> Span:
        """Span of the head of an opening in its course, m; a lintel ends with the wall."""
        low, high = opening.from_[0] - opening.bearing, opening.to[0] + opening.bearing
        return (max(0.0, low), min(self.total, high)) if opening.head == "lintel" else (low, high)

    def _between(self, course: int, first_joint: float, pitch: float, cuts: list[Span]) -> list[Span]:
        """Spans between the cuts, divided at the joints of the course; short remainders join their neighbours."""
        length, step = self.block, pitch * self.block
        joints = [first_joint + k * step for k in range(int((self.total - first_joint) / step) + 2)]
        spans: list[Span] = []
        start = 0.0
        for low, high in [*cuts, (self.total, self.total)]:
            if low < start - ON_LINE * length:
                raise SceneError(f"{self.where}: course {course + 1}", "openings or their heads overlap here", value=(low, start))
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
        skewed = [
            replace(piece, foot=(piece.foot[0], left)) if abs(piece.head[1] - low) <= near
            else replace(piece, foot=(right, piece.foot[1])) if abs(piece.head[0] - high) <= near
            else piece
            for piece in plain
        ]  # fmt: skip
        if sum(piece.foot != piece.head for piece in skewed) - sum(piece.foot != piece.head for piece in plain) != 2:
            rule = "a flat arch needs a block of the same course on either side to bear on"
            raise SceneError(f"{self.where}: opening", rule, value=(opening.from_, opening.to))
        feet, crowns = (_divided(span, opening.voussoirs) for span in ((left, right), (low, high)))
        return [*skewed, *(Piece(foot, crown) for foot, crown in zip(pairwise(feet), pairwise(crowns), strict=True))]


def _divided(span: Span, count: int) -> list[float]:
    return [span[0] + (span[1] - span[0]) * k / count for k in range(count + 1)]
