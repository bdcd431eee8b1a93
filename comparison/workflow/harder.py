"""A second attempt after a first one without agreement, with finer settings for each method.

The settings depend on the scene and on the settings of the first attempt, never on a value of either method. So the second attempt is as
blind as the first. The first verdict is stored with the second comparison.
"""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from comparison.limit_analysis import Listener
from comparison.numbers import plural
from comparison.run_folder import SECOND_ATTEMPT, is_second_attempt
from comparison.settings import HARDER_SECONDS
from comparison.verdict import Verdict
from comparison.workflow.one_scene import run_scene
from la_core.errors import SceneError
from la_core.exchange import EARLIER_ATTEMPT, TRAVEL_PERIODS
from la_core.scene import Scene, same_structure

STIFFER = 4.0  # factor on the stiffness of the joints: the travel over their strain grows by as much, so plateaus are flatter
SLOWER = 2.0  # factor on the duration of YADE's travel
STIFFNESSES = ("normal_stiffness", "shear_stiffness")  # names of the stiffnesses that a scene may set
DAMPED = 1.0  # damping ratio at the contacts: with light damping blocks may jump past an equilibrium
# Seconds of the second run over those of one attempt of YADE's first run. The first run may have made up to five attempts until stiffness
# and damping were right. On 14 scenes the second run took 1.4 to 19 times as long as such an attempt, 10 in the median. A second run that
# exceeds its time is stopped.
DEARER = 10.0
DEARER_PATHS = 8.0  # seconds of the second prediction over those of the first
OPEN = (Verdict.DISAGREE, Verdict.UNEXPECTED, Verdict.INCONCLUSIVE)  # verdicts that call for a second attempt


def try_harder(
    first: Mapping[str, Any], scene: Scene, results: Path, listener: Listener, with_yade: bool, seconds: float = HARDER_SECONDS
) -> dict[str, Any] | None:
    """Run a scene again with finer settings, and return the content of the second comparison.json.

    None if the first verdict leaves nothing open. Also None if no attempt can be made, or if it would take too long; the listener then gets
    the reason.

    Parameters
    ----------
    first : mapping
        Content of the first comparison.json.
    scene : Scene
        The scene of the first attempt.
    results : Path
        Folder of all results; the second attempt has its own folder SCENE_harder there.
    listener : Listener
        Receives the progress.
    with_yade : bool
        Whether YADE runs.
    seconds : float
        Longest wall time of the attempt, s; YADE's run is then stopped, even if the first run had a longer limit.
    """
    if first["verdict"] not in OPEN:
        return None
    of_prediction = (1.0 if scene.effort == "high" else DEARER_PATHS) * _prediction_seconds(first)
    is_missing = (first["yade"] or {}).get("status") == "missing"
    reason = "YADE is missing" if is_missing else _why_finest(scene, with_yade) or _too_long(first, with_yade, of_prediction, seconds)
    if reason:
        listener.stage(scene.name, "comparison", f"not tried harder: {reason}")
        return None
    of_yade = seconds - of_prediction
    listener.stage(scene.name, "comparison", f"{first['verdict']}; {_what_follows(first, with_yade, of_yade)}")
    harder = same_structure(scene, finer_settings(scene, first["settings"] or {}), f"{scene.name}{SECOND_ATTEMPT}")
    return run_scene(harder, results / harder.name, listener, with_yade, of_yade, first_verdict=_first_verdict(first))


def _why_finest(scene: Scene, with_yade: bool) -> str:
    """Return the reason why no settings of a second attempt are finer than those of a scene; "" if some are."""
    if is_second_attempt(scene):
        return f'this is a second attempt already, because its name ends in {SECOND_ATTEMPT} and its effort is "high"'
    if scene.effort == "high" and not with_yade:
        return 'the scene sets effort = "high", so limit analysis has followed finer paths already, and YADE does not run'
    return ""


