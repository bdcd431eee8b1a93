"""Friction pyramids bracket the answer of the cone, converge to it as 1 / facets^2, and are exact where no cone is linearised."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import scenes

from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.linearised import METHODS, solve_linearised
from la_core.limit.problem import ACCEPTED, Drive
from la_core.measures import residuals
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

SAME = 1e-6  # of the mean block weight, or of the multiplier: the residuals that either solver's answer may have
SAME_LINEAR = 1e-7  # of the weight: two algorithms on one linear programme
ROUNDING = 1e-12  # of the mean block weight
QUADRATIC = (2.8, 5.7)  # 4 within a factor sqrt(2): mechanisms vary slightly with the facets, and 1/cos(pi / F) - 1 is nearly quadratic

DRIVES = {"yielding": Drive.YIELDING, "pushing": Drive.PUSHING}
ASKEW = (0.4, 0.3, -1.0)  # a settlement that is parallel to no tangent
TURNING = {"axis": [0.3, 1.0, 0.0], "point": [0.8, 0.0, 0.0]}  # the value is a moment
FACETS = (8, 16)

both_drives = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES)
both_models = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
both_sides = pytest.mark.parametrize("inscribed", [True, False], ids=["inscribed", "circumscribed"])
any_facets = pytest.mark.parametrize("facets", [4, 7, 16])

IN_SPACE = {
    "beams": lambda: scenes.build(*scenes.crossing_beams()),
    "beams askew": lambda: scenes.build(*scenes.crossing_beams(), settlement=ASKEW),
    "slab": lambda: scenes.shipped("slab_four_corners"),
    "wall": lambda: scenes.build(*scenes.wall(3, 3, split=0.8), plane=False),
    "wall askew": lambda: scenes.build(*scenes.wall(3, 3, split=0.8), plane=False, settlement=ASKEW),
    "wall turning": lambda: scenes.build(*scenes.wall(3, 3, split=0.8), plane=False, settlement=TURNING),
}
SLIDING = ("beams askew", "wall", "wall askew", "wall turning")
every_scene = pytest.mark.parametrize("scene", [make() for make in IN_SPACE.values()], ids=IN_SPACE)
every_sliding_scene = pytest.mark.parametrize("scene", [IN_SPACE[name]() for name in SLIDING], ids=SLIDING)


def solved(solution: Solution) -> Solution:
    """The solution, which must have a value."""
    assert solution.status is Status.SOLVED
    return solution


def bracket(assembly: Assembly, drive: Drive, facets: int) -> tuple[float, float]:
    """Lower and upper bound of the true value, in its unit. For the least reaction, the circumscribed pyramids give the lower bound."""
    outside, inside = (solved(solve_linearised(assembly, drive, facets, inscribed)).value for inscribed in (False, True))
    return (outside, inside) if drive is Drive.YIELDING else (inside, outside)


def with_friction(assembly: Assembly, factor: float) -> Assembly:
    """The assembly with every coefficient of friction multiplied by a factor."""
    return replace(assembly, points=replace(assembly.points, friction=factor * assembly.points.friction))


def low_block(angle: float, friction: float = 0.6, **options) -> Scene:
    """A low block on a pad that slides under a live load at an angle to the x axis, which is the first tangent."""
    pad = scenes.box("pad", (-1.0, -1.0, -0.2), (1.0, 1.0, 0.0), "fixed")
    block = scenes.box("block", (-0.5, -0.5, 0.0), (0.5, 0.5, 0.1))
    load = {"live": (np.cos(angle), np.sin(angle), 0.0), "settlement": None} | options
    return scenes.build(pad, block, friction=friction, plane=False, **load)


def reach(facets: int, angle: float, inscribed: bool) -> float:
    """Distance from the centre of the polygon to its edge at an angle from a corner (rad), over the radius of the friction circle."""
    apothem = np.cos(np.pi / facets) if inscribed else 1.0
    return apothem / np.cos(angle % (2.0 * np.pi / facets) - np.pi / facets)


@both_drives
@every_scene
def test_pyramids_bracket_the_cone(scene: Scene, drive: Drive) -> None:
    assembly = assemble(scene)
    true, loose = solved(solve_associated(assembly, drive)).value, SAME * assembly.mean_weight
    for facets in (4, 7, 8):
        low, high = bracket(assembly, drive, facets)
        assert low - loose <= true <= high + loose


@both_drives
@pytest.mark.slow
def test_pyramids_bracket_the_cone_on_a_corner_of_two_walls(drive: Drive) -> None:
    assembly = assemble(scenes.shipped("corner_settling_end"))
    true, loose = solved(solve_associated(assembly, drive)).value, SAME * assembly.mean_weight
    (low, high), (closer_low, closer_high) = (bracket(assembly, drive, facets) for facets in FACETS)
    assert low - loose <= true <= high + loose and closer_low - loose <= true <= closer_high + loose
    assert QUADRATIC[0] < (high - low) / (closer_high - closer_low) < QUADRATIC[1]


@pytest.mark.slow_after_first
@both_drives
@every_sliding_scene
def test_width_of_the_bracket_is_quadratic_in_the_facets(scene: Scene, drive: Drive) -> None:
    assembly = assemble(scene)
    widths = [high - low for low, high in (bracket(assembly, drive, facets) for facets in (8, 16, 32, 64))]
    for wide, narrow in pairwise(widths):
        assert QUADRATIC[0] < wide / narrow < QUADRATIC[1]
    assert sum(bracket(assembly, drive, 64)) / 2.0 == pytest.approx(solve_associated(assembly, drive).value, abs=widths[-1])


@both_drives
def test_bracket_holds_however_the_scene_is_turned(drive: Drive) -> None:
    """Turned joints have other tangents, so the polygons turn about their normals and the bounds change. The true value does not change."""
    scene = IN_SPACE["beams askew"]()
    true, loose = solve_associated(assemble(scene), drive).value, SAME * assemble(scene).mean_weight
    for angle in (0.4, 1.3, 2.9):
        low, high = bracket(assemble(scenes.moved(scene, turn=scenes.rotation((1.0, 2.0, 3.0), angle))), drive, 5)
        assert low - loose <= true <= high + loose


@both_drives
@pytest.mark.parametrize("name", ["beams", "slab"])
def test_bracket_has_no_width_where_no_joint_slides(name: str, drive: Drive) -> None:
    assembly = assemble(IN_SPACE[name]())
    low, high = bracket(assembly, drive, 8)
    assert low == pytest.approx(high, abs=SAME_LINEAR * assembly.weight)
    assert low == pytest.approx(solve_associated(assembly, drive).value, abs=SAME * assembly.mean_weight)


@both_drives
@every_sliding_scene
def test_pyramids_lie_between_the_cones_that_touch_their_corners_and_sides(scene: Scene, drive: Drive) -> None:
    facets, assembly = 8, assemble(scene)
    narrow, wide = (solved(solve_associated(with_friction(assembly, np.cos(np.pi / facets) ** sign), drive)).value for sign in (1, -1))
    lowest, highest = (wide, narrow) if drive is Drive.YIELDING else (narrow, wide)
    low, high = bracket(assembly, drive, facets)
    loose = SAME * assembly.mean_weight
    assert lowest - loose <= low <= high <= highest + loose


@both_sides
@pytest.mark.parametrize("facets", [4, 6, 8])
@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.7], ids=lambda share: f"{share} of a side")
def test_sliding_block_shows_where_the_corners_are(share: float, facets: int, inscribed: bool) -> None:
    """The multiplier is mu times the polygon's reach in the direction of the load. The first corner lies along the first tangent."""
    angle = share * 2.0 * np.pi / facets
    solution = solved(solve_linearised(assemble(low_block(angle)), Drive.LIVE, facets, inscribed))
    assert solution.value == pytest.approx(0.6 * reach(facets, angle, inscribed), rel=SAME)


