"""How a command ends: with an exit code of the contract and, where it could not do its work, one message on stderr."""

import io
import os
import sys
from collections.abc import Callable

from rich.console import Console

from comparison.files import FolderInUseError
from comparison.launch import YadeFailedError, YadeMissingError
from la_core.errors import SceneError, visible
from la_core.exchange import ExchangeError

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


def message_of(error: BaseException) -> str:
    """What stopped a command, in one message."""
    if isinstance(error, SceneError | ExchangeError | FolderInUseError | YadeMissingError | YadeFailedError):
        return str(error)
    if isinstance(error, OSError):
        return f"{error.filename or 'standard output'}: {error.strerror or error}"  # what writes files names them
    if isinstance(error, MemoryError):
        return f"the memory does not suffice ({error}); take fewer blocks, or a machine with more"
    if isinstance(error, KeyboardInterrupt):
        return "stopped; what was finished is kept, the same command goes on from there"
    return f"unexpected {type(error).__name__}: {error}; this is a fault of the program, please report it"


def complain(message: str, code: int) -> int:
    """Say what went wrong, with nothing in it that a terminal would obey; returns the exit code."""
    Console(stderr=True, highlight=False, emoji=False, soft_wrap=True).print(f"error: {visible(message)}", markup=False)
    return code


def _let_go_of_stdout() -> None:
    """What could not be written must not fail again when the interpreter ends."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
