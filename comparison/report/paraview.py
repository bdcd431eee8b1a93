"""Results as ParaView files: blocks with their mechanisms, contact forces, and YADE's states over the settlement."""

from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from comparison.figures import canvas
from comparison.report.vtk_xml import POLYGON, VERTEX, Grid, write_collection, write_grid
from comparison.yade import Results, Run
from la_core.geometry import Blocks
from la_core.measures import contact_states, joint_centres, joint_forces, joint_states, mechanism
from la_core.model import Assembly


def export_results(results: Results, folder: Path) -> list[Path]:
    """Write all results into a folder and return the files to open.

    These are `structure.pvd`, and `yade.pvd` where YADE stored states. The name of every array says its meaning and its unit.

    - `blocks.vtu` has the faces of the blocks: `mechanism_coulomb (m per m)` and so on, vectors for the unit motion of the support, and
      for every face the block's number, name, role and density.
    - `forces.vtu` has the contact points: `force_coulomb (N)` and so on, on block b.
    - `joints.vtu` has the middle of every joint: `resultant_coulomb (N)`, its normal and shear part, and `state_coulomb`, with the names
      of both blocks. A state is 0 sticks, 1 carries nothing, 2 slides, 3 opens, -1 unknown.
    - In `yade.pvd` the time is the settlement in mm (mrad for a rotation). Its vectors are `displacement (m)`, from the case's geometry,
      and `force_yade (N)`.
    - The field data of every file hold the title, the weight W, the reaction R of each method, and the size of the structure.

    Parameters
    ----------
    results : Results
        Stored results of one scene.
    folder : Path
        Created where it does not exist. Files of an earlier export are replaced or deleted.
    """
    analysis, run = results.analysis, results.run
    folder.mkdir(parents=True, exist_ok=True)
    assembly = analysis.assembly
    mechanisms, forces = _mechanisms(results), _forces(results)
    per = "1" if results.scene.live is not None else "m per rad" if results.scene.is_rotation else "m per m"
    velocities = {f"mechanism_{name} ({per})": _velocities(assembly.blocks, twists) for name, twists in mechanisms.items()}
    field = _field_data(results)
    write_grid(folder / "blocks.vtu", _blocks_grid(assembly.blocks, velocities, field))
    write_grid(folder / "forces.vtu", _forces_grid(assembly, {f"force_{name} (N)": values for name, values in forces.items()}, field))
    write_grid(folder / "joints.vtu", _joints_grid(assembly, mechanisms, forces, field))
    write_collection(folder / "structure.pvd", [(0.0, ("blocks.vtu", "forces.vtu", "joints.vtu"))])
    if run is None or not len(run.poses.settlement):
        (folder / "yade.pvd").unlink(missing_ok=True)
        _delete_states(folder)
        return [folder / "structure.pvd"]
    return [folder / "structure.pvd", _export_states(assembly, run, folder, field)]


def _export_states(assembly: Assembly, run: Run, folder: Path, field: dict[str, Any]) -> Path:
    """Write YADE's stored states as a series in place of any earlier one, and return its path."""
    rows = []
    for number, settlement in enumerate(run.poses.settlement):
        names = (f"yade-blocks-{number:04d}.vtu", f"yade-forces-{number:04d}.vtu")
        moved = _displacements(assembly.blocks, run.poses.displacement[number], run.poses.rotation[number])
        write_grid(folder / names[0], _blocks_grid(assembly.blocks, {"displacement (m)": moved}, field))
        write_grid(folder / names[1], _forces_grid(assembly, {"force_yade (N)": run.poses.forces[number]}, field))
        rows.append((1e3 * float(settlement), names))  # mm or mrad
    _delete_states(folder, {name for _, names in rows for name in names})
    write_collection(folder / "yade.pvd", rows)
    return folder / "yade.pvd"


def _delete_states(folder: Path, but: Collection[str] = ()) -> None:
    """Delete the grids of an earlier series, which may be of another structure, except those with a name in `but`."""
    for kind in ("blocks", "forces"):
        for old in folder.glob(f"yade-{kind}-[0-9][0-9][0-9][0-9].vtu"):
            if old.name not in but:
                old.unlink()


def _mechanisms(results: Results) -> dict[str, np.ndarray]:
    """Return twists (B, 6) by method, for the methods that found a mechanism."""
    analysis, run = results.analysis, results.run
    twists = {"associated": results.per_motion(analysis.bounds[analysis.main].twists)}
    if analysis.coulomb is not None:
        twists["coulomb"] = results.per_motion(analysis.coulomb.twists)
    if run is not None:
        twists["yade"] = run.mechanism()
    return {name: values for name, values in twists.items() if np.isfinite(values).all()}


