"""A symmetric structure is solved by a part of its problem, and the answer is that of the whole."""

from collections.abc import Iterator
from dataclasses import replace
from unittest.mock import patch

import numpy as np
import pytest
import scenes
from hypothesis import given
from loaded_scenes import friction
from random_scenes import random_scenes

from la_core.limit import associated, symmetric_part
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.conic import maximise, optimum
from la_core.limit.problem import Drive, driven_problem, scaled_problem
from la_core.model import Assembly, assemble, images
from la_core.scene import Scene

SAME_VALUE = 1e-6  # of the weight: each answer is solved to residuals below this
DRIVES = (Drive.YIELDING, Drive.PUSHING)


@pytest.fixture(autouse=True)
def small_structures_count() -> Iterator[None]:
    with patch.object(symmetric_part, "LEAST_UNKNOWNS", 0):
        yield


def middle(per_course: int = 9, courses: int = 6, plane: bool = True, depth: float = 0.3, **options: object) -> Scene:
    """A wall whose middle third settles, or that carries a live load."""
    wall, _ = scenes.wall(per_course, courses, None, (0.4, depth, 0.2))
    ends = np.linspace(0.0, 0.4 * per_course, 4)
    roles = ("fixed", "fixed" if "live" in options else "support", "fixed")
    footing = [scenes.box(f"footing {k}", (ends[k], 0.0, -0.2), (ends[k + 1], depth, 0.0), role) for k, role in enumerate(roles)]
    return scenes.build(wall, *footing, plane=plane, **options)


def table_of_stones() -> Scene:
    """A slab on four columns that settle, and on a pier in the middle that does not. No stone of a column is its own mirror image."""
    columns = [(x, y, k) for x in (0.0, 1.6) for y in (0.0, 1.0) for k in range(5)]
    stones = [scenes.box(f"stone {n}", (x, y, 0.2 * k), (x + 0.4, y + 0.4, 0.2 * (k + 1))) for n, (x, y, k) in enumerate(columns)]
    pads = [scenes.box(f"pad {n}", (x, y, -0.2), (x + 0.4, y + 0.4, 0.0), "support") for n, (x, y, k) in enumerate(columns) if k == 0]
    middle = [scenes.box("pier", (0.8, 0.5, 0.0), (1.2, 0.9, 1.0)), scenes.box("rock", (0.8, 0.5, -0.2), (1.2, 0.9, 0.0), "fixed")]
    return scenes.build(*stones, scenes.box("slab", (0.0, 0.0, 1.0), (2.0, 1.4, 1.2)), *pads, *middle, plane=False, inset=0.001)


def turned(scene: Scene, angle: float, plane: bool | str = False) -> Scene:
    """The scene turned about the vertical, moved, and with its blocks in another order."""
    order = np.random.default_rng(1).permutation(len(scene.blocks))
    return scenes.moved(scene, scenes.rotation((0.0, 0.0, 1.0), angle), (3.0, -7.0, 2.0), 1.7, order=order, plane=plane)


def posed(assembly: Assembly, drive: Drive) -> tuple[float, float]:
    """Unknowns and rows of the whole problem over those given to the solver, which is called once."""
    with patch.object(associated, "maximise", wraps=maximise) as solver:
        solution = solve_associated(assembly, drive)
    if solution.status is Status.SOLVED:
        assert solver.call_count == 1
    power, rows, *_ = solver.call_args_list[0].args
    problem = scaled_problem(assembly)
    return len(problem.power) / len(power), problem.rows.shape[0] / rows.shape[0]


def both(assembly: Assembly, drive: Drive) -> tuple[Solution, Solution]:
    """Answer by the symmetric part, and by the whole."""
    with patch.object(associated, "symmetric_part", return_value=None):
        whole = solve_associated(assembly, drive)
    return solve_associated(assembly, drive), whole


