"""The page of the comparison with peers: what was run on what, both tables, and what each peer cannot do."""

import importlib.metadata
import math
from collections.abc import Sequence

from marked_text import listed, marked, sentences, span
from peers_dynamics import Run
from peers_table import EQUILIBRIUM, LEAST_ERROR, OURS, SOLVED, Row, limit_table, markdown, number, power, summary_table

from comparison.judge.requested_accuracy import percent
from comparison.provenance import describe
from comparison.yade.process import YadeMissingError, find_yade
from la_core.limit.problem import ACCEPTED

PACKAGES = ("ecos", "scs", "qoco", "piqp", "compas_cra", "compas_lmgc90")

AHEAD, LEVEL = 0.9, 1.1  # of our time: below the first a peer is ahead, up to the second it is level

INTRODUCTION = """\
Our limit analysis and other solvers take the same problems side by side, and YADE and LMGC90 follow the same settlements. *ratio* is a
peer's time over ours: below 1 the peer is faster; only answers whose residuals we recomputed and accept count (`solved`).
"""

LIMIT = f"""\
Every solver gets the same associated limit analysis, the least reaction: the rows, cones, offset and power of
`la_core.limit.DrivenProblem`, scaled. Residuals are recomputed from forces and velocities in the same way for all (balance of
each block, friction cones, flow rule, duality gap; relative to the mean block): *residual* is the largest, `solved` says that it
is at most {ACCEPTED:.0e}, `inaccurate` that it is not, whatever the solver says. A solver with a tolerance is asked for 1e-5, then
for ten times less until its answer is `solved`; timed is that setting alone. *error*: of R/W, relative to the certified answer
with the least residual, {LEAST_ERROR:.0e} at least.

*CPU s*: seconds of the processor for the solver's own work, its set-up included, median over up to nine repeats, with their
*range*; the first solve warms up. *clock s* counts other work on the machine, too. *ratio*: seconds over those of our own solve,
which follows every repeat in the same process, median; our own row shows the noise. One process at a time with one thread, and at
most {{limit:g}} s of the processor for a solve: `>` stands before what that leaves open.

{{summary}}

{{table}}

- **HiGHS** (through scipy) has no cones. In the plane two lines are the cone. In space pyramids are inscribed, with as many
  facets as the setting says, and their flow rule differs from the true one by some 2e-2 with 8 facets and 1e-3 with 32: the 1e-6 of
  the others would take about a thousand, but for answers in which every joint that slides does so towards a corner.
  Walls of more than 500 blocks get 8 facets alone.
- **ECOS, SCS, QOCO** pose the problem as clarabel does.
- **PIQP** has linear and quadratic programmes only: the plane, not space.
- **compas_cra** has no settlement and minimises no reaction. Posed is any equilibrium of the structure with all its supports at
  rest, on the same contact points (RBE: convex, octagons about the friction cones and tension at a penalty; CRA: coupled with a
  virtual displacement, not convex). Its tolerances are its own: the penalty leaves some 1e-6 of tension, octagons up to 8 % of
  excess friction, whatever IPOPT is asked for. Its residual is that of an equilibrium: balance and cones. Our time beside it is that of
  the least reaction, whose forces are such an equilibrium. Timed is IPOPT alone, not the building of its matrices in Python.

Why peers are ahead of us on small problems in the plane: there clarabel's set-up is a quarter to a half of our time (on the arch 0.46 ms
against 0.26 ms of all of PIQP's), and we solve small structures to residuals some hundred times smaller than the peers are asked for,
one iteration more in eight, so that an answer in a report needs no error bar. On 1,000 blocks PIQP takes more iterations than clarabel,
48 against 42, and a sixth less time for each.
"""

DYNAMICS = """\
## YADE and LMGC90: a settlement followed in time

The same blocks, friction and direction of the support's motion, to a third of a millimetre. *predicted*: our Coulomb prediction
on the same contact points, drawn in by the inset in YADE and limit analysis, sharp in LMGC90. *scatter*: of the reaction about
the fitted line. Seconds are of one whole run, from the scene to the reaction; *ratio*: over those of limit analysis on the same points.

{table}

- **LMGC90** (through `compas_lmgc90`) takes imposed velocities and gives contact forces, so the reaction is read as in YADE. It
  finds its own contact points, four at the sharp corners of each interface; there is no inset and no plane model. The tolerance
  of its contact solver is compiled in (1.666e-4), it has no criterion by which to stop, and one process holds one simulation.
- **YADE** stops by itself when the reaction is steady and states its own uncertainty; its time includes its start (about a second).
"""


def page(command: str, limit: float, rows: Sequence[Row], runs: Sequence[Run], versions: str) -> str:
    """The whole page as Markdown. limit: seconds for one solve; versions: machine and packages that made the rows, in a line."""
    parts = ["# Peers, side by side in one run\n", INTRODUCTION, f"```console\n$ {command}\n```\n", f"{versions}\n"]
    parts.append(marked("conclusions", conclusions(rows, runs)) + "\n")
    if rows:
        parts.append(LIMIT.format(limit=limit, summary=summary_table(rows), table=limit_table(rows)))
    if runs:
        parts.append(DYNAMICS.format(table=dynamics_table(runs)))
    return "\n".join(parts)


