"""The limit-analysis stage: from a scene to its solutions, and `case.h5` that carries them to YADE and to the comparison."""

import hashlib
import json
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from la_core import exchange
from la_core.assembly import Assembly, assemble
from la_core.errors import SceneError
from la_core.limit import Drive, Solution, Status, solve
from la_core.scene import Scene
from la_core.stiffness import JointStiffness, joint_stiffness

SMALLEST_INSET = 0.001  # m; and at most SMALLEST_INSET_SHARE of the narrowest interface
SMALLEST_INSET_SHARE = 0.02
GROUPS = {Drive.YIELDING: "least", Drive.PUSHING: "greatest", Drive.LIVE: "collapse"}


@dataclass(frozen=True)
class LimitAnalysis:
    """Solutions of a scene at the inset the methods share and for sharp arrises.

    assembly: contact points at the shared inset: the scene's, or the smallest that YADE can take where the scene has none.
    rounded, sharp: solution by drive at that inset and at inset 0. stiffness: of the joints, at the shared inset.
    """

    assembly: Assembly
    rounded: dict[Drive, Solution]
    sharp: dict[Drive, Solution]
    stiffness: JointStiffness

    @property
    def main(self) -> Drive:
        """The drive whose answer the scene asks for."""
        return Drive.LIVE if Drive.LIVE in self.rounded else Drive.YIELDING


def drives(scene: Scene) -> tuple[Drive, ...]:
    """What a scene is solved for: both bounds of the reaction, or the multiplier of its live load."""
    return (Drive.LIVE,) if scene.live is not None else (Drive.YIELDING, Drive.PUSHING)


def smallest_inset(assembly: Assembly) -> float:
    """Inset (m) in the place of sharp arrises: the smallest that YADE's contact spheres can take."""
    interfaces = assembly.interfaces
    owner = np.repeat(np.arange(len(interfaces)), np.diff(interfaces.polygon_start))
    following = np.arange(1, len(owner) + 1)
    following[interfaces.polygon_start[1:] - 1] = interfaces.polygon_start[:-1]
    edges = np.linalg.norm(interfaces.polygon[following] - interfaces.polygon, axis=1)
    width = 2.0 * interfaces.area / np.bincount(owner, weights=edges)
    return float(min(SMALLEST_INSET, SMALLEST_INSET_SHARE * width.min()))


def analyse(scene: Scene) -> LimitAnalysis:
    """Assemble and solve a scene, at the inset that both methods share and for sharp arrises."""
    assembly = assemble(scene)
    sharp_assembly = assembly if scene.inset == 0.0 else assembly.with_inset(scene, 0.0)
    if scene.inset == 0.0 and scene.live is None:
        assembly = assembly.with_inset(scene, smallest_inset(assembly))
    stiffness = _stiffness(scene, assembly)
    rounded = dict(_solve_all(scene, assembly))
    sharp = rounded if assembly is sharp_assembly else dict(_solve_all(scene, sharp_assembly))
    return LimitAnalysis(assembly, rounded, sharp, stiffness)


def _stiffness(scene: Scene, assembly: Assembly) -> JointStiffness:
    try:
        return joint_stiffness(assembly, assembly.inset, scene.yade)
    except SceneError as error:
        raise SceneError(str(scene.path), str(error)) from error


def _solve_all(scene: Scene, assembly: Assembly) -> Iterator[tuple[Drive, Solution]]:
    """Every drive of a scene; a structure that cannot stand cannot in any of them, so the first says it all."""
    for drive in drives(scene):
        solution = solve(assembly, drive)
        yield drive, solution
        if solution.status is Status.INFEASIBLE:
            for other in drives(scene):
                if other is not drive:
                    yield other, solution
            return


def code_digest(folder: Path) -> str:
    """Digest of the Python code directly in a package's folder."""
    total = hashlib.sha256()
    for source in sorted(folder.glob("*.py")):
        total.update(source.read_bytes())
    return total.hexdigest()


def digest(scene: Scene) -> str:
    """Digest of all that decides the limit analysis: the scene's name and text and this package's code."""
    text = "\n".join([scene.name, code_digest(Path(__file__).parent), version("clarabel"), scene.text])
    return hashlib.sha256(text.encode()).hexdigest()


