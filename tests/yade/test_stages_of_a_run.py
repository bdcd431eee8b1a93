"""The stages of a run with made-up bodies, without YADE: rest under the weights, motion of supports, stored states, and the end."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from yade_stand_in import without_yade

from la_core import exchange
from yade_scripts import plateau

protocol, recorder = (without_yade(name) for name in ("protocol", "recorder"))
STATUS = recorder.Status
SPEED, TRAVEL, STEP = 0.01, 1e-3, 1e-5  # m/s, m, s
SETTINGS: dict[str, Any] = {
    "wedging": 0.0, "gravity_time": 0.2, "gravity_ramp": 0.05, "rest_unbalanced": 1e-3, "rest_energy": 1e-6, "time_step": STEP,
    "settling_step": 2.0 * STEP, "speed": SPEED, "ramp_time": 0.0101, "max_travel": TRAVEL, "plateau_travel": 2e-4, "poses": 20,
    "record_rows": 500, "stiffening": 4.0, "swing_damping": 0.0, "damping_ratio": 0.3, "fall_speed": 0.5, "time_limit": 1e9,
    "rattling": 0.02,
}  # fmt: skip
DOWN = np.array([[0.0, 0.0, -1.0, 0.0, 0.0, 0.0]])


class Yade:
    """A stand-in for YADE, which steps to one row after another. Its bodies follow their support, and swing until `rests_after`, s.

    As in YADE, the step in which the run is paused is counted later.
    """

    def __init__(self, rests_after: float) -> None:
        self.time, self.dt, self.iter, self.moved, self.late, self.due = 0.0, STEP, 0, 0.0, 0, 0.0
        self.rests_after, self.restless, self.fallen = rests_after, lambda: False, False
        self.loads: list[tuple[float, float]] = []  # share of the weights, by time
        self.speeds: list[tuple[float, float]] = []  # of the support, by its place

    def run(self, steps: int, wait: bool) -> None:
        self.time, self.iter = self.time + self.due, self.iter + self.late
        self.paused, self.late, self.due, done, model = False, 0, 0.0, 0, self.protocol.model
        while done < steps and not self.paused:
            leap = min(model.watch.iterPeriod, steps - done)
            self.speeds.append((self.moved, model.drive[0].velocity))
            self.moved += model.drive[0].velocity * self.dt * leap
            self._count(leap - 1)
            done += leap
            if leap == model.watch.iterPeriod:
                self.protocol.watch()
            self.late, self.due = int(self.paused), self.dt * self.paused
            self._count(1 - self.late)

    def _count(self, steps: int) -> None:
        self.time, self.iter = self.time + self.dt * steps, self.iter + steps

    def pause(self) -> None:
        self.paused = True


class Told:
    """The record of the bodies of this stand-in."""

    is_cut = False

    def __init__(self, yade: Yade) -> None:
        self.yade, self.rows, self.states = yade, [], []
        self.poses: list[SimpleNamespace] = []
        self.kept: list[float] = []

    def settlement(self) -> float:
        return self.yade.moved

    def read_row(self, stage: int, damped_energy: float) -> Any:
        now = self.yade.time + self.yade.dt
        rests = now >= self.yade.rests_after and not self.yade.restless()
        row = SimpleNamespace(
            stage=stage, time=now, settlement=self.yade.moved, reaction=100.0, kinetic_energy=0.0, speed=0.6 if self.yade.fallen else 0.0,
            unbalanced=0.0 if rests else 0.01, displacement=0.0,
        )  # fmt: skip
        self.rows.append(row)
        return row

    def store_pose(self) -> None:
        self.poses.append(SimpleNamespace(settlement=self.yade.moved))

    def keep_plateau(self, start: float) -> None:
        self.kept.append(start)

    def jumps(self, allowed: float) -> bool:
        return False

    def rattles(self, share: float, allowed: float) -> bool:
        return False


class Search:
    """A search for a plateau that begins at half of the travel and may end the run at `until`, m."""

    until = 9.0
    plateau, outcome = plateau.NONE, plateau.NO_OUTCOME

    def __init__(self, case: Any, settings: Any, record: Told) -> None:
        self.record, self.looks = record, []

    def look(self, asked: float) -> bool:
        self.looks.append((asked, self.record.settlement()))
        return self.record.settlement() >= self.until

    def ended(self, asked: float) -> tuple[Any, str, float]:
        self.plateau = SimpleNamespace(start=0.5 * TRAVEL, reaction=100.0)
        return STATUS.PLATEAU, "steady", asked


@pytest.fixture
def begun(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return a function that makes a run with changed settings, before it begins, and its stand-in for YADE."""

    def begin(rests_after: float = 0.0, recording: str = "states", **changes: Any) -> tuple[Any, Yade]:
        yade = Yade(rests_after)
        monkeypatch.setattr(protocol, "Omega", lambda: yade)
        monkeypatch.setattr(protocol, "PlateauSearch", Search)
        monkeypatch.setattr(protocol, "set_loads", lambda case, model, share: yade.loads.append((yade.time, share)))
        case = SimpleNamespace(
            live=None, motions=DOWN, recording=recording, overrides={}, support_speed=1.0, is_rotation=False, block_weight=10.0
        )
        model = SimpleNamespace(drive=[SimpleNamespace(velocity=0.0)], watch=SimpleNamespace(), integrator=SimpleNamespace(damping=0.4))
        chosen = SimpleNamespace(**(SETTINGS | changes))
        yade.protocol = run = protocol.Protocol(case, chosen, model, Told(yade), lambda *given: None)
        return run, yade

    return begin


