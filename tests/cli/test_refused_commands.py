"""A refused or failed command says why in one message and ends with the exit code of its kind."""

import shutil
from argparse import ArgumentTypeError
from pathlib import Path

import pytest

from comparison.cli.arguments import parser
from comparison.cli.commands import main
from comparison.cli.help_verbs.completion import actions
from comparison.workflow import refuse_names_of_attempts
from la_core.errors import SceneError
from la_core.scene import load, shipped, variant


@pytest.mark.parametrize("verb", ["solve", "run", "export", "animate", "campaign"])
def test_a_name_that_no_file_can_have_is_a_slip_of_the_user(verb: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([verb, "x" * 5000]) == 2
    said = capsys.readouterr().err
    assert "cannot be read: File name too long; give the path of a" in said and len(said) < 300


@pytest.mark.parametrize(
    "words",
    ["report LONG", "compare LONG LONG", "run two_pads --no-yade -q -o LONG", "tutorial pads -q -o LONG", "show two_pads -q -o LONG.png"],
)
def test_a_folder_or_file_whose_name_no_disk_takes_is_a_slip_of_the_user(words: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(words.replace("LONG", "x" * 300).split()) == 2
    assert "File name too long; choose a shorter name" in capsys.readouterr().err


def test_what_names_nothing_is_not_taken_for_the_current_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """An unset variable of the shell names nothing, and so does a dot in place of a campaign."""
    (tmp_path / "two_pads").mkdir()
    (tmp_path / "two_pads" / "case.h5").touch()
    monkeypatch.chdir(tmp_path)
    for words, told in ((["export", ""], "names no scene"), (["animate", ""], "names no scene"), (["campaign", "."], "not a file")):
        assert main(words) == 2
        assert told in capsys.readouterr().err


def test_an_empty_path_is_refused_by_every_option_and_argument_that_takes_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`-o "$OUT"` with an unset variable once filled the current folder with results."""
    monkeypatch.chdir(tmp_path)
    paths = ("DIR", "DIR1", "DIR2", "FOLDER", "FIG", "MOVIE", "PAGE", "SOURCE", "FILE")
    for action in actions(parser()):
        if action.metavar in paths or (action.metavar == "SCENE" and action.option_strings):
            assert callable(action.type)
            with pytest.raises(ArgumentTypeError, match="must be the path of a file or folder"):
                action.type("")
    for words in ("run two_pads --no-yade -o", "solve two_pads --results", "tutorial wall -o", "new arch -o", "report", "compare x"):
        with pytest.raises(SystemExit) as stop:
            main([*words.split(), ""])
        said = capsys.readouterr().err
        assert stop.value.code == 2 and "must be the path of a file or folder; an unset variable" in said
    assert not list(tmp_path.iterdir())


def test_an_empty_address_of_a_scheduler_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`--scheduler "$ADDRESS"` with an unset variable once ran the campaign on the user's own machine."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as stop:
        main(["campaign", "seed_paper", "--no-yade", "--scheduler", ""])
    assert stop.value.code == 2 and "must be the address of a scheduler; an unset variable" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("friction = 0.6", "fricton = 0.6"), ("fricton", "friction")),
        (("friction = 0.6", "friction = -0.6"), ("joint.friction", "-0.6")),
        (("friction = 0.6", "friction = nan"), ("joint.friction", "nan")),
        (("[settlement]", "[settlement"), ("TOML",)),
    ],
)
def test_a_bad_scene_ends_with_code_2_and_one_message(
    change: tuple[str, str], words: tuple[str, ...], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    path.write_text(shipped.find("two_pads").read_text().replace(*change))
    for command in (["solve", str(path)], ["run", str(path), "-o", str(tmp_path / "out")], ["show", str(path)]):
        assert main(command) == 2
        captured = capsys.readouterr()
        assert captured.out == ""
        assert captured.err.startswith("error: ") and captured.err.count("\n") == 1
        assert "bad.toml" in captured.err and all(word in captured.err for word in words)
    assert not (tmp_path / "out").exists()


def test_unknown_scenes_and_commands_end_with_code_2(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["solve", "two_pds"]) == 2
    assert "two_pads" in capsys.readouterr().err
    with pytest.raises(SystemExit) as stop:
        main(["frobnicate"])
    assert stop.value.code == 2


@pytest.mark.parametrize("option", ["--title", "--project", "--author", "--date"])
@pytest.mark.parametrize("text", ["a\x1b[31mb", "a\udcffb", "a\u202eb"])
def test_words_for_a_report_are_refused_where_a_scene_file_refuses_them(
    option: str, text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for command in (["run", "two_pads", "--no-yade", "-o", str(tmp_path / "out")], ["report", str(tmp_path)]):
        with pytest.raises(SystemExit) as stop:
            main([*command, option, text])
        said = capsys.readouterr().err
        assert stop.value.code == 2 and "without control characters" in said and text not in said
    assert not (tmp_path / "out").exists()


def test_two_scenes_of_one_name_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    copy = tmp_path / "two_pads.toml"
    shutil.copy(shipped.find("two_pads"), copy)
    assert main(["run", "two_pads", str(copy), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert "same name" in capsys.readouterr().err


@pytest.mark.parametrize("words", [["--try-harder"], ["--try-harder-limit", "60"]])
def test_a_scene_with_the_name_of_another_one_s_second_attempt_is_refused(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The second attempt was once lost: the results of the other scene replaced its results."""
    paths = [tmp_path / f"{name}.toml" for name in ("x", "x_harder")]
    for path in paths:
        shutil.copy(shipped.find("two_pads"), path)
    assert main(["run", *map(str, paths), "-o", str(tmp_path / "out"), "--no-yade", *words]) == 2
    said = capsys.readouterr().err
    assert "is also the name of the second attempt" in said and all(str(path) in said for path in paths)
    assert not (tmp_path / "out").exists()
    refuse_names_of_attempts([variant(load(path), {"effort": "high"}, name=path.stem) for path in paths])  # no second attempt is left
    with pytest.raises(SceneError, match="is also the name of the second attempt"):  # YADE has finer settings left
        refuse_names_of_attempts([variant(load(path), {"effort": "high"}, name=path.stem) for path in paths], with_yade=True)


def test_an_expected_value_of_the_wrong_kind_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "wrong.toml"
    for line in ("multiplier = 3.0", ""):
        path.write_text(shipped.find("two_pads").read_text().split("[expected]")[0] + f'[expected]\nkind = "exact"\n{line}\n')
        assert main(["solve", str(path)]) == 2
        assert "reaction_over_weight" in capsys.readouterr().err


def test_a_bad_scene_is_refused_before_the_first_one_runs(tmp_path: Path) -> None:
    path = tmp_path / "floating.toml"
    lifted = ("from = [0.0, 0.0, 0.0], to = [1.0, 0.2, 0.5]", "from = [0.0, 0.0, 3.0], to = [1.0, 0.2, 3.5]")
    path.write_text(shipped.find("two_pads").read_text().replace(*lifted))
    assert main(["run", "two_pads", str(path), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert not (tmp_path / "out").exists()


def test_a_fault_of_the_program_is_never_taken_for_a_disagreement(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.scene_verbs.solve.limit_analysis_alone", lambda *arguments: 1 / 0)
    assert main(["solve", "two_pads"]) == 3
    assert "ZeroDivisionError" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ('title   = "', 'title   = "\\u0000', "title"),
        ("friction = 0.6", "friction = 1e300", "friction"),
        ("density = 2000.0", "density = 1e-300", "density"),
        ("gravity = [0.0, 0.0, -9.81]", "gravity = [0.0, 0.0, -1e-200]", "gravity"),
        ("[settlement]", "deep = " + "[" * 20_000 + "\n[settlement]", "TOML"),
    ],
)
def test_absurd_values_are_refused_with_a_sentence(
    old: str, new: str, word: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "absurd.toml"
    text = shipped.find("two_pads").read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert word in capsys.readouterr().err


def test_a_path_needs_friction_that_does_not_dilate(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tmp_path / "scene.toml"
    text = shipped.find("two_pads").read_text() + '\n[effects]\nfriction = "associated"\n'
    scene.write_text(text)
    assert main(["solve", str(scene), "--path"]) == 2
    scene.write_text(text + "[path]\nincrements = 5\n")
    assert main(["solve", str(scene)]) == 2
    assert "[path]" in capsys.readouterr().err


def test_the_name_of_stored_results_alone_is_answered_with_their_folder(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The scene may be gone while its results are stored. Commands that read results say where they are."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CROSSCHECK_OUTPUT", "results")
    shutil.copy(shipped.find("two_pads"), "mine.toml")
    assert main(["run", "mine.toml", "--no-yade", "-q"]) == 0
    assert main(["report", "mine.toml"]) == 2  # the scene file still exists
    assert f'did you mean "{Path("results", "mine")}"?' in capsys.readouterr().err
    Path("mine.toml").unlink()
    for command in ("export", "animate", "report"):
        capsys.readouterr()
        assert main([command, "mine"]) == 2
        assert f'did you mean "{Path("results", "mine")}"?' in capsys.readouterr().err
    assert main(["export", "yours"]) == 2
    assert "did you mean" not in capsys.readouterr().err
    for command in ("export", "animate"):  # instead of a list of the shipped scenes
        assert main([command, str(Path("results", "mime"))]) == 2
        assert 'neither a folder of results, a file nor a shipped scene; did you mean "mine"?' in capsys.readouterr().err
