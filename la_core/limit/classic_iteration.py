"""The classic iteration for Coulomb friction without dilatancy: a fictitious cohesion from the last normal forces.

At every iteration the friction limit of a contact point is |t| <= c0 + (1 + a) mu N - a mu n, where N is its normal force
from earlier iterations. At n = N the limit is Coulomb's plus c0. It hardly depends on n, so that a sliding joint hardly opens.
N follows the solutions with relaxation b: N <- b n + (1 - b) N. The first programme is the associated one. Gilbert, Casapulla &
Ahmed, Computers & Structures 84 (2006) 873; in 3D Portioli, Casapulla, Gilbert & Cascini, ibid. (2014). Neither
convergence nor uniqueness of the answer is proven; the method is included as the published reference. Because
the limit falls with n, a sliding joint resists more at a smaller normal force. Where one mechanism allows several reactions, the
iteration therefore tends to the end of the interval at which sliding joints carry the smallest normal forces.
"""

import math
from dataclasses import dataclass

import numpy as np

from la_core.limit.associated import Status
from la_core.limit.problem import Drive
from la_core.limit.static import StaticSolution, coulomb_limits, solve_static
from la_core.measures import contact_speeds, fastest_speed, residuals
from la_core.model import Assembly

LOADED = 1e-6  # of the mean block weight: a contact point with a larger normal force is loaded
SLIDES = 1e-6  # of the fastest block's speed: a contact point with a larger sliding speed slides


@dataclass(frozen=True)
class ClassicParameters:
    """Parameters of the iteration.

    Attributes
    ----------
    relaxation : float
        b, in (0, 1]; the papers' 0.6 damps the swing of forces between redundant contact points.
    slope : float
        a, at least 0: the limit falls with n by a mu. A larger slope keeps N bounded and makes sliding joints close
        by a mu |u_t|.
    cohesion : float
        c0 over the mean block weight, below the tolerance; with it an unloaded contact point can take up force again.
    iterations : int
        Largest number of programmes.
    tolerance : float
        Largest change of the value and largest violation of Coulomb's limit in the answer, over the mean block weight
        (a multiplier: as it is). The violation includes c0.

    Raises
    ------
    ValueError
        A parameter outside of its range.
    """

    relaxation: float = 0.6
    slope: float = 0.01
    cohesion: float = 1e-5
    iterations: int = 100
    tolerance: float = 1e-4

    def __post_init__(self) -> None:
        is_count = isinstance(self.iterations, int) and self.iterations >= 1
        if not (0.0 < self.relaxation <= 1.0 and 0.0 <= self.slope < math.inf and is_count):
            raise ValueError(f"relaxation must be in (0, 1], slope at least 0 and iterations a whole number from 1 on, not {self}")
        if not 0.0 <= self.cohesion < self.tolerance < math.inf:
            raise ValueError(f"cohesion must be from 0 to below the tolerance {self.tolerance}, and both finite, not {self.cohesion}")


@dataclass(frozen=True)
class ClassicSolution:
    """Last state of the iteration with recomputed evidence. Undefined numbers are NaN.

    Attributes
    ----------
    status : Status
        SOLVED: converged. INACCURATE: not converged within the limit of iterations, or the last programme's residuals are
        too large. INFEASIBLE: programme number `iterations` had no equilibrium. UNBOUNDED: nothing limited its value.
        FAILED: it had no usable answer. The last three have no value, forces or twists.
    value : float
        Reaction (N; N m for a rotation) or multiplier.
    forces : (C, 3) array
        Contact forces on block b, N, global axes.
    twists : (B, 6) array
        Mechanism for the support's unit motion, or for unit power of the unit live load.
    iterations : int
        Programmes solved.
    values : (k,) array
        Value of each of the k programmes that have one, in order; the last is the answer.
    violations : (k,) array
        Largest tension or excess of |t| over mu n of each programme, over the mean block weight.
    equilibrium_residual : float
        Largest unbalanced force on a free block over the mean block weight.
    dilation : float
        Sum of n max(u_n, 0) over loaded sliding points, over the power that the weights exchange, sum of |w . v|.
    penetration : float
        Largest speed at which blocks penetrate each other over the speed of the fastest block.
    seconds : float
        Time in the solver, all programmes.
    parameters : ClassicParameters
        Parameters of the iteration.
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
    parameters: ClassicParameters


def solve_sequentially(assembly: Assembly, drive: Drive, parameters: ClassicParameters | None = None) -> ClassicSolution:
    """Run the classic iteration from the associated answer; the status reports a programme without solution."""
    chosen = parameters or ClassicParameters()
    no_sliding, friction = coulomb_limits(assembly)
    cohesion = chosen.cohesion * assembly.mean_weight
    step = solve_static(assembly, drive, no_sliding, friction)
    values, violations, seconds, iterations, converged = [], [], step.seconds, 1, False
    normal = np.zeros(len(assembly.points))
    while _has_value(step):
        values.append(step.value)
        violations.append(residuals.cone_violation(assembly, step.forces))
        converged = _converged(assembly, values, violations, chosen.tolerance)
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
    """Power of normal forces on the opening of loaded sliding points, over sum |w . v|.

    It is 0 without dilatancy and NaN where undefined. twists (B, 6) and forces (C, 3) in N: a mechanism and its
    contact forces.
    """
    parting, sliding = contact_speeds(assembly, twists)
    compression = assembly.split(forces)[0]
    fastest = fastest_speed(assembly, twists)
    counted = (compression > LOADED * assembly.mean_weight) & (sliding > SLIDES * fastest)
    exchanged = float(np.abs(np.sum(assembly.dead_load * twists, axis=1)).sum())
    if not np.isfinite(exchanged):
        return float("nan")
    return float(np.sum(compression[counted] * parting[counted].clip(min=0.0)) / exchanged) if exchanged > 0.0 else 0.0


def _has_value(step: StaticSolution) -> bool:
    return step.status in (Status.SOLVED, Status.INACCURATE)


def _converged(assembly: Assembly, values: list[float], violations: list[float], tolerance: float) -> bool:
    """Whether the last value is steady and its forces obey Coulomb's limit; False for the first value, the associated one."""
    if len(values) < 2:
        return False
    change = tolerance * assembly.in_value_unit(assembly.mean_weight)
    return abs(values[-1] - values[-2]) <= change and violations[-1] <= tolerance
