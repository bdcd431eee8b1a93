"""What is installed, what is missing, and the command that mends it."""

import importlib.metadata
import shutil
from dataclasses import dataclass

from comparison.launch import HOW_TO_GET_YADE, YadeMissingError, find_yade
from comparison.provenance import PACKAGES


@dataclass(frozen=True)
class Finding:
    """One part of the tool chain: its state, and the remedy where it is not well."""

    part: str
    well: bool
    state: str
    remedy: str = ""


def examine() -> list[Finding]:
    """Look at every part the program needs."""
    findings = [_package(name) for name in (*PACKAGES, "pydantic", "jinja2", "rich")]
    try:
        yade = find_yade()
        findings.append(Finding("YADE", True, f"{yade.version}, loaded by {yade.python} with nothing listening"))
    except YadeMissingError as error:
        findings.append(Finding("YADE", False, str(error), HOW_TO_GET_YADE))
    free = shutil.disk_usage(".").free / 1e9
    findings.append(Finding("disk", free > 1.0, f"{free:.0f} GB free here", "" if free > 1.0 else "make room: a run stores some megabytes"))
    return findings


def _package(name: str) -> Finding:
    try:
        return Finding(name, True, importlib.metadata.version(name))
    except importlib.metadata.PackageNotFoundError:
        return Finding(name, False, "not installed", f"pip install {name}")
