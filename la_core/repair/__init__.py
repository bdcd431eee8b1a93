"""Blocks that nearly touch are made to touch, within a stated tolerance, and every change is counted."""

from la_core.repair.bodies import is_bent, with_plane_faces
from la_core.repair.closing import close_joints
from la_core.repair.repairs import Repairs, Unclosed

__all__ = ["Repairs", "Unclosed", "close_joints", "is_bent", "with_plane_faces"]
