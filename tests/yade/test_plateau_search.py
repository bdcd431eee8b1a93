"""The end of a run in YADE: its conditions, its value, and the causes of an early end. Records are made up, without YADE."""

import math
import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from yade_stand_in import without_yade

from la_core import exchange
from yade_scripts import plateau
from yade_scripts.settings import OF_LARGE

search, recorder, faults = (without_yade(name) for name in ("plateau_search", "recorder", "faults"))
STATUS = recorder.Status
SAG, STIFFNESS = 1e-5, 1e6  # m, N/m
SETTINGS = SimpleNamespace(
    normal_stiffness=4.0 * STIFFNESS, stop_uncertainty=0.002, plateau_uncertainty=0.02, plateau_drift=0.05, reaction_floor=0.01,
    settings_uncertainty=1e-3, swing_damping=0.0,
)  # fmt: skip
CASE = SimpleNamespace(
    sag=SAG, normal_stiffness=STIFFNESS, support_speed=1.0, is_rotation=False, live=None, free=np.arange(4), weight=4000.0, block_size=0.5
)
STRAIN_ENDS = search.STRAIN_OF_SAG * SAG / 4.0 / 0.002  # m: least settlement at which the joints' strain lets a run end


def line(reaction: float = 100.0, uncertainty: float = 0.05, **changes: Any) -> plateau.Plateau:
    """A fit of a plateau, N."""
    known = plateau.Plateau(reaction, uncertainty, 0.0, 0.0, 0.0, uncertainty, 0.0, 0.0, creeps=False)
    return replace(known, **changes)


class Told:
    """A record at a settlement, whose states have blocks at these displacements (P, 4), m, along z."""

    def __init__(self, settlement: float, states: Any = ()) -> None:
        self.now, self.cuts = settlement, []
        self.rows = [SimpleNamespace(stage=exchange.GRAVITY, reaction=2000.0), SimpleNamespace(stage=exchange.SETTLEMENT, reaction=100.0)]
        places = np.linspace(0.0, settlement, len(states))
        nothing = np.zeros((0, 3))
        moved = (np.outer(state, [0.0, 0.0, -1.0]) for state in states)
        self.poses = [plateau.Pose(place, way, np.zeros_like(way), nothing) for place, way in zip(places, moved, strict=True)]

    def settlement(self) -> float:
        return self.now

    def pose(self) -> Any:
        return self.poses[-1]

    def mark(self) -> tuple[int, int]:
        return 3, 2

    def cut(self, mark: tuple[int, int]) -> None:
        self.cuts.append(mark)


@pytest.fixture
def fits(monkeypatch: pytest.MonkeyPatch) -> list[plateau.Plateau]:
    """The fits that a search finds, one after the other."""
    given: list[plateau.Plateau] = []
    monkeypatch.setattr(search.PlateauSearch, "_fit", lambda _: given.pop(0))
    return given


def looking(record: Told, **settings: float) -> Any:
    return search.PlateauSearch(CASE, SimpleNamespace(**(vars(SETTINGS) | settings)), record)


@pytest.mark.parametrize(
    ("fit", "way", "ends"),
    [
        (line(), 1.01, True),
        (line(), 0.99, False),  # the joints still strain
        (line(uncertainty=0.19), 1.01, True),
        (line(uncertainty=0.21), 1.01, False),
        (line(drift=4.9), 1.01, True),
        (line(drift=5.1), 1.01, False),
        (line(creeps=True), 1.01, True),  # the uncertainty covers the creep
        (line(uncertainty=1.1, creeps=True), 1.01, False),
        (line(-100.0, 0.19), 1.01, True),
        (line(-100.0, 0.21), 1.01, False),
        (line(0.0, 0.039), 1.01, True),  # judged as 1 % of the reaction at rest, 20 N
        (line(0.0, 0.041), 1.01, False),
        (plateau.NONE, 1.01, False),
    ],
)
def test_a_run_ends_once_its_reaction_and_the_strain_of_its_joints_are_known_well_enough(
    fit: plateau.Plateau, way: float, ends: bool, fits: list[plateau.Plateau]
) -> None:
    """way: settlement over STRAIN_ENDS, at which 3 % of the sag over the settlement is the uncertainty that ends a run."""
    fits.append(fit)
    assert looking(Told(way * STRAIN_ENDS)).look(0.0) is ends


