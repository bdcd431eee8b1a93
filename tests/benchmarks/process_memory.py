"""Memory of a process; knows the standard library alone, so that it loads in YADE's interpreter too."""

from pathlib import Path


def peak_memory() -> float:
    """Largest memory of this process, MiB, since its program was loaded (Linux).

    `ru_maxrss` would not do: it starts from the memory of the process that this one was started from.
    """
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024.0
