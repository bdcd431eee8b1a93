"""The words of a verdict: one method alone is no agreement, a structure that cannot stand is named, and open results have a next step."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes
from runs import coulomb_run, perfect_run, with_answers, write_run

import la_core
from comparison.cli.exit_codes import CANNOT_STAND, EXIT_OF_VERDICT, INTERRUPTED, MEANINGS, SEVERITY
from comparison.judge.checks import run_checks
from comparison.judge.checks.answer import check_answer, check_expected
from comparison.judge.checks.run_checks import check_run
from comparison.judge.summary import comparison_summary, conclusion_of
from comparison.numbers import Units
from comparison.report.scene_view import view_of_scene
from comparison.verdict import VERDICTS, Check, Verdict, conclusion, inside, mark_of, named_blocks, stored_check
from comparison.yade import Results
from comparison.yade.run_record import read_run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.limit.associated import Status
from la_core.limit.problem import Drive

NEWTON = Units(1.0)  # units of a report on light structures


@pytest.fixture(scope="module")
def pads() -> LimitAnalysis:
    return analyse(scenes.shipped("two_pads"))


def summary_of(results: Results, yade: dict[str, Any] | None, checks: list[Check]) -> dict[str, Any]:
    return comparison_summary(results, yade, checks, [])


# --- one method alone -------------------------------------------------------------------------------------------------------------


def test_one_method_alone_meets_the_expected_value_and_agrees_with_nobody(pads: LimitAnalysis, tmp_path: Path) -> None:
    summary = summary_of(Results(pads), None, list(check_expected(pads)))
    assert summary["verdict"] == "expected" and "YADE was not run" in summary["reason"] and "--no-yade" in summary["next_step"]
    view = view_of_scene(tmp_path, 1, summary, NEWTON)
    assert (view["symbol"], view["word"]) == ("○", "expected value met (YADE not run)")
    words = [view["word"], view["sentence"], *(check["word"] for check in view["checks"]), *(str(value) for value in summary["checks"])]
    assert not [text for text in words if "agree" in text]
    assert {check["word"] for check in view["checks"]} == {"met"}


def test_one_method_alone_that_misses_the_expected_value_disagrees_with_nobody(pads: LimitAnalysis, tmp_path: Path) -> None:
    """Without YADE the verdict "unexpected" concerns the scene's value alone. With a result of YADE the verdict is a disagreement."""
    missed = [Check("expected reaction", Verdict.UNEXPECTED, reason="Another value was expected.", next_step="Look at its source.")]
    summary = summary_of(Results(pads), None, missed)
    assert (summary["verdict"], summary["reason"]) == ("unexpected", "Another value was expected.")
    assert summary["next_step"] == "Look at its source." and EXIT_OF_VERDICT["unexpected"] == EXIT_OF_VERDICT["disagree"] == 1
    view = view_of_scene(tmp_path, 1, summary, NEWTON)
    assert (view["symbol"], view["word"]) == ("⊗", "expected value not met (no result of YADE)")
    assert view["sentence"].startswith("Another value was expected.")
    assert {(check["symbol"], check["word"]) for check in view["checks"]} == {("✗", "not met")}


def test_an_expected_value_that_is_missed_counts_with_yade_and_without_it(pads: LimitAnalysis) -> None:
    """Agreement with YADE does not make up for a missed value. Without a result of YADE the verdict is "unexpected"."""
    missed = Check("expected reaction", Verdict.UNEXPECTED, reason="Another value was expected.", next_step="Look at its source.")
    good, bad = Check("reaction", Verdict.AGREE), Check("reaction", Verdict.DISAGREE, reason="YADE says more.")
    found = conclusion([missed, good], {"status": "plateau"})
    assert (found.verdict, found.reason, found.next_step) == (Verdict.DISAGREE, "Another value was expected.", "Look at its source.")
    assert conclusion([missed, bad], {"status": "plateau"}).reason == "Another value was expected. YADE says more."
    no_run = Check("YADE's run", Verdict.INCONCLUSIVE, reason="no program yade", next_step="Install YADE.")
    for status in ("missing", "failed", "timeout"):
        alone = conclusion([missed, no_run], {"status": status})
        assert (alone.verdict, alone.reason, alone.next_step) == (Verdict.UNEXPECTED, "Another value was expected.", "Look at its source.")
        assert conclusion([no_run], {"status": status}).verdict is Verdict.INCONCLUSIVE