@pytest.mark.parametrize(("is_rotation", "least"), [(False, 0.4), (True, 0.2)])  # N, and N m with the size of a block as lever arm
def test_a_reaction_of_zero_from_rest_on_is_measured_by_the_weight(is_rotation: bool, least: float, fits: list[plateau.Plateau]) -> None:
    """Where a ring turns about an upright axis with all its load, no weight does work, and YADE records noise alone."""
    for share, ends in ((0.99, True), (1.01, False)):
        fits.append(line(0.0, share * SETTINGS.stop_uncertainty * least))
        one = looking(Told(1.01 * STRAIN_ENDS))
        one.case = SimpleNamespace(**(vars(CASE) | {"is_rotation": is_rotation}))
        one.record.rows[0].reaction = 0.0
        assert one.look(0.0) is ends


def test_a_multiplier_of_zero_is_measured_by_the_weights(fits: list[plateau.Plateau]) -> None:
    for share, ends in ((0.99, True), (1.01, False)):
        fits.append(line(0.0, share * SETTINGS.stop_uncertainty * SETTINGS.reaction_floor))
        one = looking(Told(1.01 * STRAIN_ENDS))
        one.case = SimpleNamespace(**(vars(CASE) | {"live": np.array([1.0, 0.0, 0.0])}))
        assert one.look(0.0) is ends


def test_joints_of_a_support_that_turns_strain_by_what_its_points_move(fits: list[plateau.Plateau]) -> None:
    fits += [line(), line()]
    for way, ends in ((1.01, True), (0.99, False)):
        one = looking(Told(way * STRAIN_ENDS / 5.0))
        one.case = SimpleNamespace(**(vars(CASE) | {"support_speed": 5.0}))  # m
        assert one.look(0.0) is ends


@pytest.mark.parametrize(("late", "damping", "ends"), [(1.0, 0.5, True), (1.1, 0.5, False), (1.1, 0.0, True)])
def test_a_run_with_a_damped_swing_ends_only_where_its_blocks_move_steadily(
    late: float, damping: float, ends: bool, fits: list[plateau.Plateau]
) -> None:
    """late: speed of one block in the later half of the plateau, over its speed in the earlier half."""
    fits.append(line())
    states = [[0.0] * 4, [1e-4] * 4, [2e-4, 2e-4, 2e-4, (1.0 + late) * 1e-4]]
    assert looking(Told(2e-4, states), swing_damping=damping).look(0.0) is ends


@pytest.mark.parametrize(("late", "content", "ends"), [(1.04, False, False), (1.04, True, True), (1.06, True, False)])
def test_a_run_that_is_content_with_less_asks_for_less_steadiness(
    late: float, content: bool, ends: bool, fits: list[plateau.Plateau]
) -> None:
    """Velocities of all blocks change. 2 % is allowed, and 5 % where the run may end as uncertain as a run of a large structure."""
    fits.append(line())
    enough = OF_LARGE["stop_uncertainty"] if content else 0.99 * OF_LARGE["stop_uncertainty"]
    states = [[0.0] * 4, [1e-4] * 4, [(1.0 + late) * 1e-4] * 4]
    assert looking(Told(2e-4, states), swing_damping=0.5, stop_uncertainty=enough).look(0.0) is ends


@pytest.mark.parametrize(("later", "ends"), [(1.019, True), (1.025, False)])
def test_velocities_before_and_after_the_middle_of_the_plateau_are_compared(later: float, ends: bool, fits: list[plateau.Plateau]) -> None:
    """The third of five states is the middle. From any other state the change of 2.5 % would seem to be less than the accepted 2 %."""
    fits.append(line())
    places = 1e-4 * np.array([0.0, 1.0, 2.0, 2.0 + later, 2.0 + 2.0 * later])
    assert (
        looking(Told(4e-4, [[1e-4 * k, 1e-4 * k, 1e-4 * k, place] for k, place in enumerate(places)]), swing_damping=0.5).look(0.0) is ends
    )


