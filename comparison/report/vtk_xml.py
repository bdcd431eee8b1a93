"""XML files of VTK, which ParaView opens: an unstructured grid (.vtu) and a collection of grids (.pvd).

Source: Kitware, "VTK File Formats". Arrays are inline base64 of a 64-bit byte count and little-endian numbers.
"""

import base64
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from comparison.run_folder import write_text

VERTEX, POLYGON = 1, 7  # cell types of VTK
TYPES = {"f": ("Float64", "<f8"), "i": ("Int64", "<i8")}  # by the kind of a numpy type


@dataclass(frozen=True)
class Grid:
    """Cells of one type on points.

    Attributes
    ----------
    points : ndarray
        Positions (N, 3), m.
    connectivity : ndarray
        Points of all cells, one cell after the other; cell j has `connectivity[start[j]:start[j + 1]]`.
    start : ndarray
        First place of each cell in `connectivity`, and the end (M + 1,).
    cell_type : int
        VERTEX or POLYGON, for all cells.
    point_data, cell_data : mapping of str to ndarray
        Values of every point (N,) or (N, k), and of every cell (M,) or (M, k), by name; texts as arrays of objects.
    field_data : mapping of str to float or str
        Values of the whole grid, by name.
    """

    points: np.ndarray
    connectivity: np.ndarray
    start: np.ndarray
    cell_type: int
    point_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    cell_data: Mapping[str, np.ndarray] = field(default_factory=dict)
    field_data: Mapping[str, float | str] = field(default_factory=dict)


def write_grid(path: Path, grid: Grid) -> None:
    """Write a grid as a .vtu file."""
    cells = len(grid.start) - 1
    topology = {"connectivity": grid.connectivity, "offsets": grid.start[1:], "types": np.full(cells, grid.cell_type)}
    parts = [
        _element("Points", [_array("points", grid.points)]),
        _element("Cells", [_array(name, values) for name, values in topology.items()]),
        _element("PointData", [_array(name, values) for name, values in grid.point_data.items()]),
        _element("CellData", [_array(name, values) for name, values in grid.cell_data.items()]),
    ]
    piece = _element("Piece", parts, NumberOfPoints=len(grid.points), NumberOfCells=cells)
    whole = [_field(name, value) for name, value in grid.field_data.items()]
    _write(path, "UnstructuredGrid", _element("UnstructuredGrid", [_element("FieldData", whole), piece]))


def write_collection(path: Path, rows: Iterable[tuple[float, Sequence[str]]]) -> None:
    """Write a collection as a .pvd file.

    Each row is a time (here a settlement, m or rad) and the names of its grids, which lie beside the file.
    """
    entries = [
        _element("DataSet", [], timestep=repr(float(time)), part=part, file=name) for time, names in rows for part, name in enumerate(names)
    ]
    _write(path, "Collection", _element("Collection", entries))


def _write(path: Path, kind: str, content: str) -> None:
    file = _element("VTKFile", [content], type=kind, version="1.0", byte_order="LittleEndian", header_type="UInt64")
    write_text(path, f'<?xml version="1.0"?>\n{file}\n')


def _element(tag: str, content: Sequence[str], **attributes: object) -> str:
    opening = "".join([tag, *(f" {name}={quoteattr(str(value))}" for name, value in attributes.items())])
    return "\n".join([f"<{opening}>", *content, f"</{tag}>"])


def _field(name: str, value: float | str) -> str:
    """Return one value of a whole grid as an array of one entry."""
    if isinstance(value, str):
        return _texts(name, [value], NumberOfTuples=1)
    return _array(name, np.array([float(value)]), NumberOfTuples=1)


def _texts(name: str, texts: Iterable[str], **attributes: object) -> str:
    """Return an array of texts as VTK reads them: the numbers of their bytes, a zero after each text."""
    codes = " ".join(str(code) for text in texts for code in (*text.encode("utf-8"), 0))
    return _element("DataArray", [codes], type="String", Name=name, **attributes, format="ascii")


def _array(name: str, values: np.ndarray, **attributes: object) -> str:
    if values.dtype.kind == "O":
        return _texts(name, values.tolist(), **attributes)
    kind, dtype = TYPES["f" if values.dtype.kind == "f" else "i"]
    data = np.ascontiguousarray(values, dtype=dtype).tobytes()
    text = base64.b64encode(np.array(len(data), dtype="<u8").tobytes() + data).decode("ascii")
    width = values.shape[1] if values.ndim == 2 else 1
    return _element("DataArray", [text], type=kind, Name=name, NumberOfComponents=width, **attributes, format="binary")
