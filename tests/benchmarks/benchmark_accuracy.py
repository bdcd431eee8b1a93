"""Whether a bought accuracy is kept, and what it costs: every shipped scene whose value is known, and the wall, at three accuracies.

    python tests/benchmarks/benchmark_accuracy.py [-o comparison/gallery/accuracy.md] [SCENE ...]

Each row is a run of `crosscheck run SCENE --accuracy SHARE`. Errors are those of the answers against the scene's exact or published value,
and as each method estimated its own.
"""

import on_path  # noqa: F401, I001  before what it makes importable
import argparse
import tempfile
from pathlib import Path
from typing import Any

from rich.console import Console
from scenes import shipped

from comparison.judge.requested_accuracy import percent
from comparison.numbers import DASH
from comparison.progress import Narration
from comparison.provenance import describe
from comparison.workflow import one_scene
from la_core.analysis.accuracy import with_accuracy
from la_core.text_table import number_text

ACCURACIES = (0.05, 0.01, 0.002)
SCENES = (
    "two_pads", "trilith", "slab_four_corners", "flat_arch", "two_blocks", "stack_bond_wall", "arch_spreading", "arch_settling",
    "arch_diagonal", "vault_spreading", "ferris_tin_loi_1", "ferris_tin_loi_2", "wall_third",
)  # fmt: skip
COARSE = ("computed",)  # known to a per cent only: no error is told, but for arches, whose value has five digits
FIVE_DIGITS = 1e-4
HEAD = ("scene", "asked", "limit analysis: error", "estimated", "s", "YADE: error", "estimated", "s", "steps", "verdict")


def measured(name: str, accuracy: float, folder: Path, narration: Narration) -> list[str]:
    """Cells of one row."""
    scene = with_accuracy(shipped(name), accuracy)
    summary = one_scene.run_scene(scene, folder / f"{name}-{accuracy}", narration, with_yade=True)
    expected, bought, yade = scene.expected, summary["accuracy"], summary["yade"] or {}
    exact = None
    if expected is not None and (expected.kind not in COARSE or expected.tolerance <= FIVE_DIGITS):
        exact = expected.multiplier if scene.live is not None else (expected.reaction_over_weight or 0.0) * scene.weight
    answer = summary["limit_analysis"]["coulomb"] or summary["limit_analysis"]["associated"]
    found = {"limit_analysis": answer.get("shared_inset", answer)[scene.quantity], "yade": yade.get("reaction")}
    cells = [f"`{name}`", percent(accuracy)]
    for method, value in found.items():
        own: dict[str, Any] = bought.get(method) or {}
        error = percent(abs(value / exact - 1.0)) if exact and value is not None else DASH
        cells += [error, percent(own.get("error")), number_text(own.get("seconds"), 2)]
    return [*cells, number_text(yade.get("steps")) if yade.get("steps") else DASH, summary["verdict"]]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", nargs="*", default=SCENES)
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    one_scene.figures_of = lambda *results: {}  # type: ignore[assignment]  # figures are no part of what is measured
    with tempfile.TemporaryDirectory() as folder, Narration(Console(stderr=True)) as narration:
        rows = [measured(name, accuracy, Path(folder), narration) for name in options.scenes for accuracy in ACCURACIES]
    facts = ", ".join(f"{key} {value}" for key, value in describe().items() if key != "crosscheck")
    lines = [
        "# What a bought accuracy costs, and whether it is kept",
        "",
        "`python tests/benchmarks/benchmark_accuracy.py -o comparison/gallery/accuracy.md`",
        "",
    ]
    lines += [facts, "", f"| {' | '.join(HEAD)} |", "|" + "---|" * len(HEAD), *(f"| {' | '.join(row)} |" for row in rows)]
    text = "\n".join(lines) + "\n"
    print(text)
    if options.output:
        options.output.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
