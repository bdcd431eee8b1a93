"""Motion of the supports: one engine of YADE for all of them, and its speed."""

import numpy as np
from yade import HelixEngine, KinematicEngine, TranslationEngine

from yade_scripts.case import Case


def drive_of(case: Case, ids: list[int]) -> KinematicEngine:
    """Return the engine that moves the supports along the unit twist: a translation, or a screw about its axis. ids: of clumps."""
    velocity, spin = case.support_twist[:3], case.support_twist[3:]
    if not case.is_rotation:
        return TranslationEngine(ids=ids, translationAxis=velocity / np.linalg.norm(velocity), velocity=0.0)
    rate = float(np.linalg.norm(spin))
    return HelixEngine(ids=ids, rotationAxis=spin / rate, zeroPoint=np.cross(spin, velocity) / rate**2, rotateAroundZero=True)


def set_speed(case: Case, drive: KinematicEngine, speed: float) -> None:
    """Move the supports with `speed` times the unit twist from the next step on."""
    if case.is_rotation:
        rate = float(np.linalg.norm(case.support_twist[3:]))
        drive.angularVelocity = speed * rate
        drive.linearVelocity = speed * float(case.support_twist[:3] @ case.support_twist[3:]) / rate
    else:
        drive.velocity = speed * float(np.linalg.norm(case.support_twist[:3]))
