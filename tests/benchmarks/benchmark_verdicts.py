"""A second opinion on the verdicts: random irregular scenes by both methods. Agreements run again with stiffer joints and lower speed.

    python tests/benchmarks/benchmark_verdicts.py [--family NAME] [--seed N] [--scenes 0-199] [--once] [--workers 2] [--try-harder]
        [--folder DIR] [--record FILE]

Scenes and seed are those of verdict_scenes.py; scenes of another seed need their own record. `--family` takes the scenes of
generated_scenes.py or unusual_scenes.py. `--once` runs every scene once. Scenes in the record are not run again; an interrupted scene
continues from the stages in its folder. `--page` writes the page from the record and runs nothing.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import json
import math
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Any

import generated_scenes
import unusual_scenes
import verdict_scenes
from growth_report import table
from marked_text import sentences
from rich.console import Console
from verdict_scenes import SCENES, SEED

from comparison.numbers import format_number, with_uncertainty
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.run_folder import write_text
from comparison.verdict import mark_of
from comparison.workflow import run_scene, try_harder
from la_core.exchange import TRAVEL_PERIODS
from la_core.scene import same_structure
from la_core.text_table import exists, number_text

GALLERY = Path(__file__).parents[2] / "comparison" / "gallery"
STIFFER, SLOWER = 4.0, 2.0  # factors of an agreement's second run: stiffness of the joints, duration of the travel
NEAR = 5e-3  # share of the reaction; a smaller difference of the methods should not be inconclusive
# Scenes of SEED whose curves have led to changes of a method or of the judge. Their later agreement proves little.
SEEN = frozenset({69, 137})
GOAL = 0.9  # share of agreements
MOST_MOVED = 0.01  # share of second runs whose reaction may move by more than both runs state
LEAST = 0.01  # share of the weight; smaller reactions count as this share
HEADINGS = ("scene", "blocks", "mu", "Coulomb R/W", "YADE R/W", "apart %", "verdict", "again: verdict", "moved / stated", "s")
OF_SECOND_RUNS = slice(7, 9)  # columns
MEANING = (
    "*Blocks*: free blocks. *Apart*: difference of YADE's value from the prediction, or from the value after a release where YADE agrees "
    "with that value. It is a share of YADE's value, or of 0.01 where that is more. *s*: seconds of the prediction and of YADE's run."
)
OF_MOVED = "*Moved / stated*: change of YADE's reaction in the second run, over the uncertainty that the first run states."


STONES = (
    "Random irregular scenes by both methods, seed {}: unequal blocks, leaning walls, inclined beds, lintels and walls of two leaves in "
    "space; supports go down, aside or turn."
)
GENERATED = (
    "Random structures of the generators by both methods, seed {}: arches of four shapes and of one or two rings, vaults, parts of domes, "
    "walls that meet at a corner or as a T, walls with an opening under a floor and sometimes with a rod, and rubble. Supports go down, "
    "aside or turn. In scenes named *pushed* a load in a nearly level direction grows, or the ground tilts, and the value is the "
    "multiplier. Vaults, domes and walls that meet may move in space."
)
UNUSUAL = (
    "Structures of the [generators](generated_verdicts.md) with unusual keys, seed {}: gravity aslant, of the moon or ten times that "
    "of the earth, insets of 0.1 to 10 mm, friction of 0.1 to 3, other friction in beds, heads or footings, a small force on every "
    "block, supports that rise, requested effects and accuracies."
)
FAMILIES = {  # by name: module of the scenes, introduction and end of the title of a page
    "stones": (verdict_scenes, STONES, ""),
    "generated": (generated_scenes, GENERATED, ": structures of the generators"),
    "unusual": (unusual_scenes, UNUSUAL, ": unusual keys"),
}


def measured(number: int, seed: int, folder: Path, once: bool, harder: bool, family: str = "stones") -> dict[str, Any]:
    """Return the entry of one scene: its first comparison, and the second run of an agreement or a harder attempt at another verdict."""
    scene_drawn = FAMILIES[family][0].drawn(number, seed)
    scene = scene_drawn.scene
    with Narration(Console(stderr=True, quiet=True)) as narration:
        first = run_scene(scene, folder / scene.name, narration, with_yade=True, figures=_no_figures)
        entry = {"number": number, "kind": scene_drawn.kind, "motion": scene_drawn.motion, "friction": scene.friction} | values(first)
        if first["verdict"] == "agree" and not once:
            changes = {"yade.stiffening": STIFFER * first["settings"]["stiffening"]} if first["yade"] else {}
            changes["yade.travel_periods"] = SLOWER * TRAVEL_PERIODS
            again = same_structure(scene, changes, f"{scene.name}_again")
            entry["again"] = values(run_scene(again, folder / again.name, narration, with_yade=True, figures=_no_figures))
        elif first["verdict"] != "agree" and harder and (second := try_harder(first, scene, folder, narration, with_yade=True)) is not None:
            entry["harder"] = values(second)
    return entry


def _no_figures(_: Any) -> dict[str, Any]:
    return {}


def values(summary: dict[str, Any]) -> dict[str, Any]:
    """Return the recorded values of a comparison: reactions over the weight, or multipliers."""
    coulomb, yade = summary["limit_analysis"]["coulomb"] or {}, summary["yade"] or {}
    name, weight = ("reaction", summary["weight"]) if summary["unit"] else ("multiplier", 1.0)
    shared = coulomb.get("shared_inset") or coulomb
    numbers = {
        "coulomb": shared.get(name),
        "coulomb_uncertainty": shared.get("uncertainty"),
        "yade": yade.get(name),
        "yade_uncertainty": yade.get("uncertainty"),
    }
    kept = {key: value / weight if exists(value) else None for key, value in numbers.items()}
    names = ("verdict", "reason", "next_step", "free_blocks", "unit")
    compared = [check["limit_analysis"] for check in summary["checks"] if check["name"].endswith("against prediction")]
    if summary["verdict"] == "agree" and exists(shared.get(name)) and compared not in ([], [shared[name]]):
        kept["released"] = compared[0] / weight  # where YADE's plateau agrees with the value after a release
    seconds = (coulomb.get("seconds") or 0.0) + (yade.get("seconds") or 0.0)
    return kept | {key: summary[key] for key in names} | {"yade_status": yade.get("status"), "seconds": seconds}


# --- the page ---------------------------------------------------------------------------------------------------------------------


def apart(entry: dict[str, Any]) -> float | None:
    """Return the relative difference of YADE's reaction from the value it agrees with, else from the prediction; None if undefined."""
    coulomb, yade = entry.get("released", entry["coulomb"]), entry["yade"]
    return abs(yade - coulomb) / max(abs(yade), LEAST) if exists(coulomb) and exists(yade) else None


