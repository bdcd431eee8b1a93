"""Record of a requested accuracy: every attempt, its estimated error and its cost."""

import json
from dataclasses import asdict, dataclass, field


@dataclass(frozen=True)
class Attempt:
    """One run of one method at given settings.

    Attributes
    ----------
    settings : dict of str to float
        Settings of the run, by name.
    value : float
        Answer: a reaction (N, N m) or a multiplier.
    parts : dict of str to float
        Estimated relative error by its source; NaN where undefined.
    seconds : float
        Wall time, s.
    """

    settings: dict[str, float]
    value: float
    parts: dict[str, float]
    seconds: float

    @property
    def error(self) -> float:
        """Estimated relative error: the sum of its parts, which is the worst case."""
        return sum(self.parts.values())

    def is_within(self, accuracy: float) -> bool:
        """Whether the estimated error is at most `accuracy`; False for an undefined error."""
        return bool(self.error <= accuracy)


@dataclass(frozen=True)
class AccuracyRecord:
    """Attempts of both methods to reach a requested accuracy, in order; the accepted one is last.

    Attributes
    ----------
    asked : float
        Requested relative accuracy.
    limit_analysis, yade : tuple of Attempt
        Attempts of each method.
    settings : dict of str to float
        YADE settings of the next run, or of the last one, that replace the derived ones.
    """

    asked: float
    limit_analysis: tuple[Attempt, ...] = ()
    yade: tuple[Attempt, ...] = ()
    settings: dict[str, float] = field(default_factory=dict)


def to_text(record: AccuracyRecord | None) -> str:
    """Write a record as a JSON object, None as "null"."""
    return json.dumps(None if record is None else asdict(record), sort_keys=True)


def from_text(text: str) -> AccuracyRecord | None:
    """Read a record, or None, from a text that `to_text` wrote."""
    stored = json.loads(text)
    if stored is None:
        return None
    attempts = {method: tuple(Attempt(**attempt) for attempt in stored[method]) for method in ("limit_analysis", "yade")}
    return AccuracyRecord(stored["asked"], settings=stored["settings"], **attempts)
