"""Values written for the other method are read back unchanged, or are not written at all."""

import datetime
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import scenes
from exchange_files import FIELDS, VALUES, write_wall, write_whole
from runs import perfect_run, write_run

from comparison.yade.run_record import read_run
from la_core import exchange
from la_core.analysis.case_file import read_case, scene_digest, write_case
from la_core.analysis.result import LimitAnalysis, associated_values
from la_core.analysis.stage import analyse
from la_core.exchange import hdf5
from la_core.exchange.checksummed_file import ExchangeError
from la_core.exchange.checksummed_file import write_whole as write_whole_file
from la_core.exchange.fields import CASE_FIELDS
from la_core.limit.associated import Solution
from la_core.limit.problem import Drive
from la_core.scene.scene import Scene


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    return write_whole(tmp_path)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scene, LimitAnalysis]:
    return write_wall(tmp_path_factory.mktemp("case"))


# --- round trips -------------------------------------------------------------------------------------------------------------


def test_values_come_back_as_they_were(whole) -> None:
    back = exchange.read(whole, FIELDS)
    assert back.keys() == VALUES.keys()
    assert back["a/number"] == 1.25 and back["a/count"] == 7 and back["a/flag"] == 1
    assert back["a/text"] == VALUES["a/text"] and back["b/names"] == VALUES["b/names"]
    assert np.array_equal(back["b/vectors"], VALUES["b/vectors"])


def test_nan_stays_nan(tmp_path) -> None:
    exchange.write(tmp_path / "nan.h5", FIELDS, VALUES | {"a/number": float("nan")}, "")
    assert np.isnan(exchange.read(tmp_path / "nan.h5", FIELDS)["a/number"])


def test_empty_arrays_come_back_empty(tmp_path) -> None:
    nothing = {"b/names": [], "b/vectors": np.zeros((0, 3))}
    exchange.write(tmp_path / "empty.h5", FIELDS, VALUES | nothing, "")
    back = exchange.read(tmp_path / "empty.h5", FIELDS)
    assert back["b/names"] == [] and back["b/vectors"].shape == (0, 3)


def test_case_comes_back_as_it_was(case) -> None:
    path, scene, analysis = case
    back = read_case(path, scene)
    assert back.main is analysis.main
    assert np.array_equal(back.assembly.points.position, analysis.assembly.points.position)
    for written, read in ((analysis.bounds, back.bounds), (analysis.sharp.bounds, back.sharp.bounds)):
        assert written.keys() == read.keys()
        for drive, solution in written.items():
            for field in fields(Solution):
                value, again = getattr(solution, field.name), getattr(read[drive], field.name)
                assert type(again) is type(value), field.name
                assert np.array_equal(value, again) if isinstance(value, np.ndarray) else value == again, field.name


def test_files_are_read_and_sealed_twice_once_for_what_they_hold_and_once_for_its_values(case, tmp_path, monkeypatch) -> None:
    """Each reading takes the whole file and computes its digest."""
    path, scene, analysis = case
    write_run(tmp_path / "run.h5", perfect_run(analysis), "inputs")
    opened, read = [], hdf5.read_sealed
    monkeypatch.setattr(hdf5, "read_sealed", lambda file: (opened.append(file.name), read(file))[1])
    read_run(tmp_path / "run.h5", read_case(path, scene).assembly)
    assert opened == ["case.h5"] * 2 + ["run.h5"] * 2


def test_case_that_cannot_stand_comes_back_with_the_names_of_what_falls(tmp_path) -> None:
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))
    pads = scenes.box("pad", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "fixed"), scenes.box("s", (1.0, 0.0, -0.1), (1.01, 1.0, 0.0), "support")
    scene = scenes.build(*pads, overhang, inset=0.001)
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "")
    back = read_case(tmp_path / "case.h5", scene)
    assert back.bounds[Drive.YIELDING].falling == ("overhang",) and np.isnan(back.bounds[Drive.YIELDING].value)
    assert associated_values(back)["seconds"] == associated_values(analysis)["seconds"]  # the search for falling blocks counts once


def test_case_of_a_live_load(tmp_path) -> None:
    scene = scenes.build(*scenes.wall(3, 3), live=(1.0, 0.0, 0.0))
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "")
    assert read_case(tmp_path / "case.h5", scene).bounds[Drive.LIVE].value == analysis.bounds[Drive.LIVE].value


