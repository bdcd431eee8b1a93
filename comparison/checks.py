"""The judge: each check compares one thing, with a tolerance and the reason for it, and says agree, disagree or inconclusive."""

import enum
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from comparison.record import Run
from la_core import evidence, mechanism, sections
from la_core.case import LimitAnalysis
from la_core.contacts import plane_axes
from la_core.limit import Drive, Status
from la_core.scene import Scene

REACTION = 5e-3  # of the reaction: finite stiffness, settlement and speed of a YADE run, measured on cases with exact values
LEAST_REACTION = 1e-4  # of the weight: what a reaction of zero is judged by
BROAD = 0.05  # of the reaction: an uncertainty above this decides nothing
SETTLEMENT = 1e-3  # of the settlement asked for: the support is driven, so only round-off may separate the two
UNBALANCED = 0.02  # of the mean block weight: inertia and damping of a quasi-static run
NO_SLIDING = 1e-3  # share of the exchanged power: below this no loaded joint slides in the mechanism
SIMILAR = 0.95  # mass-weighted assurance of two mechanisms that are the same to the eye
SECTION = 1e-2  # of the weight: a sum of YADE's forces, of which each carries its own unbalanced part
ALONG = 1e-6  # of a unit vector: round-off in telling a direction from an axis
ADMISSIBLE = 0.02  # of the fastest block: joints' elastic strain while YADE's mechanism moves, which the flow rule does not know
SAME_MASS = 0.05  # share of the mass that may move in one method and not in the other


SLIDING = "Joints slide in the mechanism and real friction does not dilate"
BOUND_ONLY = ", so the associated answer is only a lower bound: YADE may lie above it, and nothing sharper is known here."


class Verdict(enum.StrEnum):
    """What a check, or a whole comparison, comes to."""

    AGREE = "agree"
    DISAGREE = "disagree"
    INCONCLUSIVE = "inconclusive"


@dataclass(frozen=True)
class Check:
    """One judgement. Numbers are None where they do not exist; `reason` is a sentence whenever the verdict is not agree."""

    name: str
    verdict: Verdict
    limit_analysis: float | None = None
    yade: float | None = None
    difference: float | None = None
    tolerance: float | None = None
    unit: str = ""
    reason: str = ""


def overall(checks: list[Check]) -> tuple[Verdict | None, str]:
    """The gravest verdict of all checks, with its reasons unless it is agree; None when nothing was judged."""
    for verdict in (Verdict.DISAGREE, Verdict.INCONCLUSIVE):
        reasons = [check.reason for check in checks if check.verdict is verdict]
        if reasons:
            return verdict, " ".join(dict.fromkeys(reasons))
    return (Verdict.AGREE, "") if checks else (None, "")


def _within(name: str, expected: float, found: float, tolerance: float, unit: str, reason: str) -> Check:
    """Compare two numbers; an undefined one makes the check inconclusive, never agree."""
    difference = found - expected
    if not (math.isfinite(difference) and math.isfinite(tolerance)):
        missing = f"{name}: a value does not exist."
        return Check(name, Verdict.INCONCLUSIVE, _number(expected), _number(found), None, tolerance, unit, missing)
    verdict = Verdict.AGREE if abs(difference) <= tolerance else Verdict.DISAGREE
    return Check(name, verdict, expected, found, difference, tolerance, unit, "" if verdict is Verdict.AGREE else reason)


def _inside(name: str, bounds: tuple[float, float], found: float, tolerance: float, unit: str, reason: str) -> Check:
    """Compare a number with a range: the check shows the nearer bound, and the range in its reason."""
    low, high = bounds
    if any(math.isnan(number) for number in (low, high, tolerance)) or not math.isfinite(found):
        return _within(name, math.nan, found, tolerance, unit, reason)
    inside = low - tolerance <= found <= high + tolerance
    nearer = low if found - low <= high - found else high
    span = f"Range: {low:.6g} to {high:.6g} {unit}." if math.isfinite(high) else f"Range: {low:.6g} {unit} and more."
    shown = span if inside else f"{reason} {span}"
    verdict = Verdict.AGREE if inside else Verdict.DISAGREE
    return Check(name, verdict, _number(nearer), found, _number(found - nearer), tolerance, unit, shown)


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None


