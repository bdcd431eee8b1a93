"""The scene file as a schema: every table and key, its type and its limits (pydantic)."""

from itertools import pairwise
from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, Strict, model_validator

from la_core.scene.schema.curved import Arch, Dome, Vault
from la_core.scene.schema.drawing import Drawing, Geometry
from la_core.scene.schema.loads import MOST_FRICTION, JointFriction, Load, Tie
from la_core.scene.schema.masonry import Building, Wall
from la_core.scene.schema.mesh import Mesh, Pattern
from la_core.scene.schema.rubble import Rubble
from la_core.scene.schema.types import (
    LARGEST,
    NO_BOND,
    Box,
    Count,
    DateText,
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
    described,
)

LEVEL = 1e-9  # of a direction: round-off
LEAST_ACCURACY, MOST_ACCURACY = 1e-3, 0.1  # not finer than the effect of strain in joints, not coarser than a drawing


def _given(table: Table, *keys: str) -> str:
    """Words that list which of these keys a table has."""
    return f"it has {' and '.join(f'`{key}`' for key in keys if getattr(table, key) is not None) or 'none'}"


def _auto_or_bool(value: object) -> object:
    if not (isinstance(value, bool) or value == "auto"):
        raise ValueError("must be 'auto', true or false")
    return value


AutoOrBool = Annotated[Literal["auto"] | bool, BeforeValidator(_auto_or_bool)]


Accuracy = Annotated[Positive, Field(ge=LEAST_ACCURACY, le=MOST_ACCURACY)]  # a share of the answer


class Stone(Table):
    """Material of every block that gives no density of its own."""

    density: Positive = described("mass per volume, joints included: 1800 to 2700 for most masonry", "kg/m3")


class Joint(Table):
    """The dry joint: no mortar, no cohesion, no tension. [[friction]] changes the friction of some joints."""

    refuses = NO_BOND

    friction: Annotated[NotNegative, Field(le=MOST_FRICTION)] = described(
        "friction coefficient mu = tan(phi), not an angle: 35 degrees is 0.7"
    )
    inset: NotNegative = described(
        "distance by which contact points are drawn in from the edges of a joint, in both methods; less in joints shorter than four insets",
        "m",
        default=0.001,
    )


class Prism(Table):
    """An (x, z) profile, in either orientation, extruded from y[0] to y[1], m; it need not be convex."""

    profile: Annotated[tuple[Pair, ...], Field(min_length=3)] = described("corners (x, z) in order", "m")
    y: Pair = described("from, to", "m")

    @model_validator(mode="after")
    def _has_depth(self) -> Self:
        if self.y[1] <= self.y[0]:
            raise ValueError("`y` must rise, else the prism has no volume")
        return self


class Polyhedron(Table):
    """Convex hull of vertices, m."""

    vertices: Annotated[tuple[Vector, ...], Field(min_length=4)] = described("corners in any order", "m")


class Block(Table):
    """One block; role "support" moves with the settlement, "fixed" is the ground."""

    name: Name = described("unique in the scene; reports and messages use it")
    role: Role = described("free: may move; fixed: ground; support: moves with the settlement", default="free")
    density: Positive | None = described("density of this block, in place of [stone]'s", "kg/m3", default=None)
    box: Box | None = described("exactly one of the three shapes must be given", default=None)
    prism: Prism | None = described("exactly one of the three shapes must be given", default=None)
    polyhedron: Polyhedron | None = described("exactly one of the three shapes must be given", default=None)

    @model_validator(mode="after")
    def _has_one_shape(self) -> Self:
        if sum(shape is not None for shape in (self.box, self.prism, self.polyhedron)) != 1:
            given = _given(self, "box", "prism", "polyhedron")
            raise ValueError(f"needs exactly one shape: box, prism or polyhedron; {given}")
        return self


class Zone(Table):
    """Supports that move by a share of the settlement of their own."""

    blocks: Annotated[tuple[Pattern, ...], Field(min_length=1)] = described(
        "names of supports, or layers of a drawing such as `layer:PAD`; `*`, `?` and `[...]` as in a shell"
    )
    ratio: Real = described("motion of these supports over the settlement: 0 holds them, a negative ratio moves them the other way")


