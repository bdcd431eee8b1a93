"""Friction is left out only where no joint slides, and there it changes nothing."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from coulomb_problems import problem
from reduced_models import SOLVER, arch, with_friction

from comparison.judge.checks.answer import check_expected
from comparison.verdict import Verdict
from la_core.analysis.decisions import decided_model
from la_core.analysis.prediction import _without_history
from la_core.analysis.stage import analyse
from la_core.coulomb import sliding
from la_core.coulomb.sliding import SAME_VALUE, SLIDING_SHARE, look_for_sliding, slides_in_mechanism
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.measures.mechanism import moving, sliding_share
from la_core.model.assembly import assemble
from la_core.scene.variants import variant

SHARP = 1e-5  # of the reaction: at sharp edges both models differ only by their tolerances
WITHOUT_SLIDING = ("arch_spreading", "arch_settling", "arch_diagonal", "two_pads", "trilith", "slab_four_corners", "vault_spreading")
WITH_SLIDING = ("wall_low_friction", "wall_tall", "stack_bond_wall", "dome_sector", "corner_settling_end", "ferris_tin_loi_1")


@pytest.mark.parametrize("name", WITHOUT_SLIDING)
def test_where_no_joint_slides_friction_is_left_out_and_nothing_changes(name: str) -> None:
    scene = scenes.shipped(name)
    short, full = analyse(scene), analyse(with_friction(scene, "coulomb"))
    assert short.assembly.effects.friction == "none-slides" and short.assembly.effects.elasticity == "none"
    assert short.coulomb is not None and full.coulomb is not None
    assert short.coulomb.value == pytest.approx(full.coulomb.value, rel=SOLVER, abs=SOLVER * scene.weight)
    assert short.coulomb.interval == (short.coulomb.value, short.coulomb.value)
    assert short.sharp.coulomb is not None and full.sharp.coulomb is not None
    assert short.sharp.coulomb.value == pytest.approx(full.sharp.coulomb.value, rel=SHARP)
    assert short.coulomb.iterations < full.coulomb.iterations
    assert short.coulomb.dilatancy_residual <= SLIDING_SHARE


@pytest.mark.parametrize("name", WITHOUT_SLIDING[:-1])
def test_where_no_joint_slides_heymans_law_gives_the_same(name: str) -> None:
    scene = scenes.shipped(name)
    heyman, short = analyse(with_friction(scene, "none-slides")), analyse(scene)
    assert heyman.coulomb is None and heyman.assembly.effects.sliding_excluded
    value = short.bounds[Drive.YIELDING].value
    assert heyman.bounds[Drive.YIELDING].value == pytest.approx(value, rel=SOLVER)


@pytest.mark.parametrize("friction", [0.01, 0.02])
def test_a_joint_that_slides_with_little_friction_slides(friction: float) -> None:
    """The settling column is a third of the weight. Dilatancy reduces the bound by a share of about mu squared."""
    scene = variant("stack_bond_wall", {"joint.friction": friction})
    answer = analyse(scene)
    assert answer.assembly.effects.friction == "coulomb" and answer.coulomb is not None
    assert answer.coulomb.value == pytest.approx(scene.weight / 3.0, rel=1e-6)
    assert answer.sharp.coulomb is None  # the bound for sharp edges has the same error


@pytest.mark.parametrize("friction", [0.003, 0.01, 0.02])
def test_a_right_value_is_met_with_little_friction(friction: float) -> None:
    """By statics the reaction is half of the weight. The bound for sharp edges, which dilates, does not replace the prediction."""
    expected = {"reaction_over_weight": 0.5, "tolerance": 1e-6, "kind": "exact"}
    (check,) = check_expected(analyse(variant("two_blocks", {"joint.friction": friction, "expected": expected})))
    assert check.verdict is Verdict.EXPECTED_MET


@pytest.mark.parametrize("name", WITH_SLIDING)
def test_where_joints_slide_friction_stays_and_names_a_joint(name: str) -> None:
    """Dilatancy wedges a dome's lunes in every associated mechanism. Without it they slide, as elastic steps find."""
    effects = decided_model(scenes.shipped(name)).assembly.effects
    assert effects.friction == "coulomb" and effects.elasticity == "plateau"
    assert "the joint between" in effects.reasons["friction"]


@pytest.mark.parametrize("friction", [0.4, 0.6])
def test_where_the_support_leaves_alone_no_joint_slides_in_the_mechanism_but_one_does_on_the_way(friction: float) -> None:
    """The middle of a wall's base settles. Dilating joints hold the wall up, so that no block moves and the velocities are noise."""
    wall, _ = scenes.wall(9, 6)
    roles = ("fixed", "support", "fixed")
    footing = [scenes.box(f"footing {k}", (1.2 * k, 0.0, -0.2), (1.2 * k + 1.2, 0.3, 0.0), role) for k, role in enumerate(roles)]
    scene = scenes.build(wall, *footing, friction=friction, inset=0.001, model="auto")
    assembly = assemble(scene)
    bound = solve_associated(assembly, Drive.YIELDING)
    assert bound.status is Status.SOLVED and not moving(assembly, bound.twists).any()
    assert not slides_in_mechanism(assembly, bound)
    assert "slides while the support moves" in decided_model(scene).assembly.effects.reasons["friction"]


