"""Results of both methods as they lie in a scene's folder: where, and read back."""

from pathlib import Path

from comparison.yade.run_record import Run, read_run
from la_core.analysis import LimitAnalysis, case_file
from la_core.errors import SceneError
from la_core.scene import Scene, load_scene, shipped


def read_results(folder: Path) -> tuple[Scene, LimitAnalysis, Run | None]:
    """Stored results of a run's folder; raises exchange.ExchangeError where limit analysis is missing."""
    scene = load_scene(folder / "scene.toml", name=folder.name)
    analysis = case_file.read_case(folder / "case.h5", scene)
    run_path = folder / "run.h5"
    return scene, analysis, read_run(run_path, analysis.assembly) if run_path.exists() else None


def locate_results(source: str) -> Path | None:
    """Folder of a scene's results: the one given, or the only one in it; None where the source is no folder of results but a scene.

    Raises SceneError for a folder without results, or with those of several scenes.
    """
    folder = Path(source)
    if not folder.is_dir():
        return None
    runs = [folder] if (folder / "case.h5").is_file() else sorted(path.parent for path in folder.glob("*/case.h5"))
    if not runs and source in shipped.names():
        return None
    if not runs:
        raise SceneError(source, "holds no results of `crosscheck run`")
    if len(runs) > 1:
        names = ", ".join(run.name for run in runs)
        raise SceneError(source, "holds the results of several scenes", hint=f"name one of its folders: {names}")
    return runs[0]
