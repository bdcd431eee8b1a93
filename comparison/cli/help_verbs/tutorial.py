"""Walk-throughs for students: scripts in cells of text and code that are told, run and drawn, or written as notebooks."""

import argparse
import contextlib
import io
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.markdown import Markdown

from comparison.cli.exit_codes import AGREE
from comparison.run_folder import write_text
from comparison.yade import find_yade
from la_core.errors import SceneError, nearest

SCRIPTS = Path(__file__).parents[2] / "tutorials"
NAMES = ("pads", "friction", "arch", "wall", "disagreement")  # in the order of reading
WIDTH = 100  # columns of text
_CELL = re.compile(r"^# %%(.*)$", re.MULTILINE)


@dataclass(frozen=True)
class Cell:
    """Text in Markdown, or code. line: of its first line in the script."""

    is_text: bool
    source: str
    line: int


def cells(name: str) -> list[Cell]:
    """The cells of a walk-through's script (percent format); raises SceneError for a name that is none."""
    if name not in NAMES:
        raise SceneError(f'the tutorial "{name}"', "is none", hint=nearest(name, NAMES, "tutorials"))
    script = (SCRIPTS / f"{name}.py").read_text(encoding="utf-8")
    _, *parts = _CELL.split(script)
    found, line = [], 1
    for mark, body in zip(parts[::2], parts[1::2], strict=True):
        is_text = "[markdown]" in mark
        source = re.sub(r"^# ?", "", body, flags=re.MULTILINE) if is_text else body
        found.append(Cell(is_text, source.strip("\n"), line + len(body) - len(body.lstrip("\n"))))
        line += body.count("\n")
    return found


def title(name: str) -> str:
    """The heading of a walk-through."""
    return cells(name)[0].source.splitlines()[0].removeprefix("# ")


def run_cells(name: str, folder: Path) -> Iterator[tuple[Cell, str, list[Path]]]:
    """Run a walk-through in a folder, cell by cell: each with what it printed and the figures it drew.

    Raises YadeMissingError where YADE is missing, before anything is run.
    """
    found = cells(name)
    find_yade()
    folder.mkdir(parents=True, exist_ok=True)
    space: dict[str, Any] = {"__name__": name}
    script = str(SCRIPTS / f"{name}.py")
    for cell in found:
        before, said = _figures(folder, name), io.StringIO()
        if not cell.is_text:
            program = compile("\n" * (cell.line - 1) + cell.source, script, "exec")
            with contextlib.chdir(folder), contextlib.redirect_stdout(said):
                exec(program, space)
        after = _figures(folder, name)
        yield cell, said.getvalue(), [path for path, written in after.items() if before.get(path) != written]


def _figures(folder: Path, name: str) -> dict[Path, int]:
    """A walk-through's figures and when each was written."""
    return {path: path.stat().st_mtime_ns for path in sorted(folder.glob(f"{name}-*.png"))}


def notebook(name: str) -> dict[str, Any]:
    """A walk-through as a notebook of the format 4.5, without outputs."""
    made: list[dict[str, Any]] = []
    for number, cell in enumerate(cells(name), 1):
        kind: dict[str, Any] = {"cell_type": "markdown"} if cell.is_text else {"cell_type": "code", "execution_count": None, "outputs": []}
        made.append(kind | {"id": f"{name}-{number}", "metadata": {}, "source": cell.source.splitlines(keepends=True)})
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    return {"cells": made, "metadata": {"kernelspec": kernel, "language_info": {"name": "python"}}, "nbformat": 4, "nbformat_minor": 5}


def write_notebooks(names: tuple[str, ...], folder: Path) -> list[Path]:
    """Write walk-throughs as notebooks; returns their paths."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{name}.ipynb" for name in names]
    for name, path in zip(names, paths, strict=True):
        write_text(path, json.dumps(notebook(name), indent=1, ensure_ascii=False) + "\n")
    return paths


def tutorial(options: argparse.Namespace, console: Console, print_json: Callable[[Any], None]) -> int:
    """Do what `crosscheck tutorial` was asked for on the console, or print it as one JSON object; returns the exit code."""
    console.quiet = options.json
    if options.notebook:
        paths = [str(path) for path in write_notebooks((options.name,) if options.name else NAMES, options.output)]
        console.print("\n".join(paths), markup=False)
        told: dict[str, Any] = {"files": paths}
    elif options.name is None:
        told = {"tutorials": [{"name": name, "title": title(name)} for name in NAMES]}
        console.print("\n".join(f"  {row['name']:<14}{row['title']}" for row in told["tutorials"]), markup=False)
    else:
        told = {"tutorial": options.name, "title": title(options.name), "cells": []}
        for cell, said, figures in run_cells(options.name, options.output):
            _tell(console, cell, said, figures)
            kind = "text" if cell.is_text else "code"
            told["cells"].append({kind: cell.source, "output": said, "figures": [str(path) for path in figures]})
    if options.json:
        print_json(told)
    return AGREE


def _tell(console: Console, cell: Cell, said: str, figures: list[Path]) -> None:
    """One cell on the console: text as text, code set apart, what it printed, and where its figures are."""
    if cell.is_text:
        console.print(Markdown(cell.source), width=WIDTH, soft_wrap=False)
    else:
        console.print("\n".join(f"    {line}".rstrip() for line in cell.source.splitlines()), style="dim", markup=False)
        console.print(said, end="", markup=False)
        console.print("".join(f"figure: {path}\n" for path in figures), end="", markup=False)
    console.print()
