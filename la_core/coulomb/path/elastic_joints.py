"""Rigid blocks on elastic joints with Coulomb friction that does not dilate: displacements, forces and their derivative.

At every contact point u is the relative displacement since the blocks were laid. The normal force follows it,
n = max(0, -kn u_n). The friction force follows its change in a step, t = t_before - ks (change of u_t), and is cut back to
mu n where it exceeds that limit. The limit is reduced by the friction of a normal force of the size of round-off: in a
very rough joint this friction would grow until the blocks jam. Only the friction force has a history, and a point that parts loses
it. YADE's contacts obey the same law, mostly with a higher stiffness.

The law can be smoothed. A contact point then parts and slips gradually, over forces of the size `smoothing`: n is the
larger root of n (n + kn u_n) = smoothing^2, and |t| is the smaller root of (|t| - |t*|) (|t| - mu n) = smoothing |t|.
Both return to the sharp law as the smoothing vanishes, and friction never exceeds mu n.

Displacements are over `unit`, the travel of the fastest support point; forces are over the weight W.
"""

import copy
from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb.path.turning import Turning
from la_core.model import Assembly, JointStiffness, columns, scaled_load, support_motion

ROUND_OFF = 1e-8  # of the mean block weight: normal force that carries no friction


@dataclass(frozen=True)
class JointState:
    """State of the joints in local axes (normal, then k - 1 tangents; k = 2 in the plane, 3 in space), scaled.

    Attributes
    ----------
    displacement : (C, k) array
        Relative displacement at each contact point since the blocks were laid.
    force : (C, k) array
        Contact force on block b, compression positive.
    memory : (C, k - 1) array
        Friction force from which the next step starts; the friction force itself where the law is sharp.
    """

    displacement: np.ndarray
    force: np.ndarray
    memory: np.ndarray


