"""What limit analysis says of a scene, by name: the numbers that are printed and stored; NaN where one does not exist."""

import math
from collections.abc import Iterable
from typing import Any

from la_core.analysis.result import LimitAnalysis
from la_core.limit import Drive, Solution, Status
from la_core.scene import Scene

COULOMB_EVIDENCE = ("drift", "dilatancy_residual", "strain_residual", "equilibrium_residual", "cone_violation")
EVIDENCE = ("equilibrium_residual", "cone_violation", "mechanism_violation", "duality_gap")


def associated_values(scene: Scene, analysis: LimitAnalysis) -> dict[str, Any]:
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


def coulomb_values(scene: Scene, analysis: LimitAnalysis) -> dict[str, Any] | None:
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
    return values | {
        "iterations": shown.iterations,
        "steps": shown.steps,
        "seconds": sum(s.seconds for s in {id(s): s for s in (rounded, sharp)}.values()),
    }


def path_values(scene: Scene, analysis: LimitAnalysis) -> dict[str, Any] | None:
    """The curve from rest to the plateau, point by point."""
    path = analysis.path
    if path is None:
        return None
    names = {"settlement": "settlement", "value": scene.quantity, "strain_residual": "strain_residual", "converged": "converged"}
    values = {shown: getattr(path, name).tolist() for name, shown in names.items()}
    values["converged"] = [bool(converged) for converged in values["converged"]]
    return values | {"solves": path.solves.tolist(), "seconds": path.seconds}


_NAMES = {Drive.YIELDING: "reaction", Drive.PUSHING: "reaction_max", Drive.LIVE: "multiplier"}


def _worst(residuals: Iterable[float]) -> float:
    """The largest residual of the solutions that have one, NaN where none has."""
    return max((residual for residual in residuals if math.isfinite(residual)), default=math.nan)


def _distinct(analysis: LimitAnalysis) -> list[Solution]:
    """Every solution that was computed, once."""
    return list({id(s): s for s in (*analysis.rounded.values(), *analysis.sharp.values())}.values())
