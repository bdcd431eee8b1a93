"""Jobs on worker processes of this machine."""

from typing import Any

from comparison.campaign.job import Job, JobOutcome, failure, run_job
from comparison.errors import message_of
from comparison.numbers import plural
from comparison.workflow import WorkerProcesses
from comparison.yade import find_yade
from la_core.analysis import Silent


class Local:
    """Jobs on worker processes of this machine, at most `capacity` at a time; leaving the context ends all processes."""

    def __init__(self, workers: int, yade: bool) -> None:
        self.capacity, self._yade = workers, yade
        self.name = f"this machine, {plural(workers, 'worker')}"
        self._processes = WorkerProcesses(_work, workers)

    def __enter__(self) -> "Local":
        if self._yade:
            find_yade()  # without YADE every case would fail
        self._processes.__enter__()
        return self

    def __exit__(self, *error: object) -> None:
        self._processes.__exit__(*error)

    def begin(self, job: Job) -> None:
        """Hand a job to a worker."""
        self._processes.begin(job)

    def ended(self, seconds: float) -> list[tuple[Job, JobOutcome]]:
        """Return jobs that ended, with their outcomes; waits at most `seconds` for the first one."""
        ended = self._processes.ended(seconds)
        return [(job, failure(message_of(made), job) if isinstance(made, Exception) else made) for job, made in ended]


class _Quiet(Silent):
    """A listener of all stages that reports nothing."""

    def stage(self, scene: str, stage: str, state: str) -> None:
        pass

    def progress(self, scene: str, report: dict[str, Any]) -> None:
        pass


def _work(job: Job) -> JobOutcome:
    """Run a job in a worker."""
    return run_job(job, _Quiet())
