"""The page of the comparison with peers: machine and versions, conclusions, the tables, and the limits of each peer."""

import importlib.metadata
import math
from collections.abc import Sequence

from marked_text import listed, marked, sentences, span
from peers_command import REPEATS, Command, command_table, conclusion
from peers_dynamics import Run
from peers_table import EQUILIBRIUM, LEAST_ERROR, OURS, SOLVED, Row, limit_table, markdown, number, power, summary_table

from comparison.errors import YadeMissingError
from comparison.numbers import percent
from comparison.provenance import describe
from comparison.yade.installation import find_yade
from la_core.limit.problem import ACCEPTED

PACKAGES = ("ecos", "scs", "qoco", "piqp", "compas_cra", "compas_lmgc90")

AHEAD, LEVEL = 0.9, 1.1  # shares of our time: a peer below the first is ahead, a peer below the second is level

INTRODUCTION = """\
Our limit analysis and other solvers (the peers) solve the same problems in one run, and YADE and LMGC90 follow the same settlements.
*ratio* is a peer's time over ours: below 1 the peer is faster. An answer counts (`solved`) only if we recomputed and accepted its
residuals.
"""

LIMIT = f"""\
Every solver gets the same associated limit analysis, the least reaction: the rows, cones, offset and power of
`la_core.limit.DrivenProblem`, scaled. Residuals are recomputed from forces and velocities in the same way for all (balance of
each block, friction cones, flow rule, duality gap; relative to the mean block). *residual* is the largest of them. `solved` means that it
is at most {ACCEPTED:.0e}, and `inaccurate` that it is larger, whatever the solver reports. A solver with a tolerance starts with 1e-5, and
the tolerance is divided by ten until its answer is `solved`; only the time of this last setting counts. *error* is the relative error of
R/W against the certified answer with the least residual, at least {LEAST_ERROR:.0e}.

*CPU s*: processor time of the solver's own work with its set-up, as the median of up to nine repeats. *range* is the range of these
repeats, and a first solve is not counted. *clock s* also includes other work on the machine. *ratio*: the time over that of our own solve,
as a median. Our solve follows every repeat in the same process, and our own row shows the noise. Only one process with one thread runs at a
time, for at most {{limit:g}} s of processor time a solve: `>` marks a solve that this limit stopped.

{{summary}}

{{table}}

- **HiGHS** (through scipy) has no cones. In the plane two lines form the exact cone. In space inscribed pyramids replace the cones; the
  setting gives their number of facets. The flow rule of a pyramid differs from that of the cone by about 2e-2 with 8 facets and 1e-3 with
  32. The 1e-6 of the other solvers would need about a thousand facets, except where all sliding joints slide towards a corner of the
  pyramid. Walls of more than 500 blocks run with 8 facets only.
- **ECOS, SCS, QOCO** solve the same form of the problem as clarabel.
- **PIQP** solves linear and quadratic programmes only, so it runs in the plane and not in space.
- **compas_cra** has no settlement and minimises no reaction. It finds any equilibrium of the structure with all supports
  at rest, on the same contact points (RBE: convex, with octagons about the friction cones and a penalty on tension; CRA: coupled with a
  virtual displacement, not convex). It has its own tolerances: the penalty leaves about 1e-6 of tension, and the octagons up to 8 % of
  excess friction, whatever the tolerance of IPOPT. Its residual covers balance and cones, but no flow rule. We compare its time with our
  time for the least reaction, whose forces are an equilibrium, too. Only the time of IPOPT counts, not that of its matrices in Python.

Peers are faster on small problems in the plane for two reasons. First, the set-up of clarabel takes a quarter to a half of our time (on the
arch we take 0.21 ms in all, and PIQP 0.17 ms). Second, we solve small structures to residuals about a hundred times smaller than those
required of the peers, so that an answer in a report needs no error bar. This takes one more iteration for every eight. On 1,000 blocks PIQP
takes more iterations than clarabel, 48 against 42, but about a fifth less time for each.
"""

DYNAMICS = """\
## YADE and LMGC90: a settlement followed in time

Both programs have the same blocks, friction and direction of the support's motion. In LMGC90 the support moves by a third of a millimetre;
YADE stops once its reaction is steady. *predicted* is our Coulomb prediction on the same contact points: with the inset for YADE and limit
analysis, sharp for LMGC90. *scatter* is the scatter of the reaction about the fitted line. Seconds are those of one whole run, from the
scene to the reaction; *ratio* divides them by the seconds of limit analysis on the same points.

{table}

- **LMGC90** (through `compas_lmgc90`) accepts imposed velocities and gives contact forces, so the reaction is measured as in YADE. It
  finds its own contact points, four at the sharp corners of each interface; there is no inset and no plane model. The tolerance
  of its contact solver is fixed in the compiled program (1.666e-4), it has no criterion for stopping, and one process holds one simulation.
- **YADE** stops when the reaction is steady and states its own uncertainty; its time includes its start (about a second).
"""


