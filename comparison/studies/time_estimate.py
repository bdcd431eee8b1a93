"""Rough times of a scene by each method, estimated from its size: before a run, a user wants to know whether to wait."""

from dataclasses import dataclass

# YADE's time for finite rotations, with its whole travel, over that for small ones: median of ten random scenes, whose ratios are 2 to 12.
FINITE = 6.0
WITHIN = 3.0  # factor by which times of shipped scenes differ from the estimate; at most one in ten differs by more
TIMES = ((1.0, "s"), (60.0, "min"), (3600.0, "h"))  # seconds of each unit


@dataclass(frozen=True)
class TimeEstimate:
    """Time that a method takes on one core of an ordinary machine.

    Attributes
    ----------
    least, greatest : float
        Ends of the estimate, s.
    """

    least: float
    greatest: float

    def __str__(self) -> str:
        if self.greatest < 1.0:
            return "less than 1 s"
        least, greatest = _time(max(self.least, 1.0)), _time(self.greatest)
        return f"about {least}" if least == greatest else f"{least} to {greatest}"


def estimated_times(points: int, yade: bool = True, finite: bool = False) -> dict[str, TimeEstimate]:
    """Estimate the times of both methods from the number of contact points.

    The laws are fitted to the recorded times of the shipped scenes and of walls of up to 250 blocks, where limit analysis follows a path
    of states and YADE takes more steps for a larger structure.

    Parameters
    ----------
    points : int
        Contact points of the model.
    yade : bool
        Whether YADE can run the scene.
    finite : bool
        Whether rotations are finite, so that YADE covers its whole travel.

    Returns
    -------
    dict of str to TimeEstimate
        Estimates of "limit_analysis" and, where it can run, of "yade".
    """
    centres = {"limit_analysis": 5e-6 * points**2} | ({"yade": (FINITE if finite else 1.0) * (0.8 + 0.0019 * points**1.4)} if yade else {})
    return {method: TimeEstimate(centre / WITHIN, centre * WITHIN) for method, centre in centres.items()}


def _time(seconds: float) -> str:
    """Return a time in one unit, rounded to one digit, or to two below 20 of a unit."""
    size, unit = next((size, unit) for size, unit in reversed(TIMES) if seconds >= size)
    value = seconds / size
    rounded = round(value) if value < 20.0 else 10 * round(value / 10.0)
    return f"{rounded} {unit}"
