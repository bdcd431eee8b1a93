"""The case as YADE bodies: one clump per block, one sphere per contact point, and the engines that move them."""

from dataclasses import dataclass

import numpy as np
from yade import (
    Bo1_Box_Aabb,
    Bo1_Sphere_Aabb,
    Body,
    Box,
    ForceResetter,
    Ig2_Box_Sphere_ScGeom,
    InsertionSortCollider,
    InteractionLoop,
    Ip2_ViscElMat_ViscElMat_ViscElPhys,
    KinematicEngine,
    Law2_ScGeom_ViscElPhys_Basic,
    NewtonIntegrator,
    Omega,
    PyRunner,
    Sphere,
    ViscElMat,
)
from yade.utils import createInteraction

from la_core.exchange import FREE
from yade_scripts.case import Case
from yade_scripts.contacts.faces import YadeError, faces_of
from yade_scripts.contacts.rows import rows_of
from yade_scripts.driving import drives_of
from yade_scripts.settings import Settings, contact_damping, inertia_of
from yade_scripts.vibration import Inertia

try:
    from yade.minieigenHP import Matrix3, Quaternion, Vector3
except ImportError:  # before 2022 YADE used a separate package
    from minieigen import Matrix3, Quaternion, Vector3
try:
    from yade import Bo1_Polyhedra_Aabb, Ig2_Sphere_Polyhedra_ScGeom
except ImportError:  # YADE was built without CGAL, as in Debian 13: only boxes can be faces
    Bo1_Polyhedra_Aabb = Ig2_Sphere_Polyhedra_ScGeom = None

# Spheres touch only faces, and bodies of two held blocks never touch. YADE pairs bodies whose masks share a bit, unless the
# masks are equal and share a bit with the collider's avoidSelfInteractionMask. The masks of faces are in `faces`.
_FREE_SPHERE, _HELD_SPHERE = 0b011, 0b100
_NO_PAIRS_OF_EQUALS = 0b111
_NO_FRICTION_LIMIT = 0.5 * np.pi - 1e-9  # friction angle of a face: YADE uses the smaller angle, which is then that of the sphere
_MASSLESS = 1e-12  # kg/m3; YADE recomputes a sphere's mass from its density, and refuses 0
_PLANE_BLOCKED = "yXZ"
_ALL_BLOCKED = "xyzXYZ"
_INERTIA_TOLERANCE = 1e-6
# Margin of a body's bound over the sphere radius. Twice this margin is less than one radius, the gap between a sphere and the neighbour's
# face across a joint. With a wider margin YADE would examine every such pair at every step.
_BOUND_MARGIN = 0.3


@dataclass(frozen=True)
class Model:
    """The case in YADE: identifiers of its bodies, poses as built, and the engines whose settings change between stages.

    Attributes
    ----------
    clump : tuple of int
        Clump (B,) of each block.
    sphere, face : tuple of int
        Sphere (C,) of each contact point, and the face (C,) that it touches.
    position : np.ndarray
        Position (B, 3) of every clump as built, m.
    rotation : tuple of Quaternion
        Orientation (B,) of every clump as built.
    inertia : Inertia
        Inertia of the blocks in this run.
    loaded : tuple of int
        Blocks on which permanent forces act.
    integrator, drive, calm, watch : NewtonIntegrator, list of KinematicEngine or PyRunner, PyRunner, PyRunner
        Engines that move the free blocks, move the supports (or set the live load), damp the swing of the blocks, and record rows. The
        engines of the live load and of the damping are off until they are started.
    """

    clump: tuple[int, ...]
    sphere: tuple[int, ...]
    face: tuple[int, ...]
    position: np.ndarray
    rotation: tuple[Quaternion, ...]
    inertia: Inertia
    loaded: tuple[int, ...]
    integrator: NewtonIntegrator
    drive: list[KinematicEngine] | PyRunner
    calm: PyRunner
    watch: PyRunner


