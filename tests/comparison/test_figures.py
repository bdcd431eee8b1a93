"""Laws of the figures: drawn for every kind of scene, the same twice, every line named once, words off each other."""

import re
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text
from runs import made_up_run
from scenes import shipped

from comparison.figures import canvas as drawing
from comparison.figures import reaction as plot_reaction
from comparison.figures import reaction_figure, report_figures, save, scene_figures, structure
from comparison.figures.animation import Story
from comparison.figures.dissipation import dissipation_figure
from comparison.figures.drawing_order import back_to_front
from comparison.figures.forces import forces_figure
from comparison.figures.line_labels import ROW, Word, write_words
from comparison.figures.motion import drawn_motion, motions, shown_joints
from comparison.yade import Results
from comparison.yade.run_record import Run
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb.equilibrium_path import EquilibriumPath
from la_core.limit.problem import Drive
from la_core.measures import ContactState, joint_forces, measure, thrust_line
from la_core.model.assembly import assemble
from la_core.scene.scene import Scene, load_scene
from la_core.scene.variants import variant

HEAD = """
title = "{title}"
[stone]
density = 2000.0
[joint]
friction = 0.6
"""
PADS = """
[[block]]
name = "fixed $\\\\frac$ <pad>"
role = "fixed"
box = { from = [0.0, 0.0, -0.1], to = [0.4, 0.2, 0.0] }
[[block]]
name = "settling"
role = "support"
box = { from = [0.5, 0.0, -0.1], to = [1.0, 0.2, 0.0] }
"""
BLOCK = """
[[block]]
name = "block"
box = { from = [0.0, 0.0, 0.0], to = [1.0, 0.2, 0.5] }
"""
NARROW = BLOCK.replace("0.2, 0.5]", "0.15, 0.5]")
OVERHANG = """
[[block]]
name = "overhang"
box = { from = [0.9, 0.0, 0.0], to = [1.9, 0.2, 0.5] }
[[block]]
name = "stands"
box = { from = [0.0, 0.0, 0.0], to = [0.4, 0.2, 0.5] }
"""
DOWN = "[settlement]\ndirection = [0.0, 0.0, -1.0]\n"
TURN = "[settlement]\naxis = [0.0, 1.0, 0.0]\npoint = [0.5, 0.0, 0.0]\n"
LIVE = "[live]\ndirection = [1.0, 0.0, 0.0]\n"
TITLE = r"Costs $5 and $\badmacro"
FRAME = 4  # pixels, more than the width of an axes' frame
SCENES = {
    "plane": PADS + BLOCK + DOWN,
    "solid": PADS + NARROW + DOWN,
    "turning": PADS + BLOCK + TURN,
    "falling": PADS + OVERHANG + DOWN,
    "live": PADS.replace('"support"', '"fixed"') + BLOCK + LIVE,
}


def scene_of(folder: Path, body: str, title: str = "A scene") -> Scene:
    path = folder / "scene.toml"
    path.write_text(HEAD.format(title=title) + body, encoding="utf-8")
    return load_scene(path)


def synthetic_run(analysis: LimitAnalysis, **result: Any) -> Run:
    """A record that falls from rest to a plateau 1 % of the weight above the least reaction, with the associated mechanism."""
    least = analysis.bounds[Drive.YIELDING]
    weight = analysis.assembly.weight
    settlement = np.linspace(0.0, 4e-4, 200)
    plateau = least.value + 0.01 * weight
    reaction = plateau + 0.4 * weight * np.exp(-settlement / 3e-5)
    record = {"stage": np.ones(200, dtype=int), "settlement": settlement, "reaction": reaction}
    poses = {
        "settlement": settlement[::20],
        "displacement": settlement[::20, None, None] * least.twists[None, :, :3],
        "rotation": settlement[::20, None, None] * least.twists[None, :, 3:],
    }
    known = {"status": "plateau", "reaction": plateau, "uncertainty": 2.0, "plateau_start": 2e-4, "slope": 0.0, "message": "settled"}
    return made_up_run({**known, **result}, record, poses)


