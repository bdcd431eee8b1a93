"""Templates of every report page, with all texts escaped, images as part of the page, and nested values as pairs of name and text."""

import base64
import functools
import html
import re
from collections.abc import Iterator
from typing import Any

import jinja2

from comparison.figures import DPI
from comparison.numbers import DASH, first_sentence, format_number, plain_number, plural, with_uncertainty

_PNG = b"\x89PNG\r\n\x1a\n"  # the first bytes of such a file; its width and height follow eight more
HALF_PAGE = 122.0  # mm: two figures of this height, with headings and captions, fill an A4 page
BESIDE_ANOTHER, ALONE = 0.7, 0.8  # of a figure's own size on paper: labels of 8 pt are printed at 5.6 and 6.4 pt


@functools.cache
def template_environment(name: str) -> jinja2.Environment:
    """Return the templates for the page of this name, compiled once, because compiling takes longer than filling them.

    HTML pages escape every text automatically; Markdown pages escape by the filter `md`.
    """
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("comparison.report", "templates"),
        autoescape=name.endswith(".html"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters |= {"number": format_number, "md": markdown, "plural": plural, "first_sentence": first_sentence}
    environment.filters |= {"uncertain": with_uncertainty, "plain": plain_number, "code": with_code}
    return environment


def markdown(text: Any) -> str:
    """Return the text in one line, with every character escaped that Markdown or HTML would interpret."""
    return re.sub(r"([\\`*_{}\[\]<>#|~$&])", r"\\\1", " ".join(str(text).split()))


def with_code(text: Any) -> str:
    """Return the text escaped for HTML, with words between backticks, such as a command, as code; templates mark the result as safe."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", html.escape(str(text)))


def image_address(image: bytes, kind: str = "png") -> str:
    """Return the address (data URI) of an image that is part of the page itself; kind: its format, "png" or "gif"."""
    return f"data:image/{kind};base64,{base64.b64encode(image).decode()}"


def paper_width(image: bytes) -> float:
    """Return the width of a PNG figure on paper, mm, before the page limits it; 0 for any other file."""
    if not image.startswith(_PNG):
        return 0.0
    width, height = (int.from_bytes(image[place : place + 4], "big") * 25.4 / DPI for place in (len(_PNG) + 8, len(_PNG) + 12))
    return width * (BESIDE_ANOTHER if height * BESIDE_ANOTHER <= HALF_PAGE else ALONE)


def flat(values: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Yield pairs of dotted name and text, in the order of the names; `prefix` goes before every name."""
    for key in sorted(values):
        value = values[key]
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", _text(value)


def _text(value: Any) -> str:
    """Return a single value as text."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    return DASH if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
