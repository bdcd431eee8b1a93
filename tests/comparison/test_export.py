"""VTK's own reader finds the geometry, the mechanisms, and forces that carry the weight in the exported files."""

import json
import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from shutil import copytree
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import scenes
from conftest import CrossChecked
from runs import made_up_run
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

from comparison.cli.commands import main
from comparison.report.paraview import export_results
from comparison.report.vtk_xml import VERTEX, Grid, write_grid
from comparison.yade import Results
from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.exchange.fields import FREE

BALANCED = 1e-5  # of the weight: equilibrium residuals of a solved answer, summed over the contact points
SAME = 1e-12  # of a coordinate: the files hold double precision
SMALL = 1e-9  # a motion whose square is below round-off of the blocks' size


def read(path: Path) -> tuple[Any, dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Return the grid, the point data and the cell data of a .vtu file."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutput()
    tables = []
    for data in (grid.GetPointData(), grid.GetCellData()):
        tables.append({data.GetArrayName(k): values_of(data.GetAbstractArray(k)) for k in range(data.GetNumberOfArrays())})
    return grid, tables[0], tables[1]


def values_of(array: Any) -> Any:
    """Return the numbers of a VTK array, or a list of its texts."""
    if array.IsA("vtkStringArray"):
        return [array.GetValue(k) for k in range(array.GetNumberOfValues())]
    return vtk_to_numpy(array)


def points(grid: Any) -> np.ndarray:
    return vtk_to_numpy(grid.GetPoints().GetData())


def volume(grid: Any) -> float:
    """Return the volume by the divergence theorem; each face is a fan of triangles from its first corner."""
    total, place = 0.0, points(grid)
    for k in range(grid.GetNumberOfCells()):
        ids = grid.GetCell(k).GetPointIds()
        a, *others = (place[ids.GetId(i)] for i in range(ids.GetNumberOfIds()))
        total += sum(float(a @ np.cross(b, c)) / 6.0 for b, c in pairwise(others))
    return total


def collection(path: Path) -> list[tuple[float, int, str]]:
    return [
        (float(entry.attrib["timestep"]), int(entry.attrib["part"]), entry.attrib["file"])
        for entry in ElementTree.parse(path).getroot().iter("DataSet")
    ]


@pytest.fixture
def trilith(tmp_path: Path) -> tuple[LimitAnalysis, Path]:
    analysis = analyse(scenes.shipped("trilith"))
    export_results(Results(analysis, None), tmp_path)
    return analysis, tmp_path


def test_blocks_come_back_as_they_were(trilith: tuple[LimitAnalysis, Path]) -> None:
    analysis, folder = trilith
    grid, _, cells = read(folder / "blocks.vtu")
    blocks = analysis.assembly.blocks
    assert points(grid) == pytest.approx(blocks.vertices, rel=SAME)
    assert grid.GetNumberOfCells() == len(blocks.face_block)
    assert all(grid.GetCellType(k) == grid.GetCell(k).GetCellType() == 7 for k in range(grid.GetNumberOfCells()))
    own = [[grid.GetCell(k).GetPointId(i) for i in range(grid.GetCell(k).GetNumberOfPoints())] for k in range(grid.GetNumberOfCells())]
    assert np.concatenate(own).tolist() == blocks.face_vertex.tolist()
    assert volume(grid) == pytest.approx(blocks.volume.sum())
    assert cells["block"].tolist() == blocks.face_block.tolist()
    assert cells["name"] == [blocks.names[k] for k in blocks.face_block]
    assert cells["role"].tolist() == blocks.role[blocks.face_block].tolist()
    assert cells["density (kg/m3)"] == pytest.approx(blocks.density[blocks.face_block], nan_ok=True)


@pytest.mark.parametrize("method", ["associated", "coulomb"])
def test_forces_hold_every_free_block(method: str, trilith: tuple[LimitAnalysis, Path]) -> None:
    """The exported forces and their moments about the origin balance the weight of each free block."""
    analysis, folder = trilith
    grid, vectors, _ = read(folder / "forces.vtu")
    role = analysis.assembly.blocks.role
    weight = analysis.assembly.weight
    total = np.zeros(3)
    for block in np.flatnonzero(role == FREE):
        on_block = (vectors["block_b"] == block) * 1.0 - (vectors["block_a"] == block) * 1.0
        force, moment = on_block @ vectors[f"force_{method} (N)"], on_block @ np.cross(points(grid), vectors[f"force_{method} (N)"])
        own, arm = analysis.assembly.dead_load[block, :3], analysis.assembly.blocks.centroid[block]
        assert force == pytest.approx(-own, abs=BALANCED * weight)
        assert moment == pytest.approx(-np.cross(arm, own), abs=BALANCED * weight)
        total += force
    assert total == pytest.approx([0.0, 0.0, weight], abs=BALANCED * weight)


def test_vectors_of_a_mechanism_are_rigid_motions_and_the_support_moves_by_one(trilith: tuple[LimitAnalysis, Path]) -> None:
    analysis, folder = trilith
    grid, vectors, _ = read(folder / "blocks.vtu")
    blocks = analysis.assembly.blocks
    for method in ("associated", "coulomb"):
        for k in range(len(blocks)):
            own = slice(blocks.vertex_start[k], blocks.vertex_start[k + 1])
            place, speed = points(grid)[own], vectors[f"mechanism_{method} (m per m)"][own]
            difference, apart = speed[:, None] - speed, place[:, None] - place
            assert np.sum(difference * apart, axis=2) == pytest.approx(0.0, abs=SMALL)
            if blocks.role[k] != FREE:
                assert np.ptp(speed, axis=0) == pytest.approx(0.0, abs=SMALL)
        (support,) = np.flatnonzero(blocks.role == 2)
        assert vectors[f"mechanism_{method} (m per m)"][blocks.vertex_start[support]] == pytest.approx([0.0, 0.0, -1.0])


def test_without_a_mechanism_there_are_no_vectors(tmp_path: Path) -> None:
    tower = scenes.build(scenes.box("ground", (0.0, 0.0, -1.0), (1.0, 1.0, 0.0), "fixed"), *leaning())
    files = export_results(Results(analyse(tower), None), tmp_path)
    assert [path.name for path in files] == ["structure.pvd"]
    assert read(tmp_path / "blocks.vtu")[1] == {}


def leaning() -> tuple[str, str]:
    return (
        scenes.box("overhanging", (0.9, 0.0, 0.0), (3.0, 1.0, 0.5)),
        scenes.box("pad", (0.0, 0.0, 0.0), (0.5, 1.0, 0.5), "support") + "\n" + scenes.box("cap", (0.0, 0.0, 0.5), (0.5, 1.0, 1.0)),
    )


def turning_run(analysis: LimitAnalysis, angles: list[float]) -> Run:
    """Return a run whose blocks turn about the vertical axes through their centroids; each force component, N, is the state's number."""
    count, contacts = len(analysis.assembly.blocks), len(analysis.assembly.points)
    rotation = np.zeros((len(angles), count, 3))
    rotation[:, :, 2] = np.array(angles)[:, None]
    forces = np.ones((len(angles), contacts, 3)) * np.arange(len(angles))[:, None, None]
    poses = {
        "settlement": 0.5 * np.arange(len(angles)),
        "displacement": np.zeros_like(rotation) + np.array([0.0, 0.0, -0.25]),
        "rotation": rotation,
        "forces": forces,
    }
    return made_up_run({"plateau_start": 0.0}, poses=poses)


def test_states_of_yade_are_a_series_over_the_settlement_with_finite_rotations(tmp_path: Path) -> None:
    analysis = analyse(scenes.shipped("trilith"))
    blocks, angles = analysis.assembly.blocks, [0.0, np.pi / 2.0, np.pi]
    assert export_results(Results(analysis, turning_run(analysis, angles)), tmp_path)[1] == tmp_path / "yade.pvd"
    rows = collection(tmp_path / "yade.pvd")
    assert [(time, part) for time, part, _ in rows] == [(500.0 * k, part) for k in range(3) for part in (0, 1)]
    arm = blocks.vertices - np.repeat(blocks.centroid, np.diff(blocks.vertex_start), axis=0)
    for k, angle in enumerate(angles):
        grid, vectors, _ = read(tmp_path / rows[2 * k][2])
        turned = arm @ scenes.rotation((0.0, 0.0, 1.0), angle).T
        assert points(grid) + vectors["displacement (m)"] == pytest.approx(blocks.vertices - arm + turned + [0.0, 0.0, -0.25])
        assert np.all(read(tmp_path / rows[2 * k + 1][2])[1]["force_yade (N)"] == k)


def test_a_shorter_series_leaves_nothing_of_a_longer_one(tmp_path: Path) -> None:
    analysis = analyse(scenes.shipped("two_pads"))
    export_results(Results(analysis, turning_run(analysis, [0.0, 0.1, 0.2])), tmp_path)
    (tmp_path / "yade-notes.vtu").write_text("mine")
    export_results(Results(analysis, turning_run(analysis, [0.0])), tmp_path)
    assert sorted(path.name for path in tmp_path.glob("yade-*")) == ["yade-blocks-0000.vtu", "yade-forces-0000.vtu", "yade-notes.vtu"]


def test_an_export_without_yade_leaves_nothing_of_an_earlier_run(tmp_path: Path) -> None:
    """The earlier run may be of another structure. The user's own files stay."""
    analysis = analyse(scenes.shipped("two_pads"))
    export_results(Results(analysis, turning_run(analysis, [0.0, 0.1])), tmp_path)
    for name in ("yade-notes.vtu", "yade-notes-0001.vtu"):
        (tmp_path / name).write_text("mine")
    assert export_results(Results(analyse(scenes.shipped("two_blocks")), None), tmp_path) == [tmp_path / "structure.pvd"]
    assert sorted(path.name for path in tmp_path.glob("yade*")) == ["yade-notes-0001.vtu", "yade-notes.vtu"]


def test_every_file_of_a_collection_exists(trilith: tuple[LimitAnalysis, Path]) -> None:
    _, folder = trilith
    files = [name for _, _, name in collection(folder / "structure.pvd")]
    assert files == ["blocks.vtu", "forces.vtu", "joints.vtu"]
    assert all((folder / name).is_file() for name in files)


def test_joints_have_their_resultants_states_and_names_and_files_say_what_they_are_of(trilith: tuple[LimitAnalysis, Path]) -> None:
    analysis, folder = trilith
    interfaces, names = analysis.assembly.interfaces, analysis.assembly.blocks.names
    grid, values, _ = read(folder / "joints.vtu")
    assert grid.GetNumberOfCells() == len(interfaces)
    assert values["name_a"] == [names[k] for k in interfaces.block_a]
    _, contacts, _ = read(folder / "forces.vtu")
    assert values["resultant_coulomb (N)"].sum(axis=0) == pytest.approx(contacts["force_coulomb (N)"].sum(axis=0))
    size = np.hypot(values["normal_coulomb (N)"], values["shear_coulomb (N)"])
    assert size == pytest.approx(np.linalg.norm(values["resultant_coulomb (N)"], axis=1))
    assert set(values["state_coulomb"].tolist()) <= {0, 1, 2, 3} and 3 in values["state_coulomb"]
    for name in ("blocks.vtu", "forces.vtu", "joints.vtu"):
        data = read(folder / name)[0].GetFieldData()
        field = {data.GetArrayName(k): values_of(data.GetAbstractArray(k))[0] for k in range(data.GetNumberOfArrays())}
        assert field["title"] == analysis.scene.title and field["W (N)"] == pytest.approx(analysis.scene.weight)
        assert analysis.coulomb is not None and field["R_coulomb (N)"] == pytest.approx(analysis.coulomb.value)


def test_numbers_survive_whatever_their_type(tmp_path: Path) -> None:
    place = np.array([[np.pi, -1e300, 5e-324], [0.0, np.nan, np.inf]])
    each = np.arange(3)
    write_grid(tmp_path / "x.vtu", Grid(place, each[:-1], each, VERTEX, {"n": np.array([2**40, -1])}, {"flag": np.array([True, False])}))
    grid, at_points, at_cells = read(tmp_path / "x.vtu")
    assert np.array_equal(points(grid), place, equal_nan=True)
    assert at_points["n"].tolist() == [2**40, -1] and at_cells["flag"].tolist() == [1, 0]


@pytest.mark.yade
def test_the_command_exports_stored_results_or_a_scene(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    assert main(["run", "-q", "two_pads", "-o", str(out), "--no-yade"]) == 0
    capsys.readouterr()
    for source, folder in ((str(out / "two_pads"), "a"), ("two_pads", "b"), (str(out), "only")):
        assert main(["export", source, "-o", str(tmp_path / folder), "--json"]) == 0
        assert json.loads(capsys.readouterr().out) == {"files": [str(tmp_path / folder / "structure.pvd")]}
    assert (tmp_path / "a" / "blocks.vtu").read_bytes() == (tmp_path / "b" / "blocks.vtu").read_bytes()
    copytree(out / "two_pads", out / "other")
    assert main(["export", str(out), "-o", str(tmp_path / "c"), "--json"]) == 0
    files = [str(tmp_path / "c" / name / "structure.pvd") for name in ("other", "two_pads")]
    assert json.loads(capsys.readouterr().out) == {"files": files}
    assert main(["export", str(tmp_path), "-o", str(tmp_path / "c")]) == 2


@pytest.mark.slow
def test_cases_of_a_campaign_are_exported_into_folders_of_their_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = 'yade = false\n[[sweep]]\nscene = "two_blocks"\nvary = { "joint.friction" = [0.3, 0.6] }\n'
    (tmp_path / "friction.toml").write_text(text, encoding="utf-8")
    assert main(["campaign", "friction.toml", "-o", "out", "--workers", "1", "-q"]) == 0
    capsys.readouterr()
    for command in ("export", "animate"):
        assert main([command, "out"]) == 2
        (words,) = re.findall('name the folder of one of its cases, such as "(out/cases/[^"]+)"', capsys.readouterr().err)
        assert (Path(words) / "outcome.json").is_file()
    capsys.readouterr()
    cases = [f"two_blocks_friction={friction}" for friction in (0.3, 0.6)]
    for source in (f"out/cases/{cases[0]}", f"out/cases/{cases[1]}/two_blocks"):
        assert main(["export", source]) == 0
    assert capsys.readouterr().out.splitlines() == [f"{case}-paraview/structure.pvd" for case in cases]


def test_a_real_run_of_yade_is_exported_with_forces_that_carry_the_weight(
    tmp_path: Path, cross_checked: Callable[[str], CrossChecked]
) -> None:
    found = cross_checked("two_pads")
    assert main(["export", "-q", str(found.folder), "-o", str(tmp_path)]) == 0
    rows = collection(tmp_path / "yade.pvd")
    assert len(rows) == 2 * len(found.run.poses.settlement)
    blocks = found.analysis.assembly.blocks
    for _, part, name in rows:
        vectors = read(tmp_path / name)[1]
        if part == 1:
            lifting = np.where(blocks.role[vectors["block_b"]] == FREE, 1.0, -1.0) @ vectors["force_yade (N)"]
            assert lifting[2] == pytest.approx(found.scene.weight, rel=1e-2)
    assert {f"mechanism_{name} (m per m)" for name in ("associated", "coulomb", "yade")} == set(read(tmp_path / "blocks.vtu")[1])