def rows(run: Any, stage: int) -> list[Any]:
    return [row for row in run.record.rows if row.stage == stage]


def test_a_support_begins_to_settle_once_all_weights_act_and_blocks_have_rested_for_three_rows(begun: Any) -> None:
    run, yade = begun(rests_after=0.08)
    run.run()
    assert yade.loads[0] == (0.0, 0.0) and max(share for _, share in yade.loads) == 1.0
    assert all(before <= after for (_, before), (_, after) in zip(yade.loads, yade.loads[1:], strict=False))
    resting = [row for row in rows(run, exchange.GRAVITY) if row.unbalanced == 0.0]
    assert len(resting) == 3 and resting[0].time == pytest.approx(0.08, abs=2e-4)
    assert run.record.poses[0].settlement == 0.0 and run.model.integrator.damping == 0.0
    early, _ = begun(rests_after=0.0)
    early.run()
    assert rows(early, exchange.GRAVITY)[-1].time > 0.05  # under growing weights there is no rest


def test_rest_that_is_broken_counts_from_its_beginning(begun: Any) -> None:
    run, yade = begun()
    yade.restless = lambda: len(run.record.rows) % 3 == 2  # two rows at rest, one not
    run.run()
    assert run.status is STATUS.FAILED and "not at rest under gravity after 0.2 s: unbalanced force" in run.message
    assert not rows(run, exchange.SETTLEMENT) and run.record.rows[-1].time == pytest.approx(0.2, rel=1e-2)


def test_a_time_to_rest_of_less_than_a_step_ends_as_one_that_is_too_short(begun: Any) -> None:
    run, _ = begun(rests_after=1.0, gravity_time=1e-9)
    run.run()
    assert run.status is STATUS.FAILED and "not at rest under gravity after 1e-09 s: unbalanced force" in run.message


@pytest.mark.parametrize("wedging", [0.0, 1e-4])
def test_a_support_covers_its_whole_travel_and_the_lift_that_wedged_the_structure(wedging: float, begun: Any) -> None:
    run, yade = begun(wedging=wedging)
    run.run()
    lowest = min(place for place, _ in yade.speeds)
    assert lowest == pytest.approx(-wedging, rel=1e-6, abs=1e-12)
    assert yade.moved == pytest.approx(TRAVEL, rel=0.01)
    assert run.asked_settlement == pytest.approx(yade.moved, rel=1e-9)
    assert max(speed for _, speed in yade.speeds) == SPEED
    assert run.status is STATUS.PLATEAU and run.steps == yade.iter + yade.late
    assert run.record.poses[-1].settlement == yade.moved


def test_a_support_begins_slowly(begun: Any) -> None:
    """On a cosine ramp the support covers half of the way at full speed, and on the ramp's first half far less than half of that."""
    run, _ = begun(ramp_time=0.01)
    run.run()
    settling = rows(run, exchange.SETTLEMENT)
    began = settling[0].time - (settling[1].time - settling[0].time)
    way = {share: min(settling, key=lambda row: abs(row.time - began - share * 0.01)).settlement for share in (0.5, 1.0)}
    assert way[1.0] == pytest.approx(0.5 * SPEED * 0.01, rel=0.01)
    assert way[0.5] == pytest.approx(0.5 * SPEED * 0.01 * (0.5 - 1.0 / np.pi), rel=0.01)


