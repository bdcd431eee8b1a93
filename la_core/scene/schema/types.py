"""Types of the entries of a scene file: numbers within limits, vectors, names, and tables that refuse unknown keys."""

import datetime
import math
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, Strict, model_validator

from la_core.errors import CONTROL

LARGEST, SMALLEST = 1e12, 1e-12  # limits of numbers in SI units: typing errors lie above, round-off below
Real = Annotated[float, Strict(), Field(allow_inf_nan=False, ge=-LARGEST, le=LARGEST)]


def _not_tiny(value: float) -> float:
    if value < SMALLEST:
        raise ValueError(f"must be at least {SMALLEST:g}")
    return value


Positive = Annotated[Real, Field(gt=0.0), AfterValidator(_not_tiny)]
NotNegative = Annotated[Real, Field(ge=0.0)]
Count = Annotated[int, Strict(), Field(ge=1, le=100_000)]
Pair = tuple[Real, Real]
Vector = tuple[Real, Real, Real]


def _is_harmless(text: str) -> str:
    if control := CONTROL.search(text):
        raise ValueError(f"must not contain control characters, such as the one numbered {ord(control[0])}")
    return text


Text = Annotated[str, Strict(), Field(max_length=10_000), AfterValidator(_is_harmless)]


def _date_as_text(value: object) -> object:
    return value.isoformat() if isinstance(value, datetime.date) else value


DateText = Annotated[Text, BeforeValidator(_date_as_text)]  # a date of TOML, or text
LONGEST_NAME = 200  # characters


def _is_one_line(text: str) -> str:
    if "\n" in text:
        raise ValueError("must be one line")
    if text.isspace():
        raise ValueError("must not be blank: tables and messages would show nothing")
    return text


Name = Annotated[Text, Field(min_length=1, max_length=LONGEST_NAME), AfterValidator(_is_one_line)]
MOST_BLOCKS = 50_000  # of one generator, and of a scene, so that a typing error does not fill the memory or take long
LARGEST_FILE = 50_000_000  # bytes; a scene is a short text, and its meshes describe a structure without ornament
Role = Literal["free", "fixed", "support"]


def bound_blocks(**counts: int) -> None:
    """Raise ValueError where the product of these counts, each with its key, is more than MOST_BLOCKS."""
    if math.prod(counts.values()) > MOST_BLOCKS:
        raise ValueError(f"{' times '.join(f'`{key}`' for key in counts)} may be at most {MOST_BLOCKS}")


def not_zero(vector: Vector) -> Vector:
    """Return the vector; raises ValueError where all its entries are zero."""
    if not any(vector):
        raise ValueError("must not be the zero vector")
    return vector


def _not_weightless(vector: Vector) -> Vector:
    _not_tiny(max(abs(entry) for entry in vector))
    return vector


Finite = Annotated[float, Strict(), Field(allow_inf_nan=False)]
Direction = Annotated[tuple[Finite, Finite, Finite], AfterValidator(not_zero)]  # scaled to unit length, so of any length
Gravity = Annotated[Vector, AfterValidator(not_zero), AfterValidator(_not_weightless)]


def described(meaning: str, unit: str = "", **options: Any) -> Any:
    """A key with its meaning and its unit, which the page of keys shows; `options` are those of pydantic's Field."""
    return Field(description=meaning, json_schema_extra={"unit": unit} if unit else None, **options)


NO_BOND = dict.fromkeys(
    ("cohesion", "tension", "tensile_strength"),
    "joints are dry and carry neither cohesion nor tension: bounds of limit analysis could include them, but the prediction and YADE's law "
    "of contact cannot, so the two methods could not be compared; leave it out, and give stones that mortar binds as one block",
)


class Table(BaseModel):
    """A table that refuses keys it does not know and does not change once read.

    `refuses` lists keys that users may try here, each with the reason for its refusal.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, defer_build=True)
    refuses: ClassVar[dict[str, str]] = {}


class Box(Table):
    """Box along the axes between two corners, m."""

    from_: Vector = described("corner with the least x, y and z", "m", alias="from")
    to: Vector = described("corner with the greatest x, y and z", "m")

    @model_validator(mode="after")
    def _has_volume(self) -> Self:
        if any(high <= low for low, high in zip(self.from_, self.to, strict=True)):
            raise ValueError("every coordinate of `to` must be greater than that of `from`, else the box has no volume")
        return self
