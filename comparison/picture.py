"""Figures of scenes and answers, as pictures that notebooks show."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from comparison.figures import assembly_figure, rendered, save, scene_figures
from comparison.run_folder import FIGURE_FORMATS, require_ending, require_folder_of
from comparison.yade import Results, Run
from la_core.analysis import Answer, decided_model
from la_core.errors import SceneError, nearest, path_of
from la_core.scene import Scene, load


@dataclass(frozen=True, eq=False)
class Picture:
    """Figure that a notebook shows as an image.

    Attributes
    ----------
    figure : matplotlib.figure.Figure
        Figure of matplotlib; change it as you like before you save it.
    """

    figure: Any

    def save(self, path: Path | str) -> "Picture":
        """Write the figure to a file.

        Parameters
        ----------
        path : Path or str
            File to write; its ending chooses the format: .png, .svg or .pdf.

        Returns
        -------
        Picture
            This picture, so that a notebook shows the saved figure.

        Raises
        ------
        SceneError
            The path has another ending, or its folder does not exist.
        """
        place = path_of("path", path)
        require_ending(place, FIGURE_FORMATS, "a figure")
        require_folder_of(place)
        save(self.figure, place)
        return self

    def _repr_png_(self) -> bytes:
        return rendered(self.figure, ".png")


def draw(what: Scene | Path | str | Answer, name: str = "", run: Run | None = None) -> Picture:
    """Draw a figure of a scene or of an answer.

    Parameters
    ----------
    what : Scene, Path, str or Answer
        A scene, its file or its name, for a figure of its assembly; or an answer, for the figure `name`.
    name : str
        Figure of an answer: "assembly", "mechanisms" (default), "reaction", "forces" or "dissipation". Ignored for a scene.
    run : Run or None
        YADE's record, drawn beside the answer. Ignored for a scene.

    Returns
    -------
    Picture
        The figure.

    Raises
    ------
    SceneError
        No figure or no scene has this name, or `run` is no record of YADE.

    Examples
    --------
    >>> import comparison
    >>> picture = comparison.draw("two_pads")
    >>> picture.save("two_pads.png") is picture
    True
    """
    if not isinstance(what, Answer):
        scene = load(what)
        return Picture(assembly_figure(scene, decided_model(scene).assembly))
    if not isinstance(run, Run | None):
        raise SceneError("run", "must be YADE's record, such as result.yade, or None", value=type(run).__name__)
    assembly = what.analysis.assembly
    if run is not None and run.poses.forces.shape[1:] != assembly.points.position.shape:
        raise SceneError("run", "must be the record of the answer's scene", hint="take the answer and the record of one result")
    drawings, chosen = scene_figures(Results(what.analysis, run)), name or "mechanisms"
    if not isinstance(chosen, str) or chosen not in drawings:
        raise SceneError(f'figure "{chosen}"', "unknown name", hint=nearest(str(chosen), drawings, "figures"))
    return Picture(drawings[chosen]())
