"""`crosscheck solve`: limit analysis of one scene, without YADE; the bounds are printed before the prediction is known."""

from pathlib import Path
from typing import Any

from comparison.cli import tables
from comparison.cli.context import Context
from comparison.cli.exit_codes import EXIT_OF_VERDICT, INCONCLUSIVE, SEVERITY
from comparison.judge import (
    check_accuracy,
    check_answer,
    check_expected,
    conclusion_of,
    greatest_load_summary,
    limit_analysis_summary,
    limit_analysis_values,
)
from comparison.limit_analysis import limit_analysis_alone
from comparison.numbers import plural
from comparison.progress import Narration
from comparison.settings import load_settings
from comparison.verdict import UNCONFIRMED, Check, Verdict
from comparison.yade import Results
from la_core.analysis import LimitAnalysis, associated_values, solve, structural_model, with_accuracy
from la_core.errors import SceneError
from la_core.limit import Status
from la_core.scene import Scene, load_scene, shipped


class _BoundsFirst(Narration):
    """Narration that prints the bounds as a table of results, unless JSON is requested, or they are those of one attempt at an accuracy."""

    def __init__(self, context: Context) -> None:
        super().__init__(context.narrator)
        self._context = context
        self.has_printed_bounds = False

    def tell_bounds(self, analysis: LimitAnalysis) -> None:
        if self._context.options.json or (analysis.scene.accuracy is not None and not self._context.options.bounds):
            super().tell_bounds(analysis)
            return
        _tell_whether_it_stands(analysis, self._context)
        values = {"associated": associated_values(analysis)}
        self._context.table(tables.bounds_table(analysis.scene, values, self._context.options.long))
        self.has_printed_bounds = True


def execute(context: Context) -> int:
    """Solve a scene and print its answer; the exit code is at least 'inconclusive' if a solver failed or is inaccurate.

    Raises SceneError.
    """
    options, narrator = context.options, context.narrator
    if options.bounds and options.accuracy is not None:
        rule = "not allowed with argument --bounds: no setting of the bounds depends on an accuracy"
        raise SceneError("argument --accuracy", rule, hint="leave out --accuracy, or leave out --bounds for an answer of this accuracy")
    scene = load_scene(shipped.find(options.scene))
    if options.accuracy is not None:
        scene = with_accuracy(scene, options.accuracy)
    context.warn(scene)
    narrator.print(f"{scene.name}: limit analysis, free blocks: {int(scene.blocks.free.sum())}", markup=False)
    with _BoundsFirst(context) as narration:
        analysis = _analysed(scene, context, narration)
    checks = [*check_expected(analysis), *check_accuracy(Results(analysis))]
    if options.json:
        context.print_json(limit_analysis_summary(analysis))
    else:
        if not narration.has_printed_bounds:  # the bounds were stored, or are those of the last attempt
            _tell_whether_it_stands(analysis, context)
        _print_rest(scene, limit_analysis_values(analysis), checks, narration.has_printed_bounds, context)
        if greatest := greatest_load_summary(Results(analysis)):
            context.tell(greatest["words"])
        if dropped := analysis.whole.slivers:
            are = f"{plural(dropped, 'joint')} {'is' if dropped == 1 else 'are'}"
            smaller = "inset" if scene.repairs is None else "inset or tolerance of the geometry"
            context.tell(f"{are} too short to count and dropped, also with sharp edges. A smaller {smaller} may keep more joints.")
    if options.output is not None:
        _draw(analysis, options.output)
        narrator.print(f"drawn in {options.output}", markup=False)
    concluded = conclusion_of(analysis, [*checks, *check_answer(analysis)], None)
    if concluded.verdict not in UNCONFIRMED:  # an answer that no check contradicts needs no next step
        is_said = concluded.verdict is Verdict.CANNOT_STAND and not options.json
        words = "" if is_said else f"{concluded.reason}\n"
        context.narrate(f"{words}next: {concluded.next_step}")
    if _statuses(analysis, options.bounds) & {Status.INACCURATE, Status.FAILED}:
        return max(INCONCLUSIVE, EXIT_OF_VERDICT[concluded.verdict], key=SEVERITY.index)
    return EXIT_OF_VERDICT[concluded.verdict]


def _tell_whether_it_stands(analysis: LimitAnalysis, context: Context) -> None:
    """Print that the structure cannot stand, with the reason, where limit analysis proves it."""
    if (concluded := conclusion_of(analysis, [], None)).verdict is Verdict.CANNOT_STAND:
        context.tell(f"{analysis.scene.name} cannot stand. {concluded.reason}")


def _analysed(scene: Scene, context: Context, narration: Narration) -> LimitAnalysis:
    """Return the requested analysis; only a complete one without an extra path is stored, because `crosscheck run` makes the same."""
    options = context.options
    if options.bounds or options.path:
        return solve(scene, options.path, options.bounds, narration).analysis
    folder = (options.results or load_settings().settings.output) / scene.name
    return limit_analysis_alone(structural_model(scene), folder, narration)


def _print_rest(scene: Scene, answer: dict[str, Any], checks: list[Check], has_printed_bounds: bool, context: Context) -> None:
    """Print the tables of an answer, without the bounds where these were printed already."""
    if not has_printed_bounds:
        context.table(tables.bounds_table(scene, answer, context.options.long))
    if (rest := tables.prediction_table(scene, answer, checks, context.options.long)) is not None:
        context.table(rest)
    if answer["path"] is not None:
        context.table(tables.path_table(scene, answer["path"]))
        context.tell(
            "The path ends here, on the plateau or before it. A larger `settlement` in the scene's [path] table follows it further."
        )


def _statuses(analysis: LimitAnalysis, bounds_only: bool) -> set[Status]:
    """Return the statuses that decide the exit code: those of the main answer and its prediction, or those of all bounds."""
    if bounds_only:
        return {bound.status for bound in analysis.bounds.values()}
    return {analysis.bounds[analysis.main].status} | ({analysis.coulomb.status} if analysis.coulomb else set())


def _draw(analysis: LimitAnalysis, path: Path) -> None:
    from comparison.figures import reaction_figure, save  # loads matplotlib, which printing a number does not need

    save(reaction_figure(Results(analysis)), path)
