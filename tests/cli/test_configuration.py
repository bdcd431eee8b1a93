"""Settings from files and the environment: their precedence, and the messages on invalid settings."""

import contextlib
import json
import os
import pickle
import re
from pathlib import Path

import pytest
from campaigns import Inline

from comparison import settings
from comparison.campaign.job import Job
from comparison.cli.commands import main
from comparison.cli.exit_codes import TOOL, USAGE
from comparison.settings import MOST_WORKERS, Settings
from comparison.yade.installation import Yade, find_yade
from la_core.errors import SceneError

SOLVE = ["solve", "two_pads", "-q"]


@pytest.fixture(autouse=True)
def in_a_folder_of_its_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "home"))
    monkeypatch.delenv("CROSSCHECK_OUTPUT")


def user_says(text: str) -> Path:
    path = Path("home/crosscheck/config.toml").absolute()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def folder_says(text: str) -> Path:
    path = Path("crosscheck.toml")
    path.write_text(text)
    return path


def ran_into() -> str:
    """Return the name of the one folder that `run` makes here."""
    assert main(["run", "two_pads", "--no-yade", "-q"]) == 0
    (report,) = Path().glob("*/report.html")
    return report.parent.name


@pytest.mark.yade
def test_without_a_configuration_the_defaults_hold(plain_figures: None) -> None:
    found = settings.load_settings()
    assert found.settings == Settings() and not found.sources
    assert ran_into() == "crosscheck-results"


