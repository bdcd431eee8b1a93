"""The context of a verb: its options and its consoles."""

import argparse
import json
import os
from dataclasses import dataclass
from typing import Any, Self

from rich.console import Console

from la_core.errors import visible
from la_core.scene import Scene

PIPE_WIDTH = 120  # columns of a file or a pipe, unless COLUMNS says otherwise
LEAST_WIDTH = 40  # columns: below, a table is unreadable however it is laid out


@dataclass(frozen=True)
class Context:
    """Options and consoles of a verb.

    Attributes
    ----------
    options : argparse.Namespace
        Options of the command line, completed from the settings.
    narrator : Console
        Console for narration (stderr), silent with `--quiet`.
    out : Console
        Console for results (stdout).
    """

    options: argparse.Namespace
    narrator: Console
    out: Console

    @classmethod
    def of(cls, options: argparse.Namespace) -> Self:
        """Return the context of these options."""
        narrator = Console(stderr=True, quiet=options.quiet, highlight=False, emoji=False, soft_wrap=True)
        return cls(options, narrator, _results_console())

    def warn(self, scene: Scene) -> None:
        """Print what is implausible about a scene on stderr, one line each, also with `--quiet`."""
        console = Console(stderr=True, highlight=False, emoji=False, soft_wrap=True)
        for warning in scene.warnings:
            console.print(visible(f"warning: {scene.name}: {warning}"), markup=False)

    def print_json(self, value: dict[str, Any]) -> None:
        """Print one JSON object on stdout; raises ValueError for NaN or an infinite number."""
        print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def _results_console() -> Console:
    """Return a console as wide as COLUMNS says, else as the terminal, else PIPE_WIDTH; only tables are fitted to it."""
    columns = os.environ.get("COLUMNS", "")
    asked = max(int(columns), LEAST_WIDTH) if columns.isdecimal() and len(columns) < 5 and int(columns) else None
    console = Console(highlight=False, emoji=False, soft_wrap=True, width=asked)
    if asked is None and not console.is_terminal:
        return Console(highlight=False, emoji=False, soft_wrap=True, width=PIPE_WIDTH)
    return console
