"""Errors that stop a command, besides those of a scene; the message of an error; and the console of standard error."""

import contextlib
import errno
import os
import sys
import traceback
from pathlib import Path
from typing import Any

from rich.console import Console

from la_core.errors import OF_LOCALE, SceneError, is_of_locale, missing_part, visible
from la_core.exchange import ASK_OWNER, ExchangeError


class FolderInUseError(Exception):
    """Another process or thread is working in a run's folder."""


class YadeMissingError(Exception):
    """This machine has no usable YADE; the message names the missing part and how to get it."""


class YadeFailedError(Exception):
    """YADE ended without a result; the message gives the meaning of the exit code and the log's last lines."""


class WorkerLostError(Exception):
    """Workers died again and again with the same work; the message says how."""


class PrinterMissingError(Exception):
    """No browser is installed that prints a report as PDF; the message says how to get one or do without."""


_WITH_A_MESSAGE = (
    SceneError, ExchangeError, FolderInUseError, YadeMissingError, YadeFailedError, WorkerLostError, PrinterMissingError,
)  # fmt: skip


_NO_ROOM = "failed to map segment"  # message of the system's loader where memory does not suffice for a library
_FREE_SPACE = "free some space; the same command then continues"
_OTHER_FOLDER = "choose a folder that can be written, or copy the results to one"
_NEXT_STEP = {  # by the number of a system's error
    errno.ENOSPC: _FREE_SPACE,
    errno.EDQUOT: _FREE_SPACE,
    errno.EROFS: _OTHER_FOLDER,
    errno.EACCES: _OTHER_FOLDER,
    errno.EPERM: _OTHER_FOLDER,
    errno.EFBIG: "raise the limit on the size of files (`ulimit -f`), or write to a disk that takes larger ones",
    errno.EMFILE: "raise the limit on open files (`ulimit -n`)",
    errno.ENAMETOOLONG: "choose a shorter name, or rename the file",
    errno.ELOOP: "a link leads to itself; delete it, or choose another folder with -o",
    errno.EISDIR: "a folder stands where a file is needed; delete or rename it",
}


def message_of(error: BaseException) -> str:
    """Return one message with the cause that stopped a command and the next step."""
    if isinstance(error, _WITH_A_MESSAGE):
        return str(error)
    if isinstance(error, FileExistsError | NotADirectoryError) and error.filename:
        place = Path(error.filename)
        what = "a link that leads nowhere" if place.is_symlink() and not place.exists() else "a file"
        said = f"{what} stands where a folder is needed; rename it, or choose another folder with -o"
        return f"{error.filename}: {error.strerror or 'File exists'}: {said}"
    if isinstance(error, OSError):
        step = f"; {_NEXT_STEP[error.errno]}" if error.errno in _NEXT_STEP else ""
        step = f"; {ASK_OWNER}" if error.errno == errno.EACCES and _is_closed(error.filename) else step
        nameless = "the current folder" if isinstance(error, FileNotFoundError) else "standard output"  # errors of other files name them
        return f"{error.filename or nameless}: {error.strerror or error}{step}"
    if isinstance(error, MemoryError) or (isinstance(error, ImportError) and _NO_ROOM in str(error)):
        return f"out of memory ({error}); use fewer blocks, or a machine with more memory"
    if isinstance(error, KeyboardInterrupt):
        return "; ".join(["stopped", *map(str, error.args)])
    fault = f"unexpected {type(error).__name__}: {error}; this is an error in crosscheck, please report it"
    return missing_part(error) if isinstance(error, ModuleNotFoundError) else _about_encoding(error) or fault


def _about_encoding(error: BaseException) -> str:
    """Return the message for a name with letters that the locale lacks, or for a matplotlib style file not in UTF-8; else ""."""
    if isinstance(error, UnicodeEncodeError) and is_of_locale(str(error.object)):
        before, after = str(error.object)[: error.start], str(error.object)[error.start :]
        line = before.rpartition("\n")[2] + after.partition("\n")[0]  # of a whole page, only the line with the name
        return f"{visible(line)}: this name cannot be used: {OF_LOCALE}"
    frames = [frame for frame, _ in traceback.walk_tb(error.__traceback__) if frame.f_code.co_name == "_rc_params_in_file"]
    if not frames or not isinstance(error, UnicodeDecodeError):
        return ""
    file = Path(frames[0].f_locals.get("fname", "matplotlibrc")).absolute()
    return f"{file}: matplotlib cannot read this file of its style, because it is not in UTF-8; save it in UTF-8, rename it or delete it"


def _is_closed(filename: Any) -> bool:
    """Return whether a file may not be read or a folder above it not be entered, as with files of a user with a strict umask."""
    if not isinstance(filename, str) or not filename:
        return False
    path = Path(filename).absolute()
    closed = os.access(path, os.F_OK) and not os.access(path, os.R_OK)
    return closed or any(os.access(folder, os.F_OK) and not os.access(folder, os.X_OK) for folder in path.parents)


class _LossyStderr:
    """Standard error that drops text that it cannot write; its other attributes are those of the stream."""

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)

    @property
    def _stream(self) -> Any:
        return getattr(sys.stderr, "rich_proxied_file", sys.stderr)  # Rich's progress bars replace sys.stderr by a stream of their own

    def write(self, text: str) -> int:
        """Write a text, or drop it where it cannot be written."""
        with contextlib.suppress(Exception):  # a caller from Python may have set sys.stderr to None or any object
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Flush the stream, or drop text that it cannot write."""
        with contextlib.suppress(Exception):
            self._stream.flush()


class StderrConsole(Console):
    """Console for narration and warnings; work goes on where standard error cannot be written, because it is full, closed or gone.

    Parameters
    ----------
    quiet : bool
        Whether to print nothing.
    has_bars : bool
        Whether bars may be shown where stderr is a terminal.
    """

    def __init__(self, quiet: bool = False, has_bars: bool = True) -> None:
        as_terminal = None if has_bars else False
        stream: Any = _LossyStderr()
        super().__init__(
            file=stream,
            quiet=quiet,
            highlight=False,
            emoji=False,
            soft_wrap=True,
            force_terminal=as_terminal,
            force_jupyter=False,  # a notebook shows standard error, too; Rich would put its words among the results
        )
