"""Tables of curved masonry in a scene file: arches, barrel vaults and domes."""

import math
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from la_core.scene.schema.masonry import ROUND
from la_core.scene.schema.types import Count, Name, Positive, Real, Table, Vector, bound_blocks, described

WIDEST = 120.0  # degrees that one voussoir may span: wider ones are slivers about their centre
FEWEST = 3  # voussoirs of a ring given by its span: fewer have a joint that is no joint of the shape
BASKET = (2.0 - math.sqrt(3.0)) / 2.0  # rise over span at which the small arcs of a basket arch of three 60-degree arcs vanish
RISES = {  # least and greatest rise of each shape, over the span
    "circular": (1e-3, 0.5), "pointed": (0.5, math.inf), "elliptical": (1e-2, math.inf), "basket": (1.05 * BASKET, 0.5),
}  # fmt: skip
ON_JOINT = 1e-9  # of a lune: sectors this close to a whole number of lunes end on a joint


class Springers(Table):
    """Roles of the held blocks behind the springing joints of an arch or a vault."""

    left: Literal["fixed", "support"] = described("whether the left springing is ground or moves with the settlement")
    right: Literal["fixed", "support"] = described("whether the right springing is ground or moves with the settlement")


class Ring(Table):
    """Straight-sided voussoirs with joints across the ring in the xz plane, numbered from the left springing.

    A circular ring is given by the radius of its mid line, or by the clear span and rise of its inner face, as all other shapes are.
    """

    centre: Vector = described(
        "centre of the circle, or with a `span` the middle between the springings; the depth or the length starts at its y", "m"
    )
    shape: Literal["circular", "pointed", "elliptical", "basket"] = described(
        "circular; pointed: two circles that meet above the middle; elliptical; basket: three circles, flatter than a semicircle",
        default="circular",
    )
    radius: Positive | None = described("radius of a circular ring's mid line, in place of `span` and `rise`", "m", default=None)
    span: Positive | None = described("clear width between the springings", "m", default=None)
    rise: Positive | None = described("clear height of the crown above the springings", "m", default=None)
    thickness: Positive = described("of the ring, across it; less than twice the radius", "m")
    voussoirs: Count = described("number of voussoirs of a ring, of equal length on the inner face; one may span at most 120 degrees")
    keystone: Literal["plain", "notched"] = described(
        "of a pointed arch with an odd number of voussoirs: plain, with a straight face below and above; notched, following the apex",
        default="plain",
    )
    embrace: Annotated[Real, Field(gt=0.0, le=180.0)] = described(
        "angle that a ring with a `radius` spans: 180 is semicircular, less is segmental", "degrees", default=180.0
    )
    angle: Real = described("direction of the span in plan: 0 runs along x, 90 along y; turned about `centre`", "degrees", default=0.0)
    springers: Springers | None = described(
        "held blocks behind the two springing joints; without it you place them as [[block]]", default=None
    )
    density: Positive | None = described("density of these blocks, in place of [stone]'s", "kg/m3", default=None)

    @model_validator(mode="after")
    def _is_a_ring(self) -> Self:
        if (self.radius is None) != (self.span is not None and self.rise is not None) or (self.span is None) != (self.rise is None):
            raise ValueError("needs either a `radius`, or both `span` and `rise`")
        if self.radius is not None:
            if self.shape != "circular":
                raise ValueError(f"the shape {self.shape} needs `span` and `rise` in place of `radius`")
            if self.thickness >= 2.0 * self.radius:
                raise ValueError("`thickness` must be less than twice `radius`")
        elif "embrace" in self.model_fields_set:
            raise ValueError("`embrace` goes with `radius`; `span` and `rise` give the angle")
        if self.radius is not None and self.embrace / self.voussoirs > WIDEST:
            raise ValueError(f"a voussoir may span at most {WIDEST:g} degrees; take more `voussoirs`")
        if self.radius is None and self.voussoirs < FEWEST:
            raise ValueError(f"needs at least {FEWEST} `voussoirs`")
        if self.keystone == "notched" and (self.shape != "pointed" or self.voussoirs % 2 == 0):
            raise ValueError('`keystone = "notched"` needs `shape = "pointed"` and an odd number of `voussoirs`')
        return self

    @model_validator(mode="after")
    def _has_the_rise_of_its_shape(self) -> Self:
        if self.span is None or self.rise is None:
            return self
        slenderness = self.rise / self.span
        low, high = RISES[self.shape]
        if not low * (1.0 - ROUND) <= slenderness <= high * (1.0 + ROUND):
            limits = f"{low * self.span:.4g} m" + (f" to {high * self.span:.4g} m" if high < math.inf else " or more")
            raise ValueError(f"the `rise` of the shape {self.shape} over this `span` is {limits}")
        return self


