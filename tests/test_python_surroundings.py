"""Work from Python goes on in notebooks, without a standard error, and where a script changes its folder."""

import io
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

import comparison
import la_core


class _Broken:
    """The stream of a closed window, which raises an error of its own for every write."""

    def write(self, text: str) -> int:
        raise RuntimeError("the window is closed")


def closed_stream() -> io.StringIO:
    stream = io.StringIO()
    stream.close()
    return stream


LOST = {"none": lambda: None, "closed": closed_stream, "broken": _Broken}


@pytest.mark.slow_after_first
@pytest.mark.parametrize("stderr", LOST.values(), ids=LOST)
def test_work_goes_on_where_standard_error_takes_no_words(
    stderr: Callable[[], object], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A notebook whose window has gone, or a service without one, must not lose a campaign of hours."""
    (tmp_path / "friction.toml").write_text('[[sweep]]\nscene = "two_pads"\nvary = { "joint.friction" = [0.6] }\n', encoding="utf-8")
    monkeypatch.setattr(sys, "stderr", stderr())
    assert comparison.run("two_pads", tmp_path / "runs", yade=False).verdict is comparison.Verdict.EXPECTED_MET
    assert len(comparison.run_campaign(tmp_path / "friction.toml", tmp_path / "cases", yade=False, workers=1).rows) == 1


def test_a_notebook_shows_the_narration_as_standard_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Rich knows a notebook by the class of its shell."""
    notebook = type("ZMQInteractiveShell", (), {})()
    monkeypatch.setattr("builtins.get_ipython", lambda: notebook, raising=False)
    comparison.run("two_pads", tmp_path, yade=False)
    assert "two_pads: limit analysis: bounds" in capsys.readouterr().err


@pytest.mark.slow
def test_results_stay_those_of_their_folder_wherever_the_program_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A script that changes its folder must not report or compare what lies under the same name elsewhere."""
    (tmp_path / "friction.toml").write_text('[[sweep]]\nscene = "two_pads"\nvary = { "joint.friction" = [0.6] }\n', encoding="utf-8")
    made = {}
    for place, friction in (("here", 0.6), ("there", 0.5)):
        (tmp_path / place).mkdir()
        monkeypatch.chdir(tmp_path / place)
        scene = la_core.variant("two_pads", {"joint.friction": friction}, name="pads")
        made[place] = comparison.run(scene, "runs", yade=False, quiet=True)
        campaign = comparison.run_campaign("../friction.toml", "cases", yade=False, workers=1, quiet=True)
    assert made["here"].report() == tmp_path / "here" / "runs" / "report.html"
    assert comparison.read("runs/pads").folder == made["there"].folder == tmp_path / "there" / "runs" / "pads"
    assert comparison.read_campaign("cases").folder == campaign.folder == tmp_path / "there" / "cases"
    with pytest.raises(ValueError, match="must lie in one folder"):
        made["here"].report(made["there"])


@pytest.mark.slow
def test_variants_of_the_scene_of_a_result_find_its_meshes_wherever_the_program_goes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    ran = comparison.run("rubble_wall", "runs", yade=False, quiet=True)
    read = comparison.read("runs/rubble_wall")
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir("elsewhere")
    for scene in (ran.scene, read.scene):
        assert scene.path == tmp_path / "runs" / "rubble_wall" / "scene.toml"
        assert len(la_core.variant(scene, {"joint.friction": 0.5}).blocks) == len(scene.blocks)