def test_case_holds_the_geometry_yade_needs(case) -> None:
    path, scene, _ = case
    data = exchange.read(path, CASE_FIELDS)
    assert data["blocks/name"] == list(scene.blocks.names)
    mass = data["blocks/mass"][data["blocks/role"] == exchange.FREE]
    assert mass.sum() * np.linalg.norm(data["scene/gravity"]) == pytest.approx(scene.weight, rel=1e-12)
    assert data["blocks/vertex_start"][-1] == len(data["blocks/vertices"])
    assert data["blocks/face_start"][-1] == len(data["blocks/face_vertex"])
    assert data["blocks/face_vertex"].max() < len(data["blocks/vertices"])
    assert data["contacts/interface"].max() == len(data["interfaces/block_a"]) - 1


# --- writing -----------------------------------------------------------------------------------------------------------------


def test_value_that_is_not_there_is_named_and_nothing_written(tmp_path) -> None:
    values = {name: value for name, value in VALUES.items() if name != "b/names"}
    with pytest.raises(ExchangeError, match="no value for b/names"):
        exchange.write(tmp_path / "file.h5", FIELDS, values, "")
    assert list(tmp_path.iterdir()) == []


class InterruptedError(Exception):
    """A crash while a value is being written."""


class Exploding:
    def __array__(self, *_: object, **__: object) -> np.ndarray:
        raise InterruptedError


@pytest.mark.parametrize("already_there", [False, True])
def test_crash_while_writing_leaves_what_was_there(tmp_path, already_there) -> None:
    path = tmp_path / "file.h5"
    if already_there:
        exchange.write(path, FIELDS, VALUES, "first")
    with pytest.raises(InterruptedError):
        exchange.write(path, FIELDS, VALUES | {"b/vectors": Exploding()}, "second")
    assert [entry.name for entry in tmp_path.iterdir()] == (["file.h5"] if already_there else [])
    assert exchange.inputs_digest(path) == ("first" if already_there else "")


def test_a_file_without_a_date_has_the_same_bytes_at_any_time(tmp_path, monkeypatch) -> None:
    """A report that writes the table of a campaign again must not change it."""
    days = iter([datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC), datetime.datetime(2026, 1, 2, tzinfo=datetime.UTC)] * 2)
    clock = SimpleNamespace(datetime=SimpleNamespace(now=lambda: next(days)))
    monkeypatch.setattr(hdf5, "datetime", clock)
    dated, undated = ([tmp_path / f"{kind}_{k}.h5" for k in range(2)] for kind in ("dated", "undated"))
    for is_dated, paths in ((True, dated), (False, undated)):
        for path in paths:
            exchange.write(path, FIELDS, VALUES, "", is_dated=is_dated)
    assert undated[0].read_bytes() == undated[1].read_bytes()
    assert dated[0].read_bytes() != dated[1].read_bytes()
    assert exchange.made_by(undated[0]) == {}


def test_digest_of_inputs_is_only_that_of_a_whole_file(whole, tmp_path) -> None:
    assert exchange.inputs_digest(whole) == "digest"
    assert exchange.inputs_digest(tmp_path / "nothing.h5") == ""
    whole.write_bytes(whole.read_bytes()[:-1])
    assert exchange.inputs_digest(whole) == ""


def test_digest_follows_the_scene(two_pads) -> None:
    first, same, other = scenes.load(two_pads), scenes.load(two_pads), scenes.load(two_pads.replace("0.6", "0.61"))
    assert scene_digest(first) == scene_digest(same) != scene_digest(other)


def test_several_threads_may_write_one_file(tmp_path: Path) -> None:
    """A program that runs several scenes at a time writes reports in several threads. They removed each other's unfinished files."""
    path, contents = tmp_path / "report.json", [bytes([65 + k]) * 100_000 for k in range(4)]
    with ThreadPoolExecutor(len(contents)) as pool:
        for written in [pool.submit(write_whole_file, path, content) for _ in range(50) for content in contents]:
            written.result()
    assert path.read_bytes() in contents and list(tmp_path.iterdir()) == [path]