def test_the_line_is_fitted_to_the_settlement_stage_and_its_geometry_to_the_motion_from_the_middle_of_its_starts_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Starts are 0.2 to 0.6 of the settlement, with the middle 0.4. Of states at every 48th, the 19th is the last one before 0.4."""
    found: dict[str, Any] = {}
    record = Told(1e-3, [[0.0] * 4] * 49)
    record.settling = lambda: [row(settlement=1e-4 * k, reaction=50.0 + k) for k in range(11)]  # type: ignore[attr-defined]
    monkeypatch.setattr(search, "geometry_of", lambda case, before, now: (before.settlement, now.settlement))
    monkeypatch.setattr(search.plateau, "fit", lambda *given: found.update(zip(("settlement", "reaction", "states"), given, strict=True)))
    looking(record)._fit()
    assert found["states"] == pytest.approx((19e-3 / 48.0, 1e-3))
    assert found["reaction"] == pytest.approx(50.0 + 1e4 * found["settlement"]) and len(found["reaction"]) == 11


def test_the_sway_of_a_structure_is_no_motion_of_its_mechanism() -> None:
    """The wall, 90 % of the weight, sways by 0.1 mm under a multiplier of 0.5. Then the block moves on alone, by 2 mm in all."""
    multiplier = np.array([0.0, 0.2, 0.3, 0.5, 0.5, 0.5])
    displacement = 2e-4 * multiplier * 0.9 + np.array([0.0, 0.0, 0.0, 0.0, 1e-4, 2e-4])
    assert search.sway_of(displacement, multiplier) == pytest.approx(1.8e-4)
    assert search.sway_of(displacement, -multiplier) == 0.0
    assert search.sway_of(displacement, np.array([0.0, 1e-6, -0.3, -0.3, -0.3, -0.3])) == 0.0  # noise, then the servo holds it back
    one: Any = SimpleNamespace(**(vars(CASE) | {"live": np.array([0.0, 0.0, -1.0]), "gravity": np.array([0.0, 0.0, -10.0])}))
    one.free, one.mass, one.live_load = np.arange(2), np.array([9.0, 1.0]), np.zeros((2, 6))
    record = Told(0.3e-3, [[0.0, 0.0], [1e-4, 1.1e-3], [1e-4, 2.1e-3]])
    assert search.lead_of(one, tuple(record.poses)) == pytest.approx(2.1 / 0.3)
    assert search.lead_of(one, (record.poses[0], record.poses[2], record.poses[2])) == 1.0


@pytest.mark.parametrize(("rows", "is_found"), [(200, True), (30, False)])
def test_a_plateau_begins_beyond_all_to_which_a_structure_has_swayed_before(
    rows: int, is_found: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It sways by 0.2 mm under a multiplier of 1, to 0.12 mm under 0.6, and back under 0.5; then its mechanism moves 1 um in each row."""
    multiplier = np.concatenate([np.linspace(0.0, 0.6, 30), np.full(rows, 0.5)])
    displacement = 2e-4 * multiplier + np.concatenate([np.zeros(30), 1e-6 * np.arange(rows)])
    record = Told(float(displacement[-1]), [[0.0] * 4] * 3)
    record.settling = lambda: [row(settlement=s, reaction=r) for s, r in zip(displacement, multiplier, strict=True)]  # type: ignore[attr-defined]
    monkeypatch.setattr(search, "geometry_of", lambda case, before, now: plateau.Geometry(0.0, 1.0))
    monkeypatch.setattr(search, "lead_of", lambda case, poses: 1.0)
    one = looking(record)
    one.case = SimpleNamespace(**(vars(CASE) | {"live": np.array([1.0, 0.0, 0.0])}))
    found = one._fit()
    assert (found.reaction == pytest.approx(0.5) and found.start > 0.12e-3) if is_found else math.isnan(found.reaction)


