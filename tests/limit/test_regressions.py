"""Structures on which laws of `test_random_laws.py` once failed, each reduced to the smallest one that still failed."""

import numpy as np
import pytest
import scenes

from la_core.coulomb import predict
from la_core.limit.associated import Status, solve_associated
from la_core.limit.linearised import solve_linearised
from la_core.limit.problem import Drive
from la_core.limit.static import coulomb_limits, solve_static
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

SAME = 1e-5  # of the weight: friction of 1e-6 changes the reaction by a few times 1e-6
SLIGHT = 1e-6
PROMISED = 1e-6  # of a multiplier: the duality gap of an answer called solved
WEDGED = 0.4  # slope of the plane on which a block lies


def crossed(friction: float, beams: int = 2, seed: int = 0, split: float = 0.4, **options) -> Scene:
    """Beams of random sizes piled up at random angles about the vertical, on a base in two parts that meet at x = split."""
    random, parts, z = np.random.default_rng(seed), [], 0.0
    for k in range(beams):
        half = random.uniform((0.3, 0.15, 0.05), (0.6, 0.4, 0.3))
        corners = np.array([[x, y, h] for x in (-1, 1) for y in (-1, 1) for h in (-1, 1)]) * half
        middle = (0.5 + random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05), z + half[2])
        parts.append(
            scenes.block(f"beam {k}", polyhedron=corners @ scenes.rotation((0.0, 0.0, 1.0), random.uniform(0.0, np.pi)).T + middle)
        )
        z += 2.0 * half[2]
    parts.append(scenes.box("ground", (0.0, -0.5, -0.2), (split, 0.5, 0.0), "fixed"))
    parts.append(scenes.box("pad", (split, -0.5, -0.2), (1.0, 0.5, 0.0), "fixed" if "live" in options else "support"))
    return scenes.build(*parts, friction=friction, plane=False, **options)


def posts(friction: float) -> Scene:
    """Two posts of two boxes under a lintel, one on the support."""
    parts = []
    for name, x, role in (("left", 0.0, "fixed"), ("right", 1.5, "support")):
        parts.append(scenes.box(f"{name} base", (x - 0.5, 0.0, -0.2), (x + 0.5, 0.5, 0.0), role))
        parts.append(scenes.box(f"{name} lower", (x - 0.2, 0.0, 0.0), (x + 0.3, 0.5, 0.5)))
        parts.append(scenes.box(f"{name} upper", (x - 0.15, 0.0, 0.5), (x + 0.15, 0.5, 1.0)))
    return scenes.build(*parts, scenes.box("lintel", (-0.1, 0.0, 1.0), (1.8, 0.5, 1.2)), friction=friction)


def values(assembly: Assembly) -> list[float]:
    """Least and greatest reaction over the weight by the kinematic form, then by the static one; all must be solved."""
    found = [solve_associated(assembly, drive) for drive in (Drive.YIELDING, Drive.PUSHING)]
    found += [solve_static(assembly, drive, *coulomb_limits(assembly)) for drive in (Drive.YIELDING, Drive.PUSHING)]
    assert {one.status for one in found} == {Status.SOLVED}
    return [one.value / assembly.weight for one in found]


@pytest.mark.parametrize("friction", [1e-300, 1e-12, 1e-7, SLIGHT])
@pytest.mark.parametrize("make", [crossed, posts])
def test_slight_friction_is_almost_none(make, friction: float) -> None:
    """The static form reported an unlimited reaction or broke off. The kinematic form ended inaccurate."""
    assert values(assemble(make(friction))) == pytest.approx(values(assemble(make(0.0))), abs=SAME)


@pytest.mark.parametrize(("seed", "beams"), [(4, 4), (6, 2), (7, 6), (8, 4), (12, 6), (22, 6)])
def test_support_that_slides_away_under_slight_friction_is_solved(seed: int, beams: int) -> None:
    """The solver's own scaling enlarged the rows of friction, and equilibrium was missed by 1e-4 and more."""
    assembly = assemble(crossed(SLIGHT, beams, seed, settlement=(0.96, -0.26, 0.0)))
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert solve_associated(assembly, drive).status is Status.SOLVED


@pytest.mark.parametrize(("seed", "beams"), [(1, 2), (1, 4), (2, 6), (5, 6), (8, 2), (9, 4)])
def test_slight_friction_bears_its_share_of_the_weight(seed: int, beams: int) -> None:
    """A horizontal load shears the pile in one joint at lambda = mu. Associated solves missed this value, and elastic steps stalled."""
    assembly = assemble(crossed(SLIGHT, beams, seed, live=(1.0, 0.0, 0.0), settlement=None))
    associated = solve_associated(assembly, Drive.LIVE)
    assert associated.status is Status.SOLVED and associated.value == pytest.approx(SLIGHT, abs=PROMISED)
    prediction = predict(assembly, joint_stiffness(assembly, {}), associated)
    assert prediction.status is Status.SOLVED and prediction.value == pytest.approx(SLIGHT, abs=PROMISED)


