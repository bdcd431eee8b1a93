"""Limit analysis from Python: solve a scene, read its values by name, show them as a table."""

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from la_core.analysis.result import LimitAnalysis
from la_core.analysis.settings import AnalysisListener, AnalysisSettings
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.limit import Drive, Solution, Status
from la_core.scene import Scene
from la_core.text_table import Tabled, number_text, over_weight

NAN = float("nan")


@dataclass(frozen=True, repr=False, eq=False)
class Answer(Tabled):
    """Results of limit analysis for one scene.

    Values without a suffix hold at the scene's inset; those that end in `_sharp` hold for sharp arrises (inset 0). A
    value that does not exist is NaN. `print(answer)` shows the table of `crosscheck solve`, and so does a notebook.

    Attributes
    ----------
    scene : Scene
        Scene that was solved.
    analysis : LimitAnalysis
        Complete results: assembly, contact forces, mechanisms and residuals.

    Notes
    -----
    Reactions are in N, or in N m for a support that rotates. A reaction is the force of the support on the structure,
    against the direction of settlement; it is positive where the support holds the structure.

    The associated flow rule gives bounds: relative velocities u at contacts obey u_n >= mu |u_t| (Livesley 1978;
    Portioli and Cascini 2016, doi 10.1016/j.engstruct.2016.02.002). The prediction `coulomb` uses friction without
    dilatancy.

    Examples
    --------
    >>> import la_core
    >>> pads = la_core.load("two_pads")
    >>> answer = la_core.solve(pads)
    >>> str(answer.status), round(answer.least_sharp / pads.weight, 6)
    ('solved', 0.166667)
    """

    scene: Scene
    analysis: LimitAnalysis

    @property
    def status(self) -> Status:
        """Outcome of the associated problem; only `Status.SOLVED` comes with a value."""
        return self.analysis.printed.bounds[self.analysis.main].status

    @property
    def least(self) -> float:
        """Least reaction of the associated problem (N, N m): no equilibrium within Coulomb's cone has a smaller one."""
        return self._bound(Drive.YIELDING, sharp=False)

    @property
    def greatest(self) -> float:
        """Greatest reaction of the associated problem (N, N m): the support is pushed into the structure."""
        return self._bound(Drive.PUSHING, sharp=False)

    @property
    def multiplier(self) -> float:
        """Collapse multiplier of a live load by the associated flow rule; NaN for a settlement."""
        return self._bound(Drive.LIVE, sharp=False)

    @property
    def coulomb(self) -> float:
        """Predicted reaction (N, N m) or multiplier, for friction without dilatancy; NaN if only bounds are computed."""
        coulomb = self.analysis.printed.coulomb
        return NAN if coulomb is None else coulomb.value

    @property
    def interval(self) -> tuple[float, float]:
        """Least and greatest value (N, N m, multiplier) of the prediction's mechanism, over all histories of friction."""
        coulomb = self.analysis.printed.coulomb
        return (NAN, NAN) if coulomb is None else coulomb.interval

    @property
    def uncertainty(self) -> float:
        """Stated uncertainty of the prediction (N, N m, multiplier); NaN where it is unknown."""
        coulomb = self.analysis.printed.coulomb
        return NAN if coulomb is None else coulomb.uncertainty

    @property
    def plateaus(self) -> tuple[float, ...]:
        """Values of all plateaus (N, N m, multiplier) where the structure has several; empty where it has one."""
        coulomb = self.analysis.printed.coulomb
        return () if coulomb is None else tuple(coulomb.plateaus.tolist())

    @property
    def least_sharp(self) -> float:
        """`least` for sharp arrises."""
        return self._bound(Drive.YIELDING, sharp=True)

    @property
    def greatest_sharp(self) -> float:
        """`greatest` for sharp arrises."""
        return self._bound(Drive.PUSHING, sharp=True)

    @property
    def coulomb_sharp(self) -> float:
        """`coulomb` for sharp arrises; NaN where joints slide and the scene's arrises are rounded."""
        coulomb = self.analysis.sharp.coulomb
        return NAN if coulomb is None else coulomb.value

    @property
    def values(self) -> dict[str, Any]:
        """All printed and stored values: "associated", "coulomb" and "path", as in `crosscheck solve --json`."""
        return answer_values(self.analysis)

    def _bound(self, drive: Drive, sharp: bool) -> float:
        bounds = (self.analysis.sharp if sharp else self.analysis.printed).bounds
        return bounds[drive].value if drive in bounds else NAN

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        return self.scene.title, answer_headings(self.scene), list(answer_rows(self.scene, self.values))


