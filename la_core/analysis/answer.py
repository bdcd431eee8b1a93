"""Limit analysis of a scene, asked for and told in one line each: what a program or a notebook works with."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from la_core.analysis import accuracy
from la_core.analysis.answer_table import headings, rows
from la_core.analysis.answer_values import associated_values, coulomb_values, path_values
from la_core.analysis.result import LimitAnalysis
from la_core.errors import SceneError
from la_core.limit import Drive, Solution, Status
from la_core.scene import Scene
from la_core.text_table import Tabled

NAN = float("nan")


@dataclass(frozen=True, repr=False, eq=False)
class Answer(Tabled):
    """What limit analysis says of a scene, in N (N m for a support that turns), at the scene's inset, and `_sharp` for sharp arrises.

    A number that does not exist is NaN. `print(answer)` shows the table of `crosscheck solve`; a notebook shows it by itself.
    scene: what was solved. analysis: everything that was found: assembly, forces, mechanisms, residuals.
    """

    scene: Scene
    analysis: LimitAnalysis

    @property
    def status(self) -> Status:
        """Solved, or why there is no value."""
        return self._bounds[self.analysis.main].status

    @property
    def least(self) -> float:
        """Least reaction of the associated problem: no friction law within Coulomb's cone carries less."""
        return self._bound(Drive.YIELDING, sharp=False)

    @property
    def greatest(self) -> float:
        """Greatest reaction of the associated problem: the support is pushed into the structure."""
        return self._bound(Drive.PUSHING, sharp=False)

    @property
    def multiplier(self) -> float:
        """Collapse multiplier of a live load by the associated flow rule, NaN for a settlement."""
        return self._bound(Drive.LIVE, sharp=False)

    @property
    def coulomb(self) -> float:
        """The prediction, reaction or multiplier, with friction that does not dilate; NaN where the scene asks for bounds alone."""
        found = self.analysis.coulomb_sharp if self.scene.inset == 0.0 else self.analysis.coulomb
        return NAN if found is None else found.value

    @property
    def interval(self) -> tuple[float, float]:
        """Least and greatest value that the prediction's mechanism allows, whatever friction's history was."""
        found = self.analysis.coulomb_sharp if self.scene.inset == 0.0 else self.analysis.coulomb
        return (NAN, NAN) if found is None else found.interval

    @property
    def least_sharp(self) -> float:
        """The same as `least` for sharp arrises."""
        return self._bound(Drive.YIELDING, sharp=True)

    @property
    def greatest_sharp(self) -> float:
        """The same as `greatest` for sharp arrises."""
        return self._bound(Drive.PUSHING, sharp=True)

    @property
    def coulomb_sharp(self) -> float:
        """The same as `coulomb` for sharp arrises."""
        return NAN if self.analysis.coulomb_sharp is None else self.analysis.coulomb_sharp.value

    @property
    def values(self) -> dict[str, Any]:
        """Everything that is printed and stored, by the names of `crosscheck solve --json`: associated, coulomb, path."""
        named = {"associated": associated_values, "coulomb": coulomb_values, "path": path_values}
        return {name: values(self.scene, self.analysis) for name, values in named.items()}

    @property
    def _bounds(self) -> dict[Drive, Solution]:
        return self.analysis.sharp if self.scene.inset == 0.0 else self.analysis.rounded

    def _bound(self, drive: Drive, sharp: bool) -> float:
        bounds = self.analysis.sharp if sharp else self._bounds
        return bounds[drive].value if drive in bounds else NAN

    def _table(self) -> tuple[str, Sequence[str], Sequence[Sequence[str]]]:
        return self.scene.title, headings(self.scene), list(rows(self.scene, self.values))


def solve(scene: Scene, path: bool = False) -> Answer:
    """Limit analysis of a scene: bounds, and the prediction where it asks for one; raises SceneError for what it does not allow.

    path: also follow the reaction from rest to the plateau, into `analysis.path`.

    >>> import la_core
    >>> pads = la_core.load("two_pads")
    >>> round(la_core.solve(pads).least_sharp / pads.weight, 6)
    0.166667
    """
    if path and scene.effects.friction not in ("auto", "coulomb"):
        raise SceneError(str(scene.path), "a path is followed with friction that does not dilate", hint='take effects.friction = "coulomb"')
    return Answer(scene, accuracy.analyse(scene, with_path=path))
