"""Results made up for tests: runs of YADE, where what a test does not give is undefined or empty, and changed limit analyses."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np

from comparison.yade.run_record import Poses, Run, RunResult, RunSeries
from la_core.analysis.result import LimitAnalysis

WORDS = {"status": "plateau", "version": "made up", "message": "made up"}
COUNTS = {"steps": 0}


def made_up_run(
    result: Mapping[str, Any] | None = None,
    record: Mapping[str, np.ndarray] | None = None,
    poses: Mapping[str, np.ndarray] | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Run:
    """A run of these values by their names in run.h5; other numbers are NaN, other series and states empty."""

    def filled(kind: Any, given: Mapping[str, Any] | None, other: Any) -> Any:
        return kind(**{field.name: other for field in dataclasses.fields(kind)} | dict(given or {}))

    ended = filled(RunResult, WORDS | COUNTS | dict(result or {}), float("nan"))
    empty = np.zeros(0)
    return Run(ended, filled(RunSeries, record, empty), filled(Poses, poses, empty), np.zeros((0, 2), dtype=int), dict(settings or {}))


def with_answers(analysis: LimitAnalysis, **changes: Any) -> LimitAnalysis:
    """The analysis with other answers, or another assembly, at the shared inset."""
    return dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, **changes))
