"""The record of predictions with friction: walls, their runs by name of settings, and the file of the record."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

GALLERY = Path(__file__).parents[2] / "comparison" / "gallery"
RECORD = "friction.json"  # in the gallery
COARSER, DEFAULT, REFERENCE, SMOOTH = "coarser", "default", "reference", "smooth"  # names of settings
LEAST = 1e-3  # share of the weight; smaller reactions count as this share
ALIKE = 1e-6  # relative; a smaller difference is round-off


@dataclass(frozen=True)
class Case:
    """One wall with its friction and the number of blocks of the base that settle."""

    per_course: int
    courses: int
    friction: float
    settling: int

    def __str__(self) -> str:
        return f"{self.per_course} x {self.courses}, {self.settling} settle, mu {self.friction}"


@dataclass(frozen=True)
class Run:
    """One prediction; value, uncertainty and plateaus over the weight."""

    status: str
    value: float
    uncertainty: float
    plateaus: tuple[float, ...]
    travel: float
    certificate: float
    iterations: int
    seconds: float


@dataclass(frozen=True)
class Result:
    """Runs of one wall by the name of their settings."""

    case: Case
    runs: dict[str, Run]

    @property
    def scale(self) -> float:
        """Divisor of relative differences: the reference's reaction, or LEAST where this is larger."""
        return max(abs(self.runs[REFERENCE].value), LEAST)

    def deviation(self, name: str) -> float:
        """Return the relative difference from the reference; infinite without a value."""
        off = abs(self.runs[name].value - self.runs[REFERENCE].value)
        return off / self.scale if np.isfinite(off) else np.inf

    def excess(self, name: str) -> float:
        """Return the difference from the reference over the stated uncertainty, or over ALIKE where this is larger."""
        return self.deviation(name) / max(self.runs[name].uncertainty / self.scale, ALIKE)


def write(record: Path, results: list[Result]) -> None:
    """Write the record, one line per wall."""
    lines = [json.dumps({"case": asdict(r.case), "runs": {name: asdict(one) for name, one in r.runs.items()}}) for r in results]
    record.write_text("[\n" + ",\n".join(lines) + "\n]\n", encoding="utf-8")


def read(record: Path) -> list[Result]:
    """Read the results of a record."""
    stored = json.loads(record.read_text(encoding="utf-8"))
    return [Result(Case(**row["case"]), {name: Run(**one) for name, one in row["runs"].items()}) for row in stored]
