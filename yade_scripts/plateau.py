"""Plateau of a noisy, drifting record: straight line through its later part, extrapolated to zero settlement.

The reaction of a mechanism changes with the geometry, so a plateau has a slope; what limit analysis predicts is its value at
the undeformed geometry, the intercept. numpy only.
"""

from dataclasses import dataclass

import numpy as np

STARTS = np.linspace(0.2, 0.6, 9)  # shares of the settlement that may be dropped
FEWEST_ROWS = 20
COVERAGE = 1.96  # standard deviations of a normal variable that cover the truth 19 times in 20
_OSCILLATION = -0.5  # autocorrelation that noise with memory does not reach, and a sine of several periods does
# The truth is between the line's intercept and the level of the flat part; a width w between two bounds is w / sqrt(12)
# of standard deviation (rectangular distribution).
_RECTANGULAR = 1.0 / np.sqrt(12.0)


@dataclass(frozen=True)
class Plateau:
    """Line a + b s fitted to the record from settlement `start` on; every value NaN where there is no meaningful fit.

    reaction: a, N (N m); uncertainty: half-width of the interval that covers a 19 times in 20, N (N m); slope: b, N/m.
    scatter: standard deviation of the residuals, N (N m); drift: change of the line over the fitted range, N (N m).
    """

    reaction: float
    uncertainty: float
    slope: float
    start: float
    scatter: float
    drift: float


NONE = Plateau(*[float("nan")] * 6)


def fit(settlement: np.ndarray, reaction: np.ndarray) -> Plateau:
    """Fit the later part of reaction (T,) against rising settlement (T,), from 0 on; NONE with fewer than 20 rows to fit.

    The start is chosen among STARTS by the smallest uncertainty (White's marginal standard error rule, with a line in the
    place of a mean): an early start keeps a transient, a late one throws rows away.
    """
    if len(settlement) == 0 or not np.all(np.isfinite(reaction)):
        return NONE
    fits = [_fit_from(settlement, reaction, share * settlement[-1]) for share in STARTS]
    return min((one for one in fits if np.isfinite(one.uncertainty)), key=lambda one: one.uncertainty, default=NONE)


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
    rows = max(len(s) / correlation_length(residuals), 3.0)  # as many independent rows know as much
    scatter = float(np.sqrt(np.mean(residuals**2) * rows / (rows - 2.0)))
    statistical = student(rows - 2.0) * scatter * np.sqrt((1.0 + centre**2 * len(s) / spread) / rows)
    model = COVERAGE * _RECTANGULAR * abs(intercept - float(r.mean()))
    uncertainty = float(np.hypot(statistical, model))
    return Plateau(intercept, uncertainty, slope, float(s[0]), scatter, slope * float(np.ptp(s)))


def student(freedoms: float) -> float:
    """Student's factor in the place of COVERAGE when the scatter is itself estimated with so many degrees of freedom.

    First terms of the expansion in 1/freedoms (Abramowitz & Stegun 26.7.5).
    """
    z = COVERAGE
    return z + (z**3 + z) / (4.0 * freedoms) + (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / (96.0 * freedoms**2)


def correlation_length(residuals: np.ndarray) -> float:
    """Rows per independent row, at least 1: the larger of two estimates of 1 + 2 sum of autocorrelations.

    One sums over pairs of lags while they are positive (Geyer 1992), right for any shape. The other takes a first-order
    process with the autocorrelation of lag 1, freed from the bias -(2 + 4 rho)/n that fitting a line brings in: it sees long
    memory, which the line itself has swallowed in the first. An oscillation, known by its deep negative autocorrelation, has
    no such memory.
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
