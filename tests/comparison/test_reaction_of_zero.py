"""Where only the support moves, reactions of zero agree, and noise counts neither as motion nor as energy."""

import dataclasses
from pathlib import Path

import numpy as np
import pytest
import scenes
from judged_runs import REACTION, SIMILARITY, judged, named
from made_up_comparisons import comparison_of, page_and_markdown
from runs import made_up_run, perfect_run

from comparison.judge.checks import energy
from comparison.verdict.check import Verdict, overall
from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.problem import Drive
from la_core.measures import mechanism


def leaving(blocks: int) -> LimitAnalysis:
    """Return a stack of blocks that stands on the ground without the settling pad: only the pad moves."""
    stack = [scenes.box(f"block {i}", (0.0, 0.0, 0.4 * i), (1.2, 0.2, 0.4 * (i + 1))) for i in range(blocks)]
    ground = scenes.box("ground", (0.0, 0.0, -0.1), (1.0, 0.2, 0.0), "fixed")
    pad = scenes.box("pad", (1.0, 0.0, -0.1), (1.2, 0.2, 0.0), "support")
    return analyse(scenes.build(ground, pad, *stack, inset=1e-3))


def with_noise(analysis: LimitAnalysis, run: Run, size: float) -> Run:
    """Return the run with random displacements of its blocks, of this share of the settlement."""
    trembling = np.random.default_rng(17).standard_normal(run.poses.displacement.shape[1:]) * analysis.assembly.blocks.free[:, None]
    displacement = run.poses.displacement + size * run.poses.settlement[:, None, None] * trembling
    return dataclasses.replace(run, poses=dataclasses.replace(run.poses, displacement=displacement))


@pytest.mark.parametrize("blocks", [1, 2, 4])
@pytest.mark.parametrize("noise", [0.0, 1e-9, 1e-4, 5e-3])
def test_two_reactions_of_zero_agree_whatever_trembles(blocks: int, noise: float) -> None:
    analysis = leaving(blocks)
    assert analysis.bounds[Drive.YIELDING].value == pytest.approx(0.0, abs=1e-6 * analysis.scene.weight)
    run = perfect_run(analysis, reaction=2e-6 * analysis.scene.weight, uncertainty=3e-6 * analysis.scene.weight)
    found = judged(analysis, with_noise(analysis, run, noise))
    assert overall(found)[0] is Verdict.AGREE, [check for check in found if check.verdict is not Verdict.AGREE]


@pytest.mark.parametrize(
    ("reaction", "uncertainty", "verdict"),
    [
        (5e-5, 1e-6, Verdict.INCONCLUSIVE),  # certainly not 0, but within the least tolerance of 1e-4
        (5e-5, 6e-5, Verdict.AGREE),
        (5e-7, 0.0, Verdict.INCONCLUSIVE),
        (5e-9, 0.0, Verdict.AGREE),  # shown as 0
    ],
)
def test_small_reactions_that_certainly_differ_do_not_agree(reaction: float, uncertainty: float, verdict: Verdict) -> None:
    """A doorstep beside a long wall carried 64 N, and any reaction from 0 to 230 N *agreed*. reaction, uncertainty: over the weight."""
    analysis = leaving(2)
    weight = analysis.scene.weight
    run = perfect_run(analysis, reaction=reaction * weight, uncertainty=uncertainty * weight)
    check = named(REACTION, judged(analysis, run))
    assert check.verdict is verdict
    assert ("because both are small" in check.reason and "part near the support" in check.next_step) is (verdict is Verdict.INCONCLUSIVE)


def test_noise_is_no_motion_where_the_support_leaves_alone() -> None:
    analysis = leaving(2)
    run = with_noise(analysis, perfect_run(analysis), 5e-3)
    assert not mechanism.moving(analysis.assembly, run.mechanism()).any()
    # The reason does not say "moves away": the support may also slide under a block that stays and presses on it.
    assert named(SIMILARITY, judged(analysis, run)).reason.startswith("No block moves in either method: only the support moves.")


@pytest.mark.parametrize(("least", "verdict"), [(energy.LEAST_TURNOVER, Verdict.AGREE), (0.0, Verdict.INCONCLUSIVE)])
def test_energy_that_hardly_anything_turned_over_is_noise(least: float, verdict: Verdict, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(energy, "LEAST_TURNOVER", least)
    analysis = leaving(2)
    run = with_noise(analysis, perfect_run(analysis), 1e-3)
    record = {name: np.zeros(5) for name in ("kinetic_energy", "reaction")} | {"settlement": run.poses.settlement}
    stiffness = {"normal_stiffness": analysis.stiffness.normal, "shear_stiffness": analysis.stiffness.shear}
    recorded = made_up_run(record=record | {"stage": np.array([0, 1, 1, 1, 1])}).record
    forces = np.array([1.0, 1.5, 1.5, 1.5, 1.5])[:, None, None] * run.poses.forces  # not in balance: the energies do not add up
    run = dataclasses.replace(run, record=recorded, poses=dataclasses.replace(run.poses, forces=forces), settings=stiffness)
    (check,) = energy.check_energy(analysis.assembly, run)
    assert check.verdict is verdict


def test_a_block_that_moves_in_yade_alone_is_no_noise() -> None:
    analysis = leaving(2)
    run = with_noise(analysis, perfect_run(analysis), 0.5)
    assert overall(judged(analysis, run))[0] is Verdict.DISAGREE


def test_a_reaction_of_zero_that_is_not_zero_in_yade_disagrees() -> None:
    analysis = leaving(2)
    run = perfect_run(analysis, reaction=1e-3 * analysis.scene.weight)
    check = named(REACTION, judged(analysis, run))
    assert check.verdict is Verdict.DISAGREE
    assert "%" not in check.reason, "a share of nothing"


def test_a_reaction_of_zero_is_0_wherever_a_report_states_it(tmp_path: Path) -> None:
    """The bound of a dome was 0 kN in the table of values, but 2.0397e-8 kN, 7.4132e-10 kN and 1.36507e-11 of W elsewhere."""
    comparison = comparison_of(expected={"associated_reaction_over_weight": 0.0, "tolerance": 1e-6, "kind": "exact"})
    comparison["limit_analysis"]["associated"] |= {"reaction": 2.0397e-5, "reaction_sharp": 7.4132e-7}
    numbers = {"limit_analysis": 2.0397e-5, "yade": 363.5, "difference": 0.0, "tolerance": 3.6, "range": [2.0397e-5, 2153.9]}
    comparison["checks"] = [{"name": "reaction within bounds", "verdict": "agree", "unit": "N", "reason": ""} | numbers]
    page, markdown = page_and_markdown(tmp_path, comparison)
    for text in (page, markdown):
        assert "does not change the associated reaction, 0 kN." in text and "0 to 2.1539" in text
        assert "2.0397e" not in text and "7.4132e" not in text and "3.435" not in text