def has_ink(path: Path, figure: Figure, axes: Axes) -> bool:
    """Whether the picture is of more than one colour within the axes' own frame."""
    pixels = imread(path)
    height, width = pixels.shape[:2]
    frame = axes.get_position().bounds
    left, below, wide, high = (share * size for share, size in zip(frame, (width, height) * 2, strict=True))
    inside = pixels[int(height - below - high) + FRAME : int(height - below) - FRAME, int(left) + FRAME : int(left + wide) - FRAME]
    return len(np.unique(inside.reshape(-1, inside.shape[-1]), axis=0)) > 1


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


def test_the_line_of_thrust_goes_through_an_arch_and_not_through_a_wall(tmp_path: Path) -> None:
    arch, wall = (analyse(shipped(name)).assembly for name in ("arch_spreading", "two_blocks"))
    pairs = thrust_line(arch)
    assert len(pairs) == 11 and set(pairs.ravel().tolist()) == set(range(12))  # every voussoir, from springer to springer
    assert len(thrust_line(wall)) == 0


def test_friction_that_dissipates_nothing_has_no_figure(tmp_path: Path) -> None:
    results = Results(analyse(scene_of(tmp_path, SCENES["plane"])))
    assert "dissipation" in scene_figures(results) and "dissipation" not in report_figures(results)
    assert all(figure().get_suptitle() == "" for name, figure in report_figures(results).items() if name in ("assembly", "forces"))


def test_nearer_blocks_are_drawn_over_those_they_rest_on(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["solid"]))
    canvas = drawing.canvases(structure.Figure(), analysis.assembly, 1)[0]
    # Seen from above, the block hides its pads, although its centroid is not nearer than the right pad's.
    assert list(canvas.order).index(2) == 2


def test_points_inside_a_thick_wall_are_hidden(tmp_path: Path) -> None:
    wall = """
[[wall]]
bond = "stack"
origin = [0.0, 0.0, 0.0]
block = [0.5, 0.5, 0.5]
per_course = 5
courses = 5
[[wall]]
name = "behind"
bond = "stack"
origin = [0.0, 0.5, 0.0]
block = [0.5, 0.5, 0.5]
per_course = 5
courses = 5
[[block]]
name = "ground"
role = "fixed"
box = { from = [0.0, 0.0, -0.5], to = [1.5, 1.0, 0.0] }
[[block]]
name = "yields"
role = "support"
box = { from = [1.5, 0.0, -0.5], to = [2.5, 1.0, 0.0] }
"""
    analysis = analyse(scene_of(tmp_path, wall + DOWN + "[effects]\nplane = false\n"))
    canvas = drawing.canvases(structure.Figure(), analysis.assembly, 1)[0]
    assert list(canvas.seen(np.array([[1.0, 0.001, 1.0], [1.0, 0.5, 1.0], [2.499, 0.5, 1.0], [1.0, 0.999, 1.0]]))) == [
        True,
        False,
        True,
        False,
    ]


