"""The results of a scene as the JSON object of `comparison.json` and `solve --json`; undefined numbers are null."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from comparison.judge.checks.curves import curves_summary
from comparison.judge.checks.energy import energy_summary
from comparison.judge.checks.next_steps import for_fine_paths
from comparison.judge.checks.tolerances import LEAST_REACTION, least_reaction
from comparison.judge.effects_table import effects_summary
from comparison.judge.first_prediction import first_prediction_summary
from comparison.judge.greatest_load import greatest_load_summary
from comparison.judge.requested_accuracy import accuracy_summary
from comparison.run_folder import is_second_attempt
from comparison.verdict import BEARS_NOTHING, CARRIED_OUT, Check, Conclusion, conclusion, named_blocks
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis, answer_values
from la_core.exchange import RUN_FIELDS
from la_core.geometry import nearest_gap
from la_core.limit import Status
from la_core.measures import measure
from la_core.model import Assembly, connected_to_held
from la_core.scene import Scene, geometry_changes, tilt_angles
from la_core.text_table import number_text


def limit_analysis_summary(analysis: LimitAnalysis) -> dict[str, Any]:
    """Return scene, counts, effects and limit analysis: the object that `solve --json` prints."""
    return without_undefined(_summary(Results(analysis)))


def _summary(results: Results) -> dict[str, Any]:
    """Return scene, counts, effects and limit analysis; measures, accuracy and greatest load include YADE's run, if there is one."""
    analysis, scene = results.analysis, results.analysis.scene
    assembly, whole = analysis.assembly, analysis.whole
    return {
        "scene": scene.name,
        "title": scene.title,
        "source": scene.source,
        "warnings": list(scene.warnings),
        "weight": scene.weight,
        "unit": scene.unit,
        "least_tolerance": least_reaction(analysis),
        "free_blocks": int(scene.blocks.free.sum()),
        "interfaces": len(whole.interfaces),
        "contact_points": len(whole.points),
        "geometry": geometry_changes(scene, whole.slivers, whole.short_joints),
        "effects": effects_summary(scene, whole, assembly, analysis),
        "expected": scene.expected.model_dump() if scene.expected else None,
        "joints": dataclasses.asdict(analysis.stiffness),
        "limit_analysis": limit_analysis_values(analysis),
        "mechanism_measures": dict(_measures(results)),
        "accuracy": accuracy_summary(results),
        "greatest_load": greatest_load_summary(results),
    }


def limit_analysis_values(analysis: LimitAnalysis) -> dict[str, Any]:
    """Return the values of limit analysis, a part of its summary: the tables that `solve` prints."""
    return without_undefined(answer_values(analysis))


def _measures(results: Results) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the measures of each method's mechanism, by method."""
    analysis, run = results.analysis, results.run
    assembly, main = analysis.assembly, analysis.bounds[analysis.main]
    mechanisms = {"associated": (main.twists, main.forces)}
    if analysis.coulomb is not None:
        mechanisms["coulomb"] = (analysis.coulomb.twists, analysis.coulomb.forces)
    if run is not None:
        mechanisms["yade"] = (results.per_drive(run.mechanism()), run.plateau_forces())
    for method, (twists, forces) in mechanisms.items():
        measures = vars(measure(assembly, twists, forces))
        yield method, {name: value for name, value in measures.items() if isinstance(value, float)}


def yade_summary(run: Run) -> dict[str, Any]:
    """Return YADE's result by the names of `la_core.exchange`."""
    return dataclasses.asdict(run.result)


def without_run(status: str, message: str) -> dict[str, Any]:
    """Return YADE's result without a run: status, message, and null for every value."""
    names = (field.path.removeprefix("result/") for field in RUN_FIELDS if field.path.startswith("result/"))
    return {**dict.fromkeys(names), "status": status, "message": message}


def _of_live_load(scene: Scene, yade: dict[str, Any]) -> dict[str, Any]:
    """Return YADE's multiplier under a live load, and the angle of a tilt; empty for a settlement."""
    value, uncertainty = yade.get("reaction"), yade.get("uncertainty")
    if scene.live is None:
        return {}
    return {"multiplier": value} | tilt_angles(scene.tilt, value, math.nan if uncertainty is None else uncertainty)


