"""A campaign's tables: results and costs, one row a case in the campaign's order, as CSV, HDF5, JSON and where asked for Parquet.

Every column is of one kind, texts or numbers, whatever the cases came to. pandas reads CSV and Parquet by itself; a group of campaign.h5 is
`pandas.DataFrame({name: c.asstr()[()] if c.dtype.kind == "S" else c[()] for name, c in h5py.File("campaign.h5")["results"].items()})`.

results.csv holds nothing that hangs on the machine's speed or on where a case was run: two campaigns that agree have the same bytes.
"""

import csv
import hashlib
import io
import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from comparison.campaign.columns import COSTS, Column, Kind, result_columns
from comparison.run_folder import write_text
from la_core import exchange
from la_core.exchange import ExchangeError, write_whole

STORED = "campaign.json"
WORDS = ("title", "axes", "labels", "rows", "costs", "provenance")


@dataclass(frozen=True)
class CampaignTable:
    """What a campaign came to.

    axes: varied keys, by their dotted paths, with their values in the campaign's order. rows: one a case that ended, in the
    campaign's order, keyed by the columns of results.csv, and "folder", relative to `folder`, which holds the case's report.html; None
    is undefined. costs: likewise, by the columns of costs.csv. labels: short names of axes. folder: of the campaign.
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
        """Rows of the cases that failed."""
        return [row for row in self.rows if row["state"] == "failed"]


def read_campaign(folder: Path) -> CampaignTable:
    """The table of a campaign's folder; raises ExchangeError where there is none, or one that this program did not write."""
    path = folder / STORED
    try:
        stored = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ExchangeError(f"{path}: cannot be read ({error.strerror}); run `crosscheck campaign` again") from error
    except (ValueError, RecursionError) as error:
        raise ExchangeError(f"{path}: damaged or cut short; run `crosscheck campaign` again") from error
    if not isinstance(stored, dict) or stored.get("sum") != _sum_of(stored):
        raise ExchangeError(f"{path}: changed or damaged since it was written; run `crosscheck campaign` again")
    return CampaignTable(folder=folder, **{word: stored[word] for word in WORDS})


def write_campaign(table: CampaignTable, parquet: bool = False) -> None:
    """Write every form of the table into its folder; each file is whole, or what was there before."""
    numeric = [key for key, values in table.axes.items() if all(type(value) in (int, float) for value in values)]
    columns = {"results": result_columns(list(table.axes), numeric), "costs": COSTS}
    rows = {"results": table.rows, "costs": table.costs}
    for name, found in columns.items():
        write_text(table.folder / f"{name}.csv", _csv(list(found), rows[name]))
        if parquet:
            write_whole(table.folder / f"{name}.parquet", _parquet(found, rows[name]))
    _write_hdf5(table.folder / "campaign.h5", columns, rows)
    stored = {word: getattr(table, word) for word in WORDS}
    write_text(table.folder / STORED, json.dumps(stored | {"sum": _sum_of(stored)}, indent=1, ensure_ascii=False, allow_nan=False) + "\n")


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
    """A value as text: all digits of a number, "" for an undefined one, JSON for an array."""
    if value is None or isinstance(value, str):
        return value or ""
    return json.dumps(value)


def _write_hdf5(path: Path, columns: Mapping[str, Mapping[str, Column]], rows: Mapping[str, list[dict[str, Any]]]) -> None:
    """One group a table, one dataset a column, with unit and meaning; sealed as case and run are.

    Numbers and counts are f8, NaN where undefined; texts are "" there.
    """
    fields, values = [], {}
    for table, found in columns.items():
        for name, (unit, meaning, kind) in found.items():
            own = [row.get(name) for row in rows[table]]
            place, is_text = f"{table}/{name}", kind == "text"
            values[place] = [_cell(value) if is_text else np.nan if value is None else value for value in own]
            fields.append(exchange.Field(place, "str" if is_text else "f8", (table,), unit, meaning))
    digest = hashlib.sha256(json.dumps(rows["results"], sort_keys=True).encode()).hexdigest()
    exchange.write(path, tuple(fields), values, digest)


def _parquet(columns: Mapping[str, Column], rows: list[dict[str, Any]]) -> bytes:
    """The table as Parquet, null where undefined; pyarrow is an extra, which the command has seen to."""
    import pyarrow as pa  # noqa: PLC0415
    import pyarrow.parquet as pq  # noqa: PLC0415

    types: dict[Kind, Any] = {"text": pa.string(), "number": pa.float64(), "count": pa.int64()}
    arrays = {}
    for name, column in columns.items():
        own = [row.get(name) for row in rows]
        shown = [value if value is None or column.kind != "text" else _cell(value) for value in own]
        arrays[name] = pa.array(shown, types[column.kind])
    content = io.BytesIO()
    pq.write_table(pa.table(arrays), content)
    return content.getvalue()
