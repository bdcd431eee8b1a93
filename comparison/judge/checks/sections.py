"""Check force sums over sections. Both methods must have the same sums, although single contact forces are not determined."""

from collections.abc import Iterator

import numpy as np

from comparison.judge.checks.tolerances import reaction_tolerance
from comparison.numbers import format_number
from comparison.verdict import Check, inside, within
from comparison.yade import Results
from la_core.geometry import plane_axes
from la_core.limit import section_forces
from la_core.measures import residuals
from la_core.scene import Scene

SECTION = 1e-2  # of the weight: every force of YADE in the sum has an unbalanced part
ALONG = 1e-6  # of a unit vector: round-off in the comparison of a direction with an axis


def check_sections(results: Results) -> Iterator[Check]:
    """Yield the checks of two force sums: over horizontal cuts, which equilibrium determines, and across the reaction, which it bounds.

    A live load enters the sums with YADE's own multiplier, which another check compares. It has no support, so there is no second check.
    """
    scene, analysis, run = results.scene, results.analysis, results.recorded
    assembly, forces = analysis.assembly, run.plateau_forces()
    multiplier = 0.0 if scene.live is None else residuals.multiplier(assembly, forces)
    expected = section_forces.sums_in_equilibrium(assembly, multiplier)
    sums = section_forces.level_sums(assembly, forces)
    farthest = np.unravel_index(np.argmax(np.abs(sums - expected)), sums.shape)  # the cut and the axis that differ most
    in_balance, by_yade = float(expected[farthest] + 0.0), float(sums[farthest])  # no negative zero
    differ = format_number(abs(by_yade - in_balance), 4)
    reason = f"The force sums over horizontal cuts differ by {differ} N: the two methods do not carry the same weight."
    yield within("force sums over sections", in_balance, by_yade, SECTION * scene.weight, "N", reason)
    if scene.live is not None:
        return
    tolerance = reaction_tolerance(results)
    slack = SECTION * scene.weight
    for label, direction in _transverse_directions(scene, assembly.effects.plane):
        low, high = section_forces.support_force_range(assembly, direction, residuals.reaction(assembly, forces), tolerance)
        component = float(section_forces.support_force(assembly, forces) @ direction)
        reason = f"In YADE the support's force along {label} lies outside the range that equilibrium and friction allow."
        yield inside(f"support's force along {label}, in its range", (low, high), component, slack, "N", reason)


def _transverse_directions(scene: Scene, plane: bool) -> Iterator[tuple[str, np.ndarray]]:
    """Yield names and unit vectors (3,) of the directions across the reaction; all axes for a moment, or for supports with own twists."""
    assert scene.support_twist is not None  # a live load has no support
    motion = scene.support_twist[:3]
    across = np.eye(3) if scene.is_rotation or scene.own_twists is not None else np.concatenate(plane_axes(motion[None, :]))
    for direction in across:
        if plane and abs(direction[1]) > ALONG:
            continue
        main = int(np.argmax(np.abs(direction)))
        unit = direction * np.sign(direction[main]) + 0.0  # no negative zero in a name
        on_axis = abs(unit[main] - 1.0) <= ALONG
        yield "xyz"[main] if on_axis else "({:.3g}, {:.3g}, {:.3g})".format(*unit), unit
