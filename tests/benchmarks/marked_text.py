"""Parts of a page that a program writes, between two HTML comments: what stands around them is written by hand."""

import re
from collections.abc import Sequence

from la_core.text_table import number_text


def marked(name: str, text: str) -> str:
    """A text between its two marks, each on a line of its own."""
    return f"<!-- {name}: written by a program from the record -->\n{text.strip()}\n<!-- end of {name} -->"


def with_part(page: str, name: str, text: str) -> str:
    """The page with the text in place of the part of this name; raises ValueError where the page has no such part, or two."""
    part = re.compile(rf"<!-- {re.escape(name)}: .*?<!-- end of {re.escape(name)} -->", re.DOTALL)
    if len(part.findall(page)) != 1:
        raise ValueError(f'the page has {len(part.findall(page))} parts "{name}"; exactly one is needed')
    return part.sub(lambda _: marked(name, text), page)


def sentences(lines: Sequence[str]) -> str:
    """A list of conclusions; empty ones are left out."""
    return "\n".join(f"- {line}" for line in lines if line)


def span(values: Sequence[float], digits: int = 2) -> str:
    """The least and the greatest of some numbers, or the one number that all of them are."""
    low, high = (number_text(float(f"{value:.{digits}g}"), 6) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def listed(words: Sequence[str]) -> str:
    """Words as an enumeration."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