def conclusion_of(analysis: LimitAnalysis, checks: list[Check], yade: dict[str, Any] | None) -> Conclusion:
    """Return the conclusion from limit analysis, every check and the summary of YADE (None if YADE was not requested)."""
    scene, main = analysis.scene, analysis.bounds[analysis.main]
    falling = main.falling if main.status is Status.INFEASIBLE else None
    is_loaded = len(scene.loads) > 0 or scene.ties is not None
    stands_sharp = analysis.sharp.bounds[analysis.main].status is Status.SOLVED
    rounded = analysis.assembly.inset if falling is not None and stands_sharp else 0.0
    cause = "" if falling is None else _missing_joints(analysis.whole, falling)
    has_run = yade is None or yade["status"] in CARRIED_OUT
    step = _where_nothing_is_borne(analysis) if has_run else ""
    concluded = conclusion(checks, yade, falling, is_second_attempt(scene), is_loaded, rounded, cause, step)
    return dataclasses.replace(concluded, next_step=for_fine_paths(concluded.next_step, scene))


def _where_nothing_is_borne(analysis: LimitAnalysis) -> str:
    """Return the next step if the multiplier is 0 to within the floor of its tolerance; "" otherwise."""
    bound, sharp = analysis.bounds[analysis.main], analysis.sharp.bounds[analysis.main]
    if analysis.scene.live is None or bound.status is not Status.SOLVED or abs(bound.value) > LEAST_REACTION:
        return ""
    if sharp.status is not Status.SOLVED or not sharp.value > LEAST_REACTION:
        return BEARS_NOTHING
    edges = f"With sharp edges the multiplier is {number_text(sharp.value, 3)}: a smaller [joint] inset loses less of it."
    return f"{BEARS_NOTHING} {edges}"


def _missing_joints(assembly: Assembly, falling: tuple[str, ...]) -> str:
    """Return a sentence on the blocks that no chain of joints connects with the ground or a support; "" without such blocks."""
    loose = np.flatnonzero(assembly.blocks.free & ~connected_to_held(assembly))
    if not len(loose):
        return ""
    others = np.setdiff1d(np.arange(len(assembly.blocks)), loose)
    names = [assembly.blocks.names[block] for block in loose]
    blocks = "them" if set(names) == set(falling) else named_blocks(names)
    return f"No joint connects {blocks} with the ground or a support: {nearest_gap(assembly.blocks, loose, others)}."


def comparison_summary(
    results: Results, yade: dict[str, Any] | None, checks: list[Check], notes: list[str], first: dict[str, Any] | None = None
) -> dict[str, Any]:
    """Return the content of `comparison.json`: limit analysis, YADE, every check, the verdict and its reason.

    Parameters
    ----------
    results : Results
        Limit analysis and YADE's run, if there is one.
    yade : dict or None
        Summary of YADE's run, or the reason why there is no run; None if YADE was not requested.
    checks : list of Check
        All checks; verdict, reason, next step and remarks follow from them.
    notes : list of str
        Sentences for the reader of the report.
    first : dict or None
        Answer of limit analysis before YADE ran, see `first_prediction`; None if no effect was restored since.
    """
    analysis, run = results.analysis, results.run
    concluded = conclusion_of(analysis, checks, yade)
    summary = _summary(results) | {
        "first_prediction": first_prediction_summary(first, analysis),
        "yade": yade and yade | _of_live_load(analysis.scene, yade),
        "curves": curves_summary(results),
        "energy": energy_summary(analysis.assembly, run) if run else None,
        "checks": [dataclasses.asdict(check) for check in checks],
        "verdict": concluded.verdict.value if concluded.verdict else None,
        "reason": concluded.reason,
        "next_step": concluded.next_step,
        "remarks": list(concluded.remarks),
        "notes": notes,
        "settings": dict(run.settings) if run else None,
    }
    return without_undefined(summary)


def without_undefined(value: Any) -> Any:
    """Return a copy of nested dicts and lists with None for every number that is not finite."""
    if isinstance(value, dict):
        return {key: without_undefined(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [without_undefined(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
