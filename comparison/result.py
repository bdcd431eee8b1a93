"""Both methods on a scene from Python: run or read, look at the verdict, draw, report. What a program or a notebook works with."""

import base64
import html
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console

from comparison.figures import assembly_figure, rendered, save, scene_figures
from comparison.judge import SYMBOLS, VERDICT_HEADINGS, VERDICT_TITLE, Check, Verdict, verdict_cells
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.report import write_report
from comparison.run_folder import FIGURE_FORMATS, refuse_name
from comparison.workflow import report_again, run_scene
from comparison.yade import Results, Run, read_results
from la_core.analysis import Answer, decided_model, structural_model
from la_core.errors import SceneError, nearest
from la_core.geometry import Interfaces
from la_core.scene import Scene, load
from la_core.text_table import Tabled


@dataclass(frozen=True, eq=False)
class Picture:
    """A figure that a notebook shows. figure: matplotlib's, to change before it is saved."""

    figure: Any

    def save(self, path: Path | str) -> "Picture":
        """Write PNG, SVG or PDF, as the name ends; returns the picture, so that a notebook shows what was saved.

        Raises SceneError for another ending.
        """
        if Path(path).suffix not in FIGURE_FORMATS:
            raise SceneError(str(path), f"a figure's name ends in {', '.join(FIGURE_FORMATS[:-1])} or {FIGURE_FORMATS[-1]}")
        save(self.figure, Path(path))
        return self

    def _repr_png_(self) -> bytes:
        return rendered(self.figure, ".png")


@dataclass(frozen=True, eq=False, repr=False)
class Result(Tabled):
    """Both methods' results of a scene and the verdict on them, as they lie in `folder`; `print(result)` shows the row of `crosscheck run`.

    summary: what comparison.json holds. answer: limit analysis. yade: YADE's record, None where YADE gave none or was not asked.
    """

    folder: Path
    summary: dict[str, Any]
    answer: Answer
    yade: Run | None

    @property
    def scene(self) -> Scene:
        """The scene, as it was run."""
        return self.answer.scene

    @property
    def verdict(self) -> Verdict | None:
        """Agree, disagree or inconclusive; None where nothing was judged."""
        return Verdict(self.summary["verdict"]) if self.summary["verdict"] else None

    @property
    def reason(self) -> str:
        """Why, in sentences; empty where both methods agree."""
        return str(self.summary["reason"])

    @property
    def checks(self) -> tuple[Check, ...]:
        """Everything that was judged, each with numbers, tolerance and verdict."""
        return tuple(Check(**check | {"verdict": Verdict(check["verdict"])}) for check in self.summary["checks"])

    def plot(self, name: str = "mechanisms") -> Picture:
        """One of the figures of the report: assembly, mechanisms, reaction, dissipation."""
        return draw(self.answer, name, self.yade)

    def report(self, *others: "Result") -> Path:
        """Write report.html, .md and .json of this result, and of others in the same folder, beside their folders; returns the page."""
        if {other.folder.parent for other in others} - {self.folder.parent}:
            raise ValueError("results of one report lie in one folder; run them with the same `folder`")
        return write_report(self.folder.parent, [result.summary for result in (self, *others)], describe())

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        *cells, own_seconds, yade_seconds = verdict_cells(self.summary)
        mark = SYMBOLS[self.summary["verdict"]]
        return VERDICT_TITLE, VERDICT_HEADINGS, [[*cells, mark, own_seconds, yade_seconds]]

    def __repr__(self) -> str:
        return "\n".join([super().__repr__(), *([self.reason] if self.reason else [])])

    def _repr_html_(self) -> str:
        figure = self.folder / "mechanisms.png"
        shown = base64.b64encode(figure.read_bytes()).decode() if figure.is_file() else ""
        image = f'<img alt="mechanisms" style="max-width: 100%" src="data:image/png;base64,{shown}">' if shown else ""
        return f"{super()._repr_html_()}\n<p>{html.escape(self.reason)}</p>\n{image}"


def run(
    scene: Scene | Path | str,
    folder: Path | str = "crosscheck-results",
    yade: bool = True,
    time_limit: float | None = None,
    quiet: bool = False,
) -> Result:
    """Take a scene through both methods, as `crosscheck run` does; what is in the folder and did not change is not run again.

    scene: or its file, or a shipped scene's name. folder: of all results; the scene's own, by its name, is made in it. yade: False for
    limit analysis alone. time_limit: wall seconds for YADE. quiet: nothing on stderr. Raises SceneError for what a user must mend; that
    YADE is missing or fails is a verdict, `inconclusive`.

    >>> import comparison
    >>> comparison.run("two_pads", "results", yade=False, quiet=True).verdict
    <Verdict.AGREE: 'agree'>
    """
    if time_limit is not None and not 0.0 < time_limit < math.inf:
        raise SceneError("time_limit", "must be a positive number of seconds, or None", value=time_limit)
    chosen = scene if isinstance(scene, Scene) else load(scene)
    refuse_name(chosen)
    own = Path(folder) / chosen.name
    with _narration(quiet) as narration:
        model = structural_model(chosen)
        summary = run_scene(model, own, narration, yade, time_limit)
    return _result(own, summary, model.assembly.interfaces)


def read(folder: Path | str) -> Result:
    """The result that a scene's folder of results holds, judged and drawn again where the program has changed since.

    Raises la_core.exchange.ExchangeError where it holds none.
    """
    with _narration(True) as narration:
        summary = report_again(Path(folder), narration)
    return _result(Path(folder), summary)


def draw(what: Scene | Answer, name: str = "", run: Run | None = None) -> Picture:
    """A figure of a scene (its assembly), or of an answer: assembly, mechanisms, reaction, dissipation; raises SceneError for another.

    name: of the figure. run: YADE's, to be drawn beside the answer.
    """
    if isinstance(what, Scene):
        return Picture(assembly_figure(what, decided_model(what).assembly))
    drawings = scene_figures(Results(what.analysis, run))
    chosen = name or "mechanisms"
    if chosen not in drawings:
        raise SceneError(f'unknown figure "{chosen}"', "not among those of this answer", hint=nearest(chosen, drawings, "figures"))
    return Picture(drawings[chosen]())


def _narration(quiet: bool) -> Narration:
    return Narration(Console(stderr=True, quiet=quiet, highlight=False, emoji=False, soft_wrap=True))


def _result(folder: Path, summary: dict[str, Any], interfaces: Interfaces | None = None) -> Result:
    results = read_results(folder, interfaces)
    answer = Answer(results.scene, results.analysis)
    return Result(folder, summary, answer, results.run if summary["yade"] is not None else None)
