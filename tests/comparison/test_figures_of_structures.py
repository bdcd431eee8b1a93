"""Every kind of scene has figures. They are the same each time, and show motions and forces to scale."""

import re
from pathlib import Path

import numpy as np
import pytest
from figure_scenes import SCENES, scene_of, synthetic_run
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.image import imread
from scenes import box, build, shipped

from comparison.figures import canvas as drawing
from comparison.figures import reaction_figure, report_figures, save, scene_figures, structure
from comparison.figures.forces import forces_figure
from comparison.figures.motion import drawn_motion, end_words, motions, shown_joints
from comparison.yade import Results
from la_core.analysis.stage import analyse
from la_core.limit.problem import Drive
from la_core.measures import ContactState, joint_forces, thrust_line
from la_core.model.assembly import assemble

TITLE = r"Costs $5 and $\badmacro"
FRAME = 4  # pixels, more than the width of an axes' frame


def has_ink(path: Path, figure: Figure, axes: Axes) -> bool:
    """Return whether the picture has more than one colour inside the frame of the axes."""
    figure.draw_without_rendering()  # puts the axes at their places in the picture
    pixels = imread(path)
    height, width = pixels.shape[:2]
    frame = axes.get_position().bounds
    left, below, wide, high = (share * size for share, size in zip(frame, (width, height) * 2, strict=True))
    inside = pixels[int(height - below - high) + FRAME : int(height - below) - FRAME, int(left) + FRAME : int(left + wide) - FRAME]
    return len(np.unique(inside.reshape(-1, inside.shape[-1]), axis=0)) > 1


def test_a_figure_says_how_the_last_attempt_ended_and_leaves_those_before_to_the_report(tmp_path: Path) -> None:
    message = (
        "the time limit was reached at a settlement of 4e-05 m; before, at 2 times the speed: blocks rattle at a settlement of 1e-05 m"
    )
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    run = synthetic_run(analysis, status="timeout", message=message)
    assert end_words(run, 2000.0) == "timeout: the time limit was reached at a settlement of 0.04 mm"


@pytest.mark.slow_after_first
@pytest.mark.parametrize("kind", SCENES)
def test_every_kind_of_scene_is_drawn(kind: str, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES[kind], title=TITLE.replace("\\", r"\\"))
    analysis = analyse(scene)
    solution = analysis.bounds[analysis.main]
    run = synthetic_run(analysis) if np.isfinite(solution.value) and scene.live is None else None
    mechanisms = {"limit analysis (associated)": solution.twists, "YADE": run.mechanism() if run else np.full_like(solution.twists, np.nan)}
    figures = {
        "assembly": structure.assembly_figure(scene, analysis.assembly),
        "mechanisms": structure.mechanism_figure(analysis.assembly, mechanisms, scene.title, solution.falling),
        "reaction": reaction_figure(Results(analysis, run)),
    }
    for name, figure in figures.items():
        save(figure, tmp_path / f"{name}.png")
        assert all(has_ink(tmp_path / f"{name}.png", figure, axes) for axes in figure.axes)
    for figure in (figures["assembly"], figures["mechanisms"]):
        assert TITLE in " ".join(figure.get_suptitle().split())  # as it was written, not read as a formula
    for axes in (*figures["assembly"].axes, *figures["mechanisms"].axes):
        outlines = sum(len(shapes.get_paths()) for shapes in axes.collections if isinstance(shapes, PolyCollection))
        assert outlines >= len(scene.blocks)  # a face of every block at least


def test_the_same_figure_has_the_same_bytes(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["solid"])
    analysis = analyse(scene)
    for path in (tmp_path / "first.png", tmp_path / "second.png"):
        save(reaction_figure(Results(analysis, synthetic_run(analysis))), path)
    assert (tmp_path / "first.png").read_bytes() == (tmp_path / "second.png").read_bytes()


