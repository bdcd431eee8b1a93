"""Helpers for tests of stored answers: a scene solved and run, the state of a folder, another scene of the same name."""

import json
from pathlib import Path
from typing import Any

import pytest

from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE
from comparison.run_folder import LOCK
from la_core.scene import shipped


def solve(out: Path, capsys: pytest.CaptureFixture[str], scene: str = "two_pads", *options: str) -> dict[str, Any]:
    """Return the output of `crosscheck solve --json` for a scene."""
    capsys.readouterr()
    assert main(["solve", scene, "--json", "--results", str(out), *options]) == AGREE
    return dict(json.loads(capsys.readouterr().out))


def run(out: Path, scene: str = "two_pads") -> None:
    assert main(["run", scene, "--no-yade", "-o", str(out)]) == AGREE


def state(folder: Path) -> dict[str, tuple[int, bytes]]:
    """Return the time of change, ns, and the content of every file below a folder, except the lock, which is empty."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != LOCK]
    return {str(path.relative_to(folder)): (path.stat().st_mtime_ns, path.read_bytes()) for path in files}


def lighter(folder: Path) -> Path:
    """Write the file of another scene with the same name, "two_pads"."""
    path = folder / "elsewhere" / "two_pads.toml"
    path.parent.mkdir(exist_ok=True)
    path.write_text(shipped.find("two_pads").read_text().replace("density = 2200.0", "density = 1100.0"))
    return path
