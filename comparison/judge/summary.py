"""What a scene came to, as the JSON object of `comparison.json` and `solve --json`: undefined numbers are null."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Any

from comparison.judge.check import Check, overall
from comparison.judge.effects_table import effects_summary
from comparison.judge.energy import energy_summary
from comparison.judge.requested_accuracy import accuracy_summary
from comparison.yade import Run
from la_core.analysis import LimitAnalysis, associated_values, coulomb_values, path_values
from la_core.exchange import RUN_FIELDS
from la_core.measures import measure
from la_core.model import assemble
from la_core.scene import Scene


def limit_analysis_summary(scene: Scene, analysis: LimitAnalysis) -> dict[str, Any]:
    """Scene, counts, effects and limit analysis: what `solve --json` prints."""
    assembly = analysis.assembly
    whole = assemble(scene).with_inset(scene, assembly.inset) if assembly.aside.any() else assembly
    summary = {
        "scene": scene.name,
        "title": scene.title,
        "source": scene.source,
        "weight": scene.weight,
        "unit": scene.unit,
        "free_blocks": int(scene.blocks.free.sum()),
        "interfaces": len(whole.interfaces),
        "contact_points": len(whole.points),
        "effects": effects_summary(scene, assembly, analysis),
        "expected": scene.expected.model_dump() if scene.expected else None,
        "joints": dataclasses.asdict(analysis.stiffness),
        "limit_analysis": {
            "associated": associated_values(scene, analysis),
            "coulomb": coulomb_values(scene, analysis),
            "path": path_values(scene, analysis),
        },
        "mechanism_measures": dict(_measures(analysis)),
        "accuracy": accuracy_summary(scene, analysis, None),
    }
    return without_undefined(summary)


def _measures(analysis: LimitAnalysis, run: Run | None = None) -> Iterator[tuple[str, dict[str, Any]]]:
    """Measures of each method's mechanism, without its arrays."""
    assembly, main = analysis.assembly, analysis.rounded[analysis.main]
    found = {"associated": (main.twists, main.forces)}
    if analysis.coulomb is not None:
        found["coulomb"] = (analysis.coulomb.twists, analysis.coulomb.forces)
    if run is not None:
        found["yade"] = (run.mechanism(), run.plateau_forces())
    for method, (twists, forces) in found.items():
        measures = vars(measure(assembly, twists, forces))
        yield method, {name: value for name, value in measures.items() if isinstance(value, float)}


def yade_summary(run: Run) -> dict[str, Any]:
    """YADE's outcome, by the names of `la_core.exchange`."""
    return dict(run.result)


def without_run(status: str, message: str) -> dict[str, Any]:
    """YADE's outcome where there is no run: why, and null for every value."""
    names = (field.path.removeprefix("result/") for field in RUN_FIELDS if field.path.startswith("result/"))
    return {**dict.fromkeys(names), "status": status, "message": message}


def comparison_summary(
    scene: Scene,
    analysis: LimitAnalysis,
    yade: dict[str, Any] | None,
    run: Run | None,
    checks: list[Check],
    notes: list[str],
) -> dict[str, Any]:
    """The whole comparison: limit analysis, YADE, every check, the verdict and its reason."""
    verdict, reason = overall(checks)
    summary = limit_analysis_summary(scene, analysis)
    summary |= {
        "mechanism_measures": dict(_measures(analysis, run)),
        "yade": yade,
        "accuracy": accuracy_summary(scene, analysis, run),
        "energy": energy_summary(analysis.assembly, run) if run else None,
        "checks": [dataclasses.asdict(check) for check in checks],
        "verdict": verdict.value if verdict else None,
        "reason": reason,
        "notes": notes,
        "settings": run.settings if run else None,
    }
    return without_undefined(summary)


def without_undefined(value: Any) -> Any:
    """The same structure with null for every number that is not finite."""
    if isinstance(value, dict):
        return {key: without_undefined(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [without_undefined(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
