"""Closed forms and published values of the associated problem, in the plane and in 3D as prisms of unit depth.

Reference values: closed forms are written out here; published and computed digits are quoted with their source.
"""

import math
import tomllib
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import scenes

from la_core.analysis.stage import analyse
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

EXACT = 1e-6  # of the weight: the solver is asked for 1e-9; residuals up to 1e-6 of a block's weight are accepted
FIVE_DIGITS = 0.5e-5  # half a unit of the last printed digit
SEVEN_DIGITS = 0.5e-7

in_plane_and_3d = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])


def value(model: Scene | Assembly, drive: Drive = Drive.YIELDING) -> float:
    """Reaction over weight, or multiplier; fails unless limit analysis says "solved"."""
    assembly = assemble(model) if isinstance(model, Scene) else model
    solution = solve_associated(assembly, drive)
    assert solution.status is Status.SOLVED
    return solution.value / (1.0 if drive is Drive.LIVE else assembly.weight)


COULOMB_ALONE = "wall_low_friction"  # its joints slide, and what is known of it is not the associated value


def with_associated_value() -> Iterator[str]:
    """Shipped scenes of a settlement that state a value which the associated problem has: a new one is held without being listed."""
    for path in scenes.SHIPPED.glob("*.toml"):
        tables = tomllib.loads(path.read_text(encoding="utf-8"))
        if {"expected", "settlement"} <= tables.keys() and path.stem != COULOMB_ALONE:
            yield path.stem


@pytest.mark.parametrize("name", sorted(with_associated_value()))
def test_shipped_scene_yields_its_expected_value(name: str) -> None:
    scene = scenes.shipped(name)
    assert scene.expected is not None and scene.inset == 0.001
    sharp = assemble(scene).with_inset(scene, 0.0)
    expected = scene.expected.associated_reaction_over_weight
    if expected is None:  # no joint slides, so any friction yields the same
        expected = scene.expected.reaction_over_weight
    assert value(sharp) == pytest.approx(expected, abs=scene.expected.tolerance)
    if scene.expected.reaction_max_over_weight is not None:
        assert value(sharp, Drive.PUSHING) == pytest.approx(scene.expected.reaction_max_over_weight, abs=scene.expected.tolerance)


# --- statically determinate supports -----------------------------------------------------------------------------------------


RECTANGLE = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (0.0, 0.5))
TRIANGLE = ((0.0, 0.0), (1.0, 0.0), (1.0, 0.5))


@in_plane_and_3d
@pytest.mark.parametrize("friction", [0.05, 0.6, 2.0])
@pytest.mark.parametrize(
    ("profile", "centroid", "fixed", "settling"),
    [
        (RECTANGLE, 0.5, (0.0, 0.4), (0.5, 1.0)),
        (RECTANGLE, 0.5, (0.1, 0.2), (0.7, 0.9)),
        (RECTANGLE, 0.5, (0.0, 0.6), (0.7, 1.0)),
        (RECTANGLE, 0.5, (0.0, 0.1), (0.2, 0.8)),
        (TRIANGLE, 2.0 / 3.0, (0.0, 0.3), (0.75, 1.0)),
        (TRIANGLE, 2.0 / 3.0, (0.25, 0.5), (0.5, 0.75)),
    ],
)
def test_block_on_two_pads(profile, centroid, fixed, settling, friction, plane) -> None:
    scene = scenes.build(
        scenes.block("block", prism=(profile, (0.0, 1.0))),
        scenes.box("fixed pad", (fixed[0], 0.0, -0.1), (fixed[1], 1.0, 0.0), "fixed"),
        scenes.box("settling pad", (settling[0], 0.0, -0.1), (settling[1], 1.0, 0.0), "support"),
        friction=friction,
        plane=plane,
    )
    least = max(0.0, (centroid - fixed[1]) / (settling[1] - fixed[1]))
    greatest = min(1.0, (centroid - fixed[0]) / (settling[0] - fixed[0]))
    assert value(scene) == pytest.approx(least, abs=EXACT)
    assert value(scene, Drive.PUSHING) == pytest.approx(greatest, abs=EXACT)


@in_plane_and_3d
def test_trilith_weighs_on_its_posts_as_statics_says(plane) -> None:
    scene = scenes.build(
        scenes.box("left post", (0.0, 0.0, 0.0), (0.5, 1.0, 2.0)),
        scenes.box("right post", (2.5, 0.0, 0.0), (3.0, 1.0, 2.0)),
        scenes.box("lintel", (0.0, 0.0, 2.0), (3.0, 1.0, 2.5)),
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.5, 1.0, 0.0), "fixed"),
        scenes.box("settling pad", (2.5, 0.0, -0.1), (3.0, 1.0, 0.0), "support"),
        density=1.0,
        gravity=scenes.DOWN,
        plane=plane,
    )
    assembly = assemble(scene)
    assert solve_associated(assembly, Drive.YIELDING).value == pytest.approx(1.6, abs=EXACT)
    assert solve_associated(assembly, Drive.PUSHING).value == pytest.approx(1.9, abs=EXACT)


