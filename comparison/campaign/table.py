"""A campaign's tables: results and costs, one row per case in the campaign's order, as CSV, HDF5, JSON and optionally Parquet.

Every column has one kind of values, texts or numbers. pandas reads CSV and Parquet directly; a group of campaign.h5 is
`pandas.DataFrame({name: c.asstr()[()] if c.dtype.kind == "S" else c[()] for name, c in h5py.File("campaign.h5")["results"].items()})`.

results.csv does not depend on the machine's speed or on the place of a run: two campaigns with equal results have equal bytes.
"""

import csv
import hashlib
import importlib.util
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from comparison.campaign.columns import COSTS, Column, Kind, result_columns
from comparison.numbers import plural
from comparison.run_folder import read_text, write_text
from la_core import exchange
from la_core.exchange import ASK_OWNER, ExchangeError, write_whole

STORED = "campaign.json"
EARLIER = {"expected value met": "expected"}  # verdicts of today, by their words in tables of an earlier program
FORMULA = frozenset("=+-@\t")  # first characters of a spreadsheet's formulas; an apostrophe before them makes a text
WORDS = ("title", "axes", "labels", "rows", "costs", "provenance")


@dataclass(frozen=True)
class CampaignTable:
    """Results of a campaign.

    Attributes
    ----------
    title : str
        Heading of the report.
    axes : dict
        Values of every varied key, by its dotted path, in the campaign's order.
    rows : list of dict
        One row per case that ended, in the campaign's order: the columns of results.csv and "folder", the folder of the case's
        report.html relative to `folder`. None is undefined.
    costs : list of dict
        One row per case that ended: the columns of costs.csv.
    provenance : dict
        Campaign file, workers, total seconds (s), and versions of programs and machine.
    folder : Path
        Folder of the campaign.
    labels : dict
        Short names of the varied keys.
    """

    title: str
    axes: dict[str, list[Any]]
    rows: list[dict[str, Any]]
    costs: list[dict[str, Any]]
    provenance: dict[str, Any]
    folder: Path
    labels: dict[str, str] = field(default_factory=dict)

    @property
    def failures(self) -> list[dict[str, Any]]:
        """Rows of failed cases."""
        return [row for row in self.rows if row["state"] == "failed"]

    @property
    def ran_yade(self) -> bool:
        """Whether YADE ran in a case."""
        return any(row.get("yade_status") not in (None, "missing") for row in self.rows)

    @property
    def unfinished(self) -> str:
        """Sentence on the number of ended cases of an interrupted campaign; "" where all cases have ended."""
        ended, cases = len(self.rows), self.provenance.get("cases") or 0
        have = "has" if ended == 1 else "have"
        return f"{ended} of {plural(cases, 'case')} {have} ended; run the campaign again to go on." if ended < cases else ""


def read_table(folder: Path) -> CampaignTable:
    """Read the table of a campaign's folder; raises ExchangeError if it is missing, damaged or changed."""
    path = folder / STORED
    try:
        stored = json.loads(read_text(path))
    except (FileNotFoundError, NotADirectoryError) as error:
        hint = "`crosscheck campaign FILE` makes some, in Python `comparison.run_campaign`"
        raise ExchangeError(f"{folder}: holds no results of `crosscheck campaign`; {hint}") from error
    except PermissionError as error:
        raise ExchangeError(f"{path}: {ASK_OWNER}") from error
    except OSError as error:
        raise ExchangeError(f"{path}: cannot be read ({error.strerror}); run `crosscheck campaign` again") from error
    except (ValueError, RecursionError) as error:
        raise ExchangeError(f"{path}: damaged or cut short; run `crosscheck campaign` again") from error
    if not isinstance(stored, dict) or stored.get("sum") != _sum_of(stored):
        raise ExchangeError(f"{path}: changed or damaged since it was written; run `crosscheck campaign` again")
    table = CampaignTable(folder=folder, **{word: stored[word] for word in WORDS})
    for row in table.rows:
        if row.get("verdict") in EARLIER:
            row["verdict"] = EARLIER[row["verdict"]]
    return table


