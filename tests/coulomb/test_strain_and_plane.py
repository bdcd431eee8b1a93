"""Strain and depth are left out where the answer does not depend on them. Checks notice where it would."""

import dataclasses

import numpy as np
import pytest
import scenes
from reduced_models import SOLVER, arch

from comparison.judge.checks.reduced_model import check_plane
from comparison.verdict.check import Verdict
from la_core.analysis.decisions import decided_model
from la_core.analysis.result import Answers, LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.limit.associated import Status, solve_associated
from la_core.limit.plane_in_space import residual_in_space
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

# --- elasticity ------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("elasticity", "friction", "path", "reason"),
    [
        ("none", "coulomb", "", "follows the joints' strain"),
        ("plateau", "associated", "", "do not depend on the joints' strain"),
        ("path", "none-slides", "", "do not depend on the joints' strain"),
        ("none", "auto", "[path]\n", "path of strain"),
    ],
)
def test_an_elasticity_that_does_not_go_with_the_friction_is_refused(elasticity: str, friction: str, path: str, reason: str) -> None:
    toml = scenes.text(*scenes.wall(3, 2, 0.6), model=friction, effects={"elasticity": elasticity}) + path
    with pytest.raises(SceneError, match=r"effects\.elasticity") as refused:
        assemble(scenes.load(toml))
    assert reason in str(refused.value)


def test_a_path_is_refused_where_only_bounds_are_modelled() -> None:
    with pytest.raises(
        SceneError, match=r'effects\.friction = "associated" yields bounds, .* say "coulomb" or "auto", or leave \[path\] out'
    ):
        scenes.load(scenes.text(*scenes.wall(3, 2, 0.6), model="associated") + "[path]\n")


def test_without_strain_a_structure_whose_joints_slide_is_refused_and_an_arch_is_not() -> None:
    rigid = {"elasticity": "none"}
    with pytest.raises(SceneError, match="slides in the mechanism, and friction without dilatancy"):
        analyse(scenes.build(*scenes.wall(4, 3, 1.0), model="auto", effects=rigid))
    assert analyse(arch(0.7, effects=rigid)).coulomb is not None


def test_strain_asked_for_is_modelled_though_no_joint_slides() -> None:
    asked, left_out = analyse(arch(0.7, effects={"elasticity": "plateau"})), analyse(arch(0.7))
    assert asked.assembly.effects.friction == "coulomb" and left_out.assembly.effects.friction == "none-slides"
    assert asked.coulomb is not None and left_out.coulomb is not None
    assert asked.coulomb.value == pytest.approx(left_out.coulomb.value, rel=SOLVER)
    assert analyse(arch(0.7, effects={"elasticity": "path"})).path is not None


def test_a_structure_that_cannot_stand_is_infeasible_without_strain_too() -> None:
    falls = scenes.build(scenes.arch(11, 0.05), model="auto", settlement=(1.0, 0.0, 0.0), effects={"elasticity": "none"})
    assert analyse(falls).bounds[Drive.YIELDING].status is Status.INFEASIBLE
    assert decided_model(falls).assembly.effects.friction == "coulomb"


@pytest.mark.parametrize(
    ("friction", "path", "law", "elasticity", "why_friction", "why_strain"),
    [
        ("auto", "", "coulomb", "plateau", "joints may slide", "from rest to the plateau"),
        ("coulomb", "", "coulomb", "plateau", "requested in the scene", "from rest to the plateau"),
        ("auto", "[path]\n", "coulomb", "path", "a [path] follows the history of friction", "a [path] is requested"),
        ("coulomb", "[path]\n", "coulomb", "path", "requested in the scene", "a [path] is requested"),
        ("associated", "", "associated", "none", "requested in the scene", "bounds do not depend"),
        ("none-slides", "", "none-slides", "none", "requested in the scene", "bounds do not depend"),
    ],
)
def test_strain_goes_with_friction_and_with_a_path(
    friction: str, path: str, law: str, elasticity: str, why_friction: str, why_strain: str
) -> None:
    """Effects that only an answer or a run can show to be needless are modelled until then."""
    effects = assemble(scenes.load(scenes.text(*scenes.wall(3, 2, 0.6), model=friction) + path)).effects
    assert (effects.friction, effects.elasticity, effects.sliding_excluded) == (law, elasticity, friction == "none-slides")
    assert why_friction in effects.reasons["friction"] and why_strain in effects.reasons["elasticity"]
    assert (effects.rotation, effects.reach, effects.displacement, effects.recording) == ("small", False, "finite", "states")
    assert ("bounds hold" in effects.reasons["rotation"]) is (elasticity == "none")


