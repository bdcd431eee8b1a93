"""The mistakes that a verdict notices: `.venv/bin/python tests/benchmarks/benchmark_detection.py`.

Runs random scenes by both methods, without a mistake and with each mistake of mistakes.py. The judge then compares limit analysis of the
right scene with YADE's run of the wrong scene, and limit analysis of the wrong scene with YADE's run of the right scene. Writes
comparison/gallery/detection.md and its record. Scenes in the record are not run again; `--page` writes the page from the record alone.
"""

import argparse
import dataclasses
import json
import tempfile
import tomllib
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import on_path  # noqa: F401  so that the packages are found
from growth_report import table
from mistakes import MISTAKES, with_mistake
from rich.console import Console
from runs import with_answers
from verdict_scenes import drawn

from comparison.judge import check_run
from comparison.numbers import format_number
from comparison.progress import Narration
from comparison.run_folder import write_text
from comparison.verdict import Verdict, overall
from comparison.workflow import run_scene
from comparison.yade import Results, read_results, read_run
from la_core.analysis import LimitAnalysis
from la_core.errors import SceneError
from la_core.exchange import ExchangeError
from la_core.scene import Scene, build

PAGE = Path(__file__).parents[2] / "comparison" / "gallery" / "detection.md"
SEED, SCENES = 20261132, 30
LEAST = 0.01  # share of the weight; smaller reactions count as this share
KNOWN = 0.01  # share of the reaction; with a larger uncertainty the change by a mistake is unknown
STEPS = (0.0, 0.005, 0.01, 0.02, 0.05, np.inf)  # shares of the reaction: bounds of the classes of changes
DIGITS = 9  # decimals of a change: rounding counts a prediction that is 1 % too large as 1 %
TIME_LIMIT = 300.0  # s of wall time of a run in YADE
FACTORS = {f"prediction {percent} % too large": 1.0 + percent / 100.0 for percent in (1, 2, 5)}
NONE, REFUSED = "none", "refused"  # no mistake; the judge refuses to compare two structures
METHODS = ("YADE", "limit analysis")  # which method has the mistake
Entry = dict[str, Any]
HEAD = f"""# Which mistakes does a verdict notice?

A judge that always agrees would pass every test in which both methods are right. Here one of them is wrong. Limit analysis answers a random
scene, and YADE runs the same scene with one mistake; then YADE runs the right scene, and limit analysis has the mistake. The judge
compares the two as if there were no mistake. The table counts verdicts by the change of the reaction that the mistake causes: the
difference of the predictions of limit analysis with and without the mistake. A mistake that changes the reaction by less than 0.5 % is
within the tolerance.

Written by `python tests/benchmarks/benchmark_detection.py` from {SCENES} random scenes of seed {SEED} (the scenes of
[verdicts.md](verdicts.md) with another seed). Scenes, seed and mistakes in the model were fixed before the first run, and no rule of the
judge follows from them. Where a mistake concerns one block or joint, this block or joint is drawn at random. A prediction that is too
large imitates a mistake in the method, not in the model: its value alone is changed.
"""
LEGEND = """*Disagree* or *inconclusive*: the mistake is noticed. *Refused*: the two structures have different numbers of contact
points, and the judge does not compare them. Changes are shares of the reaction, or of 1 % of the weight where that is more. Cases in which
limit analysis does not know the change to 1 % of the reaction are left out. Under the loads of the other structure YADE's forces are not in
balance. The check of YADE's own state is then *inconclusive*, because blocks that are not at rest have the same effect as a wrong model.
"""


