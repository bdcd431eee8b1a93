"""The six walls of Ferris & Tin-Loi (2001), pushed sideways by a load proportional to weight: the benchmark of friction without dilatancy.

Geometry: the authors' GAMS models (MPECLib, frictionalblock). Associated multipliers: an independent linear programme. Published
Coulomb multipliers: walls 1 and 2. The least ones: an independent programme with complementarity constraints, the lowest
stationary value it found; it searches all states of rigid blocks, friction's history apart, so a state that low exists, but
elastic joints need not reach it.
"""

from functools import cache

import numpy as np
import pytest
import scenes

from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb import CoulombSolution
from la_core.coulomb.equilibrium_path import follow_path
from la_core.limit.associated import Status
from la_core.scene.scene import Scene

LENGTH, HEIGHT, DEPTH = 0.4, 0.175, 0.3  # m, of a whole block
SIX_DIGITS = 1e-6
PUBLISHED = 5e-3  # relative; of published Coulomb values, which know no history
LEAST = 1e-3  # relative, of the least values found

ASSOCIATED = {1: 0.64286, 2: 0.58000, 3: 0.40369, 4: 0.33195, 5: 0.23964, 6: 0.347825}
COULOMB = {1: 0.63982, 2: 0.56260}
LEAST_FOUND = {1: 0.63898, 2: 0.55741, 3: 0.35582, 4: 0.26374, 5: 0.20863}
BLOCKS = {1: 33, 2: 55, 3: 46, 4: 55, 5: 61, 6: 146}

# Courses, bottom first, in lengths of a block; negative is a gap. E even, U uneven; W with windows.
Course = tuple[float, ...]
WIDE: dict[str, Course] = {"E": (0.5, 1, 1, 1, 1, 0.5), "U": (1,) * 5}
KINDS: dict[int, dict[str, Course]] = {
    1: WIDE,
    2: WIDE,
    3: {"E": (1,) * 4, "U": (0.5, 1, 1, 1, 0.5), "WE": (1, 0.5, -1, 0.5, 1), "WU": (0.5, 1, -1, 1, 0.5)},
    4: WIDE | {"WE": (0.5, 0.5, -1, 0.5, 0.5, -1, 0.5, 0.5), "WU": (1, -1, 1, -1, 1)},
    5: {"E": (0.5, 1, 1, 0.5), "U": (1,) * 3, "WE": (0.5, 0.5, -1, 0.5, 0.5), "WU": (1, -1, 1)},
    6: {
        "E": (0.5, 1, 1, 1, 1, 1, 1, 0.5),
        "U": (1,) * 7,
        "WE": (1, 0.5, -1, 0.5, 1, 0.5, -1, 0.5, 1),
        "WU": (0.5, 1, -1, 1, 1, -1, 1, 0.5),
    },
}
WINDOWS = "WU WE WU WE WU"
STACKS = {
    1: "E U E U E U",
    2: "E U E U E U E U E U",
    3: f"E U E {WINDOWS} E U E",
    4: f"E U E {WINDOWS} E U E",
    5: f"E U E {WINDOWS} E U E {WINDOWS} E U E",
    6: f"E U E U {WINDOWS} U E U {WINDOWS} U E U E",
}

every_wall = pytest.mark.parametrize("number", STACKS)


def wall(number: int, plane: bool | str = "auto") -> Scene:
    """One of the six walls on its base, pushed along x."""
    courses = [KINDS[number][kind] for kind in STACKS[number].split()]
    parts = [scenes.box("base", (0.0, 0.0, -0.2), (LENGTH * sum(map(abs, courses[0])), DEPTH, 0.0), "fixed")]
    for row, course in enumerate(courses):
        ends = LENGTH * np.cumsum(np.abs(course))
        for place, (end, length) in enumerate(zip(ends, course, strict=True)):
            if length > 0.0:
                low, high = (end - LENGTH * length, 0.0, HEIGHT * row), (end, DEPTH, HEIGHT * (row + 1))
                parts.append(scenes.box(f"block {row + 1}.{place + 1}", low, high))
    return scenes.build(*parts, friction=0.65, live=(1.0, 0.0, 0.0), plane=plane, model="coulomb")


@cache
def analysed(number: int) -> LimitAnalysis:
    return analyse(wall(number))


