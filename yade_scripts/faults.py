"""Faults of a run: it is lost (unstable, collapsed or out of time), or its blocks rattle.

Blocks rattle if their unbalanced forces are larger than in a quasi-static motion.
"""

import math
import time

from la_core.exchange import GRAVITY, JUMP
from yade_scripts import plateau
from yade_scripts.case import Case
from yade_scripts.recorder import Record, Row, Status
from yade_scripts.settings import CRITICAL, Settings, rattling_of

MANY = 100  # free blocks: among so many, slow motion prevents a jump better than critical dashpots do


def settlement_words(case: Case, settlement: float, start: float | None = None) -> str:
    """Return a settlement with its unit, for the reason why a run ended; under a live load it is called a displacement.

    settlement: m, or rad for a support that turns; start: beginning of a range that ends at the settlement.
    """
    motion, since = "settlement" if case.live is None else "displacement", "" if start is None else f"{start:.3g} to "
    return f"a {motion} of {since}{settlement:.3g} {'rad' if case.is_rotation else 'm'}"


def loss_of(case: Case, settings: Settings, row: Row, began: float) -> tuple[Status, str] | None:
    """Return status and reason of a run that is lost at a row, None if it goes on. began: its start on the monotonic clock, s."""
    if not all(map(math.isfinite, (row.reaction, row.kinetic_energy, row.unbalanced))):
        return Status.FAILED, f"undefined forces at {row.time:.3g} s: the integration is unstable"
    if row.speed > settings.fall_speed:
        return Status.COLLAPSED, f"a block falls at {row.speed:.3g} m/s after {settlement_words(case, row.settlement)}"
    if row.stage == GRAVITY and row.displacement > settings.max_travel * case.support_speed:
        return Status.COLLAPSED, f"a block has moved {row.displacement:.3g} m under gravity alone"
    if time.monotonic() - began > settings.time_limit:
        return Status.TIMEOUT, f"the time limit was reached at {settlement_words(case, row.settlement)}"
    return None


def jumps(case: Case, settings: Settings, record: Record) -> bool:
    """Return whether a block has jumped."""
    return record.jumps(JUMP * _allowed(case, settings, record))


def rattles(case: Case, settings: Settings, record: Record) -> bool:
    """Return whether blocks jump on the way to the plateau or on it, or rattle on the mean."""
    return jumps(case, settings, record) or record.rattles(plateau.STARTS[0], _allowed(case, settings, record))


def gives_way(case: Case, settings: Settings, pace: float) -> bool:
    """Return whether slow attempts may follow an attempt that has all its damping, if one of its many blocks jumps.

    They follow only a quick attempt, and never in a scene that sets damping or speed. pace: speed over that of the attempt that counts.
    """
    is_given = {"damping_ratio", "normal_damping", "speed"} & set(case.overrides)
    is_calmed = settings.damping_ratio >= CRITICAL and settings.swing_damping > 0.0
    return pace > 1.0 and is_calmed and not is_given and len(case.free) >= MANY


def is_restless(case: Case, settings: Settings, record: Record, may_damp: bool, pace: float) -> bool:
    """Return whether blocks rattle or jump so that a calmer attempt should follow.

    may_damp: whether an attempt with more damping may follow; pace: as in `gives_way`.
    """
    if may_damp:
        return rattles(case, settings, record)
    return gives_way(case, settings, pace) and jumps(case, settings, record)


def _allowed(case: Case, settings: Settings, record: Record) -> float:
    return rattling_of(case, settings, record.rows[-1].reaction)