SYMMETRIC = {  # by name: the scene, and about how many times fewer unknowns and rows its part has
    "middle third": (middle, 2),
    "middle third, sharp, joints in the mirror": (lambda: middle(8, 5, inset=0.0), 2),
    "in space": (lambda: middle(plane=False, inset=0.001), 4),
    "turned in space": (lambda: turned(middle(plane=False, inset=0.001), 0.4), 4),
    "plane, all turned with its gravity": (lambda: scenes.moved(middle(inset=0.001), scenes.rotation((0.0, 1.0, 0.0), 0.3)), 2),
    "end settles, in space": (lambda: scenes.build(*scenes.wall(8, 6, 2.2), plane=False, inset=0.001), 2),
    "four columns, turned in space": (lambda: turned(table_of_stones(), 0.4), 4),
    "oblique settlement": (lambda: middle(plane=False, settlement=(0.3, 0.0, -1.0)), 2),
    "oblique settlement across": (lambda: middle(plane=False, settlement=(0.0, 0.3, -1.0)), 2),
    "live load along the wall": (lambda: middle(plane=False, settlement=None, live=(1.0, 0.0, 0.0)), 2),
    "live load across": (lambda: middle(plane=False, settlement=None, live=(0.0, 1.0, 0.0)), 2),
    "without friction": (lambda: middle(4, 3, plane=False, friction=0.0, inset=0.01), 4),
}


@pytest.mark.parametrize("name", SYMMETRIC)
def test_the_part_is_smaller_and_its_answer_is_that_of_the_whole(name: str) -> None:
    build, times = SYMMETRIC[name]
    assembly = assemble(build())
    for drive in (Drive.LIVE,) if assembly.has_live_load else DRIVES:
        assert posed(assembly, drive) == pytest.approx((times, times), rel=0.1)
        part, whole = both(assembly, drive)
        assert part.status is whole.status
        if whole.status is Status.SOLVED:
            unit = 1.0 if drive is Drive.LIVE else assembly.weight
            assert part.value == pytest.approx(whole.value, abs=SAME_VALUE * unit)


def test_forces_and_mechanism_are_their_own_mirror_image() -> None:
    assembly = assemble(middle(inset=0.001))
    _, (_, mirror) = images(assembly)
    free = assembly.blocks.free
    for drive in DRIVES:
        solution = solve_associated(assembly, drive)
        swapped = mirror.swap[:, None] * (solution.forces[mirror.point] @ mirror.matrix)
        assert swapped == pytest.approx(solution.forces, abs=1e-9 * assembly.weight)
        velocity = solution.twists[free, :3]
        assert velocity[mirror.block] @ mirror.matrix == pytest.approx(velocity, abs=1e-9 * np.abs(velocity).max())


NOT_SYMMETRIC = {
    "one block heavier": lambda: one_heavier(middle()),
    "support off the middle": lambda: scenes.build(*scenes.wall(9, 6, 2.2)),
    "oblique settlement": lambda: middle(settlement=(0.3, 0.0, -1.0)),
    "live load along the wall": lambda: middle(settlement=None, live=(1.0, 0.0, 0.0)),
    "one joint of another friction": lambda: scenes.build(*_two_columns(0.0), friction(between=["column 0", "base"], friction=0.5)),
    "sliding excluded": lambda: middle(model="none-slides"),
    "one block a hair to the side": lambda: scenes.build(*_two_columns(1e-6)),
    "beams that cross": lambda: scenes.build(*scenes.crossing_beams(), plane=False),
}


def one_heavier(scene: Scene) -> Scene:
    """The scene with one heavier block off its middle."""
    density = scene.blocks.density.copy()
    density[np.flatnonzero(scene.blocks.role == 0)[0]] *= 1.001
    return replace(scene, blocks=replace(scene.blocks, density=density))


def _two_columns(shift: float) -> list[str]:
    """A slab on two columns on a base that settles; `shift` moves the right one."""
    columns = [scenes.box(f"column {k}", (x, 0.0, 0.0), (x + 0.4, 1.0, 1.0)) for k, x in enumerate((0.0, 1.6 + shift))]
    base = scenes.box("base", (-0.1, 0.0, -0.2), (2.1, 1.0, 0.0), "support")
    return [*columns, scenes.box("slab", (0.0, 0.0, 1.0), (2.0, 1.0, 1.2)), base]


@pytest.mark.parametrize("name", NOT_SYMMETRIC)
def test_what_is_not_symmetric_is_solved_whole(name: str) -> None:
    assembly = assemble(NOT_SYMMETRIC[name]())
    drive = Drive.LIVE if assembly.has_live_load else Drive.YIELDING
    problem = scaled_problem(assembly)
    assert symmetric_part.symmetric_part(assembly, problem, driven_problem(assembly, problem, drive)) is None