@pytest.mark.parametrize(("xi", "eta"), [(0.6, 0.7), (0.5, 0.8), (0.3, 0.4), (0.7, 0.75)])
def test_slab_on_four_corner_pads(xi, eta) -> None:
    """Pads of real size placed so that only their outermost points count: see slab_four_corners.toml."""
    size = 0.02
    corners = {"a": (0.0, 0.0), "b": (1.0 - size, -size), "c": (0.0, 1.0 - 2.0 * size), "settling": (1.0, 1.0 - 2.0 * size)}
    pads = [
        scenes.box(name, (px, py, -0.1), (px + size, py + size, 0.0), "support" if name == "settling" else "fixed")
        for name, (px, py) in corners.items()
    ]
    slab = scenes.box("slab", (xi - 1.1, eta - 1.1, 0.0), (xi + 1.1, eta + 1.1, 0.2))
    scene = scenes.build(slab, *pads)
    assert value(scene) == pytest.approx(max(0.0, xi + eta - 1.0), abs=EXACT)
    assert value(scene, Drive.PUSHING) == pytest.approx(min(xi, eta), abs=EXACT)


@pytest.mark.parametrize("inset", [0.001, 0.01])
def test_rounding_shifts_the_lever_arms_by_the_inset(inset, two_pads) -> None:
    """Points at f1 - inset and m1 - inset carry the block; the answer for sharp arrises stays."""
    scene = scenes.load(two_pads.replace("friction = 0.6", f"friction = 0.6\ninset = {inset}"))
    analysis = analyse(scene)
    assert analysis.assembly.inset == inset
    rounded = (0.5 - (0.4 - inset)) / (1.0 - 0.4)
    assert analysis.bounds[Drive.YIELDING].value / scene.weight == pytest.approx(rounded, abs=EXACT)
    assert analysis.sharp.bounds[Drive.YIELDING].value / scene.weight == pytest.approx(1.0 / 6.0, abs=EXACT)


@pytest.mark.parametrize("width", [0.4, 0.02])
def test_sharp_scene_is_compared_at_the_smallest_inset(width) -> None:
    """YADE's contact spheres need an inset; limit analysis takes the same one beside its answer for sharp arrises."""
    scene = scenes.build(*scenes.base(width, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)))
    analysis = analyse(scene)
    inset = analysis.assembly.inset
    assert 0.0 < inset <= min(0.001, 0.02 * width)
    # Edges of the two bases that carry: the fixed one's right edge, the settling one's right edge, both drawn in.
    fixed = width - inset
    assert analysis.bounds[Drive.YIELDING].value / scene.weight == pytest.approx((0.5 - fixed) / (1.0 - inset - fixed), abs=EXACT)
    assert analysis.sharp.bounds[Drive.YIELDING].value / scene.weight == pytest.approx((0.5 - width) / (1.0 - width), abs=EXACT)


# --- stack bond: the dilatant head joint -------------------------------------------------------------------------------------


@in_plane_and_3d
@pytest.mark.parametrize("friction", [0.2, 0.6, 0.8])
@pytest.mark.parametrize(("columns", "courses", "settling"), [(2, 1, 1), (5, 4, 2), (6, 5, 2)])
def test_stack_bonded_wall_holds_its_settling_columns_by_dilatant_friction(columns, courses, settling, friction, plane) -> None:
    """R = W_mov - mu N with the head joint's thrust N = mu R limited by the settling base; the standing part neither slides nor tips."""
    standing = columns - settling
    parts = scenes.wall(columns, courses, split=standing * 0.4, block_size=(0.4, 1.0, 0.2), bond="stack")
    scene = scenes.build(*parts, friction=friction, plane=plane)
    assert value(scene) == pytest.approx(settling / columns / (1.0 + friction**2), abs=EXACT)


# --- arches ------------------------------------------------------------------------------------------------------------------


