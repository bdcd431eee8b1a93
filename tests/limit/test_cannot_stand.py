"""A structure without equilibrium is infeasible, and the falling blocks are named. A support that cannot move is unbounded."""

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scenes

from comparison.judge import conclusion_of
from comparison.verdict import Verdict
from la_core.analysis.stage import analyse
from la_core.limit import associated, share_of_free_fall
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.scene.scene import Scene

PADS = (
    scenes.box("fixed pad", (0.0, 0.0, -0.1), (1.0, 1.0, 0.0), "fixed"),
    scenes.box("settling pad", (3.0, 0.0, -0.1), (4.0, 1.0, 0.0), "support"),
)
STANDING = scenes.box("standing", (3.0, 0.0, 0.0), (4.0, 1.0, 1.0))

both_models = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
both_drives = pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING])


def without_value(solution: Solution) -> bool:
    """Whether all numbers of a solution are NaN, so that none of them can pass for a result."""
    numbers = [
        solution.value,
        solution.equilibrium_residual,
        solution.cone_violation,
        solution.mechanism_violation,
        solution.duality_gap,
    ]
    return bool(np.isnan(numbers).all() and np.isnan(solution.twists).all() and np.isnan(solution.forces).all())


def falling(model: Scene | Assembly, drive: Drive = Drive.YIELDING) -> set[str]:
    solution = solve_associated(assemble(model) if isinstance(model, Scene) else model, drive)
    assert solution.status is Status.INFEASIBLE
    assert without_value(solution)
    return set(solution.falling)


@both_models
@both_drives
def test_overhang_topples_and_its_neighbour_stands(plane, drive) -> None:
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))  # centroid at 1.05, the pad ends at 1
    assert falling(scenes.build(*PADS, STANDING, overhang, plane=plane), drive) == {"overhang"}


@both_models
def test_overhang_stands_while_its_centroid_is_on_the_pad(plane) -> None:
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.79, 1.0, 0.5))  # centroid at 0.995
    assert solve_associated(assemble(scenes.build(*PADS, STANDING, overhang, plane=plane)), Drive.YIELDING).status is Status.SOLVED


@both_models
@both_drives
def test_block_on_a_slope_too_smooth_for_it_slides(plane, drive) -> None:
    slope = scenes.block("slope", "fixed", prism=([(0.0, 0.0), (1.0, 0.0), (1.0, 0.7)], (0.0, 1.0)))  # tan = 0.7
    sitting = scenes.block("slider", prism=([(0.2, 0.14), (0.8, 0.56), (0.8, 0.7), (0.2, 0.28)], (0.0, 1.0)))
    for friction, stands in ((0.69, False), (0.71, True)):
        scene = scenes.build(PADS[1], STANDING, slope, sitting, friction=friction, plane=plane)
        if stands:
            assert solve_associated(assemble(scene), drive).status is Status.SOLVED
        else:
            assert falling(scene, drive) == {"slider"}


@both_models
def test_what_rests_on_a_falling_block_falls_with_it(plane) -> None:
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))
    rider = scenes.box("rider", (1.2, 0.0, 0.5), (1.7, 1.0, 0.8))
    assert falling(scenes.build(*PADS, STANDING, overhang, rider, plane=plane)) == {"overhang", "rider"}


@both_models
def test_counterweight_keeps_the_overhang_up(plane) -> None:
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))
    counterweight = scenes.box("counterweight", (0.2, 0.0, 0.5), (0.6, 1.0, 1.5))
    scene = scenes.build(*PADS, STANDING, overhang, counterweight, plane=plane)
    assert solve_associated(assemble(scene), Drive.YIELDING).status is Status.SOLVED


@both_models
def test_thin_arch_names_its_voussoirs_and_not_the_pier_beside_it(plane) -> None:
    pad = scenes.box("pad", (5.0, 0.0, -0.1), (6.0, 1.0, 0.0), "fixed")
    pier = scenes.box("pier", (5.0, 0.0, 0.0), (6.0, 1.0, 1.0))
    scene = scenes.build(scenes.arch(21, 0.05), pad, pier, settlement=(1.0, 0.0, 0.0), plane=plane)
    names = falling(scene)
    assert names and names <= {f"arch {k}" for k in range(1, 22)}


