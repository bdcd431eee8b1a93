"""The comparison with peers: all solvers get the same problem, one judge checks all answers, and the page shows its record."""

import importlib.util
import json
import math
import os
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import peers_command
import peers_dynamics
import peers_equilibrium
import peers_limit
import peers_process
import pytest
import scenes
from benchmark_peers import stored_page
from peers_process import PeerEnded, alone
from peers_scenes import SCENES
from peers_table import CANNOT, LEAST_REACTION, OURS, SOLVED, Row, as_record, number, restored
from scipy.optimize import linprog

from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import ACCEPTED, Drive, DrivenProblem
from la_core.model.assembly import Assembly, assemble

PAGE = Path(__file__).parents[2] / "comparison" / "gallery" / "peers.md"
SAME_REACTION = 2.0 * ACCEPTED  # both answers are certified to ACCEPTED of a mean block; two_pads has one block
SAME_OVER_WEIGHT = 2.0 * 6.0 * ACCEPTED  # two answers with residuals of ACCEPTED in all six freedoms, at speeds of up to one
TIGHT = 1e-8  # requested tolerance, so that a solver's residuals are below ACCEPTED
FINE = 1e-4  # s: a third of the shortest solve
LIMIT = 1.0  # processor seconds for a process that never ends
LAST_RESORT = 600.0  # processor seconds for a process that ends before this limit

solver = pytest.mark.parametrize("name", [*peers_limit.FOREIGN])


def pads() -> Assembly:
    return assemble(scenes.shipped("two_pads"))


def needs(package: str) -> None:
    if importlib.util.find_spec(package) is None:
        pytest.skip(f"{package} is not installed: pip install -e '.[peers]'")


def by_scipy(driven: DrivenProblem, tolerance: float) -> peers_limit.Raw:
    """Solve the kinematic form that peers get, by HiGHS."""
    bounds = (None, None)
    answer = linprog(
        -driven.power, A_ub=-driven.rows, b_ub=driven.offset, bounds=bounds, options={"primal_feasibility_tolerance": tolerance}
    )
    return answer.x, -answer.ineqlin.marginals, answer.nit


@pytest.mark.parametrize("name", peers_limit.HIGHS)
def test_highs_gets_the_problem_that_we_solve(name) -> None:
    own, other = solve_associated(pads(), Drive.YIELDING), peers_limit.highs(pads(), name, 4)
    assert own.status is Status.SOLVED and other.residual <= ACCEPTED
    assert other.solution.value == pytest.approx(own.value, rel=SAME_REACTION)


def test_what_peers_are_handed_has_our_optimum_and_is_certified_by_our_judge(monkeypatch) -> None:
    monkeypatch.setitem(peers_limit.FOREIGN, "scipy", by_scipy)
    own, other = solve_associated(pads(), Drive.YIELDING), peers_limit.foreign(pads(), "scipy", TIGHT)
    assert other.residual <= ACCEPTED
    assert other.solution.value == pytest.approx(own.value, rel=SAME_REACTION)


def test_a_peer_that_is_wrong_is_not_called_solved(monkeypatch) -> None:
    def careless(driven: DrivenProblem, tolerance: float) -> peers_limit.Raw:
        x, multipliers, iterations = by_scipy(driven, tolerance)
        return x, 1.01 * multipliers, iterations

    monkeypatch.setitem(peers_limit.FOREIGN, "scipy", careless)
    assert peers_limit.foreign(pads(), "scipy", TIGHT).residual > ACCEPTED


