"""Both methods from Python: run a scene or read stored results, look at the verdict, draw and report."""

import copy
import html
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from comparison import workflow
from comparison.figures import Story, write_animation
from comparison.picture import Picture, draw
from comparison.progress import narration
from comparison.provenance import describe
from comparison.report import export_results, image_address, predicted_value, write_report
from comparison.run_folder import MOST_FRAMES, folder_of_results, refuse_name
from comparison.settings import HARDER_SECONDS
from comparison.verdict import VERDICT_HEADINGS, Check, Checks, Verdict, stored_check, verdict_cells, verdict_title
from comparison.yade import Results, Run, read_results
from la_core.analysis import Answer, structural_model
from la_core.errors import SceneError, path_of, seconds_or_none, true_or_false, whole_number
from la_core.geometry import Interfaces
from la_core.scene import Scene, load
from la_core.text_table import Tabled


@dataclass(frozen=True, eq=False, repr=False)
class Result(Tabled):
    """Results of both methods for one scene, and their verdict.

    `print(result)` shows the verdict table of `crosscheck run`; a notebook shows it with the figure of the mechanisms.

    Attributes
    ----------
    folder : Path
        Folder of the scene's results, as an absolute path.
    answer : Answer
        Results of limit analysis.
    yade : Run or None
        YADE's record. None where YADE did not run or recorded nothing.
    """

    folder: Path
    _summary: dict[str, Any]
    answer: Answer
    yade: Run | None

    @property
    def summary(self) -> dict[str, Any]:
        """Content of comparison.json, as a copy."""
        return copy.deepcopy(self._summary)

    @property
    def scene(self) -> Scene:
        """Scene that was run."""
        return self.answer.scene

    @property
    def verdict(self) -> Verdict | None:
        """Verdict on the whole comparison; None without any check."""
        return Verdict(self._summary["verdict"]) if self._summary["verdict"] else None

    @property
    def reason(self) -> str:
        """Reason of the verdict in sentences; "" where both methods agree."""
        return str(self._summary["reason"])

    @property
    def next_step(self) -> str:
        """Next step in sentences with shell commands; "" where both methods agree, or where nothing was compared."""
        return str(self._summary.get("next_step") or "")

    @property
    def checks(self) -> tuple[Check, ...]:
        """All checks of the comparison, each with its numbers, tolerance and verdict; they show themselves as a table."""
        return Checks(map(stored_check, self._summary["checks"]))

    @property
    def predicted(self) -> float:
        """Value of limit analysis that YADE is compared with (N, N m, multiplier), at the inset of both methods; NaN without one."""
        return predicted_value(self._summary)

    def plot(self, name: str = "mechanisms") -> Picture:
        """Draw one figure of the report.

        Parameters
        ----------
        name : str
            Name of the figure: "assembly", "mechanisms", "reaction", "forces" or "dissipation".

        Returns
        -------
        Picture
            The figure.

        Raises
        ------
        SceneError
            No figure has this name.
        """
        return draw(self.answer, name, self.yade)

    def report(self, *others: "Result") -> Path:
        """Write report.html, report.md and report.json about this result and others, beside their folders.

        Parameters
        ----------
        *others : Result
            Further results for the same report; their folders must lie in the same folder.

        Returns
        -------
        Path
            Path of report.html.

        Raises
        ------
        ValueError
            The results lie in different folders.
        SceneError
            An argument is no result.
        """
        if strange := [type(other).__name__ for other in others if not isinstance(other, Result)]:
            raise SceneError("others", "must be results of comparison.run", value=strange[0])
        if {other.folder.parent for other in others} - {self.folder.parent}:
            raise ValueError("all results of a report must lie in one folder; run them with the same `folder`")
        return write_report(self.folder.parent, [result.summary for result in (self, *others)], describe())

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        return verdict_title({self._summary["unit"]}), VERDICT_HEADINGS, [verdict_cells(self._summary)]

    def __repr__(self) -> str:
        return "\n".join(line for line in (super().__repr__(), self.reason, self.next_step) if line)

    def _repr_html_(self) -> str:
        drawn = image_address(self.plot()._repr_png_())  # a later run in this folder may have replaced the stored figure
        image = f'<img alt="mechanisms" style="max-width: 100%" src="{drawn}">'
        return f"{super()._repr_html_()}\n<p>{html.escape(f'{self.reason} {self.next_step}'.strip())}</p>\n{image}"


