"""YADE stays stable where it should, and says so where it cannot: long holds, time steps, penetration."""

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import scenes
from conftest import CrossChecked

from comparison.cli.commands import main
from comparison.yade import installation, read_results
from la_core.analysis.case_file import write_case
from la_core.analysis.stage import analyse

CrossCheck = Callable[[str], CrossChecked]
HOLD = Path(__file__).parents[1] / "benchmarks" / "yade_hold.py"
STEPS = 40_000  # of a hold: most of the steps that a wall takes to its plateau
PENETRATION = 0.1  # of a sphere's radius: the stiffness is chosen for half of it, with glued joints under the weights
MOST_PENETRATION = 0.5  # the same on the way to the plateau, where few points carry the load of many


def with_settings(name: str, path: Path, **settings: float) -> Path:
    text = scenes.shipped(name).text
    table = "\n".join(["[yade]", *(f"{key} = {value}" for key, value in settings.items())])
    path.write_text(f"{text}\n{table}\n", encoding="utf-8")
    return path


@pytest.mark.yade
@pytest.mark.parametrize(
    "name", ["slab_four_corners", *(pytest.param(name, marks=pytest.mark.slow) for name in ("arch_spreading", "wall_third", "rubble_wall"))]
)
def test_a_structure_at_rest_stays_at_rest(name: str, tmp_path: Path) -> None:
    scene = scenes.shipped(name)
    write_case(tmp_path / "case.h5", analyse(scene), "hold")
    yade = installation.find_yade()
    command = [str(part) for part in (yade.python, "-s", HOLD, tmp_path / "case.h5", STEPS)]
    environment = {**installation.yade_environment(), "YADE_MODULES": str(yade.modules)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    found = json.loads(done.stdout.splitlines()[-1])
    held = np.array(found["held"])
    assert len(held) >= 40
    assert held.max() <= max(found["at rest"], found["rest_energy"])  # no more than counts as rest
    assert held[-10:].max() <= 0.01 * found["rest_energy"]  # the joints' own damping has dissipated the rest
    assert found["moved"] <= 0.05 * found["sag"]


@pytest.mark.parametrize("share", [pytest.param(0.3, marks=pytest.mark.slow), 0.9])
@pytest.mark.parametrize("name", ["two_pads", "trilith", pytest.param("slab_four_corners", marks=pytest.mark.slow)])
def test_the_time_step_moves_no_reaction(name: str, share: float, cross_checked: CrossCheck, tmp_path: Path) -> None:
    path = with_settings(name, tmp_path / f"{name}.toml", time_step_share=share)
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) == 0
    yade = json.loads((tmp_path / "out" / name / "comparison.json").read_text())["yade"]
    derived = cross_checked(name).run.result
    assert abs(yade["reaction"] - derived["reaction"]) <= yade["uncertainty"] + derived["uncertainty"]


@pytest.mark.yade
def test_a_time_step_beyond_the_stable_one_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = with_settings("two_pads", tmp_path / "fast.toml", time_step=1.0)
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr()
    assert "time_step is" in said.err + said.out and "at most" in said.err + said.out
    assert not (tmp_path / "out" / "fast" / "run.h5").exists()


@pytest.mark.parametrize("name", ["two_pads", "arch_spreading", "wall_third", "rubble_wall", "slab_four_corners", "corner_settling_end"])
def test_spheres_sink_in_by_a_small_share_of_their_radius(name: str, cross_checked: CrossCheck) -> None:
    found = cross_checked(name)
    settings, assembly = found.run.settings, found.analysis.assembly
    normal = np.einsum("pci,ci->pc", found.run.poses.forces, assembly.normal)
    sunk = normal.max(axis=1) / settings["normal_stiffness"] / settings["sphere_radius"]
    assert sunk[0] <= PENETRATION and sunk.max() <= MOST_PENETRATION


@pytest.mark.parametrize("factor", [0.1, 100.0])
def test_much_softer_or_stiffer_joints_come_to_the_same_reaction(factor: float, cross_checked: CrossCheck, tmp_path: Path) -> None:
    found = cross_checked("trilith")
    path = with_settings("trilith", tmp_path / "joints.toml", normal_stiffness=factor * found.analysis.stiffness.normal)
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) == 0
    summary = json.loads((tmp_path / "out" / "joints" / "comparison.json").read_text())
    assert summary["yade"]["reaction"] == pytest.approx(found.run.result.reaction, rel=5e-3)


@pytest.mark.yade
def test_two_threads_give_the_same_reaction(tmp_path: Path, cross_checked: CrossCheck) -> None:
    assert main(["run", "two_pads", "--threads", "2", "-o", str(tmp_path), "-q"]) == 0
    run, alone = read_results(tmp_path / "two_pads").recorded, cross_checked("two_pads").run
    assert (run.settings["threads"], alone.settings["threads"]) == (2, 1)
    assert abs(run.reaction - alone.reaction) <= alone.uncertainty <= 0.01 * alone.reaction
