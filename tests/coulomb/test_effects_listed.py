"""The full model has every effect. Each effect is listed with its reason and, where it is left out, with the saving."""

import dataclasses
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scenes
from conftest import every_shipped_scene

from comparison.judge.effects_table import EFFECTS, effects_summary
from la_core.analysis.case_file import read_case, write_case
from la_core.analysis.decisions import decided_model
from la_core.analysis.reach import set_aside
from la_core.analysis.stage import analyse
from la_core.model.assembly import Assembly, assemble
from la_core.scene.variants import full_model

# --- the full model --------------------------------------------------------------------------------------------------------------


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


# --- the list of effects -----------------------------------------------------------------------------------------------------------


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


def saved(assembly: Assembly, whole: Assembly | None = None, poses: dict[str, int] | None = None, **choices: bool | str) -> dict[str, Any]:
    """Saving of each effect by name, for an assembly with these choices."""
    chosen = replace(assembly, effects=replace(assembly.effects, **choices))
    scene: Any = SimpleNamespace(friction=0.6, yade=poses or {})
    return {row["effect"]: row["saved"] for row in effects_summary(scene, whole or assembly, chosen)["table"]}


def test_what_a_plane_model_saves_by_counting() -> None:
    """A stack of two blocks on a base has two joints. Each has four contact points in space and two in the plane."""
    stack = [scenes.box(f"block {k}", (0.0, 0.0, 0.2 * k), (0.5, 0.3, 0.2 * (k + 1))) for k in range(2)]
    scene = scenes.build(*stack, scenes.box("base", (0.0, 0.0, -0.2), (0.5, 0.3, 0.0), "support"), inset=1e-3)
    plane, space = assemble(scene), assemble(scenes.load(scene.text.replace('plane = "auto"', "plane = false")))
    off = {"friction": "none-slides", "elasticity": "none", "rotation": "small", "displacement": "small", "recording": "plateau"}
    assert saved(plane, **off) == {
        "plane": {"unknowns": 6, "contact points": 4, "second-order cones": 8, "spheres in YADE": 4},
        "friction": {"path or more of the prediction": 1},
        "elasticity": {"springs": 8},
        "rotation": {"run of YADE over its whole travel": 1},
        "reach": {},
        "displacement": {"engine in YADE, the collider": 1},
        "recording": {"states": 2},  # of 40: before the plateau, over 6 % of the travel
    }
    in_space = saved(space, poses={"poses": 100}, **off | {"friction": "associated"})
    assert in_space["plane"] == {} and in_space["elasticity"] == {"springs": 24} and in_space["recording"] == {"states": 6}
    assert in_space["friction"] == {"path or more of the prediction": 1}
    on = {"friction": "coulomb", "elasticity": "plateau", "rotation": "finite", "displacement": "finite", "recording": "states"}
    assert not any(saved(space, **on).values())


@pytest.mark.parametrize(("plane", "unknowns", "points"), [(True, 6, 4), (False, 12, 8)])
def test_what_is_set_aside_saves_its_blocks_and_their_joints(plane: bool, unknowns: int, points: int) -> None:
    """One of two stacks of two blocks is set aside. A block in YADE has three bodies: a clump, a carrier and a face."""
    stacks = [
        scenes.box(f"block {j} {k}", (2.0 * j, 0.0, 0.2 * k), (2.0 * j + 0.5, 0.3, 0.2 * (k + 1))) for j in range(2) for k in range(2)
    ]
    bases = [scenes.box(f"base {j}", (2.0 * j, 0.0, -0.2), (2.0 * j + 0.5, 0.3, 0.0), role) for j, role in enumerate(("support", "fixed"))]
    whole = assemble(scenes.build(*stacks, *bases, inset=1e-3, plane=plane))
    part = set_aside(whole, np.array([name.startswith("block 1") for name in whole.blocks.names]))
    counts = {"unknowns": unknowns, "contact points": points, "bodies in YADE": 6, "spheres in YADE": points}
    assert saved(part, whole, reach=True)["reach"] == counts
    assert saved(whole, whole, reach=False)["reach"] == {}


def test_the_seconds_of_an_effect_are_those_of_each_answer_once() -> None:
    """The answers at the shared inset and for sharp edges may be the same one, whose seconds count once."""
    scene = scenes.shipped("wall_third")
    decided = decided_model(scene)

    def seconds(shared: float, sharp: float | None, path: float | None) -> dict[str, float | None]:
        coulomb = SimpleNamespace(seconds=shared)
        other = coulomb if sharp is None else SimpleNamespace(seconds=sharp)
        analysis: Any = SimpleNamespace(coulomb=coulomb, sharp=SimpleNamespace(coulomb=other), path=path and SimpleNamespace(seconds=path))
        assembly = replace(decided.assembly, effects=replace(decided.assembly.effects, friction="coulomb", elasticity="path"))
        return {row["effect"]: row["seconds"] for row in effects_summary(scene, decided.whole, assembly, analysis)["table"]}

    assert (seconds(3.0, None, None)["friction"], seconds(3.0, 4.0, None)["friction"]) == (3.0, 7.0)
    assert (seconds(3.0, None, 5.0)["elasticity"], seconds(3.0, None, None)["elasticity"]) == (5.0, None)


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
