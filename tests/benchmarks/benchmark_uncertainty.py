"""Test of the stated uncertainties on irregular structures: `.venv/bin/python tests/benchmarks/benchmark_uncertainty.py`.

Predicts random scenes by default and again along finer paths, and writes comparison/gallery/uncertainty.md and its record. Scenes in the
record are not predicted again; `--page` writes the page from the record alone.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import numpy as np
import on_path  # noqa: F401  so that the packages are found
from growth_report import table
from verdict_scenes import KINDS, SCENES, drawn

from comparison.numbers import format_number, with_uncertainty
from comparison.run_folder import write_text
from la_core.analysis import AnalysisSettings, analyse
from la_core.coulomb import CoulombSolution, PredictionSettings

PAGE = Path(__file__).parents[2] / "comparison" / "gallery" / "uncertainty.md"
SEEDS = (20261129, 20261130, 20261131)
# Divisors of the limits of a step on the reference paths: for a prediction with two paths, and for a prediction with a third path, which
# has finer steps itself.
FINER, FINEST = 3.0, 10.0
EFFORT = 5.0 * PredictionSettings.effort
OF_TWO, OF_THREE = PredictionSettings((1e-3, 1e-4), FINER, EFFORT), PredictionSettings((1e-4, 1e-5), FINEST, EFFORT)  # references
LEAST = 0.01  # share of the weight; smaller reactions count as this share
FLOOR = 1e-5  # share of the weight; smaller differences count as none
SAME = 1e-9  # share of the weight; values that differ by less count as equal
KNOWN = 1e-2  # share of the reaction: largest uncertainty with which the judge decides
Entry = dict[str, Any]
HEAD = f"""# Does the stated uncertainty hold?

