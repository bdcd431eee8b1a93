"""Runs shipped scenes by both methods, with the reduced and the full model, and writes the results as the page results.md.

    .venv/bin/python tests/benchmarks/results_page.py [SCENE ...]
    .venv/bin/python tests/benchmarks/results_page.py --limit-analysis [SCENE ...]
    .venv/bin/python tests/benchmarks/results_page.py --write

Without names all shipped scenes except the long ones are run. Results are kept in results.json; a scene that is not run keeps its entry.
--limit-analysis runs limit analysis alone and keeps the recorded values and verdicts of YADE.
--write runs nothing: it writes results.md, and the tables in friction.md and effects.md that come from the same record.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import tempfile
from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import Any

from marked_text import listed, sentences, span, with_part
from results_record import FRICTION_WALLS, RECORD, measured, read_record, with_limit_analysis, write_record
from rich.console import Console

from comparison.judge import UNCERTAIN
from comparison.judge.effects_table import EFFECTS
from comparison.numbers import percent
from comparison.numbers import with_uncertainty
from comparison.progress import Narration
from comparison import figures
from la_core.scene import load_scene, shipped
from la_core.text_table import number_text

Entry = dict[str, Any]
GALLERY = RECORD.parent
BUILDING = "building_corner"
WIDTH = 140  # of a line of text on a page
USUAL = 30.0  # s, assumed for a scene without an entry
LEFT_OUT = {"plane": "plane", "friction": "sliding", "reach": "reach", "displacement": "new contacts", "recording": "states"}
RESULTS_HEAD = (
    "scene", "R_min/W", "Coulomb R/W", "its interval", "R_max/W", "its uncertainty", "YADE R/W", "verdict", "iterations", "LA s", "YADE s",
)  # fmt: skip
FULL_HEAD = (
    "scene", "left out", "Coulomb R/W", "with everything", "YADE R/W", "with everything", "verdict", "LA s", "with everything", "YADE s",
    "with everything",
)  # fmt: skip
FRICTION_HEAD = ("wall of 10 courses x 6, mu", "settling", "R_min/W", "Coulomb R/W", "interval", "classic iteration", "YADE")
SETTLING = {"wall_third": "right third", "wall_half": "right half", "wall_low_friction": "right third"}
INTRODUCTION = """\
# Results: every shipped scene by both methods

Each row is one shipped scene, run by `crosscheck run SCENE`: the reaction R of the settling support over the weight W of the free blocks
(or the multiplier of a live load) by limit analysis and by YADE. *agree* means that all checks passed; YADE's value should lie between
the bounds *R_min* and *R_max*, and be equal to the Coulomb prediction.

```console
$ .venv/bin/python tests/benchmarks/results_page.py
```

The columns:

- *R_min*, *R_max*: bounds of associated limit analysis. Under a live load there is only an upper bound, in the column *R_max*.
- *Coulomb*: the prediction for friction without dilatancy. *its interval*: the values that the predicted mechanism allows, whatever
  friction's history was.
- *its uncertainty*: the uncertainty of the prediction that limit analysis states before YADE runs. All values are for the scene's inset.
- *YADE R/W*: the plateau with its uncertainty, which is the sum of its parts.
- *iterations*: Newton iterations of all paths, or of the search for sliding joints. *LA s*: seconds of the solver for the whole limit
  analysis. *YADE s*: seconds of one run on one core. Seconds are by the clock. Where other work ran on the machine, they are up to
  a few times too long.
"""
FULL_INTRODUCTION = """\
## Reduced and full model