def test_largest_drawn_displacement_is_a_fixed_share_of_the_structure(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    twists = analysis.bounds[Drive.YIELDING].twists
    figure = structure.mechanism_figure(analysis.assembly, {"one": twists, "YADE": 0.5 * twists})
    drawn = [float(word) for word in re.findall(r"([0-9.]+) mm", figure.get_suptitle())]
    # The block turns about (0.4, 0) by 1/0.6 of the settlement at x = 1; its upper right corner is the fastest, by hypot(0.6, 0.5)/0.6.
    assert drawn == [pytest.approx(1e3 * structure.DRAWN * drawing.structure_size(scene.blocks) * 0.6 / np.hypot(0.6, 0.5), rel=0.01)]


def test_joints_open_or_slide_and_figure_and_view_mark_the_same(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    assembly, solution = analysis.assembly, analysis.bounds[Drive.YIELDING]
    # The block turns about the fixed pad's right end and stays on the settling pad at its right end: both joints open.
    assert shown_joints(assembly, solution.twists, solution.forces).tolist() == [ContactState.OPENING] * 2
    shear = np.zeros((len(assembly.blocks), 6))
    shear[assembly.blocks.free, 0] = 1.0
    assert shown_joints(assembly, shear, solution.forces).tolist() == [ContactState.SLIDING] * 2
    assert shown_joints(assembly, np.full_like(shear, np.nan), solution.forces).tolist() == [ContactState.UNKNOWN] * 2
    joints = {"one": shown_joints(assembly, solution.twists, solution.forces)}
    figure = structure.mechanism_figure(assembly, {"one": solution.twists}, joints=joints)
    (marks,) = (line for line in figure.axes[0].lines if line.get_marker() == "o")
    # One mark a joint, in its middle: the left joint of 0.4 m turns with half the block's rotation about x = 0.4, the pad stays.
    turned = drawn_motion(assembly, {"one": solution.twists}) * solution.twists[2, 4]
    assert marks.get_ydata()[0] == pytest.approx(0.5 * turned * 0.2, rel=0.02)
    assert len(marks.get_ydata()) == 2
    view = motions(Results(analysis)).methods[0]
    assert view.joints.tolist() == shown_joints(assembly, view.twists, view.forces[0]).tolist()


def test_resultants_balance_the_weight_and_cross_their_joints(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    assembly, forces = analysis.assembly, analysis.bounds[Drive.YIELDING].forces
    joints = joint_forces(assembly, forces)
    assert joints.force.sum(axis=0) == pytest.approx([0.0, 0.0, assembly.weight], abs=1e-6 * assembly.weight)
    # By moments about the right end of the fixed pad, without the inset: R = W / 6, at the right end of the settling pad.
    assert joints.normal == pytest.approx([5.0 / 6.0 * assembly.weight, assembly.weight / 6.0], rel=0.02)
    assert joints.centre[:, 0] == pytest.approx([0.4, 1.0], abs=2.0 * analysis.assembly.inset)
    figure = forces_figure(assembly, {"one": forces, "unknown": np.full_like(forces, np.nan)})
    first, second = figure.axes
    (lines,) = (shapes for shapes in first.collections if isinstance(shapes, LineCollection) and len(shapes.get_segments()) == 2)
    lengths = [np.linalg.norm(segment[1] - segment[0]) for segment in lines.get_segments()]
    assert lengths[0] / lengths[1] == pytest.approx(joints.normal[0] / joints.normal[1], rel=1e-3)
    (scale,) = (text.get_text() for text in first.texts)
    assert scale == "1 kN" and "no forces are known" in second.get_title()


def test_forces_are_seen_through_the_stones_of_a_pavement_that_hides_all_its_joints() -> None:
    stones = [
        box(f"stone {i} {j}", (0.2 * i, 0.2 * j, 0.0), (0.2 * (i + 1), 0.2 * (j + 1), 0.3), "fixed" if i in (0, 5) else "free")
        for i in range(6)
        for j in range(6)
    ]
    beds = [box("bed", (0.3, 0.1, -0.2), (0.8, 1.1, 0.0), "fixed"), box("pad", (0.82, 0.1, -0.2), (0.98, 1.1, 0.0), "support")]
    assembly = assemble(build(*stones, *beds))
    forces = 100.0 * assembly.normal
    (axes,) = forces_figure(assembly, {"one": forces}).axes
    drawn = [shapes for shapes in axes.collections if isinstance(shapes, LineCollection)]
    assert len(assembly.blocks) > drawing.FEW
    assert max((len(shapes.get_segments()) for shapes in drawn), default=0) == len(assembly.interfaces)


def test_forces_are_seen_through_the_stones_of_a_building_that_hides_most_of_its_joints() -> None:
    assembly = assemble(shipped("corner_settling_end"))
    x = assembly.points.position[:, 0]
    forces = np.where(x > x.max() - 0.01, 100.0, 5.0)[:, None] * assembly.normal  # the largest forces are in sight, on the face of one end
    (axes,) = forces_figure(assembly, {"one": forces}).axes
    drawn = [shapes for shapes in axes.collections if isinstance(shapes, LineCollection)]
    assert max(len(shapes.get_segments()) for shapes in drawn) == len(assembly.interfaces)


def test_arrows_of_many_falling_blocks_lie_evenly_among_them() -> None:
    """When only the first 25 blocks had arrows, the crowns of two falling arches had none."""
    assembly = assemble(shipped("wall_third"))
    blocks = assembly.blocks
    free = np.flatnonzero(blocks.free)
    figure = structure.mechanism_figure(assembly, {"LA": np.full((len(blocks), 6), np.nan)}, falling=[blocks.names[k] for k in free])
    tails = np.array([text.get_position() for text in figure.axes[0].texts])
    assert len(tails) == drawing.FEW < len(free)
    assert tails.min(axis=0)[1] == pytest.approx(blocks.centroid[free, 2].min()) and tails.max(axis=0)[1] == pytest.approx(
        blocks.centroid[free, 2].max()
    )


def test_the_line_of_thrust_goes_through_an_arch_and_not_through_a_wall(tmp_path: Path) -> None:
    arch, wall = (analyse(shipped(name)).assembly for name in ("arch_spreading", "two_blocks"))
    pairs = thrust_line(arch)
    assert len(pairs) == 11 and set(pairs.ravel().tolist()) == set(range(12))  # every voussoir, from springer to springer
    assert len(thrust_line(wall)) == 0


@pytest.mark.parametrize(("beside", "found"), [(0, 4), (1, 4), (2, 0)])
def test_the_thrust_follows_a_line_where_two_thirds_of_the_blocks_have_two_joints(beside: int, found: int) -> None:
    """Four of the five blocks of a tower have two joints. The top block and the blocks beside the tower have one."""
    tower = [box(f"tower {k}", (0.0, 0.0, float(k)), (1.0, 1.0, k + 1.0)) for k in range(5)]
    others = [box(f"other {k}", (2.0 * k + 2.0, 0.0, 0.0), (2.0 * k + 3.0, 1.0, 1.0)) for k in range(beside)]
    scene = build(box("ground", (0.0, 0.0, -1.0), (9.0, 1.0, 0.0), "support"), *tower, *others)
    assert len(thrust_line(assemble(scene))) == found


def test_friction_that_dissipates_nothing_has_no_figure(tmp_path: Path) -> None:
    results = Results(analyse(scene_of(tmp_path, SCENES["plane"])))
    assert "dissipation" in scene_figures(results) and "dissipation" not in report_figures(results)
    assert all(figure().get_suptitle() == "" for name, figure in report_figures(results).items() if name in ("assembly", "forces"))


@pytest.mark.parametrize("name", ["wall_third", "corner_settling_end"])
def test_the_legend_of_a_mechanism_names_marks_of_joints_where_they_are_drawn(name: str) -> None:
    """In the large structure in space, blocks hide the middle of every joint, so no joint has a mark."""
    assembly = assemble(shipped(name))
    motion = np.where(assembly.blocks.free[:, None], [0.0, 0.0, -1.0, 0.0, 0.0, 0.0], 0.0)
    states = np.full(len(assembly.interfaces), ContactState.SLIDING)
    figure = structure.mechanism_figure(assembly, {"LA": motion}, joints={"LA": states})
    is_drawn = any(line.get_marker() == structure.SLIDES["marker"] for line in figure.axes[0].lines)
    assert is_drawn == (name == "wall_third")
    assert ("joint slides" in [text.get_text() for text in figure.legends[0].get_texts()]) == is_drawn
