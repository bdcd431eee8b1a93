"""An accuracy that was asked for: what was tried for it, the error as each run itself tells it, and its price."""

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

    def keeps(self, asked: float) -> bool:
        """Whether the estimate is within the accuracy; an undefined one is not."""
        return bool(self.error <= asked)


@dataclass(frozen=True)
class Purchase:
    """All attempts of both methods at an accuracy, a share of the answer, in turn but for the one that is the answer, which stands last.

    settings: of YADE's run to come, or of the last one, in place of derived ones.
    """

    asked: float
    limit_analysis: tuple[Attempt, ...] = ()
    yade: tuple[Attempt, ...] = ()
    settings: dict[str, float] = field(default_factory=dict)


def to_text(purchase: Purchase | None) -> str:
    """As a JSON object, "null" for none."""
    return json.dumps(None if purchase is None else asdict(purchase), sort_keys=True)


def from_text(text: str) -> Purchase | None:
    """The purchase of a text by `to_text`."""
    stored = json.loads(text)
    if stored is None:
        return None
    attempts = {method: tuple(Attempt(**one) for one in stored[method]) for method in ("limit_analysis", "yade")}
    return Purchase(stored["asked"], settings=stored["settings"], **attempts)
