"""What was changed in the geometry of a scene, and what could not be repaired."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Unclosed:
    """A place that the repair leaves open, between two blocks.

    Two faces lie opposite each other within the tolerance, but could not be brought onto one plane; or they were a little too far apart for
    it; or they lost most of their joint as a corner was cut; or an overlap is too deep to cut.

    Attributes
    ----------
    blocks : tuple of str
        Names of both blocks.
    vertex : tuple of float
        The corner of the gap that is farthest from closed, m; the middle of an overlap.
    gap : float
        Distance between the faces there, m; negative for an overlap: minus its depth.
    """

    blocks: tuple[str, str]
    vertex: tuple[float, float, float]
    gap: float


@dataclass(frozen=True)
class Repairs:
    """Every change of the geometry of a scene.

    Attributes
    ----------
    tolerance : float
        Tolerance of the scene, m.
    joint_width : float
        Greatest width of the open joints of drawings that are closed, m.
    largest_move : float
        Largest displacement of a vertex, m.
    moved_block : str
        Block of that vertex; "" where no vertex moved.
    gaps_closed, overlaps_closed : int
        Pairs of faces brought onto one plane, that were apart and that overlapped.
    overlaps_cut : int
        Corners cut from blocks that overlapped another block.
    deepest_cut : float
        Most that was cut from a corner, m.
    shortest_joint : float
        Joints shorter than this are dropped, m.
    unclosed : tuple of Unclosed
        What could not be repaired.
    made_convex : int
        Bodies of meshes of which dents were filled within the tolerance.
    """

    tolerance: float
    joint_width: float
    largest_move: float
    moved_block: str
    gaps_closed: int
    overlaps_closed: int
    overlaps_cut: int
    shortest_joint: float
    unclosed: tuple[Unclosed, ...]
    made_convex: int = 0
    deepest_cut: float = 0.0

    def as_dict(self) -> dict[str, Any]:
        """The same as plain values."""
        return asdict(self)