def measured(number: int, seed: int, folder: Path, mistakes: Sequence[str] = tuple(MISTAKES)) -> list[Entry]:
    """Run a scene and each of its mistakes by both methods, and judge every pair."""
    one = drawn(number, seed)
    tables, entries = tomllib.loads(one.scene.text), []
    right = _run(one.scene, folder / "right")
    shared = {"seed": seed, "number": number, "kind": one.kind, "motion": one.motion}
    entries.append(shared | {"mistake": NONE, "wrong": NONE, "verdict": overall(check_run(right))[0] if right.run else None})
    entries += [shared | entry for entry in _wrong_predictions(right, one.scene.weight)]
    for which, name in enumerate(MISTAKES):
        if name not in mistakes:
            continue
        random = np.random.default_rng((seed, number, which))
        try:
            scene = build(with_mistake(name, tables, one.scene, random), f"mistake_{which}")
            wrong = _run(scene, folder / scene.name)
        except SceneError as error:  # a mistake that the program refuses
            reason = str(error).replace(f"{Path.cwd()}/", "")
            entries.append(shared | {"mistake": name, "wrong": "both", "verdict": REFUSED, "reason": reason})
            continue
        values = {key: _prediction(it.analysis, one.scene.weight) for key, it in (("right_value", right), ("wrong_value", wrong))}
        for method, (analysis, run_folder) in zip(
            METHODS, ((right.analysis, folder / scene.name), (wrong.analysis, folder / "right")), strict=True
        ):
            entries.append(shared | values | {"mistake": name, "wrong": method} | _judged(analysis, run_folder))
    return entries


def _run(scene: Scene, folder: Path) -> Results:
    with Narration(Console(stderr=True, quiet=True)) as narration:
        run_scene(scene, folder, narration, with_yade=True, time_limit=TIME_LIMIT, figures=lambda _: {})
    return read_results(folder)


def _wrong_predictions(right: Results, weight: float) -> Iterator[Entry]:
    """Yield the verdicts on predictions that are too large. The value alone is wrong: the method errs, and the model is right."""
    coulomb, value = right.analysis.coulomb, _prediction(right.analysis, weight)
    for name, factor in FACTORS.items() if coulomb and value and right.run else ():
        wrong = with_answers(right.analysis, coulomb=dataclasses.replace(coulomb, value=factor * coulomb.value))
        values = {"right_value": value, "wrong_value": _prediction(wrong, weight)}
        yield values | {"mistake": name, "wrong": METHODS[1]} | _verdict(Results(wrong, right.run))


def _judged(analysis: LimitAnalysis, folder: Path) -> Entry:
    """Return the verdict on limit analysis of one scene and YADE's run of another scene, and the first check that decides it."""
    try:
        run = read_run(folder / "run.h5", analysis.assembly)
    except ExchangeError as error:
        return {"verdict": REFUSED, "reason": str(error).split(": ", 1)[-1]}
    return _verdict(Results(analysis, run))


def _verdict(results: Results) -> Entry:
    """Return the verdict, and the first check that decides it."""
    checks = check_run(results)
    verdict = overall(checks)[0]
    return {"verdict": verdict, "check": next((check.name for check in checks if check.verdict is verdict), "")}


def _prediction(analysis: LimitAnalysis, weight: float) -> list[float] | None:
    """Return value and uncertainty over the weight of the right scene; None where unknown."""
    answer = analysis.coulomb
    if answer is None or not np.isfinite([answer.value, answer.uncertainty]).all():
        return None
    return [answer.value / weight, answer.uncertainty / weight]


def change(entry: Entry) -> float | None:
    """Return the relative change of the reaction by the mistake; None where a prediction is missing or its uncertainty exceeds KNOWN."""
    right, wrong = entry.get("right_value"), entry.get("wrong_value")
    if not (right and wrong):
        return None
    size = max(abs(right[0]), LEAST)
    return None if right[1] + wrong[1] > KNOWN * size else round(abs(wrong[0] - right[0]) / size, DIGITS)


def counts(entries: list[Entry]) -> list[str]:
    """Return the counts of verdicts by class of change, each as "disagree / inconclusive / agree"."""
    cells = []
    for low, high in pairwise(STEPS):
        found = Counter(str(entry["verdict"]) for entry in entries if (size := change(entry)) is not None and low <= size < high)
        noticed = found[Verdict.DISAGREE.value] + found[REFUSED]
        cells.append(f"{noticed} / {found[Verdict.INCONCLUSIVE.value]} / {found[Verdict.AGREE.value]}" if found else "–")
    return cells