def solve(scene: Scene, path: bool = False, bounds_only: bool = False, listener: AnalysisListener | None = None) -> Answer:
    """Solve a scene by limit analysis: the bounds, and the prediction unless the scene requests bounds alone.

    Parameters
    ----------
    scene : Scene
        Scene from `load`, `build` or `variant`.
    path : bool
        Whether to follow the reaction from rest to the plateau, too. The curve is `answer.analysis.path`.
    bounds_only : bool
        Whether to compute the bounds alone, which is fast: the prediction is then NaN.
    listener : AnalysisListener, optional
        Object with the methods `bounds(analysis)`, called as soon as the bounds are known, and `path(report)`, called
        while the prediction is computed: `report.share` is the share that is done, `report.value` the value so far.

    Returns
    -------
    Answer
        Bounds and prediction. A structure that cannot stand is an answer with `Status.INFEASIBLE`, not an error.

    Raises
    ------
    SceneError
        The scene requests an effect that it does not allow, or `path` is requested with another friction law or with
        `bounds_only`.

    Examples
    --------
    >>> import la_core
    >>> pads = la_core.load("two_pads")
    >>> round(la_core.solve(pads).least_sharp / pads.weight, 6)
    0.166667
    """
    if path and scene.effects.friction not in ("auto", "coulomb"):
        rule = "a path needs friction without dilatancy"
        raise SceneError(f"{scene.path}: effects.friction", rule, value=scene.effects.friction, hint='use "coulomb" or "auto"')
    if path and bounds_only:
        raise SceneError("bounds_only", "a path is no bound", value=True, hint="leave out `path` or `bounds_only`")
    return Answer(scene, analyse(scene, AnalysisSettings(follow_path=path, bounds_only=bounds_only), listener))


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

    They hold at the scene's inset, those with `_sharp` for sharp arrises. "shared_inset" holds the values at the inset of
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
        values["shared_inset"] = {"inset": analysis.assembly.inset, **bounds}
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
    values |= {"uncertainty": printed.uncertainty, "plateaus": printed.plateaus.tolist()}
    values[f"{name}_sharp"] = math.nan if sharp is None else sharp.value
    values[f"{name}_interval_sharp"] = [math.nan, math.nan] if sharp is None else list(sharp.interval)
    if scene.inset == 0.0 and analysis.assembly.inset:
        shared = {"inset": analysis.assembly.inset, name: rounded.value, f"{name}_interval": list(rounded.interval)}
        values["shared_inset"] = shared | {"uncertainty": rounded.uncertainty, "plateaus": rounded.plateaus.tolist()}
    values |= {f"{name}_at_rest": printed.at_rest} | {evidence: getattr(printed, evidence) for evidence in COULOMB_EVIDENCE}
    return values | {
        "iterations": printed.iterations,
        "steps": printed.steps,
        "travel": printed.travel,
        "viscosities": printed.viscosities.tolist(),
        "curve": {"settlement": printed.path_settlement.tolist(), name: printed.path_value.tolist()},
        "seconds": sum(s.seconds for s in {id(s): s for s in (rounded, sharp) if s is not None}.values()),
    }


def path_values(analysis: LimitAnalysis) -> dict[str, Any] | None:
    """Return the curve from rest to the plateau as lists by their JSON keys; None without a path."""
    path = analysis.path
    if path is None:
        return None
    keys = {"settlement": "settlement", "value": analysis.scene.quantity, "strain_residual": "strain_residual", "converged": "converged"}
    values = {key: getattr(path, name).tolist() for name, key in keys.items()}
    values["converged"] = [bool(converged) for converged in values["converged"]]
    return values | {"solves": path.solves.tolist(), "seconds": path.seconds}


def _worst(residuals: Iterable[float]) -> float:
    """Return the largest finite residual; NaN without a finite one."""
    return max((residual for residual in residuals if math.isfinite(residual)), default=math.nan)


def _distinct(analysis: LimitAnalysis) -> list[Solution]:
    """Return every computed solution once: equal insets and unstable structures share solutions."""
    return list({id(s): s for s in (*analysis.bounds.values(), *analysis.sharp.bounds.values())}.values())


def answer_headings(scene: Scene) -> tuple[str, str, str]:
    """Return the headings of the three columns of `answer_rows`."""
    return "limit analysis", scene.unit or "value", "over W" if scene.live is None else ""


def answer_rows(scene: Scene, values: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of the table: name, value in its unit, value over the weight; `values` come from `answer_values`."""
    answer = values["associated"]
    yield "status", answer["status"], ""
    for name in (scene.quantity, "reaction_max", f"{scene.quantity}_sharp", "reaction_max_sharp"):
        if name in answer:
            yield _quantity(scene, name.replace("_", " "), answer[name])
    if "falling" in answer:
        yield "blocks that fall", ", ".join(answer["falling"]), ""
    for name in ("equilibrium_residual", "cone_violation", "mechanism_violation", "duality_gap", "seconds"):
        yield name.replace("_", " "), number_text(answer[name], 2), ""
    if values["coulomb"]:
        yield from _coulomb_rows(scene, values["coulomb"])


def _coulomb_rows(scene: Scene, answer: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of the prediction: value, interval, sharp value, residuals and cost."""
    yield "Coulomb: status", answer["status"], ""
    low, high = answer[f"{scene.quantity}_interval"]
    yield _quantity(scene, f"Coulomb: {scene.quantity}", answer[scene.quantity])
    yield _quantity(scene, "Coulomb: uncertainty", answer["uncertainty"], 2)
    for plateau in answer["plateaus"]:
        yield _quantity(scene, "Coulomb: one of several plateaus", plateau)
    yield _quantity(scene, "Coulomb: least by its mechanism", low)
    yield _quantity(scene, "Coulomb: greatest by its mechanism", high)
    if math.isfinite(answer[f"{scene.quantity}_sharp"] or math.nan):
        yield _quantity(scene, f"Coulomb: {scene.quantity} sharp", answer[f"{scene.quantity}_sharp"])
    for name in ("strain_residual", "drift", "travel", "seconds"):
        yield f"Coulomb: {name.replace('_', ' ')}", number_text(answer[name], 2), ""
    yield "Coulomb: iterations", str(answer["iterations"]), ""


def _quantity(scene: Scene, name: str, value: float | None, digits: int = 6) -> tuple[str, str, str]:
    over = "" if scene.live is not None else number_text(over_weight(value, scene.weight), digits)
    return name, number_text(value, digits), over