@pytest.mark.slow
def test_a_whole_command_says_the_same_whoever_computes_its_bounds(monkeypatch) -> None:
    """All solvers give the same bounds in the whole command. The command fails where HiGHS should compute the bounds and does not."""
    monkeypatch.setitem(peers_command.WALLS, 10, (3, 3))
    values = {method: peers_command.measure(10, method, int(LAST_RESORT))[0] for method in peers_command.METHODS}
    assert values == pytest.approx(dict.fromkeys(values, values[OURS]), abs=SAME_OVER_WEIGHT)
    monkeypatch.setattr(peers_command, "PROGRAMME", peers_command.PROGRAMME.replace("one_pass.solve_associated =", "_ ="))
    with pytest.raises(PeerEnded, match="not computed by HiGHS"):
        peers_command.measure(10, peers_command.METHODS[1], int(LAST_RESORT))
    monkeypatch.setattr(peers_command, "PROGRAMME", "while True: pass")
    with pytest.raises(PeerEnded, match="time limit of 1 s"):
        peers_command.measure(10, OURS, 1)


def test_the_ratio_of_whole_commands_is_that_of_the_faster_algorithm() -> None:
    own, slow, fast = (peers_command.Command(10, *of) for of in ((OURS, 0.1, (1.0, 2.0, 9.0)), ("a", 0.1, (30.0,)), ("b", 0.1, (8.0,))))
    none = peers_command.Command(20, "a", limit=200.0, note="time limit of 200 s")
    assert peers_command.ratios([own, slow, fast, none]) == {10: 4.0}
    assert peers_command.ratios([peers_command.Command(20, OURS, 0.1, (1.0,)), none]) == {}
    assert peers_command.ratios([replace(none, method=OURS), replace(slow, blocks=20)]) == {}
    assert peers_command.conclusion([own, slow, fast]).endswith("takes 4.0 times as long on 10 blocks.")


@solver
def test_a_peer_finds_our_reaction(name) -> None:
    needs(name.lower())
    own, other = solve_associated(pads(), Drive.YIELDING), peers_limit.foreign(pads(), name, TIGHT)
    assert other.residual <= ACCEPTED
    assert other.solution.value == pytest.approx(own.value, rel=SAME_REACTION)


def test_an_equilibrium_by_compas_cra_is_one_by_our_judge_and_lies_between_our_bounds() -> None:
    needs("compas_cra")
    assembly = assemble(scenes.shipped("wall_third"))
    *_, forces, _, _ = peers_equilibrium.equilibrium(assembly, "compas_cra RBE")
    assert peers_equilibrium.residual(assembly, forces) <= ACCEPTED
    least, greatest = (solve_associated(assembly, drive).value for drive in (Drive.YIELDING, Drive.PUSHING))
    assert least < peers_limit.residuals.reaction(assembly, forces) < greatest


def spins() -> Iterator[int]:
    yield 1
    while True:
        pass


def aborts() -> Iterator[int]:
    yield 1
    os.abort()


def stops() -> Iterator[int]:
    yield 1
    os._exit(3)


def complains() -> Iterator[int]:
    yield 1
    raise ValueError("no such cone")


def tick() -> float:
    start = time.process_time()
    while time.process_time() == start:
        pass
    return time.process_time() - start


def ticks() -> Iterator[float]:
    """Yield the shortest of many ticks. Other work on the machine lengthens single ticks; a coarse clock lengthens all of them."""
    yield min(tick() for _ in range(100))


def counts() -> Iterator[int]:
    yield from range(3)


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("function", "limit", "reason"),
    [
        (spins, LIMIT, "time limit of 1 s"), (aborts, LAST_RESORT, "SIGABRT"), (stops, LAST_RESORT, "exit code 3"),
        (complains, LAST_RESORT, "ValueError: no such cone"),
    ],
)  # fmt: skip
def test_a_peer_that_dies_or_never_comes_back_ends_its_own_row_alone(function, limit, reason, monkeypatch) -> None:
    monkeypatch.setattr(peers_process, "PATIENCE", math.inf)  # only processor seconds count, which other work does not use
    found = []
    with pytest.raises(PeerEnded, match=reason):
        for one in alone(function, (), limit):
            found.append(one)
    assert found == [1]


