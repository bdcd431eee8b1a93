"""The time goes into the solver: what surrounds it costs at most a tenth. Ratios measured side by side in one process."""

import time

import numpy as np
import pytest
import scenes

from la_core.analysis.stage import analyse
from la_core.geometry import Blocks, shapes
from la_core.geometry.interfaces import find_interfaces
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

LARGEST_SHARE = 0.1  # of all time, for contacts, assembly, scaling, residuals and all else
SAME_REACTION = 1e-6  # both models are exact; each is solved to residuals below this
LEAST_GAIN = 3.0  # of a plane model's speed over a 3D one's, 6 on a quiet machine
ATTEMPTS = 4  # the least of several, because other work on the machine only ever adds time


def between_linear_and_quadratic(growth: float) -> float:
    """Geometric mean of linear and quadratic growth: what other work on the machine does not blur."""
    return growth**1.5


def wall_of_a_thousand(plane: bool) -> Scene:
    return scenes.build(*scenes.wall(32, 31, split=8.4), inset=0.001, plane=plane)


def wall_of_two_thousand() -> Scene:
    return scenes.build(*scenes.wall(46, 45, split=12.0), inset=0.001)


@pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
def test_all_but_the_solver_takes_a_tenth_of_the_time(plane) -> None:
    shares = []
    for _ in range(ATTEMPTS if plane else 1):
        start = time.perf_counter()
        # In the plane a solve of a thousand blocks takes a third of a second, which the loading of the scene nears.
        scene = wall_of_two_thousand() if plane else wall_of_a_thousand(plane)
        analysis = analyse(scene)
        total = time.perf_counter() - start
        solutions = [*analysis.bounds.values(), *analysis.sharp.bounds.values()]
        assert len(scene.blocks) > 1000 and {s.status for s in solutions} == {Status.SOLVED}
        solver = sum(s.seconds for s in solutions)
        shares.append((total - solver) / total)
    assert min(shares) < LARGEST_SHARE, shares


def test_a_plane_model_is_several_times_cheaper_and_gives_the_same_reaction() -> None:
    plane, solid = (solve_associated(assemble(wall_of_a_thousand(flat)), Drive.YIELDING) for flat in (True, False))
    assert solid.value == pytest.approx(plane.value, rel=SAME_REACTION)
    assert solid.seconds > LEAST_GAIN * plane.seconds


def test_finding_contacts_grows_in_proportion_to_the_wall() -> None:
    """Four times the blocks: comparing all pairs would take sixteen times the time, not four."""

    def seconds(per_course: int, courses: int) -> float:
        scene = scenes.build(*scenes.wall(per_course, courses, split=2.0))
        times = []
        for _ in range(ATTEMPTS):
            start = time.perf_counter()
            assemble(scene)
            times.append(time.perf_counter() - start)
        return min(times)

    assert seconds(64, 64) < between_linear_and_quadratic(4.0) * seconds(32, 32)


def test_finding_contacts_in_a_massive_block_of_masonry_grows_as_its_volume() -> None:
    """Eight times the blocks, piled in all three directions: comparing all pairs would take 64 times the time, not eight."""

    def seconds(count: int) -> float:
        place = np.stack(np.meshgrid(*[np.arange(float(count))] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        boxes = [shapes.box(low, low + 1.0) for low in place]
        blocks = Blocks.gather([str(k) for k in range(len(boxes))], ["free"] * len(boxes), [1.0] * len(boxes), boxes)
        times = []
        for _ in range(ATTEMPTS):
            start = time.perf_counter()
            interfaces = find_interfaces(blocks)
            times.append(time.perf_counter() - start)
        assert len(interfaces) == 3 * count**2 * (count - 1)
        return min(times)

    assert seconds(16) < between_linear_and_quadratic(8.0) * seconds(8)
