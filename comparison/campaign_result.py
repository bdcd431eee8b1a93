"""Campaigns from Python: run or read one, show its rows as a table, compare two."""

import copy
import multiprocessing
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from comparison.campaign import (
    Campaign,
    CampaignTable,
    Local,
    change_words,
    compare_tables,
    default_folder,
    definition,
    expand,
    find_campaign,
    read_table,
    run_cases,
    sentence,
    title_of_values,
    value_cells,
    verdict_counts,
    with_versions,
    write_campaign_report,
)
from comparison.errors import StderrConsole
from comparison.numbers import plural
from comparison.progress import CampaignNarration
from comparison.run_folder import folder_of_results
from comparison.settings import MOST_WORKERS
from comparison.verdict import mark_of
from la_core.errors import SceneError, path_of, real_path, seconds_or_none, true_or_false, whole_number
from la_core.side_by_side import cores
from la_core.text_table import Tabled, dataframe, number_text

MOST_ROWS = 20  # in a printed table; the data frame has all rows
CHANGE_COLUMNS = ("case", "what", "before", "after", "difference", "allowed")


@dataclass(frozen=True, eq=False, repr=False)
class CampaignResult(Tabled):
    """Results of a campaign.

    `print(result)` shows one row for each case, and so does a notebook.

    Attributes
    ----------
    folder : Path
        Folder of the results, as an absolute path: report.html, results.csv, and one folder for each case.
    title : str
        Title of the campaign.
    rows : list of dict
        One row for each case that ended, with the columns of results.csv, and "folder", the folder of its report below `folder`;
        None is undefined. Reactions are in N or N m.
    unfinished : str
        Sentence on the number of ended cases of an interrupted campaign; "" where all cases have ended.
    """

    folder: Path
    title: str
    rows: list[dict[str, Any]]
    unfinished: str = ""
    _stored: CampaignTable | None = None  # table for `compare`: a later campaign may replace the one in the folder

    def to_dataframe(self) -> Any:
        """Return the rows as a table of pandas.

        Returns
        -------
        pandas.DataFrame
            One row for each case, with the keys of `rows`.

        Raises
        ------
        SceneError
            Pandas is not installed.
        """
        return dataframe(self.rows)

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        words = verdict_counts(self.rows) or "none has ended"
        more = f"; the first {MOST_ROWS} are shown" if len(self.rows) > MOST_ROWS else ""
        title = f"{self.title}: {plural(len(self.rows), 'case')}, {words}{more}; {title_of_values(self.rows)}"
        title += f"; {self.unfinished.rstrip('.')}" if self.unfinished else ""
        return title, ("case", "least", "Coulomb", "greatest", "YADE", "verdict"), [_cells(row) for row in self.rows[:MOST_ROWS]]


@dataclass(frozen=True, eq=False, repr=False)
class CampaignChanges(Tabled):
    """Differences between two campaigns beyond the stated uncertainties.

    `print(changes)` shows one row for each change, and so does a notebook.

    Attributes
    ----------
    changes : list of dict
        One row for each change: "case", "what" changed, its value "before" and "after", their "difference" and the difference "allowed"
        by the stated uncertainties; weights and reactions in N or N m, None where undefined.
    only_before : list of str
        Cases that only the first campaign has.
    only_after : list of str
        Cases that only the second campaign has.
    summary : str
        All differences in one or two sentences.
    """

    changes: list[dict[str, Any]]
    only_before: list[str]
    only_after: list[str]
    summary: str

    @property
    def changed(self) -> bool:
        """Whether anything changed; costs and versions do not count."""
        return bool(self.changes or self.only_before or self.only_after)

    def to_dataframe(self) -> Any:
        """Return the changes as a table of pandas.

        Returns
        -------
        pandas.DataFrame
            One row for each change.

        Raises
        ------
        SceneError
            Pandas is not installed.
        """
        return dataframe(self.changes, CHANGE_COLUMNS)

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        return self.summary, CHANGE_COLUMNS, [[_text(row[column]) for column in CHANGE_COLUMNS] for row in self.changes[:MOST_ROWS]]


