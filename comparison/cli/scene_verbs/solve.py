"""`crosscheck solve`: limit analysis of one scene, without YADE."""

from pathlib import Path

from comparison.cli import tables
from comparison.cli.context import Context
from comparison.cli.exit_codes import EXIT_OF_VERDICT, GRAVITY, INCONCLUSIVE
from comparison.judge import check_accuracy, check_expected, limit_analysis_summary, overall
from comparison.yade import Results
from la_core.analysis import LimitAnalysis, solve
from la_core.limit import Status
from la_core.scene import load_scene, shipped


def execute(context: Context) -> int:
    """Solve a scene and print its answer; the exit code is at least 'inconclusive' if a solver failed or is inaccurate.

    Raises SceneError.
    """
    options, narrator = context.options, context.narrator
    scene = load_scene(shipped.find(options.scene))
    narrator.print(f"{scene.name}: limit analysis, free blocks: {int(scene.blocks.free.sum())}", markup=False)
    analysis = solve(scene, options.path).analysis
    summary = limit_analysis_summary(analysis)
    checks = [*check_expected(analysis), *check_accuracy(Results(analysis))]
    if options.json:
        context.print_json(summary)
    else:
        context.out.print(tables.solution_table(scene, summary, checks))
        if analysis.path is not None:
            context.out.print(tables.path_table(scene, summary["limit_analysis"]["path"]))
    if options.output is not None:
        _draw(analysis, options.output)
        narrator.print(f"drawn in {options.output}", markup=False)
    verdict, reason = overall(checks)
    if reason:
        narrator.print(reason, markup=False)
    statuses = {analysis.bounds[analysis.main].status} | ({analysis.coulomb.status} if analysis.coulomb else set())
    if statuses & {Status.INACCURATE, Status.FAILED}:
        return max(INCONCLUSIVE, EXIT_OF_VERDICT[verdict], key=GRAVITY.index)
    return EXIT_OF_VERDICT[verdict]


def _draw(analysis: LimitAnalysis, path: Path) -> None:
    from comparison.figures import reaction_figure, save  # loads matplotlib, which printing a number does not need

    save(reaction_figure(Results(analysis)), path)
