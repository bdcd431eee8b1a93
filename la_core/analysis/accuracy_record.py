"""Record of a requested accuracy: every attempt, its estimated error, and what it cost."""

import json
from dataclasses import asdict, dataclass, field


@dataclass(frozen=True)
class Attempt:
    """One run of a method: its settings as used, by name; its answer in N, N m or as a multiplier; its seconds.

    parts: relative error by its source, NaN where undefined.
    """

    settings: dict[str, float]
    value: float
    parts: dict[str, float]
    seconds: float

    @property
    def error(self) -> float:
        """Estimated relative error: its parts may add up."""
        return sum(self.parts.values())

    def is_within(self, accuracy: float) -> bool:
        """Whether the estimated error is within the accuracy; an undefined one is not."""
        return bool(self.error <= accuracy)


@dataclass(frozen=True)
class AccuracyRecord:
    """Attempts of both methods to reach an accuracy, a share of the answer, in order; the accepted one is last.

    settings: of YADE's run to come, or of the last one, in place of derived ones.
    """

    asked: float
    limit_analysis: tuple[Attempt, ...] = ()
    yade: tuple[Attempt, ...] = ()
    settings: dict[str, float] = field(default_factory=dict)


def to_text(record: AccuracyRecord | None) -> str:
    """As a JSON object, "null" for none."""
    return json.dumps(None if record is None else asdict(record), sort_keys=True)


def from_text(text: str) -> AccuracyRecord | None:
    """The record of a text by `to_text`."""
    stored = json.loads(text)
    if stored is None:
        return None
    attempts = {method: tuple(Attempt(**one) for one in stored[method]) for method in ("limit_analysis", "yade")}
    return AccuracyRecord(stored["asked"], settings=stored["settings"], **attempts)
