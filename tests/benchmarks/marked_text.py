"""Parts of a page that a program writes between two HTML comments. The text around them is written by hand."""

import re
from collections.abc import Sequence

from la_core.text_table import number_text


def marked(name: str, text: str) -> str:
    """Return a text between its two marks, each on its own line."""
    return f"<!-- {name}: written by a program from the record -->\n{text.strip()}\n<!-- end of {name} -->"


def with_part(page: str, name: str, text: str) -> str:
    """Return the page with the text in the part of this name. Raises ValueError where the page has no such part, or several."""
    part = re.compile(rf"<!-- {re.escape(name)}: .*?<!-- end of {re.escape(name)} -->", re.DOTALL)
    if len(part.findall(page)) != 1:
        raise ValueError(f'the page has {len(part.findall(page))} parts "{name}"; exactly one is needed')
    return part.sub(lambda _: marked(name, text), page)


def sentences(lines: Sequence[str]) -> str:
    """Return conclusions as a Markdown list. Empty conclusions are left out."""
    return "\n".join(f"- {line}" for line in lines if line)


def span(values: Sequence[float], digits: int = 2) -> str:
    """Return the least and the greatest of some numbers, or one number where both are equal."""
    low, high = (number_text(float(f"{value:.{digits}g}"), 6) for value in (min(values), max(values)))
    return low if low == high else f"{low} to {high}"


def listed(words: Sequence[str]) -> str:
    """Return words as an enumeration."""
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} and {words[-1]}"
