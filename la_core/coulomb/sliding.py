"""Whether a joint slides on the way to the answer; where none does, friction has no history and the associated answer is Coulomb's.

The associated mechanism alone cannot tell: dilatancy wedges blocks that slide without it, such as the lunes of a dome. So the
structure also goes from rest to half and to all of its travel on elastic joints with a little less friction. Slip at rest does not
matter where nothing slips from there on; slip on the way does, for it leaves another state of friction on the plateau.
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
SAME_VALUE = 1e-3  # of the value: the elastic steps come to the bound, so that the joints' strain decides nothing
STATIONS = np.array([0.5, 1.0])  # of the travel


@dataclass(frozen=True)
class Sliding:
    """What was found: whether a joint slides, why this is known, and what the search took.

    law: what the scene does with where none was found. known: False where there is no answer to look at.
    """

    found: bool
    reason: str
    law: str = "none-slides"
    known: bool = True
    seconds: float = 0.0
    solves: int = 0

    def unless_sliding(self, assembly: Assembly, solution: Solution) -> "Sliding":
        """The same, but found where loaded joints slide in the mechanism of another solution."""
        if self.found or not slides_in_mechanism(assembly, solution):
            return self
        return replace(
            self, found=True, reason=f"at an inset of {assembly.inset:g} m {_sliding_joint(assembly, solution)} slides in the mechanism"
        )

    def as_coulomb(self, assembly: Assembly, associated: Solution) -> CoulombSolution:
        """The associated answer as Coulomb's, where nothing slides."""
        return without_sliding(assembly, associated, self.seconds, self.solves)


def look_for_sliding(assembly: Assembly, stiffness: JointStiffness, associated: Solution, wedging: float = 0.0) -> Sliding:
    """Look at the associated mechanism, then at few elastic steps. wedging: as in `la_core.coulomb.predict`."""
    if associated.status is not Status.SOLVED:
        return Sliding(True, f"the associated answer is {associated.status}", known=False)
    if not assembly.points.friction.any():
        return Sliding(False, "without friction joints slide without dilating, so that the associated answer is Coulomb's", "associated")
    if slides_in_mechanism(assembly, associated):
        return Sliding(True, f"{_sliding_joint(assembly, associated)} slides in the mechanism")
    weaker = replace(assembly, points=replace(assembly.points, friction=LESS_FRICTION * assembly.points.friction))
    joints = ElasticJoints(weaker, stiffness)
    steps = list(follow(joints, STATIONS, stiffness, wedging, most_solves=1))
    found, reason = _judge(joints, steps, associated)
    return Sliding(found, reason, seconds=joints.seconds, solves=joints.solves)


def slides_in_mechanism(assembly: Assembly, solution: Solution) -> bool:
    """Whether loaded joints slide in a solution's mechanism."""
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
        return True, "strain of the joints keeps the structure from its plateau, and friction decides what it comes to"
    return False, f"no joint slides while the support moves, even with {1.0 - LESS_FRICTION:.0%} less friction: its history decides nothing"


def _joint(assembly: Assembly, power: np.ndarray) -> str:
    """Name of the joint with most of a power (C,)."""
    a, b = (int(block[np.argmax(power)]) for block in assembly.contact_blocks)
    return f'the joint between "{assembly.blocks.names[a]}" and "{assembly.blocks.names[b]}"'


def _sliding_joint(assembly: Assembly, solution: Solution) -> str:
    """Name of the joint in which friction dissipates most."""
    _, speed = mechanism.contact_speeds(assembly, solution.twists)
    compression = np.maximum(assembly.split(solution.forces)[0], 0.0)
    return _joint(assembly, compression * assembly.points.friction * speed)
