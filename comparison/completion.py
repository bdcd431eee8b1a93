"""Scripts by which a shell completes the command line: commands, options, shipped scenes, files and folders."""

import argparse
from collections.abc import Iterator

import shtab

from comparison import shipped
from comparison.arguments import FIGURE_FORMATS

_BASH = """
# $1: the word so far; "_file" in the name has bash treat folders as folders
_crosscheck_scene_or_file() {{
  compgen -W "{names}" -- "$1"
  compgen -f -X '!*.toml' -- "$1"
  compgen -d -- "$1"
}}
"""
_ZSH = """
_crosscheck_scene_or_file() {{
  _alternative 'scenes:shipped scene:({names})' 'files:scene file:_files -g "*.toml"'
}}
"""
_FISH = """
function _crosscheck_scene_or_file
  printf '%s\\n' {names}
  __fish_complete_suffix .toml
end
"""


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """The completion script of a whole command line for a shell that `arguments.SHELLS` names."""
    names = " ".join(shipped.names())
    scene = {
        "bash": "_crosscheck_scene_or_file",
        "zsh": "_crosscheck_scene_or_file",
        "fish": "(_crosscheck_scene_or_file)",
        "preamble": {"bash": _BASH.format(names=names), "zsh": _ZSH.format(names=names), "fish": _FISH.format(names=names)},
    }
    figure = shtab.glob(*(f"*{ending}" for ending in FIGURE_FORMATS))
    of_kind = {"SCENE": scene, "DIR|SCENE": scene, "DIR": shtab.DIRECTORY, "FOLDER": shtab.DIRECTORY, "FIG": figure}
    for action in _actions(parser):
        if isinstance(action.metavar, str) and action.metavar in of_kind:
            action.complete = of_kind[action.metavar]  # type: ignore[attr-defined]  # where shtab looks
    text = shtab.complete(parser, shell)
    return text.replace('"(*):', '"*:') if shell == "zsh" else text  # else zsh would complete the first of several scenes alone


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """What a parser and the parsers of its commands take."""
    for action in parser._actions:  # argparse has no other list of them, and shtab reads this one, too
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for sub in action.choices.values():
                yield from _actions(sub)
