"""Laws that hold whatever the structure: equilibrium, duality, invariance, monotony, bounds; and an independent linear programme."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
import scenes
from independent_mechanics import static_form_of_rectangles

from la_core.exchange.fields import SUPPORT
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.measures import residuals
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

ROUND_OFF = 1e-7  # relative: solver tolerance 1e-9 on two differently conditioned copies of one problem
RESIDUAL = 1e-6  # of the mean block weight: what la_core promises of an answer called solved
INDEPENDENT = 1e-6  # of the weight: HiGHS' own feasibility tolerance is 1e-7 of a force scaled to one

WALL = scenes.text(*scenes.wall(5, 6, split=1.2))
ARCH = scenes.text(scenes.arch(11, 0.15), settlement=(1.0, 0.0, -1.0), friction=0.7)
CROSSING = scenes.text(
    *scenes.crossing_beams(),
    settlement=(0.3, 0.2, -1.0),
)
LIVE = scenes.text(*scenes.wall(4, 5), live=(1.0, 0.0, 0.0))
TURNING = scenes.text(*scenes.wall(5, 6, split=1.2), settlement={"axis": (0.0, 1.0, 0.0), "point": (0.9, 0.0, -0.4)})
TEXTS = {"wall": WALL, "arch": ARCH, "crossing beams": CROSSING, "live": LIVE, "turning base": TURNING}

every_scene = pytest.mark.parametrize("name", TEXTS)
TURNS = {
    "quarter turn about z": scenes.rotation((0.0, 0.0, 1.0), math.pi / 2.0),
    "small turn about y": scenes.rotation((0.0, 1.0, 0.0), 1e-4),
    "any turn": scenes.rotation((0.3, -0.5, 0.8), 1.1),
    "other turn": scenes.rotation((-1.0, 0.2, 0.1), 2.7),
}


def solutions(model: Scene | Assembly) -> Iterator[tuple[Assembly, Drive, Solution]]:
    assembly = assemble(model) if isinstance(model, Scene) else model
    for drive in [Drive.LIVE] if assembly.has_live_load else [Drive.YIELDING, Drive.PUSHING]:
        solution = solve_associated(assembly, drive)
        assert solution.status is Status.SOLVED, drive
        yield assembly, drive, solution


def values(model: Scene | Assembly) -> list[float]:
    """Least and greatest reaction over the weight (a moment also over the structure's size), or the multiplier."""

    def unit(assembly: Assembly) -> float:
        size = float(np.cbrt(assembly.blocks.volume.sum())) if np.any(assembly.support_twist[:, 3:]) else 1.0
        return 1.0 if assembly.has_live_load else assembly.weight * size

    return [solution.value / unit(assembly) for assembly, _, solution in solutions(model)]


# --- one answer, checked by hand-written mechanics ---------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("name", "plane"), [(name, plane) for name in TEXTS for plane in (True, False) if name != "crossing beams" or not plane]
)
def test_forces_balance_every_free_block(name, plane) -> None:
    scene = scenes.load(TEXTS[name].replace('plane = "auto"', f"plane = {str(plane).lower()}"))
    for assembly, drive, solution in solutions(scene):
        size = np.ptp(assembly.blocks.vertices, axis=0).max()
        for k in np.flatnonzero(assembly.blocks.free):
            weight = assembly.blocks.mass[k] * scene.gravity
            force = weight.copy()
            if drive is Drive.LIVE:
                force += solution.value * np.linalg.norm(weight) * scene.live
            moment = np.cross(assembly.blocks.centroid[k], force)
            for point, contact in enumerate(assembly.points.interface):
                pair = assembly.interfaces.block_a[contact], assembly.interfaces.block_b[contact]
                if k in pair:
                    on_block = solution.forces[point] * (1.0 if k == pair[1] else -1.0)
                    force += on_block
                    moment += np.cross(assembly.points.position[point], on_block)
            if plane:  # a plane model carries the forces at mid depth, whatever the blocks' own symmetry about it
                moment = moment[1:2]
            assert np.abs(force).max() < RESIDUAL * assembly.mean_weight
            assert np.abs(moment).max() < RESIDUAL * assembly.mean_weight * size


@every_scene
def test_forces_push_and_stay_within_friction(name) -> None:
    for assembly, _, solution in solutions(scenes.load(TEXTS[name])):
        for force, contact in zip(solution.forces, assembly.points.interface, strict=True):
            normal = assembly.interfaces.normal[contact]
            push = force @ normal
            assert push > -RESIDUAL * assembly.mean_weight
            assert np.linalg.norm(force - push * normal) < assembly.points.friction[0] * push + RESIDUAL * assembly.mean_weight


