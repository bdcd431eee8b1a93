"""Verbs and options of the command line."""

import argparse
from collections.abc import Callable
from pathlib import Path

from comparison.cli.argument_types import (
    accuracy,
    address,
    count,
    figure,
    frames_per_second,
    given_path,
    moving_picture,
    page,
    scene_file,
    seconds,
    words,
)
from comparison.cli.exit_codes import MEANINGS
from comparison.cli.guessing_parser import GuessingParser
from comparison.provenance import version
from comparison.run_folder import HEAD
from comparison.settings import HARDER_SECONDS

TUTORIALS = Path("crosscheck-tutorial")
COSTS = Path("crosscheck-cost")
SCENE_HELP = "path of a scene file, or the name of a shipped scene"
LONG_HELP = "the whole table, also where it is wider than the terminal"
NO_YADE_HELP = "run limit analysis only"
LIMIT_HELP = "wall time limit of each YADE run in seconds (default: as configured, else the scene's, or 3600)"
ACCURACY_HELP = "requested accuracy as a share of the answer, such as 1%%: start from the cheapest settings, refine if needed"
SHELLS = ("bash", "zsh", "fish")


AddVerb = Callable[[str, str], argparse.ArgumentParser]  # from a verb and its help text to the verb's parser


def parser() -> GuessingParser:
    """Return the parser of the command line.

    Parsed options hold the `verb`, and in `configured` the names of those options that the settings fill.
    """
    whole = GuessingParser(
        prog="crosscheck",
        description="Cross-checks rigid-block limit analysis and discrete elements (YADE) on masonry with a settling support.",
        epilog="Begin with `crosscheck tutorial`, six tutorials with calculations by hand, or with `crosscheck run two_pads`. "
        f"Exit codes. {' '.join(f'{code}: {meaning}.' for code, meaning in MEANINGS.items())}",
    )
    whole.add_argument("--version", action="version", version=f"crosscheck {version()}")
    verbs = whole.add_subparsers(metavar="COMMAND")

    def add(verb: str, text: str) -> argparse.ArgumentParser:
        sub = verbs.add_parser(verb, help=text, description=text)
        sub.set_defaults(verb=verb, configured=())
        sub.add_argument("-q", "--quiet", action="store_true", help="no narration on stderr")
        sub.add_argument("--json", action="store_true", help="print one JSON object on stdout, and nothing else there")
        return sub

    for add_verb in (
        _add_new,
        _add_schema,
        _add_scenes,
        _add_show,
        _add_solve,
        _add_sensitivity,
        _add_cost,
        _add_run,
        _add_campaign,
        _add_compare,
        _add_report,
        _add_export,
        _add_animate,
        _add_tutorial,
        _add_doctor,
        _add_completion,
    ):
        add_verb(add)
    return whole


def _add_new(add: AddVerb) -> None:
    new = add("new", "write a commented scene: of a kind of structure (wall, arch, building, ...), or for a drawing or a file of bodies")
    what = new.add_mutually_exclusive_group()
    what.add_argument("kind", metavar="KIND", nargs="?", help="kind of structure (default: list the kinds)")
    from_help = "in place of KIND: drawing (DXF, SVG) or bodies (OBJ, PLY, STL, JSON of COMPAS) that the scene is to read"
    what.add_argument("--from", dest="source", type=given_path, metavar="SOURCE", help=from_help)
    output_help = "scene file to write (default: KIND.toml, or SOURCE with the ending .toml)"
    new.add_argument("-o", "--output", type=scene_file, metavar="SCENE", help=output_help)


def _add_schema(add: AddVerb) -> None:
    schema = add("schema", "print the keys of scene files: as JSON Schema for editors, or those of one table as a list")
    schema.add_argument("table", metavar="TABLE", nargs="?", help="table whose keys are listed, such as wall (default: JSON Schema of all)")


def _add_scenes(add: AddVerb) -> None:
    scenes = add("scenes", "list the shipped scenes: title and expected value")
    scenes.add_argument("--long", action="store_true", help="also the kind and the source of each value")


def _add_show(add: AddVerb) -> None:
    show = add("show", "draw a scene: blocks, roles, contact points; print counts and weight")
    show.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    show.add_argument("-o", "--output", type=figure, metavar="FIG", help="PNG, SVG or PDF file to draw (default: SCENE.png)")
    show.add_argument("--long", action="store_true", help="also what each effect means, and what leaving it out saves")