@both_models
def test_a_corbel_that_tips_names_the_stones_whose_centroids_rise_as_well(plane) -> None:
    """In a stack of n stones, each shifted by s over the one below, the stones above the first tip if s exceeds 1/n of their length."""
    for shift, stands in ((0.1665, True), (0.1668, False)):
        stones = [scenes.box(f"stone {k}", (k * shift, 0.0, 0.3 * k), (1.0 + k * shift, 1.0, 0.3 * k + 0.3)) for k in range(6)]
        scene = scenes.build(*PADS, STANDING, *stones, plane=plane)
        if stands:
            assert solve_associated(assemble(scene), Drive.YIELDING).status is Status.SOLVED
        else:
            assert falling(scene) == {f"stone {k}" for k in range(1, 6)}


@both_models
def test_two_overhangs_may_both_fall(plane) -> None:
    parts = [
        scenes.box("left", (-0.95, 0.0, 0.0), (0.5, 1.0, 0.5)),
        scenes.box("right", (0.5, 0.0, 0.0), (1.95, 1.0, 0.5)),
    ]
    names = falling(scenes.build(*PADS, STANDING, *parts, plane=plane))
    assert names and names <= {"left", "right"}


@both_models
def test_live_load_on_what_cannot_stand(plane) -> None:
    """A negative multiplier would hold the structure up, but it does not stand under its own weight."""
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))
    scene = scenes.build(PADS[0], overhang, live=(1.0, 0.0, 0.2), plane=plane)
    assert falling(scene, Drive.LIVE) == {"overhang"}


def test_sliding_askew_to_every_axis() -> None:
    loose = scenes.box("loose", (0.2, 0.2, 0.0), (0.8, 0.8, 0.3))
    for friction, stands in ((0.101, True), (0.099, False)):  # tan(0.1) = 0.1003
        gravity = scenes.rotation((1.0, 2.0, 0.0), 0.1) @ np.array([0.0, 0.0, -9.81])
        scene = scenes.build(*PADS, STANDING, loose, friction=friction, gravity=gravity, plane=False)
        if stands:
            assert solve_associated(assemble(scene), Drive.YIELDING).status is Status.SOLVED
        else:
            assert falling(scene) == {"loose", "standing"}


def test_stage_reports_one_status_for_all_drives() -> None:
    overhang = scenes.box("overhang", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))
    analysis = analyse(scenes.build(*PADS, STANDING, overhang, inset=0.001))
    for solutions in (analysis.bounds, analysis.sharp.bounds):
        assert {s.status for s in solutions.values()} == {Status.INFEASIBLE}
        assert {s.falling for s in solutions.values()} == {("overhang",)}


@both_models
def test_jammed_support_bears_any_push(plane) -> None:
    """A flat arch lies between a fixed block and an abutment. No mechanism moves the abutment inward."""
    parts = (
        scenes.box("left", (-1.0, 0.0, 0.0), (0.0, 1.0, 0.4), "fixed"),
        scenes.box("voussoir", (0.0, 0.0, 0.0), (0.6, 1.0, 0.4)),
        scenes.box("right", (0.6, 0.0, 0.0), (1.6, 1.0, 0.4), "support"),
    )
    assembly = assemble(scenes.build(*parts, settlement=(1.0, 0.0, 0.0), friction=1.2, plane=plane))
    jammed = solve_associated(assembly, Drive.PUSHING)
    assert jammed.status is Status.UNBOUNDED and without_value(jammed) and jammed.falling == ()
    assert solve_associated(assembly, Drive.YIELDING).status is Status.SOLVED


def test_only_a_thorough_attempt_says_that_nothing_limits_a_value(monkeypatch: pytest.MonkeyPatch) -> None:
    """A quick attempt may be wrong. Unless a thorough attempt confirms it, the bound has no answer."""
    assembly = assemble(scenes.shipped("two_pads"))
    solved = solve_associated(assembly, Drive.YIELDING)
    inaccurate = replace(solved, status=Status.INACCURATE)

    def status_after(*statuses: Status) -> Status:
        given = iter(replace(inaccurate, status=status, cone_violation=float("nan")) for status in statuses)

        def attempt(*_: Any) -> Solution:
            return next(given)

        monkeypatch.setattr(associated, "_attempt", attempt)
        return solve_associated(assembly, Drive.YIELDING).status

    assert status_after(Status.UNBOUNDED, Status.UNBOUNDED) is Status.UNBOUNDED  # the second attempt confirms the first
    assert status_after(Status.UNBOUNDED, Status.FAILED, Status.FAILED) is Status.FAILED
    assert status_after(Status.UNBOUNDED, Status.INACCURATE, Status.INACCURATE) is Status.INACCURATE