def moved(entry: dict[str, Any], of_both: bool = False) -> float | None:
    """Return the change of YADE's reaction in the second run, over the first run's uncertainty; None where a reaction is missing.

    of_both: over the root of the sum of squares of both runs' uncertainties instead. This is the number E_n of ISO 13528.
    """
    again = entry.get("again")
    if again is None or not (exists(again["yade"]) and exists(entry["yade"])):
        return None
    change, stated = abs(again["yade"] - entry["yade"]), float(entry["yade_uncertainty"])
    stated = math.hypot(stated, again["yade_uncertainty"]) if of_both else stated
    if change == 0.0:
        return 0.0  # a support that carries nothing states no uncertainty
    return change / stated if stated > 0.0 else math.inf


def page(record: dict[str, Any]) -> str:
    """Return the page of a record."""
    entries = sorted(record["scenes"].values(), key=lambda entry: entry["number"])
    seed, family = record["seed"], record.get("family", "stones")
    module, introduction, title = FAMILIES[family]
    is_usual = seed == SEED and family == "stones"
    headings, rows = list(HEADINGS), [_row(entry) for entry in entries]
    agreements = [entry for entry in entries if not _is_open(entry)]
    repeated = sum("again" in entry for entry in agreements)
    which = "Agreements were" if repeated in (0, len(agreements)) else f"{repeated} of {len(agreements)} agreements were"
    second_runs = f"run again with joints {STIFFER:g} times stiffer and at 1/{SLOWER:g} of the speed" if repeated else "not run again"
    if not repeated:
        for columns in (headings, *rows):
            del columns[OF_SECOND_RUNS]
    options = (
        ("" if family == "stones" else f" --family {family}")
        + ("" if seed == module.SEED else f" --seed {seed} --record FILE")
        + ("" if repeated else " --once")
        + (" --try-harder" if any("harder" in entry for entry in entries) else "")
    )
    title = title if seed == module.SEED else f"{title}, seed {seed}"
    open_rows = [(f"{entry['number']}", entry["reason"], entry["next_step"], _harder(entry)) for entry in entries if _is_open(entry)]
    parts = [
        f"# A second opinion on the verdicts{title}",
        f"{introduction.format(seed)} Scenes and seed were fixed before the first run. "
        f"{which} {second_runs}. Written by `python tests/benchmarks/benchmark_verdicts.py{options}`.",
        sentences([*_conclusions(entries, module.SCENES, SEEN if is_usual else frozenset()), *record.get("since", [])]),
        " ".join([MEANING, *([OF_MOVED] if repeated else [])]),
        table(headings, rows),
        "## What stays open",
        table(("scene", "reason", "next step", "tried harder"), open_rows) if open_rows else "Nothing.",
        f"Versions: {', '.join(f'{name} {value}' for name, value in sorted(record['versions'].items()))}.",
    ]
    return "\n\n".join(parts) + "\n"


