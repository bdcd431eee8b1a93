"""Results of limit analysis for one scene."""

from dataclasses import dataclass, replace

from la_core.analysis.accuracy_record import AccuracyRecord
from la_core.coulomb import CoulombSolution, EquilibriumPath
from la_core.limit import Drive, Solution
from la_core.model import Assembly, Effects, JointStiffness
from la_core.scene import Scene


@dataclass(frozen=True)
class Answers:
    """Bounds and prediction at one inset.

    Attributes
    ----------
    assembly : Assembly
        Contact points and modelled effects; those of the reduced region where blocks are set aside.
    bounds : dict of Drive to Solution
        Associated solution for each drive, always of the whole structure.
    coulomb : CoulombSolution or None
        Prediction with friction without dilatancy. None where only bounds are computed.
    """

    assembly: Assembly
    bounds: dict[Drive, Solution]
    coulomb: CoulombSolution | None = None

    @property
    def main(self) -> Drive:
        """Drive of the scene: the live load, or the settlement of the support."""
        return Drive.LIVE if Drive.LIVE in self.bounds else Drive.YIELDING

    @property
    def sharpest(self) -> Solution | CoulombSolution:
        """Prediction, or the bound of the main drive where there is no prediction."""
        return self.coulomb or self.bounds[self.main]


@dataclass(frozen=True)
class LimitAnalysis:
    """Complete results of limit analysis, with the scene and the model that they belong to.

    The shared inset is the inset of both methods: the scene's, or the smallest one of YADE where the scene has inset 0.

    Attributes
    ----------
    scene : Scene
        Scene that was analysed.
    whole : Assembly
        Assembly with every free block, at the shared inset.
    at_inset : Answers
        Answers at the shared inset.
    sharp : Answers
        Answers for sharp arrises (inset 0); the same object as `at_inset` where both insets are equal. It has no
        prediction where joints slide and the scene's arrises are rounded: sharp joints then slide in another order, and
        the value belongs to another history of friction, not to other lever arms.
    stiffness : JointStiffness
        Stiffness of the joints at the shared inset.
    least_gap : float
        Lower bound of the gap between blocks without a joint, m; NaN where it was not computed. See
        `la_core.model.decide_dem_effects`.
    path : EquilibriumPath or None
        Curve from rest to the plateau at the shared inset. None without a request.
    accuracy : AccuracyRecord or None
        Attempts to reach the requested accuracy. None without a request.
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
        """Drive of the scene: the live load, or the settlement of the support."""
        return self.at_inset.main

    @property
    def assembly(self) -> Assembly:
        """Modelled assembly at the shared inset, without the blocks that are set aside."""
        return self.at_inset.assembly

    @property
    def bounds(self) -> dict[Drive, Solution]:
        """Associated solution for each drive, at the shared inset."""
        return self.at_inset.bounds

    @property
    def coulomb(self) -> CoulombSolution | None:
        """Prediction at the shared inset; None where only bounds are computed."""
        return self.at_inset.coulomb

    def with_effects(self, effects: Effects) -> "LimitAnalysis":
        """Copy the analysis with these effects, and their reasons, in all of its assemblies."""
        at_inset = replace(self.at_inset, assembly=replace(self.assembly, effects=effects))
        sharp = at_inset if self.sharp is self.at_inset else replace(self.sharp, assembly=replace(self.sharp.assembly, effects=effects))
        return replace(self, whole=replace(self.whole, effects=effects), at_inset=at_inset, sharp=sharp)

    @property
    def printed(self) -> Answers:
        """Answers at the scene's own inset; tables and JSON show these."""
        return self.sharp if self.scene.inset == 0.0 else self.at_inset
