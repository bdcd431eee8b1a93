"""Changes that a repair made in the geometry of a scene, and places that it could not repair."""

from dataclasses import asdict, dataclass
from typing import Any


@dataclass(frozen=True)
class Unclosed:
    """A place that the repair leaves open, between two blocks.

    There are four cases. Two opposite faces lie within the tolerance, but could not be brought onto one plane. Two opposite faces lie a
    little too far apart. Two faces lost most of their joint when a corner was cut. An overlap is too deep to cut.

    Attributes
    ----------
    blocks : tuple of str
        Names of both blocks.
    vertex : tuple of float
        Corner of the gap at which the faces are farthest apart, m; for an overlap that is too deep, its middle.
    gap : float
        Distance between the faces at that corner, m; for an overlap, minus its depth.
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
        Largest width of the open joints of drawings that are closed, m.
    largest_move : float
        Largest displacement of a vertex, m.
    moved_block : str
        Block of that vertex; "" where no vertex moved.
    gaps_closed, overlaps_closed : int
        Number of pairs of faces brought onto one plane: of pairs with a gap, and of pairs that overlapped.
    overlaps_cut : int
        Number of cuts of blocks that overlapped another block.
    deepest_cut : float
        Depth of the deepest cut, m.
    shortest_joint : float
        Length below which joints are dropped, m.
    unclosed : tuple of Unclosed
        Places that could not be repaired.
    made_convex : int
        Number of bodies of meshes whose dents were filled within the tolerance.
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
        """All attributes by name, as plain values."""
        return asdict(self)
