"""Studies of the methods' settings from Python: error against time, and the classic iteration against its parameters."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from comparison.picture import Picture
from comparison.progress import narration
from comparison.settings import MOST_WORKERS
from comparison.studies import (
    CostStudy,
    References,
    Sensitivity,
    cost_dict,
    cost_figure,
    sensitivity_figure,
    study_cost,
    study_sensitivity,
)
from comparison.studies import sensitivity as sensitivity_study
from la_core.errors import true_or_false, whole_number
from la_core.scene import Scene, load
from la_core.text_table import OVER_WEIGHT, Tabled, dataframe, number_text


@dataclass(frozen=True, eq=False, repr=False)
class CostResult(Tabled):
    """Cost of accuracy on one scene: the error of every method and setting against its time.

    `print(result)` shows one row for each setting, and so does a notebook.

    Attributes
    ----------
    rows : list of dict
        One row for each setting: "family" and "setting" of the method, "target" (its answer), "status", "value" (over the weight, or
        multiplier), its relative "error", the "uncertainty" that it states, the seconds "build", "solve", "post" and "total", their
        "scatter" over "repeats" runs, and "pareto": whether no other setting is both faster and closer. None is undefined.
    references : dict of str to dict
        "value" and "source" of the reference of the errors, by target.
    study : CostStudy
        Complete study.
    """

    rows: list[dict[str, Any]]
    references: dict[str, dict[str, Any]]
    study: CostStudy

    def plot(self) -> Picture:
        """Draw the figure of `crosscheck cost`.

        Returns
        -------
        Picture
            Error against seconds.
        """
        return Picture(cost_figure(self.study))

    def to_dataframe(self) -> Any:
        """Return the rows as a table of pandas.

        Returns
        -------
        pandas.DataFrame
            One row for each setting.

        Raises
        ------
        SceneError
            Pandas is not installed.
        """
        return dataframe(self.rows)

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        title = f"{self.study.title}: relative error against seconds; ● where no other setting is both faster and closer"
        value = f"{self.study.quantity} {OVER_WEIGHT[self.study.unit]}".rstrip()
        headings = ("method", "setting", "answer", "status", value, "error", "seconds", "front")
        rows = [[*(row[name] for name in ("family", "setting", "target", "status")), *_numbers(row)] for row in self.rows]
        return title, headings, rows


@dataclass(frozen=True, eq=False, repr=False)
class SensitivityResult(Tabled):
    """The classic iteration for friction over a grid of its parameters, on one scene.

    `print(result)` shows one row for each run, and so does a notebook.

    Attributes
    ----------
    rows : list of dict
        One row for each run: "relaxation" and "slope", "status", "value" of a converged run, "last" value and the range "lowest" to
        "highest" of the last ten, all in N (N m) or as multipliers, number of "iterations", the residuals "violation", "dilation"
        and "penetration", "seconds". None is undefined.
    references : dict of str to (float, int or None)
        Value (N, N m or multiplier) of other methods by name, and their number of programmes; None for a method that solves none.
    study : Sensitivity
        Complete study.
    """

    rows: list[dict[str, Any]]
    references: References
    study: Sensitivity

    def plot(self) -> Picture:
        """Draw the figure of `crosscheck sensitivity`.

        Returns
        -------
        Picture
            Value and number of programmes against the relaxation.
        """
        return Picture(sensitivity_figure(self.study, self.references))

    def to_dataframe(self) -> Any:
        """Return the rows as a table of pandas.

        Returns
        -------
        pandas.DataFrame
            One row for each run.

        Raises
        ------
        SceneError
            Pandas is not installed.
        """
        return dataframe(self.rows)

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        value = f"{self.study.quantity} {OVER_WEIGHT[self.study.unit]}".rstrip()
        headings = ("slope", "relaxation", value, "programmes", "status")
        rows = [
            [number_text(row["slope"]), number_text(row["relaxation"]), self._shown(row["value"]), str(row["iterations"]), row["status"]]
            for row in self.rows
        ]
        rows += [[name, "", self._shown(value), number_text(count), ""] for name, (value, count) in self.references.items()]
        return f"classic iteration, {self.study.scene}", headings, rows

    def _shown(self, value: float | None) -> str:
        return number_text(None if value is None else value / self.study.divisor, 5)


def cost(scene: Scene | Path | str, yade: bool = True, quiet: bool = False, workers: int = 1) -> CostResult:
    """Measure error against time for all methods and settings, as `crosscheck cost` does.

    Parameters
    ----------
    scene : Scene, Path or str
        Scene, path of a scene file, or name of a shipped scene.
    yade : bool
        Whether to include YADE.
    quiet : bool
        Whether to write no progress to stderr.
    workers : int
        Number of runs of YADE side by side; with several of them, their seconds are measured on a busier machine.

    Returns
    -------
    CostResult
        One row for each setting.

    Raises
    ------
    SceneError
        The scene is invalid, or the structure has no answer.
    comparison.errors.YadeMissingError
        YADE is asked for and not installed.
    """
    count, runs_yade = whole_number("workers", workers, 1, MOST_WORKERS), true_or_false("yade", yade)
    with narration(quiet) as told:
        study = study_cost(load(scene), runs_yade, told, count)
    stored = cost_dict(study)
    return CostResult(stored["rungs"], stored["references"], study)


def sensitivity(scene: Scene | Path | str, quiet: bool = False) -> SensitivityResult:
    """Study how the classic iteration for friction depends on its own parameters, as `crosscheck sensitivity` does.

    Parameters
    ----------
    scene : Scene, Path or str
        Scene, path of a scene file, or name of a shipped scene.
    quiet : bool
        Whether to write no progress to stderr.

    Returns
    -------
    SensitivityResult
        One row for each run.

    Raises
    ------
    SceneError
        The scene is invalid, or the structure has no answer.
    """
    with narration(quiet) as told:
        study, references = study_sensitivity(load(scene), told)
    return SensitivityResult(sensitivity_study.sensitivity_dict(study)["trials"], references, study)


def _numbers(row: dict[str, Any]) -> list[str]:
    """Return value, error and seconds of a row of `CostResult` as texts, and the mark of the front."""
    return [*(number_text(row[name], digits) for name, digits in (("value", 6), ("error", 2), ("total", 2))), "●" if row["pareto"] else ""]
