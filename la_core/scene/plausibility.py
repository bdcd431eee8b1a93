"""Warnings about values that are allowed but seldom meant: an angle for friction, another unit, a motion upward."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from la_core.exchange import TRAVEL_OVER_INSET
from la_core.geometry import ROLES, Blocks, MissedJoints, edge_contacts, missed_joints
from la_core.repair import Repairs
from la_core.scene.loads.plausibility import FRICTION
from la_core.scene.schema.drawing import MOST_TOLERANCE
from la_core.scene.schema.masonry import SIDES
from la_core.scene.schema.scene_file import SceneFile
from la_core.text_table import number_text, place_text

DENSITY = (500.0, 4000.0)  # kg/m3: pumice and light brick are above the first, basalt and heavy stone below the second
RADIANS = 3.1416  # degrees: pi, rounded up; no arch spans so small an angle, so a smaller value is probably in radians
SIZE = (0.01, 10.0)  # m: least thickness and greatest length of a usual block
WEIGHT = (0.1, 1e9)  # N: the weight of a model of wooden pieces, and a hundred thousand tonnes, more than a tower or a dome
GRAVITY = (5.0, 15.0)  # m/s2: around the gravity of the earth, with room for inclined models
UPWARD = 1e-6  # of the motion: round-off in a direction that is meant to be level
MARGIN = 1.5  # suggested tolerance over half the gap: with 1 it left joints open, or was refused, on 15 of 80 arches with inexact corners
ALL_BUT = 1.0 - 1e-6  # of the distance at which a block only touches a course: round-off
SHARE = 5.0  # of the settlement: a larger share is probably a percentage
ROUND_OFF = 1e-9  # of a length
TURNED = 0.05  # of a block's size: a motion that changes lever arms of half a block by a tenth
LOOSE = 0.25  # of an expected value: with a larger tolerance, wrong answers agree, too
NAMED = 3  # blocks named in one warning


def implausible(
    blocks: Blocks,
    densities: Sequence[float | None],
    file: SceneFile,
    gravity: np.ndarray,
    twists: np.ndarray | None,
    repairs: Repairs | None,
) -> tuple[str, ...]:
    """Return one sentence for each value of a scene that is probably a slip.

    Parameters
    ----------
    blocks : Blocks
        Blocks of the scene.
    densities : sequence of float or None
        Density of each block as the scene gives it, without floors, kg/m3; None where the scene gives none.
    file : SceneFile
        Tables of the scene.
    gravity : ndarray, shape (3,)
        Acceleration of gravity, m/s2.
    twists : ndarray, shape (B, 6), or None
        Unit motion of the supports: velocity of the origin, then angular velocity. None for a live load.
    repairs : Repairs or None
        Changes of the geometry within its tolerance. None where the scene requests no repair.
    """
    missed = missed_joints(blocks)
    return (
        *_of_friction(file.joint.friction),
        *_of_angles(file),
        *_of_floors(file, blocks),
        *_of_densities([density for density, free in zip(densities, blocks.free, strict=True) if free and density is not None]),
        *_of_thickness(file),
        *_of_sizes(blocks),
        *_of_gaps(blocks, missed, repairs.tolerance if repairs else 0.0),
        *_of_unclosed(repairs),
        *_of_edges(blocks, missed),
        *_of_gravity(gravity),
        *_of_shares(file),
        *_of_travel(blocks, file, twists),
        *_of_path(blocks, file, twists),
        *_of_weight(blocks, gravity),
        *_of_motion(blocks, gravity, twists),
        *_of_expected(file),
    )


def _of_friction(friction: float) -> Iterator[str]:
    if friction > FRICTION:
        angle = ""
        if 5.0 <= friction < 90.0:
            angle = f"; if it is an angle, write its tangent: {friction:g} degrees is {math.tan(math.radians(friction)):.3f}"
        yield f"joint.friction = {friction:g} is above {FRICTION:g}, but dry stone has 0.5 to 0.75{angle}."


def _of_angles(file: SceneFile) -> Iterator[str]:
    angles = {f"arch[{number}]": one.embrace for number, one in enumerate(file.arch)}
    angles |= {f"vault[{number}]": one.embrace for number, one in enumerate(file.vault)}
    angles |= {f"dome[{number}]": one.embrace for number, one in enumerate(file.dome)}
    for table, angle in angles.items():
        if angle <= RADIANS:
            meant = f"{angle:g} radians are {math.degrees(angle):.4g} degrees"
            yield f"{table}.embrace = {angle:g} is a very small angle; it is in degrees: {meant}."


def _of_floors(file: SceneFile, blocks: Blocks) -> Iterator[str]:
    """Yield a warning for each floor on a course that an arch over an opening cuts: its voussoirs belong to no course."""
    low, high = blocks.low[:, 2], blocks.high[:, 2]
    for building in file.building:
        for floor in building.floor:
            middle = building.origin[2] + (floor.course - 0.5) * building.block[2]
            beside = np.flatnonzero(np.abs(low + high - 2.0 * middle) < (high - low + building.block[2]) * ALL_BUT)
            for side in floor.sides or SIDES[building.plan]:
                if any(blocks.names[block].startswith(f"{building.name} {side} arch ") for block in beside):
                    yield (
                        f'building "{building.name}": voussoirs in course {floor.course} of the wall "{side}" carry nothing of the floor '
                        "on this course. Put it on a course above the arch, or load the voussoirs by a [[load]]."
                    )


def _of_shares(file: SceneFile) -> Iterator[str]:
    if (motion := file.settlement) is None:
        return
    shares = [(f"settlement.zone[{number}].ratio", zone.ratio) for number, zone in enumerate(motion.zone)]
    shares += [(f"settlement.profile[{number}]", share) for number, (_, share) in enumerate(motion.profile or ())]
    for where, share in shares:
        if abs(share) >= SHARE:
            yield f"{where}: {share:g} times the settlement is large; a share is no percentage: write {share / 100.0:g} for {share:g} %."


def _of_travel(blocks: Blocks, file: SceneFile, twists: np.ndarray | None) -> Iterator[str]:
    """Yield a warning where `max_travel` or `wedging` moves blocks so far in YADE that contact spheres slip off their faces."""
    longest, speed = TRAVEL_OVER_INSET * file.joint.inset, _fastest(blocks, twists)
    for name in ("max_travel", "wedging"):
        travel = float(file.yade.get(name, 0.0))
        if not travel * speed > longest * (1.0 + ROUND_OFF) or longest == 0.0:
            continue
        yield (
            f"{name} = {travel:g} moves blocks by {1e3 * travel * speed:.3g} mm in YADE, so that contact spheres slip off their faces. "
            f"It should be at most {longest / speed:.3g}: {TRAVEL_OVER_INSET:g} of the inset of {1e3 * file.joint.inset:g} mm."
        )


def _of_path(blocks: Blocks, file: SceneFile, twists: np.ndarray | None) -> Iterator[str]:
    """Yield a warning where a requested curve is so long that lever arms change; limit analysis keeps the lever arms as built."""
    settlement = file.path.settlement if file.path else None
    if settlement is None or not blocks.free.any():
        return
    size = float(np.cbrt(np.median(blocks.volume[blocks.free])))
    speed = _fastest(blocks, twists)
    if settlement * speed > TURNED * size:
        yield (
            f"path.settlement = {settlement:g} moves blocks by {settlement * speed / size:.2g} times a block's size, but lever arms stay "
            "those of the structure as built, with finite rotations, too. Do not use the curve "
            f"beyond about {TURNED * size / speed:.2g}: the true lever arms, and so the reaction, differ by then."
        )


def _fastest(blocks: Blocks, twists: np.ndarray | None) -> float:
    """Speed of the support's fastest point in its unit motion, in m where the support turns; 1 under a live load."""
    if twists is None:
        return 1.0
    moving = twists[blocks.vertex_block]
    return float(np.linalg.norm(moving[:, :3] + np.cross(moving[:, 3:], blocks.vertices), axis=1).max())


