"""Results of limit analysis for one scene, and the record of a requested accuracy: every attempt, its estimated error and its cost."""

import json
import math
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field, replace
from typing import Any

from la_core.coulomb import CoulombSolution, EquilibriumPath, interval_status
from la_core.geometry import Held
from la_core.limit import Drive, Solution, Status
from la_core.model import Assembly, Effects, JointStiffness
from la_core.scene import Scene, tilt_angles


@dataclass(frozen=True)
class Attempt:
    """One run of one method at given settings.

    Attributes
    ----------
    settings : dict of str to float
        Settings of the run, by name.
    value : float
        Answer: a reaction (N, N m) or a multiplier.
    parts : dict of str to float
        Estimated relative error by its source; NaN where undefined.
    seconds : float
        Wall time, s.
    """

    settings: dict[str, float]
    value: float
    parts: dict[str, float]
    seconds: float

    @property
    def error(self) -> float:
        """Estimated relative error: the sum of its parts, which is the worst case."""
        return sum(self.parts.values())

    def is_within(self, accuracy: float) -> bool:
        """Whether the estimated error is at most `accuracy`; False for an undefined error."""
        return bool(self.error <= accuracy)


@dataclass(frozen=True)
class AccuracyRecord:
    """Attempts of both methods to reach a requested accuracy; the last attempt of each method counts.

    Attributes
    ----------
    asked : float
        Requested relative accuracy.
    limit_analysis, yade : tuple of Attempt
        Attempts of each method.
    settings : dict of str to float
        YADE settings of the next run, or of the last one, that replace the derived ones.
    """

    asked: float
    limit_analysis: tuple[Attempt, ...] = ()
    yade: tuple[Attempt, ...] = ()
    settings: dict[str, float] = field(default_factory=dict)


def record_to_text(record: AccuracyRecord | None) -> str:
    """Write a record as a JSON object, None as "null"."""
    return json.dumps(None if record is None else asdict(record), sort_keys=True)


def record_from_text(text: str) -> AccuracyRecord | None:
    """Read a record, or None, from a text that `record_to_text` wrote."""
    stored = json.loads(text)
    if stored is None:
        return None
    attempts = {method: tuple(Attempt(**attempt) for attempt in stored[method]) for method in ("limit_analysis", "yade")}
    return AccuracyRecord(stored["asked"], settings=stored["settings"], **attempts)


@dataclass(frozen=True, eq=False, repr=False)
class Answers(Held):
    """Bounds and prediction at one inset.

    Attributes
    ----------
    assembly : Assembly
        Contact points and modelled effects; those of the reduced region where blocks are set aside.
    bounds : dict of Drive to Solution
        Associated solution for each drive, always of the whole structure.
    coulomb : CoulombSolution or None
        Prediction with friction without dilatancy. None where only bounds are computed.
    """

    assembly: Assembly
    bounds: dict[Drive, Solution]
    coulomb: CoulombSolution | None = None

    @property
    def main(self) -> Drive:
        """Drive of the scene: the live load, or the settlement of the support."""
        return Drive.LIVE if Drive.LIVE in self.bounds else Drive.YIELDING

    @property
    def sharpest(self) -> Solution | CoulombSolution:
        """Prediction, or the bound of the main drive where there is no prediction."""
        return self.coulomb or self.bounds[self.main]

    @property
    def is_without_bound(self) -> bool:
        """Whether only the prediction has a value: dilatancy locks the blocks, and without it they move."""
        locks = self.bounds[self.main].status is Status.UNBOUNDED
        return locks and self.coulomb is not None and self.coulomb.status is Status.SOLVED


