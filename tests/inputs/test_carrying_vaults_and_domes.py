"""Barrel vaults have the thrust of their arches, domes the same reactions in all directions, and the thinnest lune is Heyman's."""

import math
from typing import Any

import numpy as np
import pytest
import scenes
from scipy.optimize import linprog
from vaults_and_domes import CLOSED, RIGHT, WHOLE, dome, vault

from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

EXACT = 1e-6  # of the weight: residuals up to 1e-6 of a block's weight are accepted
ROUGH = 0.9  # friction with which no joint of these arches slides


def solved(scene: Scene, drive: Drive = Drive.YIELDING) -> Solution:
    solution = solve_associated(assemble(scene), drive)
    assert solution.status is Status.SOLVED
    return solution


def ratio(scene: Scene, drive: Drive = Drive.YIELDING) -> float:
    return solved(scene, drive).value / scene.weight


# --- vaults: 3D gives the plane answer ---------------------------------------------------------------------------------------


def plane_arch(**changes: Any) -> Scene:
    """The plane arch with the cross-section of the vault in these tests."""
    entries = {"depth": 0.7, "length": None, "rings": None, "bond": None} | changes
    return scenes.build(vault(**entries).replace("[[vault]]", "[[arch]]"), friction=ROUGH, settlement=RIGHT)


@pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING])
@pytest.mark.parametrize(("rings", "bond"), [(1, "stack"), (4, "stack"), (1, "running"), (3, "running")])
def test_a_vault_thrusts_as_its_arch_does(rings: int, bond: str, drive: Drive) -> None:
    """This holds in running bond, too: without sliding, every ring and every half voussoir moves in the mechanism of the arch."""
    scene = scenes.build(vault(rings=rings, bond=bond), friction=ROUGH, settlement=RIGHT, plane=False)
    assert ratio(scene, drive) == pytest.approx(ratio(plane_arch(), drive), abs=EXACT)


@pytest.mark.parametrize(("direction", "known"), [((1.0, 0.0, 0.0), 0.17443), ((0.0, 0.0, -1.0), 0.48827), ((1.0, 0.0, -1.0), 0.47689)])
def test_a_vault_of_eleven_courses_has_the_thrust_of_the_known_arch(direction: tuple[float, float, float], known: float) -> None:
    """Computed by an independent prototype for t/R = 0.15, five digits (arch_spreading, arch_settling and arch_diagonal)."""
    barrel = vault(thickness=0.3, embrace=180.0, voussoirs=11, rings=2)
    assert ratio(scenes.build(barrel, friction=0.7, settlement=direction)) == pytest.approx(known, abs=1e-5)


def test_running_bond_ties_the_rings_of_a_vault_together() -> None:
    """The settling pad supports half of the springing. The ring above it may drop alone in stack bond, but not in running bond."""
    held = vault(rings=2, springers=None, embrace=180.0, centre=(0.0, 0.0, 0.0), thickness=0.6)
    pads = [scenes.box("left", (-2.4, 0.0, -0.3), (-1.6, 3.0, 0.0), "fixed")]
    pads += [scenes.box(role, (1.6, y, -0.3), (2.4, y + 1.5, 0.0), role) for role, y in (("fixed", 0.0), ("support", 1.5))]
    reaction = {}
    for bond in ("stack", "running"):
        reaction[bond] = ratio(scenes.build(held.replace("running", bond), *pads, friction=ROUGH))
    assert reaction["running"] < reaction["stack"] - 1e-3  # more than any residual


# --- domes: symmetries and equilibrium ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [30.0, 77.0, 211.0])
@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (1.0, 2.0, -1.0)])
def test_a_sector_of_a_dome_answers_alike_wherever_it_looks(angle: float, direction: tuple[float, float, float]) -> None:
    scene = scenes.build(dome(support=(1, 2), sides="fixed"), friction=0.6, settlement=direction)
    turned = scenes.moved(scene, turn=scenes.rotation((0.0, 0.0, 1.0), math.radians(angle)))
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert ratio(turned, drive) == pytest.approx(ratio(scene, drive), abs=EXACT)


def test_a_sector_answers_alike_where_its_first_and_where_its_last_lunes_settle() -> None:
    first, last = (scenes.build(dome(support=lunes)) for lunes in ((1, 1), (4, 4)))
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert ratio(first, drive) == pytest.approx(ratio(last, drive), abs=EXACT)


