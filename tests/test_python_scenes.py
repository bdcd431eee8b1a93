"""Scenes built and varied in Python equal scenes of files, with the same messages about mistakes."""

import copy
import dataclasses
import operator
import pickle
import re
import shutil
import tomllib
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

import la_core
from la_core import SceneError, exchange
from la_core.analysis import analyse
from la_core.analysis.case_file import scene_digest
from la_core.scene import key_paths, shipped
from la_core.scene.loads.point_forces import PointForces
from la_core.scene.scene import Scene


@pytest.mark.parametrize("name", [name for name in la_core.names() if name not in shipped.LONG])
def test_the_tables_of_a_file_build_its_scene(name: str) -> None:
    filed = la_core.load(name)
    built = la_core.build(tomllib.loads(filed.text), name, filed.path.parent)
    for field in dataclasses.fields(Scene):
        if field.name not in ("text", "path", "blocks", "meshes"):
            ours, theirs = getattr(built, field.name), getattr(filed, field.name)
            np.testing.assert_equal(*((vars(ours), vars(theirs)) if isinstance(ours, PointForces) else (ours, theirs)))
    np.testing.assert_array_equal(built.blocks.vertices, filed.blocks.vertices)
    np.testing.assert_array_equal(built.blocks.mass, filed.blocks.mass)
    assert built.blocks.names == filed.blocks.names


def test_a_scene_built_of_arrays_is_one_built_of_lists() -> None:
    tables = tomllib.loads(la_core.load("two_pads").text)
    arrays = tables | {"gravity": np.array(tables["gravity"]), "joint": {"friction": np.float64(0.6)}}
    arrays["block"] = tuple(block | {"box": {k: tuple(v) for k, v in block["box"].items()}} for block in tables["block"])
    assert scene_digest(la_core.build(arrays)) == scene_digest(la_core.build(tables))


@pytest.mark.parametrize(
    ("key", "value"),
    [("joint.friction", -0.1), ("joint.fricton", 0.6), ("stone.density", "heavy"), ("wall[0].courses", 2.5), ("settlement", None)],
)
def test_a_mistake_in_code_is_told_as_in_a_file(key: str, value: object, write_scene: Callable[..., Path]) -> None:
    wall = la_core.load("wall_third")
    with pytest.raises(la_core.SceneError) as in_code:
        la_core.variant(wall, {key: value}, "wall")
    tables = tomllib.loads(wall.text)
    words = {"joint.friction": "friction = -0.1", "joint.fricton": "friction = 0.6\nfricton = 0.6"}
    texts = {
        "stone.density": wall.text.replace("density = 2000.0", 'density = "heavy"'),
        "wall[0].courses": re.sub(r"courses +=.*", "courses = 2.5", wall.text),
        "settlement": wall.text.replace("[settlement]\ndirection = [0.0, 0.0, -1.0]", ""),
    }
    text = texts.get(key) or wall.text.replace("friction = 0.6", words[key])
    assert tables != tomllib.loads(text)
    with pytest.raises(la_core.SceneError) as in_file:
        la_core.load(write_scene(text, "wall"))
    told = str(in_file.value).split("wall.toml")[1]
    assert str(in_code.value).removeprefix("variant of wall_third") == re.sub(r": line \d+: ", ": ", told)  # only a file has lines


@pytest.mark.parametrize(
    ("key", "rule"),
    [
        ("joint friction", "must be a dotted path"),
        ("joint.friction.static", "is a value, not a table"),
        ("wall.courses", r"select one of its entries: wall\[0\].courses"),
        ("block[7].density", "has 2 entries"),
        ("joint[0]", "is not an array"),
        ("arch[0].radius", "has no arch"),
    ],
)
def test_a_key_that_leads_nowhere_is_named(key: str, rule: str) -> None:
    with pytest.raises(la_core.SceneError, match=rule) as told:
        la_core.variant(la_core.load("wall_third"), {key: 1.0})
    assert key in str(told.value)


def test_an_entry_of_an_array_cannot_be_deleted() -> None:
    with pytest.raises(la_core.SceneError, match=r'"block\[2\]": an entry of an array cannot be deleted; set block as a whole'):
        la_core.variant("two_pads", {"block[2]": None})


@pytest.mark.parametrize("number", [np.longdouble, np.float16, np.float32, lambda value: np.array(value, dtype=np.longdouble)])
def test_a_number_of_any_precision_is_a_number_of_a_scene(number: Callable[[float], Any]) -> None:
    assert la_core.variant("two_pads", {"joint.friction": number(0.375)}).friction == 0.375


