"""Copies by <use> draw the same outlines as a drawing without copies."""

import numpy as np
import pytest

from la_core.drawing import Drawn, lacking_words, read_outlines, svg

NAMES = 'xmlns="http://www.w3.org/2000/svg" xmlns:xlink="http://www.w3.org/1999/xlink"'
PAGE = 'width="2000mm" height="1500mm" viewBox="0 0 2000 1500"'
STONE = '<defs><rect id="stone" width="500" height="250"/></defs>'
# a drawing with copies, and the same one without
SAME = {
    "place": (f'{STONE}<use href="#stone" x="100" y="50"/>', '<rect x="100" y="50" width="500" height="250"/>'),
    "old link": (f'{STONE}<use xlink:href="#stone"/>', '<rect width="500" height="250"/>'),
    "place after transform": (
        f'{STONE}<use href="#stone" x="100" transform="rotate(30)"/>',
        '<g transform="rotate(30)"><rect x="100" width="500" height="250"/></g>',
    ),
    "share of the page": (f'{STONE}<use href="#stone" x="50%"/>', '<rect x="1000" width="500" height="250"/>'),
    "visible original": (
        '<rect id="first" width="500" height="250" transform="translate(10, 20)"/><use href="#first" y="300"/>',
        '<rect x="10" y="20" width="500" height="250"/><rect x="10" y="320" width="500" height="250"/>',
    ),
    "transform of the original's group": (
        '<g transform="scale(2)"><rect id="first" width="500" height="250"/></g><use href="#first"/>',
        '<rect width="1000" height="500"/><rect width="500" height="250"/>',
    ),
    "group, before it is drawn": (
        '<use href="#pair" x="1000"/><g id="pair"><rect width="500" height="250"/><rect x="500" width="400" height="250"/></g>',
        '<g id="pair"><rect x="1000" width="500" height="250"/><rect x="1500" width="400" height="250"/></g>'
        '<g id="pair"><rect width="500" height="250"/><rect x="500" width="400" height="250"/></g>',
    ),
    "copy of copies": (
        f'{STONE}<defs><g id="two"><use href="#stone"/><use href="#stone" x="500"/></g></defs><use href="#two" y="500"/>',
        '<g id="two"><rect y="500" width="500" height="250"/><rect x="500" y="500" width="500" height="250"/></g>',
    ),
    "symbol": (
        '<symbol id="s"><rect width="500" height="250"/></symbol><use href="#s" x="5"/>',
        '<rect x="5" width="500" height="250"/>',
    ),
    "symbol with a view box": (
        '<symbol id="s" viewBox="0 0 2 1"><rect width="2" height="1"/></symbol><use href="#s" x="5" width="600" height="300"/>',
        '<rect x="5" width="600" height="300"/>',
    ),
    "symbol of its own size": (
        '<symbol id="s" viewBox="0 0 2 1" width="600" height="300"><rect width="2" height="1"/></symbol><use href="#s"/>',
        '<rect width="600" height="300"/>',
    ),
    "symbol of its own size, whatever an auto says": (
        '<symbol id="s" viewBox="0 0 2 1" width="600" height="300"><rect width="2" height="1"/></symbol><use href="#s" width="auto"/>',
        '<rect width="600" height="300"/>',
    ),
    "symbol of the page's size": (
        '<symbol id="s" viewBox="0 0 2000 1500"><rect width="500" height="250"/></symbol><use href="#s" width="auto" height="Auto"/>',
        '<rect width="500" height="250"/>',
    ),
    "nested drawing of the page's size": (
        '<svg width="auto" height="Auto" viewBox="0 0 2000 1500"><rect width="500" height="250"/></svg>',
        '<rect width="500" height="250"/>',
    ),
    "fill": (f'{STONE}<use href="#stone" fill="red"/>', '<rect width="500" height="250" fill="red"/>'),
    "fill of the original": (
        '<defs><rect id="stone" width="500" height="250" fill="blue"/></defs><use href="#stone" fill="red"/>',
        '<rect width="500" height="250" fill="blue"/>',
    ),
    "layer": (
        f'{STONE}<g id="WALL"><use href="#stone"/><use href="#stone" x="500"/></g>',
        '<g id="WALL"><rect width="500" height="250"/><rect x="500" width="500" height="250"/></g>',
    ),
    "symbol without a copy": ('<symbol id="s"><rect width="500" height="250"/></symbol>', ""),
}