def test_what_is_nearer_to_the_command_holds(plain_figures: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command line precedes the environment, the folder's file, the user's file and the default. Each setting names its source."""
    nearer = [settings.load_settings()]
    user = user_says('output = "by-user"\ntime_limit = 5')
    nearer.append(settings.load_settings())
    folder_says('output = "by-folder"')
    nearer.append(settings.load_settings())
    monkeypatch.setenv("CROSSCHECK_OUTPUT", "by-environment")
    nearer.append(settings.load_settings())
    assert [str(one.settings.output) for one in nearer] == ["crosscheck-results", "by-user", "by-folder", "by-environment"]
    assert [one.source("output") for one in nearer] == ["default", str(user), "crosscheck.toml", "CROSSCHECK_OUTPUT"]
    assert [one.settings.time_limit for one in nearer] == [None, 5.0, 5.0, 5.0]  # each setting is taken by itself, not with its whole file
    assert ran_into() == "by-environment"
    assert main(["run", "two_pads", "--no-yade", "-q", "-o", "by-command"]) == 0
    assert Path("by-command/report.html").exists() and not Path("by-folder").exists()


@pytest.mark.yade
def test_a_time_limit_reaches_yade_and_the_command_line_s_goes_before(monkeypatch: pytest.MonkeyPatch) -> None:
    limits = []
    monkeypatch.setattr("comparison.cli.scene_verbs.run.run_scene", lambda *given: limits.append(given[-1]) or {})
    monkeypatch.setattr("comparison.cli.conclude.conclude", lambda *given: 0)
    folder_says("time_limit = 7")
    assert main(["run", "two_pads"]) == 0
    assert main(["run", "two_pads", "--time-limit", "9"]) == 0
    assert limits == [7.0, 9.0]


def test_a_time_limit_reaches_the_cases_of_a_campaign(monkeypatch: pytest.MonkeyPatch) -> None:
    limits = []

    class Engine(Inline):
        def begin(self, job: Job) -> None:
            limits.append(pickle.loads(pickle.dumps(job)).time_limit)  # as a worker receives it
            super().begin(job)

    def hears(scene: object, folder: object, listener: object, yade: bool, time_limit: float | None) -> None:
        limits.append(time_limit)
        raise SceneError("here", "is enough")

    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Engine())
    monkeypatch.setattr("comparison.campaign.job.run_scene", hears)
    Path("one.toml").write_text('[[sweep]]\nscene = "two_pads"')
    assert main(["campaign", "one.toml", "-q"]) == TOOL
    folder_says("time_limit = 7")
    assert main(["campaign", "one.toml", "-q"]) == TOOL
    assert main(["campaign", "one.toml", "-q", "--time-limit", "9"]) == TOOL
    assert limits == [None, None, 7.0, 7.0, 9.0, 9.0]


@pytest.mark.parametrize("workers", [0, 1, MOST_WORKERS, MOST_WORKERS + 1])
def test_the_command_line_and_the_configuration_take_equally_many_workers(workers: int, capsys: pytest.CaptureFixture[str]) -> None:
    command = ["campaign", "nowhere.toml", "-q"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CROSSCHECK_WORKERS", str(workers))
        assert main(command) == USAGE
    configured = "nowhere.toml" in capsys.readouterr().err  # else the number is refused before the file is looked for
    with contextlib.suppress(SystemExit):
        main([*command, "--workers", str(workers)])
    assert configured == ("error: nowhere.toml" in capsys.readouterr().err) == (1 <= workers <= MOST_WORKERS)


def test_an_empty_variable_says_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in Settings.model_fields:
        monkeypatch.setenv(f"CROSSCHECK_{name.upper()}", "")
    assert settings.load_settings().settings == Settings()


def test_a_home_is_written_out(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("HOME", str(tmp_path))
    user_says('output = "~/results"')
    assert settings.load_settings().settings.output == tmp_path / "results"


def test_a_home_for_configurations_must_be_a_whole_path(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """By the XDG Base Directory Specification, a relative or empty path counts as unset."""
    monkeypatch.setenv("HOME", str(tmp_path))
    for variable in ("relative", ""):
        monkeypatch.setenv("XDG_CONFIG_HOME", variable)
        assert settings.load_settings().files[0] == tmp_path / ".config" / "crosscheck" / "config.toml"


WRONG = {
    "misspelt": ('ouput = "x"', ("ouput", "unknown key", '"output"')),
    "of mechanics": ("friction = 0.6", ("friction", "unknown key")),
    "not a number": ('time_limit = "soon"', ("time_limit = 'soon'", "must be a number")),
    "a time of nothing": ("time_limit = 0", ("time_limit = 0", "greater than 0")),
    "no time at all": ("time_limit = nan", ("time_limit = nan", "finite")),
    "half a worker": ("workers = 1.5", ("workers = 1.5", "whole number")),
    "nobody works": ("workers = 0", ("workers = 0", "greater than or equal to 1")),
    "a path that is none": ("output = 3", ("output = 3", "path", "text in quotes")),
    "an empty path": ('output = ""', ("output", "path")),
    "what a terminal obeys": ('output = "\\u001b[2J"', ("output", "path")),
    "a stranger's home": ('output = "~nobody-of-that-name/x"', ("output", "no such user")),
    "not TOML": ("output = ", ("not valid TOML",)),
}


@pytest.mark.parametrize("says", [user_says, folder_says])
@pytest.mark.parametrize(("text", "words"), WRONG.values(), ids=WRONG)
def test_what_cannot_hold_is_said_with_file_key_value_and_rule(
    text: str, words: tuple[str, ...], says, capsys: pytest.CaptureFixture[str]
) -> None:
    path = says(text)
    for command in (SOLVE, ["doctor"], ["run", "two_pads", "--json"]):
        assert main(command) == USAGE
        captured = capsys.readouterr()
        assert captured.out == "" and captured.err.startswith(f"error: {path}") and captured.err.count("\n") == 1
        assert all(word in captured.err for word in words), captured.err
        assert "\x1b" not in captured.err


@pytest.mark.parametrize(
    ("name", "text", "rule"),
    [("TIME_LIMIT", "soon", "a number"), ("TIME_LIMIT", "-3", "greater"), ("TIME_LIMIT", "inf", "finite"), ("WORKERS", "many", "whole")],
)
def test_a_variable_that_cannot_hold_is_named(
    name: str, text: str, rule: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(f"CROSSCHECK_{name}", text)
    assert main(SOLVE) == USAGE
    said = capsys.readouterr().err
    assert said.startswith(f"error: CROSSCHECK_{name}: ") and text.strip("-") in said and rule in said and said.count("\n") == 1


@pytest.mark.parametrize("text", ['yade = "."', 'yade_python = "./evil"', 'output = "/tmp/x"', 'output = "../x"', 'output = "~/x"'])
def test_a_folder_of_others_says_neither_what_is_run_nor_where_else_files_go(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    user_says(text)
    assert main(SOLVE) == 0
    Path("home/crosscheck/config.toml").unlink()
    folder_says(text)
    assert main(SOLVE) == USAGE
    said = capsys.readouterr().err
    assert text.split(" = ", maxsplit=1)[0] in said and "CROSSCHECK_" in said


def test_a_configuration_that_might_never_end_is_not_waited_for(capsys: pytest.CaptureFixture[str]) -> None:
    os.mkfifo("crosscheck.toml")
    assert main(SOLVE) == USAGE
    assert "not a file" in capsys.readouterr().err
    Path("crosscheck.toml").unlink()
    folder_says("# " + "x" * settings.LARGEST_FILE)
    assert main(SOLVE) == USAGE
    assert "larger than" in capsys.readouterr().err
    Path("crosscheck.toml").write_bytes(b"output = '\xff'")
    assert main(SOLVE) == USAGE
    assert "not valid TOML" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.yade
def test_yade_is_looked_for_where_the_user_s_file_says(capsys: pytest.CaptureFixture[str]) -> None:
    elsewhere = Path("elsewhere")
    elsewhere.mkdir()
    (elsewhere / "yade").symlink_to(find_yade().modules / "yade")
    path = user_says('yade = "elsewhere"')
    assert find_yade().modules == elsewhere.absolute()
    path.write_text('yade = "nowhere"')
    assert main(["run", "two_pads", "-q", "-o", "out"]) == TOOL
    summary = json.loads(Path("out/two_pads/comparison.json").read_text())
    assert f"{path}: yade = nowhere holds no YADE" in summary["yade"]["message"]


def test_the_doctor_says_what_holds_and_from_where(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("comparison.cli.help_verbs.doctor.find_yade", lambda: Yade(Path("python"), Path("modules"), "2023.02a"))
    path = user_says("workers = 2")
    monkeypatch.setenv("CROSSCHECK_TIME_LIMIT", "60")
    monkeypatch.setenv("CROSSCHECK_OUTPT", "results")
    assert main(["doctor", "--json"]) == 0
    shown = json.loads(capsys.readouterr().out)["configuration"]
    assert set(shown["settings"]) == set(Settings.model_fields)
    assert shown["settings"]["workers"] == {"value": 2, "from": str(path)}
    assert shown["settings"]["time_limit"] == {"value": 60.0, "from": "CROSSCHECK_TIME_LIMIT"}
    assert shown["settings"]["output"] == {"value": "crosscheck-results", "from": "default"}
    assert shown["files"] == {str(path): True, "crosscheck.toml": False}
    (unknown,) = shown["unknown_variables"]
    assert "CROSSCHECK_OUTPT" in unknown and '"CROSSCHECK_OUTPUT"' in unknown
    assert main(["doctor"]) == 0
    printed = capsys.readouterr().out
    assert all(word in printed for word in (str(path), "CROSSCHECK_TIME_LIMIT", "not there", "CROSSCHECK_OUTPT"))


def test_the_table_of_the_page_is_that_of_the_settings() -> None:
    page = (Path(__file__).parents[2] / "comparison" / "cli" / "README.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| `(CROSSCHECK_\w+)` \| .* \| (.*) \|$", page, re.MULTILINE)
    assert [(name, variable) for name, variable, _ in rows] == [(name, f"CROSSCHECK_{name.upper()}") for name in Settings.model_fields]
    defaults = {name: default.strip("`") for name, _, default in rows}
    assert all(defaults[name] == str(value) for name, value in Settings() if value is not None)


def test_no_setting_is_a_word_of_a_scene() -> None:
    """A configuration must not be able to change an answer, so the keys of scenes and of configurations have different names."""
    from la_core.exchange.dem_settings import SETTINGS
    from la_core.scene.schema.scene_file import Joint, RequestedEffects, SceneFile, Stone

    of_a_scene = {name for table in (SceneFile, Joint, Stone, RequestedEffects) for name in table.model_fields} | set(SETTINGS)
    time_limit, the_table_of_yade = "time_limit", "yade"  # a time limit ends a run with a message; "yade" only names a table
    assert set(Settings.model_fields) & of_a_scene == {time_limit, the_table_of_yade}
