"""The tables of drawings, and of the tolerance of the geometry, in a scene file."""

from pathlib import PurePosixPath
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Field, model_validator

from la_core.drawing import ADVICE, DRAWING_FORMATS
from la_core.scene.schema.mesh import Pattern, within_the_scene_s_folder
from la_core.scene.schema.types import Name, NotNegative, Pair, Positive, Table, described

LISTS = ("ignore", "openings", "ground", "support", "blocks")  # lists of layers; the first list that names a layer counts
MOST_TOLERANCE = 0.1  # m: errors of a survey are smaller


class Drawing(Table):
    """Elevation from a DXF or SVG file: every closed outline in it becomes a block along y, from y = 0 to its thickness.

    `ground`, `support`, `openings`, `ignore` and `blocks` are shell-style patterns of names of layers (of groups in SVG),
    or of colours such as `colour:red`. What no other list names is a block. Nothing is built in an opening.
    [[friction]], [[load]] and zones of a settlement choose the blocks of a layer by `layer:NAME`, those of a colour by `colour:NAME`.
    """

    file: Annotated[Name, AfterValidator(within_the_scene_s_folder)] = described(
        "a .dxf or .svg file; a path from the scene's folder on, and within it"
    )
    name: Name = described("prefix of the blocks' names, before their numbers from the lower left", default="block")
    unit: Literal["mm", "cm", "dm", "m", "in", "ft"] | None = described("unit of the drawing, in place of the file's own", default=None)
    scale: Positive = described("50 for a drawing to scale 1 : 50, 1 for one in real size; other keys are in real size", default=1.0)
    thickness: Positive = described("of the blocks, along y", "m")
    thickness_of: dict[Pattern, Positive] = described("another thickness for layers or colours, by pattern", "m", default_factory=dict)
    joints: Annotated[NotNegative, Field(le=MOST_TOLERANCE)] = described(
        "greatest width of the open joints; blocks grow to the middle of joints up to this width", "m", default=0.0
    )
    sagitta: Annotated[Positive, Field(le=MOST_TOLERANCE)] = described(
        "greatest distance between a curve and the straight edges that replace it", "m", default=0.005
    )
    density: Positive | None = described("density of these blocks, in place of [stone]'s", "kg/m3", default=None)
    density_of: dict[Pattern, Positive] = described("another density for layers or colours, by pattern", "kg/m3", default_factory=dict)
    blocks: tuple[Pattern, ...] = described("layers of free blocks; all layers not named elsewhere where left out", default=())
    ground: tuple[Pattern, ...] = described("layers of fixed blocks", default=())
    support: tuple[Pattern, ...] = described("layers of blocks that move with the settlement", default=())
    openings: tuple[Pattern, ...] = described("layers of outlines in which nothing is built", default=())
    ignore: tuple[Pattern, ...] = described("layers that are not read", default=())
    shift: Pair = described("translation along x and z", "m", default=(0.0, 0.0))

    @model_validator(mode="after")
    def _is_drawn(self) -> Self:
        if (ending := PurePosixPath(self.file).suffix.lower()) not in DRAWING_FORMATS:
            hint = f"; {ADVICE[ending]}" if ending in ADVICE else ""
            raise ValueError(f"`file` must end in {' or '.join(DRAWING_FORMATS)}{hint}")
        uses: dict[str, str] = {}
        for key in LISTS:
            for pattern in getattr(self, key):
                if (other := uses.setdefault(pattern, key)) != key:
                    raise ValueError(f'"{pattern}" is named by both `{other}` and `{key}`; name it once')
        return self


class Geometry(Table):
    """Errors of coordinates, of all blocks of the scene: a survey knows them to some millimetres."""

    tolerance: Annotated[Positive, Field(le=MOST_TOLERANCE)] | None = described(
        "faces and corners within this distance are moved together; joints shorter than twice as much are dropped; changes are reported",
        "m",
        default=None,
    )