def write_campaign(table: CampaignTable, parquet: bool = False) -> None:
    """Write all forms of the table into its folder; each file is replaced as a whole.

    parquet: whether to write Parquet files. Existing ones are updated in any case, or deleted where pyarrow is missing.
    """
    write_tables(table, parquet)
    stored = {word: getattr(table, word) for word in WORDS}
    text = json.dumps(stored | {"sum": _sum_of(stored)}, indent=1, ensure_ascii=False, allow_nan=False)
    write_text(table.folder / STORED, text + "\n")


def write_tables(table: CampaignTable, parquet: bool = False) -> None:
    """Write the table for other programs: all files but campaign.json, from which `crosscheck report` writes them again."""
    numeric = [key for key, values in table.axes.items() if all(type(value) in (int, float) for value in values)]
    columns = {"results": result_columns(list(table.axes), numeric), "costs": COSTS}
    rows = {"results": table.rows, "costs": table.costs}
    for name, of_table in columns.items():
        write_text(table.folder / f"{name}.csv", _csv(list(of_table), rows[name]))
        place = table.folder / f"{name}.parquet"
        is_there = place.is_file()
        if parquet or (is_there and importlib.util.find_spec("pyarrow")):
            write_whole(place, _parquet(of_table, rows[name]))
        elif is_there:  # pandas would read the rows of an earlier campaign
            place.unlink()
    _write_hdf5(table.folder / "campaign.h5", columns, rows)


def _sum_of(stored: Mapping[str, Any]) -> str:
    content = {name: value for name, value in stored.items() if name != "sum"}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _csv(columns: list[str], rows: list[dict[str, Any]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([_cell(row.get(column)) for column in columns] for row in rows)
    return text.getvalue()


def _cell(value: Any) -> str:
    """Return a value as text that no spreadsheet runs as a formula: a number with all digits, an array as JSON, "" for None."""
    if value is None or isinstance(value, str):
        return f"'{value}" if value and value[0] in FORMULA else value or ""
    return json.dumps(value)


def _write_hdf5(path: Path, columns: Mapping[str, Mapping[str, Column]], rows: Mapping[str, list[dict[str, Any]]]) -> None:
    """Write one group per table and one dataset per column, with unit and meaning, sealed like case.h5 and run.h5.

    Numbers and counts are f8, NaN where undefined; an undefined text is "".
    """
    fields, values = [], {}
    for table, of_table in columns.items():
        for name, (unit, meaning, kind) in of_table.items():
            cells = [row.get(name) for row in rows[table]]
            place, is_text = f"{table}/{name}", kind == "text"
            values[place] = [_cell(value) if is_text else np.nan if value is None else value for value in cells]
            fields.append(exchange.Field(place, "str" if is_text else "f8", (table,), unit, meaning))
    digest = hashlib.sha256(json.dumps(rows["results"], sort_keys=True).encode()).hexdigest()
    exchange.write(path, tuple(fields), values, digest, is_dated=False)  # `crosscheck report` writes the same bytes again, at any time


def _parquet(columns: Mapping[str, Column], rows: list[dict[str, Any]]) -> bytes:
    """Return the table as Parquet, null where undefined; the command has checked that pyarrow is installed."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.parquet as pq  # noqa: PLC0415

    types: dict[Kind, Any] = {"text": pa.string(), "number": pa.float64(), "count": pa.int64()}
    arrays = {}
    for name, column in columns.items():
        cells = [row.get(name) for row in rows]
        values = [value if value is None or column.kind != "text" else _cell(value) for value in cells]
        arrays[name] = pa.array(values, types[column.kind])
    content = io.BytesIO()
    pq.write_table(pa.table(arrays), content)
    return content.getvalue()
