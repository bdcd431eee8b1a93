"""The figures of a scene's results, by name."""

from collections.abc import Callable
from typing import Any

from comparison.figures.dissipation import dissipation_figure
from comparison.figures.motion import shown_answer
from comparison.figures.reaction import reaction_figure
from comparison.figures.structure import assembly_figure, mechanism_figure
from comparison.yade import Results
from la_core.limit import Status
from la_core.measures import measure


def scene_figures(results: Results) -> dict[str, Callable[[], Any]]:
    """Return a function that draws each figure, by the figure's name.

    Limit analysis shows its Coulomb mechanism where it has one.
    """
    scene, analysis, run = results.scene, results.analysis, results.run
    main = analysis.bounds[analysis.main]
    method, best = shown_answer(analysis)
    mechanisms = {method: best.twists}
    reasons = {} if main.status is Status.INFEASIBLE else {method: f"limit analysis: {main.status}"}
    if run is not None:
        mechanisms["YADE"] = run.mechanism()
        reasons["YADE"] = f"{run.status}: {run.result['message']}"
    measures = measure(analysis.assembly, best.twists, best.forces)
    return {
        "assembly": lambda: assembly_figure(scene, analysis.assembly),
        "mechanisms": lambda: mechanism_figure(analysis.assembly, mechanisms, scene.title, main.falling, reasons),
        "reaction": lambda: reaction_figure(results),
        "dissipation": lambda: dissipation_figure(analysis.assembly, best.twists, measures, f"{scene.title}: {method}"),
    }
