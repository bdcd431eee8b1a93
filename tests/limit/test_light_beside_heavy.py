"""The error of a light block's reaction beside heavy blocks is known: a residual that is small for them may be large for it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scenes

from la_core.analysis import analyse
from la_core.coulomb import prediction, release
from la_core.coulomb.certificate import error_of_forces
from la_core.limit import Status, solve_associated
from la_core.limit.associated import LEAST_PRECISE
from la_core.limit.problem import Drive
from la_core.measures import residuals
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

GRAVITY, DENSITY = 9.81, 2000.0
NOTHING = 1e-7  # N
SIZES = [0.2, 1.0, 5.0, 28.0, 30.0, 33.0]  # m, of a cube beside a stone of 12.8 kg; its mass is 1.25 times to 6 million times the stone's


def doorstep(cube: float) -> Scene:
    """A stone of 0.2 x 0.2 x 0.16 m on two pads of 0.06 m, of which the right one settles, and a cube on its own ground."""
    return scenes.build(
        scenes.box("ground", (0.0, 0.0, -0.2), (cube, cube, 0.0), "fixed"),
        scenes.box("cube", (0.0, 0.0, 0.0), (cube, cube, cube)),
        scenes.box("left pad", (40.0, 0.0, -0.2), (40.06, 0.2, 0.0), "fixed"),
        scenes.box("right pad", (40.14, 0.0, -0.2), (40.2, 0.2, 0.0), "support"),
        scenes.box("stone", (40.0, 0.0, 0.0), (40.2, 0.2, 0.16)),
        friction=0.6,
        settlement=scenes.DOWN,
        model="coulomb",
    )


def beside(size: float, role: str) -> Scene:
    """Two stones on a settling pad, against a long block that is fixed, or free and heavy."""
    return scenes.build(
        scenes.box("ground", (-size, 0.0, -0.2), (0.0, 0.2, 0.0), "fixed"),
        scenes.box("wall", (-size, 0.0, 0.0), (0.0, 0.2, 0.9), role),
        scenes.box("pad", (0.1, 0.0, -0.2), (0.2, 0.2, 0.0), "support"),
        scenes.box("low", (0.0, 0.0, 0.0), (0.2, 0.2, 0.2)),
        scenes.box("middle", (0.0, 0.0, 0.2), (0.25, 0.2, 0.4)),
        friction=0.5,
        settlement=scenes.DOWN,
    )


@pytest.mark.slow_after_first
@pytest.mark.parametrize("cube", SIZES)
def test_the_reaction_of_a_stone_beside_a_cube_is_that_of_statics(cube: float) -> None:
    """The stone turns about the inner or the outer edge of the left pad: R = W 0.04 / 0.14 and W 0.10 / 0.14."""
    scene = doorstep(cube)
    assembly, weight = assemble(scene), 0.2 * 0.2 * 0.16 * DENSITY * GRAVITY
    for drive, share in ((Drive.YIELDING, 0.04 / 0.14), (Drive.PUSHING, 0.10 / 0.14)):
        solution = solve_associated(assembly, drive)
        assert solution.status is Status.SOLVED
        assert abs(solution.value - share * weight) <= solution.error + NOTHING
        assert solution.error <= max(1e-4 * weight, LEAST_PRECISE * assembly.weight)
    analysis = analyse(scene)
    assert analysis.coulomb is not None
    of_rounded_edges = (0.04 + analysis.assembly.inset) / 0.14 * weight
    assert abs(analysis.coulomb.value - of_rounded_edges) <= analysis.coulomb.uncertainty + NOTHING


@pytest.mark.parametrize("size", [1.0, 10.0, 100.0, 1000.0])
def test_a_heavy_block_that_rests_is_as_good_as_ground(size: float) -> None:
    """Two stones beside a heavy free block have the same bounds as beside a fixed block, within the stated errors."""
    heavy, fixed = (assemble(beside(size, role)) for role in ("free", "fixed"))
    for drive in (Drive.YIELDING, Drive.PUSHING):
        bound, other = solve_associated(heavy, drive), solve_associated(fixed, drive)
        assert bound.status is other.status is Status.SOLVED
        assert abs(bound.value - other.value) <= bound.error + other.error + NOTHING


def loaded(drive: Drive, settlement: object) -> Scene:
    """A stone on a fixed pad and a pad that settles or turns. Under a live load, both pads are fixed."""
    pads = [scenes.box("left pad", (0.0, 0.0, -0.2), (0.06, 0.2, 0.0), "fixed")]
    pads += [scenes.box("right pad", (0.14, 0.0, -0.2), (0.2, 0.2, 0.0), "fixed" if drive is Drive.LIVE else "support")]
    stone = scenes.box("stone", (0.0, 0.0, 0.0), (0.2, 0.2, 0.16))
    live = (1.0, 0.0, 0.0) if drive is Drive.LIVE else None
    return scenes.build(*pads, stone, friction=0.9, settlement=settlement, live=live)


@pytest.mark.parametrize(
    ("drive", "settlement"),
    [
        (Drive.YIELDING, scenes.DOWN),
        (Drive.PUSHING, scenes.DOWN),
        (Drive.YIELDING, {"axis": (0.0, 1.0, 0.0), "point": (-0.3, 0.0, 0.0)}),
        (Drive.LIVE, None),
    ],
    ids=["yielding", "pushing", "turning", "live load"],
)
def test_forces_that_balance_another_load_are_off_by_their_power(drive: Drive, settlement: object) -> None:
    """The forces for a stone that is a thousandth lighter are out of balance. The power of the imbalance is the change of the value."""
    assembly = assemble(loaded(drive, settlement))
    solution = solve_associated(assembly, drive)
    lighter = solve_associated(replace(assembly, dead_load=0.999 * assembly.dead_load), drive)
    change = abs(lighter.value - solution.value)
    multiplier = lighter.value if drive is Drive.LIVE else 0.0
    assert change == pytest.approx(1e-3 * abs(solution.value), rel=1e-3)
    assert residuals.power_of_unbalanced(assembly, solution.twists, lighter.forces, multiplier) == pytest.approx(change, rel=1e-3)
    assert residuals.most_power_of_unbalanced(assembly, solution.twists, lighter.forces, multiplier) >= 0.999 * change


def sliding_stone(friction: float, *parts: str, **options: Any) -> Scene:
    """A stone against a stop, on a level plate that slides away below it."""
    return scenes.build(
        scenes.box("stop", (-0.1, 0.0, 0.0), (0.0, 0.2, 0.1), "fixed"),
        scenes.box("plate", (0.0, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
        scenes.box("stone", (0.0, 0.0, 0.0), (0.2, 0.2, 0.1)),
        *parts,
        friction=friction,
        settlement=(-1.0, 0.0, 0.0),
        model="coulomb",
        **options,
    )


def test_where_joints_slide_a_force_out_of_balance_also_changes_friction() -> None:
    """A stone slides on a level plate. One newton more of weight does no work, but changes the friction of the plate by mu newtons."""
    friction = 0.3
    analysis = analyse(sliding_stone(friction))
    assembly, coulomb = analysis.assembly, analysis.coulomb
    assert coulomb is not None
    heavier = replace(assembly, dead_load=assembly.dead_load + np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0]) * assembly.blocks.free[:, None])
    assert residuals.power_of_unbalanced(heavier, coulomb.twists, coulomb.forces) <= 1e-6
    assert residuals.most_power_of_unbalanced(heavier, coulomb.twists, coulomb.forces) >= friction


@pytest.mark.parametrize("size", [1.0, 5.0, 300.0])
def test_a_cube_beside_a_sliding_stone_changes_its_prediction_by_no_more_than_it_states(size: float) -> None:
    """The path takes 1e-8 of the mean weight for round-off. Beside a cube of 300 m, this exceeds the friction force of the stone."""
    ground = scenes.box("ground", (5.0, 0.0, -0.2), (5.0 + size, size, 0.0), "fixed")
    cube = scenes.box("cube", (5.0, 0.0, 0.0), (5.0 + size, size, size))
    alone, beside_it = (analyse(sliding_stone(0.3, *parts, reach=False)).coulomb for parts in ((), (ground, cube)))
    assert alone is not None and beside_it is not None
    assert alone.uncertainty <= 1e-3 * abs(alone.value)
    assert abs(beside_it.value - alone.value) <= beside_it.uncertainty + alone.uncertainty


def test_a_prediction_counts_the_forces_out_of_balance_before_and_after_a_release(monkeypatch: pytest.MonkeyPatch) -> None:
    scene, more = scenes.shipped("wall_third"), 1000.0
    usual = analyse(scene).coulomb
    for module in (prediction, release):
        monkeypatch.setattr(module, "error_of_forces", lambda joints, end: more + error_of_forces(joints, end))
    doubtful = analyse(scene).coulomb
    assert usual is not None and doubtful is not None
    assert doubtful.uncertainty == pytest.approx(more, rel=1e-3)
    assert usual.released_uncertainty < 0.01 * usual.released
    assert np.isnan(doubtful.released)  # so uncertain a value is not stated
