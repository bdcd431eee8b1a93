"""The settings of YADE that follow from the path of limit analysis. YADE learns only these from a prediction, and never a value."""

import numpy as np

from la_core import exchange
from la_core.analysis.accuracy import scale
from la_core.analysis.modelling import has_given_stiffness
from la_core.analysis.result import LimitAnalysis
from la_core.coulomb import FLAT, STIFFER, CoulombSolution, plateau_of

LONG_PATH = 1.5  # travels: a path that was followed for longer was not flat after the first
STIFFENING_PER_TRAVEL, MOST_STIFFENING = 4.0, 32.0  # the path's travels until it is flat are a quarter of the run's travel
# Of the value's size: a curve that stays this near to its last value is steady; the second number is for a long run. YADE states an
# uncertainty of this size for its settings.
STEADY, STEADY_OF_LONG_RUN = 1e-3, 5e-3
# Of the way so far: a curve that leaves this band for a shorter stretch has only jumped, and is steady for a long run. On a wall of 1,008
# blocks a jump of 0.0006 travels, at four travels, doubled the time of its run.
JUMPS = 0.01


def settings_after_path(analysis: LimitAnalysis) -> dict[str, float]:
    """Return the settings of YADE that follow from a path which needed more than one travel to become flat.

    They are the stiffness of the joints, over that of limit analysis, and the share of the travel before a run may stop.
    With stiffer joints one travel of a run is as many elastic sags as several travels of the path. For a very long path, joints stiff
    enough would make time steps too short. YADE may then stop only where all of its plateau lies beyond the travel after which the path is
    steady.
    Empty where the path needed one travel, where the scene sets the stiffness itself, and where wedging gives the structure a thrust in
    proportion to it. Where blocks turn on the path, YADE covers its whole travel, with the joints that the path represents.
    """
    if analysis.assembly.effects.rotation == "finite":
        return {"plateau_share": 1.0} | ({} if has_given_stiffness(analysis.scene) else {"least_stiffening": STIFFER})
    coulomb = _long_path(analysis)
    if coulomb is None:
        return {}
    steady = _steady_after(coulomb, analysis.stiffness.travel, STEADY * scale(analysis))
    stiffening = min(STIFFENING_PER_TRAVEL * _flat_after(analysis, coulomb), MOST_STIFFENING)
    return {"least_stiffening": stiffening} | _share(steady, stiffening)


def settings_of_long_run(analysis: LimitAnalysis) -> dict[str, float]:
    """Return the settings that replace `settings_after_path` where a run with the latter would take long.

    A path may come near its last value early and then vary about it for many travels: that of a wall of 250 blocks stays within 0.5 % from
    0.3 travels on, within 0.1 % from 10 on, and is flat after 64. A long run needs only 0.5 %, jumps apart, and states this uncertainty.
    Empty where `settings_after_path` is, and where the scene requests an accuracy.
    """
    coulomb = _long_path(analysis)
    if coulomb is None or analysis.scene.accuracy is not None:
        return {}
    steady = _steady_after(coulomb, analysis.stiffness.travel, STEADY_OF_LONG_RUN * scale(analysis), JUMPS)
    stiffening = min(STIFFENING_PER_TRAVEL * max(steady, 1.0), MOST_STIFFENING)
    return {"least_stiffening": stiffening, "settings_uncertainty": STEADY_OF_LONG_RUN} | _share(steady, stiffening)


def _long_path(analysis: LimitAnalysis) -> CoulombSolution | None:
    """Return the prediction if its path needed more than one travel by itself; None otherwise, and where the scene sets the stiffness."""
    coulomb = analysis.coulomb
    if coulomb is None or analysis.assembly.effects.rotation == "finite" or has_given_stiffness(analysis.scene):
        return None
    return coulomb if _flat_after(analysis, coulomb) > LONG_PATH else None


def _flat_after(analysis: LimitAnalysis, coulomb: CoulombSolution) -> float:
    """Return the travels, 1, 2, 4 and so on, after which the curve was flat and steady at its last value; the whole path otherwise.

    A path goes on beyond a flat curve where a contact point is about to change its state. YADE need not go on if the value stays.
    """
    steady = _steady_after(coulomb, analysis.stiffness.travel, STEADY * scale(analysis))
    travels, values = coulomb.path_settlement / analysis.stiffness.travel, coulomb.path_value / scale(analysis)
    end = 1.0
    while end < coulomb.travel:
        way = travels <= end
        found = plateau_of(travels[way], values[way], end, values[way][-1])
        if end >= steady and found.is_flat and abs(found.value - coulomb.value / scale(analysis)) <= FLAT:
            return end
        end *= 2.0
    return coulomb.travel


def _share(steady: float, stiffening: float) -> dict[str, float]:
    """Return the share of a run's travel before it may stop, where the usual one is less. steady: travels of the path."""
    share = min(steady / stiffening / exchange.LATEST_START, 1.0)
    return {"plateau_share": share} if share > exchange.PLATEAU_SHARE else {}


def _steady_after(coulomb: CoulombSolution, travel: float, near: float, jumps: float = 0.0) -> float:
    """Return the travels after which a path stays `near` its value (N, N m, multiplier); 0 where it always does.

    The part of the curve after a plateau that it leaves does not count.

    travel: one travel, m or rad; jumps: share of the way so far for which the curve may be farther from its value later on.
    """
    travels = coulomb.path_settlement / travel
    away = (np.abs(coulomb.path_value - coulomb.value) > near) & (travels <= coulomb.travel)
    still_away = np.cumsum((away * np.diff(travels, prepend=0.0))[::-1])[::-1]  # length of the way from here on
    return float(travels[away & (still_away > jumps * travels)].max(initial=0.0))
