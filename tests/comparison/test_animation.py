"""The animation begins at rest, ends with the whole record, and shows titles and names as plain text."""

import errno
import itertools
import json
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from conftest import CrossChecked
from PIL import Image
from scenes import SHIPPED

import comparison
from comparison.cli.commands import main
from comparison.cli.exit_codes import CANNOT_STAND, TOOL, USAGE
from comparison.errors import message_of
from comparison.figures import animation
from comparison.figures.animation import SECONDS, Story
from comparison.report.report import write_report
from comparison.run_folder import ANIMATION
from comparison.yade import Results

FPS = 2
HOSTILE = "$\\\\frac$ {x} %d <b> [red] _^"


@pytest.fixture(scope="module")
def animated(tmp_path_factory: pytest.TempPathFactory, cross_checked: Callable[[str], CrossChecked]) -> Path:
    """Results of two pads with their animation."""
    folder = tmp_path_factory.mktemp("out") / "two_pads"
    shutil.copytree(cross_checked("two_pads").folder, folder)
    assert main(["animate", str(folder), "--fps", str(FPS), "-q"]) == 0
    return folder


def pictures(path: Path) -> list[np.ndarray]:
    found = []
    with Image.open(path) as image:
        for number in range(getattr(image, "n_frames", 1)):
            image.seek(number)
            found.append(np.array(image.convert("RGB")))
    return found


def test_the_animation_has_its_frames_and_moves_from_the_first_to_the_last(animated: Path) -> None:
    frames = pictures(animated / ANIMATION)
    assert len(frames) == SECONDS * FPS + 1
    assert all(np.any(before != after) for before, after in itertools.pairwise(frames))
    assert (animated / ANIMATION).stat().st_size < 3e6
    assert np.all(frames[0][2, 2] == 255)  # the paper is white


def test_the_curve_begins_at_rest_and_is_whole_in_the_last_frame(cross_checked: Callable[[str], CrossChecked]) -> None:
    found = cross_checked("two_pads")
    story = Story(Results(found.analysis, found.run))
    at, reaction = (found.run.settling(name) for name in ("settlement", "reaction"))
    drawn = []
    for share in (0.0, 0.5, 1.0):
        story.draw(share)
        drawn.append(np.array(story.line.get_data()))
    rest, half, whole = (len(curve[0]) for curve in drawn)
    assert 1 <= rest < half < whole == len(at)
    assert drawn[2][0] * story.scales.settlement == pytest.approx(at)
    assert drawn[2][1] * story.scales.reaction == pytest.approx(reaction)
    assert np.all(at[:half] <= 0.5**animation.SLOW * found.run.poses.settlement[-1])
    assert story.tip.get_xdata()[-1] == drawn[2][0][-1]
    assert "mm" in story.reading.get_text() and "YADE's R" in story.reading.get_text()


def test_blocks_are_drawn_at_rest_first_and_where_yade_left_them_last(cross_checked: Callable[[str], CrossChecked]) -> None:
    found = cross_checked("two_pads")
    story, run = Story(Results(found.analysis, found.run)), found.run
    yade = story.shown.methods[1]
    corner = found.analysis.assembly.blocks.vertices.max(axis=0)

    def top_right() -> np.ndarray:
        paths = [path for artist in story.canvases[1].axes.collections[story.still[1] :] for path in artist.get_paths()]
        return np.array(np.concatenate([path.vertices for path in paths]).max(axis=0))

    story.draw(0.0)
    assert top_right() == pytest.approx(corner[[0, 2]])
    story.draw(1.0)
    (free,) = np.flatnonzero(found.analysis.assembly.blocks.free)
    moved = yade.displacement[-1, free]
    arm = corner - found.analysis.assembly.blocks.centroid[free]
    expected = corner + story.shown.magnification * (moved[:3] + np.cross(moved[3:], arm))
    assert top_right()[0] == pytest.approx(expected[0])
    assert yade.displacement[-1, free, :3] == pytest.approx(np.diff(run.poses.displacement[[0, -1], free], axis=0)[0])


