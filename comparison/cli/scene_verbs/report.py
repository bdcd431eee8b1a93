"""`crosscheck report`: write the reports of stored runs or campaigns again."""

import os
from pathlib import Path
from typing import Any, NoReturn

from comparison.cli.conclude import conclude
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, SEVERITY, TOOL, USAGE, complain, complain_of
from comparison.cli.study_verbs.campaign_report import is_campaign, report_campaigns
from comparison.errors import FolderInUseError
from comparison.progress import Narration
from comparison.run_folder import DEFINITION, HEAD, alone_in, is_writable
from comparison.workflow import report_again
from comparison.yade import among_results
from la_core.errors import SceneError
from la_core.exchange import ASK_OWNER, ExchangeError

RESULTS_OF_A_RUN = ("case.h5", "run.h5", "comparison.json")  # each of them alone shows that a scene was run in a folder


def execute(context: Context) -> int:
    """Write every folder's report again and return the most severe exit code.

    A scene whose results cannot be read gets an error message, and the report of the others names it. Where results cannot be written,
    the folder keeps the report that it has. Raises SceneError for a folder without results.
    """
    folders = []
    for named in context.options.folders:
        if (folder := _run_folder(named)) == named or folder not in folders:  # scenes of one run have one report
            folders.append(folder)
    if any(map(is_campaign, folders)):
        if given := [f"--{name}" for name in HEAD if getattr(context.options, name) is not None]:
            context.warn_of(
                ", ".join(given), "without effect: the page of a campaign has the title of the campaign file, and no other head"
            )
        return report_campaigns(context)
    reports: list[tuple[Path, list[dict[str, Any]]]] = []
    broken, left_out = AGREE, dict[Path, list[str]]()
    with Narration(context.narrator) as narration:
        for folder in folders:
            for closed in _closed_folders(folder):
                broken = complain(f"{closed}: {ASK_OWNER}", TOOL)
                left_out.setdefault(folder, []).append(closed.name)
            cases = sorted({path.parent for name in RESULTS_OF_A_RUN for path in folder.glob(f"*/{name}")})
            if not cases and folder not in left_out:
                _refuse_without_results(folder)
            comparisons: list[dict[str, Any]] = []
            for case in cases:
                try:
                    summary = report_again(case, narration)
                    was_renamed = summary["scene"] != case.name
                    comparisons.append(summary | {"folder": case.name} if was_renamed else summary)
                except (ExchangeError, FolderInUseError, SceneError) as error:
                    broken = max(broken, complain(str(error), USAGE if isinstance(error, SceneError) else TOOL), key=SEVERITY.index)
                    left_out.setdefault(folder, []).append(case.name)
                except OSError as error:  # such as a full disk: a page would lack figures that were deleted
                    broken = max(broken, complain_of(error), key=SEVERITY.index)
                    comparisons, left_out[folder] = [], sorted({*left_out.get(folder, []), *(each.name for each in cases)})
                    break
            reports.append((folder, comparisons))
    return max(broken, conclude(reports, context, left_out, keep_head=True), key=SEVERITY.index)


def _refuse_without_results(folder: Path) -> NoReturn:
    """Raise an error for a folder without results of `crosscheck run`, with the reason and the next step."""
    if (folder / DEFINITION).is_file():
        _refuse_a_running_campaign(folder)
        ended = "holds a campaign that was ended before its first table"
        raise SceneError(str(folder), ended, hint="the command that began it continues from its finished cases")
    hint = among_results(str(folder).removesuffix(".toml")) or "`crosscheck run SCENE` makes some"
    raise SceneError(str(folder), "holds no results of `crosscheck run`", hint=hint)


def _refuse_a_running_campaign(folder: Path) -> None:
    if not is_writable(folder):
        return
    try:
        with alone_in(folder):
            pass
    except FolderInUseError as error:
        left = "wait until some of its cases have ended, then run the same command again"
        raise FolderInUseError(f"{folder}: a campaign is running there and has no table yet; {left}") from error


def _closed_folders(folder: Path) -> list[Path]:
    """Return the folders in a run's folder, or itself, that this user may not list; else a report would silently lack their results.

    Folders of a disk or a desktop hold no results: `lost+found`, and names with a dot such as `.Trash-0`.
    """
    if not folder.is_dir():
        return []
    if not os.access(folder, os.R_OK | os.X_OK):
        return [folder]
    inside = sorted(folder.iterdir())
    inside = [place for place in inside if place.name != "lost+found" and not place.name.startswith(".")]
    return [place for place in inside if place.is_dir() and not os.access(place, os.R_OK | os.X_OK)]


def _run_folder(folder: Path) -> Path:
    """Return the folder of a run, which holds its report; a scene's folder lies in it."""
    if not any((folder / name).is_file() for name in RESULTS_OF_A_RUN):
        return folder
    return folder.resolve().parent if folder.name in ("", ".", "..") else folder.parent
