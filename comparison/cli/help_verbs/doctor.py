"""`crosscheck doctor`: list installed and missing parts, the command that installs a missing one, and the settings."""

import importlib.metadata
import re
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
from comparison.report import find_browser
from comparison.settings import load_settings, unknown_variables
from comparison.yade import HOW_TO_GET_YADE, find_yade
from la_core.errors import how_to_install

EXTRAS = ("mesh", "drawing", "dask", "pandas", "parquet")  # for users, not for developers


@dataclass(frozen=True)
class Finding:
    """State of one part that the program needs or can use.

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
    needed : bool
        Whether the program needs the part; False for a part of an extra.
    has_other_version : bool
        Whether the part is installed, but in a version that is not allowed.
    """

    part: str
    well: bool
    state: str
    remedy: str = ""
    needed: bool = True
    has_other_version: bool = False


def execute(context: Context) -> int:
    """Print every part and every setting; the exit code is 3 if a part that the program needs is missing."""
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
    return AGREE if all(finding.well or not finding.needed for finding in findings) else TOOL


def examine() -> list[Finding]:
    """Examine every part that the program needs or can use."""
    findings = [_package(*one) for one in requirements()]
    try:
        yade = find_yade()
        tested = ", a tested version" if yade.is_tested else ""
        state = f"{yade.version}{tested}, loaded by {yade.python} with nothing listening"
        findings.append(Finding("YADE", True, state, yade.caution))
    except YadeMissingError as error:
        findings.append(Finding("YADE", False, str(error), HOW_TO_GET_YADE))
    findings += [
        _program("Chromium or Chrome", find_browser(), "a report as PDF needs it: `apt-get install chromium`"),
        _program("ffmpeg", shutil.which("ffmpeg"), "an animation as MP4 needs it: `apt-get install ffmpeg`"),
    ]
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


def requirements() -> list[tuple[str, str, str]]:
    """Return the packages that this installation declares: name, allowed versions, and extra; "" for a package that it needs."""
    try:
        declared = importlib.metadata.requires("crosscheck-masonry") or []
    except importlib.metadata.PackageNotFoundError:
        declared = [*PACKAGES, "pydantic", "jinja2", "rich", "shtab"]
    found = [re.fullmatch(r"([\w.-]+)\s*([^;\[]*?)\s*(?:;\s*extra == ['\"]([\w-]+)['\"])?", one) for one in declared]
    return [(one[1], one[2], one[3] or "") for one in found if one and (not one[3] or one[3] in EXTRAS)]


def _package(name: str, allowed: str, extra: str) -> Finding:
    part = f"{name} (extra {extra})" if extra else name
    try:
        version = importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return Finding(part, False, "not installed", how_to_install(name), not extra)
    if is_allowed(version, allowed):
        return Finding(part, True, version, needed=not extra)
    return Finding(part, False, f"{version}; must be {allowed}", how_to_install(f'"{name}{allowed}"'), not extra, True)


def _program(name: str, place: str | None, remedy: str) -> Finding:
    """Return the finding of a program that some commands start; place: its path, or None."""
    return Finding(name, place is not None, place or "not installed", "" if place else remedy, needed=False)


def is_allowed(version: str, allowed: str) -> bool:
    """Return whether a version fulfils all bounds such as ">=2.12,<3"; only these two signs are bounds here.

    A library would do the same, but may itself be the missing part.
    """
    bounds = re.findall(r"(>=|<)\s*([\d.]+)", allowed)
    return all((_numbers(version) >= _numbers(bound)) == (sign == ">=") for sign, bound in bounds)


def _numbers(version: str) -> list[int]:
    """Return the numbers of a version without zeros at the end, such as [2, 12] for 2.12.0rc1."""
    release = re.match(r"\d+(?:\.\d+)*", version)
    numbers = [int(part) for part in release[0].split(".")] if release else []
    while numbers and numbers[-1] == 0:
        numbers.pop()
    return numbers


def doctor_table(findings: list[Finding]) -> Table:
    """Return a table of the parts and their states."""
    table = new_table("part", "state", "")
    for finding in findings:
        table.add_row(finding.part, plain(finding.state), _mark(finding))
    return table


def _mark(finding: Finding) -> str:
    if finding.well:
        return "[green]✓[/]"
    if finding.has_other_version:
        return "[red]✗ other version needed[/]"
    return "[red]✗ missing[/]" if finding.needed else "– optional"


def settings_table(configuration: dict[str, Any]) -> Table:
    """Return a table of the settings, their values and their sources."""
    table = new_table("setting", "value", "from")
    for name, setting in configuration["settings"].items():
        value = "–" if setting["value"] is None else plain(str(setting["value"]))
        table.add_row(name, value, plain(setting["from"]))
    return table
