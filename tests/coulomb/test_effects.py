"""Effects that a scene does without: the reduced model agrees with the full one, differs where it matters, and notices where it would."""

import dataclasses

import numpy as np
import pytest
import scenes
from conftest import Silent, every_shipped_scene

from comparison.judge import prediction
from comparison.judge.effects_table import EFFECTS, effects_summary
from comparison.judge.reduced_model import check_plane
from comparison.verdict.check import Check, Verdict
from comparison.workflow import one_scene, restored_effects
from comparison.yade import Results
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.decisions import decided_model
from la_core.analysis.result import Answers, LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb.sliding import SLIDING_SHARE
from la_core.errors import SceneError
from la_core.limit.associated import Status, solve_associated
from la_core.limit.no_sliding import no_sliding_rows, shared_friction
from la_core.limit.problem import Drive, scaled_problem
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene
from la_core.scene.variants import full_model

SOLVER = 1e-6  # of the reaction: what two solves of one problem may differ by
SHARP = 1e-5  # of the reaction: inset and inset differ in nothing, the models' tolerances in this
WITHOUT_SLIDING = ("arch_spreading", "arch_settling", "arch_diagonal", "two_pads", "trilith", "slab_four_corners", "vault_spreading")
WITH_SLIDING = ("wall_low_friction", "wall_tall", "stack_bond_wall", "dome_sector", "corner_settling_end", "ferris_tin_loi_1")


def arch(friction: float, **options) -> Scene:
    return scenes.build(scenes.arch(11, 0.15), friction=friction, inset=0.001, settlement=(1.0, 0.0, 0.0), **{"model": "auto"} | options)


def with_friction(scene: Scene, model: str) -> Scene:
    return dataclasses.replace(scene, effects=scene.effects.model_copy(update={"friction": model}))


# --- friction -----------------------------------------------------------------------------------------------------------------


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


@pytest.mark.parametrize("name", WITH_SLIDING)
def test_where_joints_slide_friction_stays_and_names_a_joint(name: str) -> None:
    """A dome's lunes are wedged by dilatancy in every associated mechanism and slide without it: elastic steps find that."""
    effects = decided_model(scenes.shipped(name)).assembly.effects
    assert effects.friction == "coulomb" and effects.elasticity == "plateau"
    assert "the joint between" in effects.reasons["friction"]


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
    """The arch's sliding limit is bracketed by its own bound: below it the reaction needs more than the mechanism of hinges."""
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
    assert short.coulomb is not None and full.coulomb is not None
    if full.coulomb.status is Status.SOLVED:
        assert short.coulomb.value == pytest.approx(full.coulomb.value, rel=1e-3, abs=1e-3 * short.assembly.mean_weight)


def test_friction_comes_back_when_joints_slide_in_yade(tmp_path, monkeypatch, cross_checked) -> None:
    """A YADE run whose joints slide where limit analysis found none that does: limit analysis is done again in full."""
    found = cross_checked("arch_spreading")
    assert found.analysis.assembly.effects.friction == "none-slides"
    monkeypatch.setattr(restored_effects, "slides_unforeseen", lambda results: results.analysis.assembly.effects.friction == "none-slides")
    monkeypatch.setattr(one_scene, "yade_stage", lambda *_: (found.run, vars(found.run.result)))
    heard: list[str] = []

    class Listener(Silent):
        def stage(self, scene: str, stage: str, state: str) -> None:
            heard.append(f"{stage}: {state}")

    summary = one_scene.run_scene(found.scene, tmp_path / "arch_spreading", Listener(), with_yade=True)
    assert any("repeated with effects that were left out (friction: joints slide" in one for one in heard)
    assert summary["effects"]["friction"] == "coulomb"
    assert summary["effects"]["reasons"]["friction"] == "joints slide in YADE's mechanism"
    assert summary["verdict"] == "agree"


def test_a_run_that_slides_unforeseen_is_noticed(cross_checked) -> None:
    """YADE's run of a wall whose joints slide, held against limit analysis that left friction out."""
    found = cross_checked("wall_third")
    assembly = found.analysis.assembly
    wrong = found.analysis.with_effects(assembly.effects.with_effect("friction", "none-slides", "made up"))
    assert prediction.slides_unforeseen(Results(wrong, found.run))
    assert 'Set friction = "coulomb"' in prediction.predicted(Results(wrong, found.run)).next_step
    arch_run = cross_checked("arch_spreading")
    assert not prediction.slides_unforeseen(Results(arch_run.analysis, arch_run.run))


