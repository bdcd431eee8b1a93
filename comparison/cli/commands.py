"""Entry of the command line: parse the arguments, load the verb's module, run it.

Results go to stdout, narration to stderr. This module has no mechanics.
"""

import argparse
import importlib
import io
import signal
import sys
from collections.abc import Callable, Sequence

from comparison.cli.arguments import parser
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, code_of
from comparison.cli.guessing_parser import parse
from comparison.settings import filled

COMMANDS = {  # by verb: the module whose `execute` runs it, loaded only for that verb
    "new": "comparison.cli.help_verbs.new",
    "schema": "comparison.cli.help_verbs.schema",
    "scenes": "comparison.cli.scene_verbs.scenes",
    "show": "comparison.cli.scene_verbs.show",
    "solve": "comparison.cli.scene_verbs.solve",
    "sensitivity": "comparison.cli.study_verbs.sensitivity",
    "cost": "comparison.cli.study_verbs.cost",
    "run": "comparison.cli.scene_verbs.run",
    "campaign": "comparison.cli.study_verbs.campaign",
    "compare": "comparison.cli.study_verbs.compare",
    "report": "comparison.cli.scene_verbs.report",
    "export": "comparison.cli.scene_verbs.export",
    "animate": "comparison.cli.scene_verbs.animate",
    "tutorial": "comparison.cli.help_verbs.tutorial",
    "doctor": "comparison.cli.help_verbs.doctor",
    "completion": "comparison.cli.help_verbs.completion",
}
CONTINUED = ("run", "campaign")
CONTINUES = "finished stages are kept, and the same command continues from there"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return its exit code, see `exit_codes.MEANINGS`."""
    if arguments is None:
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # a closed pipe ends the program quietly, as for other programs
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that is not UTF-8 gets escapes instead of an error
    return code_of(lambda: _execute(parse(parser(), arguments)))


def _execute(options: argparse.Namespace | None) -> int:
    if options is None:  # only help was requested
        return AGREE
    context = Context.of(filled(options))
    execute: Callable[[Context], int] = importlib.import_module(COMMANDS[options.verb]).execute
    try:
        return execute(context)
    except KeyboardInterrupt as stop:
        raise (KeyboardInterrupt(CONTINUES) if options.verb in CONTINUED else stop) from None
