"""YADE's record of a run, as read from `run.h5`."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from la_core import exchange
from la_core.model import Assembly

STATUSES = ("plateau", "no plateau", "collapsed", "timeout", "failed")


@dataclass(frozen=True)
class Run:
    """What YADE recorded; names and units are those of `la_core.exchange.RUN_FIELDS`, NaN where undefined.

    result: scalars of the outcome; record: series (T,) against time; poses: stored states, the first at rest under gravity.
    extra_contacts: block pairs (E, 2) that touched where the case lists no contact point. settings: as used.
    """

    result: dict[str, Any]
    record: dict[str, np.ndarray]
    poses: dict[str, np.ndarray]
    extra_contacts: np.ndarray
    settings: dict[str, Any]

    @property
    def status(self) -> str:
        """plateau, no plateau, collapsed, timeout or failed."""
        return str(self.result["status"])

    @property
    def reaction(self) -> float:
        """Reaction on the plateau, extrapolated to no settlement, N or N m; NaN where there is no plateau."""
        return float(self.result["reaction"])

    @property
    def uncertainty(self) -> float:
        """Half width of the interval that holds the reaction 19 times in 20, N or N m."""
        return float(self.result["uncertainty"])

    def settling(self, series: str) -> np.ndarray:
        """One recorded series during the settlement stage."""
        return self.record[series][self.record["stage"] == 1]

    def _on_plateau(self) -> np.ndarray:
        """Indices of the stored states on the plateau; a comparison with an undefined start finds none."""
        return np.flatnonzero(self.poses["settlement"] >= self.result["plateau_start"])

    def scatter(self) -> float:
        """Standard deviation of the reaction about the plateau's line, over the reaction; NaN where there is no plateau."""
        if not self.record or self.status != "plateau" or not self.result["reaction"]:
            return float("nan")
        settlement, reaction = self.settling("settlement"), self.settling("reaction")
        kept = settlement >= self.result["plateau_start"]
        line = self.result["reaction"] + self.result["slope"] * settlement
        return float(np.std((reaction - line)[kept]) / abs(self.result["reaction"])) if kept.any() else float("nan")

    def plateau_forces(self) -> np.ndarray:
        """Mean contact forces (C, 3) over the plateau, N: a mean of admissible states is one, and inertia averages out of it."""
        stored = self._on_plateau()
        return self.poses["forces"][stored if len(stored) else [-1]].mean(axis=0)

    def mechanism(self) -> np.ndarray:
        """Twists (B, 6) for unit support motion: change of pose over the plateau; NaN when fewer than two poses lie on it."""
        settlement, on_plateau = self.poses["settlement"], self._on_plateau()
        twists = np.full((self.poses["displacement"].shape[1], 6), np.nan)
        if len(on_plateau) >= 2:
            first, last = on_plateau[0], on_plateau[-1]
            change = [self.poses[name][last] - self.poses[name][first] for name in ("displacement", "rotation")]
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
    return Run(groups["result"], groups["record"], groups["poses"], extra, settings)