def check_expected(scene: Scene, analysis: LimitAnalysis) -> Iterator[Check]:
    """The scene's own expected values against limit analysis for sharp arrises."""
    if scene.expected is None:
        return
    asked = (
        ("expected reaction", scene.expected.reaction_over_weight, Drive.YIELDING, scene.weight),
        ("expected greatest reaction", scene.expected.reaction_max_over_weight, Drive.PUSHING, scene.weight),
        ("expected multiplier", scene.expected.multiplier, Drive.LIVE, 1.0),
    )
    for name, expected, drive, unit in asked:
        if expected is not None and drive in analysis.sharp:
            found = analysis.sharp[drive].value / unit
            if analysis.sharp[drive].status is not Status.SOLVED:
                found = math.nan
            reason = f"Limit analysis gives {found:.6g} over the weight for sharp arrises, the scene expects {expected:.6g}."
            check = _within(name, found, expected, scene.expected.tolerance, "of W" if unit != 1.0 else "", reason)
            yield replace(check, yade=None)  # what was compared is the scene's own number, which the report names as such


def check_run(scene: Scene, analysis: LimitAnalysis, run: Run) -> list[Check]:
    """Everything YADE's run can say about limit analysis and limit analysis about YADE's run."""
    least = analysis.rounded[Drive.YIELDING]
    if run.status not in ("plateau", "no plateau", "collapsed"):
        return [Check("YADE's run", Verdict.INCONCLUSIVE, reason=f"YADE's run ended as {run.status}: {run.result['message']}")]
    if least.status is Status.INFEASIBLE or run.status == "collapsed":
        return [_check_standing(analysis, run)]
    if least.status is not Status.SOLVED:
        reason = f"Limit analysis ended as {least.status}, so there is nothing to judge by."
        return [Check("limit analysis", Verdict.INCONCLUSIVE, reason=reason)]
    checks = [_check_settlement(scene, run), _check_contacts(analysis, run), _check_equilibrium(analysis, run)]
    if run.status == "no plateau":
        reason = f"YADE's reaction had not settled when the run ended: {run.result['message']}"
        return [*checks, Check("plateau", Verdict.INCONCLUSIVE, reason=reason)]
    slides = mechanism.sliding_share(analysis.assembly, least.twists, least.forces) > NO_SLIDING or _slides_in_yade(analysis, run)
    checks += [_check_bounds(scene, analysis, run), _check_prediction(scene, analysis, run, slides)]
    return [*checks, *_check_mechanism(scene, analysis, run, slides), *_check_sections(scene, analysis, run)]


def _slides_in_yade(analysis: LimitAnalysis, run: Run) -> bool:
    """Whether joints slide in YADE's mechanism as limit analysis does not allow: faster than they part, without penetrating."""
    twists = run.mechanism()
    if np.isnan(twists).any():
        return False
    penetrates = evidence.penetration(analysis.assembly, twists) > ADMISSIBLE
    return not penetrates and evidence.flow_rule_violation(analysis.assembly, twists) > ADMISSIBLE


def _check_standing(analysis: LimitAnalysis, run: Run) -> Check:
    """One method, or both, say that the structure falls.

    A proof that no equilibrium exists binds every method. An equilibrium that exists need not be found: with friction that does
    not dilate the safe theorem fails, and blocks laid without thrust may slide although thrust could hold them.
    """
    least, name = analysis.rounded[Drive.YIELDING], "the structure stands"
    outcome = "it collapsed in YADE" if run.status == "collapsed" else f"YADE's run ended as {run.status}"
    if least.status is Status.INFEASIBLE:
        verdict = Verdict.AGREE if run.status == "collapsed" else Verdict.DISAGREE
        proof = f"Limit analysis proves that the structure cannot stand ({', '.join(least.falling[:5])} would fall)"
        return Check(name, verdict, reason="" if verdict is Verdict.AGREE else f"{proof}, but {outcome}.")
    if least.status is Status.SOLVED and not analysis.assembly.points.friction.any():
        return Check(name, Verdict.DISAGREE, reason=f"Without friction an equilibrium that exists holds, but {outcome}.")
    found = "Limit analysis finds an equilibrium" if least.status is Status.SOLVED else f"Limit analysis ends as {least.status}"
    reason = f"{found}, but {outcome} ({run.result['message']}): friction holds only the thrust that the blocks were laid with."
    return Check(name, Verdict.INCONCLUSIVE, reason=reason)