def _add_solve(add: AddVerb) -> None:
    solve = add("solve", "run limit analysis only: first the bounds, then the prediction; `crosscheck run` uses this answer")
    solve.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    extent = solve.add_mutually_exclusive_group()
    extent.add_argument("--bounds", action="store_true", help="stop after the bounds, which take seconds, and store nothing")
    path_help = "also follow the reaction from rest over one travel of YADE, like a [path] table in the scene; stores nothing"
    extent.add_argument("--path", action="store_true", help=path_help)
    results_help = "folder of `crosscheck run`, where the answer is stored and found again (default: crosscheck-results, or as configured)"
    solve.add_argument("--results", type=given_path, metavar="DIR", help=results_help)
    solve.add_argument("-o", "--output", type=figure, metavar="FIG", help="draw the reaction: PNG, SVG or PDF file")
    solve.add_argument("--accuracy", type=accuracy, metavar="SHARE", help=ACCURACY_HELP)
    solve.add_argument("--long", action="store_true", help="also residuals, iterations and seconds")


def _add_sensitivity(add: AddVerb) -> None:
    study = add("sensitivity", "show how the classic iteration for friction depends on its own parameters")
    study.add_argument("scene", metavar="SCENE", help=SCENE_HELP)
    study.add_argument("-o", "--output", type=figure, metavar="FIG", help="PNG, SVG or PDF file to draw (default: SCENE-sensitivity.png)")
    study.add_argument("--long", action="store_true", help=LONG_HELP)


def _add_cost(add: AddVerb) -> None:
    cost = add("cost", "measure the cost of accuracy: error against seconds for all methods and settings, as table and figure")
    cost.add_argument("scenes", metavar="SCENE", nargs="+", help=SCENE_HELP)
    cost.set_defaults(configured=("time_limit",), time_limit=None)
    cost.add_argument(
        "-o", "--output", type=given_path, metavar="DIR", default=COSTS, help=f"folder of figures and results (default: {COSTS})"
    )
    cost.add_argument("--no-yade", action="store_true", help=NO_YADE_HELP)
    beside = "runs of YADE that go on side by side; their seconds are then those of a busier machine (default: 1)"
    cost.add_argument("--workers", type=count, metavar="N", default=1, help=beside)
    cost.add_argument("--long", action="store_true", help=LONG_HELP)


def _add_run(add: AddVerb) -> None:
    run = add("run", "run limit analysis and YADE, compare them and write the report; finished stages are not run again")
    run.add_argument("scenes", metavar="SCENE", nargs="+", help=SCENE_HELP)
    run.set_defaults(configured=("output", "time_limit"))
    output_help = "folder of the results (default: crosscheck-results, or as configured)"
    run.add_argument("-o", "--output", type=given_path, metavar="DIR", help=output_help)
    run.add_argument("--accuracy", type=accuracy, metavar="SHARE", help=ACCURACY_HELP)
    run.add_argument(
        "--full", action="store_true", help="model every effect; results go to the folder SCENE_full, beside those of the reduced model"
    )
    run.add_argument("--no-yade", action="store_true", help=NO_YADE_HELP)
    run.add_argument("--time-limit", type=seconds, metavar="S", help=f"{LIMIT_HELP}; a second attempt has --try-harder-limit")
    harder_help = (
        "where the verdict is inconclusive, disagree or expected value not met, run both methods again with finer settings of their own, "
        "in the folder SCENE_harder"
    )
    run.add_argument("--try-harder", action="store_true", help=harder_help)
    most = (
        "wall time of --try-harder, which this option implies, for each scene in seconds, in place of any other time limit "
        f"(default: {HARDER_SECONDS:g}, 15 minutes)"
    )
    run.add_argument("--try-harder-limit", type=seconds, metavar="S", help=most)
    threads_help = (
        "threads of YADE in each scene, for structures of 1,000 blocks and more; two runs then differ in their last digits (default: 1)"
    )
    run.add_argument("--threads", type=count, metavar="N", help=threads_help)
    run.add_argument("--workers", type=count, metavar="N", default=1, help="number of scenes that run side by side (default: 1)")
    run.add_argument("--long", action="store_true", help=LONG_HELP)
    _add_head(run)


