"""Laws of the plateau fit: the records that it recovers exactly, and the rate at which its uncertainty covers the truth."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import linregress
from scipy.stats import t as student_t

from yade_scripts import plateau

ROWS = 400
TRAVEL = 1e-3
REACTION, SLOPE = 300.0, 2.0e4  # N, N/m: the line changes by 7 % over the travel
DRAWS = 400
LEVEL = plateau.Geometry(turning=2.0 * SLOPE, lever=np.inf)  # of a structure whose geometry may give such a slope
STIFF = plateau.Geometry(turning=0.0, lever=0.4)  # m: of a structure whose blocks, of this size, only slide
COVERED = 0.917  # least share of DRAWS: the stated 0.95 less three standard deviations of a share among 400 draws


def settlement(rows: int = ROWS) -> np.ndarray:
    return np.linspace(0.0, TRAVEL, rows)


def fitted(s: np.ndarray, r: np.ndarray, geometry: plateau.Geometry = LEVEL) -> plateau.Plateau:
    return plateau.fit(s, r, geometry)


def autocorrelated(rng: np.random.Generator, memory: float, deviation: float) -> np.ndarray:
    noise = rng.standard_normal(ROWS) * deviation * np.sqrt(1.0 - memory**2)
    noise[0] /= np.sqrt(1.0 - memory**2)
    for row in range(1, ROWS):
        noise[row] += memory * noise[row - 1]
    return noise


def test_a_slope_that_turning_explains_is_no_doubt_and_any_other_is() -> None:
    s = settlement()
    r = REACTION + SLOPE * s

    def doubt(explained: float) -> float:
        return fitted(s, r, plateau.Geometry(2.0 * SLOPE, np.inf, explained)).from_fit

    assert doubt(SLOPE) < 1e-9 * REACTION and doubt(0.0) > 1e-2 * REACTION
    assert doubt(0.5 * SLOPE) == pytest.approx(0.5 * doubt(0.0), rel=1e-6)
    assert doubt(-SLOPE) == doubt(2.5 * SLOPE) == doubt(0.0)  # an explanation that misses by more than the slope explains nothing


def test_a_plateau_is_left_where_the_reaction_falls_away_and_not_where_it_stays() -> None:
    s = settlement()
    falls = np.where(s < 0.1 * TRAVEL, REACTION, REACTION * (1.0 - ((s - 0.1 * TRAVEL) / TRAVEL) ** 2))
    noise = autocorrelated(np.random.default_rng(0), 0.5, 1e-3 * REACTION)
    early = s < 0.1 * TRAVEL
    best = plateau.Earlier(fitted(s[early], falls[early] + noise[early], STIFF), (1, 1), 0.0)
    enough = plateau.EARLY * REACTION
    assert best.is_left(fitted(s, falls + noise, STIFF), enough) and best.is_left(plateau.NONE, enough)
    assert not best.is_left(fitted(s, REACTION + noise, STIFF), enough)
    assert not best.is_left(fitted(s, falls + noise, STIFF), 2.0 * REACTION)  # below so high a limit no uncertainty counts


@pytest.mark.parametrize(("uncertainty", "enough", "is_left"), [(2.0, 0.0, False), (4.0, 0.0, True), (4.0, 5.0, False)])
def test_a_plateau_is_left_where_its_uncertainty_more_than_trebles_and_is_no_longer_small(
    uncertainty: float, enough: float, is_left: bool
) -> None:
    best = plateau.fit(np.linspace(0.0, 1.0, 50), np.full(50, 100.0), plateau.Geometry(0.0, 1.0))
    earlier = plateau.Earlier(replace(best, uncertainty=1.0), (50, 5), 1.0)
    assert earlier.is_left(replace(best, uncertainty=uncertainty), enough) is is_left


def test_the_parts_of_an_uncertainty_add_up_and_an_unknown_one_does_not_count() -> None:
    assert plateau.Outcome(100.0, 1.0, 2.0, 4.0, 8.0).uncertainty == 15.0
    assert plateau.Outcome(100.0, 1.0, 2.0, 4.0).uncertainty == 7.0


def test_exact_line_is_recovered() -> None:
    s = settlement()
    fit = fitted(s, REACTION + SLOPE * s)
    assert fit.reaction == pytest.approx(REACTION, rel=1e-12)
    assert fit.slope == pytest.approx(SLOPE, rel=1e-9)
    assert fit.from_scatter < 1e-9 * REACTION


def test_constant_has_no_uncertainty() -> None:
    fit = fitted(settlement(), np.full(ROWS, REACTION))
    assert fit.reaction == REACTION
    assert fit.uncertainty < 1e-12 * REACTION
    assert fit.drift == 0.0


def test_white_noise_makes_the_error_of_a_line_by_least_squares() -> None:
    """In 19 of 20 cases the intercept lies within Student's factor times its standard error, which scipy computes independently."""
    s, ratios = settlement(), []
    for seed in range(50):
        r = REACTION + np.random.default_rng(seed).standard_normal(ROWS)
        fit = fitted(s, r)
        kept = s >= fit.start
        line = linregress(s[kept], r[kept])
        assert (fit.reaction, fit.slope) == pytest.approx((line.intercept, line.slope))
        ratios.append(fit.from_scatter / (student_t.ppf(0.975, kept.sum() - 2) * line.intercept_stderr))
    assert np.median(ratios) == pytest.approx(1.05, abs=0.1)  # some records seem to have a memory


