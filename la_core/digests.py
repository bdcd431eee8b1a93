"""Digests of code: what a stored result was made by."""

import hashlib
from pathlib import Path


def code_digest(*folders: Path) -> str:
    """Digest of all Python code below the folders: where each file lies, and every byte of it. A single file counts as a folder of one."""
    total = hashlib.sha256()
    for folder in folders:
        for source in [folder] if folder.is_file() else sorted(folder.rglob("*.py")):
            name, content = source.relative_to(folder).as_posix().encode(), source.read_bytes()
            total.update(b"%d %b %d %b" % (len(name), name, len(content), content))
    return total.hexdigest()
