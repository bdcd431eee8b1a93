"""Blocks, the interfaces at which they touch, and the contact points there."""

from la_core.geometry import shapes
from la_core.geometry.blocks import ROLES, Blocks
from la_core.geometry.interfaces import Interfaces, find_interfaces, near_pairs, separation_by_faces
from la_core.geometry.points import ContactPoints, contact_points, joint_rooms, without_slivers
from la_core.geometry.polygons import plane_axes
from la_core.geometry.shapes import FACE_FLATNESS, Shape, box, compound, loft, polyhedron, prism

__all__ = [
    "FACE_FLATNESS",
    "ROLES",
    "Blocks",
    "ContactPoints",
    "Interfaces",
    "Shape",
    "box",
    "compound",
    "contact_points",
    "find_interfaces",
    "joint_rooms",
    "loft",
    "near_pairs",
    "plane_axes",
    "polyhedron",
    "prism",
    "separation_by_faces",
    "shapes",
    "without_slivers",
]