def _of_densities(densities: Sequence[float]) -> Iterator[str]:
    low, high = DENSITY
    for density in sorted({density for density in densities if not low <= density <= high}):
        unit = ""
        if 10.0 <= density <= 40.0:
            unit = f"; if it is a weight in kN/m3, write {1000.0 * density / 9.81:.0f}"
        elif 0.5 <= density <= 4.0:
            unit = f"; if it is in t/m3, write {1000.0 * density:.0f}"
        yield f"density = {density:g} kg/m3 lies outside {low:g} to {high:g}{unit}."


def _of_thickness(file: SceneFile) -> Iterator[str]:
    """Yield a warning for each drawing with blocks thicker than 10 m: the thickness was probably given in the unit of the drawing."""
    for number, drawing in enumerate(file.drawing):
        if drawing.thickness > SIZE[1]:
            metres = f"if it is in mm, write {drawing.thickness / 1e3:g}"
            yield f"drawing[{number}].thickness = {drawing.thickness:g} m is more than {SIZE[1]:g} m; {metres}."


def _of_sizes(blocks: Blocks) -> Iterator[str]:
    extent = blocks.high - blocks.low
    (low, high), where = SIZE, blocks.free
    long, thin = np.flatnonzero(where & (extent.max(axis=1) > high)), np.flatnonzero(where & (extent.min(axis=1) < low))
    if len(long):
        yield f"{_named(blocks, long)} longer than {high:g} m (up to {extent[long].max():.4g} m); coordinates are in metres."
    if len(thin):
        least = 1e3 * extent[thin].min()
        yield f"{_named(blocks, thin)} thinner than {1e3 * low:g} mm (down to {number_text(least, 3)} mm); coordinates are in metres."