def test_two_columns_are_symmetric_but_for_a_hair() -> None:
    """The scene above with its column shifted back is symmetric, so the shift alone decides."""
    assert [len(images(assemble(scenes.build(*_two_columns(shift))))[1]) for shift in (0.0, 1e-6)] == [2, 1]


def test_a_structure_that_cannot_stand_falls_on_both_sides() -> None:
    """Two slabs lie side by side on a narrow base. The centroid of each lies beyond the base, and neither holds the other."""
    slabs = [scenes.box(f"slab {k}", (x, 0.0, 0.0), (x + 1.0, 1.0, 0.2)) for k, x in enumerate((-1.0, 0.0))]
    scene = scenes.build(*slabs, scenes.box("base", (-0.2, 0.0, -0.2), (0.2, 1.0, 0.0), "support"), friction=0.1)
    assembly = assemble(scene)
    with patch.object(associated, "optimum", wraps=optimum) as certificate:
        part = solve_associated(assembly, Drive.YIELDING)
    assert 2 * len(certificate.call_args.args[0]) == len(scaled_problem(assembly).power)
    _, whole = both(assembly, Drive.YIELDING)
    assert part.status is whole.status is Status.INFEASIBLE
    assert set(part.falling) == set(whole.falling) == {"slab 0", "slab 1"}


def test_both_mirrors_of_a_pier_are_found_in_every_direction() -> None:
    """The block centroids lie on a grid of three by two in plan, so their principal axes are those of the pier."""
    places = [(0.4 * i, 0.3 * j, 0.2 * k) for i in range(3) for j in range(2) for k in range(2)]
    stones = [scenes.box(f"stone {n}", (x, y, z), (x + 0.4, y + 0.3, z + 0.2)) for n, (x, y, z) in enumerate(places)]
    pier = scenes.build(*stones, scenes.box("footing", (0.0, 0.0, -0.2), (1.2, 0.6, 0.0), "support"), plane=False, inset=0.001)
    for angle in (0.0, 0.4, 2.0):
        axes, found = images(assemble(turned(pier, angle)))
        along = abs(axes[:2] @ [np.cos(angle), np.sin(angle), 0.0])
        assert len(found) == 4 and sorted(along) == pytest.approx([0.0, 1.0], abs=1e-6)


def test_a_small_problem_is_not_searched_for_mirrors() -> None:
    with patch.object(symmetric_part, "LEAST_UNKNOWNS", 1000), patch.object(symmetric_part, "images") as search:
        solve_associated(assemble(middle()), Drive.YIELDING)
    assert not search.called


def beside_its_image(scene: Scene, plane: bool) -> Scene:
    """The scene with supports that move down, and its mirror image on the left, separated by a gap."""
    blocks, place = scene.blocks, scene.blocks.vertices.copy()
    place[:, 0] += 0.5 - place[:, 0].min()
    parts = []
    for side, sign in (("right", 1.0), ("left", -1.0)):
        for k, name in enumerate(blocks.names):
            corners = place[blocks.vertex_start[k] : blocks.vertex_start[k + 1]] * (sign, 1.0, 1.0)
            role, density = scenes.ROLE_NAMES[int(blocks.role[k])], float(blocks.density[k])
            parts.append(scenes.block(f"{name} {side}", role, None if np.isnan(density) else density, polyhedron=corners))
    return scenes.build(*parts, friction=scene.friction, inset=scene.inset, plane=plane)


@given(scene=random_scenes(settles=True))
def test_a_random_structure_and_its_image_have_the_answer_of_the_whole(scene: Scene) -> None:
    assembly = assemble(beside_its_image(scene, scene.effects.plane is True))
    problem = scaled_problem(assembly)
    for drive in DRIVES:
        found = symmetric_part.symmetric_part(assembly, problem, driven_problem(assembly, problem, drive))
        assert found is not None
        part, whole = both(assembly, drive)
        assert part.status is whole.status
        if whole.status is Status.SOLVED:
            assert part.value == pytest.approx(whole.value, abs=SAME_VALUE * assembly.weight)