@pytest.mark.parametrize(("seed", "beams"), [(1, 4), (1, 6), (3, 6), (11, 6)])
def test_interval_exists_under_slight_friction(seed: int, beams: int) -> None:
    """With slight friction, exact sliding directions contradict equilibrium. The ends of the interval were undefined or exchanged."""
    assembly = assemble(crossed(SLIGHT, beams, seed, live=(1.0, 0.0, 0.0), settlement=None))
    prediction = predict(assembly, joint_stiffness(assembly, {}), solve_associated(assembly, Drive.LIVE))
    low, high = prediction.interval
    assert low - PROMISED <= prediction.value <= high + PROMISED and low - PROMISED <= high


def test_joint_that_slides_and_still_carries_does_not_part() -> None:
    """Three posts under a heavy lintel, mu = 5: the remaining dilation of the iteration was mistaken for an opening joint."""
    posts = [(-0.2701804073520084, 0.2441923385185683, 70.0), (1.3313224177641152, 1.6688775822358848, 236.0)]
    posts.append((2.610403281448762, 3.125488656136274, 632.0))
    height, depth = 0.6783968142881358, 0.5
    parts = [scenes.box(f"post {k}", (low, 0.0, 0.0), (high, depth, height), density=own) for k, (low, high, own) in enumerate(posts)]
    parts += [scenes.box(f"base {k}", (1.5 * k - 0.5, 0.0, -0.2), (1.5 * k + 0.5, depth, 0.0), "fixed") for k in range(3)]
    parts.append(scenes.box("lintel", (-0.4, 0.0, height), (3.4, depth, 1.15), density=42488.0))
    scene = scenes.build(*parts, live=(0.8530521698933407, 0.0, -0.5218256370093973), settlement=None, friction=5.0, plane=True)
    assembly = assemble(scene)
    prediction = predict(assembly, joint_stiffness(assembly, {}), solve_associated(assembly, Drive.LIVE))
    low, high = prediction.interval
    assert prediction.status is Status.SOLVED and low - SAME <= prediction.value <= high + SAME


@pytest.mark.parametrize(
    ("per_course", "courses", "first", "split", "friction"),
    [(2, 2, "full", 0.64, 0.6), (3, 1, "half", 1.14, 5.0), (3, 2, "half", 1.08, 0.6), (4, 3, "full", 1.28, 0.9)],
)
def test_support_that_leaves_a_standing_wall_has_no_reaction(
    per_course: int, courses: int, first: str, split: float, friction: float
) -> None:
    """Only the support moves, so hardly any work is done to measure a dilation by. The last step ended before its tolerance was met."""
    assembly = assemble(scenes.build(*scenes.wall(per_course, courses, split, first=first), friction=friction, plane=False))
    prediction = predict(assembly, joint_stiffness(assembly, {}), solve_associated(assembly, Drive.YIELDING))
    assert prediction.status is Status.SOLVED and abs(prediction.value) <= SAME * assembly.weight


@pytest.mark.parametrize("plane", [True, False])
def test_what_only_a_live_load_holds_up_cannot_stand(plane: bool) -> None:
    """A block on a slope is pushed uphill. Some multipliers balance it, but without a push it slides down if mu is below the slope."""
    slope = scenes.block("slope", "fixed", prism=([(0.0, 0.0), (1.0, 0.0), (1.0, WEDGED)], (0.0, 1.0)))
    rise = [(x, WEDGED * x) for x in (0.2, 0.8)]
    block = scenes.block("block", prism=([*rise, (0.8, 0.8 * WEDGED + 0.1), (0.2, 0.2 * WEDGED + 0.1)], (0.0, 1.0)))
    for friction, stands in ((0.3, False), (0.5, True)):
        scene = scenes.build(slope, block, live=(1.0, 0.0, 0.0), settlement=None, friction=friction, plane=plane)
        assembly = assemble(scene)
        expected = Status.SOLVED if stands else Status.INFEASIBLE
        assert solve_associated(assembly, Drive.LIVE).status is expected
        assert solve_linearised(assembly, Drive.LIVE, 16, inscribed=True).status is expected
        greatest = solve_static(assembly, Drive.LIVE, *coulomb_limits(assembly)).value
        assert greatest == pytest.approx((WEDGED + friction) / (1.0 - WEDGED * friction), abs=SAME)  # tan(slope + friction angle)
