"""Energy balance of a YADE run from its stored states: the work put in against kinetic, elastic, frictional and viscous energy.

Let F be the mean contact force of two successive stored states, and du the relative displacement of the contact points. Then the contact
takes the energy -F . du out of the motion. The work of the weights and of the support is computed in the same way. YADE's own energy
counters are not used. The drift is the unaccounted part of the work.
"""

import dataclasses
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from comparison.numbers import percent
from comparison.verdict import Check, Verdict, finite_or_none
from comparison.yade import Run
from la_core.exchange import GRAVITY
from la_core.model import Assembly

IN_DOUBT = ", so its time integration is in doubt."
SPARSE = ": between two stored states the forces change so much that this balance is known to ±{} only."
FALLS = ": blocks fall or jump, and between two stored states their contact forces change too much for this balance."
LOOK_FOR_FALL = "See which blocks fall (`crosscheck animate`), and hold them or leave them out."
SHORTER_STEP = "Run YADE with a shorter time step: half of the [yade] time_step_share that the report lists."
MORE_STATES = "Store more states: set [yade] poses to the record_rows that the report lists."
MORE_ROWS = "Record and store more states: set [yade] record_rows and poses to ten times the record_rows that the report lists."
LEAST_TURNOVER = 0.01  # of the weight times the settlement: with a smaller turnover the blocks stand, and the balance is noise
DRIFT = 0.05  # of the turnover: forces between two stored states are approximated by their mean
COVERAGE = 1.96  # standard deviations of a sum of random errors that cover the sum 19 times in 20


@dataclass(frozen=True)
class EnergyAudit:
    """Energies from the first state of the balance, see `audit`, to the last stored state; all NaN without a balance.

    Attributes
    ----------
    weights, support, load : float
        Work of the weights, of the support and of the live load on the free blocks, J; support or load is 0, as only one of them acts.
    kinetic, elastic : float
        Change of the stored kinetic and elastic energy, J.
    friction, viscous : float
        Energy taken by friction along the joints; energy taken by damping across the joints and of the blocks' swing, J.
    turnover : float
        Sum over the blocks of the absolute work of weight and live load, plus the absolute work of the support, J.
    """

    weights: float
    support: float
    load: float
    kinetic: float
    elastic: float
    friction: float
    viscous: float
    turnover: float

    @property
    def unaccounted(self) -> float:
        """Unaccounted work, J."""
        return self.weights + self.support + self.load - self.kinetic - self.elastic - self.friction - self.viscous

    @property
    def drift(self) -> float:
        """Unaccounted work over the turnover; NaN if nothing moved."""
        return self.unaccounted / self.turnover if self.turnover > 0.0 else float("nan")


def audit(assembly: Assembly, run: Run) -> EnergyAudit:
    """Return the energy balance of a run; all NaN with fewer than two stored states, or without a recorded row at rest.

    assembly: the assembly of the run. The balance starts at rest, or at the first state of the plateau if only the states of the plateau
    were stored.
    """
    kept = _kept(assembly)
    if len(run.poses.settlement[kept]) < 2 or not run.record or GRAVITY not in run.record.stage:
        return EnergyAudit(*[float("nan")] * 8)
    return _balance(assembly, run, kept)


def _kept(assembly: Assembly) -> slice:
    return slice(1 if assembly.effects.recording == "plateau" else 0, None)


def _balance(assembly: Assembly, run: Run, kept: slice) -> EnergyAudit:
    """Return the balance between the first and the last of the kept states, at least two."""
    settlement = run.poses.settlement[kept]
    poses = np.concatenate([run.poses.displacement[kept], run.poses.rotation[kept]], axis=2)
    steps, forces = np.diff(poses, axis=0), run.poses.forces[kept]
    by_weights = np.einsum("bi,pbi->b", assembly.dead_load, steps)
    by_load, support = np.zeros_like(by_weights), 0.0
    if assembly.has_live_load:
        multipliers = np.interp(settlement, *_series(run, "reaction"))
        by_load = np.einsum("p,bi,pbi->b", 0.5 * (multipliers[1:] + multipliers[:-1]), assembly.live_load, steps)
    else:
        support = _support_work(run, settlement)
    dissipated, stored = _dissipated(assembly, forces, poses), _stored(assembly, forces[[0, -1]], run.settings)
    damped = float(np.diff(np.interp(settlement[[0, -1]], *_series(run, "damped_energy")))[0]) if len(run.record.damped_energy) else 0.0
    return EnergyAudit(
        weights=float(by_weights.sum()),
        support=support,
        load=float(by_load.sum()),
        kinetic=float(np.diff(np.interp(settlement[[0, -1]], *_series(run, "kinetic_energy")))[0]),
        elastic=float(stored.sum()),
        friction=float(dissipated[1] - stored[1]),
        viscous=float(dissipated[0] - stored[0]) + damped,
        turnover=float(np.abs(by_weights + by_load).sum()) + abs(support),
    )


