"""Tables of campaign keys, campaign columns, settings, and fields of HDF5 files, written into the pages that explain them.

`.venv/bin/python tests/benchmarks/program_keys.py` rewrites the marked parts. A test fails when a part is out of date.
"""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
from pathlib import Path

import scene_keys

from comparison.campaign.columns import COSTS, result_columns
from comparison.campaign.definition import CampaignFile
from comparison.settings import PREFIX, Settings
from la_core import exchange

COMPARISON = scene_keys.ROOT / "comparison"
HEADINGS = {"CampaignFile": "Top of the file", "Sweep": "`[[sweep]]`"}


def campaign_keys() -> str:
    """Every key of a campaign file."""
    schema = CampaignFile.model_json_schema()
    tables = {"CampaignFile": schema, **schema["$defs"]}
    parts = [part for name, heading in HEADINGS.items() for part in (f"### {heading}", *scene_keys.described(tables[name], HEADINGS))]
    return "\n\n".join(parts)


def campaign_columns() -> str:
    """Every column of results.csv and costs.csv; `KEY` stands for a varied key."""
    tables = {"`results.csv`": result_columns(("KEY",)), "`costs.csv`": COSTS}
    parts = []
    for heading, columns in tables.items():
        rows = [f"| `{name}` | {column.unit} | {column.meaning} |" for name, column in columns.items()]
        parts += [f"### {heading}", "\n".join(["| column | unit | meaning |", "|---|---|---|", *rows])]
    return "\n\n".join(parts)


def settings() -> str:
    """Every setting of the program."""
    rows = ["| setting | variable | meaning | default |", "|---|---|---|---|"]
    for name, field in Settings.model_fields.items():
        default = f"`{field.default}`" if field.default is not None else "–"
        rows.append(f"| `{name}` | `{PREFIX}{name.upper()}` | {field.description} | {default} |")
    return "\n".join(rows)


def hdf5_fields() -> str:
    """Every field of case.h5 and run.h5; `GROUP` stands for one of limit analysis' answers."""
    parts = [
        ("### `case.h5`: structure", exchange.schema_table(exchange.CASE_FIELDS)),
        ("### `case.h5`: where a block has several convex parts", exchange.schema_table(exchange.PART_FIELDS)),
        ("### `case.h5`: where the inset of a joint is not that of the scene", exchange.schema_table((exchange.JOINT_INSET,))),
        ("### `case.h5`: unless it is of version 0.2.0", exchange.schema_table((exchange.SWAY,))),
        ("### `case.h5`: where the path of limit analysis was long", exchange.schema_table((exchange.LONG_RUN_SETTINGS,))),
        ("### `case.h5`: where a live load drives the structure", exchange.schema_table((exchange.LIVE_DIRECTION,))),
        ("### `case.h5`: where supports move by different shares", exchange.schema_table((exchange.SUPPORT_TWISTS,))),
        ("### `case.h5`: where loads or ties act on blocks", exchange.schema_table(exchange.LOAD_FIELDS)),
        ("### `case.h5`: where an effect was restored after a run in YADE", exchange.schema_table((exchange.FIRST_PREDICTION,))),
        ("### `case.h5`: associated answers", exchange.schema_table(exchange.solution_fields("GROUP"))),
        ("### `case.h5`: Coulomb predictions", exchange.schema_table(exchange.coulomb_fields("GROUP"))),
        ("### `case.h5`: where the paths of the prediction went on with turning blocks", exchange.schema_table(exchange.RELEASE_FIELDS)),
        ("### `case.h5`: where the curve of a live load rises above its plateau", exchange.schema_table(exchange.PEAK_FIELDS)),
        ("### `case.h5`: the path, where one is requested", exchange.schema_table(exchange.PATH_FIELDS)),
        ("### `run.h5`", exchange.schema_table(exchange.RUN_FIELDS)),
    ]
    return "\n\n".join(text for part in parts for text in part)


PARTS = {  # by name of the part: its page, and the function that writes it
    "campaign keys": (COMPARISON / "campaign" / "README.md", campaign_keys),
    "campaign columns": (COMPARISON / "campaign" / "README.md", campaign_columns),
    "settings": (COMPARISON / "cli" / "README.md", settings),
    "fields": (scene_keys.ROOT / "la_core" / "exchange" / "README.md", hdf5_fields),
}


def mark(name: str) -> str:
    """Return the comment at the start of a part."""
    return f"{name}, written by tests/benchmarks/program_keys.py"


def rewritten(name: str) -> tuple[Path, str]:
    """Return the path of a page, and its text with one part written anew."""
    path, part = PARTS[name]
    return path, scene_keys.with_part(path.read_text(encoding="utf-8"), mark(name), part())


if __name__ == "__main__":
    for name in PARTS:
        path, text = rewritten(name)
        path.write_text(text, encoding="utf-8")
        print(f"written: {path}")
