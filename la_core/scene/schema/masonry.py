"""Tables of masonry in courses: walls, openings, and buildings of walls that interlock."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from la_core.scene.schema.types import MOST_BLOCKS, Count, Name, NotNegative, Pair, Positive, Real, Table, Vector, bound_blocks, described

ROUND = 1e-9  # of a length: round-off in values that users divide by hand
SIDES = {  # walls of each plan, and the axis along which each wall runs
    "rectangle": {"south": "x", "east": "y", "north": "x", "west": "y"},
    "L": {"south": "x", "west": "y"},
    "T": {"south": "x", "stem": "y"},
    "cross": {"along x": "x", "along y": "y"},
}


def _need_area(low: tuple[float, float], high: tuple[float, float]) -> None:
    """Raise ValueError where the rectangle from the corner `low` to the corner `high` has no area."""
    if high[0] <= low[0] or high[1] <= low[1]:
        raise ValueError("both coordinates of `to` must be greater than those of `from`")


class Opening(Table):
    """Rectangle cut out of a wall, in the wall's own length and height (from its lower left corner), under a head."""

    from_: Pair = described("lower left corner: along the wall, up; the height lies on a course line", "m", alias="from")
    to: Pair = described("upper right corner; at least one course must remain above it for the head", "m")
    bearing: Positive = described(
        "length by which the head extends beyond the opening on either side; of a flat arch, at its upper edge; "
        "of an arch, at its springing if it is a semicircle, else one course higher; a lintel ends with the wall",
        "m",
    )
    head: Literal["lintel", "flat arch", "arch"] = described(
        "a lintel in one piece; a flat arch of voussoirs between skewbacks; or an arch over the opening, with voussoirs cut to the courses",
        default="lintel",
    )
    voussoirs: Count = described("number of voussoirs of a flat arch or an arch", default=5)
    rise: Positive | None = described(
        "needed for an arch, and only there: height of its crown above the opening; half the opening's width makes a semicircle",
        "m",
        default=None,
    )

    @model_validator(mode="after")
    def _has_area(self) -> Self:
        _need_area(self.from_, self.to)
        return self

    @model_validator(mode="after")
    def _has_voussoirs_in_an_arch(self) -> Self:
        if self.head == "lintel" and "voussoirs" in self.model_fields_set:
            raise ValueError('`voussoirs` go with `head = "flat arch"` or `head = "arch"`')
        if (self.head == "arch") != (self.rise is not None):
            raise ValueError('`head = "arch"` needs a `rise`, and only an arch has one')
        if self.rise is not None and self.rise > (self.to[0] - self.from_[0]) / 2.0 * (1.0 + ROUND):
            raise ValueError("the `rise` of an arch over an opening is at most half the opening's width, that of a semicircle")
        return self


class Footing(Table):
    """A strip of ground under a wall, as long and as deep as its foot; a part of it may settle."""

    height: Positive = described("height of the strip", "m")
    settling: Pair | None = described(
        "from, to along the wall: the part that moves with the settlement; the rest is fixed", "m", default=None
    )

    @model_validator(mode="after")
    def _settles_forwards(self) -> Self:
        if self.settling is not None and self.settling[1] <= self.settling[0]:
            raise ValueError("the second entry of `settling` must be greater than the first")
        return self


