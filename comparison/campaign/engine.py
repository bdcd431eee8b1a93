"""The campaign itself: what is finished is kept, the rest is handed to workers, whatever ends is gathered in the tables."""

import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol, Self

from comparison.campaign import table
from comparison.campaign.cases import Case, CaseRun, axes
from comparison.campaign.columns import result_columns
from comparison.campaign.definition import Definition
from comparison.campaign.job import LOADED, Job, JobOutcome, digest, stored_outcome
from comparison.campaign.narration import CampaignNarration
from comparison.provenance import describe
from comparison.run_folder import alone_in, write_text
from la_core.limit import ClassicParameters

CASES = "cases"  # folder of the cases' folders
LOOKS_EVERY = 0.5  # s
WRITES_EVERY = 10.0  # s between tables, while cases end


class Engine(Protocol):
    """What does jobs; entered only where there are some."""

    name: str
    capacity: int

    def __enter__(self) -> Self:
        """Make ready; raises for what would fail every job."""

    def __exit__(self, *error: object) -> None:
        """End every job at once."""

    def begin(self, job: Job) -> None:
        """Hand out a job; at most `capacity` are out at a time."""

    def ended(self, seconds: float) -> list[tuple[Job, JobOutcome]]:
        """Jobs that ended, with what they came to, once there is one or after so many seconds."""


@dataclass(frozen=True)
class Campaign:
    """Cases to run in a folder.

    yade: whether YADE takes part. parquet: whether tables are written as Parquet as well. time_limit: wall seconds for each YADE run, None
    for the scenes' own; as for `crosscheck run` no part of what decides an outcome, for a run that it ended is made again.
    """

    definition: Definition
    cases: list[Case]
    folder: Path
    yade: bool
    parquet: bool = False
    time_limit: float | None = None

    def folder_of(self, run: CaseRun) -> Path:
        """A run's own folder."""
        return self.folder / CASES / run.name


def run_campaign(
    campaign: Campaign,
    engine: Engine,
    narration: CampaignNarration,
    conclude: Callable[[table.CampaignTable], object] = lambda found: None,
) -> table.CampaignTable:
    """Run what is not finished; tables are written however this ends. Raises FolderInUseError where another works in the folder.

    conclude: called with the final table while the folder is still held.
    """
    campaign.folder.mkdir(parents=True, exist_ok=True)
    with alone_in(campaign.folder):
        write_text(campaign.folder / "campaign.toml", campaign.definition.text)
        began, outcomes = time.monotonic(), dict[str, JobOutcome]()
        waiting = _waiting(campaign, outcomes)
        narration.opens(len(campaign.cases), len(waiting) + len(outcomes), len(outcomes))
        with _tables(campaign, outcomes, engine, began) as write:
            if waiting:
                with engine:
                    _run_all(campaign, deque(waiting), engine, narration, outcomes, write)
        found = table.read_campaign(campaign.folder)
        conclude(found)
    return found


def _waiting(campaign: Campaign, outcomes: dict[str, JobOutcome]) -> list[tuple[CaseRun, dict[str, ClassicParameters], str]]:
    """Runs that are not finished, each with the classic iterations asked for and the digest of its inputs; the others' are filled in."""
    found = []
    runs = {case.run.name: case.run for case in campaign.cases}
    classic: dict[str, dict[str, ClassicParameters]] = {name: {} for name in runs}
    for case in campaign.cases:
        if case.classic is not None:
            classic[case.run.name][case.name] = case.classic
    for name, run in runs.items():
        inputs = digest(run, campaign.yade, classic[name], LOADED)
        if (stored := stored_outcome(campaign.folder_of(run), run.scene_name, inputs)) is not None:
            outcomes[name] = stored
        else:
            found.append((run, classic[name], inputs))
    return found


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
def _tables(campaign: Campaign, outcomes: dict[str, JobOutcome], engine: Engine, began: float) -> Iterator[Callable[[], None]]:
    """Gives what writes the tables, at most now and then; they are written at the end in any case."""
    latest = time.monotonic()

    def write() -> None:
        nonlocal latest
        if time.monotonic() - latest >= WRITES_EVERY:
            table.write_campaign(gather(campaign, outcomes, engine.name, began), campaign.parquet)
            latest = time.monotonic()

    try:
        yield write
    finally:
        table.write_campaign(gather(campaign, outcomes, engine.name, began), campaign.parquet)


def gather(campaign: Campaign, outcomes: dict[str, JobOutcome], engine: str, began: float) -> table.CampaignTable:
    """The table of the cases that ended, in the campaign's order."""
    keys, rows, costs = campaign.definition.keys, [], []
    blank = dict.fromkeys(result_columns(keys))
    for case in campaign.cases:
        outcome = outcomes.get(case.run.name)
        if outcome is None:
            continue
        classic = outcome["classic"].get(case.name, {})
        row = (
            blank
            | {"case": case.name, "sweep": case.sweep, "scene": case.run.scene_name}
            | case.values
            | {"state": outcome["state"]}
            | outcome["answers"]
        )
        row |= {"classic": classic.get("value"), "classic_status": classic.get("status"), "classic_iterations": classic.get("iterations")}
        rows.append(row | {"folder": f"{CASES}/{case.run.name}"})
        own = {"classic_seconds": classic.get("seconds"), "classic_iterations": classic.get("iterations")}
        costs.append({"case": case.name} | outcome["costs"] | own)
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
