"""Results of both methods as they lie in a scene's folder: where, and read back."""

from dataclasses import dataclass
from pathlib import Path

from comparison.yade.run_record import Run, read_run
from la_core.analysis import LimitAnalysis, case_file
from la_core.errors import SceneError
from la_core.geometry import Interfaces
from la_core.scene import Scene, load_scene, shipped


@dataclass(frozen=True)
class Results:
    """Results of both methods on one scene: what the judge, the figures and the report work with.

    analysis: limit analysis, which carries the scene. run: YADE's, None where YADE gave none or was not asked.
    """

    analysis: LimitAnalysis
    run: Run | None = None

    @property
    def scene(self) -> Scene:
        """The scene that was analysed."""
        return self.analysis.scene

    @property
    def recorded(self) -> Run:
        """YADE's run; raises ValueError where there is none."""
        if self.run is None:
            raise ValueError(f"{self.scene.name}: YADE gave no run")
        return self.run


def read_results(folder: Path, interfaces: Interfaces | None = None) -> Results:
    """Stored results of a scene's folder; raises exchange.ExchangeError where limit analysis is missing.

    interfaces: of the scene's blocks, where they are known.
    """
    analysis = case_file.read_case(folder / "case.h5", load_scene(folder / "scene.toml", name=folder.name), interfaces)
    path = folder / "run.h5"
    return Results(analysis, read_run(path, analysis.assembly) if path.exists() else None)


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
