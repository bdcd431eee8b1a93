"""Structures that break programs, for limit analysis, YADE and the judge, each with its known answer.

No function here calls a solver. Most structures are a block on two pads, whose least reaction follows from its levers: one sixth of its
weight. Others are two columns side by side. The right column settles and carries its own weight: half of the total.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import scenes
from scipy.spatial import Voronoi

SIXTH, HALF = 1.0 / 6.0, 0.5
LEAST_THICKNESS = 0.107426  # over the radius, of a semicircular arch of very many voussoirs (Cocchetti & Rizzi)
FALLS, REFUSED = "falls", "refused"


@dataclass(frozen=True)
class HardCase:
    """One scene. known: least reaction over the weight without dilatancy, FALLS, REFUSED, or None where no value is known.

    yade: True if YADE runs the scene, too.
    """

    name: str
    what_is_hard: str
    text: str
    known: float | str | None
    yade: bool = True

    @property
    def long(self) -> bool:
        """True if only the long tests run the case in YADE."""
        return self.name not in QUICK


def pads(
    *parts: str,
    size: float = 1.0,
    height: float = 0.5,
    fixed: tuple[float, float] = (0.0, 0.4),
    settling: tuple[float, float] = (0.5, 1.0),
    top: float = 0.0,
    inset: float = 1e-3,
    **options: object,
) -> str:
    """A block of length 1 on two pads. fixed, settling: ends of the pads in x; top: of the settling pad. `size` multiplies all lengths."""

    def scaled(*corner: float) -> tuple[float, ...]:
        return tuple(size * coordinate for coordinate in corner)

    return scenes.text(
        scenes.box("fixed pad", scaled(fixed[0], 0.0, -0.1), scaled(fixed[1], 0.2, 0.0), "fixed"),
        scenes.box("settling pad", scaled(settling[0], 0.0, -0.1), scaled(settling[1], 0.2, top), "support"),
        scenes.box("block", (0.0, 0.0, 0.0), scaled(1.0, 0.2, height)),
        *parts,
        inset=inset * size,
        **{"model": "auto"} | options,  # type: ignore[arg-type]
    )


def columns(friction: float, *parts: str) -> str:
    """Two columns side by side, the right one on the support."""
    return scenes.text(
        *parts,
        scenes.box("left", (0.0, 0.0, 0.0), (0.5, 0.2, 1.0)),
        scenes.box("right", (0.5, 0.0, 0.0), (1.0, 0.2, 1.0)),
        scenes.box("ground", (0.0, 0.0, -0.1), (0.5, 0.2, 0.0), "fixed"),
        scenes.box("pad", (0.5, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
        friction=friction,
        inset=1e-3,
        model="auto",
    )


def two_layers(below: float, above: float) -> str:
    """Two slabs on the pads. below, above: their densities, kg/m3."""
    return scenes.text(
        scenes.box("lower slab", (0.0, 0.0, 0.0), (1.0, 0.2, 0.2), density=below),
        scenes.box("upper slab", (0.0, 0.0, 0.2), (1.0, 0.2, 0.4), density=above),
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.box("settling pad", (0.5, 0.0, -0.1), (1.0, 0.2, 0.0), "support"),
        inset=1e-3,
        model="auto",
    )


def tower(blocks: int) -> str:
    """A tower of blocks on the support."""
    boxes = [scenes.box(f"block {k}", (0.0, 0.0, 0.2 * k), (0.4, 0.3, 0.2 * (k + 1))) for k in range(blocks)]
    return scenes.text(*boxes, scenes.box("pad", (0.0, 0.0, -0.2), (0.4, 0.3, 0.0), "support"), inset=1e-3, model="auto")


def many_pads(pads_below: int) -> str:
    """A slab on `pads_below` pads. The last pad but one settles, and the other pads take its load."""
    width = 10.0 / pads_below
    role = {pads_below - 2: "support"}
    below = [scenes.box(f"pad {k}", (k * width, 0.0, -0.1), ((k + 0.5) * width, 0.2, 0.0), role.get(k, "fixed")) for k in range(pads_below)]
    return scenes.text(*below, scenes.box("slab", (0.0, 0.0, 0.0), (10.0, 0.2, 0.5)), plane=False, inset=1e-3, model="auto")


def rubble(seed: int, stones: int = 14) -> str:
    """Convex stones of random shapes that fill a wall of 2 x 1 m: Voronoi cells of random points, mirrored at the wall's sides."""
    points = np.random.default_rng(seed).random((stones, 2)) * [2.0, 1.0]
    mirrored = [points * [1, -1], points * [-1, 1], points * [-1, 1] + [4, 0], points * [1, -1] + [0, 2]]
    cells = Voronoi(np.vstack([points, *mirrored]))
    polygons = [cells.vertices[cells.regions[cells.point_region[k]]] for k in range(stones)]
    blocks = [scenes.block(f"stone {k}", prism=(np.round(polygon, 9), (0.0, 0.3))) for k, polygon in enumerate(polygons)]
    ground = scenes.box("ground", (0.0, 0.0, -0.1), (1.3, 0.3, 0.0), "fixed")
    pad = scenes.box("pad", (1.3, 0.0, -0.1), (2.0, 0.3, 0.0), "support")
    return scenes.text(*blocks, ground, pad, inset=1e-4, model="auto")  # some joints are millimetres wide


