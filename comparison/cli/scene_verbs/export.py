"""`crosscheck export`: write stored results, or limit analysis of a scene, as files for ParaView."""

from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.report import export_results
from comparison.run_folder import OUTCOME
from comparison.yade import Results, locate_results, read_results
from la_core.analysis import analyse
from la_core.scene import load_scene, shipped


def execute(context: Context) -> int:
    """Write the files and print their paths; raises SceneError, or exchange.ExchangeError for damaged results."""
    options = context.options
    stored = locate_results(options.source)
    files = _export_stored(stored, options.output) if stored else _export_solved(options.source, options.output)
    if options.json:
        context.print_json({"files": files})
    else:
        context.out.print("\n".join(files), markup=False)
    return AGREE


def _export_stored(folders: list[Path], output: Path | None) -> list[str]:
    """Export the stored results of scenes, those of several scenes into folders of their names; return the files to open."""
    files: list[str] = []
    for folder in folders:
        place = Path(f"{_name(folder)}-paraview") if output is None else output / folder.name if len(folders) > 1 else output
        files += map(str, export_results(read_results(folder), place))
    return files


def _name(folder: Path) -> str:
    """Return the name of a scene's results; in a campaign the name of the case, because the results of a sweep's cases share one name."""
    case = folder.resolve().parent
    return case.name if (case / OUTCOME).is_file() else folder.name


def _export_solved(source: str, output: Path | None) -> list[str]:
    """Export the limit analysis of a scene given by its path or shipped name; return the files to open. Raises SceneError."""
    scene = load_scene(shipped.find(source))
    return list(map(str, export_results(Results(analyse(scene)), output or Path(f"{scene.name}-paraview"))))