def test_a_bent_record_tells_no_more_than_three_rows_with_one_freedom_left() -> None:
    """By hand: a line through n rows with n - 2 freedoms has sigma^2 = n mean(residual^2) / (n - 2) and var(intercept) =
    sigma^2 (1 + centre^2 / var(s)) / n. Each row of a parabola nearly repeats the row before, so that the fewest rows count, n = 3.
    """
    s = settlement()
    r = REACTION + 1.5 * (2.0 * s / TRAVEL - 1.0) ** 2
    fit = fitted(s, r)
    kept = s >= fit.start
    residual = r[kept] - np.polyval(np.polyfit(s[kept], r[kept], 1), s[kept])
    variance = 3.0 * np.mean(residual**2) * (1.0 + s[kept].mean() ** 2 / s[kept].var()) / 3.0
    assert fit.from_scatter == pytest.approx(plateau.student(1.0) * np.sqrt(variance))


def test_a_line_is_uncertain_by_what_lies_between_it_and_its_level_and_by_the_strain_that_may_be_left() -> None:
    """By hand, where turning blocks explain 0.2 of the slope. The difference of line and level, slope times centre, has a rectangular
    distribution. A strain c / s has the slope c / centre^2 at the centre. Drawn back to 0, the line changes by slope times centre, c /
    centre, which is all the strain that is left at the centre. As much is still to come.
    """
    s = settlement()
    fit = fitted(s, REACTION - SLOPE * s, plateau.Geometry(turning=0.25 * SLOPE, lever=np.inf, slope=-0.2 * SLOPE))
    centre = 0.5 * (fit.start + TRAVEL)
    assert fit.from_fit == pytest.approx(1.96 * 0.8 * SLOPE * centre / np.sqrt(12.0), rel=1e-6)
    assert fit.from_strain == pytest.approx(2.0 * 0.75 * SLOPE * centre, rel=1e-6)
    assert fit.drift == pytest.approx(0.8 * SLOPE * (TRAVEL - fit.start), rel=1e-6)
    assert fit.uncertainty == pytest.approx(np.hypot(fit.from_fit, fit.from_strain), rel=1e-6)


def test_slope_alone_widens_the_uncertainty_but_not_beyond_flat_level() -> None:
    s = settlement()
    fit = fitted(s, REACTION + SLOPE * s)
    level_at_end = SLOPE * TRAVEL
    assert 0.1 * level_at_end < fit.uncertainty < level_at_end


@pytest.mark.slow_after_first
@pytest.mark.parametrize("memory", [0.0, 0.5, 0.9, 0.95])
def test_uncertainty_covers_at_the_stated_rate(memory: float) -> None:
    rng = np.random.default_rng(7)
    s = settlement()
    fits = [fitted(s, REACTION + autocorrelated(rng, memory, 5.0)) for _ in range(DRAWS)]
    covered = np.mean([abs(fit.reaction - REACTION) <= fit.uncertainty for fit in fits])
    assert covered >= COVERED


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_uncertainty_is_not_idle(memory: float) -> None:
    rng = np.random.default_rng(8)
    s = settlement()
    fits = [fitted(s, REACTION + autocorrelated(rng, memory, 5.0)) for _ in range(DRAWS)]
    errors = np.array([fit.reaction - REACTION for fit in fits])
    assert np.mean([fit.uncertainty for fit in fits]) < 4.0 * plateau.COVERAGE * errors.std()


def test_autocorrelation_widens_the_uncertainty() -> None:
    s = settlement()
    white, red = (
        np.mean([fitted(s, REACTION + autocorrelated(np.random.default_rng(seed), memory, 5.0)).uncertainty for seed in range(50)])
        for memory in (0.0, 0.9)
    )
    assert red > 2.0 * white


