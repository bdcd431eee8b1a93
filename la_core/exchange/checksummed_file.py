"""Files that are either whole or absent, because they are written under another name and renamed.

A file between the two methods also has a seal: its first 512 bytes, which HDF5 skips as a user block, hold the
version of the format and a digest of all other bytes. The seal is checked before HDF5 reads a byte, so that a
damaged, truncated or foreign file is refused and never misread. Standard library only.
"""

import contextlib
import hashlib
import threading
from pathlib import Path

VERSION = 3
SEAL, SEAL_BYTES = b"crosscheck", 512  # the smallest user block of HDF5
ASK_OWNER = "it may not be read by you: ask its owner to permit it (`chmod -R a+rX FOLDER`), or choose another folder"
LARGEST_FILE = 4 * 2**30  # bytes; a file is read as a whole


class ExchangeError(Exception):
    """A case or run file is missing, incomplete, foreign or damaged; the message says what to do next."""


def write_whole(path: Path, content: bytes) -> None:
    """Write a file under another name, then rename it, so that a crash leaves the old or the new file.

    Raises OSError with the name of the file.
    """
    unwritten = path.with_name(f"{path.name}.{threading.get_native_id()}.part")  # a process may write the same file in several threads
    try:
        unwritten.write_bytes(content)
        unwritten.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with contextlib.suppress(OSError):
            unwritten.unlink()


def write_sealed(path: Path, content: bytes) -> None:
    """Write a file with its seal in place of the first 512 bytes of `content`."""
    write_whole(path, _seal(content).ljust(SEAL_BYTES, b"\0") + content[SEAL_BYTES:])


def read_sealed(path: Path) -> bytes:
    """Content of a file with a valid seal, including the seal; raises ExchangeError for any other file."""
    content = _bounded_content(path)
    seal = content[:SEAL_BYTES].rstrip(b"\0").split(b" ")
    if len(seal) != 3 or seal[0] != SEAL:
        raise ExchangeError(f"{path}: not a whole file of version {VERSION} of this program's format; run the scene again")
    if seal[1] != str(VERSION).encode():
        version = seal[1].decode(errors="replace")
        raise ExchangeError(f"{path}: version {version}, this program reads version {VERSION}; run the scene again")
    if seal != _seal(content).split(b" "):
        raise ExchangeError(f"{path}: damaged or cut short since it was written; run the scene again")
    return content


def _seal(content: bytes) -> bytes:
    return SEAL + f" {VERSION} {hashlib.sha256(memoryview(content)[SEAL_BYTES:]).hexdigest()}".encode()


def _bounded_content(path: Path) -> bytes:
    try:
        if path.exists() and not path.is_file():
            raise ExchangeError(f"{path}: not a file; delete or rename it and run the scene again")
        if path.stat().st_size > LARGEST_FILE:
            rule = f"larger than {LARGEST_FILE} bytes, so crosscheck did not write it"
            raise ExchangeError(f"{path}: {rule}; delete it and run the scene again")
        return path.read_bytes()
    except PermissionError as error:
        raise ExchangeError(f"{path}: {ASK_OWNER}") from error
    except OSError as error:
        raise ExchangeError(f"{path}: cannot be read ({error.strerror}); run the scene again") from error
