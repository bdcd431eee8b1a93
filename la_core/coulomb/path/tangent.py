"""Tangent matrix of blocks on elastic joints: its pattern and elimination order are found once, its values often.

The matrix is K = J' D J + drag M, with the kinematic matrix J, the stiffness D of the contact points and the masses M. Every
entry of K is a fixed combination of the entries of D, so that one sparse product yields all of them. Minimum degree
on the pattern orders the elimination once. Keeping this order made a factorisation of 1,000 plane blocks three to four times
faster than ordering anew each time; GMRES preconditioned by an old factorisation then saved no time. An old tangent that learns
from the moves made with it saves a third (`LearningTangent`).
"""

from collections.abc import Callable

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from la_core.coulomb.path.elastic_joints import ElasticJoints

PIVOT = 0.01  # a diagonal entry of at least this share of its column's largest is the pivot, which keeps the order and so the sparsity
# Most moves that a tangent learns from; and the least s'H y over s's of a move that it learns from: below that, corrections would be large.
MOST_LEARNT, LEAST_ALONG = 30, 0.1
Solve = Callable[[np.ndarray], np.ndarray]


class Tangent:
    """Tangent matrices of one assembly on elastic joints.

    Parameters
    ----------
    joints : ElasticJoints
        Structure on its elastic joints.

    Attributes
    ----------
    factorisations : int
        Number of factorisations so far.
    """

    def __init__(self, joints: ElasticJoints) -> None:
        self.factorisations = 0
        size = len(joints.weights)
        row, column, source, value = _products(joints)
        diagonal = np.arange(size)
        keys, place = np.unique(
            np.concatenate([column, diagonal]).astype(np.int64) * size + np.concatenate([row, diagonal]), return_inverse=True
        )
        order = _elimination_order(keys % size, keys // size, size)
        self._rank = np.argsort(order)  # position of each unknown in the elimination
        self._order = order
        new_row, new_column = self._rank[keys % size], self._rank[keys // size]
        sorted_by_column = np.lexsort((new_row, new_column))
        start = np.searchsorted(new_column[sorted_by_column], np.arange(size + 1))
        self._matrix = sparse.csc_matrix((np.zeros(len(keys)), new_row[sorted_by_column], start), shape=(size, size))
        position = np.argsort(sorted_by_column)[place]
        self._diagonal, self._mass = position[len(row) :], joints.mass
        shape = (len(keys), len(joints.friction) * joints.width**2)
        self._values = sparse.csr_matrix((value, (position[: len(row)], source)), shape=shape)

    def factorised(self, stiffness: np.ndarray, drag: float) -> Solve:
        """Factorise the matrix and return the function that solves with it; right-hand sides are (n,) or (n, r).

        Parameters
        ----------
        stiffness : (C, k, k) array
            Stiffness of the contact points.
        drag : float
            Factor of the masses.

        Raises
        ------
        RuntimeError
            The matrix is singular.
        """
        self._matrix.data = self._values @ stiffness.ravel()
        self._matrix.data[self._diagonal] += drag * self._mass
        self.factorisations += 1
        factors = splu(self._matrix, permc_spec="NATURAL", diag_pivot_thresh=PIVOT, options={"SymmetricMode": True})
        return lambda right: factors.solve(right[self._order])[self._rank]


class LearningTangent:
    """A factorised tangent that learns from the moves made with it, by Broyden's method (C. G. Broyden, Math. Comp. 19, 1965).

    After a move s that changed the unbalanced forces by -y, the inverse H becomes H + (s - H y) s'H / (s'H y): it then maps y to s.

    Parameters
    ----------
    solve : callable
        Solves with the factorised tangent.
    unbalanced : (n,) array
        Forces that the blocks leave unbalanced where it was factorised.

    Attributes
    ----------
    move : (n,) array
        Next move of the blocks.
    """

    def __init__(self, solve: Solve, unbalanced: np.ndarray) -> None:
        self._solve, self.move = solve, solve(unbalanced)
        self._learnt: list[tuple[np.ndarray, np.ndarray]] = []

    def learn(self, share: float, unbalanced: np.ndarray) -> bool:
        """Learn from the forces unbalanced after a share of the move, and set the next move; False after more than MOST_LEARNT moves."""
        made, following = share * self.move, self._solve(unbalanced)
        for moved, more in self._learnt:
            following += more * (moved @ following)
        mapped = self.move - following  # H y: H maps the unbalanced forces before the move to it, those after it to the following move
        along = float(made @ mapped)
        if along > LEAST_ALONG * float(made @ made):
            more = (made - mapped) / along
            self._learnt.append((made, more))
            following += more * (made @ following)
        self.move = following
        return len(self._learnt) <= MOST_LEARNT


def _products(joints: ElasticJoints) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """All products that add up to the matrix: their rows and columns in it, entries of the stiffness, and factors."""
    assembly, width, freedoms = joints.assembly, joints.width, joints.freedoms
    count = len(joints.friction)
    number = np.where(assembly.blocks.free, np.cumsum(assembly.blocks.free) - 1, -1)
    sides = []
    for block in assembly.contact_blocks:
        rows = np.broadcast_to(np.arange(count * width).reshape(count, width, 1), (count, width, freedoms))
        columns = np.broadcast_to(block[:, None, None] * freedoms + np.arange(freedoms), rows.shape)
        kinematics = np.asarray(joints.all_kinematics[rows.ravel(), columns.ravel()]).reshape(rows.shape)
        sides.append((number[block], kinematics))
    parts: list[tuple[np.ndarray, ...]] = []
    freedom, axis = np.arange(freedoms), np.arange(width)
    for first, from_first in sides:
        for second, from_second in sides:
            both = np.flatnonzero((first >= 0) & (second >= 0))
            value = np.einsum("crp,csq->cpqrs", from_first[both], from_second[both])
            row = first[both][:, None, None, None, None] * freedoms + freedom[:, None, None, None]
            column = second[both][:, None, None, None, None] * freedoms + freedom[:, None, None]
            source = both[:, None, None, None, None] * width**2 + axis[:, None] * width + axis
            used = np.flatnonzero(value)
            parts.append(tuple(np.broadcast_to(array, value.shape).ravel()[used] for array in (row, column, source, value)))
    row, column, source, value = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
    return row, column, source, value


def _elimination_order(row: np.ndarray, column: np.ndarray, size: int) -> np.ndarray:
    """Unknowns (n,) in an order of elimination that keeps the factors sparse: minimum degree on the symmetric pattern."""
    pattern = sparse.csc_matrix((np.ones(len(row)), (row, column)), shape=(size, size)) + size * sparse.identity(size, format="csc")
    factors = splu(pattern.tocsc(), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    return np.argsort(factors.perm_c)