def test_the_cost_of_an_answer_holds_that_of_looking_for_a_fall(monkeypatch: pytest.MonkeyPatch) -> None:
    """Under a live load, the solver also checks whether the structure stands without the load. Both costs count."""
    assembly = assemble(scenes.build(*scenes.wall(3, 2, first="half"), live=(1.0, 0.0, 0.0)))
    spent: list[int] = []

    def counted(solver: Any) -> Any:
        def solve(*arguments: Any) -> Any:
            answer = solver(*arguments)
            spent.append(answer.iterations)
            return answer

        return solve

    for name in ("maximise", "optimum"):
        monkeypatch.setattr(associated, name, counted(getattr(associated, name)))
    solution = solve_associated(assembly, Drive.LIVE)
    assert solution.status is Status.SOLVED and len(spent) == 2 and solution.iterations == sum(spent)


@both_models
def test_jammed_support_beside_what_cannot_stand(plane) -> None:
    """No mechanism moves the abutment inward, but the overhang beside it falls."""
    parts = (
        scenes.box("left", (-1.0, 0.0, 0.0), (0.0, 1.0, 0.4), "fixed"),
        scenes.box("voussoir", (0.0, 0.0, 0.0), (0.6, 1.0, 0.4)),
        scenes.box("right", (0.6, 0.0, 0.0), (1.6, 1.0, 0.4), "support"),
        scenes.box("overhang", (-1.9, 0.0, 0.4), (-0.2, 1.0, 0.9)),
    )
    scene = scenes.build(*parts, settlement=(1.0, 0.0, 0.0), friction=1.2, plane=plane)
    for drive in (Drive.YIELDING, Drive.PUSHING):
        assert falling(scene, drive) == {"overhang"}


@pytest.mark.parametrize("share", [1.0, 0.1, 1e-4])
@both_models
def test_all_that_falls_is_named_however_light(share, plane) -> None:
    heavy = scenes.box("heavy", (0.2, 0.0, 0.0), (1.9, 1.0, 0.5))
    light = scenes.box("light", (2.1, 0.0, 0.0), (3.0, 1.0, 0.5), density=2000.0 * share)
    pads = (PADS[0], scenes.box("settling pad", (2.8, 0.0, -0.1), (4.0, 1.0, 0.0), "support"))
    scene = scenes.build(*pads, scenes.box("standing", (3.1, 0.0, 0.0), (4.0, 1.0, 1.0)), heavy, light, plane=plane)
    assert falling(scene) == {"heavy", "light"}


@both_models
def test_live_load_that_only_presses_is_borne_without_end(plane) -> None:
    scene = scenes.build(PADS[0], scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), live=scenes.DOWN, plane=plane)
    solution = solve_associated(assemble(scene), Drive.LIVE)
    assert solution.status is Status.UNBOUNDED and without_value(solution)


def test_a_structure_that_stands_with_sharp_edges_alone_says_so() -> None:
    """The weight acts half a millimetre inside the edge of the support. With edges rounded by 1 mm the stone falls, as the message says."""
    shelf = scenes.box("shelf", (0.0, 0.0, -0.2), (0.5005, 0.4, 0.0), "fixed")
    scene = scenes.build(shelf, scenes.box("stone", (0.0, 0.0, 0.0), (1.0, 0.4, 0.2)), live=(1.0, 0.0, 0.0), settlement=None, inset=1e-3)
    analysis = analyse(scene)
    assert analysis.sharp.bounds[Drive.LIVE].status is Status.SOLVED
    concluded = conclusion_of(analysis, [], None)
    assert concluded.verdict is Verdict.CANNOT_STAND
    assert "where edges are rounded by 1 mm" in concluded.reason and "With sharp edges the structure stands." in concluded.reason
    assert "edge of some joint" in concluded.next_step


# --- speed of the fall -------------------------------------------------------------------------------------------------------