@in_plane_and_3d
@pytest.mark.parametrize(("voussoirs", "friction"), [(3, 1.0), (4, 1.0), (5, 1.0), (8, 1.0), (9, 0.9), (3, 0.7), (4, 0.5), (5, 0.83)])
def test_flat_arch_thrust(voussoirs, friction, plane) -> None:
    span, thickness = 2.0, 0.4
    course = scenes.table(
        "[wall]", bond="stack", origin=(0.0, 0.0, 0.0), block=(span / voussoirs, 1.0, thickness), per_course=voussoirs, courses=1
    )
    abutments = (
        scenes.box("left", (-0.5, 0.0, 0.0), (0.0, 1.0, thickness), "fixed"),
        scenes.box("right", (span, 0.0, 0.0), (span + 0.5, 1.0, thickness), "support"),
    )
    scene = scenes.build(course, *abutments, friction=friction, settlement=(1.0, 0.0, 0.0), plane=plane)
    odd = voussoirs % 2
    thrust = span / (8.0 * thickness) * (1.0 - odd / voussoirs**2)
    assert value(scene) == pytest.approx(max(thrust, 1.0 / (2.0 * friction)), abs=EXACT)


class RingOfSectors:
    """Statics of a semicircular ring of sectors (weights of curved sectors, or along the centre line) with n radial joints.

    Angles from the crown; the right half carries `count` sectors whose weights act at x = radius of gravity times sin.
    """

    def __init__(self, thickness: float, voussoirs: int, centreline: bool = False) -> None:
        self.inner, self.outer, self.voussoirs = 1.0 - thickness / 2.0, 1.0 + thickness / 2.0, voussoirs
        opening = math.pi / voussoirs
        chord = math.sin(opening / 2.0) / (opening / 2.0)
        moment, area = (self.outer**3 - self.inner**3) / 3.0, (self.outer**2 - self.inner**2) / 2.0
        self.gravity_radius = chord * (1.0 if centreline else moment / area)
        self.middles = (np.arange(voussoirs) + 0.5) * opening - math.pi / 2.0

    def loaded(self, assembly: Assembly) -> Assembly:
        """The assembly of straight-sided voussoirs with these weights in place of their own; unit total weight."""
        load = np.zeros_like(assembly.dead_load)
        voussoirs = slice(0, self.voussoirs)  # the generator puts the springers last
        arm = self.gravity_radius * np.sin(self.middles) - assembly.blocks.centroid[voussoirs, 0]
        load[voussoirs, 2] = -1.0 / self.voussoirs
        load[voussoirs, 4] = arm / self.voussoirs  # moment about y of a downward force at x = arm
        return replace(assembly, dead_load=load)

    def thrusts(self) -> tuple[float, float]:
        """Least and greatest thrust over weight: hinges at the crown, the haunches and the springings (discrete Couplet-Heyman)."""
        half = self.voussoirs // 2
        arms = self.gravity_radius * np.sin(self.middles[half:])
        joints = np.arange(half + 1) * math.pi / self.voussoirs
        x, z = self.inner * np.sin(joints), self.inner * np.cos(joints)
        above = np.concatenate([[0.0], np.cumsum(arms)])  # moments of the weights between the crown and each joint
        count = np.arange(half + 1)
        least = (count * x - above) / (self.outer - z)
        below = (above[-1] - above) - (half - count) * x
        greatest = (half * (self.outer - x) - below)[:-1] / z[:-1]
        return float(least.max() / self.voussoirs), float(greatest.min() / self.voussoirs)


def ring(thickness: float, voussoirs: int, plane: bool = True, centreline: bool = False, **options) -> Assembly:
    options = {"settlement": (1.0, 0.0, 0.0), "model": "none-slides"} | options
    scene = scenes.build(scenes.arch(voussoirs, thickness), plane=plane, **options)
    return RingOfSectors(thickness, voussoirs, centreline).loaded(assemble(scene))


@in_plane_and_3d
@pytest.mark.parametrize("thickness", [0.12, 0.15, 0.20, 0.25])
@pytest.mark.parametrize("voussoirs", [8, 30])
def test_ring_without_sliding_matches_statics_joint_by_joint(thickness, voussoirs, plane) -> None:
    least, greatest = RingOfSectors(thickness, voussoirs).thrusts()
    assembly = ring(thickness, voussoirs, plane)
    assert value(assembly) == pytest.approx(least, abs=EXACT)
    assert value(assembly, Drive.PUSHING) == pytest.approx(greatest, abs=EXACT)


# Joints at any angle, t/R: (H_min, H_max, V_min)/W. Heyman's closed form; V_min computed with 200 sectors.
SEMICIRCLE = {
    0.12: (0.19083, 0.20700, 0.49657),
    0.15: (0.17587, 0.22698, 0.48854),
    0.20: (0.15404, 0.25455, 0.47557),
    0.25: (0.13492, 0.27718, 0.46297),
}


