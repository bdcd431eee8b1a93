"""Write and read `case.h5`: the assembly and its limit analysis, for YADE and for the comparison."""

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from la_core import exchange
from la_core.analysis import reach
from la_core.analysis.modelling import drives
from la_core.analysis.path_settings import settings_after_path, settings_of_long_run
from la_core.analysis.result import Answers, LimitAnalysis, record_from_text, record_to_text, with_one_fall
from la_core.coulomb import CoulombSolution, EquilibriumPath
from la_core.digests import code_digest
from la_core.geometry import Interfaces
from la_core.limit import Solution, Status
from la_core.model import Assembly, Effects, JointStiffness, assemble
from la_core.scene import Scene

PACKAGE = Path(__file__).parents[1]
ROUNDING = 1e-12  # of the largest value: other versions and machines compute the voussoirs of an arch with other rounding errors


def _fields(scene: Scene, predictions: dict[str, bool], has_path: bool, with_error: bool = True) -> tuple[exchange.Field, ...]:
    groups = [f"{problem}/{drive.group}" for problem in ("associated", "associated_sharp") for drive in drives(scene)]
    fields = exchange.CASE_FIELDS + tuple(field for group in groups for field in exchange.solution_fields(group, with_error))
    for group, with_path in predictions.items():
        fields += exchange.coulomb_fields(group, with_path)
    return fields + exchange.PATH_FIELDS if has_path else fields


def _motion(scene: Scene) -> np.ndarray:
    """Return the support's unit motion (6,); NaN where no support moves."""
    return np.full(6, np.nan) if scene.support_twist is None else scene.support_twist


def write_case(
    path: Path, analysis: LimitAnalysis, inputs: str, first_prediction: str = "", made_by: Mapping[str, str] | None = None
) -> None:
    """Write `case.h5`.

    Parameters
    ----------
    path : Path
        File to write.
    analysis : LimitAnalysis
        Complete results of limit analysis.
    inputs : str
        Digest of everything that the results depend on, see `scene_digest`; a cached stage compares it.
    first_prediction : str
        Prediction before an effect was restored, as a text that is kept beside the results; "" for none.
    made_by : mapping of str to str, optional
        Versions of the programs that made the results, and their machine.
    """
    scene, assembly, record = analysis.scene, analysis.assembly, analysis.accuracy
    blocks, interfaces, points = assembly.blocks, assembly.interfaces, assembly.points

    def as_text(found: dict[str, float]) -> str:
        return json.dumps(found | dict(scene.yade) | (record.settings if record else {}), sort_keys=True)

    values: dict[str, Any] = {
        "scene/name": scene.name,
        "scene/title": scene.title,
        "scene/gravity": scene.gravity,
        "scene/plane": assembly.effects.plane,
        "scene/effects": json.dumps(assembly.effects.as_dict, sort_keys=True),
        "scene/displacement": assembly.effects.displacement,
        "scene/least_gap": analysis.least_gap,
        "scene/recording": assembly.effects.recording,
        "scene/inset": assembly.inset,
        "scene/support_twist": _motion(scene),
        "scene/settings": as_text(settings_after_path(analysis)),
        "scene/accuracy": record_to_text(record),
        "blocks/name": list(blocks.names),
        "blocks/aside": assembly.aside,
        **{f"blocks/{name}": getattr(blocks, name) for name in _BLOCK_ARRAYS},
        **{f"interfaces/{name}": getattr(interfaces, name) for name in ("block_a", "block_b", "normal", "area")},
        **{f"contacts/{name}": getattr(points, name) for name in ("interface", "position", "friction")},
        **{field: getattr(analysis.stiffness, name) for name, field in _JOINT_FIELDS.items() if field != exchange.SWAY.path},
    }
    for suffix, answers in (("", analysis.at_inset), ("_sharp", analysis.sharp)):
        for drive, solution in answers.bounds.items():
            values |= _below(f"limit_analysis/associated{suffix}/{drive.group}", solution)
        values |= _below(f"limit_analysis/coulomb{suffix}", answers.coulomb)
    values |= _below("path", analysis.path)
    own: dict[exchange.Field, Any] = {**_own_values(scene, assembly)}
    if math.isfinite(analysis.stiffness.sway):
        own[exchange.SWAY] = analysis.stiffness.sway
    if of_long_run := settings_of_long_run(analysis):
        own[exchange.LONG_RUN_SETTINGS] = as_text(of_long_run)
    if analysis.coulomb is not None and math.isfinite(analysis.coulomb.released):
        own |= {field: values[field.path] for field in exchange.RELEASE_FIELDS}
    if analysis.coulomb is not None and len(analysis.coulomb.peak):
        own |= {field: values[field.path] for field in exchange.PEAK_FIELDS}
    predictions = {f"coulomb{suffix}": True for suffix, one in (("", analysis.at_inset), ("_sharp", analysis.sharp)) if one.coulomb}
    fields = _fields(scene, predictions, analysis.path is not None) + tuple(own)
    values |= {field.path: value for field, value in own.items()}
    if first_prediction:
        fields += (exchange.FIRST_PREDICTION,)
        values[exchange.FIRST_PREDICTION.path] = first_prediction
    exchange.write(path, fields, values, inputs, made_by)


