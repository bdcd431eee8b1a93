"""`crosscheck scenes` and `crosscheck show` describe scenes before any analysis."""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from comparison.cli.commands import main
from comparison.studies import TimeEstimate, estimated_times
from comparison.studies.time_estimate import WITHIN
from la_core.analysis import structural_model
from la_core.scene import load_scene, shipped

GALLERY = Path(__file__).parents[2] / "comparison" / "gallery"


def test_scenes_lists_every_shipped_scene_with_its_source(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["scenes", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)["scenes"]
    assert [scene["name"] for scene in listed] == shipped.names()
    assert all(scene["title"] and scene["source"] for scene in listed)
    assert main(["scenes"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in ("two_pads", "facade", "wall_third"))


@pytest.mark.slow
def test_the_mass_of_floors_is_no_density_of_stone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A table and a report once gave 4500 kg/m3 as the density of the blocks under a roof of 380 kg."""
    scene, results = tmp_path / "building.toml", tmp_path / "results"
    assert main(["new", "building", "-o", str(scene)]) == 0 and main(["show", str(scene), "-o", str(tmp_path / "a.png")]) == 0
    printed = capsys.readouterr().out
    assert "2000 " in printed and "4500" not in printed and "mass of floors on the blocks   380 " in printed
    assert main(["run", str(scene), "--no-yade", "-q", "-o", str(results)]) == 0
    report = (results / "report.md").read_text(encoding="utf-8")
    assert "| density | 2000 kg/m3 |" in report and "| mass of floors on the blocks | 380 kg |" in report


def test_show_states_dimensions_density_and_times(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["show", "two_pads", "-o", str(tmp_path / "a.png"), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert facts["dimensions"] == pytest.approx([1.0, 0.2, 0.5]) and facts["densities"] == [2200.0]
    assert facts["floor_mass"] is None
    assert set(facts["estimated_seconds"]) == {"limit_analysis", "yade"}
    assert main(["show", "ferris_tin_loi_1", "-q", "-o", str(tmp_path / "a.png")]) == 0
    printed = capsys.readouterr().out
    assert "limit analysis takes" in printed and "YADE takes" in printed


def test_the_estimated_times_follow_the_recorded_ones() -> None:
    """The record's machine may be faster or slower than an ordinary one, so the test compares times relative to its median factor."""
    records = json.loads((GALLERY / "results.json").read_text(encoding="utf-8"))
    names = sorted(records)
    estimates = {name: estimated_times(len(structural_model(load_scene(shipped.find(name))).assembly.points)) for name in names}
    factors = np.array([records[name]["reduced"]["yade_seconds"] / middle(estimates[name]["yade"]) for name in names])
    machine = float(np.median(factors))
    assert 1.0 / WITHIN <= machine <= WITHIN
    assert np.mean(np.abs(np.log(factors / machine)) <= math.log(WITHIN)) >= 0.9
    for name in names:
        allowed = max(estimates[name]["limit_analysis"].greatest, 1.0)
        assert records[name]["reduced"]["limit_analysis_seconds"] <= max(machine, 1.0) * allowed, name


def middle(estimate: TimeEstimate) -> float:
    return math.sqrt(estimate.least * estimate.greatest)


def test_an_estimate_spans_the_factor_it_states_and_is_told_in_one_unit() -> None:
    times = estimated_times(338)
    assert times["yade"].greatest == pytest.approx(WITHIN**2 * times["yade"].least)
    assert estimated_times(338, yade=False).keys() == {"limit_analysis"}
    finite = estimated_times(338, finite=True)
    assert finite["limit_analysis"] == times["limit_analysis"] and finite["yade"].least > times["yade"].least
    assert str(TimeEstimate(0.1, 0.9)) == "less than 1 s" and str(TimeEstimate(400.0, 3700.0)) == "7 min to 1 h"


def test_settings_of_its_own_leave_the_time_of_yade_unknown(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = shipped.find("two_pads").read_text(encoding="utf-8")
    (tmp_path / "slow.toml").write_text(f"{text}\n[yade]\nspeed = 1e-9\n", encoding="utf-8")
    assert main(["show", str(tmp_path / "slow.toml"), "-o", str(tmp_path / "a.png")]) == 0
    assert "unknown: [yade] sets speed" in " ".join(capsys.readouterr().out.split())


def test_show_draws_and_counts(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    figure = tmp_path / "figure.png"
    assert main(["show", "slab_four_corners", "-o", str(figure), "--json"]) == 0
    facts = json.loads(capsys.readouterr().out)
    assert (facts["free_blocks"], facts["contact_points"]) == (1, 16)
    assert figure.read_bytes().startswith(b"\x89PNG")


def test_a_figure_takes_the_format_of_its_name(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, beginning in (("f.png", b"\x89PNG"), ("f.svg", b"<?xml"), ("f.pdf", b"%PDF")):
        assert main(["show", "two_pads", "-q", "-o", str(tmp_path / name)]) == 0
        assert (tmp_path / name).read_bytes().startswith(beginning)
    with pytest.raises(SystemExit) as stop:
        main(["show", "two_pads", "-o", str(tmp_path / "figure.jpeg")])
    assert stop.value.code == 2 and ".svg" in capsys.readouterr().err
