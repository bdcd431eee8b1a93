"""The next steps for a user after a check that did not agree, in sentences that several checks share."""

from dataclasses import replace

from comparison.verdict import HARDER, Check, Verdict
from la_core.analysis import LimitAnalysis
from la_core.exchange import TRAVEL_PERIODS
from la_core.limit import Status
from la_core.scene import Scene

CHECK_SOURCE = "Compare the scene with its source, and see for which friction law and inset the value of [expected] holds."
IN_NEWTONS = "The value of [expected] seems to be in {unit}: divide it by the weight, {weight:.6g} N."
PERCENT = "The value of [expected] seems to be in percent: write it as a share of one, 0.5 for 50 %."
ANGLE = "The value of [expected] seems to be an angle in degrees: the multiplier is its tangent."
SIGN = "The value of [expected] seems to have the wrong sign: the {quantity} is positive here."
MINUS = "The value of [expected] seems to have the wrong sign: the reaction is negative here, because the structure holds the support back."
OTHER_KEY = "The value of [expected] seems to be the {meaning}: give it as `{key}`."
SHARP_EDGES = (
    "The value of [expected] may hold for sharp edges, but the prediction is for the scene's inset, because joints slide: set `inset = 0` "
    "in [joint] to compare it."
)
MODEL_SLIDING = 'Set friction = "coulomb" in the scene\'s [effects] table for a prediction.'
FINER_PATHS = f"Let limit analysis follow finer paths: this is cheaper than a finer run of YADE. {HARDER}"
FINEST_PATHS = 'Limit analysis followed finer paths already (effort = "high"): `--accuracy 1%` follows still finer ones.'
SLOWER_RUN = f"Run YADE more slowly (set [yade] speed to half of the speed in the report) and on stiffer joints. {HARDER}"
BOTH_FINER = f"Repeat both methods with finer settings. {HARDER}"
TWO_LEVELS = f'If the curve rests there, turning blocks may have released a thrust: set [effects] rotation = "finite". If not: {BOTH_FINER}'
AFTER_RELEASE = 'Set [effects] rotation = "finite": both methods then answer for the motion after the release.'
BOUNDS = "Work with the bounds: they hold for every history of friction, the interval only for histories that end in its mechanism."
LEAST_FAVOURABLE = "Work with the least favourable plateau, or with the bounds: a small disturbance decides between them."
SMALLER_PART = "Model the part near the support alone: the least tolerance is a share of the weight of the free blocks."
MORE_TIME = "Allow more seconds with --time-limit, or model larger blocks."
REPAIR_YADE = "See `crosscheck doctor`, and yade.log in the scene's folder; then run the scene again."
COME_TO_REST = (
    "Give YADE more time to come to rest ([yade] gravity_time), or leave out keys of the scene's [yade] table that delay rest, such as "
    "gravity_ramp."
)
INTERRUPTED_RUN = "YADE's run was interrupted"  # begins the reason of such a run
GO_ON = "Run the scene again: limit analysis is stored, and YADE begins anew."
CHANGE_SETTING = (
    "Change this key of [yade] where it is set, in the scene or the campaign, or leave it out, so that it is derived; then run it again."
)
PLAIN_SCENE = "Look at the scene (`crosscheck show`): blocks of very different size or weight are hard for the solver. Try a smaller part."
OTHER_DIRECTION = (
    "Look at the direction of the settlement or of the live load, or at the axis of the tilt: no mechanism with dilatant friction follows "
    "this motion, so no bound exists. If the direction is right, the blocks lock as they dilate"
)
JAM = ", and without dilatancy they come to no certain plateau either: they may jam, or slide and fall for want of a thrust"
MODEL_STRAIN = 'Leave elasticity = "none" out of the scene\'s [effects] table for a prediction: without dilatancy the blocks may move.'
GIVE_THRUST = "Give the blocks a thrust ([yade] wedging), as the shipped scene flat_arch does."
OTHER_THRUST = (
    "The thrust of [yade] wedging does not hold the blocks. Change its size, or compare the friction with its source: with little "
    "friction no thrust may hold them once the support yields."
)
NO_THRUST = (
    "Look for a block that slides out and falls before the structure fails (`crosscheck show`), and hold it or leave it out. Where weights "
    "or dead loads move the blocks on after the live load has displaced them, the resistance keeps falling: work with the bound, if there "
    "is one; no load exceeds it."
)
LONGER = (
    "Let YADE go farther in proportion to the strain of the joints, and slower: `crosscheck run --try-harder` does this. Where a short "
    "joint forces a small inset, and with it a short travel, remove that joint from the drawing."
)