def _of_gaps(blocks: Blocks, missed: MissedJoints, tolerance: float) -> Iterator[str]:
    near = MARGIN * missed.gap / 2.0 <= MOST_TOLERANCE  # huge blocks, such as those in a wrong unit, have wider gaps
    missed = replace(missed, pairs=missed.pairs[near], gap=missed.gap[near])
    if not len(missed.gap):
        return
    closing = _rounded_up(MARGIN * max(float(missed.gap.max()) / 2.0, tolerance))  # more than the tolerance that left these gaps open
    pairs = [
        f'"{blocks.names[a]}" and "{blocks.names[b]}" across {number_text(1e3 * gap, 2)} mm'
        for (a, b), gap in zip(missed.pairs, missed.gap, strict=True)
    ]
    named = ", ".join(pairs[:NAMED]) + (", ..." if len(pairs) > NAMED else "")
    what = f"blocks {named} nearly touch" if len(pairs) == 1 else f"{len(pairs)} pairs of blocks nearly touch ({named})"
    yield f"{what}, but no joint connects them there; [geometry] tolerance = {closing:g} closes such gaps."


def _of_edges(blocks: Blocks, missed: MissedJoints) -> Iterator[str]:
    """Yield a warning for blocks that touch at an edge or a corner, except for pairs across a gap, see `_of_gaps`."""
    found, told = edge_contacts(blocks), set(map(tuple, missed.pairs.tolist()))
    kept = [k for k, pair in enumerate(found.pairs.tolist()) if tuple(pair) not in told]
    if not kept:
        return
    first, places = kept[0], [place_text(place) for place in found.place[kept[:NAMED]].tolist()]
    pairs = [f'"{blocks.names[a]}" and "{blocks.names[b]}"' for a, b in found.pairs[kept[:NAMED]].tolist()]
    where = "along an edge" if found.length[first] > 0.0 else "at a corner"
    what = f"blocks {pairs[0]} touch {where} alone, near {places[0]}"
    if len(kept) > 1:
        spots = [f"{pair} near {one}" for pair, one in zip(pairs, places, strict=True)] + ["..."] * (len(kept) > NAMED)
        what = f"{len(kept)} pairs of blocks touch along an edge or at a corner alone ({', '.join(spots)})"
    hint = "where it should hold, cut the edge to a face of some millimetres"
    yield f"{what}: that is no joint and holds nothing in either method; {hint}."