class ElasticJoints:
    """An assembly on elastic joints.

    Parameters
    ----------
    assembly : Assembly
        Blocks, contact points, weights, and the support's motion or the live load.
    stiffness : JointStiffness
        Stiffness of a contact point, and the travel of the support, which is the unit of displacement.
    turning : float
        Share of the displacements of second order in the rotations that counts, see `Turning`; 0 for small rotations.

    Attributes
    ----------
    kinematics : (C k, n) sparse matrix
        From the displacements of the free blocks (rotations times the mean block size) to relative displacements.
    motion : (C, k) array
        Relative displacements that the support's whole travel imposes.
    weights, live_load : (n,) array
        Dead load, and the live load over `live_size`.
    live_size : float
        Sum over the blocks of the size of the live load's force per unit multiplier. The power of the load over this sum is the mean
        speed of the pushed blocks. For a load of pure moments, their sum over the mean block size. 1 for a settlement.
    mass : (n,) array
        Share of the mass that moves with each freedom; it weights the drag.
    normal, shear : float
        Stiffness of a contact point.
    sag : float
        Largest sag of the glued structure under its weight, over `unit`.
    """

    def __init__(self, assembly: Assembly, stiffness: JointStiffness, turning: float = 0.0) -> None:
        if stiffness.shear == 0.0:  # smooth joints: friction never builds up
            points = replace(assembly.points, friction=np.zeros_like(assembly.points.friction))
            assembly = replace(assembly, points=points)
        self.assembly, self.live = assembly, assembly.has_live_load
        speed, motion = support_motion(assembly, 0.0 if self.live else 1.0)
        self.unit = stiffness.travel * speed
        self.sag = stiffness.sag / self.unit
        self.width = 2 if assembly.effects.plane else 3
        self.friction = assembly.points.friction
        kinematics = assembly.kinematic_matrix(assembly.length)
        self.freedoms = kinematics.shape[1] // len(assembly.blocks)
        free = np.repeat(assembly.blocks.free, self.freedoms)
        self.motion = self.local(kinematics @ columns(assembly, motion))
        self.turning = Turning(assembly, self.unit, self.unit * motion, turning) if turning > 0.0 else None
        self._turned: np.ndarray | None = None  # displacements of second order
        self.all_kinematics = kinematics
        self.kinematics = kinematics[:, free].tocsr()
        self.transposed = self.kinematics.T.tocsr()
        self.weights = scaled_load(assembly, assembly.dead_load)
        live_load = scaled_load(assembly, assembly.live_load)
        self.live_size = self._size_of(live_load) if self.live else 1.0
        self.live_load = live_load / self.live_size
        self._round_off = ROUND_OFF * self.freedoms / len(live_load)
        mass = assembly.blocks.mass[assembly.blocks.free]
        self.mass = np.repeat(mass / mass.sum(), self.freedoms)
        self.normal, self.shear = (value * self.unit / assembly.weight for value in (stiffness.normal, stiffness.shear))

    def _size_of(self, live_load: np.ndarray) -> float:
        """Return the size of a live load (n,): see `live_size`."""
        by_block = live_load.reshape(-1, self.freedoms)
        forces, moments = (float(np.linalg.norm(part, axis=1).sum()) for part in (by_block[:, : self.width], by_block[:, self.width :]))
        return forces or moments

    def under(self, share: float) -> "ElasticJoints":
        """Return the same structure under a share of its weights."""
        other = copy.copy(self)
        other.weights, other._round_off = share * self.weights, share * self._round_off
        return other

    @property
    def laid(self) -> JointState:
        """Joints as laid, without displacement or force."""
        zero = np.zeros((len(self.friction), self.width))
        return JointState(zero, zero, zero[:, 1:])

    def local(self, values: np.ndarray) -> np.ndarray:
        """Values of all contact points (C k,) as an array (C, k)."""
        return values.reshape(-1, self.width)

    def displacement(self, blocks: np.ndarray, progress: float) -> np.ndarray:
        """Relative displacements (C, k) for displacements (n,) of the free blocks and the support's motion over its travel."""
        first = self.local(self.kinematics @ blocks) + progress * self.motion
        return first if self._turned is None else first + self._turned

    def as_turned(self, blocks: np.ndarray, progress: float, for_good: bool = False) -> "ElasticJoints":
        """Return the joints with the second order of the displacements `blocks`; the same joints where rotations are small.

        for_good: whether the second order stays as it is, because rotations are small from here on.
        """
        if self.turning is None:
            return self
        other = copy.copy(self)
        other._turned = self.turning.displacement(blocks, progress, self.local(self.kinematics @ blocks) + progress * self.motion)
        other.turning = None if for_good else self.turning
        return other

    @property
    def has_turned(self) -> bool:
        """Whether displacements of second order count."""
        return self._turned is not None

    def with_axes_of_first(self) -> "ElasticJoints":
        """Return joints whose axes turn with block a instead of block b; the same joints where rotations are small."""
        if self.turning is None:
            return self
        other = copy.copy(self)
        other.turning = self.turning.with_axes_of_first()
        return other

    def state(self, displacement: np.ndarray, before: JointState, smoothing: float = 0.0) -> tuple[JointState, np.ndarray]:
        """State at the end of a step, and minus the derivative of its forces by the displacements.

        Parameters
        ----------
        displacement : (C, k) array
            Relative displacements at the end of the step.
        before : JointState
            Joints at the start of the step, with their history of friction.
        smoothing : float
            Force over which a contact point parts and slips gradually; 0 for the sharp law.

        Returns
        -------
        state : JointState
            Displacements and forces at the end of the step.
        tangent : (C, k, k) array
            Stiffness of each contact point: not symmetric where it slides, zero where it parts.
        """
        normal, normal_slope = _positive(-self.normal * displacement[:, 0], smoothing)
        trial = before.memory - self.shear * (displacement[:, 1:] - before.displacement[:, 1:])
        size = np.linalg.norm(trial, axis=1)
        rubs = normal > self._round_off
        limit = self.friction * np.where(rubs, normal - self._round_off, 0.0)
        friction, by_trial, by_limit = _smaller(size, limit, smoothing)
        known = np.where(size > 0.0, size, 1.0)
        direction = trial / known[:, None]
        share = np.where(size > 0.0, friction / known, by_trial)
        force = np.concatenate([normal[:, None], trial * share[:, None]], axis=1)
        memory = trial * np.minimum(limit / known, 1.0)[:, None]  # cut back sharply, or friction would fade with every step
        tangent = np.zeros((len(normal), self.width, self.width))
        tangent[:, 0, 0] = self.normal * normal_slope
        pressed = np.where(rubs, by_limit * self.friction * tangent[:, 0, 0], 0.0)
        across, along = (np.where(rubs, self.shear * part, 0.0) for part in (share, by_trial - share))
        for i in range(1, self.width):
            tangent[:, i, 0] = pressed * direction[:, i - 1]
            for j in range(1, self.width):
                tangent[:, i, j] = across * (i == j) + along * direction[:, i - 1] * direction[:, j - 1]
        return JointState(displacement, force, memory), tangent

    def unbalanced(self, force: np.ndarray) -> np.ndarray:
        """Force (n,) on the free blocks that the contact forces (C, k) and the weights leave unbalanced."""
        balance: np.ndarray = self.transposed @ force.ravel() + self.weights
        return balance

    def reaction(self, force: np.ndarray) -> float:
        """Reaction of the support over the weight, per unit speed of its fastest point."""
        return float(np.sum(self.motion * force))

    def value_in_units(self, scaled: float) -> float:
        """Reaction in N or N m, or the multiplier, from its scaled value."""
        return scaled / self.live_size if self.live else scaled * self.assembly.weight * self.assembly.support_speed


def _positive(value: np.ndarray, smoothing: float) -> tuple[np.ndarray, np.ndarray]:
    """Positive part of a value, smoothed, and its derivative."""
    if smoothing == 0.0:
        return np.maximum(value, 0.0), (value > 0.0).astype(float)
    root = np.sqrt(value**2 + 4.0 * smoothing**2)  # a third of the time of np.hypot
    part = np.where(value > 0.0, 0.5 * (value + root), 2.0 * smoothing**2 / (root - np.minimum(value, 0.0)))
    return part, 0.5 * (1.0 + value / root)


def _smaller(first: np.ndarray, second: np.ndarray, smoothing: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Smaller of two values of at least 0, smoothed, and its derivatives by both."""
    if smoothing == 0.0:
        is_second = first > second
        return np.where(is_second, second, first), np.where(is_second, 0.0, 1.0), is_second.astype(float)
    total = first + second + smoothing
    root = np.sqrt(total**2 - 4.0 * first * second)
    smaller = 2.0 * first * second / (total + root)
    return smaller, (second - smaller) / root, (first - smaller) / root
