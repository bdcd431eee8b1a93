"""The random scenes of the second opinion follow from their seed and vary as stated. Their page counts the recorded verdicts."""

import json
import math
from collections import Counter
from pathlib import Path
from typing import Any

import benchmark_verdicts
import generated_scenes
import pytest
import unusual_scenes
from benchmark_verdicts import apart, moved, numbers, page, values
from judged_runs import REACTION
from verdict_scenes import FRICTION, KINDS, LEAST_BLOCKS, MOST_BLOCKS, MOTIONS, SCENES, SEED, drawn

from la_core.model import assemble
from la_core.scene import Scene

RECORDS = sorted(benchmark_verdicts.GALLERY.glob("*verdicts.json"))


@pytest.mark.parametrize("number", [0, 21, 42, 63, 84, 119])
def test_a_scene_follows_from_its_number_alone(number: int) -> None:
    first, second = drawn(number), drawn(number)
    assert first.scene.text == second.scene.text and first.scene.text != drawn(number + 15).scene.text
    assert LEAST_BLOCKS <= int(first.scene.blocks.free.sum()) <= MOST_BLOCKS
    assert FRICTION[0] <= first.scene.friction <= FRICTION[1]
    assert assemble(first.scene).support_speed > 0.0


@pytest.mark.parametrize("number", range(0, 120, 13))
def test_a_generated_scene_follows_from_its_number_alone_and_is_what_it_is_called(number: int) -> None:
    first = generated_scenes.drawn(number)
    assert first.scene.text == generated_scenes.drawn(number).scene.text != generated_scenes.drawn(number, seed=1).scene.text
    assert generated_scenes.LEAST_BLOCKS <= int(first.scene.blocks.free.sum()) <= generated_scenes.MOST_BLOCKS
    assert first.kind.startswith("pushed") == (first.scene.live is not None)
    assert assemble(first.scene).effects.plane == (first.kind not in ("vault", "dome", "corner", "pushed corner"))


def test_an_unusual_scene_follows_from_its_number_alone_and_is_unlike_the_generated_one() -> None:
    scenes = [unusual_scenes.drawn(number).scene for number in range(10)]
    assert [scene.text for scene in scenes] == [unusual_scenes.drawn(number).scene.text for number in range(10)]
    changed = {
        "gravity": [scene.gravity.tolist() != [0.0, 0.0, -9.81] for scene in scenes],
        "inset": [scene.inset != 1e-3 for scene in scenes],
        "effects": [bool(scene.effects.model_fields_set) for scene in scenes],
    }
    assert all(any(of_scenes) and not all(of_scenes) for of_scenes in changed.values())


