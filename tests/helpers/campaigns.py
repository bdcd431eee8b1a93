"""Helpers for tests of campaigns: an engine in this process, and a campaign from its text to its table."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from conftest import Silent
from rich.console import Console

from comparison.campaign import definition
from comparison.campaign.cases import expand
from comparison.campaign.engine import Campaign, run_cases
from comparison.campaign.job import Job, JobOutcome, run_job
from comparison.campaign.table import CampaignTable
from comparison.progress import CampaignNarration

QUICK = """
title = "Friction of two scenes"
yade = false

[[sweep]]
scene = "two_blocks"
vary = { "joint.friction" = [0.3, 0.6] }

[[sweep]]
scene = "two_pads"
vary = { "joint.friction" = [0.4, 0.5] }
"""  # scenes whose limit analysis takes milliseconds


class Inline:
    """An engine that runs jobs in this process, one after the other, and records them in `done`. `fails` may raise instead of a job."""

    name, capacity = "inline", 1

    def __init__(self, fails: Callable[[Job], None] = lambda job: None) -> None:
        self.done: list[str] = []
        self._ended: list[tuple[Job, JobOutcome]] = []
        self._fails = fails

    def __enter__(self) -> "Inline":
        return self

    def __exit__(self, *error: object) -> None:
        pass

    def begin(self, job: Job) -> None:
        self._fails(job)
        self.done.append(job.folder.name)
        self._ended.append((job, run_job(job, Silent())))

    def ended(self, seconds: float) -> list[tuple[Job, JobOutcome]]:
        return [self._ended.pop()]


def campaign(text: str, folder: Path, time_limit: float | None = None) -> Campaign:
    """Write the text of a campaign beside the folder of its results, and return the campaign."""
    path = folder.parent / "campaign.toml"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    asked = definition.load_campaign(path)
    return Campaign(asked, expand(asked), folder, asked.file.yade, time_limit=time_limit)


def run(text: str, folder: Path, engine: Any = None, time_limit: float | None = None) -> CampaignTable:
    """Run the campaign of a text in a folder. Without an engine it runs in this process."""
    with CampaignNarration(Console(quiet=True), "test") as narration:
        return run_cases(campaign(text, folder, time_limit), engine or Inline(), narration)


def begun(folder: Path) -> list[str]:
    """Return the cases of a campaign's folder that have begun."""
    return sorted(path.parent.name for path in folder.glob("cases/*/.lock"))


def finished(folder: Path) -> dict[str, int]:
    """Return the finished cases of a campaign's folder, with the time when each finished, ns."""
    return {path.parent.name: path.stat().st_mtime_ns for path in folder.glob("cases/*/outcome.json")}


def written(tmp_path: Path, text: str) -> Path:
    """Write a campaign file and return its path."""
    path = tmp_path / "campaign.toml"
    path.write_text(text, encoding="utf-8")
    return path


def sweep(text: str, scene: str = "two_pads") -> str:
    """Return the text of a campaign file with one sweep, without YADE."""
    return f'yade = false\n[[sweep]]\nscene = "{scene}"\n{text}\n'
