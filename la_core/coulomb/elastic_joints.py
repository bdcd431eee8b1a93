"""Rigid blocks on elastic joints with friction that need not dilate: one associated cone programme for a given shift.

A joint's relative displacement since the blocks were laid is u = e + (gap, slip): e its elastic part, gap >= 0 and slip the rest.
Compression follows e_n in total, n = -kn e_n; friction follows it in steps, t = t_before - ks (change of e_t), so that slip keeps
its history. Friction that does not dilate is the associated law with the normal displacement shifted by s = mu |slip|:
    (gap + s, slip) in the dual of Coulomb's cone, orthogonal to the contact force
(De Saxce & Feng 1998; Acary, Cadoux, Lemarechal & Malick 2011, doi 10.1002/zamm.201000073). For a given s this is the optimum of
    maximise  w . q - sum (kn e_n^2 + ks |e_t|^2) / 2 + t_before . e_t   subject to   (u - e) + s n in the dual cone
over displacements q of the blocks and e of the joints; the contact forces are its multipliers. Any s, right or wrong, gives forces
in equilibrium and within Coulomb's cone. Matrix and cones never change: `conic.Programme` is set up once.

Displacements are over `unit`, the travel of the fastest support point; forces over the weight W.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.limit import Programme, ProgrammeAnswer, ProgrammeOutcome, scaled_problem
from la_core.model import Assembly, JointStiffness, columns, scaled_load, support_motion

LEAST_WORK = 1e-3  # of the weight's over the support's motion
TOLERANCE = 1e-8  # asked of the solver; what was reached is recomputed from the answer


@dataclass(frozen=True)
class JointState:
    """Where the joints are: relative displacement (C, k) in local axes since the blocks were laid, and contact force (C, k); scaled."""

    displacement: np.ndarray
    force: np.ndarray


@dataclass(frozen=True)
class Trial:
    """Answer for one shift; all scaled. blocks (n,): displacements of the free blocks. gap (C,), slip (C, k - 1): of this step.

    load: multiplier of the live load, NaN without one. energy: elastic energy of the joints. solved: whether the solver has an answer.
    """

    solved: bool
    blocks: np.ndarray
    joints: JointState
    gap: np.ndarray
    slip: np.ndarray
    load: float
    energy: float


class ElasticJoints:
    """The problem of one assembly on joints of given stiffness; counts its `solves` and their `seconds`."""

    def __init__(self, assembly: Assembly, stiffness: JointStiffness) -> None:
        self.assembly = assembly
        self.live = assembly.has_live_load
        speed, motion = support_motion(assembly, 0.0 if self.live else 1.0)
        self.unit = stiffness.travel * speed
        self.solves, self.seconds = 0, 0.0
        self._width = 2 if assembly.effects.plane else 3
        kinematics = assembly.kinematic_matrix(assembly.length)
        self._blocks = kinematics[:, np.repeat(assembly.blocks.free, kinematics.shape[1] // len(assembly.blocks))]
        self.motion = self._local(kinematics @ columns(assembly, motion))
        self.weights = scaled_load(assembly, assembly.dead_load)
        self._live_load = scaled_load(assembly, assembly.live_load)
        problem = scaled_problem(assembly, every_point=True)  # each has its own spring
        self._flow_rule, self._cones = problem.flow_rule, problem.cones
        stiff = np.full((len(assembly.points), self._width), stiffness.shear)
        stiff[:, 0] = stiffness.normal
        self._stiffness = stiff * (self.unit / assembly.weight)
        self._compliance = np.divide(1.0, self._stiffness, out=np.zeros_like(stiff), where=self._stiffness > 0.0)
        self._programmes: dict[tuple[bool, bool], Programme] = {}

    @property
    def laid(self) -> JointState:
        """Joints as laid, without force."""
        nothing = np.zeros((len(self.assembly.points), self._width))
        return JointState(nothing, nothing)

    def live_displacement(self, blocks: np.ndarray) -> float:
        """Mean displacement along the live load, weighted by it, of the free blocks' displacements (n,)."""
        return float(self._live_load @ blocks)

    def value(self, trial: Trial) -> float:
        """Reaction over the weight, per unit speed of the fastest support point, or multiplier of the live load, 0 before it acts."""
        if self.live:
            return trial.load if np.isfinite(trial.load) else 0.0
        return float(np.sum(self.motion * trial.joints.force))

    def work(self, trial: Trial, before: Trial, stride: float) -> float:
        """Work over a stride of motion by the weights that settle and a support that has to be pulled, or the live load; scaled.

        At least LEAST_WORK of the weight's: a mechanism that takes less is judged by this.
        """
        freedoms = len(self.weights) // int(self.assembly.blocks.free.sum())
        weights = np.sum((self.weights * (trial.blocks - before.blocks)).reshape(-1, freedoms), axis=1)
        value = self.value(trial)
        driving = abs(value) if self.live else max(-value, 0.0)
        return max(float(np.maximum(weights, 0.0).sum()) + driving * stride, LEAST_WORK * stride)

    def solve(self, before: JointState, motion: np.ndarray, shift: np.ndarray, live: float | None = None) -> Trial:
        """One associated solve from `before`, for the supports' relative displacement (C, k) and shift (C,).

        live: the displacement to impose along the live load; None where the load does not act.
        """
        offset = motion.copy()
        offset[:, 0] += shift
        offset[:, 1:] -= before.displacement[:, 1:]
        history = before.force.copy()
        history[:, 0] = 0.0
        bound = self._flow_rule @ offset.ravel()
        if live is not None:
            bound = np.concatenate([[-live], bound])
        for refine in (False, True):  # joints almost without friction need refinement
            answer = self._programme(live is not None, refine).solve(np.concatenate([self.weights, history.ravel()]), bound)
            self.solves, self.seconds = self.solves + 1, self.seconds + answer.seconds
            if answer.outcome is ProgrammeOutcome.OPTIMUM:
                break
        return self._trial(answer, before, motion, driven=live is not None)

    def _trial(self, answer: ProgrammeAnswer, before: JointState, motion: np.ndarray, driven: bool) -> Trial:
        count = len(self.weights)
        solved = answer.outcome is ProgrammeOutcome.OPTIMUM and bool(np.isfinite(answer.x).all() and np.isfinite(answer.multipliers).all())
        multipliers = answer.multipliers[1:] if driven else answer.multipliers
        blocks, elastic = answer.x[:count], self._local(answer.x[count:])
        force = self._local(self._flow_rule.T @ multipliers)
        displacement = self._local(self._blocks @ blocks) + motion
        return Trial(
            solved,
            blocks,
            JointState(displacement, force),
            gap=displacement[:, 0] - elastic[:, 0],
            slip=displacement[:, 1:] - before.displacement[:, 1:] - elastic[:, 1:],
            load=float(answer.multipliers[0]) if driven else float("nan"),
            energy=float(np.sum(force**2 * self._compliance) / 2.0),
        )

    def _programme(self, driven: bool, refine: bool) -> Programme:
        """The programme without or with the row that imposes the live displacement; made when first asked for."""
        if (driven, refine) not in self._programmes:
            rows, cones = sparse.hstack([self._flow_rule @ self._blocks, -self._flow_rule]).tocsr(), self._cones
            if driven:
                live = np.concatenate([self._live_load, np.zeros(self._stiffness.size)])
                rows = sparse.vstack([sparse.csr_matrix(live), rows]).tocsr()
                cones = replace(cones, equalities=cones.equalities + 1)
            quadratic = np.concatenate([np.zeros(len(self.weights)), self._stiffness.ravel()])
            self._programmes[driven, refine] = Programme(rows, cones, quadratic, TOLERANCE, refine=refine)
        return self._programmes[driven, refine]

    def _local(self, values: np.ndarray) -> np.ndarray:
        return values.reshape(len(self.assembly.points), self._width)
