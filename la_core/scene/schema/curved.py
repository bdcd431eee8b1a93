"""Tables of curved masonry in a scene file: arches, barrel vaults and domes."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from la_core.scene.schema.types import MOST_BLOCKS, Count, Name, Positive, Real, Table, Vector

WIDEST = 120.0  # degrees that one voussoir may span: wider ones are slivers about their centre
ON_JOINT = 1e-9  # of a lune: sectors this close to a whole number of lunes end on a joint


class Springers(Table):
    """Roles of the held blocks behind the springing joints of an arch or a vault."""

    left: Literal["fixed", "support"]
    right: Literal["fixed", "support"]


class Ring(Table):
    """Straight-sided voussoirs with radial joints in the xz plane, numbered from the left springing."""

    centre: Vector  # centre of the circle; its y is where depth or length begin
    radius: Positive  # of the ring's mid line
    thickness: Positive
    voussoirs: Count
    embrace: Annotated[Real, Field(gt=0.0, le=180.0)] = 180.0  # degrees; 180 is semicircular, less is segmental
    springers: Springers | None = None
    density: Positive | None = None

    @model_validator(mode="after")
    def _is_a_ring(self) -> Self:
        if self.thickness >= 2.0 * self.radius:
            raise ValueError("`thickness` must be less than twice `radius`")
        if self.embrace / self.voussoirs > WIDEST:
            raise ValueError(f"a voussoir may span at most {WIDEST:g} degrees; take more `voussoirs`")
        return self


class Arch(Ring):
    """One ring of a given depth along y."""

    name: Name = "arch"
    depth: Positive


class Vault(Ring):
    """Barrel vault: courses of voussoirs along y, cut into `rings` of equal length."""

    name: Name = "vault"
    length: Positive  # along y
    rings: Count
    bond: Literal["running", "stack"]  # running: every other course is shifted by half a ring, with half voussoirs at its ends

    @model_validator(mode="after")
    def _is_bounded(self) -> Self:
        if self.voussoirs * self.rings > MOST_BLOCKS:
            raise ValueError(f"`voussoirs` times `rings` may be at most {MOST_BLOCKS}")
        return self


class Dome(Table):
    """Dome or sector of one about the vertical through its centre; courses from the crown down, lunes from the x axis towards y.

    A lune is what two neighbouring meridian joints cut out. Springers, one to a lune, are fixed but for those in `support`.
    """

    name: Name = "dome"
    centre: Vector
    radius: Positive  # of the middle surface
    thickness: Positive
    courses: Count  # along the meridian, the keystone among them
    lunes: Annotated[Count, Field(ge=3)]  # of the full circle
    embrace: Annotated[Real, Field(gt=0.0, le=90.0)] = 90.0  # degrees from the crown to the springing; 90 is hemispherical, less segmental
    oculus: Annotated[Real, Field(ge=0.0, lt=90.0)]  # degrees from the crown left open; 0 is closed by one keystone
    sector: Annotated[Real, Field(gt=0.0, le=360.0)] = 360.0  # degrees about the vertical; 360 is the whole dome
    sides: Literal["fixed", "free"] | None = None  # of a sector: abutments along its two end meridians, or nothing
    support: tuple[Count, Count] | None = None  # first and last lune whose springers move
    density: Positive | None = None

    @property
    def lunes_built(self) -> int:
        """Number of lunes of the sector."""
        return round(self.sector * self.lunes / 360.0)

    @model_validator(mode="after")
    def _is_a_shell(self) -> Self:
        if self.thickness >= 2.0 * self.radius:
            raise ValueError("`thickness` must be less than twice `radius`")
        if self.oculus >= self.embrace:
            raise ValueError("`oculus` must be less than `embrace`, else nothing is left of the dome")
        if self.oculus == 0.0 and self.courses == 1:
            raise ValueError("`courses` must be at least 2 where a keystone closes the dome: it is the first of them")
        if self.courses * self.lunes > MOST_BLOCKS:
            raise ValueError(f"`courses` times `lunes` may be at most {MOST_BLOCKS}")
        return self

    @model_validator(mode="after")
    def _ends_on_meridian_joints(self) -> Self:
        if self.lunes_built < 1 or abs(self.sector * self.lunes / 360.0 - self.lunes_built) > ON_JOINT:
            raise ValueError(f"`sector` must be a multiple of a lune, which is {360.0 / self.lunes:g} degrees wide")
        if self.oculus == 0.0 and 180.0 < self.sector < 360.0:
            raise ValueError("the keystone of a `sector` between 180 and 360 degrees is not convex; give it an `oculus`")
        if (self.sides is None) != (self.sector == 360.0):
            raise ValueError('`sides = "fixed"` or `"free"` belongs to a `sector` of less than 360 degrees, and to no whole dome')
        if self.support is not None and not self.support[0] <= self.support[1] <= self.lunes_built:
            raise ValueError(f"`support` must be the first and the last of some lunes, which are numbered 1 to {self.lunes_built}")
        return self
