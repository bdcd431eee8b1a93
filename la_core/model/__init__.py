"""The mechanical model of a scene: assembly, scaling, elastic joints, and the effects that it needs."""

from la_core.model.assembly import PLANE_FREEDOMS, Assembly, assemble, per_length, unjoined
from la_core.model.contact_grid import with_grid
from la_core.model.dem_effects import decide_dem_effects, distance_to_meet
from la_core.model.effects import BOUNDS_HOLD, BOUNDS_WITHOUT_STRAIN, Effects
from la_core.model.joints import ELASTIC_SHARE, JointStiffness, connected_to_held, joint_stiffness
from la_core.model.mirrors import SAME_LOAD, Image, images
from la_core.model.scaling import columns, global_forces, local_forces, scaled_load, support_motion, twists_of

__all__ = [
    "BOUNDS_HOLD",
    "BOUNDS_WITHOUT_STRAIN",
    "ELASTIC_SHARE",
    "PLANE_FREEDOMS",
    "SAME_LOAD",
    "Assembly",
    "Effects",
    "Image",
    "JointStiffness",
    "assemble",
    "columns",
    "connected_to_held",
    "decide_dem_effects",
    "distance_to_meet",
    "global_forces",
    "images",
    "joint_stiffness",
    "local_forces",
    "per_length",
    "scaled_load",
    "support_motion",
    "twists_of",
    "unjoined",
    "with_grid",
]