def read(body: str) -> Drawn:
    return read_outlines(".svg", f"<svg {NAMES} {PAGE}>{body}</svg>".encode(), None, 1e-4)


@pytest.mark.parametrize("name", SAME)
def test_a_copy_draws_what_it_stands_for(name: str) -> None:
    with_copies, without = (read(body) for body in SAME[name])
    assert [(one.layer, one.colour) for one in with_copies.outlines] == [(one.layer, one.colour) for one in without.outlines]
    for copied, drawn in zip(with_copies.outlines, without.outlines, strict=True):
        assert copied.points == pytest.approx(np.asarray(drawn.points), abs=1e-12)
    assert not with_copies.ignored


def test_a_hidden_copy_is_counted_and_not_read() -> None:
    drawn = read(f'{STONE}<use href="#stone" display="none"/><use href="#stone" visibility="hidden"/>')
    assert not drawn.outlines
    assert sum(drawn.ignored.values()) == 2


@pytest.mark.parametrize("link", ["other.svg#stone", "#missing", "#", ""])
def test_a_copy_of_what_is_not_there_is_counted(link: str) -> None:
    drawn = read(f'{STONE}<use href="{link}"/>')
    assert not drawn.outlines
    assert drawn.ignored == {"use": 1}


LETTER = '<path d="M0 0H4V7H0Z"/>'


@pytest.mark.parametrize(
    ("shape", "link"),
    [
        ('<symbol overflow="visible" id="glyph0-1">{}</symbol>', "glyph0-1"),  # pdf2svg and Inkscape
        ('<g id="glyph-0-1">{}</g>', "glyph-0-1"),  # pdftocairo of today
        ('<g id="font_1_23">{}</g>', "font_1_23"),  # mutool
    ],
)
def test_letters_of_a_converted_pdf_are_counted_and_no_stones(shape: str, link: str) -> None:
    copies = f'<g fill="#000"><use xlink:href="#{link}" x="10" y="20"/><use xlink:href="#{link}" x="30" y="20"/></g>'
    drawn = read(f"<defs><g>{shape.format(LETTER)}</g></defs>{copies}{STONE}<use href='#stone'/>")
    assert len(drawn.outlines) == 1
    assert drawn.ignored == {"letters of texts": 2}


def test_stones_with_numbers_are_no_letters() -> None:
    drawn = read("".join(f'<defs><rect id="{name}" width="5" height="2"/></defs><use href="#{name}"/>' for name in ("g12-3", "stone_1_2")))
    assert len(drawn.outlines) == 2
    assert not drawn.ignored


def test_a_point_that_would_move_a_symbol_is_counted() -> None:
    drawn = read('<symbol id="s" refX="250"><rect width="500" height="250"/></symbol><use href="#s"/><use href="#s" display="none"/>')
    assert drawn.outlines[0].points[:, 0].min() == pytest.approx(0.0)
    assert drawn.ignored == {"refX or refY of symbols": 1, "hidden entities": 1}


def test_what_copies_lack_is_told() -> None:
    drawn = read('<symbol id="s" refX="250"><rect width="500" height="250"/></symbol><use href="#s"/><use href="other.svg#stone"/>')
    absent, moved = lacking_words(drawn.ignored)
    assert absent.startswith("copies by <use> of what the file does not hold show nothing (1); ")
    assert moved.startswith("refX or refY of symbols are not read (1), so copies of these symbols may stand beside their places; ")


def test_a_copy_within_its_original_is_refused() -> None:
    with pytest.raises(ValueError, match="copies by <use>, more than 100 deep"):
        read('<g id="a"><use href="#a"/></g>')


def test_copies_of_copies_cannot_fill_the_memory(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(svg, "MOST_COPIED", 1000)
    tens = "".join(f'<g id="g{k}">' + f'<use href="#g{k - 1}"/>' * 10 + "</g>" for k in range(1, 9))
    with pytest.raises(ValueError, match="more than 1000 elements"):
        read(f'<defs><g id="g0"/>{tens}</defs><use href="#g8"/>')
