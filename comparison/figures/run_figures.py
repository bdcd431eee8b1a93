"""The figures of a scene's results, by name."""

from collections.abc import Callable
from typing import Any

from comparison.figures.dissipation import dissipation_figure
from comparison.figures.forces import forces_figure
from comparison.figures.motion import end_words, shown_answer, shown_joints
from comparison.figures.reaction import reaction_figure
from comparison.figures.structure import assembly_figure, mechanism_figure, push_name
from comparison.yade import Results
from la_core.limit import Status
from la_core.measures import measure


def scene_figures(results: Results) -> dict[str, Callable[[], Any]]:
    """Return a function that draws each figure with its title, by the figure's name.

    Limit analysis shows its Coulomb mechanism where it has one.
    """
    return _drawings(results, results.scene.title)


def report_figures(results: Results) -> dict[str, Callable[[], Any]]:
    """Return the figures that a report shows, without titles, because its headings give these.

    The figure of the dissipation is left out where friction dissipates nothing: it would only repeat the mechanism.
    """
    drawings = _drawings(results, "")
    _, best = shown_answer(results.analysis)
    if not measure(results.analysis.assembly, best.twists, best.forces).dissipated_power > 0.0:
        del drawings["dissipation"]
    return drawings


def _drawings(results: Results, title: str) -> dict[str, Callable[[], Any]]:
    scene, analysis, run = results.scene, results.analysis, results.run
    main, assembly = analysis.bounds[analysis.main], analysis.assembly
    method, best = shown_answer(analysis)
    mechanisms, forces = {method: results.per_motion(best.twists)}, {method: best.forces}
    reasons = {} if main.status is Status.INFEASIBLE else {method: f"limit analysis: {main.status}"}
    if run is not None:
        mechanisms["YADE"], forces["YADE"] = run.mechanism(), run.plateau_forces()
        reasons["YADE"] = end_words(run, scene.weight)
    measures = measure(assembly, best.twists, best.forces)

    def mechanism_drawing() -> Any:
        joints = {name: shown_joints(assembly, twists, forces[name]) for name, twists in mechanisms.items()}
        travel = 0.0 if run is None else max(float(run.result.settlement), 0.0)
        return mechanism_figure(assembly, mechanisms, title, main.falling, reasons, joints, travel)

    return {
        "assembly": lambda: assembly_figure(scene, assembly, title),
        "mechanisms": mechanism_drawing,
        "reaction": lambda: reaction_figure(results),
        "forces": lambda: forces_figure(assembly, forces, title),
        "dissipation": lambda: dissipation_figure(
            assembly, best.twists, measures, f"{title}: {method}" if title else method, push_name(scene)
        ),
    }
