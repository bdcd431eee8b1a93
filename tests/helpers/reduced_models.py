"""Helpers for tests of effects: an arch, a scene with another law of friction, and the tolerance between two solves."""

import dataclasses

import scenes

from la_core.scene.scene import Scene

SOLVER = 1e-6  # share of the reaction: largest difference of two solves of one problem


def arch(friction: float, **options) -> Scene:
    return scenes.build(scenes.arch(11, 0.15), friction=friction, inset=0.001, settlement=(1.0, 0.0, 0.0), **{"model": "auto"} | options)


def with_friction(scene: Scene, model: str) -> Scene:
    return dataclasses.replace(scene, effects=scene.effects.model_copy(update={"friction": model}))
