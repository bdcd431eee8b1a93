"""Numbers of a report have the digits that their uncertainty leaves, and one unit."""

import math
from typing import Any

import pytest

from comparison.numbers import Units, format_number, percent, plain_number, share_of, small_number, with_uncertainty


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "–"), (float("nan"), "–"), (float("inf"), "–"), (True, "–"), (0.0, "0"), (24.0, "24"), (22829, "22829"), (363.2987, "363.3"),
        (99999.6, "100000"), (-0.02981, "−0.02981"), (1.2344e-9, "1.234e-9"), (12345678.9, "1.235e7"),
    ],
)  # fmt: skip
def test_numbers(value: Any, shown: str) -> None:
    assert format_number(value) == shown


@pytest.mark.parametrize(
    ("value", "uncertainty", "shown"),
    [
        (0.0703164, 2.3e-5, "0.07032 ± 0.00002"), (1986.65, 0.65, "1986.7 ± 0.7"), (-0.5, 0.01, "−0.50 ± 0.01"),
        (-4e-13, 2e-7, "0.0000000 ± 0.0000002"),
        (0.16833, 1e-8, "0.16833"), (0.0, 1e-12, "0"), (0.16833, 0.0, "0.16833"), (0.16833, None, "0.16833"), (float("nan"), 0.1, "–"),
    ],
)  # fmt: skip
def test_a_value_has_the_digits_that_its_uncertainty_leaves(value: float, uncertainty: float | None, shown: str) -> None:
    assert with_uncertainty(value, uncertainty) == shown


@pytest.mark.parametrize(
    ("value", "scale", "digits", "shown"),
    [
        (-4.1e-6, 0.3633, 5, "≈ 0"),  # kN: a difference of 0.004 N of two reactions
        (1.59e-4, 2.5524, 5, "0.0002"),
        (-0.0025, 0.366, 5, "−0.00250"),
        (0.0, 0.366, 5, "0"),  # exactly
        (2.44e-11, 1e-6, 3, "≈ 0"),  # far below its tolerance
        (3.5e-6, 1e-5, 3, "3.5e-6"),  # too many decimal places
        (12.0, 250.0, 3, "12"),
        (math.nan, 1.0, 3, "–"),
        (0.5, math.nan, 3, "0.500"),
        (0.5, 0.0, 3, "0.500"),
    ],
)
def test_a_difference_has_the_places_of_what_it_is_compared_with(value: float, scale: float, digits: int, shown: str) -> None:
    assert small_number(value, scale, digits) == shown


def test_small_numbers_of_a_report_have_no_exponent_and_no_idle_zeros() -> None:
    assert [plain_number(value) for value in (1.28e-4, 0.0020, 0.05, 4.0, 20.0, 1e-9, None)] == [
        "0.00013", "0.002", "0.05", "4", "20", "1e-9", "–",
    ]  # fmt: skip
    assert plain_number(1.85, 3) == "1.85" and plain_number(-0.5, 3) == "−0.5"
    assert [share_of(apart, 2.0) for apart in (0.02, -1e-3, 1e-6, 0.0, None)] == ["+1 %", "−0.050 %", "≈ 0 %", "0 %", "–"]
    assert share_of(1.0, 0.0) == "–"


def test_words_and_numbers_of_a_report_have_one_unit() -> None:
    heavy, light = Units(5e4), Units(50.0)
    assert heavy.text(1986.65, "N") == "1.987 kN" and light.text(12.5, "N") == "12.50 N"
    assert heavy.text(3.4e-4, "m", 3) == "0.340 mm" and heavy.text(2e9, "N/m") == "2000 kN/mm"
    assert heavy.words("Range: 2552.39 to 3340.92 N.") == "Range: 2.55239 to 3.34092 kN."
    assert heavy.words("moved 4e-05 m in 12 s, 5 N/m, 3 mm") == "moved 0.04 mm in 12 s, 5 N/m, 3 mm"
    assert (
        heavy.words("said 363.3 ± 0.1 N; 1300.40 N (plateaus: 363.3, 402 N)")
        == "said 0.3633 ± 0.0001 kN; 1.30040 kN (plateaus: 0.3633, 0.402 kN)"
    )
    assert heavy.words("off by −4e-12 m") == "off by −4e-9 mm" and light.words("363.3 ± 0.1 N") == "363.3 ± 0.1 N"


@pytest.mark.parametrize(
    ("share", "shown"), [(None, "–"), (math.nan, "–"), (0.0, "0 %"), (0.05, "5 %"), (0.142, "14 %"), (0.0035, "0.35 %"), (1.14, "114 %")]
)
def test_a_share_in_per_cent_has_two_digits_and_a_space(share: float | None, shown: str) -> None:
    assert percent(share) == shown
