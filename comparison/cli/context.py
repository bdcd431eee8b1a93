"""The context of a verb: its options and its consoles."""

import argparse
import json
import os
import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from rich.console import Console
from rich.table import Table

from comparison.cli.layout import columns_asked, say, show_table
from comparison.errors import StderrConsole
from la_core.errors import visible
from la_core.scene import Scene

PIPE_WIDTH = 120  # columns of a file or a pipe, unless COLUMNS says otherwise


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
        return cls(options, StderrConsole(options.quiet), _results_console())

    def warn(self, scene: Scene) -> None:
        """Print the warnings about a scene on stderr, one paragraph each, also with `--quiet`."""
        for warning in scene.warnings:
            self.warn_of(scene.name, warning)

    def warn_of(self, what: str, warning: str) -> None:
        """Print one warning on stderr, also with `--quiet`; `what` names its subject."""
        say(StderrConsole(), visible(f"warning: {what}: {warning}"))

    def table(self, table: Table, can_go: Sequence[str] = ()) -> None:
        """Print a table on stdout; `can_go`: columns that a narrow table leaves out without `--long`, in this order."""
        show_table(self.out, table, can_go, getattr(self.options, "long", False))

    def tell(self, text: str) -> None:
        """Print sentences of a result on stdout, broken between words at the width of a terminal."""
        say(self.out, text)

    def narrate(self, text: str) -> None:
        """Print narration on stderr, unless it is silent, broken between words at the width of a terminal."""
        say(self.narrator, text)

    def show_report(self, page: Path) -> None:
        """Print the path of a report, and a note where the PDF beside it is of an earlier report."""
        self.out.print(f"report: {os.path.relpath(page)}", markup=False)
        printed = page.with_suffix(".pdf")
        if printed.exists() and printed.stat().st_mtime < page.stat().st_mtime:
            again = f"`crosscheck report {shlex.quote(os.path.relpath(page.parent))} --pdf`"
            self.narrate(f"{os.path.relpath(printed)} is of an earlier report; {again} prints this one")

    def print_json(self, value: dict[str, Any]) -> None:
        """Print one JSON object on stdout; raises ValueError for NaN or an infinite number."""
        print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def _results_console() -> Console:
    """Return a console with the width in COLUMNS, else of the terminal, else PIPE_WIDTH; only tables are fitted to this width."""
    asked = columns_asked()
    console = Console(highlight=False, emoji=False, soft_wrap=True, width=asked)
    if asked is None and not console.is_terminal:
        return Console(highlight=False, emoji=False, soft_wrap=True, width=PIPE_WIDTH)
    return console
