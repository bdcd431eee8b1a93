"""Small or finite displacements: limit analysis chooses by the gaps between blocks, and a guard judges the run by them."""

import numpy as np
import pytest
import scenes
from displaced_blocks import GAP, TEXTS, TRAVEL, buffer, decided, with_effects
from runs import made_up_run

from comparison.judge.checks.reduced_model import check_displacement, largest_displacements
from comparison.verdict.check import Verdict
from comparison.yade import Results
from comparison.yade.run_record import Run
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.model import dem_effects
from la_core.model.assembly import Assembly, assemble

# --- displacement: the choice ----------------------------------------------------------------------------------------------------


def test_auto_takes_finite_displacements_where_blocks_may_meet_and_names_them() -> None:
    effects, gap = decided(with_effects(buffer()))
    assert effects.displacement == "finite"
    assert 'blocks "block" and "stop" are 0.0002 m apart without a joint' in effects.reasons["displacement"]
    assert gap == pytest.approx(GAP, rel=1e-9)


def test_small_displacements_asked_for_where_blocks_may_meet_are_refused_with_their_names() -> None:
    with pytest.raises(SceneError, match=r'effects.displacement = \'small\': blocks "block" and "stop" are 0.0002 m apart.*"finite"'):
        decided(with_effects(buffer(), displacement="small"))


def test_small_displacements_asked_for_say_so_and_why_they_may_be() -> None:
    effects, gap = decided(with_effects(TEXTS["arch"], displacement="small"))
    assert effects.reasons["displacement"].startswith("requested in the scene, and blocks without a joint")
    assert f"{gap:.3g} m apart" in effects.reasons["displacement"]


def test_finite_displacements_are_always_allowed() -> None:
    for text in (*TEXTS.values(), buffer()):
        effects, gap = decided(with_effects(text, displacement="finite"))
        assert effects.displacement == "finite" and effects.reasons["displacement"] == "requested in the scene" and np.isnan(gap)


@pytest.mark.parametrize(("share", "choice"), [(0.99, "finite"), (1.01, "small")])
def test_the_choice_turns_at_the_reach_of_the_motion(share: float, choice: str) -> None:
    effects, _ = decided(with_effects(buffer(gap=share * dem_effects.GAP_OVER_TRAVEL * TRAVEL)))
    assert effects.displacement == choice


@pytest.mark.parametrize("name", ["arch_spreading", "vault_spreading", "rubble_wall", "two_pads", "slab_four_corners"])
def test_arches_and_vaults_whose_bounding_boxes_overlap_come_out_small_in_any_position(name: str) -> None:
    scene = scenes.shipped(name)
    turn = scenes.rotation((1.0, 2.0, -0.5), 0.7)
    for one in (scene, scenes.moved(scene, turn, shift=(3.0, -2.0, 1.0), plane=False)):
        assert decided(one)[0].displacement == "small"


def test_two_held_blocks_and_blocks_with_a_joint_do_not_count() -> None:
    """The halves of the base meet in an upright face. Every other pair of blocks within reach shares a joint."""
    effects, _ = decided(scenes.build(*scenes.wall(2, 1, split=0.3), inset=0.001))
    assert effects.displacement == "small"


@pytest.mark.parametrize("seed", range(3))
def test_the_least_gap_is_never_more_than_the_distance_of_any_two_blocks(seed: int) -> None:
    """Turned boxes stand over a floor. The distance of random points of two boxes is an upper bound of the distance of the boxes."""
    chance = np.random.default_rng(seed)
    box = np.array([(x, y, z) for x in (0.0, 0.2) for y in (0.0, 0.2) for z in (0.0, 0.2)])
    free = [box @ scenes.rotation((0.0, 0.0, 1.0), chance.uniform(0.0, 1.5)).T + (0.5 * k, chance.uniform(0.0, 0.1), 0.0) for k in range(4)]
    parts = [scenes.block(f"block {k}", polyhedron=vertices) for k, vertices in enumerate(free)]
    scene = scenes.build(scenes.box("floor", (-2.0, -2.0, -0.2), (4.0, 2.0, 0.0), "support"), *parts, inset=0.001, plane=False)
    gap, pair = dem_effects.least_gap(assemble(scene), 10.0)
    shares = chance.dirichlet(np.full(8, 0.2), 500)
    apart = [np.linalg.norm((shares @ a)[:, None] - (shares @ b)[None], axis=2).min() for k, a in enumerate(free) for b in free[k + 1 :]]
    assert pair is not None and 0.0 < gap <= min(apart)


