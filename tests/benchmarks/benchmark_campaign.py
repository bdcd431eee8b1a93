"""Overhead of a large campaign on a Dask cluster, and the cases that it loses when parts of the cluster die.

    python tests/benchmarks/benchmark_campaign.py -o comparison/gallery [--cases 1000] [--workers 8]

Each case is `two_pads` by limit analysis alone, with its own friction and density. The cases are so short that the overhead shows.
The cluster loses a worker and then its scheduler. The same command then goes on with a new cluster. Writes campaigns.md.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import csv
import os
import socket
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from statistics import mean

from peers_table import markdown

from comparison import provenance

ROOT = Path(__file__).parents[2]
ENVIRONMENT = {**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": str(ROOT)}
TICKS = os.sysconf("SC_CLK_TCK")
LOST_WORKER, LOST_SCHEDULER = 0.25, 0.5  # shares of the cases that are finished when a worker and the scheduler are killed
TOLD = 1.0  # s between two samples of the processes


@dataclass(frozen=True)
class Cluster:
    """A Dask scheduler and its workers, each in its own process."""

    address: str
    scheduler: subprocess.Popen
    workers: list[subprocess.Popen]

    @classmethod
    def started(cls, workers: int) -> "Cluster":
        """Start a cluster on free ports of this machine."""
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            port = probe.getsockname()[1]
        address = f"tcp://127.0.0.1:{port}"
        scheduler = _dask("distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
        started = [_dask("distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard") for _ in range(workers)]
        return cls(address, scheduler, started)

    def end(self) -> None:
        """Kill all processes."""
        for process in (*self.workers, self.scheduler):
            process.kill()
            process.wait()


def _dask(module: str, *options: str) -> subprocess.Popen:
    command = [sys.executable, "-m", module, *options]
    return subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


@dataclass
class Watched:
    """Time and memory of one call of the campaign.

    Attributes
    ----------
    seconds : float
        Wall time.
    campaign, scheduler : float
        Processor seconds of the campaign's process and of the scheduler.
    campaign_memory, scheduler_memory, scheduler_at_start : float
        Peak memory of both processes, and the scheduler's after the first second, MiB.
    code : int
        Exit code.
    """

    seconds: float = 0.0
    campaign: float = 0.0
    scheduler: float = 0.0
    campaign_memory: float = 0.0
    scheduler_memory: float = 0.0
    scheduler_at_start: float = 0.0
    code: int = -1


def processor_seconds(process: int) -> float:
    """Return the processor time of a process, user and system, without its children, s."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / TICKS


def memory(process: int) -> float:
    """Return the peak memory of a process so far, MiB."""
    line = next(line for line in Path(f"/proc/{process}/status").read_text().splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) / 1024.0


