"""Growth of time and memory with the number of blocks: limit analysis, associated and Coulomb, and YADE, in the plane and in 3D.

    python tests/benchmarks/benchmark_growth.py -o comparison/gallery [--quick] [--resume] [--methods NAME ...] [--before RECORD VERSION]

The structures are running-bond walls with as many courses as blocks per course. A third of the base settles. All blocks are modelled:
bounds leave no block out, and the predictions of a whole analysis ("all of Coulomb") have fewer than 100 blocks beyond the reach, too few
to be left out. Each size runs in its own process, small sizes first. Writes growth.json after every size, and growth.md and growth.png at
the end or when interrupted. --resume measures the sizes that growth.json lacks. --before adds the measurements that an earlier version
made of itself, and the page shows both. Times are CPU seconds, the best of several where one is quick. build: scene, contacts, assembly,
matrices; solver: set-up and solution of cone programmes, and steps of the paths; rest: evidence and all else.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import argparse
import json
import os
import tempfile
import time
from collections import Counter
from pathlib import Path
from subprocess import TimeoutExpired
from statistics import median
from typing import Any

import benchmark_effects as effects
import benchmark_scale as scale
import growth_report as report
import scenes
from marked_text import marked
from process_memory import peak_memory

from comparison import provenance
from comparison.figures import save
from comparison.yade import installation
from la_core.analysis import one_pass, stage
from la_core.analysis.case_file import write_case
from la_core.coulomb import interval, predict
from la_core.coulomb.path import elastic_joints, quasi_static_path, rest, tangent
from la_core.limit import associated, conic
from la_core.limit.problem import Drive
from la_core.model import assembly, joints
from la_core.scene.scene import Scene

SIZES: dict[tuple[str, str], tuple[int, ...]] = {
    ("associated", "plane"): (60, 120, 250, 500, 1000, 2000, 5000),
    ("associated", "3D"): (60, 120, 250, 500, 1000, 2000),
    ("Coulomb", "plane"): (60, 120, 250, 500, 1000),
    ("Coulomb", "3D"): (60, 120, 250, 500),
    ("all of associated", "plane"): (120, 250, 500, 1000, 2000),
    ("all of associated", "3D"): (120, 250, 500, 1000),
    ("all of Coulomb", "plane"): (60, 120, 250),
    ("all of Coulomb", "3D"): (60, 120),
    ("step", "plane"): (20, 60, 120, 250, 500),
    ("step", "3D"): (20, 60, 120, 250, 500),
    ("YADE", "plane"): (20, 60, 120, 250),
    ("YADE", "3D"): (20, 60, 120, 250),
}
OVERHEAD_SCENES = {"arch_spreading": "plane", "wall_third": "plane", "corner_settling_end": "3D"}
QUICK = 130  # blocks of the largest size, with --quick
DRIVER_ORDER = 100  # size by which the driver's measurements are sorted among the others
ROUNDS = 2  # each round: a run with the driver and a run without it
REPEATS, ENOUGH = 5, 2.0  # times one size is solved; seconds after which it is not solved again
STEPS = 100_000  # number of timed steps of YADE times number of blocks
SOLVER = {
    "conversion": (conic.Programme, "__init__"),
    "solve": (conic.Programme, "solve"),
    "steps to rest": (rest, "advance"),
    "steps": (quasi_static_path, "advance"),
}
BUILD = {
    "scene": (scenes, "build"),
    "assembly": (assembly, "assemble"),
    "bound's matrices": (associated, "scaled_problem"),
    "elastic matrices": (elastic_joints.ElasticJoints, "__init__"),
    "tangent's pattern": (tangent.Tangent, "__init__"),
    "interval's matrices": (interval, "scaled_problem"),
    "stiffness": (joints, "joint_stiffness"),
    "model of an analysis": (stage, "structural_model"),
    "matrices of an analysis": (one_pass, "scaled_problem"),
}
FIGURE = "![Growth of time and memory with the number of blocks](growth.png)"
PROTOCOL_COST = Path(__file__).parent / "yade_protocol_cost.py"


def one_answer(method: str, plane: bool, size: int) -> dict[str, Any]:
    """Solve one wall by limit analysis: the least reaction by the associated law and, for "Coulomb", also the prediction."""
    scene = scale.wall(size, plane)
    model = assembly.assemble(scene)
    bound = associated.solve_associated(model, Drive.YIELDING)
    if method == "associated":
        return {"blocks": len(model.blocks), "status": bound.status.value, "iterations": bound.iterations}
    answer = predict(model, joints.joint_stiffness(model, scene.yade), bound)
    return {"blocks": len(model.blocks), "status": answer.status.value, "iterations": answer.iterations}


def whole_analysis(method: str, plane: bool, size: int) -> dict[str, Any]:
    """Run the program's limit analysis of one wall: both bounds, with inset and sharp, and both predictions where friction needs them."""
    scene = scale.wall(size, plane, model=method.removeprefix("all of ").casefold())
    analysis = stage.analyse(scene)
    return {"blocks": len(scene.blocks), "status": (analysis.coulomb or analysis.bounds[analysis.main]).status.value}