def _add_campaign(add: AddVerb) -> None:
    campaign = add("campaign", "run many scenes, or one scene over ranges of its keys, in parallel; finished cases are not run again")
    campaign.set_defaults(configured=("workers", "time_limit"))
    file_help = "campaign file (TOML) with scenes and ranges of their keys, or the name of a shipped campaign, such as seed_paper"
    campaign.add_argument("campaign", metavar="FILE", type=given_path, help=file_help)
    campaign.add_argument(
        "-o", "--output", type=given_path, metavar="DIR", help="folder of the results (default: crosscheck-campaigns/FILE)"
    )
    where = campaign.add_mutually_exclusive_group()
    workers_help = "number of processes on this machine (default: as configured, else its cores)"
    where.add_argument("--workers", type=count, metavar="N", help=workers_help)
    where.add_argument(
        "--scheduler", type=address, metavar="ADDRESS", help="run on the workers of a Dask scheduler, which share the folder"
    )
    campaign.add_argument("--no-yade", action="store_true", help=NO_YADE_HELP)
    campaign.add_argument("--time-limit", type=seconds, metavar="S", help=LIMIT_HELP)
    campaign.add_argument("--long", action="store_true", help=LONG_HELP)
    campaign.add_argument("--parquet", action="store_true", help="also write the tables as Parquet")


def _add_compare(add: AddVerb) -> None:
    text = (
        "compare two campaigns, before and after a change: cases, verdicts, reactions, mechanisms, weights, blocks, costs; exit code 1 if "
        "any of these but the costs differ"
    )
    compare = add("compare", text)
    compare.add_argument("before", metavar="DIR1", type=given_path, help="folder of `crosscheck campaign`, before the change")
    compare.add_argument("after", metavar="DIR2", type=given_path, help="folder of `crosscheck campaign`, after the change")
    compare.add_argument("-o", "--output", type=page, metavar="PAGE", help="write the comparison: HTML, Markdown or JSON file")


def _add_report(add: AddVerb) -> None:
    report = add("report", "write the report again from stored results")
    folder_help = "folder of `crosscheck run` (that of one of its scenes stands for the whole run), or of `crosscheck campaign`"
    report.add_argument("folders", metavar="DIR", nargs="+", type=given_path, help=folder_help)
    report.add_argument("--pdf", action="store_true", help="also print the report to report.pdf (A4); needs Chromium or Chrome")
    report.add_argument("--long", action="store_true", help=LONG_HELP)
    _add_head(report)


def _add_head(verb: argparse.ArgumentParser) -> None:
    """Add the options that fill the head of a report."""
    for name in HEAD:
        verb.add_argument(f"--{name}", type=words, metavar="TEXT", help=f"{name} in the head of the report (default: the scene's)")


def _add_export(add: AddVerb) -> None:
    export = add("export", "write blocks, mechanisms, forces and YADE's states for ParaView (.vtu, .pvd)")
    export.add_argument(
        "source", metavar="DIR|SCENE", help="folder of `crosscheck run`, or of one of its scenes, or a scene, which is solved first"
    )
    export.add_argument("-o", "--output", type=given_path, metavar="FOLDER", help="folder to write the files to (default: SCENE-paraview)")


def _add_animate(add: AddVerb) -> None:
    animate = add("animate", "animate the settlement: both mechanisms grow beside the record of the reaction")
    animate.add_argument(
        "source", metavar="DIR|SCENE", help="folder of `crosscheck run`, or of one of its scenes, or a scene, which is run first"
    )
    animate.set_defaults(configured=("time_limit",))
    animate.add_argument("--no-yade", action="store_true", help=NO_YADE_HELP)
    animate.add_argument("--time-limit", type=seconds, metavar="S", help=LIMIT_HELP)
    place = "GIF or MP4 file (default: animation.gif in the scene's folder, from where `crosscheck report` shows it)"
    animate.add_argument("-o", "--output", type=moving_picture, metavar="MOVIE", help=place)
    animate.add_argument("--fps", type=frames_per_second, metavar="N", default=10, help="frames per second (default: 10)")


def _add_tutorial(add: AddVerb) -> None:
    tutorial = add("tutorial", "tutorials for students: list them, run one, or write notebooks")
    tutorial.add_argument("name", metavar="NAME", nargs="?", help="tutorial to run (default: list them)")
    output_help = f"folder of figures, results and notebooks (default: {TUTORIALS})"
    tutorial.add_argument("-o", "--output", type=given_path, metavar="DIR", default=TUTORIALS, help=output_help)
    tutorial.add_argument("--notebook", action="store_true", help="write the notebook NAME.ipynb, or all of them, and run nothing")


def _add_doctor(add: AddVerb) -> None:
    add("doctor", "list installed and missing parts, the commands that install them, and the settings")


def _add_completion(add: AddVerb) -> None:
    completion = add("completion", "print the script with which a shell completes commands, options and scenes")
    completion.add_argument("shell", metavar="SHELL", choices=SHELLS, help=", ".join(SHELLS))