@pytest.mark.parametrize("settlement", [scenes.DOWN, (0.6, 0.0, -1.0)])
def test_where_the_support_leaves_alone_friction_decides_nothing(settlement: tuple[float, ...]) -> None:
    """A reaction of zero is known to a share of the weight, not of its own rounding errors. Sharp edges then have a prediction."""
    scene = scenes.build(*scenes.wall(3, 2, split=1.1), inset=0.001, settlement=settlement, model="auto")
    answer = analyse(scene)
    assert answer.assembly.effects.friction == "none-slides"
    assert answer.coulomb is not None and answer.sharp.coulomb is not None
    assert [answer.coulomb.value, answer.sharp.coulomb.value] == pytest.approx([0.0, 0.0], abs=SOLVER * scene.weight)


def test_a_motion_without_power_does_not_slide_by_its_rounding_errors() -> None:
    """A lintel turns about the edge below its centroid. Neither its weight nor friction does work, so that their ratio is noise."""
    parts = [
        scenes.box("fixed pad", (0.0, 0.0, 0.0), (1.0, 1.0, 0.2), "fixed"),
        scenes.box("pad", (1.5, 0.0, 0.0), (2.0, 1.0, 0.2), "support"),
    ]
    scene = scenes.build(*parts, scenes.box("lintel", (0.0, 0.0, 0.2), (2.0, 1.0, 0.7)), inset=0.0)
    assembly = assemble(scene)
    lintel = scene.blocks.names.index("lintel")
    twists, forces = np.zeros((len(scene.blocks), 6)), np.zeros((len(assembly.points), 3))
    twists[lintel, 4], twists[lintel, 0], twists[lintel, 2] = 1.0, 0.25 + 1e-15, 1e-13  # about y, at half its height
    forces[:, 2] = assembly.weight / len(forces)
    assert sliding_share(assembly, twists, forces) < SLIDING_SHARE
    twists[lintel, 0] += 1e-3
    assert sliding_share(assembly, twists, forces) > SLIDING_SHARE


def test_without_friction_joints_slide_and_nothing_dilates() -> None:
    scene = scenes.build(*scenes.wall(4, 3, 1.0), friction=0.0, inset=0.001, model="auto")
    short, full = analyse(scene), analyse(with_friction(scene, "coulomb"))
    assert short.assembly.effects.friction == "associated"
    assert short.coulomb is not None and full.coulomb is not None
    assert short.coulomb.value == pytest.approx(full.coulomb.value, rel=SOLVER)


def test_a_wall_without_sliding_is_another_structure() -> None:
    scene = scenes.shipped("wall_third")
    heyman, full = analyse(with_friction(scene, "none-slides")), analyse(scene)
    assert full.coulomb is not None
    assert heyman.bounds[Drive.YIELDING].value < 0.5 * full.coulomb.value


def test_a_joint_within_two_per_cent_of_sliding_counts_as_sliding() -> None:
    """The arch's bound brackets the friction at which it slides: below this friction the reaction exceeds that of the hinge mechanism."""
    free = solve_associated(assemble(arch(0.9, model="none-slides")), Drive.YIELDING).value
    low, high = 0.2, 0.9
    while high - low > 1e-3:
        middle = 0.5 * (low + high)
        solution = solve_associated(assemble(arch(middle, model="associated")), Drive.YIELDING)
        holds = solution.status is Status.SOLVED and abs(solution.value - free) <= SOLVER * free
        low, high = (low, middle) if holds else (middle, high)
    assert decided_model(arch(1.005 * high)).assembly.effects.friction == "coulomb"
    assert decided_model(arch(1.5 * high)).assembly.effects.friction == "none-slides"
    assert decided_model(arch(0.97 * low)).assembly.effects.friction == "coulomb"


@pytest.mark.parametrize("friction", [0.4, 0.5, 0.6, 0.7])
@pytest.mark.parametrize("thickness", [0.2, 0.3, 0.4])
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.3, 0.0, 0.5), (0.0, 0.0, -1.0)])
def test_friction_is_left_out_only_where_that_changes_nothing(friction: float, thickness: float, direction: tuple[float, ...]) -> None:
    """Arches of three voussoirs, some of which slide on their way to a plateau on which nothing slides."""
    toml = scenes.text(scenes.arch(3, thickness), friction=friction, inset=0.001, settlement=direction, model="auto")
    short, full = (analyse(scenes.load(toml.replace('"auto"', f'"{model}"', 2).replace(f'plane = "{model}"', 'plane = "auto"')))
                   for model in ("auto", "coulomb"))  # fmt: skip
    assert short.coulomb is not None and full.coulomb is not None and full.coulomb.status is Status.SOLVED
    assert short.coulomb.value == pytest.approx(full.coulomb.value, rel=1e-3, abs=1e-3 * short.assembly.mean_weight)


