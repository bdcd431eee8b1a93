"""The files between the methods: what is written is read back, and anything less than a whole file of ours is refused."""

from collections.abc import Callable
from dataclasses import fields
from pathlib import Path

import h5py
import numpy as np
import pytest
import scenes

from la_core import exchange
from la_core.analysis.case_file import read_case, scene_digest, write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.exchange.checksummed_file import SEAL_BYTES, VERSION, ExchangeError, write_sealed
from la_core.exchange.fields import CASE_FIELDS, RUN_FIELDS, Field, solution_fields
from la_core.limit.associated import Solution
from la_core.limit.problem import Drive
from la_core.scene.scene import Scene

FIELDS = (
    Field("a/number", "f8", (), "N", "a number"),
    Field("a/count", "i8", (), "", "a count"),
    Field("a/flag", "u1", (), "", "a flag"),
    Field("a/text", "str", (), "", "a text"),
    Field("b/names", "str", ("B",), "", "names"),
    Field("b/vectors", "f8", ("B", 3), "m", "vectors"),
)
VALUES = {
    "a/number": 1.25,
    "a/count": 7,
    "a/flag": True,
    "a/text": "Tässä – ψ",
    "b/names": ["one", "zwei", "três"],
    "b/vectors": np.arange(9.0).reshape(3, 3),
}


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    path = tmp_path / "file.h5"
    exchange.write(path, FIELDS, VALUES, "digest")
    return path


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scene, LimitAnalysis]:
    scene = scenes.build(*scenes.wall(3, 4, split=0.8), inset=0.001)
    analysis = analyse(scene)
    path = tmp_path_factory.mktemp("case") / "case.h5"
    write_case(path, analysis, scene_digest(scene))
    return path, scene, analysis


def refusal(path: Path, expected: tuple[Field, ...] = FIELDS) -> str:
    with pytest.raises(ExchangeError) as error:
        exchange.read(path, expected)
    assert str(path) in str(error.value)
    return str(error.value)


def edited(path: Path, change: Callable[[h5py.File], object]) -> Path:
    """The file after a change by another hand that knows how to seal it."""
    with h5py.File(path, "r+") as file:
        change(file)
    write_sealed(path, path.read_bytes())
    return path


def replaced(path: Path, name: str, value: object) -> Path:
    def change(file: h5py.File) -> None:
        del file[name]
        file[name] = value

    return edited(path, change)


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


def test_case_that_cannot_stand_comes_back_with_the_names_of_what_falls(tmp_path) -> None:
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))
    pads = scenes.box("pad", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "fixed"), scenes.box("s", (1.0, 0.0, -0.1), (1.01, 1.0, 0.0), "support")
    scene = scenes.build(*pads, overhang, inset=0.001)
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "")
    back = read_case(tmp_path / "case.h5", scene)
    assert back.bounds[Drive.YIELDING].falling == ("overhang",) and np.isnan(back.bounds[Drive.YIELDING].value)


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


# --- refusals ----------------------------------------------------------------------------------------------------------------


def test_missing_file(tmp_path) -> None:
    assert "cannot be read (No such file or directory); run it again" in refusal(tmp_path / "nothing.h5")


def test_folder_in_the_place_of_a_file(tmp_path) -> None:
    assert "not a file; delete or rename it" in refusal(tmp_path)


FOREIGN = "not a whole file of version"


def test_foreign_file(tmp_path) -> None:
    path = tmp_path / "foreign.h5"
    path.write_text("title = 'not HDF5'\n" * 100)
    assert FOREIGN in refusal(path)


def test_hdf5_of_another_program(tmp_path) -> None:
    path = tmp_path / "other.h5"
    with h5py.File(path, "w") as file:
        file["x"] = 1.0
    assert FOREIGN in refusal(path)


def test_sealed_text_is_no_hdf5(tmp_path) -> None:
    write_sealed(tmp_path / "file.h5", b"title = 'not HDF5'\n" * 100)
    assert "not an HDF5 file of this program" in refusal(tmp_path / "file.h5")


@pytest.mark.parametrize("seed", range(50))
def test_truncated_file(whole, seed) -> None:
    content = whole.read_bytes()
    whole.write_bytes(content[: np.random.default_rng(seed).integers(len(content))])
    assert "run it again" in refusal(whole)


@pytest.mark.parametrize("seed", range(50))
def test_one_flipped_bit_anywhere(whole, seed) -> None:
    content = bytearray(whole.read_bytes())
    content[np.random.default_rng(seed).integers(SEAL_BYTES if seed % 2 else len(content))] ^= 1 << seed % 8
    whole.write_bytes(content)
    assert "run it again" in refusal(whole)


def test_other_version(whole) -> None:
    content = whole.read_bytes()
    whole.write_bytes(content.replace(f"crosscheck {VERSION} ".encode(), f"crosscheck {VERSION + 1} ".encode(), 1))
    assert f"version {VERSION + 1}, this program reads version {VERSION}; run it again" in refusal(whole)


def test_missing_field(whole) -> None:
    edited(whole, lambda file: file.__delitem__("b/vectors"))
    assert "b/vectors (vectors) is missing" in refusal(whole)


