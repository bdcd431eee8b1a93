"""A settlement followed in time: YADE and LMGC90 on the same blocks, friction and support motion, compared with our prediction.

LMGC90 (contact dynamics: rigid blocks, implicit steps, non-smooth contact) is driven through `compas_lmgc90`, which passes on blocks,
one contact law, imposed velocities, poses and contact forces. LMGC90 finds its own contact points, four sharp corners of each interface;
it has no inset and no plane model. The tolerance of its Gauss-Seidel solver is compiled in (1.666e-4 of the quadratic norm). Its steps
have only their numerical damping.
Each reaction is the value at zero settlement of a line fitted to the plateau: the reaction of a structure that has not moved yet.
Seconds are for the whole run from the scene to the reaction, YADE's start included.
"""

import importlib
import math
import resource
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from peers_scenes import SCENES

from comparison.studies.cost_limit_analysis import coulomb, shared_inset
from comparison.studies.cost_yade import run_once
from comparison.yade.installation import find_yade
from comparison.yade.run_record import read_run
from la_core.coulomb import PredictionSettings
from la_core.exchange.fields import SUPPORT
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

DYNAMIC = ("arch_spreading", "wall_third")
SPEED, TRAVEL = 0.002, 0.35e-3  # m/s, m; at about this travel YADE finds its plateau steady and stops
REST, RAMP = 0.05, 0.02  # s: time at rest under gravity, then time until the support has its speed
DROPPED = 0.3  # share of the travel that the fit leaves out at its start
STEPS = (2e-3, 1e-3, 5e-4)  # s, time steps of LMGC90
ALERT = 1e-3  # m, gap up to which LMGC90 searches contacts; smaller than any gap between blocks without a joint


@dataclass(frozen=True)
class Run:
    """One run. reaction, scatter: over the weight; asked, achieved: settlement, m; steps: number of time steps; processor, clock: s.

    predicted: our Coulomb prediction over the weight, on the same contact points: with the inset for YADE, sharp for LMGC90.
    """

    scene: str
    method: str
    setting: str
    status: str
    reaction: float = math.nan
    scatter: float = math.nan
    predicted: float = math.nan
    asked: float = math.nan
    achieved: float = math.nan
    steps: int = 0
    processor: float = math.nan
    clock: float = math.nan
    note: str = ""


def predict(name: str) -> Iterator[Run]:
    """Yield our prediction on both sets of contact points."""
    scene = SCENES[name]()
    for setting, inset in (("inset", shared_inset(scene)), ("sharp", 0.0)):
        coulomb(scene, inset, PredictionSettings())  # to warm up
        spent = _stopwatch()
        outcome = coulomb(scene, inset, PredictionSettings())
        value = outcome.value / scene.weight
        yield Run(name, "limit analysis", setting, outcome.status, value, predicted=value, **spent())


def yade(name: str) -> Iterator[Run]:
    """Run YADE as the program does, with the settings that it derives."""
    scene, found = SCENES[name](), find_yade()
    with tempfile.TemporaryDirectory() as folder:
        spent = _stopwatch()
        outcome, _ = run_once(scene, shared_inset(scene), scene.yade, found, Path(folder), lambda report: None)
        seconds = spent()
        run = read_run(Path(folder) / "run.h5", assemble(scene))
    weight = scene.weight
    yield Run(
        name, "YADE", "derived settings", outcome.status, outcome.value / weight, run.scatter() * outcome.value / weight,
        coulomb(scene, shared_inset(scene), PredictionSettings()).value / weight, run.result.asked_settlement, run.result.settlement,
        int(run.result.steps), **seconds,
    )  # fmt: skip


