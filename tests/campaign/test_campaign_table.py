"""The table of a campaign states the results of each case, the same in every file format."""

import csv
import io
import json
import math
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from campaigns import Inline, run, sweep

import comparison
from comparison.campaign import columns, table
from comparison.campaign.cases import expand
from comparison.campaign.definition import load_campaign
from comparison.campaign.mechanism_changes import letter
from comparison.campaign.mechanism_labels import mechanism_label
from comparison.campaign.row_groups import is_number, ordered
from comparison.campaign.row_values import mechanism_name, verdict_counts
from comparison.cli.study_verbs.campaign import exit_code
from comparison.studies.sensitivity import study
from la_core.analysis.stage import analyse
from la_core.exchange.checksummed_file import ExchangeError
from la_core.limit.classic_iteration import ClassicParameters
from la_core.model.assembly import assemble
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find

ROUND_OFF = 1e-7  # of a speed: residuals of accepted mechanisms are below it


def test_a_row_says_what_both_analyses_of_its_scene_say(tmp_path: Path, plain_figures: None) -> None:
    found = run(sweep('vary = { "joint.friction" = [0.3, 0.6] }', "two_blocks"), tmp_path / "out")
    assert [row["joint.friction"] for row in found.rows] == [0.3, 0.6]
    for row in found.rows:
        weight, friction = row["weight"] / 2.0, row["joint.friction"]
        # the reaction under the right one of two equal blocks: W_b/(1 + mu^2) by the associated law, W_b without dilatancy
        assert row["least"] == pytest.approx(weight / (1.0 + friction**2), rel=1e-4)
        assert row["coulomb"] == pytest.approx(weight, rel=1e-3)
        assert 0.0 < row["coulomb_uncertainty"] < 1e-2 * weight and row["coulomb_plateaus"] == 1 and row["coulomb_sharp"] is None
        assert row["unit"] == "N" and row["free_blocks"] == 2 and row["yade"] is None and row["yade_status"] is None
        assert row["associated_mechanism"] == row["coulomb_mechanism"] and row["yade_mechanism"] is None
        assert (tmp_path / "out" / row["folder"] / "report.html").is_file()
    assert [cost["case"] for cost in found.costs] == [row["case"] for row in found.rows]


def test_sharp_edges_are_told_at_the_inset_that_yade_is_judged_by(tmp_path: Path, plain_figures: None) -> None:
    (row,) = run(sweep('set = { "joint.inset" = 0.0 }'), tmp_path / "out").rows
    analysis = analyse(expand(load_campaign(tmp_path / "campaign.toml"))[0].run.scene())
    assert analysis.assembly.inset > 0.0
    assert row["least"] == analysis.bounds[analysis.main].value != analysis.sharp.bounds[analysis.main].value
    assert analysis.coulomb is not None and row["coulomb"] == analysis.coulomb.value
    assert row["coulomb_sharp"] == analysis.sharp.coulomb.value


def test_a_live_load_is_a_multiplier(tmp_path: Path, plain_figures: None) -> None:
    (row,) = run(sweep("", "ferris_tin_loi_1"), tmp_path / "out").rows
    analysis = analyse(expand(load_campaign(tmp_path / "campaign.toml"))[0].run.scene())
    assert row["unit"] == "" and row["greatest"] is None
    assert row["least"] == analysis.bounds[analysis.main].value < 0.64286  # contact points drawn in from the edges bear less
    assert row["coulomb_sharp"] == pytest.approx(0.63982, rel=3e-3)  # as published


def test_the_classic_iteration_s_answer_is_that_of_the_sensitivity_study_and_its_scene_runs_once(
    tmp_path: Path, plain_figures: None
) -> None:
    slopes, relaxations = (0.01, 0.1), (0.4, 1.0)
    engine = Inline()
    text = sweep(f'vary = {{ "classic.slope" = {list(slopes)}, "classic.relaxation" = {list(relaxations)} }}', "two_blocks")
    found = run(text, tmp_path / "out", engine)
    assert engine.done == ["two_blocks"]
    assert [row["case"] for row in found.rows][1] == "two_blocks_slope=0.01_relaxation=1.0"
    scene = load_scene(find("two_blocks"))
    expected = study(scene, assemble(scene), relaxations, slopes, ClassicParameters())
    for row, trial in zip(found.rows, expected.trials, strict=True):
        assert (row["classic.slope"], row["classic.relaxation"]) == (trial.slope, trial.relaxation)
        assert row["classic"] == (None if math.isnan(trial.value) else trial.value)
        assert (row["classic_status"], row["classic_iterations"]) == (trial.status.value, trial.iterations)


@pytest.mark.slow
def test_tables_for_pandas_are_never_those_of_an_earlier_campaign(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    from pyarrow import parquet

    out = tmp_path / "out"
    found = run(sweep('vary = { "joint.friction" = [0.3, 0.6] }', "two_blocks"), out)
    assert not list(out.glob("*.parquet"))
    table.write_campaign(found, parquet=True)
    run(sweep('vary = { "joint.friction" = [0.5] }', "two_blocks"), out)
    assert parquet.read_table(out / "results.parquet").column("joint.friction").to_pylist() == [0.5]
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)  # no library can write the files any more
    table.write_campaign(found)
    assert not list(out.glob("*.parquet"))
    (out / "results.parquet").mkdir()  # the user's own: other programs write folders with such names
    table.write_campaign(found)
    assert (out / "results.parquet").is_dir()


