"""Random dead loads, ties and classes of joints on the random structures of `random_scenes`."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scenes
from hypothesis import reject
from hypothesis import strategies as st
from random_scenes import frictions, random_scenes

from la_core.errors import SceneError
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene

MOST = 1.5  # largest load, or tension of a tie, over the weight of the mean block
SMALLEST = 1e-6  # smallest load, or tension of a tie, over the weight of the mean block


@dataclass(frozen=True)
class Loading:
    """A scene, and tables of loads, ties and classes of joints for it, as keys and values.

    Attributes
    ----------
    scene : Scene
        The scene without the tables.
    forces, masses, ties, classes : tuple of dict
        Tables of [[load]] with a force, [[load]] with a mass, [[tie]] and [[friction]].
    """

    scene: Scene
    forces: tuple[dict[str, Any], ...] = ()
    masses: tuple[dict[str, Any], ...] = ()
    ties: tuple[dict[str, Any], ...] = ()
    classes: tuple[dict[str, Any], ...] = ()

    def loaded(self, scale: float = 1.0, **changed: Any) -> Scene:
        """Return the scene with its tables. scale: factor on weights and loads; changed: other tables, by field."""
        one = replace(self, **changed)
        tables = [scenes.table("[load]", **{**load, "force": [scale * part for part in load["force"]]}) for load in one.forces]
        tables += [scenes.table("[load]", **{**load, "mass": scale * load["mass"]}) for load in one.masses]
        tables += [scenes.table("[tie]", **{**tie, "force": scale * tie["force"]}) for tie in one.ties]
        tables += [scenes.table("[friction]", **rule) for rule in one.classes]
        text = scenes.moved(one.scene, plane=bool(one.scene.effects.plane), density=scale).text
        return scenes.load("\n".join([text, *tables]))


@st.composite
def loadings(draw: st.DrawFn, settles: bool | None = None, ties: int = 2) -> Loading:
    """Draw a random structure with up to three loads of each kind, up to `ties` ties (exactly one for 1), and classes of joints."""
    scene = draw(random_scenes(settles=settles))
    plane, blocks = bool(scene.effects.plane), scene.blocks
    free = np.flatnonzero(blocks.free)
    unit = scene.weight / len(free)
    depth = float(blocks.low[:, 1].min() + blocks.high[:, 1].max()) / 2.0

    def place(block: int) -> tuple[float, float, float]:
        low, high = blocks.low[block], blocks.high[block]
        x, y, z = (float(a + draw(st.floats(0.0, 1.0)) * (b - a)) for a, b in zip(low, high, strict=True))
        return (x, depth if plane else y, z)

    def size() -> float:
        return float(unit * draw(st.floats(SMALLEST, MOST)))

    def block() -> int:
        return int(free[draw(st.integers(0, len(free) - 1))])

    forces = []
    for _ in range(draw(st.integers(0, 3))):
        on, angle, tilt = block(), draw(st.floats(0.0, 6.28)), 0.0 if plane else draw(st.floats(-1.0, 1.0))
        direction = np.array([np.cos(angle) * np.cos(tilt), np.sin(tilt), np.sin(angle) * np.cos(tilt)])
        down = draw(st.booleans())  # most loads press down, and more structures stand
        force = size() * (scene.gravity / np.linalg.norm(scene.gravity) if down else direction)
        forces.append({"blocks": [blocks.names[on]], "at": place(on), "force": force.tolist()})
    masses = []
    for _ in range(draw(st.integers(0, 3))):
        on = block()
        masses.append({"blocks": [blocks.names[on]], "at": place(on), "mass": size() / float(np.linalg.norm(scene.gravity))})
    rods = []
    for _ in range(draw(st.integers(1 if ties == 1 else 0, ties))):
        one, other = block(), block()
        start, end = place(one), place(other)
        named = [blocks.names[one]] if one == other else [blocks.names[one], blocks.names[other]]
        if one == other:
            end = (end[0], end[1], float(blocks.low[:, 2].min()) - 0.3)  # an anchor in the ground
        rods.append({"blocks": named, "from": start, "to": end, "force": size()})
    if any(np.linalg.norm(np.subtract(rod["from"], rod["to"])) < 1e-3 for rod in rods):
        reject()
    kinds = draw(st.lists(st.sampled_from(["bed", "head", "footing"]), max_size=2, unique=True))
    classes = tuple({"joints": kind, "friction": draw(frictions())} for kind in kinds)
    found = Loading(scene, tuple(forces), tuple(masses), tuple(rods), classes)
    try:
        assemble(found.loaded())
    except SceneError:
        reject()
    return found