def test_without_an_expected_value_nothing_was_compared(pads: LimitAnalysis) -> None:
    found = conclusion([], None)
    assert found.verdict is None and found.next_step == "" and mark_of(None) == "– not compared"
    assert conclusion([Check("accuracy of limit analysis", Verdict.AGREE)], None).verdict is None
    assert pads.scene.expected is not None


def test_with_both_methods_an_expected_value_that_is_met_is_part_of_their_agreement(pads: LimitAnalysis) -> None:
    checks = [*check_expected(pads), *check_run(Results(pads, perfect_run(pads)))]
    assert conclusion(checks, {"status": "plateau"}).verdict is Verdict.AGREE


# --- a structure that cannot stand ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("yade", "words"),
    [
        (None, "YADE was not run"),
        ({"status": "collapsed"}, "collapsed in YADE, too"),
        ({"status": "timeout"}, "ended as timeout."),
        ({"status": "failed", "message": "not at rest\nTraceback"}, "ended as failed: not at rest."),
    ],
)
def test_what_cannot_stand_says_so_with_the_blocks_that_fall(yade: dict[str, Any] | None, words: str) -> None:
    names = [f"block {number}" for number in range(8)]
    unfinished = [Check("YADE's run", Verdict.INCONCLUSIVE, reason="late")] if yade and yade["status"] == "timeout" else []
    found = conclusion(unfinished, yade, names)
    assert found.verdict is Verdict.CANNOT_STAND and found.next_step
    assert '"block 0"' in found.reason and "3 more blocks would fall" in found.reason and words in found.reason
    assert EXIT_OF_VERDICT[found.verdict] == CANNOT_STAND != 0


def test_one_more_block_is_told_in_the_singular() -> None:
    assert named_blocks([str(number) for number in range(6)]).endswith(" and 1 more block")


PIER_AND_PAD = (
    scenes.box("pier", (0.0, 0.0, -0.5), (1.0, 1.0, 0.0), "fixed"),
    scenes.box("pad", (2.0, 0.0, -0.5), (3.0, 1.0, 0.0), "support"),
    scenes.box("on the pier", (0.0, 0.0, 0.0), (0.5, 1.0, 0.5)),
    scenes.box("on the pad", (2.0, 0.0, 0.0), (3.0, 1.0, 0.5)),
)


def test_blocks_that_meet_the_rest_in_edges_only_fall_for_want_of_a_joint() -> None:
    """The lower of two stacked blocks meets the pier in an edge only. Each block has a joint, so the scene is not refused."""
    lower, upper = scenes.box("lower", (1.0, 0.0, 0.0), (1.5, 1.0, 0.5)), scenes.box("upper", (1.0, 0.0, 0.5), (1.5, 1.0, 1.0))
    found = conclusion_of(analyse(scenes.build(*PIER_AND_PAD, lower, upper)), [], None)
    assert found.verdict is Verdict.CANNOT_STAND
    words = 'would fall. No joint connects them with the ground or a support: "pier" is nearest to "lower" and meets it at most in an edge'
    assert words in found.reason


def test_what_falls_although_joints_connect_it_has_no_such_cause() -> None:
    found = conclusion_of(analyse(scenes.build(*PIER_AND_PAD, scenes.box("beam", (0.6, 0.0, 0.0), (1.8, 1.0, 0.2)))), [], None)
    assert found.verdict is Verdict.CANNOT_STAND and '"beam" would fall' in found.reason and "No joint" not in found.reason


@pytest.mark.parametrize("load", [(), (scenes.table("[load]", blocks=["arch 4"], force=(0.0, 0.0, -100.0)),)])
def test_an_arch_that_slips_out_of_its_joints_is_told_to_look_at_their_friction(load: tuple[str, ...]) -> None:
    """The arch has no gap and no missing support: it stands with ten times the friction."""
    slippery, rough = (analyse(scenes.build(scenes.arch(7, 0.3), *load, friction=friction)) for friction in (0.06, 0.6))
    assert conclusion_of(rough, [], None).verdict is not Verdict.CANNOT_STAND
    found = conclusion_of(slippery, [], None)
    assert found.verdict is Verdict.CANNOT_STAND and "too little friction" in found.next_step