def test_oscillation_averages_out_within_the_uncertainty() -> None:
    s = settlement()
    for phase in np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False):
        fit = fitted(s, REACTION + 20.0 * np.sin(2.0 * np.pi * s / (TRAVEL / 15.3) + phase))
        assert abs(fit.reaction - REACTION) <= fit.uncertainty
        assert fit.uncertainty < 0.05 * REACTION


def test_transient_is_dropped() -> None:
    s = settlement()
    fit = fitted(s, REACTION + 500.0 * np.exp(-s / (0.05 * TRAVEL)))
    assert fit.start > 0.3 * TRAVEL
    assert abs(fit.reaction - REACTION) <= fit.uncertainty + 1e-3 * REACTION


def test_steadily_falling_record_is_no_plateau() -> None:
    s = settlement()
    fit = fitted(s, 1000.0 - 900.0 * s / TRAVEL)
    level = 1000.0 - 900.0
    assert abs(fit.drift) > 0.3 * level
    assert fit.uncertainty > level


def test_scale_of_force_and_length_does_not_matter() -> None:
    rng = np.random.default_rng(3)
    s = settlement()
    r = REACTION + SLOPE * s + autocorrelated(rng, 0.5, 5.0)
    small, large = fitted(s, r), fitted(1e6 * s, 1e-6 * r)
    assert large.reaction == pytest.approx(1e-6 * small.reaction, rel=1e-9)
    assert large.uncertainty == pytest.approx(1e-6 * small.uncertainty, rel=1e-6)
    assert large.start == pytest.approx(1e6 * small.start)


def creeping(s: np.ndarray, power: float) -> np.ndarray:
    """A reaction that approaches REACTION by a negative power of the settlement, as joints lose their strain."""
    return REACTION * (1.0 + 0.02 * (s / TRAVEL + 1e-9) ** -power)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("power", [0.5, 1.0])
@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_a_curve_that_creeps_is_no_plateau(direction: float, power: float, noise: float) -> None:
    """The curve changes by 1.6 to 4.9 % over the last 70 % of the travel. A line drawn back from there misses the whole curve."""
    s = settlement()[1:]
    r = REACTION + direction * (creeping(s, power) - REACTION) + autocorrelated(np.random.default_rng(4), 0.5, noise)[1:]
    assert 0.007 < abs(r[-1] / r[int(0.3 * ROWS)] - 1.0) < 0.05
    assert fitted(s, r, STIFF).creeps


def test_the_slope_that_geometry_gives_is_no_creep() -> None:
    """Turning or sliding blocks cause such a slope: 0.25 % per mm on blocks of 0.4 m."""
    s = settlement()
    assert not fitted(s, REACTION * (1.0 - 0.9 * s / STIFF.lever), STIFF).creeps
    assert not fitted(s, REACTION - 1.9 * SLOPE * s).creeps
    assert fitted(s, REACTION - 1.9 * SLOPE * s, STIFF).creeps


def test_noise_is_no_creep() -> None:
    s = settlement()
    fits = [fitted(s, REACTION + autocorrelated(np.random.default_rng(seed), 0.5, 5.0), STIFF) for seed in range(100)]
    assert np.mean([fit.creeps for fit in fits]) < 0.05


def test_noise_with_memory_is_no_creep() -> None:
    """The slopes of such noise scatter more than the slopes of as many independent rows."""
    rng, geometry = np.random.default_rng(5), plateau.Geometry(turning=0.0, lever=np.inf)
    creeping = [fitted(settlement(), REACTION + autocorrelated(rng, 0.9, 1.0), geometry).creeps for _ in range(DRAWS)]
    assert np.mean(creeping) < 0.03


def test_a_support_that_pulls_has_the_plateau_of_one_that_is_pressed() -> None:
    noise = autocorrelated(np.random.default_rng(2), 0.5, 0.1)
    record = REACTION + 0.9 * REACTION / STIFF.lever * settlement() + noise  # less steep than sliding blocks may make it
    pressed, pulled = (fitted(settlement(), sign * record, STIFF) for sign in (1.0, -1.0))
    assert not pressed.creeps and not pulled.creeps
    assert (pulled.reaction, pulled.slope) == pytest.approx((-pressed.reaction, -pressed.slope))
    assert (pulled.uncertainty, pulled.drift, pulled.start) == pytest.approx((pressed.uncertainty, pressed.drift, pressed.start))


