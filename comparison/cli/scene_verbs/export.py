"""`crosscheck export`: stored results, or limit analysis of a scene, as files for ParaView."""

from comparison.yade import Run, locate_results, read_results
from la_core.analysis import LimitAnalysis, accuracy
from la_core.scene import load_scene, shipped


def results_of(source: str) -> tuple[LimitAnalysis, Run | None]:
    """Stored results of a scene's folder within those of a run, or limit analysis of a scene, path or shipped.

    Raises SceneError, or exchange.ExchangeError for broken results.
    """
    folder = locate_results(source)
    if folder is not None:
        return read_results(folder)[1:]
    return accuracy.analyse(load_scene(shipped.find(source))), None
