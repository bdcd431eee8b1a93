"""Fit the plateau of a noisy, drifting record: a straight line through its later part, extrapolated to zero settlement.

The reaction of a mechanism changes with the geometry, so a plateau has a slope. Limit analysis predicts the reaction of the undeformed
geometry, which is the intercept of the line. A slope that is too steep for a change of geometry shows that the joints still strain. Such a
curve has not reached its plateau, and the intercept of its line would be wrong.

References
----------
K. P. White, An effective truncation heuristic for bias reduction in simulation output, Simulation 69 (1997) 323-334.
C. J. Geyer, Practical Markov chain Monte Carlo, Statistical Science 7 (1992) 473-483.
"""

import itertools
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from la_core.exchange import LATEST_START, UNCERTAIN
from yade_scripts.case import Case
from yade_scripts.driving import pushed_of

STARTS = np.linspace(0.2, LATEST_START, 9)  # shares of the settlement that may be dropped
FEWEST_ROWS = 20
COVERAGE = 1.96  # standard deviations of a normal variable that cover the true value 19 times in 20
_OSCILLATION = -0.5  # autocorrelation below which a record oscillates: noise with memory stays above, a sine of several periods goes below
# The true value lies between the line's intercept and the mean level of its rows. Two bounds at a distance w give a standard
# deviation of w / sqrt(12) (rectangular distribution).
_RECTANGULAR = 1.0 / np.sqrt(12.0)
EARLY = UNCERTAIN  # of the reaction: largest uncertainty of a plateau that the reaction leaves
LEFT = 3.0  # times the uncertainty of the best plateau so far: a fit that is less certain shows that the reaction has left that plateau
# Largest change of a block's velocity over a plateau, over the velocity of the support; share of the free blocks whose velocity may change
# by more, because a few of a thousand blocks always do so. The second pair is for a run that may end with a less certain plateau: for the
# judge a block with less than 5 % of the velocity stands still, and 5 % of the mass may move in one method only.
STEADY, STEADY_ENOUGH = (0.02, 0.01), (0.05, 0.05)
_CERTAIN = 3.0  # standard errors of the slope: a smaller excess over the geometric slope may be noise


class Pose(NamedTuple):
    """State of the structure: settlement, m or rad; displacements (B, 3), m; rotations (B, 3), rad; contact forces (C, 3), N."""

    settlement: float
    displacement: np.ndarray
    rotation: np.ndarray
    forces: np.ndarray


@dataclass(frozen=True)
class Plateau:
    """Line a + b s fitted to reaction against settlement s; every value is NaN where no fit is possible.

    Attributes
    ----------
    reaction : float
        Intercept a, N or N m.
    uncertainty : float
        Half width of the interval that contains a 19 times in 20, N or N m.
    slope : float
        Slope b, N/m, or N m/rad.
    start : float
        Settlement where the fitted part begins, m or rad.
    drift : float
        Change of the line over the fitted part without the change that turning blocks explain, N or N m, at least 0.
    from_scatter, from_fit, from_strain : float
        Parts of the uncertainty, N or N m: noise of the record; choice of line or level; joints that may still strain.
    creeps : bool
        Whether the line is steeper than a change of geometry can make it: the curve has not reached its plateau.
    """

    reaction: float
    uncertainty: float
    slope: float
    start: float
    drift: float
    from_scatter: float
    from_fit: float
    from_strain: float
    creeps: bool


_NAN = float("nan")
NONE = Plateau(_NAN, _NAN, _NAN, _NAN, _NAN, _NAN, _NAN, _NAN, creeps=False)


@dataclass(frozen=True)
class Geometry:
    """The effect that the changing geometry of the structure can have on its reaction.

    Attributes
    ----------
    turning : float
        Largest slope that turning blocks can give, N/m or N m/rad.
    lever : float
        Settlement over which lever arms change by their own length, m or rad: sliding blocks shift the points where they
        touch. inf where nothing slides.
    slope : float
        Slope that turning blocks give where no joint slides, N/m or N m/rad.
    """

    turning: float
    lever: float
    slope: float = 0.0


@dataclass(frozen=True)
class Outcome:
    """Reaction of a plateau, and the parts of its uncertainty, N or N m; NaN where undefined.

    Attributes
    ----------
    reaction : float
        Line through the plateau at zero settlement.
    scatter : float
        Noise of the record.
    fit : float
        Choice between line and level.
    stiffness : float
        Strain of the joints, and settings.
    rate : float
        Speed of the support.
    """

    reaction: float
    scatter: float
    fit: float
    stiffness: float
    rate: float = float("nan")

    @property
    def uncertainty(self) -> float:
        """Sum of all known parts: noise apart, they are limits of systematic errors, which may all act in one direction."""
        return self.scatter + self.fit + self.stiffness + (0.0 if math.isnan(self.rate) else self.rate)