@pytest.mark.parametrize("thickness", SEMICIRCLE)
def test_ring_of_many_sectors_reaches_the_closed_form(thickness) -> None:
    least, greatest, vertical = SEMICIRCLE[thickness]
    many = 720  # the joint nearest to the best one is 1/8 degree off: 2e-6 of the thrust, which is stationary there
    assembly = ring(thickness, many)
    assert value(assembly) == pytest.approx(least, abs=FIVE_DIGITS)
    assert value(assembly, Drive.PUSHING) == pytest.approx(greatest, abs=FIVE_DIGITS)
    assert value(ring(thickness, 200, settlement=scenes.DOWN)) == pytest.approx(vertical, abs=FIVE_DIGITS)


LEAST_THICKNESS = 0.107426  # over the radius; Cocchetti & Rizzi 2020, table 3, centre-line self-weight
HAUNCH_JOINT = 360  # voussoirs: a joint at 54.5 degrees, where the published haunch hinge is at 54.4963


def stands(assembly: Assembly) -> bool:
    status = solve_associated(assembly, Drive.YIELDING).status
    assert status in (Status.SOLVED, Status.INFEASIBLE)
    return status is Status.SOLVED


def test_least_thickness_of_a_semicircular_arch() -> None:
    last_digit = 1e-6
    assert stands(ring(LEAST_THICKNESS + last_digit, HAUNCH_JOINT, centreline=True))
    assert not stands(ring(LEAST_THICKNESS - last_digit, HAUNCH_JOINT, centreline=True))


def test_thrust_at_the_least_thickness() -> None:
    assembly = ring(LEAST_THICKNESS + 1e-6, HAUNCH_JOINT, centreline=True)
    per_arc = 1.0 / math.pi  # weight per unit of centre line, for unit weight and radius
    last_digits = 2e-6  # half of the last one, and the room that a millionth of thickness leaves
    assert value(assembly) / per_arc == pytest.approx(0.621772, abs=last_digits)
    assert value(assembly, Drive.PUSHING) / per_arc == pytest.approx(0.621772, abs=last_digits)


# A millionth of thickness leaves the thrust, hence mu, some room; cones cannot be certified as close to the threshold as lines.
@pytest.mark.parametrize(("plane", "margin"), [(True, 3e-6), (False, 1e-4)], ids=["plane", "3D"])
def test_sliding_threshold_of_the_thinnest_arch(plane, margin) -> None:
    """Above mu = 0.395832 the thinnest arch fails by hinges alone; below, sliding brings it down although it could still hinge."""
    thickness = LEAST_THICKNESS + 1e-6
    assert stands(ring(thickness, HAUNCH_JOINT, plane, centreline=True, model="associated", friction=0.395832 + margin))
    assert not stands(ring(thickness, HAUNCH_JOINT, plane, centreline=True, model="associated", friction=0.395832 - margin))


@pytest.mark.parametrize("thickness", [0.5, 1.0])
def test_friction_below_which_no_thickness_helps(thickness) -> None:
    last_digits = 2e-6  # joints every half degree: the nearest to the critical one at 28 degrees misses it by less than this
    assert stands(ring(thickness, HAUNCH_JOINT, centreline=True, model="associated", friction=0.309215 + last_digits))
    assert not stands(ring(thickness, HAUNCH_JOINT, centreline=True, model="associated", friction=0.309215 - last_digits))


@in_plane_and_3d
def test_arch_of_eleven_voussoirs(plane) -> None:
    """Digits of an independent prototype."""

    def reaction(direction, drive=Drive.YIELDING) -> float:
        scene = scenes.build(scenes.arch(11, 0.15), friction=0.7, settlement=direction, plane=plane)
        return value(scene, drive)

    assert reaction((1.0, 0.0, 0.0)) == pytest.approx(0.17443, abs=FIVE_DIGITS)
    assert reaction((1.0, 0.0, 0.0), Drive.PUSHING) == pytest.approx(0.22953, abs=FIVE_DIGITS)
    assert reaction(scenes.DOWN) == pytest.approx(0.48827, abs=FIVE_DIGITS)
    assert reaction((1.0, 0.0, -1.0)) == pytest.approx(0.47689, abs=FIVE_DIGITS)


# --- one block: sliding, tipping, twisting -----------------------------------------------------------------------------------

AZIMUTHS = [math.radians(degrees) for degrees in (0, 10, 30, 45, 72, 90, 135, 200, 290, 333)]


