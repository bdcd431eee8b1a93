"""The engines that move supports: every point of a support moves by the support's unit motion times the speed."""

import sys
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from la_core import exchange
from yade_scripts import case
from yade_scripts.driving import drives_of, ramp, set_speed

DOWN = [0.0, 0.0, -1.0, 0.0, 0.0, 0.0]
HALF = [0.0, 0.0, -0.5, 0.0, 0.0, 0.0]
OBLIQUE = [0.6, 0.0, -0.8, 0.0, 0.0, 0.0]
TURN = [*np.cross([2.0, 0.0, -1.0], [0.0, 1.0, 0.0]), 0.0, 1.0, 0.0]  # about an axis along y through (2, 0, -1)
SCREW = [*(np.cross([0.0, 3.0, 1.0], [0.0, 0.6, 0.8]) + 0.25 * np.array([0.0, 0.6, 0.8])), 0.0, 0.6, 0.8]
HALF_TURN = [0.5 * value for value in TURN]


class TranslationEngine(SimpleNamespace):
    """A stand-in that keeps its arguments and moves points as YADE's documentation states."""

    def moves(self, point: np.ndarray) -> np.ndarray:
        return self.velocity * self.translationAxis


class HelixEngine(SimpleNamespace):
    """A stand-in that turns points about an axis and moves them along it."""

    def moves(self, point: np.ndarray) -> np.ndarray:
        along = getattr(self, "linearVelocity", 0.0) * self.rotationAxis
        arm = point - self.zeroPoint if self.rotateAroundZero else 0.0 * point  # else each body turns about its own centroid
        return getattr(self, "angularVelocity", 0.0) * np.cross(self.rotationAxis, arm) + along


@pytest.fixture(autouse=True)
def engines(monkeypatch: pytest.MonkeyPatch) -> None:
    stand_in: Any = ModuleType("yade")
    stand_in.HelixEngine, stand_in.TranslationEngine = HelixEngine, TranslationEngine
    monkeypatch.setitem(sys.modules, "yade", stand_in)


def case_of(*twists: Any, **more: Any) -> Any:
    one: Any = object.__new__(case.Case)
    vars(one).update({"support_twists": np.array([[0.0] * 6, *twists])} | more)  # the first block is free
    return one


@pytest.mark.parametrize(
    ("twists", "motion", "places", "leader"),
    [
        ([HALF, DOWN, HALF], DOWN, [0.0, 0.0, 0.0], 2),
        ([DOWN, HALF], DOWN, [0.0, 0.0], 1),
        ([HALF_TURN, TURN], TURN, [9.0, 2.5], 2),  # for an angle, the support that turns most leads
        ([TURN, TURN], DOWN, [3.0, 5.0], 2),  # for a way, the support farthest from the axis leads
        ([TURN, TURN], DOWN, [5.0, 3.0], 1),
    ],
)
def test_the_support_that_moves_most_leads(twists: list[list[float]], motion: list[float], places: list[float], leader: int) -> None:
    """places: of the supports' centroids along x, at the height of the axis."""
    centroid = np.array([[0.0, 0.0, 0.0], *([x, 0.0, -1.0] for x in places)])
    role = np.array([exchange.FREE, *[exchange.SUPPORT] * len(twists)])
    assert case_of(*twists, role=role, live=None, support_twist=np.array(motion), centroid=centroid).leader == leader


def test_the_speed_of_supports_is_that_of_their_fastest_contact_point_beside_the_other_block() -> None:
    """Points beside a free block are 1 m and 4 m from the axis. The point of two supports that move alike, at 8 m, does not count."""
    position = np.array([[3.0, 0.0, -1.0], [-2.0, 0.0, -1.0], [10.0, 0.0, -1.0]])
    contacts = {"block_a": np.array([0, 2, 1]), "block_b": np.array([1, 0, 2]), "position": position}
    assert case_of(TURN, TURN, live=None, **contacts).support_speed == pytest.approx(4.0)
    assert case_of(HALF, DOWN, live=None, **contacts).support_speed == pytest.approx(1.0)
    assert case_of(TURN, TURN, live=np.array([1.0, 0.0, 0.0]), **contacts).support_speed == 1.0


@pytest.mark.parametrize(("plane", "size"), [(True, 2.0), (False, 9.0)])
def test_units_of_force_and_of_length_are_those_of_a_free_block(plane: bool, size: float) -> None:
    """Units are the mean weight with dead loads, and the median largest extent, in the plane without depth. Held blocks do not count."""
    extents = [(1.0, 9.0, 0.5), (50.0, 9.0, 50.0), (2.0, 9.0, 1.0), (4.0, 9.0, 5.0)]
    vertices = tuple(np.array([[0.0, 0.0, 0.0], extent]) for extent in extents)
    masses = {"mass": np.array([2.0, 100.0, 4.0, 3.0]), "load_weight": np.array([5.0, 7.0, 0.0, 1.0])}
    role = np.array([exchange.FREE, exchange.SUPPORT, exchange.FREE, exchange.FREE])
    one = case_of(plane=plane, role=role, gravity=np.array([6.0, 0.0, -8.0]), vertices=vertices, **masses)
    assert (one.block_weight, one.weight, one.block_size) == pytest.approx((32.0, 96.0, size))


@pytest.mark.parametrize(
    "twists", [[DOWN], [DOWN, HALF, DOWN], [OBLIQUE], [TURN], [SCREW], [TURN, HALF_TURN, TURN], [[0.5 * value for value in SCREW]]]
)
def test_every_support_moves_by_its_own_unit_motion_times_the_speed(twists: list[list[float]]) -> None:
    one, clumps = case_of(*twists), [10, *range(20, 20 + len(twists))]
    drives = drives_of(one, clumps)
    set_speed(one, drives, 0.03)
    assert len(drives) == len({tuple(twist) for twist in twists})  # one engine for supports that move alike
    assert sorted(clump for drive in drives for clump in drive.ids) == clumps[1:]
    for clump, twist in zip(clumps[1:], np.array(twists), strict=True):
        (drive,) = [drive for drive in drives if clump in drive.ids]
        for point in np.array([[0.0, 0.0, 0.0], [1.0, -2.0, 5.0]]):
            assert_allclose(drive.moves(point), 0.03 * (twist[:3] + np.cross(twist[3:], point)), atol=1e-15)


def test_supports_at_rest_stay_where_they_are() -> None:
    one, point = case_of(DOWN, TURN, SCREW), np.array([1.0, 2.0, 3.0])
    drives = drives_of(one, [10, 20, 21, 22])
    assert_allclose([drive.moves(point) for drive in drives], 0.0)
    set_speed(one, drives, 0.5)
    set_speed(one, drives, 0.0)
    assert_allclose([drive.moves(point) for drive in drives], 0.0)


def test_a_ramp_begins_and_ends_smoothly() -> None:
    """It gives half of the speed at half of its time, is symmetric about this point, and gives full speed from its end on."""
    assert [ramp(elapsed, 2.0) for elapsed in (0.0, 1.0, 2.0, 3.0)] == pytest.approx([0.0, 0.5, 1.0, 1.0])
    assert ramp(0.5, 2.0) == pytest.approx(1.0 - ramp(1.5, 2.0)) and ramp(1e-3, 2.0) < 1e-6
    assert ramp(0.0, 0.0) == 1.0  # no ramp at all
