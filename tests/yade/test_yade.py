"""Real YADE runs against exact values, each other, and the promises about the process."""

import ast
import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
from conftest import CrossChecked
from faulty_runs import endless, held_yade, wait_for

from comparison.cli.commands import main
from comparison.workflow import one_scene
from comparison.yade.installation import ROOT, Yade, find_yade, yade_environment
from comparison.yade.process import run_yade
from la_core.analysis import case_file, stage
from la_core.exchange.dem_settings import SETTINGS
from la_core.exchange.fields import RUN_FIELDS
from la_core.limit.problem import Drive
from la_core.scene import shipped
from la_core.scene.scene import load_scene

CrossCheck = Callable[[str], CrossChecked]

HALF_PER_CENT = 5e-3  # relative: promised accuracy where values are exact


@pytest.fixture(scope="session")
def yade() -> Yade:
    return find_yade()


@pytest.mark.parametrize(
    "name", ["two_pads", "trilith", "arch_spreading", "arch_settling", "arch_diagonal", "flat_arch", "slab_four_corners"]
)
def test_the_reaction_is_exact_to_half_a_per_cent_and_its_own_uncertainty(name: str, cross_checked: CrossCheck) -> None:
    found = cross_checked(name)
    exact = found.analysis.bounds[Drive.YIELDING].value
    difference = abs(found.run.result.reaction - exact)
    assert found.run.status == "plateau"
    assert difference <= HALF_PER_CENT * exact
    assert difference <= found.run.result.uncertainty
    assert found.summary["verdict"] == "agree", found.summary["reason"]


def test_a_facade_goes_through_both_methods(cross_checked: CrossCheck) -> None:
    found = cross_checked("facade")
    assert found.summary["free_blocks"] >= 150
    assert found.run.status == "plateau"
    assert _verdicts(found)["reaction against prediction"] == "agree"


@pytest.mark.yade
def test_blocks_laid_without_thrust_may_fall_although_thrust_could_hold_them(tmp_path: Path) -> None:
    path = tmp_path / "unwedged.toml"
    soft = "wedging = 0.0\nstiffening = 1.0"  # stiffer joints jam after a shorter fall, which gives them a thrust
    path.write_text(shipped.find("flat_arch").read_text().replace("wedging = 2e-5", soft))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) == 4
    summary = json.loads((tmp_path / "out" / "unwedged" / "comparison.json").read_text())
    assert summary["yade"]["status"] == "collapsed" and summary["verdict"] == "inconclusive"
    assert "thrust" in summary["reason"]


def _verdicts(found: CrossChecked) -> dict[str, str]:
    return {check["name"]: check["verdict"] for check in found.summary["checks"]}


def test_two_identical_runs_give_identical_bits(yade: Yade, cross_checked: CrossCheck, tmp_path: Path) -> None:
    first = cross_checked("arch_spreading").folder
    shutil.copy(first / "case.h5", tmp_path)
    run_yade(yade, tmp_path, "again", one_scene.TIME_LIMIT, lambda report: None)
    with h5py.File(first / "run.h5") as one, h5py.File(tmp_path / "run.h5") as other:
        for field in RUN_FIELDS:
            if field.path != "result/seconds":
                assert np.array_equal(one[field.path][()], other[field.path][()], equal_nan=field.dtype == "f8"), field.path


def test_nothing_listens_while_yade_runs(yade: Yade, tmp_path: Path) -> None:
    scene = load_scene(endless(tmp_path))  # it runs for as long as this test looks at it
    case_file.write_case(tmp_path / "case.h5", stage.analyse(scene), "test")
    script = ROOT / "yade_scripts" / "run_case.py"
    variables = {**yade_environment(), "YADE_MODULES": str(yade.modules)}
    command = [str(yade.python), str(script), str(tmp_path / "case.h5"), str(tmp_path / "run.h5")]
    with subprocess.Popen(command, env=variables, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        first = process.stdout.readline()  # the model is built and runs from here on
        sockets = set()
        for _ in range(20):
            if process.poll() is None:
                sockets |= {str(entry.readlink()) for entry in Path(f"/proc/{process.pid}/fd").iterdir() if entry.is_symlink()}
            time.sleep(0.05)
        process.kill()
    assert first.startswith("progress ")
    assert sockets and not [target for target in sockets if target.startswith("socket:")]


def test_a_run_without_a_folder_for_its_record_ends_before_yade_loads(tmp_path: Path) -> None:
    """It ended after the whole run, whose record was lost."""
    script, record = ROOT / "yade_scripts" / "run_case.py", tmp_path / "none" / "run.h5"
    ended = subprocess.run(
        [sys.executable, str(script), str(tmp_path / "case.h5"), str(record)], check=False, capture_output=True, text=True
    )
    assert ended.returncode == 1 and ended.stderr.endswith(
        f"error: {record}: its folder does not exist; make the folder, then run the case again\n"
    )


@pytest.mark.yade
def test_a_structure_that_cannot_stand_collapses_in_both_methods(tmp_path: Path) -> None:
    text = shipped.find("two_pads").read_text().split("[expected]")[0].replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]")
    path = tmp_path / "overhang.toml"
    path.write_text(text.replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]"))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) == 5
    summary = json.loads((tmp_path / "out" / "overhang" / "comparison.json").read_text())
    assert summary["verdict"] == "cannot stand" and "collapsed in YADE, too" in summary["reason"]
    assert summary["yade"]["status"] == "collapsed" and summary["yade"]["reaction"] is None
    assert summary["limit_analysis"]["associated"]["falling"] == ["block"]