def _own_values(scene: Scene, assembly: Assembly) -> dict[exchange.Field, np.ndarray]:
    """Return the values that only some structures have, by field: parts of compound blocks, insets of short joints, loads."""
    blocks, values = assembly.blocks, dict[exchange.Field, np.ndarray]()
    if blocks.is_compound.any():
        values |= dict(zip(exchange.PART_FIELDS, (blocks.part_block, blocks.part_vertex_start, blocks.part_face_start), strict=True))
    if (assembly.points.inset != assembly.inset).any():
        values[exchange.JOINT_INSET] = assembly.points.inset
    if scene.own_twists is not None:
        values[exchange.SUPPORT_TWISTS] = scene.own_twists
    if scene.live is not None:
        values[exchange.LIVE_DIRECTION] = scene.live
    if assembly.applied_load.any():
        loads = (assembly.applied_load, np.where(blocks.free, assembly.carried, 0.0), _live_load_of_loads(scene, assembly))
        values |= dict(zip(exchange.LOAD_FIELDS, loads, strict=True))
    return values


def _live_load_of_loads(scene: Scene, assembly: Assembly) -> np.ndarray:
    """Return the live load (B, 6) of multiplier 1 that dead loads given as masses add, N and N m; 0 for a settlement and held blocks."""
    blocks = assembly.blocks
    if scene.live is None:
        return np.zeros((len(blocks), 6))
    pushed = scene.loads.wrenches(blocks.centroid, per_mass=float(np.linalg.norm(scene.gravity)) * scene.live)
    return np.where(blocks.free[:, None], pushed, 0.0)


def read_first_prediction(path: Path) -> str:
    """Return the text that `write_case` kept beside the results, "" for none; raises exchange.ExchangeError for anything but a text."""
    field = exchange.FIRST_PREDICTION
    return str(exchange.read(path, (field,))[field.path]) if exchange.holds(path, field.path) else ""


def _below(group: str, solution: Any) -> dict[str, Any]:
    """Return every value of a result by its path in the file; nothing for None."""
    return {} if solution is None else {f"{group}/{name}": getattr(solution, name) for name in solution.__dataclass_fields__}


_BLOCK_ARRAYS = ("role", "mass", "centroid", "inertia", "vertices", "vertex_start", "face_vertex", "face_start", "face_block")
_JOINT_FIELDS = {"normal": "joints/normal_stiffness", "shear": "joints/shear_stiffness"} | {
    name: f"joints/{name}" for name in ("travel", "sag", "sway")
}


def read_case(path: Path, scene: Scene, interfaces: Interfaces | None = None) -> LimitAnalysis:
    """Read the limit analysis of a scene from `case.h5`.

    Parameters
    ----------
    path : Path
        File to read.
    scene : Scene
        Scene of the file. The assembly is built from it again and must equal the one in the file.
    interfaces : Interfaces, optional
        Interfaces of the scene's blocks, if they are known; None searches them.

    Returns
    -------
    LimitAnalysis
        Complete results of limit analysis.

    Raises
    ------
    exchange.ExchangeError
        The file is missing or damaged, or belongs to another scene.
    """
    both, own = ("coulomb", "coulomb_sharp"), (*exchange.OWN_FIELDS, exchange.SWAY, *exchange.RELEASE_FIELDS, *exchange.PEAK_FIELDS)
    present = exchange.present(path, _fields(scene, dict.fromkeys(both, True), has_path=True) + own)
    held = {field.path for field in present}
    groups = {name.rpartition("/")[0] for name in held}
    predictions = {group: f"limit_analysis/{group}/uncertainty" in held for group in both if f"limit_analysis/{group}" in groups}
    with_error = f"limit_analysis/associated/{drives(scene)[0].group}/error" in held
    kept = tuple(field for field in own if field.path in held)
    data = exchange.read(path, _fields(scene, predictions, "path" in groups, with_error) + kept)
    with exchange.values_of(path):
        choices = json.loads(data["scene/effects"])
        effects = Effects(**{**choices, "called_back": tuple(choices["called_back"])})
    in_space = {} if effects.plane else {"plane": False}  # a run may have restored motion out of the plane
    modelled = replace(scene, effects=scene.effects.model_copy(update=in_space))
    whole = replace(assemble(modelled, interfaces), effects=effects)
    with exchange.values_of(path):
        return _analysis(path, scene, whole, data, predictions)