def conclusions(rows: Sequence[Row], runs: Sequence[Run]) -> str:
    """What follows from the rows, as a list."""
    scenes = list(dict.fromkeys(row.scene for row in rows))
    timed = [row for row in rows if row.status == SOLVED and row.solver != OURS and math.isfinite(row.ratio)]
    highs = {scene: _best(timed, scene, "HiGHS") for scene in scenes}
    fastest = {scene: ratio for scene, ratio in highs.items() if ratio is not None}
    lines = [
        f"HiGHS, by the better one of its two algorithms, takes {span(list(fastest.values()))} times as long as we do on the "
        f"{len(fastest)} of {len(scenes)} structures where it certifies an answer."
        if fastest
        else ""
    ]
    for name, posed in (("SCS", "SCS"), ("compas_cra", "compas_cra, which seeks any equilibrium and not the least reaction,")):
        ratios = [row.ratio for row in timed if row.solver.startswith(name)]
        lines.append(f"{posed} takes {span(ratios)} times as long as we do where its answer is certified." if ratios else "")
    lines.append(_closest(timed))
    lines += [_certified(timed, scene) for scene in scenes]
    return sentences([*lines, *_settlements(runs)])


def _best(timed: Sequence[Row], scene: str, solver: str) -> float | None:
    """The least ratio of a solver's settings on a scene; None where it certifies no answer."""
    return min((row.ratio for row in timed if row.scene == scene and row.solver.startswith(solver)), default=None)


def _closest(timed: Sequence[Row]) -> str:
    """Who is ahead of us, and who is level."""
    ahead, level = ([f"{row.solver} on {row.scene} ({number(row.ratio)})" for row in timed if low <= row.ratio < high]
                    for low, high in ((0.0, AHEAD), (AHEAD, LEVEL)))  # fmt: skip
    words = f"We are not ahead everywhere. Faster than we are: {listed(ahead)}." if ahead else "No peer is faster than we are."
    return words + (f" About level: {listed(level)}." if level else "")


def _certified(timed: Sequence[Row], scene: str) -> str:
    """Where a single peer certifies the least reaction, its name and time."""
    found = [row for row in timed if row.scene == scene and row.posed != EQUILIBRIUM]
    if len({row.solver for row in found}) != 1:
        return ""
    return f"On {scene} only {found[0].solver} certifies an answer besides us; it takes {span([row.ratio for row in found])} times as long."


def _settlements(runs: Sequence[Run]) -> list[str]:
    """What LMGC90 takes beside YADE, and by how much it differs from the prediction."""
    lines = []
    for scene in dict.fromkeys(run.scene for run in runs):
        peers, yade = ([run for run in runs if (run.scene, run.method) == (scene, method)] for method in ("LMGC90", "YADE"))
        found = [run for run in peers if math.isfinite(run.reaction)]
        if found and yade:
            off = max(abs(run.reaction / run.predicted - 1.0) for run in found)
            lines.append(
                f"On {scene} LMGC90 takes {span([run.processor for run in found])} s where YADE takes "
                f"{span([run.processor for run in yade])} s; its reaction differs from the prediction by up to {percent(off)}, depending "
                "on its time step."
            )
    return lines


def dynamics_table(runs: Sequence[Run]) -> str:
    """Markdown of the runs in time, in their order."""
    own = {(run.scene, run.setting): run.processor for run in runs if run.method == "limit analysis"}
    heads = (
        "scene", "method", "setting", "status", "R/W", "predicted", "difference", "scatter", "asked mm", "achieved mm", "steps",
        "CPU s", "clock s", "ratio", "note",
    )  # fmt: skip
    lines = []
    for run in runs:
        points = {"limit analysis": run.setting, "YADE": "inset", "LMGC90": "sharp"}[run.method]
        difference = (run.reaction - run.predicted) / run.predicted
        lines.append(
            (
                run.scene, run.method, run.setting, run.status, _fixed(run.reaction, 5), _fixed(run.predicted, 5),
                f"{100.0 * difference:+.2f} %" if math.isfinite(difference) else "–", power(run.scatter), _fixed(1e3 * run.asked, 3),
                _fixed(1e3 * run.achieved, 3), f"{run.steps}" if run.steps else "–", number(run.processor), number(run.clock),
                number(run.processor / own.get((run.scene, points), math.nan)), run.note,
            )
        )  # fmt: skip
    return markdown(heads, lines)


def _fixed(value: float, places: int) -> str:
    return f"{value:.{places}f}" if math.isfinite(value) else "–"


def versions() -> str:
    """Machine and versions in a paragraph."""
    known = describe()
    found = {name: _version(name) for name in PACKAGES}
    try:
        found["YADE"] = find_yade().version
    except YadeMissingError:
        found["YADE"] = "not installed"
    shown = {name: known[name] for name in ("python", "clarabel", "scipy", "numpy")} | found
    return f"{known['machine']}; " + ", ".join(f"{name} {version}" for name, version in shown.items()) + "."


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