@every_scene
def test_mechanism_obeys_the_flow_rule_and_dissipates_nothing(name) -> None:
    """Associated flow: u_n >= mu |u_t| everywhere, and forces do no work on it (complementarity)."""
    for assembly, drive, solution in solutions(scenes.load(TEXTS[name])):
        blocks, twists = assembly.blocks, solution.twists
        fastest, power = 0.0, 0.0
        slack = []
        for point, contact in enumerate(assembly.points.interface):
            where, normal = assembly.points.position[point], assembly.interfaces.normal[contact]
            a, b = assembly.interfaces.block_a[contact], assembly.interfaces.block_b[contact]
            velocity = [twists[k, :3] + np.cross(twists[k, 3:], where - blocks.centroid[k]) for k in (a, b)]
            jump = velocity[1] - velocity[0]
            opening = jump @ normal
            slack.append(opening - assembly.points.friction[point] * np.linalg.norm(jump - opening * normal))
            fastest = max(fastest, float(np.linalg.norm(jump)))
            power += solution.forces[point] @ jump
        assert min(slack) > -RESIDUAL * fastest
        scale = assembly.weight * fastest if drive is not Drive.LIVE else 1.0
        assert abs(power) < RESIDUAL * scale


@every_scene
def test_value_from_forces_is_value_from_work(name) -> None:
    scene = scenes.load(TEXTS[name])
    for assembly, drive, solution in solutions(scene):
        work = float(np.sum(assembly.dead_load * solution.twists))
        if drive is Drive.LIVE:
            live_work = float(np.sum(assembly.live_load * solution.twists))
            assert solution.value == pytest.approx(-work / live_work, rel=ROUND_OFF)
            continue
        supports = np.flatnonzero(scene.blocks.role == SUPPORT)
        on_structure = np.zeros(6)  # force and moment about the origin
        for point, contact in enumerate(assembly.points.interface):
            wrench = np.concatenate([solution.forces[point], np.cross(assembly.points.position[point], solution.forces[point])])
            if assembly.interfaces.block_a[contact] in supports:
                on_structure += wrench
            if assembly.interfaces.block_b[contact] in supports:
                on_structure -= wrench
        assert solution.value == pytest.approx(-on_structure @ scene.support_twist, abs=ROUND_OFF * assembly.weight)
        assert solution.value == pytest.approx(work if drive is Drive.YIELDING else -work, abs=ROUND_OFF * assembly.weight)


# --- the same structure, told differently ------------------------------------------------------------------------------------


@every_scene
@pytest.mark.parametrize("turn", TURNS)
def test_invariance_under_rotation(name, turn) -> None:
    scene = scenes.load(TEXTS[name].replace('plane = "auto"', "plane = false"))
    turned = scenes.moved(scene, TURNS[turn], shift=(3.0, -2.0, 5.0), plane=False)
    assert values(turned) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
@pytest.mark.parametrize("shift", [(1000.0, -300.0, 20.0), (0.1, 0.2, 0.3)])
def test_invariance_under_translation(name, shift) -> None:
    scene = scenes.load(TEXTS[name])
    assert values(scenes.moved(scene, shift=shift)) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
def test_invariance_under_block_order(name) -> None:
    scene = scenes.load(TEXTS[name])
    order = np.random.default_rng(1).permutation(len(scene.blocks))
    assert values(scenes.moved(scene, order=order)) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
@pytest.mark.parametrize("scale", [1e-3, 1e3], ids=["km", "mm"])
@pytest.mark.parametrize("density", [1e-3, 1e3], ids=["light", "heavy"])
def test_invariance_under_units(name, scale, density) -> None:
    """Lengths told in km or mm as if they were m, densities from 1e0 to 1e6 units: reactions over weight are the same."""
    scene = scenes.load(TEXTS[name])
    assert values(scenes.moved(scene, scale=scale, density=density)) == pytest.approx(values(scene), abs=ROUND_OFF)


@every_scene
@pytest.mark.parametrize("axis", [0, 1])
def test_invariance_under_mirroring(name, axis) -> None:
    scene = scenes.load(TEXTS[name])
    mirror = np.eye(3)
    mirror[axis, axis] = -1.0
    assert values(scenes.moved(scene, mirror)) == pytest.approx(values(scene), abs=ROUND_OFF)


@pytest.mark.parametrize("name", ["wall", "arch"])
def test_plane_model_is_the_3d_model_of_a_prism(name) -> None:
    plane, solid = (scenes.load(TEXTS[name].replace('plane = "auto"', f"plane = {flag}")) for flag in ("true", "false"))
    assert len(assemble(solid).points) == 2 * len(assemble(plane).points)
    assert values(solid) == pytest.approx(values(plane), abs=ROUND_OFF)


