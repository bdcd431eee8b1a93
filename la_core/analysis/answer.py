"""Limit analysis from Python: solve a scene, read its values by name, show them as a table."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import degrees, nan
from pathlib import Path
from typing import Any

import numpy as np

from la_core.analysis.result import LimitAnalysis, answer_values
from la_core.analysis.settings import AnalysisListener, AnalysisSettings, checked
from la_core.analysis.stage import analyse
from la_core.coulomb import CoulombSolution
from la_core.errors import SceneError, true_or_false
from la_core.limit import Drive, Solution, Status
from la_core.measures import joint_rows
from la_core.pictures import picture
from la_core.scene import Scene, load
from la_core.text_table import OVER_WEIGHT, Tabled, dataframe, exists, number_text, over_weight, without_round_off


@dataclass(frozen=True, repr=False, eq=False)
class Answer(Tabled):
    """Results of limit analysis for one scene.

    Values without a suffix hold at the scene's inset; those that end in `_sharp` hold for sharp edges (inset 0). A value that
    does not exist is NaN. Where the scene's inset is 0, which YADE cannot have, `mechanism`, `forces`, `joints` and `path` hold at
    `analysis.assembly.inset`, as `analysis.coulomb.value` does. Arrays are copies. A notebook shows what `solve --long` computes.

    Attributes
    ----------
    scene : Scene
        Scene that was solved.
    analysis : LimitAnalysis
        Complete results: assembly, contact forces, mechanisms and residuals.

    Notes
    -----
    Reactions are in N, or in N m for a support that rotates. A reaction is the force of the support on the structure,
    against the direction of settlement; it is positive where the support holds the structure. A joint's state is "opening",
    "sliding", "sticking", "idle" (closed, carries nothing) or "unknown"; its shear is the size of the force across the normal.

    The associated flow rule gives bounds: relative velocities u at contacts obey u_n >= mu |u_t| (Livesley 1978; Portioli and
    Cascini 2016, doi 10.1016/j.engstruct.2016.02.002). The prediction `coulomb` uses friction without dilatancy.

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
        """Outcome of the associated problem; only `Status.SOLVED` comes with bounds. `coulomb` may have a value beside UNBOUNDED, too."""
        return self.analysis.printed.bounds[self.analysis.main].status

    @property
    def least(self) -> float:
        """Least reaction of the associated problem (N, N m): no equilibrium within Coulomb's cone has a smaller one."""
        return self._bound(Drive.YIELDING, sharp=False)

    @property
    def greatest(self) -> float:
        """Greatest reaction of the associated problem (N, N m): the support is pushed into the structure; NaN where nothing limits it."""
        return self._bound(Drive.PUSHING, sharp=False)

    @property
    def multiplier(self) -> float:
        """Collapse multiplier of a live load by the associated flow rule; NaN for a settlement."""
        return self._bound(Drive.LIVE, sharp=False)

    @property
    def coulomb(self) -> float:
        """Predicted reaction (N, N m) or multiplier, for friction without dilatancy; NaN if only bounds are computed."""
        coulomb = self.analysis.printed.coulomb
        return nan if coulomb is None else coulomb.value

    @property
    def interval(self) -> tuple[float, float]:
        """Least and greatest value (N, N m, multiplier) of the prediction's mechanism for any history of friction; infinite: no limit."""
        coulomb = self.analysis.printed.coulomb
        return (nan, nan) if coulomb is None else coulomb.interval

    @property
    def uncertainty(self) -> float:
        """Stated uncertainty of the prediction (N, N m, multiplier); NaN where it is unknown, infinite where the blocks fell."""
        coulomb = self.analysis.printed.coulomb
        return nan if coulomb is None else coulomb.uncertainty

    @property
    def plateaus(self) -> tuple[float, ...]:
        """Values of all plateaus (N, N m, multiplier) where the structure has several, `coulomb` first; empty where it has one."""
        coulomb = self.analysis.printed.coulomb
        return () if coulomb is None else tuple(coulomb.plateaus.tolist())

    @property
    def least_sharp(self) -> float:
        """`least` for sharp edges."""
        return self._bound(Drive.YIELDING, sharp=True)

    @property
    def greatest_sharp(self) -> float:
        """`greatest` for sharp edges."""
        return self._bound(Drive.PUSHING, sharp=True)

    @property
    def coulomb_sharp(self) -> float:
        """`coulomb` for sharp edges; NaN where joints slide and the scene's edges are rounded."""
        coulomb = self.analysis.sharp.coulomb
        return nan if coulomb is None else coulomb.value

    @property
    def mechanism(self) -> np.ndarray:
        """Twists (B, 6) of all blocks per unit motion of the support, in the order of `scene.blocks.names`; NaN without any.

        A twist is (vx, vy, vz, wx, wy, wz) about the centroid, from the prediction, else from the associated answer. Under a
        live load twists are per N m of its work; `comparison.Run` has them per m of mean displacement along the load.
        """
        return self._shown.twists.copy()

    @property
    def forces(self) -> np.ndarray:
        """Contact forces (C, 3) on the second block of each point in `analysis.assembly.points`, N, global axes; NaN without any."""
        return self._shown.forces.copy()

    @property
    def joints(self) -> list[dict[str, Any]]:
        """Every joint: `block_a`, `block_b`, `state`, `normal` (compression positive), `shear` (N), centre of pressure `x`, `y`, `z` (m) or
        NaN with its `eccentricity` (1: edge), `friction_used`, and per unit of `mechanism` `opening`, `slip` (m), `rotation` (rad)."""
        return joint_rows(self.analysis.assembly, self.mechanism, self.forces)

    @property
    def path(self) -> tuple[np.ndarray, np.ndarray]:
        """Curve of the prediction from rest: settlement (m, rad), of a live load the mean displacement (m), and value; or empty."""
        coulomb = self.analysis.coulomb
        return (np.zeros(0), np.zeros(0)) if coulomb is None else (coulomb.path_settlement.copy(), coulomb.path_value.copy())

    def plot(self, name: str = "mechanisms") -> Any:
        """Draw one figure of the answer.

        Parameters
        ----------
        name : str
            Name of the figure: "assembly", "mechanisms", "reaction", "forces" or "dissipation".

        Returns
        -------
        comparison.Picture
            The figure, which a notebook shows.

        Raises
        ------
        SceneError
            No figure has this name.
        """
        return picture(self, name)

    def to_dataframe(self) -> Any:
        """Return the joints as a table of pandas, one row a joint with the columns of `joints`.

        Returns
        -------
        pandas.DataFrame
            Table of the joints.

        Raises
        ------
        SceneError
            Pandas is not installed.
        """
        return dataframe(self.joints)

    @property
    def _shown(self) -> Solution | CoulombSolution:
        return self.analysis.coulomb or self.analysis.bounds[self.analysis.main]

    @property
    def values(self) -> dict[str, Any]:
        """All printed and stored values: "associated", "coulomb" and "path", with the keys of `crosscheck solve --json`.

        A number that does not exist is NaN here, and null in that JSON.
        """
        return answer_values(self.analysis)

    def _bound(self, drive: Drive, sharp: bool) -> float:
        bounds = (self.analysis.sharp if sharp else self.analysis.printed).bounds
        return bounds[drive].value if drive in bounds else nan

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        return self.scene.title, answer_headings(self.scene), list(answer_rows(self.scene, self.values))