def test_group_in_place_of_a_field(whole) -> None:
    def change(file: h5py.File) -> None:
        del file["b/vectors"]
        file.create_group("b/vectors")

    assert "b/vectors (vectors) is missing" in refusal(edited(whole, change))


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("a/number", np.float32(1.25), "a/number holds float32, the schema says f8"),
        ("a/number", "1.25", "a/number holds object, the schema says f8"),
        ("a/text", 3.0, "a/text holds float64, the schema says str"),
        ("a/count", 7.0, "a/count holds float64, the schema says i8"),
        ("b/vectors", np.zeros((3, 2)), "b/vectors has shape (3, 2), the schema says"),
        ("b/vectors", np.zeros((2, 3)), "b/vectors has shape (2, 3), the schema says"),
        ("b/vectors", np.zeros(3), "b/vectors has shape (3,), the schema says"),
        ("a/number", np.zeros(1), "a/number has shape (1,), the schema says"),
    ],
)
def test_field_of_another_kind_or_shape(whole, name, value, says) -> None:
    assert says in refusal(replaced(whole, name, value))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (("[0.8, ", "[0.4, "), "blocks/mass"),  # same contact points: the base's parts meet at another joint
        (("friction = 0.6", "friction = 0.7"), "contacts/friction"),
        (("density = 2000.0", "density = 2100.0"), "blocks/mass"),
        (("0.0, 0.0, -1.0]", "0.1, 0.0, -1.0]"), "scene/support_twist"),
        (("per_course = 3", "per_course = 4"), "blocks/name"),
        (('"fixed"', '"support"'), "blocks/role"),
    ],
)
def test_case_of_another_scene(case, change, named) -> None:
    path, scene, _ = case
    assert change[0] in scene.text
    other = scenes.load(scene.text.replace(*change))
    with pytest.raises(ExchangeError, match=f"{named} differs from that of"):
        read_case(path, other)


PADS = [scenes.box(f"pad {k}", (x, 0.0, -0.2), (x + 0.5, 0.5, 0.0), "support") for k, x in enumerate((0.0, 1.5))]
LYING = scenes.box("beam", (0.0, 0.0, 0.0), (2.0, 0.5, 0.5))
HELD = [pad.replace('"support"', '"fixed"') for pad in PADS]


def sinking(*ratios: float) -> Scene:
    """A beam on two pads, each of which has a share of the settlement of its own."""
    zones = [{"blocks": [f"pad {k}"], "ratio": ratio} for k, ratio in enumerate(ratios)]
    return scenes.build(*PADS, LYING, settlement={"direction": scenes.DOWN, **({"zone": zones} if zones else {})})


def carrying(*loads: float) -> Scene:
    """A beam on two pads that carries forces, N."""
    tables = [scenes.table("[load]", blocks=["beam"], force=(0.0, 0.0, -load)) for load in loads]
    return scenes.build(*PADS, LYING, *tables)


@pytest.mark.parametrize(
    ("stored", "asked", "named"),
    [
        (lambda: sinking(1.0, 0.5), lambda: sinking(1.0, 0.25), "blocks/support_twist"),
        (lambda: sinking(1.0, 0.5), sinking, "blocks/support_twist"),
        (sinking, lambda: sinking(1.0, 0.5), "blocks/support_twist"),
        (lambda: carrying(1e3), lambda: carrying(2e3), "blocks/applied_load"),
        (lambda: carrying(1e3), carrying, "blocks/applied_load"),
        (carrying, lambda: carrying(1e3), "blocks/applied_load"),
        (
            lambda: scenes.build(*HELD, LYING, live=(1.0, 0.0, 0.0)),
            lambda: scenes.build(*HELD, LYING, live=(-1.0, 0.0, 0.0)),
            "scene/live",
        ),
    ],
)
def test_case_of_other_loads_or_motions(stored, asked, named, tmp_path) -> None:
    scene, other = stored(), asked()
    write_case(tmp_path / "case.h5", analyse(scene), scene_digest(scene))
    assert read_case(tmp_path / "case.h5", scene).scene is scene
    with pytest.raises(ExchangeError, match=f"{named} differs from that of"):
        read_case(tmp_path / "case.h5", other)


# --- writing -----------------------------------------------------------------------------------------------------------------


def test_value_that_is_not_there_is_named_and_nothing_written(tmp_path) -> None:
    values = {name: value for name, value in VALUES.items() if name != "b/names"}
    with pytest.raises(ExchangeError, match="no value for b/names"):
        exchange.write(tmp_path / "file.h5", FIELDS, values, "")
    assert list(tmp_path.iterdir()) == []


class InterruptedError(Exception):
    """Stands for a crash while a value is being written."""


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


def test_digest_of_inputs_is_only_that_of_a_whole_file(whole, tmp_path) -> None:
    assert exchange.inputs_digest(whole) == "digest"
    assert exchange.inputs_digest(tmp_path / "nothing.h5") == ""
    whole.write_bytes(whole.read_bytes()[:-1])
    assert exchange.inputs_digest(whole) == ""


def test_digest_follows_the_scene(two_pads) -> None:
    first, same, other = scenes.load(two_pads), scenes.load(two_pads), scenes.load(two_pads.replace("0.6", "0.61"))
    assert scene_digest(first) == scene_digest(same) != scene_digest(other)


# --- the schema itself -------------------------------------------------------------------------------------------------------

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