def _is_open(entry: dict[str, Any]) -> bool:
    return entry["verdict"] != "agree"


def _harder(entry: dict[str, Any]) -> str:
    return mark_of(entry["harder"]["verdict"]) if "harder" in entry else "–"


def _row(entry: dict[str, Any]) -> list[str]:
    difference, again, change, released = apart(entry), entry.get("again"), moved(entry), entry.get("released")
    return [
        f"{entry['number']} {entry['kind']}, {entry['motion']}",
        str(entry["free_blocks"]),
        format_number(entry["friction"], 3),
        with_uncertainty(entry["coulomb"], entry["coulomb_uncertainty"]) + (f"; then {number_text(released, 4)}" if released else ""),
        with_uncertainty(entry["yade"], entry["yade_uncertainty"]) if exists(entry["yade"]) else str(entry["yade_status"]),
        format_number(100.0 * difference if difference is not None else None, 2),
        mark_of(entry["verdict"]),
        mark_of(again["verdict"]) if again else "",
        format_number(change, 2) if again else "",
        format_number(entry["seconds"], 2),
    ]


def _conclusions(entries: list[dict[str, Any]], total: int, seen: frozenset[int]) -> Iterator[str]:
    """Yield the conclusions from the record as sentences. total: number of scenes; seen: scenes that led to changes of a method."""
    counts = Counter(str(entry["verdict"]) for entry in entries)
    agree = counts["agree"]
    yield f"{len(entries)} of {total} scenes: " + ", ".join(f"{count} {verdict}" for verdict, count in counts.most_common()) + "."
    yield f"{agree / len(entries):.1%} agree; the goal is {GOAL:.0%}."
    if released := [str(entry["number"]) for entry in entries if "released" in entry]:
        where = ", ".join(released)
        yield f"Scenes in which YADE comes to the prediction and then to the value of limit analysis after a release (*then*): {where}."
    unseen = [entry for entry in entries if entry["number"] not in seen]
    agreed = sum(not _is_open(entry) for entry in unseen)
    if seen:
        yield (
            f"Scenes that have led to changes of a method or of the judge prove little: {', '.join(map(str, sorted(seen)))}. "
            f"Without these {agreed} of {len(unseen)} agree."
        )
    near = [entry for entry in entries if _is_open(entry) and (difference := apart(entry)) is not None and difference <= NEAR]
    yield f"Inconclusive although the reactions agree within {NEAR:.1%}: {len(near)}."
    again = [entry for entry in entries if "again" in entry]
    if not again:
        return
    lost = [entry for entry in again if entry["again"]["verdict"] != "agree"]
    far = [entry for entry in again if (change := moved(entry)) is None or change > 1.0]
    apart_by_both = [entry for entry in again if (change := moved(entry, of_both=True)) is None or change > 1.0]
    yield f"Of {len(again)} agreements that were run again, {len(lost)} no longer agree."
    yield (
        f"In {len(far)} of them YADE's reaction moves by more than the first run states, or has no value. In {len(apart_by_both)} it moves "
        f"by more than both runs state. The measure is the number E_n (ISO 13528): the change over the root of the sum of the squares of "
        f"both uncertainties. E_n must not exceed 1. The goal for this second count is at most {MOST_MOVED:.0%}, "
        f"{math.floor(MOST_MOVED * len(again))} of them."
    )
    for name, entries_of in (("that no longer agree", lost), ("whose reaction moves by more than the first run states", far)):
        if entries_of:
            yield f"Scenes {name}: {', '.join(str(entry['number']) for entry in entries_of)}."