def test_blocks_that_are_lifted_off_do_not_slide_by_rounding_errors() -> None:
    """Once the load equals the weight, the joints store no energy, and any rounding error of friction's work would exceed it."""
    ground = scenes.box("ground", (0.0, 0.0, -0.1), (1.0, 0.2, 0.0), "fixed")
    blocks = scenes.box("lower", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)), scenes.box("upper", (0.1, 0.0, 0.5), (0.8, 0.2, 1.0))
    answer = analyse(scenes.build(ground, *blocks, inset=0.001, live=(0.0, 0.0, 1.0), model="auto"))
    assert answer.assembly.effects.friction == "none-slides"
    assert answer.coulomb is not None and answer.coulomb.status is Status.SOLVED
    assert answer.coulomb.value == pytest.approx(1.0, abs=SOLVER)
    assert answer.coulomb.uncertainty <= SOLVER


def test_friction_stays_where_the_strain_of_the_joints_keeps_the_value_from_the_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    assembly, stiffness = problem(scenes.shipped("arch_spreading"))
    bound = solve_associated(assembly, Drive.YIELDING)
    assert not look_for_sliding(assembly, stiffness, bound, 0.0).found
    monkeypatch.setattr(sliding, "SAME_VALUE", 0.0)  # no value is that near to the bound
    search = look_for_sliding(assembly, stiffness, bound, 0.0)
    assert search.found and "strain of the joints" in search.reason


@pytest.mark.parametrize(("apart", "uncertainty", "is_known"), [(0.5, 0.0, True), (2.0, 0.0, False), (2.0, 1.5, True)])
def test_sharp_edges_have_a_value_where_that_of_rounded_ones_is_the_bound_beyond_doubt(
    apart: float, uncertainty: float, is_known: bool
) -> None:
    """apart: prediction less bound; uncertainty: of the prediction; both over the difference within which two values are one."""
    analysis = analyse(scenes.shipped("arch_spreading"))
    assert analysis.coulomb is not None
    one = SAME_VALUE * analysis.bounds[Drive.YIELDING].value
    coulomb = replace(analysis.coulomb, value=analysis.bounds[Drive.YIELDING].value + apart * one, uncertainty=uncertainty * one)
    assert (_without_history(replace(analysis.at_inset, coulomb=coulomb), analysis.sharp) is not None) is is_known


# --- by hand ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("shear", "energy"), [(4.0, 2.875), (0.0, 2.25)])
def test_the_energy_of_joints_is_that_of_their_springs(shear: float, energy: float) -> None:
    """Normal forces 3 and 0 on springs of 2, friction 1 and 2 on springs of 4: half of 9/2 + 5/4. A shear stiffness of 0 adds nothing."""
    joints: Any = SimpleNamespace(normal=2.0, shear=shear)
    state: Any = SimpleNamespace(joints=SimpleNamespace(force=np.array([[3.0, 1.0], [0.0, 2.0]])))
    assert sliding._energy(joints, state) == pytest.approx(energy)


def test_the_joint_that_is_said_to_slide_is_the_one_that_dissipates_most() -> None:
    """Two blocks slide at one velocity. The heavier one has a fifth of the friction coefficient: 2 * 0.1 against 1 * 0.5."""
    parts = [scenes.box(name, (x, 0.0, 0.0), (x + 0.5, 0.5, size)) for name, x, size in (("heavy", 0.0, 0.4), ("light", 1.0, 0.2))]
    ground = scenes.box("ground", (-1.0, 0.0, -0.2), (3.0, 0.5, 0.0), "fixed")
    smooth = scenes.table("[friction]", between=["heavy", "ground"], friction=0.1)
    scene = scenes.build(*parts, ground, smooth, friction=0.5, live=(1.0, 0.0, 0.0))
    assembly = assemble(scene)
    solution: Any = SimpleNamespace(twists=np.zeros((3, 6)), forces=np.zeros((len(assembly.points), 3)))
    solution.twists[:2, 0] = 1.0
    is_heavy = (assembly.contact_blocks[0] == 0) | (assembly.contact_blocks[1] == 0)
    upward = np.where(assembly.contact_blocks[1] < 2, 1.0, -1.0)
    solution.forces[:, 2] = upward * np.where(is_heavy, 2.0, 1.0)
    assert '"light"' in sliding._sliding_joint(assembly, solution) and '"heavy"' not in sliding._sliding_joint(assembly, solution)
