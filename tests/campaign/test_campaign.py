"""A campaign file says which cases there are; their table says what each came to, once, in order, whoever ran it."""

import csv
import dataclasses
import io
import json
import math
import os
import signal
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import h5py
import numpy as np
import pytest
from campaigns import QUICK, Inline, begun, finished, run
from conftest import Silent
from faulty_runs import INTERRUPTED

from comparison.campaign import columns, job, table
from comparison.campaign.cases import LONGEST, axes, expand
from comparison.campaign.definition import MOST_CASES, load_campaign
from comparison.campaign.job import LOADED, OTHER_CODE, Job, failure, run_job
from comparison.campaign.mechanism_labels import mechanism_label
from comparison.cli.commands import main
from comparison.cli.study_verbs.campaign import find_campaign
from comparison.errors import FolderInUseError
from comparison.run_folder import alone_in
from comparison.studies.sensitivity import study
from comparison.workflow.one_scene import read_results
from la_core.analysis.stage import analyse
from la_core.errors import SceneError
from la_core.exchange.checksummed_file import ExchangeError
from la_core.limit.classic_iteration import ClassicParameters
from la_core.model.assembly import assemble
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find

ROUND_OFF = 1e-7  # of a speed: residuals of accepted mechanisms are below it


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "campaign.toml"
    path.write_text(text, encoding="utf-8")
    return path


def sweep(text: str, scene: str = "two_pads") -> str:
    return f'yade = false\n[[sweep]]\nscene = "{scene}"\n{text}\n'


# --- the file -----------------------------------------------------------------------------------------------------------------

WRONG = {
    "not TOML": ("sweep = [", "not valid TOML"),
    "no sweep": ('title = "nothing"', "sweep: missing"),
    "a scene": ("[joint]\nfriction = 0.6\n[stone]\ndensity = 2000.0", "the file: is a scene, not a campaign; a campaign names it"),
    "misspelt key": ('yad = true\n[[sweep]]\nscene = "two_pads"', 'yad: unknown key; did you mean "yade"?'),
    "misspelt key of a sweep": (sweep("[sweep.varry]\na = [1]"), 'varry: unknown key; did you mean "vary"?'),
    "wrong type": ('yade = "no"\n[[sweep]]\nscene = "two_pads"', "yade = 'no': must be true or false"),
    "unknown scene": (sweep("", "two_padz"), 'did you mean "two_pads"?'),
    "missing scene file": (sweep("", "nowhere.toml"), "nowhere.toml: cannot be read"),
    "no values": (sweep('vary = { "joint.friction" = [] }'), "joint.friction = []: has too few entries"),
    "no path": (sweep('vary = { "joint friction" = [1.0] }'), '"joint friction": must be a dotted path'),
    "given twice": (sweep('set = { "joint.friction" = 1.0 }\nvary = { "joint.friction" = [1.0] }'), '"joint.friction" is given twice'),
    "unequal lengths": (sweep('together = [{ "joint.friction" = [1.0], "joint.inset" = [0.1, 0.2] }]'), "equally many values"),
    "too many": (sweep(f'vary = {{ "joint.friction" = {[1.0] * 101}, "joint.inset" = {[0.001] * 100} }}'), f"at most {MOST_CASES} cases"),
    "label of nothing": ('labels = { mu = "mu" }\n' + sweep(""), 'no sweep varies "mu"'),
    "unknown key of the scene": (sweep('vary = { "joint.frction" = [0.5] }'), 'joint.frction: unknown key; did you mean "friction"?'),
    "wrong value for the scene": (sweep('vary = { "joint.friction" = [0.5, -1.0] }'), "joint.friction = -1.0: must"),
    "impossible structure": (sweep('set = { "block[2].box.to[0]" = -1.0 }'), "every coordinate of `to` must be greater"),
    "index beyond": (sweep('set = { "block[3].density" = 1.0 }'), "block has 3 entries; [0] is the first"),
    "index missing": (sweep('set = { "block.density" = 1.0 }'), "block is an array; select one of its entries: block[0].density"),
    "index of a table": (sweep('set = { "joint[0]" = 1.0 }'), "joint is not an array"),
    "below a value": (sweep('set = { "joint.friction.x" = 1.0 }'), "joint.friction is a value, not a table"),
    "an array that is not there": (sweep('set = { "wall[0].courses" = 3 }'), "the scene has no wall"),
    "unknown parameter": (sweep('vary = { "classic.slop" = [0.1] }'), 'classic.slop: unknown key; did you mean "slope"?'),
    "wrong kind of parameter": (sweep('vary = { "classic.iterations" = [0.5] }'), "classic.iterations = 0.5: must be a whole number"),
    "impossible parameter": (
        sweep('vary = { "classic.relaxation" = [nan] }'),
        "two_pads_relaxation=nan: classic: needs relaxation in (0, 1], slope from 0, iterations from 1, "
        "and cohesion from 0 and below tolerance; given: relaxation = nan; the others have their defaults",
    ),
    "parameter beyond all numbers": (sweep(f'vary = {{ "classic.slope" = [1{"0" * 400}] }}'), "classic: needs relaxation in (0, 1]"),
    "impossible model": (sweep('vary = { "effects.plane" = [true] }', "slab_four_corners"), "effects.plane = true: "),
}


