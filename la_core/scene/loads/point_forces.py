"""Constant forces at points of blocks, from loads and ties."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class PointForces:
    """N constant forces on blocks as flat arrays; they keep direction and lever arm as the blocks move.

    Attributes
    ----------
    block : (N,) array of int
        Block of each force.
    point : (N, 3) array
        Point of application of each force, m.
    force : (N, 3) array
        Force, N.
    mass : (N,) array
        Mass of a force that is a weight, kg; 0 for any other force.
    table : (N,) array of int
        Number of the [[load]] or [[tie]] table that gives each force, from 0.
    """

    block: np.ndarray
    point: np.ndarray
    force: np.ndarray
    mass: np.ndarray
    table: np.ndarray

    @classmethod
    def none(cls) -> "PointForces":
        """No force at all."""
        return cls(np.zeros(0, dtype=int), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0, dtype=int))

    @classmethod
    def gather(cls, several: list["PointForces"]) -> "PointForces":
        """All forces of several sets, one set after the other."""
        fields = ("block", "point", "force", "mass", "table")
        return cls(*(np.concatenate([getattr(one, name) for one in several]) for name in fields)) if several else cls.none()

    def __len__(self) -> int:
        return len(self.block)

    def wrenches(self, centroid: np.ndarray, per_mass: np.ndarray | None = None) -> np.ndarray:
        """Sum of the forces on each block as wrenches (B, 6) about the centroids (B, 3), N and N m.

        per_mass: acceleration (3,) that acts on the masses in place of the forces, m/s2.
        """
        force = self.force if per_mass is None else self.mass[:, None] * per_mass
        wrenches = np.zeros((len(centroid), 6))
        np.add.at(wrenches, self.block, np.concatenate([force, np.cross(self.point - centroid[self.block], force)], axis=1))
        return wrenches

    def weight(self, count: int, down: np.ndarray) -> np.ndarray:
        """Sum of the components along gravity of the forces on each of `count` blocks, N; a force that lifts counts as 0.

        down: unit vector (3,) of gravity.
        """
        return np.bincount(self.block, weights=np.maximum(self.force @ down, 0.0), minlength=count)
