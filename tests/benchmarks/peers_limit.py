"""The same limit analysis by solvers that a user might choose instead of ours: the same rows, cones, offset and power for all.

All solvers except HiGHS get the kinematic form of `la_core.limit.DrivenProblem`, as clarabel does. HiGHS gets the static form, which
`la_core.limit.linearised` found no slower. The time is that of the conversion to the solver's format, its set-up and its solve.
"""

import importlib
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import Any
from unittest.mock import patch

import numpy as np
import peers_equilibrium
from peers_scenes import SCENES
from peers_table import CANNOT, EQUILIBRIUM, FAILED, INACCURATE, LEAST_REACTION, OURS, SOLVED, Row
from scipy import optimize, sparse

from la_core.limit import associated, linearised
from la_core.limit.associated import Solution, solution_of
from la_core.limit.conic import ProgrammeAnswer, ProgrammeOutcome
from la_core.limit.problem import ACCEPTED, Drive, DrivenProblem, driven_problem, scaled_problem
from la_core.measures import residuals
from la_core.model.assembly import Assembly, assemble

TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)  # tried in turn until the recomputed residuals are small enough
PATIENCE = 2  # tolerances in a row without a smaller residual, after which no further tolerance is tried
MOST_ITERATIONS = 1_000
MOST_STEPS = 10_000_000  # of a first-order method, which the time limit ends first
LARGE = 500  # blocks; of larger structures HiGHS gets the coarsest polygon alone
REPEATS = ((0.1, 9), (0.5, 5), (3.0, 2))  # (seconds, repeats): repeats of a solve of fewer seconds; a slower solve runs once
HIGHS = {"HiGHS interior point": "highs-ipm", "HiGHS dual simplex": "highs-ds"}

Raw = tuple[np.ndarray, np.ndarray, int]  # x, multipliers of the rows, iterations


@dataclass(frozen=True)
class Attempt:
    """One solve: its certified solution, its processor seconds and wall seconds."""

    solution: Solution
    processor: float
    clock: float

    @property
    def residual(self) -> float:
        """Largest recomputed residual; infinite where there is no answer."""
        one = self.solution
        worst = max(one.equilibrium_residual, one.cone_violation, one.mechanism_violation, one.duality_gap)
        return worst if math.isfinite(worst) else math.inf


def ecos(driven: DrivenProblem, tolerance: float) -> Raw:
    package = importlib.import_module("ecos")
    sizes = {"l": driven.cones.inequalities, "q": [3] * driven.cones.second_order}
    tolerances = {"feastol": tolerance, "abstol": tolerance, "reltol": np.finfo(float).eps}
    rows = (-driven.rows).tocsc()
    answer = package.solve(-driven.power, rows, driven.offset, sizes, verbose=False, max_iters=MOST_ITERATIONS, **tolerances)
    return answer["x"], answer["z"], answer["info"]["iter"]


def scs(driven: DrivenProblem, tolerance: float) -> Raw:
    package = importlib.import_module("scs")
    sizes = {"l": driven.cones.inequalities, "q": [3] * driven.cones.second_order}
    data = {"A": (-driven.rows).tocsc(), "b": driven.offset, "c": -driven.power}
    answer = package.SCS(data, sizes, verbose=False, eps_abs=tolerance, eps_rel=0.0, max_iters=MOST_STEPS).solve()
    return answer["x"], answer["y"], answer["info"]["iter"]


def qoco(driven: DrivenProblem, tolerance: float) -> Raw:
    programme = importlib.import_module("qoco").QOCO()
    cones, (count, size) = driven.cones, driven.rows.shape
    programme.setup(
        size, count, 0, None, -driven.power, None, None, (-driven.rows).tocsc(), driven.offset,
        cones.inequalities, cones.second_order, [3] * cones.second_order,
        abstol=tolerance, reltol=np.finfo(float).eps, max_iters=MOST_ITERATIONS,
    )  # fmt: skip
    answer = programme.solve()
    return np.array(answer.x), np.array(answer.z), answer.iters


def piqp(driven: DrivenProblem, tolerance: float) -> Raw:
    programme, size = importlib.import_module("piqp").SparseSolver(), len(driven.power)
    programme.settings.eps_abs = programme.settings.eps_duality_gap_abs = tolerance
    programme.settings.eps_rel = programme.settings.eps_duality_gap_rel = 0.0
    programme.settings.max_iter, programme.settings.num_threads = MOST_ITERATIONS, 1
    programme.setup(sparse.csc_matrix((size, size)), -driven.power, G=(-driven.rows).tocsc(), h_u=driven.offset)
    programme.solve()
    return programme.result.x, programme.result.z_u, programme.result.info.iter


FOREIGN: dict[str, Callable[[DrivenProblem, float], Raw]] = {"ECOS": ecos, "SCS": scs, "QOCO": qoco, "PIQP": piqp}
LINEAR_ONLY = ("PIQP",)
SOLVERS = (OURS, *HIGHS, *FOREIGN)


