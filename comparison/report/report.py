"""The report of a run: one self-contained offline HTML page, the same content as Markdown, and as JSON."""

import json
from pathlib import Path
from typing import Any

from comparison.judge import without_undefined
from comparison.report.scene_view import view_of_scene
from comparison.report.templating import flat, template_environment
from comparison.report.viewer import scripts
from comparison.run_folder import write_text
from comparison.verdict import VERDICTS

LIMITATIONS = (
    "Contact forces are not compared one by one. Most structures of rigid blocks are statically indeterminate: many sets of contact "
    "forces balance the same weights, and each method finds a different set. Both methods must agree on reactions and on sums of "
    "forces over sections.",
    "Where joints slide, the associated answer is a bound and not a prediction: its flow rule makes sliding joints open "
    "(u_n = mu u_t), and those of dry stone do not. The Coulomb prediction has no dilatancy, but its reaction may depend on the "
    "history of friction. The interval shows how much. Elastic joints under one steady settlement select a value within it, found by a "
    "quasi-static path from rest. Another history, such as repeated settlement, may select another value.",
    "The uncertainty of the Coulomb prediction is what paths of different viscosity and the rest of their curves leave open. It is an "
    "estimate and no proof. A structure may have several plateaus; then no single value is the answer.",
    "Limit analysis keeps the undeformed geometry. Its bounds do not depend on stiffness; its Coulomb prediction and its path use the "
    "stiffness of YADE's joints. In YADE the support has moved and the blocks have inertia. The plateau is extrapolated to zero "
    "settlement; only the tolerances cover the remaining influence of stiffness and speed.",
    "Contact points lie inside the arrises by the inset, the same in both methods. This shortens every lever arm. "
    "Agreement at that inset does not prove the answer for sharp arrises. The report therefore gives the bounds for sharp arrises, too; "
    "where joints slide, sharp arrises would be another history of friction, and the prediction is for the scene's own.",
    "A mechanism need not be unique, least of all in a large wall: two different mechanisms may both belong to the right reaction.",
    "Compressive strength is infinite. Joints carry neither tension nor cohesion. Blocks do not crush, crack or chip. "
    "Forces act at points, so only friction at these points resists torsion at a corner.",
    "YADE's uncertainty covers its fitted plateau, and 0.02 % for its settings; the influence of its settings on the history of "
    "friction may be larger.",
)


def write_report(folder: Path, comparisons: list[dict[str, Any]], provenance: dict[str, Any]) -> Path:
    """Write report.html, report.md and report.json into a folder and return the path of the HTML page.

    Figures and interactive views come from `folder/<scene>/`, where they exist. Each file is replaced as a whole or not at all.

    Parameters
    ----------
    folder : Path
        Folder of the run.
    comparisons : list of dict
        The content of each scene's `comparison.json`, in the order of the page.
    provenance : dict
        Versions and machine, shown at the end of the page; may be nested.
    """
    scenes = [view_of_scene(folder, number, comparison) for number, comparison in enumerate(comparisons, 1)]
    page = {
        "scenes": scenes,
        "scripts": scripts() if any(scene["view"] for scene in scenes) else None,
        "counts": _counts(comparisons),
        "provenance": list(flat(provenance)),
        "limitations": LIMITATIONS,
    }
    for name in ("report.md", "report.html"):
        write_text(folder / name, template_environment(name).get_template(f"{name}.j2").render(page))
    stored = stored_report(comparisons, provenance)
    write_text(folder / "report.json", json.dumps(stored, indent=2, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n")
    return folder / "report.html"


def stored_report(comparisons: list[dict[str, Any]], provenance: dict[str, Any]) -> dict[str, Any]:
    """Return the content of report.json; undefined numbers are None."""
    return dict(without_undefined({"comparisons": comparisons, "provenance": provenance}))


def _counts(comparisons: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Count the scenes of each verdict; verdicts without scenes are left out."""
    verdicts = [comparison.get("verdict") for comparison in comparisons]
    return [
        {"symbol": symbol, "word": word, "count": verdicts.count(verdict)}
        for verdict, (symbol, word) in VERDICTS.items()
        if verdict in verdicts
    ]
