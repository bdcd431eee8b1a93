"""Write the page of the Python interface from its docstrings: `.venv/bin/python tests/benchmarks/api_page.py`."""

import on_path  # noqa: F401, I001  first, because it makes the next imports possible
import ast
import dataclasses
import enum
import inspect
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NamedTuple

import comparison
import la_core

PAGE = Path(comparison.__file__).parent / "gallery" / "api.md"
HEAD = """# From Python: the stable names

`la_core` solves a scene by limit analysis. `comparison` runs both methods on a scene and compares them. The names on this page
stay; all other names may change. An invalid scene or argument raises `la_core.SceneError`, with a message that says where the
error is, which rule it breaks and what to do next; each name lists its other errors. A notebook shows scenes, answers and
results as tables, and pictures as images.

This page is written by `.venv/bin/python tests/benchmarks/api_page.py` from the docstrings.
"""
LISTS = ("Parameters", "Attributes", "Returns", "Raises")  # sections of entries, in numpydoc's format
SECTIONS = (*LISTS, "Notes", "Examples")


class Entry(NamedTuple):
    """One entry of a section: `name : kind`, then its meaning. An entry of Returns has no name; an entry of Raises has no kind."""

    name: str
    kind: str
    meaning: str


def sections(thing: Any) -> dict[str, str]:
    """Return the sections of a docstring by their headings. The key "" has the text above the first heading."""
    lines = (inspect.getdoc(thing) or "").splitlines()
    heading = ""
    texts: dict[str, list[str]] = {heading: []}
    for number, line in enumerate(lines):
        underlined = number + 1 < len(lines) and lines[number + 1] == "-" * len(line)
        if line in SECTIONS and underlined:
            heading = line
            texts[heading] = []
        elif not (heading and line == "-" * len(heading)):
            texts[heading].append(line)
    return {heading: "\n".join(text).strip("\n") for heading, text in texts.items()}


def entries(text: str) -> list[Entry]:
    """Return the entries of a section. A line without indent begins an entry; the indented lines below it are its meaning."""
    listed: list[Entry] = []
    for line in text.splitlines():
        if line and not line.startswith(" "):
            name, _, kind = line.partition(" : ")
            listed.append(Entry(name, kind, ""))
        elif line.strip():
            listed[-1] = listed[-1]._replace(meaning=f"{listed[-1].meaning} {line.strip()}".strip())
    return listed


def fields_of(thing: type) -> list[str]:
    """Return the names of a class that its docstring describes: members of an enumeration, public fields of a dataclass."""
    if issubclass(thing, enum.Enum):
        return list(thing.__members__)
    fields = dataclasses.fields(thing) if dataclasses.is_dataclass(thing) else ()
    return [field.name for field in fields if not field.name.startswith("_")]


def members_of(thing: type, kind: type) -> dict[str, Any]:
    """Return the public members of a class that have their own docstrings: properties (`property`) or methods (`FunctionType`)."""
    return {name: member for name, member in vars(thing).items() if isinstance(member, kind) and not name.startswith("_")}


def page() -> str:
    """The whole page as Markdown."""
    parts = [HEAD]
    for package in (la_core, comparison):
        parts += [f"## `{package.__name__}`\n", *(_entry(package, name) for name in package.__all__)]
    return "\n".join(parts)


def _entry(package: ModuleType, name: str) -> str:
    """Return the Markdown of a function or class: heading, call and text. A class also has its properties and methods."""
    thing = getattr(package, name)
    heading = f"### `{package.__name__}.{name}`\n"
    if not inspect.isclass(thing):
        return "\n".join([heading, *_call(thing), *_text(thing)])
    lines = [heading, *_text(thing)]
    for method_name, method in members_of(thing, FunctionType).items():
        lines += [f"#### `{name}.{method_name}`\n", *_call(method), *_text(method)]
    return "\n".join(lines)


def _call(function: Any) -> Iterator[str]:
    """Yield the call of a function as in its source, but without types. The list of parameters names the types."""
    tree = _source(function)
    arguments = tree.args
    for argument in (*arguments.args, *filter(None, [arguments.vararg])):
        argument.annotation = None
    arguments.args = [argument for argument in arguments.args if argument.arg != "self"]
    call = f"{tree.name}({ast.unparse(arguments)})".replace("'", '"')  # double quotes, as ruff formats code
    yield f"`{call}`\n"


def _source(function: Any) -> ast.FunctionDef:
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(function))).body
    assert isinstance(tree, ast.FunctionDef)
    return tree


def _text(thing: Any) -> Iterator[str]:
    """Yield a docstring as Markdown: its text, then its sections in their order."""
    for heading, text in sections(thing).items():
        if not heading:
            yield f"{text}\n"
        elif heading in LISTS:
            yield f"**{heading}**\n"
            yield from (_item(entry) for entry in _listed(thing, heading, text))
            yield ""
        elif heading == "Examples":
            yield f"```python\n{text}\n```\n"
        else:
            yield f"**{heading}**\n\n{text}\n"


def _listed(thing: Any, heading: str, text: str) -> list[Entry]:
    """Return the entries of a section for the page. Members have their values, and properties are among the attributes."""
    listed = entries(text)
    if heading == "Returns":
        return [Entry("", kind, meaning) for kind, _, meaning in listed]
    if heading == "Attributes" and issubclass(thing, enum.Enum):
        return [Entry(name, f'"{thing[name].value}"', meaning) for name, _, meaning in listed]
    return listed + (_properties(thing) if heading == "Attributes" else [])


def _properties(thing: type) -> list[Entry]:
    """Return the properties of a class: name, returned type and docstring."""
    kinds = {name: _source(member.fget).returns for name, member in members_of(thing, property).items()}
    return [Entry(name, ast.unparse(kind) if kind else "", _sentence(getattr(thing, name))) for name, kind in kinds.items()]


def _item(entry: Entry) -> str:
    """An entry of a list: name, type and meaning."""
    parts = [f"`{entry.name}`" if entry.name else "", f"*{entry.kind}*" if entry.kind else ""]
    return f"- {', '.join(filter(None, parts))}: {entry.meaning}"


def _sentence(member: Any) -> str:
    return " ".join((inspect.getdoc(member) or "").split())


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
