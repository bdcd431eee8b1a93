"""YADE's record of a run, as read from `run.h5`."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from la_core import exchange
from la_core.model import Assembly

STATUSES = ("plateau", "no plateau", "collapsed", "timeout", "failed")


class _Named:
    """Values by attribute, and by name as in `run.h5`: `run.result.reaction` is `run.result["reaction"]`."""

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


@dataclass(frozen=True)
class RunResult(_Named):
    """How a run ended and its plateau; NaN where undefined.

    status: one of STATUSES. reaction, uncertainty: of the plateau, N or N m, extrapolated to zero settlement. settlement: reached by the
    support, m or rad; asked_settlement: imposed. plateau_start: settlement where the fitted plateau begins. slope: of the fitted line, N/m.
    kinetic_ratio: largest kinetic energy on the plateau over the work of the weights there. steps: time steps. seconds: inside YADE.
    """

    status: str
    reaction: float
    uncertainty: float
    settlement: float
    asked_settlement: float
    plateau_start: float
    slope: float
    kinetic_ratio: float
    steps: int
    seconds: float
    version: str
    message: str


@dataclass(frozen=True)
class RunSeries(_Named):
    """Series (T,) recorded over time.

    stage: 0 gravity, 1 settlement. time: s. settlement: of the support, m or rad. reaction: N or N m. support_wrench (T, 6): of the
    supports on the structure about the origin. kinetic_energy: of the free blocks, J. unbalanced: largest force over the mean block weight.
    """

    stage: np.ndarray
    time: np.ndarray
    settlement: np.ndarray
    reaction: np.ndarray
    support_wrench: np.ndarray
    kinetic_energy: np.ndarray
    unbalanced: np.ndarray

    def __len__(self) -> int:
        return len(self.stage)


@dataclass(frozen=True)
class Poses(_Named):
    """Stored states (P,), the first at rest under gravity.

    settlement (P,): m or rad. displacement (P, B, 3): of centroids, m. rotation (P, B, 3): rotation vectors. forces (P, C, 3): on b, N.
    """

    settlement: np.ndarray
    displacement: np.ndarray
    rotation: np.ndarray
    forces: np.ndarray

    def __len__(self) -> int:
        return len(self.settlement)


@dataclass(frozen=True)
class Run:
    """YADE's record of a run; names and units are those of `la_core.exchange.RUN_FIELDS`, NaN where undefined.

    result: how it ended, and the plateau. record: series over time. poses: stored states. extra_contacts: block pairs (E, 2) that touched
    where the case lists no contact point. settings: as used.
    """

    result: RunResult
    record: RunSeries
    poses: Poses
    extra_contacts: np.ndarray
    settings: dict[str, Any]

    @property
    def status(self) -> str:
        """plateau, no plateau, collapsed, timeout or failed."""
        return self.result.status

    @property
    def reaction(self) -> float:
        """Reaction on the plateau, extrapolated to no settlement, N or N m; NaN where there is no plateau."""
        return self.result.reaction

    @property
    def uncertainty(self) -> float:
        """Half width of the interval that holds the reaction 19 times in 20, N or N m."""
        return self.result.uncertainty

    def settling(self, series: str) -> np.ndarray:
        """One recorded series during the settlement stage."""
        return getattr(self.record, series)[self.record.stage == 1]

    def _on_plateau(self) -> np.ndarray:
        """Indices of the stored states on the plateau; a comparison with an undefined start finds none."""
        return np.flatnonzero(self.poses.settlement >= self.result.plateau_start)

    def scatter(self) -> float:
        """Standard deviation of the reaction about the plateau's line, over the reaction; NaN where there is no plateau."""
        if not len(self.record) or self.status != "plateau" or not self.result.reaction:
            return float("nan")
        settlement, reaction = self.settling("settlement"), self.settling("reaction")
        kept = settlement >= self.result.plateau_start
        line = self.result.reaction + self.result.slope * settlement
        return float(np.std((reaction - line)[kept]) / abs(self.result.reaction)) if kept.any() else float("nan")

    def plateau_forces(self) -> np.ndarray:
        """Mean contact forces (C, 3) over the plateau, N: a mean of admissible states is one, and inertia averages out of it."""
        stored = self._on_plateau()
        return self.poses.forces[stored if len(stored) else [-1]].mean(axis=0)

    def mechanism(self) -> np.ndarray:
        """Twists (B, 6) for unit support motion: change of pose over the plateau; NaN when fewer than two poses lie on it."""
        settlement, on_plateau = self.poses.settlement, self._on_plateau()
        twists = np.full((self.poses.displacement.shape[1], 6), np.nan)
        if len(on_plateau) >= 2:
            first, last = on_plateau[0], on_plateau[-1]
            change = [getattr(self.poses, name)[last] - getattr(self.poses, name)[first] for name in ("displacement", "rotation")]
            twists = np.concatenate(change, axis=1) / (settlement[last] - settlement[first])
        return twists


def read_run(path: Path, assembly: Assembly) -> Run:
    """Read `run.h5`; raises exchange.ExchangeError when it is not whole or belongs to another assembly."""
    data = exchange.read(path, exchange.RUN_FIELDS)
    groups: dict[str, dict[str, Any]] = {}
    for field_path, value in data.items():
        group, name = field_path.split("/")
        groups.setdefault(group, {})[name] = value.item() if isinstance(value, np.generic) else value
    states, blocks, points = groups["poses"]["forces"].shape[0], len(assembly.blocks), len(assembly.points)
    extra = groups["extra_contacts"]["blocks"]
    if groups["poses"]["displacement"].shape[1] != blocks or groups["poses"]["forces"].shape[1] != points:
        raise exchange.ExchangeError(f"{path}: recorded on another assembly; run it again")
    with exchange.values_of(path):
        settings = json.loads(groups["settings"]["json"])
        if not isinstance(settings, dict) or not set(exchange.SETTINGS) <= set(settings):
            raise ValueError("settings/json lacks settings")
        if states == 0 or groups["result"]["status"] not in STATUSES or not np.all((extra >= 0) & (extra < blocks)):
            raise ValueError("a state, a status or a block is none")
    return Run(RunResult(**groups["result"]), RunSeries(**groups["record"]), Poses(**groups["poses"]), extra, settings)