def test_a_greatest_reaction_far_above_is_named_and_not_drawn(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    whole, close = reaction_figure(Results(analysis, synthetic_run(analysis))).axes
    greatest, least = (1e-3 * analysis.bounds[drive].value for drive in (Drive.PUSHING, Drive.YIELDING))  # kN
    assert close.get_ylim()[1] < greatest
    assert "lies above" in close.get_title(loc="right")
    assert close.get_ylim()[0] < least < close.get_ylim()[1]
    assert whole.get_ylim()[1] > least + 0.4e-3 * scene.weight


def test_a_run_without_plateau_has_no_line(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    run = synthetic_run(analysis, status="no plateau", reaction=np.nan, uncertainty=np.nan, slope=np.nan, plateau_start=np.nan)
    (axes,) = reaction_figure(Results(analysis, run)).axes
    assert "no plateau" in axes.get_title(loc="left")
    assert not any("fitted" in str(line.get_label()) for line in axes.get_lines())


CURVELESS: dict[str, Any] = {"path_settlement": np.zeros(0), "path_value": np.zeros(0)}


def frictional(analysis: LimitAnalysis, share: tuple[float, float], value: float = 1.1) -> LimitAnalysis:
    """The analysis with a Coulomb value of so many times the least reaction, its interval likewise, and no curve; and a short path."""
    assert analysis.coulomb is not None
    least = analysis.bounds[analysis.main].value
    coulomb = replace(analysis.coulomb, value=value * least, interval=(share[0] * least, share[1] * least), **CURVELESS)
    settlement = np.linspace(0.0, 8e-4, 9)
    path = EquilibriumPath(
        settlement, least * (value + 2.0 * np.exp(-settlement / 3e-5)), np.zeros(9), np.ones(9, bool), np.ones(9, int), 0.1
    )
    return replace(analysis, at_inset=replace(analysis.at_inset, coulomb=coulomb), path=path)


def labels_of(axes: Any) -> dict[str, Any]:
    return {label: handle for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}


@pytest.mark.parametrize(
    ("share", "drawn"),
    [
        ((1.0, 1.3), True), ((1.0, np.inf), True), ((-np.inf, 1.3), True), ((1.1, 1.1 + 1e-6), False), ((np.nan, 1.3), False),
        ((1.0, np.nan), False),
    ],
)  # fmt: skip
def test_an_interval_is_a_band_unless_it_is_a_point_or_unknown(share: tuple[float, float], drawn: bool, tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), share)
    figure = reaction_figure(Results(analysis, synthetic_run(analysis)))
    save(figure, tmp_path / "reaction.png")
    least = 1e-3 * analysis.bounds[Drive.YIELDING].value  # kN
    for axes in figure.axes:
        band = labels_of(axes).get(plot_reaction.HISTORY)
        assert (band is not None) == drawn
        assert plot_reaction.COULOMB in labels_of(axes)
        if band is not None:
            seen = np.clip([band.get_y(), band.get_y() + band.get_height()], *axes.get_ylim())
            assert seen == pytest.approx(np.clip(np.array(share) * least, *axes.get_ylim()))


def test_everything_drawn_is_named_once_beside_its_line_or_in_the_legend(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), (1.0, 1.3))
    figure = reaction_figure(Results(analysis, synthetic_run(analysis)))
    keys = [text.get_text() for text in figure.legends[0].get_texts()]
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    beside = {
        plot_reaction.LEAST: "$R_{\\min}$, associated: 0.33027 kN",
        plot_reaction.COULOMB: "Coulomb prediction: 0.36330 kN",
        plot_reaction.HISTORY: "value depends on friction's history",
        plot_reaction.FITTED: "YADE's plateau: 0.350 ± 0.002 kN",
        plot_reaction.GREATEST: "$R_{\\max}$, associated: 1.9581 kN",
        r"$R_{\min}$ of sharp arrises": "sharp arrises: 0.32700 kN",  # W / 6
        plot_reaction.ADMISSIBLE: "admissible",
    }
    for label in {label for axes in figure.axes for label in labels_of(axes)}:
        shown = any(beside[label] in word for word in words) if label in beside else False
        assert shown != (label in keys), label
    assert {plot_reaction.LEAST, plot_reaction.COULOMB, plot_reaction.HISTORY, plot_reaction.FITTED}.isdisjoint(keys)


def test_a_prediction_that_is_the_bound_shares_its_words(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), (1.0, 1.0), value=1.0)
    figure = reaction_figure(Results(analysis))
    words = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert any("associated, and Coulomb prediction" in word for word in words)
    assert not any(word.startswith("Coulomb prediction") for word in words)