class Settlement(Table):
    """Motion of the supports: a translation or a rotation of all as one rigid body, or by shares of this motion.

    Each `zone` gives the share of its supports. A `profile`, such as a trough, gives this share by place instead: supports then
    turn, too, each about its top. The reaction is the force that does work on the settlement: for two supports with the ratios 1 and 0.5,
    it is the force of the first plus half the force of the second.
    """

    direction: Direction | None = described("direction of a translation, of any length; down is [0, 0, -1]", default=None)
    axis: Direction | None = described("axis of a rotation, right-handed; the reaction is then a moment in N m", default=None)
    point: Vector | None = described("a point on this axis", "m", default=None)
    zone: tuple[Zone, ...] = described(
        "supports with another share of the motion; all others have 1, and of zones that overlap the last counts", default=()
    )
    profile: Annotated[tuple[Pair, ...], Field(min_length=2)] | None = described(
        "share of a translation by place, as points [place, ratio]: linear between, constant beyond; a support takes those at its ends",
        "m, -",
        default=None,
    )
    along: Literal["x", "y"] = described("axis of the places of a `profile`, at right angles to `direction`", default="x")

    @model_validator(mode="after")
    def _has_one_kind_of_shares(self) -> Self:
        if self.profile is None:
            return self
        if self.zone:
            raise ValueError("needs either `zone` or `profile`, not both")
        if self.direction is None or abs(self.direction["xy".index(self.along)]) > LEVEL * max(map(abs, self.direction)):
            raise ValueError("a `profile` needs a `direction` at right angles to the axis that `along` names")
        if any(after[0] <= before[0] for before, after in pairwise(self.profile)):
            raise ValueError("the places of a `profile` must rise from point to point")
        return self

    @model_validator(mode="after")
    def _is_one_motion(self) -> Self:
        given = (self.direction is not None, self.axis is not None, self.point is not None)
        if given not in ((True, False, False), (False, True, True)):
            has = _given(self, "direction", "axis", "point")
            raise ValueError(f"needs either `direction` (translation) or both `axis` and `point` (rotation); {has}")
        return self


class Live(Table):
    """A load proportional to weight, such as the static push of an earthquake; in place of [settlement]."""

    direction: Direction = described("direction of the load, of any length")


class Tilt(Table):
    """The ground tilts with the structure until it fails; in place of [settlement]. By the right-hand rule [0, 1, 0] tilts toward +x."""

    axis: Direction = described("level axis about which the ground turns, right-handed, of any length")


class RequestedPath(Table):
    """Asks limit analysis for the curve of the reaction from rest. Where `settlement` is short, the curve ends before the plateau."""

    settlement: Positive | None = described(
        "distance that the support moves; the travel of YADE where none is given", "m or rad", default=None
    )
    increments: Annotated[Count, Field(le=10_000)] = described("points on the curve after rest", default=25)


class RequestedEffects(Table):
    """Effects to model; with "auto" the program decides from the scene."""

    plane: AutoOrBool = described("true: motion in the xz plane only; false: a model in space", default="auto")
    friction: Literal["auto", "coulomb", "associated", "none-slides"] = described(
        "coulomb: real friction, without dilatancy; associated: bounds alone; none-slides: sliding excluded (Heyman)", default="auto"
    )
    elasticity: Literal["auto", "none", "plateau", "path"] = described(
        "strain of the joints in limit analysis: not at all, on the way to the plateau, or along a requested curve, too", default="auto"
    )
    reach: AutoOrBool = described("true: only the blocks that the support's motion can affect, for the prediction and YADE", default="auto")
    displacement: Literal["auto", "small", "finite"] = described(
        "small: contacts in YADE are those of the joints; finite: YADE looks for new ones", default="auto"
    )
    rotation: Literal["auto", "small", "finite"] = described(
        "small: the prediction is for small displacements; auto: the same, and limit analysis also states the value after turning "
        "blocks release a thrust; finite: both methods answer for displacements after this release, and YADE covers its whole travel",
        default="auto",
    )
    recording: Literal["auto", "plateau", "states"] = described("states that YADE stores: on the plateau, or all the way", default="auto")


