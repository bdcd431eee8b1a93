"""The parts of the record of a YADE run: its end, its series over time and its stored states."""

from collections.abc import ItemsView, Iterator, KeysView, ValuesView
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from la_core.geometry import Held

NAN = float("nan")
STATUSES = ("plateau", "no plateau", "collapsed", "timeout", "failed")


class _Named:
    """Access to attributes also by their name in `run.h5`: `run.result["reaction"]` is `run.result.reaction`.

    In version 0.2.0 these objects were dictionaries. Code that iterates over names, or reads a name, works as before. `len` counts samples.
    """

    def __getitem__(self, name: str) -> Any:
        return vars(self)[name]

    def __iter__(self) -> Iterator[str]:
        return iter(vars(self))

    def __contains__(self, name: object) -> bool:
        return name in vars(self)

    def get(self, name: str, default: Any = None) -> Any:
        """Return the value of a name, or a default for an unknown one."""
        return vars(self).get(name, default)

    def keys(self) -> KeysView[str]:
        """Return the names."""
        return vars(self).keys()

    def values(self) -> ValuesView[Any]:
        """Return the values, in the order of the names."""
        return vars(self).values()

    def items(self) -> ItemsView[str, Any]:
        """Return names with their values."""
        return vars(self).items()


class _Series(_Named, Held):
    """Read-only arrays with one row for each instant; they are displayed by their names and number of rows instead of all values."""

    def __repr__(self) -> str:
        first = next(iter(vars(self).values()))
        return f"<{type(self).__name__}: {len(first)} rows of {', '.join(vars(self))}>"


@dataclass(frozen=True)
class RunResult(_Named):
    """End of a run and its plateau; numbers are NaN where undefined.

    Attributes
    ----------
    status : str
        One of STATUSES.
    reaction : float
        Reaction on the plateau, extrapolated to zero settlement, N or N m; NaN without a plateau.
    uncertainty : float
        Half width of the interval of the reaction, the sum of its parts below, N or N m; NaN without a plateau.
    settlement : float
        Settlement that the support reached, m or rad.
    asked_settlement : float
        Imposed settlement, m or rad.
    plateau_start : float
        Settlement where the fitted plateau begins, m or rad.
    slope : float
        Slope of the line fitted to the plateau, N/m, or N m/rad.
    kinetic_ratio : float
        Largest kinetic energy on the plateau over the work of the weights there.
    steps : int
        Number of time steps of all attempts.
    seconds : float
        Wall time inside YADE, s.
    version : str
        Version of YADE.
    message : str
        Reason for the end of the run, as a phrase.
    uncertainty_scatter, uncertainty_fit, uncertainty_rate, uncertainty_stiffness : float
        Parts of the uncertainty, N or N m: noise of the record; choice between line and level of the plateau; speed of the
        support, NaN without a quicker attempt; strain of the joints, and settings. NaN in runs of version 0.2.0.
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
    uncertainty_scatter: float = NAN
    uncertainty_fit: float = NAN
    uncertainty_rate: float = NAN
    uncertainty_stiffness: float = NAN


@dataclass(frozen=True, eq=False, repr=False)
class RunSeries(_Series):
    """Series recorded over time, in T rows.

    Attributes
    ----------
    stage : np.ndarray
        0 during gravity, 1 during settlement (T,).
    time : np.ndarray
        Simulated time (T,), s.
    settlement : np.ndarray
        Settlement of the support (T,), m or rad.
    reaction : np.ndarray
        Reaction (T,), N or N m.
    support_wrench : np.ndarray
        Force and moment about the origin (T, 6) of the supports on the structure, N and N m.
    kinetic_energy : np.ndarray
        Kinetic energy of the free blocks (T,), J.
    unbalanced : np.ndarray
        Largest unbalanced force over the mean block weight (T,); before the settlement over 20 times the block's own weight if less.
    damped_energy : np.ndarray
        Energy that the damping of the blocks' swing has taken so far (T,), J; empty in runs of version 0.2.0.
    """

    stage: np.ndarray
    time: np.ndarray
    settlement: np.ndarray
    reaction: np.ndarray
    support_wrench: np.ndarray
    kinetic_energy: np.ndarray
    unbalanced: np.ndarray
    damped_energy: np.ndarray = field(default_factory=lambda: np.zeros(0))

    def __len__(self) -> int:
        return len(self.stage)


@dataclass(frozen=True, eq=False, repr=False)
class Poses(_Series):
    """The P stored states of B blocks and C contact points; the first state is at rest under gravity.

    Attributes
    ----------
    settlement : np.ndarray
        Settlement of the support (P,), m or rad.
    displacement : np.ndarray
        Displacements of the centroids (P, B, 3), m.
    rotation : np.ndarray
        Rotation vectors of the blocks (P, B, 3), rad.
    forces : np.ndarray
        Contact forces on block b of each contact point (P, C, 3), N.
    """

    settlement: np.ndarray
    displacement: np.ndarray
    rotation: np.ndarray
    forces: np.ndarray

    def __len__(self) -> int:
        return len(self.settlement)