def column(breadth: float, height: float, friction: float, tilt: float = 0.0, azimuth: float = 0.0, **options) -> Scene:
    """Block of square base on a plane tilted by `tilt`, downhill along `azimuth`, with a live load downhill."""
    half = breadth / 2.0
    downhill = np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
    return scenes.build(
        scenes.box("plane", (-9.0, -half, -1.0), (9.0, half, 0.0), "fixed"),
        scenes.box("block", (-half, -half, 0.0), (half, half, height)),
        friction=friction,
        gravity=9.81 * (math.sin(tilt) * downhill + math.cos(tilt) * np.array(scenes.DOWN)),
        live=downhill,
        **options,
    )


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize(("breadth", "height", "friction"), [(1.0, 0.5, 0.6), (1.0, 2.5, 0.6), (0.4, 0.5, 0.35), (1.0, 1.0, 1.2)])
def test_block_under_a_horizontal_load_slides_or_tips(breadth, height, friction, azimuth) -> None:
    """lambda = min(mu, b/h) across an edge; askew, the block tips over the edge that the load crosses most squarely."""
    tipping = breadth / height / max(abs(math.cos(azimuth)), abs(math.sin(azimuth)))
    scene = column(breadth, height, friction, azimuth=azimuth, plane=False)
    assert value(scene, Drive.LIVE) == pytest.approx(min(friction, tipping), abs=EXACT)


@in_plane_and_3d
@pytest.mark.parametrize(("breadth", "height", "friction"), [(1.0, 0.5, 0.6), (1.0, 2.5, 0.6)])
def test_inclined_plane_in_both_models(breadth, height, friction, plane) -> None:
    critical = min(friction, breadth / height)
    tilt = 0.5 * math.atan(critical)
    live = value(column(breadth, height, friction, tilt, plane=plane), Drive.LIVE)
    # The live load is along the plane: it adds lambda W to the weight's own part.
    assert live == pytest.approx(critical * math.cos(tilt) - math.sin(tilt), abs=EXACT)


@pytest.mark.parametrize("azimuth", AZIMUTHS)
@pytest.mark.parametrize("height", [0.5, 2.5])
def test_inclined_plane_stands_up_to_its_angle_and_not_beyond(height, azimuth) -> None:
    critical = min(0.6, 1.0 / height / max(abs(math.cos(azimuth)), abs(math.sin(azimuth))))
    margin = 1e-5  # rad
    below = column(1.0, height, 0.6, math.atan(critical) - margin, azimuth, plane=False)
    above = column(1.0, height, 0.6, math.atan(critical) + margin, azimuth, plane=False)
    assert solve_associated(assemble(below), Drive.LIVE).status is Status.SOLVED
    fallen = solve_associated(assemble(above), Drive.LIVE)
    assert fallen.status is Status.INFEASIBLE and fallen.falling == ("block",)


@pytest.mark.parametrize(("side", "friction"), [(1.0, 0.6), (0.3, 0.2), (2.0, 1.5)])
def test_torsion_of_a_square_joint_on_its_four_corners(side, friction) -> None:
    assembly = assemble(column(side, 0.5, friction, plane=False))
    moment = np.zeros_like(assembly.live_load)
    moment[assembly.blocks.names.index("block"), 5] = 1.0
    torque = value(replace(assembly, live_load=moment), Drive.LIVE)
    assert torque / (friction * assembly.weight * side / math.sqrt(2.0)) == pytest.approx(1.0, abs=EXACT)


# --- walls -------------------------------------------------------------------------------------------------------------------


@in_plane_and_3d
@pytest.mark.parametrize(("courses", "published"), [(6, 0.64286), (10, 0.58000)])
def test_walls_of_ferris_and_tin_loi(courses, published, plane) -> None:
    """Ferris & Tin-Loi 2001, walls 1 and 2; Gilbert, Casapulla & Ahmed 2006: associated multipliers."""
    parts = scenes.wall(5, courses, block_size=(0.4, 1.0, 0.175), first="half")
    scene = scenes.build(*parts, friction=0.65, live=(1.0, 0.0, 0.0), plane=plane)
    assert len(scene.blocks) == {6: 33, 10: 55}[courses] + 1
    assert value(scene, Drive.LIVE) == pytest.approx(published, abs=FIVE_DIGITS)


@in_plane_and_3d
@pytest.mark.parametrize(("friction", "split", "computed"), [(0.6, 1.2, 0.1286765), (0.3, 1.2, 0.1761531), (0.6, 1.6, 0.0612745)])
def test_running_bond_wall(friction, split, computed, plane) -> None:
    """Digits of an independent prototype."""
    scene = scenes.build(*scenes.wall(6, 10, split, block_size=(0.4, 1.0, 0.2)), friction=friction, plane=plane)
    assert value(scene) == pytest.approx(computed, abs=SEVEN_DIGITS)
