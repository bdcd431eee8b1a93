"""The figure of the reaction shows every value and curve that is known, and names each of them once."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from figure_scenes import SCENES, scene_of, synthetic_run

from comparison.figures import reaction as plot_reaction
from comparison.figures import reaction_figure, save
from comparison.figures.reaction_levels import at_joints_of_yade
from comparison.yade import Results
from la_core.analysis.result import LimitAnalysis
from la_core.analysis.stage import analyse
from la_core.coulomb.equilibrium_path import EquilibriumPath
from la_core.limit.associated import Status
from la_core.limit.problem import Drive


def test_a_greatest_reaction_far_above_is_named_and_not_drawn(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    whole, close = reaction_figure(Results(analysis, synthetic_run(analysis))).axes
    greatest, least = (1e-3 * analysis.bounds[drive].value for drive in (Drive.PUSHING, Drive.YIELDING))  # kN
    assert close.get_ylim()[1] < greatest
    assert "lies above" in close.get_title(loc="right")
    assert close.get_ylim()[0] < least < close.get_ylim()[1]
    assert whole.get_ylim()[1] > least + 0.4e-3 * scene.weight


@pytest.mark.parametrize(("status", "is_drawn"), [(Status.UNBOUNDED, True), (Status.FAILED, False)])
def test_a_greatest_reaction_that_is_unknown_is_not_drawn_as_unlimited(status: Status, is_drawn: bool, tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES["plane"]))
    lost = replace(analysis.bounds[Drive.PUSHING], status=status, value=np.nan)
    answers = replace(analysis.at_inset, bounds={**analysis.bounds, Drive.PUSHING: lost})
    figure = reaction_figure(Results(replace(analysis, at_inset=answers), synthetic_run(analysis)))
    words = " ".join(text.get_text() for axes in figure.axes for text in axes.texts)
    titles = " ".join(axes.get_title(loc="right") for axes in figure.axes)
    assert ("admissible" in words) is is_drawn
    assert ("is unknown" in titles) is not is_drawn


def test_a_run_without_plateau_has_no_line(tmp_path: Path) -> None:
    scene = scene_of(tmp_path, SCENES["plane"])
    analysis = analyse(scene)
    run = synthetic_run(analysis, status="no plateau", reaction=np.nan, uncertainty=np.nan, slope=np.nan, plateau_start=np.nan)
    (axes,) = reaction_figure(Results(analysis, run)).axes
    assert "no plateau" in axes.get_title(loc="left")
    assert not any("fitted" in str(line.get_label()) for line in axes.get_lines())


def test_a_run_that_collapsed_before_it_settled_leaves_no_empty_axes(tmp_path: Path) -> None:
    """The empty axes once had ticks of 1e-5 kN and of 1e-5 over W."""
    scene = scene_of(tmp_path, SCENES["falling"])
    analysis = analyse(scene)
    run = synthetic_run(analysis, status="collapsed", reaction=np.nan, uncertainty=np.nan, slope=np.nan, plateau_start=np.nan)
    run = replace(run, record=replace(run.record, stage=np.zeros(200, dtype=int)))
    figure = reaction_figure(Results(analysis, run))
    words = " ".join(text.get_text() for text in figure.texts)
    assert not figure.axes and "YADE ended as: collapsed" in words and "cannot stand" in words


CURVELESS: dict[str, Any] = {"path_settlement": np.zeros(0), "path_value": np.zeros(0)}


def frictional(analysis: LimitAnalysis, share: tuple[float, float], value: float = 1.1) -> LimitAnalysis:
    """Return the analysis with a short path and a Coulomb value without curve. value, share: value and interval over the least reaction."""
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
    ("released", "stated", "is_drawn"),
    [(1.05, 1e-3, True), (0.9, 1e-3, True), (1.0, 1e-3, False), (1.05, 0.1, False), (np.nan, np.nan, False)],
)
def test_the_value_after_a_release_is_a_level_where_it_is_another_one(
    released: float, stated: float, is_drawn: bool, tmp_path: Path
) -> None:
    """A change within its uncertainty is no level of its own. released, stated: released value and uncertainty, over the prediction."""
    analysis = frictional(analyse(scene_of(tmp_path, SCENES["plane"])), (0.9, 1.3))
    coulomb = analysis.coulomb
    assert coulomb is not None
    coulomb = replace(coulomb, uncertainty=0.0, released=released * coulomb.value, released_uncertainty=stated * coulomb.value)
    analysis = replace(analysis, at_inset=replace(analysis.at_inset, coulomb=coulomb))
    figure = reaction_figure(Results(analysis, synthetic_run(analysis)))
    levels = [line for axes in figure.axes for line in axes.get_lines() if line.get_label() == plot_reaction.RELEASED]
    assert len(levels) == (len(figure.axes) if is_drawn else 0)
    assert all(line.get_ydata()[0] == pytest.approx(1e-3 * coulomb.released) for line in levels)
    keys = {text.get_text() for legend in figure.legends for text in legend.get_texts()}
    labels = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert (plot_reaction.RELEASED in keys or any("after turning blocks released" in label for label in labels)) == is_drawn


@pytest.mark.slow_after_first
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
        r"$R_{\min}$ of sharp edges": "sharp edges: 0.32700 kN",  # W / 6
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


@pytest.mark.slow_after_first
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


def followed(analysis: LimitAnalysis) -> LimitAnalysis:
    """Return the analysis with the prediction's curve over 16 travels, which falls along a line from three times the value to the value."""
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


