"""Friction of every joint, from the last class of joints that contains it, or else from [joint]."""

import math

import numpy as np

from la_core.errors import SceneError
from la_core.geometry import Blocks, Interfaces
from la_core.scene.loads.dead_loads import chosen_by
from la_core.scene.schema.loads import JointFriction

LEVEL = math.cos(math.radians(45.0)) * (1.0 - 1e-9)  # least z of the normal of a bed joint; a joint at 45 degrees is a bed joint


def friction_of_joints(rules: tuple[JointFriction, ...], common: float, blocks: Blocks, interfaces: Interfaces) -> np.ndarray:
    """Friction coefficient (I,) of each interface.

    Parameters
    ----------
    rules : tuple of JointFriction
        Classes of joints; the last class that contains a joint counts.
    common : float
        Friction coefficient of joints without a class.
    blocks : Blocks
        Blocks of the scene, with their roles in the scene.
    interfaces : Interfaces
        Interfaces between the blocks.
    """
    friction = np.full(len(interfaces), common)
    for rule in rules:
        friction[joints_of_rule(rule, blocks, interfaces)] = rule.friction
    return friction


def joints_per_class(rules: tuple[JointFriction, ...], blocks: Blocks, interfaces: Interfaces) -> list[int]:
    """Number of interfaces that take their friction from each class; the parameters are those of `friction_of_joints`."""
    ruling = np.full(len(interfaces), -1)
    for number, rule in enumerate(rules):
        ruling[joints_of_rule(rule, blocks, interfaces)] = number
    return [int((ruling == number).sum()) for number in range(len(rules))]


def joints_of_rule(rule: JointFriction, blocks: Blocks, interfaces: Interfaces) -> np.ndarray:
    """Mask (I,) of the interfaces in a class of joints."""
    a, b = interfaces.block_a, interfaces.block_b
    held = ~(blocks.free[a] & blocks.free[b])
    level = np.abs(interfaces.normal[:, 2]) >= LEVEL
    of_class = {None: np.ones(len(a), dtype=bool), "footing": held, "bed": ~held & level, "head": ~held & ~level}[rule.joints]
    if rule.between is None:
        return of_class
    one, other = (chosen_by(blocks, pattern) for pattern in rule.between)
    return of_class & ((one[a] & other[b]) | (one[b] & other[a]))


def refuse_idle_classes(rules: tuple[JointFriction, ...], blocks: Blocks, interfaces: Interfaces) -> None:
    """Raise SceneError for a class of joints between blocks that share no joint; the parameters are those of `friction_of_joints`."""
    for number, rule in enumerate(rules):
        if rule.between is not None and not joints_of_rule(rule, blocks, interfaces).any():
            raise SceneError(f"friction[{number}].between", "no joint lies between these blocks", value=list(rule.between))
