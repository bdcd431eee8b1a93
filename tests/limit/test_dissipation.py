"""Measures of a mechanism and their figure: closed forms, the balance of power and invariance."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import scenes
from matplotlib.figure import Figure
from matplotlib.text import Text

from comparison.figures import save
from comparison.figures.dissipation import POWER, dissipation_figure
from la_core.limit.associated import Solution, Status, solve_associated
from la_core.limit.problem import Drive
from la_core.measures import dissipation, joint_states, mechanism
from la_core.measures.dissipation import ContactState, MechanismMeasures, measure, participation_index
from la_core.model.assembly import Assembly, assemble
from la_core.scene import shipped
from la_core.scene.scene import Scene

SOLVER = 1e-6  # relative: residual that la_core allows in an answer called solved
RIGID = 1e-6  # threshold for mechanisms of rigid blocks, whose only noise is the solver's
NAMES = [name for name in shipped.names() if name not in shipped.LONG and scenes.shipped(name).live is None]

SLIDER = (scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.5, 0.4)), scenes.box("base", (-1.0, 0.0, -0.2), (2.0, 0.5, 0.0), "fixed"))
OVERHANG = (scenes.box("overhang", (0.9, 0.0, 0.0), (1.9, 0.2, 0.5)), *scenes.base(0.4, 1.0, 0.2))


def side_by_side(friction: float, plane: bool | str = "auto") -> Scene:
    blocks = (scenes.box("stands", (0.0, 0.0, 0.0), (0.4, 0.2, 0.4)), scenes.box("settles", (0.4, 0.0, 0.0), (0.8, 0.2, 0.4)))
    return scenes.build(*blocks, *scenes.base(0.4, 0.8, 0.2), friction=friction, plane=plane)


def wall() -> Scene:
    return scenes.build(*scenes.wall(4, 4, split=0.8))


def solved(scene: Scene, drive: Drive = Drive.YIELDING) -> tuple[Assembly, Solution]:
    assembly = assemble(scene)
    solution = solve_associated(assembly, drive)
    assert solution.status is Status.SOLVED
    return assembly, solution


def measured(scene: Scene, drive: Drive = Drive.YIELDING) -> MechanismMeasures:
    assembly, solution = solved(scene, drive)
    return measure(assembly, solution.twists, solution.forces)


def dragged(friction: float) -> tuple[Assembly, np.ndarray, np.ndarray]:
    """A block that slides over its base at unit speed with Coulomb friction, without dilating. All points share its weight equally."""
    assembly = assemble(scenes.build(*SLIDER, friction=friction, live=(1.0, 0.0, 0.0)))
    twists = np.zeros((len(assembly.blocks), 6))
    twists[assembly.blocks.free, 0] = 1.0
    on_block = np.sign(assembly.normal[:, 2:]) * np.array([-friction, 0.0, 1.0])  # forces are on b, which may be the base
    return assembly, twists, on_block * assembly.weight / len(assembly.points)


# --- closed forms ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("plane", [True, False])
@pytest.mark.parametrize("friction", [0.3, 0.6, 0.9])
def test_two_blocks_side_by_side_dissipate_alike_in_both_joints_that_slide(friction: float, plane: bool) -> None:
    scene = side_by_side(friction, plane)
    assembly, solution = solved(scene)
    measures = measure(assembly, solution.twists, solution.forces)
    # The block sinks at 1/(1 + mu^2) and moves sideways at mu times that speed. It presses with W_b/(1 + mu^2) on its base and
    # with mu times that force on the head joint. Each joint dissipates mu n |u_t| = mu^2 W_b/(1 + mu^2)^2.
    each = friction**2 * (assembly.weight / 2.0) / (1.0 + friction**2) ** 2
    assert np.sort(measures.dissipation_per_interface) == pytest.approx([0.0, each, each], rel=SOLVER)
    assert measures.dissipated_power == pytest.approx(2.0 * each, rel=SOLVER)
    assert measures.dissipated_share == pytest.approx(2.0 * friction**2 / (1.0 + friction**2), rel=SOLVER)
    assert measures.participation_index == pytest.approx(2.0 / 3.0, rel=SOLVER)
    assert measures.moving_mass_share == pytest.approx(0.5)
    points = 2 if plane else 4
    assert (measures.opening, measures.sliding, measures.sticking + measures.idle) == (0, 2 * points, points)


@pytest.mark.parametrize("length", [1.0, 200.0])
def test_a_support_that_reaches_far_beyond_the_structure_does_not_make_its_blocks_seem_at_rest(length: float) -> None:
    """The right pad of a block turns about a point below the block. The end of a pad of 200 m moves some 250 times as fast as the block."""
    held = (
        scenes.box("fixed", (0.0, 0.0, -0.1), (0.4, 0.2, 0.0), "fixed"),
        scenes.box("turns", (0.5, 0.0, -0.1), (length, 0.2, 0.0), "support"),
    )
    about = {"axis": (0.0, 1.0, 0.0), "point": (0.4, 0.0, 0.0)}
    assembly, solution = solved(scenes.build(scenes.box("block", (0.0, 0.0, 0.0), (1.0, 0.2, 0.5)), *held, settlement=about))
    assert mechanism.fastest_speed(assembly, solution.twists) == pytest.approx(
        np.hypot(1.0 - 0.4, 0.5), rel=SOLVER
    )  # of the block's corner
    assert measure(assembly, solution.twists, solution.forces).moving_mass_share == 1.0


def test_two_blocks_that_pass_each_other_are_as_fast_as_either() -> None:
    stacked = (scenes.box("lower", (0.0, 0.0, 0.0), (1.0, 1.0, 0.5)), scenes.box("upper", (0.0, 0.0, 0.5), (1.0, 1.0, 1.0)))
    assembly = assemble(scenes.build(SLIDER[1], *stacked, friction=0.3, live=(1.0, 0.0, 0.0)))
    names = assembly.blocks.names
    twists = np.zeros((len(names), 6))
    twists[names.index("lower"), 0], twists[names.index("upper"), 0] = 1.0, -1.0
    assert mechanism.fastest_speed(assembly, twists) == pytest.approx(1.0)


def test_a_block_pushed_over_a_plane_dissipates_all_the_live_load_brings() -> None:
    assembly, solution = solved(scenes.build(*SLIDER, friction=0.3, live=(1.0, 0.0, 0.0)), Drive.LIVE)
    measures = measure(assembly, solution.twists, solution.forces)
    assert solution.value == pytest.approx(0.3, rel=SOLVER)
    assert measures.dissipated_power == pytest.approx(0.3, rel=SOLVER)  # mu W |u_t| with |u_t| = 1/W at unit power of the load
    assert measures.participation_index == pytest.approx(1.0)
    assert measures.sliding == len(assembly.points)
    assert np.isnan(measures.dissipated_share)  # the load does the work, not the weights


def test_real_friction_dissipates_without_dilating() -> None:
    assembly, twists, forces = dragged(0.3)
    measures = measure(assembly, twists, forces)
    assert measures.sliding == len(assembly.points)
    assert measures.dissipated_power == pytest.approx(0.3 * assembly.weight)


@pytest.mark.parametrize(("sinks", "exchanged"), [(0.2, 0.2), (-0.2, 0.2), (0.0, mechanism.LEAST_EXCHANGE)])
def test_friction_has_its_share_of_the_power_that_the_weights_exchange(sinks: float, exchanged: float) -> None:
    """The share is mu W |u_t| / (W |v_z|) for a sinking or rising block. For level motion, the divisor is the least power that counts."""
    assembly, twists, forces = dragged(0.3)
    twists[assembly.blocks.free, 2] = -sinks
    assert mechanism.friction_power(assembly, twists, forces) == pytest.approx(0.3 * assembly.weight)
    share = mechanism.sliding_share(assembly, twists, forces)
    assert share == pytest.approx(0.3 / exchanged)
    assert mechanism.sliding_share(assembly, -7.0 * twists, 5.0 * forces) == pytest.approx(5.0 * share)
    assert np.isnan(measure(assembly, twists, forces).dissipated_share)  # the load does the work, whether the weights sink or not


def test_no_friction_works_in_a_joint_in_tension_or_at_rest() -> None:
    assembly, twists, forces = dragged(0.3)
    assert mechanism.friction_power(assembly, twists, -forces) == 0.0
    assert mechanism.sliding_share(assembly, 0.0 * twists, forces) == 0.0


@pytest.mark.parametrize("count", [1, 2, 7, 169])
def test_participation_counts_the_interfaces_that_share_equally(count: int) -> None:
    interfaces = 169
    power = np.where(np.arange(interfaces) < count, 3.0, 0.0)
    assert participation_index(power) == pytest.approx(count / interfaces)
    assert participation_index(1e-200 * power) == pytest.approx(count / interfaces)


@pytest.mark.parametrize(("sinks", "known"), [(0.0, False), (1e-6, False), (0.2, True)])
def test_where_no_weight_sinks_there_is_no_share_of_its_work(sinks: float, known: bool) -> None:
    """A plate is drawn out from under a block that hardly sinks. Reports stated that friction took 1.4e8 % of the weight's work."""
    friction = 0.5
    held = (
        scenes.box("plate", (0.0, 0.0, -0.2), (1.0, 1.0, 0.0), "support"),
        scenes.box("stop", (1.0, 0.0, 0.0), (1.5, 1.0, 0.4), "fixed"),
    )
    block = scenes.box("block", (0.0, 0.0, 0.0), (1.0, 1.0, 0.4))
    scene = scenes.build(*held, block, friction=friction, settlement=(1.0, 0.0, 0.0))
    assembly, solution = solved(scene)
    twists = np.zeros((len(assembly.blocks), 6))
    twists[assembly.blocks.names.index("plate"), 0] = 1.0
    twists[assembly.blocks.names.index("block"), 2] = -sinks
    measures = measure(assembly, twists, solution.forces)
    assert measures.dissipated_power > 0.0
    assert np.isfinite(measures.dissipated_share) == known
    if known:
        assert measures.dissipated_share == pytest.approx(measures.dissipated_power / (sinks * assembly.weight))