class Wall(Table):
    """Courses of blocks, bottom course first, along x or in any other direction; its faces and its ends may lean, and a gable may end it.

    A wall of two or three leaves is tied by courses of headers. A wall of one block per course is a pier. A wall across another one, with
    an end that leans, is a buttress.
    """

    name: Name = described(
        "prefix of the blocks' names, before their numbers: wall 3.2 is the second block of the third course", default="wall"
    )
    bond: Literal["running", "stack"] = described("running: every other course is shifted by half a block; stack: vertical joints in line")
    origin: Vector = described("lower left front corner of the wall", "m")
    block: tuple[Positive, Positive, Positive] = described("length (x), depth (y) of one leaf, height (z) of a block", "m")
    per_course: Count = described("blocks in a full course: the length of the wall over that of a block")
    courses: Count = described("number of courses, without those of a gable")
    heights: tuple[Positive, ...] = described(
        "heights of the courses from the bottom up, in place of that of a block; repeated where there are more courses", "m", default=()
    )
    angle: Real = described("direction of the wall in plan: 0 runs along x, 90 along y; turned about `origin`", "degrees", default=0.0)
    taper: tuple[NotNegative, NotNegative] = described(
        "distances by which the front and the back face lean inward from the foot to the top, a gable included", "m", default=(0.0, 0.0)
    )
    rake: tuple[NotNegative, NotNegative] = described(
        "distances by which the start and the end of the wall lean inward, as at a buttress, from the foot to the top below a gable",
        "m",
        default=(0.0, 0.0),
    )
    gable: Positive | None = described("height of a gable on top: courses between two slopes that meet above the middle", "m", default=None)
    first: Literal["full", "half"] = described("the block that the bottom course of a running bond starts with", default="full")
    leaves: Annotated[Count, Field(le=3)] = described("leaves side by side in depth", default=1)
    headers_every: Count | None = described(
        "number of courses from one course of headers to the next; headers tie two leaves, and blocks are then twice as long as deep",
        "courses",
        default=None,
    )
    density: Positive | None = described("density of these blocks, in place of [stone]'s", "kg/m3", default=None)
    opening: tuple[Opening, ...] = described("doors and windows", default=())
    footing: Footing | None = described("ground under the wall, part of it settling; without it you place it as [[block]]", default=None)

    @property
    def length(self) -> float:
        """Length of the wall at its foot, m."""
        return self.per_course * self.block[0]

    @model_validator(mode="after")
    def _leans_within_itself(self) -> Self:
        leans = any(self.taper) or any(self.rake) or self.gable is not None
        if self.leaves > 1 and (leans or any(opening.head == "arch" for opening in self.opening)):
            raise ValueError("`taper`, `rake`, `gable` and openings under an arch go with one leaf")
        if sum(self.taper) >= self.block[1]:
            raise ValueError("the entries of `taper` together must be less than the depth of a `block`")
        if sum(self.rake) >= self.length:
            raise ValueError("the entries of `rake` together must be less than the length of the wall")
        if self.footing is not None and self.footing.settling is not None:
            low, high = self.footing.settling
            if low < 0.0 or high > self.length * (1.0 + ROUND):
                raise ValueError(f"`settling` of the footing must lie within the wall's length, 0 to {self.length:g} m")
        return self

    @model_validator(mode="after")
    def _starts_half_in_running_bond(self) -> Self:
        if self.first == "half" and self.bond == "stack":
            raise ValueError('`first = "half"` goes with a running bond; in stack bond all courses are alike')
        return self

    @model_validator(mode="after")
    def _is_bounded(self) -> Self:
        bound_blocks(per_course=self.per_course, courses=self.courses, leaves=self.leaves)
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

    side: Name = described("name of the wall, as its plan lists them")


class Floor(Table):
    """A floor on walls: its mass per metre of wall is added to the blocks of one course, but not to voussoirs over an opening.

    A corner block belongs to the wall that runs through in this course: in odd courses the walls along x, in even ones those along y.
    """

    course: Count = described("course whose blocks carry the floor, counted from 1 at the bottom")
    mass: Positive = described("mass of the floor per metre of wall", "kg/m")
    sides: tuple[Name, ...] = described("walls that bear the floor; all where none is named", default=())


class Region(Table):
    """Rectangle in plan, m."""

    from_: Pair = described("corner with the least x and y", "m", alias="from")
    to: Pair = described("corner with the greatest x and y", "m")

    @model_validator(mode="after")
    def _has_area(self) -> Self:
        _need_area(self.from_, self.to)
        return self


class Foundation(Table):
    """Strips under all walls: the ground, and in the region `settling` the support."""

    height: Positive = described("height of the strips", "m")
    settling: Region | None = described(
        "part of the plan that settles, from the building's `origin`; strips are cut at its edges, and it must hold their whole breadth; "
        "the rest is fixed",
        default=None,
    )


class Building(Table):
    """Walls of one leaf in running bond that meet at right angles and interlock: in every other course the other wall runs through.

    Plans: "rectangle" (walls south, east, north, west), "L" (south, west), "T" (south and a stem from its middle), "cross"
    (along x, along y, through each other's middle).
    """

    name: Name = described("prefix of the blocks' names, before the wall's name and the numbers", default="building")
    plan: Literal["rectangle", "L", "T", "cross"] = described("walls and their names, as above", default="rectangle")
    origin: Vector = described("corner of the plan with the least x and y, at the foot of the walls", "m")
    size: tuple[Positive, Positive] = described("outer length in x and in y, each at least two lengths of a block", "m")
    block: tuple[Positive, Positive, Positive] = described("length along the wall, thickness (less than the length), height", "m")
    courses: Count = described("number of courses")
    density: Positive | None = described("density of these blocks, in place of [stone]'s", "kg/m3", default=None)
    opening: tuple[BuildingOpening, ...] = described("doors and windows", default=())
    floor: tuple[Floor, ...] = described("floors and roofs as mass on the walls", default=())
    foundation: Foundation | None = described(
        "strips under the walls, of which a part may settle; without it you place the ground as [[block]]", default=None
    )

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
