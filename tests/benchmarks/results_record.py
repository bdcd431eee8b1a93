"""The record behind `results.md`: one entry for each shipped scene, with the results of both methods for the reduced and the full model.

Forces are divided by W, the weight of the free blocks; multipliers are not divided. An undefined number is null.
"""

import json
import time
from pathlib import Path
from typing import Any

from comparison.provenance import describe
from comparison.workflow import Listener, run_scene
from comparison.yade import find_yade
from la_core.limit.associated import Drive
from la_core.limit.classic_iteration import solve_sequentially
from la_core.model import assemble
from la_core.scene import Scene, full_model, load_scene, shipped
from la_core.text_table import over_weight

RECORD = Path(__file__).parents[2] / "comparison" / "gallery" / "results.json"
FRICTION_WALLS = ("wall_third", "wall_half", "wall_low_friction")  # scenes whose reaction by the classic iteration is recorded, too
VERSIONS = ("python", "clarabel", "numpy", "machine")


def read_record(path: Path = RECORD) -> dict[str, dict[str, Any]]:
    """Return the entries by scene, in the order of their names; an empty record where there is no file."""
    return dict(sorted(json.loads(path.read_text(encoding="utf-8")).items())) if path.exists() else {}


def write_record(entries: dict[str, dict[str, Any]], path: Path = RECORD) -> None:
    """Store all entries."""
    path.write_text(json.dumps(dict(sorted(entries.items())), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


def measured(name: str, folder: Path, listener: Listener) -> dict[str, Any]:
    """Run both models of a shipped scene and return its entry. `seconds` is the wall time of all runs.

    Results are written into `folder`. A model whose results are already there is not run again.
    """
    start = time.monotonic()
    scene = load_scene(shipped.find(name))
    reduced = run_scene(scene, folder / name, listener, with_yade=True)
    entry = {
        "blocks": reduced["free_blocks"],
        "weight": reduced["weight"],
        "left_out": [row["effect"] for row in reduced["effects"]["table"] if not row["on"]],
        "reduced": model_values(reduced),
    }
    if name not in shipped.LONG:
        whole = full_model(scene)
        entry["full"] = model_values(run_scene(whole, folder / whole.name, listener, with_yade=True))
    if name in FRICTION_WALLS:
        entry["classic"] = classic_reaction(scene)
    known = describe()
    versions = {package: known[package] for package in VERSIONS} | {"YADE": find_yade().version}
    return entry | {"seconds": round(time.monotonic() - start, 1), "versions": versions}


def with_limit_analysis(entry: dict[str, Any], name: str, folder: Path, listener: Listener) -> dict[str, Any]:
    """Return the entry with a new limit analysis of both models, and YADE's recorded values and verdicts. YADE uses no prediction."""
    scene, kept = load_scene(shipped.find(name)), ("yade_status", "yade", "uncertainty", "verdict", "yade_seconds")
    models = {"reduced": scene} | ({} if name in shipped.LONG else {"full": full_model(scene)})
    for model, one in models.items():
        fresh = model_values(run_scene(one, folder / one.name, listener, with_yade=False))
        entry = entry | {model: entry[model] | {key: value for key, value in fresh.items() if key not in kept}}
    return entry | {"yade_before": True}


def model_values(summary: dict[str, Any]) -> dict[str, Any]:
    """Return the recorded values of one model from `comparison.json`, with the inset that both methods share; `sharp` is without inset.

    The seconds are those of the solver in the whole limit analysis, and of YADE's run.
    """
    associated, coulomb, yade = summary["limit_analysis"]["associated"], summary["limit_analysis"]["coulomb"], summary["yade"] or {}
    live = "multiplier" in associated
    quantity, unit = ("multiplier", 1.0) if live else ("reaction", summary["weight"])
    bounds, predicted = associated.get("shared_inset", associated), coulomb.get("shared_inset", coulomb)
    return {
        "least": over_weight(bounds[quantity], unit),
        "predicted": over_weight(predicted[quantity], unit),
        "interval": [over_weight(end, unit) for end in predicted[f"{quantity}_interval"]],
        "greatest": over_weight(bounds.get("reaction_max"), unit),
        "stated": over_weight(coulomb["uncertainty"], unit),
        "plateaus": [over_weight(value, unit) for value in coulomb["plateaus"]],
        "sharp": over_weight(coulomb[f"{quantity}_sharp"], unit),
        "prediction_status": coulomb["status"],
        "solves": coulomb["iterations"],
        "steps": coulomb["steps"],
        "yade_status": yade.get("status"),
        "yade": over_weight(yade.get("reaction"), unit),
        "uncertainty": over_weight(yade.get("uncertainty"), unit),
        "verdict": summary["verdict"],
        "limit_analysis_seconds": associated["seconds"] + coulomb["seconds"],
        "yade_seconds": yade.get("seconds"),
    }


def classic_reaction(scene: Scene) -> float:
    """Return the reaction over the weight by the classic iteration for friction, with its own settings."""
    return float(solve_sequentially(assemble(scene), Drive.YIELDING).value / scene.weight)