def test_participation_is_undefined_where_nothing_dissipates() -> None:
    assert np.isnan(participation_index(np.zeros(5)))
    assert np.isnan(participation_index(np.zeros(0)))
    assert np.isnan(participation_index(np.full(5, np.nan)))


@pytest.mark.parametrize("name", ["arch_settling", "arch_spreading", "flat_arch", "slab_four_corners", "trilith", "two_pads"])
def test_where_nothing_slides_nothing_dissipates(name: str) -> None:
    measures = measured(scenes.shipped(name))
    assert measures.sliding == 0
    assert measures.opening > 0
    assert measures.dissipated_power == 0.0
    assert measures.dissipated_share == 0.0
    assert np.isnan(measures.participation_index)


# --- states ------------------------------------------------------------------------------------------------------------------


def test_a_point_that_parts_opens_unless_it_slides_under_load() -> None:
    assembly, twists, forces = dragged(0.3)
    free = assembly.blocks.free

    def states(rise: float, load: float, along: float = 1.0) -> set[int]:
        motion = twists * along
        motion[free, 2] = rise
        return set(dissipation.contact_states(assembly, motion, load * forces).tolist())

    assert states(0.0, 1.0) == {ContactState.SLIDING}
    assert states(0.0, 0.0) == {ContactState.SLIDING}
    assert states(0.3, 1.0) == {ContactState.SLIDING}  # the associated flow rule
    assert states(0.3, 0.0) == {ContactState.OPENING}
    assert states(0.5, 1.0) == {ContactState.OPENING}
    assert states(0.3, 0.0, along=0.0) == {ContactState.OPENING}
    assert states(0.0, 1.0, along=0.0) == {ContactState.STICKING}
    assert states(0.0, 0.0, along=0.0) == {ContactState.IDLE}


