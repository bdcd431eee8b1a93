"""The same structure, described differently, has the same answer."""

import math
from dataclasses import replace

import numpy as np
import pytest
import scenes
from scenes_of_laws import ARCH, ROUND_OFF, TEXTS, every_scene, solutions, values

from la_core.model.assembly import assemble

TURNS = {
    "quarter turn about z": scenes.rotation((0.0, 0.0, 1.0), math.pi / 2.0),
    "small turn about y": scenes.rotation((0.0, 1.0, 0.0), 1e-4),
    "any turn": scenes.rotation((0.3, -0.5, 0.8), 1.1),
    "other turn": scenes.rotation((-1.0, 0.2, 0.1), 2.7),
}


@every_scene
@pytest.mark.parametrize("turn", TURNS)
def test_invariance_under_rotation(name, turn) -> None:
    scene = scenes.load(TEXTS[name].replace('plane = "auto"', "plane = false"))
    turned = scenes.moved(scene, TURNS[turn], shift=(3.0, -2.0, 5.0), plane=False)
    assert values(turned) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
@pytest.mark.parametrize("shift", [(1000.0, -300.0, 20.0), (0.1, 0.2, 0.3)])
def test_invariance_under_translation(name, shift) -> None:
    scene = scenes.load(TEXTS[name])
    assert values(scenes.moved(scene, shift=shift)) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
def test_invariance_under_block_order(name) -> None:
    scene = scenes.load(TEXTS[name])
    order = np.random.default_rng(1).permutation(len(scene.blocks))
    assert values(scenes.moved(scene, order=order)) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
@pytest.mark.parametrize("scale", [1e-3, 1e3], ids=["km", "mm"])
@pytest.mark.parametrize("density", [1e-3, 1e3], ids=["light", "heavy"])
def test_invariance_under_units(name, scale, density) -> None:
    """Lengths in km or mm are taken for m, and densities are multiplied by 1e-3 or 1e3: reactions over weight are the same."""
    scene = scenes.load(TEXTS[name])
    assert values(scenes.moved(scene, scale=scale, density=density)) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
@pytest.mark.parametrize("axis", [0, 1])
def test_invariance_under_mirroring(name, axis) -> None:
    scene = scenes.load(TEXTS[name])
    mirror = np.eye(3)
    mirror[axis, axis] = -1.0
    assert values(scenes.moved(scene, mirror)) == pytest.approx(values(scene), abs=ROUND_OFF)


@pytest.mark.parametrize("name", ["wall", "arch"])
def test_plane_model_is_the_3d_model_of_a_prism(name) -> None:
    plane, solid = (scenes.load(TEXTS[name].replace('plane = "auto"', f"plane = {flag}")) for flag in ("true", "false"))
    assert len(assemble(solid).points) == 2 * len(assemble(plane).points)
    assert values(solid) == pytest.approx(values(plane), abs=ROUND_OFF)


@pytest.mark.parametrize("name", ["wall", "crossing beams"])
def test_reaction_is_proportional_to_density_and_gravity(name) -> None:
    scene = scenes.load(TEXTS[name])
    heavier = scenes.moved(scene, density=3.0)
    stronger = replace(scene, gravity=7.0 * scene.gravity)
    for factor, other in ((3.0, heavier), (7.0, stronger)):
        for (_, _, base), (_, _, scaled) in zip(solutions(scene), solutions(other), strict=True):
            assert scaled.value == pytest.approx(factor * base.value, rel=ROUND_OFF)


def test_length_of_the_direction_does_not_matter() -> None:
    for length in (1e-200, 0.5, 1e200):
        scene = scenes.load(ARCH.replace("direction = [1.0, 0.0, -1.0]", f"direction = [{length!r}, 0.0, {-length!r}]"))
        assert values(scene) == pytest.approx(values(scenes.load(ARCH)), abs=ROUND_OFF)
