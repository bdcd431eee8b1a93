"""Results of limit analysis on one scene."""

from dataclasses import dataclass, replace

from la_core.analysis.accuracy_record import AccuracyRecord
from la_core.coulomb import CoulombSolution, EquilibriumPath
from la_core.limit import Drive, Solution
from la_core.model import Assembly, Effects, JointStiffness
from la_core.scene import Scene


@dataclass(frozen=True)
class Answers:
    """Answers at one inset.

    assembly: the contact points, and the effects that were modelled; of the reduced region where blocks were set aside.
    bounds: associated solution by drive, always of the whole structure. coulomb: the prediction with friction that does not dilate, None
    where the scene does not call for it.
    """

    assembly: Assembly
    bounds: dict[Drive, Solution]
    coulomb: CoulombSolution | None = None

    @property
    def main(self) -> Drive:
        """The drive whose answer the scene asks for."""
        return Drive.LIVE if Drive.LIVE in self.bounds else Drive.YIELDING

    @property
    def sharpest(self) -> Solution | CoulombSolution:
        """The prediction, else the bound that the scene asks for."""
        return self.coulomb or self.bounds[self.main]


@dataclass(frozen=True)
class LimitAnalysis:
    """Everything that limit analysis found out about a scene; it carries what it was made from.

    whole: the assembly with every free block, at the inset that both methods share. at_inset, sharp: answers at that inset, and for
    sharp arrises (inset 0); the same object where both insets are equal. stiffness: of the joints, at the shared inset.
    least_gap: bound of the gap between blocks without a joint, m, see `la_core.model.decide_dem_effects`; NaN where it was not looked for.
    path: the curve from rest to the plateau at the shared inset, None where nobody asked for it.
    accuracy: the attempts to reach the accuracy that the scene requests, None where it requests none.
    """

    scene: Scene
    whole: Assembly
    at_inset: Answers
    sharp: Answers
    stiffness: JointStiffness
    least_gap: float = float("nan")
    path: EquilibriumPath | None = None
    accuracy: AccuracyRecord | None = None

    @property
    def main(self) -> Drive:
        """The drive whose answer the scene asks for."""
        return self.at_inset.main

    @property
    def assembly(self) -> Assembly:
        """The assembly at the shared inset, as it was modelled: without the blocks that were set aside."""
        return self.at_inset.assembly

    @property
    def bounds(self) -> dict[Drive, Solution]:
        """Associated solution by drive, at the shared inset."""
        return self.at_inset.bounds

    @property
    def coulomb(self) -> CoulombSolution | None:
        """The prediction at the shared inset, None where the scene does not call for it."""
        return self.at_inset.coulomb

    def with_effects(self, effects: Effects) -> "LimitAnalysis":
        """The same with other effects, or other reasons for them, said of its assemblies."""
        at_inset = replace(self.at_inset, assembly=replace(self.assembly, effects=effects))
        sharp = at_inset if self.sharp is self.at_inset else replace(self.sharp, assembly=replace(self.sharp.assembly, effects=effects))
        return replace(self, whole=replace(self.whole, effects=effects), at_inset=at_inset, sharp=sharp)

    @property
    def printed(self) -> Answers:
        """The answers at the scene's own inset, which are printed."""
        return self.sharp if self.scene.inset == 0.0 else self.at_inset