# --- recording ----------------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("poses", "choice"), [(833_332, "states"), (833_333, "plateau")])
def test_states_are_stored_up_to_200_megabytes(poses: int, choice: str) -> None:
    """A state of 3 blocks and 4 contact points is 30 numbers of 8 bytes; the state at rest comes before the others."""
    text = TEXTS["two_pads"] + scenes.table("yade", poses=poses) + "\n"
    effects, _ = decided(with_effects(text))
    assert effects.recording == choice and f"{poses + 1} states take 200 MB" in effects.reasons["recording"]
    for asked in ("states", "plateau"):
        assert decided(with_effects(text, recording=asked))[0].recording == asked


# --- displacement: the guard ------------------------------------------------------------------------------------------------------


def made_up(assembly: Assembly, shift: float, turn: float) -> Run:
    """A run whose second block moves by `shift` (m) along x and turns by `turn` (rad) about y."""
    displacement, rotation = np.zeros((2, len(assembly.blocks), 3)), np.zeros((2, len(assembly.blocks), 3))
    displacement[1, 1, 0], rotation[1, 1, 1] = shift, turn
    return made_up_run(poses={"displacement": displacement, "rotation": rotation})


@pytest.mark.parametrize(("share", "expected"), [(0.99, Verdict.AGREE), (1.01, Verdict.INCONCLUSIVE)])
def test_a_run_that_moved_its_blocks_by_half_the_least_gap_decides_nothing(share: float, expected: Verdict) -> None:
    analysis = analyse(with_effects(TEXTS["arch"], displacement="small"))
    limit = 0.5 * analysis.least_gap
    (check,) = check_displacement(Results(analysis, made_up(analysis.assembly, share * limit, 0.0)))
    assert check.verdict is expected
    if expected is Verdict.INCONCLUSIVE:
        assert analysis.assembly.blocks.names[1] in check.reason and 'displacement = "finite"' in check.next_step


def test_a_turn_counts_with_the_size_of_its_block() -> None:
    """The bound is at least the exact displacement of every vertex, and at most the longest arm times the turn."""
    assembly = assemble(scenes.shipped("arch_spreading"))
    blocks, turn = assembly.blocks, 1e-3
    vertices = blocks.vertices[blocks.vertex_start[1] : blocks.vertex_start[2]] - blocks.centroid[1]
    exact = np.linalg.norm(vertices @ (scenes.rotation((0.0, 1.0, 0.0), turn) - np.eye(3)).T, axis=1).max()
    bound = largest_displacements(blocks, made_up(assembly, 0.0, turn))
    assert exact <= bound[1] <= np.linalg.norm(vertices, axis=1).max() * turn * (1.0 + 1e-12)
    assert not bound[[0, *range(2, len(blocks))]].any()


def test_a_displacement_is_the_largest_of_all_states_a_shift_and_a_turn_together() -> None:
    """Half diagonals of 0.65 m and 0.15 m; the first block moves most on the way, the second one at the end."""
    floor = scenes.box("floor", (-1.0, -1.0, -0.1), (9.0, 2.0, 0.0), "support")
    boxes = scenes.box("large", (0.0, 0.0, 0.0), (0.3, 0.4, 1.2)), scenes.box("small", (5.0, 0.0, 0.0), (5.2, 0.2, 0.1))
    blocks = assemble(scenes.build(*boxes, floor)).blocks
    displacement, rotation = np.zeros((3, 3, 3)), np.zeros((3, 3, 3))
    displacement[:, 0], rotation[:, 0] = np.outer([0.0, 1.0, 0.5], [0.003, 0.0, -0.004]), np.outer([0.0, 1.0, 0.5], [0.0, 0.002, 0.0])
    displacement[2, 1], rotation[2, 1] = [0.0, 0.001, 0.0], [0.004, 0.0, -0.003]
    run = made_up_run(poses={"displacement": displacement, "rotation": rotation})
    assert largest_displacements(blocks, run) == pytest.approx([0.005 + 0.65 * 0.002, 0.001 + 0.15 * 0.005, 0.0])


def test_a_run_that_stored_no_state_is_not_judged_by_its_displacements() -> None:
    analysis = analyse(with_effects(TEXTS["two_pads"], displacement="small"))
    none = made_up_run(poses={name: np.zeros((0, len(analysis.assembly.blocks), 3)) for name in ("displacement", "rotation")})
    assert list(check_displacement(Results(analysis, none))) == []


def test_an_undefined_displacement_decides_nothing() -> None:
    analysis = analyse(with_effects(TEXTS["two_pads"], displacement="small"))
    (check,) = check_displacement(Results(analysis, made_up(analysis.assembly, np.nan, 0.0)))
    assert check.verdict is Verdict.INCONCLUSIVE
