"""The record of a YADE run, read from `run.h5`."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from comparison.yade.run_parts import STATUSES, Poses, RunResult, RunSeries
from la_core import exchange
from la_core.errors import SceneError, nearest
from la_core.geometry import Held
from la_core.model import Assembly
from la_core.text_table import dataframe


@dataclass(frozen=True, eq=False)
class Run(Held):
    """YADE's record of a run, read from `run.h5`; undefined numbers are NaN.

    The arrays have T time samples, P stored states, B blocks and C contact points; they are read-only.
    `la_core.exchange.RUN_FIELDS` lists all names, shapes and units.

    Attributes
    ----------
    result : RunResult
        End of the run and properties of the plateau.
    record : RunSeries
        Series over time, each with shape (T,) or (T, 6).
    poses : Poses
        Stored states; the first is at rest under gravity.
    extra_contacts : ndarray, shape (E, 2)
        Indices of block pairs that touched where the case lists no contact point.
    settings : mapping of str to Any
        All settings of the run, by name; read-only.

    Notes
    -----
    The reaction is the force of the support on the structure, against the direction of settlement; it is positive if the support holds
    the structure. For a rotation it is a moment. Under a live load its multiplier replaces the reaction, and the mean
    displacement of the loaded weights along the load replaces the settlement.
    """

    result: RunResult
    record: RunSeries
    poses: Poses
    extra_contacts: np.ndarray
    settings: Mapping[str, Any]

    def __repr__(self) -> str:
        """Return one line, because the arrays would fill pages."""
        counts = f"{len(self.record)} samples, {len(self.poses)} stored states"
        return f"<Run of YADE {self.result.version}: {self.status}, reaction {self.reaction:.6g} ± {self.uncertainty:.2g}, {counts}>"

    @property
    def status(self) -> str:
        """End of the run: "plateau", "no plateau", "collapsed", "timeout" or "failed"."""
        return self.result.status

    @property
    def reaction(self) -> float:
        """Reaction of the plateau, extrapolated to zero settlement, N or N m; NaN without a plateau."""
        return self.result.reaction

    @property
    def uncertainty(self) -> float:
        """Half width of the interval of the reaction, the sum of its parts (`result`), N or N m; NaN without a plateau."""
        return self.result.uncertainty

    def to_dataframe(self) -> Any:
        """Return the record as a pandas table: one row per sample, with stage, time (s), settlement (m, rad), reaction (N, N m).

        Returns
        -------
        pandas.DataFrame
            Table of the record.

        Raises
        ------
        SceneError
            Pandas is not installed.
        """
        names = ("stage", "time", "settlement", "reaction")
        columns = (getattr(self.record, name).tolist() for name in names)
        return dataframe([dict(zip(names, row, strict=True)) for row in zip(*columns, strict=True)])

    def settling(self, series: str) -> np.ndarray:
        """Return one recorded series of the settlement stage.

        Parameters
        ----------
        series : str
            Name of an attribute of `record`, such as "settlement" (m or rad) or "reaction" (N or N m).

        Returns
        -------
        ndarray, shape (S,) or (S, 6)
            Samples of the series in the settlement stage, in the order of time.

        Raises
        ------
        SceneError
            No series has this name.
        """
        names = [field.name for field in fields(RunSeries)]
        if series not in names:
            raise SceneError(f"series {series!r}", "unknown name", hint=nearest(str(series), names, "series"))
        return getattr(self.record, series)[self.record.stage == exchange.SETTLEMENT]

    def _on_plateau(self) -> np.ndarray:
        """Return the indices of the stored states on the plateau; an empty array without a plateau, because its start is NaN."""
        return np.flatnonzero(self.poses.settlement >= self.result.plateau_start)

    def scatter(self) -> float:
        """Return the relative scatter of the reaction on the plateau.

        Returns
        -------
        float
            Standard deviation of the reaction about the fitted line, over the reaction; NaN without a plateau.
        """
        if not len(self.record) or self.status != "plateau" or not self.result.reaction:
            return float("nan")
        settlement, reaction = self.settling("settlement"), self.settling("reaction")
        kept = settlement >= self.result.plateau_start
        line = self.result.reaction + self.result.slope * settlement
        return float(np.std((reaction - line)[kept]) / abs(self.result.reaction)) if kept.any() else float("nan")

    def plateau_forces(self) -> np.ndarray:
        """Return the mean contact forces over the plateau; without a plateau the contact forces of the last state.

        Returns
        -------
        ndarray, shape (C, 3)
            Forces on the second block of each contact, N, global axes.

        Notes
        -----
        A mean of admissible states is admissible, because the friction cone is convex. Inertial forces average out.
        """
        stored = self._on_plateau()
        return self.poses.forces[stored if len(stored) else [-1]].mean(axis=0)

    def plateau_wrenches(self, assembly: Assembly) -> np.ndarray:
        """Return the mean wrench of the contact forces on each block over the plateau; without a plateau the wrench in the last state.

        Parameters
        ----------
        assembly : Assembly
            Model of the run, with B blocks.

        Returns
        -------
        ndarray, shape (B, 6)
            Force and moment about the centroid, N and N m. Blocks and contact points have their displaced positions, because a leaning
            tall block has other lever arms. If a joint slides, the point is midway between its positions on both blocks.

        Raises
        ------
        SceneError
            The argument is no assembly, or has another number of blocks or contact points than the run.
        """
        sizes = self.poses.displacement.shape[1:2] + self.poses.forces.shape[1:2]
        if not isinstance(assembly, Assembly) or sizes != (len(assembly.blocks), len(assembly.points)):
            hint = "`result.answer.analysis.assembly` is that of `result.yade`"
            raise SceneError("assembly", "must be that of the run, with as many blocks and contact points", hint=hint)
        stored = self._on_plateau()
        stored = stored if len(stored) else np.array([len(self.poses) - 1])
        position, centroid, (a, b) = assembly.points.position, assembly.blocks.centroid, assembly.contact_blocks
        states = self.poses.displacement, self.poses.rotation, self.poses.forces
        wrenches = np.zeros((len(assembly.blocks), 6))
        for moved, turned, forces in zip(*(values[stored] for values in states), strict=True):
            places = [position + moved[block] + np.cross(turned[block], position - centroid[block]) for block in (a, b)]
            for block, sign in ((a, -1.0), (b, 1.0)):
                arm = 0.5 * (places[0] + places[1]) - centroid[block] - moved[block]
                np.add.at(wrenches, block, sign * np.hstack([forces, np.cross(arm, forces)]) / len(stored))
        return wrenches

    def mechanism(self) -> np.ndarray:
        """Return the mechanism on the plateau: the change of every block's pose per unit of support motion.

        Returns
        -------
        ndarray, shape (B, 6)
            Displacement of the centroid, then rotation vector, of every block per m (or rad) of support motion, or per m of
            mean displacement along a live load; NaN where fewer than two stored states lie on the plateau.
        """
        settlement, on_plateau = self.poses.settlement, self._on_plateau()
        twists = np.full((self.poses.displacement.shape[1], 6), np.nan)
        if len(on_plateau) >= 2:
            first, last = on_plateau[0], on_plateau[-1]
            change = [getattr(self.poses, name)[last] - getattr(self.poses, name)[first] for name in ("displacement", "rotation")]
            twists = np.concatenate(change, axis=1) / (settlement[last] - settlement[first])
        return twists


def read_run(path: Path, assembly: Assembly) -> Run:
    """Read `run.h5`; raises exchange.ExchangeError if it is damaged or belongs to another assembly.

    assembly: the assembly of the run; its numbers of blocks and contact points are checked.
    """
    missing = set(exchange.LATER_RUN_FIELDS) - set(exchange.present(path, exchange.LATER_RUN_FIELDS))
    data = exchange.read(path, tuple(field for field in exchange.RUN_FIELDS if field not in missing))
    groups: dict[str, dict[str, Any]] = {}
    for field_path, value in data.items():
        group, name = field_path.split("/")
        groups.setdefault(group, {})[name] = value.item() if isinstance(value, np.generic) else value
    states, blocks, points = groups["poses"]["forces"].shape[0], len(assembly.blocks), len(assembly.points)
    extra = groups["extra_contacts"]["blocks"]
    if groups["poses"]["displacement"].shape[1] != blocks or groups["poses"]["forces"].shape[1] != points:
        raise exchange.ExchangeError(f"{path}: its numbers of blocks and contact points are those of another assembly; run the scene again")
    with exchange.values_of(path):
        settings = json.loads(groups["settings"]["json"])
        if not isinstance(settings, dict) or not set(exchange.SETTINGS) - set(exchange.LATER_SETTINGS) <= set(settings):
            raise ValueError("settings are missing in settings/json")
        if states == 0 or groups["result"]["status"] not in STATUSES or not np.all((extra >= 0) & (extra < blocks)):
            raise ValueError("no stored state, an unknown status, or a block number out of range")
    result = RunResult(**groups["result"] | _without_plateau(groups["result"]["status"]))
    return Run(result, RunSeries(**groups["record"]), Poses(**groups["poses"]), extra, settings)


def _without_plateau(status: str) -> dict[str, float]:
    """Return NaN for the values that do not exist without a plateau, so that an unfinished value is never quoted."""
    return {} if status == "plateau" else dict.fromkeys(("reaction", "uncertainty", "slope"), float("nan"))
