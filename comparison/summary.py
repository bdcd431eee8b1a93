"""What a scene came to, as the JSON object of `comparison.json` and `solve --json`: undefined numbers are null."""

import dataclasses
import math
from collections.abc import Iterable, Iterator
from typing import Any

from comparison.bought import accuracy_summary
from comparison.check import Check, overall
from comparison.effects_table import effects_summary
from comparison.energy import energy_summary
from comparison.record import Run
from la_core.analysis import LimitAnalysis
from la_core.assembly import assemble
from la_core.dissipation import measure
from la_core.exchange import RUN_FIELDS
from la_core.limit import Drive, Solution, Status
from la_core.scene import Scene

COULOMB_EVIDENCE = ("drift", "dilatancy_residual", "strain_residual", "equilibrium_residual", "cone_violation")
EVIDENCE = ("equilibrium_residual", "cone_violation", "mechanism_violation", "duality_gap")


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
            "associated": _associated(scene, analysis),
            "coulomb": _coulomb(scene, analysis),
            "path": _path(scene, analysis),
        },
        "mechanism_measures": dict(_measures(analysis)),
        "accuracy": accuracy_summary(scene, analysis, None),
    }
    return without_undefined(summary)


def _associated(scene: Scene, analysis: LimitAnalysis) -> dict[str, Any]:
    """The associated answer: with the scene's inset, and sharp; the shared inset's apart where the scene has none."""
    main = analysis.main
    shown = analysis.sharp if scene.inset == 0.0 else analysis.rounded
    solution = shown[main]
    values: dict[str, Any] = {"status": solution.status.value, scene.quantity: solution.value}
    if main is Drive.YIELDING:
        values["reaction_max"] = shown[Drive.PUSHING].value
        values["reaction_max_status"] = shown[Drive.PUSHING].status.value
        values["reaction_max_sharp"] = analysis.sharp[Drive.PUSHING].value
    values[f"{scene.quantity}_sharp"] = analysis.sharp[main].value
    values["inset"] = analysis.assembly.inset if scene.inset else 0.0
    if analysis.assembly.inset != values["inset"]:
        values["shared_inset"] = {"inset": analysis.assembly.inset, **{_NAMES[d]: s.value for d, s in analysis.rounded.items()}}
    values |= {name: _worst(getattr(s, name) for s in shown.values()) for name in EVIDENCE}
    values["iterations"] = solution.iterations
    values["seconds"] = sum(s.seconds for s in _distinct(analysis))
    if solution.status is Status.INFEASIBLE:
        values["falling"] = list(solution.falling)
    return values


def _coulomb(scene: Scene, analysis: LimitAnalysis) -> dict[str, Any] | None:
    """The Coulomb answer: with the scene's inset, and sharp; the shared inset's apart where the scene has none."""
    rounded, sharp, name = analysis.coulomb, analysis.coulomb_sharp, scene.quantity
    if rounded is None or sharp is None:
        return None
    shown = sharp if scene.inset == 0.0 else rounded
    values: dict[str, Any] = {"status": shown.status.value, name: shown.value, f"{name}_interval": list(shown.interval)}
    values |= {f"{name}_sharp": sharp.value, f"{name}_interval_sharp": list(sharp.interval)}
    if scene.inset == 0.0 and analysis.assembly.inset:
        values["shared_inset"] = {"inset": analysis.assembly.inset, name: rounded.value, f"{name}_interval": list(rounded.interval)}
    values |= {f"{name}_at_rest": shown.at_rest} | {evidence: getattr(shown, evidence) for evidence in COULOMB_EVIDENCE}
    return values | {"iterations": shown.iterations, "seconds": sum(s.seconds for s in {id(s): s for s in (rounded, sharp)}.values())}


def _path(scene: Scene, analysis: LimitAnalysis) -> dict[str, Any] | None:
    """The curve from rest to the plateau, point by point."""
    path = analysis.path
    if path is None:
        return None
    names = {"settlement": "settlement", "value": scene.quantity, "strain_residual": "strain_residual", "converged": "converged"}
    values = {shown: getattr(path, name).tolist() for name, shown in names.items()}
    values["converged"] = [bool(converged) for converged in values["converged"]]
    return values | {"solves": path.solves.tolist(), "seconds": path.seconds}


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


_NAMES = {Drive.YIELDING: "reaction", Drive.PUSHING: "reaction_max", Drive.LIVE: "multiplier"}


def _worst(residuals: Iterable[float]) -> float:
    """The largest residual of the solutions that have one, NaN where none has."""
    return max((residual for residual in residuals if math.isfinite(residual)), default=math.nan)


def _distinct(analysis: LimitAnalysis) -> list[Solution]:
    """Every solution that was computed, once."""
    return list({id(s): s for s in (*analysis.rounded.values(), *analysis.sharp.values())}.values())


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
