"""A release from made-up paths: their travels, the path that counts, its value in N, and the cases without a known value."""

import math
from types import SimpleNamespace
from typing import Any

import pytest

from la_core.coulomb import PredictionSettings, release
from la_core.coulomb.plateau import Plateau

UNIT = 200.0  # N: force of the scaled value 1
LEAST_TRAVEL = 8.0  # of turning blocks


def path(value: float = 0.3, travel: float = 5.0, worst: float = 0.0, iterations: int = 25, is_short: bool = False) -> Any:
    """A made-up path of turning blocks at its end. Ten of its iterations came before the blocks turned."""
    return SimpleNamespace(
        plateau=Plateau(value, value, 0.0, 0.0, travel), end=SimpleNamespace(certificate=SimpleNamespace(worst=worst)),
        iterations=iterations, is_short=is_short, smooth_error=0.0,
    )  # fmt: skip


class Made:
    """A release from made-up paths. error: of their forces, N; pace: of the fastest block after one travel."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, *paths: Any, error: float = 0.0, pace: float = 1.0) -> None:
        self.turned: list[Any] = []
        self.least: list[float] = []
        ways = iter(paths)

        def go_on(start: Any, joints: Any, settings: Any, least: float, send: Any) -> Any:
            self.turned.append(joints)
            self.least.append(least)
            return next(ways)

        self.turning: Any = SimpleNamespace(with_axes_of_first=lambda: "axes of the other block")
        monkeypatch.setattr(release, "ElasticJoints", lambda *_: self.turning)
        monkeypatch.setattr(release, "least_travel", lambda _: LEAST_TRAVEL)
        monkeypatch.setattr(release, "go_on_turning", go_on)
        monkeypatch.setattr(release, "error_of_forces", lambda *_: error)
        monkeypatch.setattr(release, "mechanism_and_forces", lambda joints, end: (joints, end))
        start = SimpleNamespace(pace=pace, last=SimpleNamespace(progress=1.0), iterations=10)
        followed: Any = [SimpleNamespace(first_travel=start, viscosity=0.0) for _ in paths]
        joints: Any = SimpleNamespace(assembly=None, value_in_units=lambda value: UNIT * value)
        progress: Any = SimpleNamespace(senders_of_more=lambda viscosities: [None for _ in viscosities])
        self.found = release.released(joints, Any, followed, PredictionSettings(), progress)


def is_unknown(found: release.Released) -> bool:
    return math.isnan(found.value) and math.isnan(found.uncertainty) and found.state is None and found.is_doubtful


def test_every_path_goes_as_far_as_the_farthest_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Made(monkeypatch, path(travel=3.0), path(travel=7.0), path(travel=5.0), path()).least == [0.0, 3.0, 7.0, 7.0]


def test_the_coarse_path_alone_turns_its_axes_with_the_other_block(monkeypatch: pytest.MonkeyPatch) -> None:
    made = Made(monkeypatch, path(), path(), path())
    assert made.turned == ["axes of the other block", made.turning, made.turning]


@pytest.mark.parametrize(("error", "is_doubtful"), [(0.0, False), (0.5, False), (0.6, True), (14.0, True)])
def test_errors_of_forces_add_to_what_paths_leave_uncertain(error: float, is_doubtful: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """The value is 0.3 * 200 N = 60 N. Steps leave an uncertainty of 3e-4, 0.018 N. More than 1 %, 0.6 N, is doubtful."""
    found = Made(monkeypatch, path(), path(), error=error).found
    assert (found.value, found.uncertainty, found.is_doubtful) == (60.0, pytest.approx(0.018 + error), is_doubtful)


def test_a_reaction_of_zero_is_doubtful_by_a_share_of_a_thousandth_of_the_weight(monkeypatch: pytest.MonkeyPatch) -> None:
    """A thousandth of the weight of 200 N is 0.2 N. The value is doubtful from 1 % of it, 0.002 N, on, and unknown from 0.05 N on."""
    for error, is_doubtful in ((0.0019, False), (0.0021, True), (0.049, True)):
        found = Made(monkeypatch, path(0.0), path(0.0), error=error).found
        assert (found.value, found.is_doubtful) == (0.0, is_doubtful)
    assert is_unknown(Made(monkeypatch, path(0.0), path(0.0), error=0.051).found)


def test_errors_of_forces_of_a_quarter_of_the_value_leave_it_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    found = Made(monkeypatch, path(), path(), error=15.0).found
    assert is_unknown(found) and found.iterations == 30


@pytest.mark.parametrize(("worst", "value"), [((0.0, 0.0), 0.3), ((0.0, 1e-2), 0.301), ((1e-2, 0.0), 0.3)])
def test_the_finest_path_in_a_limit_state_has_the_value_and_the_state(
    worst: tuple[float, float], value: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its mechanism is that of blocks that have turned."""
    paths = path(0.301, worst=worst[0]), path(0.3, worst=worst[1])
    made = Made(monkeypatch, *paths)
    assert made.found.value == UNIT * value and made.found.iterations == 30
    assert made.found.state == (made.turning, paths[0 if value == 0.301 else 1].end)


def test_without_a_limit_state_the_value_is_unknown_however_well_the_paths_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    for worst in (1e-2, math.nan):
        found = Made(monkeypatch, path(worst=worst), path(worst=worst)).found
        assert is_unknown(found) and found.iterations == 30


def test_a_path_that_cannot_go_on_or_ends_too_early_leaves_the_value_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    """The iterations of the paths so far count, and no other path follows."""
    for second, iterations in ((None, 15), (path(iterations=17, is_short=True), 22)):
        made = Made(monkeypatch, path(), second, path())
        assert is_unknown(made.found) and made.found.iterations == iterations and len(made.turned) == 2


@pytest.mark.parametrize(("pace", "is_followed"), [(3.9, True), (4.1, False)])
def test_no_path_branches_off_where_the_fastest_block_has_gone_half_its_least_travel(
    pace: float, is_followed: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = Made(monkeypatch, path(), path(), pace=pace)
    assert bool(made.turned) is is_followed and is_unknown(made.found) is not is_followed
