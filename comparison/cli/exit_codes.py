"""Exit codes of all commands; a command that fails ends with one message on stderr."""

import errno
import io
import os
import sys
from collections.abc import Callable

from comparison.cli.layout import say
from comparison.errors import StderrConsole, message_of
from la_core.errors import CannotStandError, SceneError, visible

AGREE, DISAGREE, USAGE, TOOL, INCONCLUSIVE, CANNOT_STAND = range(6)
INTERRUPTED = 130  # as shells define it: 128 + SIGINT
EXIT_OF_VERDICT = {
    "agree": AGREE,
    "expected": AGREE,
    "disagree": DISAGREE,
    "unexpected": DISAGREE,
    "inconclusive": INCONCLUSIVE,
    "cannot stand": CANNOT_STAND,
    None: AGREE,
}
SEVERITY = (AGREE, INCONCLUSIVE, CANNOT_STAND, DISAGREE, USAGE, TOOL)  # from mild to severe; the most severe of several scenes decides
MEANINGS = {  # of every exit code, for the help and the page of the command line
    AGREE: "agree; without YADE (`--no-yade`): the expected value is met, or the scene states none",
    DISAGREE: "disagree; without YADE: the expected value is not met; of `compare`: something changed",
    USAGE: "usage or scene error, also a setting that YADE refuses for the structure",
    TOOL: "a tool is missing or failed, or a file or folder cannot be written",
    INCONCLUSIVE: "inconclusive; without YADE also where limit analysis is `inaccurate`, `failed`, or `unbounded` without a prediction",
    CANNOT_STAND: "the structure cannot stand under its weight and dead loads",
    INTERRUPTED: "interrupted by Ctrl-C",
}


def code_of(command: Callable[[], int]) -> int:
    """Run a command and return its exit code; any error ends in one message on stderr."""
    try:
        code = int(command())
        sys.stdout.flush()
        return code
    except (Exception, KeyboardInterrupt) as error:
        if isinstance(error, OSError) and error.filename is None:
            _discard_stdout()
        return complain_of(error)


def complain_of(error: BaseException) -> int:
    """Print the message of an error on stderr and return its exit code."""
    return complain(message_of(error), _code(error))


def _code(error: BaseException) -> int:
    if isinstance(error, OSError) and error.errno == errno.ENAMETOOLONG:  # no disk takes so long a name, so the argument is wrong
        return USAGE
    codes = {CannotStandError: CANNOT_STAND, SceneError: USAGE, KeyboardInterrupt: INTERRUPTED}
    return next((code for kind, code in codes.items() if isinstance(error, kind)), TOOL)


def complain(message: str, code: int) -> int:
    """Print an error message on stderr, with control characters escaped, and return the exit code."""
    say(StderrConsole(), f"error: {visible(message)}")  # where stderr cannot be written, the exit code still tells of the error
    return code


def _discard_stdout() -> None:
    """Redirect stdout to the null device, so that unwritten output does not fail again when the interpreter ends."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
