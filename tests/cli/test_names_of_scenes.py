"""A name leads to one scene. Where a shipped scene and a file here share a name, the command asks which scene is meant."""

from pathlib import Path

import pytest
from faulty_runs import one_message

from comparison.campaign.definition import find_campaign
from comparison.cli.commands import main
from la_core.errors import SceneError
from la_core.scene import shipped


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Make an empty folder the current folder."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_file_with_the_name_of_a_shipped_scene_is_not_passed_over(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", "facade"]) == 0
    capsys.readouterr()
    assert main(["show", "facade"]) == 2
    one_message(capsys.readouterr().err, 'names both a shipped scene and a file here; "facade.toml" is the file')
    assert shipped.find("facade.toml") == Path("facade.toml")
    assert shipped.find("two_pads") == shipped.place("two_pads")
    assert main(["scenes"]) == 0


def test_a_file_without_ending_that_has_the_name_of_a_shipped_scene_is_not_taken_without_a_word(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (here / "facade").write_text(shipped.place("two_pads").read_text())
    assert main(["show", "facade"]) == 2
    one_message(capsys.readouterr().err, 'facade: names both a shipped scene and a file here; "facade" is the file')


def test_a_shipped_scene_may_be_named_in_the_folder_of_the_shipped_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(shipped.FOLDER)
    assert shipped.find("two_pads") == shipped.place("two_pads")


@pytest.mark.slow
def test_a_campaign_looks_beside_itself(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = here / "studies"
    folder.mkdir()
    (folder / "wall_third.toml").write_text(shipped.place("two_pads").read_text())
    campaign = folder / "study.toml"
    campaign.write_text('title = "One"\n[[sweep]]\nscene = "wall_third"\n')
    assert main(["campaign", str(campaign), "--no-yade", "-o", str(here / "out")]) == 2
    one_message(capsys.readouterr().err, "wall_third: names both a shipped scene and a file here")
    campaign.write_text('title = "One"\n[[sweep]]\nscene = "wall_third.toml"\n')
    assert main(["campaign", str(campaign), "--no-yade", "-o", str(here / "out")]) == 0


def test_a_campaign_with_the_name_of_a_shipped_one_is_not_passed_over(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (here / "seed_paper.toml").write_text('title = "Mine"\n[[sweep]]\nscene = "two_pads"\n')
    assert main(["campaign", "seed_paper", "--no-yade", "-o", "out"]) == 2
    one_message(capsys.readouterr().err, 'seed_paper: names both a shipped campaign and a file here; "seed_paper.toml" is the file')


def test_a_folder_with_the_name_of_a_shipped_campaign_does_not_hide_it(here: Path) -> None:
    (here / "seed_paper").mkdir()
    assert find_campaign(Path("seed_paper")).is_file()
    (here / "other").mkdir()
    assert find_campaign(Path("other")) == Path("other")  # the message that it is a folder comes on reading


def test_the_path_of_a_scene_in_another_folder_may_lack_its_ending(here: Path) -> None:
    (here / "of_mine.toml").write_text(shipped.place("two_pads").read_text())
    assert shipped.find("of_mine", here) == here / "of_mine.toml"
    with pytest.raises(SceneError, match="neither a file nor a shipped scene"):
        shipped.find("of_nobody", here)


def test_a_scene_whose_name_is_a_space_is_refused(here: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The scene's folder of results, and its row in every table, would seem to have no name."""
    (here / " .toml").write_text(shipped.place("two_pads").read_text())
    assert main(["run", " .toml", "--no-yade", "-o", "out"]) == 2
    one_message(capsys.readouterr().err, "more than spaces", "rename the file")


MESH = '[stone]\ndensity = 2000.0\n[joint]\nfriction = 0.6\n[settlement]\ndirection = [0.0, 0.0, -1.0]\n[[mesh]]\nfile = "loop.obj"\n'
DRAWING = MESH.replace("mesh", "drawing").replace("loop.obj", "loop.svg") + "thickness = 0.2\n"


@pytest.mark.parametrize(
    "command", [["run", "--no-yade"], ["cost", "--no-yade"], ["solve"], ["new", "--from"]], ids=lambda command: command[0]
)
@pytest.mark.parametrize("ending", ["toml", "obj", "svg"])
def test_a_file_that_is_a_link_to_itself_is_no_error_of_the_program(
    command: list[str], ending: str, here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Python raises a special error if the link of a scene, a file of bodies or a drawing is a loop: the command gives one message."""
    (here / f"loop.{ending}").symlink_to(f"loop.{ending}")
    (here / "scene.toml").write_text({"obj": MESH, "svg": DRAWING}.get(ending, ""))
    assert main([*command, f"loop.{ending}" if ending == "toml" or command[0] == "new" else "scene.toml"]) == 2
    one_message(capsys.readouterr().err, f"loop.{ending}")
