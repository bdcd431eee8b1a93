"""Words in figures name the load, and cover neither lines, nor frames, nor each other."""

from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from figure_scenes import DOWN, LIVE, SCENES, scene_of, synthetic_run
from matplotlib.text import Text
from scenes import base, box, build, shipped

import la_core
from comparison.figures import canvas as drawing
from comparison.figures import motions, reaction_figure, scene_figures, structure
from comparison.figures.animation import Story
from comparison.figures.dissipation import dissipation_figure
from comparison.figures.line_labels import ROW, Word, write_words
from comparison.figures.save import DPI, rendered
from comparison.yade import Results
from la_core.analysis.stage import analyse
from la_core.limit.problem import Drive
from la_core.measures import ContactState, measure
from la_core.model.assembly import assemble
from la_core.scene.scene import load_scene
from la_core.scene.variants import variant


@pytest.mark.parametrize("kind", ["live", "tilt"])
def test_a_tilt_has_its_own_words(kind: str, tmp_path: Path) -> None:
    """The figures of a tilt name its angle. The figures of a live load name the load."""
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


@pytest.mark.parametrize(("level", "fits"), [(1.6 * ROW, False), (2.1 * ROW, True)])
def test_a_label_of_two_rows_needs_room_for_both(level: float, fits: bool) -> None:
    """Below its line the label would reach the axis, and another line leaves no room above."""
    axes = structure.Figure().subplots()
    two_rows = Word(level, level, "prediction\nseveral plateaus", "black", ("prediction",))
    assert write_words(axes, [two_rows], (0.0, 1.0), other=[level + 1.5 * ROW]) == ({"prediction"} if fits else set())


def test_words_keep_off_lines_and_each_other() -> None:
    axes = structure.Figure().subplots()
    axes.set_ylim(0.0, 1.0)

    def word(low: float, high: float, name: str) -> Word:
        return Word(low, high, name, "black", (name,))

    # The words of the line "two" fit below it only, and those of "one" nowhere. The words of the band stand in its widest gap.
    lines = [word(0.5, 0.5, "three"), word(0.5 - 0.2 * ROW, 0.5 - 0.2 * ROW, "one"), word(0.5 - 0.4 * ROW, 0.5 - 0.4 * ROW, "two")]
    narrow = word(0.9, 0.9 + 0.9 * ROW, "narrow")
    assert write_words(axes, [*lines, word(0.0, 0.5, "band"), narrow], (0.0, 1.0)) == {"three", "two", "band"}
    at = {text.get_text(): text.xy[1] for text in axes.texts}
    assert at["three"] == 0.5
    assert at["band"] == pytest.approx((0.5 - 1.4 * ROW) / 2.0)
    # Without room above, the words of the upper line stand below it. The words of the lower line must keep clear of them.
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


def test_an_animation_under_a_live_load_tells_the_multiplier(tmp_path: Path) -> None:
    analysis, settling = (analyse(scene_of(tmp_path, SCENES[kind])) for kind in ("live", "plane"))
    run = synthetic_run(settling)
    forces = np.zeros((len(run.poses.settlement), len(analysis.assembly.points), 3))
    story = Story(Results(analysis, replace(run, poses=replace(run.poses, forces=forces))))
    story.draw(1.0)
    assert "; YADE's multiplier = " in story.reading.get_text()


