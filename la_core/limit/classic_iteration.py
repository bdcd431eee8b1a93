"""The classic iteration for Coulomb friction without dilatancy: a fictitious cohesion from the last normal forces.

At every iteration the friction limit of a contact point is |t| <= c0 + (1 + a) mu N - a mu n, with N its normal force so far:
at n = N it is Coulomb's limit plus c0, and its slope is nearly flat, so that a sliding joint hardly changes its opening.
N follows the solutions with relaxation b: N <- b n + (1 - b) N. The first programme is the associated one.
Gilbert, Casapulla & Ahmed, Computers & Structures 84 (2006) 873; in 3D Portioli, Casapulla, Gilbert & Cascini, ibid. (2014).
Nothing proves that it converges, nor that what it converges to is the only answer: it is here as the published reference method.
A falling limit, however flat, rewards a sliding joint for pressing less. Where friction history would decide between several
reactions of one mechanism, the iteration therefore tends to the end where sliding joints are pressed least.
"""

from dataclasses import dataclass, field

import numpy as np

from la_core.limit.associated import Status
from la_core.limit.problem import Drive
from la_core.limit.static import StaticSolution, coulomb_limits, solve_static
from la_core.measures import block_speeds, contact_speeds, residuals
from la_core.model import Assembly

LOADED = 1e-6  # of the mean block weight: a contact point with a larger normal force carries some
SLIDES = 1e-6  # of the fastest block's speed: a contact point with a larger sliding speed slides


@dataclass(frozen=True)
class ClassicParameters:
    """Parameters of the iteration.

    relaxation: b, the papers' 0.6 damps the swing of forces between redundant contact points. slope: a, the share of mu at which
    the limit falls with n; a larger one keeps N from running away and makes sliding joints close by a mu |u_t|. cohesion: c0 over
    the mean block weight; lets a contact without force take some again. iterations: most programmes solved. tolerance: over the
    mean block weight (the multiplier as it is), of the change of the value and of Coulomb's limit; c0 is part of its violation.
    """

    relaxation: float = 0.6
    slope: float = 0.01
    cohesion: float = 1e-5
    iterations: int = 100
    tolerance: float = 1e-4

    def __post_init__(self) -> None:
        if not (0.0 < self.relaxation <= 1.0 and self.slope >= 0.0 and self.iterations >= 1):
            raise ValueError(f"relaxation in (0, 1], slope from 0 and iterations from 1 are needed, not {self}")
        if not 0.0 <= self.cohesion < self.tolerance:
            raise ValueError(f"the cohesion {self.cohesion} must be below the tolerance {self.tolerance}, for it counts as violation")


@dataclass(frozen=True)
class ClassicSolution:
    """Where the iteration ended, with recomputed evidence. Undefined numbers are NaN.

    status: SOLVED when it converged, INACCURATE when it did not within the limit, INFEASIBLE when programme number `iterations`
    had no equilibrium, FAILED when it had no usable answer; then value, forces and twists are NaN.
    value: reaction in N (N m) or multiplier. forces (C, 3) in N. twists (B, 6): for the support's unit motion or unit live power.
    values, violations (programmes with a value,): the history of the value, and of the excess of |t| over mu n, or tension, over
    the mean block weight; the last ones are the answer's.
    dilation: sum of n max(u_n, 0) over loaded sliding points, over the power that the weights exchange, sum of |w . v|.
    penetration: largest speed at which blocks penetrate over the fastest block's. seconds: inside the solver, all programmes.
    """

    status: Status
    value: float
    forces: np.ndarray
    twists: np.ndarray
    iterations: int
    values: np.ndarray
    violations: np.ndarray
    equilibrium_residual: float
    dilation: float
    penetration: float
    seconds: float
    parameters: ClassicParameters = field(default_factory=ClassicParameters)


def solve_sequentially(assembly: Assembly, drive: Drive, parameters: ClassicParameters | None = None) -> ClassicSolution:
    """Run the classic iteration; never raises for a programme without solution, the status says so."""
    chosen = parameters or ClassicParameters()
    no_sliding, friction = coulomb_limits(assembly)
    cohesion = chosen.cohesion * assembly.mean_weight
    step = solve_static(assembly, drive, no_sliding, friction)
    values, violations, seconds, iterations, converged = [], [], step.seconds, 1, False
    normal = np.zeros(len(assembly.points))
    while _has_value(step):
        values.append(step.value)
        violations.append(residuals.cone_violation(assembly, step.forces))
        converged = _converged(assembly, drive, values, violations, chosen.tolerance)
        if converged or iterations == chosen.iterations:
            break
        share = chosen.relaxation if iterations > 1 else 1.0
        normal = share * assembly.split(step.forces)[0].clip(min=0.0) + (1.0 - share) * normal
        limit = cohesion + (1.0 + chosen.slope) * friction * normal
        step = solve_static(assembly, drive, np.maximum(no_sliding, limit), -chosen.slope * friction)
        seconds, iterations = seconds + step.seconds, iterations + 1
    status = step.status
    if _has_value(step):
        status = Status.SOLVED if converged and step.status is Status.SOLVED else Status.INACCURATE
    return ClassicSolution(
        status=status,
        value=step.value,
        forces=step.forces,
        twists=step.twists,
        iterations=iterations,
        values=np.array(values),
        violations=np.array(violations),
        equilibrium_residual=step.equilibrium_residual,
        dilation=dilation(assembly, step.twists, step.forces),
        penetration=residuals.penetration(assembly, step.twists) if _has_value(step) else float("nan"),
        seconds=seconds,
        parameters=chosen,
    )


def dilation(assembly: Assembly, twists: np.ndarray, forces: np.ndarray) -> float:
    """Power of normal forces on the opening of loaded points that slide, over sum |w . v|; zero without dilatancy, NaN if undefined."""
    parting, sliding = contact_speeds(assembly, twists)
    compression = assembly.split(forces)[0]
    fastest = block_speeds(assembly.blocks, twists).max()
    counted = (compression > LOADED * assembly.mean_weight) & (sliding > SLIDES * fastest)
    exchanged = float(np.abs(np.sum(assembly.dead_load * twists, axis=1)).sum())
    if not np.isfinite(exchanged):
        return float("nan")
    return float(np.sum(compression[counted] * parting[counted].clip(min=0.0)) / exchanged) if exchanged > 0.0 else 0.0


def _has_value(step: StaticSolution) -> bool:
    return step.status in (Status.SOLVED, Status.INACCURATE)


def _converged(assembly: Assembly, drive: Drive, values: list[float], violations: list[float], tolerance: float) -> bool:
    """Whether the last value stands still and its forces obey Coulomb; the first, associated, one is never the answer."""
    if len(values) < 2:
        return False
    unit = 1.0
    if drive is not Drive.LIVE:  # the speed of the support turns a moment into a force
        unit = assembly.mean_weight * assembly.support_speed
    return abs(values[-1] - values[-2]) <= tolerance * unit and violations[-1] <= tolerance
