"""The tilt of the ground as a live load: the direction of gravity relative to the structure, which turns with the ground.

After a tilt by the angle t about a level axis, gravity g relative to the structure is g (cos t down + sin t across), which equals
g cos t (down + tan t across). This is a live load along `across` with the multiplier tan t, with all forces scaled by cos t. With friction
and without cohesion, failure does not depend on the scale of the forces. So the structure fails at the same tan t.
"""

import math
from collections.abc import Iterator

import numpy as np

from la_core.errors import SceneError
from la_core.scene.loads.dead_loads import Fault
from la_core.scene.schema.motion import unit_vector
from la_core.scene.schema.scene_file import SceneFile

LEVEL = 1e-6  # cosine between axis and gravity: round-off of a typed direction


def tilt_push(axis: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    """Unit direction (3,) in which the ground goes down as it turns about the unit `axis` (3,) by the right-hand rule.

    gravity: (3,), m/s2, at right angles to the axis.
    """
    across = np.cross(gravity, axis)
    push: np.ndarray = across / np.linalg.norm(across) + 0.0  # without negative zeros
    return push


def tilt_angles(tilt: np.ndarray | None, multiplier: float | None, uncertainty: float | None = None) -> dict[str, float]:
    """`angle` of the ground and `angle_uncertainty`, degrees, for a multiplier and its uncertainty; empty without a tilt.

    At this angle the component of the weight along the ground is `multiplier` times the component normal to the ground. Undefined numbers
    are NaN. uncertainty: of the multiplier; None leaves `angle_uncertainty` out.
    """
    if tilt is None:
        return {}
    tangent = math.nan if multiplier is None else multiplier
    angles = {"angle": math.degrees(math.atan(tangent))}
    return angles if uncertainty is None else angles | {"angle_uncertainty": math.degrees(uncertainty / (1.0 + tangent**2))}


def faults_of_tilt(file: SceneFile) -> Iterator[Fault]:
    """Yield the faults of a scene with a [tilt]: an axis that is not level, and forces that do not turn with gravity."""
    if file.tilt is None:
        return
    if abs(unit_vector(file.tilt.axis) @ unit_vector(file.gravity)) > LEVEL:
        hint = "an axis such as [0, 1, 0]"
        yield ("tilt", "axis"), str(SceneError("tilt.axis", "must be level, at right angles to gravity", value=file.tilt.axis, hint=hint))
    why = "does not turn with gravity, so the structure under it has no one angle of collapse"
    for number, load in enumerate(file.load):
        if load.force is not None:
            hint = "give a `mass`, or push by a [live] load"
            yield ("load", number), str(SceneError(f'load "{load.name}".force', f"a force {why}", hint=hint))
    for number, tie in enumerate(file.tie):
        hint = "leave it out, or push by a [live] load"
        yield ("tie", number), str(SceneError(f'tie "{tie.name}"', f"the tension of a tie {why}", hint=hint))