`crosscheck run` leaves out effects that a scene does not need: motion out of the plane, sliding, new contacts
([effects.md](effects.md)). This table compares each scene with its full model, *with everything* (`crosscheck run --full SCENE`): in space,
with friction, all blocks and new contacts.
"""


def page(entries: dict[str, Entry]) -> str:
    """Return the page as Markdown."""
    both = {name: entry for name, entry in entries.items() if name not in shipped.LONG}
    parts = [INTRODUCTION, _origins(entries), _table(RESULTS_HEAD, [_results_row(name, entry) for name, entry in entries.items()]) + "\n"]
    parts += [_conclusions(entries) + "\n", _figures(entries), FULL_INTRODUCTION]
    parts += [_table(FULL_HEAD, [_full_row(name, entry) for name, entry in both.items()]) + "\n", _full_conclusions(both) + "\n"]
    return "\n".join([*parts, _whole_building(entries)]).rstrip("\n") + "\n"


def other_pages(entries: dict[str, Entry], folder: Path = GALLERY) -> dict[str, str]:
    """Return the text of the pages with a part from the same record, by file name."""
    parts = {"friction.md": ("walls", friction_table(entries)), "effects.md": ("shipped scenes", left_out_list(entries))}
    return {name: with_part((folder / name).read_text(encoding="utf-8"), *part) for name, part in parts.items()}


def _table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    return "\n".join(f"| {' | '.join(row)} |" if k != 1 else "|" + "---|" * len(head) for k, row in enumerate([head, head, *rows]))


def _results_row(name: str, entry: Entry) -> list[str]:
    model = entry["reduced"]
    times = [f"{model['solves']}", *(number_text(model[f"{method}_seconds"], 2) for method in ("limit_analysis", "yade"))]
    bounds = {key: value_cell(model, key) for key in ("least", "predicted", "interval", "greatest")}
    if name in shipped.names() and shipped.load(name).live is not None:  # its associated value is an upper bound
        bounds |= {"least": number_text(None, 5), "greatest": bounds["least"]}
    return [f"`{name}`", *bounds.values(),
            number_text(model["stated"], 2), yade_cell(model),
            model["verdict"], *times]  # fmt: skip


def value_cell(model: Entry, key: str, places: int | None = None) -> str:
    """Return a value or the interval as text, with five significant digits or with `places` decimal places."""
    values = model[key] if isinstance(model[key], list) else [model[key]]
    return " to ".join(number_text(value, 5) if places is None else f"{value:.{places}f}" for value in values)


def yade_cell(model: Entry) -> str:
    """Return YADE's reaction with its uncertainty, or the status of a run without a plateau; a dash where YADE was not run."""
    if model["yade_status"] not in (None, "plateau"):
        return str(model["yade_status"])
    return with_uncertainty(model["yade"], model["uncertainty"])


def words_of_left_out(entry: Entry) -> str:
    """Return the effects that the reduced model leaves out, in words."""
    return ", ".join(LEFT_OUT[effect] for effect in entry["left_out"] if effect in LEFT_OUT) or "nothing"


def _full_row(name: str, entry: Entry) -> list[str]:
    models = [entry["reduced"], entry["full"]]
    seconds = [number_text(model[f"{method}_seconds"], 2) for method in ("limit_analysis", "yade") for model in models]
    verdicts = dict.fromkeys(model["verdict"] for model in models)
    return [f"`{name}`", words_of_left_out(entry), *(value_cell(model, "predicted") for model in models), *map(yade_cell, models),
            ", with everything ".join(verdicts), *seconds]  # fmt: skip


def _origins(entries: dict[str, Entry]) -> str:
    """State machine and versions, and the scenes that were made on others."""
    made: dict[str, list[str]] = {}
    for name, entry in entries.items():
        known = dict(entry["versions"])
        words = f"{known.pop('machine')}; " + ", ".join(f"{package} {version}" for package, version in known.items())
        made.setdefault(words + (f" (from the {entry['source']})" if "source" in entry else ""), []).append(name)
    most = max(made, key=lambda words: len(made[words]))
    others = [f"{listed([f'`{name}`' for name in names])}: {words}." for words, names in made.items() if words != most]
    kept = [f"`{name}`" for name, entry in entries.items() if entry.get("yade_before")]
    if kept:
        others.append(f"Limit analysis was run again without YADE, whose values and verdicts are those of the run before: {listed(kept)}.")
    return "\n".join([f"Made on {most}.", *others]) + "\n"


