"""Progress of a path, for whoever waits for it."""

from dataclasses import dataclass


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
