"""A parser of the command line that suggests the nearest command or option for a misspelt one, and takes options before the command."""

import argparse
import contextlib
import itertools
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from comparison.cli.exit_codes import USAGE
from la_core.errors import nearest, visible

BEFORE_THE_VERB = ("-q", "--quiet", "--json")  # options of every verb, which may also stand before it


class GuessingParser(argparse.ArgumentParser):
    """A parser that names the nearest valid word for a misspelt one; its message has the form of every other error."""

    def error(self, message: str) -> NoReturn:
        """End with exit code 2 and one message."""
        told = f"{visible(message)}{'' if message.endswith('?') else ';'} `{self.prog} --help` lists what is valid"
        with contextlib.suppress(OSError):  # where stderr cannot be written, the exit code still tells of the error
            print(f"error: {told}", file=sys.stderr)
        raise SystemExit(USAGE)

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            choices = [str(choice) for choice in action.choices]
            kind = "commands" if isinstance(action, argparse._SubParsersAction) else "values"
            raise argparse.ArgumentError(None, f'"{value}": unknown; {nearest(str(value), choices, kind)}')

    def chosen(self, options: argparse.Namespace) -> "GuessingParser":
        """Return the parser of the verb that was chosen, or this one where none was."""
        (verbs,) = (action for action in self._actions if isinstance(action, argparse._SubParsersAction))
        return verbs.choices.get(getattr(options, "verb", ""), self)

    def unknown(self, options: argparse.Namespace, words: Sequence[str]) -> NoReturn:
        """End with the nearest option of the chosen verb for each word that it does not know."""
        chosen = self.chosen(options)
        known = [word for word in chosen._option_string_actions if word.startswith("--")]
        told = (f'"{word}": unknown option; {nearest(word.split("=")[0], known, "options")}' for word in words if word.startswith("-"))
        GuessingParser.error(chosen, "; ".join(told) or f'"{" ".join(words)}": one argument too many')


def parse(whole: GuessingParser, arguments: Sequence[str] | None = None) -> argparse.Namespace | None:
    """Parse a command line by the parser of all commands; None for an empty one, which asks for help.

    Options that every verb has may stand before it. An invalid command line ends with exit code 2.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    early = list(itertools.takewhile(lambda word: word in BEFORE_THE_VERB, words))
    words = [*words[len(early) : len(early) + 1], *early, *words[len(early) + 1 :]]
    if not set(words) - set(BEFORE_THE_VERB):
        whole.print_help()
        return None
    options, rest = whole.parse_known_args(words)
    if rest and not _added(options, rest, whole.chosen(options)):
        whole.unknown(options, rest)
    if not hasattr(options, "verb"):
        whole.error("a command is missing")
    return options


def _added(options: argparse.Namespace, rest: Sequence[str], chosen: argparse.ArgumentParser) -> bool:
    """Add scenes or folders behind an option to those before it, the only ones that argparse takes; False for any other `rest`."""
    several = [action for action in chosen._actions if action.nargs == "+"]
    end = rest.index("--") if "--" in rest else len(rest)
    if not several or any(word.startswith("-") for word in rest[:end]):
        return False
    (action,) = several
    getattr(options, action.dest).extend(chosen._get_value(action, word) for word in (*rest[:end], *rest[end + 1 :]))
    return True