def build(case: Case, settings: Settings, watch: str, pull: str = "pass", calm: str = "pass") -> Model:
    """Build the case in YADE's scene.

    watch, pull, calm: Python statements that YADE repeats to record a row, to set the live load, and to damp the swing.
    Raises YadeError if a clump does not have the mass and inertia of its block.
    """
    omega = Omega()
    omega.reset()
    inertia = inertia_of(case, settings.normal_stiffness, settings.shear_stiffness, settings.added_mass)
    clumps, carriers, spheres, faces = _append_blocks(case, settings, inertia)
    _turn_carriers(case, carriers, clumps)
    _set_inertia(case, inertia, clumps)
    for block, clump in enumerate(clumps):
        omega.bodies[clump].state.blockedDOFs = _blocked(case, block)
    if case.displacement == "small":
        _pair(spheres, faces)
    integrator, drive, calming, watching = _engines(case, settings, clumps, (watch, pull, calm))
    position = np.array([omega.bodies[clump].state.pos for clump in clumps])
    rotation = tuple(Quaternion(omega.bodies[clump].state.ori) for clump in clumps)
    loaded = np.flatnonzero(case.applied_load.any(axis=1) | case.live_load.any(axis=1) | (inertia.mass != case.mass)).tolist()
    model = Model(
        tuple(clumps), tuple(spheres), tuple(faces), position, rotation, inertia, tuple(loaded), integrator, drive, calming, watching
    )
    set_loads(case, model)
    return model


def _append_blocks(case: Case, settings: Settings, inertia: Inertia) -> tuple[list[int], list[int], list[int], list[int]]:
    """Append the bodies of every block to YADE's scene, joined to a clump.

    Returns the identifiers of the clump (B,) and of the carrier (B,) of each block, of the sphere (C,) of each contact point, and of the
    face (C,) that it touches.
    """
    bodies = Omega().bodies
    spheres, faces = np.zeros(len(case.host), dtype=int), np.zeros(len(case.host), dtype=int)
    carriers, clumps = [], []
    viscosity = contact_damping(case, inertia, settings.normal_damping, settings.shear_damping)
    of_face = 2.0 * viscosity.max(axis=0)
    material = _material(settings, of_face, _NO_FRICTION_LIMIT)
    of_sphere = of_face * viscosity / np.maximum(of_face - viscosity, np.finfo(float).tiny)  # in series they give the contact's viscosity
    kinds, kind = np.unique(np.column_stack([np.arctan(case.friction), of_sphere]), axis=0, return_inverse=True)
    rubbing = [_material(settings, values[1:], float(values[0])) for values in kinds]
    touching, carried = (rows_of(owner, len(case.role)) for owner in (case.target, case.host))
    for block in range(len(case.role)):  # all bodies of a block side by side: the integrator visits them together
        members = [bodies.append(_carrier(case, block, material))]
        carriers.append(members[0])
        for face, touched in faces_of(case, block, touching[block]):
            face.material = material
            members.append(bodies.append(face))
            faces[touched] = members[-1]
        for contact in carried[block].tolist():
            radius = settings.sphere_radius * case.own_inset[contact] / case.inset
            sphere = _sphere(case, contact, radius, rubbing[kind.ravel()[contact]])
            members.append(bodies.append(sphere))
            spheres[contact] = members[-1]
        clumps.append(bodies.clump(members))
    return clumps, carriers, spheres.tolist(), faces.tolist()


def _material(settings: Settings, viscosity: np.ndarray, friction_angle: float) -> ViscElMat:
    """Return a new material. Sphere and face act in series, so each gets twice the contact's stiffness. viscosity: (2,), N s/m."""
    stiffness = {"kn": 2.0 * settings.normal_stiffness, "ks": 2.0 * settings.shear_stiffness}
    dashpots = {"cn": float(viscosity[0]), "cs": float(viscosity[1])}
    material = ViscElMat(**stiffness, **dashpots, frictionAngle=friction_angle, density=_MASSLESS)
    Omega().materials.append(material)
    return material