def test_the_report_takes_it_in_when_it_is_written_again(animated: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(animated.parent), "-q"]) == 0
    page = (animated.parent / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/gif;base64,") == 1
    assert "two_pads/animation.gif" in (animated.parent / "report.md").read_text(encoding="utf-8")
    assert "data:image/gif" not in write_report(animated.parent, [{"scene": "other", "verdict": None}], {}).read_text(encoding="utf-8")
    capsys.readouterr()


@pytest.mark.usefixtures("plain_figures")
def test_an_animation_of_other_results_is_taken_away(animated: Path, tmp_path: Path) -> None:
    shutil.copytree(animated.parent, tmp_path / "out")
    command = ["run", "two_pads", "-o", str(tmp_path / "out"), "-q"]
    assert main(command) == 0 and (tmp_path / "out" / "two_pads" / ANIMATION).is_file()
    assert main([*command, "--no-yade"]) == 0 and not (tmp_path / "out" / "two_pads" / ANIMATION).exists()


@pytest.mark.slow
@pytest.mark.usefixtures("plain_figures")
def test_results_without_yade_stay_so_beside_the_record_of_an_earlier_run(
    animated: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`crosscheck report` leaves out a record older than the comparison. A newer record, such as one of another machine, counts."""
    folder = shutil.copytree(animated.parent, tmp_path / "out") / "two_pads"

    def verdict_of_report() -> str:
        assert main(["report", str(folder), "-q"]) == 0
        return str(json.loads((folder / "comparison.json").read_text(encoding="utf-8"))["verdict"])

    assert verdict_of_report() == "agree"
    assert main(["run", "two_pads", "-o", str(folder.parent), "-q", "--no-yade"]) == 0
    assert verdict_of_report() == "expected" and comparison.read(folder).yade is None
    later = (folder / "comparison.json").stat().st_mtime + 1.0
    os.utime(folder / "run.h5", (later, later))
    assert verdict_of_report() == "agree"
    capsys.readouterr()
    assert main(["animate", str(folder), "--fps", str(FPS), "-q", "--no-yade"]) == 0
    assert "--no-yade: without effect" in " ".join(capsys.readouterr().err.split())


@pytest.mark.usefixtures("plain_figures")
def test_a_scene_that_cannot_move_leaves_the_others_their_animation(
    tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    text = two_pads.split("[expected]", maxsplit=1)[0]
    falls = text.replace("from = [0.5, 0.0, -0.1], to = [1.0, 0.2, 0.0]", "from = [0.4, 0.0, -0.1], to = [0.45, 0.2, 0.0]")
    Path("falls.toml").write_text(falls, encoding="utf-8")
    Path("moves.toml").write_text(text, encoding="utf-8")
    assert main(["run", "falls.toml", "moves.toml", "--no-yade", "-q", "-o", "out"]) == CANNOT_STAND
    capsys.readouterr()
    assert main(["animate", "out", "--fps", "1", "-q"]) == CANNOT_STAND
    told = capsys.readouterr()
    assert told.out.split() == [str(Path("out") / "moves" / ANIMATION)] and "falls" in told.err and "nothing moves" in told.err


@pytest.mark.yade
@pytest.mark.slow
@pytest.mark.usefixtures("plain_figures")
def test_a_scene_is_run_first_and_its_title_is_text(
    tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("CROSSCHECK_OUTPUT")
    text = two_pads.split("[expected]", maxsplit=1)[0].replace('title   = "', f'title   = "{HOSTILE} ', 1)
    Path("$x$.toml").write_text(text.replace('name    = "block"', f'name    = "{HOSTILE}"'), encoding="utf-8")
    assert main(["animate", "$x$.toml", "--fps", "1", "-o", "a $b$.gif", "--json", "-q"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made == {"scene": "$x$", "file": "a $b$.gif", "frames": SECONDS + 1, "bytes": Path("a $b$.gif").stat().st_size}
    assert (Path("crosscheck-results") / "$x$" / "run.h5").is_file()
    assert len(pictures(Path("a $b$.gif"))) == SECONDS + 1


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["ferris_tin_loi_1", "-o", "x.png"], 2, "ends in .gif or .mp4"),
        (["two_pads", "--fps", "0"], 2, "whole number from 1 to 50"),
        (["."], 2, "holds no results of `crosscheck run`"),
        (["no such scene"], 2, "neither a file nor a shipped scene"),
    ],
)
def test_what_is_wrong_is_said(
    words: list[str], code: int, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    try:
        found = main(["animate", *words])
    except SystemExit as stop:
        found = int(str(stop.code))
    assert found == code and said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("plain_figures")
def test_results_of_several_scenes_and_of_what_cannot_move_are_refused(
    animated: Path, tmp_path: Path, two_pads: str, capsys: pytest.CaptureFixture[str]
) -> None:
    for name in ("a", "b"):
        shutil.copytree(animated, tmp_path / "several" / name)
    assert main(["animate", str(tmp_path / "several"), "-o", str(tmp_path / "x.gif"), "-q"]) == 2
    assert "name one of the folders: a, b" in capsys.readouterr().err
    text = two_pads.replace("to = [1.0, 0.2, 0.0]", "to = [0.45, 0.2, 0.0]").replace("from = [0.5, 0.0, -0.1]", "from = [0.4, 0.0, -0.1]")
    (tmp_path / "falls.toml").write_text(text.split("[expected]", maxsplit=1)[0])
    assert main(["run", str(tmp_path / "falls.toml"), "-o", str(tmp_path / "one"), "--no-yade", "-q"]) == 5
    assert main(["animate", str(tmp_path / "one"), "-q"]) == 5  # the only scene in its folder
    assert "nothing moves" in capsys.readouterr().err


def test_an_mp4_needs_ffmpeg_and_says_so(
    animated: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert main(["animate", str(animated), "-o", str(tmp_path / "a.mp4"), "-q"]) == 3
    said = capsys.readouterr().err
    assert said.startswith("error: ffmpeg: not installed") and "apt-get install ffmpeg" in said and ".gif" in said
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_an_mp4_has_its_frames(animated: Path, tmp_path: Path) -> None:
    path = tmp_path / "a.mp4"
    assert main(["animate", str(animated), "-o", str(path), "--fps", "5", "-q"]) == 0
    report = subprocess.run(["ffmpeg", "-i", str(path), "-f", "null", os.devnull], capture_output=True, text=True, check=True).stderr
    assert f"frame= {round((SECONDS + animation.HOLD) * 5 + 1):4d}" in report


@pytest.mark.usefixtures("plain_figures")
def test_a_mechanism_alone_is_animated_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert (SHIPPED / "ferris_tin_loi_1.toml").is_file()
    assert main(["run", "ferris_tin_loi_1", "--no-yade", "-o", str(tmp_path), "-q"]) == 0
    assert main(["animate", str(tmp_path), "--fps", "1", "-q"]) == 0
    frames = pictures(tmp_path / "ferris_tin_loi_1" / ANIMATION)
    assert len(frames) == SECONDS + 1 and np.any(frames[0] != frames[-1])
    capsys.readouterr()


@pytest.mark.parametrize(
    ("name", "code", "said"), [("x.mp4", TOOL, "ffmpeg: not installed"), ("nodir/x.gif", USAGE, "its folder nodir does not exist")]
)
def test_what_is_missing_for_the_file_is_told_before_the_scene_is_run(
    name: str, code: int, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("shutil.which", lambda program: None)
    assert main(["animate", "two_pads", "--no-yade", "-o", name, "-q"]) == code
    assert said in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_a_full_disk_names_the_file_that_could_not_be_written(
    cross_checked: Callable[[str], CrossChecked], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(writer: animation.GifWriter) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    found = cross_checked("two_pads")
    monkeypatch.setattr(animation.GifWriter, "finish", fail)
    with pytest.raises(OSError, match="No space left") as told:
        animation.write_animation(Story(Results(found.analysis, found.run)), tmp_path / "x.gif", 1, lambda done, of: None)
    assert message_of(told.value).split(": ")[0].endswith("animation.gif")