class Arch(Ring):
    """An arch of a given depth along y, in one ring or in several rings, one around the other."""

    name: Name = described("prefix of the voussoirs' names, before their numbers", default="arch")
    depth: Positive = described("along y", "m")
    rings: Count = described(
        "rings one around the other, between which the arch can slide and open; they share `thickness` equally", default=1
    )

    @model_validator(mode="after")
    def _is_bounded_in_rings(self) -> Self:
        bound_blocks(voussoirs=self.voussoirs, rings=self.rings)
        return self


class Vault(Ring):
    """Barrel vault: courses of voussoirs along y, cut into `rings` of equal length."""

    name: Name = described("prefix of the voussoirs' names, before their numbers", default="vault")
    length: Positive = described("of the vault along y", "m")
    rings: Count = described("rings of equal length along y")
    bond: Literal["running", "stack"] = described("running: every other course is shifted by half a ring, with half voussoirs at its ends")

    @model_validator(mode="after")
    def _is_bounded(self) -> Self:
        bound_blocks(voussoirs=self.voussoirs, rings=self.rings)
        return self


class Dome(Table):
    """Dome or sector of one about the vertical through its centre; courses from the crown down, lunes from the x axis towards y.

    A lune is the part between two neighbouring meridian joints. Each lune has one springer. Springers are fixed, except those in `support`.
    """

    name: Name = described("prefix of the blocks' names, before their numbers", default="dome")
    centre: Vector = described("centre of the sphere", "m")
    radius: Positive = described("radius of the middle surface", "m")
    thickness: Positive = described("of the shell, along the radius; less than twice the radius", "m")
    courses: Count = described("courses from the crown to the springing, the keystone included")
    lunes: Annotated[Count, Field(ge=3)] = described("lunes of the full circle, also for a sector")
    embrace: Annotated[Real, Field(gt=0.0, le=90.0)] = described(
        "angle from the crown to the springing: 90 is hemispherical, less is segmental", "degrees", default=90.0
    )
    oculus: Annotated[Real, Field(ge=0.0, lt=90.0)] = described("angle left open at the crown; 0 is closed by one keystone", "degrees")
    sector: Annotated[Real, Field(gt=0.0, le=360.0)] = described(
        "angle about the vertical, a multiple of a lune; 360 is the whole dome", "degrees", default=360.0
    )
    sides: Literal["fixed", "free"] | None = described(
        "needed for a sector, and only there: fixed abutments along its two end meridians, or free ends", default=None
    )
    support: tuple[Count, Count] | None = described(
        "first and last lune whose springers move with the settlement; all others are fixed", default=None
    )
    density: Positive | None = described("density of these blocks, in place of [stone]'s", "kg/m3", default=None)

    @property
    def lunes_built(self) -> int:
        """Number of lunes of the sector."""
        return round(self.sector * self.lunes / 360.0)

    @model_validator(mode="after")
    def _is_a_shell(self) -> Self:
        if self.thickness >= 2.0 * self.radius:
            raise ValueError("`thickness` must be less than twice `radius`")
        if self.oculus >= self.embrace:
            raise ValueError("`oculus` must be less than `embrace`; otherwise the dome has no courses")
        if self.oculus == 0.0 and self.courses == 1:
            raise ValueError("`courses` must be at least 2 where a keystone closes the dome: it is the first of them")
        bound_blocks(courses=self.courses, lunes=self.lunes)
        return self

    @model_validator(mode="after")
    def _ends_on_meridian_joints(self) -> Self:
        if self.lunes_built < 1 or abs(self.sector * self.lunes / 360.0 - self.lunes_built) > ON_JOINT:
            raise ValueError(f"`sector` must be a multiple of a lune, which is {360.0 / self.lunes:g} degrees wide")
        if self.oculus == 0.0 and 180.0 < self.sector < 360.0:
            raise ValueError("the keystone of a `sector` between 180 and 360 degrees is not convex; give it an `oculus`")
        if (self.sides is None) != (self.sector == 360.0):
            raise ValueError(
                '`sides = "fixed"` or `"free"` is needed for a `sector` of less than 360 degrees, and not allowed for a whole dome'
            )
        if self.support is not None and not self.support[0] <= self.support[1] <= self.lunes_built:
            raise ValueError(f"`support` must be a first and a last lune, in this order, with numbers from 1 to {self.lunes_built}")
        return self