def tilted_pad(slope: float) -> str:
    """A block on two pads. The top of the settling pad slopes down from its outer edge."""
    profile = ((0.5, -0.1), (1.0, -0.1), (1.0, 0.0), (0.5, -0.5 * slope))
    return scenes.text(
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.block("settling pad", "support", prism=(profile, (0.0, 0.2))),
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)),
        inset=1e-3,
        model="auto",
    )


def knife(edge: float) -> str:
    """A block on a pad and, towards its far end, on a wedge. edge: width of the wedge's upper edge, m."""
    profile = ((0.8 - edge, 0.0), (0.7, -0.1), (0.9, -0.1), (0.8, 0.0)) if edge else ((0.8, 0.0), (0.7, -0.1), (0.9, -0.1))
    return scenes.text(
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.block("knife", "support", prism=(profile, (0.0, 0.2))),
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)),
        inset=0.0,
        model="auto",
    )


def cube_on_top(size: float, density: float = 2000.0) -> tuple[str, float]:
    """Return pads whose block carries a cube at its far end, and the least reaction over the weight."""
    inset = min(1e-3, 0.02 * size)
    text = pads(scenes.box("cube", (1.0 - size, 0.0, 0.5), (1.0, size, 0.5 + size), density=density), plane=False, inset=inset)
    cube, block = size**3 * density, 0.1 * 2000.0
    lever = (block * 0.5 + cube * (1.0 - 0.5 * size)) / (cube + block)
    return text, (lever - 0.4) / 0.6


QUICK = (  # a case of each kind whose run in YADE takes a second or two
    "pads in mm, 0.001 kg/m3", "pads in km, 1e+06 kg/m3", "pads, friction 0", "pads, friction 1000", "columns, friction 0",
    "columns, friction 0.9", "columns, friction 1000", "blunt knife of 2 mm", "gap of 1e-07 m", "overlap of 1e-07 m", "pad tilted by 1e-06",
    "lintel balanced on an edge", "lintel that overhangs", "support under a standing block", "support that slides away", "rubble 0",
    "load that lifts 0.999 of the weight", "rod that pulls down with 1000 weights", "footings of glue, head joints of ice",
)  # fmt: skip


def catalogue() -> Iterator[HardCase]:
    """Yield every case, in the order of the table."""
    yield from _units()
    yield from _friction()
    yield from _mixed_sizes()
    yield from _narrow_contacts()
    yield from _many_of_a_kind()
    yield from _at_the_limit()
    yield from _rubble()
    yield from _loaded()


def _units() -> Iterator[HardCase]:
    for size, unit in ((1e-3, "mm"), (1.0, "m"), (1e3, "km")):
        for density in (1e-3, 2000.0, 1e6):
            yield HardCase(f"pads in {unit}, {density:g} kg/m3", "units and weights", pads(size=size, density=density), SIXTH)


def _friction() -> Iterator[HardCase]:
    for friction in (0.0, 1e-6, 0.9, 5.0, 1e3):
        yield HardCase(f"pads, friction {friction:g}", "friction from none to that of glue", pads(friction=friction), SIXTH)
    for friction in (0.0, 1e-6, 0.9):
        yield HardCase(f"columns, friction {friction:g}", "two bodies that only friction ties", columns(friction), HALF)
    for friction in (5.0, 1e3):  # a block that tilts by the joints' strain jams, and its load depends on this strain
        yield HardCase(f"columns, friction {friction:g}", "a joint that jams", columns(friction), None)


def _mixed_sizes() -> Iterator[HardCase]:
    for size in (0.1, 0.01, 0.001):
        text, known = cube_on_top(size)
        yield HardCase(f"cube of {size:g} m on a block of 1 m", "sizes mixed, masses up to 1 : 1e8", text, known)
    text, known = cube_on_top(0.02, density=2000.0 * 1e6)
    yield HardCase("cube of lead a million times as dense", "a small block that outweighs the large one", text, known)
    for ratio in (1e3, 1e5):
        yield HardCase(f"slab {ratio:g} times as heavy above", "weight ratio through one joint", two_layers(2000.0, 2000.0 * ratio), SIXTH)
        yield HardCase(f"slab {ratio:g} times as heavy below", "weight ratio through one joint", two_layers(2000.0 * ratio, 2000.0), SIXTH)
    for height in (10.0, 100.0):
        yield HardCase(f"block {2 * height:g} times as high", "slender", pads(height=height), SIXTH)
        yield HardCase(f"block {2 * height:g} times as flat", "flat", pads(height=0.5 / height), SIXTH)