def coulomb(analysis: LimitAnalysis) -> CoulombSolution:
    """The Coulomb answer, which must have converged."""
    solution = analysis.sharp.coulomb
    assert solution is not None and solution.status is Status.SOLVED
    return solution


@every_wall
def test_walls_are_those_of_the_authors(number: int) -> None:
    scene = wall(number)
    assert int(scene.blocks.free.sum()) == BLOCKS[number]
    assert len({sum(map(abs, KINDS[number][kind])) for kind in STACKS[number].split()}) == 1


@every_wall
def test_associated_multiplier(number: int) -> None:
    analysis = analysed(number)
    solution = analysis.sharp.bounds[analysis.main]
    last_digit = SIX_DIGITS if number == 6 else 10.0 * SIX_DIGITS
    assert solution.status is Status.SOLVED
    assert solution.value == pytest.approx(ASSOCIATED[number], abs=0.6 * last_digit)


@pytest.mark.parametrize("number", COULOMB)
def test_published_coulomb_multiplier(number: int) -> None:
    assert coulomb(analysed(number)).value == pytest.approx(COULOMB[number], rel=PUBLISHED)


@every_wall
def test_coulomb_lies_between_the_least_found_and_the_associated_multiplier(number: int) -> None:
    analysis = analysed(number)
    value = coulomb(analysis).value
    low, high = coulomb(analysis).interval
    assert low * (1.0 - LEAST) <= value <= high * (1.0 + LEAST)
    assert value <= analysis.sharp.bounds[analysis.main].value * (1.0 + LEAST)
    if number in LEAST_FOUND:
        assert value >= LEAST_FOUND[number] * (1.0 - LEAST)


@pytest.mark.parametrize(("number", "apart"), [(1, 1e-4), (2, 1e-2), (3, 1e-2), (4, 1e-4), (5, 1e-4)])
def test_interval_of_the_mechanism_begins_at_the_least_multiplier(number: int, apart: float) -> None:
    """Two programmes find the same; in wall 2 theirs is lower by 0.6 %, in another mechanism; wall 3 has a second one at +0.5 %."""
    assert coulomb(analysed(number)).interval[0] == pytest.approx(LEAST_FOUND[number], rel=apart)


@pytest.mark.parametrize(("number", "history"), [(1, 0.005), (2, 0.005), (3, 0.02), (4, 0.005), (5, 0.005), (6, 0.005)])
def test_four_steps_find_the_plateau_of_the_fine_path(number: int, history: float) -> None:
    """In wall 3 a few long steps lead to a second plateau, 1.4 % above that of the path, which ends at the least multiplier found."""
    analysis = analysed(number)
    solution = coulomb(analysis)
    path = follow_path(analysis.assembly, analysis.stiffness, analysis.stiffness.travel, 25)
    assert path.converged.all()
    assert solution.value == pytest.approx(path.value[-1], rel=history)
    assert abs(solution.drift) <= history


def test_wall_1_in_space() -> None:
    scene, plane = wall(1, plane=False), analysed(1)
    space = analyse(scene)
    assert not space.assembly.effects.plane
    assert space.sharp.bounds[space.main].value == pytest.approx(ASSOCIATED[1], abs=0.6e-5)
    assert coulomb(space).value == pytest.approx(coulomb(plane).value, rel=1e-3)
    assert coulomb(space).interval == pytest.approx(coulomb(plane).interval, rel=1e-3)


@pytest.mark.parametrize("number", [1, 2])
def test_shipped_walls_are_these(number: int) -> None:
    """The shipped scenes say the same with a generator; their expected values are those above."""
    scene, same = scenes.shipped(f"ferris_tin_loi_{number}"), wall(number)
    assert scene.expected is not None
    assert (scene.expected.multiplier, scene.expected.associated_multiplier) == (COULOMB[number], ASSOCIATED[number])
    assert scene.expected.tolerance == pytest.approx(PUBLISHED * COULOMB[number], rel=0.02)
    order = (np.lexsort(np.round(blocks.centroid[blocks.free], 6).T) for blocks in (scene.blocks, same.blocks))
    ours, theirs = (blocks.centroid[blocks.free][rows] for blocks, rows in zip((scene.blocks, same.blocks), order, strict=True))
    assert ours == pytest.approx(theirs, abs=1e-9)
    solution = coulomb(analyse(scene))
    assert solution.value == pytest.approx(coulomb(analysed(number)).value, rel=1e-3)
