"""A path is followed past the next contact point that closes, opens or slides, until such a change leaves its value unchanged."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
import vaults_and_domes
from coulomb_problems import answer

from la_core.coulomb import lasting
from la_core.coulomb.certificate import ACCEPTED_RESIDUAL
from la_core.model.joints import joint_stiffness


def test_a_gap_that_closes_after_the_curve_is_flat_is_awaited() -> None:
    """Stiffer joints leave narrower gaps, which close within the first travel. Only the strain on the way differs."""
    stones = scenes.table("[rubble]", origin=(0.0, 0.0, 0.0), size=(2.2, 0.9), depth=0.4, stones=12, seed=30, flatness=1.7)
    ground = scenes.box("ground", (0.0, 0.0, -0.3), (1.032151, 0.4, 0.0), "fixed")
    turning = scenes.box("turning", (1.032151, 0.0, -0.3), (2.2, 0.4, 0.0), "support")
    hinge = {"axis": (0.0, -1.0, 0.0), "point": (3.2, 0.0, 0.0)}
    scene = scenes.build(stones, ground, turning, friction=0.8, inset=0.001, settlement=hinge)
    assembly, usual = answer(scene)
    stiff = 16.0 * joint_stiffness(assembly, {}).normal
    _, stiffer = answer(scene, normal_stiffness=stiff, shear_stiffness=stiff)
    assert usual.value == pytest.approx(stiffer.value, abs=usual.uncertainty + stiffer.uncertainty)
    assert (len(usual.plateaus), len(stiffer.plateaus)) == (2, 0)


def test_a_force_that_still_changes_is_followed_until_its_contact_point_gives_way() -> None:
    """A point of this vault opens 11 travels after the curve is flat; stiffer joints show it within the first travel."""
    vault = vaults_and_domes.vault(
        centre=(0.0, 0.0, 0.0),
        radius=None,
        embrace=None,
        shape="pointed",
        span=3.0,
        rise=2.0,
        thickness=0.56,
        length=1.1,
        voussoirs=6,
        rings=2,
    )
    skew = {"axis": (-0.327, 1.5, -0.621), "point": (2.64, 3.54, 0.99)}
    scene = scenes.build(vault, friction=0.79, inset=0.001, settlement=skew)
    assembly, usual = answer(scene)
    stiff = 16.0 * joint_stiffness(assembly, {}).normal
    _, stiffer = answer(scene, normal_stiffness=stiff, shear_stiffness=stiff)
    assert usual.value == pytest.approx(stiffer.value, abs=usual.uncertainty + stiffer.uncertainty)


def extrapolated(displacement: list[np.ndarray], force: list[np.ndarray]) -> float:
    """Progress of the next change of contact points with mu = 0.5, from their displacements and forces at progress 3 and 5."""
    before, last = (
        SimpleNamespace(progress=progress, joints=SimpleNamespace(displacement=motion, force=forces))
        for progress, motion, forces in zip((3.0, 5.0), displacement, force, strict=True)
    )
    points = len(force[0])
    joints: Any = SimpleNamespace(normal=1.0, shear=1.0, friction=np.full(points, 0.5), freedoms=3 * points, weights=np.ones(3 * points))
    return lasting.next_change(joints, before, last)  # type: ignore[arg-type]


def test_only_an_open_point_that_closes_without_the_joints_strain_is_awaited() -> None:
    """The points in turn: open and closing, pressed, overlapping without force, parting, and closing no faster than by strain."""
    gap, closed = np.array([0.3, 0.2, -0.1, 0.1, 0.001]), np.array([0.1, 0.1, 0.1, -0.1, 0.9 * lasting.LEAST_CLOSING])
    force = np.array([[0.0, 0.0], [1.0, 0.0], *[[0.0, 0.0]] * 3])
    before, last, faster = (np.column_stack([one, np.zeros(5)]) for one in (gap + 2.0 * closed, gap, gap - 2.0))
    assert extrapolated([before, last], [force, force]) == pytest.approx(5.0 + 0.3 / 0.1)
    assert extrapolated([faster, last], [force, force]) == np.inf


@pytest.mark.parametrize(("times", "until"), [(0.9, np.inf), (1.1, 5.0 + 0.5)])
def test_a_force_below_what_a_residual_may_be_is_none_that_could_vanish(times: float, until: float) -> None:
    """The force falls by twice its last value per unit of progress."""
    last, still = np.array([[times * ACCEPTED_RESIDUAL, 0.0]]), np.zeros((1, 2))
    assert extrapolated([still, still], [5.0 * last, last]) == pytest.approx(until)


@pytest.mark.parametrize(
    ("rate", "until"),
    [
        ([-0.1, 0.0], 0.6 / 0.1),  # slides: 0.5 (1 - 0.1 s) = 0.2
        ([0.0, 0.05], 0.3 / 0.05),  # slides: 0.2 + 0.05 s = 0.5
        ([0.0, -0.05], 0.7 / 0.05),  # slides the other way
        ([-0.1, 0.05], 0.3 / 0.1),  # both: 0.5 - 0.05 s = 0.2 + 0.05 s
        ([0.2, 0.05], np.inf),  # mu n grows faster than friction
        ([0.0, 0.0], np.inf),
    ],
)
def test_a_point_that_sticks_is_awaited_until_it_slides(rate: list[float], until: float) -> None:
    force, still = np.array([[1.0, 0.2]]), np.zeros((1, 2))
    assert extrapolated([still, still], [force - 2.0 * np.array([rate]), force]) == pytest.approx(5.0 + until)


def test_a_point_that_slides_is_awaited_until_it_opens() -> None:
    force, still = np.array([[1.0, 0.5]]), np.zeros((1, 2))
    assert extrapolated([still, still], [1.4 * force, force]) == pytest.approx(5.0 + 1.0 / 0.2)


def test_an_end_lasts_where_nothing_changes_in_time_or_has_changed_without_effect(monkeypatch: pytest.MonkeyPatch) -> None:
    changes = iter([9.0, 14.0, 15.0])
    monkeypatch.setattr(lasting, "next_change", lambda *_: next(changes))

    def look(end: lasting.Lasting, progress: float, value: float) -> bool:
        path: Any = SimpleNamespace(value=lambda _: value, joints=None)
        state: Any = SimpleNamespace(progress=progress)
        return end.holds(path, state, state)

    end, flat = lasting.Lasting(latest=10.0), lasting.FLAT
    assert not look(end, 2.0, 0.5)  # a point changes its state at 9
    assert not look(end, 8.0, 0.5)  # that change is still to come, so nothing is known
    assert look(end, 9.5, 0.7)  # another value, but the next change comes too late
    assert look(end, 16.0, 0.7 * (1.0 + 0.9 * flat))
    changes = iter([4.0, 5.0, 6.0])
    end = lasting.Lasting(latest=10.0)
    assert [look(end, *one) for one in ((2.0, 0.5), (4.5, 0.7), (5.5, 0.7 * (1.0 + 0.9 * flat)))] == [False, False, True]
