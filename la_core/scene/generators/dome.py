"""Domes: voussoirs between meridian planes and planes through the centre.

A corner lies at r u(theta, phi), with r on the intrados or the extrados, theta about the vertical from the x axis,
and phi from the crown. A voussoir has six faces. Two lie on meridian planes. Two, its beds, lie on planes through the
centre and the chords of a parallel. Two are isosceles trapezoids with four corners of equal r. All faces are exactly
plane, and the voussoir is convex, because it is a frustum of a pyramid about the centre. Meridian joints are
continuous from crown to springing: the bed planes turn with every lune, so a voussoir shifted by half a lune would
share no plane with the voussoirs below it.
"""

from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from la_core.geometry import Shape, loft
from la_core.scene.generators.wall import NamedShape
from la_core.scene.schema.curved import Dome


def dome_blocks(dome: Dome) -> Iterator[NamedShape]:
    """Keystone of a closed crown, voussoirs course by course from the crown, springers, then abutments of the sides."""
    beds = _beds(dome)
    for course, (above, below) in enumerate(pairwise(beds), 1):
        if course == 1 and dome.oculus == 0.0:
            yield NamedShape(f"{dome.name} keystone", "free", dome.density, _keystone(dome, above, below))
            continue
        for lune in range(dome.lunes_built):
            shape = loft(_bed(above, lune), _bed(below, lune))
            yield NamedShape(f"{dome.name} {course}.{lune + 1}", "free", dome.density, shape)
    for lune in range(dome.lunes_built):
        moves = dome.support is not None and dome.support[0] <= lune + 1 <= dome.support[1]
        shape = _behind(_bed(beds[-1], lune), dome.thickness)
        yield NamedShape(f"{dome.name} springer {lune + 1}", "support" if moves else "fixed", dome.density, shape)
    if dome.sides == "fixed":
        yield from _abutments(dome, beds)


def _beds(dome: Dome) -> np.ndarray:
    """Corners (courses + 1, lunes + 1, 2, 3) of the bed joints, m: bed from the crown, meridian, intrados or extrados.

    A keystone has flat faces. Where it closes the crown, the corners of the first bed are the centres of these faces.
    """
    radii = dome.radius + dome.thickness * np.array([-0.5, 0.5])
    phi = np.radians(np.linspace(dome.oculus, dome.embrace, dome.courses + 1))[:, None]
    theta = 2.0 * np.pi * np.arange(dome.lunes_built + 1) / dome.lunes
    directions = np.stack(np.broadcast_arrays(np.sin(phi) * np.cos(theta), np.sin(phi) * np.sin(theta), np.cos(phi)), axis=-1)
    if dome.oculus == 0.0:
        directions[0] = [0.0, 0.0, np.cos(phi[1, 0])]
    return np.array(dome.centre) + radii[:, None] * directions[:, :, None, :]


def _bed(bed: np.ndarray, lune: int) -> np.ndarray:
    """Corners (4, 3) of one bed joint, counter-clockwise seen from the crown."""
    return np.array([bed[lune, 0], bed[lune, 1], bed[lune + 1, 1], bed[lune + 1, 0]])


def _keystone(dome: Dome, axis: np.ndarray, bed: np.ndarray) -> Shape:
    """The polygonal keystone of a whole dome, or its part in a sector."""
    corners = bed[: dome.lunes] if dome.sector == 360.0 else bed
    if dome.sector < 180.0:
        corners = np.concatenate([corners, axis[:1]])
    return loft(corners[:, 1], corners[:, 0])


def _behind(face: np.ndarray, depth: float) -> Shape:
    """Block of the given depth (m) behind a face (n, 3), m, that is counter-clockwise seen from the joint."""
    normal = np.cross(face[1] - face[0], face[2] - face[0])
    return loft(face, face - depth * normal / np.linalg.norm(normal))


def _abutments(dome: Dome, beds: np.ndarray) -> Iterator[NamedShape]:
    """Fixed blocks behind the end meridians of a sector, one for each course."""
    for course, (above, below) in enumerate(pairwise(beds), 1):
        for side, meridian, turn in (("start", 0, 1), ("end", -1, -1)):
            face = np.array([above[meridian, 0], above[meridian, 1], below[meridian, 1], below[meridian, 0]])[::turn]
            yield NamedShape(f"{dome.name} abutment {side} {course}", "fixed", dome.density, _behind(face, dome.thickness))
