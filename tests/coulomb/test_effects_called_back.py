"""An effect that was left out is restored where a run of YADE shows it to be needed."""

from conftest import Silent

from comparison.judge.checks import prediction
from comparison.verdict.check import Check, Verdict
from comparison.workflow import one_scene, restored_effects
from comparison.yade import Results
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.result import LimitAnalysis


def test_friction_comes_back_when_joints_slide_in_yade(tmp_path, monkeypatch, cross_checked) -> None:
    """Joints slide in YADE's run although limit analysis found none that slides. Limit analysis is then repeated with friction."""
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
    """The joints of a wall slide in YADE's run, while its limit analysis left friction out."""
    found = cross_checked("wall_third")
    assembly = found.analysis.assembly
    wrong = found.analysis.with_effects(assembly.effects.with_effect("friction", "none-slides", "made up"))
    assert prediction.slides_unforeseen(Results(wrong, found.run))
    assert 'Set friction = "coulomb"' in prediction.predicted(Results(wrong, found.run)).next_step
    arch_run = cross_checked("arch_spreading")
    assert not prediction.slides_unforeseen(Results(arch_run.analysis, arch_run.run))


def test_a_region_and_small_displacements_that_yade_does_not_bear_out_are_given_up(tmp_path, monkeypatch, cross_checked) -> None:
    """Both guards are made to complain. The whole structure is then modelled with finite displacements, for the reasons they gave."""
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


def test_a_structure_whose_motion_in_space_came_back_is_read_again(tmp_path, monkeypatch, cross_checked) -> None:
    """The scene alone would be modelled in the plane, so that reports and exports took its file for that of another scene."""
    found = cross_checked("arch_spreading")
    assert found.analysis.assembly.effects.plane
    complaint = [Check("plane answer in space", Verdict.INCONCLUSIVE, reason="made up for plane")]
    monkeypatch.setattr(restored_effects, "check_plane", lambda analysis: complaint if analysis.assembly.effects.plane else [])
    again = restored_effects.restore(Results(found.analysis, found.run))
    assert again is not None and again.assembly.effects.called_back == ("plane",) and not again.assembly.effects.plane
    write_case(tmp_path / "case.h5", again, "")
    back = read_case(tmp_path / "case.h5", found.scene)
    assert len(back.assembly.points) == len(again.assembly.points) > len(found.analysis.assembly.points)
    assert back.assembly.effects == again.assembly.effects and back.main_answer.value == again.main_answer.value
