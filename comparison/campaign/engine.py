"""The run of a campaign: keep finished cases, hand the others to workers, gather all outcomes in the tables."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol, Self

from comparison.campaign import table
from comparison.campaign.cases import Case, CaseRun, axes
from comparison.campaign.columns import result_columns
from comparison.campaign.definition import Definition
from comparison.campaign.job import LOADED, Job, JobOutcome, digest, stored_outcome
from comparison.progress import CampaignNarration
from comparison.provenance import describe
from comparison.run_folder import CASES, DEFINITION, REPORTS, alone_in, write_text
from la_core.exchange import ExchangeError
from la_core.limit import ClassicParameters

LOOKS_EVERY = 0.5  # s
WRITES_EVERY = 10.0  # s between two writings of the tables, while cases end


class Engine(Protocol):
    """Workers that run jobs, as a context that is entered only if there are jobs.

    name: text for the provenance. capacity: number of jobs that can run at a time.
    """

    name: str
    capacity: int

    def __enter__(self) -> Self:
        """Start the workers; raises an error for any cause that would make every job fail."""

    def __exit__(self, *error: object) -> None:
        """End every job at once."""

    def begin(self, job: Job) -> None:
        """Start a job; at most `capacity` jobs run at a time."""

    def ended(self, seconds: float) -> list[tuple[Job, JobOutcome]]:
        """Return jobs that ended, with their outcomes; waits for the first one, at most `seconds`."""


@dataclass(frozen=True)
class Campaign:
    """Cases to run in a folder.

    Attributes
    ----------
    definition : Definition
        The campaign file.
    cases : list of Case
        Its cases, in order.
    folder : Path
        Folder of all results.
    yade : bool
        Whether YADE runs.
    parquet : bool
        Whether the tables are also written as Parquet.
    time_limit : float or None
        Wall time limit of each YADE run (s); None takes the scenes' own. The limit is no part of the inputs' digest: a case is
        repeated anyway where a limit ended YADE's run, or where the limit now allows a slower run that a requested accuracy needs.
    """

    definition: Definition
    cases: list[Case]
    folder: Path
    yade: bool
    parquet: bool = False
    time_limit: float | None = None

    def folder_of(self, run: CaseRun) -> Path:
        """Return the folder of a run."""
        return self.folder / CASES / run.name


def run_cases(
    campaign: Campaign,
    engine: Engine,
    narration: CampaignNarration,
    conclude: Callable[[table.CampaignTable], object] = lambda _: None,
) -> table.CampaignTable:
    """Run the unfinished cases of a campaign and return its table; the tables are written even if the run is interrupted.

    engine: workers that run the cases. narration: receives the progress. conclude: called with the final table, or with that of an
    interrupted run, while the folder is still locked. Raises FolderInUseError if another process works in the folder.
    """
    campaign.folder.mkdir(parents=True, exist_ok=True)
    with alone_in(campaign.folder):
        write_text(campaign.folder / DEFINITION, campaign.definition.text)
        began, outcomes = time.monotonic(), dict[str, JobOutcome]()
        waiting = _waiting(campaign, outcomes)
        narration.opens(len(campaign.cases), len(waiting) + len(outcomes), len(outcomes))
        ran_before = None if waiting else _engine_of_stored(campaign.folder)
        if waiting:  # neither reports nor tables may be those of cases that run again now, however this run ends
            for name in REPORTS:
                (campaign.folder / name).unlink(missing_ok=True)
            table.write_campaign(gather(campaign, outcomes, engine.name, began), campaign.parquet)
        with _tables(campaign, outcomes, lambda: ran_before or engine.name, began, conclude) as write:
            if waiting:
                with engine:
                    _run_all(campaign, deque(waiting), engine, narration, outcomes, write)
        return table.read_table(campaign.folder)


def _waiting(campaign: Campaign, outcomes: dict[str, JobOutcome]) -> list[tuple[CaseRun, dict[str, ClassicParameters], str]]:
    """Return unfinished runs with their classic iterations and the digest of their inputs; adds stored outcomes to `outcomes`."""
    waiting = []
    runs = {case.run.name: case.run for case in campaign.cases}
    classic: dict[str, dict[str, ClassicParameters]] = {name: {} for name in runs}
    for case in campaign.cases:
        if case.classic is not None:
            classic[case.run.name][case.name] = case.classic
    for name, run in runs.items():
        inputs = digest(run, campaign.yade, classic[name], LOADED)
        if (stored := stored_outcome(campaign.folder_of(run), run.scene_name, inputs, campaign.time_limit)) is not None:
            outcomes[name] = stored
        else:
            waiting.append((run, classic[name], inputs))
    return waiting


def _run_all(
    campaign: Campaign,
    waiting: deque[tuple[CaseRun, dict[str, ClassicParameters], str]],
    engine: Engine,
    narration: CampaignNarration,
    outcomes: dict[str, JobOutcome],
    write: Callable[[], None],
) -> None:
    running = 0
    while waiting or running:
        while waiting and running < engine.capacity:
            run, classic, inputs = waiting.popleft()
            folder = campaign.folder_of(run)
            engine.begin(Job(run.scene(), folder, campaign.yade, classic, inputs, LOADED, campaign.time_limit))
            running += 1
            narration.begins()
        for job, outcome in engine.ended(LOOKS_EVERY):
            running -= 1
            outcomes[job.folder.name] = outcome
            narration.ends(job.folder.name, outcome["state"], outcome["answers"]["reason"] or "")
            write()
        narration.shows()


@contextmanager
def _tables(
    campaign: Campaign,
    outcomes: dict[str, JobOutcome],
    engine: Callable[[], str],
    began: float,
    conclude: Callable[[table.CampaignTable], object],
) -> Iterator[Callable[[], None]]:
    """Yield a function that writes the tables at most every WRITES_EVERY seconds; write them at the end anyway, and call `conclude`.

    engine: returns the name of the workers, which may change while they run.
    """
    latest = time.monotonic()

    def write() -> None:
        nonlocal latest
        if time.monotonic() - latest >= WRITES_EVERY:
            table.write_campaign(gather(campaign, outcomes, engine(), began), campaign.parquet)
            latest = time.monotonic()

    try:
        yield write
    finally:
        table.write_campaign(gather(campaign, outcomes, engine(), began), campaign.parquet)
        conclude(table.read_table(campaign.folder))


def _engine_of_stored(folder: Path) -> str | None:
    """Return the name of the workers that ran the stored campaign; None where it is unknown."""
    try:
        return table.read_table(folder).provenance.get("engine")
    except ExchangeError:
        return None


def gather(campaign: Campaign, outcomes: dict[str, JobOutcome], engine: str, began: float) -> table.CampaignTable:
    """Return the table of the cases that ended, in the campaign's order.

    outcomes: by the name of the run. engine: name of the workers. began: start of the campaign on the monotonic clock (s).
    """
    blank = dict.fromkeys(result_columns(campaign.definition.keys))
    ended = [(case, outcome) for case in campaign.cases if (outcome := outcomes.get(case.run.name)) is not None]
    rows = [blank | _row_of(case, outcome) for case, outcome in ended]
    costs = [_costs_of(case, outcome) for case, outcome in ended]
    provenance = {
        "file": campaign.definition.path.name,
        "yade": campaign.yade,
        "cases": len(campaign.cases),
        "ended": len(rows),
        "engine": engine,
        "seconds": time.monotonic() - began,
        "program": describe(),
    }
    varied = axes(campaign.definition, campaign.cases)
    return table.CampaignTable(
        campaign.definition.title, varied, rows, costs, provenance, campaign.folder, dict(campaign.definition.file.labels)
    )


def _row_of(case: Case, outcome: JobOutcome) -> dict[str, Any]:
    """Return the row of a case in results.csv, without the columns that it leaves empty."""
    classic = outcome["classic"].get(case.name, {})
    return (
        {"case": case.name, "sweep": case.sweep, "scene": case.run.path.stem}
        | case.values
        | {"state": outcome["state"]}
        | outcome["answers"]
        | {"classic": classic.get("value"), "classic_status": classic.get("status"), "classic_iterations": classic.get("iterations")}
        | {"folder": f"{CASES}/{case.run.name}"}
    )


def _costs_of(case: Case, outcome: JobOutcome) -> dict[str, Any]:
    """Return the row of a case in costs.csv."""
    classic = outcome["classic"].get(case.name, {})
    classic_costs = {"classic_seconds": classic.get("seconds"), "classic_iterations": classic.get("iterations")}
    return {"case": case.name} | outcome["costs"] | classic_costs
