"""Rigid blocks on elastic joints with friction without dilatancy: one associated cone programme for a given shift.

The relative displacement of a joint since the blocks were laid is u = e + (gap, slip), with elastic part e,
gap >= 0 and slip. The normal force follows the whole elastic part, n = -kn e_n. The friction force follows its change
in each step, t = t_before - ks (change of e_t), so that it keeps the history of slip. Friction without dilatancy is
the associated law with the normal displacement shifted by s = mu |slip|:
    (gap + s, slip) in the dual of Coulomb's cone, orthogonal to the contact force
(De Saxce & Feng 1998; Acary, Cadoux, Lemarechal & Malick 2011, doi 10.1002/zamm.201000073). For a given s this is the
optimum of
    maximise  w . q - sum (kn e_n^2 + ks |e_t|^2) / 2 + t_before . e_t   subject to   (u - e) + s n in the dual cone
over displacements q of the blocks and e of the joints; the contact forces are its multipliers. For every s the forces
are in equilibrium and within Coulomb's cone. Matrix and cones never change, so `conic.Programme` is set up once.

Displacements are over `unit`, the travel of the fastest support point; forces over the weight W.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.limit import Programme, ProgrammeAnswer, ProgrammeOutcome, scaled_problem
from la_core.model import Assembly, JointStiffness, columns, scaled_load, support_motion

LEAST_WORK = 1e-3  # of the weight's work over the support's motion
TOLERANCE = 1e-8  # of the solver; residuals are recomputed from its answer


@dataclass(frozen=True)
class JointState:
    """State of the joints in local axes (normal, then k - 1 tangents; k = 2 in the plane, 3 in space), scaled.

    Attributes
    ----------
    displacement : (C, k) array
        Relative displacement at each contact point since the blocks were laid.
    force : (C, k) array
        Contact force on block b, compression positive.
    """

    displacement: np.ndarray
    force: np.ndarray


@dataclass(frozen=True)
class Trial:
    """Answer of the programme for one shift; all numbers are scaled.

    Attributes
    ----------
    solved : bool
        Whether the solver has an answer.
    blocks : (n,) array
        Displacements of the free blocks.
    joints : JointState
        Displacements and forces of the joints.
    gap : (C,) array
        Opening of each contact point.
    slip : (C, k - 1) array
        Slip of each contact point in this step.
    load : float
        Multiplier of the live load; NaN where it does not act.
    energy : float
        Elastic energy of the joints.
    """

    solved: bool
    blocks: np.ndarray
    joints: JointState
    gap: np.ndarray
    slip: np.ndarray
    load: float
    energy: float


class ElasticJoints:
    """An assembly on elastic joints of given stiffness. It counts its `solves` and the `seconds` they take.

    Parameters
    ----------
    assembly : Assembly
        Blocks, contact points, weights, and the support's motion or the live load.
    stiffness : JointStiffness
        Stiffness of a contact point, and the travel of the support, which is the unit of displacement.
    """

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
        problem = scaled_problem(assembly, every_point=True)  # every point has its own spring
        self._flow_rule, self._cones = problem.flow_rule, problem.cones
        stiff = np.full((len(assembly.points), self._width), stiffness.shear)
        stiff[:, 0] = stiffness.normal
        self._stiffness = stiff * (self.unit / assembly.weight)
        self._compliance = np.divide(1.0, self._stiffness, out=np.zeros_like(stiff), where=self._stiffness > 0.0)
        self._programmes: dict[tuple[bool, bool], Programme] = {}

    @property
    def laid(self) -> JointState:
        """Joints as laid, without displacement or force."""
        zero = np.zeros((len(self.assembly.points), self._width))
        return JointState(zero, zero)

    def live_displacement(self, blocks: np.ndarray) -> float:
        """Mean displacement along the live load, weighted by the load, for displacements (n,) of the free blocks."""
        return float(self._live_load @ blocks)

    def value(self, trial: Trial) -> float:
        """Scaled reaction, or multiplier of the live load.

        A reaction is over the weight, per unit speed of the fastest support point. A multiplier is 0 where the load
        does not act.
        """
        if self.live:
            return trial.load if np.isfinite(trial.load) else 0.0
        return float(np.sum(self.motion * trial.joints.force))

    def work(self, trial: Trial, before: Trial, stride: float) -> float:
        """Scaled work put into the structure over one step; residuals are relative to it.

        The sinking weights do work, and so does the live load, or a support that has to be pulled. The result is at
        least LEAST_WORK of the work of the whole weight.

        Parameters
        ----------
        trial, before : Trial
            States at the end and at the start of the step.
        stride : float
            Motion of the support, or displacement along the live load, in the step; over `unit`.
        """
        freedoms = len(self.weights) // int(self.assembly.blocks.free.sum())
        weights = np.sum((self.weights * (trial.blocks - before.blocks)).reshape(-1, freedoms), axis=1)
        value = self.value(trial)
        driving = abs(value) if self.live else max(-value, 0.0)
        return max(float(np.maximum(weights, 0.0).sum()) + driving * stride, LEAST_WORK * stride)

    def solve(self, before: JointState, motion: np.ndarray, shift: np.ndarray, live: float | None = None) -> Trial:
        """Solve the associated programme once for a given shift.

        Parameters
        ----------
        before : JointState
            Joints at the start of the step, with their history of friction.
        motion : (C, k) array
            Relative displacement of the joints that the supports impose, since the blocks were laid.
        shift : (C,) array
            Shift s of the normal displacement.
        live : float, optional
            Displacement to impose along the live load; None where the load does not act.
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
        """The programme without or with the row that imposes the live displacement, set up at its first use."""
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
