"""The effect of rotations: the choices of a scene, and the reason that states the change by turning blocks."""

import math
from dataclasses import replace

import pytest
import scenes
from turning_scenes import FINITE, RELEASES, SMALL

import la_core
from la_core.analysis import analyse
from la_core.analysis.decisions import with_rotation_explained
from la_core.errors import SceneError
from la_core.scene.variants import full_model


def test_rotation_is_explained_by_what_the_mechanism_allows() -> None:
    wide = analyse(RELEASES).assembly.effects
    assert wide.rotation == "small"
    assert (
        'release a thrust, and the reaction becomes 1930 N, 18.18 ± 0.05 % less (rotation = "finite" has YADE check this)'
        in wide.reasons["rotation"]
    )
    kept = analyse(scenes.shipped("wall_third")).assembly.effects
    assert "turning blocks change it by at most 0." in kept.reasons["rotation"]
    narrow = analyse(scenes.shipped("ferris_tin_loi_1")).assembly.effects
    assert narrow.rotation == "small" and "another mechanism alone" in narrow.reasons["rotation"]
    asked = analyse(la_core.variant(RELEASES, SMALL)).assembly.effects
    assert asked.reasons["rotation"] == "requested in the scene"


@pytest.mark.parametrize(
    ("released", "doubt", "words"),
    [
        (2.6, 0.12, "160 ± 12 % more"),
        (0.4, 0.004, "60.0 ± 0.4 % less"),
        (0.97, 1.2, "it is uncertain whether turning blocks change it (−3 ± 120 %)"),
        (0.998, 0.001, "turning blocks change it by at most 0.3 %"),
        (0.9931, 0.007, "it is uncertain whether turning blocks change it (−0.7 ± 0.7 %)"),
        (1.0 - 1e-15, 0.11, "it is uncertain whether turning blocks change it (0 ± 11 %)"),
        (1.0, 1e-27, "turning blocks change it by at most 0.01 %"),
        (1.0592, 0.012, "6 ± 1 % more"),
    ],
)
def test_rotation_says_how_much_turning_blocks_change(released: float, doubt: float, words: str) -> None:
    analysis = analyse(la_core.variant(RELEASES, SMALL))
    assert analysis.coulomb is not None
    value = analysis.coulomb.value
    made_up = replace(analysis.coulomb, uncertainty=0.0, released=released * value, released_uncertainty=doubt * value)
    assert words in with_rotation_explained(RELEASES, analysis.assembly, made_up).reasons["rotation"]


@pytest.mark.parametrize(
    ("released", "doubt", "words"),
    [
        (6.0, 0.1, "becomes 6 N, 4.0 ± 0.1 N more"),
        (2.1, 0.3, "it is uncertain whether turning blocks change it (0.1 ± 0.3 N)"),
        (2.0, 0.05, "turning blocks change it by at most 0.05 N"),
        (math.nan, math.nan, "because the mechanism's interval is 5 N"),
    ],
)
def test_changes_of_a_value_that_is_hardly_anything_are_no_shares_of_it(released: float, doubt: float, words: str) -> None:
    """A reaction of 2 N is judged by a thousandth of the weight, 24 N. A rise by 4 N is stated in N, not as 17 % of these 24 N."""
    analysis = analyse(la_core.variant(RELEASES, SMALL))
    assert analysis.coulomb is not None and 20.0 < 1e-3 * RELEASES.weight < 30.0
    values = {"value": 2.0, "uncertainty": 0.0, "interval": (1.0, 6.0), "released": released, "released_uncertainty": doubt}
    effects = with_rotation_explained(RELEASES, analysis.assembly, replace(analysis.coulomb, **values))
    assert words in effects.reasons["rotation"]


@pytest.mark.parametrize(("ends", "words"), [((0.0, math.inf), "is unlimited"), ((math.nan, math.nan), "is unknown")])
def test_rotation_names_an_interval_without_a_width(ends: tuple[float, float], words: str) -> None:
    analysis = analyse(RELEASES)
    assert analysis.coulomb is not None
    unknown = replace(analysis.coulomb, interval=ends, released=math.nan)
    effects = with_rotation_explained(RELEASES, analysis.assembly, unknown)
    assert effects.reasons["rotation"].endswith(words)


def test_an_interval_of_round_off_is_a_point() -> None:
    """Its width was once stated as "3.1e-09 of the value"."""
    analysis = analyse(RELEASES)
    assert analysis.coulomb is not None
    value = analysis.coulomb.value
    narrow = replace(analysis.coulomb, interval=(value, (1.0 + 3.1e-9) * value), released=math.nan)
    effects = with_rotation_explained(RELEASES, analysis.assembly, narrow)
    assert effects.reasons["rotation"].endswith("because the interval of this one is a point")


def test_without_sliding_there_is_nothing_to_release() -> None:
    effects = analyse(la_core.variant(scenes.shipped("arch_spreading"), FINITE)).assembly.effects
    assert effects.friction == "none-slides" and effects.rotation == "small"
    assert "no joint slides" in effects.reasons["rotation"]


def test_bounds_refuse_finite_rotations() -> None:
    with pytest.raises(SceneError, match=r"effects\.rotation"):
        analyse(la_core.variant(RELEASES, FINITE | {"effects.friction": "associated"}))


def test_the_full_model_keeps_the_rotations_of_its_scene() -> None:
    assert full_model(RELEASES).effects.rotation == "auto"
    assert full_model(la_core.variant(RELEASES, FINITE)).effects.rotation == "finite"