def _off(model: Entry) -> float:
    """Return the difference of YADE's reaction from the prediction, relative to the prediction."""
    return float(model["yade"] / model["predicted"] - 1.0)


def _conclusions(entries: dict[str, Entry]) -> str:
    verdicts = {name: entry["reduced"]["verdict"] for name, entry in entries.items()}
    alone = {"expected": "meets its expected value without YADE"}
    others = [f"`{name}` {alone.get(verdict, f'is {verdict}')}" for name, verdict in verdicts.items() if verdict != "agree"]
    run = {name: entry["reduced"] for name, entry in entries.items() if entry["reduced"]["yade"] is not None}
    steady = {name: model for name, model in run.items() if verdicts[name] == "agree"}
    worst = max(steady, key=lambda name: abs(_off(steady[name])))
    cost = [model["yade_seconds"] / model["limit_analysis_seconds"] for model in run.values()]
    return sentences(
        [
            f"{len(entries) - len(others)} of {len(entries)} scenes agree" + (f"; {listed(others)}." if others else "."),
            f"Where they agree, YADE and the prediction differ by at most {percent(abs(_off(steady[worst])))} (`{worst}`).",
            f"YADE takes {span(cost)} times as long as limit analysis.",
        ]
    )


def _figures(entries: dict[str, Entry]) -> str:
    parts = ["![A facade whose right end settles: the mechanism by limit analysis and by YADE](facade.png)\n"]
    if BUILDING in entries:
        model, seconds = entries[BUILDING]["reduced"], entries[BUILDING]["reduced"]["yade_seconds"]
        text = (
            f"`{BUILDING}` takes {number_text(seconds / 60.0, 2)} minutes in YADE; verdict: *{model['verdict']}*. Its joints stick and "
            f"slip in YADE. Its reaction, with an uncertainty of {percent(model['uncertainty'] / model['yade'])}, "
            f"differs by {percent(abs(_off(model)))} from the prediction, "
            f"whose stated uncertainty is {percent(model['stated'] / model['predicted'])}."
        )
        if model["verdict"] == "agree" and max(model["uncertainty"] / model["yade"], model["stated"] / model["predicted"]) > UNCERTAIN:
            text += f" Uncertainties of more than {percent(UNCERTAIN)} are not added to the tolerance: the values agree within its floor."
        parts.append(fill(text, WIDTH) + "\n")
        parts.append(
            f"![A building of {entries[BUILDING]['blocks']:,} blocks whose corner settles: the mechanism by limit analysis and by YADE; "
            "grey blocks were left out](building.png)\n"
        )
    return "\n".join(parts)


def _full_conclusions(entries: dict[str, Entry]) -> str:
    pairs = {name: (entry["reduced"], entry["full"]) for name, entry in entries.items()}
    change = {name: abs(full["predicted"] / reduced["predicted"] - 1.0) for name, (reduced, full) in pairs.items()}
    run = {name: models for name, models in pairs.items() if models[0]["yade"] is not None and models[1]["yade"] is not None}
    moved = {name: abs(full["yade"] / reduced["yade"] - 1.0) for name, (reduced, full) in run.items()}
    largest, farthest = (max(found, key=lambda name: found[name]) for found in (change, moved))
    dearer = [full["limit_analysis_seconds"] / reduced["limit_analysis_seconds"] for reduced, full in pairs.values()]
    slower = [full["yade_seconds"] / reduced["yade_seconds"] for reduced, full in run.values()]
    return sentences(
        [
            f"Leaving effects out changes the prediction by at most {percent(change[largest])} (`{largest}`) and YADE's reaction by at "
            f"most {percent(moved[farthest])} (`{farthest}`).",
            f"The full model takes {span(dearer)} times the time in limit analysis and {span(slower)} times in YADE.",
        ]
    )


