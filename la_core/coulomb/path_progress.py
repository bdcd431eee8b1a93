"""Progress of a path, for whoever waits for it."""

from collections.abc import Callable
from dataclasses import dataclass

from la_core.coulomb.elastic_joints import ElasticJoints


@dataclass(frozen=True)
class PathProgress:
    """Progress of the paths of one prediction.

    Attributes
    ----------
    progress : float
        Motion of the support, or displacement along the live load, over the travel.
    share : float
        Estimated share of the paths that is done, 0 to 1.
    value : float
        Reaction (N or N m) or multiplier so far.
    viscosity : float
        First viscosity of the path.
    path, paths : int
        Number of this path, from 1, and of all paths.
    """

    progress: float
    share: float
    value: float
    viscosity: float
    path: int
    paths: int


Reporter = Callable[[PathProgress], None]
Sender = Callable[[float, float, float], None]  # progress, end of the travel, scaled value


def sender(joints: ElasticJoints, report: Reporter | None, viscosity: float, path: int, paths: int) -> Sender:
    """Function that reports the points of one path with this first viscosity."""

    def send(progress: float, end: float, value: float) -> None:
        if report is not None:
            share = (path - 1 + min(progress / end, 1.0)) / paths
            report(PathProgress(progress, share, joints.value_in_units(value), viscosity, path, paths))

    return send
