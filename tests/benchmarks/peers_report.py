"""The page of the comparison with peers: what was run on what, both tables, and what each peer cannot do."""

import importlib.metadata
import math
from collections.abc import Sequence

from peers_dynamics import Run
from peers_table import LEAST_ERROR, Row, limit_table, markdown, number, power, summary_table

from comparison.provenance import describe
from comparison.yade.process import YadeMissingError, find_yade
from la_core.limit.problem import ACCEPTED

PACKAGES = ("ecos", "scs", "qoco", "piqp", "compas_cra", "compas_lmgc90")

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

Where a peer is ahead of us, it is so in the plane and by less than a factor of two. On problems that take a few milliseconds
clarabel's set-up is a quarter to a half of our time (on the arch 0.46 ms against PIQP's 0.26), and small structures are solved to some
hundred times less residual than the peers are asked for, one iteration more in eight: an answer in a report should need no error
bar. On 1,000 blocks PIQP takes more iterations than clarabel, 48 against 42, and a sixth less time for each. In space clarabel is
ahead of, or level with, all that certify their answer.
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


def page(command: str, limit: float, rows: Sequence[Row], runs: Sequence[Run]) -> str:
    """The whole page as Markdown."""
    parts = [f"# Peers, side by side in one run\n\n```console\n$ {command}\n```\n", f"{_versions()}\n"]
    if rows:
        parts.append(LIMIT.format(limit=limit, summary=summary_table(rows), table=limit_table(rows)))
    if runs:
        parts.append(DYNAMICS.format(table=dynamics_table(runs)))
    return "\n".join(parts)


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


def _versions() -> str:
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
