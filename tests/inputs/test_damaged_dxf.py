"""DXF files with a fault that a reader could pass over: entities that would vanish or move are told of in words."""

import pytest
from wall_drawings import dxf, polyline

from la_core.drawing import read_outlines

SQUARE = [(0, 0), (1000, 0), (1000, 500), (0, 500)]
BESIDE = [(1000, 0), (2000, 0), (2000, 500), (1000, 500)]


def with_handle(entity: str, handle: str) -> str:
    """An entity that has a handle."""
    kind, rest = entity.split("100\n", 1)
    return f"{kind}5\n{handle}\n100\n{rest}"


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (dxf([with_handle(polyline(points, "A"), "1F") for points in (SQUARE, BESIDE)]), "with the same handle 1F (code 5)"),
        (dxf([polyline(SQUARE, "A").replace("\n500\n", "\n500,25\n")]), 'holds "500,25" near its line '),
        (dxf([polyline(SQUARE, "A").replace("\n500\n", "\n1.#QNAN\n")]), 'holds "1.#QNAN" near its line '),
    ],
)
def test_a_file_whose_entities_would_vanish_or_move_is_refused(content: bytes, words: str) -> None:
    with pytest.raises(ValueError) as error:
        read_outlines(".dxf", content, None, 0.005)
    assert words in str(error.value)


def test_handles_that_differ_are_read() -> None:
    content = dxf([with_handle(polyline(points, "A"), handle) for points, handle in ((SQUARE, "1E"), (BESIDE, "1F"))])
    assert len(read_outlines(".dxf", content, None, 0.005).outlines) == 2