def page(entries: list[Entry]) -> str:
    """Return the page: the findings, a row for each mistake, and the large mistakes that passed."""
    plain = [entry for entry in entries if entry["mistake"] == NONE]
    pairs = sum(entry["wrong"] in METHODS for entry in entries)
    wrong = [entry for entry in entries if change(entry) is not None]
    passed = sorted((entry for entry in wrong if entry["verdict"] == "agree" and change(entry) >= STEPS[1]), key=change, reverse=True)
    percents = [f"{100 * step:g}" for step in STEPS[:-1]]
    classes = [f"{low} to {high} %" for low, high in pairwise(percents)] + [f"{percents[-1]} % and more"]
    rows = [[name, *counts([entry for entry in wrong if entry["mistake"] == name])] for name in (*MISTAKES, *FACTORS)]
    rows += [[f"all, in {method}", *counts([entry for entry in wrong if entry["wrong"] == method])] for method in METHODS]
    large = [entry for entry in wrong if change(entry) >= STEPS[3]]
    by_both = Counter(str(entry["verdict"]) for entry in large)
    checks = {
        verdict: ", ".join(
            f"{name} ({count})" for name, count in Counter(e["check"] for e in wrong if e["verdict"] == verdict).most_common()
        )
        for verdict in ("disagree", "inconclusive")
    }
    none = Counter(str(entry["verdict"]) for entry in plain)
    found = [
        f"- Without a mistake: {', '.join(f'{count} {verdict}' for verdict, count in none.most_common())}.",
        f"- Limit analysis knows the change for {len(wrong)} of {pairs} pairs of a right and a wrong method.",
        f"- Of the {len(large)} pairs whose mistake changes the reaction by 2 % or more, {len(large) - by_both['agree']} are noticed "
        f"({', '.join(f'{count} {verdict}' for verdict, count in by_both.most_common())}).",
        *(f"- The first check that says *{verdict}*, with the number of pairs: {names}." for verdict, names in checks.items()),
    ]
    parts = [HEAD.rstrip("\n"), "\n".join(found), "Disagree or refused / inconclusive / agree, by change of the reaction:"]
    parts += [table(("mistake", *classes), rows), LEGEND.rstrip("\n")]
    if passed:
        cells = [
            (
                f"{entry['number']}, {entry['kind']}, {entry['motion']}",
                entry["mistake"],
                entry["wrong"],
                format_number(100.0 * float(change(entry) or 0.0), 2),
            )
            for entry in passed
        ]
        parts += ["## Mistakes of 0.5 % and more that pass", table(("scene", "mistake", "in", "change %"), cells)]
    return "\n\n".join(parts) + "\n"


def main() -> None:
    """Run the scenes that the record lacks, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=int, default=SCENES, help="number of scenes (default: %(default)s)")
    parser.add_argument("--workers", type=int, default=1, help="processes (default: %(default)s)")
    parser.add_argument("--page", action="store_true", help="write the page alone")
    options = parser.parse_args()
    record = PAGE.with_suffix(".json")
    entries: list[Entry] = json.loads(record.read_text(encoding="utf-8")) if record.is_file() else []
    missing = sorted(set(range(options.scenes)) - {entry["number"] for entry in entries})
    if missing and not options.page:
        with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor(options.workers) as pool:
            runs = [pool.submit(measured, number, SEED, Path(folder) / f"scene_{number}") for number in missing]
            for done, future in enumerate(as_completed(runs), start=1):
                entries = sorted([*entries, *future.result()], key=lambda entry: entry["number"])
                write_text(record, "[\n" + ",\n".join(json.dumps(entry) for entry in entries) + "\n]\n")
                print(f"{done} of {len(missing)}", flush=True)
    write_text(PAGE, page(entries))


if __name__ == "__main__":
    main()
