"""`crosscheck export`: stored results, or limit analysis of a scene, as files for ParaView."""

from comparison.yade import Results, locate_results, read_results
from la_core.analysis import analyse
from la_core.scene import load_scene, shipped


def results_of(source: str) -> Results:
    """Stored results of a scene's folder within those of a run, or limit analysis of a scene, path or shipped.

    Raises SceneError, or exchange.ExchangeError for broken results.
    """
    folder = locate_results(source)
    if folder is not None:
        return read_results(folder)
    return Results(analyse(load_scene(shipped.find(source))))
