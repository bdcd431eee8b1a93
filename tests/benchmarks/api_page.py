"""Write the page of the Python interface from its docstrings: `.venv/bin/python tests/benchmarks/api_page.py`."""

import ast
import dataclasses
import doctest
import inspect
import textwrap
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import comparison
import la_core

PAGE = Path(comparison.__file__).parent / "gallery" / "api.md"
HEAD = """# From Python: the stable names

`la_core` solves, `comparison` takes a scene through both methods; what is named here stays as it is, everything else may change.
A mistake in a scene raises `la_core.SceneError`, whose message says where, what and how to mend it. A notebook shows scenes, answers,
results and pictures by themselves. This page is written by `.venv/bin/python tests/benchmarks/api_page.py` from the docstrings.
"""


def page() -> str:
    """The whole page as Markdown."""
    parts = [HEAD]
    for package in (la_core, comparison):
        parts += [f"## `{package.__name__}`\n", *(_entry(package, name) for name in package.__all__)]
    return "\n".join(parts)


def _entry(package: ModuleType, name: str) -> str:
    """A function or class: what it is called with, what it says, and of a class its public members."""
    thing = getattr(package, name)
    lines = [f"### `{package.__name__}.{name}{_arguments(thing)}`\n", *_words(thing)]
    if inspect.isclass(thing):
        lines += [f"- {member}" for member in _members(thing)] + [""]
    return "\n".join(lines)


def _arguments(thing: Any) -> str:
    """What a function is called with, as its source has it; nothing for a class."""
    if inspect.isclass(thing):
        return ""
    (function,) = ast.parse(textwrap.dedent(inspect.getsource(thing))).body
    assert isinstance(function, ast.FunctionDef)
    arguments = ast.unparse(
        ast.arguments([], [a for a in function.args.args if a.arg != "self"], None, [], [], None, function.args.defaults)
    )
    if function.args.vararg:
        arguments = f"*{ast.unparse(function.args.vararg)}"
    return f"({arguments})" + (f" -> {ast.unparse(function.returns)}" if function.returns else "")


def _words(thing: Any) -> Iterator[str]:
    """A docstring's text, and its examples apart as code."""
    words, examples = [], []
    for part in doctest.DocTestParser().parse(inspect.getdoc(thing) or ""):
        if isinstance(part, doctest.Example):
            examples.append(f">>> {part.source}{part.want}".rstrip())
        elif part.strip():
            words.append(part.strip())
    yield "\n".join(words) + "\n"
    if examples:
        yield "\n".join(["```python", *examples, "```\n"])


def _members(thing: type) -> Iterator[str]:
    """Public fields, values, properties and methods of a class, one a line."""
    if issubclass(thing, str):
        yield from (f"`{member.name}`: `{member.value}`" for member in thing)  # type: ignore[attr-defined]
        return
    fields = [field.name for field in dataclasses.fields(thing)] if dataclasses.is_dataclass(thing) else []
    if fields:
        yield "fields: " + ", ".join(f"`{name}`" for name in fields)
    for name, member in vars(thing).items():
        if not name.startswith("_") and isinstance(member, property):
            yield f"`{name}`: {_sentence(member)}"
        elif not name.startswith("_") and inspect.isfunction(member):
            yield f"`{name}{_arguments(member)}`: {_sentence(member)}"


def _sentence(member: Any) -> str:
    return " ".join((inspect.getdoc(member) or "").split())


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
