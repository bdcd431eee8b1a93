"""What every page of a report shares: templates with all texts escaped, and nested facts as pairs of words."""

import re
from collections.abc import Iterator
from typing import Any

import jinja2

from comparison.numbers import DASH, first_sentence, format_number, plural


def template_environment(name: str) -> jinja2.Environment:
    """The templates, for a page of this name: texts in HTML are escaped of themselves, those in Markdown by the filter `md`."""
    found = jinja2.Environment(
        loader=jinja2.PackageLoader("comparison.report", "templates"),
        autoescape=name.endswith(".html"),
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    found.filters |= {"number": format_number, "md": markdown, "plural": plural, "first_sentence": first_sentence}
    return found


def markdown(text: Any) -> str:
    """Text with every sign that Markdown or HTML would read escaped, in one line."""
    return re.sub(r"([\\`*_{}\[\]<>#|~$&])", r"\\\1", " ".join(str(text).split()))


def flat(values: dict[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    """Pairs of dotted name and text, in order of the names."""
    for key in sorted(values):
        value = values[key]
        if isinstance(value, dict):
            yield from flat(value, f"{prefix}{key}.")
        else:
            yield f"{prefix}{key}", DASH if value is None else f"{value:.6g}" if isinstance(value, float) else str(value)
