"""Tables of dead loads, ties and classes of joints in a scene file."""

from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from la_core.scene.schema.mesh import Pattern
from la_core.scene.schema.types import NO_BOND, Box, Name, NotNegative, Pair, Positive, Table, Vector, described, not_zero

MOST_FRICTION = 1e3
Force = Annotated[Vector, AfterValidator(not_zero)]


class Load(Table):
    """A dead load on free blocks: it acts from the start, does not change, and keeps its direction as the blocks turn.

    It is a `force`, or a `mass` whose weight acts along gravity, and which a [live] load pushes as it pushes the blocks. `per` says
    what it is given for: each chosen block; each metre of a line in plan, on the top faces under it; each square metre in plan of the
    top faces.
    """

    name: Name = described("reports and messages use it", default="load")
    blocks: tuple[Pattern, ...] = described(
        "names of the loaded blocks, or layers of a drawing such as `layer:BRICK`; `*`, `?` and `[...]` as in a shell", default=()
    )
    region: Box | None = described(
        "loaded are the free blocks whose centroid lies in this box; with `blocks`, only those named there", default=None
    )
    force: Force | None = described("the load as a force (x, y, z); either this or `mass`", "N, N/m or N/m2", default=None)
    mass: Positive | None = described("a floor, a roof or a fill by its mass; either this or `force`", "kg, kg/m or kg/m2", default=None)
    per: Literal["block", "m", "m2"] = described("for each block, metre of the line, or square metre", default="block")
    at: Vector | None = described("point where a load on one block acts; the block's centroid where left out", "m", default=None)
    from_: Pair | None = described('start (x, y) of the line of a load `per = "m"`', "m", alias="from", default=None)
    to: Pair | None = described("end (x, y) of this line", "m", default=None)

    @model_validator(mode="after")
    def _is_one_load(self) -> Self:
        if (self.force is None) == (self.mass is None):
            raise ValueError("needs either a `force` or a `mass`")
        if not self.blocks and self.region is None:
            raise ValueError("needs `blocks` or a `region` that it acts on")
        has_line = (self.from_ is not None, self.to is not None)
        if has_line != ((self.per == "m"),) * 2:
            raise ValueError('`per = "m"` needs `from` and `to`, and they belong to it alone')
        if self.per == "m" and self.from_ == self.to:
            raise ValueError("`from` and `to` must differ, else the line has no length")
        if self.at is not None and self.per != "block":
            raise ValueError('`at` belongs to a load `per = "block"`; other loads act on the top faces')
        return self


class Tie(Table):
    """A rod under a given tension, between two blocks or between a block and the ground.

    Its two forces are equal and opposite along the line between its ends as built. They do not change as blocks move: it is a rod under
    load, not one that stretches.
    """

    refuses = dict.fromkeys(("tension", "mass"), "the tension of a tie is its `force`, in N")

    name: Name = described("reports and messages use it", default="tie")
    blocks: Annotated[tuple[Name, ...], Field(min_length=1, max_length=2)] = described(
        "block at `from` and block at `to`; with one name the end `to` is held by the ground; pulls on a support are not in the reaction"
    )
    from_: Vector = described("end of the rod at the first block", "m", alias="from")
    to: Vector = described("end of the rod at the second block, or in the ground", "m")
    force: Positive = described("tension of the rod", "N")

    @model_validator(mode="after")
    def _has_two_ends(self) -> Self:
        if self.from_ == self.to:
            raise ValueError("`from` and `to` must differ, else the rod has no direction")
        if len(self.blocks) == 2 and self.blocks[0] == self.blocks[1]:
            raise ValueError("the two `blocks` must differ: a rod within one block changes nothing")
        return self


class JointFriction(Table):
    """Friction of some joints, in place of [joint]'s. Where a joint belongs to several tables, the last one counts."""

    refuses = NO_BOND

    joints: Literal["bed", "head", "footing"] | None = described(
        "bed: joints between free blocks, at most 45 degrees from level; head: steeper ones; footing: joints with a held block",
        default=None,
    )
    between: tuple[Pattern, Pattern] | None = described(
        "joints between a block of the first name and one of the second, in either order; `*`, `?` and `[...]` as in a shell; "
        "`layer:BRICK` stands for all blocks on this layer of a drawing",
        default=None,
    )
    friction: Annotated[NotNegative, Field(le=MOST_FRICTION)] = described("friction coefficient mu = tan(phi) of these joints")

    @model_validator(mode="after")
    def _chooses_joints(self) -> Self:
        if self.joints is None and self.between is None:
            raise ValueError("needs `joints` or `between`, to choose the joints; [joint] holds for all others")
        return self
