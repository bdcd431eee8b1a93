"""Provenance of a result: versions of the program and its packages, and the machine."""

import importlib.metadata
import os
import platform
from pathlib import Path

PACKAGES = ("numpy", "scipy", "clarabel", "shapely", "h5py", "matplotlib")


def describe() -> dict[str, str]:
    """Return versions and machine by name; every call on one machine returns the same."""
    versions = {package: importlib.metadata.version(package) for package in PACKAGES}
    return {"crosscheck": version(), "python": platform.python_version(), **versions, "machine": machine()}


def version() -> str:
    """Return the installed version of this program."""
    try:
        return importlib.metadata.version("crosscheck-masonry")
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def machine() -> str:
    """Return processor, cores and system in one line."""
    processor = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        models = [line.split(":", 1)[1].strip() for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        processor = models[0] if models else processor
    return f"{processor}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"