def solve(scene: Scene | Path | str, path: bool = False, bounds_only: bool = False, listener: AnalysisListener | None = None) -> Answer:
    """Solve a scene by limit analysis: the bounds, and the prediction unless the scene requests bounds alone.

    Parameters
    ----------
    scene : Scene, Path or str
        Scene from `load`, `build` or `variant`; path of a scene file, or name of a shipped scene.
    path : bool
        Whether to follow the reaction from rest over one travel of YADE, too. The curve is `answer.analysis.path`.
    bounds_only : bool
        Whether to compute the bounds alone, which is fast: the prediction is then NaN.
    listener : AnalysisListener, optional
        Object with the methods `bounds(analysis)`, called as soon as the bounds are known, and `path(report)`, called while the
        prediction is computed: `report.share` is the estimated share that is done, which may fall; `report.value` the value so far.

    Returns
    -------
    Answer
        Bounds and prediction. A structure that cannot stand is an answer with `Status.INFEASIBLE`, not an error.

    Raises
    ------
    SceneError
        The scene or the listener is invalid, or the scene requests an effect that it does not allow, or `path` is requested with
        another friction law or with `bounds_only`.

    Examples
    --------
    >>> import la_core
    >>> pads = la_core.load("two_pads")
    >>> round(la_core.solve(pads).least_sharp / pads.weight, 6)
    0.166667
    """
    scene, path, bounds_only = load(scene), true_or_false("path", path), true_or_false("bounds_only", bounds_only)
    if path and scene.effects.friction not in ("auto", "coulomb"):
        rule = "a path needs friction without dilatancy"
        raise scene.located(SceneError("effects.friction", rule, value=scene.effects.friction, hint='use "coulomb" or "auto"'))
    if path and bounds_only:
        raise SceneError("bounds_only", "a path is no bound", value=True, hint="leave out `path` or `bounds_only`")
    return Answer(scene, analyse(scene, AnalysisSettings(follow_path=path, bounds_only=bounds_only), checked(listener)))


