"""Sensitivity of the classic iteration for non-associative friction to its parameters, on one scene."""

import dataclasses
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from rich.table import Table

from comparison.judge import without_undefined
from comparison.verdict import new_table, plain
from la_core.limit import ClassicParameters, ClassicSolution, Drive, Status, solve_sequentially
from la_core.model import Assembly
from la_core.scene import Scene
from la_core.text_table import number_text

RELAXATIONS = (0.2, 0.4, 0.6, 0.8, 1.0)
SLOPES = (0.001, 0.01, 0.1, 0.3, 1.0)
LATE = 10  # iterations: the value's range over the last ones shows whether an unconverged run oscillates or creeps
STATUS_WORDS = {
    Status.SOLVED: "[green]✓ converged[/]",
    Status.INACCURATE: "[yellow]? not converged[/]",
    Status.INFEASIBLE: "[red]✗ infeasible[/]",
    Status.FAILED: "[red]✗ failed[/]",
    Status.UNBOUNDED: "[red]✗ unbounded[/]",
}


@dataclass(frozen=True)
class Trial:
    """One run of the iteration. Values are in N (N m for a rotation), or multipliers; undefined numbers are NaN.

    Attributes
    ----------
    relaxation, slope : float
        The varied parameters b and a.
    status : Status
        SOLVED where the run converged, INACCURATE where it did not, else the status of its last programme.
    value : float
        Value of a converged run, else NaN.
    last : float
        Value of the last programme that was solved.
    lowest, highest : float
        Range of the last ten values.
    iterations : int
        Number of programmes.
    violation, dilation, penetration : float
        Residuals of the last forces and velocities, see `la_core.limit.ClassicSolution`.
    seconds : float
        Time of the run.
    """

    relaxation: float
    slope: float
    status: Status
    value: float
    last: float
    lowest: float
    highest: float
    iterations: int
    violation: float
    dilation: float
    penetration: float
    seconds: float


@dataclass(frozen=True)
class Sensitivity:
    """Runs over a grid of relaxation and slope.

    Attributes
    ----------
    scene : str
        Name of the scene.
    quantity : str
        "reaction" or "multiplier".
    unit : str
        Unit of the values, "" for a multiplier.
    divisor : float
        Weight W of the free blocks, N, or 1 for a multiplier; tables and figures show values over it.
    parameters : ClassicParameters
        Parameters that all runs share.
    trials : tuple of Trial
        The runs, slope by slope.
    """

    scene: str
    quantity: str
    unit: str
    divisor: float
    parameters: ClassicParameters
    trials: tuple[Trial, ...]


def study(
    scene: Scene,
    assembly: Assembly,
    relaxations: Sequence[float] = RELAXATIONS,
    slopes: Sequence[float] = SLOPES,
    parameters: ClassicParameters | None = None,
    progress: Callable[[int, int, Trial], None] | None = None,
) -> Sensitivity:
    """Run the classic iteration over a grid of its parameters, slope by slope.

    Parameters
    ----------
    scene : Scene
        The scene, for its name and its units.
    assembly : Assembly
        The structure to solve.
    relaxations, slopes : sequence of float
        Values of the varied parameters b and a.
    parameters : ClassicParameters, optional
        Parameters that all runs share; the standard ones by default.
    progress : callable, optional
        Called after each run with the number of finished runs, the number of all runs, and the finished run.
    """
    shared = parameters or ClassicParameters()
    drive = Drive.LIVE if assembly.has_live_load else Drive.YIELDING
    grid = list(product(slopes, relaxations))
    trials: list[Trial] = []
    for slope, relaxation in grid:
        chosen = dataclasses.replace(shared, slope=slope, relaxation=relaxation)
        trials.append(_trial(solve_sequentially(assembly, drive, chosen)))
        if progress is not None:
            progress(len(trials), len(grid), trials[-1])
    divisor = 1.0 if drive is Drive.LIVE else assembly.weight
    return Sensitivity(scene.name, scene.quantity, scene.unit, divisor, shared, tuple(trials))


def _trial(solution: ClassicSolution) -> Trial:
    late = solution.values[-LATE:]
    nan = float("nan")
    return Trial(
        relaxation=solution.parameters.relaxation,
        slope=solution.parameters.slope,
        status=solution.status,
        value=solution.value if solution.status is Status.SOLVED else nan,
        last=float(late[-1]) if len(late) else nan,
        lowest=float(late.min()) if len(late) else nan,
        highest=float(late.max()) if len(late) else nan,
        iterations=solution.iterations,
        violation=float(solution.violations[-1]) if len(late) else nan,
        dilation=solution.dilation,
        penetration=solution.penetration,
        seconds=solution.seconds,
    )


def sensitivity_dict(result: Sensitivity) -> dict[str, Any]:
    """Return the study as a JSON object; undefined numbers are null."""
    trials = [dataclasses.asdict(trial) | {"status": trial.status.value} for trial in result.trials]
    shared = dataclasses.asdict(result.parameters)
    kept = {name: shared[name] for name in ("cohesion", "iterations", "tolerance")}
    head = {"scene": result.scene, "quantity": result.quantity, "unit": result.unit, "divisor": result.divisor}
    return without_undefined(head | {"parameters": kept, "trials": trials})


def reaction_symbol(result: Sensitivity) -> str:
    """Return the symbol of the values over the divisor."""
    return {"": "multiplier", "N": "R/W", "N m": "R/W, m"}[result.unit]


def sensitivity_table(result: Sensitivity, references: Mapping[str, tuple[float, int | None]] | None = None) -> Table:
    """Return a table with one row for each run, then one for each other method.

    `references` has the value (N, N m or multiplier) and the number of programmes of other methods, by name; None for a method that
    solves none.
    """
    shared = result.parameters
    title = (
        f"classic iteration, {result.scene}: cohesion {number_text(shared.cohesion, 2)} and tolerance "
        f"{number_text(shared.tolerance, 2)} of the mean block weight, at most {shared.iterations} programmes"
    )
    headings = ("slope a", "relaxation b", reaction_symbol(result), "last ten", "programmes", "violation", "status", "s")
    table = new_table(*headings, title=title)
    for trial in result.trials:
        values = [_shown(trial.value / result.divisor, 5), _range(trial, result.divisor)]
        ends = [str(trial.iterations), _shown(trial.violation, 2), STATUS_WORDS[trial.status], number_text(trial.seconds, 2)]
        table.add_row(number_text(trial.slope), number_text(trial.relaxation), *values, *ends)
    for name, (value, programmes) in (references or {}).items():
        table.add_row(plain(name), "", _shown(value / result.divisor, 5), "", number_text(programmes), "", "", "")
    return table


def _range(trial: Trial, divisor: float) -> str:
    """Return the range of the last ten values as text; "" for a converged run."""
    if trial.status is Status.SOLVED:
        return ""
    return f"{_shown(trial.lowest / divisor, 4)} to {_shown(trial.highest / divisor, 4)}"


def _shown(value: float, digits: int) -> str:
    return number_text(value if math.isfinite(value) else None, digits)
