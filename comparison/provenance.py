"""What made a result: program, machine and package versions."""

import importlib.metadata
import os
import platform
from pathlib import Path

PACKAGES = ("numpy", "scipy", "clarabel", "shapely", "h5py", "matplotlib")


def describe() -> dict[str, str]:
    """Versions and machine, by name; the same on every call on one machine."""
    versions = {package: importlib.metadata.version(package) for package in PACKAGES}
    return {"crosscheck": version(), "python": platform.python_version(), **versions, "machine": machine()}


def version() -> str:
    """This program's version, as installed."""
    try:
        return importlib.metadata.version("crosscheck-masonry")
    except importlib.metadata.PackageNotFoundError:
        return "not installed"


def machine() -> str:
    """Processor, cores and system in a line."""
    processor = platform.processor() or platform.machine()
    cpuinfo = Path("/proc/cpuinfo")
    if cpuinfo.exists():
        models = [line.split(":", 1)[1].strip() for line in cpuinfo.read_text().splitlines() if line.startswith("model name")]
        processor = models[0] if models else processor
    return f"{processor}, {os.cpu_count()} cores, {platform.system()} {platform.machine()}"
