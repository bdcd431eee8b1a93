"""`crosscheck completion`: the script by which a shell completes commands, options, shipped scenes and campaigns, files and folders."""

import argparse
from collections.abc import Iterable, Iterator
from typing import Any

import shtab

from comparison.campaign import shipped_campaigns
from comparison.cli import arguments
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.cli.help_verbs.tutorial import NAMES
from la_core.scene import shipped

_BASH = """
# $1: the word so far; "_file" in the name has bash treat folders as folders
{function}() {{
  compgen -W "{names}" -- "$1"
  compgen -f -X '!*.toml' -- "$1"
  compgen -d -- "$1"
}}
"""
_ZSH = """
{function}() {{
  _alternative '{kind}s:shipped {kind}:({names})' 'files:{kind} file:_files -g "*.toml"'
}}
"""
_FISH = """
function {function}
  printf '%s\\n' {names}
  __fish_complete_suffix .toml
end
"""


def execute(context: Context) -> int:
    """Print the script of one shell."""
    shell = context.options.shell
    text = script(arguments.parser(), shell)
    if context.options.json:
        context.print_json({"shell": shell, "script": text})
    else:
        print(text)
    return AGREE


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """The completion script of a whole command line for a shell that `arguments.SHELLS` names."""
    _say_what_completes(parser)
    text = shtab.complete(parser, shell)
    return text.replace('"(*):', '"*:') if shell == "zsh" else text  # else zsh would complete the first of several scenes alone


def _say_what_completes(parser: argparse.ArgumentParser) -> None:
    """Tell shtab, by the name of an argument's value, what to offer for it."""
    scene, campaign = _named_or_file("scene", shipped.names()), _named_or_file("campaign", shipped_campaigns())
    of_kind = {"SCENE": scene, "DIR|SCENE": scene, "FILE": campaign} | dict.fromkeys(("DIR", "DIR1", "DIR2", "FOLDER"), shtab.DIRECTORY)
    formats = {"FIG": arguments.FIGURE_FORMATS, "MOVIE": arguments.MOVING_FORMATS, "PAGE": arguments.PAGE_FORMATS}
    of_kind |= {kind: shtab.glob(*(f"*{ending}" for ending in endings)) for kind, endings in formats.items()}
    for action in actions(parser):
        if action.metavar in of_kind:
            action.complete = of_kind[action.metavar]  # type: ignore[attr-defined]  # where shtab looks
        elif action.metavar == "NAME":
            action.choices = NAMES


def _named_or_file(kind: str, known: Iterable[str]) -> dict[str, Any]:
    """What completes to a shipped thing's name, or to a TOML file."""
    function, names = f"_crosscheck_{kind}_or_file", " ".join(known)
    texts = {"bash": _BASH, "zsh": _ZSH, "fish": _FISH}
    preambles = {shell: text.format(function=function, kind=kind, names=names) for shell, text in texts.items()}
    return {"bash": function, "zsh": function, "fish": f"({function})", "preamble": preambles}


def actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """What a parser and the parsers of its commands take."""
    for action in parser._actions:  # argparse has no other list of them, and shtab reads this one, too
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for sub in action.choices.values():
                yield from actions(sub)
