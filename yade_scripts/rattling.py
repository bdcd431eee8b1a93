"""Whether the blocks of a run rattle: unbalanced forces larger than those of a quasi-static motion."""

from la_core.exchange import JUMP
from yade_scripts import plateau
from yade_scripts.case import Case
from yade_scripts.recorder import Record
from yade_scripts.settings import Settings, rattling_of


def jumps(case: Case, settings: Settings, record: Record) -> bool:
    """Return whether a block has jumped."""
    return record.jumps(JUMP * _allowed(case, settings, record))


def rattles(case: Case, settings: Settings, record: Record) -> bool:
    """Return whether blocks jump on the way to the plateau or on it, or rattle on the mean."""
    return jumps(case, settings, record) or record.rattles(plateau.STARTS[0], _allowed(case, settings, record))


def _allowed(case: Case, settings: Settings, record: Record) -> float:
    return rattling_of(case, settings, record.rows[-1].reaction)