@pytest.mark.parametrize(
    ("points", "loaded", "joint"),
    [
        ("sliding opening", (1.0, 0.0), "sliding"),
        ("sliding opening", (0.0, 0.0), "opening"),
        ("sliding sticking", (0.0, 1.0), "sliding"),
        ("opening sticking", (0.0, 1.0), "opening"),
        ("sticking idle", (1.0, 0.0), "sticking"),
        ("idle idle", (0.0, 0.0), "idle"),
        ("unknown idle", (1.0, 0.0), "unknown"),
    ],
)
def test_a_joint_slides_where_friction_works_before_it_opens(points: str, loaded: tuple[float, float], joint: str) -> None:
    """A joint has two contact points. Each is pressed by the given share of the weight."""
    assembly = assemble(scenes.build(*SLIDER, live=(1.0, 0.0, 0.0), plane=True))
    states = np.array([ContactState[name.upper()] for name in points.split()])
    forces = np.array(loaded)[:, None] * assembly.weight * assembly.normal
    assert [ContactState(state).name.lower() for state in joint_states(assembly, states, forces)] == [joint]


def test_sliding_without_load_dissipates_nothing() -> None:
    assembly, twists, forces = dragged(0.3)
    measures = measure(assembly, twists, 1e-6 * forces)
    assert measures.sliding == len(assembly.points)
    assert measures.dissipated_power == 0.0
    assert np.isnan(measures.participation_index)


