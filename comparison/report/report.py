"""The report of a run: one self-contained offline HTML page, the same content as Markdown, and as JSON."""

import datetime
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from comparison.judge import without_undefined
from comparison.numbers import Units
from comparison.report.scene_view import view_of_scene
from comparison.report.templating import flat, template_environment
from comparison.report.viewer import scripts
from comparison.run_folder import HEAD, name_in_results, read_text, write_text
from comparison.verdict import VERDICTS
from la_core.errors import visible
from la_core.exchange import MADE_AT, made_by
from la_core.text_table import exists

LIMITATIONS = (
    "Both methods share the model: geometry, weights, loads, friction, and rigid blocks that touch at the same points of shared faces, not "
    "at single edges or corners. Agreement proves neither this model nor its inputs.",
    "Contact forces are not compared one by one. Most structures of rigid blocks are statically indeterminate: many sets of contact "
    "forces balance the same weights, and each method finds a different set. Both methods must agree on reactions and on sums of "
    "forces over sections.",
    "Where joints slide, the associated answer is a bound and not a prediction: its flow rule makes sliding joints open "
    "(u_n = mu u_t), but sliding joints of dry stone do not open. The Coulomb prediction has no dilatancy, but its reaction may "
    "depend on the history of friction. The interval shows how much, as long as the mechanism stays the same. Elastic joints under "
    "one steady settlement select a value within the interval, found by a quasi-static path from rest. Another history, such as "
    "repeated settlement, may select another value, or another mechanism with a value outside the interval; only the bounds hold for "
    "every history.",
    "The uncertainty of the Coulomb prediction comes from paths of different viscosity and from the change left in their curves. It is an "
    "estimate and no proof. A structure may have several plateaus; then no single value is the answer.",
    "Limit analysis keeps the undeformed geometry. Its bounds do not depend on stiffness; its Coulomb prediction and its path have "
    "elastic joints. YADE's joints may be stiffer, as the inputs of a scene say: they then reach the same strain at a smaller "
    "settlement, in proportion. In YADE the support has moved and the blocks have inertia. The plateau is extrapolated to zero "
    "settlement; only the tolerances cover the remaining influence of stiffness and speed. Where joints slide, turning blocks may release "
    "a thrust after some tenths of a millimetre, and the reaction comes to another plateau within the bounds. [effects] "
    'rotation = "small" is for settlements before this release, "finite" for settlements after it. By default limit analysis also says '
    "what the prediction becomes after the release; YADE checks the value before it, and the value after it where its run goes so far.",
    "Contact points lie inside the edges of each joint by the inset, the same in both methods. This shortens every lever arm. "
    "Agreement at that inset does not prove the answer for sharp edges. The report therefore says how much the inset changes the least "
    "reaction, or the multiplier, of associated limit analysis; "
    "where joints slide, sharp edges would give another history of friction, and the prediction is for the scene's own inset.",
    "A mechanism need not be unique, least of all in a large wall: two different mechanisms may both belong to the right reaction.",
    "Compressive strength is infinite. Joints carry neither tension nor cohesion. Blocks do not crush, crack or chip. "
    "Forces act at points, so only friction at these points resists torsion at a corner.",
    "YADE's uncertainty covers the noise of its record, the line through its plateau, its speed and the strain of its joints, and a share "
    "for its settings (0.1 % of the reaction by default); the influence of its settings on the history of friction may be larger.",
)


