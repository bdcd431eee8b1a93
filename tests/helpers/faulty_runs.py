"""What tests of faults share: runs as processes, what they left behind, what they said."""

import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
TOOL, INTERRUPTED = 3, 130
RUN_SECONDS = 2.0  # what YADE takes for two pads, loading included
PATIENCE = 60.0  # s, for what should happen at once

Fake = Callable[[str], None]


def lasting(value: Any) -> Any:
    """What comparison.json says apart from how long it took, and the digests, which know that."""
    if isinstance(value, dict):
        return {name: lasting(item) for name, item in value.items() if name not in ("seconds", "inputs", "sum")}
    return [lasting(item) for item in value] if isinstance(value, list) else value


def answer(out: Path) -> Any:
    return lasting(json.loads((out / "two_pads" / "comparison.json").read_text(encoding="utf-8")))


def unfinished(out: Path) -> list[Path]:
    return list(out.rglob("*.part"))


def one_message(said: str, *words: str) -> None:
    assert said.count("error: ") == 1 and "Traceback" not in said and "unexpected" not in said, said
    assert all(word in said for word in words), said


def crosscheck(*arguments: str, **options: Any) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "comparison", *arguments]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, **{"cwd": ROOT, **pipes, **options})


def wait_for(happens: Callable[[], bool], seconds: float = PATIENCE) -> None:
    deadline = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def processes_about(path: Path) -> list[int]:
    """Processes whose command line names a path."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and str(path).encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue  # it ended just now
    return found
