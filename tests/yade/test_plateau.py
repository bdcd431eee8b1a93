"""Laws of the plateau fit: what it recovers exactly, and how often its uncertainty covers the truth."""

import numpy as np
import pytest

from yade_scripts import plateau

ROWS = 400
TRAVEL = 1e-3
REACTION, SLOPE = 300.0, 2.0e4  # N, N/m: the line changes by 7 % over the travel
DRAWS = 400
COVERED = 0.917  # least share of DRAWS: the stated 0.95 less three standard deviations of a share among 400 draws


def settlement(rows: int = ROWS) -> np.ndarray:
    return np.linspace(0.0, TRAVEL, rows)


def autocorrelated(rng: np.random.Generator, memory: float, deviation: float) -> np.ndarray:
    noise = rng.standard_normal(ROWS) * deviation * np.sqrt(1.0 - memory**2)
    noise[0] /= np.sqrt(1.0 - memory**2)
    for row in range(1, ROWS):
        noise[row] += memory * noise[row - 1]
    return noise


def test_exact_line_is_recovered() -> None:
    s = settlement()
    fit = plateau.fit(s, REACTION + SLOPE * s)
    assert fit.reaction == pytest.approx(REACTION, rel=1e-12)
    assert fit.slope == pytest.approx(SLOPE, rel=1e-9)
    assert fit.scatter < 1e-9 * REACTION


def test_constant_has_no_uncertainty() -> None:
    fit = plateau.fit(settlement(), np.full(ROWS, REACTION))
    assert fit.reaction == REACTION
    assert fit.uncertainty < 1e-12 * REACTION
    assert fit.drift == 0.0


def test_slope_alone_widens_the_uncertainty_but_not_beyond_flat_level() -> None:
    s = settlement()
    fit = plateau.fit(s, REACTION + SLOPE * s)
    level_at_end = SLOPE * TRAVEL
    assert 0.1 * level_at_end < fit.uncertainty < level_at_end


@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9, 0.95])
def test_uncertainty_covers_at_the_stated_rate(memory: float) -> None:
    rng = np.random.default_rng(7)
    s = settlement()
    fits = [plateau.fit(s, REACTION + autocorrelated(rng, memory, 5.0)) for _ in range(DRAWS)]
    covered = np.mean([abs(fit.reaction - REACTION) <= fit.uncertainty for fit in fits])
    assert covered >= COVERED


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_uncertainty_is_not_idle(memory: float) -> None:
    rng = np.random.default_rng(8)
    s = settlement()
    fits = [plateau.fit(s, REACTION + autocorrelated(rng, memory, 5.0)) for _ in range(DRAWS)]
    errors = np.array([fit.reaction - REACTION for fit in fits])
    assert np.mean([fit.uncertainty for fit in fits]) < 4.0 * plateau.COVERAGE * errors.std()


def test_autocorrelation_widens_the_uncertainty() -> None:
    s = settlement()
    white, red = (
        np.mean([plateau.fit(s, REACTION + autocorrelated(np.random.default_rng(seed), memory, 5.0)).uncertainty for seed in range(50)])
        for memory in (0.0, 0.9)
    )
    assert red > 2.0 * white


def test_oscillation_averages_out_within_the_uncertainty() -> None:
    s = settlement()
    for phase in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False):
        fit = plateau.fit(s, REACTION + 20.0 * np.sin(2.0 * np.pi * s / (TRAVEL / 15.3) + phase))
        assert abs(fit.reaction - REACTION) <= fit.uncertainty
        assert fit.uncertainty < 0.05 * REACTION


def test_transient_is_dropped() -> None:
    s = settlement()
    fit = plateau.fit(s, REACTION + 500.0 * np.exp(-s / (0.05 * TRAVEL)))
    assert fit.start > 0.3 * TRAVEL
    assert abs(fit.reaction - REACTION) <= fit.uncertainty + 1e-3 * REACTION


def test_steadily_falling_record_is_no_plateau() -> None:
    s = settlement()
    fit = plateau.fit(s, 1000.0 - 900.0 * s / TRAVEL)
    level = 1000.0 - 900.0
    assert abs(fit.drift) > 0.3 * level
    assert fit.uncertainty > level


def test_scale_of_force_and_length_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    s = settlement()
    r = REACTION + SLOPE * s + autocorrelated(rng, 0.5, 5.0)
    small, large = plateau.fit(s, r), plateau.fit(1e6 * s, 1e-6 * r)
    assert large.reaction == pytest.approx(1e-6 * small.reaction, rel=1e-9)
    assert large.uncertainty == pytest.approx(1e-6 * small.uncertainty, rel=1e-6)
    assert large.start == pytest.approx(1e6 * small.start)


@pytest.mark.parametrize("rows", [0, 1, plateau.FEWEST_ROWS])
def test_too_few_rows_give_no_value(rows: int) -> None:
    fit = plateau.fit(settlement(rows) if rows else np.empty(0), np.full(rows, REACTION))
    assert np.isnan(fit.reaction)
    assert np.isnan(fit.uncertainty)


def test_undefined_reaction_gives_no_value() -> None:
    r = np.full(ROWS, REACTION)
    r[-1] = np.nan
    assert np.isnan(plateau.fit(settlement(), r).reaction)


def test_support_that_stands_still_gives_no_value() -> None:
    assert np.isnan(plateau.fit(np.zeros(ROWS), np.full(ROWS, REACTION)).reaction)


@pytest.mark.parametrize(("freedoms", "tabulated"), [(3.0, 3.182), (10.0, 2.228), (60.0, 2.000)])
def test_students_factor_agrees_with_tables(freedoms: float, tabulated: float) -> None:
    assert plateau.student(freedoms) == pytest.approx(tabulated, rel=0.04)  # the next term of the series, at 3


def test_correlation_length_of_known_processes() -> None:
    rng = np.random.default_rng(5)
    assert plateau.correlation_length(rng.standard_normal(20000)) == pytest.approx(1.0, abs=0.1)
    memory, noise = 0.8, rng.standard_normal(20000)
    for row in range(1, len(noise)):
        noise[row] += memory * noise[row - 1]
    assert plateau.correlation_length(noise) == pytest.approx((1.0 + memory) / (1.0 - memory), rel=0.2)