def test_block_on_a_slope_may_stand_in_the_cone_and_not_in_the_pyramid() -> None:
    """With four facets and a slope at 45 degrees to their corners, an inscribed pyramid resists up to mu / sqrt(2)."""
    tilted = 9.81 * np.array([0.5, 0.5, -1.0])  # tangent of the slope 0.71, between 0.8 / sqrt(2) and mu = 0.8
    pad = scenes.box("settling pad", (3.0, 0.0, -0.1), (4.0, 1.0, 0.0), "support")
    standing = scenes.box("standing", (3.0, 0.0, 0.0), (4.0, 1.0, 0.1))
    fixed = scenes.box("fixed pad", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "fixed")
    block = scenes.box("block", (0.2, 0.2, 0.0), (0.8, 0.8, 0.1))
    assembly = assemble(scenes.build(pad, standing, fixed, block, friction=0.8, gravity=tilted, plane=False))
    assert solve_associated(assembly, Drive.YIELDING).status is Status.SOLVED
    assert solve_linearised(assembly, Drive.YIELDING, 4, inscribed=False).status is Status.SOLVED
    inside = solve_linearised(assembly, Drive.YIELDING, 4, inscribed=True)
    assert inside.status is Status.INFEASIBLE and set(inside.falling) == {"block", "standing"}


