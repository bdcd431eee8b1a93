"""Blocks that lock where their joints dilate: the prediction needs no bound, and YADE, which never dilates, finds the same."""

from pathlib import Path

import numpy as np
import pytest
import scenes
from conftest import Silent
from locking_scenes import drawn, slot

from comparison.workflow.one_scene import run_scene
from la_core.analysis.stage import analyse
from la_core.limit.associated import Status

SAME = 5e-3  # relative: error of both methods beside their uncertainties


@pytest.mark.yade
def test_a_block_pulled_aslant_out_of_a_slot_moves_by_both_methods(tmp_path: Path) -> None:
    """The block slides up one wall: lambda W / sqrt 2 = W + mu lambda W / sqrt 2."""
    scene = scenes.build(*slot(), friction=0.3, inset=1e-3, live=(1.0, 0.0, 1.0), model="auto")
    summary = run_scene(scene, tmp_path, Silent(), with_yade=True)
    assert summary["limit_analysis"]["associated"]["status"] == "unbounded"
    assert summary["verdict"] == "agree", summary["reason"]
    by_hand = 2.0**0.5 / 0.7
    assert summary["yade"]["reaction"] == pytest.approx(by_hand, rel=SAME)
    assert summary["limit_analysis"]["coulomb"]["multiplier"] == pytest.approx(by_hand, rel=SAME)


@pytest.mark.slow
@pytest.mark.yade
def test_predictions_without_a_bound_are_those_of_yade(tmp_path: Path) -> None:
    random, compared = np.random.default_rng(2611), 0
    for number in range(20):
        _, scene = drawn(random)
        analysis = analyse(scene)
        known = analysis.coulomb is not None and analysis.coulomb.status is Status.SOLVED
        if analysis.bounds[analysis.main].status is not Status.UNBOUNDED or not known:
            continue
        summary = run_scene(scene, tmp_path / f"{number}", Silent(), with_yade=True)
        if summary["yade"]["status"] != "plateau":
            continue
        value, stated = analysis.coulomb.value, analysis.coulomb.uncertainty + summary["yade"]["uncertainty"]
        assert abs(summary["yade"]["reaction"] - value) <= stated + SAME * abs(value), number
        assert summary["verdict"] in ("agree", "inconclusive"), (number, summary["reason"])
        compared += 1
    assert compared >= 5
