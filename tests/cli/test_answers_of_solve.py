"""`crosscheck solve` answers with values, a path or the falling blocks, and prints no other text beside JSON."""

import json
import math
import os
import subprocess
import sys
from pathlib import Path

import pytest
import scenes
from conftest import every_shipped_scene
from locking_scenes import slot

from comparison.cli.commands import main
from la_core.analysis.answer import answer_rows
from la_core.analysis.result import answer_values
from la_core.analysis.stage import analyse
from la_core.coulomb import interval_status
from la_core.scene import shipped

SOLVED_KEYS = {
    "status", "reaction", "reaction_max", "reaction_sharp", "equilibrium_residual", "cone_violation", "duality_gap", "seconds"
}  # fmt: skip


def test_solve_prints_one_json_object_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pads", "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["weight"] == pytest.approx(2158.2)
    assert (answer["free_blocks"], answer["interfaces"], answer["contact_points"]) == (1, 2, 4)
    assert answer["effects"]["plane"] is True
    associated = answer["limit_analysis"]["associated"]
    assert associated.keys() >= SOLVED_KEYS
    assert associated["status"] == "solved"
    assert associated["reaction"] == pytest.approx(363.297, abs=1e-3)  # the inset moves every lever arm: 0.101 / 0.6 of W
    assert associated["reaction_sharp"] == pytest.approx(359.7, abs=1e-3)
    coulomb = answer["limit_analysis"]["coulomb"]
    assert coulomb["status"] == "solved"
    assert coulomb["reaction"] == pytest.approx(associated["reaction"], rel=1e-6)  # no joint slides
    assert coulomb["reaction_interval"] == pytest.approx([associated["reaction"]] * 2, rel=1e-6)
    assert coulomb["dilatancy_residual"] <= 1e-3 and coulomb["iterations"] > 0 and coulomb["seconds"] > 0.0
    assert not {"yade", "checks", "verdict"} & answer.keys()


@pytest.mark.parametrize(
    ("interval", "shown"),
    [((math.nan, math.nan), ["not stated"] * 2), ((-math.inf, 363.297), ["unlimited", "363.297"]), ((0.0, 1e-7), ["0", "0"])],
)
def test_the_ends_of_an_interval_are_numbers_or_say_why_not(interval: tuple[float, float], shown: list[str]) -> None:
    scene = shipped.load("two_pads")
    values = answer_values(analyse(scene))
    values["coulomb"] |= {"reaction_interval": list(interval), "interval_status": interval_status(interval)}
    rows = {name: value for name, value, _ in answer_rows(scene, values)}
    assert [rows[f"Coulomb: {end} by its mechanism"] for end in ("least", "greatest")] == shown


def test_without_a_prediction_no_interval_is_withheld() -> None:
    scene = shipped.load("two_pads")
    values = answer_values(analyse(scene))
    values["coulomb"] |= {"reaction": math.nan, "reaction_interval": [math.nan] * 2, "interval_status": "not stated"}
    rows = {name: value for name, value, _ in answer_rows(scene, values)}
    assert [rows[f"Coulomb: {end} by its mechanism"] for end in ("least", "greatest")] == ["–", "–"]


def _overhanging(folder: Path) -> Path:
    """Write a scene whose two pads both lie left of the block's centroid. Return its path."""
    text = shipped.find("two_pads").read_text().split("[expected]")[0].replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]")
    path = folder / "overhang.toml"
    path.write_text(text.replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]"))
    return path


