"""Search for joints that slide on the way to the plateau.

Without sliding on the way from rest, friction does no work, and the associated answer is Coulomb's.

The associated mechanism alone does not decide: dilatancy wedges blocks that slide without it, such as the lunes of a
dome. The structure is therefore also followed from rest over its travel, with slightly less friction. Slip on the way
does not matter if nothing slips over the second half of the travel: without dissipation the power of the weights alone
determines the value.
"""

import time
from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb.followed_path import annealed
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.joint_rates import joint_rates
from la_core.coulomb.path.quasi_static_path import QuasiStaticPath, first_travel
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.plateau import reference_size
from la_core.coulomb.solution import CoulombSolution, without_sliding
from la_core.limit import Solution, Status
from la_core.measures import mechanism
from la_core.model import Assembly, JointStiffness

LESS_FRICTION = 0.98  # of the scene's: a joint this close to its limit counts as sliding
SLIDING_SHARE = 1e-3  # of the exchanged power: below this no loaded joint slides in the mechanism of a prediction
# The same share in an associated mechanism; the error of the bound is about this share. Shipped scenes without sliding have 5e-8 at most,
# by rounding errors.
ASSOCIATED_SHARE = 1e-5
SLIGHT_WORK = 1e-3  # of the elastic energy at rest or now, whichever is larger: less work of friction on the way changes no force
SAME_VALUE = 1e-3  # of the value: for elastic joints this close to the bound their strain does not matter
VISCOSITY = 1e-2  # at the start of the search


@dataclass(frozen=True)
class Sliding:
    """Result of the search for sliding joints.

    Attributes
    ----------
    found : bool
        Whether a joint slides, or may slide.
    reason : str
        Reason for this result, a clause for people.
    law : str
        Friction law that suffices where no joint slides: "none-slides" or "associated".
    known : bool
        False where the associated problem has no answer to search in.
    seconds : float
        Time of the search.
    solves : int
        Newton iterations of the search.
    """

    found: bool
    reason: str
    law: str = "none-slides"
    known: bool = True
    seconds: float = 0.0
    solves: int = 0

    def unless_sliding(self, assembly: Assembly, solution: Solution) -> "Sliding":
        """This result, or one with `found` where loaded joints slide in the mechanism at another inset."""
        if self.found or not slides_in_mechanism(assembly, solution):
            return self
        reason = f"at an inset of {assembly.inset:g} m {_sliding_joint(assembly, solution)} slides in the mechanism"
        return replace(self, found=True, reason=reason)

    def as_coulomb(self, assembly: Assembly, associated: Solution) -> CoulombSolution:
        """The associated answer as Coulomb's, for a structure in which no joint slides."""
        return without_sliding(assembly, associated, self.seconds, self.solves)


def look_for_sliding(assembly: Assembly, stiffness: JointStiffness, associated: Solution, wedging: float) -> Sliding:
    """Search for sliding joints in the associated mechanism, then on a path with less friction.

    Parameters
    ----------
    assembly : Assembly
        Structure with its support motion or live load.
    stiffness : JointStiffness
        Stiffness of the joints, and the travel.
    associated : Solution
        Associated answer of the assembly.
    wedging : float
        Motion of the support against its settlement before gravity acts, m or rad.
    """
    if associated.status is not Status.SOLVED:
        locks = ", because dilatancy locks the blocks" if associated.status is Status.UNBOUNDED else ""
        return Sliding(True, f"the associated answer is {associated.status}{locks}", known=False)
    if not assembly.points.friction.any():
        reason = "joints without friction slide without dilating, so the associated answer is Coulomb's"
        return Sliding(False, reason, "associated")
    if slides_in_mechanism(assembly, associated):
        return Sliding(True, f"{_sliding_joint(assembly, associated)} slides in the mechanism")
    start = time.perf_counter()
    weaker = replace(assembly, points=replace(assembly.points, friction=LESS_FRICTION * assembly.points.friction))
    joints = ElasticJoints(weaker, stiffness)
    slides, reason, iterations = _slide_on_the_way(joints, wedging / stiffness.travel, associated)
    return Sliding(slides, reason, seconds=time.perf_counter() - start, solves=iterations)


def slides_in_mechanism(assembly: Assembly, solution: Solution) -> bool:
    """Whether loaded joints slide in an associated mechanism; False where the support moves alone, or without a solution."""
    if solution.status is not Status.SOLVED or not mechanism.moving(assembly, solution.twists).any():
        return False
    return mechanism.sliding_share(assembly, solution.twists, solution.forces) > ASSOCIATED_SHARE


def _slide_on_the_way(joints: ElasticJoints, wedging: float, associated: Solution) -> tuple[bool, str, int]:
    """Whether a joint slides on the path, the reason, and the Newton iterations."""
    tangent = Tangent(joints)
    rest, iterations = come_to_rest(joints, tangent, wedging)
    if rest is None:
        return True, "the blocks do not come to rest on elastic joints", iterations
    end, during = first_travel(joints), "under the live load" if joints.live else "while the support moves"
    path = QuasiStaticPath(joints, tangent, rest, annealed(joints, VISCOSITY))
    work, at_rest = np.zeros(len(joints.friction)), _energy(joints, rest)  # energy at rest: joints that open lose theirs later
    for _ in path.advance_to(end / 2.0):
        pass
    for _ in path.advance_to(end):
        work += _friction_work(joints, path.before, path.last)
        if work.sum() > SLIGHT_WORK * max(at_rest, _energy(joints, path.last)):
            return True, f"{_joint(joints.assembly, work)} slides {during}", iterations + path.iterations
    iterations += path.iterations
    if path.last.progress < end:
        return True, "a step on elastic joints has no answer", iterations
    bound = associated.value / joints.value_in_units(1.0)
    if abs(path.points[-1].value - bound) > SAME_VALUE * reference_size(bound):
        return True, "the strain of the joints keeps the structure from its plateau, so friction may decide the value", iterations
    less = f"{100.0 * (1.0 - LESS_FRICTION):.0f} %"
    return False, f"no joint slides {during}, even with {less} less friction: the bound is the value from rest", iterations


def _friction_work(joints: ElasticJoints, before: State, last: State) -> np.ndarray:
    """Work (C,) of friction in one step, scaled."""
    slip = joint_rates(joints, before, last).slip * (last.progress - before.progress)
    work: np.ndarray = joints.friction * last.joints.force[:, 0] * np.linalg.norm(slip, axis=1)
    return work


def _energy(joints: ElasticJoints, state: State) -> float:
    """Elastic energy of the joints, scaled."""
    normal, friction = state.joints.force[:, 0], state.joints.force[:, 1:]
    return float(np.sum(normal**2) / joints.normal + (np.sum(friction**2) / joints.shear if joints.shear > 0.0 else 0.0)) / 2.0


def _joint(assembly: Assembly, power: np.ndarray) -> str:
    """Name of the joint whose contact point has the largest power (C,)."""
    a, b = (int(block[np.argmax(power)]) for block in assembly.contact_blocks)
    return f'the joint between "{assembly.blocks.names[a]}" and "{assembly.blocks.names[b]}"'


def _sliding_joint(assembly: Assembly, solution: Solution) -> str:
    """Name of the joint whose contact point dissipates most by friction."""
    _, speed = mechanism.contact_speeds(assembly, solution.twists)
    compression = np.maximum(assembly.split(solution.forces)[0], 0.0)
    return _joint(assembly, compression * assembly.points.friction * speed)
