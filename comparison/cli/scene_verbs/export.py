"""`crosscheck export`: write stored results, or limit analysis of a scene, as files for ParaView."""

from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.report import export
from comparison.yade import Results, locate_results, read_results
from la_core.analysis import analyse
from la_core.scene import load_scene, shipped


def execute(context: Context) -> int:
    """Write the files and print their paths; raises SceneError, or exchange.ExchangeError for damaged results."""
    options = context.options
    stored = locate_results(options.source)
    several = len(stored) > 1
    files = []
    for results in map(read_results, stored) if stored else [solved_results(options.source)]:
        name = results.scene.name
        folder = options.output or Path(f"{name}-paraview")
        files += [str(path) for path in export(results, folder / name if several and options.output else folder)]
    if options.json:
        context.print_json({"files": files})
    else:
        context.out.print("\n".join(files), markup=False)
    return AGREE


def solved_results(source: str) -> Results:
    """Return the limit analysis of a scene given by its path or shipped name; raises SceneError."""
    return Results(analyse(load_scene(shipped.find(source))))