class Expected(Table):
    """The known answer for sharp edges (inset 0), and its source; limit analysis is checked with it. At least one value is needed.

    Where joints slide, the prediction is known for the scene's inset alone: set `inset = 0` in [joint], or a `tolerance` that covers it.
    """

    reaction_over_weight: Real | None = described("R/W with the scene's own friction; in m where the support turns", default=None)
    reaction_max_over_weight: Real | None = described("greatest R/W, the support pushed against its settlement; associated", default=None)
    multiplier: Real | None = described(
        "collapse multiplier of a live load, or tangent of the tilt, with the scene's own friction", default=None
    )
    associated_reaction_over_weight: Real | None = described("R/W by the associated flow rule", default=None)
    associated_multiplier: Real | None = described("multiplier by the associated flow rule", default=None)
    tolerance: Positive = described("largest difference that still agrees, in the unit of these values", default=1e-4)
    kind: Literal["exact", "published", "computed"] = described("source of the value: calculation by hand, publication, or another program")

    @classmethod
    def values(cls) -> list[str]:
        """Names of the values that may be expected."""
        return [name for name in cls.model_fields if name not in ("tolerance", "kind")]

    @model_validator(mode="after")
    def _expects_something(self) -> Self:
        if all(getattr(self, name) is None for name in self.values()):
            raise ValueError("needs a value: `reaction_over_weight`, `reaction_max_over_weight` or `multiplier`")
        return self


class SceneFile(Table):
    """Keys above the first table, and the tables that a file may hold."""

    title: Text = described("heading of tables and reports", default="")
    source: Text = described("where the expected value, or the structure, comes from", default="")
    project: Text = described("project that the report belongs to, shown in its head", default="")
    author: Text = described("who answers for the report, shown in its head", default="")
    date: DateText = described("date in the report's head; the day of the calculation where none is given", default="")
    accuracy: Accuracy | None = described(
        "requested accuracy of both methods, as a share of the answer; as `crosscheck run --accuracy`", default=None
    )
    effort: Literal["normal", "high"] = described(
        "high: the prediction follows finer and longer paths, at several times the cost; `crosscheck run --try-harder` sets it",
        default="normal",
    )
    gravity: Gravity = described("acceleration of gravity, z is up", "m/s2", default=(0.0, 0.0, -9.81))
    stone: Stone | None = described("material of blocks without their own density", default=None)
    joint: Joint = described("friction of every joint, and its inset where that is not 0.001 m")
    block: tuple[Block, ...] = described("single blocks", default=())
    wall: tuple[Wall, ...] = described("walls in courses", default=())
    building: tuple[Building, ...] = described("walls that meet and interlock", default=())
    arch: tuple[Arch, ...] = described("arches", default=())
    vault: tuple[Vault, ...] = described("barrel vaults", default=())
    dome: tuple[Dome, ...] = described("domes", default=())
    rubble: tuple[Rubble, ...] = described("walls of irregular stones", default=())
    mesh: tuple[Mesh, ...] = described("imported blocks", default=())
    drawing: tuple[Drawing, ...] = described("blocks from the outlines of a drawing", default=())
    friction: tuple[JointFriction, ...] = described("friction of some joints, in place of [joint]'s", default=())
    load: tuple[Load, ...] = described("dead loads on blocks beside their weight", default=())
    tie: tuple[Tie, ...] = described("rods of given tension", default=())
    geometry: Geometry = described("errors of the coordinates", default=Geometry())
    settlement: Settlement | None = described("how the support moves; either this, [live] or [tilt]", default=None)
    live: Live | None = described("a load that grows until collapse; either this, [settlement] or [tilt]", default=None)
    tilt: Tilt | None = described("ground that tilts until collapse; either this, [settlement] or [live]", default=None)
    path: RequestedPath | None = described("asks for the curve from rest, over a given distance", default=None)
    effects: RequestedEffects = described("which effects are modelled; chosen automatically where left out", default=RequestedEffects())
    expected: Expected | None = described("the known answer", default=None)
    yade: dict[str, Annotated[int, Strict(), Field(ge=0, le=LARGEST)] | NotNegative] = described(
        "settings of YADE in place of derived ones", default_factory=dict
    )

    @model_validator(mode="after")
    def _has_one_loading(self) -> Self:
        given = [f"[{name}]" for name in ("settlement", "live", "tilt") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(f"needs one table out of [settlement], [live] and [tilt]; it has {' and '.join(given) or 'none'}")
        return self

    @model_validator(mode="after")
    def _follows_coulomb_friction(self) -> Self:
        if self.path is not None and self.effects.friction not in ("auto", "coulomb"):
            raise ValueError(
                f'effects.friction = "{self.effects.friction}" yields bounds, but a [path] needs friction without dilatancy: '
                'say "coulomb" or "auto", or leave [path] out'
            )
        return self
