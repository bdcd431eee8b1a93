"""Search for joints that slide on the way to the plateau.

Without sliding, friction has no history, and the associated answer is Coulomb's.

The associated mechanism alone does not decide: dilatancy wedges blocks that slide without it, such as the lunes of a
dome. The structure therefore also moves from rest to half and to all of its travel, on elastic joints with slightly
less friction. Slip before rest does not matter if nothing slips afterwards. Slip on the way matters, because it
changes the state of friction on the plateau.
"""

from dataclasses import dataclass, replace

import numpy as np

from la_core.coulomb.elastic_joints import ElasticJoints
from la_core.coulomb.fixed_point import CONVERGED, Step
from la_core.coulomb.plateau import CoulombSolution, follow, value_of, without_sliding
from la_core.limit import Solution, Status
from la_core.measures import mechanism
from la_core.model import Assembly, JointStiffness

LESS_FRICTION = 0.98  # of the scene's: a joint this close to its limit counts as sliding
SLIDING_SHARE = 1e-3  # of the exchanged power: below this no loaded joint slides in a mechanism
SAME_VALUE = 1e-3  # of the value: for elastic steps this close to the bound the strain of the joints does not matter
STATIONS = np.array([0.5, 1.0])  # of the travel


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
        Solver time of the search.
    solves : int
        Associated programmes of the search.
    """

    found: bool
    reason: str
    law: str = "none-slides"
    known: bool = True
    seconds: float = 0.0
    solves: int = 0

    def unless_sliding(self, assembly: Assembly, solution: Solution) -> "Sliding":
        """The same result, or `found` where loaded joints slide in the mechanism at another inset."""
        if self.found or not slides_in_mechanism(assembly, solution):
            return self
        reason = f"at an inset of {assembly.inset:g} m {_sliding_joint(assembly, solution)} slides in the mechanism"
        return replace(self, found=True, reason=reason)

    def as_coulomb(self, assembly: Assembly, associated: Solution) -> CoulombSolution:
        """The associated answer as Coulomb's, for a structure in which no joint slides."""
        return without_sliding(assembly, associated, self.seconds, self.solves)


def look_for_sliding(assembly: Assembly, stiffness: JointStiffness, associated: Solution, wedging: float = 0.0) -> Sliding:
    """Search for sliding joints in the associated mechanism, then in a few elastic steps.

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
        return Sliding(True, f"the associated answer is {associated.status}", known=False)
    if not assembly.points.friction.any():
        reason = "joints without friction slide without dilating, so the associated answer is Coulomb's"
        return Sliding(False, reason, "associated")
    if slides_in_mechanism(assembly, associated):
        return Sliding(True, f"{_sliding_joint(assembly, associated)} slides in the mechanism")
    weaker = replace(assembly, points=replace(assembly.points, friction=LESS_FRICTION * assembly.points.friction))
    joints = ElasticJoints(weaker, stiffness)
    steps = list(follow(joints, STATIONS, stiffness, wedging, most_solves=1))
    slides, reason = _judge(joints, steps, associated)
    return Sliding(slides, reason, seconds=joints.seconds, solves=joints.solves)


def slides_in_mechanism(assembly: Assembly, solution: Solution) -> bool:
    """Whether loaded joints slide in the mechanism of a solution."""
    return solution.status is Status.SOLVED and mechanism.sliding_share(assembly, solution.twists, solution.forces) > SLIDING_SHARE


def _judge(joints: ElasticJoints, steps: list[Step], associated: Solution) -> tuple[bool, str]:
    _, *settling = steps
    if len(settling) < len(STATIONS) or not settling[-1].trial.solved:
        return True, "a step on elastic joints has no answer"
    for step in settling:
        if step.strain_residual > CONVERGED:
            slip = np.linalg.norm(step.trial.slip, axis=1) * joints.assembly.points.friction
            return True, f"{_joint(joints.assembly, step.joints.force[:, 0] * slip)} slides while the support moves"
    value = value_of(joints, settling[-1])
    if abs(value - associated.value) > SAME_VALUE * abs(associated.value):
        return True, "the strain of the joints keeps the structure from its plateau, so friction decides the value"
    return (
        False,
        f"no joint slides while the support moves, even with {1.0 - LESS_FRICTION:.0%} less friction: its history does not matter",
    )


def _joint(assembly: Assembly, power: np.ndarray) -> str:
    """Name of the joint whose contact point has the largest power (C,)."""
    a, b = (int(block[np.argmax(power)]) for block in assembly.contact_blocks)
    return f'the joint between "{assembly.blocks.names[a]}" and "{assembly.blocks.names[b]}"'


def _sliding_joint(assembly: Assembly, solution: Solution) -> str:
    """Name of the joint whose contact point dissipates most by friction."""
    _, speed = mechanism.contact_speeds(assembly, solution.twists)
    compression = np.maximum(assembly.split(solution.forces)[0], 0.0)
    return _joint(assembly, compression * assembly.points.friction * speed)