@any_facets
@both_sides
@pytest.mark.parametrize(
    ("options", "drives"),
    [
        ({}, DRIVES.values()),
        ({"friction": 0.0}, DRIVES.values()),
        ({"model": "none-slides"}, DRIVES.values()),
        ({"live": (1.0, 0.0, 0.0)}, [Drive.LIVE]),
    ],
    ids=["rough", "smooth", "none slides", "live"],
)
def test_plane_answer_is_exact_for_any_facets(options: dict, drives: list[Drive], facets: int, inscribed: bool) -> None:
    assembly = assemble(scenes.build(*scenes.wall(4, 3, split=None if "live" in options else 1.2), **options))
    assert assembly.effects.plane
    for drive in drives:
        unit = 1.0 if drive is Drive.LIVE else assembly.mean_weight
        assert solved(solve_linearised(assembly, drive, facets, inscribed)).value == pytest.approx(
            solve_associated(assembly, drive).value, abs=SAME * unit
        )


@both_drives
@both_sides
@pytest.mark.parametrize("options", [{"friction": 0.0}, {"model": "none-slides"}], ids=["smooth", "none slides"])
def test_without_a_cone_to_cut_the_answer_in_space_is_exact(options: dict, inscribed: bool, drive: Drive) -> None:
    assembly = assemble(scenes.build(*scenes.wall(3, 3, split=0.8), plane=False, **options))
    value = solved(solve_linearised(assembly, drive, 4, inscribed)).value
    assert value == pytest.approx(solve_associated(assembly, drive).value, abs=SAME * assembly.mean_weight)


def test_multiplier_in_space_is_bracketed() -> None:
    assembly = assemble(scenes.build(*scenes.wall(3, 3), live=(1.0, 0.4, 0.0), settlement=None, plane=False))
    low, high = bracket(assembly, Drive.LIVE, 16)
    assert low - SAME <= solve_associated(assembly, Drive.LIVE).value <= high + SAME


@both_sides
@every_scene
def test_interior_point_and_simplex_agree(scene: Scene, inscribed: bool) -> None:
    assembly = assemble(scene)
    first, second = (solved(solve_linearised(assembly, Drive.YIELDING, 8, inscribed, method)).value for method in METHODS)
    assert first == pytest.approx(second, abs=SAME_LINEAR * assembly.weight)


@both_drives
@every_sliding_scene
def test_inscribed_forces_are_safe_in_the_true_cone(scene: Scene, drive: Drive) -> None:
    assembly = assemble(scene)
    solution = solved(solve_linearised(assembly, drive, 8, inscribed=True))
    assert residuals.equilibrium_residual(assembly, solution.forces) <= ACCEPTED
    assert residuals.cone_violation(assembly, solution.forces) <= ROUNDING
    assert residuals.reaction(assembly, solution.forces) == solution.value
    assert solution.mechanism_violation == residuals.flow_rule_violation(assembly, solution.twists) > ACCEPTED


