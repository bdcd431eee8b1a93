"""An undefined part makes the whole result undefined. The report calls it unknown and never counts it as zero."""

from dataclasses import replace

import numpy as np
import pytest
import scenes

from comparison.campaign.row_values import LIMIT, of_mechanism, prediction
from comparison.numbers import Units, percent
from comparison.report.plain_words import _moving_words
from la_core.analysis import analyse
from la_core.coulomb.certificate import Certificate, End
from la_core.limit.plane_in_space import residual_in_space
from la_core.text_table import number_text

NAN = float("nan")


@pytest.mark.parametrize(
    ("count", "words"),
    [(None, "it is unknown which blocks move"), (0, "no block moves"), (2, "2 of the 5 blocks move"), (5, "all 5 blocks move")],
)
def test_an_unknown_mechanism_is_no_rest(count: int | None, words: str) -> None:
    facts = {"moving_blocks": {} if count is None else {"limit_analysis": count}, "blocks": {"free": 5}}
    assert _moving_words({}, facts) == words


def test_the_end_with_an_undefined_residual_is_the_farther_one() -> None:
    known, better, unknown = (End(None, None, Certificate(1e-6, 0.0, 0.0, 0.0, power)) for power in (1e-3, 1e-5, NAN))  # type: ignore[arg-type]
    assert known.or_nearer(better) is better and better.or_nearer(known) is better
    assert unknown.or_nearer(known) is known and known.or_nearer(unknown) is known
    assert unknown.or_nearer(unknown) is unknown


@pytest.mark.parametrize(
    "residual", ["equilibrium_residual", "cone_violation", "dilatancy_residual", "sliding_residual", "strain_residual"]
)
def test_a_certificate_with_an_undefined_residual_is_undefined(residual: str) -> None:
    coulomb = analyse(scenes.shipped("wall_third")).coulomb
    assert coulomb is not None and coulomb.steps > 0 and np.isfinite(coulomb.certificate)
    assert np.isnan(replace(coulomb, **{residual: NAN}).certificate)


def test_without_a_path_a_certificate_is_that_of_the_residuals_that_exist() -> None:
    coulomb = analyse(scenes.shipped("two_pads")).coulomb
    assert coulomb is not None and coulomb.steps == 0 and np.isnan(coulomb.strain_residual) and np.isfinite(coulomb.certificate)


def test_a_plane_answer_without_a_mechanism_is_none_in_space() -> None:
    analysis = analyse(scenes.shipped("two_pads"))
    answer = analysis.main_answer
    assert residual_in_space(analysis.assembly, answer.twists, answer.forces) < 1e-6
    assert np.isnan(residual_in_space(analysis.assembly, np.full_like(answer.twists, NAN), answer.forces))


def test_value_and_mechanism_of_a_row_are_of_one_answer() -> None:
    row = {"coulomb_status": "failed", "coulomb": None, "least": 1.0, "associated_participation": 0.5, "coulomb_participation": None}
    assert prediction(row) == "least" and of_mechanism(row, LIMIT, "participation") == 0.5
    row |= {"coulomb_status": "solved", "coulomb": 2.0, "coulomb_participation": 0.7}
    assert prediction(row) == "coulomb" and of_mechanism(row, LIMIT, "participation") == 0.7


@pytest.mark.parametrize(
    ("sentence", "shown"),
    [
        ('block "pier 2 m" would fall under 1500 N', 'block "pier 2 m" would fall under 1.500 kN'),
        ('block "wall 1.2.3 m" moves by 0.002 m', 'block "wall 1.2.3 m" moves by 2 mm'),
        ("part 1.2.3 m of it", "part 1.2.3 m of it"),
        ("2552.39 to 3340.92 N", "2.55239 to 3.34092 kN"),
    ],
)
def test_numbers_within_names_keep_their_units(sentence: str, shown: str) -> None:
    assert Units(1000.0).words(sentence) == shown


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (9999.7, 4, "10000"),
        (99999.6, 5, "100000"),
        (9999.4, 4, "9999"),
        (-0.0, 6, "0"),
        (-3.5, 4, "−3.5"),
        (1234567.0, 4, "1.235e+06"),
        (NAN, 4, "–"),
    ],
)
def test_a_number_that_is_rounded_up_to_the_next_power_of_ten_is_in_full(value: float, digits: int, text: str) -> None:
    assert number_text(value, digits) == text


def test_a_negative_share_has_the_minus_of_every_other_number() -> None:
    assert (percent(-0.05), percent(-2.0), percent(0.05), percent(-0.0), percent(NAN)) == ("−5 %", "−200 %", "5 %", "0 %", "–")