def without_friction(assembly: Assembly) -> Assembly:
    return dataclasses.replace(assembly, effects=assembly.effects.with_effect("friction", "none-slides", "made up"))


def test_a_region_and_small_displacements_that_yade_does_not_bear_out_are_given_up(tmp_path, monkeypatch, cross_checked) -> None:
    """The guards' complaints, made up: the whole structure is run again in YADE with finite displacements, and says why."""
    found = cross_checked("arch_spreading")
    complaints = {"reach": "made up for reach", "displacement": "made up for displacement"}

    def complain(effect: str, left_out: object):
        def guard(analysis: LimitAnalysis) -> list[Check]:
            bad = getattr(analysis.assembly.effects, effect) == left_out
            return [Check(effect, Verdict.INCONCLUSIVE if bad else Verdict.AGREE, reason=complaints[effect] if bad else "")]

        return guard

    reach, displacement = complain("reach", True), complain("displacement", "small")
    monkeypatch.setattr(restored_effects, "check_reach", lambda results: reach(results.analysis))
    monkeypatch.setattr(restored_effects, "check_displacement", lambda results: displacement(results.analysis))
    assembly = found.analysis.assembly
    first = found.analysis.with_effects(assembly.effects.with_effect("reach", True, "made up"))
    assert first.assembly.effects.displacement == "small"
    asked = restored_effects.needed(Results(first, found.run))
    assert {effect: reason for effect, (_, reason) in asked.items()} == complaints
    again = restored_effects.restore(Results(first, found.run))
    assert again is not None and again.assembly.effects.called_back == tuple(asked)
    assert not again.assembly.effects.reach and again.assembly.effects.displacement == "finite"
    assert again.assembly.effects.reasons["reach"] == complaints["reach"]
    assert restored_effects.restore(Results(again, found.run)) is None


# --- joints that cannot slide ----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("plane", [True, False])
def test_few_equations_stop_all_points_of_a_joint(plane: bool) -> None:
    """Their null space is that of all points' equations."""
    scene = scenes.build(*scenes.wall(3, 2, 0.6), plane=plane, model="none-slides", inset=0.01)
    assembly = assemble(scene)
    kinematics = assembly.kinematic_matrix(assembly.length)
    every, few = (scaled_problem(assembly, every_point) for every_point in (True, False))
    matrices = [(one.flow_rule[: one.cones.equalities] @ kinematics).toarray() for one in (every, few)]
    ranks = [np.linalg.matrix_rank(matrix) for matrix in (*matrices, np.vstack(matrices))]
    assert len(set(ranks)) == 1
    assert no_sliding_rows(assembly).shape[0] == len(assembly.interfaces) * (1 if plane else 3) < matrices[0].shape[0]


def test_few_equations_give_the_answer_of_all() -> None:
    assembly = assemble(scenes.build(*scenes.crossing_beams(), model="none-slides", inset=0.01))
    few, every = (solve_associated(assembly, Drive.YIELDING, scaled_problem(assembly, every_point)) for every_point in (False, True))
    assert few.status is Status.SOLVED
    assert few.value == pytest.approx(every.value, rel=SOLVER)


def test_shared_friction_has_the_same_wrench_and_is_the_least() -> None:
    assembly = assemble(scenes.build(*scenes.crossing_beams(), inset=0.01))
    forces = np.random.default_rng(7).normal(size=(len(assembly.points), 3))
    shared = shared_friction(assembly, forces)
    assert assembly.contact_wrenches(shared) == pytest.approx(assembly.contact_wrenches(forces), abs=1e-12)
    normal = [np.sum(one * assembly.normal, axis=1) for one in (forces, shared)]
    assert normal[0] == pytest.approx(normal[1])
    assert np.linalg.norm(shared) < np.linalg.norm(forces)
    assert shared_friction(assembly, shared) == pytest.approx(shared, abs=1e-12)


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


# --- plane -----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["arch_spreading", "wall_third", "two_pads"])
def test_the_plane_answer_is_an_answer_in_space(name: str) -> None:
    checks = list(check_plane(analyse(scenes.shipped(name))))
    assert [check.verdict for check in checks] == [Verdict.AGREE]


def test_a_plane_model_of_what_is_not_plane_differs_and_is_noticed() -> None:
    """A slab on four corners of which one settles: seen from the side, the corner behind it bears in its place."""
    scene = scenes.shipped("slab_four_corners")
    space, flat = assemble(scene), forced_flat(scene)
    answers = [solve_associated(assembly, Drive.YIELDING).value / scene.weight for assembly in (space, flat)]
    assert abs(answers[0] - answers[1]) > 0.1
    bounds = Answers(flat, {Drive.YIELDING: solve_associated(flat, Drive.YIELDING)})
    analysis = LimitAnalysis(scene, flat, bounds, bounds, joint_stiffness(flat, flat.inset, scene.yade))
    (check,) = check_plane(analysis)
    assert check.verdict is Verdict.INCONCLUSIVE and "plane = false" in check.next_step


