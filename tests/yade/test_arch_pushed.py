"""An arch pushed sideways until it fails: both methods against the best of all mechanisms of four hinges, by hand."""

import itertools
from pathlib import Path

import numpy as np
import pytest
import scenes
from conftest import Silent

from comparison.workflow import run_scene
from la_core.analysis import analyse
from la_core.limit import Drive

VOUSSOIRS, RADIUS, THICKNESS, INSET = 12, 1.0, 0.3, 1e-3
PER_MILLE = 1e-3
MUCH_FRICTION = 1.2  # no joint slides


def four_hinges(inset: float) -> tuple[float, tuple[int, ...]]:
    """Least multiplier of the push along x over all mechanisms of four hinges, and the joints where they open.

    Three rigid parts turn between hinges at the edges of four joints: about the first and the last hinge, which belong to the ground,
    and about each other. Joint k lies at the angle pi k / VOUSSOIRS from the right springing. A joint may open, but not close, away from
    its hinge.
    """
    inner, outer = RADIUS - THICKNESS / 2.0, RADIUS + THICKNESS / 2.0
    joint = np.pi * np.arange(VOUSSOIRS + 1) / VOUSSOIRS
    rays = np.column_stack([np.cos(joint), np.sin(joint)])
    edges = np.stack([(inner + inset) * rays, (outer - inset) * rays])  # hinge at the inner or the outer edge
    half, middle = joint[1] / 2.0, (joint[1:] + joint[:-1]) / 2.0
    reach = np.cos(half) * (inner + THICKNESS / 3.0 * (inner + 2.0 * outer) / (inner + outer))  # centroid of a trapezoid
    centroid = reach * np.column_stack([np.cos(middle), np.sin(middle)])
    best, where = np.inf, (0,)
    for joints in itertools.combinations(range(VOUSSOIRS + 1), 4):
        for first in (0, 1):
            sides = [(first + k) % 2 for k in range(4)]  # inner and outer edge in turn
            hinge = np.array([edges[side, k] for side, k in zip(sides, joints, strict=True)])
            for sense in (1.0, -1.0):
                if (spins := spins_of(hinge, sense)) is None or not opens(spins, sides):
                    continue
                power = power_of(spins, hinge, joints, centroid)
                if power[0] > 1e-12 and -power[1] / power[0] < best:
                    best, where = -power[1] / power[0], joints
    return float(best), where


def spins_of(hinge: np.ndarray, sense: float) -> np.ndarray | None:
    """Anticlockwise spins (3,) of the parts between four hinges (4, 2), the first of size 1; None where they jam."""
    a, b, c, d = hinge
    # Two equations: the middle part, turning about hinge b, and the last part, turning about hinge d, give hinge c one velocity.
    moved_b = sense * turned(b - a)
    matrix = np.column_stack([turned(c - b), -turned(c - d)])
    if abs(np.linalg.det(matrix)) < 1e-9:
        return None
    return np.array([sense, *np.linalg.solve(matrix, -moved_b)])


def turned(arm: np.ndarray) -> np.ndarray:
    """Velocity at the end of an arm (2,) for the anticlockwise spin 1."""
    return np.array([-arm[1], arm[0]])


def opens(spins: np.ndarray, sides: list[int]) -> bool:
    """Whether every hinged joint opens.

    A part that turns anticlockwise against the one before it, along rising angles, leaves it at the outer edge.
    """
    relative = np.diff(np.concatenate([[0.0], spins, [0.0]]))
    return all(jump > 0.0 if side == 0 else jump < 0.0 for jump, side in zip(relative, sides, strict=True))


def power_of(spins: np.ndarray, hinge: np.ndarray, joints: tuple[int, ...], centroid: np.ndarray) -> tuple[float, float]:
    """Power of a push of 1 along x and of the weights, for voussoirs of equal weight 1 / VOUSSOIRS."""
    push = weight = 0.0
    a, b, _, d = hinge
    for part, (low, high) in enumerate(itertools.pairwise(joints)):
        for k in range(low, high):
            if part == 0:
                velocity = spins[0] * turned(centroid[k] - a)
            elif part == 1:
                velocity = spins[0] * turned(b - a) + spins[1] * turned(centroid[k] - b)
            else:
                velocity = spins[2] * turned(centroid[k] - d)
            push += velocity[0] / VOUSSOIRS
            weight -= velocity[1] / VOUSSOIRS
    return push, weight


def pushed_arch(inset: float) -> str:
    arch = scenes.arch(VOUSSOIRS, THICKNESS, RADIUS, right="fixed")
    return scenes.text(arch, friction=MUCH_FRICTION, inset=inset, live=(1.0, 0.0, 0.0), model="auto")


def test_limit_analysis_finds_the_best_mechanism_of_four_hinges() -> None:
    exact, joints = four_hinges(0.0)
    analysis = analyse(scenes.load(pushed_arch(0.0)))
    assert analysis.sharp.bounds[Drive.LIVE].value == pytest.approx(exact, rel=1e-6)
    assert len(set(joints)) == 4


@pytest.mark.slow
@pytest.mark.yade
def test_an_arch_fails_by_four_hinges_in_both_methods(tmp_path: Path) -> None:
    exact, _ = four_hinges(INSET)
    summary = run_scene(scenes.load(pushed_arch(INSET)), tmp_path / "results", Silent(), with_yade=True, figures=lambda _: {})
    assert summary["verdict"] == "agree", summary["reason"]
    assert summary["limit_analysis"]["coulomb"]["multiplier"] == pytest.approx(exact, rel=PER_MILLE)
    assert summary["yade"]["multiplier"] == pytest.approx(exact, rel=2.0 * PER_MILLE)
    assert abs(summary["yade"]["multiplier"] - exact) <= summary["yade"]["uncertainty"]