def test_an_arch_in_which_no_line_of_thrust_fits_is_told_that_it_may_be_too_thin() -> None:
    """Friction and supports are sufficient: an arch 0.3 m thick stands with them."""
    thin, thick = (analyse(scenes.build(scenes.arch(13, thickness), friction=1.0)) for thickness in (0.1, 0.3))
    assert conclusion_of(thick, [], None).verdict is not Verdict.CANNOT_STAND
    found = conclusion_of(thin, [], None)
    assert found.verdict is Verdict.CANNOT_STAND and "is too thin or needs more support" in found.next_step


@pytest.mark.parametrize(("shift", "verdict"), [(0.1999, Verdict.CANNOT_STAND), (0.205, Verdict.CANNOT_STAND), (0.21, Verdict.DISAGREE)])
def test_what_falls_slowly_may_still_stand_at_the_end_of_yades_run(shift: float, verdict: Verdict) -> None:
    """A corbel of five stones falls if each stone is shifted by more than 1/5 of its length less two insets, 0.1996 m."""
    stones = [scenes.box(f"stone {k}", (k * shift, 0.0, 0.3 * k), (1.0 + k * shift, 1.0, 0.3 * k + 0.3)) for k in range(5)]
    analysis = analyse(scenes.build(scenes.box("pad", (0.0, 0.0, -0.5), (1.0, 1.0, 0.0), "support"), *stones, inset=1e-3))
    stood = perfect_run(analysis, reaction=analysis.assembly.weight)
    found = conclusion_of(analysis, check_run(Results(analysis, stood)), {"status": "plateau", "message": "steady"})
    assert found.verdict is verdict
    assert ("ended before the fall" in found.reason) is (verdict is Verdict.CANNOT_STAND)
    assert '"stone 1", "stone 2", "stone 3", "stone 4" would fall' in found.reason


def test_how_fast_a_structure_falls_is_not_asked_where_it_fell_in_yade_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """The speed of the fall needs an optimisation of the whole structure and would not change this verdict."""
    analysis = analyse(scenes.build(*PIER_AND_PAD, scenes.box("beam", (0.6, 0.0, 0.0), (1.8, 1.0, 0.2))))
    asked: list[Any] = []
    monkeypatch.setattr(run_checks, "falls_slowly", asked.append)
    verdicts = [check_run(Results(analysis, perfect_run(analysis, status=status)))[0].verdict for status in ("collapsed", "plateau")]
    assert verdicts == [Verdict.AGREE, Verdict.DISAGREE]
    assert len(asked) == 1


def test_a_structure_that_stands_in_yade_although_it_cannot_is_a_disagreement() -> None:
    found = conclusion([Check("the structure stands", Verdict.DISAGREE, reason="it stands")], {"status": "plateau"}, ["block"])
    assert found.verdict is Verdict.DISAGREE and found.next_step


# --- what to do next --------------------------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def wall() -> LimitAnalysis:
    return analyse(scenes.shipped("wall_third"))


def open_checks(pads: LimitAnalysis, wall: LimitAnalysis) -> list[list[Check]]:
    """Return the checks of several results that do not agree, one list for each result."""
    assert wall.coulomb is not None
    value, moving = wall.coulomb.value, perfect_run(pads)
    moving.poses.forces[:, 0] += pads.assembly.mean_weight
    unsolved = dataclasses.replace(pads.bounds[Drive.YIELDING], status=Status.INACCURATE)
    wrong = [
        Results(pads, perfect_run(pads, status=status, reaction=math.nan)) for status in ("timeout", "failed", "no plateau", "collapsed")
    ]
    wrong += [
        Results(pads, moving),
        Results(pads, perfect_run(pads, reaction=0.5 * pads.bounds[Drive.YIELDING].value)),
        Results(pads, perfect_run(pads, settlement=0.0)),
        Results(pads, perfect_run(pads, uncertainty=math.nan)),
        Results(with_answers(pads, bounds={**pads.bounds, Drive.YIELDING: unsolved}), perfect_run(pads)),
        Results(wall, coulomb_run(wall, reaction=1.1 * value)),
        Results(wall, coulomb_run(wall, reaction=1.02 * value, uncertainty=0.1 * value)),
    ]
    for changes in ({"uncertainty": value}, {"plateaus": np.array([value, 2.0 * value])}, {"status": Status.INACCURATE}):
        other = with_answers(wall, coulomb=dataclasses.replace(wall.coulomb, **changes))  # type: ignore[arg-type]
        wrong.append(Results(other, coulomb_run(wall, reaction=1.2 * value)))
    return [check_run(results) for results in wrong]