def _check_settlement(scene: Scene, run: Run) -> Check:
    asked, achieved = run.result["asked_settlement"], run.result["settlement"]
    return _within(
        "settlement achieved",
        asked,
        achieved,
        SETTLEMENT * abs(asked),
        "rad" if scene.is_rotation else "m",
        "The support did not move as it was asked to.",
    )


def _check_contacts(analysis: LimitAnalysis, run: Run) -> Check:
    names, extra = analysis.assembly.blocks.names, run.extra_contacts
    listed = len(analysis.assembly.points)
    if not len(extra):
        return Check("contact lists", Verdict.AGREE, float(listed), float(listed), 0.0, 0.0, "points")
    pairs = ", ".join(f"{names[a]} and {names[b]}" for a, b in extra[:3])
    reason = f"In YADE {len(extra)} contacts appeared that limit analysis does not know ({pairs})."
    return Check("contact lists", Verdict.DISAGREE, float(listed), float(listed + len(extra)), float(len(extra)), 0.0, "points", reason)


def _check_equilibrium(analysis: LimitAnalysis, run: Run) -> Check:
    forces = run.plateau_forces()
    residual = evidence.equilibrium_residual(analysis.assembly, forces)
    violation = evidence.cone_violation(analysis.assembly, forces)
    worst = max(residual, violation)
    reason = "YADE's mean state on the plateau is out of equilibrium or breaks the friction law, so its reaction is not a quasi-static one."
    rests = worst <= UNBALANCED
    verdict = Verdict.AGREE if rests else Verdict.INCONCLUSIVE
    name, unit = "equilibrium of the YADE state", "of the mean block weight"
    return Check(name, verdict, 0.0, worst, worst, UNBALANCED, unit, "" if rests else reason)


def reaction_tolerance(scene: Scene, analysis: LimitAnalysis, run: Run) -> float:
    """Tolerance (N or N m) of a reaction: a share of it, not less than a share of the weight, and YADE's own uncertainty (19 in 20)."""
    share = max(REACTION * abs(run.result["reaction"]), _least_reaction(scene, analysis))
    return share + float(run.result["uncertainty"])


def _least_reaction(scene: Scene, analysis: LimitAnalysis) -> float:
    """What a reaction of zero is judged by, N, or N m by the arm of a mean block."""
    return LEAST_REACTION * scene.weight * (analysis.assembly.length if scene.is_rotation else 1.0)


def _check_bounds(scene: Scene, analysis: LimitAnalysis, run: Run) -> Check:
    """Any quasi-static state on the same contact points is statically admissible, so its reaction lies between the bounds."""
    reaction, tolerance = run.result["reaction"], reaction_tolerance(scene, analysis, run)
    least, greatest = analysis.rounded[Drive.YIELDING].value, analysis.rounded[Drive.PUSHING]
    above = math.inf if greatest.status is Status.UNBOUNDED else greatest.value if greatest.status is Status.SOLVED else math.nan
    reason = "YADE's reaction lies outside what equilibrium and friction allow on these contact points: one of the two models is wrong."
    return _inside("reaction within bounds", (least, above), reaction, tolerance, scene.unit, reason)


def _check_prediction(scene: Scene, analysis: LimitAnalysis, run: Run, slides: bool) -> Check:
    least, reaction, tolerance = analysis.rounded[Drive.YIELDING].value, run.result["reaction"], reaction_tolerance(scene, analysis, run)
    name = "reaction against prediction"
    if slides:
        excluded = analysis.assembly.effects.friction == "none-slides"
        reason = ("Joints slide in YADE, which the scene excludes in limit analysis" if excluded else SLIDING) + BOUND_ONLY
        return Check(name, Verdict.INCONCLUSIVE, least, reaction, reaction - least, None, scene.unit, reason)
    if run.result["uncertainty"] > BROAD * max(abs(reaction), _least_reaction(scene, analysis)):
        reason = "YADE's own uncertainty is too large to judge the prediction."
        return Check(name, Verdict.INCONCLUSIVE, least, reaction, reaction - least, tolerance, scene.unit, reason)
    reason = "No joint slides, so limit analysis predicts the reaction, but YADE's differs by more than both uncertainties."
    return _within(name, least, reaction, tolerance, scene.unit, reason)