NO_OUTCOME = Outcome(*[float("nan")] * 4)


@dataclass(frozen=True)
class Earlier:
    """The best plateau so far.

    Friction may lock a thrust in. Turning blocks release it later in the run, the softer the joints, the later. The run then leaves the
    plateau that has the reaction of the undeformed geometry.

    Attributes
    ----------
    fit : Plateau
        The plateau.
    mark : tuple of int
        Numbers of rows and of states in the record at the time of the fit.
    asked : float
        Settlement imposed up to the fit, m or rad.
    """

    fit: Plateau
    mark: tuple[int, int]
    asked: float

    def is_left(self, now: Plateau, enough: float) -> bool:
        """Whether a later fit is so uncertain that the reaction has left this plateau. enough: uncertainty that always counts as small."""
        return not now.uncertainty <= max(LEFT * self.fit.uncertainty, enough)


def geometry_of(case: Case, before: Pose, now: Pose) -> Geometry:
    """Return the effect of the geometry on the reaction, or on the multiplier of a live load, as the structure moves between two states."""
    slope, turning = turning_slopes(case, before, now)
    if case.live is None:
        return Geometry(turning, case.block_size / case.support_speed, slope)
    pushed = float(pushed_of(case).sum())  # a live load does work on the blocks, but the blocks do work on a support: the sign changes
    return Geometry(turning / pushed, case.block_size / largest_speed(before, now), -slope / pushed)


def turning_slopes(case: Case, first: Pose, last: Pose) -> tuple[float, float]:
    """Return the slope of the reaction over the settlement due to turning blocks if no joint slides, and its bound if joints slide.

    Both are in N/m (N m/rad for a rotation). Turning blocks move on arcs. If no joint slides, the slope is the sum over the contact points
    of force times the second derivative of the contact's motion, as seen from the face on which the contact lies. Sliding joints give these
    terms other weights, so the bound is the sum of their absolute values. Both are 0 where the two states have the same settlement.
    """
    travelled = last.settlement - first.settlement
    if travelled <= 0.0:
        return 0.0, 0.0
    velocity, spin = (last.displacement - first.displacement) / travelled, (last.rotation - first.rotation) / travelled
    host, target = case.host, case.target
    arm_host, arm_target = case.position - case.centroid[host], case.position - case.centroid[target]
    spin_host, spin_target = spin[host], spin[target]
    slip = velocity[host] + np.cross(spin_host, arm_host) - velocity[target] - np.cross(spin_target, arm_target)
    on_arcs = np.cross(spin_host, np.cross(spin_host, arm_host)) - np.cross(spin_target, np.cross(spin_target, arm_target))
    turned = on_arcs - 2.0 * np.cross(spin_target, slip)
    on_host = np.where(host == case.block_b, 1.0, -1.0)[:, None] * 0.5 * (first.forces + last.forces)
    parts = np.einsum("ci,ci->c", on_host, turned)
    return float(parts.sum()), float(np.abs(parts).sum())


def largest_speed(first: Pose, last: Pose) -> float:
    """Return the largest displacement of a block between two states, over the change of the settlement; at least 1."""
    travelled = last.settlement - first.settlement
    return max(1.0, float(np.linalg.norm(last.displacement - first.displacement, axis=1).max()) / travelled) if travelled > 0.0 else 1.0


def is_steady(poses: tuple[Pose, Pose, Pose], free: np.ndarray, fastest: float, shares: tuple[float, float] = STEADY) -> bool:
    """Whether the free blocks, apart from a few of many, keep their velocity from the first state over the second to the last.

    free: indices (F,) of the free blocks. fastest: largest velocity over that of the settlement. shares: allowed change of a block's
    velocity as a share of `fastest`, and share of the blocks whose velocity may change by more.
    """
    before, after = (
        (now.displacement - then.displacement)[free] / (now.settlement - then.settlement) for then, now in itertools.pairwise(poses)
    )
    changed = np.linalg.norm(after - before, axis=1) > shares[0] * fastest
    return int(changed.sum()) <= shares[1] * len(free)


def fit(settlement: np.ndarray, reaction: np.ndarray, geometry: Geometry) -> Plateau:
    """Return the line through the later part of reaction (T,) against settlement (T,), which begins at 0; NONE below 20 rows.

    The fit uses the start among STARTS with the smallest uncertainty: an early start keeps a transient, a late one drops rows. This is
    the marginal standard error rule of White (1997), with a line in place of the mean.
    """
    if len(settlement) == 0 or not np.all(np.isfinite(reaction)):
        return NONE
    fits = [_fit_from(settlement, reaction, share * settlement[-1], geometry) for share in STARTS]
    return min((line for line in fits if np.isfinite(line.uncertainty)), key=lambda line: line.uncertainty, default=NONE)