def _of_unclosed(repairs: Repairs | None) -> Iterator[str]:
    """Yield a warning for the places that are still open after the repair of the geometry.

    An overlap too deep to be cut does not count: blocks that overlap are refused with a message of their own.
    """
    if repairs is None:
        return
    deepest = 2.0 * repairs.tolerance + repairs.joint_width
    some = sorted((one for one in repairs.unclosed if one.gap >= -deepest), key=lambda one: -abs(one.gap))
    if not some:
        return
    named = ", ".join(f'"{one.blocks[0]}" and "{one.blocks[1]}" across {number_text(1e3 * abs(one.gap), 2)} mm' for one in some[:NAMED])
    count = "1 place is" if len(some) == 1 else f"{len(some)} places are"
    yield f"{count} not closed ({named}{', ...' if len(some) > NAMED else ''}), so a joint may be missing; `crosscheck show` marks them."


def _rounded_up(length: float) -> float:
    """The length, rounded up to one digit."""
    unit = 10.0 ** math.floor(math.log10(length))
    return math.ceil(length / unit * (1.0 - 1e-9)) * unit


def _named(blocks: Blocks, some: np.ndarray) -> str:
    names = ", ".join(f'"{blocks.names[k]}"' for k in some[:NAMED])
    if len(some) == 1:
        return f"block {names} is"
    return f"{len(some)} blocks ({names}{', ...' if len(some) > NAMED else ''}) are"


def _of_gravity(gravity: np.ndarray) -> Iterator[str]:
    low, high = GRAVITY
    size = float(np.linalg.norm(gravity))
    if not low <= size <= high:
        yield f"gravity is {size:.4g} m/s2, but on earth it is 9.81 m/s2."
    if gravity[2] > 0.0:
        yield "gravity points upward, along z; its z is negative on earth."


def _of_weight(blocks: Blocks, gravity: np.ndarray) -> Iterator[str]:
    weight = float(blocks.mass[blocks.free].sum() * np.linalg.norm(gravity))
    low, high = WEIGHT
    if not low <= weight <= high:
        beyond = "more than any known building of masonry" if weight > high else "less than that of a model of small pieces"
        yield f"the free blocks weigh {weight:.3g} N, {beyond}; are coordinates in metres and densities in kg/m3?"


def _of_motion(blocks: Blocks, gravity: np.ndarray, twists: np.ndarray | None) -> Iterator[str]:
    supports = blocks.role == ROLES["support"]
    if twists is None or not supports.any():
        return
    velocity = twists[supports, :3] + np.cross(twists[supports, 3:], blocks.centroid[supports])
    # On an inclined model, gravity is oblique: a level motion has a component against gravity and lifts nothing.
    along = np.array([gravity, np.where(np.abs(gravity) == np.abs(gravity).max(), gravity, 0.0)])
    rounded = UPWARD * np.linalg.norm(gravity) * np.linalg.norm(velocity, axis=1).max()
    rises = (velocity @ along.T < -rounded).all(axis=1)
    if (along @ np.average(velocity, axis=0, weights=blocks.volume[supports]) < -rounded).all():
        yield (
            "the support moves against gravity: it lifts the structure; a settlement has a direction such as [0, 0, -1], or an axis about "
            "which the support sinks."
        )
    elif rises.any() and np.ptp(twists[supports], axis=0).any():  # one rigid body that turns may rise at one end
        yield f"{_named(blocks, np.flatnonzero(supports)[rises])} lifted, while the support sinks as a whole."


def _of_expected(file: SceneFile) -> Iterator[str]:
    """Yield a warning for a tolerance that is large compared with its expected value."""
    if file.expected is None:
        return
    tolerance = file.expected.tolerance
    values = {name: value for name in file.expected.values() if (value := getattr(file.expected, name))}
    for name, value in values.items():
        if tolerance > LOOSE * abs(value):
            share = f"{100.0 * tolerance / abs(value):.3g} % of {name} = {value:g}"
            yield f"expected.tolerance = {tolerance:g} is {share}, so a wrong answer may meet it; it is in the unit of the value."
            return
