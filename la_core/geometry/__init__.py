"""Convex blocks, the interfaces at which they touch, and the contact points there."""

from la_core.geometry import shapes
from la_core.geometry.interfaces import (
    ContactPoints,
    Interfaces,
    contact_points,
    find_interfaces,
    near_pairs,
    plane_axes,
    separation_by_faces,
)
from la_core.geometry.shapes import FACE_FLATNESS, Blocks, Shape, box, loft, polyhedron, prism

__all__ = [
    "FACE_FLATNESS",
    "Blocks",
    "ContactPoints",
    "Interfaces",
    "Shape",
    "box",
    "contact_points",
    "find_interfaces",
    "loft",
    "near_pairs",
    "plane_axes",
    "polyhedron",
    "prism",
    "separation_by_faces",
    "shapes",
]
