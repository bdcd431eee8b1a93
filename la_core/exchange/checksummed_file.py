"""Files that are whole or absent: written beside their name and renamed; those between the methods under a seal.

The seal is the first 512 bytes, which HDF5 skips as a user block: the version and the digest of all that follows. It is checked before
HDF5 reads a byte, so that a file that is damaged, cut short or foreign is refused and never misread. Standard library only.
"""

import contextlib
import hashlib
import os
from pathlib import Path

VERSION = 3
SEAL, SEAL_BYTES = b"crosscheck", 512  # the least user block that HDF5 knows
LARGEST_FILE = 4 * 2**30  # bytes; it is read as a whole


class ExchangeError(Exception):
    """A case or run file is missing, incomplete, foreign or broken; the message says which and what to do."""


def write_whole(path: Path, content: bytes) -> None:
    """Write a file beside its name and rename: a crash leaves the old one or the new one. An OSError names the file."""
    unwritten = path.with_name(f"{path.name}.{os.getpid()}.part")
    try:
        unwritten.write_bytes(content)
        unwritten.replace(path)
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        with contextlib.suppress(OSError):
            unwritten.unlink()


def write_sealed(path: Path, content: bytes) -> None:
    """Write a content with the seal that belongs to it in the place of its first 512 bytes."""
    write_whole(path, _seal(content).ljust(SEAL_BYTES, b"\0") + content[SEAL_BYTES:])


def read_sealed(path: Path) -> bytes:
    """Content of a file whose seal holds, seal included; raises ExchangeError for any other."""
    content = _bounded_content(path)
    words = content[:SEAL_BYTES].rstrip(b"\0").split(b" ")
    if len(words) != 3 or words[0] != SEAL:
        raise ExchangeError(f"{path}: not a whole file that version {VERSION} of this program's format describes; run it again")
    if words[1] != str(VERSION).encode():
        raise ExchangeError(f"{path}: version {words[1].decode(errors='replace')}, this program reads version {VERSION}; run it again")
    if words != _seal(content).split(b" "):
        raise ExchangeError(f"{path}: damaged or cut short since it was written; run it again")
    return content


def _seal(content: bytes) -> bytes:
    return SEAL + f" {VERSION} {hashlib.sha256(memoryview(content)[SEAL_BYTES:]).hexdigest()}".encode()


def _bounded_content(path: Path) -> bytes:
    try:
        if path.exists() and not path.is_file():
            raise ExchangeError(f"{path}: not a file; take it away and run it again")
        if path.stat().st_size > LARGEST_FILE:
            raise ExchangeError(f"{path}: larger than {LARGEST_FILE} bytes, so none of this program's; take it away and run it again")
        return path.read_bytes()
    except OSError as error:
        raise ExchangeError(f"{path}: cannot be read ({error.strerror}); run it again") from error