def test_every_form_of_the_table_says_the_same(tmp_path: Path, plain_figures: None) -> None:
    out = tmp_path / "out"
    found = run(sweep('vary = { "joint.friction" = [0.3, 0.6], "effects.plane" = ["auto", true] }', "two_blocks"), out)
    table.write_campaign(found, parquet=True)
    assert table.read_table(out) == found
    rows = list(csv.DictReader(io.StringIO((out / "results.csv").read_text(encoding="utf-8"))))
    names = list(columns.result_columns(list(found.axes)))
    assert list(rows[0]) == names
    from pyarrow import parquet

    as_parquet = parquet.read_table(io.BytesIO((out / "results.parquet").read_bytes())).to_pylist()
    with h5py.File(out / "campaign.h5") as file:
        for name in names:
            stored = file[f"results/{name}"]
            assert stored.attrs["meaning"] and stored.attrs["unit"] == columns.result_columns(list(found.axes))[name][0]
            for k, row in enumerate(found.rows):
                value, text = row[name], rows[k][name]
                if isinstance(value, float):
                    assert float(text) == stored[k] == as_parquet[k][name] == value  # to the last digit
                elif isinstance(value, int) and not isinstance(value, bool):
                    assert int(text) == stored[k] == as_parquet[k][name] == value
                elif value is None:
                    assert text == "" and (stored.asstr()[k] == "" if stored.dtype.kind == "S" else np.isnan(stored[k]))
                else:
                    assert text == stored.asstr()[k] == as_parquet[k][name] == (value if isinstance(value, str) else json.dumps(value))
        assert file["costs/seconds"].attrs["unit"] == "s" and np.all(file["costs/seconds"][()] > 0.0)


@pytest.mark.parametrize("name", ["=1+1", "+1", "-1", "@SUM(A1)"])
def test_no_name_is_a_formula_in_a_spreadsheet(name: str, tmp_path: Path, plain_figures: None) -> None:
    found = run(sweep(f'name = "{name}"\nvary = {{ "joint.friction" = [0.6] }}', "two_blocks"), tmp_path / "out")
    assert [row["sweep"] for row in found.rows] == [name]
    with (tmp_path / "out" / "results.csv").open(newline="") as file:
        (row,) = csv.DictReader(file)
    assert row["sweep"] == f"'{name}" and float(row["least"]) > 0.0


def test_the_types_of_columns_do_not_hang_on_what_the_cases_came_to(tmp_path: Path) -> None:
    """pandas makes a frame from the arrays of a group in h5py, one for each column, so their types must not depend on their values."""
    from pyarrow import parquet

    axes: dict[str, list[Any]] = {"joint.friction": [0.3, 1], "effects.plane": ["auto", True]}
    found = columns.result_columns(list(axes), ["joint.friction"])
    one: dict[columns.Kind, Any] = {"text": "words", "number": 0.1, "count": 3}
    full = {name: one[column.kind] for name, column in found.items()} | {"joint.friction": 1}
    costs = {name: one[column.kind] for name, column in columns.COSTS.items()}
    rows = {"full": [full, full], "undefined": [dict.fromkeys(full), dict.fromkeys(full)], "none": list[Any]()}
    arrays, types = {}, {}
    for name, own in rows.items():
        (tmp_path / name).mkdir()
        spent = [costs if row["case"] else dict.fromkeys(costs) for row in own]
        table.write_campaign(table.CampaignTable("title", axes, own, spent, {}, tmp_path / name), parquet=True)
        types[name] = [parquet.read_schema(tmp_path / name / f"{stem}.parquet") for stem in ("results", "costs")]
        with h5py.File(tmp_path / name / "campaign.h5") as file:
            arrays[name] = {
                f"{stem}/{key}": column.asstr()[()] if column.dtype.kind == "S" else column[()]
                for stem in ("results", "costs")
                for key, column in file[stem].items()
            }
    assert types["full"] == types["undefined"] == types["none"]
    for key, array in arrays["full"].items():
        undefined = arrays["undefined"][key]
        assert array.dtype.kind == undefined.dtype.kind == arrays["none"][key].dtype.kind and len(array) == len(undefined) == 2
        assert np.all(np.isnan(undefined) if array.dtype.kind == "f" else undefined == "")
    as_csv = np.genfromtxt(tmp_path / "full" / "results.csv", delimiter=",", names=True, dtype=None, encoding="utf-8", deletechars="")
    for key in found:
        assert np.all(as_csv[key] == arrays["full"][f"results/{key}"])
    for row in parquet.read_table(tmp_path / "undefined" / "results.parquet").to_pylist():
        assert set(row.values()) == {None}