@dataclass(frozen=True, eq=False)
class LimitAnalysis(Held):
    """Complete results of limit analysis, with the scene and the model that they belong to.

    The shared inset is the inset of both methods: the scene's, or that of YADE where the scene has inset 0.

    Attributes
    ----------
    scene : Scene
        Scene that was analysed.
    whole : Assembly
        Assembly with every free block, at the shared inset.
    at_inset : Answers
        Answers at the shared inset.
    sharp : Answers
        Answers for sharp edges (inset 0); the same object as `at_inset` where both insets are equal. It has no
        prediction where joints slide and the scene's edges are rounded: sharp joints then slide in another order, and
        the value belongs to another history of friction, not to other lever arms.
    stiffness : JointStiffness
        Stiffness of the joints at the shared inset.
    least_gap : float
        Lower bound of the gap between blocks without a joint, m; NaN where it was not computed. See
        `la_core.model.decide_dem_effects`.
    path : EquilibriumPath or None
        Curve from rest to the plateau at the shared inset. None without a request.
    accuracy : AccuracyRecord or None
        Attempts to reach the requested accuracy. None without a request.
    """

    scene: Scene
    whole: Assembly
    at_inset: Answers
    sharp: Answers
    stiffness: JointStiffness
    least_gap: float = float("nan")
    path: EquilibriumPath | None = None
    accuracy: AccuracyRecord | None = None

    def __repr__(self) -> str:
        """Return one line: the arrays would fill pages."""
        bounds = self.bounds[self.main]
        predicted = "" if self.coulomb is None else f", prediction {self.coulomb.value:.6g}"
        return f"<LimitAnalysis of {self.scene.name}: {bounds.status}, bound {bounds.value:.6g}{predicted} {self.scene.unit}>"

    @property
    def main(self) -> Drive:
        """Drive of the scene: the live load, or the settlement of the support."""
        return self.at_inset.main

    @property
    def assembly(self) -> Assembly:
        """Modelled assembly at the shared inset, without the blocks that are set aside."""
        return self.at_inset.assembly

    @property
    def bounds(self) -> dict[Drive, Solution]:
        """Associated solution for each drive, at the shared inset."""
        return self.at_inset.bounds

    @property
    def coulomb(self) -> CoulombSolution | None:
        """Prediction at the shared inset; None where only bounds are computed."""
        return self.at_inset.coulomb

    @property
    def is_without_bound(self) -> bool:
        """Whether only the prediction has a value at the shared inset, see `Answers.is_without_bound`."""
        return self.at_inset.is_without_bound

    @property
    def main_answer(self) -> Solution | CoulombSolution:
        """Bound of the main drive at the shared inset, or the prediction where only that has a value."""
        return self.at_inset.sharpest if self.is_without_bound else self.bounds[self.main]

    def with_effects(self, effects: Effects) -> "LimitAnalysis":
        """Copy the analysis with these effects, and their reasons, in all of its assemblies."""
        at_inset = replace(self.at_inset, assembly=replace(self.assembly, effects=effects))
        sharp = at_inset if self.sharp is self.at_inset else replace(self.sharp, assembly=replace(self.sharp.assembly, effects=effects))
        return replace(self, whole=replace(self.whole, effects=effects), at_inset=at_inset, sharp=sharp)

    @property
    def printed(self) -> Answers:
        """Answers at the scene's own inset; tables and JSON show these."""
        return self.sharp if self.scene.inset == 0.0 else self.at_inset


def answer_values(analysis: LimitAnalysis) -> dict[str, Any]:
    """Return all printed and stored values with the keys of `crosscheck solve --json`; NaN or None if undefined."""
    return {
        "associated": associated_values(analysis),
        "coulomb": coulomb_values(analysis),
        "path": path_values(analysis),
    }


COULOMB_EVIDENCE = ("drift", "dilatancy_residual", "strain_residual", "sliding_residual", "equilibrium_residual", "cone_violation")
EVIDENCE = ("equilibrium_residual", "cone_violation", "mechanism_violation", "duality_gap")


def associated_values(analysis: LimitAnalysis) -> dict[str, Any]:
    """Return the values of the associated problem by their JSON keys.

    They hold at the scene's inset, those with `_sharp` for sharp edges. "shared_inset" holds the values at the inset of
    both methods where the scene's inset is 0. Residuals are relative to the mean block weight, see `Solution`.
    """
    scene, main, printed = analysis.scene, analysis.main, analysis.printed.bounds
    solution = printed[main]
    values: dict[str, Any] = {"status": solution.status.value, scene.quantity: solution.value}
    if main is Drive.YIELDING:
        values["reaction_max"] = printed[Drive.PUSHING].value
        values["reaction_max_status"] = printed[Drive.PUSHING].status.value
        values["reaction_max_sharp"] = analysis.sharp.bounds[Drive.PUSHING].value
    values[f"{scene.quantity}_sharp"] = analysis.sharp.bounds[main].value
    values["inset"] = analysis.assembly.inset if scene.inset else 0.0
    if analysis.assembly.inset != values["inset"]:
        bounds = {drive.key: bound.value for drive, bound in analysis.bounds.items()}
        values["shared_inset"] = {"inset": analysis.assembly.inset, **bounds, **tilt_angles(scene.tilt, analysis.bounds[main].value)}
    values |= tilt_angles(scene.tilt, solution.value)
    values |= {name: _worst(getattr(s, name) for s in printed.values()) for name in EVIDENCE}
    values["iterations"] = solution.iterations
    values["seconds"] = sum(s.seconds for s in _distinct(analysis))
    if solution.status is Status.INFEASIBLE:
        values["falling"] = list(solution.falling)
    return values


