"""Runs every hard case through limit analysis, YADE and the judge, and writes the outcomes as a table.

    python tests/benchmarks/hard_cases_table.py [--quick] [-o comparison/gallery/hard_cases.md] [NAME ...]

--quick leaves out YADE's long runs. A refusal or `inconclusive` is a correct answer; a wrong value is an error.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import math
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import scenes
from hard_cases import FALLS, REFUSED, HardCase, catalogue
from independent_mechanics import OtherSolvers, ask_other_solvers, drives
from rich.console import Console

from comparison import figures
from comparison.numbers import with_uncertainty
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.workflow import one_scene
from la_core.analysis.result import EVIDENCE
from la_core.errors import SceneError
from la_core.model.assembly import assemble
from la_core.text_table import number_text, over_weight

LONGEST = 120.0  # s of wall time for YADE
TOLERANCE = 2e-3  # share of the reaction, or of 1 % of the weight where this is larger; for elastic joints and rounded edges
INTRODUCTION = """\
This page has structures that are hard for every program, run through limit analysis, YADE and the checks: unusual units, densities and
friction, blocks of very different size, joints at the tolerance of geometry, towers, arches at the limit of stability, rubble. A refusal or
*inconclusive* is a correct answer. A value that differs from the *known* one, or from that of the *other solvers*, would be an error.
The columns *known*, *limit analysis*, *residual* and *other solvers* are for sharp edges; *R_min*, *R*, *YADE* and the verdict are for the
inset of 1 mm, which makes every structure thinner: the arch of 1.001 the least thickness stands with sharp edges, but falls with the inset.
"""
HEAD = (
    "case",
    "what is hard",
    "known",
    "limit analysis",
    "R_min/W",
    "R/W",
    "residual",
    "other solvers",
    "YADE",
    "R/W",
    "verdict",
    "reason",
)


@dataclass(frozen=True)
class Outcome:
    """Outcome of a case: the content of comparison.json, or the reason why the scene was refused."""

    case: HardCase
    summary: dict[str, Any] | None
    refusal: str = ""
    others: tuple[OtherSolvers, ...] = ()

    @property
    def sharp(self) -> float:
        """Least reaction over the weight without dilatancy, for sharp edges where no joint slides; NaN where the outcome has no value."""
        assert self.summary is not None
        analysis = self.summary["limit_analysis"]
        answer = analysis["coulomb"] or analysis["associated"]
        value = answer["reaction"] if answer["reaction_sharp"] is None else answer["reaction_sharp"]
        return math.nan if value is None else float(value / self.summary["weight"])

    @property
    def is_right(self) -> bool:
        """True if limit analysis gives the known answer, or if no answer is known."""
        if self.case.known == REFUSED or self.summary is None:
            return self.case.known == REFUSED and self.summary is None
        if self.case.known == FALLS:
            return bool(self.summary["limit_analysis"]["associated"]["status"] == "infeasible")
        return not isinstance(self.case.known, float) or abs(self.sharp - self.case.known) <= TOLERANCE * max(self.case.known, 0.01)


def outcome(case: HardCase, folder: Path, narration: Narration, with_yade: bool = True) -> Outcome:
    """Run a case through the workflow."""
    try:
        scene = scenes.load(case.text, name="case")
        assembly = assemble(scene)
        others = tuple(ask_other_solvers(assembly, drive) for drive in drives(assembly))
        return Outcome(case, one_scene.run_scene(scene, folder, narration, with_yade and case.yade, time_limit=LONGEST), others=others)
    except SceneError as error:
        words = str(error).split("/case.toml: ", 1)[-1]
        return Outcome(case, None, words)


def row(found: Outcome) -> list[str]:
    """Return the cells of a case."""
    case, summary = found.case, found.summary
    known = case.known if isinstance(case.known, str) else number_text(case.known, 5)
    if summary is None:
        return [case.name, case.what_is_hard, known, "refused", *["–"] * 7, found.refusal.split(";")[0]]
    answer, coulomb, weight = summary["limit_analysis"]["associated"], summary["limit_analysis"]["coulomb"], summary["weight"]
    shared = answer.get("shared_inset", answer)
    predicted = (coulomb or {}).get("shared_inset", coulomb or {}).get("reaction")
    residual = max((answer[name] for name in EVIDENCE if answer[name] is not None), default=None)
    values = [
        number_text(over_weight(shared["reaction"], weight), 5),
        number_text(over_weight(predicted, weight), 5),
        number_text(residual, 1),
    ]
    yade = summary["yade"] or {}
    reaction, uncertainty = (over_weight(yade.get(name), weight) for name in ("reaction", "uncertainty"))
    status = answer["status"] if answer["status"] != "solved" or coulomb is None else coulomb["status"]
    ran = yade.get("status", "not run")
    values.append(solvers_in_words(found.others))
    return [case.name, case.what_is_hard, known, status, *values, ran, with_uncertainty(reaction, uncertainty), summary["verdict"] or "–",
            summary["reason"].split(". ")[0]]  # fmt: skip


def solvers_in_words(others: tuple[OtherSolvers, ...]) -> str:
    """State whether the static form and HiGHS give the same least and greatest reaction, and their largest difference over the weight."""
    verdict = "agree" if all(other.agree for other in others) else "DISAGREE"
    off = max((other.beyond for other in others if not math.isnan(other.beyond)), default=None)
    return verdict if off is None else f"{verdict}, {number_text(off, 1)}"


def page(outcomes: list[Outcome], quick: bool = False) -> str:
    """Return the table with the command and the machine that made it, as Markdown."""
    facts = ", ".join(f"{key} {value}" for key, value in describe().items() if key != "crosscheck")
    command = f"python tests/benchmarks/hard_cases_table.py {'--quick ' if quick else ''}-o comparison/gallery/hard_cases.md"
    lines = ["# Hard cases", "", INTRODUCTION, f"`{command}`{': long runs of YADE are left out' if quick else ''}", "", facts, ""]
    right = sum(one.is_right for one in outcomes)
    lines += [
        f"{right} of {len(outcomes)} limit analyses give the known answer, or have no known answer and are judged by mechanical laws only.",
        "",
    ]
    lines += [
        "The *other solvers* are the static form as a programme of its own, and HiGHS with pyramids in place of cones. "
        "The number is the largest difference of both bounds over W.",
        "",
    ]
    lines += [f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD)]
    lines += ["| " + " | ".join(cell.replace("|", "\\|") for cell in row(one)) + " |" for one in outcomes]
    return "\n".join(lines) + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="parts of names")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    figures.report_figures = lambda *results: {}  # type: ignore[assignment]  # nobody looks at eighty of them
    cases = [case for case in catalogue() if not options.names or any(name in case.name for name in options.names)]
    with tempfile.TemporaryDirectory() as folder, Narration(Console(stderr=True)) as narration:
        outcomes = [outcome(case, Path(folder) / str(k), narration, not (options.quick and case.long)) for k, case in enumerate(cases)]
    text = page(outcomes, options.quick)
    print(text)
    if options.output:
        options.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
