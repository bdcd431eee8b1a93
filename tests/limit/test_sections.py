"""Sums of contact forces over sections agree with statics: weights above cuts, and the range of a support's horizontal force."""

import numpy as np
import pytest
import scenes

from la_core.limit import section_forces
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import assemble

X = np.array([1.0, 0.0, 0.0])
SLACK = 1e-3  # of the weight: allowed difference from the given reaction

both_models = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])


@both_models
def test_a_cut_carries_the_weight_above_it(plane: bool) -> None:
    """Four equal blocks are stacked. Three, two and one of them lie above the cuts, and the force on them points up."""
    base = scenes.box("base", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "support")
    tower = [scenes.box(f"block {k}", (0.0, 0.0, float(k)), (1.0, 1.0, k + 1.0)) for k in range(4)]
    assembly = assemble(scenes.build(base, *tower, plane=plane))
    solution = solve_associated(assembly, Drive.YIELDING)
    assert solution.status is Status.SOLVED
    sums = section_forces.level_sums(assembly, solution.forces)
    np.testing.assert_allclose(section_forces.sums_in_equilibrium(assembly, 0.0), sums, atol=1e-6 * assembly.weight)
    assert sums == pytest.approx(np.outer([3.0, 2.0, 1.0], -assembly.down) * assembly.mean_weight, abs=1e-6 * assembly.weight)
    on_tower = section_forces.support_force(assembly, solution.forces)
    assert on_tower == pytest.approx(-assembly.down * assembly.weight, abs=1e-6 * assembly.weight)


@both_models
def test_a_cut_carries_the_push_on_what_lies_above_it_at_any_multiplier(plane: bool) -> None:
    base = scenes.box("base", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "fixed")
    tower = [scenes.box(f"block {k}", (0.0, 0.0, float(k)), (1.0, 1.0, k + 1.0)) for k in range(4)]
    push = np.array([0.6, 0.0, -0.8])
    assembly = assemble(scenes.build(base, *tower, plane=plane, settlement=None, live=push.tolist()))
    solution = solve_associated(assembly, Drive.LIVE)
    assert solution.status is Status.SOLVED
    for multiplier in (solution.value, 0.5 * solution.value, 0.0):
        carried = np.outer([3.0, 2.0, 1.0], -assembly.down - multiplier * push) * assembly.mean_weight
        assert section_forces.sums_in_equilibrium(assembly, multiplier) == pytest.approx(carried, abs=1e-9 * assembly.weight)
    at_collapse = section_forces.sums_in_equilibrium(assembly, solution.value)
    assert section_forces.level_sums(assembly, solution.forces) == pytest.approx(at_collapse, abs=1e-6 * assembly.weight)


@both_models
@pytest.mark.parametrize("ratio", [1.0, 0.4], ids=["whole settlement", "part of it"])
def test_a_support_pushes_sideways_only_against_what_resists_and_no_more_than_friction(ratio: float, plane: bool) -> None:
    """A wall stands on the left of the block only, so the friction of the support may push the block to the left but not to the right.

    The reaction of a support that moves by a share of the settlement is the same share of its force.
    """
    parts = (
        scenes.box("wall", (-1.0, 0.0, 0.0), (0.0, 1.0, 1.0), "fixed"),
        scenes.box("base", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "support"),
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
    )
    settlement = {"direction": scenes.DOWN, "zone": [{"blocks": ["base"], "ratio": ratio}]}
    assembly = assemble(scenes.build(*parts, friction=0.5, plane=plane, settlement=settlement))
    weight = assembly.weight
    limits = section_forces.support_force_range(assembly, X, ratio * weight, ratio * SLACK * weight)
    assert limits == pytest.approx((-0.5 * weight, 0.0), abs=2.0 * SLACK * weight)
    against_x = section_forces.support_force_range(assembly, -X, ratio * weight, ratio * SLACK * weight)
    assert against_x == pytest.approx((-limits[1], -limits[0]), abs=1e-5 * weight)
