"""What can stop a command besides a faulty scene, and the one message that says so."""

from la_core.errors import SceneError
from la_core.exchange import ExchangeError


class FolderInUseError(Exception):
    """Another process works in a run's folder."""


class YadeMissingError(Exception):
    """No usable YADE on this machine; the message says what is missing and how to get it."""


class YadeFailedError(Exception):
    """YADE ended without a result; the message carries the exit code's meaning and the log's last lines."""


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
