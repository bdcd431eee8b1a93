"""A file that is not whole, not of this program or of another scene is refused with the reason."""

import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest
import scenes
from exchange_files import FIELDS, write_wall, write_whole

from la_core import exchange
from la_core.analysis.case_file import read_case, scene_digest, write_case
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.exchange.checksummed_file import SEAL_BYTES, VERSION, ExchangeError, write_sealed
from la_core.exchange.fields import Field
from la_core.scene.scene import Scene


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    return write_whole(tmp_path)


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Scene, LimitAnalysis]:
    return write_wall(tmp_path_factory.mktemp("case"))


def refusal(path: Path, expected: tuple[Field, ...] = FIELDS) -> str:
    with pytest.raises(ExchangeError) as error:
        exchange.read(path, expected)
    assert str(path) in str(error.value)
    return str(error.value)


def edited(path: Path, change: Callable[[h5py.File], object]) -> Path:
    """The file, changed and sealed again as a whole file."""
    with h5py.File(path, "r+") as file:
        change(file)
    write_sealed(path, path.read_bytes())
    return path


def replaced(path: Path, name: str, value: object) -> Path:
    def change(file: h5py.File) -> None:
        del file[name]
        file[name] = value

    return edited(path, change)


def test_missing_file(tmp_path) -> None:
    assert "cannot be read (No such file or directory); run the scene again" in refusal(tmp_path / "nothing.h5")


def test_a_file_that_may_not_be_read_is_one_to_ask_for(tmp_path, monkeypatch) -> None:
    """To run the scene again is of no use in another user's folder. Root may read every file, so the test imitates the system's error."""

    def closed(path) -> bytes:
        raise PermissionError(13, "Permission denied", str(path))

    (tmp_path / "case.h5").touch()
    monkeypatch.setattr(Path, "read_bytes", closed)
    assert "case.h5: it may not be read by you: ask its owner" in refusal(tmp_path / "case.h5")


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
    assert "run the scene again" in refusal(whole)


@pytest.mark.parametrize("seed", range(50))
def test_one_flipped_bit_anywhere(whole, seed) -> None:
    content = bytearray(whole.read_bytes())
    content[np.random.default_rng(seed).integers(SEAL_BYTES if seed % 2 else len(content))] ^= 1 << seed % 8
    whole.write_bytes(content)
    assert "run the scene again" in refusal(whole)


def test_other_version(whole) -> None:
    content = whole.read_bytes()
    whole.write_bytes(content.replace(f"crosscheck {VERSION} ".encode(), f"crosscheck {VERSION + 1} ".encode(), 1))
    assert f"version {VERSION + 1}, this program reads version {VERSION}; run the scene again" in refusal(whole)


def test_missing_field(whole) -> None:
    edited(whole, lambda file: file.__delitem__("b/vectors"))
    assert "b/vectors (vectors) is missing" in refusal(whole)


def test_missing_group(whole) -> None:
    """To run the scene again does not help where a group belongs to other scenes. The message names the groups of the file."""
    field = Field("b/other/deep", "f8", (), "", "of another scene")
    assert "is missing, because the file has no group b/other, and /b holds " in refusal(whole, (field,))


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
    said = refusal(replaced(whole, name, value))
    assert says in said and said.endswith("; run the scene again")


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


@pytest.mark.parametrize("field", ["contacts/position", "blocks/centroid", "blocks/mass"])
def test_a_case_whose_geometry_was_rounded_otherwise_is_that_of_the_scene(case, field, tmp_path) -> None:
    """Voussoirs of an arch stored by version 0.2.0 differ by 1e-15 m from those of today. Another processor may do the same."""
    path, scene, _ = case
    for share, is_same in ((1e-15, True), (1e-9, False)):
        copy = shutil.copy(path, tmp_path / "case.h5")
        with h5py.File(copy) as file:
            values = file[field][()]
        replaced(copy, field, values + share * np.abs(values).max())
        if is_same:
            assert read_case(copy, scene).scene is scene
        else:
            with pytest.raises(ExchangeError, match=f"{field} differs from that of"):
                read_case(copy, scene)


PADS = [scenes.box(f"pad {k}", (x, 0.0, -0.2), (x + 0.5, 0.5, 0.0), "support") for k, x in enumerate((0.0, 1.5))]
LYING = scenes.box("beam", (0.0, 0.0, 0.0), (2.0, 0.5, 0.5))
HELD = [pad.replace('"support"', '"fixed"') for pad in PADS]


def sinking(*ratios: float) -> Scene:
    """A beam on two pads. Each pad has its own share of the settlement."""
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
