"""The command line: reads words, calls the rooms, prints; results on stdout, narration on stderr. No mechanics here."""

import argparse
import io
import json
import os
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from comparison import doctor, shipped, tables
from comparison.arguments import figure, seconds
from comparison.check import overall
from comparison.checks import check_expected
from comparison.narration import Narration
from comparison.provenance import describe, version
from comparison.summary import limit_analysis_summary
from la_core.assembly import assemble
from la_core.case import analyse, settled
from la_core.errors import SceneError
from la_core.exchange import ExchangeError
from la_core.full_model import full_model
from la_core.limit import Status
from la_core.scene import Scene, load_scene

AGREE, DISAGREE, USAGE, TOOL, INCONCLUSIVE = range(5)
INTERRUPTED = 130  # as shells say it
EXIT_OF_VERDICT = {"agree": AGREE, "disagree": DISAGREE, "inconclusive": INCONCLUSIVE, None: AGREE}
GRAVITY = (AGREE, INCONCLUSIVE, DISAGREE, TOOL)  # the gravest of several scenes decides
PIPE_WIDTH = 120  # columns
RESULTS = Path("crosscheck-results")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit code of the contract: 0 agree, 1 disagree, 2 usage or scene, 3 tool, 4 inconclusive."""
    if arguments is None:
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # a closed pipe ends the program quietly, as it ends others
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that is not UTF-8 gets escapes instead of an error
    options = _parser().parse_args(arguments)
    narrator = Console(stderr=True, quiet=getattr(options, "quiet", False), highlight=False, soft_wrap=True)
    try:
        return int(options.command(options, narrator))
    except SceneError as error:
        return _complain(str(error), USAGE)
    except ExchangeError as error:
        return _complain(str(error), TOOL)
    except OSError as error:
        return _complain(f"{error.filename or 'file'}: {error.strerror or error}", TOOL)
    except Exception as error:
        return _complain(f"unexpected {type(error).__name__}: {error}; this is a fault of the program, please report it", TOOL)
    except KeyboardInterrupt:
        return _complain("stopped; what was finished is kept, the same command goes on from there", INTERRUPTED)


def _complain(message: str, code: int) -> int:
    Console(stderr=True, highlight=False, soft_wrap=True).print(f"error: {message}", markup=False)
    return code


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="crosscheck",
        description="Cross-checks rigid-block limit analysis and discrete elements (YADE) on masonry with a settling support.",
        epilog="exit codes: 0 agree, 1 disagree, 2 usage or scene error, 3 a tool is missing or failed, 4 inconclusive",
    )
    parser.add_argument("--version", action="version", version=f"crosscheck {version()}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, command: Any, text: str) -> argparse.ArgumentParser:
        sub = commands.add_parser(name, help=text, description=text)
        sub.set_defaults(command=command)
        sub.add_argument("-q", "--quiet", action="store_true", help="no narration on stderr")
        sub.add_argument("--json", action="store_true", help="one JSON object on stdout and nothing else there")
        return sub

    scene_help = "path of a scene file, or the name of a shipped scene"
    add("scenes", _scenes, "list the shipped scenes: title, expected value, kind, source")
    show = add("show", _show, "draw a scene: blocks, roles, contact points; counts and weight")
    show.add_argument("scene", metavar="SCENE", help=scene_help)
    show.add_argument("-o", "--output", type=figure, metavar="FIG", help="PNG, SVG or PDF file to draw (default: SCENE.png)")
    solve = add("solve", _solve, "limit analysis alone")
    solve.add_argument("scene", metavar="SCENE", help=scene_help)
    solve.add_argument("--path", action="store_true", help="also follow the reaction from rest to the plateau, as a [path] table asks")
    solve.add_argument("-o", "--output", type=figure, metavar="FIG", help="draw the reaction: PNG, SVG or PDF file")
    study = add("sensitivity", _sensitivity, "how the classic iteration for friction depends on its own parameters")
    study.add_argument("scene", metavar="SCENE", help=scene_help)
    study.add_argument("-o", "--output", type=figure, metavar="FIG", help="PNG, SVG or PDF file to draw (default: SCENE-sensitivity.png)")
    run = add("run", _run, "limit analysis, YADE, comparison and report; finished stages are not run again")
    run.add_argument("scenes", metavar="SCENE", nargs="+", help=scene_help)
    run.add_argument("-o", "--output", type=Path, metavar="DIR", default=RESULTS, help=f"folder of the results (default: {RESULTS})")
    run.add_argument("--full", action="store_true", help="with every effect modelled, in a folder SCENE_full beside the reduced model's")
    run.add_argument("--no-yade", action="store_true", help="limit analysis alone")
    run.add_argument("--time-limit", type=seconds, metavar="S", help="wall seconds for each YADE run (default: the scene's, or 3600)")
    report = add("report", _report, "write the report again from stored results")
    report.add_argument("folders", metavar="DIR", nargs="+", type=Path, help="folder of `crosscheck run`")
    export = add("export", _export, "blocks, mechanisms, forces and YADE's states for ParaView (.vtu, .pvd)")
    export.add_argument("source", metavar="DIR|SCENE", help="a scene's folder in the results of `crosscheck run`, or a scene, to solve it")
    export.add_argument("-o", "--output", type=Path, metavar="FOLDER", required=True, help="folder of the files")
    add("doctor", _doctor, "what is installed, what is missing, the command that mends it")
    return parser


def _stdout() -> Console:
    """Results: as wide as the terminal, or wide enough for a table in a file or pipe; text is never cut or broken."""
    console = Console(highlight=False, soft_wrap=True)
    return console if console.is_terminal else Console(highlight=False, soft_wrap=True, width=PIPE_WIDTH)


def _print_json(value: Any) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=False))


def _scenes(options: argparse.Namespace, narrator: Console) -> int:
    scenes = [load_scene(shipped.find(name)) for name in shipped.names()]
    if options.json:
        rows = [{"name": s.name, "title": s.title, "source": s.source} for s in scenes]
        _print_json([row | {"expected": s.expected.model_dump() if s.expected else None} for row, s in zip(rows, scenes, strict=True)])
    else:
        _stdout().print(tables.scene_table(scenes))
    return AGREE


def _show(options: argparse.Namespace, narrator: Console) -> int:
    from comparison import plots

    scene = load_scene(shipped.find(options.scene))
    assembly = settled(scene)
    figure = options.output or Path(f"{scene.name}.png")
    plots.save(plots.assembly_figure(scene, assembly), figure)
    facts = tables.scene_facts(scene, assembly)
    if options.json:
        _print_json(facts | {"figure": str(figure)})
    else:
        _stdout().print(tables.facts_table(scene.title, facts))
        _stdout().print(tables.effects_table(facts["effects"]))
        narrator.print(f"drawn in {figure}", markup=False)
    return AGREE


def _solve(options: argparse.Namespace, narrator: Console) -> int:
    scene = load_scene(shipped.find(options.scene))
    narrator.print(f"{scene.name}: limit analysis, free blocks: {int(scene.blocks.free.sum())}", markup=False)
    if options.path and scene.effects.friction not in ("auto", "coulomb"):
        raise SceneError(str(scene.path), "a path is followed with friction that does not dilate", hint='take effects.friction = "coulomb"')
    analysis = analyse(scene, with_path=options.path)
    summary = limit_analysis_summary(scene, analysis)
    checks = list(check_expected(scene, analysis))
    if options.json:
        _print_json(summary)
    else:
        _stdout().print(tables.solution_table(scene, summary, checks))
        if analysis.path is not None:
            _stdout().print(tables.path_table(scene, summary["limit_analysis"]["path"]))
    if options.output is not None:
        from comparison import plots

        plots.save(plots.reaction_figure(scene, analysis, None), options.output)
        narrator.print(f"drawn in {options.output}", markup=False)
    verdict, reason = overall(checks)
    if reason:
        narrator.print(reason, markup=False)
    statuses = {analysis.rounded[analysis.main].status} | ({analysis.coulomb.status} if analysis.coulomb else set())
    if statuses & {Status.INACCURATE, Status.FAILED}:
        return max(INCONCLUSIVE, EXIT_OF_VERDICT[verdict], key=_gravity)
    return EXIT_OF_VERDICT[verdict]


def _sensitivity(options: argparse.Namespace, narrator: Console) -> int:
    from comparison import plots, sensitivity
    from comparison.plot_sensitivity import sensitivity_figure

    scene = load_scene(shipped.find(options.scene))
    analysis = analyse(scene)
    main, coulomb = analysis.rounded[analysis.main], analysis.coulomb
    if main.status is not Status.SOLVED:
        raise SceneError(str(scene.path), f"limit analysis ends as {main.status}, so there is nothing to iterate on")
    references = {"associated": (main.value, 1)}
    if coulomb is not None:
        references["Coulomb, elastic joints"] = (coulomb.value, coulomb.iterations)
    figure = options.output or Path(f"{scene.name}-sensitivity.png")
    with Narration(narrator) as narration:
        result = sensitivity.study(
            scene, analysis.assembly, progress=lambda done, of, _: narration.fraction(scene.name, done / of, f"run {done} of {of}")
        )
    plots.save(sensitivity_figure(result, references), figure)
    if options.json:
        _print_json(sensitivity.sensitivity_dict(result) | {"figure": str(figure)})
    else:
        _stdout().print(sensitivity.sensitivity_table(result, references))
        narrator.print(f"drawn in {figure}", markup=False)
    return AGREE


def _run(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.workflow import run_scene

    scenes = [load_scene(path) for path in dict.fromkeys(shipped.find(name).resolve() for name in options.scenes)]
    if options.full:
        scenes = [full_model(scene) for scene in scenes]
    _refuse_names(scenes)
    for scene in scenes:
        assemble(scene)  # a bad scene is refused before the first one runs
    with Narration(narrator) as narration:
        comparisons = [
            run_scene(scene, options.output / scene.name, narration, not options.no_yade, options.time_limit) for scene in scenes
        ]
    return _conclude(options, narrator, [(options.output, comparisons)])


def _refuse_names(scenes: list[Scene]) -> None:
    """A scene's name is its folder's: it must be one, and its own."""
    seen: dict[str, Scene] = {}
    for scene in scenes:
        if scene.name in (".", "..", "report.html", "report.md", "report.json"):
            raise SceneError(str(scene.path), f'"{scene.name}" cannot name a folder of results', hint="rename the file")
        if scene.name in seen:
            raise SceneError(str(scene.path), f'has the same name as {seen[scene.name].path}, "{scene.name}"', hint="rename one file")
        seen[scene.name] = scene


def _report(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.workflow import report_again

    reports, broken = [], AGREE
    with Narration(narrator) as narration:
        for folder in options.folders:
            cases = sorted(path.parent for path in folder.glob("*/case.h5"))
            if not cases:
                raise SceneError(str(folder), "holds no results of `crosscheck run`")
            comparisons = []
            for case in cases:
                try:
                    comparisons.append(report_again(case, narration))
                except ExchangeError as error:
                    broken = _complain(str(error), TOOL)
            reports.append((folder, comparisons))
    return max(broken, _conclude(options, narrator, reports), key=_gravity)


def _export(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.export import export, results_of

    files = [str(path) for path in export(*results_of(options.source), options.output)]
    if options.json:
        _print_json({"files": files})
    else:
        _stdout().print("\n".join(files), markup=False)
    return AGREE


def _conclude(options: argparse.Namespace, narrator: Console, reports: list[tuple[Path, list[dict[str, Any]]]]) -> int:
    """Write each folder's report, print the verdict table, and return the gravest exit code."""
    from comparison.report import write_report

    codes, stored = [], []
    for folder, comparisons in reports:
        page = write_report(folder, comparisons, describe())
        stored.append(json.loads((folder / "report.json").read_text(encoding="utf-8")))
        if not options.json:
            _stdout().print(tables.verdict_table(comparisons))
            for comparison in comparisons:
                if comparison["reason"]:
                    _stdout().print(f"{comparison['scene']}: {comparison['reason']}", markup=False)
            _stdout().print(f"report: {os.path.relpath(page)}", markup=False)
        codes += [_code(comparison) for comparison in comparisons]
    if options.json:
        _print_json(stored[0] if len(stored) == 1 else {"reports": stored})
    return max(codes, key=_gravity, default=AGREE)


def _gravity(code: int) -> int:
    return GRAVITY.index(code)


def _code(comparison: dict[str, Any]) -> int:
    if comparison["yade"] and comparison["yade"]["status"] in ("missing", "failed"):
        return TOOL
    return EXIT_OF_VERDICT[comparison["verdict"]]


def _doctor(options: argparse.Namespace, narrator: Console) -> int:
    findings = doctor.examine()
    if options.json:
        _print_json([vars(finding) for finding in findings])
    else:
        _stdout().print(tables.doctor_table(findings))
        for finding in findings:
            if not finding.well:
                _stdout().print(f"{finding.part}: {finding.remedy}", markup=False)
    return AGREE if all(finding.well for finding in findings) else TOOL


if __name__ == "__main__":
    sys.exit(main())
