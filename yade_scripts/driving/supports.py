"""Drive the supports: one engine of YADE for each distinct motion."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from yade_scripts.case import Case

if TYPE_CHECKING:
    from yade import KinematicEngine


def drives_of(case: Case, clumps: Sequence[int]) -> list[KinematicEngine]:
    """Return an engine for each distinct motion of supports, in the order of `Case.motions`. clumps: the clump of each block."""
    alike = [np.flatnonzero((case.support_twists == twist).all(axis=1)).tolist() for twist in case.motions]
    return [_drive(twist, [clumps[block] for block in blocks]) for twist, blocks in zip(case.motions, alike, strict=True)]


def _drive(twist: np.ndarray, ids: list[int]) -> KinematicEngine:
    """Return the engine that moves clumps along a twist (6,): a translation, or a screw about its axis."""
    from yade import HelixEngine, TranslationEngine  # noqa: PLC0415  the servo beside it is used without YADE

    velocity, spin = twist[:3], twist[3:]
    if not spin.any():
        return TranslationEngine(ids=ids, translationAxis=velocity / np.linalg.norm(velocity), velocity=0.0)
    rate = float(np.linalg.norm(spin))
    return HelixEngine(ids=ids, rotationAxis=spin / rate, zeroPoint=np.cross(spin, velocity) / rate**2, rotateAroundZero=True)


def set_speed(case: Case, drives: list[KinematicEngine], speed: float) -> None:
    """Move the supports with `speed` times their unit twists from the next step on."""
    for drive, twist in zip(drives, case.motions, strict=True):
        if rate := float(np.linalg.norm(twist[3:])):
            drive.angularVelocity = speed * rate
            drive.linearVelocity = speed * float(twist[:3] @ twist[3:]) / rate
        else:
            drive.velocity = speed * float(np.linalg.norm(twist[:3]))


def ramp(elapsed: float, duration: float) -> float:
    """Return the value of a cosine ramp from 0 to 1, `elapsed` seconds after its start."""
    return 0.5 - 0.5 * math.cos(math.pi * elapsed / duration) if elapsed < duration else 1.0
