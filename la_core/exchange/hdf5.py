"""Write, read and check HDF5 files by the fields of a schema; every fault of a file is an ExchangeError."""

import contextlib
import datetime
import io
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from la_core.exchange.checksummed_file import SEAL_BYTES, VERSION, ExchangeError, read_sealed, write_sealed
from la_core.exchange.fields import Field

MADE_AT = "time"  # in `made_by`
_TEXT, _SCALAR = h5py.h5t.py_create(h5py.string_dtype(), logical=True), h5py.h5s.create(h5py.h5s.SCALAR)  # of labels


def write(
    path: Path,
    fields: tuple[Field, ...],
    values: Mapping[str, Any],
    inputs: str,
    made_by: Mapping[str, str] | None = None,
    is_dated: bool = True,
) -> None:
    """Write a file; a crash leaves the previous one.

    Parameters
    ----------
    path : Path
        File to write.
    fields : tuple of Field
        Schema of the file.
    values : mapping
        Value of each field, by its path.
    inputs : str
        Digest of the inputs that made the values.
    made_by : mapping of str to str, optional
        Versions of the programs that made the values, and their machine. The file keeps them with its time, see `made_by`.
    is_dated : bool
        Whether the file keeps the time and `made_by`. Without them, equal values give equal bytes.

    Raises
    ------
    ExchangeError
        A field has no value.
    """
    missing = [field.path for field in fields if field.path not in values]
    if missing:
        raise ExchangeError(f"{path}: not written: no value for {', '.join(missing)}")
    content = io.BytesIO()
    with h5py.File(content, "w", userblock_size=SEAL_BYTES) as file:
        file.attrs["version"] = VERSION
        file.attrs["inputs"] = np.bytes_(inputs.encode())
        if is_dated:
            time = datetime.datetime.now().astimezone().isoformat(timespec="seconds")
            file.attrs["made_by"] = np.bytes_(json.dumps({**(made_by or {}), MADE_AT: time}).encode())
        groups: dict[str, Any] = {}
        for field in fields:
            place, _, name = field.path.rpartition("/")
            if place not in groups:
                groups[place] = file.require_group(place or "/")
            dataset = groups[place].create_dataset(name, data=_stored(field, values[field.path]))
            _label(dataset, b"unit", field.unit)
            _label(dataset, b"meaning", field.meaning)
    write_sealed(path, content.getvalue())


def _label(dataset: Any, name: bytes, text: str) -> None:
    """Give a new dataset an attribute; `dataset.attrs` first looks for an old one, which took a third of the time of a small file."""
    attribute = h5py.h5a.create(dataset.id, name, _TEXT, _SCALAR)
    attribute.write(np.array(text, dtype=h5py.string_dtype()))


def _stored(field: Field, value: Any) -> np.ndarray:
    """A value as stored; texts are UTF-8 of fixed length, because a damaged heap of texts can trap HDF5 in an endless loop."""
    if field.dtype != "str":
        return np.asarray(value, dtype=field.dtype)
    texts = np.char.encode(np.asarray(value, dtype=str), "utf-8")
    return texts.astype(h5py.string_dtype("utf-8", max(1, texts.dtype.itemsize)))


def inputs_digest(path: Path) -> str:
    """Digest of the inputs that made `path`, or "" where there is no whole file of this version."""
    try:
        with _opened(path) as file:
            return bytes(file.attrs["inputs"]).decode()
    except ExchangeError:
        return ""


def made_by(path: Path | str) -> dict[str, str]:
    """Versions and machine that made the file `path`, and the time, under MADE_AT; empty where the file does not state them.

    The time is local, with its zone, in ISO 8601. The times of the file system are not used, because a copy has other times.
    """
    try:
        with _opened(Path(path)) as file:
            stored = json.loads(bytes(file.attrs["made_by"]).decode()) if "made_by" in file.attrs else {}
            made = {str(name): str(value) for name, value in stored.items()}
            has_zone = MADE_AT not in made or datetime.datetime.fromisoformat(made[MADE_AT]).tzinfo is not None
    except ExchangeError:  # also for a record of another form
        return {}
    return made if has_zone else {}