def main() -> None:
    """Run the scenes that the record lacks, and write record and page after every scene."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--family", choices=FAMILIES, default="stones", help="scenes (default: those of verdict_scenes.py)")
    parser.add_argument("--seed", type=int, help="seed of the scenes (default: that of their file)")
    parser.add_argument("--once", action="store_true", help="run every scene once")
    parser.add_argument("--scenes", default=f"0-{SCENES - 1}", help="numbers, such as 0-199 or 3,17")
    parser.add_argument("--workers", type=int, default=2, help="processes (default: 2)")
    parser.add_argument("--try-harder", action="store_true", help="try harder where a scene stays open")
    parser.add_argument("--folder", type=Path, help="folder of all runs (default: crosscheck-verdicts- and the seed)")
    parser.add_argument("--record", type=Path, help="the record; the page lies beside it (default: verdicts.json of the gallery)")
    parser.add_argument("--page", action="store_true", help="write the page alone")
    options = parser.parse_args()
    module, *_ = FAMILIES[options.family]
    options.seed = module.SEED if options.seed is None else options.seed
    options.record = options.record or GALLERY / f"{'' if options.family == 'stones' else f'{options.family}_'}verdicts.json"
    stored = json.loads(options.record.read_text(encoding="utf-8")) if options.record.exists() else {}
    held = stored.get("family", "stones") if stored else options.family
    record = {"seed": options.seed, "versions": {}, "scenes": {}} | stored | {"family": held}
    if record["seed"] != options.seed and not options.page:
        parser.error(f"{options.record} holds scenes of seed {record['seed']}, not of {options.seed}; name another file with --record")
    if held != options.family and not options.page:
        parser.error(f"{options.record} holds scenes of the family {held}, not of {options.family}; name another file with --record")
    todo = [] if options.page else [number for number in numbers(options.scenes, module.SCENES) if str(number) not in record["scenes"]]
    folder, versions = options.folder or Path(f"crosscheck-verdicts-{options.seed}"), describe()
    with ProcessPoolExecutor(options.workers) as pool:
        jobs = {
            pool.submit(measured, number, options.seed, folder, options.once, options.try_harder, options.family): number for number in todo
        }
        for done, job in enumerate(as_completed(jobs), 1):
            if job.exception() is not None:
                pool.shutdown(wait=False, cancel_futures=True)  # else a fault would show only after all other scenes
            entry = job.result()
            record["scenes"][str(entry["number"])] = entry
            record["versions"] = {name: versions[name] for name in ("crosscheck", "python", "numpy", "machine")}
            write_text(options.record, json.dumps(record, indent=1, sort_keys=True, ensure_ascii=False) + "\n")
            write_text(options.record.with_suffix(".md"), page(record))
            print(f"{done} of {len(jobs)}: {' | '.join(_row(entry))}", flush=True)
    if record["scenes"]:
        write_text(options.record.with_suffix(".md"), page(record))


def numbers(text: str, total: int = SCENES) -> list[int]:
    """Return the numbers below `total` of a text such as "0-199" or "3,17,40-42"."""
    found = []
    for part in text.split(","):
        low, _, high = part.partition("-")
        found += range(int(low), int(high or low) + 1)
    return [number for number in dict.fromkeys(found) if 0 <= number < total]


if __name__ == "__main__":
    main()
