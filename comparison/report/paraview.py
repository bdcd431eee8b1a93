"""Results as ParaView files: blocks with their mechanisms, contact forces, and YADE's states over the settlement."""

from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from comparison.report.vtk_xml import POLYGON, VERTEX, Grid, write_collection, write_grid
from comparison.yade import Results, Run
from la_core.geometry import Blocks
from la_core.measures import mechanism
from la_core.model import Assembly


def export(results: Results, folder: Path) -> list[Path]:
    """Write all results into a folder and return the files to open.

    These are `structure.pvd`, and `yade.pvd` where YADE stored states.

    - `blocks.vtu` has the faces of the blocks, with the mechanisms as vectors for the unit motion of the support.
    - `forces.vtu` has the contact points, with the forces on block b (N).
    - The vectors of both files are named associated, coulomb and yade.
    - In `yade.pvd` the time is the settlement (m or rad). Its vectors are displacement (m), from the case's geometry, and force (N).

    Parameters
    ----------
    results : Results
        Stored results of one scene.
    folder : Path
        Created where it does not exist. Files of an earlier export are replaced.
    """
    analysis, run = results.analysis, results.run
    folder.mkdir(parents=True, exist_ok=True)
    assembly = analysis.assembly
    mechanisms, forces = _mechanisms(results), _forces(results)
    velocities = {name: _velocities(assembly.blocks, twists) for name, twists in mechanisms.items()}
    write_grid(folder / "blocks.vtu", _blocks_grid(assembly.blocks, velocities))
    write_grid(folder / "forces.vtu", _forces_grid(assembly, forces))
    write_collection(folder / "structure.pvd", [(0.0, ("blocks.vtu", "forces.vtu"))])
    if run is None or not len(run.poses.settlement):
        return [folder / "structure.pvd"]
    return [folder / "structure.pvd", _export_states(assembly, run, folder)]


def _export_states(assembly: Assembly, run: Run, folder: Path) -> Path:
    """Write YADE's stored states as a series and return its path.

    Remaining grids of an earlier, longer series are deleted.
    """
    rows = []
    for number, settlement in enumerate(run.poses.settlement):
        names = (f"yade-blocks-{number:04d}.vtu", f"yade-forces-{number:04d}.vtu")
        moved = _displacements(assembly.blocks, run.poses.displacement[number], run.poses.rotation[number])
        write_grid(folder / names[0], _blocks_grid(assembly.blocks, {"displacement": moved}))
        write_grid(folder / names[1], _forces_grid(assembly, {"force": run.poses.forces[number]}))
        rows.append((float(settlement), names))
    written = {name for _, names in rows for name in names}
    for old in folder.glob("yade-*-[0-9][0-9][0-9][0-9].vtu"):
        if old.name not in written:
            old.unlink()
    write_collection(folder / "yade.pvd", rows)
    return folder / "yade.pvd"


def _mechanisms(results: Results) -> dict[str, np.ndarray]:
    """Return twists (B, 6) by method, for the methods that found a mechanism."""
    analysis, run = results.analysis, results.run
    twists = {"associated": analysis.bounds[analysis.main].twists}
    if analysis.coulomb is not None:
        twists["coulomb"] = analysis.coulomb.twists
    if run is not None:
        twists["yade"] = run.mechanism()
    return {name: values for name, values in twists.items() if np.isfinite(values).all()}


def _forces(results: Results) -> dict[str, np.ndarray]:
    """Return contact forces (C, 3) on block b by method, N.

    YADE's are the mean over its plateau, else its last state.
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
    block = np.repeat(np.arange(len(blocks)), np.diff(blocks.vertex_start))
    return block, blocks.vertices - blocks.centroid[block]


def _velocities(blocks: Blocks, twists: np.ndarray) -> np.ndarray:
    return mechanism.point_velocity(blocks, twists, blocks.vertices, _arms(blocks)[0])


def _displacements(blocks: Blocks, displacement: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Return the displacements (V, 3) of the vertices, m.

    The blocks move by displacements (B, 3), m, and rotation vectors (B, 3), rad, of any size.
    """
    block, arm = _arms(blocks)
    return displacement[block] + Rotation.from_rotvec(rotation[block]).apply(arm) - arm


def _blocks_grid(blocks: Blocks, vectors: dict[str, np.ndarray]) -> Grid:
    owner = blocks.face_block
    cells = {"block": owner, "role": blocks.role[owner], "density": blocks.density[owner]}
    return Grid(blocks.vertices, blocks.face_vertex, blocks.face_start, POLYGON, vectors, cells)


def _forces_grid(assembly: Assembly, forces: dict[str, np.ndarray]) -> Grid:
    points, interfaces = assembly.points, assembly.interfaces
    sides = {"block_a": interfaces.block_a[points.interface], "block_b": interfaces.block_b[points.interface]}
    each = np.arange(len(points) + 1)
    return Grid(points.position, each[:-1], each, VERTEX, {**forces, "normal": interfaces.normal[points.interface], **sides})
