"""Values of the associated problem, in the plane and as prisms of unit depth in 3D, and their accuracy."""

import pytest

from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

EXACT = 1e-6  # share of the weight: the solver's tolerance is 1e-9; residuals up to 1e-6 of a block's weight are accepted
FIVE_DIGITS = 0.5e-5  # half a unit of the last printed digit
SEVEN_DIGITS = 0.5e-7

in_plane_and_3d = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])


def value(model: Scene | Assembly, drive: Drive = Drive.YIELDING) -> float:
    """Return reaction over weight, or multiplier. Fails unless limit analysis ends as `solved`."""
    assembly = assemble(model) if isinstance(model, Scene) else model
    solution = solve_associated(assembly, drive)
    assert solution.status is Status.SOLVED
    return solution.value / (1.0 if drive is Drive.LIVE else assembly.weight)
