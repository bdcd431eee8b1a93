"""The command line: reads words, calls the rooms, prints; results on stdout, narration on stderr. No mechanics here."""

import argparse
import io
import json
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rich.console import Console

from comparison.cli import tables
from comparison.cli.arguments import parser
from comparison.cli.exit_codes import AGREE, EXIT_OF_VERDICT, GRAVITY, INCONCLUSIVE, TOOL, code_of, complain
from comparison.cli.help_verbs import doctor
from comparison.errors import FolderInUseError
from comparison.judge import check_accuracy, check_expected, limit_analysis_summary, overall
from comparison.progress import Narration
from comparison.run_folder import refuse_name
from comparison.settings import filled
from comparison.yade import Results
from la_core.analysis import decided_model, solve, structural_model, with_accuracy
from la_core.errors import SceneError
from la_core.exchange import ExchangeError
from la_core.limit import Status
from la_core.scene import Scene, full_model, load_scene, shipped

PIPE_WIDTH = 120  # columns


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit code of the contract: 0 agree, 1 disagree, 2 usage or scene, 3 tool, 4 inconclusive."""
    if arguments is None:
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # a closed pipe ends the program quietly, as it ends others
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that is not UTF-8 gets escapes instead of an error
    options = parser(COMMANDS).parse_args(arguments)
    narrator = Console(stderr=True, quiet=getattr(options, "quiet", False), highlight=False, emoji=False, soft_wrap=True)
    return code_of(lambda: options.command(filled(options), narrator))


def _stdout() -> Console:
    """Results: as wide as the terminal, or wide enough for a table in a file or pipe; text is never cut or broken."""
    console = Console(highlight=False, emoji=False, soft_wrap=True)
    return console if console.is_terminal else Console(highlight=False, emoji=False, soft_wrap=True, width=PIPE_WIDTH)


def _print_json(value: dict[str, Any]) -> None:
    print(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))


def _scenes(options: argparse.Namespace, narrator: Console) -> int:
    scenes = [load_scene(shipped.find(name)) for name in shipped.names()]
    if options.json:
        rows = [{"name": s.name, "title": s.title, "source": s.source} for s in scenes]
        expected = [{"expected": s.expected.model_dump() if s.expected else None} for s in scenes]
        _print_json({"scenes": [row | one for row, one in zip(rows, expected, strict=True)]})
    else:
        _stdout().print(tables.scene_table(scenes))
    return AGREE


def _show(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.figures import structure

    scene = load_scene(shipped.find(options.scene))
    decided = decided_model(scene)
    assembly = decided.assembly
    figure = options.output or Path(f"{scene.name}.png")
    structure.save(structure.assembly_figure(scene, assembly), figure)
    facts = tables.scene_facts(scene, decided)
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
    analysis = solve(scene, options.path).analysis
    summary = limit_analysis_summary(analysis)
    checks = [*check_expected(analysis), *check_accuracy(Results(analysis))]
    if options.json:
        _print_json(summary)
    else:
        _stdout().print(tables.solution_table(scene, summary, checks))
        if analysis.path is not None:
            _stdout().print(tables.path_table(scene, summary["limit_analysis"]["path"]))
    if options.output is not None:
        from comparison.figures import structure

        structure.save(structure.reaction_figure(Results(analysis)), options.output)
        narrator.print(f"drawn in {options.output}", markup=False)
    verdict, reason = overall(checks)
    if reason:
        narrator.print(reason, markup=False)
    statuses = {analysis.bounds[analysis.main].status} | ({analysis.coulomb.status} if analysis.coulomb else set())
    if statuses & {Status.INACCURATE, Status.FAILED}:
        return max(INCONCLUSIVE, EXIT_OF_VERDICT[verdict], key=GRAVITY.index)
    return EXIT_OF_VERDICT[verdict]


def _sensitivity(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.study_verbs.sensitivity import study_and_draw
    from comparison.studies import sensitivity

    scene = load_scene(shipped.find(options.scene))
    figure = options.output or Path(f"{scene.name}-sensitivity.png")
    with Narration(narrator) as narration:
        result, references = study_and_draw(scene, figure, narration)
    if options.json:
        _print_json(sensitivity.sensitivity_dict(result) | {"figure": str(figure)})
    else:
        _stdout().print(sensitivity.sensitivity_table(result, references))
        narrator.print(f"drawn in {figure}", markup=False)
    return AGREE


def _cost(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.study_verbs import cost as ladders
    from comparison.studies import cost

    scenes = [load_scene(shipped.find(name)) for name in options.scenes]
    _refuse_names(scenes)
    found = []
    with Narration(narrator) as narration:
        for scene in scenes:
            found.append(ladders.climb_and_draw(scene, options.output, not options.no_yade, narration))
    for ladder in found if not options.json else ():
        for target in ladder.references:
            _stdout().print(cost.cost_table(ladder, target))
    if options.json:
        _print_json({"ladders": [cost.cost_dict(ladder) for ladder in found]})
    narrator.print(f"drawn in {options.output}", markup=False)
    return AGREE


def _run(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.workflow import run_scene

    scenes = [load_scene(path) for path in dict.fromkeys(shipped.find(name).resolve() for name in options.scenes)]
    if options.accuracy is not None:
        scenes = [with_accuracy(scene, options.accuracy) for scene in scenes]
    if options.full:
        scenes = [full_model(scene) for scene in scenes]
    _refuse_names(scenes)
    for scene in scenes:
        structural_model(scene)  # a bad scene is refused before the first one runs
    comparisons: list[dict[str, Any]] = []
    try:
        with Narration(narrator) as narration:
            for scene in scenes:
                folder = options.output / scene.name
                comparisons.append(run_scene(scene, folder, narration, not options.no_yade, options.time_limit))
    except (SceneError, FolderInUseError):  # what only an answer or the folder could tell: the scenes before it keep their report
        if comparisons:
            _conclude(options, [(options.output, comparisons)])
        raise
    return _conclude(options, [(options.output, comparisons)])


def _refuse_names(scenes: list[Scene]) -> None:
    """A scene's name is its folder's: it must be one, and its own."""
    seen: dict[str, Scene] = {}
    for scene in scenes:
        refuse_name(scene)
        if scene.name in seen:
            raise SceneError(str(scene.path), f'has the same name as {seen[scene.name].path}, "{scene.name}"', hint="rename one file")
        seen[scene.name] = scene


def _report(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.study_verbs.campaign_report import is_campaign, report_campaigns
    from comparison.workflow import report_again

    if any(map(is_campaign, options.folders)):
        return report_campaigns(options, _stdout(), _print_json)
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
                except (ExchangeError, FolderInUseError) as error:
                    broken = complain(str(error), TOOL)
            reports.append((folder, comparisons))
    return max(broken, _conclude(options, reports), key=GRAVITY.index)


def _export(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.scene_verbs.export import results_of
    from comparison.report import export

    files = [str(path) for path in export(results_of(options.source), options.output)]
    if options.json:
        _print_json({"files": files})
    else:
        _stdout().print("\n".join(files), markup=False)
    return AGREE


def _animate(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.scene_verbs.animate import animation

    return animation(options, narrator, _stdout(), _print_json)


def _tutorial(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.help_verbs.tutorial import tutorial

    return tutorial(options, _stdout(), _print_json)


def _conclude(options: argparse.Namespace, reports: list[tuple[Path, list[dict[str, Any]]]]) -> int:
    from comparison.cli.conclude import conclude

    return conclude(reports, options.json, _stdout(), _print_json)


def _campaign(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.study_verbs.campaign import campaign

    return campaign(options, narrator, _stdout(), _print_json)


def _compare(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.study_verbs.campaign_report import compare_campaigns

    return compare_campaigns(options, narrator, _stdout(), _print_json)


def _doctor(options: argparse.Namespace, narrator: Console) -> int:
    findings, settings = doctor.examine(), doctor.configuration_dict()
    if options.json:
        _print_json({"parts": [vars(finding) for finding in findings], "configuration": settings})
    else:
        _stdout().print(doctor.doctor_table(findings))
        for finding in findings:
            if finding.remedy:
                _stdout().print(f"{finding.part}: {finding.remedy}", markup=False)
        _stdout().print(doctor.settings_table(settings))
        _stdout().print(doctor.configuration_words(settings), markup=False)
    return AGREE if all(finding.well for finding in findings) else TOOL


def _completion(options: argparse.Namespace, narrator: Console) -> int:
    from comparison.cli.help_verbs.completion import script

    text = script(parser(COMMANDS), options.shell)
    if options.json:
        _print_json({"shell": options.shell, "script": text})
    else:
        print(text)
    return AGREE


COMMANDS = {
    "scenes": _scenes,
    "show": _show,
    "solve": _solve,
    "sensitivity": _sensitivity,
    "cost": _cost,
    "run": _run,
    "campaign": _campaign,
    "compare": _compare,
    "report": _report,
    "export": _export,
    "animate": _animate,
    "tutorial": _tutorial,
    "doctor": _doctor,
    "completion": _completion,
}
