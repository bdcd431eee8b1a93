"""Completion in a real shell: the words offered after the beginning of a line."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from comparison.campaign.definition import shipped_campaigns
from comparison.cli.arguments import SHELLS, parser
from comparison.cli.commands import COMMANDS, main
from comparison.cli.help_verbs import completion
from comparison.cli.help_verbs.tutorial import NAMES
from la_core.scene import shipped

BASH = shutil.which("bash")
IN_BASH = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
read -r _ _ function _ < <(complete -p crosscheck | grep -o -- '-F .*' | sed 's/^/x /')
"$function" crosscheck
printf '%s\\n' "${COMPREPLY[@]}"
"""


def script(shell: str, capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["completion", shell]) == 0
    captured = capsys.readouterr()
    assert captured.err == ""
    return captured.out


@pytest.fixture
def offered(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    """Return a function that gives bash's offers for the last of some words, in a folder with a scene file and a folder of results."""
    if BASH is None:
        pytest.skip("there is no bash here")
    path, here = tmp_path / "crosscheck.bash", tmp_path / "here"
    path.write_text(script("bash", capsys))
    (here / "results").mkdir(parents=True)
    for name in ("mine.toml", "mine.txt", "mine.png", "mine.gif", "mine.html"):
        (here / name).touch()

    def ask(*words: str) -> list[str]:
        command = [BASH, "--norc", "-c", IN_BASH, "bash", str(path), "crosscheck", *words]
        answer = subprocess.run(command, cwd=here, capture_output=True, text=True, check=True)
        assert answer.stderr == ""
        return sorted(answer.stdout.split())

    return ask


def test_every_command_is_offered(offered) -> None:
    assert offered("") == sorted(COMMANDS)
    assert offered("so") == ["solve"]


def test_a_scene_is_a_shipped_one_or_a_file_or_on_the_way_to_one(offered) -> None:
    assert offered("solve", "") == sorted([*shipped.names(), "mine.toml", "results"])
    assert offered("solve", "two") == ["two_blocks", "two_pads"]
    assert offered("run", "two_pads", "trilith", "arch_s") == ["arch_settling", "arch_spreading"]
    assert offered("run", "--no-yade", "-o", "results", "mi") == ["mine.toml"]


def test_options_folders_figures_and_shells_are_offered_where_they_belong(offered) -> None:
    assert offered("run", "--tim") == ["--time-limit"]
    assert offered("run", "two_pads", "-o", "") == ["results"]
    assert offered("solve", "--b") == ["--bounds"] and offered("solve", "--r") == ["--results"]
    assert offered("solve", "two_pads", "--results", "") == ["results"]
    assert offered("report", "") == ["results"]
    assert offered("show", "two_pads", "-o", "mi") == ["mine.png"]
    assert offered("completion", "") == sorted(SHELLS)


def test_campaigns_tutorials_animations_and_pages_are_offered_where_they_belong(offered) -> None:
    assert offered("campaign", "") == sorted([*shipped_campaigns(), "mine.toml", "results"])
    assert offered("campaign", "seed") == ["seed_paper"]
    assert offered("compare", "") == offered("compare", "results", "") == ["results"]
    assert offered("compare", "results", "results", "-o", "mi") == ["mine.html"]
    assert offered("tutorial", "") == sorted(NAMES)
    assert offered("animate", "two_pads", "-o", "mi") == ["mine.gif"]


def test_every_positional_and_every_output_says_what_completes_it() -> None:
    whole = parser()
    completion.script(whole, "bash")
    asked = [one for one in completion.actions(whole) if not one.option_strings or "-o" in one.option_strings]
    assert len(asked) > len(COMMANDS)
    assert [one.metavar for one in asked if one.choices is None and not hasattr(one, "complete")] == []


@pytest.mark.parametrize("shell", SHELLS)
def test_every_shell_s_script_knows_all_commands_and_scenes_and_is_its_language(
    shell: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = script(shell, capsys)
    assert all(name in text for name in (*COMMANDS, *shipped.names(), *shipped_campaigns(), *NAMES))
    assert main(["completion", shell, "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"shell": shell, "script": text.removesuffix("\n")}
    if (found := shutil.which(shell)) is not None:
        path = tmp_path / "script"
        path.write_text(text)
        subprocess.run([found, "-n", str(path)], check=True)
