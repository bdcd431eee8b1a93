"""`crosscheck doctor`: what is installed, what is missing, and the command that mends it."""

import importlib.metadata
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.table import Table

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, TOOL
from comparison.cli.tables import new_table, plain
from comparison.errors import YadeMissingError
from comparison.provenance import PACKAGES
from comparison.settings import load_settings, unknown_variables
from comparison.yade import HOW_TO_GET_YADE, find_yade


@dataclass(frozen=True)
class Finding:
    """One part of the tool chain: its state, and the remedy where it is not well, or a caution where it might not be."""

    part: str
    well: bool
    state: str
    remedy: str = ""


def execute(context: Context) -> int:
    """Print every part and every setting; the exit code is 3 where a part is missing."""
    findings, settings = examine(), configuration_dict()
    if context.options.json:
        context.print_json({"parts": [vars(finding) for finding in findings], "configuration": settings})
    else:
        context.out.print(doctor_table(findings))
        for finding in findings:
            if finding.remedy:
                context.out.print(f"{finding.part}: {finding.remedy}", markup=False)
        context.out.print(settings_table(settings))
        context.out.print(configuration_words(settings), markup=False)
    return AGREE if all(finding.well for finding in findings) else TOOL


def examine() -> list[Finding]:
    """Look at every part the program needs."""
    findings = [_package(name) for name in (*PACKAGES, "pydantic", "jinja2", "rich", "shtab")]
    try:
        yade = find_yade()
        tested = "" if yade.caution else ", a version this was tested with"
        state = f"{yade.version}{tested}, loaded by {yade.python} with nothing listening"
        findings.append(Finding("YADE", True, state, yade.caution))
    except YadeMissingError as error:
        findings.append(Finding("YADE", False, str(error), HOW_TO_GET_YADE))
    free = shutil.disk_usage(".").free / 1e9
    findings.append(Finding("disk", free > 1.0, f"{free:.0f} GB free here", "" if free > 1.0 else "make room: a run stores some megabytes"))
    return findings


def configuration_dict() -> dict[str, Any]:
    """Every setting with its value and where it comes from, the files that were looked for, and variables that mean nothing."""
    found = load_settings()
    settings = {name: {"value": _plain(value), "from": found.source(name)} for name, value in found.settings}
    files = {str(path): path.exists() for path in found.files}
    return {"settings": settings, "files": files, "unknown_variables": unknown_variables()}


def configuration_words(found: dict[str, Any]) -> str:
    """Lines on what was looked for: a file that is not there, and a variable that means nothing, might be taken to hold."""
    lines = [f"{path}: {'read' if exists else 'not there'}" for path, exists in found["files"].items()]
    return "\n".join([*lines, *(f"{words}; this one means nothing" for words in found["unknown_variables"])])


def _plain(value: object) -> object:
    """A value as JSON has it."""
    return str(value) if isinstance(value, Path) else value


def _package(name: str) -> Finding:
    try:
        return Finding(name, True, importlib.metadata.version(name))
    except importlib.metadata.PackageNotFoundError:
        return Finding(name, False, "not installed", f"pip install {name}")


def doctor_table(findings: list[Finding]) -> Table:
    """What is installed and what is not."""
    table = new_table("part", "state", "")
    for finding in findings:
        table.add_row(finding.part, plain(finding.state), "[green]✓[/]" if finding.well else "[red]✗ missing[/]")
    return table


def settings_table(configuration: dict[str, Any]) -> Table:
    """Which settings hold, and from where."""
    table = new_table("setting", "value", "from")
    for name, one in configuration["settings"].items():
        table.add_row(name, "–" if one["value"] is None else plain(str(one["value"])), plain(one["from"]))
    return table