@pytest.mark.parametrize("kind", ["plane", "live"])
@pytest.mark.parametrize("known", [(), ("coulomb",), ("path",), ("coulomb", "path")])
def test_what_limit_analysis_has_is_drawn_without_a_run(kind: str, known: tuple[str, ...], tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES[kind])
    analysis = frictional(analyse(scene), (1.0, 1.3))
    if "coulomb" not in known:
        analysis = replace(analysis, at_inset=replace(analysis.at_inset, coulomb=None))
    if "path" not in known:
        analysis = replace(analysis, path=None)
    figure = reaction_figure(Results(analysis))
    save(figure, tmp_path / "reaction.png")
    assert len(figure.axes) == (2 if "path" in known else 1)
    for axes in figure.axes:
        assert (plot_reaction.COULOMB in labels_of(axes)) == ("coulomb" in known)
        assert any("path" in label for label in labels_of(axes)) == ("path" in known)
    assert figure.axes[0].get_xlabel().startswith("mean displacement" if kind == "live" else "settlement")
    if "path" in known:
        assert figure.axes[0].get_xlabel().endswith("(mm)")
        assert figure.axes[0].get_ylim()[0] < 0.0 < analysis.path.value.max() < 1e3 * figure.axes[0].get_ylim()[1]  # type: ignore[union-attr]


@pytest.mark.parametrize("kind", ["live", "tilt"])
def test_a_tilt_has_its_own_words(kind: str, tmp_path: Path) -> None:
    """The figures of a tilt speak of its angle, those of a live load of that load."""
    text = SCENES["live"]
    assert LIVE in text
    scene = scene_of(tmp_path, text.replace(LIVE, "[tilt]\naxis = [0.0, 1.0, 0.0]\n") if kind == "tilt" else text)
    figures = {name: draw() for name, draw in scene_figures(Results(analyse(scene))).items()}
    words = {name: " ".join(text.get_text() for text in figure.findobj(Text)) for name, figure in figures.items()}
    assert all(("live load" in words[name]) == (kind == "live") for name in ("assembly", "reaction"))
    axes = figures["reaction"].axes[0]
    assert axes.get_ylabel() == ("tangent of the tilt angle" if kind == "tilt" else "multiplier of the live load")
    second = [axis.get_ylabel() for axis in axes.child_axes]
    assert second == (["tilt angle (degrees)"] if kind == "tilt" else [])
    if kind == "tilt":
        figures["reaction"].draw_without_rendering()
        low, high = axes.child_axes[0].get_ylim()
        assert np.tan(np.radians([low, high])) == pytest.approx(axes.get_ylim())


@pytest.mark.parametrize(
    ("push", "expected"), [("live load", "unit power of the live load"), ("push of the tilt", "unit power of the push of the tilt")]
)
def test_the_power_of_friction_is_told_per_power_of_what_pushes(push: str, expected: str, tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["live"].replace("friction = 0.6", "friction = 0.2")))
    bound = analysis.bounds[Drive.LIVE]
    measures = measure(analysis.assembly, bound.twists, bound.forces)
    assert measures.dissipated_power > 0.0
    figure = dissipation_figure(analysis.assembly, bound.twists, measures, push=push)
    figure.draw_without_rendering()
    assert sum(expected in text.get_text() for text in figure.findobj(Text)) == 2


def followed(analysis: LimitAnalysis) -> LimitAnalysis:
    """The analysis with a prediction's curve over 16 travels, which falls from three times its value to it along a line."""
    analysis = replace(frictional(analysis, (1.0, 1.3)), path=None)
    assert analysis.coulomb is not None
    travel, value = analysis.stiffness.travel, analysis.coulomb.value
    settlement = travel * np.array([0.0, 0.5, 16.0])
    curve = {"path_settlement": settlement, "path_value": value * np.array([3.0, 1.0, 1.0])}
    coulomb = replace(analysis.coulomb, uncertainty=3.0, plateaus=np.array([value, 2.0 * value]), **curve)
    return replace(analysis, at_inset=replace(analysis.at_inset, coulomb=coulomb))


@pytest.mark.parametrize("with_run", [False, True])
def test_the_curve_of_the_prediction_is_drawn_as_far_as_yade_went_or_over_its_first_travel(with_run: bool, tmp_path: Path) -> None:
    analysis = followed(analyse(scene_of(tmp_path, SCENES["plane"])))
    assert analysis.coulomb is not None
    run = synthetic_run(analysis) if with_run else None
    figure = reaction_figure(Results(analysis, run))
    save(figure, tmp_path / "reaction.png")
    travel, value = 1e3 * analysis.stiffness.travel, 1e-3 * analysis.coulomb.value
    end = 1e3 * run.settling("settlement").max() if run is not None else travel
    assert len(figure.axes) == 2
    for axes in figure.axes:
        at, values = labels_of(axes)[plot_reaction.CURVE].get_data()
        assert at[-1] == pytest.approx(end) and len(at) == len(values)
        assert values[-1] == pytest.approx(np.interp(end, [0.0, 0.5 * travel], [3.0 * value, value]))
    low, high = figure.axes[0].get_ylim()
    assert low < 0.0 and high > 3.0 * value


