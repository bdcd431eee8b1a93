"""Fit the plateau of a noisy, drifting record: a straight line through its later part, extrapolated to zero settlement.

The reaction of a mechanism changes with the geometry, so a plateau has a slope. Limit analysis predicts the reaction of the undeformed
geometry, the line's intercept. This module needs numpy only.

References
----------
K. P. White, An effective truncation heuristic for bias reduction in simulation output, Simulation 69 (1997) 323-334.
C. J. Geyer, Practical Markov chain Monte Carlo, Statistical Science 7 (1992) 473-483.
"""

from dataclasses import dataclass

import numpy as np

STARTS = np.linspace(0.2, 0.6, 9)  # shares of the settlement that may be dropped
FEWEST_ROWS = 20
COVERAGE = 1.96  # standard deviations of a normal variable that cover the truth 19 times in 20
_OSCILLATION = -0.5  # autocorrelation below which a record oscillates: noise with memory does not reach it, a sine of several periods does
# The truth is between the line's intercept and the level of the flat part; a width w between two bounds is w / sqrt(12)
# of standard deviation (rectangular distribution).
_RECTANGULAR = 1.0 / np.sqrt(12.0)


@dataclass(frozen=True)
class Plateau:
    """Line a + b s fitted to reaction against settlement s; every value is NaN where no fit is possible.

    Attributes
    ----------
    reaction : float
        Intercept a, N or N m.
    uncertainty : float
        Half width of the interval that covers a 19 times in 20, N or N m.
    slope : float
        Slope b, N/m, or N m/rad.
    start : float
        Settlement where the fitted part begins, m or rad.
    scatter : float
        Standard deviation of the residuals, N or N m.
    drift : float
        Change of the line over the fitted part, N or N m.
    """

    reaction: float
    uncertainty: float
    slope: float
    start: float
    scatter: float
    drift: float


NONE = Plateau(*[float("nan")] * 6)


def fit(settlement: np.ndarray, reaction: np.ndarray) -> Plateau:
    """Return the line through the later part of reaction (T,) against settlement (T,), which rises from 0; NONE below 20 rows.

    The start among STARTS with the smallest uncertainty is chosen: an early start keeps a transient, a late one throws rows away. This
    is the marginal standard error rule of White (1997), with a line in place of the mean.
    """
    if len(settlement) == 0 or not np.all(np.isfinite(reaction)):
        return NONE
    fits = [_fit_from(settlement, reaction, share * settlement[-1]) for share in STARTS]
    return min((line for line in fits if np.isfinite(line.uncertainty)), key=lambda line: line.uncertainty, default=NONE)


def _fit_from(settlement: np.ndarray, reaction: np.ndarray, start: float) -> Plateau:
    kept = settlement >= start
    s, r = settlement[kept], reaction[kept]
    if len(s) < FEWEST_ROWS or np.ptp(s) <= 0.0:
        return NONE
    centre = s.mean()
    spread = float(np.sum((s - centre) ** 2))
    slope = float(np.sum((s - centre) * (r - r.mean())) / spread)
    intercept = float(r.mean() - slope * centre)
    residuals = r - intercept - slope * s
    rows = max(len(s) / correlation_length(residuals), 3.0)  # number of independent rows with the same information
    scatter = float(np.sqrt(np.mean(residuals**2) * rows / (rows - 2.0)))
    statistical = student(rows - 2.0) * scatter * np.sqrt((1.0 + centre**2 * len(s) / spread) / rows)
    model = COVERAGE * _RECTANGULAR * abs(intercept - float(r.mean()))
    uncertainty = float(np.hypot(statistical, model))
    return Plateau(intercept, uncertainty, slope, float(s[0]), scatter, slope * float(np.ptp(s)))


def student(freedoms: float) -> float:
    """Return Student's factor, which replaces COVERAGE when the scatter is estimated with this number of degrees of freedom.

    First terms of the expansion in 1/freedoms (Abramowitz & Stegun 26.7.5).
    """
    z = COVERAGE
    return z + (z**3 + z) / (4.0 * freedoms) + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * freedoms**2)


def correlation_length(residuals: np.ndarray) -> float:
    """Return the number of rows per independent row, at least 1: the larger of two estimates of 1 + 2 sum of autocorrelations.

    The first sums over pairs of lags while they are positive (Geyer 1992), which is right for any shape. The second assumes a
    first-order process with the autocorrelation of lag 1, corrected for the bias -(2 + 4 rho)/n of fitting a line. It sees long memory,
    which the fitted line hides from the first. An oscillation, recognised by its strong negative autocorrelation, has no such memory.
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
