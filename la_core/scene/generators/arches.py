"""Arches and barrel vaults: rings of straight-sided voussoirs in the xz plane, drawn out along y, and turned in plan."""

import math
from collections.abc import Iterator, Sequence
from itertools import pairwise

from la_core.geometry import Shape, prism
from la_core.scene.generators.placing import turned
from la_core.scene.generators.ring_curves import Station, stations
from la_core.scene.generators.wall import NamedShape
from la_core.scene.schema.curved import Arch, Ring, Vault


def arch_blocks(arch: Arch) -> Iterator[NamedShape]:
    """Voussoirs from the left springing to the right one, ring by ring from the inner one; then the springers, if the table has them."""
    joints, y = stations(arch), (0.0, arch.depth)
    for ring in range(arch.rings):
        layer = arch.thickness * ring / arch.rings, arch.thickness * (ring + 1) / arch.rings
        for number, (left, right) in enumerate(pairwise(joints), 1):
            name = f"{arch.name} {number}" if arch.rings == 1 else f"{arch.name} {ring + 1}.{number}"
            yield NamedShape(name, "free", arch.density, _voussoir(arch, left, right, layer, y))
    yield from _springers(arch, arch.name, joints, arch.depth)


def vault_blocks(vault: Vault) -> Iterator[NamedShape]:
    """Voussoirs course by course from the left springing, along y within a course; then the springers, if requested.

    In running bond the second, fourth, ... course begins and ends with half voussoirs.
    """
    joints = stations(vault)
    for course, (left, right) in enumerate(pairwise(joints), 1):
        halves = vault.bond == "running" and course % 2 == 0
        inner = [ring + 0.5 for ring in range(vault.rings)] if halves else range(1, vault.rings)
        ends = [vault.length * place / vault.rings for place in (0, *inner, vault.rings)]
        for number, y in enumerate(pairwise(ends), 1):
            shape = _voussoir(vault, left, right, (0.0, vault.thickness), y)
            yield NamedShape(f"{vault.name} {course}.{number}", "free", vault.density, shape)
    yield from _springers(vault, vault.name, joints, vault.length)


def _voussoir(ring: Ring, left: Station, right: Station, layer: Sequence[float], y: Sequence[float]) -> Shape:
    """Solid between two joints and two depths within the ring (m), from y[0] to y[1] beyond the ring's centre (m)."""
    return _placed(ring, [left.at(layer[0]), right.at(layer[0]), right.at(layer[1]), left.at(layer[1])], y)


def _placed(ring: Ring, profile: Sequence[tuple[float, float]], y: Sequence[float]) -> Shape:
    """Solid of a profile about the ring's centre, m."""
    x0, y0, z0 = ring.centre
    return turned(prism([(x0 + x, z0 + z) for x, z in profile], (y0 + y[0], y0 + y[1])), ring.centre, ring.angle)


def _springers(ring: Ring, name: str, joints: list[Station], depth: float) -> Iterator[NamedShape]:
    """One held block behind each springing joint: as long as `depth` (m) along y and as thick as the ring."""
    if ring.springers is None:
        return
    for side, joint in (("left", joints[0]), ("right", joints[-1])):
        away = math.copysign(ring.thickness, joint.angle)
        face = [joint.at(0.0), joint.at(ring.thickness)]
        beyond = [(x + away * math.cos(joint.angle), z - away * math.sin(joint.angle)) for x, z in face]
        shape = _placed(ring, [face[0], face[1], beyond[1], beyond[0]], (0.0, depth))
        yield NamedShape(f"{name} springer {side}", getattr(ring.springers, side), ring.density, shape)