def test_the_prediction_s_label_says_its_uncertainty_and_every_plateau(tmp_path: Path) -> None:
    analysis = followed(analyse(scene_of(tmp_path, SCENES["plane"])))
    words = "".join(text.get_text() for axes in reaction_figure(Results(analysis)).axes for text in axes.texts)
    assert "Coulomb prediction: 0.363 ± 0.003 kN\nseveral plateaus: 0.3633, 0.7266 kN" in words


def test_an_interval_that_dwarfs_the_plateau_does_not_set_its_scale(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = frictional(analyse(scene), (1.0, 5.0))
    close = reaction_figure(Results(analysis, synthetic_run(analysis))).axes[1]
    assert close.get_ylim()[1] < 1.5 * analysis.bounds[Drive.YIELDING].value


def test_words_keep_off_lines_and_each_other() -> None:
    axes = structure.Figure().subplots()
    axes.set_ylim(0.0, 1.0)

    def word(low: float, high: float, name: str) -> Word:
        return Word(low, high, name, "black", (name,))

    # Words for "two" fit below it only, for "one" nowhere; the band's stand in its widest gap.
    lines = [word(0.5, 0.5, "three"), word(0.5 - 0.2 * ROW, 0.5 - 0.2 * ROW, "one"), word(0.5 - 0.4 * ROW, 0.5 - 0.4 * ROW, "two")]
    narrow = word(0.9, 0.9 + 0.9 * ROW, "narrow")
    assert write_words(axes, [*lines, word(0.0, 0.5, "band"), narrow], (0.0, 1.0)) == {"three", "two", "band"}
    at = {text.get_text(): text.xy[1] for text in axes.texts}
    assert at["three"] == 0.5
    assert at["band"] == pytest.approx((0.5 - 1.4 * ROW) / 2.0)
    # The words of the upper line stand below it, for above is no room, and there those of the lower line may not be.
    axes = structure.Figure().subplots()
    upper, lower = 1.0 - 0.5 * ROW, 1.0 - 2.0 * ROW
    assert write_words(axes, [word(upper, upper, "upper"), word(lower, lower, "lower")], (0.0, 1.0)) == {"upper", "lower"}
    assert [text.get_va() for text in axes.texts] == ["top", "top"]


def test_labels_of_an_animation_cover_neither_each_other_nor_the_frame() -> None:
    """At mu = 0.3 both bounds lie close to the prediction."""
    story = Story(Results(analyse(variant(shipped("two_blocks"), {"joint.friction": 0.3}))))
    renderer = story.figure.canvas.get_renderer()  # type: ignore[attr-defined]
    below = story.line.axes
    frame = below.get_window_extent(renderer)
    boxes = [text.get_window_extent(renderer) for text in below.texts if text.get_text()]
    assert boxes and all(frame.y0 <= box.y0 and box.y1 <= frame.y1 for box in boxes)
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))


def test_blocks_set_aside_are_drawn_behind_those_that_stand_before_them() -> None:
    """Here all blocks are set aside: the model has no interfaces, and the order comes from the boxes."""
    whole, toward = assemble(shipped("corner_settling_end")), np.array([0.3, -0.8, 0.5])
    none = whole.interfaces.subset(np.zeros(len(whole.interfaces), dtype=bool))
    rank = np.argsort(back_to_front(replace(whole, aside=np.ones(len(whole.blocks), dtype=bool), interfaces=none), toward))
    facing = whole.interfaces.normal @ toward > 0.0
    a, b = whole.interfaces.block_a, whole.interfaces.block_b
    assert np.all(rank[np.where(facing, a, b)] < rank[np.where(facing, b, a)])
