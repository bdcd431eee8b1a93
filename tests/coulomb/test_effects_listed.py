"""The full model has every effect, and each is listed with its reason and what it saves."""

import dataclasses

import pytest
import scenes
from conftest import every_shipped_scene

from comparison.judge.effects_table import EFFECTS, effects_summary
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.decisions import decided_model
from la_core.analysis.stage import analyse
from la_core.model.assembly import assemble
from la_core.scene.variants import full_model

# --- everything on ---------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["arch_spreading", "wall_third", "slab_four_corners", "two_pads", "ferris_tin_loi_1"])
def test_the_full_model_has_every_effect_and_the_same_structure(name: str) -> None:
    scene = scenes.shipped(name)
    full = full_model(scene)
    assert full.name == f"{name}_full"
    assert full.effects.model_dump() == {
        "plane": False, "friction": "coulomb", "elasticity": "auto", "reach": False, "displacement": "finite", "recording": "states",
        "rotation": "auto",
    }  # fmt: skip
    assert full.blocks.names == scene.blocks.names and full.weight == scene.weight
    assert full.path_asked == scene.path_asked and full.expected == scene.expected and full.yade == scene.yade


def test_effects_of_a_scene_give_way_to_the_full_model() -> None:
    plain = scenes.text(*scenes.wall(3, 2, 0.6), model="auto", plane=True, effects={"displacement": "small"})
    full = full_model(scenes.load(plain))
    assert full.effects.friction == "coulomb" and full.effects.displacement == "finite"
    for law in ("associated", "none-slides"):
        assert full_model(scenes.load(plain.replace('friction = "auto"', f'friction = "{law}"'))).effects.friction == law


def test_effects_that_are_no_table_of_their_own_are_replaced_too() -> None:
    inline = "effects = { plane = true }\n" + scenes.text(*scenes.wall(3, 2, 0.6)).replace("[effects]", "[yade]").replace(
        'plane = "auto"\nfriction = "associated"\nreach = "auto"', ""
    )
    plain = scenes.load(inline)
    assert plain.effects.plane is True
    full = full_model(plain)
    assert full.effects.plane is False and full.effects.friction == "coulomb"
    assert full.blocks.names == plain.blocks.names and full.weight == plain.weight


# --- what the user sees ------------------------------------------------------------------------------------------------------------


def test_every_effect_is_listed_with_its_reason_and_what_it_saves() -> None:
    scene = scenes.shipped("arch_spreading")
    analysis = analyse(scene)
    summary = effects_summary(scene, analysis.whole, analysis.assembly, analysis)
    assert [row["effect"] for row in summary["table"]] == list(EFFECTS)
    rows = {row["effect"]: row for row in summary["table"]}
    assert not rows["plane"]["on"] and not rows["friction"]["on"]
    in_space = assemble(dataclasses.replace(scene, effects=scene.effects.model_copy(update={"plane": False})))
    assert rows["plane"]["saved"]["contact points"] == len(in_space.points) - len(analysis.assembly.points)
    assert rows["plane"]["saved"]["unknowns"] == 3 * int(scene.blocks.free.sum())
    assert all(row["reason"] for row in summary["table"])


@every_shipped_scene
def test_every_shipped_scene_says_what_it_does_without_before_it_is_solved(name: str) -> None:
    scene = scenes.shipped(name)
    decided = decided_model(scene)
    summary = effects_summary(scene, decided.whole, decided.assembly)
    assert [row["effect"] for row in summary["table"]] == list(EFFECTS)
    for row in summary["table"]:
        assert row["reason"] and row["modelled"]
        assert bool(row["saved"]) == (not row["on"])
        assert all(count > 0 for count in row["saved"].values())


def test_settled_effects_come_back_from_the_file(tmp_path) -> None:
    scene = scenes.shipped("arch_spreading")
    analysis = analyse(scene)
    write_case(tmp_path / "case.h5", analysis, "inputs")
    assert read_case(tmp_path / "case.h5", scene).assembly.effects == analysis.assembly.effects == decided_model(scene).assembly.effects
