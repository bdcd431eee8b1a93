"""Helpers for tests of faults: runs as processes, the files that they leave behind, and their messages."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from comparison.settings import SYSTEM_PYTHON
from la_core.errors import SceneError
from la_core.scene.shipped import find

ROOT = Path(__file__).parents[2]
USAGE, TOOL, INTERRUPTED = 2, 3, 130
RUN_SECONDS = 2.0  # about the duration of a run of two pads; only where a signal may come at any time
PATIENCE = 600.0  # s, a last resort for events that should happen at once: a busy machine is no fault

Fake = Callable[[str], None]


def lasting(value: Any) -> Any:
    """Return comparison.json without its seconds and without the digests, which depend on the seconds and on the figures."""
    if isinstance(value, dict):
        return {name: lasting(item) for name, item in value.items() if name not in ("seconds", "inputs", "sum", "files")}
    return [lasting(item) for item in value] if isinstance(value, list) else value


def answer(out: Path) -> Any:
    return lasting(json.loads((out / "two_pads" / "comparison.json").read_text(encoding="utf-8")))


def unfinished(out: Path) -> list[Path]:
    return list(out.rglob("*.part"))


def one_message(said: str, *words: str) -> None:
    said = " ".join(said.split())  # a narrow terminal breaks the message into lines
    assert said.count("error: ") == 1 and "Traceback" not in said and "unexpected" not in said, said
    assert all(word in said for word in words), said


def crosscheck(*arguments: str, **options: Any) -> "subprocess.Popen[str]":
    command = [sys.executable, "-m", "comparison", *arguments]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    return subprocess.Popen(command, **{"cwd": ROOT, **pipes, **options})


def endless(folder: Path, name: str = "two_pads") -> Path:
    """Write a scene file of "two_pads" whose run in YADE takes days, so that it cannot end before a test stops it."""
    path = folder / "endless" / f"{name}.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(find("two_pads").read_text(encoding="utf-8") + "\n[yade]\nspeed = 1e-12\n", encoding="utf-8")
    return path


def dies(*ignored: object, **options: object) -> None:
    """End the process, as a lack of memory does."""
    os._exit(9)


class _Ending:
    """An object whose destruction takes so long that a stop comes meanwhile. It writes a file when its destruction begins."""

    def __init__(self, begun: Path) -> None:
        self.begun = begun

    def __del__(self) -> None:
        self.begun.touch()
        time.sleep(PATIENCE)


def stops_while_an_object_ends(folder: Path) -> None:
    """Work that is stopped while Python destroys an object. It must still write a file before it ends."""
    _Ending(folder / "begun")
    try:
        time.sleep(PATIENCE)
    finally:
        (folder / "finished").touch()


class UnreadableError(Exception):
    """An error that can be pickled but not unpickled, like errors of some libraries."""

    def __init__(self, one: str, two: str) -> None:
        super().__init__(f"{one} and {two}")


def fails_unreadably(word: str) -> None:
    raise UnreadableError(word, "another")


def refuses(word: str) -> None:
    raise SceneError("here", "must be otherwise", value=word, hint="change it", blocks=["stone"], spots=[(0.0, 1.0, 2.0)])


def held_yade(folder: Path, after: int = 0) -> tuple[dict[str, str], Path]:
    """Return an environment in which runs in YADE, except the first `after`, wait before they begin, and the file that lets them go on."""
    python, count, go = (folder / name for name in ("python", "begun", "go on"))
    awaited = "[ $PPID -gt 1 ] && kill -0 $PPID"  # the parent is 1 where the run was killed before this shell began
    wait = f'while [ ! -e "{go}" ] && [ "$(wc -l < "{count}")" -gt {after} ] && {awaited}; do sleep 0.05; done'
    alone = f"{{ {awaited}; }} || exit 1"  # no process is left to read a result
    python.write_text(f'#!/bin/sh\nif [ "$2" != -c ]; then echo >> "{count}"; {wait}; {alone}; fi\nexec {SYSTEM_PYTHON} "$@"\n')
    python.chmod(0o755)
    return {**os.environ, "CROSSCHECK_YADE_PYTHON": str(python)}, go


def wait_for(happens: Callable[[], bool], seconds: float = PATIENCE) -> None:
    deadline = time.monotonic() + seconds
    while not happens():
        assert time.monotonic() < deadline
        time.sleep(0.01)


def processes_about(path: Path) -> list[int]:
    """Return the processes whose command line names a path."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and str(path).encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            continue  # the process has just ended
    return found