def shortcoming(fit: Plateau, scale: float, most: float, name: str = "reaction") -> str:
    """Return the reason why a line is no plateau, as a clause.

    scale: reaction by which uncertainty and drift are divided; most: largest uncertainty of a plateau; name: name of the fitted quantity.
    """
    if not math.isfinite(fit.reaction):
        return "the record is too short for a line, or undefined"
    if fit.creeps:
        return f"the {name} still creeps"
    if fit.uncertainty > max(most * scale, abs(fit.reaction)):  # as a share of a reaction near 0 it would be in the thousands
        return f"the {name} is uncertain by more than itself"
    if fit.uncertainty > most * scale:
        return f"the {name} is known only to {fit.uncertainty / scale:.2g} of itself"
    return f"the {name} still changes by {fit.drift / scale:.2g} of itself over the line"


def _fit_from(settlement: np.ndarray, reaction: np.ndarray, start: float, geometry: Geometry) -> Plateau:
    """Return the line through the rows (T,) from the settlement `start` on; NONE where they are too few."""
    kept = settlement >= start
    s, r = settlement[kept], reaction[kept]
    if len(s) < FEWEST_ROWS or np.ptp(s) <= 0.0:
        return NONE
    centre, level = float(s.mean()), float(r.mean())
    spread = float(np.sum((s - centre) ** 2))
    slope = float(np.sum((s - centre) * (r - level)) / spread)
    intercept = level - slope * centre
    residuals = r - intercept - slope * s
    rows = max(len(s) / correlation_length(residuals), 3.0)  # number of independent rows with the same information
    scatter = float(np.sqrt(np.mean(residuals**2) * rows / (rows - 2.0)))
    error = float(scatter * np.sqrt(len(s) / (spread * rows)))  # of the slope
    from_scatter = float(student(rows - 2.0) * scatter * np.sqrt((1.0 + centre**2 * len(s) / spread) / rows))
    # A slope that turning blocks explain adds no uncertainty: the line leads to the undeformed geometry. Sliding joints may give another.
    unexplained = min(abs(slope), abs(slope - geometry.slope))
    from_fit = COVERAGE * _RECTANGULAR * unexplained * centre
    # Strain that falls as 1/s gives the curve R + c/s. Its tangent at the centre has the slope -c/s^2 and the intercept R + 2 c/s. So the
    # intercept differs from R by twice the slope times the settlement of the centre, without the slope that turning blocks may explain.
    from_strain = 2.0 * max(0.0, abs(slope) - geometry.turning) * centre
    creeps = abs(slope) - _CERTAIN * error > geometry.turning + abs(level) / geometry.lever
    uncertainty = float(np.sqrt(from_scatter**2 + from_fit**2 + from_strain**2))
    drift = unexplained * float(np.ptp(s))
    return Plateau(intercept, uncertainty, slope, float(s[0]), drift, from_scatter, from_fit, from_strain, creeps)


def student(freedoms: float) -> float:
    """Return Student's factor, which replaces COVERAGE if the scatter is estimated with this number of degrees of freedom.

    The formula has the first terms of the expansion in 1/freedoms (Abramowitz & Stegun 26.7.5).
    """
    z = COVERAGE
    return z + (z**3 + z) / (4.0 * freedoms) + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * freedoms**2)


def correlation_length(residuals: np.ndarray) -> float:
    """Return the number of rows per independent row, at least 1: the larger of two estimates of 1 + 2 sum of autocorrelations.

    The first estimate sums over pairs of lags while these sums are positive (Geyer 1992), which is right for any shape. The second assumes
    a first-order process with the autocorrelation of lag 1, corrected for the bias -(2 + 4 rho)/n of a fitted line. It includes long
    memory, which the line hides from the first. The second is not used for an oscillation, which has a strong negative autocorrelation.
    """
    rows, power = len(residuals), float(np.sum(residuals**2))
    if power == 0.0:
        return 1.0
    size = 2 ** int(np.ceil(np.log2(2 * rows)))
    spectrum = np.abs(np.fft.rfft(residuals, size)) ** 2
    correlation = np.fft.irfft(spectrum, size)[:rows] / power
    pairs = correlation[: rows // 2 * 2].reshape(-1, 2).sum(axis=1)
    negative = np.flatnonzero(pairs <= 0.0)
    summed = pairs[: negative[0]] if len(negative) else pairs
    summed_length = max(1.0, float(2.0 * summed.sum() - 1.0))
    if correlation.min() < _OSCILLATION:
        return summed_length
    first = min(correlation[1] + (2.0 + 4.0 * correlation[1]) / rows, 1.0 - 1.0 / rows)
    return max(summed_length, float((1.0 + first) / (1.0 - first)))