def _narrow_contacts() -> Iterator[HardCase]:
    yield HardCase("pad 1 mm wide", "narrow joint", pads(settling=(0.999, 1.0), inset=0.0), SIXTH)
    yield HardCase("pad 1e-6 of the block", "a joint below the tolerance of geometry", pads(settling=(1.0 - 1e-6, 1.0)), REFUSED)
    yield HardCase("knife edge", "line contact", knife(0.0), REFUSED)
    yield HardCase("blunt knife of 2 mm", "almost a line contact", knife(2e-3), 0.1 / 0.4)
    for gap in (1e-8, 1e-7):
        yield HardCase(f"gap of {gap:g} m", "gap within the tolerance", pads(top=-gap), SIXTH)
        yield HardCase(f"overlap of {gap:g} m", "overlap within the tolerance", pads(top=gap), SIXTH)
    yield HardCase("gap of 0.1 mm", "gap beyond the tolerance", pads(top=-1e-4), REFUSED)
    yield HardCase("overlap of 1 mm", "overlap beyond the tolerance", pads(top=1e-3), REFUSED)
    for slope in (1e-8, 1e-6):
        yield HardCase(f"pad tilted by {slope:g}", "nearly coplanar, within the tolerance", tilted_pad(slope), SIXTH)
    yield HardCase("pad tilted by 1e-4", "nearly coplanar, beyond the tolerance", tilted_pad(1e-4), REFUSED)


def _many_of_a_kind() -> Iterator[HardCase]:
    yield HardCase("slab on 250 pads", "1,000 contact points on one block, zero reaction", many_pads(250), 0.0)
    yield HardCase("tower of 100 blocks", "long load path", tower(100), 1.0)
    yield HardCase("tower of 1,000 blocks", "very long load path", tower(1000), 1.0, yade=False)


def _at_the_limit() -> Iterator[HardCase]:
    for share in (0.999, 1.001):
        arch = scenes.text(scenes.arch(301, LEAST_THICKNESS * share), settlement=(1.0, 0.0, 0.0), friction=0.7, model="auto")
        yield HardCase(
            f"arch of {share:g} the least thickness", "at the edge of standing", arch, FALLS if share < 1.0 else None, yade=False
        )
    yield HardCase("lintel balanced on an edge", "zero reaction", pads(fixed=(0.0, 0.5), settling=(0.6, 1.0)), 0.0)
    yield HardCase("lintel that overhangs", "cannot stand", pads(fixed=(0.0, 0.3), settling=(0.35, 0.45)), FALLS)
    symmetric = scenes.box("middle pad", (0.4, 0.0, -0.1), (0.6, 0.2, 0.0), "fixed")
    yield HardCase(
        "support under a standing block", "nothing moves but the support", pads(symmetric, fixed=(0.0, 0.3), settling=(0.7, 1.0)), 0.0
    )
    yield HardCase("support that slides away", "settlement orthogonal to gravity", pads(settlement=(1.0, 0.0, 0.0)), None)
    away = scenes.box("support far away", (3.0, 0.0, -0.1), (4.0, 0.2, 0.0), "support")
    alone = scenes.text(scenes.box("base", (0, 0, -0.1), (1, 0.2, 0), "fixed"), scenes.box("block", (0, 0, 0), (1, 0.2, 0.5)), away)
    yield HardCase("support that touches nothing", "no load path", alone, REFUSED)


def _rubble() -> Iterator[HardCase]:
    for seed in range(8):
        yield HardCase(f"rubble {seed}", "stones of any shape, slivers of joints", rubble(seed), None)


def _loaded() -> Iterator[HardCase]:
    """Dead loads, ties and classes of joints. The weight of the block on the pads is 2000 x 9.81 x 0.1 N."""
    weight, middle = 2000.0 * 9.81 * 0.1, (0.5, 0.1, 0.5)
    for ratio in (1e-3, 1e3, 1e6):
        floor = scenes.table("[load]", name="floor", blocks=["block"], mass=ratio * weight / 9.81, at=middle)
        yield HardCase(
            f"floor {ratio:g} times as heavy as its block", "a load that outweighs the block, or hardly acts", pads(floor), SIXTH
        )
    lift = scenes.table("[load]", name="lift", blocks=["block"], force=(0.0, 0.0, 0.999 * weight), at=middle)
    yield HardCase("load that lifts 0.999 of the weight", "almost nothing is left", pads(lift), 1e-3 * SIXTH)
    flies = scenes.table("[load]", name="lift", blocks=["block"], force=(0.0, 0.0, 1.001 * weight), at=middle)
    yield HardCase("load that lifts more than the weight", "cannot stand", pads(flies), FALLS)
    for ratio in (1.0, 1e3):
        down = {"from": middle, "to": (0.5, 0.1, -1.0)}
        rod = scenes.table("[tie]", blocks=["block"], force=ratio * weight, **down)
        yield HardCase(f"rod that pulls down with {ratio:g} weights", "a force that is no weight", pads(rod), (1.0 + ratio) * SIXTH)
    apart = (scenes.table("[friction]", joints="footing", friction=1e3), scenes.table("[friction]", joints="head", friction=0.0))
    yield HardCase("footings of glue, head joints of ice", "friction of 0 and 1000 in one structure", columns(0.6, *apart), HALF)
