"""YADE's side reads the fields of a case. It refuses a case that it cannot run, and names the field."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scenes

from la_core import exchange
from la_core.analysis.case_file import write_case
from la_core.analysis.stage import analyse
from yade_scripts import case

Fields = dict[str, Any]
Change = Callable[[Fields], Any]
PARTS = (
    scenes.box("pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
    scenes.box("settling pad", (0.5, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
    scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)),
)
FIXED, SUPPORT, FREE = 0, 1, 2  # blocks of PARTS


@pytest.fixture(scope="module")
def settles(tmp_path_factory: pytest.TempPathFactory) -> Fields:
    return fields_of(tmp_path_factory.mktemp("settles"))


@pytest.fixture(scope="module")
def pushed(tmp_path_factory: pytest.TempPathFactory) -> Fields:
    return fields_of(tmp_path_factory.mktemp("pushed"), live=(1.0, 0.0, 0.0))


def fields_of(folder: Path, **options: Any) -> Fields:
    """Fields of a case, optional ones included."""
    parts = [part.replace('"support"', '"fixed"') for part in PARTS] if "live" in options else PARTS
    write_case(folder / "case.h5", analyse(scenes.build(*parts, inset=0.001, **options)), "")
    own = exchange.present(folder / "case.h5", exchange.OWN_FIELDS)
    data = dict(exchange.read(folder / "case.h5", (*exchange.CASE_FIELDS, exchange.SWAY, *own)))
    supports = np.zeros((len(PARTS), 6))
    supports[SUPPORT] = np.nan_to_num(data["scene/support_twist"])
    loads = {name: np.zeros((len(PARTS), 6)) for name in ("blocks/applied_load", "blocks/live_load")}
    insets = np.full(len(data["contacts/position"]), 0.001)
    return {"blocks/support_twist": supports, "contacts/inset": insets} | loads | data


def changed(data: Fields, field: str, value: Any, place: Any = None) -> Fields:
    """The fields with another value in one field, or at one place of that field."""
    if place is None:
        return data | {field: value}
    other = np.array(data[field], copy=True)
    other[place] = value
    return data | {field: other}


def test_the_cases_can_be_run_as_they_are(settles: Fields, pushed: Fields) -> None:
    assert case.from_fields(settles).live is None and case.from_fields(pushed).live is not None


@pytest.mark.parametrize(
    ("field", "value", "place"),
    [
        ("scene/inset", 0.0, None),
        ("scene/inset", np.nan, None),
        ("contacts/inset", 0.0, 0),
        ("contacts/inset", 0.002, -1),  # more than the inset of the scene
        ("scene/displacement", "large", None),
        ("scene/recording", "", None),
        ("blocks/mass", 0.0, FREE),
        ("blocks/mass", -1.0, FREE),
        ("blocks/mass", np.inf, FREE),
        ("contacts/position", np.nan, (0, 2)),
        ("contacts/friction", -0.1, -1),
        ("contacts/friction", np.nan, 0),
        ("scene/support_twist", 0.0, slice(None)),
        ("scene/support_twist", np.nan, 3),
        ("blocks/support_twist", np.nan, (SUPPORT, 0)),
        ("blocks/support_twist", 0.1, (FREE, 0)),
        ("blocks/support_twist", -1.0, (FIXED, 2)),
        ("blocks/support_twist", 0.0, SUPPORT),
        ("blocks/applied_load", np.nan, (FREE, 4)),
        ("blocks/applied_load", 1.0, (FIXED, 0)),
        ("blocks/live_load", 1.0, (SUPPORT, 0)),
        ("joints/normal_stiffness", 0.0, None),
        ("joints/normal_stiffness", np.inf, None),
        ("joints/shear_stiffness", -1.0, None),
        ("joints/travel", -1e-3, None),
        ("joints/travel", 0.0, None),
        ("joints/sag", 0.0, None),
        ("joints/sway", -1e-5, None),
        ("joints/sway", np.nan, None),
    ],
)
def test_a_field_out_of_its_range_is_refused_by_name(field: str, value: Any, place: Any, settles: Fields) -> None:
    with pytest.raises(case.CaseError, match=field.replace("/", ".*")):
        case.from_fields(changed(settles, field, value, place))


@pytest.mark.parametrize("name", ["shear_stiffness", "sway"])
def test_joints_may_have_no_shear_stiffness_and_structures_no_known_sway(name: str, settles: Fields) -> None:
    assert getattr(case.from_fields(settles | {f"joints/{name}": 0.0}), name) == 0.0


@pytest.mark.parametrize(
    ("role", "named"), [(exchange.FIXED, "nothing to settle"), (exchange.FREE, "nothing to settle"), (exchange.SUPPORT, "")]
)
def test_some_support_must_carry_a_contact_point(role: int, named: str, settles: Fields) -> None:
    data = changed(settles, "blocks/role", role, SUPPORT)
    if named:
        with pytest.raises(case.CaseError, match=named):
            case.from_fields(data)
    else:
        assert case.from_fields(data).supports.tolist() == [SUPPORT]


def test_a_structure_without_a_free_block_is_nothing_to_simulate(settles: Fields) -> None:
    with pytest.raises(case.CaseError, match="no free block"):
        case.from_fields(changed(settles, "blocks/role", exchange.FIXED, FREE))


def test_a_live_load_has_a_unit_direction_and_lifts_no_support(pushed: Fields) -> None:
    for direction in ([0.9, 0.0, 0.0], [1.0, 1.0, 0.0], [np.nan, 0.0, 0.0]):
        with pytest.raises(case.CaseError, match="scene/live"):
            case.from_fields(pushed | {"scene/live": np.array(direction)})
    with pytest.raises(case.CaseError, match="wedging"):
        case.from_fields(pushed | {"scene/settings": '{"wedging": 1e-4}'})
    assert case.from_fields(pushed | {"scene/settings": '{"wedging": 0.0}'}).overrides == {"wedging": 0.0}


@pytest.mark.parametrize("text", ["{", "[1.0]", "1.0"])
def test_settings_must_be_a_table(text: str, settles: Fields) -> None:
    with pytest.raises(case.CaseError, match="scene/settings: "):
        case.from_fields(settles | {"scene/settings": text})


def test_the_settlement_is_an_angle_where_the_unit_motion_turns_and_never_under_a_live_load(settles: Fields, pushed: Fields) -> None:
    turns = case.from_fields(settles | {"scene/support_twist": np.array([0.0, 0.0, 0.0, 0.0, 1.0, 0.0])})
    assert turns.is_rotation and not case.from_fields(settles).is_rotation
    assert np.isnan(pushed["scene/support_twist"]).all() and not case.from_fields(pushed).is_rotation


def test_held_blocks_may_lack_a_density(settles: Fields) -> None:
    """A held block without a density gets the mass 1 kg. Free blocks, and held ones with a density, keep their mass."""
    bare = case.from_fields(changed(settles, "blocks/mass", np.nan, FIXED))
    assert bare.mass.tolist() == [1.0, *settles["blocks/mass"][1:]]
    np.testing.assert_array_equal(bare.inertia[FIXED], np.eye(3))
    np.testing.assert_array_equal(bare.inertia[SUPPORT:], settles["blocks/inertia"][SUPPORT:])
