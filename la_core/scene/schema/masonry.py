"""Tables of masonry in courses: walls, openings, and buildings of walls that interlock."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from la_core.scene.schema.types import MOST_BLOCKS, Count, Name, Pair, Positive, Table, Vector

SIDES = {  # walls of a plan: which axis each runs along
    "rectangle": {"south": "x", "east": "y", "north": "x", "west": "y"},
    "L": {"south": "x", "west": "y"},
    "T": {"south": "x", "stem": "y"},
    "cross": {"along x": "x", "along y": "y"},
}


class Opening(Table):
    """Rectangle cut out of a wall, in the wall's own length and height (from its lower left corner), under a head.

    bearing (m): how far the head reaches beyond the opening on either side; of a flat arch, at its upper edge.
    """

    from_: Pair = Field(alias="from")
    to: Pair
    bearing: Positive
    head: Literal["lintel", "flat arch"] = "lintel"
    voussoirs: Count = 5  # of a flat arch

    @model_validator(mode="after")
    def _has_area(self) -> Self:
        if self.to[0] <= self.from_[0] or self.to[1] <= self.from_[1]:
            raise ValueError("both coordinates of `to` must be greater than those of `from`")
        return self

    @model_validator(mode="after")
    def _has_voussoirs_in_an_arch(self) -> Self:
        if self.head == "lintel" and "voussoirs" in self.model_fields_set:
            raise ValueError('`voussoirs` go with `head = "flat arch"`')
        return self


class Wall(Table):
    """Courses of equal blocks along x, bottom course first; of two or three leaves, tied by courses of headers."""

    name: Name = "wall"
    bond: Literal["running", "stack"]
    origin: Vector
    block: tuple[Positive, Positive, Positive]  # length (x), depth (y) of one leaf, height (z)
    per_course: Count
    courses: Count
    first: Literal["full", "half"] = "full"  # what the bottom course of a running bond starts with
    leaves: Annotated[Count, Field(le=3)] = 1
    headers_every: Count | None = None  # courses; blocks turned across two leaves
    density: Positive | None = None
    opening: tuple[Opening, ...] = ()

    @model_validator(mode="after")
    def _starts_half_in_running_bond(self) -> Self:
        if self.first == "half" and self.bond == "stack":
            raise ValueError('`first = "half"` goes with a running bond; in stack bond all courses are alike')
        return self

    @model_validator(mode="after")
    def _is_bounded(self) -> Self:
        if self.per_course * self.courses * self.leaves > MOST_BLOCKS:
            raise ValueError(f"`per_course` times `courses` times `leaves` may be at most {MOST_BLOCKS}")
        return self

    @model_validator(mode="after")
    def _ties_leaves(self) -> Self:
        if self.headers_every is None:
            return self
        if self.leaves == 1:
            raise ValueError("`headers_every` goes with two or three `leaves`")
        if abs(self.block[0] - 2.0 * self.block[1]) > 1e-6 * self.block[0]:
            raise ValueError("headers span two leaves, so the length of a `block` must be twice its depth")
        return self


class BuildingOpening(Opening):
    """Opening in one wall of a building; its length counts from the wall's west or south end."""

    side: Name


class Floor(Table):
    """A floor borne by walls, as mass per metre of wall (kg/m) that the blocks of one course (from 1) take up."""

    course: Count
    mass: Positive
    sides: tuple[Name, ...] = ()  # all walls where none is named


class Region(Table):
    """Rectangle in plan, m."""

    from_: Pair = Field(alias="from")
    to: Pair

    @model_validator(mode="after")
    def _has_area(self) -> Self:
        if self.to[0] <= self.from_[0] or self.to[1] <= self.from_[1]:
            raise ValueError("both coordinates of `to` must be greater than those of `from`")
        return self


class Foundation(Table):
    """Strips under all walls, held: where they lie in the region `settling` they are the support, elsewhere the ground."""

    height: Positive
    settling: Region


class Building(Table):
    """Walls of one leaf in running bond that meet at right angles and interlock: in every other course the other wall runs through.

    Plans: "rectangle" (walls south, east, north, west), "L" (south, west), "T" (south and a stem from its middle), "cross"
    (along x, along y, through each other's middle).
    """

    name: Name = "building"
    plan: Literal["rectangle", "L", "T", "cross"] = "rectangle"
    origin: Vector
    size: tuple[Positive, Positive]  # over all, in x and y
    block: tuple[Positive, Positive, Positive]  # length along the wall, thickness, height
    courses: Count
    density: Positive | None = None
    opening: tuple[BuildingOpening, ...] = ()
    floor: tuple[Floor, ...] = ()
    foundation: Foundation | None = None

    @model_validator(mode="after")
    def _is_bounded(self) -> Self:
        if sum(self.size) / self.block[0] * 2.0 * self.courses > MOST_BLOCKS:
            raise ValueError(f"would have more than {MOST_BLOCKS} blocks; take larger ones or fewer `courses`")
        return self

    @model_validator(mode="after")
    def _has_room(self) -> Self:
        length, thickness, _ = self.block
        if min(self.size) < 2.0 * length:
            raise ValueError("both entries of `size` must be at least two lengths of a `block`")
        if thickness >= length:
            raise ValueError("a `block` must be longer than thick, else corners do not interlock")
        return self

    @model_validator(mode="after")
    def _names_its_sides(self) -> Self:
        named = [opening.side for opening in self.opening] + [side for floor in self.floor for side in floor.sides]
        for side in named:
            if side not in SIDES[self.plan]:
                raise ValueError(f'a plan "{self.plan}" has no side "{side}", it has {", ".join(SIDES[self.plan])}')
        for floor in self.floor:
            if floor.course > self.courses:
                raise ValueError(f"a floor on course {floor.course}, but there are {self.courses} `courses`")
        return self
