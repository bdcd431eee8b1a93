"""`crosscheck report` for folders of campaigns."""

from pathlib import Path

from comparison.campaign import STORED, read_table, stored_campaign_report, with_versions, write_campaign_report, write_tables
from comparison.cli.context import Context
from comparison.cli.exit_codes import SEVERITY, complain_of
from comparison.cli.study_verbs.campaign import exit_code, show
from comparison.errors import PrinterMissingError
from comparison.report import write_pdf
from la_core.errors import SceneError
from la_core.exchange import ExchangeError


def is_campaign(folder: Path) -> bool:
    """Return whether the folder holds a campaign's results."""
    return (folder / STORED).is_file()


def report_campaigns(context: Context) -> int:
    """Write the reports of campaigns again, with the tables beside them, and return the most severe exit code of all cases.

    A campaign that cannot be read or written gets an error message. Raises SceneError for a folder without a campaign.
    """
    folders, as_json = context.options.folders, context.options.json
    others = [folder for folder in folders if not is_campaign(folder)]
    if others:
        raise SceneError(str(others[0]), "holds no campaign, unlike another folder", hint="report campaigns and runs separately")
    codes, stored = [], []
    for folder in folders:
        written: list[Path] = []
        try:
            results = read_table(folder)
            codes.append(exit_code(results))
            stored.append(stored_campaign_report(with_versions(results)))
            write_tables(results)  # results.csv and campaign.h5 may be damaged or missing
            written.append(write_campaign_report(results))
            if context.options.pdf:
                written.append(write_pdf(written[0]))
        except (ExchangeError, OSError, PrinterMissingError) as error:
            codes.append(complain_of(error))
        if written and not as_json:
            show(results, context)
            for printed in written[1:]:
                context.show_report(printed)
    if as_json and stored:
        context.print_json(stored[0] if len(folders) == 1 else {"reports": stored})
    return max(codes, key=SEVERITY.index)
