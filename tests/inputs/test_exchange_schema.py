"""Every field of the files states its meaning and its unit."""

from dataclasses import fields
from pathlib import Path

import h5py
import pytest
from exchange_files import write_wall

from la_core import exchange
from la_core.analysis.result import LimitAnalysis
from la_core.exchange.fields import CASE_FIELDS, RUN_FIELDS, solution_fields
from la_core.limit.associated import Solution
from la_core.scene.scene import Scene


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scene, LimitAnalysis]:
    return write_wall(tmp_path_factory.mktemp("case"))


SCHEMA = CASE_FIELDS + solution_fields("associated/least") + RUN_FIELDS


def test_every_field_says_what_it_means_and_in_which_unit() -> None:
    paths = [field.path for field in SCHEMA]
    assert len(set(paths)) == len(paths)
    for field in SCHEMA:
        assert len(field.meaning) > 5, field.path
        assert field.dtype in ("f8", "i8", "u1", "str"), field.path
        assert bool(field.unit) == (field.dtype == "f8"), field.path  # "-" for a ratio; counts, flags and texts have none


def test_schema_table_lists_every_field() -> None:
    rows = exchange.schema_table(SCHEMA).splitlines()[2:]
    assert len(rows) == len(SCHEMA)
    for row, field in zip(rows, SCHEMA, strict=True):
        assert row.startswith(f"| {field.path} | {field.dtype} |") and row.endswith(f"| {field.unit} | {field.meaning} |")


def test_every_dataset_carries_unit_and_meaning(case) -> None:
    path, _, _ = case
    with h5py.File(path) as file:
        for field in CASE_FIELDS:
            assert file[field.path].attrs["unit"] == field.unit and file[field.path].attrs["meaning"] == field.meaning


def test_every_solution_value_has_a_field() -> None:
    names = [field.path.rsplit("/", 1)[1] for field in solution_fields("x")]
    assert sorted(names) == sorted(field.name for field in fields(Solution))


def test_values_that_a_live_load_makes_a_multiplier_say_that_they_then_have_no_unit() -> None:
    meanings = {field.path: field.meaning for field in RUN_FIELDS}
    for path in ("result/reaction", "result/uncertainty", "record/reaction"):
        assert "multiplier" in meanings[path] and "no unit" in meanings[path], path


def test_the_rules_of_settings_know_which_ones_are_whole_numbers() -> None:
    from yade_scripts.settings import Settings

    assert {field.name for field in fields(Settings)} == set(exchange.SETTINGS)
    for field in fields(Settings):
        assert (exchange.broken_rule(field.name, 0.5) == "a whole number") == (field.type is int), field.name