def _check_mechanism(scene: Scene, analysis: LimitAnalysis, run: Run, slides: bool) -> Iterator[Check]:
    assembly, least, found = analysis.assembly, analysis.rounded[Drive.YIELDING], run.mechanism()
    if np.isnan(found).any():
        reason = "YADE stored fewer than two states on the plateau, so its mechanism is not known."
        yield Check("mechanism similarity", Verdict.INCONCLUSIVE, reason=reason)
        return
    blocks = assembly.blocks
    alike = mechanism.similarity(blocks, least.twists, found)
    differ = mechanism.moving(blocks, least.twists) != mechanism.moving(blocks, found)
    mass = float(blocks.mass[differ].sum() / blocks.mass[blocks.free].sum())
    if slides:
        other, why = Verdict.INCONCLUSIVE, " The associated mechanism dilates where joints slide; real friction does not."
    elif _is_collapse_mechanism(scene, analysis, run, found):
        other, why = Verdict.AGREE, " YADE's is admissible and does the same work, so the collapse mechanism is not unique."
    else:
        other, why = Verdict.DISAGREE, ""
    same = alike >= SIMILAR
    reason = "" if same else f"The mechanisms differ (assurance {alike:.3f}).{why}"
    yield Check("mechanism similarity", Verdict.AGREE if same else other, 1.0, alike, alike - 1.0, 1.0 - SIMILAR, "", reason)
    same = mass <= SAME_MASS
    reason = "" if same else f"Blocks with {mass:.0%} of the mass move in one method only.{why}"
    shares = [mechanism.moving_mass_share(blocks, twists) for twists in (least.twists, found)]
    yield Check("moving blocks", Verdict.AGREE if same else other, shares[0], shares[1], mass, SAME_MASS, "of the mass", reason)


def _is_collapse_mechanism(scene: Scene, analysis: LimitAnalysis, run: Run, twists: np.ndarray) -> bool:
    """Whether twists (B, 6) for the support's unit motion solve limit analysis, too: they obey the flow rule and do its work."""
    work = float(np.sum(analysis.assembly.dead_load * twists))
    misses = abs(work - analysis.rounded[Drive.YIELDING].value)
    obeys = evidence.flow_rule_violation(analysis.assembly, twists) <= ADMISSIBLE
    return obeys and misses <= reaction_tolerance(scene, analysis, run)


def _check_sections(scene: Scene, analysis: LimitAnalysis, run: Run) -> Iterator[Check]:
    """Force sums: through horizontal cuts, which equilibrium fixes, and across the reaction, which it limits to a range."""
    assembly, forces = analysis.assembly, run.plateau_forces()
    expected = sections.level_sums(assembly, analysis.rounded[Drive.YIELDING].forces)
    difference = float(np.abs(sections.level_sums(assembly, forces) - expected).max())
    reason = "The force sums over horizontal cuts differ: the two methods do not carry the same weight."
    largest = float(np.linalg.norm(expected, axis=1).max())
    yield _within("force sums over sections", largest, largest + difference, SECTION * scene.weight, "N", reason)
    tolerance = reaction_tolerance(scene, analysis, run)
    slack = SECTION * scene.weight
    for label, direction in _transverse_directions(scene, assembly.effects.plane):
        low, high = sections.support_force_range(assembly, direction, evidence.reaction(assembly, forces), tolerance)
        found = float(sections.support_force(assembly, forces) @ direction)
        reason = f"The support's force along {label} lies outside what equilibrium and friction allow."
        yield _inside(f"support's force along {label}, in its range", (low, high), found, slack, "N", reason)


def _transverse_directions(scene: Scene, plane: bool) -> Iterator[tuple[str, np.ndarray]]:
    """Unit vectors across the reaction, with their names; all axes for a moment."""
    assert scene.support_twist is not None  # only a settlement has a YADE run
    motion = scene.support_twist[:3]
    across = np.eye(3) if scene.is_rotation else np.concatenate(plane_axes(motion[None, :]))
    for direction in across:
        if plane and abs(direction[1]) > ALONG:
            continue
        main = int(np.argmax(np.abs(direction)))
        unit = direction * np.sign(direction[main]) + 0.0  # no negative zero in a name
        on_axis = abs(unit[main] - 1.0) <= ALONG
        yield "xyz"[main] if on_axis else "({:.3g}, {:.3g}, {:.3g})".format(*unit), unit
