"""Helpers for tests of the judge: checks of a run and their verdicts by name, and a changed prediction."""

import dataclasses

from comparison.judge.checks.run_checks import check_run
from comparison.verdict.check import Check, Verdict
from comparison.yade import Results
from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb import CoulombSolution
from la_core.scene.scene import Scene, load_scene
from la_core.scene.shipped import find

REACTION, SIMILARITY, MOVING = "reaction against prediction", "mechanism similarity", "moving blocks"


def case_of(name: str) -> tuple[Scene, LimitAnalysis]:
    scene = load_scene(find(name))
    return scene, analyse(scene)


def coulomb_of(analysis: LimitAnalysis, **changes: object) -> CoulombSolution:
    assert analysis.coulomb is not None
    return dataclasses.replace(analysis.coulomb, **changes)  # type: ignore[arg-type]


def judged(analysis: LimitAnalysis, run: Run) -> list[Check]:
    return check_run(Results(analysis, run))


def named(name: str, found: list[Check]) -> Check:
    return next(check for check in found if check.name.startswith(name))


def verdict_of(name: str, found: list[Check]) -> Verdict:
    return named(name, found).verdict
