"""Short joints beside long ones neither determine the inset of the long joints nor change the answer."""

import numpy as np
import pytest
import scenes

from la_core.analysis.modelling import structural_model
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.limit.problem import Drive
from la_core.scene import Scene

INSET = 0.004  # m


def stepped(share: float, inset: float = INSET, at: float = 1.3) -> Scene:
    """Two courses on two pads. The upper head joint is `share` (m) beside the lower one, so one bed joint has this length."""
    lower = [scenes.box("a", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), scenes.box("b", (1.0, 0.0, 0.0), (2.0, 1.0, 0.5))]
    upper = [scenes.box("c", (0.0, 0.0, 0.5), (1.0 + share, 1.0, 1.0)), scenes.box("d", (1.0 + share, 0.0, 0.5), (2.0, 1.0, 1.0))]
    return scenes.build(*scenes.base(at, 2.0), *lower, *upper, inset=inset)


@pytest.mark.parametrize(("share", "own", "joints"), [(0.05, INSET, 8), (0.01, 0.0025, 8), (0.003, 0.00075, 8), (0.0015, None, 7)])
def test_a_short_joint_has_an_inset_of_its_own_or_is_dropped(share: float, own: float | None, joints: int) -> None:
    assembly = structural_model(stepped(share)).assembly
    assert len(assembly.interfaces) == joints and assembly.slivers == 8 - joints
    insets = [INSET if own is None else own, *[INSET] * (joints - 1)]
    found = sorted({round(float(assembly.points.inset[assembly.points.interface == k][0]), 9) for k in range(joints)})
    assert found == sorted(set(insets))
    assert assembly.short_joints == (own not in (None, INSET))


@pytest.mark.parametrize("plane", [True, False])
def test_the_travel_of_the_support_does_not_depend_on_a_short_joint(plane: bool) -> None:
    travels = [structural_model(stepped(share)).stiffness.travel for share in (0.2, 0.01, 0.003)]
    assert travels == pytest.approx([travels[0]] * 3, rel=1e-9)


def test_the_answer_does_not_depend_on_where_a_joint_begins_to_be_short() -> None:
    """Below 16 mm the inset of the short joint shrinks. The answer changes as little there as elsewhere."""
    values = np.array([bound(stepped(share, at=0.7)) for share in (0.0165, 0.0161, 0.0159, 0.0155)])
    assert np.ptp(values) < 0.005 * values.mean()


def bound(scene: Scene) -> float:
    return analyse(scene).bounds[Drive.YIELDING].value / scene.weight


def test_an_inset_for_no_joint_is_refused_with_the_largest_allowed() -> None:
    with pytest.raises(SceneError, match=r"joint.inset = 0.6: larger than half the interface.*; take less than 0.35 m"):
        structural_model(stepped(0.05, inset=0.6))
