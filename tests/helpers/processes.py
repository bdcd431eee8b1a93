"""Descendants of a process, the processes that a signal reaches, and listening sockets, from the kernel's tables."""

import os
import signal
from pathlib import Path

LISTENS = "0A"  # state of a socket in /proc/net/tcp


def tree(root: int) -> set[int]:
    """Return a process and all its descendants."""
    parents = {}
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit():
                parents[int(entry.name)] = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
        except OSError:
            continue  # the process has just ended
    found = {root}
    while more := {child for child, parent in parents.items() if parent in found} - found:
        found |= more
    return found


def is_gone(process: int) -> bool:
    """Return True if a process has ended, even if its parent has not yet waited for it."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] == "Z"
    except OSError:
        return True


def reached(group: int, number: signal.Signals) -> set[int]:
    """Return the processes of a group that a signal to the group reaches: all that neither block nor ignore the signal."""
    found = set()
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and os.getpgid(int(entry.name)) == group:
                lines = (entry / "status").read_text().splitlines()
                deaf = [int(line.split()[1], 16) for line in lines if line.startswith(("SigBlk:", "SigIgn:"))]
                if not any(mask >> (number - 1) & 1 for mask in deaf):
                    found.add(int(entry.name))
        except OSError:
            continue  # the process has just ended
    return found


def listening(processes: set[int]) -> set[str]:
    """Return the listening sockets of some processes."""
    held = set()
    for process in processes:
        try:
            held |= {str(link.readlink()) for link in Path(f"/proc/{process}/fd").iterdir()}
        except OSError:
            continue
    rows = [line.split() for name in ("tcp", "tcp6") for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]]
    return held & {f"socket:[{row[9]}]" for row in rows if row[3] == LISTENS}
