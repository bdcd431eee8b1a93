"""Laws of one answer: equilibrium, cones, flow rule and duality, checked by hand and by an independent linear programme."""

from typing import Any

import numpy as np
import pytest
import scenes
from independent_mechanics import static_form_of_rectangles
from scenes_of_laws import INDEPENDENT, ROUND_OFF, TEXTS, every_scene, solutions, values

from la_core.exchange.fields import SUPPORT
from la_core.limit.problem import Drive
from la_core.measures import residuals
from la_core.model.assembly import assemble

RESIDUAL = 1e-6  # of the mean block weight: residual that la_core allows in an answer called solved


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
    """Associated flow: u_n >= mu |u_t| at every point, and the contact forces do no work in the mechanism (complementarity)."""
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
            assert live_work == pytest.approx(1.0, rel=RESIDUAL) and solution.value == pytest.approx(-work, rel=ROUND_OFF)
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


# --- an independent solver on the static form --------------------------------------------------------------------------------


@pytest.mark.slow_after_first
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
    """The violation of the flow rule is divided by sqrt(1 + mu^2), but blocks that penetrate violate it by their full speed."""
    scene = scenes.build(*scenes.base(0.5, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), friction=1e3)
    assembly = assemble(scene)
    sinking = np.zeros((len(scene.blocks), 6))
    sinking[scene.blocks.free, 2] = -1.0
    assert residuals.flow_rule_violation(assembly, sinking) == residuals.penetration(assembly, sinking) == pytest.approx(1.0)
    assert residuals.flow_rule_violation(assembly, -sinking) == residuals.penetration(assembly, -sinking) == 0.0  # it lifts off
    sliding = np.zeros_like(sinking)
    sliding[scene.blocks.free, 0] = 5.0
    assert residuals.flow_rule_violation(assembly, sliding) == pytest.approx(1e3 / np.hypot(1.0, 1e3))
    assert residuals.penetration(assembly, sliding) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("options", [{"friction": 0.0}, {"friction": 0.6}, {"model": "none-slides"}])
def test_tension_counts_in_full_whatever_the_friction(options: dict[str, Any]) -> None:
    """Without friction, or with unlimited friction, a tension causes no excess of friction, so it must count by itself."""
    scene = scenes.build(*scenes.base(0.5, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), **options)
    assembly = assemble(scene)
    forces = np.zeros((len(assembly.points), 3))
    forces[0] = -0.1 * assembly.mean_weight * assembly.normal[0]
    assert residuals.cone_violation(assembly, forces) == pytest.approx(0.1)


@pytest.mark.parametrize(("options", "excess"), [({"friction": 0.0}, 0.9), ({"friction": 0.6}, 0.3), ({"model": "none-slides"}, 0.0)])
def test_one_force_beyond_its_friction_counts_by_what_is_beyond(options: dict[str, Any], excess: float) -> None:
    """Only one point is loaded, with a friction force of 0.9 of its normal force. Where sliding is excluded, no friction is in excess."""
    scene = scenes.build(*scenes.base(0.5, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), **options)
    assembly = assemble(scene)
    forces = np.zeros((len(assembly.points), 3))
    forces[0] = assembly.mean_weight * (assembly.normal[0] + [0.9, 0.0, 0.0])
    assert residuals.cone_violation(assembly, forces) == pytest.approx(excess)


@pytest.mark.parametrize(("plane", "across"), [(True, 0.0), (False, 0.2)])
def test_a_force_across_the_plane_is_out_of_balance_in_space_alone(plane: bool, across: float) -> None:
    """The base carries the block and pushes it along y with a fifth of its weight, a quarter of a metre below its centroid.

    The moment divided by the mean block size, 1.5 m / sqrt(3), is less than the force.
    """
    scene = scenes.build(*scenes.base(0.5, 1.0), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), plane=plane)
    assembly = assemble(scene)
    forces = np.sign(assembly.normal[:, 2:]) * [0.0, 0.2, 1.0] * assembly.weight / len(assembly.points)
    assert residuals.equilibrium_residual(assembly, forces) == pytest.approx(across, abs=1e-12)
    assert residuals.equilibrium_residual(assembly, 0.0 * forces) == pytest.approx(1.0)


@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.6, 0.0, 0.8), (0.0, 0.0, -1.0)])
def test_forces_that_balance_a_share_of_the_live_load_have_it_as_multiplier(direction: tuple[float, float, float]) -> None:
    """The forces balance the weight and three tenths of the live load, which pushes, lifts or presses the block."""
    parts = scenes.box("base", (-1.0, 0.0, -0.2), (2.0, 1.0, 0.0), "fixed"), scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5))
    assembly = assemble(scenes.build(*parts, live=direction))
    on_base = (np.array([0.0, 0.0, -1.0]) + 0.3 * np.array(direction)) * assembly.weight / len(assembly.points)
    forces = np.where(assembly.blocks.free[assembly.contact_blocks[0]][:, None], on_base, -on_base)  # on block b
    assert residuals.multiplier(assembly, forces) == pytest.approx(0.3)


def test_the_residuals_of_undefined_forces_and_motions_are_undefined() -> None:
    """One of the numbers is NaN. A residual of 0 would then pass every tolerance."""
    assembly = assemble(scenes.shipped("two_pads"))
    forces, twists = np.zeros((len(assembly.points), 3)), np.zeros((len(assembly.blocks), 6))
    assert residuals.cone_violation(assembly, forces) == residuals.penetration(assembly, twists) == 0.0
    forces[1, 0] = twists[-1, 2] = np.nan
    found = [residuals.equilibrium_residual(assembly, forces), residuals.cone_violation(assembly, forces)]
    found += [residuals.flow_rule_violation(assembly, twists), residuals.penetration(assembly, twists)]
    assert np.isnan(found).all()
