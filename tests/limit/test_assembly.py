"""The units of a mechanical model, checked by hand: block size, support speed, and a weight in the unit of the answer."""

from typing import Any

import numpy as np
import pytest
import scenes

from la_core.model import assemble
from la_core.model.assembly import Assembly

HALF = {"direction": scenes.DOWN, "zone": [{"blocks": ["support"], "ratio": 0.5}]}
ASLANT = (0.6, 0.0, -0.8)
TURNS = {"axis": (0.0, 1.0, 0.0), "point": (-1.0, 0.5, 0.0)}  # beside the support, whose top reaches from x = 0 to 2 m


def model(**options: Any) -> Assembly:
    """Two boxes side by side on a support, with sharp edges; in the plane by default."""
    boxes = scenes.box("low", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), scenes.box("high", (1.0, 0.0, 0.0), (2.0, 1.0, 3.0))
    role = "fixed" if "live" in options else "support"
    return assemble(scenes.build(*boxes, scenes.box("support", (0.0, 0.0, -9.0), (2.0, 1.0, 0.0), role), **options))


def test_lengths_are_relative_to_a_cube_with_the_mean_diagonal_of_the_free_blocks() -> None:
    """The diagonal of the low box is 1.5 m, that of the high box sqrt(11) m. The support below does not count."""
    assert model().length == pytest.approx((1.5 + np.sqrt(11.0)) / 2.0 / np.sqrt(3.0))


@pytest.mark.parametrize(
    ("options", "speed"),
    [
        ({"settlement": scenes.DOWN}, 1.0),
        ({"settlement": ASLANT}, 1.0),
        ({"settlement": HALF}, 0.5),
        ({"settlement": TURNS}, 3.0),  # of the contact point at x = 2 m; the foot of the support is farther away
    ],
)
def test_a_support_is_as_fast_as_its_fastest_contact_point_and_a_weight_is_worth_as_much(options: dict[str, Any], speed: float) -> None:
    assembly = model(**options)
    assert assembly.support_speed == pytest.approx(speed)
    assert assembly.in_value_unit(7.0) == pytest.approx(7.0 * speed)


def test_a_multiplier_has_neither_a_speed_nor_a_unit() -> None:
    assembly = model(live=(1.0, 0.0, 0.0))
    assert assembly.support_speed == assembly.in_value_unit(7.0) == 1.0


@pytest.mark.parametrize("plane", [True, False])
def test_contact_forces_have_the_power_of_their_wrenches(plane: bool) -> None:
    """For random forces and motions, the power of the block wrenches is that of the contact forces on the relative velocities.

    The kinematic matrix of the programmes gives the same velocities in local axes.
    """
    assembly, random = model(plane=plane), np.random.default_rng(8)
    twists, forces = random.normal(size=(3, 6)), random.normal(size=(len(assembly.points), 3))
    if plane:
        twists[:, [1, 3, 5]] = forces[:, 1] = 0.0
    velocity, wrenches = assembly.relative_velocity(twists), assembly.contact_wrenches(forces)
    assert np.sum(forces * velocity) == pytest.approx(np.sum(wrenches * twists))
    np.testing.assert_allclose(wrenches[:, :3].sum(axis=0), 0.0, atol=1e-12)  # a and b take the same force with opposite signs
    kept, length = ([0, 2, 4] if plane else list(range(6))), 2.5
    scaled = (twists * [1.0, 1.0, 1.0, length, length, length])[:, kept].ravel()
    local = np.einsum("cij,cj->ci", assembly.axes[:, : 2 if plane else 3], velocity)
    np.testing.assert_allclose(assembly.kinematic_matrix(length) @ scaled, local.ravel(), atol=1e-12)
