"""Problems that tests of Coulomb predictions share: scenes, their predictions and values, and tolerances."""

import pytest
import scenes

from la_core.coulomb import CoulombSolution, predict
from la_core.limit.associated import Status, solve_associated
from la_core.limit.problem import Drive
from la_core.model.assembly import Assembly, assemble
from la_core.model.joints import JointStiffness, joint_stiffness
from la_core.scene.scene import Scene

STRAIN = 2e-3  # relative: elastic joints leave a sag of 1/300 of the travel
UNSLIDING = 1e-3  # relative: where no joint slides, the two answers differ only by solver tolerance and strain of the joints
PLATEAU = 1e-2  # relative: two paths to the same plateau differ by friction's history
DIGIT = 2e-4  # share of the weight: two units of the last printed digit
FOUND = 1e-6  # share of the weight: cone programmes compute the interval's ends
in_plane_and_3d = pytest.mark.parametrize("plane", [True, False], ids=["plane", "3D"])


def problem(scene: Scene, **settings: float) -> tuple[Assembly, JointStiffness]:
    """Return the assembly of a scene and the stiffness of its joints."""
    assembly = assemble(scene)
    return assembly, joint_stiffness(assembly, {**scene.yade, **settings})


def answer(scene: Scene, wedging: float = 0.0, **settings: float) -> tuple[Assembly, CoulombSolution]:
    """Return assembly and prediction. Fails unless the associated answer and the prediction are solved."""
    assembly, stiffness = problem(scene, **settings)
    associated = solve_associated(assembly, Drive.LIVE if assembly.has_live_load else Drive.YIELDING)
    assert associated.status is Status.SOLVED
    solution = predict(assembly, stiffness, associated, wedging)
    assert solution.status is Status.SOLVED
    return assembly, solution


def unit(assembly: Assembly) -> float:
    """Return the weight, or 1 for a multiplier."""
    return 1.0 if assembly.has_live_load else assembly.weight


def value(scene: Scene, **settings: float) -> float:
    """Return the reaction over the weight, or the multiplier."""
    assembly, solution = answer(scene, **settings)
    return solution.value / unit(assembly)


def bounds(scene: Scene, **settings: float) -> list[float]:
    """Return the ends of the interval over the weight, or as multipliers."""
    assembly, solution = answer(scene, **settings)
    return [end / unit(assembly) for end in solution.interval]


def small_wall(**options) -> Scene:
    """Six courses of five blocks. The last two fifths of the base settle."""
    return scenes.build(*scenes.wall(5, 6, split=1.2), **options)


def great_wall(mu: float, split: float, plane: bool = True) -> Scene:
    """Ten courses of six blocks; sharp edges."""
    return scenes.build(*scenes.wall(6, 10, split, block_size=(0.4, 1.0, 0.2)), friction=mu, plane=plane)


def beams(**options) -> Scene:
    """Crossing beams on two piers, pulled down and obliquely: a scene that is not plane."""
    return scenes.build(
        *scenes.crossing_beams(),
        **{"settlement": (0.3, 0.2, -1.0)} | options,
    )


def turning(**options) -> Scene:
    """The small wall on a base that turns."""
    return small_wall(settlement={"axis": (0.0, 1.0, 0.0), "point": (0.9, 0.0, -0.4)}, **options)


def pushed(**options) -> Scene:
    """Wall 1 of Ferris & Tin-Loi (2001)."""
    parts = scenes.wall(5, 6, block_size=(0.4, 1.0, 0.175), first="half")
    return scenes.build(*parts, **{"friction": 0.65, "live": (1.0, 0.0, 0.0)} | options)


SCENES = {"wall": small_wall, "wall without sliding": lambda: small_wall(model="none-slides"), "crossing beams": beams,
          "turning base": turning, "live load": pushed}  # fmt: skip
every_scene = pytest.mark.parametrize("name", SCENES)