def check_energy(assembly: Assembly, run: Run) -> Iterator[Check]:
    """Yield the check that the run's energies add up; no check if no motion was recorded."""
    found = audit(assembly, run)
    if finite_or_none(found.drift) is not None:
        least = LEAST_TURNOVER * assembly.weight * assembly.support_speed * abs(float(run.poses.settlement[-1] - run.poses.settlement[0]))
        drift = found.drift * found.turnover / max(found.turnover, least)
        share = f"{percent(abs(drift), 3)} of the energy turned over in YADE's run is not accounted for ({percent(DRIFT)} accepted)"
        verdict, message, step = Verdict.AGREE, "", ""
        if abs(drift) > DRIFT:
            falls = found.kinetic > DRIFT * max(found.turnover, least)
            scatter = _scatter(assembly, run) / max(found.turnover, least)
            cause, step = (FALLS, LOOK_FOR_FALL) if falls else _cause(drift, scatter, len(run.poses.settlement) < len(run.record))
            if step == MORE_STATES and run.settings.get("poses", 0.0) >= run.settings.get("record_rows", math.inf):
                step = MORE_ROWS  # the run already stored as many states as rows
            verdict, message = Verdict.INCONCLUSIVE, share + cause
        yield Check("energy of the YADE run", verdict, 0.0, drift, drift, DRIFT, "of the turnover", message, step)


def _cause(drift: float, scatter: float, stores_less: bool) -> tuple[str, str]:
    """Return the reason why the energies do not add up, and the next step.

    With too long a time step energy is lost or gained throughout the run. With blocks that stick and slip, the stored states have too much
    force or too little by chance, so the errors are random.

    drift, scatter: shares of the turnover. stores_less: whether YADE stored fewer states than it recorded rows.
    """
    uncertainty = COVERAGE * scatter
    is_sparse = stores_less and abs(drift) <= uncertainty
    return (SPARSE.format(percent(uncertainty, 3)), MORE_STATES) if is_sparse else (IN_DOUBT, SHORTER_STEP)


def _scatter(assembly: Assembly, run: Run) -> float:
    """Return the standard deviation of the unaccounted work, J, from its scatter over the pairs of successive stored states.

    The error of a state counts half in each of its two pairs. So errors of neighbouring pairs are correlated, and the variance of the sum
    is twice that of independent pairs.
    """
    first, states = _kept(assembly).start, len(run.poses.settlement)
    between = [_balance(assembly, run, slice(k, k + 2)).unaccounted for k in range(first, states - 1)]
    return float(np.std(between, ddof=1) * np.sqrt(2.0 * len(between))) if len(between) > 1 else 0.0


def energy_summary(assembly: Assembly, run: Run) -> dict[str, float]:
    """Return every energy by name, J, and the drift as a share of the turnover."""
    energies = audit(assembly, run)
    return dataclasses.asdict(energies) | {"drift": energies.drift}


def _series(run: Run, name: str) -> tuple[np.ndarray, np.ndarray]:
    """Return the settlement and one recorded series, starting with the last row at rest, in the order of the settlement.

    Under a live load a structure may sway back a little on its way, and the displacement of the rows does not rise all the way.
    """
    first = int(np.flatnonzero(run.record.stage == GRAVITY)[-1])
    settlement = run.record.settlement[first:].copy()
    settlement[0] = min(settlement[0], run.poses.settlement[0])
    order = np.argsort(settlement, kind="stable")
    return settlement[order], getattr(run.record, name)[first:][order]


def _support_work(run: Run, stored: np.ndarray) -> float:
    """Return the work of the support on the structure between the first and last stored settlement, J; negative while it yields."""
    settlement, reaction = _series(run, "reaction")
    start, end = stored[[0, -1]]
    stations = np.concatenate([[start], settlement[(settlement > start) & (settlement < end)], [end]])
    force = np.interp(stations, settlement, reaction)
    return -0.5 * float(np.diff(stations) @ (force[:-1] + force[1:]))  # numpy.trapezoid needs NumPy 2


def _dissipated(assembly: Assembly, forces: np.ndarray, poses: np.ndarray) -> np.ndarray:
    """Return the energy (2,) that the contacts took out of the motion across and along the joints, J."""
    moved = np.diff(_apart(assembly, poses), axis=0)
    normal, tangential = assembly.split(0.5 * (forces[1:] + forces[:-1]))
    closing, sliding = assembly.split(moved)
    return -np.array([np.sum(normal * closing), np.sum(tangential * sliding)])


def _apart(assembly: Assembly, poses: np.ndarray) -> np.ndarray:
    """Return the displacement (P, C, 3) of block b relative to block a at each contact point, m, for poses (P, B, 6).

    The displacement includes the second order of the rotations. The first order alone, with levers that do not turn, misses work of the
    size of weight times height times the square of the rotation. For a block 200 times as high as wide this was 12 % of the turnover.
    """
    displacement = np.zeros((len(poses), *assembly.points.position.shape))
    for block, sign in zip(assembly.contact_blocks, (-1.0, 1.0), strict=True):
        rotation = poses[:, block, 3:]
        first = np.cross(rotation, assembly.points.position - assembly.blocks.centroid[block])
        displacement += sign * (poses[:, block, :3] + first + 0.5 * np.cross(rotation, first))
    return displacement


def _stored(assembly: Assembly, ends: np.ndarray, settings: Mapping[str, float]) -> np.ndarray:
    """Return the change (2,) of the joints' elastic energy between two states of force (2, C, 3), J: across and along the joints."""
    normal, tangential = assembly.split(ends)
    squares = np.array([np.sum(normal**2, axis=1), np.sum(tangential**2, axis=(1, 2))])
    stiffness = np.array([settings["normal_stiffness"], settings["shear_stiffness"]])
    halves = np.divide(0.5, stiffness, out=np.zeros(2), where=stiffness > 0.0)
    return np.diff(squares, axis=1)[:, 0] * halves
