"""Blocks, the interfaces at which they touch, and the contact points there."""

from la_core.geometry import shapes
from la_core.geometry.blocks import ROLES, Blocks, Held
from la_core.geometry.division import without_straight_corners
from la_core.geometry.edge_contacts import edge_contacts
from la_core.geometry.faces import face_corners, face_pairs, face_polygons, near_pairs, near_parts, opposite_faces
from la_core.geometry.interfaces import Interfaces, find_interfaces, gaps, nearest_gap, overlaps
from la_core.geometry.missed_joints import MissedJoints, joint_areas, missed_joints
from la_core.geometry.points import SLIVER, ContactPoints, contact_points, without_slivers
from la_core.geometry.polygons import group_members, next_corners, overlap_of, owners, plane_axes, polygons_of, ring_corners
from la_core.geometry.shapes import FACE_FLATNESS, Shape, box, compound, divided_loft, loft, polyhedron, prism

__all__ = [
    "FACE_FLATNESS",
    "ROLES",
    "SLIVER",
    "Blocks",
    "ContactPoints",
    "Held",
    "Interfaces",
    "MissedJoints",
    "Shape",
    "box",
    "compound",
    "contact_points",
    "divided_loft",
    "edge_contacts",
    "face_corners",
    "face_pairs",
    "face_polygons",
    "find_interfaces",
    "gaps",
    "group_members",
    "joint_areas",
    "loft",
    "missed_joints",
    "near_pairs",
    "near_parts",
    "nearest_gap",
    "next_corners",
    "opposite_faces",
    "overlap_of",
    "overlaps",
    "owners",
    "plane_axes",
    "polygons_of",
    "polyhedron",
    "prism",
    "ring_corners",
    "shapes",
    "without_slivers",
    "without_straight_corners",
]
