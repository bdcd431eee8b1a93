"""The symmetric part of a problem: half the unknowns, or a quarter, of a structure that is its own mirror image.

A bound is a convex programme. The mirror image of an admissible motion is admissible and has the same power, and so has
the mean of both. Some best motion is therefore symmetric, and so are some best forces. A symmetric motion has one unknown
for all unknowns that are images of each other. A contact point and its images have the same cone conditions. One of
these is enough, and its multiplier is the sum of the multipliers of all.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from la_core.limit.conic import Cones, ProgrammeAnswer
from la_core.limit.problem import DrivenProblem, ScaledProblem, multipliers_of, points_of_rows
from la_core.model import SAME_LOAD, Assembly, Image, global_forces, images, twists_of

LEAST_UNKNOWNS = 1000  # 333 blocks in the plane, 167 in space: for less the search was not worth its time
ROUND_OFF = 1e-12  # a smaller entry of the part, beside entries of order one, is a sum that should vanish


@dataclass(frozen=True)
class SymmetricPart:
    """Symmetric motions of a structure, and the rows of one contact point of each set of images.

    Attributes
    ----------
    group : list of Image
        Images of the structure under which loads and motion are the same; the structure itself is the first.
    basis : (n, r) sparse matrix
        From the unknowns of symmetric motions to the unknowns of all free blocks.
    kept : (m,) array of bool
        Rows of the whole problem that the part keeps; the row of a live load is one of them.
    """

    group: list[Image]
    basis: sparse.csr_matrix
    kept: np.ndarray

    def of(self, driven: DrivenProblem) -> DrivenProblem:
        """Return the problem of the symmetric motions."""
        rows, cones = self._reduced(driven.rows, driven.cones, self.kept)
        return replace(driven, power=self.basis.T @ driven.power, rows=rows, offset=driven.offset[self.kept], cones=cones)

    def at_rest(self, problem: ScaledProblem) -> ScaledProblem:
        """Return the problem of the symmetric motions without a drive; only power, rows and cones are those of the part."""
        rows, cones = self._reduced(problem.rows, problem.cones, self.kept[-problem.rows.shape[0] :])
        return replace(problem, power=self.basis.T @ problem.power, rows=rows, cones=cones)

    def _reduced(self, rows: sparse.csr_matrix, cones: Cones, kept: np.ndarray) -> tuple[sparse.csr_matrix, Cones]:
        """Rows of the part and their cones; kept: mask of the rows."""
        reduced = (rows[np.flatnonzero(kept)] @ self.basis).tocsr()
        reduced.data[np.abs(reduced.data) < ROUND_OFF] = 0.0  # equilibration would scale up a row that has only such entries
        reduced.eliminate_zeros()
        first, last = cones.equalities, cones.equalities + cones.inequalities
        return reduced, replace(cones, inequalities=int(kept[first:last].sum()), second_order=int(kept[last:].sum()) // 3)

    def whole(self, assembly: Assembly, problem: ScaledProblem, answer: ProgrammeAnswer) -> ProgrammeAnswer:
        """Return the answer of the whole problem from that of the symmetric motions.

        The force at each contact point is the mean, over the images, of the forces mapped there from the kept points.
        """
        multipliers = np.zeros(len(self.kept))
        multipliers[self.kept] = answer.multipliers
        before = len(self.kept) - problem.rows.shape[0]
        sums = global_forces(assembly, problem.flow_rule.T @ multipliers[before:])
        shared = sum(image.swap[:, None] * (sums[image.point] @ image.matrix) for image in self.group) / len(self.group)
        multipliers[before:] = multipliers_of(assembly, problem, np.asarray(shared))
        return replace(answer, x=self.basis @ answer.x, multipliers=multipliers)


def symmetric_part(assembly: Assembly, problem: ScaledProblem, driven: DrivenProblem) -> SymmetricPart | None:
    """Return the symmetric part of a problem.

    It is None where structure, loads or the support's motion are not symmetric, where sliding is excluded, and for a
    small problem.

    Parameters
    ----------
    assembly : Assembly
        The structure.
    problem : ScaledProblem
        `scaled_problem(assembly)`.
    driven : DrivenProblem
        The problem with its drive.
    """
    if len(problem.power) < LEAST_UNKNOWNS or problem.cones.equalities:
        return None
    axes, found = images(assembly)
    single = [[found[0], image] for image in found[1:]]
    for group in [found, *single] if len(single) > 1 else single:  # loads may be symmetric in one of two mirrors
        basis = _basis(assembly, axes, group)
        if _is_symmetric(assembly, problem, driven, basis, group):
            first = np.min([image.point for image in group], axis=0)
            point = points_of_rows(assembly, problem)
            return SymmetricPart(group, basis, np.append(np.ones(driven.cones.equalities, dtype=bool), first[point] == point))
    return None


def _basis(assembly: Assembly, axes: np.ndarray, group: list[Image]) -> sparse.csr_matrix:
    """Symmetric motions (n, r): each column holds the unknowns that are images of each other, with their signs."""
    plane, blocks = assembly.effects.plane, len(group[0].block)
    if plane:
        turn = np.eye(3)
        turn[:2, :2] = axes[np.ix_([0, 2], [0, 2])].T  # of vx and vz; a rotation about y stays
    else:
        turn = np.kron(np.eye(2), axes.T)
    width = len(turn)
    places, signs = [], []
    for image in group:
        of_axis = np.prod(image.signs) * image.signs  # of a rotation, whose sense a mirror reverses
        sign = np.array([image.signs[0], image.signs[2], of_axis[1]]) if plane else np.concatenate([image.signs, of_axis])
        places.append((image.block[:, None] * width + np.arange(width)).ravel())
        signs.append(np.tile(sign, blocks))
    place, sign = np.array(places), np.array(signs)
    first = place.min(axis=0)
    value = np.take_along_axis(sign, place.argmin(axis=0)[None], axis=0)[0]
    is_opposite = ((place == first) & (sign != value)).any(axis=0)  # an unknown whose image is its own opposite vanishes
    unknown = np.flatnonzero(~is_opposite)
    column = np.unique(first[unknown], return_inverse=True)[1]
    motions = sparse.csr_matrix((value[unknown], (unknown, column)), shape=(blocks * width, column.max() + 1))
    return (sparse.kron(sparse.identity(blocks), turn) @ motions).tocsr()


def _is_symmetric(assembly: Assembly, problem: ScaledProblem, driven: DrivenProblem, basis: sparse.csr_matrix, group: list[Image]) -> bool:
    """Whether loads and velocities are the same at all images.

    The velocities are those of a symmetric motion drawn at random, with the motion of the supports.
    """
    motion = basis @ np.random.default_rng(0).standard_normal(basis.shape[1])
    velocity = assembly.relative_velocity(twists_of(assembly, motion) + driven.imposed)
    if not all(_same(image.swap[:, None] * (velocity[image.point] @ image.matrix), velocity) for image in group[1:]):
        return False
    loads = [problem.power, *driven.rows[: driven.cones.equalities].toarray()]
    return all(_same(basis @ ((basis.T @ load) / basis.power(2).sum(axis=0).A1), load) for load in loads)


def _same(first: np.ndarray, second: np.ndarray) -> bool:
    return bool(np.abs(first - second).max() <= SAME_LOAD * np.abs(second).max())