def lmgc90(name: str, step: float) -> Iterator[Run]:
    """Run LMGC90 with one time step, s."""
    package = importlib.import_module("compas_lmgc90._lmgc90")
    scene = SCENES[name]()
    spent = _stopwatch()
    assembly = assemble(scene)
    solver = package.LMGC90Solver()
    _set_up(solver, scene, assembly, step)
    settlement, reaction = _follow(solver, assembly, step)
    fit = settlement > DROPPED * settlement[-1]
    slope, value = np.polyfit(settlement[fit], reaction[fit], 1).tolist()
    scatter = float(np.std(reaction[fit] - value - slope * settlement[fit]))
    seconds = spent()
    predicted = coulomb(scene, 0.0, PredictionSettings()).value
    asked = SPEED * (len(settlement) * step - REST - RAMP / 2.0)
    yield Run(
        name, "LMGC90", words(step), "plateau", value / scene.weight, scatter / scene.weight, predicted / scene.weight,
        asked, float(settlement[-1]), len(settlement), **seconds,
    )  # fmt: skip


def words(step: float) -> str:
    """Return a time step of LMGC90, s, in words."""
    return f"step {1e3 * step:g} ms"


def _set_up(solver: object, scene: Scene, assembly: Assembly, step: float) -> None:
    """Pass material, friction, blocks and the motion of held blocks to the solver."""
    blocks = assembly.blocks
    solver.initialize(step, 0.5, False)
    densities = np.unique(blocks.density[blocks.free])
    solver.add_one_tact_behav("iqsc0", "IQS_CLB", [scene.friction])
    solver.set_materials(densities.tolist())
    solver.set_see_tables(ALERT)
    solver.set_nb_bodies(len(blocks))
    for k in range(len(blocks)):
        start, stop = blocks.vertex_start[k : k + 2]
        loops = [blocks.face_vertex[slice(*blocks.face_start[f : f + 2])] - start + 1 for f in np.flatnonzero(blocks.face_block == k)]
        triangles = [int(corner) for loop in loops for i in range(1, len(loop) - 1) for corner in (loop[0], loop[i], loop[i + 1])]
        place = np.searchsorted(densities, blocks.density[k]) if blocks.free[k] else 0
        corners = (blocks.vertices[start:stop] - blocks.centroid[k]).ravel().tolist()
        held = 0 if blocks.free[k] else 6
        solver.set_one_polyr(f"s{place + 1:04d}", blocks.centroid[k].tolist(), triangles, corners, held, 0)
        for freedom in range(held):
            speed = float(assembly.support_twist[k, freedom]) * SPEED
            evolution = [0.0, REST, REST + RAMP, 1e3, 0.0, 0.0, speed, speed]  # times, then velocities
            solver.set_drvdof(k + 1, freedom + 1, evolution if speed else [0.0] * 6, True, bool(speed))
    solver.close_before_computing()


def _follow(solver: object, assembly: Assembly, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Return settlement (T,) and reaction (T,), in m and N, along the support's unit motion at every step."""
    support = np.flatnonzero(assembly.blocks.role == SUPPORT)
    direction = assembly.support_twist[support[0], :3]
    start = np.array(solver.get_initial_state().bodies)[support[0]]
    record = []
    for _ in range(round((REST + RAMP / 2.0 + TRAVEL / SPEED) / step)):
        state = solver.compute_one_step()
        forces = np.array(state.interaction_force_global).reshape(-1, 3)  # on the first block of each pair
        first, second = np.array(state.interaction_bodies).reshape(-1, 2).T - 1
        on_support = forces[np.isin(first, support)].sum(axis=0) - forces[np.isin(second, support)].sum(axis=0)
        record.append(((np.array(state.bodies)[support[0]] - start) @ direction, on_support @ direction))
    settlement, reaction = np.array(record).T
    return settlement, reaction


def _stopwatch() -> Callable[[], dict[str, float]]:
    """Return a function that gives the processor seconds since now, with those of ended child processes, and the wall seconds."""

    def used() -> float:
        own, others = resource.getrusage(resource.RUSAGE_SELF), resource.getrusage(resource.RUSAGE_CHILDREN)
        return own.ru_utime + own.ru_stime + others.ru_utime + others.ru_stime

    processor, clock = used(), time.perf_counter()
    return lambda: {"processor": used() - processor, "clock": time.perf_counter() - clock}