def _forces(results: Results) -> dict[str, np.ndarray]:
    """Return contact forces (C, 3) on block b by method, N.

    YADE's forces are the mean over its plateau, else those of its last state.
    """
    analysis, run = results.analysis, results.run
    forces = {"associated": analysis.bounds[analysis.main].forces}
    if analysis.coulomb is not None:
        forces["coulomb"] = analysis.coulomb.forces
    if run is not None and len(run.poses.settlement):
        forces["yade"] = run.plateau_forces()
    return {name: values for name, values in forces.items() if np.isfinite(values).all()}


def _arms(blocks: Blocks) -> tuple[np.ndarray, np.ndarray]:
    """Return the block of every vertex (V,), and the vertex relative to its block's centroid (V, 3), m."""
    block = blocks.vertex_block
    return block, blocks.vertices - blocks.centroid[block]


def _velocities(blocks: Blocks, twists: np.ndarray) -> np.ndarray:
    return mechanism.point_velocity(blocks, twists, blocks.vertices, _arms(blocks)[0])


def _displacements(blocks: Blocks, displacement: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Return the displacements (V, 3) of the vertices, m.

    The blocks move by displacements (B, 3), m, and rotation vectors (B, 3), rad, of any size.
    """
    block, arm = _arms(blocks)
    return displacement[block] + scipy.spatial.transform.Rotation.from_rotvec(rotation[block]).apply(arm) - arm


def _field_data(results: Results) -> dict[str, Any]:
    """Return the values of the whole structure: its title, weight, reactions by method and size."""
    scene, analysis, run = results.scene, results.analysis, results.run
    unit = scene.unit or "1"
    name = "multiplier" if scene.live is not None else "R"
    field: dict[str, Any] = {
        "title": scene.title,
        "roles": "0 free, 1 fixed, 2 support",
        "states": "0 sticks, 1 carries nothing, 2 slides, 3 opens, -1 unknown",
        "W (N)": scene.weight,
        "size (m)": canvas.structure_size(analysis.assembly.blocks),
        f"{name}_associated ({unit})": analysis.bounds[analysis.main].value,
    }
    if analysis.coulomb is not None:
        field[f"{name}_coulomb ({unit})"] = analysis.coulomb.value
    if run is not None:
        field[f"{name}_yade ({unit})"] = run.reaction
    return field


def _blocks_grid(blocks: Blocks, vectors: dict[str, np.ndarray], field: dict[str, Any]) -> Grid:
    owner = blocks.face_block
    names = np.array(blocks.names, dtype=object)[owner]
    cells = {"block": owner, "name": names, "role": blocks.role[owner], "density (kg/m3)": blocks.density[owner]}
    return Grid(blocks.vertices, blocks.face_vertex, blocks.face_start, POLYGON, vectors, cells, field)


def _joints_grid(assembly: Assembly, mechanisms: dict[str, np.ndarray], forces: dict[str, np.ndarray], field: dict[str, Any]) -> Grid:
    """Return the middle of every joint with its resultant forces and its states, by method."""
    interfaces, names = assembly.interfaces, np.array(assembly.blocks.names, dtype=object)
    values: dict[str, np.ndarray] = {
        "name_a": names[interfaces.block_a], "name_b": names[interfaces.block_b], "normal": interfaces.normal, "area (m2)": interfaces.area,
    }  # fmt: skip
    for name, contact_forces in forces.items():
        joints = joint_forces(assembly, contact_forces)
        values |= {f"resultant_{name} (N)": joints.force, f"normal_{name} (N)": joints.normal, f"shear_{name} (N)": joints.shear}
        if name in mechanisms:
            states = contact_states(assembly, mechanisms[name], contact_forces)
            values[f"state_{name}"] = joint_states(assembly, states, contact_forces)
    each = np.arange(len(interfaces) + 1)
    return Grid(joint_centres(assembly), each[:-1], each, VERTEX, values, {}, field)


def _forces_grid(assembly: Assembly, forces: dict[str, np.ndarray], field: dict[str, Any]) -> Grid:
    points, interfaces = assembly.points, assembly.interfaces
    sides = {"block_a": interfaces.block_a[points.interface], "block_b": interfaces.block_b[points.interface]}
    each = np.arange(len(points) + 1)
    return Grid(points.position, each[:-1], each, VERTEX, {**forces, "normal": interfaces.normal[points.interface], **sides}, {}, field)
