"""Smooth joints of large structures: their law, its derivative, its sharp limit, and the predictions that rest on them."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import scenes

from la_core.coulomb import (
    ACCEPTED_RESIDUAL,
    CoulombSolution,
    PathProgress,
    certificate,
    followed_path,
    plateau,
    predict,
    prediction,
    several_paths,
)
from la_core.coulomb.followed_path import PredictionSettings, Reporter
from la_core.coulomb.path.elastic_joints import ElasticJoints, JointState
from la_core.limit import Drive, Status, solve_associated
from la_core.model import assemble, joint_stiffness

SMOOTHING = (1.0, 1e-2)  # times the mean contact force
DIFFERENCE = 1e-6  # of the displacement that strains a joint by its mean force: step of the finite differences

in_plane_and_3d = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])


def structure(plane: bool) -> ElasticJoints:
    scene = scenes.build(*scenes.wall(4, 3, split=0.8), friction=0.6, plane=plane)
    assembly = assemble(scene)
    return ElasticJoints(assembly, joint_stiffness(assembly, scene.yade))


def random_states(joints: ElasticJoints, seed: int) -> tuple[np.ndarray, JointState]:
    """Displacements of joints that press, part, stick and slip, and their state before."""
    rng = np.random.default_rng(seed)
    count, width = len(joints.friction), joints.width
    strain = 1.0 / count / joints.normal  # by the mean contact force
    shear = rng.normal(size=(count, width - 1)) / count
    before = JointState(rng.normal(size=(count, width)) * strain, np.concatenate([np.ones((count, 1)) / count, shear], axis=1), shear)
    return rng.normal(size=(count, width)) * strain, before


@in_plane_and_3d
@pytest.mark.parametrize("smoothing", SMOOTHING)
def test_tangent_is_the_derivative_of_the_forces(plane, smoothing) -> None:
    joints = structure(plane)
    displacement, before = random_states(joints, 5)
    force = smoothing / len(joints.friction)
    _, tangent = joints.state(displacement, before, force)
    step = DIFFERENCE / len(joints.friction) / joints.normal
    for axis in range(joints.width):
        moved = np.zeros_like(displacement)
        moved[:, axis] = step
        ahead, behind = (joints.state(displacement + sign * moved, before, force)[0].force for sign in (1.0, -1.0))
        assert np.allclose(-(ahead - behind) / (2.0 * step), tangent[:, :, axis], rtol=1e-4, atol=1e-4 * joints.normal)


@in_plane_and_3d
@pytest.mark.parametrize("smoothing", SMOOTHING)
def test_friction_of_smooth_joints_stays_in_its_cone_and_joints_never_pull(plane, smoothing) -> None:
    joints = structure(plane)
    state, _ = joints.state(*random_states(joints, 7), smoothing / len(joints.friction))
    normal, friction = state.force[:, 0], np.linalg.norm(state.force[:, 1:], axis=1)
    assert (normal > 0.0).all()
    assert (friction <= joints.friction * normal).all()
    assert (np.linalg.norm(state.memory, axis=1) <= joints.friction * normal * (1.0 + 1e-12)).all()


@in_plane_and_3d
def test_smooth_law_becomes_the_sharp_one_as_the_root_of_the_smoothing(plane) -> None:
    joints = structure(plane)
    displacement, before = random_states(joints, 9)
    sharp = joints.state(displacement, before)[0].force
    mean = 1.0 / len(joints.friction)
    for smoothing in (1e-2, 1e-4, 1e-6):
        smooth = joints.state(displacement, before, smoothing * mean)[0].force
        assert np.abs(smooth - sharp).max() <= 3.0 * np.sqrt(smoothing) * mean


def test_a_sharp_joint_remembers_the_friction_that_it_carries() -> None:
    joints = structure(True)
    state, _ = joints.state(*random_states(joints, 3))
    assert np.array_equal(state.memory, state.force[:, 1:])


@pytest.mark.slow_after_first
@pytest.mark.parametrize(
    ("per_course", "courses", "split", "friction"),
    [(10, 6, 2.8, 0.3), (10, 6, 2.0, 0.6), pytest.param(12, 8, 3.2, 0.8, marks=pytest.mark.slow)],
)
def test_large_structures_state_an_uncertainty_that_holds(per_course, courses, split, friction, monkeypatch) -> None:
    """A wall that is small enough for sharp joints is predicted with sharp and with smooth ones.

    On the last wall two paths with a smoothing of 30 and 3 mean contact forces were 7 % too low, but agreed within 0.3 %.
    """
    scene = scenes.build(*scenes.wall(per_course, courses, split=split), friction=friction)
    assembly = assemble(scene)
    stiffness = joint_stiffness(assembly, scene.yade)
    associated = solve_associated(assembly, Drive.YIELDING)
    sharp = predict(assembly, stiffness, associated)
    monkeypatch.setattr(prediction, "LARGE", 0.0)
    smooth = predict(assembly, stiffness, associated)
    assert smooth.certificate <= ACCEPTED_RESIDUAL
    assert abs(smooth.value - sharp.value) <= smooth.uncertainty + sharp.uncertainty
    assert smooth.status is Status.SOLVED and smooth.uncertainty <= 0.01 * smooth.value


@pytest.mark.slow_after_first
@pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])
@pytest.mark.parametrize("live", [None, (1.0, 0.0, 0.0)], ids=["settlement", "live load"])
def test_limit_state_near_a_path_of_smooth_joints_is_certified(plane, live, monkeypatch) -> None:
    """The state is computed from forces and mechanism that are both well away from a limit state."""
    scene = scenes.build(*scenes.wall(6, 4, split=None if live else 1.2), friction=0.6, plane=plane, live=live)
    assembly = assemble(scene)
    stiffness = joint_stiffness(assembly, scene.yade)
    ends = []

    def watched(path, tell):
        ends.append((certificate.certify(path.joints, path.before, path.last).worst, path.points[-1].value, path.joints))
        return certificate.limit_state_near(path, tell)

    monkeypatch.setattr(prediction, "LARGE", 0.0)
    monkeypatch.setattr(followed_path, "limit_state_near", watched)
    associated = solve_associated(assembly, Drive.LIVE if live else Drive.YIELDING)
    found = predict(assembly, stiffness, associated, settings=PredictionSettings(viscosities=(1.0, 0.1)))
    before, value, joints = ends[-1]
    assert before > 10.0 * ACCEPTED_RESIDUAL
    assert found.certificate <= ACCEPTED_RESIDUAL
    assert found.value == pytest.approx(joints.value_in_units(value), rel=0.02)
    assert found.uncertainty >= several_paths.MOVED * abs(found.value - joints.value_in_units(value)) * (1.0 - 1e-9)


def test_rounds_that_lower_no_residual_go_on_until_they_are_held_least(monkeypatch) -> None:
    """All rounds before the sixth are made to count as bad. The sixth or a later one is found, with the value of the path."""
    certify, ended = certificate.certify, []

    def watched(path, tell):
        calls = itertools.count()  # at the end of the path, then after each round

        def late(*state):
            found = certify(*state)
            return replace(found, sliding=1.0) if next(calls) <= 5 else found

        monkeypatch.setattr(certificate, "certify", late)
        ended.append((path, certificate.limit_state_near(path, tell)))
        return ended[-1][1]

    monkeypatch.setattr(followed_path, "limit_state_near", watched)
    predicted_as_large(monkeypatch, 1, settings=PredictionSettings(viscosities=(1.0, 0.1)))
    path, end = ended[0]
    assert end.certificate.worst <= ACCEPTED_RESIDUAL
    assert path.joints.reaction(end.last.joints.force) == pytest.approx(path.points[-1].value, rel=1e-6)


@pytest.mark.slow
def test_travel_is_doubled_until_the_plateau_is_known(monkeypatch) -> None:
    """A wall whose curve still falls over the first half of one travel."""
    scene = scenes.build(*scenes.wall(12, 8, split=2.4), friction=0.7)
    assembly = assemble(scene)
    stiffness, associated = joint_stiffness(assembly, scene.yade), solve_associated(assembly, Drive.YIELDING)
    sharp = predict(assembly, stiffness, associated)
    monkeypatch.setattr(prediction, "LARGE", 0.0)
    short, known = (predict(assembly, stiffness, associated, settings=PredictionSettings(doublings=most)) for most in (0, 6))
    assert short.travel == pytest.approx(1.0 + followed_path.SHARPENED) and short.uncertainty > 0.05 * short.value
    assert known.travel > 2.0 * short.travel and known.uncertainty < 0.01 * known.value
    assert abs(known.value - sharp.value) <= known.uncertainty + sharp.uncertainty
    assert abs(known.value - sharp.value) < 0.5 * abs(short.value - sharp.value)


@pytest.mark.parametrize(("doubt", "apart", "paths"), [(0.05, 0.0, 2), (0.0, 0.02, 3), (0.0, 0.0, 2)])
def test_a_third_path_follows_where_a_sharper_one_would_help(doubt, apart, paths, monkeypatch) -> None:
    """doubt: uncertainty that the curves of both paths leave; apart: difference of the paths; both over the value."""
    original, made = prediction.follow_large, []

    def changed(*arguments):
        one = original(*arguments)
        value = one.plateau.value * (1.0 + apart * len(made))
        made.append(replace(one, plateau=replace(one.plateau, value=value, change=doubt * value), smooth_error=1e-9))
        return replace(made[-1], values=np.append(one.values[:-1], value))

    monkeypatch.setattr(prediction, "follow_large", changed)
    found = predicted_as_large(monkeypatch, 1)
    assert len(made) == paths
    assert found.uncertainty >= max(doubt, apart) * found.value


def predicted_as_large(
    monkeypatch: pytest.MonkeyPatch, threads: int, report: Reporter | None = None, settings: PredictionSettings | None = None
) -> CoulombSolution:
    """Prediction of a small wall by the paths of a large one, on this many threads."""
    monkeypatch.setattr(prediction, "LARGE", 0.0)
    monkeypatch.setenv("OMP_NUM_THREADS", str(threads))
    scene = scenes.build(*scenes.wall(6, 4, split=1.2), friction=0.6)
    assembly = assemble(scene)
    stiffness = joint_stiffness(assembly, scene.yade)
    return predict(assembly, stiffness, solve_associated(assembly, Drive.YIELDING), settings=settings, report=report)


def test_a_path_ends_where_it_has_cost_as_much_again_as_its_travel(monkeypatch) -> None:
    """The plateau is made to stay unknown. The path still becomes sharp and is certified. More effort allows more travel."""
    monkeypatch.setattr(plateau, "EARLY", -1.0)
    monkeypatch.setattr(followed_path, "AGAIN", 0.1)
    travels = []
    for more in (1.0, 4.0):
        found = predicted_as_large(monkeypatch, 1, settings=PredictionSettings(effort=more * PredictionSettings.effort))
        assert found.status is Status.SOLVED
        travels.append(found.travel / (1.0 + followed_path.SHARPENED))
    assert 1.0 < travels[0] < travels[1] < 64.0  # 64 without the limit


def test_paths_side_by_side_give_the_answer_of_paths_in_turn(monkeypatch) -> None:
    reports: list[PathProgress] = []
    one, two = predicted_as_large(monkeypatch, 1), predicted_as_large(monkeypatch, 2, reports.append)
    assert (one.value, one.uncertainty, one.iterations) == (two.value, two.uncertainty, two.iterations)
    assert np.array_equal(one.path_value, two.path_value)
    assert {report.path for report in reports} == {1, 2, 3} and max(report.share for report in reports) == pytest.approx(1.0)


@pytest.mark.parametrize("threads", [1, 2])
def test_who_ends_one_path_ends_all(threads, monkeypatch) -> None:
    reports: list[PathProgress] = []

    def report(progress: PathProgress) -> None:
        reports.append(progress)
        if len(reports) == 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        predicted_as_large(monkeypatch, threads, report)
    assert len(reports) <= 5 + threads


def test_a_structure_whose_sharp_path_is_cut_short_gets_smooth_joints(monkeypatch) -> None:
    """The first path is made to end before its travel. No other sharp path follows, and the answer is that of smooth joints."""
    scene = scenes.build(*scenes.wall(6, 4, split=1.2), friction=0.6)
    assembly = assemble(scene)
    stiffness, associated = joint_stiffness(assembly, scene.yade), solve_associated(assembly, Drive.YIELDING)
    original, cut = prediction.follow, []

    def cut_short(*arguments):
        one = original(*arguments)
        cut.append(replace(one, is_short=True))
        return cut[-1]

    monkeypatch.setattr(prediction, "follow", cut_short)
    found, smooth = predict(assembly, stiffness, associated), predicted_as_large(monkeypatch, 1)
    assert len(cut) == 1
    assert (found.value, found.uncertainty, found.travel) == (smooth.value, smooth.uncertainty, smooth.travel)
    assert found.iterations == smooth.iterations + cut[0].iterations