@pytest.mark.yade
def test_sharp_edges_are_judged_by_the_inset_that_yade_took(tmp_path: Path) -> None:
    path = tmp_path / "sharp.toml"
    path.write_text(shipped.find("two_pads").read_text().replace("friction = 0.6", "friction = 0.6\ninset = 0.0"))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) == 0
    summary = json.loads((tmp_path / "out" / "sharp" / "comparison.json").read_text())
    associated = summary["limit_analysis"]["associated"]
    assert associated["reaction"] == associated["reaction_sharp"] == pytest.approx(359.7, abs=1e-3)
    assert associated["shared_inset"]["reaction"] == pytest.approx(363.297, abs=1e-3)
    assert any("takes 0.001 m" in note for note in summary["notes"])


@pytest.mark.yade
def test_a_rotating_support_gives_a_moment(tmp_path: Path) -> None:
    path = tmp_path / "hinge.toml"
    text = shipped.find("two_pads").read_text().split("[expected]")[0]
    path.write_text(text.replace("direction = [0.0, 0.0, -1.0]", "axis = [0.0, 1.0, 0.0]\npoint = [0.4, 0.0, 0.0]"))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) == 0
    summary = json.loads((tmp_path / "out" / "hinge" / "comparison.json").read_text())
    yade, associated = summary["yade"], summary["limit_analysis"]["associated"]
    assert yade["reaction"] == pytest.approx(associated["reaction"], rel=HALF_PER_CENT)


@pytest.mark.slow
@pytest.mark.yade
def test_a_run_that_was_killed_is_redone(tmp_path: Path) -> None:
    out = tmp_path / "out"
    command = [sys.executable, "-m", "comparison", "run", "wall_third", "-o", str(out)]
    environment, _ = held_yade(tmp_path)
    with subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL, cwd=ROOT, env=environment) as process:
        wait_for((out / "wall_third" / "yade.log").exists)
        process.kill()
    assert not (out / "wall_third" / "run.h5").exists()
    assert main(["run", "wall_third", "-o", str(out), "-q", "--no-yade"]) == 0


@pytest.mark.yade
def test_a_yade_that_crashes_is_a_failed_tool_with_the_log_s_last_lines(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fake = tmp_path / "python"
    fake.write_text('#!/bin/sh\n[ "$2" = -c ] && echo 0.0 && exit 0\necho the sky is falling\nkill -SEGV $$\n')
    fake.chmod(0o755)
    monkeypatch.setenv("CROSSCHECK_YADE_PYTHON", str(fake))
    assert main(["run", "two_pads", "-o", str(tmp_path / "out")]) == 3
    said = capsys.readouterr().err
    assert "SIGSEGV" in said and "the sky is falling" in said


@pytest.mark.slow
@pytest.mark.yade
def test_a_time_limit_ends_in_a_timeout_that_is_tried_again(tmp_path: Path) -> None:
    out = tmp_path / "out"
    assert main(["run", "wall_third", "-o", str(out), "-q", "--time-limit", "0.01"]) == 4  # YADE takes seconds to load
    assert json.loads((out / "wall_third" / "comparison.json").read_text())["yade"]["status"] == "timeout"


@pytest.mark.yade
@pytest.mark.slow
def test_a_time_limit_is_obeyed_however_many_steps_lie_between_two_records(tmp_path: Path) -> None:
    """At this speed the first row of the settlement would be written after a day."""
    scene = tmp_path / "slow.toml"
    scene.write_text(shipped.find("two_pads").read_text(encoding="utf-8") + "\n[yade]\nspeed = 1e-12\n", encoding="utf-8")
    assert main(["run", str(scene), "-o", str(tmp_path), "-q", "--time-limit", "3"]) == 4
    stored = json.loads((tmp_path / "slow" / "comparison.json").read_text(encoding="utf-8"))
    assert stored["yade"]["status"] == "timeout"


def test_a_misspelt_yade_setting_is_a_scene_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "typo.toml"
    path.write_text(shipped.find("two_pads").read_text() + "\n[yade]\nspeeed = 1.0\n")
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert "yade.speeed" in said and '"speed"' in said


def test_the_settings_a_scene_may_name_are_those_yade_knows() -> None:
    text = (ROOT / "yade_scripts" / "settings.py").read_text()
    (settings,) = [node for node in ast.parse(text).body if isinstance(node, ast.ClassDef) and node.name == "Settings"]
    assert tuple(field.target.id for field in settings.body if isinstance(field, ast.AnnAssign)) == SETTINGS


@pytest.mark.yade
@pytest.mark.parametrize("friction", [1.5, *(pytest.param(value, marks=pytest.mark.slow) for value in (5.0, 1e3))])
def test_where_rough_joints_may_jam_or_slide_the_interval_holds_both_and_nobody_is_called_wrong(friction: float, tmp_path: Path) -> None:
    path = tmp_path / "rough.toml"
    path.write_text(shipped.find("two_blocks").read_text().split("[expected]")[0].replace("friction = 0.6", f"friction = {friction}"))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) in (0, 4)
    summary = json.loads((tmp_path / "out" / "rough" / "comparison.json").read_text())
    assert summary["yade"]["reaction"] == pytest.approx(0.5 * summary["weight"], rel=HALF_PER_CENT)
    predicted = summary["limit_analysis"]["coulomb"]["reaction"]
    if predicted == pytest.approx(0.5 * summary["weight"], rel=HALF_PER_CENT):
        assert summary["verdict"] == "agree"
    else:
        assert summary["verdict"] == "inconclusive" and "history decides" in summary["reason"]
