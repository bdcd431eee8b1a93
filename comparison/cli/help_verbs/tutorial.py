"""Tutorials for students: scripts of text and code cells, run on the console or written as notebooks."""

import contextlib
import io
import json
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markdown import Markdown

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE
from comparison.run_folder import write_text
from comparison.yade import find_yade
from la_core.errors import SceneError, nearest

SCRIPTS = Path(__file__).parents[2] / "tutorials"
NAMES = ("pads", "friction", "arch", "wall", "disagreement", "push")  # in the order of reading
ANSWER = "**Answer.**"  # begins the answer to a tutorial's question, the last part of its cell
WIDTH = 100  # columns of text
_CELL = re.compile(r"^# %%(.*)$", re.MULTILINE)


@dataclass(frozen=True)
class Cell:
    """A cell of a tutorial.

    Attributes
    ----------
    is_text : bool
        True for Markdown text, False for Python code.
    source : str
        Text or code, without the comment marks of the script.
    line : int
        Number of the cell's first line in the script, from 1.
    """

    is_text: bool
    source: str
    line: int


def cells(name: str) -> list[Cell]:
    """Return the cells of a tutorial's script (percent format); raises SceneError for an unknown name."""
    if name not in NAMES:
        raise SceneError(f'the tutorial "{name}"', "unknown", hint=nearest(name, NAMES, "tutorials"))
    script = (SCRIPTS / f"{name}.py").read_text(encoding="utf-8")
    _, *marks_and_bodies = _CELL.split(script)
    script_cells, line = [], 1
    for mark, body in zip(marks_and_bodies[::2], marks_and_bodies[1::2], strict=True):
        is_text = "[markdown]" in mark
        source = re.sub(r"^# ?", "", body, flags=re.MULTILINE) if is_text else body
        script_cells.append(Cell(is_text, source.strip("\n"), line + len(body) - len(body.lstrip("\n"))))
        line += body.count("\n")
    return script_cells


def title(name: str) -> str:
    """Return the heading of a tutorial."""
    return cells(name)[0].source.splitlines()[0].removeprefix("# ")


def run_cells(name: str, folder: Path) -> Iterator[tuple[Cell, str, list[Path]]]:
    """Run a tutorial in a folder cell by cell; yields each cell, its printed output and the paths of the figures it drew.

    Raises YadeMissingError before the first cell if YADE is missing.
    """
    script_cells = cells(name)
    find_yade()
    folder.mkdir(parents=True, exist_ok=True)
    space: dict[str, Any] = {"__name__": name}
    script = str(SCRIPTS / f"{name}.py")
    for cell in script_cells:
        before, output = _figures(folder, name), io.StringIO()
        if not cell.is_text:
            program = compile("\n" * (cell.line - 1) + cell.source, script, "exec")
            with contextlib.chdir(folder), contextlib.redirect_stdout(output):
                exec(program, space)
        after = _figures(folder, name)
        yield cell, output.getvalue(), [path for path, written in after.items() if before.get(path) != written]


def _figures(folder: Path, name: str) -> dict[Path, int]:
    """Return the modification time (ns) of each of a tutorial's figures, by path."""
    return {path: path.stat().st_mtime_ns for path in sorted(folder.glob(f"{name}-*.png"))}


def notebook(name: str) -> dict[str, Any]:
    """Return a tutorial as a notebook (format 4.5) without outputs."""
    notebook_cells: list[dict[str, Any]] = []
    for number, cell in enumerate(cells(name), 1):
        code: dict[str, Any] = {"cell_type": "code", "execution_count": None, "outputs": []}
        kind = {"cell_type": "markdown"} if cell.is_text else code
        source = folded(cell.source) if cell.is_text else cell.source
        notebook_cells.append(kind | {"id": f"{name}-{number}", "metadata": {}, "source": source.splitlines(keepends=True)})
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    metadata = {"kernelspec": kernel, "language_info": {"name": "python"}}
    return {"cells": notebook_cells, "metadata": metadata, "nbformat": 4, "nbformat_minor": 5}


def folded(text: str) -> str:
    """Return a cell's text with the answer to its question folded, so that a reader can think first."""
    question, mark, answer = text.partition(ANSWER)
    return f"{question}<details><summary>Answer</summary>\n\n{answer.strip()}\n\n</details>" if mark else text


def write_notebooks(names: tuple[str, ...], folder: Path) -> list[Path]:
    """Write tutorials as notebooks into a folder; returns their paths. Raises SceneError before a student's work would be replaced."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {folder / f"{name}.ipynb": json.dumps(notebook(name), indent=1, ensure_ascii=False) + "\n" for name in names}
    for path, text in texts.items():
        if path.exists() and path.read_bytes() != text.encode():
            raise SceneError(
                str(path), "exists with other content and is not replaced", hint="name another folder with -o, or move the file"
            )
    for path, text in texts.items():
        write_text(path, text)
    return list(texts)


def execute(context: Context) -> int:
    """List the tutorials, run one on the console or write notebooks; with `--json`, print the same as one JSON object."""
    options, console = context.options, context.out
    console.quiet = options.json
    if options.notebook:
        paths = [str(path) for path in write_notebooks((options.name,) if options.name else NAMES, options.output)]
        console.print("\n".join(paths), markup=False)
        result: dict[str, Any] = {"files": paths}
    elif options.name is None:
        result = {"tutorials": [{"name": name, "title": title(name)} for name in NAMES]}
        console.print("\n".join(f"  {row['name']:<14}{row['title']}" for row in result["tutorials"]), markup=False)
    else:
        result = {"tutorial": options.name, "title": title(options.name), "cells": []}
        for cell, output, figures in run_cells(options.name, options.output):
            _print_cell(console, cell, output, figures)
            kind = "text" if cell.is_text else "code"
            result["cells"].append({kind: cell.source, "output": output, "figures": [str(path) for path in figures]})
    if options.json:
        context.print_json(result)
    return AGREE


def _print_cell(console: Console, cell: Cell, output: str, figures: list[Path]) -> None:
    """Print a cell: Markdown as text, code indented, then its output and the paths of its figures."""
    if cell.is_text:
        console.print(Markdown(cell.source), width=WIDTH, soft_wrap=False)
    else:
        console.print("\n".join(f"    {line}".rstrip() for line in cell.source.splitlines()), style="dim", markup=False)
        console.print(output, end="", markup=False)
        console.print("".join(f"figure: {path}\n" for path in figures), end="", markup=False)
    console.print()
