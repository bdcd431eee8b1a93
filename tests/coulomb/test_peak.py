"""The peak of a live load on the way to its plateau: without drag, with an uncertainty, and stored with the analysis."""

from pathlib import Path

import h5py
import numpy as np
import pytest
import scenes
from pushed_walls import ALONG, OBLIQUE, peak_without_drag, pushed_wall

from la_core.analysis import analyse, case_file
from la_core.analysis.result import LimitAnalysis
from la_core.coulomb.plateau import peak_before


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("seed", "live"), [(1, ALONG), (18, ALONG), (35, ALONG), (19, OBLIQUE), (35, OBLIQUE)])
def test_the_peak_is_that_of_a_path_with_next_to_no_drag(seed: int, live: tuple[float, float, float]) -> None:
    analysis = pushed_wall(seed, live)
    coulomb = analysis.coulomb
    assert coulomb is not None
    peak, uncertainty = coulomb.peak
    assert peak > 1.02 * coulomb.value and uncertainty < 0.02 * peak
    assert abs(peak_without_drag(analysis) - peak) <= uncertainty


def test_a_load_that_rises_to_its_plateau_has_no_peak() -> None:
    coulomb = pushed_wall(0, ALONG).coulomb
    assert coulomb is not None and len(coulomb.path_value) and not len(coulomb.peak)


def test_a_curve_that_drag_alone_lifts_above_its_plateau_has_no_peak() -> None:
    coulomb = pushed_wall(50, OBLIQUE).coulomb
    assert coulomb is not None and coulomb.path_value.max() > 1.02 * coulomb.value and not len(coulomb.peak)


def test_a_settlement_has_no_peak_and_no_place_for_one_in_its_file(tmp_path: Path) -> None:
    """The reaction of a settlement falls from rest, so that its greatest value is the one at rest."""
    analysis = analyse(scenes.shipped("wall_third"))
    assert analysis.coulomb is not None and not len(analysis.coulomb.peak)
    assert not stored(analysis, tmp_path)[1]


def test_a_peak_is_stored_with_its_analysis(tmp_path: Path) -> None:
    analysis = pushed_wall(1, ALONG)
    found, has_peak = stored(analysis, tmp_path)
    assert analysis.coulomb is not None and found.coulomb is not None and has_peak
    assert len(found.coulomb.peak) == 2 and np.array_equal(found.coulomb.peak, analysis.coulomb.peak)


def stored(analysis: LimitAnalysis, folder: Path) -> tuple[LimitAnalysis, bool]:
    """An analysis written and read again, and whether its file has a peak."""
    path = folder / "case.h5"
    case_file.write_case(path, analysis, case_file.scene_digest(analysis.scene))
    with h5py.File(path) as file:
        return case_file.read_case(path, analysis.scene), "limit_analysis/coulomb/peak" in file


def test_a_curve_counts_up_to_its_last_point_near_the_level() -> None:
    values = np.array([0.0, 3.0, 1.0, 2.0, 1.01, 5.0])
    assert peak_before(values, 1.0, 0.02) == 3.0
    assert peak_before(values, 1.0, 0.005) == 3.0
    assert peak_before(np.array([0.0, 1.0, 4.0, 1.0, 5.0]), 1.0, 0.02) == 4.0  # the curve comes to the level twice
    assert peak_before(values, 9.0, 0.1) == 5.0  # the curve never comes to the level
    assert peak_before(values, 0.0, 0.1) == -np.inf  # no point lies before the first one