WHOLE = f"""\
## A whole command

`crosscheck solve FILE --bounds` reads the file of a wall whose right third settles, finds its joints, computes the least and the greatest
reaction with and without inset, checks all four and prints them. The same command runs with HiGHS in place of our solver; in the plane both
solve exactly the same problem, because the friction cone is two lines. *blocks* is the approximate number of blocks. *CPU s* is the
processor time of the whole process, from the start of Python, as the median of {REPEATS} runs in turn. {{versions}}

{{table}}
"""


def page(
    command: str, limit: float, rows: Sequence[Row], runs: Sequence[Run], versions: str, whole: Sequence[Command] = (), made_by: str = ""
) -> str:
    """Return the page as Markdown. limit: seconds for one solve; versions, made_by: versions that made the rows and the commands."""
    parts = ["# Other solvers (peers), compared in one run\n", INTRODUCTION, f"```console\n$ {command}\n```\n", f"{versions}\n"]
    parts.append(marked("conclusions", conclusions(rows, runs, whole)) + "\n")
    if rows:
        parts.append(LIMIT.format(limit=limit, summary=summary_table(rows), table=limit_table(rows)))
    if whole:
        parts.append(WHOLE.format(table=command_table(whole), versions=made_by))
    if runs:
        parts.append(DYNAMICS.format(table=dynamics_table(runs)))
    return "\n".join(parts)


def conclusions(rows: Sequence[Row], runs: Sequence[Run], whole: Sequence[Command] = ()) -> str:
    """Return the conclusions from the rows, as a list."""
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
    lines.append(conclusion(whole))
    for name, posed in (("SCS", "SCS"), ("compas_cra", "compas_cra, which finds any equilibrium and not the least reaction,")):
        ratios = [row.ratio for row in timed if row.solver.startswith(name)]
        lines.append(f"{posed} takes {span(ratios)} times as long as we do where its answer is certified." if ratios else "")
    lines.append(_closest(timed))
    lines += [_certified(timed, scene) for scene in scenes]
    return sentences([*lines, *_settlements(runs)])


def _best(timed: Sequence[Row], scene: str, solver: str) -> float | None:
    """Return the least ratio of a solver's settings on a scene; None where it certifies no answer."""
    return min((row.ratio for row in timed if row.scene == scene and row.solver.startswith(solver)), default=None)


def _closest(timed: Sequence[Row]) -> str:
    """State the peers that are faster than we are, and the peers that are about as fast."""
    ahead, level = ([f"{row.solver} on {row.scene} ({number(row.ratio)})" for row in timed if low <= row.ratio < high]
                    for low, high in ((0.0, AHEAD), (AHEAD, LEVEL)))  # fmt: skip
    words = f"We are not ahead everywhere. Faster than we are: {listed(ahead)}." if ahead else "No peer is faster than we are."
    return words + (f" About as fast: {listed(level)}." if level else "")


def _certified(timed: Sequence[Row], scene: str) -> str:
    """State name and time of the peer where a single peer certifies the least reaction; else return an empty text."""
    found = [row for row in timed if row.scene == scene and row.posed != EQUILIBRIUM]
    if len({row.solver for row in found}) != 1:
        return ""
    return f"On {scene} only {found[0].solver} certifies an answer besides us; it takes {span([row.ratio for row in found])} times as long."


def _settlements(runs: Sequence[Run]) -> list[str]:
    """State the seconds of LMGC90 and YADE, and the difference of LMGC90's reaction from the prediction."""
    lines = []
    for scene in dict.fromkeys(run.scene for run in runs):
        peers, yade = ([run for run in runs if (run.scene, run.method) == (scene, method)] for method in ("LMGC90", "YADE"))
        found = [run for run in peers if math.isfinite(run.reaction)]
        if found and yade:
            off = max(abs(run.reaction / run.predicted - 1.0) for run in found)
            lines.append(
                f"On {scene} LMGC90 takes {span([run.processor for run in found])} s where YADE takes "
                f"{span([run.processor for run in yade])} s; LMGC90's reaction differs from the prediction by up to {percent(off)}, "
                "depending on its time step."
            )
    return lines


def dynamics_table(runs: Sequence[Run]) -> str:
    """Return the table of the runs in time as Markdown, in their order."""
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


def versions(peers: Sequence[str] = PACKAGES) -> str:
    """Return machine and versions in a paragraph, with YADE's where there are peers beside HiGHS."""
    known = describe()
    found = {name: _version(name) for name in peers}
    try:
        found |= {"YADE": find_yade().version} if peers else {}
    except YadeMissingError:
        found["YADE"] = "not installed"
    shown = {name: known[name] for name in ("python", "clarabel", "scipy", "numpy")} | found
    return f"{known['machine']}; " + ", ".join(f"{name} {version}" for name, version in shown.items()) + "."


def _version(package: str) -> str:
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        return "not installed"
