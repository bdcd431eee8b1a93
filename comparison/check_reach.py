"""What limit analysis set aside, held against YADE's plateau: it was proven to rest beside its own answer only."""

from collections.abc import Iterator
from dataclasses import replace

from comparison.check import Check, Verdict
from comparison.record import Run
from comparison.tolerances import UNBALANCED
from la_core.analysis import LimitAnalysis, reach
from la_core.model import assemble
from la_core.scene import Scene


def check_reach(scene: Scene, analysis: LimitAnalysis, run: Run) -> Iterator[Check]:
    """Whether the blocks set aside stand under YADE's forces, as far as its state is balanced, and its mechanism ends before them.

    Nothing where all were modelled.
    """
    part = analysis.assembly
    if not part.effects.reach:
        return
    whole = replace(assemble(scene).with_inset(scene, part.inset), effects=part.effects)
    obstacle = reach.obstacle(whole, part, run.mechanism(), run.plateau_forces(), UNBALANCED)
    verdict = Verdict.INCONCLUSIVE if obstacle else Verdict.AGREE
    reason = f"In YADE {obstacle}: model the whole structure ([effects] reach = false)." if obstacle else ""
    yield Check("what was set aside stands", verdict, reason=reason)