def test_the_best_plateau_is_kept_where_the_reaction_leaves_it(fits: list[plateau.Plateau]) -> None:
    best = line(100.0, 0.3)
    fits += [line(101.0, 0.6), best, line(101.0, 0.6), line(120.0, 20.0), line(120.0, 20.0)]
    record = Told(5e-5)
    one = looking(record)
    assert [one.look(asked) for asked in (1.0, 2.0, 3.0)] == [False] * 3
    assert one.look(4.0)
    status, message, asked = one.ended(4.0)
    assert status is STATUS.PLATEAU and one.plateau.reaction == 100.0 and asked == 2.0 and record.cuts == [(3, 2)]
    assert re.fullmatch(r"steady from a settlement of \S+ to \S+ m; the reaction leaves it before a settlement of \S+ m", message)


def test_the_strain_at_a_plateau_that_was_left_is_compared_with_the_motion_there(monkeypatch: pytest.MonkeyPatch) -> None:
    """The blocks that the load moves led by 5 times the mean on the plateau. After it the whole wall moves."""
    given = iter([(line(0.5, 0.003), 5.0), (line(0.6, 0.1), 1.0), (line(0.6, 0.1), 1.0)])

    def fit(one: Any) -> plateau.Plateau:
        found, one._lead = next(given)
        return found

    monkeypatch.setattr(search.PlateauSearch, "_fit", fit)
    one = looking(Told(STRAIN_ENDS))
    one.case = SimpleNamespace(**(vars(CASE) | {"live": np.array([1.0, 0.0, 0.0])}))
    one.look(1.0), one.look(2.0)
    assert one.ended(2.0)[2] == 1.0
    assert one.outcome.stiffness == pytest.approx(0.5 * math.hypot(0.002 / 5.0, 1e-3))


def test_of_a_live_load_it_is_the_multiplier_that_has_no_plateau_or_leaves_one(fits: list[plateau.Plateau]) -> None:
    """A live load has neither a reaction nor a settlement."""
    creeping, best, left = line(0.5, 0.5, creeps=True), line(0.5, 0.003), line(0.6, 0.1)
    for fitted, end in (
        ([creeping], "and the multiplier still creeps"),
        ([best, left], "the multiplier leaves it before a displacement of"),
    ):
        fits += fitted
        one = looking(Told(5e-5))
        one.case = SimpleNamespace(**(vars(CASE) | {"live": np.array([1.0, 0.0, 0.0])}))
        for _ in fitted[1:]:
            one.look(1.0)
        _, message, _ = one.ended(1.0)
        assert end in message and "reaction" not in message


def test_a_plateau_that_the_reaction_did_not_leave_is_the_last_one(fits: list[plateau.Plateau]) -> None:
    fits += [line(100.0, 0.3), line(101.0, 0.8)]
    record = Told(5e-5)
    one = looking(record)
    assert not one.look(1.0)
    assert one.ended(2.0)[::2] == (STATUS.PLATEAU, 2.0) and one.plateau.reaction == 101.0 and record.cuts == []


@pytest.mark.parametrize(
    ("fit", "status", "has_value"),
    [
        (line(uncertainty=1.9), STATUS.PLATEAU, True),
        (line(uncertainty=2.1), STATUS.NO_PLATEAU, True),
        (line(uncertainty=0.9, creeps=True), STATUS.PLATEAU, True),
        (line(uncertainty=1.1, creeps=True), STATUS.NO_PLATEAU, False),
        (plateau.NONE, STATUS.NO_PLATEAU, False),
    ],
)
def test_at_the_end_of_its_travel_a_run_is_content_with_less_but_no_curve_that_creeps_has_a_value(
    fit: plateau.Plateau, status: Any, has_value: bool, fits: list[plateau.Plateau]
) -> None:
    fits.append(fit)
    one = looking(Told(1e-3))
    assert one.ended(1.0)[0] is status
    assert math.isfinite(one.outcome.reaction) is has_value


