"""Runs that are lost: unstable, fallen, or out of time."""

import math
import time

from yade_scripts.case import Case
from yade_scripts.recorder import GRAVITY, Row, Status
from yade_scripts.settings import Settings


def loss_of(case: Case, settings: Settings, row: Row, began: float) -> tuple[Status, str] | None:
    """Return how and why a run is lost at a row, None where it goes on. began: when it began, on the monotonic clock, s."""
    if not all(map(math.isfinite, (row.reaction, row.kinetic_energy, row.unbalanced))):
        return Status.FAILED, f"undefined forces at {row.time:.3g} s: the integration is unstable"
    if row.speed > settings.fall_speed:
        return Status.COLLAPSED, f"a block falls at {row.speed:.3g} m/s after a settlement of {row.settlement:.3g}"
    if row.stage == GRAVITY and row.displacement > settings.max_travel * case.support_speed:
        return Status.COLLAPSED, f"a block has moved {row.displacement:.3g} m under gravity alone"
    if time.monotonic() - began > settings.time_limit:
        return Status.TIMEOUT, f"time limit of {settings.time_limit:g} s reached at a settlement of {row.settlement:.3g}"
    return None