def test_solve_of_a_structure_that_cannot_stand_names_what_falls(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", str(_overhanging(tmp_path)), "--json"]) == 5
    associated = json.loads(capsys.readouterr().out)["limit_analysis"]["associated"]
    assert associated["status"] == "infeasible"
    assert associated["reaction"] is None and associated["duality_gap"] is None
    assert associated["falling"] == ["block"]


@pytest.mark.parametrize("command", [["cost", "--no-yade"], ["sensitivity"], ["animate", "--no-yade"]], ids=lambda command: command[0])
def test_every_command_ends_with_the_same_code_for_a_structure_that_cannot_stand(
    command: list[str], tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CROSSCHECK_OUTPUT")
    assert main([*command, str(_overhanging(tmp_path)), "-q"]) == 5
    assert "cannot stand" in capsys.readouterr().err


def test_a_scene_that_misses_its_expected_value_disagrees(tmp_path: Path) -> None:
    path = tmp_path / "wrong.toml"
    path.write_text(shipped.find("two_pads").read_text().replace("0.1666666667", "0.1766666667"))
    assert main(["solve", str(path), "-q"]) == 1


@pytest.mark.slow
def test_a_live_load_gives_a_multiplier_and_no_yade_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "pushed.toml"
    path.write_text("""
title = "Block pushed sideways"
[stone]
density = 2000.0
[joint]
friction = 0.4
[[block]]
name = "ground"
role = "fixed"
box = { from = [-1.0, 0.0, -0.1], to = [2.0, 1.0, 0.0] }
[[block]]
name = "block"
box = { from = [0.0, 0.0, 0.0], to = [1.0, 1.0, 0.5] }
[live]
direction = [1.0, 0.0, 0.0]
""")
    assert main(["solve", str(path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)["limit_analysis"]
    assert answer["associated"]["multiplier"] == pytest.approx(0.4, abs=1e-8)
    assert answer["coulomb"]["multiplier"] == pytest.approx(0.4, abs=1e-6)
    assert "reaction" not in answer["associated"] and "reaction" not in answer["coulomb"]
    assert main(["run", str(path), "-o", str(tmp_path / "out")]) == 0


def test_colours_and_narration_obey_the_environment(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "comparison", "solve", "two_pads", "-q"]
    environment = {**os.environ, "NO_COLOR": "1", "FORCE_COLOR": ""}
    answer = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
    assert "\x1b[3" not in answer.stdout
    assert answer.stderr == ""


@every_shipped_scene
def test_every_shipped_scene_reproduces_what_is_expected_of_it(name: str) -> None:
    assert main(["solve", name, "-q"]) == 0


def test_a_path_is_followed_where_it_is_asked_for(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pads", "--path", "--json", "-o", str(tmp_path / "path.svg")]) == 0
    path = json.loads(capsys.readouterr().out)["limit_analysis"]["path"]
    assert len(path["settlement"]) == len(path["reaction"]) == 26 and path["settlement"][0] == 0.0
    assert path["reaction"][-1] == pytest.approx(363.297, rel=1e-3)
    assert (tmp_path / "path.svg").is_file()
    assert main(["solve", "two_pads", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["limit_analysis"]["path"] is None


@pytest.mark.slow_after_first
@pytest.mark.parametrize("words", [("solve",), ("run", "--no-yade")], ids=["solve", "run"])
def test_an_answer_without_a_limit_is_inconclusive_and_says_why(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A wall that is pressed straight into the ground bears any multiple of its weight."""
    path = tmp_path / "pressed.toml"
    path.write_text(scenes.text(*scenes.wall(4, 3), live=(0.0, 0.0, -1.0), model="coulomb"))
    assert main([words[0], str(path), *words[1:], *(("-o", str(tmp_path / "out")) if words[0] == "run" else ())]) == 4
    captured = capsys.readouterr()
    told = " ".join((captured.out + captured.err).split())
    assert "Limit analysis ended as unbounded, so it has no answer." in told
    assert "next: Look at the direction of the settlement or of the live load" in told
    assert "they may jam" in told
    if words[0] == "run":
        assert "| pressed | ? inconclusive | unbounded |" in (tmp_path / "out" / "report.md").read_text()


def test_a_block_that_only_a_thrust_could_hold_may_fall_where_nothing_limits_the_answer(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Without thrust, a block between two walls slides down, as in YADE. By the associated flow rule it locks and bears any load."""
    left, right = (
        scenes.box("left", (-1.0, 0.0, 0.0), (0.0, 1.0, 1.0), "fixed"),
        scenes.box("right", (1.0, 0.0, 0.0), (2.0, 1.0, 1.0), "fixed"),
    )
    path = tmp_path / "between.toml"
    path.write_text(scenes.text(left, right, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), live=(0.0, 0.0, -1.0), model="coulomb"))
    assert main(["solve", str(path)]) == 4
    captured = capsys.readouterr()
    assert "they may jam, or slide and fall for want of a thrust." in " ".join((captured.out + captured.err).split())


def test_a_tilt_that_a_wall_resists_at_any_angle_points_to_its_axis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "leaning.toml"
    stones = (
        scenes.box("table", (0.0, 0.0, -0.1), (2.0, 1.0, 0.0), "fixed"),
        scenes.box("wall", (1.0, 0.0, 0.0), (1.5, 1.0, 1.0), "fixed"),
        scenes.box("stone", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)),
    )
    path.write_text(scenes.text(*stones, tilt=(0.0, 1.0, 0.0), model="coulomb"))
    assert main(["solve", str(path)]) == 4
    captured = capsys.readouterr()
    told = " ".join((captured.out + captured.err).split())
    assert "Limit analysis ended as unbounded" in told and "the axis of the tilt" in told


@pytest.mark.parametrize("drive", [{"live": (1.0, 0.0, 0.0)}, {"tilt": (0.0, 1.0, 0.0)}], ids=["push", "tilt"])
def test_a_multiplier_of_round_off_is_zero(drive: dict[str, tuple[float, ...]], tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A block without friction bears no push. The solver's multiplier of some 1e-11 is shown as 0."""
    path = tmp_path / "ice.toml"
    ground, block = scenes.box("ground", (-1.0, 0.0, -0.1), (2.0, 1.0, 0.0), "fixed"), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
    path.write_text(scenes.text(ground, block, friction=0.0, model="coulomb", **drive))
    assert main(["solve", str(path)]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines() if "multiplier" in line or " angle, degrees" in line]
    assert len(rows) >= 3 and {row[-1] for row in rows} == {"0"}


def in_a_slot(inset: float = 0.001, **effects: str) -> str:
    """Return the text of a scene: a block is pulled obliquely out of a slot."""
    return scenes.text(*slot(), friction=0.3, inset=inset, live=(1.0, 0.0, 1.0), model="auto", effects=effects)


@pytest.mark.parametrize(
    ("effects", "step"),
    [
        ({"friction": "associated"}, 'Set friction = "coulomb" in the scene\'s [effects] table for a prediction.'),
        ({"friction": "none-slides"}, 'Set friction = "coulomb" in the scene\'s [effects] table for a prediction.'),
        ({"elasticity": "none"}, 'Leave elasticity = "none" out of the scene\'s [effects] table for a prediction'),
    ],
    ids=["associated", "none slides", "rigid"],
)
def test_where_an_effect_of_the_scene_forbids_the_prediction_the_next_step_names_it(
    effects: dict[str, str], step: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "slot.toml"
    path.write_text(in_a_slot(**effects))
    assert main(["solve", str(path)]) == 4
    told = " ".join("".join(capsys.readouterr()).split())
    assert "the blocks lock as they dilate" in told and step in told and "jam" not in told


def test_blocks_that_lock_as_they_dilate_have_a_prediction_and_no_bound(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """For a block pulled obliquely out of a slot, lambda W / sqrt 2 = W + mu lambda W / sqrt 2. Bounds alone give no answer."""
    path = tmp_path / "slot.toml"
    path.write_text(in_a_slot())
    assert main(["solve", str(path), "--json"]) == 0
    answer = json.loads(capsys.readouterr().out)["limit_analysis"]
    assert (answer["associated"]["status"], answer["associated"]["multiplier"]) == ("unbounded", None)
    assert answer["coulomb"]["status"] == "solved"
    assert answer["coulomb"]["multiplier"] == pytest.approx(2.0**0.5 / 0.7, rel=1e-3)
    assert answer["coulomb"]["multiplier_interval"][1] is None and answer["coulomb"]["interval_status"] == "unlimited"
    assert main(["solve", str(path), "--bounds", "-q"]) == 4
    capsys.readouterr()
    assert main(["solve", str(path), "--path", "--json"]) == 0
    followed = json.loads(capsys.readouterr().out)["limit_analysis"]["path"]
    assert followed["multiplier"][-1] == pytest.approx(2.0**0.5 / 0.7, rel=1e-3)
    assert main(["solve", str(path), "--accuracy", "1%"]) == 4
    assert "next: Set inset = 0 in the scene's [joint] table" in " ".join("".join(capsys.readouterr()).split())
    path.write_text(in_a_slot(inset=0.0))
    assert main(["solve", str(path), "--accuracy", "1%"]) == 0


def test_a_greatest_reaction_without_a_limit_is_no_dash() -> None:
    """A dash means that no value exists. The reaction of the flat arch has no upper limit."""
    analysis = analyse(scenes.shipped("flat_arch"))
    rows = {name: value for name, value, _ in answer_rows(analysis.scene, answer_values(analysis))}
    assert rows["reaction max"] == rows["reaction max sharp"] == "no upper limit"


@pytest.mark.parametrize(
    ("keys", "smaller"), [("inset = 0.03", "inset"), ("inset = 0\n[geometry]\ntolerance = 0.01", "inset or tolerance of the geometry")]
)
def test_solve_says_that_joints_are_too_short_to_count(keys: str, smaller: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An inset of 30 mm drops the joint on a pad of 12 mm, on which the block leans with sharp edges. So does a tolerance of 10 mm."""
    third = '[[block]]\nname = "third pad"\nrole = "fixed"\nbox = { from = [0.45, 0.0, -0.1], to = [0.462, 0.2, 0.0] }\n'
    text = shipped.load("two_pads").text.replace("friction = 0.6", f"friction = 0.6\n{keys}")
    (tmp_path / "pads.toml").write_text(f"{text}\n{third}", encoding="utf-8")
    main(["solve", str(tmp_path / "pads.toml")])
    told = f"1 joint is too short to count and dropped, also with sharp edges. A smaller {smaller} may keep more joints."
    assert told in " ".join(capsys.readouterr().out.split())