def test_elastic_creep_below_the_threshold_is_rest() -> None:
    assembly, solution = solved(scenes.shipped("two_blocks"))
    standing = assembly.blocks.names.index("standing block")
    base = np.flatnonzero(assembly.interfaces.block_a + assembly.interfaces.block_b == standing + assembly.blocks.names.index("fixed pad"))
    below = np.isin(assembly.points.interface, base)
    crept = solution.twists.copy()
    crept[standing, 0] = -0.01
    at_rest, seen = (measure(assembly, crept, solution.forces, threshold).states for threshold in (dissipation.THRESHOLD, 0.001))
    assert below.sum() == 2
    assert set(at_rest[below].tolist()) == {ContactState.STICKING}
    assert set(seen[below].tolist()) == {ContactState.SLIDING}


def test_slow_slip_dissipates_where_friction_is_used_up() -> None:
    """A block slides over its base while both sink 50 times as fast. With less friction than the joint can carry, the block creeps."""
    assembly, twists, forces = dragged(0.3)
    sinking = 0.02 * twists
    sinking[:, 2] = -1.0
    slides = measure(assembly, sinking, forces)
    assert slides.sliding == len(assembly.points)
    assert slides.dissipated_power == pytest.approx(0.02 * 0.3 * assembly.weight)
    creeps = measure(assembly, sinking, forces * np.array([0.9, 1.0, 1.0]))
    assert (creeps.sticking, creeps.dissipated_power) == (len(assembly.points), 0.0)


@pytest.mark.parametrize("undefined", ["twists", "forces", "both"])
def test_one_undefined_number_leaves_everything_undefined(undefined: str) -> None:
    assembly, solution = solved(scenes.shipped("two_pads"))
    twists, forces = solution.twists.copy(), solution.forces.copy()
    if undefined != "forces":
        twists[0, 3] = np.nan
    if undefined != "twists":
        forces[-1, 1] = np.nan
    measures = measure(assembly, twists, forces)
    assert set(measures.states.tolist()) == {ContactState.UNKNOWN}
    numbers = [value for name, value in vars(measures).items() if name != "states"]
    assert all(np.isnan(value).all() for value in numbers)


def test_every_point_is_counted_once() -> None:
    for name in NAMES:
        measures = measured(scenes.shipped(name))
        assert measures.opening + measures.sliding + measures.sticking + measures.idle == len(measures.states)


# --- balance of power --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("drive", [Drive.YIELDING, Drive.PUSHING])
@pytest.mark.parametrize("name", NAMES)
def test_weights_work_against_reaction_friction_and_dilation(name: str, drive: Drive) -> None:
    assembly = assemble(scenes.shipped(name))
    solution = solve_associated(assembly, drive)
    if solution.status is Status.UNBOUNDED:
        pytest.skip("no mechanism lets the support move this way")
    measures = measure(assembly, solution.twists, solution.forces, RIGID)
    parting, slip = mechanism.contact_speeds(assembly, solution.twists)
    compression = np.sum(solution.forces * assembly.normal, axis=1)
    work = float(np.sum(assembly.dead_load * solution.twists))
    dilation = float(np.sum(compression * parting))
    unit = max(assembly.weight, float(compression.sum())) * float(slip.max() + np.abs(parting).max())  # thrusts exceed weights in a dome
    assert work == pytest.approx(drive.value * solution.value + measures.dissipated_power - dilation, abs=1e-6 * unit)
    stated = measure(assembly, solution.twists, solution.forces)  # without the slowest slip
    assert stated.dissipated_power == pytest.approx(measures.dissipated_power, abs=5e-4 * assembly.weight)
    # Associated sliding does no net work: the dilation returns the work of friction.
    assert measures.dissipated_power == pytest.approx(dilation, abs=1e-6 * unit)


# --- invariance --------------------------------------------------------------------------------------------------------------


def test_measures_do_not_depend_on_units() -> None:
    assembly, solution = solved(wall())
    first = measure(assembly, solution.twists, solution.forces)
    # Another unit of time makes the mechanism faster, another unit of force the loads and forces larger.
    heavier = replace(assembly, dead_load=1e3 * assembly.dead_load)
    second = measure(heavier, 60.0 * solution.twists, 1e3 * solution.forces)
    assert first.dissipated_power > 0.0
    assert np.array_equal(first.states, second.states)
    assert second.dissipation_per_interface == pytest.approx(6e4 * first.dissipation_per_interface)
    for name in ("dissipated_share", "participation_index", "moving_mass_share"):
        assert getattr(second, name) == pytest.approx(getattr(first, name))