@both_drives
@every_sliding_scene
def test_circumscribed_mechanism_is_admissible_and_its_forces_exceed_the_cone_by_the_corners(scene: Scene, drive: Drive) -> None:
    facets, assembly = 8, assemble(scene)
    solution = solved(solve_linearised(assembly, drive, facets, inscribed=False))
    assert residuals.flow_rule_violation(assembly, solution.twists) <= ACCEPTED
    power = float(np.sum(assembly.dead_load * solution.twists)) * drive.value
    assert power == pytest.approx(solution.value, abs=SAME * assembly.mean_weight)
    assert solution.cone_violation == residuals.cone_violation(assembly, solution.forces) > ACCEPTED
    normal, friction_force = assembly.split(solution.forces)
    tangential = np.linalg.norm(friction_force, axis=1)
    corner = assembly.points.friction * normal / np.cos(np.pi / facets)
    assert (tangential <= corner + ROUNDING * assembly.mean_weight).all()


@both_models
@both_sides
@pytest.mark.parametrize("method", METHODS)
def test_structure_that_cannot_stand_names_what_falls(method: str, inscribed: bool, plane: bool) -> None:
    parts = (
        scenes.box("fixed pad", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "fixed"),
        scenes.box("settling pad", (3.0, 0.0, -0.1), (4.0, 1.0, 0.0), "support"),
        scenes.box("standing", (3.0, 0.0, 0.0), (4.0, 1.0, 1.0)),
        scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5)),
    )
    for drive in DRIVES.values():
        solution = solve_linearised(assemble(scenes.build(*parts, plane=plane)), drive, 8, inscribed, method)
        assert solution.status is Status.INFEASIBLE and solution.falling == ("overhang",)
        assert np.isnan(solution.value) and np.isnan(solution.forces).all() and np.isnan(solution.twists).all()
    live = assemble(scenes.build(parts[0], parts[3], live=(1.0, 0.0, 0.2), plane=plane))  # a negative multiplier would hold it up
    assert solve_linearised(live, Drive.LIVE, 8, inscribed, method).falling == ("overhang",)


@both_models
@both_sides
@pytest.mark.parametrize("method", METHODS)
def test_jammed_support_bears_any_push(method: str, inscribed: bool, plane: bool) -> None:
    parts = (
        scenes.box("left", (-1.0, 0.0, 0.0), (0.0, 1.0, 0.4), "fixed"),
        scenes.box("voussoir", (0.0, 0.0, 0.0), (0.6, 1.0, 0.4)),
        scenes.box("right", (0.6, 0.0, 0.0), (1.6, 1.0, 0.4), "support"),
    )
    assembly = assemble(scenes.build(*parts, settlement=(1.0, 0.0, 0.0), friction=1.2, plane=plane))
    assert solve_linearised(assembly, Drive.PUSHING, 8, inscribed, method).status is Status.UNBOUNDED
    assert solve_linearised(assembly, Drive.YIELDING, 8, inscribed, method).status is Status.SOLVED
    overhang = scenes.box("overhang", (-1.9, 0.0, 0.4), (-0.2, 1.0, 0.9))
    beside = assemble(scenes.build(*parts, overhang, settlement=(1.0, 0.0, 0.0), friction=1.2, plane=plane))
    assert solve_linearised(beside, Drive.PUSHING, 8, inscribed, method).falling == ("overhang",)
    pressed = assemble(scenes.build(*scenes.wall(2, 2), live=scenes.DOWN, plane=plane))
    assert solve_linearised(pressed, Drive.LIVE, 8, inscribed, method).status is Status.UNBOUNDED


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_value_over_weight_knows_no_units(scale: float) -> None:
    scene = IN_SPACE["beams askew"]()
    original, other = assemble(scene), assemble(scenes.moved(scene, scale=scale, density=3.0))
    first, second = (solved(solve_linearised(a, Drive.YIELDING, 8, inscribed=True)).value / a.weight for a in (original, other))
    assert first == pytest.approx(second, rel=SAME)


def test_cost_is_what_highs_says() -> None:
    solution = solve_linearised(assemble(IN_SPACE["wall"]()), Drive.YIELDING, 8, inscribed=True)
    assert solution.seconds > 0.0 and solution.iterations > 0


@pytest.mark.parametrize(("facets", "method", "what"), [(3, "highs-ipm", "facets = 3"), (8, "simplex", 'method = "simplex"')])
def test_what_is_asked_for_wrongly_is_named(facets: int, method: str, what: str) -> None:
    with pytest.raises(ValueError, match=what):
        solve_linearised(assemble(IN_SPACE["wall"]()), Drive.YIELDING, facets, inscribed=True, method=method)
