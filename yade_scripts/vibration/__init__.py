"""How blocks swing on their contact points: springs, the inertia that a quasi-static run gives the blocks, and the stable time step."""

from yade_scripts.vibration.inertia import Inertia, slowed
from yade_scripts.vibration.springs import springs_of
from yade_scripts.vibration.time_step import highest_eigenvalue, stable_time_step

__all__ = ["Inertia", "highest_eigenvalue", "slowed", "springs_of", "stable_time_step"]