def test_figures_give_the_lengths_of_a_run_in_mm(tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    run = synthetic_run(analysis, status="collapsed", message="a block has moved 0.000801 m under gravity alone")
    forces = np.zeros((len(run.poses.settlement), len(analysis.assembly.points), 3))
    run = replace(run, poses=replace(run.poses, displacement=np.nan * run.poses.displacement, forces=forces))
    words = " ".join(text.get_text() for text in scene_figures(Results(analysis, run))["mechanisms"]().findobj(Text))
    assert "collapsed: a block has moved 0.801 mm under" in words
    assert motions(Results(analysis, run)).methods[1].reason == "collapsed: a block has moved 0.801 mm under gravity alone"


def test_figures_of_a_large_structure_have_no_powers_of_ten(tmp_path: Path) -> None:
    """The figures of a pier of 30 m once had a support motion of 2.7e+03 mm and R_max = 5.472e+04 kN."""
    large = "".join(
        f'[[block]]\nname = "{name}"\nrole = "{role}"\nbox = {{ from = [{left}, 0.0, {low}], to = [{right}, 20.0, {top}] }}\n'
        for name, role, left, right, low, top in (
            ("fixed", "fixed", 0.0, 12.0, -3.0, 0.0), ("pad", "support", 15.0, 30.0, -3.0, 0.0), ("pier", "free", 0.0, 30.0, 0.0, 20.0)
        )
    )  # fmt: skip
    analysis = analyse(scene_of(tmp_path, large + DOWN))
    figures = (reaction_figure(Results(analysis, synthetic_run(analysis))), scene_figures(Results(analysis))["mechanisms"]())
    words = [text.get_text() for figure in figures for text in figure.findobj(Text)]
    assert any("lies above" in word for word in words) and any("a support motion of" in word for word in words)
    assert not [word for word in words if "e+" in word]


@pytest.mark.parametrize("shift", [(0.0, 0.0, 0.0), (5.2e6, -4.5e5, 300.25)])
def test_numbers_of_the_axes_in_space_tell_apart_and_cover_nothing(shift: tuple[float, float, float]) -> None:
    """The coordinates of a survey were once all shown as 5.2e+06, and long numbers lay on the axis."""

    def moved(*corner: float) -> tuple[float, ...]:
        return tuple(np.add(corner, shift).tolist())

    ground = box("ground", moved(0.0, 0.0, -0.2), moved(1.0, 1.0, 0.0), "fixed")
    block = box("block", moved(0.0, 0.0, 0.0), moved(0.5, 0.9, 0.7))
    assembly = assemble(build(ground, block, live=(1.0, 0.0, 0.0), plane=False))
    figure = structure.Figure(figsize=(11.0, 9.0))
    figure.subplots_adjust(left=0.06, right=0.94, wspace=0.0)
    axes = drawing.canvases(figure, assembly, 2)[0].axes
    figure.draw_without_rendering()
    words = [text for text in axes.texts if text.get_text()]
    names = [words.index(text) for text in words if text.get_text().endswith("(m)")]
    by_axis = [words[start + 1 : end] for start, end in pairwise([-1, *names])]
    boxes = [[text.get_window_extent() for text in numbers] for numbers in by_axis]
    for numbers, of_axis in zip(by_axis, boxes, strict=True):
        assert 2 <= len(numbers) == len({text.get_text() for text in numbers})
        assert not any(one.overlaps(other) for one, other in combinations(of_axis, 2))
    corner = assembly.blocks.low.min(axis=0) - [0.03 * drawing.structure_size(assembly.blocks), 0.0, 0.0]
    axis = axes.transData.transform(np.stack(drawing.view_axes(plane=False)[:2]) @ corner)[0]
    name = words[names[2]].get_window_extent()
    assert all(name.x1 < number.x0 and number.x1 < axis for number in boxes[2])


def test_names_of_blocks_in_space_do_not_cover_each_other() -> None:
    scene = load_scene(Path(la_core.__file__).parent / "scene" / "starters" / "vault.toml")
    figure = structure.assembly_figure(scene, assemble(scene))
    figure.draw_without_rendering()
    boxes = [text.get_window_extent() for text in figure.axes[0].texts if text.get_text().startswith("vault")]
    assert len(boxes) > len(scene.blocks) / 2
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))


@pytest.mark.parametrize("width", [0.4, 1.2])
def test_long_names_of_blocks_keep_their_ends_and_cover_no_other_name(width: float) -> None:
    """The wall has a tie to an anchor beside it, for which the axes have room; the names are as small as the wall is drawn."""
    table = {"name": "northern abutment, outer face", "bond": "stack", "origin": (0, 0, 0), "block": (width, 0.4, 0.3), "per_course": 3}
    table |= {"courses": 5, "footing": {"height": 0.3, "settling": (2.0 * width, 3.0 * width)}}
    tie = {"blocks": ["northern abutment, outer face 4.1"], "from": (0.0, 0.2, 1.05), "to": (-0.9, 0.2, 0.9), "force": 100.0}
    scene = variant(shipped("two_pads"), {"wall": [table], "tie": [tie], "block": None})
    figure = structure.assembly_figure(scene, assemble(scene))
    figure.draw_without_rendering()
    names = [text for text in figure.axes[0].texts if text.get_text().startswith("…")]
    ends = [f"{course}.{k}" for course in range(1, 6) for k in range(1, 4)]
    assert sorted(text.get_text()[-3:] for text in names if "footing" not in text.get_text()[-9:]) == ends
    boxes = [text.get_window_extent() for text in names]
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    assert figure.axes[0].get_xlim()[0] < -0.9


def test_of_many_loads_the_largest_are_drawn_and_the_legend_gives_their_number() -> None:
    """Two of 60 loads are a hundred times as large as the others. Where all are equal, the arrows lie evenly."""
    pads = shipped("two_pads")
    for large in ([17, 44], []):
        loads = [
            {"blocks": ["block"], "at": (0.01 * k, 0.0, 0.4), "force": (0.0, 0.0, -1000.0 if k in large else -10.0)} for k in range(60)
        ]
        scene = variant(pads, {"load": loads})
        shown, start = drawing.load_arrows(scene.blocks, scene.loads.point, scene.loads.force)
        assert len(shown) == len(start) == drawing.MOST_LOADS and {*large} <= {*shown.tolist()}
        assert shown[0] == 0 and shown[-1] == 59 and np.diff(shown).max() <= 3
        (legend,) = structure.assembly_figure(scene, assemble(scene)).legends
        assert "dead load (40 of 60 drawn)" in [text.get_text() for text in legend.get_texts()]


