"""All words that users type, write and read: verbs, options, exit codes, scene and campaign keys, JSON keys, HDF5 paths, columns.

`python tests/helpers/contract_list.py` prints the list. Version 0.2.0 wrote `tests/helpers/contract.json` by it, and the words of later
versions were added. All words in that file must stay.
"""

import argparse
import contextlib
import io
import json
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import comparison
import la_core
from comparison.campaign.columns import COSTS, result_columns
from comparison.campaign.definition import CampaignFile
from comparison.cli.arguments import parser
from comparison.cli.commands import main
from comparison.cli.exit_codes import AGREE, CANNOT_STAND, DISAGREE, INCONCLUSIVE, INTERRUPTED, TOOL, USAGE
from comparison.run_folder import WRITTEN
from comparison.settings import Settings
from comparison.verdict import Verdict
from la_core import exchange
from la_core.scene.schema.scene_file import SceneFile

FREE_KEYS = ("settings", "provenance", "reasons", "shared_inset", "saved")  # objects whose keys depend on the scene
SOLVED = {"wall_third": ("--path",), "ferris_tin_loi_1": (), "two_pads": ()}


def contract() -> dict[str, Any]:
    """Return the whole list. Runs limit analysis on SOLVED, and both methods on one scene."""
    (commands,) = [action for action in parser()._actions if isinstance(action, argparse._SubParsersAction)]
    fields = [*exchange.CASE_FIELDS, *exchange.solution_fields("G"), *exchange.coulomb_fields("G"), *exchange.PATH_FIELDS]
    fields += [exchange.FIRST_PREDICTION, *exchange.PART_FIELDS, exchange.JOINT_INSET, exchange.LIVE_DIRECTION, *exchange.LOAD_FIELDS]
    fields += [exchange.SUPPORT_TWISTS, exchange.SWAY, exchange.LONG_RUN_SETTINGS, *exchange.RELEASE_FIELDS, *exchange.PEAK_FIELDS]
    return {
        "verbs": {name: sorted(words(sub)) for name, sub in commands.choices.items()},
        "exit codes": {
            "agree": AGREE, "disagree": DISAGREE, "usage": USAGE, "tool": TOOL, "inconclusive": INCONCLUSIVE, "interrupted": INTERRUPTED,
            "cannot stand": CANNOT_STAND,
        },
        "verdicts": [verdict.value for verdict in Verdict],
        "settings": sorted(Settings.model_fields),
        "scene keys": sorted(schema_keys(SceneFile.model_json_schema())),
        "campaign keys": sorted(schema_keys(CampaignFile.model_json_schema())),
        "yade settings": sorted(exchange.SETTINGS),
        "case.h5": {field.path: f"{field.dtype}, {field.unit}" for field in fields},
        "run.h5": {field.path: f"{field.dtype}, {field.unit}" for field in exchange.RUN_FIELDS},
        "results.csv": list(result_columns(())),
        "costs.csv": list(COSTS),
        "files": sorted(WRITTEN),
        "stable names": {package.__name__: package.__all__ for package in (la_core, comparison)},
        "solve --json": {scene: sorted(set(json_keys(solved(scene, *options)))) for scene, options in SOLVED.items()},
        "comparison.json": sorted(set(json_keys(compared()))),
    }  # fmt: skip


def words(command: argparse.ArgumentParser) -> Iterator[str]:
    """Yield the options of a command, and the names of its positional arguments in the help."""
    for action in command._actions:
        yield from action.option_strings or [str(action.metavar)]


def schema_keys(schema: dict[str, Any]) -> Iterator[str]:
    """Return the dotted keys of a JSON Schema, with `[]` for the entries of an array of tables."""

    def below(node: dict[str, Any], path: str) -> Iterator[str]:
        for part in (node, *node.get("anyOf", ()), *node.get("allOf", ())):
            reference = part.get("$ref")
            if reference:
                yield from below(schema["$defs"][reference.rsplit("/", 1)[1]], path)
            if isinstance(part.get("items"), dict):
                yield from below(part["items"], f"{path}[]")
            for name, child in part.get("properties", {}).items():
                key = f"{path}.{name}".removeprefix(".")
                values = [f"{key}={value}" for choice in (child, *child.get("anyOf", ())) for value in choice.get("enum", ())]
                yield from [key, *values]
                yield from below(child, key)

    return below(schema, "")


def json_keys(value: Any, path: str = "") -> Iterator[str]:
    """Yield the dotted keys of an object, with `[]` for the entries of an array."""
    if isinstance(value, dict):
        for name, item in value.items():
            key = f"{path}.{name}".removeprefix(".")
            yield key
            if name not in FREE_KEYS:
                yield from json_keys(item, key)
    elif isinstance(value, list):
        for item in value:
            yield from json_keys(item, f"{path}[]")


def solved(scene: str, *options: str) -> dict[str, Any]:
    """Return the output of `crosscheck solve --json`."""
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()) as printed:
        main(["solve", scene, "--json", "-q", "--results", folder, *options])
    return dict(json.loads(printed.getvalue()))


def compared() -> dict[str, Any]:
    """Return comparison.json of a scene by both methods, as `crosscheck run` stores it."""
    with tempfile.TemporaryDirectory() as folder:
        main(["run", "two_pads", "-q", "-o", folder])
        return dict(json.loads((Path(folder) / "two_pads" / "comparison.json").read_text(encoding="utf-8")))


if __name__ == "__main__":
    print(json.dumps(contract(), indent=1))