@pytest.mark.parametrize("change", [{"scale": 100.0}, {"density": 1e-3}, {"shift": (5.0, -3.0, 2.0)}])
def test_dissipation_grows_with_the_weight_alone(change: dict[str, float]) -> None:
    scene = side_by_side(0.6)
    other = scenes.moved(scene, **change)
    first, second = measured(scene), measured(other)
    assert second.dissipated_power / other.weight == pytest.approx(first.dissipated_power / scene.weight, rel=1e-5)
    for name in ("opening", "sliding", "dissipated_share", "participation_index", "moving_mass_share"):
        assert getattr(second, name) == pytest.approx(getattr(first, name), rel=1e-5)


# --- the figure --------------------------------------------------------------------------------------------------------------

FIGURES = {
    "plane": lambda: side_by_side(0.6),
    "wall in space": lambda: scenes.build(*scenes.wall(4, 6, split=0.8), plane=False),
    "turning": lambda: scenes.build(*scenes.wall(3, 4, split=0.8), settlement={"axis": (0.0, 1.0, 0.0), "point": (0.5, 0.0, -0.4)}),
    "live": lambda: scenes.build(*SLIDER, friction=0.3, live=(1.0, 0.0, 0.0)),
    "arch": lambda: scenes.shipped("arch_spreading"),
    "slab": lambda: scenes.shipped("slab_four_corners"),
    "wall_third": lambda: scenes.shipped("wall_third"),
    "falling": lambda: scenes.build(*OVERHANG),
}


def figure_of(scene: Scene, title: str = "Costs $5 and $\\badmacro") -> tuple[Figure, MechanismMeasures]:
    assembly = assemble(scene)
    solution = solve_associated(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING)
    measures = measure(assembly, solution.twists, solution.forces)
    return dissipation_figure(assembly, solution.twists, measures, title), measures


@pytest.mark.parametrize("kind", FIGURES)
def test_every_kind_of_mechanism_is_drawn_with_all_its_words_inside(kind: str, tmp_path: Path) -> None:
    figure, measures = figure_of(FIGURES[kind]())
    save(figure, tmp_path / "figure.png")
    assert (tmp_path / "figure.png").stat().st_size > 5000
    axes = figure.axes[0]
    summary = next(text for text in axes.texts if text.get_text().startswith(("friction", "no mechanism")))
    boxes = [text.get_window_extent() for text in (axes.title, summary)]
    assert boxes[0].y0 >= boxes[1].y1
    assert boxes[1].y0 >= axes.get_window_extent().y1
    for box in (*boxes, figure.legends[0].get_window_extent()):
        assert box.x0 >= 0.0 and box.y0 >= 0.0
        assert box.x1 <= figure.bbox.x1 and box.y1 <= figure.bbox.y1
    assert len(figure.axes) == 1 + (measures.dissipated_power > 0.0)  # a colour bar only where there is power


def words(figure: Figure) -> str:
    return "\n".join(text.get_text() for text in figure.findobj(Text))


def test_the_figure_says_what_was_measured() -> None:
    figure, measures = figure_of(side_by_side(0.6))
    for part in (f"{measures.dissipated_power / 1e3:.4g} kN", "52.9 %", "index 0.667", "by 2 of the 3", "50 % of the mass", "slides (4)"):
        assert part in words(figure)
    assert "dissipates nothing" in words(figure_of(scenes.shipped("arch_spreading"))[0])
    assert "no mechanism is known" in words(figure_of(FIGURES["falling"]())[0])
    assert "N m" in words(figure_of(FIGURES["turning"]())[0])


def test_more_power_is_darker_in_greyscale_too() -> None:
    luminance = POWER(np.linspace(0.0, 1.0, 50))[:, :3] @ np.array([0.299, 0.587, 0.114])
    assert (np.diff(luminance) < 0.0).all()


def test_the_same_figure_has_the_same_bytes(tmp_path: Path) -> None:
    for name in ("first.png", "second.png"):
        save(figure_of(wall())[0], tmp_path / name)
    assert (tmp_path / "first.png").read_bytes() == (tmp_path / "second.png").read_bytes()
