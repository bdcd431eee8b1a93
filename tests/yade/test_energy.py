"""The energy audit of a YADE run: a made-up run by hand, and real runs, which must neither lose nor gain energy."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest
import scenes
from conftest import CrossChecked
from runs import made_up_run
from scipy.spatial.transform import Rotation

from comparison.judge.checks.energy import DRIFT, audit, check_energy
from comparison.numbers import DASH
from comparison.report.details import ENERGIES, energies
from comparison.verdict.check import Verdict
from comparison.yade.run_record import Poses, Run
from la_core.exchange.fields import SUPPORT
from la_core.model.assembly import Assembly, assemble

CrossCheck = Callable[[str], CrossChecked]
ADDS_UP = 1e-9  # relative: round-off
ACCOUNTED = 5e-3  # of the turnover: forces between stored states are taken as the mean of both
WEDGED = 2e-2  # the same where joints lose the thrust of their wedging before the second state is stored
SINK, NORMAL, SHEAR = 1e-3, 2e6, 1e6  # m, N/m


def sliding_column() -> tuple[Assembly, float]:
    """A column on its support beside a fixed one, and its weight."""
    assembly = assemble(scenes.shipped("two_blocks"))
    return assembly, float(-assembly.dead_load[np.flatnonzero(assembly.blocks.free)[-1], 2])


def made_up(assembly: Assembly, friction: float) -> Run:
    """A run whose settling side sinks rigidly. The points of the upright joint share a force of `friction`, N, up and as much across."""
    names = assembly.blocks.names
    moving = np.array([k for k, role in enumerate(assembly.blocks.role) if role == SUPPORT] + [names.index("settling block")])
    joint = np.abs(assembly.normal[:, 0]) > 0.5
    forces = np.zeros((len(assembly.points), 3))
    forces[joint] = (assembly.normal[joint] + np.array([0.0, 0.0, 1.0])) * friction / joint.sum()
    poses = {
        "settlement": np.array([0.0, 0.5 * SINK, SINK]),
        "displacement": np.zeros((3, len(names), 3)),
        "rotation": np.zeros((3, len(names), 3)),
        "forces": np.array([forces] * 3),
    }
    poses["displacement"][1:, moving, 2] = [[-0.5 * SINK], [-SINK]]
    weight = -assembly.dead_load[names.index("settling block"), 2]
    rows = 9
    record = {
        "stage": np.array([0] + [1] * rows),
        "settlement": np.concatenate([[0.0], np.linspace(0.0, SINK, rows)]),
        "reaction": np.full(rows + 1, weight - friction),
        "kinetic_energy": np.zeros(rows + 1),
    }
    return made_up_run({}, record, poses, {"normal_stiffness": NORMAL, "shear_stiffness": SHEAR})


def test_what_the_damping_of_the_swing_takes_counts_as_damping() -> None:
    assembly, weight = sliding_column()
    run = made_up(assembly, 0.2 * weight)
    taken = 0.1 * weight * SINK
    damped = dataclasses.replace(run, record=dataclasses.replace(run.record, damped_energy=np.append(0.0, np.linspace(0.0, taken, 9))))
    plain, found = audit(assembly, run), audit(assembly, damped)
    assert found.viscous - plain.viscous == pytest.approx(taken)
    assert plain.drift - found.drift == pytest.approx(taken / found.turnover)


def test_energy_of_motion_is_accounted_for() -> None:
    assembly, weight = sliding_column()
    run = made_up(assembly, 0.2 * weight)
    faster = 0.1 * weight * SINK
    run.record.kinetic_energy[:] = np.append(0.0, np.linspace(0.0, faster, 9))
    found = audit(assembly, run)
    assert found.kinetic == pytest.approx(faster) and found.drift == pytest.approx(-faster / found.turnover)


def test_a_block_that_slides_down_gives_its_weight_to_support_and_friction() -> None:
    assembly, weight = sliding_column()
    found = audit(assembly, made_up(assembly, 0.2 * weight))
    assert found.weights == pytest.approx(weight * SINK, rel=ADDS_UP)
    assert found.support == pytest.approx(-0.8 * weight * SINK, rel=ADDS_UP)
    assert found.friction == pytest.approx(0.2 * weight * SINK, rel=ADDS_UP)
    assert (found.elastic, found.kinetic) == (0.0, 0.0) and abs(found.viscous) <= ADDS_UP * weight * SINK
    assert abs(found.drift) <= ADDS_UP


def test_a_reaction_that_swells_between_two_stored_states_works_by_its_mean() -> None:
    """The reaction rises and falls in a triangle over half of the way. Every recorded row counts, also between the stored states."""
    assembly, weight = sliding_column()
    run = made_up(assembly, 0.2 * weight)
    run.record.reaction[:] += 0.3 * weight * np.interp(run.record.settlement / SINK, [0.0, 0.125, 0.5], [0.0, 1.0, 0.0])
    assert audit(assembly, run).support == pytest.approx(-(0.8 + 0.5 * 0.5 * 0.3) * weight * SINK, rel=ADDS_UP)


def test_energy_is_stored_across_and_along_the_joints_by_their_own_stiffness() -> None:
    """At rest, 16 N press and 16 N shear the upright joint. Both forces vanish on the way."""
    assembly, _ = sliding_column()
    run = made_up(assembly, 16.0)
    points = int((np.abs(assembly.normal[:, 0]) > 0.5).sum())
    run.poses.forces[-1] = 0.0
    found = audit(assembly, run)
    across, along = (points * 0.5 * (16.0 / points) ** 2 / stiffness for stiffness in (NORMAL, SHEAR))
    assert found.elastic == pytest.approx(-across - along)
    assert found.viscous == pytest.approx(across)  # no point came nearer: all energy stored across the joint is lost
    assert found.friction == pytest.approx(
        0.75 * 16.0 * SINK + along
    )  # the force is 16 N over one half of the way, and falls over the other


def test_work_that_a_rising_block_takes_and_a_sinking_one_gives_is_turned_over_twice() -> None:
    assembly, _ = sliding_column()
    run = made_up(assembly, 0.0)
    free = np.flatnonzero(assembly.blocks.free)
    plain = audit(assembly, run)
    run.poses.displacement[1:, free[0], 2] = [0.5 * SINK, SINK]
    found, risen = audit(assembly, run), -float(assembly.dead_load[free[0], 2]) * SINK
    assert found.weights == pytest.approx(plain.weights - risen) and found.turnover == pytest.approx(plain.turnover + risen)


def test_where_only_the_plateau_is_stored_the_balance_begins_there() -> None:
    """Between rest and the plateau, forces are known only at two states that are far apart."""
    assembly, weight = sliding_column()
    kept = dataclasses.replace(assembly, effects=assembly.effects.with_effect("recording", "plateau", "many states"))
    found = audit(kept, made_up(assembly, 0.2 * weight))
    assert (found.weights, found.support) == pytest.approx((0.5 * weight * SINK, -0.4 * weight * SINK)) and abs(found.drift) <= ADDS_UP


def test_the_load_works_by_its_mean_multiplier_between_two_states() -> None:
    """A block slides while its multiplier rises from 0 to 0.4."""
    ground = scenes.box("ground", (-1.0, 0.0, -0.2), (2.0, 0.3, 0.0), "fixed")
    assembly = assemble(scenes.build(ground, scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.3, 0.4)), inset=1e-3, live=(1.0, 0.0, 0.0)))
    free = int(np.flatnonzero(assembly.blocks.free)[0])
    still = {name: np.zeros((2, len(assembly.blocks), 3)) for name in ("displacement", "rotation")}
    poses = still | {"settlement": np.array([0.0, SINK]), "forces": np.zeros((2, len(assembly.points), 3))}
    poses["displacement"][1, free, 0] = SINK
    record = {"stage": np.array([0, 1, 1]), "settlement": np.array([0.0, 0.0, SINK]), "reaction": np.array([0.0, 0.0, 0.4])}
    run = made_up_run({}, record | {"kinetic_energy": np.zeros(3)}, poses, {"normal_stiffness": NORMAL, "shear_stiffness": SHEAR})
    found = audit(assembly, run)
    assert found.load == found.turnover == pytest.approx(0.2 * assembly.weight * SINK) and found.support == 0.0
    assert found.drift == pytest.approx(1.0)  # neither contact forces nor kinetic energy took this work


def test_the_load_works_by_the_multipliers_of_the_rows_where_a_structure_sways_back_before_it_moves_on() -> None:
    """The rows at which the two states were stored have the multipliers 0 and 0.4; others come between them in time."""
    ground = scenes.box("ground", (-1.0, 0.0, -0.2), (2.0, 0.3, 0.0), "fixed")
    assembly = assemble(scenes.build(ground, scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.3, 0.4)), inset=1e-3, live=(1.0, 0.0, 0.0)))
    free = int(np.flatnonzero(assembly.blocks.free)[0])
    poses = {name: np.zeros((2, len(assembly.blocks), 3)) for name in ("displacement", "rotation")}
    poses |= {"settlement": np.array([0.0, SINK]), "forces": np.zeros((2, len(assembly.points), 3))}
    poses["displacement"][1, free, 0] = SINK
    swaying = {"settlement": np.array([0.0, 0.0, SINK, 0.4 * SINK, 1.5 * SINK]), "reaction": np.array([0.0, 0.0, 0.4, 0.1, 0.3])}
    record = {"stage": np.array([0, 1, 1, 1, 1]), "kinetic_energy": np.zeros(5)} | swaying
    run = made_up_run({}, record, poses, {"normal_stiffness": NORMAL, "shear_stiffness": SHEAR})
    assert audit(assembly, run).load == pytest.approx(0.2 * assembly.weight * SINK)


def test_a_block_that_turns_about_its_edge_loses_nothing_there() -> None:
    """Its lever arms turn with it. With the undeformed geometry, half of N height angle^2 would seem to be damped."""
    ground = scenes.box("ground", (-1.0, 0.0, -0.2), (2.0, 0.3, 0.0), "fixed")
    block = scenes.box("block", (0.0, 0.0, 0.0), (0.6, 0.3, 4.0))
    assembly, angle, force = assemble(scenes.build(ground, block, inset=1e-3, live=(1.0, 0.0, 0.0))), 3e-3, 1e3
    free, edge = int(np.flatnonzero(assembly.blocks.free)[0]), int(assembly.points.position[:, 0].argmax())
    poses = {name: np.zeros((2, len(assembly.blocks), 3)) for name in ("displacement", "rotation")}
    poses |= {"settlement": np.array([0.0, SINK]), "forces": np.zeros((2, len(assembly.points), 3))}
    to_edge = assembly.points.position[edge] - assembly.blocks.centroid[free]
    poses["rotation"][1, free] = [0.0, angle, 0.0]
    poses["displacement"][1, free] = to_edge - Rotation.from_rotvec([0.0, angle, 0.0]).apply(to_edge)
    poses["forces"][:, edge, 2] = force
    record = {"stage": np.array([0, 1, 1]), "settlement": np.array([0.0, 0.0, SINK]), "reaction": np.zeros(3)}
    run = made_up_run({}, record | {"kinetic_energy": np.zeros(3)}, poses, {"normal_stiffness": NORMAL, "shear_stiffness": SHEAR})
    assert abs(audit(assembly, run).viscous) <= angle * force * 4.0 * angle**2


def test_blocks_that_fall_are_named_as_the_cause() -> None:
    assembly, weight = sliding_column()
    run = made_up(assembly, 0.2 * weight)
    run.record.kinetic_energy[:] = np.append(0.0, np.linspace(0.0, 0.3 * weight * SINK, 9))
    (check,) = check_energy(assembly, run)
    assert check.verdict is Verdict.INCONCLUSIVE and "blocks fall or jump" in check.reason
    assert "time integration" not in check.reason and "time_step" not in check.next_step


def test_forces_that_jump_between_stored_states_are_told_from_a_long_time_step() -> None:
    """A joint sticks and slips: it has 14 times its force in every tenth state, and none in the others."""
    assembly, weight = sliding_column()
    run = made_up(assembly, 0.4 * weight)
    share, sticks = np.linspace(0.0, 1.0, 41)[:, None, None], np.where(np.arange(41) % 10 == 5, 14.0, 0.0)[:, None, None]
    last = {name: values[-1] for name, values in vars(run.poses).items()}
    moved = {name: share * last[name] for name in ("displacement", "rotation")}
    rough = Poses(settlement=SINK * share[:, 0, 0], forces=sticks * last["forces"], **moved)
    rows = {name: np.repeat(values, 10, axis=0) for name, values in vars(run.record).items()}  # more rows than states
    sparse = dataclasses.replace(run, poses=rough, record=dataclasses.replace(run.record, **rows))
    (check,) = check_energy(assembly, sparse)
    assert check.verdict is Verdict.INCONCLUSIVE and "the forces change so much that this balance is known to ±" in check.reason
    assert "[yade] poses" in check.next_step and "time_step" not in check.next_step
    asked = {"poses": 1200, "record_rows": 1200}  # that advice was followed, but a block springs even between two rows
    (check,) = check_energy(assembly, dataclasses.replace(sparse, settings={**run.settings, **asked}))
    assert "set [yade] record_rows and poses to ten times" in check.next_step
    (check,) = check_energy(assembly, dataclasses.replace(run, poses=rough))  # every row has its state: no more can be stored
    assert "time_step" in check.next_step and "[yade] poses" not in check.next_step


def test_energy_from_nowhere_is_seen() -> None:
    assembly, weight = sliding_column()
    run = made_up(assembly, 0.2 * weight)
    louder = dataclasses.replace(run, record=dataclasses.replace(run.record, reaction=1.3 * run.record.reaction))
    (check,) = check_energy(assembly, louder)
    assert check.verdict is Verdict.INCONCLUSIVE and "not accounted for" in check.reason and "time integration" in check.reason
    assert check.difference == pytest.approx(-0.3 * 0.8 / (1.0 + 1.3 * 0.8))  # the support takes 0.8 of the weight's work, times 1.3
    louder.poses.forces[-1] *= 1.05  # states that scatter by less than the missing energy do not explain it
    (check,) = check_energy(assembly, louder)
    assert "time integration" in check.reason
    (check,) = check_energy(assembly, made_up(assembly, 0.2 * weight))
    assert check.verdict is Verdict.AGREE and check.tolerance == DRIFT


def test_without_motion_there_is_nothing_to_audit() -> None:
    assembly, weight = sliding_column()
    run = made_up(assembly, 0.2 * weight)
    first = dataclasses.replace(run, poses=Poses(**{name: values[:1] for name, values in vars(run.poses).items()}))
    assert np.isnan(audit(assembly, first).drift) and not list(check_energy(assembly, first))


@pytest.mark.parametrize(
    ("name", "accounted"),
    [("two_pads", ACCOUNTED), ("two_blocks", ACCOUNTED), ("wall_third", ACCOUNTED), ("rubble_wall", ACCOUNTED), ("flat_arch", WEDGED)],
)
def test_a_run_loses_no_energy_and_finds_none(name: str, accounted: float, cross_checked: CrossCheck) -> None:
    found = cross_checked(name)
    energy = audit(found.analysis.assembly, found.run)
    assert abs(energy.drift) <= accounted
    assert energy.friction >= -accounted * energy.turnover and energy.kinetic <= 1e-3 * energy.turnover
    assert found.summary["energy"]["drift"] == pytest.approx(energy.drift)


def test_friction_takes_what_the_mechanism_says_it_takes(cross_checked: CrossCheck) -> None:
    """From rest to the end, friction takes the share of the weights' work that YADE's mechanism states, but for the transient."""
    found = cross_checked("wall_third")
    energy, measures = audit(found.analysis.assembly, found.run), found.summary["mechanism_measures"]["yade"]
    assert energy.friction / energy.weights == pytest.approx(measures["dissipated_share"], rel=0.2)


def test_the_report_s_energies_add_up(cross_checked: CrossCheck) -> None:
    """The work put in is the sum of its uses, with a row for the energy that is not accounted for."""
    summary = cross_checked("wall_third").summary
    rows = {row["name"]: row["joule"] for row in energies(summary)}
    shown = [words for name, words in ENERGIES.items() if name != "load"]
    assert list(rows) == [*shown, "not accounted for"] and DASH not in rows.values()
    energy = summary["energy"]
    went = sum(energy[name] for name in ("kinetic", "elastic", "friction", "viscous")) + energy["drift"] * energy["turnover"]
    assert energy["weights"] + energy["support"] == pytest.approx(went, rel=ADDS_UP)
    assert energies({"energy": None}) == []
