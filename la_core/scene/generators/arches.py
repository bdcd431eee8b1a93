"""Arches and barrel vaults: a ring of straight-sided voussoirs in the xz plane, drawn out along y."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from la_core.geometry import Shape, prism
from la_core.scene.generators.wall import NamedShape
from la_core.scene.schema.curved import Arch, Ring, Vault

RadialJoint = tuple[tuple[float, float], tuple[float, float]]  # intrados and extrados (x, z) of a radial joint, m


def arch_blocks(arch: Arch) -> Iterator[NamedShape]:
    """Voussoirs from the left springing to the right one, then the springers, if the table has them."""
    joints, y = _joints(arch), arch.centre[1]
    for number, (left, right) in enumerate(pairwise(joints), 1):
        yield NamedShape(f"{arch.name} {number}", "free", arch.density, _voussoir(left, right, (y, y + arch.depth)))
    yield from _springers(arch, arch.name, joints, arch.depth)


def vault_blocks(vault: Vault) -> Iterator[NamedShape]:
    """Voussoirs course by course from the left springing, along y within a course; then the springers, if requested.

    In running bond the second, fourth, ... course begins and ends with half voussoirs.
    """
    joints = _joints(vault)
    for course, (left, right) in enumerate(pairwise(joints), 1):
        halves = vault.bond == "running" and course % 2 == 0
        inner = [ring + 0.5 for ring in range(vault.rings)] if halves else range(1, vault.rings)
        ends = [vault.centre[1] + vault.length * place / vault.rings for place in (0, *inner, vault.rings)]
        for number, y in enumerate(pairwise(ends), 1):
            yield NamedShape(f"{vault.name} {course}.{number}", "free", vault.density, _voussoir(left, right, y))
    yield from _springers(vault, vault.name, joints, vault.length)


def _joints(ring: Ring) -> list[RadialJoint]:
    """Radial joints from the left springing to the right one."""
    half = math.radians(ring.embrace) / 2.0
    angles = [-half + 2.0 * half * k / ring.voussoirs for k in range(ring.voussoirs + 1)]
    return [_joint(ring, angle) for angle in angles]


def _joint(ring: Ring, angle: float) -> RadialJoint:
    """Intrados and extrados (x, z), m, of the radial joint at `angle` (rad) from the crown, positive to the right."""
    radii = (ring.radius - ring.thickness / 2.0, ring.radius + ring.thickness / 2.0)
    inner, outer = ((ring.centre[0] + r * math.sin(angle), ring.centre[2] + r * math.cos(angle)) for r in radii)
    return inner, outer


def _voussoir(left: RadialJoint, right: RadialJoint, y: Sequence[float]) -> Shape:
    return prism([left[0], right[0], right[1], left[1]], y)


def _springers(ring: Ring, name: str, joints: list[RadialJoint], depth: float) -> Iterator[NamedShape]:
    """One held block behind each springing joint: as long as `depth` (m) along y and as thick as the ring."""
    if ring.springers is None:
        return
    half = math.radians(ring.embrace) / 2.0
    y = (ring.centre[1], ring.centre[1] + depth)
    for side, angle, joint in (("left", -half, joints[0]), ("right", half, joints[-1])):
        away = math.copysign(ring.thickness, angle)
        beyond = [(px + away * math.cos(angle), pz - away * math.sin(angle)) for px, pz in joint]
        shape = prism([joint[0], joint[1], beyond[1], beyond[0]], y)
        yield NamedShape(f"{name} springer {side}", getattr(ring.springers, side), ring.density, shape)
