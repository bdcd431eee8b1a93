"""Made-up results for tests: runs of YADE, whose missing values are undefined or empty, and changed limit analyses."""

import dataclasses
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from comparison.yade.run_parts import Poses, RunResult, RunSeries
from comparison.yade.run_record import Run
from la_core import exchange
from la_core.analysis.result import LimitAnalysis
from la_core.limit.problem import Drive

TRAVEL = 1e-3  # m
WORDS = {"status": "plateau", "version": "made up", "message": "made up"}
COUNTS = {"steps": 0}


def made_up_run(
    result: Mapping[str, Any] | None = None,
    record: Mapping[str, np.ndarray] | None = None,
    poses: Mapping[str, np.ndarray] | None = None,
    settings: Mapping[str, Any] | None = None,
) -> Run:
    """Return a run of these values by their names in run.h5. Other numbers are NaN; other series and states are empty. No block jumps.

    Tests may change its arrays in place; arrays of real runs are read-only.
    """

    def filled(kind: Any, given: Mapping[str, Any] | None, other: Any) -> Any:
        return kind(**{field.name: other for field in dataclasses.fields(kind)} | dict(given or {}))

    ended = filled(RunResult, WORDS | COUNTS | dict(result or {}), float("nan"))
    empty = np.zeros(0)
    if record is not None and "stage" in record:
        record = {"unbalanced": np.zeros(len(record["stage"]))} | dict(record)
    run = Run(ended, filled(RunSeries, record, empty), filled(Poses, poses, empty), np.zeros((0, 2), dtype=int), dict(settings or {}))
    for array in (*run.record.values(), *run.poses.values()):
        array.setflags(write=True)
    return run


def with_answers(analysis: LimitAnalysis, **changes: Any) -> LimitAnalysis:
    """Return the analysis with other answers, or another assembly, at the shared inset."""
    return dataclasses.replace(analysis, at_inset=dataclasses.replace(analysis.at_inset, **changes))


def perfect_run(analysis: LimitAnalysis, **result: object) -> Run:
    """Return a run that equals limit analysis in every digit: reaction, mechanism and forces of the least reaction."""
    least = analysis.bounds[Drive.YIELDING]
    settlement = np.linspace(0.0, TRAVEL, 5)
    scalars = {
        "status": "plateau", "reaction": least.value, "uncertainty": 0.0, "settlement": TRAVEL, "asked_settlement": TRAVEL,
        "plateau_start": 0.3 * TRAVEL, "slope": 0.0, "kinetic_ratio": 1e-6, "steps": 1000, "seconds": 1.0, "version": "made up",
        "message": "steady",
    }  # fmt: skip
    poses = {
        "settlement": settlement,
        "displacement": settlement[:, None, None] * least.twists[None, :, :3],
        "rotation": settlement[:, None, None] * least.twists[None, :, 3:],
        "forces": np.repeat(least.forces[None], 5, axis=0),
    }
    return made_up_run({**scalars, **result}, poses=poses)


def coulomb_run(analysis: LimitAnalysis, scatter: float = 0.0, **result: object) -> Run:
    """Return a run that follows the Coulomb prediction. scatter: root mean square scatter of its reaction, over the reaction."""
    assert analysis.coulomb is not None
    coulomb = analysis.coulomb
    stand_in = dataclasses.replace(analysis.bounds[Drive.YIELDING], value=coulomb.value, twists=coulomb.twists, forces=coulomb.forces)
    run = perfect_run(with_answers(analysis, bounds={**analysis.bounds, Drive.YIELDING: stand_in}), **result)
    settlement = np.linspace(0.0, TRAVEL, 400)
    reaction = run.result.reaction * (1.0 + np.sqrt(2.0) * scatter * np.sin(np.arange(400.0)))
    record = {"stage": np.ones(400, dtype=int), "settlement": settlement, "reaction": reaction, "kinetic_energy": np.full(400, 1e-12)}
    return dataclasses.replace(run, record=made_up_run(record=record).record)


def write_run(path: Path, run: Run, inputs: str) -> None:
    """Write a run as YADE's process does. Missing series and settings are 0."""
    count = len(run.record.settlement)
    shapes = {field.name: (count, 6) if field.name == "support_wrench" else (count,) for field in dataclasses.fields(RunSeries)}
    series = {name: value if len(value := getattr(run.record, name)) else np.zeros(shape) for name, shape in shapes.items()}
    values = {f"result/{name}": value for name, value in vars(run.result).items()} | {f"record/{name}": one for name, one in series.items()}
    values |= {f"poses/{name}": value for name, value in vars(run.poses).items()}
    values |= {"settings/json": json.dumps(dict.fromkeys(exchange.SETTINGS, 0.0) | run.settings)}
    values |= {"extra_contacts/blocks": run.extra_contacts, "extra_contacts/position": np.zeros((len(run.extra_contacts), 3))}
    exchange.write(path, exchange.RUN_FIELDS, values, inputs)
