"""Walls of random blocks that are pushed sideways, and the peak of their multiplier on a path of almost no drag."""

import itertools
import time

import numpy as np
import scenes

from la_core.analysis import analyse
from la_core.analysis.result import LimitAnalysis
from la_core.coulomb.followed_path import PredictionSettings, annealed
from la_core.coulomb.path.elastic_joints import ElasticJoints
from la_core.coulomb.path.implicit_step import State
from la_core.coulomb.path.quasi_static_path import QuasiStaticPath
from la_core.coulomb.path.rest import come_to_rest
from la_core.coulomb.path.tangent import Tangent
from la_core.coulomb.plateau import peak_before
from la_core.coulomb.sharp_path import PEAK_PATHS, peak_on_the_way

ALONG, OBLIQUE = (1.0, 0.0, 0.0), (1.0, 0.5, 0.0)


def pushed_wall(seed: int, live: tuple[float, float, float]) -> LimitAnalysis:
    """Analyse courses of blocks of random lengths and densities on a fixed base, pushed sideways."""
    rng = np.random.default_rng(seed)
    height = rng.uniform(0.2, 1.1)
    parts = [scenes.box("ground", (-0.2, 0.0, -0.3), (2.2, 0.5, 0.0), "fixed")]
    for course in range(3):
        ends = np.concatenate([[0.0], np.linspace(0.5, 1.5, 3) + rng.uniform(-0.2, 0.2, 3), [2.0]])
        for left, right in itertools.pairwise(ends):
            low, high = (left, 0.0, course * height), (right, 0.5, (course + 1) * height)
            parts.append(scenes.box(f"block {len(parts)}", low, high, density=float(rng.uniform(200.0, 5000.0))))
    return analyse(scenes.build(*parts, friction=float(rng.uniform(0.3, 0.7)), inset=0.001, live=live, model="coulomb"))


def peak_without_drag(analysis: LimitAnalysis) -> float:
    """Return the peak of a path with a ten-thousandth of the usual viscosity, in steps of a tenth of the usual length."""
    joints, tangent, rest, level, end = _at_rest(analysis)
    path = QuasiStaticPath(joints, tangent, rest, annealed(joints, 1e-7), 10.0)
    assert [point.progress for point in path.advance_to(end)][-1] == end
    return peak_before(path.curve[1], level, 0.01 * level) * joints.value_in_units(1.0)


def seconds_of_peak(analysis: LimitAnalysis) -> float:
    """Follow both paths to the peak of an analysis again, and return the time, s."""
    start = time.perf_counter()
    peak_on_the_way(*_at_rest(analysis), PredictionSettings(), [lambda *point: None] * len(PEAK_PATHS))
    return time.perf_counter() - start


def _at_rest(analysis: LimitAnalysis) -> tuple[ElasticJoints, Tangent, State, float, float]:
    """Return joints, tangent and state at rest, the scaled plateau, and the progress at the end of the prediction's path."""
    coulomb = analysis.coulomb
    assert coulomb is not None
    joints = ElasticJoints(analysis.assembly, analysis.stiffness)
    tangent = Tangent(joints)
    rest, _ = come_to_rest(joints, tangent, 0.0)
    assert rest is not None
    return joints, tangent, rest, coulomb.value / joints.value_in_units(1.0), float(coulomb.path_settlement[-1]) / analysis.stiffness.travel
