"""Answer of Coulomb limit analysis."""

from dataclasses import dataclass, field, replace

import numpy as np

from la_core.geometry import Held
from la_core.limit import Solution, Status
from la_core.measures import mechanism
from la_core.model import Assembly

NAN = float("nan")
ONE_POINT = 1e-6  # of the value: an interval of at most this half-width is one point but for round-off


def _empty() -> np.ndarray:
    return np.zeros(0)


@dataclass(frozen=True, eq=False, repr=False)
class CoulombSolution(Held):
    """Answer of Coulomb limit analysis with its evidence. Undefined numbers are NaN.

    Attributes
    ----------
    status : Status
        SOLVED where a certified plateau has a stated uncertainty.
    value : float
        Reaction (N; N m for a rotation) or multiplier on the plateau.
    uncertainty : float
        Uncertainty of the value, in its unit, from paths of different viscosity, from the remaining change of the curve and from unbalanced
        forces. It reaches to the bound where the value lies beyond the bound. Infinite where the blocks fell on the way.
    plateaus : (K,) array
        Values of all plateaus, that of the answer first, where paths end on several or a curve leaves one; empty if there is only one.
    interval : tuple of float
        Least and greatest value that the mechanism allows over all histories of friction.
    twists : (B, 6) array
        Mechanism for the support's unit motion, or for unit power of the unit live load.
    forces : (C, 3) array
        Contact forces on block b on the plateau, N, global axes.
    at_rest : float
        Reaction before the support moves; 0 for a live load.
    drift : float
        Relative change of the mean value from the second quarter of the travel to its second half.
    dilatancy_residual : float
        Power of the normal forces at parting joints over the power put in by the sinking weights and by the support or
        the live load.
    strain_residual : float
        Power of the weights less dissipation less the power of the reaction, over the power put in: the joints' changing
        strain and the drag.
    sliding_residual : float
        Dissipation less the power of the friction forces against the slip, over the power put in.
    equilibrium_residual : float
        Largest unbalanced force on a free block over the mean free-block weight.
    cone_violation : float
        Largest tension or excess of |t| over mu n, over the mean free-block weight.
    seconds : float
        Time of the paths.
    iterations : int
        Newton iterations of all paths.
    steps : int
        Steps of all paths. 0 where no path was followed.
    travel : float
        Motion of the support, or displacement along the live load, at the end of the path, over the travel.
    viscosities : (V,) array
        First viscosity of each path, in multiples of the weight at unit rate.
    path_settlement, path_value : (P,) array
        Curve of the finest path: motion of the support (m or rad), or displacement along the live load (m), and value. Where rotations
        are finite and the stiffness of the joints is not given, the actual joints release as much at a quarter of this motion.
    released, released_uncertainty : float
        Value of a prediction with small rotations after turning blocks have released a thrust, and its uncertainty, in the unit of the
        value. NaN where it is unknown or was not computed.
    peak : (2,) array
        Greatest multiplier on the way to the plateau of a live load, without drag, and its uncertainty; empty where the curve does not rise
        above the plateau, or where the peak is unknown.
    released_state : tuple of two arrays (B, 6) and (C, 3), or None
        Mechanism and contact forces of that value, as `twists` and `forces`. None where there is no such value, or it comes from a file.
    """

    status: Status
    value: float
    interval: tuple[float, float]
    twists: np.ndarray
    forces: np.ndarray
    at_rest: float
    drift: float
    dilatancy_residual: float
    strain_residual: float
    equilibrium_residual: float
    cone_violation: float
    seconds: float
    iterations: int
    steps: int = 0
    uncertainty: float = NAN
    plateaus: np.ndarray = field(default_factory=_empty)
    sliding_residual: float = NAN
    travel: float = NAN
    viscosities: np.ndarray = field(default_factory=_empty)
    path_settlement: np.ndarray = field(default_factory=_empty)
    path_value: np.ndarray = field(default_factory=_empty)
    released: float = NAN
    released_uncertainty: float = NAN
    peak: np.ndarray = field(default_factory=_empty)
    released_state: tuple[np.ndarray, np.ndarray] | None = None

    @property
    def certificate(self) -> float:
        """Largest residual of the limit state on the plateau, NaN where one is undefined; without a path, the largest defined one."""
        of_state, of_mechanism = (self.equilibrium_residual, self.cone_violation), (self.dilatancy_residual, self.sliding_residual)
        largest = np.max if self.steps else np.fmax.reduce
        return float(largest([*of_state, *of_mechanism, self.strain_residual]))


def without_sliding(assembly: Assembly, associated: Solution, seconds: float, iterations: int) -> CoulombSolution:
    """Return the associated answer as Coulomb's where no joint slides: nothing dilates, and the interval is the value.

    Parameters
    ----------
    assembly : Assembly
        Structure.
    associated : Solution
        Its associated answer.
    seconds : float
        Time of the search for sliding.
    iterations : int
        Newton iterations of that search.

    Returns
    -------
    CoulombSolution
        The value at rest, the drift and the strain residual are NaN, because no path was followed. Interval and uncertainty contain
        the effect of the little sliding that the associated mechanism may still have. The uncertainty also contains the error of the
        associated value.
    """
    if associated.status is not Status.SOLVED:
        return without_answer(assembly, associated.status)
    slight = _by_dilatancy(assembly, associated)
    width = slight if slight > ONE_POINT * abs(associated.value) else 0.0
    return CoulombSolution(
        Status.SOLVED,
        associated.value,
        (associated.value - width, associated.value + width),
        associated.twists,
        associated.forces,
        at_rest=NAN,
        drift=NAN,
        dilatancy_residual=mechanism.sliding_share(assembly, associated.twists, associated.forces),
        strain_residual=NAN,
        equilibrium_residual=associated.equilibrium_residual,
        cone_violation=associated.cone_violation,
        seconds=seconds,
        iterations=iterations,
        uncertainty=associated.error + slight,
    )


def _by_dilatancy(assembly: Assembly, associated: Solution) -> float:
    """Power of friction in the associated mechanism, which is one for the support's unit motion or for unit power of the live load.

    The search for sliding leaves out joints that slide so little. Their dilatancy may still make a least reaction too small, or a
    multiplier too large, by this power.
    """
    return mechanism.friction_power(assembly, associated.twists, associated.forces)


def reaching_to(solution: CoulombSolution, bound: float, is_live: bool) -> CoulombSolution:
    """Return the prediction. If its value lies beyond the bound, where no equilibrium exists, its uncertainty reaches to the bound.

    A path may end beyond the bound where blocks with little of the mass fail first: its drag still holds them.
    """
    sign = 1.0 if is_live else -1.0
    uncertainty = max(solution.uncertainty, sign * (solution.value - bound))
    after_release = float(np.maximum(solution.released_uncertainty, sign * (solution.released - bound)))
    return replace(solution, uncertainty=uncertainty, released_uncertainty=after_release)


def without_answer(assembly: Assembly, status: Status, seconds: float = 0.0, iterations: int = 0) -> CoulombSolution:
    """Return a prediction without a value.

    Parameters
    ----------
    assembly : Assembly
        Structure.
    status : Status
        Reason.
    seconds, iterations : float, int
        Time and Newton iterations spent.
    """
    twists, forces = np.full((len(assembly.blocks), 6), NAN), np.full((len(assembly.points), 3), NAN)
    return CoulombSolution(status, NAN, (NAN, NAN), twists, forces, NAN, NAN, NAN, NAN, NAN, NAN, seconds, iterations)