OWN_SETTINGS = "The scene's [yade] table sets {names}: leave {them} out first, so that YADE derives {them}. If that does not help:"
OF_THE_RUN = (SLOWER_RUN, MORE_TIME, GIVE_THRUST, LONGER)  # steps for a run that did not come to a steady state in balance
# Settings that the structure needs to stand, that do not change the motion, or whose effect the message itself gives.
NEEDED = ("wedging", "time_limit", "threads", "plateau_uncertainty", "stop_uncertainty")
# Settings that a second attempt adds to the scene, and the least values that are no coarser than derived ones.
OF_SECOND_ATTEMPT = {"damping_ratio": 1.0, "stiffening": 4.0, "travel_periods": TRAVEL_PERIODS}


def own_settings_first(check: Check, scene: Scene) -> Check:
    """Return an inconclusive check with the advice to leave out the scene's settings, if YADE may not have settled because of them.

    A scene of high effort, such as that of a second attempt, may have the fine settings of that attempt. These are not named.
    """
    names = [name for name in scene.yade if name not in NEEDED and not (scene.effort == "high" and _is_fine(name, scene))]
    if check.verdict is not Verdict.INCONCLUSIVE or check.next_step not in OF_THE_RUN or not names:
        return check
    lead = OWN_SETTINGS.format(names=", ".join(names), them="it" if len(names) == 1 else "them")
    return replace(check, next_step=f"{lead} {check.next_step}")


def _is_fine(name: str, scene: Scene) -> bool:
    """Return whether a setting of a scene is as fine as a setting of a second attempt."""
    return name in OF_SECOND_ATTEMPT and float(scene.yade[name]) >= OF_SECOND_ATTEMPT[name]


def for_fine_paths(step: str, scene: Scene) -> str:
    """Return a next step without the advice to follow finer paths, if the scene already has them."""
    return step.replace(FINER_PATHS, FINEST_PATHS) if scene.effort == "high" else step


def without_value(analysis: LimitAnalysis) -> str:
    """Return the next step after limit analysis without a value."""
    if analysis.bounds[analysis.main].status is not Status.UNBOUNDED:
        return PLAIN_SCENE
    if analysis.coulomb is not None and analysis.coulomb.iterations > 0:
        return f"{OTHER_DIRECTION}{JAM}."
    effects = analysis.scene.effects
    left_out = MODEL_SLIDING if effects.friction in ("associated", "none-slides") else MODEL_STRAIN if effects.elasticity == "none" else ""
    return f"{OTHER_DIRECTION}. {left_out}".rstrip()


def after_a_failure(message: str) -> str:
    """Return the next step after a run that YADE itself reported as failed."""
    return COME_TO_REST if message.startswith("not at rest") else REPAIR_YADE


def refuses_setting(reason: str) -> bool:
    """Whether this reason is a setting of the scene that does not suit the structure."""
    return "scene/settings: " in reason


def for_a_failed_run(reason: str) -> str:
    """Return the next step after YADE's process failed for this reason."""
    if reason.startswith(INTERRUPTED_RUN):
        return GO_ON
    return CHANGE_SETTING if refuses_setting(reason) else REPAIR_YADE


def for_a_thrust(scene: Scene) -> str:
    """Return the next step if blocks slide although a thrust could hold them."""
    if scene.live is not None:
        return NO_THRUST
    return OTHER_THRUST if scene.yade.get("wedging") else GIVE_THRUST