@pytest.mark.parametrize("name", ["wall", "crossing beams"])
def test_reaction_is_proportional_to_density_and_gravity(name) -> None:
    scene = scenes.load(TEXTS[name])
    heavier = scenes.moved(scene, density=3.0)
    stronger = replace(scene, gravity=7.0 * scene.gravity)
    for factor, other in ((3.0, heavier), (7.0, stronger)):
        for (_, _, base), (_, _, scaled) in zip(solutions(scene), solutions(other), strict=True):
            assert scaled.value == pytest.approx(factor * base.value, rel=ROUND_OFF)


def test_length_of_the_direction_does_not_matter() -> None:
    for length in (1e-200, 0.5, 1e200):
        scene = scenes.load(ARCH.replace("direction = [1.0, 0.0, -1.0]", f"direction = [{length!r}, 0.0, {-length!r}]"))
        assert values(scene) == pytest.approx(values(scenes.load(ARCH)), abs=ROUND_OFF)


# --- bounds and monotony -----------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["wall", "arch", "crossing beams"])
def test_more_friction_widens_the_interval_of_reactions(name) -> None:
    scene = scenes.load(TEXTS[name])
    assembly = assemble(scene)
    intervals = []
    for friction in (0.45, 0.5, 0.6, 0.8, 1.2):
        points = replace(assembly.points, friction=np.full(len(assembly.points), friction))
        intervals.append(values(replace(assembly, points=points)))
    least, greatest = np.array(intervals).T
    assert (np.diff(least) <= ROUND_OFF).all() and (np.diff(greatest) >= -ROUND_OFF).all()
    assert (least <= greatest).all()
    if name == "wall":  # friction matters here, so the law is put to the test
        assert least[0] - least[-1] > 0.01


def test_more_friction_bears_more_live_load() -> None:
    multipliers = [values(scenes.load(LIVE.replace("friction = 0.6", f"friction = {mu}")))[0] for mu in (0.0, 0.2, 0.4, 0.6, 0.9)]
    assert (np.diff(multipliers) > 0.0).any() and (np.diff(multipliers) >= -ROUND_OFF).all()
    assert multipliers[0] == pytest.approx(0.0, abs=INDEPENDENT)  # frictionless bed joints bear no horizontal load


@pytest.mark.parametrize("name", ["wall", "arch", "crossing beams"])
def test_the_greatest_reaction_is_minus_the_least_for_the_opposite_motion(name) -> None:
    """R is measured along the motion: turned round, R_min and R_max change places and sign."""
    scene = scenes.load(TEXTS[name])
    assert scene.support_twist is not None
    least, greatest = values(scene)
    assert values(replace(scene, support_twist=-scene.support_twist)) == pytest.approx([-greatest, -least], abs=ROUND_OFF)


def test_supports_that_exchange_roles_share_the_weight() -> None:
    """Vertical motion: what one base carries least, the other carries most."""
    first = scenes.build(*scenes.wall(5, 6, split=1.2))
    parts = [
        part.replace('"fixed"', '"swap"').replace('"support"', '"fixed"').replace('"swap"', '"support"') for part in scenes.wall(5, 6, 1.2)
    ]
    second = scenes.build(*parts)
    (least, greatest), (other_least, other_greatest) = values(first), values(second)
    assert [least + other_greatest, greatest + other_least] == pytest.approx([1.0, 1.0], abs=ROUND_OFF)


def test_without_sliding_nothing_changes_where_nothing_slides() -> None:
    coulomb = scenes.load(ARCH)
    no_sliding = scenes.load(ARCH.replace('"associated"', '"none-slides"'))
    assert values(coulomb) == pytest.approx(values(no_sliding), abs=ROUND_OFF)


@pytest.mark.parametrize("name", ["wall", "crossing beams"])
def test_large_friction_tends_to_no_sliding(name) -> None:
    no_sliding = values(scenes.load(TEXTS[name].replace('"associated"', '"none-slides"')))
    gaps = []
    for friction in (3.0, 30.0, 300.0):
        reaction = values(scenes.load(TEXTS[name].replace("friction = 0.6", f"friction = {friction}")))
        gaps.append(abs(reaction[0] - no_sliding[0]))
    assert gaps[2] <= gaps[0] + ROUND_OFF and gaps[2] < 1e-2  # forces in the cone reach any direction only as mu grows
    assert gaps[2] == pytest.approx(0.0, abs=max(ROUND_OFF, gaps[0] / 30.0))


@pytest.mark.parametrize("plane", [True, False])
def test_frictionless_joints(plane) -> None:
    """A pile on two pads needs no friction; a stack-bonded wall without it carries its columns separately."""
    pads = scenes.load(scenes.SHIPPED.joinpath("two_pads.toml").read_text().replace("friction = 0.6", "friction = 0.0"))
    sharp = assemble(pads).with_inset(pads, 0.0)
    assert values(sharp) == pytest.approx([1.0 / 6.0, 1.0], abs=ROUND_OFF)
    columns = scenes.build(*scenes.wall(4, 3, split=0.8, bond="stack"), friction=0.0, plane=plane)
    assert values(columns) == pytest.approx([0.5, 0.5], abs=ROUND_OFF)