def run(
    scene: Scene | Path | str,
    folder: Path | str = "crosscheck-results",
    yade: bool = True,
    time_limit: float | None = None,
    quiet: bool = False,
    try_harder: bool = False,
    try_harder_limit: float | None = None,
) -> Result:
    """Run both methods on a scene and compare them, as `crosscheck run` does.

    Stored results whose inputs did not change are read and not computed again. A missing or failed YADE is no error: the verdict is then
    `Verdict.INCONCLUSIVE` with a reason, unless limit analysis misses an expected value or proves that the structure cannot stand.

    Parameters
    ----------
    scene : Scene, Path or str
        Scene, path of a scene file, or name of a shipped scene.
    folder : Path or str
        Folder for all results; the scene gets a folder of its own name in it.
    yade : bool
        Whether to run YADE; False runs limit analysis alone.
    time_limit : float or None
        Longest wall time of YADE, s. None takes the scene's setting, or 3600 s. A second attempt has `try_harder_limit` instead.
    quiet : bool
        Whether to write no progress to stderr.
    try_harder : bool
        Whether to run both methods again with finer settings, in SCENE_harder, where the verdict is disagree, unexpected or inconclusive.
    try_harder_limit : float or None
        Longest wall time of that second attempt, s; a number implies `try_harder`. None takes 900 s. A longer attempt is not begun.

    Returns
    -------
    Result
        Results of both methods and the verdict, of the second attempt where one was made; its summary then has `first_verdict`.

    Raises
    ------
    SceneError
        The scene or an argument is invalid.
    comparison.errors.FolderInUseError
        Another process or thread works in the scene's folder.

    Examples
    --------
    >>> import comparison
    >>> comparison.run("two_pads", "results", yade=False, quiet=True).verdict
    <Verdict.EXPECTED_MET: 'expected'>
    """
    limit, runs_yade, chosen = seconds_or_none("time_limit", time_limit), true_or_false("yade", yade), load(scene)
    may_repeat, most = true_or_false("try_harder", try_harder), seconds_or_none("try_harder_limit", try_harder_limit)
    refuse_name(chosen)
    results = folder_of_results(folder)
    with narration(quiet) as told:
        model = structural_model(chosen)
        first = workflow.run_scene(model, results / chosen.name, told, runs_yade, limit)
        again = workflow.try_harder(first, chosen, results, told, runs_yade, most or HARDER_SECONDS) if may_repeat or most else None
    return _result(results / (again or first)["scene"], again or first, model.assembly.interfaces)


def read(folder: Path | str) -> Result:
    """Read the stored results of one scene; judge and draw them again where the program has changed.

    A folder that cannot be written is read as it is, and nothing is stored there.

    Parameters
    ----------
    folder : Path or str
        Folder of the scene's results, such as "crosscheck-results/two_pads".

    Returns
    -------
    Result
        Results of both methods and the verdict.

    Raises
    ------
    la_core.exchange.ExchangeError
        The folder holds no results, or a file in it is damaged.
    comparison.errors.FolderInUseError
        Another process or thread works in the folder.

    Examples
    --------
    >>> import comparison
    >>> result = comparison.run("two_pads", "results", yade=False, quiet=True)
    >>> comparison.read("results/two_pads").verdict == result.verdict
    True
    """
    place = path_of("folder", folder)
    with narration(True) as told:
        summary = workflow.report_again(place, told)
    return _result(place, summary)


def export(what: Answer | Result, folder: Path | str) -> list[Path]:
    """Write blocks, mechanisms, forces and YADE's states as files for ParaView.

    Parameters
    ----------
    what : Answer or Result
        Results of limit analysis, or of both methods.
    folder : Path or str
        Folder of the files.

    Returns
    -------
    list of Path
        Files to open in ParaView.

    Raises
    ------
    SceneError
        An argument is invalid, or a file stands in the place of the folder.
    """
    return export_results(_results_of(what), folder_of_results(folder))


def animate(what: Answer | Result, path: Path | str, fps: int = 10, quiet: bool = False) -> Path:
    """Write the settlement as an animation, as `crosscheck animate` does: the mechanisms grow while YADE's reaction is recorded.

    Parameters
    ----------
    what : Answer or Result
        Results of limit analysis, or of both methods.
    path : Path or str
        File to write; its ending chooses the format: .gif, or .mp4, which needs ffmpeg.
    fps : int
        Frames a second, 1 to 50.
    quiet : bool
        Whether to write no progress to stderr.

    Returns
    -------
    Path
        The written file.

    Raises
    ------
    SceneError
        Nothing moves, an argument is invalid, or the folder of the file does not exist.
    FileNotFoundError
        The file is an MP4, and ffmpeg is not installed.
    """
    results, frames, place = _results_of(what), whole_number("fps", fps, 1, MOST_FRAMES), path_of("path", path)
    with narration(quiet) as told:
        write_animation(Story(results), place, frames, lambda k, of: told.fraction(results.scene.name, k / of, f"frame {k} of {of}"))
    return place


def _results_of(what: Answer | Result) -> Results:
    if not isinstance(what, Answer | Result):
        raise SceneError("what", "must be an answer of la_core.solve or a result of comparison.run", value=type(what).__name__)
    return Results(what.analysis) if isinstance(what, Answer) else Results(what.answer.analysis, what.yade)


def _result(folder: Path, summary: dict[str, Any], interfaces: Interfaces | None = None) -> Result:
    place = folder.absolute()  # variants of its scene find their meshes there from any current folder
    results = read_results(place, interfaces)
    return Result(place, summary, Answer(results.scene, results.analysis), results.run if summary["yade"] is not None else None)
