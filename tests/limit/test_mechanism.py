"""Measures of a mechanism, checked by hand: similarity of two mechanisms, and speeds of block corners."""

import numpy as np
import pytest
import scenes

from la_core.geometry import Blocks
from la_core.measures import block_speeds, corner_speeds
from la_core.measures.mechanism import moving_mass_share, point_velocity, similarity
from la_core.model import assemble
from la_core.scene import Scene

LENGTH, DEPTH, HEIGHT = 1.0, 0.5, 0.4


def two_boxes() -> Scene:
    """A light box beside a box three times as heavy, each on one half of a base. The right half settles."""
    boxes = (
        scenes.box("light", (0.0, 0.0, 0.0), (LENGTH, DEPTH, HEIGHT), density=1000.0),
        scenes.box("heavy", (LENGTH, 0.0, 0.0), (2.0 * LENGTH, DEPTH, HEIGHT), density=3000.0),
    )
    return scenes.build(*boxes, *scenes.base(LENGTH, 2.0 * LENGTH, DEPTH))


def motion(blocks: Blocks, **twists: tuple[float, ...]) -> np.ndarray:
    """Twists (B, 6) of the named blocks; all others rest."""
    made = np.zeros((len(blocks), 6))
    for name, twist in twists.items():
        made[blocks.names.index(name)] = twist
    return made


DOWN, UP = (0.0, 0.0, -1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
# About the y axis at the foot of the light box, x = 0, z = 0: omega x r at the centroid, and omega.
TIPS = (HEIGHT / 2.0, 0.0, -LENGTH / 2.0, 0.0, 1.0, 0.0)
OF_INERTIA = (LENGTH**2 + HEIGHT**2) / 12.0  # over the mass, about the y axis through the centroid
OF_TIPPING = OF_INERTIA + (LENGTH**2 + HEIGHT**2) / 4.0  # about the foot, by the parallel axis theorem


@pytest.mark.parametrize(
    ("first", "second", "alike"),
    [
        ({"light": DOWN, "heavy": DOWN}, {"light": DOWN}, 1.0 / 4.0),  # (m 1 1)^2 / ((m + 3m) m)
        ({"light": DOWN, "heavy": DOWN}, {"heavy": DOWN}, 3.0 / 4.0),
        ({"light": DOWN, "heavy": DOWN}, {"light": UP, "heavy": DOWN}, 1.0 / 4.0),  # (-m + 3m)^2 / (4m)^2
        ({"light": DOWN}, {"heavy": DOWN}, 0.0),
        ({"light": TIPS}, {"light": DOWN}, (LENGTH / 2.0) ** 2 / OF_TIPPING),
        ({"light": TIPS}, {"light": (0.0, 0.0, 0.0, 0.0, 1.0, 0.0)}, OF_INERTIA / OF_TIPPING),
        ({"light": DOWN}, {"light": (0.0, 0.0, 0.0, 0.0, 1.0, 0.0)}, 0.0),
    ],
)
def test_mechanisms_are_alike_by_the_mass_that_moves_alike(
    first: dict[str, tuple[float, ...]], second: dict[str, tuple[float, ...]], alike: float
) -> None:
    blocks = two_boxes().blocks
    one, other = motion(blocks, **first), motion(blocks, **second)
    assert similarity(blocks, one, other) == pytest.approx(alike, abs=1e-12)
    assert similarity(blocks, other, one) == pytest.approx(alike, abs=1e-12)


def test_a_mechanism_is_like_itself_at_any_speed_whatever_the_supports_do() -> None:
    blocks = two_boxes().blocks
    one = motion(blocks, light=TIPS, heavy=DOWN)
    other = -7.0 * one + motion(blocks, **{"settling base": UP})
    assert similarity(blocks, one, other) == pytest.approx(1.0)


def test_nothing_is_like_rest() -> None:
    blocks = two_boxes().blocks
    assert np.isnan(similarity(blocks, motion(blocks, light=DOWN), motion(blocks)))


def test_a_box_that_tips_turns_about_its_foot() -> None:
    """A positive rotation about y lowers the points at greater x and moves the higher points along x."""
    blocks = two_boxes().blocks
    corners = np.array([[0.0, 0.0, 0.0], [LENGTH, 0.0, 0.0], [0.0, DEPTH, HEIGHT], [LENGTH, DEPTH, HEIGHT]])
    of_light = np.full(len(corners), blocks.names.index("light"))
    velocity = point_velocity(blocks, motion(blocks, light=TIPS), corners, of_light)
    expected = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -LENGTH], [HEIGHT, 0.0, 0.0], [HEIGHT, 0.0, -LENGTH]])
    np.testing.assert_allclose(velocity, expected, atol=1e-12)


def test_the_fastest_corner_may_be_another_one_along_a_direction() -> None:
    """A box tips, and the box beside it rises. Against the x axis, the fastest corner of the tipping box is its foot, which is at rest."""
    blocks = two_boxes().blocks
    tips = motion(blocks, light=TIPS, heavy=UP)
    both = [blocks.names.index("light"), blocks.names.index("heavy")]
    assert block_speeds(blocks, tips)[both] == pytest.approx([np.hypot(LENGTH, HEIGHT), 1.0])
    for direction, fastest in (((0.0, 0.0, -1.0), (LENGTH, -1.0)), ((1.0, 0.0, 0.0), (HEIGHT, 0.0)), ((-1.0, 0.0, 0.0), (0.0, 0.0))):
        assert corner_speeds(blocks, tips, np.array(direction))[both] == pytest.approx(fastest, abs=1e-12)


@pytest.mark.parametrize(("speed", "share"), [(1.0, 1.0), (0.06, 1.0), (0.04, 0.75)])
def test_blocks_below_a_twentieth_of_the_fastest_speed_stand_still(speed: float, share: float) -> None:
    """The heavy box moves with its support and has three quarters of the mass."""
    assembly = assemble(two_boxes())
    slow = tuple(speed * component for component in DOWN)
    twists = motion(assembly.blocks, light=slow, heavy=DOWN, **{"settling base": DOWN})
    assert moving_mass_share(assembly, twists) == pytest.approx(share)
