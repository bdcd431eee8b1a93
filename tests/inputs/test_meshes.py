"""Imported bodies form the same structure in any format, and runs keep their meshes."""

import json
from collections.abc import Callable
from pathlib import Path

import make_rubble_wall
import numpy as np
import pytest
import scenes
from conftest import CrossChecked
from mesh_files import (
    BOX_FACES,
    TRIANGLES,
    as_compas,
    as_compas_list_of_elements,
    as_compas_meshes,
    as_compas_model,
    as_compas_network,
    as_obj,
    as_obj_groups,
    as_old_compas,
    as_ply_folder,
    as_stl_folder,
    boxes,
    compas,
    obj,
    reaction,
    wall,
    written,
)

from comparison.cli.commands import main
from la_core.analysis.case_file import scene_digest
from la_core.model.assembly import assemble
from la_core.scene.generators.mesh_formats import surfaces
from la_core.scene.scene import load_scene

EXACT = 1e-6  # of the weight: residuals of a solved answer are below this
SINGLE = 1e-5  # of the weight: error of block lengths from coordinates in single precision
AS_WRITTEN = 1e-9  # m: half a unit of the last digit written, and round-off


@pytest.mark.parametrize(
    ("write", "tolerance"),
    [
        (as_obj, EXACT), (as_obj_groups, EXACT), (as_ply_folder, EXACT), (as_stl_folder, SINGLE),
        (as_compas, EXACT), (as_old_compas, EXACT), (as_compas_network, EXACT), (as_compas_model, EXACT),
        (as_compas_list_of_elements, EXACT), (as_compas_meshes, EXACT),
    ],
)  # fmt: skip
def test_a_wall_is_the_same_by_any_format(write: Callable[[Path], Path], tolerance: float, tmp_path: Path) -> None:
    imported, typed = load_scene(write(tmp_path)), boxes()
    assert sorted(imported.blocks.role) == sorted(typed.blocks.role)
    assert np.sort(imported.blocks.mass) == pytest.approx(np.sort(typed.blocks.mass), rel=tolerance, nan_ok=True)
    assert np.all(np.bincount(imported.blocks.face_block) == len(BOX_FACES))
    assert len(assemble(imported).points) == len(assemble(typed).points)
    assert reaction(imported) == pytest.approx(reaction(typed), abs=tolerance)


def test_names_roles_and_densities_come_from_the_table(tmp_path: Path) -> None:
    bodies = {name: vertices for name, (vertices, _) in wall().items()}
    scene = load_scene(written(tmp_path, "w.obj", obj(bodies), name="west", fixed=["gr?und"], support=["p*"], density=1000.0))
    assert scene.blocks.names == tuple(f"west {name}" for name in bodies)
    assert {name: scenes.ROLE_NAMES[int(role)] for name, role in zip(bodies, scene.blocks.role, strict=True)} == {
        name: role for name, (_, role) in wall().items()
    }
    assert scene.weight == pytest.approx(1000.0 * 9.81 * 1.6 * 0.3 * 0.6)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "cp1252"])
def test_names_are_read_in_the_encodings_in_which_programs_write_them(encoding: str) -> None:
    bodies = {"Stütze links": wall()["pad"][0], "Stütze é": wall()["ground"][0]}
    objects = obj(bodies).partition("\n")[2]  # the first line names the first body
    solids = ""
    for name, points in bodies.items():
        loops = ("\n".join(f"vertex {x!r} {y!r} {z!r}" for x, y, z in points[list(triangle)].tolist()) for triangle in TRIANGLES)
        facets = (f"facet normal 0 0 0\nouter loop\n{loop}\nendloop\nendfacet" for loop in loops)
        solids += "\n".join([f"solid {name}", *facets, f"endsolid {name}", ""])
    for suffix, text in ((".obj", objects), (".stl", solids), (".stl", solids.replace("solid", "SOLID"))):
        if suffix == ".obj" or encoding != "utf-16":
            found = surfaces(suffix, text.encode(encoding), "file")
            assert [body.name for body in found] == list(bodies)
            assert [len(body.faces) for body in found] == [len(BOX_FACES if suffix == ".obj" else TRIANGLES)] * 2


def test_a_line_in_another_encoding_leaves_the_names_of_all_others_as_they_are() -> None:
    """A UTF-8 file contains a comment or a name that an older program wrote in another encoding."""
    text = obj({"Stütze links": wall()["pad"][0], "Stütze é": wall()["ground"][0]}).encode()
    for mark in (b"", b"\xef\xbb\xbf"):
        mixed = mark + b"# Gr\xfc\xdfe\n" + text.replace("Stütze é".encode(), "Stütze é".encode("cp1252"))
        assert [body.name for body in surfaces(".obj", mixed, "file")] == ["Stütze links", "Stütze é"]


