"""Look for the plateau in the record of a run: while it goes on, and at its end."""

import math
from dataclasses import dataclass, replace

import numpy as np

from la_core.exchange import GRAVITY, LEAST_REACTION, LEFT_PLATEAU
from yade_scripts import plateau
from yade_scripts.case import Case
from yade_scripts.faults import settlement_words
from yade_scripts.plateau import EARLY, Earlier, Outcome, Plateau, geometry_of
from yade_scripts.recorder import Record, Status
from yade_scripts.settings import Settings, is_content, sag_of

# Largest effect of the joints' strain, as a share of the reaction: this factor times the elastic sag over the settlement.
STRAIN_OF_SAG = 0.03


@dataclass
class PlateauSearch:
    """The search for the plateau in the record of a run.

    Attributes
    ----------
    case : Case
        The case that runs.
    settings : Settings
        Every setting of the run.
    record : Record
        Rows and poses so far.
    plateau : Plateau
        The last fit; its values are NaN before the first one.
    """

    case: Case
    settings: Settings
    record: Record
    plateau: Plateau = plateau.NONE
    _best: Earlier | None = None

    def look(self, asked: float) -> bool:
        """Fit the record so far, and return whether the run may end.

        It may end if the plateau is known and the motion on it is steady, or if the reaction has left the best plateau.
        asked: settlement imposed so far, m or rad.
        """
        self.plateau = fit = self._fit()
        is_known = self._is_plateau(fit, self.settings.stop_uncertainty) and self._strain <= self.settings.stop_uncertainty
        if is_known and self._is_steady(fit):
            return True
        best, enough = self._best, EARLY * self._scale(fit)
        if fit.uncertainty <= enough and (best is None or fit.uncertainty < best.fit.uncertainty):
            self._best = Earlier(fit, self.record.mark(), asked)
            return False
        return best is not None and best.is_left(fit, enough)

    def ended(self, asked: float) -> tuple[Status, str, float]:
        """Return the status of a run that ends now, the reason, and the imposed settlement at its end (m or rad).

        The run ends with a plateau, or without one if the curve creeps or is noisy. If the reaction has left the best plateau, the record
        is cut at the end of that plateau. asked: settlement imposed so far.
        """
        fit, best, ending = self._fit(), self._best, ""
        name = "reaction" if self.case.live is None else "multiplier"
        if best is not None and best.is_left(fit, EARLY * self._scale(fit)):
            fit, asked = best.fit, best.asked
            ending = f"; the {name}{LEFT_PLATEAU}{settlement_words(self.case, self.record.settlement())}"
            self.record.cut(best.mark)
        self.plateau, reached = fit, self.record.settlement()
        if self._is_plateau(fit, self.settings.plateau_uncertainty):
            self.plateau = replace(fit, creeps=False)
            return Status.PLATEAU, f"steady from {settlement_words(self.case, reached, fit.start)}{ending}", asked
        why = plateau.shortcoming(fit, self._scale(fit), self.settings.plateau_uncertainty, name)
        return Status.NO_PLATEAU, f"the whole travel is covered at {settlement_words(self.case, reached)} and {why}", asked

    @property
    def outcome(self) -> Outcome:
        """Reaction of the plateau with the parts of its uncertainty; no value where the curve creeps or has no fit."""
        fit, settings = self.plateau, self.settings
        if fit.creeps or not math.isfinite(fit.reaction):
            return plateau.NO_OUTCOME
        stiffness = math.hypot(fit.from_strain, self._strain * fit.reaction, settings.settings_uncertainty * fit.reaction)
        return Outcome(fit.reaction, fit.from_scatter, fit.from_fit, stiffness)

    @property
    def _strain(self) -> float:
        """Largest share of the reaction that may be due to the joints' strain; it falls as the support moves on."""
        sag = sag_of(self.case, self.settings.normal_stiffness)
        return STRAIN_OF_SAG * sag / (self.record.settlement() * self.case.support_speed)

    def _fit(self) -> Plateau:
        rows = self.record.settling()
        settlement, reaction = (np.array([getattr(row, name) for row in rows]) for name in ("settlement", "reaction"))
        middle = 0.5 * (plateau.STARTS[0] + plateau.STARTS[-1]) * self.record.settlement()
        before = next((pose for pose in reversed(self.record.poses) if pose.settlement <= middle), self.record.poses[0])
        return plateau.fit(settlement, reaction, geometry_of(self.case, before, self.record.pose()))

    def _is_steady(self, fit: Plateau) -> bool:
        """Whether each block, or all but a few of many, keeps its velocity over the plateau. True for a run without a damped swing.

        The damper makes blocks seem heavier. So a part of the structure that stands on its own may still sway under a constant reaction.
        """
        if self.settings.swing_damping == 0.0:
            return True
        now = self.record.pose()
        poses = [pose for pose in self.record.poses if fit.start <= pose.settlement < now.settlement]
        if len(poses) < 2:
            return True
        middle = min(poses[1:], key=lambda pose: abs(pose.settlement - 0.5 * (poses[0].settlement + now.settlement)))
        fastest = self.case.support_speed if self.case.live is None else plateau.largest_speed(middle, now)
        shares = plateau.STEADY_ENOUGH if is_content(self.settings) else plateau.STEADY
        return plateau.is_steady((poses[0], middle, now), self.case.free, fastest, shares)

    def _scale(self, fit: Plateau) -> float:
        """Return the reaction by which uncertainties are divided. It has a lower limit, because a reaction of zero is noise alone."""
        if self.case.live is not None:
            return max(abs(fit.reaction), self.settings.reaction_floor)
        at_rest = next(row.reaction for row in reversed(self.record.rows) if row.stage == GRAVITY)
        least = LEAST_REACTION * self.case.weight * (self.case.block_size if self.case.is_rotation else 1.0)
        return max(abs(fit.reaction), self.settings.reaction_floor * abs(at_rest), least)

    def _is_plateau(self, fit: Plateau, uncertainty: float) -> bool:
        """Whether a fit is certain enough for a plateau. A creeping fit counts if its uncertainty, which includes the creep, is small."""
        scale = self._scale(fit)
        is_flat = (not fit.creeps or fit.uncertainty <= EARLY * scale) and fit.drift <= self.settings.plateau_drift * scale
        return is_flat and fit.uncertainty <= uncertainty * scale
