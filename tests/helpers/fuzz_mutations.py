"""Random and deliberate damage to files: bytes, numbers, lines, nesting and quoted words of a text; datasets and links of an HDF5 file."""

import io
import random
import re
from collections.abc import Callable
from typing import Any

import h5py
import numpy as np

from la_core.exchange.checksummed_file import SEAL_BYTES

NUMBER = re.compile(r"(?<![\w.])-?\d[\d_.]*(?:e[-+]?\d+)?")
QUOTED = re.compile(r'"[^"\n]*"')
EXTREMES = (
    "nan", "inf", "-inf", "0", "-0.0", "-1", "0.5", "1e-308", "1e-13", "1e11", "1e13", "1e308", "-1e308", "1" + "0" * 30, "9" * 5000,
    "100000", "100001", "9223372036854775808", "true", '"text"', "[]", "{}", "null", "1979-05-27", "3 4", "",
)  # fmt: skip
TEXTS = (
    "x" * 100_000, "x" * 250, "", " ", "\\u0000", "\\u001b[2J", "\\ud800", "\\u202e", "../../etc/passwd", "/etc/passwd", "a\\nb",
    "%s{0}$HOME",
    "<script>alert(1)</script>", "[red]", "é" * 40, "\U0001f9f1" * 99, "\u202e\u2066", "\x07\x1b", "fixed", "support", "free", "*", "[!",
    "con",
)  # fmt: skip
FACTORS = (-1.0, 0.0, 1e-9, 1e-3, 0.1, 0.5, 1.0 - 1e-9, 1.0 + 1e-9, 1.0 + 1e-5, 1.1, 2.0, 3.0, 10.0, 1e3, 1e6)
DEPTHS = (10, 120, 3000, 100_000)


def mutated_text(content: bytes, other: bytes, chance: random.Random) -> bytes:
    """Return a text after one to three changes. other: a text from which lines may be taken."""
    for _ in range(chance.choice((1, 1, 2, 3))):
        content = chance.choice(TEXT_CHANGES)(content, other, chance)
    return content


def _bytes(content: bytes, other: bytes, chance: random.Random) -> bytes:
    place, room = chance.randrange(len(content) + 1), chance.choice((0, 1, 1, 4, 40))
    return content[:place] + chance.randbytes(chance.choice((0, 1, 1, 4))) + content[place + room :]


def _number(content: bytes, other: bytes, chance: random.Random) -> bytes:
    return _replaced(content, NUMBER, chance.choice(EXTREMES), chance)


def _scaled(content: bytes, other: bytes, chance: random.Random) -> bytes:
    """Multiply one number by a factor of FACTORS, some of them nearly one."""
    text = content.decode("utf-8", "surrogateescape")
    if not (found := list(NUMBER.finditer(text))):
        return content
    start, end = (one := chance.choice(found)).span()
    value = float(one[0].replace("_", "") if len(one[0]) < 300 else 1.0) * chance.choice(FACTORS)
    by = str(round(value)) if "." not in one[0] and chance.random() < 0.9 and abs(value) < 1e15 else repr(value)
    return (text[:start] + by + text[end:]).encode("utf-8", "surrogateescape")


def _quoted(content: bytes, other: bytes, chance: random.Random) -> bytes:
    return _replaced(content, QUOTED, f'"{chance.choice(TEXTS)}"', chance)


def _replaced(content: bytes, pattern: re.Pattern[str], by: str, chance: random.Random) -> bytes:
    text = content.decode("utf-8", "surrogateescape")
    if not (found := list(pattern.finditer(text))):
        return content
    start, end = chance.choice(found).span()
    return (text[:start] + by + text[end:]).encode("utf-8", "surrogateescape")


def _lines(content: bytes, other: bytes, chance: random.Random) -> bytes:
    """Remove a line, insert lines of the same or of the other text, or do both."""
    lines, source = content.split(b"\n"), chance.choice((content, other)).split(b"\n")
    if chance.random() < 0.5:
        del lines[chance.randrange(len(lines))]
    if not lines or chance.random() < 0.7:
        start = chance.randrange(len(source))
        place = chance.randrange(len(lines) + 1)
        lines[place:place] = source[start : start + chance.choice((1, 1, 5))]
    return b"\n".join(lines)