def write_report(
    folder: Path,
    comparisons: list[dict[str, Any]],
    provenance: dict[str, Any],
    head: dict[str, str] | None = None,
    left_out: Sequence[str] = (),
) -> Path:
    """Write report.html, report.md and report.json into a folder and return the path of the HTML page.

    Figures, interactive views and scene files come from `folder/<scene>/`, where they exist. Each file is replaced as a whole or not
    at all.

    Parameters
    ----------
    folder : Path
        Folder of the run.
    comparisons : list of dict
        The content of each scene's `comparison.json`, in the order of the page.
    provenance : dict
        Versions and machine, shown at the end of the page; may be nested.
    head : dict of str, optional
        Words for the head of the report in place of those of the scenes: title, project, author, date.
    left_out : sequence of str
        Names of scenes in the folder whose results cannot be read; the page names them.
    """
    units = [Units(weight if exists(weight := comparison.get("weight")) else None) for comparison in comparisons]  # as in its figures
    scenes = [view_of_scene(folder, number, *each) for number, each in enumerate(zip(comparisons, units, strict=True), 1)]
    titles = [scene["title"] for scene in scenes]
    for scene in scenes:
        if titles.count(scene["title"]) > 1:  # such as a scene and its second attempt
            scene["title"] += f" ({scene['name']})"
    page = {
        "head": report_head(folder, comparisons, head or {}),
        "force_unit": " or ".join(sorted({unit.of("N")[1] for unit in units})),
        "scenes": scenes,
        "scripts": scripts() if any(scene["view"] for scene in scenes) else None,
        "counts": _counts(comparisons),
        "left_out": ", ".join(left_out),
        "provenance": list(flat(provenance)),
        "limitations": LIMITATIONS,
    }
    for name in ("report.md", "report.html"):
        write_text(folder / name, template_environment(name).get_template(f"{name}.j2").render(page))
    stored = stored_report(comparisons, provenance, left_out, head)
    write_text(folder / "report.json", json.dumps(stored, indent=2, sort_keys=True, ensure_ascii=False, allow_nan=False) + "\n")
    return folder / "report.html"


def report_head(folder: Path, comparisons: list[dict[str, Any]], chosen: dict[str, str]) -> dict[str, str]:
    """Return title, project, author and date of a report; "" for an unknown one.

    Chosen words come first, then those on which the scenes agree. Where neither has a date, it is the day of the latest stored result.
    """
    facts = [comparison.get("structure") or {} for comparison in comparisons]
    agreed = {}
    for name in ("project", "author", "date"):
        given = {scene.get(name) or "" for scene in facts}
        agreed[name] = given.pop() if len(given) == 1 else ""
    titles = [str(comparison.get("title") or comparison.get("scene")) for comparison in comparisons]
    agreed["title"] = titles[0] if len(titles) == 1 else chosen.get("project") or agreed["project"] or f"{len(titles)} structures"
    head = {name: chosen.get(name) or agreed[name] for name in HEAD}
    head["date"] = head["date"] or _day_of_results(folder, comparisons)
    return head


def _day_of_results(folder: Path, comparisons: list[dict[str, Any]]) -> str:
    """Return the ISO date of the latest result that a method stored, in the result's own time zone; "" where no result has a date."""
    paths = [folder / name_in_results(comparison) / name for comparison in comparisons for name in ("case.h5", "run.h5")]
    moments = [datetime.datetime.fromisoformat(made[MADE_AT]) for path in paths if MADE_AT in (made := made_by(path))]
    return max(moments).date().isoformat() if moments else ""


def stored_report(
    comparisons: list[dict[str, Any]], provenance: dict[str, Any], left_out: Sequence[str] = (), head: dict[str, str] | None = None
) -> dict[str, Any]:
    """Return the content of report.json; undefined numbers are None.

    It holds the names of scenes that cannot be read under `left_out`, and the chosen words of the head under `head`.
    """
    stored = {"comparisons": comparisons, "provenance": provenance, "left_out": list(left_out), "head": head or {}}
    return dict(without_undefined(stored))


def chosen_head(folder: Path, comparisons: list[dict[str, Any]]) -> tuple[dict[str, str], list[str]]:
    """Return the words that an earlier command chose for the head of a folder's report, and the scenes in `comparisons` that it lacked.

    The words hold for a report of `comparisons` only where no scene was lacking. Words that cannot be read are left out.
    """
    try:
        stored = json.loads(read_text(folder / "report.json"))
        covered = {comparison["scene"] for comparison in stored["comparisons"]}
        words = {name: visible(stored["head"][name]) for name in HEAD if isinstance(stored["head"].get(name), str)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return {}, []  # an older report has no words; a damaged one is written anew
    return words, [comparison["scene"] for comparison in comparisons if comparison["scene"] not in covered]


def _counts(comparisons: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Count the scenes of each verdict; verdicts without scenes are left out."""
    verdicts = [comparison.get("verdict") for comparison in comparisons]
    return [
        {"symbol": symbol, "word": word, "count": verdicts.count(verdict)}
        for verdict, (symbol, word) in VERDICTS.items()
        if verdict in verdicts
    ]