Every prediction states its uncertainty before YADE runs, from its own paths alone. Here irregular random scenes test it: unequal blocks,
leaning walls, inclined beds, lintels and walls of two leaves in space, whose supports go down, aside or turn. Another page has
a [test on regular walls](friction.md#the-accuracy-of-the-prediction). The reference follows paths in steps {FINER:g}
times finer, with a tenth of the viscosity. Where a prediction has a third path, the reference follows paths in steps {FINEST:g} times
finer, with a hundredth of the viscosity. Prediction and reference share model and method, which YADE tests on [other](verdicts.md)
[random](fresh_verdicts.md) [scenes](third_verdicts.md).

Written by `python tests/benchmarks/benchmark_uncertainty.py` (half an hour on one core) from scenes that had no part in any method.
"""
LEGEND = """*holds*: scenes in which prediction and reference differ by no more than the stated uncertainty, or than 1e-5 of the weight
where this is more. *worst excess*: largest ratio of the difference to the allowed one. *median stated*: median of the stated uncertainties.
*90 % within*: difference that nine scenes in ten do not exceed. Both are shares of the reaction, or of 1 % of the weight where this is
larger. *unsure*: predictions that are not solved, or that state more than 1 %, so that the judge does not decide by them. *s*,
*reference s*: seconds of limit analysis for all scenes, one after the other.
"""


def measured(number: int, seed: int) -> Entry:
    """Predict a scene by default and along finer paths. Values are over the weight."""
    one = drawn(number, seed)
    default = analyse(one.scene).coulomb
    paths = 0 if default is None else len(default.viscosities)
    answers = [default, analyse(one.scene, AnalysisSettings(prediction=OF_THREE if paths > 2 else OF_TWO)).coulomb]
    entry: Entry = {"seed": seed, "number": number, "kind": one.kind, "motion": one.motion, "paths": paths}
    return entry | {name: _values(answer, one.scene.weight) for name, answer in zip(("default", "reference"), answers, strict=True)}


def _values(answer: CoulombSolution | None, weight: float) -> Entry | None:
    """Return value, uncertainty and plateaus over the weight; None without a value."""
    if answer is None or not np.isfinite(answer.value):
        return None
    return {
        "value": answer.value / weight,
        "uncertainty": answer.uncertainty / weight,
        "plateaus": (answer.plateaus / weight).tolist(),
        "status": answer.status.value,
        "seconds": answer.seconds,
    }


def excess(entry: Entry) -> float:
    """Return the difference from the reference over the stated uncertainty, or over FLOOR where this is larger."""
    first, finer = entry["default"], entry["reference"]
    return float(abs(first["value"] - finer["value"]) / max(first["uncertainty"], FLOOR))


def share(entry: Entry, amount: float) -> float:
    """Return an amount over the reaction of the reference."""
    return float(amount / max(abs(entry["reference"]["value"]), LEAST))


def is_unsure(entry: Entry) -> bool:
    """Return True if a prediction is not solved, or too uncertain for a verdict."""
    first = entry["default"]
    return bool(first["status"] != "solved" or share(entry, first["uncertainty"]) > KNOWN)


def row(name: str, entries: list[Entry]) -> list[str]:
    """Return the row of the table for some scenes."""
    apart = [share(entry, abs(entry["default"]["value"] - entry["reference"]["value"])) for entry in entries]
    stated = [share(entry, entry["default"]["uncertainty"]) for entry in entries]
    seconds = [sum(entry[which]["seconds"] for entry in entries) for which in ("default", "reference")]
    return [
        name,
        f"{sum(excess(entry) <= 1.0 for entry in entries)} of {len(entries)}",
        format_number(max(map(excess, entries)), 2),
        f"{format_number(100.0 * float(np.median(stated)), 2)} %",
        f"{format_number(100.0 * float(np.quantile(apart, 0.9)), 2)} %",
        str(sum(map(is_unsure, entries))),
        *(format_number(value, 3) for value in seconds),
    ]


def page(entries: list[Entry]) -> str:
    """Return the page: the findings, a row for each kind of scene, and the scenes that differ by more than the stated uncertainty."""
    both = [entry for entry in entries if entry["default"] and entry["reference"]]
    beyond = sorted((entry for entry in both if excess(entry) > 1.0), key=excess, reverse=True)
    wrong = [entry for entry in beyond if share(entry, abs(entry["default"]["value"] - entry["reference"]["value"])) > KNOWN]
    holds = len(both) - len(beyond)
    same = sum(abs(entry["default"]["value"] - entry["reference"]["value"]) <= SAME for entry in both)
    headings = ("scenes", "holds", "worst excess", "median stated", "90 % within", "unsure", "s", "reference s")
    kinds = [row(kind, [entry for entry in both if entry["kind"] == kind]) for kind in KINDS]
    cells = [
        [
            f"{entry['number']} of {entry['seed']}, {entry['kind']}, {entry['motion']}",
            *(with_uncertainty(entry[which]["value"], entry[which]["uncertainty"]) for which in ("default", "reference")),
            f"{100.0 * share(entry, abs(entry['default']['value'] - entry['reference']['value'])):.2g}",
            f"{excess(entry):.2g}",
        ]
        for entry in beyond
    ]
    found = [
        f"- {len(both)} of {len(entries)} scenes have both predictions; seeds {', '.join(map(str, sorted({e['seed'] for e in entries})))}.",
        f"- The stated uncertainty holds on {holds} of them ({100.0 * holds / len(both):.3g} %); it is meant to hold on 19 scenes of 20.",
        f"- On {same} scenes both values are equal to {format_number(SAME, 1)} of the weight: the path hardly matters there. Of the other "
        f"{len(both) - same} scenes the uncertainty holds on {holds - same} ({100.0 * (holds - same) / (len(both) - same):.3g} %).",
        f"- It does not hold on {len(beyond)} scenes. On {len(wrong)} of these the difference is larger than {100 * KNOWN:g} % of the "
        "reaction.",
    ]
    parts = [HEAD.rstrip("\n"), "\n".join(found), table(headings, [*kinds, row("all", both)]), LEGEND.rstrip("\n")]
    if beyond:
        parts += ["## Where it does not hold", table(("scene", "default: R/W", "reference: R/W", "apart %", "excess"), cells)]
    return "\n\n".join(parts) + "\n"


def main() -> None:
    """Predict the scenes that the record lacks, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, nargs="+", default=SEEDS, help="seeds of the scenes (default: %(default)s)")
    parser.add_argument("--workers", type=int, default=1, help="processes (default: %(default)s)")
    parser.add_argument("--page", action="store_true", help="write the page alone")
    options = parser.parse_args()
    record = PAGE.with_suffix(".json")
    entries: list[Entry] = json.loads(record.read_text(encoding="utf-8")) if record.is_file() else []
    kept = {(entry["seed"], entry["number"]) for entry in entries}
    missing = [(number, seed) for seed in options.seeds for number in range(SCENES) if (seed, number) not in kept]
    if missing and not options.page:
        with ProcessPoolExecutor(options.workers) as pool:
            for done, future in enumerate(as_completed([pool.submit(measured, *one) for one in missing]), start=1):
                entries.append(future.result())
                print(f"{done} of {len(missing)}", flush=True)
                if done % SCENES == 0 or done == len(missing):
                    entries.sort(key=lambda entry: (entry["seed"], entry["number"]))
                    write_text(record, "[\n" + ",\n".join(json.dumps(entry) for entry in entries) + "\n]\n")
    write_text(PAGE, page(entries))


if __name__ == "__main__":
    main()