def forced_flat(scene: Scene) -> Assembly:
    """The plane model that `decide` refuses for this scene."""
    assembly = assemble(scene)
    assert not assembly.effects.plane
    flat = dataclasses.replace(assembly, effects=dataclasses.replace(assembly.effects, plane=True))
    return flat.with_inset(scene, scene.inset)


# --- everything on ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["arch_spreading", "wall_third", "slab_four_corners", "two_pads", "ferris_tin_loi_1"])
def test_the_full_model_has_every_effect_and_the_same_structure(name: str) -> None:
    scene = scenes.shipped(name)
    full = full_model(scene)
    assert full.name == f"{name}_full"
    assert full.effects.model_dump() == {
        "plane": False, "friction": "coulomb", "elasticity": "auto", "reach": False, "displacement": "finite", "recording": "states",
    }  # fmt: skip
    assert full.blocks.names == scene.blocks.names and full.weight == scene.weight
    assert full.path_asked == scene.path_asked and full.expected == scene.expected and full.yade == scene.yade


def test_effects_of_a_scene_give_way_to_the_full_model() -> None:
    plain = scenes.text(*scenes.wall(3, 2, 0.6), model="auto", plane=True, effects={"displacement": "small"})
    full = full_model(scenes.load(plain))
    assert full.effects.friction == "coulomb" and full.effects.displacement == "finite"
    for law in ("associated", "none-slides"):
        assert full_model(scenes.load(plain.replace('friction = "auto"', f'friction = "{law}"'))).effects.friction == law


def test_effects_that_are_no_table_of_their_own_are_replaced_too() -> None:
    inline = "effects = { plane = true }\n" + scenes.text(*scenes.wall(3, 2, 0.6)).replace("[effects]", "[yade]").replace(
        'plane = "auto"\nfriction = "associated"\nreach = "auto"', ""
    )
    plain = scenes.load(inline)
    assert plain.effects.plane is True
    full = full_model(plain)
    assert full.effects.plane is False and full.effects.friction == "coulomb"
    assert full.blocks.names == plain.blocks.names and full.weight == plain.weight


def test_a_structure_that_cannot_stand_is_infeasible_without_strain_too() -> None:
    falls = scenes.build(scenes.arch(11, 0.05), model="auto", settlement=(1.0, 0.0, 0.0), effects={"elasticity": "none"})
    assert analyse(falls).bounds[Drive.YIELDING].status is Status.INFEASIBLE
    assert decided_model(falls).assembly.effects.friction == "coulomb"


# --- what the user sees ------------------------------------------------------------------------------------------------------------


def test_every_effect_is_listed_with_its_reason_and_what_it_saves() -> None:
    scene = scenes.shipped("arch_spreading")
    analysis = analyse(scene)
    summary = effects_summary(scene, analysis.whole, analysis.assembly, analysis)
    assert [row["effect"] for row in summary["table"]] == list(EFFECTS)
    rows = {row["effect"]: row for row in summary["table"]}
    assert not rows["plane"]["on"] and not rows["friction"]["on"]
    in_space = assemble(dataclasses.replace(scene, effects=scene.effects.model_copy(update={"plane": False})))
    assert rows["plane"]["saved"]["contact points"] == len(in_space.points) - len(analysis.assembly.points)
    assert rows["plane"]["saved"]["unknowns"] == 3 * int(scene.blocks.free.sum())
    assert all(row["reason"] for row in summary["table"])


@every_shipped_scene
def test_every_shipped_scene_says_what_it_does_without_before_it_is_solved(name: str) -> None:
    scene = scenes.shipped(name)
    decided = decided_model(scene)
    summary = effects_summary(scene, decided.whole, decided.assembly)
    assert [row["effect"] for row in summary["table"]] == list(EFFECTS)
    for row in summary["table"]:
        assert row["reason"] and row["modelled"]
        assert bool(row["saved"]) == (not row["on"])
        assert all(count > 0 for count in row["saved"].values())


def test_settled_effects_come_back_from_the_file(tmp_path) -> None:
    scene = scenes.shipped("arch_spreading")
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "inputs")
    assert read_case(tmp_path / "case.h5", scene).assembly.effects == analysis.assembly.effects == decided_model(scene).assembly.effects
