"""The report of a run: one self-contained offline HTML page, the same as Markdown that diffs well, and as JSON."""

import json
from pathlib import Path
from typing import Any

from comparison.judge import without_undefined
from comparison.report.scene_view import VERDICTS, view_of_scene
from comparison.report.templating import flat, template_environment
from comparison.report.viewer import scripts
from comparison.run_folder import write_text

LIMITATIONS = (
    "Contact forces are not compared one by one. Rigid blocks on more than the fewest contacts are hyperstatic: many force states "
    "balance the same weights, and each method picks its own. Reactions and force sums over sections are what both must share.",
    "Where joints slide, the associated answer is a bound and not a prediction: its flow rule dilates (u_n = mu u_t), dry stone does "
    "not. The Coulomb prediction does not dilate, but what its mechanism carries may depend on friction's history: the interval says how "
    "far, and elastic joints under one steady settlement select within it. Another history, such as repeated settlement, may end "
    "elsewhere.",
    "Limit analysis keeps the undeformed geometry; its bounds know no stiffness, its Coulomb prediction and its path take that of YADE's "
    "joints. In YADE the support has moved and the blocks have inertia: "
    "the plateau is extrapolated to zero settlement, but what stiffness and speed leave behind is only covered by the tolerances.",
    "Contact points are drawn in from the arrises by the inset, the same in both methods, which shortens every lever arm. "
    "Agreement at that inset says nothing on sharp arrises; the sharp reaction stands beside it for that reason.",
    "A mechanism need not be unique, least of all in a large wall: two that differ may both belong to the right reaction.",
    "Compressive strength is infinite, joints carry no tension or cohesion, blocks neither crush, crack nor chip; "
    "forces act at points, so a corner's resistance to torsion is that of the friction at its points.",
    "YADE's uncertainty is that of its fitted plateau and 0.02 % for its settings; friction's history may depend on them by more.",
)


def write_report(folder: Path, comparisons: list[dict[str, Any]], provenance: dict[str, Any]) -> Path:
    """Write report.html, report.md and report.json into `folder`, from comparison.json objects; returns the page's path.

    Figures and interactive views are taken from `folder/<scene>/`, where they exist. Each file is whole or the one that was there before.
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
    """What report.json holds."""
    return dict(without_undefined({"comparisons": comparisons, "provenance": provenance}))


def _counts(comparisons: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """How many scenes came to each verdict, verdicts without scenes left out."""
    found = [comparison.get("verdict") for comparison in comparisons]
    return [
        {"symbol": symbol, "word": word, "count": found.count(verdict)} for verdict, (symbol, word) in VERDICTS.items() if verdict in found
    ]