@pytest.mark.parametrize("damage", [lambda text: text.replace("0.3", "0.4", 1), lambda text: text[:-20], lambda text: "[" * 10**5])
def test_a_damaged_table_is_never_read(damage, tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    rows = [dict.fromkeys(columns.result_columns([])) | {"case": "a", "least": 0.3, "state": "done"}]
    table.write_campaign(table.CampaignTable("title", {}, rows, [{"case": "a"}], {}, out))
    assert table.read_table(out).rows == rows
    stored = out / table.STORED
    stored.write_text(damage(stored.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(ExchangeError, match="run `crosscheck campaign` again"):
        table.read_table(out)


def test_a_table_that_may_not_be_read_is_one_to_ask_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def closed(path: Path) -> str:
        raise PermissionError(13, "Permission denied", str(path))

    monkeypatch.setattr(table, "read_text", closed)
    with pytest.raises(ExchangeError, match=r"campaign.json: it may not be read by you: ask its owner"):
        table.read_table(tmp_path)


def test_a_folder_without_a_campaign_is_told_with_the_command_that_makes_one(tmp_path: Path) -> None:
    for folder in (tmp_path, tmp_path / "nowhere"):
        with pytest.raises(ExchangeError, match="holds no results of `crosscheck campaign`; `crosscheck campaign FILE` makes some") as told:
            comparison.read_campaign(folder)
        assert str(told.value).startswith(f"{folder}: ")


def test_a_table_with_an_earlier_word_for_a_verdict_is_read_counted_and_judged(tmp_path: Path) -> None:
    rows = [
        dict.fromkeys(columns.result_columns([])) | {"case": word, "verdict": word, "state": "done"}
        for word in ("expected value met", "agree")
    ]
    table.write_campaign(table.CampaignTable("title", {}, rows, [{"case": row["case"]} for row in rows], {}, tmp_path))
    found = table.read_table(tmp_path)
    assert [row["verdict"] for row in found.rows] == ["expected", "agree"]
    assert verdict_counts(found.rows) == "1 expected value met (YADE not run), 1 agree" and exit_code(found) == 0


@pytest.mark.parametrize("scene", ["wall_third", "arch_spreading"])
def test_labels_of_mechanisms_are_equal_for_equal_ones_and_stand_round_off(scene: str) -> None:
    analysis = analyse(load_scene(find(scene)))
    blocks, twists = analysis.assembly.blocks, analysis.bounds[analysis.main].twists
    label = mechanism_label(analysis.assembly, twists)
    noise = np.random.default_rng(5).normal(size=(20, *twists.shape)) * ROUND_OFF * np.abs(twists).max()
    assert {mechanism_label(analysis.assembly, 7.0 * (twists + one)) for one in noise} == {label}
    fastest = int(np.argmax(np.where(blocks.free, np.abs(twists).max(axis=1), 0.0)))
    without = twists.copy()
    without[fastest] = 0.0
    assert label is not None and mechanism_label(analysis.assembly, without) not in (label, None)
    assert (
        mechanism_label(analysis.assembly, np.zeros_like(twists)) is None
        and mechanism_label(analysis.assembly, np.full_like(twists, np.nan)) is None
    )


def test_where_the_support_moves_alone_no_block_moves_whatever_round_off_is_left() -> None:
    assembly = analyse(load_scene(find("two_pads"))).assembly
    blocks = assembly.blocks
    twists = np.zeros((len(blocks.free), 6))
    twists[blocks.names.index("settling pad")] = [0.0, 0.0, -1.0, 0.0, 0.0, 0.0]
    noise = np.random.default_rng(5).normal(size=(20, *twists.shape)) * ROUND_OFF * blocks.free[:, None]
    labels = {mechanism_label(assembly, twists + one) for one in (np.zeros_like(twists), *noise)}
    assert len(labels) == 1 and str(labels.pop()).startswith("0-")


def test_true_is_a_choice_and_no_number_and_choices_follow_numbers_in_their_own_order() -> None:
    """In Python true equals 1, but a sweep of an effect, on and off, has no axis of numbers."""
    assert json.dumps(ordered([True, 2, 1.0, 1, False, "auto", 0.5], ["auto", False, True])) == '[0.5, 1, 2, "auto", false, true]'
    assert [is_number(value) for value in (1, 1.0, True, False, "1", None)] == [True, True, *[False] * 4]


def test_mechanisms_have_letters_as_the_columns_of_a_spreadsheet_have() -> None:
    assert [letter(k) for k in (0, 1, 25, 26, 27, 51, 52, 701, 702)] == ["A", "B", "Z", "AA", "AB", "AZ", "BA", "ZZ", "AAA"]


@pytest.mark.parametrize(("status", "label"), [(None, "2-a"), ("solved", "3-c"), ("inaccurate", "3-c")])
def test_the_mechanism_of_limit_analysis_is_that_of_the_prediction_where_one_was_asked_for(status: str | None, label: str) -> None:
    row = {
        "coulomb_status": status,
        "coulomb": None if status is None else 0.1,
        "associated_mechanism": "2-a",
        "coulomb_mechanism": "3-c",
        "yade_mechanism": "4-y",
    }
    assert [mechanism_name(row, method) for method in ("limit", "associated", "coulomb", "yade")] == [label, "2-a", "3-c", "4-y"]