def _nesting(content: bytes, other: bytes, chance: random.Random) -> bytes:
    depth = chance.choice(DEPTHS)
    objects, dotted = '{"a":' * depth + "1" + "}" * depth, "a." * min(depth, 3000)
    deep = chance.choice(("[" * depth, "[" * depth + "]" * depth, "{a=" * depth, objects, dotted))
    if chance.random() < 0.5:
        return _replaced(content, NUMBER, deep, chance)
    place = chance.choice([m.start() for m in re.finditer(rb"\n|$", content)])
    return content[:place] + f"\ndeep = {deep}\n".encode() + content[place:]


def _cut(content: bytes, other: bytes, chance: random.Random) -> bytes:
    return content[: chance.randrange(len(content) + 1)]


Change = Callable[[bytes, bytes, random.Random], bytes]
TEXT_CHANGES: tuple[Change, ...] = (_bytes, _number, _number, _scaled, _scaled, _scaled, _quoted, _lines, _nesting, _cut)


def mutated_bytes(content: bytes, chance: random.Random) -> bytes:
    """Return a binary file after one to four changes: bits, numbers at their limits, random bytes, a piece lost, doubled or cut off."""
    damaged = bytearray(content)
    for _ in range(chance.randint(1, 4)):
        place, size = chance.randrange(len(damaged) + 1), chance.choice((1, 2, 4, 8, 64))
        kind = chance.randrange(6)
        if kind == 0 and place < len(damaged):
            damaged[place] ^= 1 << chance.randrange(8)
        elif kind == 1:
            damaged[place : place + size] = chance.choice((b"\xff", b"\x00", b"\x7f", b"\x80")) * size
        elif kind == 2:
            damaged[place : place + size] = chance.randbytes(size)
        elif kind == 3:
            del damaged[place : place + size]
        elif kind == 4:
            damaged[place:place] = damaged[place : place + size]
        elif chance.random() < 0.2:
            del damaged[place:]
    return bytes(damaged)


def forged(content: bytes, chance: random.Random) -> bytes:
    """Return an exchange file that another program has changed: its bytes, or its datasets through HDF5."""
    if chance.random() < 0.5:
        return content[:SEAL_BYTES] + mutated_bytes(content[SEAL_BYTES:], chance)
    image = io.BytesIO(content)
    with h5py.File(image, "r+") as file:
        names: list[str] = []
        file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
        for name in chance.sample(names, chance.randint(1, 2)):
            _change(file, name, chance)
    return image.getvalue()


def _change(file: h5py.File, name: str, chance: random.Random) -> None:
    kind, old = chance.randrange(9), file[name]
    if kind <= 2:  # a value of the same kind and shape
        old[()] = _values(old, chance)
        return
    shape = chance.choice(((), (0,), (1,), (3,), (0, 3), (2, 3), (6,), old.shape, (*old.shape, 1), old.shape[:-1]))
    del file[name]
    if kind == 3:
        file[name] = h5py.ExternalLink("/etc/passwd", "/")
    elif kind == 4:
        file[name] = h5py.SoftLink(chance.choice(("/scene/name", "/nowhere", f"/{name}")))
    elif kind == 5:
        file.create_dataset(name, data=np.zeros(shape, chance.choice(("f8", "f4", "i8", "u1", "S8", "c16", "V4"))))
    elif kind == 6:
        file.create_dataset(name, shape=(10**9, 3), dtype="f8", chunks=(1000, 3), fillvalue=1.0)
    elif kind == 7:
        file.create_dataset(name, data=chance.choice(TEXTS).encode("utf-8", "replace").replace(b"\0", b""), dtype=h5py.string_dtype())


def _values(old: h5py.Dataset, chance: random.Random) -> Any:
    if old.dtype.kind == "O":
        texts = [chance.choice((*TEXTS, "null", "{}", "[]", "[" * 2000, "1", '{"asked": 1}')).replace("\0", "") for _ in range(old.size)]
        return np.array(texts, dtype=object).reshape(old.shape) if old.shape else texts[0]
    values = np.array(old[()])
    numbers = (-1, 0, 1, 7, 255, 2**62, -(2**63)) if old.dtype.kind in "iu" else (np.nan, np.inf, -np.inf, 0.0, -1.0, 1e308, 1e-308, 3.7)
    chosen = np.array([chance.choice(numbers) for _ in range(values.size)]).reshape(values.shape)
    few = np.array([chance.random() < 0.2 for _ in range(values.size)]).reshape(values.shape)
    with np.errstate(all="ignore"):
        return np.where(few, chosen, values).astype(old.dtype)
