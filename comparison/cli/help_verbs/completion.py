"""`crosscheck completion`: print the script that completes commands, options, scenes, campaigns, files and folders in a shell."""

import argparse
from collections.abc import Iterable, Iterator
from typing import Any

import shtab

from comparison.campaign import shipped_campaigns
from comparison.cli import arguments
from comparison.cli.argument_types import PAGE_FORMATS
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.cli.help_verbs.tutorial import NAMES
from comparison.run_folder import FIGURE_FORMATS, MOVING_FORMATS
from la_core.scene import SOURCE_FORMATS, shipped, starter_names, tables_of_schema

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
    """Print the completion script of one shell."""
    shell = context.options.shell
    text = script(arguments.parser(), shell)
    if context.options.json:
        context.print_json({"shell": shell, "script": text})
    else:
        print(text)
    return AGREE


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """Return the completion script of a command line for one of `arguments.SHELLS`."""
    _set_completions(parser)
    text = shtab.complete(parser, shell)
    return text.replace('"(*):', '"*:') if shell == "zsh" else text  # else zsh completes only the first of several scenes


def _set_completions(parser: argparse.ArgumentParser) -> None:
    """Set the completions that shtab offers for each argument, by the argument's metavar."""
    scene, campaign = _named_or_file("scene", shipped.names()), _named_or_file("campaign", shipped_campaigns())
    of_kind = {"SCENE": scene, "DIR|SCENE": scene, "FILE": campaign} | dict.fromkeys(("DIR", "DIR1", "DIR2", "FOLDER"), shtab.DIRECTORY)
    formats = {"FIG": FIGURE_FORMATS, "MOVIE": MOVING_FORMATS, "PAGE": PAGE_FORMATS}
    formats["SOURCE"] = SOURCE_FORMATS
    of_kind |= {kind: shtab.glob(*(f"*{ending}" for ending in endings)) for kind, endings in formats.items()}
    words = {"NAME": NAMES, "KIND": starter_names(), "TABLE": tables_of_schema()}
    for action in actions(parser):
        if action.metavar in of_kind:
            action.complete = of_kind[action.metavar]  # type: ignore[attr-defined]  # where shtab looks
        elif action.metavar in words:
            action.choices = words[action.metavar]


def _named_or_file(kind: str, known: Iterable[str]) -> dict[str, Any]:
    """Return the completion by name or TOML file for a kind of input ('scene' or 'campaign') with these shipped names."""
    function, names = f"_crosscheck_{kind}_or_file", " ".join(known)
    texts = {"bash": _BASH, "zsh": _ZSH, "fish": _FISH}
    preambles = {shell: text.format(function=function, kind=kind, names=names) for shell, text in texts.items()}
    return {"bash": function, "zsh": function, "fish": f"({function})", "preamble": preambles}


def actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Yield the actions of a parser and of its sub-parsers."""
    for action in parser._actions:  # argparse has no public list of them; shtab reads this one too
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for sub in action.choices.values():
                yield from actions(sub)
