"""`crosscheck export`: write stored results, or limit analysis of a scene, as files for ParaView."""

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.report import export
from comparison.yade import Results, locate_results, read_results
from la_core.analysis import analyse
from la_core.scene import load_scene, shipped


def execute(context: Context) -> int:
    """Write the files and print their paths; raises SceneError, or exchange.ExchangeError for damaged results."""
    options = context.options
    files = [str(path) for path in export(results_of(options.source), options.output)]
    if options.json:
        context.print_json({"files": files})
    else:
        context.out.print("\n".join(files), markup=False)
    return AGREE


def results_of(source: str) -> Results:
    """Return the stored results of a scene's folder, or the limit analysis of a scene given by its path or shipped name.

    Raises SceneError, or exchange.ExchangeError for damaged results.
    """
    folder = locate_results(source)
    if folder is None:
        return Results(analyse(load_scene(shipped.find(source))))
    return read_results(folder)
