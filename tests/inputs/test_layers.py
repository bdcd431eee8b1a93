"""Layers and colours of a drawing choose blocks for friction, loads, densities and zones, in both methods."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Silent

from comparison.workflow import run_scene
from la_core.analysis import analyse
from la_core.errors import SceneError
from la_core.limit import Drive
from la_core.model import assemble
from la_core.scene import Scene, build, classes_as_dicts

INSET = 1e-3  # m
EXACT, PER_MILLE = 1e-6, 1e-3
DEPTH, DENSITY = 0.3, 2000.0  # m, kg/m3
STACK = {  # layer, fill and corners in mm of every outline: two pads, two bricks on them, one stone on both
    "FIXED": ("grey", [(0, -200), (1000, -200), (1000, 0), (0, 0)]),
    "PAD": ("grey", [(1000, -200), (2000, -200), (2000, 0), (1000, 0)]),
    "BRICK": ("red", [(0, 0), (2000, 0), (2000, 200), (0, 200)]),
    "STONE": ("blue", [(0, 200), (2000, 200), (2000, 400), (0, 400)]),
}
BRICK_WEIGHT = 2.0 * 0.2 * DEPTH * DENSITY * 9.81  # N


def stack(folder: Path, drawing: dict[str, Any] | None = None, **tables: Any) -> Scene:
    """The stack, drawn as SVG. It is pushed along x unless the tables have a settlement."""
    drawn = "".join(
        f'<g id="{layer}"><path fill="{fill}" d="M {" L ".join(f"{x},{-z}" for x, z in corners)} Z"/></g>'
        for layer, (fill, corners) in STACK.items()
    )
    page = f'<svg xmlns="http://www.w3.org/2000/svg" width="3000mm" height="1000mm" viewBox="0 -500 3000 1000">{drawn}</svg>'
    (folder / "stack.svg").write_text(page, encoding="utf-8")
    held = {"ground": ["FIXED", "PAD"]} if "settlement" not in tables else {"ground": ["FIXED"], "support": ["PAD"]}
    whole = {
        "stone": {"density": DENSITY}, "joint": {"friction": 0.6, "inset": INSET},
        "drawing": [{"file": "stack.svg", "thickness": DEPTH, **held, **(drawing or {})}],
    }  # fmt: skip
    driven = {} if "settlement" in tables else {"live": {"direction": [1.0, 0.0, 0.0]}}
    return build({**whole, **driven, **tables}, "stack", folder)


def between(one: str, other: str, mu: float, **more: str) -> dict[str, Any]:
    return {"between": [one, other], "friction": mu, **more}


@pytest.mark.parametrize(
    ("rules", "brick_below", "brick_above"),
    [
        ([between("layer:BRICK", "layer:STONE", 0.2)], 0.6, 0.2),
        ([between("layer:STONE", "layer:BRICK", 0.2)], 0.6, 0.2),
        ([between("layer:BRICK", "layer:*", 0.2)], 0.2, 0.2),
        ([between("colour:red", "colour:gr[ae]y", 0.2)], 0.2, 0.6),
        ([between("layer:BRICK", "*", 0.2, joints="bed")], 0.6, 0.2),
        ([between("layer:BRICK", "*", 0.2), between("layer:BRICK", "layer:STONE", 0.4)], 0.2, 0.4),
    ],
)
def test_contact_points_between_layers_have_the_friction_of_their_class(
    rules: list[dict[str, Any]], brick_below: float, brick_above: float, tmp_path: Path
) -> None:
    model = assemble(stack(tmp_path, friction=rules))
    above = model.points.position[:, 2] > 0.1
    assert above.any() and (~above).any()
    assert np.all(model.points.friction[above] == brick_above)
    assert np.all(model.points.friction[~above] == brick_below)


def test_the_stack_slides_where_the_layers_meet_at_least_friction(tmp_path: Path) -> None:
    scene = stack(tmp_path, friction=[between("layer:BRICK", "layer:STONE", 0.2)])
    assert analyse(scene).bounds[Drive.LIVE].value == pytest.approx(0.2, abs=EXACT)
    assert classes_as_dicts(scene.joint_classes) == [{"joints": None, "between": ["layer:BRICK", "layer:STONE"], "friction": 0.2}]


@pytest.mark.yade
def test_both_methods_slide_between_two_layers(tmp_path: Path) -> None:
    scene = stack(tmp_path, friction=[between("layer:BRICK", "layer:STONE", 0.2)], effects={"friction": "coulomb"})
    summary = run_scene(scene, tmp_path / "results", Silent(), with_yade=True, figures=lambda _: {})
    assert summary["verdict"] == "agree", summary["reason"]
    assert summary["limit_analysis"]["coulomb"]["multiplier"] == pytest.approx(0.2, rel=PER_MILLE)
    assert summary["yade"]["multiplier"] == pytest.approx(0.2, rel=PER_MILLE)


def test_loads_densities_and_zones_choose_layers(tmp_path: Path) -> None:
    scene = stack(
        tmp_path,
        {"density_of": {"BRICK": 1500.0, "colour:blue": 2500.0}},
        load=[{"blocks": ["layer:STONE"], "mass": 100.0}],
        settlement={"direction": [0.0, 0.0, -1.0], "zone": [{"blocks": ["layer:PAD"], "ratio": 0.5}]},
    )
    assert scene.blocks.density[scene.blocks.free] == pytest.approx([1500.0, 2500.0])
    assert scene.weight == pytest.approx(BRICK_WEIGHT * (1500.0 + 2500.0) / DENSITY + 981.0)
    assert scene.support_twists is not None
    assert scene.support_twists[1, 2] == -0.5


def test_a_word_before_a_layer_is_allowed_in_the_drawing_too(tmp_path: Path) -> None:
    scene = stack(tmp_path, {"thickness_of": {"layer:STONE": 0.2}})
    assert scene.blocks.volume[2:] == pytest.approx([0.4 * DEPTH, 0.4 * 0.2])


@pytest.mark.parametrize(
    ("drawing", "tables", "message"),
    [
        (
            {},
            {"friction": [between("layer:BRIK", "*", 0.2)]},
            'friction[0].between: no block has the layer "BRIK"; did you mean "layer:BRICK"?',
        ),
        ({}, {"friction": [between("BRICK", "*", 0.2)]}, 'no block has the name "BRICK"; did you mean "layer:BRICK"?'),
        ({}, {"friction": [between("colour:rde", "*", 0.2)]}, 'no block has the colour "rde"; did you mean "colour:red"?'),
        ({}, {"friction": [between("layer:STONE", "layer:PAD", 0.2)]}, "no joint lies between these blocks"),
        ({}, {"load": [{"blocks": ["layer:STNE"], "mass": 1.0}]}, 'no block has the layer "STNE"; did you mean "layer:STONE"?'),
        ({}, {"load": [{"blocks": ["layer:PAD"], "mass": 1.0}]}, "chooses no free block"),
        (
            {},
            {"tie": [{"blocks": ["layer:STONE"], "from": [0, 0, 0], "to": [0, 0, 1], "force": 1.0}]},
            "a rod ends at one block, so give the name of that block",
        ),
        (
            {},
            {"settlement": {"direction": [0, 0, -1], "zone": [{"blocks": ["layer:STONE"], "ratio": 0.5}]}},
            'no support has the layer "STONE"; did you mean "layer:PAD"?',
        ),
        (
            {"density_of": {"BRIK": 1.0}},
            {},
            "density_of = 'BRIK': no outline is on such a layer or of such a colour; did you mean \"BRICK\"?",
        ),
        ({"thickness_of": {"BRIK": 1.0}}, {}, "thickness_of = 'BRIK': no outline is on such a layer"),
    ],
)
def test_an_unknown_layer_is_named_with_the_nearest_one(
    drawing: dict[str, Any], tables: dict[str, Any], message: str, tmp_path: Path
) -> None:
    with pytest.raises(SceneError) as refused:
        assemble(stack(tmp_path, drawing, **tables))
    assert message in str(refused.value)


def test_layers_of_a_scene_without_a_drawing_are_refused() -> None:
    blocks = [
        {"name": "ground", "role": "fixed", "box": {"from": [0, 0, -1], "to": [1, 1, 0]}},
        {"name": "stone", "box": {"from": [0, 0, 0], "to": [1, 1, 1]}},
    ]
    scene = {"stone": {"density": 2e3}, "joint": {"friction": 0.6}, "block": blocks, "live": {"direction": [1, 0, 0]}}
    with pytest.raises(SceneError, match=r"only blocks of a \[\[drawing\]\] have a layer or a colour"):
        build({**scene, "friction": [between("layer:STONE", "*", 0.2)]})
