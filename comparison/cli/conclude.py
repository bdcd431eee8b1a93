"""Last step of `crosscheck run` and `crosscheck report`: write the reports, print the verdicts, choose the exit code."""

import shlex
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from comparison.cli import tables
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, EXIT_OF_VERDICT, SEVERITY, TOOL, USAGE, complain_of
from comparison.errors import PrinterMissingError
from comparison.judge import refuses_setting
from comparison.numbers import plural
from comparison.provenance import describe
from comparison.report import angle_words, chosen_head, notes_of, stored_report, write_pdf, write_report
from comparison.run_folder import HEAD, name_in_results
from comparison.verdict import UNCONFIRMED, VERDICTS, Verdict


def conclude(
    reports: list[tuple[Path, list[dict[str, Any]]]],
    context: Context,
    left_out: Mapping[Path, list[str]] | None = None,
    keep_head: bool = False,
) -> int:
    """Write the report of each folder, print verdict tables or one JSON object, and return the most severe exit code.

    A report that cannot be written gets an error message, and the others are still written: all results are stored by then.

    reports: folders with the comparisons of their scenes (dictionaries in the form of comparison.json). left_out: by folder, names of
    scenes whose results cannot be read. keep_head: whether a report keeps the words that an earlier command chose for its head.
    """
    as_json = context.options.json
    codes, stored = [], []
    for folder, comparisons in reports:
        unread, head = (left_out or {}).get(folder, []), _kept_head(folder, comparisons, context) if keep_head else {}
        head |= {name: words for name in HEAD if (words := getattr(context.options, name)) is not None}
        stored.append(stored_report(comparisons, describe(), unread, head))
        if not comparisons:  # the report of earlier results stays where none can be read
            continue
        again = {first["scene"] for comparison in comparisons if (first := comparison.get("first_verdict"))}
        written: list[Path] = []
        failure: Exception | None = None
        try:
            written.append(write_report(folder, comparisons, describe(), head, unread))
            if getattr(context.options, "pdf", False):
                written.append(write_pdf(written[0]))
        except (OSError, PrinterMissingError) as error:
            failure = error
        finally:  # also after an interruption
            if not as_json:
                _print_verdicts(comparisons, again, context)
        if not as_json:
            for path in written:
                context.show_report(path)
        if failure:
            codes.append(complain_of(failure))
        if written:
            _tell_of_others(folder, set(map(name_in_results, comparisons)).union(unread), context)
        deciding = (comparison for comparison in comparisons if comparison["scene"] not in again)  # the second attempt decides
        codes += [code_of_comparison(comparison) for comparison in deciding]
    if as_json:
        context.print_json(stored[0] if len(stored) == 1 else {"reports": stored})
    return max(codes, key=SEVERITY.index, default=AGREE)


def _tell_of_others(folder: Path, covered: set[str], context: Context) -> None:
    """Print the number of scenes of earlier runs that a folder's report lacks, and the command for a report of all scenes."""
    if others := {path.parent.name for path in folder.glob("*/comparison.json")} - covered:
        missing = f"{plural(len(others), 'other scene')} in {folder} {'is' if len(others) == 1 else 'are'} not in this report"
        context.narrate(f"{missing}: `crosscheck report {shlex.quote(str(folder))}` makes one of all")


def _print_verdicts(comparisons: list[dict[str, Any]], again: set[str], context: Context) -> None:
    """Print the tables of one report, and the sentences about its scenes. again: names of scenes that a second attempt follows."""
    for comparison in comparisons:
        if comparison["verdict"] == Verdict.CANNOT_STAND:
            context.tell(f"{name_in_results(comparison)} cannot stand. {comparison['reason']}")
    context.table(tables.verdict_table(comparisons), tables.VERDICT_CAN_GO)
    if any(comparison.get("accuracy") for comparison in comparisons):
        context.table(tables.accuracy_table(comparisons))
    for comparison in comparisons:
        if first := comparison.get("first_prediction"):
            context.tell(f"{name_in_results(comparison)}: {first['sentence']}")
        for words in lines_below(comparison, comparison["scene"] in again):
            context.tell(f"{name_in_results(comparison)}: {words}")


def _kept_head(folder: Path, comparisons: list[dict[str, Any]], context: Context) -> dict[str, str]:
    """Return the words that a report keeps in its head; a warning names the words that it loses because it has further scenes."""
    words, beyond = chosen_head(folder, comparisons)
    lost = ", ".join(f'{name} "{text}"' for name, text in words.items() if text and getattr(context.options, name) is None)
    if lost and beyond:
        context.warn_of(
            str(folder / "report.html"), f"loses {lost}: given for a report without {', '.join(beyond)}; give it again to keep it"
        )
    return {} if beyond else words


def lines_below(comparison: dict[str, Any], is_tried_again: bool = False) -> Iterator[str]:
    """Yield the lines under the terminal's table of verdicts: notes, the reason or the remarks, then the next step.

    is_tried_again: whether a second attempt has already taken the next step.
    """
    if words := angle_words(comparison):
        yield words
    yield from notes_of(comparison)
    is_said = comparison["verdict"] in (Verdict.CANNOT_STAND, Verdict.EXPECTED_MET)  # above the table, or by the mark in it
    yield from [comparison["reason"]] if comparison["reason"] and not is_said else comparison.get("remarks") or []
    if first := comparison.get("first_verdict"):
        words = VERDICTS.get(first["verdict"], VERDICTS[None])[1]
        yield f"second attempt with finer settings; the verdict of the first one, {first['scene']}, was: {words}."
    if comparison.get("next_step") and not is_tried_again and comparison["verdict"] not in UNCONFIRMED:
        yield f"next: {comparison['next_step']}"


def code_of_comparison(comparison: dict[str, Any]) -> int:
    """Return the exit code of one scene: of its verdict, unless YADE failed or refused a setting of the scene."""
    if comparison["yade"] and comparison["yade"]["status"] in ("missing", "failed"):
        return USAGE if refuses_setting(comparison["reason"]) else TOOL
    return EXIT_OF_VERDICT[comparison["verdict"]]
