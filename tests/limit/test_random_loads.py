"""Laws of dead loads, ties and classes of joints for random structures; many scenes with `--hypothesis-profile long`."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from independent_mechanics import RESIDUAL, VERDICTS, drives, slack, value_slack
from random_loads import Loading, loadings

from la_core.coulomb import predict
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import joint_stiffness
from la_core.scene.scene import Scene

COULOMB_RESIDUAL = 1e-5  # residual that the Coulomb prediction allows
ROUNDING = 1e-9  # of the weight


def answers(scene: Scene) -> Iterator[tuple[Assembly, Drive, Solution]]:
    """The assembly and its answer for each drive. A scene without a verdict is skipped."""
    assembly = assemble(scene)
    for drive in drives(assembly):
        solution = solve_associated(assembly, drive)
        assume(solution.status in VERDICTS)
        yield assembly, drive, solution


def assert_same(first: Scene, second: Scene, scale: float = 1.0) -> None:
    """Assert equal statuses, and second values of `scale` times the first, within the residuals of both."""
    for (one, drive, a), (other, _, b) in zip(answers(first), answers(second), strict=True):
        assert a.status == b.status
        if a.status is Status.SOLVED:
            factor = 1.0 if drive is Drive.LIVE else scale
            assert abs(factor * a.value - b.value) <= factor * value_slack(one, drive, a, a) + value_slack(other, drive, b, b)


def loads_by_hand(loading: Loading, scene: Scene, multiplier: float) -> np.ndarray:
    """Weights, loads and ties (B, 6) about the centroids, read from the tables; zero for held blocks."""
    names, blocks, wrenches = scene.blocks.names, scene.blocks, np.zeros((len(scene.blocks), 6))
    per_mass = scene.gravity
    if scene.live is not None:
        per_mass = per_mass + multiplier * np.linalg.norm(scene.gravity) * scene.live
    acting = [(names[k], blocks.centroid[k], blocks.mass[k] * per_mass) for k in np.flatnonzero(blocks.free)]
    acting += [(load["blocks"][0], load["at"], np.array(load["force"])) for load in loading.forces]
    acting += [(load["blocks"][0], load["at"], load["mass"] * per_mass) for load in loading.masses]
    acting += [(end["blocks"][0], end["at"], np.array(end["force"])) for end in ends_of_ties(loading)]
    for name, point, force in acting:
        k = names.index(name)
        wrenches[k] += np.concatenate([force, np.cross(np.array(point) - blocks.centroid[k], force)])
    return wrenches


def ends_of_ties(loading: Loading) -> list[dict[str, Any]]:
    """Every end of a tie at a block as a point load."""
    ends = []
    for tie in loading.ties:
        along = np.subtract(tie["to"], tie["from"])
        pull = tie["force"] * along / np.linalg.norm(along)
        for name, point, sign in zip(tie["blocks"], (tie["from"], tie["to"]), (1.0, -1.0), strict=False):
            ends.append({"blocks": [name], "at": point, "force": (sign * pull).tolist()})
    return ends


@pytest.mark.slow
@given(loading=loadings())
def test_loads_and_ties_are_in_equilibrium_with_the_contact_forces(loading: Loading) -> None:
    """solved: on every block the forces of the tables, read from them by hand, balance the contact forces"""
    scene = loading.loaded()
    for assembly, drive, solution in answers(scene):
        assume(solution.status is Status.SOLVED)
        expected = loads_by_hand(loading, scene, solution.value if drive is Drive.LIVE else 0.0)
        left = (assembly.contact_wrenches(solution.forces) + expected)[scene.blocks.free]
        left[:, 3:] /= assembly.length
        kept = left[:, [0, 2, 4]] if assembly.effects.plane else left
        assert np.abs(kept).max() <= (RESIDUAL + ROUNDING) * assembly.mean_weight


@pytest.mark.slow
@given(loading=loadings(), scale=st.floats(0.01, 100.0))
def test_values_are_linear_in_weights_and_loads_together(loading: Loading, scale: float) -> None:
    """weights, loads and ties times k: k times the reaction, the same multiplier"""
    assert_same(loading.loaded(), loading.loaded(scale), scale)


@pytest.mark.slow
@given(loading=loadings())
def test_ties_are_two_forces(loading: Loading) -> None:
    """a tie is a pair of opposite point loads at its ends"""
    forces = [*loading.forces, *ends_of_ties(loading)]
    assert_same(loading.loaded(), loading.loaded(forces=tuple(forces), ties=()))


@pytest.mark.slow
@given(loading=loadings())
def test_a_mass_at_the_centroid_is_density(loading: Loading) -> None:
    """a mass without a point is more density of its block; a load is the sum of two halves"""
    blocks = loading.scene.blocks
    density = blocks.density.copy()
    for load in loading.masses:
        k = blocks.names.index(load["blocks"][0])
        density[k] += load["mass"] / blocks.volume[k]
    heavier = replace(loading.scene, blocks=replace(blocks, density=density))
    centred = tuple({"blocks": load["blocks"], "mass": load["mass"]} for load in loading.masses)
    assert_same(loading.loaded(masses=centred), loading.loaded(scene=heavier, masses=()))
    halves = tuple({**load, "mass": 0.5 * load["mass"]} for load in loading.masses)
    assert_same(loading.loaded(), loading.loaded(masses=halves + halves))


@pytest.mark.slow
@given(loading=loadings(), mu=st.floats(0.1, 1.2))
def test_classes_of_one_friction_are_one_friction(loading: Loading, mu: float) -> None:
    """bed, head and footing joints of the same friction are joints of that friction"""
    alike = tuple({"joints": kind, "friction": mu} for kind in ("bed", "head", "footing"))
    common = replace(loading.scene, friction=mu)
    assert_same(loading.loaded(scene=common, classes=()), loading.loaded(classes=alike))


@pytest.mark.slow
@given(loading=loadings(), share=st.floats(0.1, 0.9))
def test_bounds_are_monotone_in_the_friction_of_a_class(loading: Loading, share: float) -> None:
    """less friction in one class of joints: no smaller least reaction, no greater greatest one, no greater multiplier"""
    assume(loading.classes)
    first, *others = loading.classes
    weaker = loading.loaded(classes=({**first, "friction": share * first["friction"]}, *others))
    for (one, drive, a), (other, _, b) in zip(answers(loading.loaded()), answers(weaker), strict=True):
        assume(a.status is b.status is Status.SOLVED)
        sign = 1.0 if drive is Drive.YIELDING else -1.0
        assert sign * (a.value - b.value) <= value_slack(one, drive, a, a) + value_slack(other, drive, b, b)


@pytest.mark.slow
@given(loading=loadings(ties=1), share=st.floats(0.1, 0.9))
def test_bounds_are_convex_in_the_tension_of_a_tie(loading: Loading, share: float) -> None:
    """tension between two that stand: it stands; least reaction is convex, greatest and multiplier are concave in the tension"""
    (tie,) = loading.ties
    between = {**tie, "force": share * tie["force"]}
    slack_one, tight, middle = (list(answers(loading.loaded(ties=ties))) for ties in ((), (tie,), (between,)))
    for (one, drive, a), (other, _, b), (third, _, c) in zip(slack_one, tight, middle, strict=True):
        assume(a.status is b.status is Status.SOLVED)
        assert c.status is Status.SOLVED
        sign = 1.0 if drive is Drive.YIELDING else -1.0
        chord = (1.0 - share) * a.value + share * b.value
        left_open = value_slack(one, drive, a, a) + value_slack(other, drive, b, b) + value_slack(third, drive, c, c)
        assert sign * (c.value - chord) <= left_open


@pytest.mark.slow
@given(loading=loadings())
def test_the_prediction_is_never_beyond_the_associated_bounds(loading: Loading) -> None:
    """R_min <= R of Coulomb friction <= R_max, and its multiplier is at most the associated one"""
    scene = loading.loaded()
    found = list(answers(scene))
    (assembly, drive, first), *_ = found
    assume(first.status is Status.SOLVED)
    prediction = predict(assembly, joint_stiffness(assembly, {}), first)
    assume(prediction.status is Status.SOLVED)
    for (_, _, bound), sign in zip(found, (-1.0,) if drive is Drive.LIVE else (1.0, -1.0), strict=True):
        if bound.status is Status.SOLVED:
            assert sign * (bound.value - prediction.value) <= slack(assembly, bound.twists, prediction.forces, COULOMB_RESIDUAL)


@pytest.mark.slow
@pytest.mark.parametrize("settles", [True, False])
def test_random_loadings_have_every_kind_of_table(settles: bool) -> None:
    """The laws are checked on structures that stand with forces, masses, ties and classes of joints."""
    seen: set[str] = set()

    @given(loading=loadings(settles=settles))
    def look(loading: Loading) -> None:
        kinds = ("forces", "masses", "ties", "classes")
        stands = all(solution.status is not Status.INFEASIBLE for *_, solution in answers(loading.loaded()))
        seen.update(kind for kind in kinds if getattr(loading, kind) and stands)

    look()
    assert seen == {"forces", "masses", "ties", "classes"}