def run_campaign(
    campaign: Path | str,
    folder: Path | str | None = None,
    yade: bool = True,
    workers: int | None = None,
    time_limit: float | None = None,
    quiet: bool = False,
) -> CampaignResult:
    """Run a campaign, as `crosscheck campaign` does; finished cases are not run again.

    The cases run in processes of their own, which do not load the script that calls this function.

    Parameters
    ----------
    campaign : Path or str
        Path of a campaign file, or name of a shipped campaign.
    folder : Path, str or None
        Folder of the results. None takes "crosscheck-campaigns/NAME".
    yade : bool
        Whether to run YADE, where the campaign file asks for it; False runs limit analysis alone.
    workers : int or None
        Number of cases that run side by side. None takes one for each core.
    time_limit : float or None
        Longest wall time of each YADE run, s. None takes the scenes' own.
    quiet : bool
        Whether to write no progress to stderr.

    Returns
    -------
    CampaignResult
        One row for each case.

    Raises
    ------
    SceneError
        The campaign or one of its cases is invalid.
    comparison.errors.FolderInUseError
        Another process or thread works in the folder.
    """
    if getattr(multiprocessing.current_process(), "_inheriting", False):  # set while a worker process loads the user's script
        raise SceneError(
            "run_campaign", "is called while a worker process loads the script", hint='call it below `if __name__ == "__main__":`'
        )
    count = cores() if workers is None else whole_number("workers", workers, 1, MOST_WORKERS)
    asked, silent = true_or_false("yade", yade), true_or_false("quiet", quiet)
    limit = seconds_or_none("time_limit", time_limit)
    path = find_campaign(path_of("campaign", campaign))
    defined = definition.load_campaign(path)
    place = folder_of_results(default_folder(path) if folder is None else folder)
    runs_yade = defined.file.yade and asked
    whole = Campaign(defined, expand(defined), real_path(place), runs_yade, time_limit=limit)
    with CampaignNarration(StderrConsole(silent), defined.title) as narration:
        return _result_of(run_cases(whole, Local(count, runs_yade), narration, write_campaign_report))


def read_campaign(folder: Path | str) -> CampaignResult:
    """Read the stored results of a campaign.

    Parameters
    ----------
    folder : Path or str
        Folder of `run_campaign` or of `crosscheck campaign`.

    Returns
    -------
    CampaignResult
        One row for each case.

    Raises
    ------
    la_core.exchange.ExchangeError
        The folder holds no campaign, or its table is damaged.
    """
    return _result_of(read_table(path_of("folder", folder)))


def compare(before: CampaignResult | Path | str, after: CampaignResult | Path | str) -> CampaignChanges:
    """Compare two campaigns, before and after a change, as `crosscheck compare` does.

    Cases are matched by the values of their keys; where the two campaigns vary different keys, by name.

    Parameters
    ----------
    before : CampaignResult, Path or str
        Campaign before the change, or its folder.
    after : CampaignResult, Path or str
        Campaign after the change, or its folder.

    Returns
    -------
    CampaignChanges
        Changes beyond the stated uncertainties.

    Raises
    ------
    la_core.exchange.ExchangeError
        A folder holds no campaign, or its table is damaged.
    """
    given = {"before": before, "after": after}
    known = [one if isinstance(one, CampaignResult) else path_of(name, one) for name, one in given.items()]
    found = compare_tables(*(with_versions(_table_of(one)) for one in known))
    changes = [
        {
            "case": change.case,
            "what": words["what"],
            "before": change.before,
            "after": change.after,
            "difference": change.difference,
            "allowed": change.allowed,
        }
        for change, words in ((change, change_words(change)) for change in found.changes)
    ]
    return CampaignChanges(changes, list(found.only_before), list(found.only_after), sentence(found))


def _result_of(table: CampaignTable) -> CampaignResult:
    place = table.folder.absolute()  # the rows are a copy, which a user may change
    return CampaignResult(place, table.title, copy.deepcopy(table.rows), table.unfinished, replace(table, folder=place))


def _table_of(given: CampaignResult | Path) -> CampaignTable:
    """Return the table of a result as it was read, because a later campaign may have replaced its file; or the table in a folder."""
    if isinstance(given, CampaignResult):
        return given._stored or read_table(given.folder)
    return read_table(given)


def _cells(row: dict[str, Any]) -> list[str]:
    """Return a case as the cells of a printed table."""
    return [str(row["case"]), *value_cells(row), "failed" if row["state"] == "failed" else mark_of(row["verdict"])]


def _text(value: Any) -> str:
    """Return a value before or after a change as text."""
    return value if isinstance(value, str) else number_text(value)