# --- rotation of the support -------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parametrize(("pivot_x", "pivot_z"), [(0.0, 0.0), (-1.0, 0.4), (0.4, 0.0)])
def test_turning_pad_feels_the_moment_of_its_reaction(pivot_x, pivot_z, plane) -> None:
    """Block [0, 1] on a fixed pad [0, 0.4] and a pad [0.5, 1] that turns about y, clockwise seen with x right and z up:
    the pad's points sink in proportion to x - pivot, so the reaction acts on the block at one edge of the pad."""
    scene = scenes.build(
        scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)),
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (0.4, 1.0, 0.0), "fixed"),
        scenes.box("turning pad", (0.5, 0.0, -0.1), (1.0, 1.0, 0.0), "support"),
        settlement={"axis": (0.0, 1.0, 0.0), "point": (pivot_x, 0.0, pivot_z)},
        friction=0.0,  # only vertical forces: statics of a beam
        plane=plane,
    )
    assert scene.is_rotation and scene.unit == "N m"
    # Vertical force P at x in [0.5, 1] with P x + Q q = W/2, P + Q = W, q in [0, 0.4]: M = P (x - pivot) over the extreme points.
    moments = []
    for at in (0.5, 1.0):
        for other in (0.0, 0.4):
            force = (0.5 - other) / (at - other)
            moments.append(force * (at - pivot_x))
    least, greatest = (s.value / a.weight for a, _, s in solutions(scene))
    assert [least, greatest] == pytest.approx([min(moments), max(moments)], abs=INDEPENDENT)


def test_far_axis_is_a_translation() -> None:
    far = 1e4
    turning = scenes.load(WALL.replace("direction = [0.0, 0.0, -1.0]", f"axis = [0.0, 1.0, 0.0]\npoint = [{-far}, 0.0, 0.0]"))
    reaction = [solution.value / (assembly.weight * far) for assembly, _, solution in solutions(turning)]
    assert reaction == pytest.approx(values(scenes.load(WALL)), abs=3.0 / far)  # lever arms differ by the wall's own length


# --- an independent solver on the other form of the problem ------------------------------------------------------------------


@pytest.mark.parametrize("name", ["wall_third", "wall_half", "wall_long", "wall_tall", "facade"])
def test_highs_on_the_static_form_agrees_on_shipped_scenes(name) -> None:
    scene = scenes.shipped(name)
    sharp = assemble(scene).with_inset(scene, 0.0)
    assert values(sharp) == pytest.approx([static_form_of_rectangles(scene), static_form_of_rectangles(scene, sign=-1.0)], abs=INDEPENDENT)
    assert scene.expected is not None
    assert static_form_of_rectangles(scene) == pytest.approx(scene.expected.associated_reaction_over_weight, abs=scene.expected.tolerance)


@pytest.mark.parametrize("seed", range(6))
def test_highs_agrees_on_random_walls(seed) -> None:
    """Walls with random bond, size, split, friction and openings."""
    random = np.random.default_rng(seed)
    per_course, courses = int(random.integers(4, 8)), int(random.integers(4, 9))
    split = 0.4 * int(random.integers(1, per_course)) + 0.1
    opening = [{"from": (0.4, 0.2), "to": (1.0, 0.6), "bearing": 0.2}] if seed % 2 else []
    parts = scenes.wall(per_course, courses, split, first=str(random.choice(["full", "half"])), opening=opening)
    scene = scenes.build(*parts, friction=float(random.uniform(0.3, 0.9)))
    assert values(scene) == pytest.approx([static_form_of_rectangles(scene), static_form_of_rectangles(scene, sign=-1.0)], abs=INDEPENDENT)


def test_highs_agrees_on_live_loads() -> None:
    for courses in (4, 7):
        scene = scenes.build(*scenes.wall(5, courses, first="half"), live=(1.0, 0.0, 0.0))
        assert values(scene) == pytest.approx([static_form_of_rectangles(scene)], abs=INDEPENDENT)


def test_great_friction_does_not_hide_a_penetration() -> None:
    """The flow rule divides by sqrt(1 + mu^2); blocks that penetrate violate it by their full speed all the same."""
    scene = scenes.build(*scenes.base(0.5, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), friction=1e3)
    assembly = assemble(scene)
    sinking = np.zeros((len(scene.blocks), 6))
    sinking[scene.blocks.free, 2] = -1.0
    assert residuals.flow_rule_violation(assembly, sinking) == pytest.approx(1.0)
