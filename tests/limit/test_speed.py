"""The code around the solver is cheap. Work is counted, not timed, so that a busy machine changes nothing.

The number of numpy calls does not depend on the number of blocks, and memory is proportional to it; so is the time. The benchmarks
(benchmark_scale.py, benchmark_growth.py) measure seconds, and the pages of the gallery state the solver's share of them.
"""

import gc
import sys
import tracemalloc
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scenes
from scipy.sparse import identity
from scipy.sparse.linalg import splu

from la_core.analysis.stage import analyse
from la_core.geometry import shapes
from la_core.geometry.blocks import Blocks
from la_core.geometry.interfaces import find_interfaces
from la_core.limit import symmetric_part
from la_core.limit.associated import Drive, Solution, Status, solve_associated
from la_core.limit.conic import Programme
from la_core.limit.problem import driven_problem, scaled_problem
from la_core.model import joints
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

CALLS_A_BLOCK = 25  # of Python and C, for four solutions; one loop over the contact points, ten a block and more, takes as many
SOLVES = 4  # two drives, rounded and sharp
SAME_REACTION = 1e-6  # both models are exact; each is solved to residuals below this
LEAST_GAIN = 3.0  # operations of a 3D model over those of the plane model
LINEAR = 1.1  # allowed growth over that of the number of blocks


def calls(work: Callable[[], object]) -> int:
    """Calls of Python's and of C's functions that some work makes."""
    count = 0

    def hear(frame: object, event: str, argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    before = sys.getprofile()
    gc.collect()
    gc.disable()  # the garbage collector may call libraries at any time
    sys.setprofile(hear)
    try:
        work()
    finally:
        sys.setprofile(before)
        gc.enable()
    return count


def peak(work: Callable[[], object]) -> int:
    """Most bytes that Python and numpy hold at once during some work."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def wall_of(per_course: int, courses: int, plane: bool = True) -> Scene:
    return scenes.build(*scenes.wall(per_course, courses, split=0.25 * per_course + 0.4), inset=0.001, plane=plane)


@pytest.mark.slow_after_first
@pytest.mark.parametrize(("plane", "sizes"), [(True, (8, 32)), (False, (8, 16))], ids=["plane", "3D"])
def test_what_surrounds_the_solver_takes_few_calls_a_block(plane: bool, sizes: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    """The solver is also called only once for each answer."""
    solves = 0
    ask = Programme.solve

    def counted(*arguments, **options):
        nonlocal solves
        solves += 1
        return ask(*arguments, **options)

    def unheard(*arguments, **options):  # its iterations follow the slowest sway, not the number of blocks
        hear = sys.getprofile()
        sys.setprofile(None)
        try:
            return solver(*arguments, **options)
        finally:
            sys.setprofile(hear)

    monkeypatch.setattr(symmetric_part, "LEAST_UNKNOWNS", 0)  # both sizes are searched for symmetry
    solver = joints.cg
    monkeypatch.setattr(joints, "cg", unheard)
    monkeypatch.setattr(Programme, "solve", counted)
    counts, blocks = [], []
    for size in sizes:
        scene = wall_of(size, size, plane)
        analyses = []
        counts.append(calls(lambda scene=scene, analyses=analyses: analyses.append(analyse(scene))))
        blocks.append(len(scene.blocks))
        assert {s.status for s in (*analyses[0].bounds.values(), *analyses[0].sharp.bounds.values())} == {Status.SOLVED}
    assert solves == len(sizes) * SOLVES
    assert np.diff(counts)[0] < CALLS_A_BLOCK * np.diff(blocks)[0]


def operations(assembly: Assembly, solution: Solution) -> float:
    """Operations of all factorisations for an answer: the sum of squared column lengths of the factor, times the iterations."""
    rows = driven_problem(assembly, scaled_problem(assembly), Drive.YIELDING).rows
    columns = np.diff(splu((rows.T @ rows + identity(rows.shape[1])).tocsc(), permc_spec="MMD_AT_PLUS_A").L.indptr)
    return solution.iterations * float(np.sum(columns.astype(float) ** 2))


@pytest.mark.slow
def test_a_plane_model_is_several_times_cheaper_and_gives_the_same_reaction(monkeypatch: pytest.MonkeyPatch) -> None:
    """The 3D model is solved whole, without use of its symmetry about the middle plane of the wall."""
    monkeypatch.setattr(symmetric_part, "LEAST_UNKNOWNS", np.inf)
    plane, solid = (assemble(wall_of(32, 31, flat)) for flat in (True, False))
    assert len(plane.blocks) > 1000
    flat, deep = solve_associated(plane, Drive.YIELDING), solve_associated(solid, Drive.YIELDING)
    assert deep.value == pytest.approx(flat.value, rel=SAME_REACTION)
    assert operations(solid, deep) > LEAST_GAIN * operations(plane, flat)


def pile_of(count: int) -> Blocks:
    place = np.stack(np.meshgrid(*[np.arange(float(count))] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    boxes = [shapes.box(low, low + 1.0) for low in place]
    return Blocks.gather([str(k) for k in range(len(boxes))], ["free"] * len(boxes), [1.0] * len(boxes), boxes)


def unsearched(blocks: Blocks) -> Blocks:
    """A copy of the blocks, whose touching faces are not stored yet."""
    return replace(blocks)


@pytest.mark.slow
def test_finding_contacts_grows_in_proportion_to_the_wall() -> None:
    """There are four times the blocks. To compare all pairs would take sixteen times the memory, or four times the calls."""
    small, large = (wall_of(size, size) for size in (32, 64))

    def assembled(scene: Scene) -> None:
        assemble(replace(scene, blocks=unsearched(scene.blocks)))

    assert calls(lambda: assembled(large)) == calls(lambda: assembled(small))
    growth = len(large.blocks) / len(small.blocks)
    assert peak(lambda: assembled(large)) < LINEAR * growth * peak(lambda: assembled(small))


@pytest.mark.slow
def test_finding_contacts_in_a_massive_block_of_masonry_grows_as_its_joints() -> None:
    """There are eight times the blocks, piled in three directions. To compare all pairs would take 64 times the memory, not about nine."""

    def joints(count: int) -> int:
        return 3 * count**2 * (count - 1)

    small, large = (pile_of(count) for count in (8, 16))
    for count, blocks in ((8, small), (16, large)):
        assert len(find_interfaces(blocks)) == joints(count)
    assert calls(lambda: find_interfaces(unsearched(large))) == calls(lambda: find_interfaces(unsearched(small)))
    growth = LINEAR * joints(16) / joints(8)
    assert peak(lambda: find_interfaces(unsearched(large))) < growth * peak(lambda: find_interfaces(unsearched(small)))
