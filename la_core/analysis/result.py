"""Results of limit analysis on one scene."""

from dataclasses import dataclass

from la_core.analysis.accuracy_record import Purchase
from la_core.coulomb import CoulombSolution, Path
from la_core.limit import Drive, Solution
from la_core.model import Assembly, JointStiffness


@dataclass(frozen=True)
class LimitAnalysis:
    """Solutions of a scene at the inset the methods share and for sharp arrises.

    assembly: contact points at the shared inset: the scene's, or the smallest that YADE can take where the scene has none.
    rounded, sharp: solution by drive at that inset and at inset 0. stiffness: of the joints, at the shared inset.
    coulomb, coulomb_sharp: the same with friction that does not dilate, None where the scene does not call for it.
    least_gap: bound of the gap between blocks without a joint, m, see `run_effects.settle_run`; NaN where nobody looked.
    path: the curve from rest to the plateau at the shared inset, None where nobody asked for it.
    purchase: what was tried for the accuracy that the scene asks for, None where it asks for none.
    """

    assembly: Assembly
    rounded: dict[Drive, Solution]
    sharp: dict[Drive, Solution]
    stiffness: JointStiffness
    least_gap: float = float("nan")
    coulomb: CoulombSolution | None = None
    coulomb_sharp: CoulombSolution | None = None
    path: Path | None = None
    purchase: Purchase | None = None

    @property
    def main(self) -> Drive:
        """The drive whose answer the scene asks for."""
        return Drive.LIVE if Drive.LIVE in self.rounded else Drive.YIELDING