def test_a_run_ends_with_its_plateau_which_it_looks_for_from_its_least_travel_on(begun: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Search, "until", 5e-4)
    run, yade = begun(recording="plateau")
    run.run()
    assert run.status is STATUS.PLATEAU and 5e-4 <= yade.moved < 6e-4
    assert min(way for _, way in run.search.looks) >= 2e-4
    assert all(asked == pytest.approx(way, rel=1e-9) for asked, way in run.search.looks)
    assert run.asked_settlement == pytest.approx(yade.moved, rel=1e-9)
    assert run.steps == yade.iter + yade.late and yade.late == 1
    assert run.record.kept == [0.5 * TRAVEL]


def test_states_are_dense_while_joints_strain_and_where_a_plateau_may_be(begun: Any) -> None:
    for stiffening, wedging in ((4.0, 0.0), (64.0, 0.0), (4.0, 1e-4)):
        run, _ = begun(stiffening=stiffening, wedging=wedging)
        run.run()
        row, first = TRAVEL / 500, TRAVEL / 20 / 32 / stiffening
        places = np.array([pose.settlement for pose in run.record.poses])
        assert places[0] == pytest.approx(-wedging, rel=1e-6) and first <= places[1] - places[0] <= 2.0 * first
        places = places + wedging
        apart = np.diff(places)
        late = places[:-1] >= 2e-4 + wedging
        assert np.all(apart[late] <= 0.1 * places[:-1][late] + 2.0 * row) and np.all(apart <= TRAVEL / 20 + 2.0 * row)
        assert np.all(apart[~late][1:] <= 2e-4 / 32 + 2.0 * row)


def test_a_block_that_falls_ends_a_run_at_its_row_and_leaves_no_plateau(begun: Any) -> None:
    run, yade = begun()
    run.search.plateau, told = SimpleNamespace(reaction=100.0), run.record.read_row

    def falling(*given: Any) -> Any:
        yade.fallen = yade.moved > 3e-4
        return told(*given)

    run.record.read_row = falling
    run.run()
    assert run.status is STATUS.COLLAPSED and run.record.rows[-1].speed > 0.0 == run.record.rows[-2].speed
    assert np.isnan(run.plateau.reaction)


@pytest.mark.parametrize("rows_before", [0, 1, 2])
def test_a_run_ends_where_a_block_comes_to_a_face_that_it_did_not_touch(rows_before: int, begun: Any) -> None:
    """Faces are checked in every fourth row, at the end, and where a block falls, because a face may have caught it."""
    run, yade = begun()
    run.record.motion = lambda: ()
    run.near = SimpleNamespace(are_met=lambda: yade.moved > 3e-4)
    told = run.record.read_row

    def falling(*given: Any) -> Any:
        row = told(*given)
        yade.fallen = yade.moved > 3e-4 and len(run.record.rows) % 4 == rows_before
        return row

    run.record.read_row = falling
    run.run()
    assert run.met_face and run.status is STATUS.FAILED and "comes to a face" in run.message
    assert 3e-4 < yade.moved < 3e-4 + 4.1 * TRAVEL / 500


def test_an_error_in_the_thread_of_yade_comes_out_of_the_run(begun: Any) -> None:
    run, yade = begun()
    run.record.read_row = lambda *given: 1 / 0
    with pytest.raises(ZeroDivisionError):
        run.run()
    assert yade.iter + yade.late == 10  # the run ends at its row


@pytest.mark.parametrize(
    ("ratio", "overrides", "may"),
    [(0.3, {}, True), (1.0, {}, False), (0.3, {"damping_ratio": 0.3}, False), (0.3, {"normal_damping": 1.0}, False)],
)
def test_more_damping_may_follow_where_there_can_be_more_and_the_scene_leaves_it(
    ratio: float, overrides: dict[str, float], may: bool, begun: Any
) -> None:
    run, _ = begun(damping_ratio=ratio)
    run.case.overrides = overrides
    assert run.may_damp is may


@pytest.mark.parametrize(("swing_damping", "ended"), [(0.0, STATUS.NO_PLATEAU), (0.5, STATUS.PLATEAU)])
def test_blocks_that_rattle_end_a_run_before_its_plateau_and_damped_ones_only_by_a_jump(
    swing_damping: float, ended: Any, begun: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(protocol, "swing_damper", lambda *given: SimpleNamespace(every=5, taken=0.0))
    run, yade = begun(swing_damping=swing_damping)
    run.model.calm, run.model.inertia = SimpleNamespace(), None
    run.record.rattles = lambda share, allowed: 4e-4 < yade.moved < 8e-4
    run.run()
    assert run.status is ended
    if not swing_damping:
        assert "blocks rattle at a settlement of 0.0004" in run.message and yade.moved < 5e-4