def _whole_building(entries: dict[str, Entry]) -> str:
    entry = entries.get(BUILDING, {})
    if "stated" not in entry.get("full", {}):
        return ""
    model = entry["full"]
    text = (
        f"`{BUILDING}` is not in this table. With all its {entry['blocks']:,} blocks "
        f"(`--full`, and `[yade]` with {model['settings']}) "
        f"the prediction took {number_text(model['limit_analysis_seconds'])} s "
        f"({number_text(model['predicted'], 3)}, stated uncertainty {percent(model['stated'] / model['predicted'])}); "
        f"after {number_text(model['yade_seconds'] / 60.0)} minutes YADE knew its reaction "
        f"to {percent(model['uncertainty'] / model['yade'])} ({number_text(model['yade'], 5)})."
    )
    return fill(text, WIDTH) + "\n"


def friction_table(entries: dict[str, Entry]) -> str:
    """Return the table of bound, prediction, interval, classic iteration and YADE on three walls."""
    rows = []
    for name in FRICTION_WALLS:
        entry = entries[name]
        model, friction = entry["reduced"], load_scene(shipped.find(name)).friction
        values = [value_cell(model, key, 4) for key in ("least", "predicted", "interval")]
        rows.append([number_text(friction), SETTLING[name], *values, f"{entry['classic']:.4f}", yade_cell(model)])
    return _table(FRICTION_HEAD, rows)


def left_out_list(entries: dict[str, Entry]) -> str:
    """State the number of shipped scenes that leave out each effect."""
    scenes = {effect: [name for name, entry in entries.items() if effect in entry["left_out"]] for effect in EFFECTS}
    return sentences([f"`{effect}`: left out in {len(names)} of {len(entries)} shipped scenes." for effect, names in scenes.items()])


def run_limit_analysis(names: Sequence[str], folder: Path) -> None:
    """Run limit analysis of the scenes alone, and store each as soon as it is done."""
    entries = read_record()
    figures.report_figures = lambda *results: {}  # type: ignore[assignment]  # the measured times leave out figures
    with Narration(Console(stderr=True)) as narration:
        for name in names:
            entries[name] = with_limit_analysis(entries[name], name, folder, narration)
            write_record(entries)


def run(names: Sequence[str], folder: Path) -> None:
    """Run the scenes, and store each as soon as it is done."""
    entries = read_record()
    figures.report_figures = lambda *results: {}  # type: ignore[assignment]  # the measured times leave out figures
    expected = {name: entries.get(name, {}).get("seconds", USUAL) for name in names}
    pace = 1.0  # seconds of this run over those of the last run
    with Narration(Console(stderr=True)) as narration:
        for k, name in enumerate(names):
            left = pace * sum(expected[later] for later in names[k:])
            narration.stage("results", f"scene {k + 1} of {len(names)}", f"{name}; about {left / 60.0:.0f} min left")
            entries[name] = measured(name, folder, narration)
            pace = sum(entries[done]["seconds"] for done in names[: k + 1]) / sum(expected[done] for done in names[: k + 1])
            write_record(entries)


def write_pages() -> None:
    """Write results.md and the parts of other pages from the record."""
    entries = read_record()
    for name, text in ({"results.md": page(entries)} | other_pages(entries)).items():
        (GALLERY / name).write_text(text, encoding="utf-8")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help="shipped scenes to run again; all but the long ones")
    parser.add_argument("--limit-analysis", action="store_true", help="run limit analysis alone, and keep the record of YADE")
    parser.add_argument("--write", action="store_true", help="run nothing, write the pages from the record")
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="folder of results to keep; what lies there is not run again")
    options = parser.parse_args()
    if not options.write:
        names = options.scenes or [name for name in shipped.names() if name not in shipped.LONG]
        with tempfile.TemporaryDirectory() as folder:
            (run_limit_analysis if options.limit_analysis else run)(names, options.output or Path(folder))
    write_pages()


if __name__ == "__main__":
    main()