def _analysis(path: Path, scene: Scene, whole: Assembly, data: dict[str, Any], predictions: dict[str, bool]) -> LimitAnalysis:
    """Return the stored analysis; the file must belong to the given assembly of the whole structure, with the stored effects."""
    if data["blocks/name"] != list(whole.blocks.names):
        raise exchange.ExchangeError(f"{path}: blocks/name differs from that of {scene.path}; run the scene again")
    whole = whole.with_inset(scene, float(data["scene/inset"]))

    def answers(assembly: Assembly, suffix: str) -> Answers:
        if data["blocks/aside"].any():
            assembly = reach.set_aside(assembly, data["blocks/aside"].astype(bool))
        bounds = {drive: _solution(data, f"limit_analysis/associated{suffix}/{drive.group}") for drive in drives(scene)}
        return Answers(assembly, with_one_fall(bounds), _coulomb(data, f"coulomb{suffix}") if f"coulomb{suffix}" in predictions else None)

    at_inset = answers(whole, "")
    _refuse_another(path, scene, at_inset.assembly, data)
    return LimitAnalysis(
        scene,
        whole,
        at_inset,
        sharp=answers(whole.with_inset(scene, 0.0), "_sharp") if whole.inset else at_inset,
        stiffness=JointStiffness(**{name: float(data[field]) for name, field in _JOINT_FIELDS.items() if field in data}),
        least_gap=float(data["scene/least_gap"]),
        path=EquilibriumPath(**_values(data, "path", EquilibriumPath)) if "path/value" in data else None,
        accuracy=record_from_text(data["scene/accuracy"]),
    )


def _refuse_another(path: Path, scene: Scene, assembly: Assembly, data: dict[str, Any]) -> None:
    """Raise exchange.ExchangeError where the file belongs to another assembly."""
    expected = {
        "contacts/position": assembly.points.position,
        "contacts/friction": assembly.points.friction,
        "blocks/role": assembly.blocks.role,
        "blocks/mass": assembly.blocks.mass,
        "blocks/centroid": assembly.blocks.centroid,
        "scene/gravity": scene.gravity,
        "scene/support_twist": _motion(scene),
    } | {field.path: None for field in exchange.OWN_FIELDS}
    expected |= {field.path: value for field, value in _own_values(scene, assembly).items()}
    if exchange.LIVE_DIRECTION.path not in data:  # version 0.2.0 did not store it
        del expected[exchange.LIVE_DIRECTION.path]
    for name, value in expected.items():
        if not _alike(value, data.get(name)):
            raise exchange.ExchangeError(f"{path}: {name} differs from that of {scene.path}; run the scene again")


def _alike(value: Any, found: Any) -> bool:
    """Return whether two arrays are equal but for rounding, or both are None."""
    if value is None or found is None:
        return value is found
    value, found = np.asarray(value, dtype=float), np.asarray(found, dtype=float)
    largest = np.abs(value[np.isfinite(value)]).max(initial=0.0)
    return value.shape == found.shape and np.allclose(value, found, rtol=0.0, atol=ROUNDING * largest, equal_nan=True)


def _values(data: dict[str, Any], group: str, kind: Any) -> dict[str, Any]:
    """Return the values of one result by name, scalars as plain numbers."""
    values = {name: data[f"{group}/{name}"] for name in kind.__dataclass_fields__ if f"{group}/{name}" in data}
    return {name: value.item() if isinstance(value, np.generic) else value for name, value in values.items()}


def _solution(data: dict[str, Any], group: str) -> Solution:
    values = _values(data, group, Solution)
    return Solution(**{**values, "status": Status(values["status"]), "falling": tuple(values["falling"])})


def _coulomb(data: dict[str, Any], group: str) -> CoulombSolution:
    values = _values(data, f"limit_analysis/{group}", CoulombSolution)
    return CoulombSolution(**{**values, "status": Status(values["status"]), "interval": tuple(values["interval"].tolist())})


def scene_digest(scene: Scene) -> str:
    """Return the digest of all inputs of `case.h5`: the scene's name, text and meshes, this package, and the solver."""
    meshes = [f"{mesh.path} {hashlib.sha256(mesh.content).hexdigest()}" for mesh in scene.meshes]
    text = "\n".join([scene.name, code_digest(PACKAGE), version("clarabel"), *meshes, scene.text])
    return hashlib.sha256(text.encode()).hexdigest()
