"""Where the energy of a run in YADE went, from its stored states: work put in against kinetic, elastic, frictional and viscous parts.

Between two stored states a contact force F, the mean of both states', acts on points that move by du relative to each other and takes
-F . du out of the motion; weights and the support put work in likewise. Nothing of YADE's own bookkeeping is used: what does not add
up is drift.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from comparison.judge.check import Check, Verdict, finite_or_none
from comparison.yade import Run
from la_core.model import Assembly

GRAVITY = 0
DRIFT = 0.05  # of the turnover: forces between two stored states are taken as the mean of both


@dataclass(frozen=True)
class EnergyAudit:
    """Energies of the settlement stage, from rest under gravity to the last stored state, J; all NaN where no state was stored.

    weights, support: work done on the free blocks. kinetic, elastic: change of what is stored. friction: taken along the joints;
    viscous: taken across them. turnover: work without regard to sign, block by block.
    """

    weights: float
    support: float
    kinetic: float
    elastic: float
    friction: float
    viscous: float
    turnover: float

    @property
    def drift(self) -> float:
        """Work put in less all it went to, over the turnover; NaN where nothing moved."""
        left = self.weights + self.support - self.kinetic - self.elastic - self.friction - self.viscous
        return left / self.turnover if self.turnover > 0.0 else float("nan")


def audit(assembly: Assembly, run: Run) -> EnergyAudit:
    """Audit of a run on the assembly that it was made from, from rest, or from the plateau's first state where no others were kept.

    NaN where nothing was recorded at rest.
    """
    first = 1 if assembly.effects.recording == "plateau" else 0
    settlement = run.poses.settlement[first:]
    if len(settlement) < 2 or not run.record or GRAVITY not in run.record.stage:
        return EnergyAudit(*[float("nan")] * 7)
    poses = np.concatenate([run.poses.displacement, run.poses.rotation], axis=2)[first:]
    steps, forces = np.diff(poses, axis=0), run.poses.forces[first:]
    by_block = np.einsum("bi,pbi->b", assembly.dead_load, steps)
    support = _support_work(run, settlement)
    taken, stored = _taken(assembly, forces, steps), _stored(assembly, forces[[0, -1]], run.settings)
    return EnergyAudit(
        weights=float(by_block.sum()),
        support=support,
        kinetic=float(np.diff(np.interp(settlement[[0, -1]], *_series(run, "kinetic_energy")))[0]),
        elastic=float(stored.sum()),
        friction=float(taken[1] - stored[1]),
        viscous=float(taken[0] - stored[0]),
        turnover=float(np.abs(by_block).sum()) + abs(support),
    )


def check_energy(assembly: Assembly, run: Run) -> Iterator[Check]:
    """Whether the run's energies add up; nothing where no motion was recorded."""
    found = audit(assembly, run)
    if finite_or_none(found.drift) is not None:
        reason = f"{abs(found.drift):.1%} of the energy that YADE's run turned over is not accounted for: its integration is in doubt."
        adds_up = abs(found.drift) <= DRIFT
        verdict, words = (Verdict.AGREE, "") if adds_up else (Verdict.INCONCLUSIVE, reason)
        yield Check("energy of the YADE run", verdict, 0.0, found.drift, found.drift, DRIFT, "of the turnover", words)


def energy_summary(assembly: Assembly, run: Run) -> dict[str, float]:
    """Every energy by name, J, and the drift."""
    found = audit(assembly, run)
    return dataclasses.asdict(found) | {"drift": found.drift}


def _series(run: Run, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Settlement and one recorded series, from the last row at rest on."""
    first = int(np.flatnonzero(run.record.stage == GRAVITY)[-1])
    settlement = run.record.settlement[first:].copy()
    settlement[0] = min(settlement[0], run.poses.settlement[0])
    return settlement, getattr(run.record, name)[first:]


def _support_work(run: Run, stored: np.ndarray) -> float:
    """Work of the support on the structure between the first and the last stored settlement, J: it yields, so work goes out."""
    settlement, reaction = _series(run, "reaction")
    start, end = stored[[0, -1]]
    stations = np.concatenate([[start], settlement[(settlement > start) & (settlement < end)], [end]])
    return -float(np.trapezoid(np.interp(stations, settlement, reaction), stations))


def _taken(assembly: Assembly, forces: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """Energy (2,) that contacts took out of the motion, J: across the joints, and along them."""
    moved = np.array([assembly.relative_velocity(step) for step in steps])
    normal, tangential = assembly.split(0.5 * (forces[1:] + forces[:-1]))
    closing, sliding = assembly.split(moved)
    return -np.array([np.sum(normal * closing), np.sum(tangential * sliding)])


def _stored(assembly: Assembly, ends: np.ndarray, settings: Mapping[str, float]) -> np.ndarray:
    """Change (2,) of the joints' elastic energy between two states of force (2, C, 3), J: across and along them."""
    normal, tangential = assembly.split(ends)
    squares = np.array([np.sum(normal**2, axis=1), np.sum(tangential**2, axis=(1, 2))])
    stiffness = np.array([settings["normal_stiffness"], settings["shear_stiffness"]])
    halves = np.divide(0.5, stiffness, out=np.zeros(2), where=stiffness > 0.0)
    return np.diff(squares, axis=1)[:, 0] * halves
