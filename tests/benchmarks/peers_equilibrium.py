"""Static equilibrium by compas_cra on the same blocks, contact points and friction as ours.

compas_cra asks whether a structure stands. Its supports do not move and it minimises no reaction, so it finds any equilibrium of the
structure with the settling support at rest. Our forces at the least reaction are such an equilibrium: we solve the harder problem.
    RBE (rigid-block equilibrium): tension allowed at a penalty, friction in octagons about the cones (convex, quadratic);
    CRA: RBE coupled with a virtual displacement of each block (Kao et al. 2022, doi 10.1016/j.cad.2022.103216; not convex).
Weights are passed relative to the mean block, the scale for which its tolerances are meant. Only its solver, IPOPT, is timed: the Python
loops that build its matrices take longer.
"""

import time

import numpy as np

from la_core.measures import residuals
from la_core.model.assembly import Assembly

METHODS = {"compas_cra RBE": "rbe", "compas_cra CRA penalty": "cra_penalty", "compas_cra CRA": "cra"}


def equilibrium(assembly: Assembly, name: str) -> tuple[bool, str, np.ndarray, float, float]:
    """Return compas_cra's flag of success, its status message, contact forces (C, 3) in N, processor seconds and wall seconds."""
    from compas_cra.equilibrium import cra_native, cra_nlp
    from compas_cra.nlp import solve_nlp

    method = METHODS[name]
    options = {"cra": cra_native._CRA_OPTIONS, "cra_penalty": cra_native._CRA_PENALTY_OPTIONS}.get(method)
    structure, order = _structure(assembly)
    problem, layout = getattr(cra_nlp, f"{method}_problem")(structure, mu=float(assembly.points.friction[0]))
    processor, clock = time.process_time(), time.perf_counter()
    answer = solve_nlp(problem, backend="native", options=options)
    processor, clock = time.process_time() - processor, time.perf_counter() - clock
    columns = answer.x[layout["f"]].reshape(len(order), -1)  # normal (and tension where it is allowed), two tangents
    tension = columns[:, 1] if columns.shape[1] == 4 else 0.0
    local = np.zeros((len(order), 3))
    local[order] = np.column_stack([columns[:, 0] - tension, columns[:, -2:]]) * assembly.mean_weight
    return answer.success, answer.status_message, np.einsum("ck,ckj->cj", local, assembly.axes), processor, clock


def residual(assembly: Assembly, forces: np.ndarray) -> float:
    """Return the largest residual of an equilibrium: of the balance of each block and of the friction cones."""
    return max(residuals.equilibrium_residual(assembly, forces), residuals.cone_violation(assembly, forces))


def _structure(assembly: Assembly) -> tuple[object, np.ndarray]:
    """Return compas_cra's assembly, and the index of our contact point (C,) for each contact point of compas_cra."""
    from compas.geometry import Frame
    from compas_assembly.datastructures import Block
    from compas_cra.datastructures import CRA_Assembly

    blocks, structure = assembly.blocks, CRA_Assembly()
    weight = np.linalg.norm(assembly.dead_load[:, :3], axis=1) / assembly.mean_weight
    for k in range(len(blocks)):
        start, stop = blocks.vertex_start[k : k + 2]
        faces = np.flatnonzero(blocks.face_block == k)
        loops = [(blocks.face_vertex[blocks.face_start[f] : blocks.face_start[f + 1]] - start).tolist() for f in faces]
        block = Block.from_vertices_and_faces(blocks.vertices[start:stop].tolist(), loops)
        block.attributes["density"] = float(weight[k] / blocks.volume[k])
        structure.add_block(block, node=k)
        if not blocks.free[k]:
            structure.set_boundary_condition(k)
    points_of: dict[tuple[int, int], np.ndarray] = {}
    for i, (a, b) in enumerate(zip(assembly.interfaces.block_a.tolist(), assembly.interfaces.block_b.tolist(), strict=True)):
        own = np.flatnonzero(assembly.points.interface == i)
        points_of[a, b] = own
        _, first, second = assembly.axes[own[0]].tolist()  # the third axis of its frame is their cross product, our normal
        structure.add_to_interfaces(a, b, 1.0, assembly.points.position[own].tolist(), Frame([0.0, 0.0, 0.0], first, second))
    return structure, np.concatenate([points_of[edge] for edge in structure.graph.edges()])
