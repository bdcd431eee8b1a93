"""The inertia of a quasi-static run: added inertia slows the fastest blocks down and changes no weight and no reaction."""

import dataclasses
import json
import math
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
import scenes
from conftest import CrossChecked
from hard_cases import cube_on_top, rubble, two_layers
from hypothesis import given
from hypothesis import strategies as st

import la_core
from comparison.cli.commands import main
from la_core import exchange
from la_core.analysis import structural_model
from la_core.analysis.case_file import write_case
from la_core.analysis.stage import analyse
from yade_scripts import case, settings
from yade_scripts.vibration import highest_eigenvalue, slowed, springs_of
from yade_scripts.vibration.inertia import MOST
from yade_scripts.vibration.springs import Springs

ROUND_OFF = 1e-9
SHARE = 0.05  # of the mass
CASES = {
    "wall": scenes.text(*scenes.wall(3, 4, split=0.8), inset=1e-3),
    "cube of 0.01 m on a block of 1 m": cube_on_top(0.01)[0],
    "slab 1e5 times as heavy above": two_layers(2000.0, 2e8),
    "rubble": rubble(0),
}


@pytest.fixture(scope="module", params=CASES)
def one(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> case.Case:
    path = tmp_path_factory.mktemp("inertia") / "case.h5"
    write_case(path, analyse(scenes.load(CASES[request.param])), "")
    optional = [field for field in (*exchange.PART_FIELDS, exchange.JOINT_INSET) if exchange.holds(path, field.path)]
    return case.from_fields(exchange.read(path, (*exchange.CASE_FIELDS, *optional)))


def test_the_true_inertia_is_kept_on_request(one: case.Case) -> None:
    true = slowed(one, springs_of(one, 1.0, 1.0), 0.0)
    assert np.array_equal(true.mass, one.mass)
    assert np.allclose(true.tensor[:, 1, 1], one.inertia[:, 1, 1], rtol=0.0)


def test_no_block_loses_inertia_and_the_mass_added_keeps_its_share(one: case.Case) -> None:
    true, slow = (slowed(one, springs_of(one, 1.0, 1.0), added) for added in (0.0, SHARE))
    assert np.all(slow.mass >= true.mass) and np.all(slow.mass <= MOST * true.mass * (1.0 + ROUND_OFF))
    assert (slow.mass - true.mass)[one.free].sum() <= SHARE * true.mass[one.free].sum() * (1.0 + ROUND_OFF)
    held = np.setdiff1d(np.arange(len(one.mass)), one.free)
    assert np.array_equal(slow.mass[held], true.mass[held]) and np.array_equal(slow.tensor[held], true.tensor[held])
    growth = slow.tensor[:, 1, 1] / true.tensor[:, 1, 1]
    assert np.allclose(slow.tensor, growth[:, None, None] * true.tensor) and growth.min() >= 1.0  # the same about every axis


def test_a_moment_of_inertia_grows_only_until_the_block_turns_as_slowly_as_it_shifts(one: case.Case) -> None:
    """It grows exactly so far that no block turns faster than it shifts, and at most MOST times."""
    springs = springs_of(one, 3.0, 2.0)
    slow = slowed(one, springs, SHARE)
    shifting, turning = springs.of_blocks()
    for block in one.free:
        shifts = np.linalg.eigvalsh(shifting[block]).max() / slow.mass[block]
        true = one.inertia[block, 1, 1] * np.eye(3) if one.plane else one.inertia[block]
        needed = np.linalg.eigvals(np.linalg.solve(true, turning[block])).real.max() / shifts
        assert slow.tensor[block, 1, 1] == pytest.approx(min(max(1.0, needed), MOST) * true[1, 1])


def test_a_block_that_turns_as_slowly_as_it_shifts_keeps_its_moment_of_inertia() -> None:
    """By hand: blocks of 2 kg and 0.5 kg m2 shift at 400 N/m / 2 kg = 200 /s2, and turn at 3, 1.1, 0.5 and 1000 times that rate.

    A block of 1 kg, which shifts faster, takes the mass that is added, 0.1 of all 9 kg.
    """
    shifting = np.diag([100.0, 400.0, 300.0]) * np.array([1.0, 1.0, 1.0, 1.0, 1e3])[:, None, None]
    turning = 0.5 * 200.0 * np.array([3.0, 1.1, 0.5, 1000.0, 0.0])[:, None, None] * np.diag([1.0, 0.7, 0.3])
    blocks = SimpleNamespace(mass=np.array([2.0, 2.0, 2.0, 2.0, 1.0]), inertia=np.tile(0.5 * np.eye(3), (5, 1, 1)), plane=False)
    blocks.free = np.arange(5)
    slow = slowed(cast(case.Case, blocks), cast(Springs, SimpleNamespace(of_blocks=lambda: (shifting, turning))), 0.1)
    assert slow.mass == pytest.approx([2.0, 2.0, 2.0, 2.0, 1.9])
    assert slow.tensor[:, 1, 1] == pytest.approx([1.5, 0.55, 0.5, 50.0, 0.5])  # a hundred times at most
    less = slowed(cast(case.Case, blocks), cast(Springs, SimpleNamespace(of_blocks=lambda: (shifting, turning))), 0.1, 1.5)
    assert less.mass == pytest.approx([2.0, 2.0, 2.0, 2.0, 1.5])
    assert less.tensor[:, 1, 1] == pytest.approx([0.75, 0.55, 0.5, 0.75, 0.5])  # 1.5 times at most


def test_the_stiffness_of_a_block_is_what_its_own_motion_feels(one: case.Case) -> None:
    springs = springs_of(one, 3.0, 2.0)
    shifting, turning = springs.of_blocks()
    chance = np.random.default_rng(0)
    for block in chance.choice(one.free, 3):
        twists = np.zeros((len(one.mass), 6))
        twists[block] = chance.normal(size=6) * springs.freedoms[block]
        felt = springs.stiffness(twists)[block]
        shifts, turns = (springs.stiffness(np.where(np.arange(6) // 3 == half, twists, 0.0))[block] for half in (0, 1))
        assert np.allclose(shifts[:3], shifting[block] @ twists[block, :3])
        assert np.allclose(turns[3:], turning[block] @ twists[block, 3:])
        assert np.allclose(felt, shifts + turns)


def test_the_fastest_swing_is_slower_and_the_step_longer(one: case.Case) -> None:
    springs = springs_of(one, 1.0, 1.0)
    fast, slow = (highest_eigenvalue(springs, slowed(one, springs, added)) for added in (0.0, SHARE))
    assert slow < 0.6 * fast
    true = dataclasses.replace(one, overrides={"added_mass": 0.0})
    assert settings.derive(one).time_step > 1.5 * settings.derive(true).time_step


def test_a_step_that_added_mass_makes_stable_is_not_refused_before_the_run(tmp_path: Path) -> None:
    """The added mass makes the swing slower. The period of the true mass is shorter than the stable step."""
    heavy = la_core.variant("two_pads", {"yade.added_mass": 100.0, "yade.stiffening": 1.0})
    write_case(tmp_path / "case.h5", analyse(heavy), "")
    stable = settings.derive(case.from_fields(exchange.read(tmp_path / "case.h5", exchange.CASE_FIELDS))).settling_step
    model = structural_model(la_core.variant(heavy, {"yade.settling_step": stable}))
    assert stable > 2.0 * math.pi * math.sqrt(model.stiffness.sag / 9.81)


@given(share=st.floats(1e-3, 1.0), seed=st.integers(0, 99))
def test_more_mass_is_never_a_faster_swing(share: float, seed: int) -> None:
    from yade_scripts.vibration.inertia import _levelled

    chance = np.random.default_rng(seed)
    stiffness, mass = np.exp(chance.normal(size=20, scale=3.0)), np.exp(chance.normal(size=20, scale=3.0))
    less, more = _levelled(stiffness, mass, 0.5 * share), _levelled(stiffness, mass, share)
    assert (stiffness / more).max() <= (stiffness / less).max() * (1.0 + ROUND_OFF)
    assert (more - mass).sum() <= share * mass.sum() * (1.0 + ROUND_OFF)
    least = (stiffness / more).max()
    touched = more > mass * (1.0 + ROUND_OFF)
    assert np.all((stiffness / more)[touched & (more < MOST * mass * (1.0 - ROUND_OFF))] >= least * (1.0 - 1e-6))  # no more than needed


@pytest.mark.yade
@pytest.mark.parametrize("name", ["arch_spreading"])
def test_true_and_slowed_inertia_come_to_one_reaction(name: str, cross_checked: Callable[[str], CrossChecked], tmp_path: Path) -> None:
    path = tmp_path / "true.toml"
    path.write_text(f"{scenes.shipped(name).text}\n[yade]\nadded_mass = 0.0\n", encoding="utf-8")
    assert main(["run", str(path), "-o", str(tmp_path / "out"), "-q"]) == 0
    true = json.loads((tmp_path / "out" / "true" / "comparison.json").read_text())["yade"]
    slowed_down = cross_checked(name).run.result
    assert abs(true["reaction"] - slowed_down["reaction"]) <= np.hypot(true["uncertainty"], slowed_down["uncertainty"])
    assert slowed_down["steps"] < 0.7 * true["steps"]