def test_everything_that_stays_open_has_a_reason_and_a_next_step(pads: LimitAnalysis, wall: LimitAnalysis) -> None:
    for checks in open_checks(pads, wall):
        found = conclusion(checks, {"status": "plateau"})
        assert found.verdict in (Verdict.INCONCLUSIVE, Verdict.DISAGREE), checks
        assert found.reason and found.next_step and not found.next_step.startswith(found.reason)


def test_the_next_step_reaches_json_and_report(wall: LimitAnalysis, tmp_path: Path) -> None:
    assert wall.coulomb is not None
    run = coulomb_run(wall, reaction=1.02 * wall.coulomb.value, uncertainty=0.1 * wall.coulomb.value)
    summary = summary_of(Results(wall, run), {"status": "plateau"}, check_run(Results(wall, run)))
    assert "--try-harder" in summary["next_step"]
    assert view_of_scene(tmp_path, 1, summary, NEWTON)["next_step"] == summary["next_step"]
    assert summary["curves"] is not None and summary["remarks"] == []


def test_a_remark_of_an_agreement_is_shown(wall: LimitAnalysis, tmp_path: Path) -> None:
    run = coulomb_run(wall, scatter=0.02)
    summary = summary_of(Results(wall, run), {"status": "plateau"}, check_run(Results(wall, run)))
    assert summary["verdict"] == "agree" and summary["reason"] == "" and "Stick-slip" in summary["remarks"][0]
    assert "Stick-slip" in view_of_scene(tmp_path, 1, summary, NEWTON)["sentence"]


# --- ranges, plateaus, words ------------------------------------------------------------------------------------------------------


def test_a_range_check_is_shown_as_a_range_and_its_difference_is_the_distance_beyond(wall: LimitAnalysis, tmp_path: Path) -> None:
    low, high = inside("r", (1.0, 3.0), 2.0, 0.1, "N", "no"), inside("r", (1.0, math.inf), 0.5, 0.1, "N", "no")
    assert (low.verdict, low.difference, low.range) == (Verdict.AGREE, 0.0, (1.0, 3.0))
    assert (high.verdict, high.difference, high.range) == (Verdict.DISAGREE, -0.5, (1.0, None))
    assert all(stored_check(dataclasses.asdict(check)) == check for check in (low, high))
    run = coulomb_run(wall)
    view = view_of_scene(tmp_path, 1, summary_of(Results(wall, run), {"status": "plateau"}, check_run(Results(wall, run))), NEWTON)
    shown = {check["name"]: check for check in view["checks"]}
    ranged = [check for name, check in shown.items() if "range" in name or "interval" in name or "bounds" in name]
    assert len(ranged) >= 3
    for check in ranged:
        assert " to " in check["range"] and check["difference"] == "0"


@pytest.mark.parametrize("status", ["no plateau", "timeout", "collapsed"])
def test_without_a_plateau_no_value_of_one_is_read_from_a_file(pads: LimitAnalysis, status: str, tmp_path: Path) -> None:
    write_run(tmp_path / "run.h5", perfect_run(pads, status=status), "inputs")
    run = read_run(tmp_path / "run.h5", pads.assembly)
    assert np.isnan([run.reaction, run.uncertainty, run.result.slope]).all()
    write_run(tmp_path / "run.h5", perfect_run(pads), "inputs")
    assert math.isfinite(read_run(tmp_path / "run.h5", pads.assembly).reaction)


def test_every_verdict_has_words_an_exit_code_and_every_exit_code_a_meaning() -> None:
    verdicts = [*Verdict, None]
    assert set(VERDICTS) == set(verdicts) == set(EXIT_OF_VERDICT)
    assert len({mark_of(verdict) for verdict in verdicts}) == len({mark_of(verdict)[0] for verdict in verdicts}) == len(verdicts)
    assert set(MEANINGS) == {*SEVERITY, 2, INTERRUPTED}
    page = (Path(__file__).parents[2] / "comparison" / "cli" / "README.md").read_text(encoding="utf-8")
    for code, meaning in MEANINGS.items():
        assert f"| {code} | {meaning} |" in page


