"""The bounds change as they must with friction, with the direction of the motion and with the choice of the support."""

from dataclasses import replace

import numpy as np
import pytest
import scenes
from scenes_of_laws import ARCH, INDEPENDENT, LIVE, ROUND_OFF, TEXTS, values

from la_core.model.assembly import assemble


@pytest.mark.parametrize("name", ["wall", "arch", "crossing beams"])
def test_more_friction_widens_the_interval_of_reactions(name) -> None:
    scene = scenes.load(TEXTS[name])
    assembly = assemble(scene)
    intervals = []
    for friction in (0.45, 0.5, 0.6, 0.8, 1.2):
        points = replace(assembly.points, friction=np.full(len(assembly.points), friction))
        intervals.append(values(replace(assembly, points=points)))
    least, greatest = np.array(intervals).T
    assert (np.diff(least) <= ROUND_OFF).all() and (np.diff(greatest) >= -ROUND_OFF).all()
    assert (least <= greatest).all()
    if name == "wall":  # friction matters here, so the law is put to the test
        assert least[0] - least[-1] > 0.01


def test_more_friction_bears_more_live_load() -> None:
    multipliers = [values(scenes.load(LIVE.replace("friction = 0.6", f"friction = {mu}")))[0] for mu in (0.0, 0.2, 0.4, 0.6, 0.9)]
    assert (np.diff(multipliers) > 0.0).any() and (np.diff(multipliers) >= -ROUND_OFF).all()
    assert multipliers[0] == pytest.approx(0.0, abs=INDEPENDENT)  # frictionless bed joints bear no horizontal load


@pytest.mark.parametrize("name", ["wall", "arch", "crossing beams"])
def test_the_greatest_reaction_is_minus_the_least_for_the_opposite_motion(name) -> None:
    """R is measured along the motion. For the opposite motion, R_min and R_max exchange places and change sign."""
    scene = scenes.load(TEXTS[name])
    assert scene.support_twist is not None
    least, greatest = values(scene)
    assert values(replace(scene, support_twist=-scene.support_twist)) == pytest.approx([-greatest, -least], abs=ROUND_OFF)


def test_supports_that_exchange_roles_share_the_weight() -> None:
    """For vertical motion, the least reaction of one base and the greatest reaction of the other add up to the weight."""
    first = scenes.build(*scenes.wall(5, 6, split=1.2))
    parts = [
        part.replace('"fixed"', '"swap"').replace('"support"', '"fixed"').replace('"swap"', '"support"') for part in scenes.wall(5, 6, 1.2)
    ]
    second = scenes.build(*parts)
    (least, greatest), (other_least, other_greatest) = values(first), values(second)
    assert [least + other_greatest, greatest + other_least] == pytest.approx([1.0, 1.0], abs=ROUND_OFF)


def test_without_sliding_nothing_changes_where_nothing_slides() -> None:
    coulomb = scenes.load(ARCH)
    no_sliding = scenes.load(ARCH.replace('"associated"', '"none-slides"'))
    assert values(coulomb) == pytest.approx(values(no_sliding), abs=ROUND_OFF)


@pytest.mark.parametrize("name", ["wall", "crossing beams"])
def test_large_friction_tends_to_no_sliding(name) -> None:
    no_sliding = values(scenes.load(TEXTS[name].replace('"associated"', '"none-slides"')))
    gaps = []
    for friction in (3.0, 30.0, 300.0):
        reaction = values(scenes.load(TEXTS[name].replace("friction = 0.6", f"friction = {friction}")))
        gaps.append(abs(reaction[0] - no_sliding[0]))
    assert gaps[2] <= gaps[0] + ROUND_OFF and gaps[2] < 1e-2  # forces in the cone reach any direction only as mu grows
    assert gaps[2] == pytest.approx(0.0, abs=max(ROUND_OFF, gaps[0] / 30.0))


@pytest.mark.parametrize("plane", [True, False])
def test_frictionless_joints(plane) -> None:
    """A block on two pads needs no friction. Without friction, each column of a stack-bonded wall carries itself."""
    pads = scenes.load(scenes.SHIPPED.joinpath("two_pads.toml").read_text().replace("friction = 0.6", "friction = 0.0"))
    sharp = assemble(pads).with_inset(pads, 0.0)
    assert values(sharp) == pytest.approx([1.0 / 6.0, 1.0], abs=ROUND_OFF)
    columns = scenes.build(*scenes.wall(4, 3, split=0.8, bond="stack"), friction=0.0, plane=plane)
    assert values(columns) == pytest.approx([0.5, 0.5], abs=ROUND_OFF)
