"""Walls and shipped scenes have the values of closed forms, publications and an independent prototype."""

import tomllib
from collections.abc import Iterator

import pytest
import scenes
from associated_values import EXACT, FIVE_DIGITS, SEVEN_DIGITS, in_plane_and_3d, value

from la_core.limit.problem import Drive
from la_core.model.assembly import assemble

COULOMB_ALONE = "wall_low_friction"  # its joints slide: its exact value is that of the prediction, not of the bound


def with_associated_value() -> Iterator[str]:
    """Shipped scenes with a settlement and an expected associated value. A new scene is tested without being listed."""
    for path in scenes.SHIPPED.glob("*.toml"):
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
        if {"expected", "settlement"} <= tables.keys() and path.stem != COULOMB_ALONE:
            yield path.stem


@pytest.mark.parametrize("name", sorted(with_associated_value()))
def test_shipped_scene_yields_its_expected_value(name: str) -> None:
    scene = scenes.shipped(name)
    assert scene.expected is not None and scene.inset == 0.001
    sharp = assemble(scene).with_inset(scene, 0.0)
    expected = scene.expected.associated_reaction_over_weight
    if expected is None:  # no joint slides, so any friction yields the same
        expected = scene.expected.reaction_over_weight
    assert value(sharp) == pytest.approx(expected, abs=scene.expected.tolerance)
    if scene.expected.reaction_max_over_weight is not None:
        assert value(sharp, Drive.PUSHING) == pytest.approx(scene.expected.reaction_max_over_weight, abs=scene.expected.tolerance)


@in_plane_and_3d
@pytest.mark.parametrize("friction", [0.2, 0.6, 0.8])
@pytest.mark.parametrize(("columns", "courses", "settling"), [(2, 1, 1), (5, 4, 2), (6, 5, 2)])
def test_stack_bonded_wall_holds_its_settling_columns_by_dilatant_friction(columns, courses, settling, friction, plane) -> None:
    """R = W_mov - mu N with the head joint's thrust N = mu R limited by the settling base; the standing part neither slides nor tips."""
    standing = columns - settling
    parts = scenes.wall(columns, courses, split=standing * 0.4, block_size=(0.4, 1.0, 0.2), bond="stack")
    scene = scenes.build(*parts, friction=friction, plane=plane)
    assert value(scene) == pytest.approx(settling / columns / (1.0 + friction**2), abs=EXACT)


@in_plane_and_3d
@pytest.mark.parametrize(("courses", "published"), [(6, 0.64286), (10, 0.58000)])
def test_walls_of_ferris_and_tin_loi(courses, published, plane) -> None:
    """Ferris & Tin-Loi 2001, walls 1 and 2; Gilbert, Casapulla & Ahmed 2006: associated multipliers."""
    parts = scenes.wall(5, courses, block_size=(0.4, 1.0, 0.175), first="half")
    scene = scenes.build(*parts, friction=0.65, live=(1.0, 0.0, 0.0), plane=plane)
    assert len(scene.blocks) == {6: 33, 10: 55}[courses] + 1
    assert value(scene, Drive.LIVE) == pytest.approx(published, abs=FIVE_DIGITS)


@in_plane_and_3d
@pytest.mark.parametrize(("friction", "split", "computed"), [(0.6, 1.2, 0.1286765), (0.3, 1.2, 0.1761531), (0.6, 1.6, 0.0612745)])
def test_running_bond_wall(friction, split, computed, plane) -> None:
    """Values of an independent prototype, to seven digits."""
    scene = scenes.build(*scenes.wall(6, 10, split, block_size=(0.4, 1.0, 0.2)), friction=friction, plane=plane)
    assert value(scene) == pytest.approx(computed, abs=SEVEN_DIGITS)