@pytest.mark.parametrize(("text", "words"), WRONG.values(), ids=WRONG)
def test_a_wrong_file_is_refused_in_one_message_before_anything_runs(
    text: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = written(tmp_path, text)
    assert main(["campaign", str(path), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and said.err.startswith(f"error: {path}: ") and said.err.count("error: ") == 1
    assert words in " ".join(said.err.split())
    assert not (tmp_path / "out").exists()


def test_a_wrong_case_is_named(tmp_path: Path) -> None:
    path = written(tmp_path, sweep('vary = { "joint.friction" = [0.5, -1.0] }'))
    with pytest.raises(SceneError, match=r"campaign\.toml: case two_pads_friction=-1\.0: .*two_pads\.toml: joint\.friction = -1\.0"):
        expand(load_campaign(path))


def test_a_campaign_that_cannot_be_read_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for path in (tmp_path, tmp_path / "nowhere.toml"):
        assert main(["campaign", str(path)]) == 2
        assert str(path) in capsys.readouterr().err


# --- the cases ----------------------------------------------------------------------------------------------------------------


def names(text: str, tmp_path: Path) -> list[str]:
    return [case.name for case in expand(load_campaign(written(tmp_path, text)))]


def test_cases_are_the_product_in_the_order_of_the_file_the_last_key_fastest(tmp_path: Path) -> None:
    together = 'together = [{ "block[0].box.to[0]" = [0.4, 0.45], "block[1].box.from[0]" = [0.5, 0.55] }]'
    text = sweep(f'vary = {{ "joint.friction" = [0.3, 0.6] }}\n{together}') + 'labels = { "joint.friction" = "mu" }'
    text = 'labels = { "joint.friction" = "mu" }\n' + text.removesuffix('labels = { "joint.friction" = "mu" }')
    found = expand(load_campaign(written(tmp_path, text)))
    assert [case.name for case in found] == [
        "two_pads_mu=0.3_to0=0.4", "two_pads_mu=0.3_to0=0.45", "two_pads_mu=0.6_to0=0.4", "two_pads_mu=0.6_to0=0.45",
    ]  # fmt: skip
    keys = ("joint.friction", "block[0].box.to[0]", "block[1].box.from[0]")
    assert [tuple(case.values[key] for key in keys) for case in found] == [
        (0.3, 0.4, 0.5), (0.3, 0.45, 0.55), (0.6, 0.4, 0.5), (0.6, 0.45, 0.55),
    ]  # fmt: skip
    scene = found[1].run.scene()
    assert scene.friction == 0.3 and scene.title.endswith(": mu = 0.3, to0 = 0.45")
    assert scene.blocks.vertices[: scene.blocks.vertex_start[1], 0].max() == 0.45


def test_names_are_unique_short_and_lead_nowhere(tmp_path: Path) -> None:
    odd = '"../../x", "..", "a/b", "$(x)", "A", "a", "%2e%2e/", "é", "", ".", "' + "z" * 300 + '", "' + "z" * 299 + '"'
    found = names(sweep(f'vary = {{ "source" = [{odd}] }}\nname = "../{"n" * 30}"'), tmp_path)
    assert len({name.casefold() for name in found}) == len(found) == 12
    for name in found:
        assert Path(name).name == name and len(name) <= LONGEST + 4 and name.startswith("n" * 30 + "_source=")
        assert not set(name) & set("/\\$()*?[]{}<>|&;:'\" ,")


def test_equal_cases_of_two_sweeps_share_a_run_and_each_row_has_every_value_that_its_scene_has(tmp_path: Path) -> None:
    text = sweep('vary = { "joint.friction" = [0.3, 0.6, 0.6] }')
    text += '[[sweep]]\nscene = "two_pads"\nvary = { "joint.inset" = [0.001, 0.002] }'
    definition = load_campaign(written(tmp_path, text))
    found = expand(definition)
    assert [case.name for case in found] == [f"two_pads_{key}" for key in ("friction=0.3", "friction=0.6", "inset=0.001", "inset=0.002")]
    assert [case.sweep for case in found] == ["two_pads", "two_pads", "two_pads-2", "two_pads-2"]
    assert found[1].run is found[2].run and len({case.run.name for case in found}) == 3
    assert [list(case.values.values()) for case in found] == [[0.3, 0.001], [0.6, 0.001], [0.6, 0.001], [0.6, 0.002]]  # a default
    assert axes(definition, found) == {"joint.friction": [0.3, 0.6], "joint.inset": [0.001, 0.002]}


def test_an_expected_value_holds_for_the_scene_as_it_is_alone(tmp_path: Path) -> None:
    settings = ['"yade.time_limit" = 60.0', '"joint.friction" = 0.5', '"joint.friction" = 0.5\n"expected.tolerance" = 0.1']
    kept = []
    for setting in settings:
        text = sweep(f"[sweep.set]\n{setting}")
        if "expected" in setting:
            text += '"expected.reaction_over_weight" = 0.16667\n"expected.kind" = "exact"\n'
        (case,) = expand(load_campaign(written(tmp_path, text)))
        kept.append(case.run.scene().expected is not None)
    assert kept == [True, False, True]


def test_a_scene_lies_beside_the_campaign_and_its_meshes_beside_the_scene(tmp_path: Path, plain_figures: None) -> None:
    folder = tmp_path / "scenes"
    folder.mkdir()
    for name in ("rubble_wall.toml", "rubble_wall.obj"):
        (folder / name).write_bytes((find("rubble_wall").parent / name).read_bytes())
    text = sweep('vary = { "joint.friction" = [0.5] }', "scenes/rubble_wall.toml")
    (row,) = run(text, tmp_path / "out").rows
    assert row["state"] == "done" and row["coulomb_status"] == "solved"
    scene = load_scene(folder / "rubble_wall.toml")
    assert row["weight"] == scene.weight


# --- the table ----------------------------------------------------------------------------------------------------------------


def test_a_row_says_what_both_analyses_of_its_scene_say(tmp_path: Path, plain_figures: None) -> None:
    found = run(sweep('vary = { "joint.friction" = [0.3, 0.6] }', "two_blocks"), tmp_path / "out")
    assert [row["joint.friction"] for row in found.rows] == [0.3, 0.6]
    for row in found.rows:
        weight, friction = row["weight"] / 2.0, row["joint.friction"]
        # the right one of two equal blocks carries W_b/(1 + mu^2) by the associated law, and its whole weight in truth
        assert row["least"] == pytest.approx(weight / (1.0 + friction**2), rel=1e-4)
        assert row["coulomb"] == pytest.approx(weight, rel=1e-3)
        assert 0.0 < row["coulomb_uncertainty"] < 1e-2 * weight and row["coulomb_plateaus"] == 1 and row["coulomb_sharp"] is None
        assert row["unit"] == "N" and row["free_blocks"] == 2 and row["yade"] is None and row["yade_status"] is None
        assert row["associated_mechanism"] == row["coulomb_mechanism"] and row["yade_mechanism"] is None
        assert (tmp_path / "out" / row["folder"] / "report.html").is_file()
    assert [cost["case"] for cost in found.costs] == [row["case"] for row in found.rows]


def test_sharp_arrises_are_told_at_the_inset_that_yade_is_judged_by(tmp_path: Path, plain_figures: None) -> None:
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
    assert row["least"] == analysis.bounds[analysis.main].value < 0.64286  # drawn in from the edges, the points hold less
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


def test_the_types_of_columns_do_not_hang_on_what_the_cases_came_to(tmp_path: Path) -> None:
    """pandas makes a frame of what h5py gives of a group, one array a column."""
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


@pytest.mark.parametrize("scene", ["wall_third", "arch_spreading"])
def test_labels_of_mechanisms_are_equal_for_equal_ones_and_stand_round_off(scene: str) -> None:
    analysis = analyse(load_scene(find(scene)))
    blocks, twists = analysis.assembly.blocks, analysis.bounds[analysis.main].twists
    label = mechanism_label(blocks, twists)
    noise = np.random.default_rng(5).normal(size=(20, *twists.shape)) * ROUND_OFF * np.abs(twists).max()
    assert {mechanism_label(blocks, 7.0 * (twists + one)) for one in noise} == {label}
    fastest = int(np.argmax(np.where(blocks.free, np.abs(twists).max(axis=1), 0.0)))
    without = twists.copy()
    without[fastest] = 0.0
    assert label is not None and mechanism_label(blocks, without) not in (label, None)
    assert mechanism_label(blocks, np.zeros_like(twists)) is None and mechanism_label(blocks, np.full_like(twists, np.nan)) is None


# --- what is finished is kept -------------------------------------------------------------------------------------------------


def test_finished_cases_are_not_run_again_and_a_new_value_adds_its_own_alone(tmp_path: Path, plain_figures: None) -> None:
    out, engine = tmp_path / "out", Inline()
    first = run(QUICK, out, engine)
    bytes_before = (out / "results.csv").read_bytes()
    again = Inline()
    assert run(QUICK, out, again).rows == first.rows and again.done == []
    assert (out / "results.csv").read_bytes() == bytes_before
    longer = run(QUICK.replace("[0.4, 0.5]", "[0.4, 0.45, 0.5]"), out, again)
    assert again.done == ["two_pads_friction=0.45"]
    assert [row["case"] for row in longer.rows][2:] == [f"two_pads_friction={mu}" for mu in (0.4, 0.45, 0.5)]
    (out / "cases" / "two_blocks_friction=0.3" / "report.html").unlink()
    (out / "cases" / "two_blocks_friction=0.6" / "outcome.json").write_text("{}")
    repaired = Inline()
    assert run(QUICK, out, repaired).rows == first.rows
    assert repaired.done == ["two_blocks_friction=0.3", "two_blocks_friction=0.6"]


def test_a_case_that_fails_is_told_with_its_reason_and_tried_again_by_the_next_call(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"
    text = sweep('vary = { "effects.elasticity" = ["auto", "none"] }', "wall_low_friction")  # only the answer tells that joints slide
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline())
    assert main(["campaign", str(written(tmp_path, text)), "-o", str(out)]) == 3
    said = capsys.readouterr()
    assert "wall_low_friction_elasticity=none: failed: " in said.err and "effects.elasticity" in said.out
    done, failed = table.read_table(out).rows
    assert (done["state"], failed["state"]) == ("done", "failed")
    assert failed["reason"].startswith("wall_low_friction.toml: effects.elasticity")  # where the program lies is left out
    assert table.read_table(out).failures == [failed]
    again = Inline()
    run(text, out, again)
    assert again.done == ["wall_low_friction_elasticity=none"]


def test_no_path_of_this_machine_is_in_a_reason(tmp_path: Path) -> None:
    scene = load_scene(find("two_pads"))
    own = Job(scene, tmp_path / "case", False, {}, "", LOADED)
    beside = dataclasses.replace(own, scene=dataclasses.replace(scene, path=Path("mine.toml")))
    reason = f"{own.folder}/two_pads/case.h5: of {scene.path}"
    assert failure(reason, own)["answers"]["reason"] == "two_pads/case.h5: of two_pads.toml"
    assert failure("a. b/c. d", beside)["answers"]["reason"] == "a. b/c. d"


def test_what_another_version_would_make_is_not_stored_as_this_one_s(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    out = tmp_path / "out"

    def install(at: Job) -> None:
        if len(begun(out)) == 2:
            monkeypatch.setattr(job, "code", lambda: "newer")

    found = run(QUICK, out, Inline(install))
    assert [row["state"] for row in found.rows] == ["done", "done", "failed", "failed"]
    assert [row["reason"] for row in found.failures] == [OTHER_CODE] * 2
    assert len(finished(out)) == 2 and not list(out.glob("cases/two_pads*/two_pads"))
    monkeypatch.undo()
    again = Inline()
    assert [row["state"] for row in run(QUICK, out, again).rows] == ["done"] * 4 and len(again.done) == 2


def test_a_worker_that_loaded_another_version_stores_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(job, "LOADED", "older")
    outcome = run_job(Job(load_scene(find("two_pads")), tmp_path / "case", False, {}, "", LOADED), Silent())
    assert (outcome["state"], outcome["answers"]["reason"]) == ("failed", OTHER_CODE)
    assert not (tmp_path / "case").exists()


def test_without_yade_a_run_of_an_earlier_call_is_not_told(tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def with_a_run(*place: Any) -> SimpleNamespace:
        results = read_results(*place)
        twists = results.analysis.bounds[results.analysis.main].twists
        return SimpleNamespace(scene=results.scene, analysis=results.analysis, run=SimpleNamespace(mechanism=lambda: twists))

    run(QUICK, tmp_path / "fresh" / "out")
    monkeypatch.setattr(job, "read_results", with_a_run)
    found = run(QUICK, tmp_path / "used" / "out")
    assert found.rows[0]["associated_mechanism"] and found.rows[0]["yade_mechanism"] is None
    assert (tmp_path / "used/out/results.csv").read_bytes() == (tmp_path / "fresh/out/results.csv").read_bytes()


@pytest.mark.parametrize(
    ("verdicts", "code"),
    [(["agree"], 0), (["agree", None], 0), (["agree", "inconclusive"], 4), (["inconclusive", "disagree"], 1), (["disagree", "failed"], 3)],
)
def test_the_gravest_case_decides_the_exit_code(verdicts: list[str | None], code: int, tmp_path: Path) -> None:
    from comparison.cli.study_verbs.campaign import exit_code

    rows = [{"state": "failed", "verdict": None} if verdict == "failed" else {"state": "done", "verdict": verdict} for verdict in verdicts]
    assert exit_code(table.CampaignTable("", {}, rows, [], {}, tmp_path)) == code


def test_the_command_prints_its_table_or_one_json_object_and_nothing_else(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline())
    command = ["campaign", str(written(tmp_path, QUICK)), "-o", str(tmp_path / "out")]
    assert main([*command, "--json", "-q"]) == 0
    said = capsys.readouterr()
    found = json.loads(said.out)
    assert said.err == "" and [row["case"] for row in found["rows"]] == sorted(begun(tmp_path / "out"))
    assert main(command) == 0
    said = capsys.readouterr()
    assert "4 of them finished before" in said.err and "4 cases: 3 not compared, 1 expected value met" in said.out and "0.36765" in said.out


def test_a_case_s_folder_is_one_of_crosscheck_run(tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    row = run(QUICK, out).rows[0]
    assert main(["report", str(out / row["folder"]), "-q"]) == 0
    assert "two_blocks" in capsys.readouterr().out


def test_two_campaigns_in_one_folder_are_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    out.mkdir()
    with alone_in(out):
        assert main(["campaign", str(written(tmp_path, QUICK)), "-o", str(out), "-q"]) == 3
    assert "in use by another crosscheck process" in capsys.readouterr().err


def test_a_stop_keeps_the_table_of_what_was_finished(tmp_path: Path, plain_figures: None) -> None:
    out = tmp_path / "out"

    def interrupt(job) -> None:
        if len(begun(out)) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(QUICK, out, Inline(interrupt))
    assert [row["case"] for row in table.read_table(out).rows] == begun(out)
    again = Inline()
    assert len(run(QUICK, out, again).rows) == 4 and len(again.done) == 2


def test_a_request_to_end_is_an_interruption_to_a_campaign_and_to_nothing_else(
    tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out"

    def end(at: Job) -> None:
        if len(begun(out)) == 2:
            os.kill(os.getpid(), signal.SIGTERM)

    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline(end))
    elsewhere: list[int] = []
    before = signal.signal(signal.SIGTERM, lambda number, frame: elsewhere.append(number))
    try:
        assert main(["campaign", str(written(tmp_path, QUICK)), "-o", str(out), "-q"]) == INTERRUPTED
        assert elsewhere == [] and "error: stopped" in capsys.readouterr().err
        assert [row["case"] for row in table.read_table(out).rows] == begun(out)
        os.kill(os.getpid(), signal.SIGTERM)
        assert elsewhere == [signal.SIGTERM]
    finally:
        signal.signal(signal.SIGTERM, before)


def test_the_report_is_written_while_the_folder_is_held(tmp_path: Path, plain_figures: None, monkeypatch: pytest.MonkeyPatch) -> None:
    def conclude(found: table.CampaignTable) -> None:
        with pytest.raises(FolderInUseError), alone_in(found.folder):
            pass
        concluded.append(len(found.rows))

    concluded: list[int] = []
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.Local", lambda workers, yade: Inline())
    monkeypatch.setattr("comparison.cli.study_verbs.campaign.write_campaign_report", conclude)
    assert main(["campaign", str(written(tmp_path, QUICK)), "-o", str(tmp_path / "out"), "-q"]) == 0
    assert concluded == [4]


def test_a_shipped_campaign_is_found_by_its_name_and_all_its_cases_are_scenes(capsys: pytest.CaptureFixture[str]) -> None:
    cases = expand(load_campaign(find_campaign(Path("seed_paper"))))
    assert len(cases) >= 60 and len({case.sweep for case in cases}) == 9
    assert main(["campaign", "seed_papers"]) == 2
    assert 'did you mean "seed_paper"?' in capsys.readouterr().err
    assert main(["campaign", "unlike"]) == 2
    assert "valid campaigns: seed_paper" in capsys.readouterr().err
