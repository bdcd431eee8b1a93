"""A joint that was laid a little thicker may lead to another limit state, also where no joint slides from rest."""

import numpy as np
import pytest
import scenes

from la_core.analysis.stage import analyse
from la_core.coulomb.certificate import ACCEPTED_RESIDUAL
from la_core.coulomb.followed_path import FollowedPath, PredictionSettings
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.sharp_path import follow


class UnevenJoints(ElasticJoints):
    """Joints that were laid thicker than drawn; `thicker` (C,) is the difference over the travel."""

    thicker: np.ndarray

    def displacement(self, blocks: np.ndarray, progress: float) -> np.ndarray:
        moved = super().displacement(blocks, progress)
        moved[:, 0] -= self.thicker
        return moved


def frame() -> tuple[str, ...]:
    """Two legs of two blocks under a lintel that a tie pulls; the right foot is pushed aside."""
    held = (
        scenes.box("ground", (-0.05, 0.0, -0.2), (0.4, 0.3, 0.0), "fixed"),
        scenes.box("pad", (0.55, 0.0, -0.2), (1.0, 0.3, 0.0), "support"),
    )
    legs = [
        scenes.box(f"{side} {level}", (low, 0.0, 0.3 * level), (low + 0.35, 0.3, 0.3 * level + 0.3))
        for side, low in (("left", 0.0), ("right", 0.6))
        for level in (0, 1)
    ]
    tie = scenes.table("[tie]", blocks=["lintel"], **{"from": (0.0, 0.15, 0.7)}, to=(-2.0, 0.15, 1.0), force=165.0)
    return (*held, *legs, scenes.box("lintel", (0.0, 0.0, 0.6), (0.95, 0.3, 0.8)), tie)


def test_one_thicker_joint_leads_to_another_limit_state_within_the_bounds() -> None:
    scene = scenes.build(*frame(), friction=1.5, inset=1e-3, settlement=(1.0, 0.0, 0.0), model="auto")
    analysis = analyse(scene)
    assembly, coulomb = analysis.at_inset.assembly, analysis.at_inset.coulomb
    assert coulomb is not None and assembly.effects.friction == "none-slides"
    assert coulomb.interval == pytest.approx((coulomb.value, coulomb.value))
    joints = UnevenJoints(assembly, analysis.stiffness)
    found: list[FollowedPath] = []
    for sags in (0.0, 10.0):
        joints.thicker = np.where(assembly.points.interface == 0, sags * joints.sag, 0.0)
        tangent = Tangent(joints)
        rest, _ = come_to_rest(joints, tangent)
        assert rest is not None
        path = follow(joints, tangent, rest, 1e-3, PredictionSettings(), 0.0, lambda *_: None)
        assert path is not None and path.plateau.is_flat and path.end.certificate.worst <= ACCEPTED_RESIDUAL
        found.append(path)
    even, uneven = (joints.value_in_units(path.plateau.value) for path in found)
    least, greatest = (bound.value for bound in analysis.at_inset.bounds.values())
    assert even == pytest.approx(coulomb.value, rel=1e-3)
    assert least < uneven < greatest and uneven > 0.6 * coulomb.value  # both are negative: uneven has less than 0.6 of the size