def _fields(scene: Scene) -> tuple[exchange.Field, ...]:
    groups = [f"{arrises}/{GROUPS[drive]}" for arrises in ("associated", "associated_sharp") for drive in drives(scene)]
    return exchange.CASE_FIELDS + tuple(field for group in groups for field in exchange.solution_fields(group))


def _motion(scene: Scene) -> np.ndarray:
    """The support's unit motion (6,), NaN where no support moves."""
    return np.full(6, np.nan) if scene.support_twist is None else scene.support_twist


def write_case(path: Path, scene: Scene, analysis: LimitAnalysis, inputs: str) -> None:
    """Write `case.h5`; `inputs` is the digest of what made it."""
    assembly = analysis.assembly
    blocks, interfaces, points = assembly.blocks, assembly.interfaces, assembly.points
    values: dict[str, Any] = {
        "scene/name": scene.name,
        "scene/title": scene.title,
        "scene/gravity": scene.gravity,
        "scene/plane": assembly.effects.plane,
        "scene/inset": assembly.inset,
        "scene/support_twist": _motion(scene),
        "scene/settings": json.dumps(scene.yade, sort_keys=True),
        "blocks/name": list(blocks.names),
        **{f"blocks/{name}": getattr(blocks, name) for name in _BLOCK_ARRAYS},
        **{f"interfaces/{name}": getattr(interfaces, name) for name in ("block_a", "block_b", "normal", "area")},
        **{f"contacts/{name}": getattr(points, name) for name in ("interface", "position", "friction")},
        **{field: getattr(analysis.stiffness, name) for name, field in _JOINT_FIELDS.items()},
    }
    for arrises, solutions in (("associated", analysis.rounded), ("associated_sharp", analysis.sharp)):
        for drive, solution in solutions.items():
            for name in _SOLUTION_VALUES:
                values[f"limit_analysis/{arrises}/{GROUPS[drive]}/{name}"] = getattr(solution, name)
    exchange.write(path, _fields(scene), values, inputs)


_BLOCK_ARRAYS = ("role", "mass", "centroid", "inertia", "vertices", "vertex_start", "face_vertex", "face_start", "face_block")
_JOINT_FIELDS = {"normal": "joints/normal_stiffness", "shear": "joints/shear_stiffness", "travel": "joints/travel", "sag": "joints/sag"}
_SOLUTION_VALUES = tuple(Solution.__dataclass_fields__)


def read_case(path: Path, scene: Scene) -> LimitAnalysis:
    """Read the solutions of `case.h5` back; the assembly is built again from the scene, and must be the one in the file.

    Raises exchange.ExchangeError when the file is not whole or belongs to another scene.
    """
    data = exchange.read(path, _fields(scene))
    assembly = assemble(scene).with_inset(scene, float(data["scene/inset"]))
    own = {
        "contacts/position": assembly.points.position,
        "contacts/friction": assembly.points.friction,
        "blocks/role": assembly.blocks.role,
        "blocks/mass": assembly.blocks.mass,
        "blocks/centroid": assembly.blocks.centroid,
        "scene/gravity": scene.gravity,
        "scene/support_twist": _motion(scene),
    }
    for name, value in own.items():
        if not np.array_equal(value, data[name], equal_nan=True):
            raise exchange.ExchangeError(f"{path}: {name} is not that of {scene.path}; run it again")

    def solutions(arrises: str) -> dict[Drive, Solution]:
        return {drive: _solution(data, f"limit_analysis/{arrises}/{GROUPS[drive]}") for drive in drives(scene)}

    stiffness = JointStiffness(**{name: float(data[field]) for name, field in _JOINT_FIELDS.items()})
    return LimitAnalysis(assembly, solutions("associated"), solutions("associated_sharp"), stiffness)


def _solution(data: dict[str, Any], group: str) -> Solution:
    values = {name: data[f"{group}/{name}"] for name in _SOLUTION_VALUES}
    numbers = {name: value.item() for name, value in values.items() if isinstance(value, np.generic)}
    return Solution(**{**values, **numbers, "status": Status(values["status"]), "falling": tuple(values["falling"])})