def test_what_toml_cannot_say_is_refused_by_its_key() -> None:
    with pytest.raises(la_core.SceneError, match=r"joint\.friction: a c\w+ has no place in a scene; give a number"):
        la_core.build({"joint": {"friction": np.clongdouble(0.6)}})
    with pytest.raises(la_core.SceneError, match=r"joint\.friction: a NoneType has no place"):
        la_core.build({"joint": {"friction": None}})
    with pytest.raises(la_core.SceneError, match=r"joint\.friction: a Decimal has no place in a scene; give a number"):
        la_core.build({"joint": {"friction": Decimal("0.6")}})
    with pytest.raises(la_core.SceneError, match=r"title: a bytes has no place in a scene"):
        la_core.variant("two_pads", {"title": b"pads"})


@pytest.mark.parametrize("digits", [400, 5000])
def test_a_number_of_too_many_digits_is_refused_in_words(digits: int) -> None:
    with pytest.raises(la_core.SceneError, match=r"joint\.friction = .*: has too many digits"):
        la_core.variant("two_pads", {"joint.friction": 10**digits})
    with pytest.raises(la_core.SceneError, match=r"joint\.friction = 1000.*: has too many digits"):
        la_core.build(tomllib.loads(la_core.load("two_pads").text.replace("= 0.6", f"= {10**400}")))


def test_a_date_of_toml_is_a_date_of_the_scene() -> None:
    text = la_core.load("two_pads").text
    assert la_core.build(tomllib.loads(f"date = 2024-05-01\n{text}")).date == "2024-05-01"


def test_a_path_ends_where_a_text_begins() -> None:
    """The letters of a text have no keys, and the entries of an array have no names."""
    data = {"title": "abc", "block": [{"name": "a"}]}
    assert key_paths.get(data, "block[0].name") == "a"
    for key in ("title[0]", "block.name", "block[1]", "title.upper", "block[0].name[0]"):
        assert key_paths.get(data, key) is None, key


def test_a_table_that_contains_itself_is_refused_by_its_key() -> None:
    table: dict[str, object] = {"density": 2000.0}
    table["own"] = table
    for call in (lambda: la_core.build({"stone": table}), lambda: la_core.variant("two_pads", {"stone": [table]})):
        with pytest.raises(la_core.SceneError, match=r"^stone: must be at most \d+ tables and arrays deep; it may contain itself$"):
            call()


def test_half_of_a_character_is_refused_in_words() -> None:
    with pytest.raises(la_core.SceneError, match=r"title = 'a\\ud800b': must be text that a file can hold; this one has half"):
        la_core.variant("two_pads", {"title": "a\ud800b"})


def test_the_text_of_a_scene_is_not_taken_for_its_path() -> None:
    with pytest.raises(la_core.SceneError, match=r"`la_core\.build\(tomllib\.loads\(text\)\)`") as refused:
        la_core.load(la_core.load("two_pads").text)
    assert len(str(refused.value)) < 250


@pytest.mark.parametrize("name", ["x" * 5000, "x" * 5000 + ".toml", "a/" * 5000 + "b"])
def test_a_name_that_no_file_can_have_names_no_scene(name: str) -> None:
    with pytest.raises(la_core.SceneError, match=r"^scene = .*: cannot be read: File name too long; give the path of a scene") as refused:
        la_core.load(name)
    assert len(str(refused.value)) < 250


@pytest.mark.parametrize("changes", [{"yade.speed": 0.0}, {"block[2].role": "fixed"}], ids=["yade", "role"])
def test_every_fault_of_a_variant_names_what_it_is_a_variant_of(changes: dict[str, object]) -> None:
    with pytest.raises(la_core.SceneError, match=r"^variant of two_pads: "):
        la_core.variant("two_pads", changes)


def test_variants_find_the_meshes_of_their_scene_wherever_the_program_goes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("rubble_wall.toml", "rubble_wall.obj"):
        shutil.copy(shipped.FOLDER / name, tmp_path)
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path)
    loaded, built = la_core.load("rubble_wall.toml"), la_core.build(tomllib.loads(Path("rubble_wall.toml").read_text()))
    monkeypatch.chdir("elsewhere")
    for scene in (loaded, built):
        assert len(la_core.variant(scene, {"joint.friction": 0.5}).blocks) == len(loaded.blocks)