# --- varied scenes ----------------------------------------------------------------------------------------------------------------


def test_a_varied_structure_loses_source_and_expected_value_that_spoke_of_another_one() -> None:
    arch = la_core.load("arch_spreading")
    assert arch.source and arch.expected is not None
    other = la_core.variant(arch, {"arch[0].voussoirs": 12})
    assert other.source == "" and other.expected is None
    named = la_core.variant(arch, {"arch[0].voussoirs": 12, "source": "own calculation"})
    assert named.source == "own calculation" and named.expected is None
    for settings in ({"yade.speed": 0.01}, {"accuracy": 0.01}, {"effort": "high"}, {"title": "other words"}):
        same = la_core.variant(arch, settings)
        assert same.source == arch.source and same.expected == arch.expected


def test_remarks_say_nothing_twice() -> None:
    checks = [Check(name, Verdict.AGREE, reason=f"The {name} differ. It need not be unique.") for name in ("mechanisms", "moving blocks")]
    assert conclusion([*checks, *checks], {"status": "plateau"}).remarks == (
        "The mechanisms differ. It need not be unique.",
        "The moving blocks differ.",
    )


def test_blocks_that_slide_although_a_thrust_could_hold_them_need_a_thrust_or_another_one() -> None:
    for wedged, words in ((True, "Change its size"), (False, "Give the blocks a thrust")):
        arch = la_core.variant("flat_arch", {"joint.friction": 0.4} | ({} if wedged else {"yade.wedging": None}))
        analysis = analyse(arch)
        if wedged:
            (check,) = check_answer(analysis)
            assert check.verdict is Verdict.INCONCLUSIVE and "the blocks slide and fall" in check.reason and words in check.next_step
        run = perfect_run(analysis)
        fallen = dataclasses.replace(run, result=dataclasses.replace(run.result, status="collapsed"))
        (check,) = check_run(Results(analysis, fallen))
        assert check.verdict is Verdict.INCONCLUSIVE and words in check.next_step
        assert (
            check.reason.startswith("In both methods the blocks slide and fall, ")
            and "no plateau, and it collapsed in YADE" in check.reason
        )


def test_blocks_that_stood_at_rest_and_fell_while_the_support_moved_need_no_thrust() -> None:
    analysis = analyse(la_core.load("wall_third"))
    run = perfect_run(analysis)
    for settlement, words in ((run.result.settlement, "Run YADE more slowly"), (0.0, "Give the blocks a thrust")):
        fallen = dataclasses.replace(run, result=dataclasses.replace(run.result, status="collapsed", settlement=settlement))
        (check,) = (check for check in check_run(Results(analysis, fallen)) if check.name == "the structure stands")
        assert check.verdict is Verdict.INCONCLUSIVE and words in check.next_step
        assert ("thrust" in check.reason) == ("thrust" in words) and ("stood at rest" in check.reason) == (settlement > 0.0)
    pushed = dataclasses.replace(analysis, scene=dataclasses.replace(analysis.scene, live=(1.0, 0.0, 0.0)))
    fallen = dataclasses.replace(run, result=dataclasses.replace(run.result, status="collapsed"))
    (check,) = (check for check in check_run(Results(pushed, fallen)) if check.name == "the structure stands")
    assert check.next_step.startswith("Look for a block that slides out")


@pytest.mark.parametrize(("edge", "words"), [(0.501, "With sharp edges the multiplier is 0.004"), (0.6, "own step")])
def test_where_no_load_is_borne_the_next_step_says_so(edge: float, words: str) -> None:
    """At the inset the weight acts on the edge of the joint, so the block bears no load. On a longer base it bears one."""
    base = scenes.box("base", (-1.0, 0.0, -0.2), (edge, 0.2, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5))
    analysis = analyse(scenes.build(base, block, inset=1e-3, live=(1.0, 0.0, 0.0)))
    checks = [Check("plateau", Verdict.INCONCLUSIVE, reason="not steady", next_step="own step")]
    found = conclusion_of(analysis, checks, {"status": "no plateau"}).next_step
    assert words in found and ("bears none of it" in found) == (edge == 0.501)
    assert conclusion_of(analysis, checks, {"status": "missing"}).next_step == "own step"
