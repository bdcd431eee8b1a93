"""Every field of `run.h5`, from the record of a finished run."""

import dataclasses
import json
from typing import Any

import numpy as np
from yade import config

from la_core.exchange import SETTLEMENT
from yade_scripts.attempts import Attempts
from yade_scripts.contacts.frame import about_old_origin
from yade_scripts.plateau import Pose
from yade_scripts.protocol import Protocol
from yade_scripts.recorder import Row

_NO_WORK = 1e-6  # of the largest possible work of the weights: any smaller work is due to the joints' elastic strain alone


def fields(made: Attempts, seconds: float) -> dict[str, Any]:
    """Return the values of all fields of `run.h5` by path. seconds: wall time of all attempts."""
    run = made.last
    values: dict[str, Any] = {
        "result/status": run.status.value if run.status else "failed",
        "result/reaction": made.outcome.reaction,
        "result/uncertainty": made.outcome.uncertainty,
        **{f"result/uncertainty_{part}": getattr(made.outcome, part) for part in ("scatter", "fit", "rate", "stiffness")},
        "result/settlement": run.record.settlement(),
        "result/asked_settlement": run.asked_settlement,
        "result/plateau_start": run.plateau.start,
        "result/slope": run.plateau.slope,
        "result/kinetic_ratio": kinetic_ratio(run),
        "result/steps": made.steps,
        "result/seconds": seconds,
        "result/version": config.version,
        "result/message": made.message,
        "settings/json": json.dumps(dataclasses.asdict(run.settings), sort_keys=True),
    }
    return values | _rows(run) | _poses(run) | _extra(run)


def kinetic_ratio(run: Protocol) -> float:
    """Return the largest kinetic energy on the plateau over the absolute work of the weights there; NaN without a plateau or work."""
    fitted = [row for row in run.record.rows if row.stage == SETTLEMENT and row.settlement >= run.plateau.start]
    if not fitted:
        return float("nan")
    case, travel = run.case, fitted[-1].settlement - fitted[0].settlement
    most = case.weight * travel * case.support_speed  # all free blocks sink with the support
    work = abs(fitted[-1].weight_work - fitted[0].weight_work)
    return max(row.kinetic_energy for row in fitted) / work if work > _NO_WORK * most else float("nan")


def _rows(run: Protocol) -> dict[str, Any]:
    rows: list[Row] = run.record.rows
    names = ("stage", "time", "settlement", "reaction", "kinetic_energy", "damped_energy", "unbalanced")
    wrenches = about_old_origin(np.array([row.support_wrench for row in rows]).reshape(-1, 6), run.case.origin)
    return {f"record/{name}": np.array([getattr(row, name) for row in rows]) for name in names} | {"record/support_wrench": wrenches}


def _poses(run: Protocol) -> dict[str, Any]:
    """Return the stored states by path; blocks that the case leaves out do not move."""
    poses = {name: np.array([getattr(pose, name) for pose in run.record.poses]) for name in Pose._fields}
    for name in ("displacement", "rotation"):
        every = np.zeros((len(run.record.poses), run.case.total, 3))
        every[:, run.case.index] = poses[name]
        poses[name] = every
    return {f"poses/{name}": value for name, value in poses.items()}


def _extra(run: Protocol) -> dict[str, Any]:
    contacts = sorted(run.record.extra.items())
    return {
        "extra_contacts/blocks": run.case.index[np.array([pair for pair, _ in contacts], dtype=int).reshape(-1, 2)],
        "extra_contacts/position": np.array([point for _, point in contacts], dtype=float).reshape(-1, 3) + run.case.origin,
    }
