"""The plane answer, held against the model in space that was left out."""

from collections.abc import Iterator

from comparison.check import Check, Verdict
from la_core.analysis import LimitAnalysis
from la_core.limit import Status, residual_in_space

IN_SPACE = 1e-5  # of the mean block weight, or of the fastest block: ten times what limit analysis leaves in the plane


def check_plane(analysis: LimitAnalysis) -> Iterator[Check]:
    """Lifted to the model in space, a plane answer has to be an answer there; nothing for a model in space."""
    least = analysis.rounded[analysis.main]
    if not analysis.assembly.effects.plane or least.status is not Status.SOLVED:
        return
    worst = residual_in_space(analysis.assembly, least.twists, least.forces)
    holds = worst <= IN_SPACE
    reason = "" if holds else "In space the plane answer is out of equilibrium or blocks penetrate; ask for effects.plane = false."
    verdict = Verdict.AGREE if holds else Verdict.INCONCLUSIVE
    yield Check("plane answer in space", verdict, worst, None, None, IN_SPACE, "of a block", reason)
