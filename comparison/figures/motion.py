"""Motion of the blocks over the settlement, by method, from rest under gravity."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from comparison.figures.canvas import structure_size
from comparison.numbers import Units
from comparison.yade import Results, Run
from la_core.analysis import LimitAnalysis
from la_core.coulomb import CoulombSolution
from la_core.exchange import EARLIER_ATTEMPT
from la_core.limit import Solution, Status
from la_core.measures import contact_states, joint_states, mechanism
from la_core.model import Assembly

DRAWN = 0.09  # of the structure's size: the largest displacement in a drawn mechanism
FARTHEST = 0.5  # of the structure's size: the largest displacement of a magnified collapse


@dataclass(frozen=True)
class Motion:
    """States of one method in order of the support's motion, the first at rest.

    Attributes
    ----------
    label : str
        Name of the method in figures.
    settlement : ndarray
        Motion of the support (S,), m or rad.
    displacement : ndarray
        Displacements of the centroids, m, and rotation vectors, rad, from rest (S, B, 6).
    forces : ndarray
        Contact forces (S, C, 3) on block b, N; a single state (1, C, 3) holds for all; NaN where unknown.
    twists : ndarray
        Mechanism (B, 6) per unit motion of the support; NaN without a mechanism.
    joints : ndarray
        ContactState (I,) of each interface in the mechanism.
    falling : tuple of str
        Names of the blocks that cannot stand.
    reason : str
        Why there is no mechanism, or "".
    """

    label: str
    settlement: np.ndarray
    displacement: np.ndarray
    forces: np.ndarray
    twists: np.ndarray
    joints: np.ndarray
    falling: tuple[str, ...] = ()
    reason: str = ""

    def at(self, settlement: float) -> np.ndarray:
        """Return displacements (B, 6), m and rad, at a settlement: linear between states, constant after the last."""
        after = int(np.clip(np.searchsorted(self.settlement, settlement), 1, len(self.settlement) - 1))
        first, last = self.settlement[after - 1 : after + 1]
        share = np.clip((settlement - first) / (last - first), 0.0, 1.0) if last > first else 1.0
        return (1.0 - share) * self.displacement[after - 1] + share * self.displacement[after]


@dataclass(frozen=True)
class Motions:
    """The motions of all methods over the same settlement.

    Attributes
    ----------
    methods : tuple of Motion
        Motion of each method, limit analysis first.
    start, end : float
        First and last settlement, m or rad. The start is negative where the support is first pushed in. Both are equal where
        nothing moves.
    magnification : float
        Factor of all drawn displacements.
    """

    methods: tuple[Motion, ...]
    start: float
    end: float
    magnification: float


def shown_answer(analysis: LimitAnalysis) -> tuple[str, Solution | CoulombSolution]:
    """Return label and answer of limit analysis in figures: the Coulomb prediction, else the associated answer."""
    if analysis.coulomb is not None and np.isfinite(analysis.coulomb.value):
        return "limit analysis (Coulomb)", analysis.coulomb
    return "limit analysis (associated)", analysis.bounds[analysis.main]


def shown_joints(assembly: Assembly, twists: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Return the state (I,) of each interface in a mechanism (B, 6) with contact forces (C, 3), N, for the marks in figures and 3D view."""
    return joint_states(assembly, contact_states(assembly, twists, forces), forces)


def drawn_motion(assembly: Assembly, mechanisms: Mapping[str, np.ndarray]) -> float:
    """Return the motion of the drive (m, rad, or 1) at which the fastest point moves by DRAWN of the size.

    `mechanisms` has twists (B, 6) by label. The motion is 0 without any mechanism.
    """
    known = [twists for twists in mechanisms.values() if np.isfinite(twists).all()]
    fastest = max((float(mechanism.block_speeds(assembly.blocks, twists).max()) for twists in known), default=0.0)
    return DRAWN * structure_size(assembly.blocks) / fastest if fastest > 0.0 else 0.0


def motions(results: Results) -> Motions:
    """Return limit analysis' mechanism and YADE's recorded states over the same settlement.

    The settlement is YADE's; without a run it is large enough to see the mechanism.
    """
    analysis, run = results.analysis, results.run
    label, answer = shown_answer(analysis)
    twists = results.per_motion(answer.twists)
    mechanisms = {label: twists} | ({"YADE": run.mechanism()} if run is not None else {})
    large = drawn_motion(analysis.assembly, mechanisms)
    end = max(float(run.poses.settlement[-1]), 0.0) if run is not None else 0.0
    methods = [_of_limit_analysis(analysis, label, twists, answer.forces, end or large)]
    if run is not None:
        methods.append(_of_run(analysis.assembly, run))
    start = min(float(method.settlement[0]) for method in methods)
    return Motions(tuple(methods), start, end or large, _magnification(analysis.assembly, methods, large / end if end else 1.0))


def _magnification(assembly: Assembly, methods: Sequence[Motion], wanted: float) -> float:
    """Return the wanted magnification, less where a collapse would leave the picture, and at least 1."""
    farthest = max(float(mechanism.block_speeds(assembly.blocks, method.displacement[-1]).max()) for method in methods)
    most = FARTHEST * structure_size(assembly.blocks) / farthest if farthest > 0.0 else 1.0
    return max(min(wanted, most), 1.0)


def end_words(run: Run, weight: float) -> str:
    """Return the status of a run and the reason why its last attempt ended, in a report's units for a structure of this weight, N."""
    last, *_ = str(run.result["message"]).split(EARLIER_ATTEMPT)
    return Units(weight).words(f"{run.status}: {last}")


def _of_limit_analysis(analysis: LimitAnalysis, label: str, twists: np.ndarray, forces: np.ndarray, end: float) -> Motion:
    """Return limit analysis' motion with these twists (B, 6) and forces (C, 3) up to the settlement `end`; displacements grow linearly."""
    main = analysis.bounds[analysis.main]
    known = bool(np.isfinite(twists).all())
    displacement = np.stack([np.zeros_like(twists), end * np.where(known, twists, 0.0)])
    joints = shown_joints(analysis.assembly, twists, forces)
    falling = tuple(main.falling) if main.status is Status.INFEASIBLE else ()
    reason = "" if known else "cannot stand" if falling else str(main.status)
    return Motion(label, np.array([0.0, end]), displacement, forces[None], twists, joints, falling, reason)


def _of_run(assembly: Assembly, run: Run) -> Motion:
    """Return YADE's recorded states; a single state is repeated, so that the blocks rest there."""
    twists = run.mechanism()
    moved = np.concatenate([run.poses.displacement, run.poses.rotation], axis=2)
    kept = [0, 0] if len(moved) == 1 else slice(None)
    joints = shown_joints(assembly, twists, run.plateau_forces())
    reason = "" if run.status == "plateau" else end_words(run, assembly.weight)
    settlement = run.poses.settlement
    return Motion("YADE", settlement[kept], (moved - moved[0])[kept], run.poses.forces[kept], twists, joints, reason=reason)
