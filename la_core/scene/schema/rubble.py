"""The table of rubble: a wall of irregular stones, drawn by chance from a seed."""

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from la_core.scene.schema.masonry import ROUND, Footing
from la_core.scene.schema.types import Count, Name, Positive, Real, Table, Vector, described

LONGEST_JOINT = 0.4  # of a stone's size: regular hexagons have 0.62, and stones close to them are no rubble


class Rubble(Table):
    """A wall of irregular stones that fill a rectangle without gaps and go through its whole depth; the same seed draws the same stones.

    The stones are cells of a Voronoi diagram. Their corners are then moved apart until no joint is shorter than `shortest`.
    """

    name: Name = described("prefix of the stones' names, before their numbers", default="rubble")
    origin: Vector = described("lower left front corner of the wall", "m")
    size: tuple[Positive, Positive] = described("length and height of the wall", "m")
    depth: Positive = described("of the wall", "m")
    stones: Annotated[Count, Field(ge=2, le=5_000)] = described("number of stones")
    seed: Annotated[int, Strict(), Field(ge=0, le=2**31)] = described("another seed draws other stones of the same size", default=1)
    shortest: Positive | None = described("length of the shortest joint; a tenth of a stone's size where none is given", "m", default=None)
    flatness: Annotated[Real, Field(ge=0.2, le=5.0)] = described("length over height of a typical stone", default=1.5)
    angle: Real = described("direction of the wall in plan: 0 runs along x, 90 along y; turned about `origin`", "degrees", default=0.0)
    density: Positive | None = described("density of these stones, in place of [stone]'s", "kg/m3", default=None)
    footing: Footing | None = described("ground under the wall, part of it settling; without it you place it as [[block]]", default=None)

    @property
    def shortest_joint(self) -> float:
        """Length of the shortest joint that is allowed, m."""
        return 0.1 * self.stone_size if self.shortest is None else self.shortest

    @property
    def stone_size(self) -> float:
        """Side of a square as large as the mean stone, m."""
        return float((self.size[0] * self.size[1] / self.stones) ** 0.5)

    @model_validator(mode="after")
    def _has_joints_shorter_than_stones(self) -> Self:
        most = LONGEST_JOINT * self.stone_size
        if self.shortest is not None and self.shortest > most:
            raise ValueError(f"`shortest` may be at most {most:.3g} m: these stones are about {self.stone_size:.2g} m long")
        return self

    @model_validator(mode="after")
    def _settles_within_itself(self) -> Self:
        if self.footing is not None and self.footing.settling is not None:
            low, high = self.footing.settling
            if low < 0.0 or high > self.size[0] * (1.0 + ROUND):
                raise ValueError(f"`settling` of the footing must lie within the wall's length, 0 to {self.size[0]:g} m")
        return self