def test_a_variant_keeps_what_its_changes_leave_true() -> None:
    pads = la_core.load("two_pads")
    for key in ("title", "project", "author"):
        assert la_core.variant(pads, {key: "same"}).expected == pads.expected
    assert la_core.variant(pads, {"joint.friction": pads.friction, "yade.speed": 1e-3}).expected == pads.expected
    assert la_core.variant(pads, {"joint.friction": 0.4}).expected is None
    kept = la_core.variant(pads, {"joint.friction": 0.4, "expected.reaction_over_weight": 1 / 6})
    assert kept.expected is not None and kept.expected.reaction_over_weight == 1 / 6
    named = {"expected.reaction_over_weight": pads.expected.reaction_over_weight, "source": pads.source}
    equal = la_core.variant(pads, {"joint.friction": 0.4} | named)  # named entries stay, also where they equal the scene's own
    assert (equal.expected, equal.source) == (pads.expected, pads.source)
    assert pads.friction == 0.6
    assert la_core.variant(la_core.load("rubble_wall"), {"title": "same"}).meshes


@pytest.mark.parametrize("name", exchange.SETTINGS)
def test_a_setting_of_yade_that_limit_analysis_reads_too_leaves_no_expected_value(name: str) -> None:
    pads = la_core.load("two_pads")
    changed = la_core.variant(pads, {f"yade.{name}": 1 if name in ("record_rows", "poses", "threads") else 1e-6})
    has_other_answer = "also changes limit analysis" in exchange.SETTING_MEANINGS[name]
    assert has_other_answer == (name in exchange.SHARED_SETTINGS)
    assert (changed.expected, changed.source) == ((None, "") if has_other_answer else (pads.expected, pads.source))


def test_limit_analysis_reads_no_other_settings_of_yade() -> None:
    """Any other setting that it reads would change its answer but leave the expected value."""

    class Heard(dict[str, float]):
        names: ClassVar[set[str]] = set()

        def get(self, name: str, default: Any = None) -> Any:
            self.names.add(name)
            return super().get(name, default)

        def __contains__(self, name: object) -> bool:
            self.names.add(str(name))
            return super().__contains__(name)

    arch = la_core.variant("flat_arch", {})
    object.__setattr__(arch, "yade", Heard(arch.yade))
    analyse(arch)
    assert Heard.names == {*exchange.SHARED_SETTINGS, "poses"}  # the number of stored states says what YADE records


def test_a_structure_that_is_no_longer_wedged_has_another_answer() -> None:
    assert la_core.load("flat_arch").expected is not None
    assert la_core.variant("flat_arch", {"yade.wedging": None}).expected is None


def test_a_variant_is_named_and_titled_by_its_changes() -> None:
    pads = la_core.load("two_pads")
    assert la_core.variant(pads, {"title": "Mine"}).title == "Mine"
    assert la_core.variant(pads, {"joint.friction": 0.4}).title == f"{pads.title}: joint.friction = 0.4"
    assert la_core.variant(pads, {"joint.friction": 0.4}, "own").name == "own"
    assert "/" not in la_core.variant(pads, {"title": "../../a/b"}).name
    assert len(la_core.variant(pads, {"source": 1000 * "x"}).name) < 255  # bytes of a file's name


def test_the_title_of_a_variant_has_arrays_as_a_scene_file_has_them() -> None:
    """NumPy prints a matrix in several lines, which would break the heading of a printed scene."""
    profile = np.array([[0.0, 0.5], [1.0, 1.0]])
    assert la_core.variant("two_pads", {"settlement.profile": profile}).title.endswith(": settlement.profile = [[0.0, 0.5], [1.0, 1.0]]")


def test_a_change_that_changes_nothing_keeps_what_the_scene_expects() -> None:
    """The change sets the inset to its default."""
    pads = la_core.load("two_pads")
    assert la_core.variant(pads, {"joint.inset": pads.inset}).expected == pads.expected
    assert la_core.variant(pads, {"joint.inset": 2.0 * pads.inset}).expected is None