@pytest.mark.parametrize("friction", ["associated", "none-slides"])
def test_turning_blocks_are_refused_where_only_bounds_are_modelled(friction: str) -> None:
    with pytest.raises(SceneError, match=rf"effects\.rotation.*friction = \"{friction}\" yields bounds"):
        assemble(scenes.build(*scenes.wall(3, 2, 0.6), model=friction, effects={"rotation": "finite"}))


# --- plane -----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["arch_spreading", "wall_third", "two_pads"])
def test_the_plane_answer_is_an_answer_in_space(name: str) -> None:
    checks = list(check_plane(analyse(scenes.shipped(name))))
    assert [check.verdict for check in checks] == [Verdict.AGREE]


def test_a_plane_model_of_what_is_not_plane_differs_and_is_noticed() -> None:
    """One of the four corners under a slab settles. In the plane model the corner behind it bears in its place."""
    scene = scenes.shipped("slab_four_corners")
    space, flat = assemble(scene), forced_flat(scene)
    answers = [solve_associated(assembly, Drive.YIELDING).value / scene.weight for assembly in (space, flat)]
    assert abs(answers[0] - answers[1]) > 0.1
    bounds = Answers(flat, {Drive.YIELDING: solve_associated(flat, Drive.YIELDING)})
    analysis = LimitAnalysis(scene, flat, bounds, bounds, joint_stiffness(flat, scene.yade))
    (check,) = check_plane(analysis)
    assert check.verdict is Verdict.INCONCLUSIVE and "plane = false" in check.next_step


def test_a_plane_answer_that_breaks_the_friction_law_breaks_it_in_space() -> None:
    """Two opposite level forces of half a weight at one joint are in balance. In space two points share each of them."""
    analysis = analyse(scenes.shipped("two_pads"))
    assembly, answer = analysis.assembly, analysis.main_answer
    pair = np.flatnonzero(assembly.points.interface == assembly.points.interface[0])
    forces = answer.forces.copy()
    forces[pair, 0] += np.array([0.5, -0.5]) * assembly.mean_weight
    least = assembly.split(answer.forces)[0][pair].min()
    by_hand = (0.5 - assembly.points.friction[pair[0]] * least / assembly.mean_weight) / 2.0
    assert residual_in_space(assembly, answer.twists, forces) == pytest.approx(by_hand, rel=1e-4)


def forced_flat(scene: Scene) -> Assembly:
    """The plane model that `decide` refuses for this scene."""
    assembly = assemble(scene)
    assert not assembly.effects.plane
    flat = dataclasses.replace(assembly, effects=dataclasses.replace(assembly.effects, plane=True))
    return flat.with_inset(scene, scene.inset)


def test_the_depth_of_a_plane_structure_is_told_however_far_the_origin() -> None:
    far = 5432100.25
    boxes = [
        scenes.box(name, (0.0, far, z), (1.0, far + 0.4, z + 0.5), role)
        for name, z, role in (("pad", -0.5, "support"), ("block", 0.0, "free"))
    ]
    assert "from y = 5432100.25 to 5432100.65 m" in assemble(scenes.build(*boxes)).effects.reasons["plane"]
