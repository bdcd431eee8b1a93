"""Repeat a Coulomb prediction that YADE contradicts in shorter steps, before the verdict."""

from collections.abc import Iterator

from comparison.judge import INTERVAL_CHECK, REACTION_CHECK, Verdict, check_prediction
from comparison.workflow import restored_effects
from comparison.yade import Results
from la_core.analysis import LimitAnalysis
from la_core.coulomb import FIRST_SAGS, STEPS, PredictionSettings

# Steps, and travel of the first over the elastic sag. Remaining dilation may create a spurious thrust that holds blocks up; more steps
# leave less of it. In a first step that is too long, blocks may jam that slide past each other in shorter ones. The order was chosen on
# cases of the campaign seed_paper, so their agreement does not confirm it; finer values scatter by per cents and need not converge.
FINER = ((2 * STEPS, FIRST_SAGS), (2 * STEPS, FIRST_SAGS / 8.0), (4 * STEPS, FIRST_SAGS / 8.0), (8 * STEPS, FIRST_SAGS / 64.0))


def predictions(results: Results) -> Iterator[tuple[int, LimitAnalysis]]:
    """Yield the number of steps and the analysis with them, each finer than the last, while YADE's plateau contradicts the prediction.

    Nothing where the prediction was made in more steps before, or where a requested accuracy chose its steps.
    """
    analysis, run = results.analysis, results.recorded
    if run.status != "plateau" or analysis.accuracy or analysis.coulomb is None or analysis.coulomb.steps != STEPS:
        return
    for steps, first_sags in FINER:
        if not _is_contradicted(Results(analysis, run)):
            return
        finer = restored_effects.analyse_with(analysis, restored_effects.restored(analysis), PredictionSettings(steps, first_sags))
        if finer.coulomb is None or finer.assembly.aside.tolist() != analysis.assembly.aside.tolist():
            return  # another model, which the run was not made from
        analysis = finer
        yield steps, analysis


def note(analysis: LimitAnalysis) -> list[str]:
    """Return a note for the reader on a repeated prediction, which is no longer blind to YADE; no note for any other."""
    if analysis.accuracy or analysis.coulomb is None or analysis.coulomb.steps in (0, STEPS):
        return []
    return [
        f"YADE contradicted the Coulomb prediction in {STEPS} steps, so it was repeated in up to {analysis.coulomb.steps} steps, "
        "until YADE no longer contradicted it, or the finest setting was reached. "
        "An agreement with it is weaker evidence than one with a prediction made without knowledge of YADE's result."
    ]


def _is_contradicted(results: Results) -> bool:
    """Return whether YADE disagrees, or misses both the prediction and its mechanism's interval, by whichever mechanism."""
    checks = list(check_prediction(results))
    missed = [check.name for check in checks if None not in (check.difference, check.tolerance) and check.verdict is not Verdict.AGREE]
    return any(check.verdict is Verdict.DISAGREE for check in checks) or {REACTION_CHECK, INTERVAL_CHECK} <= set(missed)
