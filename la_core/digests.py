"""Digests of code, which record the code that made a stored result."""

import hashlib
from pathlib import Path


def code_digest(*folders: Path) -> str:
    """Digest of the relative paths and contents of all Python files below the folders; a folder may be a single file."""
    total = hashlib.sha256()
    for folder in folders:
        for source in [folder] if folder.is_file() else sorted(folder.rglob("*.py")):
            name, content = source.relative_to(folder).as_posix().encode(), source.read_bytes()
            total.update(b"%d %b %d %b" % (len(name), name, len(content), content))
    return total.hexdigest()