def test_variants_of_other_values_have_other_names() -> None:
    pads = la_core.load("two_pads")
    names = [la_core.variant(pads, {"gravity": gravity}).name for gravity in ([1.0, 11.0, -99.0], [11.0, 1.0, -99.0], [1.0, 1.0, -199.0])]
    assert len(set(names)) == 3 and all("/" not in name and " " not in name for name in names)
    arrays = [np.array([1.1, 11.0, -99.0]), np.array([1.11, 1.0, -99.0]), np.array([11, 1, -99]), np.array([1, 11, -99])]
    assert len({la_core.variant(pads, {"gravity": gravity}).name for gravity in arrays}) == 4
    titles = ["a b", "ab", "a, b", "a_b", "a-b"]
    assert len({la_core.variant(pads, {"title": title}).name for title in titles}) == len(titles)
    blocks = [[f"{'x' * 90}{end}"] for end in "ab"]
    long = {la_core.variant(pads, {"title": title[0]}).name for title in blocks}
    assert len(long) == 2 and {len(name) for name in long} == {80}
    assert la_core.variant(pads, {}).title == pads.title


def test_a_wrong_entry_of_an_array_is_said_once() -> None:
    for value, told in (
        (np.array([[0.0, 0.0, -1.0]]), "settlement.direction[0] = [0.0, 0.0, -1.0]: must be a number"),
        ([0.0], "settlement.direction = [0.0]: has too few entries; needed: direction of a translation, of any length; down is [0, 0, -1]"),
        ([0.0, "down", -1.0], "settlement.direction[1] = 'down': must be a number"),
    ):
        with pytest.raises(la_core.SceneError) as refused:
            la_core.variant("two_pads", {"settlement.direction": value})
        assert str(refused.value) == f"variant of two_pads: {told}"


@pytest.mark.parametrize("array", ["gravity", "support_twist", "blocks.density", "blocks.vertices", "loads.force"])
def test_the_arrays_of_a_scene_cannot_be_changed_behind_its_text(array: str) -> None:
    scene = la_core.load("two_pads")
    with pytest.raises(ValueError, match="read-only"):
        operator.attrgetter(array)(scene)[...] = 0.0
    assert la_core.solve(scene, bounds_only=True).least == la_core.solve("two_pads", bounds_only=True).least


COPIES = {"made": lambda scene: scene, "copied": copy.deepcopy, "unpickled": lambda scene: pickle.loads(pickle.dumps(scene))}


@pytest.mark.parametrize("same", COPIES.values(), ids=COPIES)
def test_a_copy_of_a_scene_cannot_be_changed_behind_its_text_either(same: Callable[[la_core.Scene], la_core.Scene]) -> None:
    """Worker processes get their scenes unpickled."""
    tie = {"blocks": ["block"], "from": [0.0, 0.1, 0.5], "to": [-1.0, 0.1, 0.0], "force": 1.0}
    scene = same(la_core.variant("two_pads", {"yade.stiffening": 2.0, "tie": [tie]}))
    with pytest.raises(TypeError, match="does not support item assignment"):
        scene.yade["stiffening"] = 1.0  # type: ignore[index]
    for array in (scene.gravity, scene.blocks.vertices, scene.loads.force, scene.ties.forces.force):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0.0
    assert scene.yade == {"stiffening": 2.0}


def test_a_new_expected_value_does_not_keep_an_associated_one_of_another_structure() -> None:
    blocks = la_core.load("two_blocks")  # it also expects an associated value, which holds for its friction alone
    assert blocks.expected is not None and blocks.expected.associated_reaction_over_weight is not None
    smooth = la_core.variant(blocks, {"joint.friction": 0.3, "expected.reaction_over_weight": 0.5})
    assert smooth.expected is not None and smooth.expected.reaction_over_weight == 0.5
    assert smooth.expected.associated_reaction_over_weight is None and smooth.expected.tolerance == blocks.expected.tolerance
    assert la_core.variant(blocks, {"joint.friction": 0.3, "expected.tolerance": 0.01}).expected is None
    same = la_core.variant(blocks, {"expected.tolerance": 0.01}).expected
    assert same is not None and same.associated_reaction_over_weight == blocks.expected.associated_reaction_over_weight


def test_a_key_that_a_later_one_overwrites_is_refused() -> None:
    with pytest.raises(SceneError, match=r'"joint.inset": is a part of "joint", which is set after it as a whole.*write it within "joint"'):
        la_core.variant("two_blocks", {"joint.inset": 0.002, "joint": {"friction": 0.3}})
    changed = la_core.variant("two_blocks", {"joint": {"friction": 0.3}, "joint.inset": 0.002})
    assert (changed.friction, changed.inset) == (0.3, 0.002)