def campaign_file(folder: Path, cases: int) -> Path:
    """Write a campaign of at least `cases` cases, at most a few more."""
    across = max(1, round(cases**0.5))
    frictions = ", ".join(f"{0.2 + 0.8 * k / across:.6f}" for k in range(across))
    densities = ", ".join(f"{1800.0 + k:.1f}" for k in range(-(-cases // across)))
    path = folder / "large.toml"
    path.write_text(
        f'title = "Large"\nyade = false\n\n[[sweep]]\nscene = "two_pads"\n[sweep.vary]\n"joint.friction" = [{frictions}]\n'
        f'"stone.density" = [{densities}]\n',
        encoding="utf-8",
    )
    return path


def done(out: Path) -> int:
    """Number of finished cases."""
    return len(list(out.glob("cases/*/outcome.json")))


def run(path: Path, out: Path, cluster: Cluster, cases: int, kill: bool) -> Watched:
    """Run a campaign and watch its processes. `kill`: a worker dies after LOST_WORKER of the cases, the scheduler after LOST_SCHEDULER."""
    command = [sys.executable, "-m", "comparison", "campaign", str(path), "-o", str(out), "-q", "--scheduler", cluster.address]
    start, watched = time.monotonic(), Watched()
    before = processor_seconds(cluster.scheduler.pid)
    with subprocess.Popen(command, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        while process.poll() is None:
            time.sleep(TOLD)
            _look(watched, process.pid, cluster, before)
            watched.scheduler_at_start = watched.scheduler_at_start or watched.scheduler_memory
            if kill and done(out) >= LOST_WORKER * cases:
                cluster.workers[0].kill()
            if kill and done(out) >= LOST_SCHEDULER * cases:
                cluster.scheduler.kill()
    watched.seconds, watched.code = time.monotonic() - start, process.returncode
    return watched


def _look(watched: Watched, process: int, cluster: Cluster, before: float) -> None:
    """Record times and memory of the processes that still run."""
    try:
        watched.campaign, watched.campaign_memory = processor_seconds(process), memory(process)
        watched.scheduler, watched.scheduler_memory = processor_seconds(cluster.scheduler.pid) - before, memory(cluster.scheduler.pid)
    except (OSError, StopIteration):  # the process has just ended, or is a zombie
        pass


def rows(out: Path) -> list[dict[str, str]]:
    """Return the rows of a campaign's table."""
    with (out / "results.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def case_seconds(out: Path) -> float:
    """Return the mean wall time of a case in its worker, with reading and writing, s."""
    with (out / "costs.csv").open(encoding="utf-8", newline="") as file:
        return mean(float(row["seconds"]) for row in csv.DictReader(file))


def page(calls: dict[str, tuple[Watched, int]], workers: int, seconds: float) -> str:
    """Return the page. calls: cost of each call and the number of cases it finished; seconds: mean time of a case."""
    head = [
        "call",
        "cases",
        "s",
        "s a case",
        "campaign, CPU ms a case",
        "scheduler, CPU ms a case",
        "campaign, MiB",
        "scheduler, MiB",
        "exit code",
    ]
    table = []
    for name, (call, cases) in calls.items():
        each = [f"{1e3 * call.campaign / cases:.0f}", f"{1e3 * call.scheduler / cases:.0f}"]
        memories = [f"{call.campaign_memory:.0f}", f"{call.scheduler_at_start:.0f} to {call.scheduler_memory:.0f}"]
        table.append([name, f"{cases:,}", f"{call.seconds:.0f}", f"{call.seconds / cases:.2f}", *each, *memories, str(call.code)])
    total, versions = sum(cases for _, cases in calls.values()), provenance.describe()
    return f"""\
# Large campaigns

{total:,} cases of `two_pads` by limit analysis alone, on a Dask cluster of {workers} worker processes. The cases are as short as
possible, so that the work around them shows. A worker was killed after {LOST_WORKER:.0%} of the cases and the scheduler after
{LOST_SCHEDULER:.0%}. The campaign then ended and kept its finished cases; the same command on a new cluster ran the others. No case
was lost, and no finished one ran again. Written by `python tests/benchmarks/benchmark_campaign.py -o comparison/gallery`.

{markdown(head, table)}

*campaign* and *scheduler* are the two processes that every case passes through. Their processor time per case limits how many workers
they can serve: with cases of a minute each, some {round(60.0 / max(_dearest(calls), 1e-3), -2):,.0f} workers. A case took
{seconds:.1f} s by the clock of its worker, with its figures, while {workers} workers shared the cores of this machine.

{versions["machine"]}; python {versions["python"]}, distributed {version("distributed")}.
"""


def _dearest(calls: dict[str, tuple[Watched, int]]) -> float:
    """Return the processor seconds per case of the busier of the two processes, in the undisturbed call."""
    call, cases = list(calls.values())[-1]
    return max(call.campaign, call.scheduler) / cases


def main() -> None:
    """Run the campaign and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, help="folder of the page")
    parser.add_argument("--cases", type=int, default=1000, help="number of cases (default: 1000)")
    parser.add_argument("--workers", type=int, default=8, help="number of worker processes (default: 8)")
    options = parser.parse_args()
    calls: dict[str, tuple[Watched, int]] = {}
    with tempfile.TemporaryDirectory() as name:
        path, out = campaign_file(Path(name), options.cases), Path(name) / "out"
        kept: dict[Path, int] = {}
        for call in ("worker and scheduler killed", "again, undisturbed"):
            cluster = Cluster.started(options.workers)
            try:
                watched = run(path, out, cluster, options.cases, kill=not kept)
            finally:
                cluster.end()
            finished = {case: case.stat().st_mtime_ns for case in out.glob("cases/*/outcome.json")}
            if any(finished[case] != written for case, written in kept.items()):
                raise SystemExit("finished cases ran again")
            calls[call], kept = (watched, len(finished) - len(kept)), finished
        table = rows(out)
        if len(table) != len(kept) or len(table) < options.cases or any(row["coulomb_status"] != "solved" for row in table):
            raise SystemExit(f"{len(kept)} of {options.cases} cases finished, the table has {len(table)} rows")
        text = page(calls, options.workers, case_seconds(out))
    options.output.mkdir(parents=True, exist_ok=True)
    (options.output / "campaigns.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
