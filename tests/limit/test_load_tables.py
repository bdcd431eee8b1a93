"""Tables of loads, ties and classes of joints: mistakes are named with their lines, and commands and reports list the tables."""

import json
import math
from pathlib import Path

import pytest
import scenes
from loaded_scenes import BEAM, STACK, friction, load, tie

from comparison.cli.commands import main
from comparison.figures.canvas import LOAD_COLOUR
from comparison.figures.structure import assembly_figure
from comparison.numbers import Units
from comparison.report.inputs import input_rows
from la_core.errors import SceneError
from la_core.model.assembly import assemble
from la_core.scene.loads.summary import classes_as_dicts, loads_as_dicts, ties_as_dicts
from la_core.scene.scene import load_scene
from la_core.scene.shipped import find, starter_text

# --- mistakes ----------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (load(), "needs either a `force` or a `mass`"),
        (load(mass=1.0, force=(0.0, 0.0, -1.0)), "needs either a `force` or a `mass`"),
        (load(mass=1.0, blocks=[]), "needs `blocks` or a `region`"),
        (load(mass=1.0, blocks=["beem"]), 'no block has the name "beem"; did you mean "beam"?'),
        (load(mass=1.0, blocks=["lift"]), 'no block has the name "lift"; valid names: beam'),  # "left" is held: no load acts on it
        (load(mass=1.0, blocks=["left"]), "chooses no free block; a load on a held block changes nothing"),
        (load(mass=1.0, per="m"), '`per = "m"` needs `from` and `to`'),
        (load(mass=1.0, start=(0.0, 0.0), to=(1.0, 0.0)), '`per = "m"` needs `from` and `to`, and they belong to it alone'),
        (load(mass=1.0, per="m", start=(0.0, 0.0), to=(0.0, 0.0)), "`from` and `to` must differ"),
        (load(mass=1.0, per="m", start=(0.0, 7.0), to=(1.0, 7.0)), "no top face of the chosen blocks lies under the line"),
        (load(mass=1.0, per="m2", at=(0.0, 0.0, 0.0)), "`at` belongs to a load"),
        (load(force=(0.0, 0.0, 0.0)), "must not be the zero vector"),
        (tie(["beam", "beem"], (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.0), 'no block has the name "beem"; did you mean "beam"?'),
        (tie(["left", "right"], (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.0), "no end is at a free block"),
        (tie(["beam", "beam"], (0.0, 0.0, 0.0), (1.0, 0.0, 0.0), 1.0), "the two `blocks` must differ"),
        (tie(["beam"], (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0), "`from` and `to` must differ"),
        (friction(friction=0.1), "needs `joints` or `between`"),
        (friction(between=["beam", "lift"], friction=0.1), 'no block has the name "lift"; did you mean "left"?'),
    ],
)
def test_a_mistake_in_a_table_is_named_with_its_line(table: str, message: str) -> None:
    with pytest.raises(SceneError) as refused:
        scenes.build(*BEAM, table)
    assert message in str(refused.value)
    assert "line " in str(refused.value)


def test_a_load_that_would_count_twice_is_refused() -> None:
    with pytest.raises(SceneError, match="lie above each other"):
        scenes.build(*STACK, load(blocks=["lower", "upper"], mass=100.0, per="m2"), live=(1.0, 0.0, 0.0), settlement=None)


def test_a_point_on_several_blocks_is_refused() -> None:
    with pytest.raises(SceneError, match="is a point on one block, but 2 blocks are chosen"):
        scenes.build(*STACK, load(blocks=["*er"], mass=100.0, at=(0.5, 0.5, 0.4)), live=(1.0, 0.0, 0.0), settlement=None)


def test_a_class_of_joints_that_no_joint_belongs_to_is_refused() -> None:
    scene = scenes.build(*BEAM, friction(between=["left", "right"], friction=0.1))
    with pytest.raises(SceneError, match=r"no joint lies between these blocks"):
        assemble(scene)


# --- output for the user -----------------------------------------------------------------------------------------------------


def test_show_lists_and_draws_loads_ties_and_classes_of_joints(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "floors.toml"
    path.write_text(starter_text("floors"), encoding="utf-8")
    assert main(["show", str(path), "-q", "--json", "-o", str(tmp_path / "floors.png")]) == 0
    facts = json.loads(capsys.readouterr().out)
    floor, beam = facts["loads"]
    assert (floor["name"], floor["mass"], floor["blocks"]) == ("floor", pytest.approx(250.0 * 3.6), 7)
    assert (beam["force"], beam["mass"], beam["blocks"]) == ([0.0, 0.0, -1500.0], None, 1)
    (rod,) = facts["ties"]
    assert (rod["name"], rod["tension"], rod["between"]) == ("rod", 2000.0, ["wall 5.1", "wall 5.6"])
    assert rod["length"] == pytest.approx(3.6) == math.dist(*rod["ends"])
    assert facts["joint_classes"] == [{"joints": "footing", "between": None, "friction": 0.5, "interfaces": 6}]
    scene = load_scene(path)
    figure = assembly_figure(scene, assemble(scene))
    labels = {text.get_text() for legend in figure.legends for text in legend.get_texts()}
    assert {"dead load", "tie"} <= labels
    arrows = [text for text in figure.axes[0].texts if text.arrowprops and text.arrowprops.get("color") == LOAD_COLOUR]
    assert len(arrows) == len(scene.loads) == 8


def test_a_tie_that_ends_at_a_support_is_not_told_to_end_in_the_ground() -> None:
    tie = '[[tie]]\nblocks = ["block", "{}"]\nfrom = [0.8, 0.1, 0.4]\nto = [0.8, 0.1, 0.0]\nforce = 200.0\n[settlement]'
    text = find("two_pads").read_text(encoding="utf-8")
    for pad, told in (("settling pad", "support"), ("fixed pad", "ground")):
        scene = scenes.load(text.replace("[settlement]", tie.format(pad)))
        assert ties_as_dicts(scene.ties, scene.blocks.names)[0]["between"] == ["block", told]


def test_the_inputs_of_a_report_list_loads_ties_and_classes_of_joints() -> None:
    scene = scenes.load(starter_text("floors"))
    facts = {
        "loads": loads_as_dicts(scene.loads, scene.load_names),
        "ties": ties_as_dicts(scene.ties, scene.blocks.names),
        "joint_classes": classes_as_dicts(scene.joint_classes),
        "densities": [], "gravity": [0.0, 0.0, -9.81], "friction": [0.5, 0.6], "inset": 1e-3,
    }  # fmt: skip
    rows = dict(input_rows({"structure": facts, "weight": scene.weight}, Units(scene.weight)))
    assert rows["dead load floor (x, y, z)"].endswith("on 7 blocks, 900 kg, resultant through (1.8, 0.2, 1.8) m")
    assert rows["dead load roof beam (x, y, z)"].endswith("on 1 block, resultant through (1.4, 0.2, 1.8) m")
    assert rows["tie rod, tension"].endswith("between wall 5.1 and wall 5.6, from (0, 0.2, 1.35) m to (3.6, 0.2, 1.35) m")
    assert rows["friction coefficient of footing joints"] == "0.5"
    assert "weight of the free blocks and the loads on them, W" in rows
