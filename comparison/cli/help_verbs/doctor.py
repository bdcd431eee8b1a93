"""`crosscheck doctor`: list installed and missing parts, the command that installs a missing one, and the settings."""

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
from la_core.errors import how_to_install


@dataclass(frozen=True)
class Finding:
    """State of one part that the program needs.

    Attributes
    ----------
    part : str
        Name: a package, YADE or the disk.
    well : bool
        Whether the part is usable.
    state : str
        Version or free space, or the reason why the part is not usable.
    remedy : str
        Next step for an unusable part, or a caution for a usable one; "" without either.
    """

    part: str
    well: bool
    state: str
    remedy: str = ""


def execute(context: Context) -> int:
    """Print every part and every setting; the exit code is 3 if a part is missing."""
    findings, settings = examine(), configuration_dict()
    if context.options.json:
        context.print_json({"parts": [vars(finding) for finding in findings], "configuration": settings})
    else:
        context.table(doctor_table(findings))
        for finding in findings:
            if finding.remedy:
                context.tell(f"{finding.part}: {finding.remedy}")
        context.table(settings_table(settings))
        context.tell(configuration_words(settings))
    return AGREE if all(finding.well for finding in findings) else TOOL


def examine() -> list[Finding]:
    """Examine every part that the program needs."""
    findings = [_package(name) for name in (*PACKAGES, "pydantic", "jinja2", "rich", "shtab")]
    try:
        yade = find_yade()
        tested = ", a tested version" if yade.is_tested else ""
        state = f"{yade.version}{tested}, loaded by {yade.python} with nothing listening"
        findings.append(Finding("YADE", True, state, yade.caution))
    except YadeMissingError as error:
        findings.append(Finding("YADE", False, str(error), HOW_TO_GET_YADE))
    free = shutil.disk_usage(".").free / 1e9
    findings.append(
        Finding("disk", free > 1.0, f"{free:.0f} GB free here", "" if free > 1.0 else "free some space: a run stores several megabytes")
    )
    return findings


def configuration_dict() -> dict[str, Any]:
    """Return every setting with its value and source, the settings files that exist or not, and the unknown variables."""
    configuration = load_settings()
    settings = {name: {"value": _plain(value), "from": configuration.source(name)} for name, value in configuration.settings}
    files = {str(path): path.exists() for path in configuration.files}
    return {"settings": settings, "files": files, "unknown_variables": unknown_variables()}


def configuration_words(configuration: dict[str, Any]) -> str:
    """Return lines on the settings files, read or absent, and on unknown variables: a user may believe that they apply."""
    lines = [f"{path}: {'read' if exists else 'not there'}" for path, exists in configuration["files"].items()]
    return "\n".join([*lines, *(f"{message}; it is ignored" for message in configuration["unknown_variables"])])


def _plain(value: object) -> object:
    """Return a value in its JSON form: a path as text."""
    return str(value) if isinstance(value, Path) else value


def _package(name: str) -> Finding:
    try:
        return Finding(name, True, importlib.metadata.version(name))
    except importlib.metadata.PackageNotFoundError:
        return Finding(name, False, "not installed", how_to_install(name))


def doctor_table(findings: list[Finding]) -> Table:
    """Return a table of the parts and their states."""
    table = new_table("part", "state", "")
    for finding in findings:
        table.add_row(finding.part, plain(finding.state), "[green]✓[/]" if finding.well else "[red]✗ missing[/]")
    return table


def settings_table(configuration: dict[str, Any]) -> Table:
    """Return a table of the settings, their values and their sources."""
    table = new_table("setting", "value", "from")
    for name, setting in configuration["settings"].items():
        value = "–" if setting["value"] is None else plain(str(setting["value"]))
        table.add_row(name, value, plain(setting["from"]))
    return table