def test_a_bound_that_is_the_prediction_has_its_uncertainty(tmp_path: Path) -> None:
    analysis = frictional(analyse(scene_of(tmp_path, SCENES["plane"])), (1.0, 1.0), value=1.0)
    assert analysis.coulomb is not None
    analysis = replace(analysis, at_inset=replace(analysis.at_inset, coulomb=replace(analysis.coulomb, uncertainty=3.0)))
    words = [text.get_text() for axes in reaction_figure(Results(analysis)).axes for text in axes.texts]
    assert "$R_{\\min}$, associated, and Coulomb prediction: 0.330 ± 0.003 kN" in words


@pytest.mark.parametrize(("kind", "motion"), [("turning", "rotation"), ("live", "displacement")])
def test_curves_on_stiffer_joints_name_the_motion_of_their_axis(kind: str, motion: str, tmp_path: Path) -> None:
    analysis = analyse(scene_of(tmp_path, SCENES[kind]))
    run = replace(
        synthetic_run(analyse(scene_of(tmp_path, SCENES["plane"]))), settings={"normal_stiffness": 4.0 * analysis.stiffness.normal}
    )
    assert at_joints_of_yade(Results(analysis, run)) == f"\nat the {motion} of YADE's joints (4 times as stiff)"


@pytest.mark.parametrize(("times", "told"), [(1.0, ""), (32.0, "\nat the settlement of YADE's joints (32 times as stiff)")])
def test_curves_say_where_they_are_drawn_at_the_settlement_of_stiffer_joints(times: float, told: str, tmp_path: Path) -> None:
    analysis = followed(analyse(scene_of(tmp_path, SCENES["plane"])))
    analysis = replace(analysis, path=frictional(analysis, (1.0, 1.3)).path)
    run = replace(synthetic_run(analysis), settings={"normal_stiffness": times * analysis.stiffness.normal})
    figure = reaction_figure(Results(analysis, run))
    keys = [text.get_text() for text in figure.legends[0].get_texts()]
    assert {plot_reaction.CURVE + told, plot_reaction.PATH + told} <= set(keys)


def test_the_legend_is_no_wider_than_the_figure(tmp_path: Path) -> None:
    """A legend of four columns with a narrow interval, curves and their largest difference on stiffer joints was cut off at both sides."""
    analysis = followed(analyse(scene_of(tmp_path, SCENES["plane"])))
    assert analysis.coulomb is not None
    value = analysis.coulomb.value
    narrow = replace(analysis.coulomb, interval=(0.999 * value, 1.001 * value))
    path = frictional(analysis, (1.0, 1.3)).path
    analysis = replace(analysis, at_inset=replace(analysis.at_inset, coulomb=narrow), path=path)
    run = replace(synthetic_run(analysis), settings={"normal_stiffness": 32.0 * analysis.stiffness.normal})
    figure = reaction_figure(Results(analysis, run))
    figure.draw_without_rendering()
    (legend,) = figure.legends
    keys = " ".join(text.get_text() for text in legend.get_texts())
    assert plot_reaction.APART in keys and plot_reaction.HISTORY in keys
    drawn = legend.get_window_extent()
    assert figure.bbox.x0 <= drawn.x0 and drawn.x1 <= figure.bbox.x1


def test_the_mark_of_the_largest_difference_ends_on_the_record_of_a_structure_that_sways_back(tmp_path: Path) -> None:
    """Under a live load the recorded displacements may fall for a while, and values between rows have no order then."""
    analysis = followed(analyse(scene_of(tmp_path, SCENES["plane"])))
    run = replace(synthetic_run(analysis), settings={"normal_stiffness": analysis.stiffness.normal})
    settlement, reaction = run.record.settlement.copy(), run.record.reaction.copy()
    settlement[120:160] = settlement[120:160][::-1]
    reaction[140] *= 10.0  # the largest difference, in a row with smaller displacements behind it
    results = Results(analysis, replace(run, record=replace(run.record, settlement=settlement, reaction=reaction)))
    marks = [
        line for axes in reaction_figure(results).axes for line in axes.get_lines() if str(line.get_label()).startswith(plot_reaction.APART)
    ]
    assert marks and all(np.isclose(np.asarray(mark.get_ydata()), 1e-3 * reaction[140]).any() for mark in marks)