def test_a_peer_that_behaves_is_heard_to_the_end() -> None:
    assert list(alone(counts, (), LAST_RESORT)) == [0, 1, 2]


@pytest.mark.slow
def test_a_watched_process_sees_fine_seconds_of_its_own() -> None:
    """With the system's own limit the process would read its time in ticks of milliseconds, longer than a small solve."""
    assert max(alone(ticks, (), LAST_RESORT)) < FINE


def test_a_number_has_two_digits_at_any_size() -> None:
    assert [number(value) for value in (713.0, 0.0996, 1.04, 3.14e-4, 0.0, math.nan)] == ["710", "0.10", "1.0", "3.1e-04", "0", "–"]


def test_the_prediction_beside_the_peers_in_time_is_solved() -> None:
    assert [(run.setting, run.status) for run in peers_dynamics.predict("arch_spreading")] == [("inset", SOLVED), ("sharp", SOLVED)]


@pytest.fixture(scope="module")
def record() -> tuple[list[Row], list[peers_dynamics.Run]]:
    stored = json.loads(PAGE.with_suffix(".json").read_text(encoding="utf-8"))
    return [restored(Row, row) for row in stored["limit analysis"]], [restored(peers_dynamics.Run, run) for run in stored["in time"]]


def test_every_whole_command_of_the_record_has_an_answer_or_says_why_not_and_all_answers_agree() -> None:
    stored = json.loads(PAGE.with_suffix(".json").read_text(encoding="utf-8"))["whole commands"]
    commands = [restored(peers_command.Command, one) for one in stored]
    assert json.loads(json.dumps([as_record(one) for one in commands])) == stored
    assert [(one.blocks, one.method) for one in commands] == [(b, m) for b in peers_command.WALLS for m in peers_command.METHODS]
    for one in commands:
        own = next(other.value for other in commands if (other.blocks, other.method) == (one.blocks, OURS))
        assert one.note if math.isnan(one.value) else one.value == pytest.approx(own, abs=SAME_OVER_WEIGHT)


def test_every_peer_has_a_row_on_every_scene_that_says_how_it_went_or_why_not(record) -> None:
    rows, runs = record
    solvers = (*peers_limit.SOLVERS, *peers_equilibrium.METHODS)
    assert {(row.scene, row.solver) for row in rows} == {(scene, name) for scene in SCENES for name in solvers}
    assert {(run.scene, run.method) for run in runs} == {
        (s, m) for s in peers_dynamics.DYNAMIC for m in ("limit analysis", "YADE", "LMGC90")
    }
    assert all(row.processor or row.note for row in rows)
    assert all(run.processor > 0.0 or run.note for run in runs)


def test_solved_in_the_record_means_certified_and_certified_reactions_agree(record) -> None:
    rows, _ = record
    assert all((row.residual <= ACCEPTED) == (row.status == SOLVED) for row in rows)
    assert all(row.status == SOLVED for row in rows if row.solver == OURS)
    for scene in SCENES:
        found = [row.value for row in rows if (row.scene, row.status, row.posed) == (scene, SOLVED, LEAST_REACTION)]
        assert np.ptp(found) <= SAME_OVER_WEIGHT


def test_a_ratio_lies_between_what_the_repeats_allow(record) -> None:
    rows, _ = record
    timed = [row for row in rows if row.beside]
    assert all(min(row.processor) / max(row.beside) <= row.ratio <= max(row.processor) / min(row.beside) for row in timed)
    assert all(row.status == CANNOT or row.note for row in rows if not row.beside)


def test_the_page_is_what_the_record_says() -> None:
    assert stored_page(PAGE) == PAGE.read_text(encoding="utf-8")


def test_a_row_comes_back_from_its_record_whole(record) -> None:
    rows, runs = record
    assert all(repr(restored(type(row), json.loads(json.dumps(as_record(row))))) == repr(row) for row in (*rows, *runs))