def holds(path: Path, group: str) -> bool:
    """Whether the file can be read and has this group."""
    try:
        with _opened(path) as file:
            return group in file
    except ExchangeError:
        return False


def present(path: Path, fields: tuple[Field, ...]) -> tuple[Field, ...]:
    """The given fields that the file has; none where it cannot be read."""
    try:
        with _opened(path) as file:
            return tuple(field for field in fields if field.path in file)
    except ExchangeError:
        return ()


def read(path: Path | str, fields: tuple[Field, ...]) -> dict[str, Any]:
    """Read and check every field; return the values by path, texts as `str` and arrays as numpy.

    Raises ExchangeError for a field that is missing or has another type or shape than the schema.
    """
    file_path, sizes = Path(path), dict[str, int]()
    with _opened(file_path) as file:
        return {field.path: _checked(file_path, file, field, sizes) for field in fields}


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open the HDF5 file at `path`; a broken seal, and every error of HDF5, is an ExchangeError."""
    content = read_sealed(path)
    try:
        with h5py.File(h5py.h5f.open_file_image(content)) as file:
            yield file
    except ExchangeError:
        raise
    except Exception as error:
        raise ExchangeError(f"{path}: not an HDF5 file of this program ({type(error).__name__}: {error}); run the scene again") from error


@contextlib.contextmanager
def values_of(path: Path) -> Iterator[None]:
    """Turn every error of Python about the values of a file into an ExchangeError."""
    try:
        yield
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError, RecursionError) as error:
        fault = f"invalid value ({type(error).__name__}: {error}), the file is damaged"
        raise ExchangeError(f"{path}: {fault}; run the scene again") from error


def _checked(path: Path, file: Any, field: Field, sizes: dict[str, int]) -> Any:
    dataset = _own_dataset(file, field.path)
    if dataset is None:
        raise ExchangeError(f"{path}: {field.path} ({field.meaning}) is missing{_why_missing(file, field.path)} run the scene again")
    if dataset.external or dataset.is_virtual or dataset.chunks or dataset.nbytes > file.id.get_filesize():
        raise ExchangeError(f"{path}: {field.path} is not stored as plain data in one piece; run the scene again")
    text_type = h5py.check_string_dtype(dataset.dtype)
    is_text = text_type is not None and text_type.length is not None
    if is_text != (field.dtype == "str") or (not is_text and dataset.dtype != np.dtype(field.dtype)):
        raise ExchangeError(f"{path}: {field.path} holds {dataset.dtype}, the schema says {field.dtype}; run the scene again")
    expected = tuple(n if isinstance(n, int) else sizes.setdefault(n, size) for n, size in zip(field.shape, dataset.shape, strict=False))
    if dataset.ndim != len(field.shape) or dataset.shape != expected:
        rule = f"the schema says {field.shape} = {expected}"
        raise ExchangeError(f"{path}: {field.path} has shape {dataset.shape}, {rule}; run the scene again")
    if is_text:
        text = dataset.asstr()[()]
        return text if field.shape == () else [str(item) for item in text]
    return dataset[()]


def _why_missing(file: Any, path: str) -> str:
    """Return the middle of the message on a missing field; it names the groups of the file where the file lacks the group of the field."""
    group, place = path.rpartition("/")[0], file
    for step in filter(None, group.split("/")):
        if not isinstance(place.get(step, getlink=True), h5py.HardLink) or not isinstance(place[step], h5py.Group):
            has = ", ".join(name for name in place if isinstance(place.get(name, getlink=True), h5py.HardLink))
            return f", because the file has no group {group}, and {place.name} holds {has or 'nothing'}; read another group, or"
        place = place[step]
    return ";"


def _own_dataset(file: Any, path: str) -> Any:
    """The dataset at a path, or None; links are not followed, because they may lead to other files."""
    place = file
    for step in path.split("/"):
        if not isinstance(place, h5py.Group) or not isinstance(place.get(step, getlink=True), h5py.HardLink):
            return None
        place = place[step]
    return place if isinstance(place, h5py.Dataset) else None