@pytest.mark.parametrize("reaction", [100.0, -100.0])
def test_what_stiffness_and_settings_may_do_is_a_part_of_the_uncertainty(reaction: float, fits: list[plateau.Plateau]) -> None:
    fits.append(line(reaction, 0.05, from_scatter=0.03, from_fit=0.04, from_strain=0.12))
    one = looking(Told(STRAIN_ENDS))
    one.ended(0.0)
    assert one.outcome.stiffness == pytest.approx(math.hypot(0.12, 0.2, 0.1))
    assert one.outcome.uncertainty == pytest.approx(0.03 + 0.04 + one.outcome.stiffness)


# --- early ends ----------------------------------------------------------------------------------------------------------------------


def row(**values: float) -> Any:
    """A row of a run that goes on."""
    usual = {"reaction": 1.0, "kinetic_energy": 0.0, "unbalanced": 0.0, "time": 1.0, "speed": 0.0, "settlement": 0.0, "displacement": 0.0}
    return SimpleNamespace(**({"stage": exchange.SETTLEMENT} | usual | values))


@pytest.mark.parametrize(
    ("values", "status"),
    [
        ({}, None),
        ({"reaction": math.nan}, STATUS.FAILED),
        ({"kinetic_energy": math.inf}, STATUS.FAILED),
        ({"speed": 0.51}, STATUS.COLLAPSED),
        ({"speed": 0.49}, None),
        ({"displacement": 0.006, "stage": exchange.GRAVITY}, STATUS.COLLAPSED),
        ({"displacement": 0.004, "stage": exchange.GRAVITY}, None),  # a turn of 1 mrad at 5 m
        ({"displacement": 0.006}, None),  # it follows the support
    ],
)
def test_a_run_is_lost_where_forces_are_undefined_or_a_block_falls(values: dict[str, float], status: Any) -> None:
    one = SimpleNamespace(support_speed=5.0, is_rotation=True, live=None)
    chosen = SimpleNamespace(fall_speed=0.5, max_travel=1e-3, time_limit=1e9)
    found = faults.loss_of(one, chosen, row(**values), 0.0)
    assert (found and found[0]) is status


@pytest.mark.parametrize(
    ("is_rotation", "live", "words"),
    [
        (False, None, "a settlement of 0.0002 m"),
        (True, None, "a settlement of 0.0002 rad"),
        (False, (1.0, 0.0, 0.0), "a displacement of 0.0002 m"),
    ],
)
def test_a_run_is_lost_at_its_time_limit_and_says_where(is_rotation: bool, live: Any, words: str) -> None:
    one = SimpleNamespace(support_speed=1.0, is_rotation=is_rotation, live=live)
    chosen = SimpleNamespace(fall_speed=0.5, max_travel=1e-3, time_limit=1.0)
    status, why = faults.loss_of(one, chosen, row(settlement=2e-4), -1e12)
    assert status is STATUS.TIMEOUT and why.endswith(words)


@pytest.mark.parametrize(
    ("early", "late", "peak", "rattling"),
    [
        (0.0, 0.019, 0.0, False),
        (0.0, 0.021, 0.0, True),
        (0.4, 0.0, 0.0, False),  # on the first fifth of the way, which the mean leaves out
        (0.0, 0.0, 0.49, False),
        (0.0, 0.0, 0.51, True),
    ],
)
def test_blocks_rattle_on_the_mean_of_the_later_way_or_by_a_single_jump(early: float, late: float, peak: float, rattling: bool) -> None:
    rows = [row(settlement=place, unbalanced=early if place < 0.2 else late) for place in np.linspace(0.0, 1.0, 101)]
    rows[50].unbalanced = max(late, peak)
    rows.insert(0, row(stage=exchange.GRAVITY, unbalanced=9.0))  # a motion before the support moves is no rattling
    record = object.__new__(recorder.Record)
    record.rows, record._cut = rows, 1.0
    one, chosen = SimpleNamespace(live=None, support_speed=1.0, block_weight=10.0), SimpleNamespace(rattling=0.02)
    assert faults.rattles(one, chosen, record) is rattling