def coulomb_values(analysis: LimitAnalysis) -> dict[str, Any] | None:
    """Return the prediction's values by their JSON keys, insets as in `associated_values`; None without a prediction."""
    scene, name = analysis.scene, analysis.scene.quantity
    rounded, sharp, printed = analysis.at_inset.coulomb, analysis.sharp.coulomb, analysis.printed.coulomb
    if rounded is None or printed is None:
        return None
    values: dict[str, Any] = {"status": printed.status.value, name: printed.value, f"{name}_interval": list(printed.interval)}
    values |= {"interval_status": interval_status(printed.interval)}
    values |= _stated(printed)
    values[f"{name}_sharp"] = math.nan if sharp is None else sharp.value
    values[f"{name}_interval_sharp"] = [math.nan, math.nan] if sharp is None else list(sharp.interval)
    if scene.inset == 0.0 and analysis.assembly.inset:
        shared = {"inset": analysis.assembly.inset, name: rounded.value, f"{name}_interval": list(rounded.interval)}
        shared |= tilt_angles(scene.tilt, rounded.value, rounded.uncertainty)
        shared["interval_status"] = interval_status(rounded.interval)
        values["shared_inset"] = shared | _stated(rounded)
    values |= tilt_angles(scene.tilt, printed.value, printed.uncertainty)
    values |= {f"{name}_at_rest": printed.at_rest} | {evidence: getattr(printed, evidence) for evidence in COULOMB_EVIDENCE}
    return values | {
        "iterations": printed.iterations,
        "steps": printed.steps,
        "travel": printed.travel,
        "viscosities": printed.viscosities.tolist(),
        "curve": {"settlement": printed.path_settlement.tolist(), name: printed.path_value.tolist()},
        "seconds": sum(s.seconds for s in {id(s): s for s in (rounded, sharp) if s is not None}.values()),
    }


def _stated(coulomb: CoulombSolution) -> dict[str, Any]:
    """Return the statements of a prediction beside its value: uncertainty, value after a release, peak and plateaus."""
    values = {name: getattr(coulomb, name) for name in ("uncertainty", "released", "released_uncertainty")}
    values |= dict(zip(("peak", "peak_uncertainty"), coulomb.peak.tolist() or [math.nan, math.nan], strict=True))
    return values | {"plateaus": coulomb.plateaus.tolist()}


def path_values(analysis: LimitAnalysis) -> dict[str, Any] | None:
    """Return the curve from rest to the plateau as lists by their JSON keys; None without a path."""
    if (path := analysis.path) is None:
        return None
    keys = {"settlement": "settlement", "value": analysis.scene.quantity, "strain_residual": "strain_residual", "converged": "converged"}
    values = {key: getattr(path, name).tolist() for name, key in keys.items()}
    values["converged"] = [bool(converged) for converged in values["converged"]]
    return values | {"solves": path.solves.tolist(), "seconds": path.seconds}


def _worst(residuals: Iterable[float]) -> float:
    """Return the largest finite residual; NaN without a finite one."""
    return max((residual for residual in residuals if math.isfinite(residual)), default=math.nan)


def with_one_fall(bounds: dict[Drive, Solution]) -> dict[Drive, Solution]:
    """Return the bounds of one assembly: if one drive shows that it cannot stand, every drive without a value has that answer."""
    fallen = next((solution for solution in bounds.values() if solution.status is Status.INFEASIBLE), None)
    return {drive: solution if fallen is None or solution.status is Status.SOLVED else fallen for drive, solution in bounds.items()}


def _distinct(analysis: LimitAnalysis) -> list[Solution]:
    """Return every computed solution once: equal insets and unstable structures share solutions."""
    return list({id(s): s for s in (*analysis.bounds.values(), *analysis.sharp.bounds.values())}.values())
