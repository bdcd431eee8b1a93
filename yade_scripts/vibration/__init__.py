"""Vibration of blocks on their contact points: springs, inertia of the blocks in a quasi-static run, and the stable time step."""

from yade_scripts.vibration.inertia import MOST, MOST_PUSHED, Inertia, slowed
from yade_scripts.vibration.springs import springs_of
from yade_scripts.vibration.time_step import highest_eigenvalue, stable_time_step

__all__ = ["MOST", "MOST_PUSHED", "Inertia", "highest_eigenvalue", "slowed", "springs_of", "stable_time_step"]