def test_a_block_between_smooth_walls_falls_freely() -> None:
    walls = [scenes.box(name, (x, 0.0, 0.0), (x + 1.0, 1.0, 1.0), role) for name, x, role in (("a", -1.0, "support"), ("b", 1.0, "fixed"))]
    scene = scenes.build(*walls, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), friction=0.0, plane=True)
    assert share_of_free_fall(assemble(scene)) == pytest.approx(1.0, rel=1e-6)


@both_models
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_a_block_beside_one_wall_falls_along_it(friction: float, plane: bool) -> None:
    """A smooth wall does not deflect the block. A rough wall deflects it: by the flow rule it parts at mu times its sliding speed."""
    wall = scenes.box("wall", (-1.0, 0.0, 0.0), (0.0, 1.0, 1.0), "support")
    assembly = assemble(scenes.build(wall, scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)), friction=friction, plane=plane))
    assert share_of_free_fall(assembly) == pytest.approx(1.0 / np.hypot(1.0, friction), rel=1e-6)


@both_models
def test_each_block_falls_as_fast_as_its_joints_allow_whatever_it_weighs(plane: bool) -> None:
    """One block falls freely. Another block, four times as heavy, falls along a rough wall, which deflects it."""
    friction, times = 0.9, 4.0
    slope = np.hypot(1.0, friction)
    parts = [scenes.box(f"at {x:g}", (x, 0.0, 0.0), (x + 1.0, 1.0, 1.0), role) for x, role in ((-1, "support"), (1, "fixed"), (4, "fixed"))]
    parts += [
        scenes.box("free", (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        scenes.box("heavy", (5.0, 0.0, 0.0), (6.0, 1.0, 1.0), density=2000.0 * times),
    ]
    parts += [scenes.table("[friction]", between=("free", wall), friction=0.0) for wall in ("at -1", "at 1")]
    share = share_of_free_fall(assemble(scenes.build(*parts, friction=friction, plane=plane)))
    assert share == pytest.approx((1.0 + times / slope**2) / (1.0 + times / slope), rel=1e-6)


@both_models
def test_what_hardly_moves_beside_a_falling_block_makes_its_fall_no_slower(plane: bool) -> None:
    """A small block falls along a wall, and a large one tips so little that it hardly moves."""
    pad = scenes.box("pad", (-1.0, 0.0, -0.2), (0.0, 1.0, 0.0), "support")
    tipping = scenes.box("tipping", (-1.0, 0.0, 0.0), (1.002, 1.0, 0.4))
    falling, wall = scenes.box("falling", (2.0, 0.0, 0.0), (2.4, 1.0, 0.4)), scenes.box("wall", (2.4, 0.0, 0.0), (3.0, 1.0, 0.4), "fixed")
    share = share_of_free_fall(assemble(scenes.build(pad, tipping, falling, wall, friction=0.3, plane=plane)))
    assert share == pytest.approx(1.0 / np.hypot(1.0, 0.3), rel=0.01)


@both_models
@pytest.mark.parametrize("beyond", [0.5, 0.01])
def test_a_block_that_tips_falls_by_what_its_centroid_is_beyond_the_edge(beyond: float, plane: bool) -> None:
    """In a rotation about the edge, the centroid sinks by its horizontal distance, and the farthest corner moves by its distance."""
    pad, lying = 1.0, (2.0 * (1.0 + beyond), 0.4)  # length and height of the block, whose end is 1 m inside of the edge
    held = scenes.box("pad", (-pad, 0.0, -0.2), (0.0, 1.0, 0.0), "support")
    block = scenes.box("block", (-1.0, 0.0, 0.0), (lying[0] - 1.0, 1.0, lying[1]))
    farthest = np.hypot(lying[0] - 1.0, lying[1])
    assembly = assemble(scenes.build(held, block, friction=0.6, plane=plane))
    assert share_of_free_fall(assembly) == pytest.approx(beyond / farthest, rel=1e-5)


@both_drives
def test_numbers_beyond_all_bounds_warn_nobody(drive: Drive, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where a structure just fails to stand, the solver may break off with velocities whose squares overflow."""
    asked = associated.maximise

    def broken_off(*given: Any) -> Any:
        return replace(answer := asked(*given), x=1e160 * answer.x, multipliers=1e160 * answer.multipliers)

    monkeypatch.setattr(associated, "maximise", broken_off)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        solution = solve_associated(assemble(scenes.build(PADS[1], STANDING, friction=0.6)), drive)
    assert solution.status is Status.INACCURATE