def measure(method: str, plane: bool, size: int) -> dict[str, Any]:
    """Return seconds by part and peak memory of limit analysis, from the fastest of several solutions."""
    before, best = peak_memory(), None
    work, totals = whole_analysis if method.startswith("all of") else one_answer, []
    while len(totals) < REPEATS and sum(totals) <= ENOUGH:
        spent: Counter = Counter(dict.fromkeys({**SOLVER, **BUILD}, 0.0))
        start = time.process_time()
        with scale.patched({**SOLVER, **BUILD}, spent):
            found = work(method, plane, size)
        totals.append(time.process_time() - start)
        solver, build = (sum(spent[name] for name in part) for part in (SOLVER, BUILD))
        if totals[-1] == min(totals):
            best = found | {"seconds": totals[-1], "build": build, "solver": solver, "rest": totals[-1] - build - solver}
    assert best is not None
    return best | {"outside": 1.0 - best["solver"] / best["seconds"], "peak": peak_memory(), "memory": peak_memory() - before}


def written(scene: Scene, folder: Path) -> Path:
    """Write case.h5 of a scene and return its path."""
    write_case(folder / "case.h5", stage.analyse(scene), "growth")
    return folder / "case.h5"


def yade_step(plane: bool, size: int, folder: Path) -> dict[str, Any]:
    """Return the cost of one step of the settlement, ms."""
    found = effects.in_yade(effects.COST, written(scale.wall(size, plane, reach=False), folder), max(200, STEPS // size))
    return {name: found[name] for name in ("blocks", "spheres", "build")} | {"step": 1e3 * found["step"]}


def yade_verdict(plane: bool, size: int, folder: Path) -> dict[str, Any]:
    """Return the cost of a whole run to its plateau. The seconds are those of the whole process."""
    found = effects.in_yade(PROTOCOL_COST, written(scale.wall(size, plane, reach=False), folder), "--verdict")
    kept = {name: found[name] for name in ("blocks", "steps", "status")}
    run, watching = found["protocol"][0], found["watching"][0]
    memory = {"peak": found["memory"], "memory": found["memory"] - found["memory_before"]}
    return kept | memory | {"seconds": found["total"], "run": run, "watched": watching / run}


def overhead(name: str, folder: Path) -> dict[str, Any]:
    """Compare the driver with a bare loop of as many steps over the same bodies, in turn in one process."""
    found = effects.in_yade(PROTOCOL_COST, written(scenes.shipped(name), folder), "--rounds", ROUNDS)
    bare = found["bare"]
    over = [with_driver / without - 1.0 for with_driver, without in zip(found["protocol"][1:], bare, strict=True)]
    row = (median(found["protocol"][1:]) - median(bare)) / found["rows"]
    spread = {"overhead": median(over), "least": min(over), "most": max(over)}
    counts = {name: found[name] for name in ("blocks", "steps", "rows", "poses")}
    constant = median(found["protocol"][1:]) / median(found["constant"]) - 1.0
    return (
        counts
        | spread
        | {"bare": median(bare), "constant": constant, "watched": median(found["watching"][1:]) / median(bare), "row": 1e3 * row}
    )


def taken(method: str, dimension: str, size: int) -> dict[str, Any]:
    """Return the measurement of one entry."""
    with tempfile.TemporaryDirectory() as folder:
        if method == "driver":
            return overhead(dimension, Path(folder))
        if method in ("step", "YADE"):
            try:
                return (yade_step if method == "step" else yade_verdict)(dimension == "plane", size, Path(folder))
            except TimeoutExpired as late:
                blocks = len(scale.wall(size, dimension == "plane").blocks)
                return {"blocks": blocks, "status": f"not after {late.timeout:g} s"}
        found: Any = scale.alone(measure, method, dimension == "plane", size)
        return dict(found)


def markdown(record: dict[str, Any]) -> str:
    """Return the page of a record: conclusions, exponents, an earlier version, the measurements, and the driver's overhead."""
    measured, machine = record["measured"], record["machine"]
    series = by_series(measured)
    command = __doc__.split("\n\n")[1].strip()
    sections = ["# Growth with the number of blocks", report.INTRODUCTION, f"`{command}`", machine, FIGURE]
    sections += [marked("conclusions", report.conclusions(measured))]
    answers = {key: series[key] for key in series if key[0] in ("associated", "Coulomb")}
    analyses = {key: series[key] for key in series if key[0].startswith("all of")}
    steps, verdicts = ({key: series[key] for key in series if key[0] == name} for name in ("step", "YADE"))
    quantities = ("seconds", "build", "solver", "rest", "memory", "steps", "step")
    sections += ["## Exponents b of N^b, with standard errors", report.exponents(answers | analyses | steps | verdicts, quantities)]
    if before := record.get("before"):
        beside = report.beside(before["measured"], measured, before["version"])
        sections += [f"## Version {before['version']} beside today's", report.BESIDE, beside]
    parts = ("blocks", "status", "seconds", "build", "solver", "rest", "outside", "memory", "peak")
    heads = ("method", "model", *parts[:-3], "outside the solver", "MiB", "peak MiB")
    rows = [[*key, *(share(one, part) for part in parts)] for key, many in (answers | analyses).items() for one in many]
    sections += ["## Limit analysis; MiB: above what Python and its libraries take", report.table(heads, rows)]
    rows = [[*key, *(one.get(part) for part in ("blocks", "spheres", "build", "step"))] for key, many in steps.items() for one in many]
    sections += ["## YADE: a step of the settlement", report.table(("", "model", "blocks", "spheres", "build s", "ms a step"), rows)]
    parts = ("blocks", "status", "steps", "seconds", "watched", "memory", "peak")
    heads = ("", "model", "blocks", "status", "steps", "seconds", "inside the driver", "MiB", "peak MiB")
    rows = [[*key, *(share(one, part) for part in parts)] for key, many in verdicts.items() for one in many]
    sections += ["## YADE: a verdict, from loading YADE to the plateau", report.table(heads, rows)]
    parts = ("blocks", "steps", "rows", "poses", "bare", "overhead", "least", "most", "constant", "watched", "row")
    heads = ("scene", "blocks", "steps", "rows", "states", "bare loop s", "overhead", "least", "most", "over one at constant speed")
    heads += ("inside the driver", "ms a row")
    rows = [[one["dimension"], *(share(one, part) for part in parts)] for one in measured if one["method"] == "driver"]
    sections += [
        "## The driver compared with a bare loop of YADE over the same bodies, with the same motion of the support",
        report.table(heads, rows),
    ]
    return "\n\n".join(sections) + "\n"


def share(one: dict[str, Any], part: str) -> Any:
    """Return a part of a measurement for the page, shares in per cent."""
    value = one.get(part)
    return f"{value:.1%}" if part in ("outside", "watched", "overhead", "least", "most", "constant") and value is not None else value


def by_series(measured: list[dict[str, Any]]) -> dict[tuple[str, str], list[dict[str, Any]]]:
    """Return the measurements by method and dimension, in the order of SIZES."""
    found: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for key in SIZES:
        mine = sorted((one for one in measured if (one["method"], one["dimension"]) == key), key=lambda one: one["blocks"])
        found |= {key: mine} if mine else {}
    return found


def this_machine() -> str:
    """Return machine and versions in a line."""
    made = provenance.describe() | {"YADE": installation.find_yade().version}
    return f"{made.pop('machine')}; " + ", ".join(f"{name} {version}" for name, version in made.items())


def stored(folder: Path) -> dict[str, Any]:
    """Return the record in a folder; an empty one if there is no file."""
    path = folder / "growth.json"
    return dict(json.loads(path.read_text(encoding="utf-8"))) if path.exists() else {}


def store(record: dict[str, Any], folder: Path) -> None:
    """Write the record of the measurements."""
    (folder / "growth.json").write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")


def stored_page(folder: Path) -> str:
    """Return the page of the stored record. Nothing is measured."""
    return markdown(stored(folder))


def write(record: dict[str, Any], folder: Path) -> None:
    """Write the page and the figure of a record."""
    (folder / "growth.md").write_text(markdown(record), encoding="utf-8")
    series = by_series(record["measured"])
    answers = {key: many for key, many in series.items() if key[0] in ("associated", "Coulomb", "YADE")}
    steps = {("YADE", key[1]): many for key, many in series.items() if key[0] == "step"}
    panels = {
        "CPU time of an answer (s)": ("seconds", answers),
        "CPU time of a step of YADE (ms)": ("step", steps),
        "peak memory above that of the libraries (MiB)": ("memory", answers),
    }
    save(report.growth_figure(panels), folder / "growth.png")


def main() -> None:
    os.environ["OMP_NUM_THREADS"] = "1"  # for the processes started here, because idle threads would count as work
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--quick", action="store_true", help=f"no more than {QUICK} blocks")
    names = list(dict.fromkeys([method for method, _ in SIZES] + ["driver"]))
    parser.add_argument("--methods", nargs="+", choices=names, default=names, metavar="NAME", help=f"of {', '.join(names)}")
    parser.add_argument("--resume", action="store_true", help="measure only what growth.json lacks")
    parser.add_argument(
        "--before",
        nargs=2,
        metavar=("RECORD", "VERSION"),
        help="growth.json of an earlier version, made on this machine within the hour, and its name",
    )
    options = parser.parse_args()
    earlier = stored(options.output)
    record = {"machine": this_machine(), "measured": earlier.get("measured", []) if options.resume else []}
    if options.before:
        path, version = options.before
        record["before"] = {"version": version, "measured": json.loads(Path(path).read_text(encoding="utf-8"))["measured"]}
    elif "before" in earlier:
        record["before"] = earlier["before"]
    measured = record["measured"]
    asked = [(method, dimension, size) for (method, dimension), sizes in SIZES.items() for size in sizes]
    asked += [("driver", name, DRIVER_ORDER) for name in OVERHEAD_SCENES]
    try:
        for method, dimension, size in sorted(asked, key=lambda one: one[2]):  # an interrupted run then has all smaller sizes
            key = {"method": method, "dimension": dimension, "asked": size}
            wanted = method in options.methods and not (options.quick and size > QUICK)
            if wanted and not any(key.items() <= one.items() for one in measured):
                began = time.monotonic()
                measured.append(key | taken(method, dimension, size))
                print(f"{method}, {dimension}, {size}: {time.monotonic() - began:.0f} s", flush=True)
                store(record, options.output)
    finally:
        store(record, options.output)
        write(record, options.output)


if __name__ == "__main__":
    main()