def _sphere(case: Case, contact: int, radius: float, material: ViscElMat) -> Body:
    """Return the sphere of a contact point, inside its host and tangent to the interface at that point."""
    host = case.host[contact]
    into_host = case.normal[contact] if host == case.block_b[contact] else -case.normal[contact]
    body = Body()
    body.shape = Sphere(radius=radius)
    body.material = material
    body.mask = _FREE_SPHERE if case.role[host] == FREE else _HELD_SPHERE
    body.state.mass = _MASSLESS * 4.0 / 3.0 * np.pi * radius**3
    body.state.inertia = Vector3.Ones * (0.4 * body.state.mass * radius**2)
    body.state.pos = case.position[contact] + radius * into_host
    return body


def _carrier(case: Case, block: int, material: ViscElMat) -> Body:
    """Return a tiny body at the centroid that carries the block's mass and inertia and touches nothing."""
    body = Body()
    body.shape = Box(extents=1e-3 * np.ptp(case.vertices[block], axis=0))
    body.material = material
    body.mask = 0
    body.bounded = False
    principal, axes = np.linalg.eigh(case.inertia[block])
    right_handed = axes * np.array([1.0, 1.0, np.sign(np.linalg.det(axes))])
    body.state.pos, body.state.ori = case.centroid[block], Quaternion(Matrix3(*right_handed.ravel()))
    body.state.ori.normalize()
    body.state.mass, body.state.inertia = case.mass[block], principal
    return body


def _turn_carriers(case: Case, carriers: list[int], clumps: list[int]) -> None:
    """Give every clump the mass and inertia of its block; raises YadeError if this fails.

    YADE 2023.02a rotates a clump member's inertia by the inverse of its orientation. If a clump's inertia is wrong for this reason, its
    carrier is rotated the other way, and YADE computes the clump again. A YADE without this error needs no rotation.
    """
    bodies = Omega().bodies
    turned = [carrier for carrier, block in zip(carriers, _wrong_inertias(case, clumps), strict=True) if block]
    if turned:
        for carrier in turned:
            bodies[carrier].state.ori = bodies[carrier].state.ori.conjugate()
        bodies.updateClumpProperties(discretization=0)
        if any(_wrong_inertias(case, clumps)):
            raise YadeError("the inertia of YADE's clumps is not that of their blocks; this version of YADE cannot be used")


def _set_inertia(case: Case, inertia: Inertia, clumps: list[int]) -> None:
    """Give every clump the inert mass and inertia of the run; `set_loads` corrects the weight."""
    factor = np.einsum("bii->b", inertia.tensor) / np.einsum("bii->b", case.inertia)  # the same about every axis
    for block, clump in enumerate(clumps):
        state = Omega().bodies[clump].state
        state.mass = inertia.mass[block]
        # For a body with blocked freedoms YADE divides global torques by the sorted principal inertias. Equal ones need no order.
        state.inertia = Vector3.Ones * inertia.tensor[block, 1, 1] if case.plane else state.inertia * float(factor[block])


def _wrong_inertias(case: Case, clumps: list[int]) -> list[bool]:
    """Return for each block whether the inertia of its clump is wrong; raises YadeError if the mass of a clump is wrong."""
    wrong = []
    for block, clump in enumerate(clumps):
        state = Omega().bodies[clump].state
        axes = np.array(state.ori.toRotationMatrix()).reshape(3, 3)
        inertia = axes @ np.diag(list(state.inertia)) @ axes.T
        size = np.abs(case.inertia[block]).max()
        wrong.append(bool(np.abs(inertia - case.inertia[block]).max() > _INERTIA_TOLERANCE * size))
        if abs(state.mass - case.mass[block]) > _INERTIA_TOLERANCE * case.mass[block]:
            raise YadeError(f"block {block}: YADE's clump weighs {state.mass} kg, the block {case.mass[block]} kg")
    return wrong