def answer_headings(scene: Scene) -> tuple[str, str, str]:
    """Return the headings of the three columns of `answer_rows`."""
    return "limit analysis", scene.unit or "value", OVER_WEIGHT[scene.unit]


def answer_rows(scene: Scene, values: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of the table: name, value in its unit, value over the weight; `values` come from `answer_values`."""
    answer = values["associated"]
    yield "status", answer["status"], ""
    for name in (scene.quantity, "reaction_max", f"{scene.quantity}_sharp", "reaction_max_sharp"):
        if name in answer:
            limitless = "reaction_max" in name and answer["reaction_max_status"] == "unbounded" and not exists(answer[name])
            yield (name.replace("_", " "), "no upper limit", "") if limitless else _quantity(scene, name.replace("_", " "), answer[name])
    if "falling" in answer:
        yield "blocks that fall", ", ".join(answer["falling"]), ""
    yield from _angle_rows("", answer)
    for name in ("equilibrium_residual", "cone_violation", "mechanism_violation", "duality_gap", "seconds"):
        yield name.replace("_", " "), number_text(answer[name], 2), ""
    if values["coulomb"]:
        yield from _coulomb_rows(scene, values["coulomb"])


def _coulomb_rows(scene: Scene, answer: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the rows of the prediction: value, interval, sharp value, residuals and cost."""
    yield "Coulomb: status", answer["status"], ""
    yield _quantity(scene, f"Coulomb: {scene.quantity}", answer[scene.quantity])
    yield _row(scene, "Coulomb: uncertainty", answer["uncertainty"], 2)
    yield from _angle_rows("Coulomb: ", answer)
    yield from (_quantity(scene, "Coulomb: one of several plateaus", plateau) for plateau in answer["plateaus"])
    is_predicted = exists(answer[scene.quantity])  # without a prediction there is no interval to explain
    for which, end in zip(("least", "greatest"), answer[f"{scene.quantity}_interval"], strict=True):
        name = f"Coulomb: {which} by its mechanism"
        yield (name, answer["interval_status"], "") if is_predicted and not exists(end) else _quantity(scene, name, end)
    if exists(answer[f"{scene.quantity}_sharp"]):
        yield _quantity(scene, f"Coulomb: {scene.quantity} sharp", answer[f"{scene.quantity}_sharp"])
    if exists(answer["released"]):
        yield _quantity(scene, f"Coulomb: {scene.quantity} after release", answer["released"])
        yield _row(scene, "Coulomb: uncertainty after release", answer["released_uncertainty"], 2)
    for name in ("strain_residual", "drift", "travel", "seconds"):
        yield f"Coulomb: {name.replace('_', ' ')}", number_text(answer[name], 2), ""
    yield "Coulomb: iterations", str(answer["iterations"]), ""


def _angle_rows(before: str, answer: dict[str, Any]) -> Iterator[tuple[str, str, str]]:
    """Yield the angle of a [tilt] at which the structure fails, and its uncertainty. before: first words of the rows."""
    for name, digits in (("angle", 5), ("angle_uncertainty", 2)):
        if name in answer:
            angle = without_round_off(answer[name], degrees(1.0)) if name == "angle" and exists(answer[name]) else answer[name]
            yield f"{before}{name.replace('_', ', ')}, degrees", number_text(angle, digits), ""


def _quantity(scene: Scene, name: str, value: float | None) -> tuple[str, str, str]:
    """Return the row of a reaction or of a multiplier, which is 0 where it is only round-off."""
    value = None if value is None else without_round_off(value, scene.weight if scene.live is None else 1.0)
    return _row(scene, name, value, 6)


def _row(scene: Scene, name: str, value: float | None, digits: int) -> tuple[str, str, str]:
    return name, number_text(value, digits), "" if scene.live is not None else number_text(over_weight(value, scene.weight), digits)
