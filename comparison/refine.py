"""Before YADE is said to disagree with the Coulomb prediction, the prediction is held against itself: again in more and shorter steps."""

from collections.abc import Iterator

from comparison import turn_back
from comparison.check import Verdict
from comparison.check_prediction import INTERVAL_CHECK, REACTION_CHECK, check_prediction
from comparison.record import Run
from comparison.tolerances import HISTORY, least_reaction
from la_core.accuracy import MOST_STEPS
from la_core.analysis import LimitAnalysis
from la_core.coulomb import STEPS
from la_core.scene import Scene


def predictions(scene: Scene, analysis: LimitAnalysis, run: Run) -> Iterator[tuple[int, LimitAnalysis]]:
    """Twice the steps and the analysis with them, and again, while a plateau of YADE's contradicts it and the last doubling still moved it.

    Nothing where the prediction was made in more steps before, or by an accuracy that was asked for.
    """
    steps, moves = STEPS, True
    if run.status != "plateau" or analysis.purchase or analysis.coulomb is None or analysis.coulomb.steps != STEPS:
        return
    while moves and steps < MOST_STEPS and _is_contradicted(scene, analysis, run):
        steps *= 2
        finer = turn_back.analyse_with(scene, turn_back.called_back(analysis), steps)
        if finer.coulomb is None or finer.assembly.aside.tolist() != analysis.assembly.aside.tolist():
            return  # another model, which the run was not made from
        change = abs(finer.coulomb.value - analysis.coulomb.value)
        moves = not change <= max(HISTORY * abs(finer.coulomb.value), least_reaction(scene, finer))
        analysis = finer
        yield steps, analysis


def _is_contradicted(scene: Scene, analysis: LimitAnalysis, run: Run) -> bool:
    """Whether YADE disagrees, or misses the prediction and its mechanism's interval as well, be it by another mechanism."""
    checks = list(check_prediction(scene, analysis, run))
    missed = [check.name for check in checks if None not in (check.difference, check.tolerance) and check.verdict is not Verdict.AGREE]
    return any(check.verdict is Verdict.DISAGREE for check in checks) or {REACTION_CHECK, INTERVAL_CHECK} <= set(missed)