def test_a_mesh_is_scaled_then_turned_then_shifted(tmp_path: Path) -> None:
    bodies = {name: 1000.0 * vertices for name, (vertices, _) in wall().items()}
    turn = {"axis": [0.0, 0.0, 2.0], "degrees": 90.0}
    scene = load_scene(written(tmp_path, "w.obj", obj(bodies), scale=0.001, turn=turn, shift=[10.0, 20.0, 30.0]))
    assert scene.blocks.low.min(axis=0) == pytest.approx([10.0 - 0.3, 20.0, 30.0 - 0.2])
    assert scene.blocks.high.max(axis=0) == pytest.approx([10.0, 20.0 + 1.6, 30.0 + 0.6])


def test_the_rubble_wall_is_what_its_script_makes_and_fills_its_box() -> None:
    scene = scenes.shipped("rubble_wall")
    made = make_rubble_wall.stones()
    assert int(scene.blocks.free.sum()) == len(made)
    for vertices, k in zip(made, np.flatnonzero(scene.blocks.free), strict=True):
        own = scene.blocks.vertices[scene.blocks.vertex_start[k] : scene.blocks.vertex_start[k + 1]]
        assert own.min(axis=0) == pytest.approx(vertices.min(axis=0), abs=AS_WRITTEN)
        assert own.max(axis=0) == pytest.approx(vertices.max(axis=0), abs=AS_WRITTEN)
    box = make_rubble_wall.LENGTH * make_rubble_wall.DEPTH * make_rubble_wall.HEIGHT
    assert scene.weight == pytest.approx(2200.0 * 9.81 * box, rel=EXACT)


@pytest.mark.parametrize("seed", range(2))
def test_the_rubble_wall_turned_with_its_gravity_and_settlement_has_the_same_answer(seed: int, tmp_path: Path) -> None:
    chance = np.random.default_rng(seed)
    axis, degrees, shift = chance.normal(size=3), float(chance.uniform(0.0, 360.0)), chance.uniform(-5.0, 5.0, 3)
    turn = scenes.rotation(axis, np.radians(degrees))
    content = make_rubble_wall.OBJ.read_bytes()
    upright = load_scene(written(tmp_path, "rubble.obj", content))
    moved = load_scene(
        written(
            tmp_path,
            "rubble.obj",
            content,
            turn={"axis": axis, "degrees": degrees},
            shift=shift,
            gravity=turn @ [0.0, 0.0, -9.81],
            settlement=turn @ scenes.DOWN,
        )
    )
    assert moved.blocks.centroid == pytest.approx(upright.blocks.centroid @ turn.T + shift, abs=AS_WRITTEN)
    assert reaction(moved) == pytest.approx(reaction(upright), abs=EXACT)


def test_both_methods_agree_on_irregular_stones(cross_checked: Callable[[str], CrossChecked]) -> None:
    assert cross_checked("rubble_wall").summary["verdict"] == "agree"


@pytest.mark.parametrize("write", [as_obj, as_ply_folder])
def test_a_run_keeps_the_meshes_and_can_be_reported_alone(write: Callable[[Path], Path], tmp_path: Path, plain_figures: None) -> None:
    source, out = tmp_path / "source", tmp_path / "out"
    source.mkdir()
    scene = write(source)
    assert main(["run", "-q", str(scene), "-o", str(out), "--no-yade"]) == 0
    for path in source.rglob("*"):
        path.unlink() if path.is_file() and path != scene else None
    assert main(["report", "-q", str(out)]) == 0


def test_a_changed_mesh_is_solved_again_and_an_unchanged_one_is_not(
    tmp_path: Path, plain_figures: None, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, out = as_obj(tmp_path), tmp_path / "out"
    run = ["run", str(scene), "-o", str(out), "--no-yade"]
    assert main(run) == 0
    capsys.readouterr()
    assert main(run) == 0
    assert capsys.readouterr().err.count("cached") == 2
    before = scene_digest(load_scene(scene))
    lower = {name: vertices * [1.0, 1.0, 0.5] for name, (vertices, _) in wall().items()}
    (tmp_path / "wall.obj").write_text(obj(lower))
    assert scene_digest(load_scene(scene)) != before
    assert main(run) == 0
    assert "cached" not in capsys.readouterr().err
    summary = json.loads((out / "scene" / "comparison.json").read_text())
    assert summary["weight"] == pytest.approx(boxes().weight / 2.0)


def test_a_stone_taken_out_of_the_folder_leaves_the_run_s_folder(tmp_path: Path, plain_figures: None) -> None:
    scene, out = as_ply_folder(tmp_path), tmp_path / "out"
    run = ["run", "-q", str(scene), "-o", str(out), "--no-yade"]
    assert main(run) == 0
    (tmp_path / "stones" / "stone 2.3.ply").unlink()
    assert main(run) == 0
    assert not (out / "scene" / "stones" / "stone 2.3.ply").exists()
    assert main(["report", "-q", str(out)]) == 0


def test_a_mesh_named_like_a_result_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scene = written(tmp_path, "comparison.json", compas(wall()), fixed=[], support=["pad"])
    assert main(["run", str(scene), "-o", str(tmp_path / "out"), "--no-yade"]) == 2
    assert "has the name of a result; rename the file" in capsys.readouterr().err