def test_strain_that_may_be_left_is_stated() -> None:
    """A curve may creep with no more slope than sliding may cause. Its limit then lies within the uncertainty."""
    s = settlement()[1:]
    r = REACTION * (1.0 + 4e-4 * TRAVEL / s)
    fit = fitted(s, r, STIFF)
    assert not fit.creeps
    assert abs(fit.reaction - REACTION) <= fit.uncertainty


@pytest.mark.parametrize("rows", [0, 1, plateau.FEWEST_ROWS])
def test_too_few_rows_give_no_value(rows: int) -> None:
    fit = fitted(settlement(rows) if rows else np.empty(0), np.full(rows, REACTION))
    assert np.isnan(fit.reaction)
    assert np.isnan(fit.uncertainty)


def test_a_line_that_is_no_plateau_says_what_it_lacks() -> None:
    """The line is too short, creeps, is uncertain, or changes. A number that does not exist is not stated."""
    exact = fitted(settlement(), np.full(ROWS, REACTION))

    def lacks(**changed: Any) -> str:
        return plateau.shortcoming(replace(exact, **changed), REACTION, 0.02)

    assert plateau.shortcoming(plateau.NONE, REACTION, 0.02) == "the record is too short for a line, or undefined"
    assert lacks(creeps=True, uncertainty=REACTION) == "the reaction still creeps"
    assert lacks(uncertainty=0.05 * REACTION) == "the reaction is known only to 0.05 of itself"
    assert lacks(drift=0.06 * REACTION) == "the reaction still changes by 0.06 of itself over the line"
    # A share of a reaction of 0 has no meaning. A support that turns about an axis below its block has such a reaction.
    assert plateau.shortcoming(replace(exact, reaction=0.0, uncertainty=3.0), 10.0, 0.02) == "the reaction is uncertain by more than itself"


def test_undefined_reaction_gives_no_value() -> None:
    r = np.full(ROWS, REACTION)
    r[-1] = np.nan
    assert np.isnan(fitted(settlement(), r).reaction)


def test_support_that_stands_still_gives_no_value() -> None:
    assert np.isnan(fitted(np.zeros(ROWS), np.full(ROWS, REACTION)).reaction)


@pytest.mark.parametrize(("freedoms", "tabulated"), [(3.0, 3.182), (10.0, 2.228), (60.0, 2.000)])
def test_students_factor_agrees_with_tables(freedoms: float, tabulated: float) -> None:
    assert plateau.student(freedoms) == pytest.approx(tabulated, rel=0.04)  # size of the next term of the series, at 3


def test_correlation_length_of_known_processes() -> None:
    rng = np.random.default_rng(5)
    assert plateau.correlation_length(rng.standard_normal(20000)) == pytest.approx(1.0, abs=0.1)
    memory, noise = 0.8, rng.standard_normal(20000)
    for row in range(1, len(noise)):
        noise[row] += memory * noise[row - 1]
    assert plateau.correlation_length(noise) == pytest.approx((1.0 + memory) / (1.0 - memory), rel=0.2)


@pytest.mark.parametrize(
    ("blocks", "changing", "change", "steady", "steady_enough"),
    [
        (30, 0, 0.03, True, True),
        (30, 1, 0.03, False, True),
        (250, 2, 0.03, True, True),
        (250, 3, 0.03, False, True),
        (250, 12, 0.06, False, True),
        (250, 13, 0.06, False, False),
        (250, 13, 0.04, False, True),
    ],
)
def test_a_motion_is_steady_where_all_but_a_few_blocks_keep_their_velocity(
    blocks: int, changing: int, change: float, steady: bool, steady_enough: bool
) -> None:
    """Block 0 is a support, which does not count. changing: blocks that change their velocity by the share `change`."""
    fastest = 4.0
    velocity, more = fastest * np.ones((blocks + 1, 3)), np.zeros((blocks + 1, 3))
    more[1 : 1 + changing, 2] = change * fastest
    more[0] = 1.0
    nothing = np.zeros((0, 3))
    ways = (1e-4 * velocity, 2e-4 * velocity, 2e-4 * velocity + 2e-4 * (velocity + more))
    first, middle, last = (plateau.Pose(s, way, np.zeros_like(way), nothing) for s, way in zip((1e-4, 2e-4, 4e-4), ways, strict=True))
    free = np.arange(1, blocks + 1)
    assert plateau.is_steady((first, middle, last), free, fastest) is steady
    assert plateau.is_steady((first, middle, last), free, fastest, plateau.STEADY_ENOUGH) is steady_enough
