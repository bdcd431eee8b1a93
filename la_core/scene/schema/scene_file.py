"""The scene file as a schema: every table and key, its type and its limits (pydantic)."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, Strict, model_validator

from la_core.scene.schema.curved import Arch, Dome, Vault
from la_core.scene.schema.masonry import Building, Wall
from la_core.scene.schema.mesh import Mesh
from la_core.scene.schema.types import (
    LARGEST,
    Count,
    Direction,
    Gravity,
    Name,
    NotNegative,
    Pair,
    Positive,
    Real,
    Role,
    Table,
    Text,
    Vector,
)

LEAST_ACCURACY, MOST_ACCURACY = 1e-3, 0.1  # what is finer than a joint's strain, or coarser than a drawing, is not for sale


def _auto_or_bool(value: object) -> object:
    if not (isinstance(value, bool) or value == "auto"):
        raise ValueError("must be 'auto', true or false")
    return value


AutoOrBool = Annotated[Literal["auto"] | bool, BeforeValidator(_auto_or_bool)]


Accuracy = Annotated[Positive, Field(ge=LEAST_ACCURACY, le=MOST_ACCURACY)]  # a share of the answer


class Stone(Table):
    """What every block without its own density is made of (density in kg/m3)."""

    density: Positive


class Joint(Table):
    """The dry joint: friction is tan(phi); inset in m draws contact points in from the edges of an interface."""

    friction: Annotated[NotNegative, Field(le=1e3)]  # 1e3 is a slope of 89.9 degrees
    inset: NotNegative = 0.001


class Box(Table):
    """Box along the axes between two corners, m."""

    from_: Vector = Field(alias="from")
    to: Vector

    @model_validator(mode="after")
    def _has_volume(self) -> Self:
        if any(high <= low for low, high in zip(self.from_, self.to, strict=True)):
            raise ValueError("every coordinate of `to` must be greater than that of `from`, else the box has no volume")
        return self


class Prism(Table):
    """Convex (x, z) profile, in either orientation, extruded from y[0] to y[1], m."""

    profile: Annotated[tuple[Pair, ...], Field(min_length=3)]
    y: Pair

    @model_validator(mode="after")
    def _has_depth(self) -> Self:
        if self.y[1] <= self.y[0]:
            raise ValueError("`y` must rise, else the prism has no volume")
        return self


class Polyhedron(Table):
    """Convex hull of vertices, m."""

    vertices: Annotated[tuple[Vector, ...], Field(min_length=4)]


class Block(Table):
    """One convex block; role "support" moves with the settlement, "fixed" is the ground."""

    name: Name
    role: Role = "free"
    density: Positive | None = None
    box: Box | None = None
    prism: Prism | None = None
    polyhedron: Polyhedron | None = None

    @model_validator(mode="after")
    def _has_one_shape(self) -> Self:
        if sum(shape is not None for shape in (self.box, self.prism, self.polyhedron)) != 1:
            raise ValueError("needs exactly one shape: box, prism or polyhedron")
        return self


class Settlement(Table):
    """Motion of all support blocks as one rigid body: a translation or a rotation."""

    direction: Direction | None = None
    axis: Direction | None = None
    point: Vector | None = None

    @model_validator(mode="after")
    def _is_one_motion(self) -> Self:
        given = (self.direction is not None, self.axis is not None, self.point is not None)
        if given not in ((True, False, False), (False, True, True)):
            raise ValueError("needs either `direction` (translation) or both `axis` and `point` (rotation)")
        return self


class Live(Table):
    """A load proportional to weight along a direction."""

    direction: Direction


class RequestedPath(Table):
    """The curve from rest to the plateau: how far, m or rad (default: the joints' travel), and in how many increments."""

    settlement: Positive | None = None
    increments: Annotated[Count, Field(le=10_000)] = 25


class RequestedEffects(Table):
    """Which effects to model; "auto" decides from the scene."""

    plane: AutoOrBool = "auto"
    friction: Literal["auto", "coulomb", "associated", "none-slides"] = "auto"
    elasticity: Literal["auto", "none", "plateau", "path"] = "auto"
    reach: AutoOrBool = "auto"
    displacement: Literal["auto", "small", "finite"] = "auto"
    recording: Literal["auto", "plateau", "states"] = "auto"


class Expected(Table):
    """What the scene is known to yield for sharp arrises, and how it is known.

    The reaction and the multiplier are those of the scene's own friction; `associated_` says what the associated flow rule yields.
    """

    reaction_over_weight: Real | None = None
    reaction_max_over_weight: Real | None = None
    multiplier: Real | None = None
    associated_reaction_over_weight: Real | None = None
    associated_multiplier: Real | None = None
    tolerance: Positive = 1e-4
    kind: Literal["exact", "published", "computed"]

    @model_validator(mode="after")
    def _expects_something(self) -> Self:
        if all(value is None for name, value in self if name not in ("tolerance", "kind")):
            raise ValueError("needs a value: `reaction_over_weight`, `reaction_max_over_weight` or `multiplier`")
        return self


class SceneFile(Table):
    """The whole file."""

    title: Text = ""
    source: Text = ""
    accuracy: Accuracy | None = None
    gravity: Gravity = (0.0, 0.0, -9.81)
    stone: Stone | None = None
    joint: Joint
    block: tuple[Block, ...] = ()
    wall: tuple[Wall, ...] = ()
    building: tuple[Building, ...] = ()
    arch: tuple[Arch, ...] = ()
    vault: tuple[Vault, ...] = ()
    dome: tuple[Dome, ...] = ()
    mesh: tuple[Mesh, ...] = ()
    settlement: Settlement | None = None
    live: Live | None = None
    path: RequestedPath | None = None
    effects: RequestedEffects = RequestedEffects()
    expected: Expected | None = None
    # Settings for YADE in place of derived ones.
    yade: dict[str, Annotated[int, Strict(), Field(ge=0, le=LARGEST)] | NotNegative] = Field(default_factory=dict)

    @model_validator(mode="after")
    def _has_one_loading(self) -> Self:
        if (self.settlement is None) == (self.live is None):
            raise ValueError("needs either a [settlement] or a [live] table")
        return self

    @model_validator(mode="after")
    def _follows_coulomb_friction(self) -> Self:
        if self.path is not None and self.effects.friction not in ("auto", "coulomb"):
            raise ValueError('a [path] is followed with friction = "coulomb" only')
        return self