def measure(scene: str, solver: str) -> Iterator[Row]:
    """Yield the row of a solver on a scene, again after each better solve and each repeat. HiGHS has one row for each polygon."""
    assembly = assemble(SCENES[scene]())
    if solver in LINEAR_ONLY and not assembly.effects.plane:
        yield Row(scene, solver, "–", LEAST_REACTION, CANNOT, note="linear and quadratic programmes only")
        return
    if solver in FOREIGN:
        importlib.import_module(solver.lower())  # not timed
    best = math.inf
    for row, solve in _settings(scene, solver, assembly):
        first = solve()
        if first.residual < best or solver in HIGHS:
            best, since = first.residual, 0
            status = SOLVED if best <= ACCEPTED else INACCURATE if math.isfinite(best) else FAILED
            found = replace(row, status=status, value=first.solution.value / assembly.weight, residual=first.residual)
            kept, again = replace(found, processor=(first.processor,), clock=(first.clock,)), solve
            yield kept
        else:
            since += 1
        if solver in HIGHS:
            yield from repeated(kept, lambda again=again: _seconds(again()), assembly)
        elif best <= ACCEPTED or since == PATIENCE:
            break
    if solver not in HIGHS:
        yield from repeated(kept, lambda: _seconds(again()), assembly)


def measure_equilibrium(scene: str, solver: str) -> Iterator[Row]:
    """Yield the row of a method of compas_cra on a scene, again after each repeat."""
    assembly = assemble(SCENES[scene]())
    for package in ("compas_cra", "compas_cra.equilibrium"):
        importlib.import_module(package)
    believes, words, forces, processor, clock = peers_equilibrium.equilibrium(assembly, solver)
    residual = peers_equilibrium.residual(assembly, forces)
    status = SOLVED if residual <= ACCEPTED else INACCURATE
    value = residuals.reaction(assembly, forces) / assembly.weight
    note = "" if believes else f"IPOPT: {words}"
    row = Row(scene, solver, "its own", EQUILIBRIUM, status, value, residual, (processor,), clock=(clock,), note=note)
    yield row
    yield from repeated(row, lambda: peers_equilibrium.equilibrium(assembly, solver)[3:], assembly)


def repeated(row: Row, again: Callable[[], tuple[float, float]], assembly: Assembly) -> Iterator[Row]:
    """Yield the row after each repeat. Our own solve follows every repeat. Where there are several, the first solve only warms up."""
    count = next((count for seconds, count in REPEATS if row.processor[0] < seconds), 1)
    processor, beside, clock = [], [], []
    for _ in range(count):
        spent = (row.processor[0], row.clock[0]) if count == 1 else again()
        processor.append(spent[0])
        clock.append(spent[1])
        beside.append(ours(assembly).processor)
        yield replace(row, processor=tuple(processor), beside=tuple(beside), clock=tuple(clock))


def ours(assembly: Assembly) -> Attempt:
    """Solve by our own solver. The seconds include all its attempts."""
    with timed(associated, "maximise") as spent:
        solution = associated.solve_associated(assembly, Drive.YIELDING)
    return Attempt(solution, *spent)


def highs(assembly: Assembly, solver: str, facets: int) -> Attempt:
    """Solve by HiGHS with pyramids inscribed in the cones. In the plane two lines are the exact cone for any number of facets."""
    with timed(optimize, "linprog") as spent:
        solution = linearised.solve_linearised(assembly, Drive.YIELDING, facets, True, HIGHS[solver])
    return Attempt(solution, *spent)


def foreign(assembly: Assembly, solver: str, tolerance: float) -> Attempt:
    """Solve by another solver, and certify the answer as ours is certified."""
    problem = scaled_problem(assembly)
    driven = driven_problem(assembly, problem, Drive.YIELDING)
    if driven.cones.equalities:
        raise ValueError("cones with equalities (joints that cannot slide) are not posed to other solvers")
    processor, clock = time.process_time(), time.perf_counter()
    x, multipliers, iterations = FOREIGN[solver](driven, tolerance)
    processor, clock = time.process_time() - processor, time.perf_counter() - clock
    answer = ProgrammeAnswer(ProgrammeOutcome.OPTIMUM, np.asarray(x), np.asarray(multipliers), int(iterations), clock)
    return Attempt(solution_of(assembly, problem, Drive.YIELDING, driven, answer), processor, clock)


@contextmanager
def timed(owner: Any, name: str) -> Iterator[list[float]]:
    """Measure the processor and wall seconds in the function of this name in a module."""
    spent, real = [0.0, 0.0], getattr(owner, name)

    def function(*arguments: object, **options: object) -> object:
        processor, clock = time.process_time(), time.perf_counter()
        answer = real(*arguments, **options)
        spent[0] += time.process_time() - processor
        spent[1] += time.perf_counter() - clock
        return answer

    with patch.object(owner, name, function):
        yield spent


def _settings(scene: str, solver: str, assembly: Assembly) -> Iterator[tuple[Row, Callable[[], Attempt]]]:
    """Yield the settings of a solver in turn, each with the call that solves."""
    blank = Row(scene, solver, "its own", LEAST_REACTION, FAILED)
    if solver == OURS:
        yield blank, lambda: ours(assembly)
    elif solver in HIGHS:
        facets = (4,) if assembly.effects.plane else (8,) if len(assembly.blocks) > LARGE else (8, 32)
        for count in facets:
            setting = f"{linearised.TOLERANCE:.0e}" + ("" if assembly.effects.plane else f", {count} facets")
            yield replace(blank, setting=setting), lambda count=count: highs(assembly, solver, count)
    else:
        for tolerance in TOLERANCES:
            yield replace(blank, setting=f"{tolerance:.0e}"), lambda tolerance=tolerance: foreign(assembly, solver, tolerance)


def _seconds(attempt: Attempt) -> tuple[float, float]:
    return attempt.processor, attempt.clock
