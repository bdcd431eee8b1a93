"""Look for the plateau in the record of a run: while it goes on, and at its end."""

import math
from dataclasses import dataclass, replace

import numpy as np

from la_core.exchange import GRAVITY, LEAST_REACTION, LEFT_PLATEAU
from yade_scripts import plateau
from yade_scripts.case import Case
from yade_scripts.driving import pushed_of
from yade_scripts.faults import settlement_words
from yade_scripts.plateau import EARLY, Earlier, Outcome, Plateau, Pose, geometry_of
from yade_scripts.recorder import Record, Status
from yade_scripts.settings import Settings, is_content, sag_of

# Largest effect of the joints' strain, as a share of the reaction: this factor times the elastic sag over the settlement.
STRAIN_OF_SAG = 0.03


def sway_of(displacement: np.ndarray, multiplier: np.ndarray) -> float:
    """Return the mean displacement over the multiplier, m, by which a structure sways before a live load moves it.

    It is taken where the multiplier first comes to half its greatest value. Where a light block moves on a heavy wall, this sway is most of
    the mean displacement, and no part of the mechanism. 0 for a structure that the servo mostly holds back: a small push before that, of
    noise alone, tells no sway.

    displacement: rows (T,), m; multiplier: of the same rows.
    """
    greatest = float(multiplier.max(initial=0.0))
    if greatest <= 0.0 or multiplier.mean() <= 0.0:
        return 0.0
    half = int(np.argmax(multiplier >= 0.5 * greatest))
    return max(float(displacement[half] / multiplier[half]), 0.0)


def lead_of(case: Case, poses: tuple[Pose, Pose, Pose]) -> float:
    """Return how far the blocks that a live load moves have moved along it, over the mean displacement; at least 1.

    poses: at rest, on the way, and now.
    """
    rest, before, now = poses
    rate, moved = ((now.displacement - then.displacement)[case.free] @ case.live for then in (before, rest))
    shares = pushed_of(case) * np.maximum(rate, 0.0)
    if now.settlement <= 0.0 or not shares.any():
        return 1.0
    return max(float(shares @ moved / shares.sum()) / now.settlement, 1.0)


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
    _lead: float = 1.0  # motion along a live load of the blocks that it moves, over the mean of all blocks
    _best_lead: float = 1.0  # the same at the best plateau

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
            self._best, self._best_lead = Earlier(fit, self.record.mark(), asked), self._lead
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
            fit, asked, self._lead = best.fit, best.asked, self._best_lead
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
        return STRAIN_OF_SAG * sag / (self.record.settlement() * self.case.support_speed * self._lead)

    def _fit(self) -> Plateau:
        rows, is_pushed = self.record.settling(), self.case.live is not None
        settlement, reaction = (np.array([getattr(row, name) for row in rows]) for name in ("settlement", "reaction"))
        sway = sway_of(settlement, reaction) if is_pushed else 0.0
        swayed = sway * float(reaction[-1]) if is_pushed and rows else 0.0
        middle = swayed + 0.5 * (plateau.STARTS[0] + plateau.STARTS[-1]) * (self.record.settlement() - swayed)
        before = next((pose for pose in reversed(self.record.poses) if pose.settlement <= middle), self.record.poses[0])
        now = self.record.pose()
        geometry = geometry_of(self.case, before, now)
        if not is_pushed:
            return plateau.fit(settlement, reaction, geometry)
        self._lead = lead_of(self.case, (self.record.poses[0], before, now))
        moved = settlement - sway * reaction
        line = plateau.fit(moved, reaction, geometry)
        # States of the plateau are known by their displacement. So it begins beyond all to which the structure has swayed before.
        swayed_to = float(settlement[moved < line.start].max(initial=0.0))
        start = max(line.start + sway * line.reaction, math.nextafter(swayed_to, math.inf))
        is_long = np.count_nonzero(settlement >= start) >= plateau.FEWEST_ROWS
        return replace(line, start=start) if is_long else plateau.NONE

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
