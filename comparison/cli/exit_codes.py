"""How a command ends: with an exit code of the contract and, where it could not do its work, one message on stderr."""

import io
import os
import sys
from collections.abc import Callable

from rich.console import Console

from comparison.errors import message_of
from la_core.errors import SceneError, visible

AGREE, DISAGREE, USAGE, TOOL, INCONCLUSIVE = range(5)
EXIT_OF_VERDICT = {"agree": AGREE, "disagree": DISAGREE, "inconclusive": INCONCLUSIVE, None: AGREE}
GRAVITY = (AGREE, INCONCLUSIVE, DISAGREE, TOOL)  # the gravest of several scenes decides
INTERRUPTED = 130  # as shells say it


def code_of(command: Callable[[], int]) -> int:
    """Exit code of a command, run to its end; whatever stops it is told in one message."""
    try:
        code = int(command())
        sys.stdout.flush()
        return code
    except (Exception, KeyboardInterrupt) as error:
        if isinstance(error, OSError) and error.filename is None:
            _let_go_of_stdout()
        return complain(message_of(error), _code(error))


def _code(error: BaseException) -> int:
    return USAGE if isinstance(error, SceneError) else INTERRUPTED if isinstance(error, KeyboardInterrupt) else TOOL


def complain(message: str, code: int) -> int:
    """Say what went wrong, with nothing in it that a terminal would obey; returns the exit code."""
    Console(stderr=True, highlight=False, emoji=False, soft_wrap=True).print(f"error: {visible(message)}", markup=False)
    return code


def _let_go_of_stdout() -> None:
    """What could not be written must not fail again when the interpreter ends."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