def _blocked(case: Case, block: int) -> str:
    if case.role[block] != FREE:
        return _ALL_BLOCKED
    return _PLANE_BLOCKED if case.plane else ""


def set_loads(case: Case, model: Model, share: float = 1.0, multiplier: float = 0.0) -> None:
    """Apply, from the next step on, `share` of weights, dead loads and ties, and `multiplier` times the live load.

    YADE's gravity acts on the inert mass of a block, which may be larger than its mass. A permanent force balances the excess. Dead loads
    and ties keep direction and moment while the blocks move, as in limit analysis.
    """
    gravity = share * case.gravity
    if case.live is not None:
        gravity = gravity + multiplier * np.linalg.norm(case.gravity) * case.live
    model.integrator.gravity = gravity
    load = share * case.applied_load + multiplier * case.live_load
    load[:, :3] += (case.mass - model.inertia.mass)[:, None] * gravity
    forces = Omega().forces
    for block in model.loaded:
        forces.setPermF(model.clump[block], Vector3(*load[block, :3].tolist()))
        forces.setPermT(model.clump[block], Vector3(*load[block, 3:].tolist()))


def _pair(spheres: list[int], faces: list[int]) -> None:
    """Pair every sphere with the face that it touches: without a collider, an open pair stays in YADE's list and may close again."""
    for sphere, face in zip(spheres, faces, strict=True):
        createInteraction(sphere, face, virtualI=True)


def _collider(settings: Settings, least_share: float) -> InsertionSortCollider:
    """Return the engine that finds spheres near faces; it searches again after a body has moved by the margin of the bounds.

    least_share: radius of the smallest sphere over that of a sphere with the inset of the scene.
    """
    bounds = [Bo1_Sphere_Aabb(), Bo1_Box_Aabb(), *([Bo1_Polyhedra_Aabb()] if Bo1_Polyhedra_Aabb else [])]
    collider = InsertionSortCollider(bounds)
    collider.verletDist = _BOUND_MARGIN * settings.sphere_radius * least_share
    collider.avoidSelfInteractionMask = _NO_PAIRS_OF_EQUALS
    return collider


def _engines(
    case: Case, settings: Settings, clumps: list[int], commands: tuple[str, str, str]
) -> tuple[NewtonIntegrator, list[KinematicEngine] | PyRunner, PyRunner, PyRunner]:
    """Set YADE's engines; the supports stand still until their speed is set. commands: statements that watch, pull and calm."""
    command, pull, calm = commands
    colliders = [_collider(settings, float(case.own_inset.min() / case.inset))] if case.displacement == "finite" else []
    contacts = InteractionLoop(
        [Ig2_Box_Sphere_ScGeom(), *([Ig2_Sphere_Polyhedra_ScGeom()] if Ig2_Sphere_Polyhedra_ScGeom else [])],
        [Ip2_ViscElMat_ViscElMat_ViscElPhys()],
        [Law2_ScGeom_ViscElPhys_Basic()],
    )
    integrator = NewtonIntegrator(gravity=case.gravity, damping=settings.gravity_damping)
    drive = drives_of(case, clumps) if case.live is None else PyRunner(command=pull, iterPeriod=1, initRun=False, dead=True)
    calming = PyRunner(command=calm, iterPeriod=1, initRun=False, dead=True)
    watch = PyRunner(command=command, iterPeriod=1, initRun=False)
    clock = PyRunner(command=command, realPeriod=settings.time_limit, initRun=False)  # keeps the time limit between two distant rows
    omega = Omega()
    driving = drive if isinstance(drive, list) else [drive]
    omega.engines = [ForceResetter(), *colliders, contacts, *driving, calming, integrator, watch, clock]
    omega.dt = settings.time_step
    return integrator, drive, calming, watch
