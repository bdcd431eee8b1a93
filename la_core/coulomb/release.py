"""Value after a release by turning blocks: the paths of a prediction go on with finite rotations from the end of their first travel.

Until then the displacements of second order are too small to matter, so both values share this part of the paths. On 400 and on another
200 random scenes the paths that branch off end within 0.26 % of those whose blocks turn from rest on (`comparison/gallery/turning.md`).
Under a live load the fastest block goes farther than the mean on this way. Where it goes TOO_FAR, no path branches off.
"""

from dataclasses import dataclass

import numpy as np

from la_core.coulomb.certificate import ACCEPTED_RESIDUAL, error_of_forces, mechanism_and_forces
from la_core.coulomb.followed_path import FollowedPath, PredictionSettings, SharedProgress
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.quasi_static_path import least_travel
from la_core.coulomb.path.turning import STIFFER
from la_core.coulomb.plateau import EARLY, reference_size
from la_core.coulomb.several_paths import BROAD, joints_of_path, on_one_plateau, stated_uncertainty
from la_core.coulomb.sharp_path import go_on_turning
from la_core.coulomb.solution import CoulombSolution
from la_core.model import JointStiffness

CHANGED = 5e-3  # of the value: smaller changes are within the least tolerance of the judge
# Largest displacement of the fastest block at the end of the first travel, over the least travel of turning blocks. In pushed corners with
# a share of at most 0.43 the paths that branch off end within 0.1 % of those whose blocks turn from rest on; with 1.1 they end 9 % off.
TOO_FAR = 0.5
NAN = float("nan")


@dataclass(frozen=True)
class Released:
    """Value after a release and its uncertainty (N, N m or multiplier), NaN where unknown, and the Newton iterations that it took.

    state: its mechanism and contact forces, see `CoulombSolution.released_state`. is_doubtful: whether the value is unknown, or uncertain
    by more than 1 %, although the structure may release something.
    """

    value: float = NAN
    uncertainty: float = NAN
    iterations: int = 0
    state: tuple[np.ndarray, np.ndarray] | None = None
    is_doubtful: bool = False


def released(
    joints: ElasticJoints, stiffness: JointStiffness, followed: list[FollowedPath], settings: PredictionSettings, progress: SharedProgress
) -> Released:
    """Return the value after turning blocks have released thrusts; unknown without a certified plateau, or with smooth joints.

    It is unknown, too, where the fastest block has already gone TOO_FAR under a live load.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints, with small rotations.
    stiffness : JointStiffness
        Stiffness of the joints, and the travel.
    followed : list of FollowedPath
        Paths with small rotations.
    settings : PredictionSettings
        Limits of the paths.
    progress : SharedProgress
        Receives the progress of the paths.
    """
    starts = [path.first_travel for path in followed if path.first_travel is not None]
    if not starts or len(starts) < len(followed):
        return Released()
    turning, on = ElasticJoints(joints.assembly, stiffness, 1.0 / STIFFER), list[FollowedPath]()
    if any(start.pace * start.last.progress > TOO_FAR * least_travel(turning) for start in starts):
        return Released(is_doubtful=True)
    senders, iterations = progress.senders_of_more([path.viscosity for path in followed]), 0
    for number, (start, send) in enumerate(zip(starts, senders, strict=True), start=1):
        least = max((path.plateau.travel for path in on), default=0.0)
        if (path := go_on_turning(start, joints_of_path(turning, number, settings), settings, least, send)) is None:
            return Released(iterations=iterations, is_doubtful=True)
        on.append(path)
        iterations += path.iterations - start.iterations
        if path.is_short:  # its effort has ended, and the effort of a finer path would end, too
            return Released(iterations=iterations, is_doubtful=True)
    chosen = on_one_plateau(on)[0]
    value, unit = chosen.plateau.value, joints.value_in_units(1.0)
    uncertainty = stated_uncertainty(chosen, on) + error_of_forces(turning, chosen.end) / unit
    if not (chosen.end.certificate.worst <= ACCEPTED_RESIDUAL and uncertainty <= BROAD * reference_size(value)):
        return Released(iterations=iterations, is_doubtful=True)
    is_doubtful = uncertainty > EARLY * reference_size(value)
    return Released(value * unit, uncertainty * unit, iterations, mechanism_and_forces(turning, chosen.end), is_doubtful)


def change_by_release(coulomb: CoulombSolution, unit: float) -> tuple[float, float]:
    """Change of a prediction by a release and the doubt about it, both over the value. unit: value whose scaled value is 1."""
    size = reference_size(coulomb.value / unit) * unit
    return (coulomb.released - coulomb.value) / size, (coulomb.uncertainty + coulomb.released_uncertainty) / size


def is_changed_by_release(coulomb: CoulombSolution, unit: float) -> bool:
    """Return whether a release changes a prediction by more than CHANGED and the doubt; False if unknown. unit: see `change_by_release`."""
    change, doubt = change_by_release(coulomb, unit)
    return abs(change) > max(CHANGED, doubt)