def test_kinds_and_motions_are_shared_evenly() -> None:
    met = Counter((KINDS[number % len(KINDS)], MOTIONS[number // len(KINDS) % len(MOTIONS)]) for number in range(SCENES))
    assert len(met) == len(KINDS) * len(MOTIONS) and max(met.values()) - min(met.values()) <= 1
    assert [(drawn(n).kind, drawn(n).motion) for n in (3, 9)] == [("lintel", "down"), ("two leaves", "oblique")]
    assert numbers("3,17,40-42,3,900") == [3, 17, 40, 41, 42]


def entry(number: int, verdict: str, yade: float | None, again: float | None = None) -> dict[str, Any]:
    values = {
        "coulomb": 0.1, "coulomb_uncertainty": 1e-4, "yade": yade, "yade_uncertainty": 1e-4, "verdict": verdict, "reason": f"why {number}",
        "next_step": "look", "free_blocks": 12, "unit": "N", "yade_status": "plateau", "seconds": 2.0,
    }  # fmt: skip
    second = {"again": values | {"yade": again}} if again is not None else {}
    return {"number": number, "kind": "wall", "motion": "down", "friction": 0.5} | values | second


def test_the_page_counts_what_moved_and_what_stays_open(monkeypatch: pytest.MonkeyPatch) -> None:
    entries = [entry(0, "agree", 0.1, 0.10005), entry(1, "agree", 0.1, 0.1003), entry(2, "inconclusive", 0.1003), entry(3, "disagree", 0.2)]
    assert moved(entries[0]) == pytest.approx(0.5) and moved(entries[1]) == pytest.approx(3.0) and moved(entries[2]) is None
    between = entry(5, "agree", 0.1, 0.10012)  # beyond the first run's uncertainty, within that of both runs
    assert moved(between) == pytest.approx(1.2) and moved(between, of_both=True) == pytest.approx(1.2 / math.sqrt(2.0))
    nothing = entry(4, "agree", 0.0, 0.0) | {"yade_uncertainty": 0.0}
    assert moved(nothing) == 0.0 and moved(nothing | {"again": nothing | {"yade": 1e-9}}) == math.inf
    monkeypatch.setattr(benchmark_verdicts, "SEEN", frozenset((1, 2)))
    record = {"seed": SEED, "versions": {"python": "3"}, "scenes": {str(one["number"]): one for one in entries}}
    text = page(json.loads(json.dumps(record)))
    assert "4 of 200 scenes: 2 agree, 1 inconclusive, 1 disagree." in text and "50.0% agree" in text
    assert "prove little: 1, 2. Without these 1 of 2 agree." in text and "Without these" not in page(record | {"seed": 1})
    assert "Inconclusive although the reactions agree within 0.5%: 1." in text
    assert (
        "Scenes whose reaction moves by more than the first run states: 1." in text
        and "In 1 of them" in text
        and "In 1 it moves by more than both runs state" in text
    )
    assert "at most 1%, 0 of them" in text
    assert "why 2" in text and "why 3" in text and "why 0" not in text


def test_a_page_without_second_runs_does_not_speak_of_them() -> None:
    entries = [entry(0, "agree", 0.1), entry(1, "disagree", 0.2)]
    text = page({"seed": 7, "versions": {"python": "3"}, "scenes": {str(one["number"]): one for one in entries}})
    assert (
        text.startswith("# A second opinion on the verdicts, seed 7\n")
        and "Agreements were not run again." in text
        and "benchmark_verdicts.py --seed 7 --record FILE --once" in text
    )
    assert "again: verdict" not in text and "oved / stated" not in text and "ISO 13528" not in text
    assert "| 1 wall, down | 12 | 0.500 | 0.1000 ± 0.0001 | 0.2000 ± 0.0001 | 50 | ✗ disagree | 2 |" in text


def test_a_page_names_the_option_of_its_second_attempts() -> None:
    entries = [entry(0, "agree", 0.1), entry(1, "inconclusive", 0.1) | {"harder": entry(1, "agree", 0.1)}]
    text = page({"seed": 7, "versions": {}, "scenes": {str(one["number"]): one for one in entries}})
    assert "benchmark_verdicts.py --seed 7 --record FILE --once --try-harder`" in text
    assert "--try-harder" not in page({"seed": 7, "versions": {}, "scenes": {"0": entries[0]}})


def test_a_page_counts_the_agreements_that_were_run_again() -> None:
    entries = [entry(0, "agree", 0.1, 0.1), entry(1, "agree", 0.1), entry(2, "disagree", 0.2)]
    text = page({"seed": SEED, "versions": {}, "scenes": {str(one["number"]): one for one in entries}})
    assert "1 of 2 agreements were run again" in text and "Written by `python tests/benchmarks/benchmark_verdicts.py`." in text


@pytest.mark.parametrize(("once", "verdict", "runs"), [(True, "agree", 1), (False, "agree", 2), (False, "disagree", 1)])
def test_an_agreement_is_run_again_unless_every_scene_runs_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, once: bool, verdict: str, runs: int
) -> None:
    made = []

    def run_scene(scene: Scene, *_: object, **__: object) -> dict[str, Any]:
        made.append(scene.name)
        summary = dict.fromkeys(("reason", "next_step", "unit"), "") | {"verdict": verdict, "weight": 1.0, "free_blocks": 9}
        return summary | {"limit_analysis": {"coulomb": None}, "yade": None, "settings": {}, "checks": []}

    monkeypatch.setattr(benchmark_verdicts, "run_scene", run_scene)
    found = benchmark_verdicts.measured(0, 7, tmp_path, once, harder=False)
    assert len(made) == runs and ("again" in found) == (runs == 2) and found["friction"] == drawn(0, 7).scene.friction


@pytest.mark.parametrize(("verdict", "compared", "released"), [("agree", 90.0, 0.45), ("agree", 100.0, None), ("disagree", 90.0, None)])
def test_the_page_names_agreements_with_the_value_after_a_release(verdict: str, compared: float, released: float | None) -> None:
    """The prediction is 100 N, half the weight; YADE's plateau is at 90 N."""
    summary: dict[str, Any] = {"reason": "", "next_step": "", "unit": "N", "verdict": verdict, "weight": 200.0, "free_blocks": 9}
    summary |= {"limit_analysis": {"coulomb": {"reaction": 100.0, "uncertainty": 0.1}}, "yade": {"reaction": 90.0, "uncertainty": 0.1}}
    summary["checks"] = [{"name": "reaction within bounds", "limit_analysis": 1.0}, {"name": REACTION, "limit_analysis": compared}]
    found = values(summary)
    assert found.get("released") == released
    one = entry(3, verdict, 0.1) | found
    text = page({"seed": 7, "versions": {}, "scenes": {"3": one}})
    assert ("; then 0.45 |" in text and "after a release (*then*): 3." in text) == (released is not None)
    assert apart(one) == (0.0 if released else pytest.approx(1.0 / 9.0))


def test_a_pushed_structure_has_its_multiplier_in_place_of_the_share_of_its_weight() -> None:
    summary: dict[str, Any] = {"reason": "", "next_step": "", "unit": "", "verdict": "agree", "weight": 200.0, "free_blocks": 9}
    both = {"multiplier": 0.4, "uncertainty": 0.01}
    summary |= {"limit_analysis": {"coulomb": both}, "yade": both | {"reaction": None}, "checks": []}
    found = values(summary)
    assert [found[key] for key in ("coulomb", "coulomb_uncertainty", "yade", "yade_uncertainty")] == [0.4, 0.01, 0.4, 0.01]


@pytest.mark.parametrize("record", RECORDS, ids=lambda path: path.stem)
def test_the_page_of_a_record_is_the_one_beside_it(record: Path) -> None:
    assert page(json.loads(record.read_text(encoding="utf-8"))) == record.with_suffix(".md").read_text(encoding="utf-8")


def test_a_record_holds_the_scenes_of_one_seed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    record = tmp_path / "record.json"
    record.write_text(json.dumps({"seed": 7, "versions": {}, "scenes": {}}), encoding="utf-8")
    monkeypatch.setattr("sys.argv", ["benchmark_verdicts.py", "--seed", "8", "--record", str(record)])
    with pytest.raises(SystemExit, match="2"):
        benchmark_verdicts.main()
    assert "holds scenes of seed 7, not of 8; name another file with --record" in capsys.readouterr().err


def test_other_seeds_have_other_scenes() -> None:
    assert drawn(0, 7).scene.text != drawn(0).scene.text
