"""Stored results of both methods: find the folder of a scene and read them."""

import errno
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from comparison.run_folder import CASES
from comparison.settings import load_settings
from comparison.yade.run_record import Run, read_run
from la_core.analysis import LimitAnalysis, case_file, has_given_stiffness
from la_core.coulomb import STIFFER
from la_core.errors import SceneError, nearest
from la_core.exchange import ExchangeError
from la_core.geometry import Interfaces
from la_core.scene import Scene, load_scene, shipped


@dataclass(frozen=True)
class Results:
    """Results of both methods on one scene, the input of the judge, the figures and the report.

    Attributes
    ----------
    analysis : LimitAnalysis
        Limit analysis, which carries the scene.
    run : Run or None
        YADE's run; None if it failed or was not requested.
    """

    analysis: LimitAnalysis
    run: Run | None = None

    @property
    def scene(self) -> Scene:
        """The scene that was analysed."""
        return self.analysis.scene

    @property
    def recorded(self) -> Run:
        """YADE's run; raises ValueError if there is no run."""
        if self.run is None:
            raise ValueError(f"{self.scene.name}: there is no YADE run in these results")
        return self.run

    def per_motion(self, twists: np.ndarray) -> np.ndarray:
        """Return twists (B, 6) of limit analysis per unit of the motion that YADE records: of the support, or along the live load, m.

        The motion along a live load is the mean over the loaded weights: the power of the load over its sum. NaN if it is not above 0.
        """
        if self.scene.live is None:
            return twists
        load = self.analysis.assembly.live_load
        return _over(twists, float(np.sum(load * twists) / np.linalg.norm(load[:, :3], axis=1).sum()))

    def per_drive(self, twists: np.ndarray) -> np.ndarray:
        """Return twists (B, 6) of YADE per unit of the drive of limit analysis: motion of the support, or power of the unit live load.

        This is the inverse of `per_motion`; NaN if the power of a live load on these twists is not above 0.
        """
        return twists if self.scene.live is None else _over(twists, float(np.sum(self.analysis.assembly.live_load * twists)))

    @property
    def stiffening(self) -> float:
        """Stiffness of YADE's joints over that of limit analysis, > 0; 1 without a run, NaN if a stiffness is undefined or zero."""
        if self.run is None:
            return 1.0
        normal = self.analysis.stiffness.normal
        used = float(self.run.settings.get("normal_stiffness", normal))
        return used / normal if normal > 0.0 and used > 0.0 else math.nan

    @property
    def path_scale(self) -> float:
        """Settlement of the requested path over the corresponding settlement of YADE's run; NaN if `stiffening` is NaN.

        With small rotations, joints strain equally at corresponding settlements, because only the settlement over the sag counts. With
        finite rotations, equal thrusts have been released, because the settlement of a release grows with the root of the sag.
        """
        return math.sqrt(self.stiffening) if self._turns else self.stiffening

    @property
    def prediction_scale(self) -> float:
        """The same ratio for the curve of the prediction, whose joints represent stiffer ones if rotations are finite."""
        stands_for_stiffer = self._turns and not has_given_stiffness(self.scene)
        return self.path_scale * (math.sqrt(STIFFER) if stands_for_stiffer else 1.0)

    @property
    def _turns(self) -> bool:
        return self.analysis.assembly.effects.rotation == "finite"


def _over(twists: np.ndarray, size: float) -> np.ndarray:
    """Return twists (B, 6) divided by a size; NaN if the size is not above 0."""
    return twists / size if size > 0.0 else np.full_like(twists, np.nan)


def read_results(folder: Path, interfaces: Interfaces | None = None) -> Results:
    """Read the results in a scene's folder; raises exchange.ExchangeError if limit analysis is missing or a file is damaged.

    interfaces: interfaces of the scene's blocks, if they are already known; otherwise they are searched for.
    """
    scene = folder / "scene.toml"
    if not scene.is_file():
        raise ExchangeError(f"{scene}: this copy of the scene is missing; run the scene again")
    analysis = case_file.read_case(folder / "case.h5", load_scene(scene, name=folder.name), interfaces)
    path = folder / "run.h5"
    return Results(analysis, read_run(path, analysis.assembly) if path.exists() else None)


def among_results(name: str) -> str:
    """Return a hint with the path of the stored results of this name, as the end of a message; "" without such results."""
    folder = load_settings().settings.output / name
    return f'did you mean "{folder}"?' if _holds((folder / "case.h5").is_file) else ""


def results_beside(folder: Path) -> str:
    """Return a hint with the stored results beside this folder: the one with a similar name, else all; "" without any."""
    beside = sorted(path.parent.name for path in folder.parent.glob("*/case.h5")) if _holds(folder.parent.is_dir) else []
    return nearest(folder.name, beside, f"results in {folder.parent}") if beside else ""


def _is_of_results(source: str) -> bool:
    """Whether a path that does not exist may be meant as a folder of results: a name alone, or the path of a scene file, is not."""
    return "/" in source and not source.endswith((".toml", ".."))


def _holds(question: Callable[[], bool]) -> bool:
    """Return the answer to a question about a path; it is False if the name is too long for the system."""
    try:
        return question()
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            return False
        raise


def locate_results(source: str) -> list[Path]:
    """Return the folders of stored results: `source`, or all inside it; empty if `source` names a scene instead.

    Raises SceneError for a folder without results.
    """
    folder = Path(source)
    is_scene = source in shipped.names() or _holds(Path(f"{source}.toml").is_file)  # a scene beside a folder of its name
    if not source or not _holds(folder.is_dir):
        is_file = bool(source) and _holds(folder.exists)
        if (
            source
            and not is_scene
            and not is_file
            and (hint := among_results(source) or (results_beside(folder) if _is_of_results(source) else ""))
        ):
            raise SceneError(source, "neither a folder of results, a file nor a shipped scene", hint=hint)
        return []
    runs = [folder] if (folder / "case.h5").is_file() else sorted(path.parent for path in folder.glob("*/case.h5"))
    if not runs and not is_scene:
        cases = sorted(path.parent.parent for path in folder.glob(f"{CASES}/*/*/case.h5"))  # of a campaign
        hint = f'name the folder of one of its cases, such as "{cases[0]}"' if cases else "name a folder of results, or a scene"
        raise SceneError(source, "holds no results of `crosscheck run`", hint=hint)
    return runs
