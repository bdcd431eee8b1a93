"""The context in which a verb runs: its options, and where it prints."""

import argparse
import json
from dataclasses import dataclass
from typing import Any, Self

from rich.console import Console

PIPE_WIDTH = 120  # columns


@dataclass(frozen=True)
class Context:
    """Options of the command line, filled from the settings; a console for narration (stderr) and one for results (stdout)."""

    options: argparse.Namespace
    narrator: Console
    out: Console

    @classmethod
    def of(cls, options: argparse.Namespace) -> Self:
        """The context of these options; the narrator is silent with `--quiet`."""
        narrator = Console(stderr=True, quiet=options.quiet, highlight=False, emoji=False, soft_wrap=True)
        return cls(options, narrator, _results_console())

    def print_json(self, value: dict[str, Any]) -> None:
        """Print one JSON object on stdout; raises ValueError for a number that JSON does not have."""
        print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def _results_console() -> Console:
    """As wide as the terminal, or wide enough for a table in a file or pipe; text is never cut or broken."""
    console = Console(highlight=False, emoji=False, soft_wrap=True)
    return console if console.is_terminal else Console(highlight=False, emoji=False, soft_wrap=True, width=PIPE_WIDTH)