def test_under_a_title_of_several_lines_the_label_of_the_axis_keeps_off_the_legend() -> None:
    load = {"blocks": ["beam"], "force": (0.0, 0.0, -500.0)}  # a seventh entry of the legend makes a second row
    title = {"title": " ".join(9 * ["a title of several lines"]), "load": [load]}
    scene = variant(build(*base(1.0, 2.0), box("beam", (0.0, 0.0, 0.0), (2.0, 1.0, 0.4))), title)
    figure = structure.assembly_figure(scene, assemble(scene))
    figure.set_dpi(DPI)
    figure.draw_without_rendering()  # once, as for a file
    axes, (legend,) = figure.axes[0], figure.legends
    assert figure.get_suptitle().count("\n") >= 2
    assert axes.xaxis.label.get_window_extent().y0 > legend.get_window_extent().y1


def test_an_arrow_of_a_load_is_seen_above_the_name_of_its_block() -> None:
    load = {"name": "roof", "blocks": ["block"], "force": [0.0, 0.0, -500.0]}
    scene = variant(shipped("two_pads"), {"load": [load]})
    axes = structure.assembly_figure(scene, assemble(scene)).axes[0]
    names = [text for text in axes.texts if text.get_text() == "block"]
    arrows = [text for text in axes.texts if getattr(text, "arrow_patch", None) is not None]
    assert (
        names
        and arrows
        and max(name.get_zorder() for name in names) < min(arrow.get_zorder() for arrow in arrows if arrow.xycoords == "data")
    )


def test_the_arrow_of_a_push_is_whole_and_lies_on_no_block() -> None:
    """The arrow lies neither on the name of a block nor on a joint that would hide it."""
    ground = box("ground", (-0.5, 0.0, -0.2), (1.0, 0.3, 0.0), "fixed")
    scene = build(ground, box("block", (0.0, 0.0, 0.0), (0.5, 0.3, 0.7)), live=(-1.0, 0.0, 0.0))
    axes = structure.assembly_figure(scene, assemble(scene)).axes[0]
    (push,) = (text for text in axes.texts if getattr(text, "arrow_patch", None) is not None and text.xycoords == "data")
    (end, height), start = push.xy, push.get_position()
    assert start == pytest.approx((0.0, 0.35)) and height == pytest.approx(0.35)
    assert axes.get_xlim()[0] < end < 0.0


def test_a_point_that_opens_is_seen_around_one_that_slides(tmp_path: Path) -> None:
    """Two joints that meet in a corner have contact points in one place. The cross of one joint lies within the circle of the other."""
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    solution = analysis.bounds[Drive.YIELDING]
    measures = measure(analysis.assembly, solution.twists, solution.forces)
    states = np.resize([ContactState.OPENING, ContactState.SLIDING], len(measures.states))
    figure = dissipation_figure(analysis.assembly, solution.twists, replace(measures, states=states))
    (circle,), (cross,) = ([line for line in figure.axes[0].lines if line.get_marker() == marker] for marker in ("o", "X"))
    assert circle.get_markersize() > np.sqrt(2.0) * cross.get_markersize()


@pytest.mark.parametrize("name", ["two_pads", "wall_third", "wall_tall"])
def test_a_long_reason_above_a_mechanism_keeps_off_the_heading(name: str) -> None:
    assembly = assemble(shipped(name))
    motion = np.where(assembly.blocks.free[:, None], [0.1, 0.0, -1.0, 0.0, 0.0, 0.0], 0.0)
    reasons = {"YADE": "collapsed: a block falls at 0.125 m/s after a settlement of 0.785 mm; YADE looked for new contacts"}
    figure = structure.mechanism_figure(assembly, {"LA": motion, "YADE": np.nan * motion}, "", reasons=reasons, travel=1e-3)
    words = [figure._suptitle, *(axes.title for axes in figure.axes), *(axes.xaxis.label for axes in figure.axes), *figure.legends]
    assert len(words) == 6
    drawn: list[list[Any]] = []
    figure.canvas.mpl_connect("draw_event", lambda event: drawn.append([word.get_window_extent(event.renderer) for word in words]))
    rendered(figure, ".png")
    assert not any(one.overlaps(other) for one, other in combinations(drawn[-1], 2))


@pytest.mark.slow_after_first
@pytest.mark.parametrize("suffix", [".png", ".svg"])
@pytest.mark.parametrize("name", ["assembly", "mechanisms", "dissipation"])
def test_a_figure_that_is_saved_again_is_the_same(name: str, suffix: str, tmp_path: Path) -> None:
    """The layout of a drawing begins with the layout of the drawing before, which must not change the figure."""
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    figure = scene_figures(Results(analysis))[name]()
    first = rendered(figure, suffix)
    assert [rendered(figure, suffix) for _ in range(3)] == [first] * 3
    assert rendered(scene_figures(Results(analysis))[name](), suffix) == first
    axes = figure.axes[0]
    axes.set_title("a title of\ntwo lines")
    assert rendered(figure, suffix) != first and axes.get_in_layout()
