"""Blocks that nearly touch are made to touch, within a stated tolerance, and every change is counted."""

from la_core.repair.bodies import with_plane_faces, without_bent_faces
from la_core.repair.closing import close_joints
from la_core.repair.repairs import Repairs, Unclosed

__all__ = ["Repairs", "Unclosed", "close_joints", "with_plane_faces", "without_bent_faces"]