@pytest.mark.parametrize("changes", [WHOLE, CLOSED | {"embrace": 90.0}])
def test_a_whole_dome_rests_on_all_its_springers(changes: dict[str, Any]) -> None:
    scene = scenes.build(dome(**changes, support=(1, 12)))
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert ratio(scene, drive) == pytest.approx(1.0, abs=EXACT)


def test_what_some_springers_do_not_carry_the_others_do() -> None:
    """The vertical forces of the springers add up to the weight: the least of some is the weight minus the greatest of the others."""
    some, others = (scenes.build(dome(**CLOSED, support=lunes)) for lunes in ((1, 5), (6, 12)))
    assert ratio(some) + ratio(others, Drive.PUSHING) == pytest.approx(1.0, abs=EXACT)
    assert ratio(others) + ratio(some, Drive.PUSHING) == pytest.approx(1.0, abs=EXACT)


# --- the thinnest dome -------------------------------------------------------------------------------------------------------


def lune_stands(thickness: float, lunes: int, courses: int) -> bool:
    """Whether a thrust line fits into one lune of a closed hemisphere of radius 1, without forces from its neighbours.

    Plane statics in the lune's middle plane, x outwards. The keystone exerts its share of the weight, any thrust and any moment. At
    each bed joint the resultant of all forces above passes between intrados and extrados. The voussoirs are frusta about the centre.
    """
    inner, outer = 1.0 - thickness / 2.0, 1.0 + thickness / 2.0
    parallels = np.linspace(0.0, math.pi / 2.0, courses + 1)[1:]
    joint = np.stack([np.sin(parallels) * math.cos(math.pi / lunes), np.cos(parallels)], axis=1)  # mid points of chords, radius 1
    width, sector = np.sin(parallels), (outer**3 - inner**3) / 6.0 * math.sin(2.0 * math.pi / lunes)
    keystone = sector * width[0] ** 2 * math.cos(parallels[0])
    weight = sector * (width[:-1] + width[1:]) * np.sin(np.diff(parallels))
    below = (width[:-1] + 2.0 * width[1:]) / (3.0 * (width[:-1] + width[1:]))  # centroid of a trapezoid, from the upper joint
    arm = 0.75 * (outer**4 - inner**4) / (outer**3 - inner**3) * (joint[:-1, 0] + below * np.diff(joint[:, 0]))
    rows, most = [], []
    for k in range(courses):
        for edge, sign in ((inner * joint[k], 1.0), (outer * joint[k], -1.0)):
            weights = edge[0] * keystone - np.sum((arm[:k] - edge[0]) * weight[:k])
            rows.append([sign * edge[1], sign])  # moments of a unit thrust at the centre's level, and of a unit moment
            most.append(-sign * weights)
    return bool(linprog([0.0, 0.0], A_ub=rows, b_ub=most, bounds=[(None, None)] * 2).success)


def thinnest(lunes: int, courses: int) -> float:
    """Least thickness over the radius of a lune that stands, by bisection to seven digits."""
    low, high = 0.01, 0.2
    while high - low > 1e-7 * high:
        middle = (low + high) / 2.0
        low, high = (low, middle) if lune_stands(middle, lunes, courses) else (middle, high)
    return high


def test_thinnest_lune_is_heyman_s() -> None:
    """Heyman (1967) gives 0.042 for orange slices, to two digits, with the weight on the middle surface."""
    assert thinnest(400, 400) == pytest.approx(0.042, abs=1e-3)


@pytest.mark.parametrize(("lunes", "courses"), [(8, 6), (12, 6), (16, 9)])
@pytest.mark.parametrize(("over", "status"), [(0.99, Status.INFEASIBLE), (1.01, Status.SOLVED)])
@pytest.mark.parametrize("model", ["associated", "none-slides"])
def test_a_hemisphere_stands_exactly_if_its_lunes_do(lunes: int, courses: int, over: float, status: Status, model: str) -> None:
    """Above the least thickness, lunes without hoop forces are a safe state. Below it, the lunes part as they fall, without restraint."""
    entries = CLOSED | {"radius": 1.0, "thickness": over * thinnest(lunes, courses), "embrace": 90.0, "lunes": lunes, "courses": courses}
    scene = scenes.build(dome(**entries, support=(1, lunes)), friction=ROUGH, model=model)
    assert solve_associated(assemble(scene), Drive.YIELDING).status is status
