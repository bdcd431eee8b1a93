"""Memory of a process. The module imports only the standard library, so that it also loads in YADE's interpreter."""

from pathlib import Path


def peak_memory() -> float:
    """Return the peak memory of this process, MiB, since its program was loaded (Linux).

    `ru_maxrss` is unsuitable, because it starts from the memory of the parent process.
    """
    line = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024.0
