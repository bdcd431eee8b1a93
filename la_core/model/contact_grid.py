"""More contact points than the corners of an interface, to measure their effect on an answer and on its cost."""

from dataclasses import replace

import numpy as np

from la_core.geometry import ContactPoints
from la_core.model.assembly import Assembly

CORNERS = 4  # an interface with this number of corners can carry a grid


def with_grid(assembly: Assembly, per_side: int) -> Assembly:
    """The assembly with `per_side` (at least 2) contact points along each side of its interfaces.

    The points lie evenly between those at the corners: on a line in the plane, on a grid in 3D. In 3D an interface
    with more or fewer than four corners keeps its points.
    """
    points, share = assembly.points, np.linspace(0.0, 1.0, per_side)
    count = np.bincount(points.interface, minlength=len(assembly.interfaces))
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    if assembly.effects.plane:
        start, end = points.position[first], points.position[first + 1]
        position = start[:, None] + share[:, None] * (end - start)[:, None]
        kept, grid = np.zeros(len(points), dtype=bool), np.arange(len(assembly.interfaces))
    else:
        grid = np.flatnonzero(count == CORNERS)
        a, b, c, d = (points.position[first[grid] + corner][:, None, None] for corner in range(CORNERS))
        u, v = share[None, :, None, None], share[None, None, :, None]
        position = ((1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d).reshape(len(grid), -1, 3)
        kept = np.isin(points.interface, grid, invert=True)
    owner = np.concatenate([points.interface[kept], np.repeat(grid, position.shape[1])])
    place = np.concatenate([points.position[kept], position.reshape(-1, 3)])
    order = np.argsort(owner, kind="stable")
    of_first = first[owner[order]]
    return replace(assembly, points=ContactPoints(owner[order], place[order], points.friction[of_first], points.inset[of_first]))