def _too_long(first: Mapping[str, Any], with_yade: bool, of_prediction: float, seconds: float) -> str:
    """Return the message that the second attempt would take too long; "" if it would not. of_prediction: seconds of limit analysis."""
    expected = DEARER * _seconds_of_attempt(first["yade"] or {}) * with_yade + of_prediction
    if expected <= seconds:
        return ""
    minutes = math.ceil(expected / 60.0)
    more = " or more, because its time limit cut YADE's first run off" if with_yade and _is_cut_off(first) else ""
    allowed = f"--try-harder-limit {60 * minutes} (s) allows it, in Python `try_harder_limit`"
    return f"this would take about {plural(minutes, 'minute')}{more}; {allowed}"


def _what_follows(first: Mapping[str, Any], with_yade: bool, of_yade: float) -> str:
    """Return the line on the start of a second attempt. of_yade: longest wall time of YADE's run, s."""
    words = "both methods run again with finer settings"
    if not with_yade:
        return words
    cut_off = "; its time limit cut the first run off, so nobody knows how long this one takes" if _is_cut_off(first) else ""
    return f"{words}, YADE for at most {of_yade:.0f} s (--try-harder-limit){cut_off}"


def _is_cut_off(first: Mapping[str, Any]) -> bool:
    """Return whether YADE's first run ended at its time limit; a complete run then takes longer than its seconds."""
    return (first["yade"] or {}).get("status") == "timeout"


def refuse_names_of_attempts(scenes: Iterable[Scene], with_yade: bool = False) -> None:
    """Raise SceneError for a scene with the name of another scene's second attempt, because the two would share a folder of results.

    with_yade: whether YADE runs; without it, a scene of high effort has no second attempt.
    """
    by_name = {scene.name: scene for scene in scenes}
    for name, scene in by_name.items():
        other = by_name.get(f"{name}{SECOND_ATTEMPT}")
        if other is not None and not _why_finest(scene, with_yade):
            rule = f'"{other.name}" is also the name of the second attempt of {scene.path}, and each needs a folder of its own'
            raise SceneError(str(other.path), rule, hint="rename one file, or run the two in different folders (-o)")


def finer_settings(scene: Scene, run: Mapping[str, float]) -> dict[str, Any]:
    """Return the scene keys of the second attempt: finer paths, and in YADE a slower, more damped run with stiffer joints.

    run: settings of YADE's first run; empty without a run.
    """
    settings = {"effort": "high", "yade.damping_ratio": max(DAMPED, float(scene.yade.get("damping_ratio", 0.0)))}
    names = [name for name in STIFFNESSES if name in scene.yade] or ["stiffening"]
    settings |= {f"yade.{name}": STIFFER * run[name] for name in names if name in run}
    if "speed" in scene.yade:
        return settings | {"yade.speed": float(scene.yade["speed"]) / SLOWER}
    periods = float(scene.yade.get("travel_periods", TRAVEL_PERIODS))
    if scene.accuracy is not None:  # the requested accuracy may have made the first run slower
        periods = max(periods, run.get("travel_periods", 0.0))
    return settings | {"yade.travel_periods": SLOWER * periods}


def _seconds_of_attempt(yade: Mapping[str, Any]) -> float:
    """Return the mean seconds of an attempt of YADE's run; 0 without an attempt."""
    return float(yade.get("seconds") or 0.0) / (1 + str(yade.get("message")).count(EARLIER_ATTEMPT))


def _prediction_seconds(first: Mapping[str, Any]) -> float:
    coulomb = first["limit_analysis"]["coulomb"] or {}
    return float(coulomb.get("seconds") or 0.0)


def _first_verdict(first: Mapping[str, Any]) -> dict[str, Any]:
    """Return the data of the first attempt that the second one stores: scene, verdict, reason, and the values of both methods."""
    coulomb, yade = first["limit_analysis"]["coulomb"] or {}, first["yade"] or {}
    shared = coulomb.get("shared_inset") or coulomb
    values = {"coulomb": shared.get("reaction", shared.get("multiplier")), "coulomb_uncertainty": shared.get("uncertainty")}
    values |= {"yade": yade.get("reaction"), "yade_uncertainty": yade.get("uncertainty")}
    return {name: first[name] for name in ("scene", "verdict", "reason")} | values
