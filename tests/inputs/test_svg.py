"""SVG as specified and as drawing programs use it: areas, places and layers agree with values computed by hand."""

from pathlib import Path

import numpy as np
import pytest
import shapely

from la_core.drawing import Drawn, cleaned, read_outlines
from la_core.scene import scene_from_file

PAGE = 'width="2000mm" height="1500mm" viewBox="0 0 2000 1500"'
NAMES = 'xmlns="http://www.w3.org/2000/svg" xmlns:inkscape="http://www.inkscape.org/namespaces/inkscape"'
ROUND_OFF = 1e-9
SAGITTA = 1e-4  # m


def read(body: str, page: str = PAGE, unit: float | None = None, sagitta: float = SAGITTA) -> Drawn:
    return read_outlines(".svg", f"<svg {NAMES} {page}>{body}</svg>".encode(), unit, sagitta)


def area(drawn: Drawn) -> float:
    """Area of all outlines together, m2."""
    return float(sum(shapely.Polygon(outline.points).area for outline in drawn.outlines))


def box(drawn: Drawn) -> list[float]:
    """Least x and z and greatest x and z of the first outline, m."""
    points = drawn.outlines[0].points
    return [*points.min(axis=0), *points.max(axis=0)]


def refusal(body: str, page: str = PAGE) -> str:
    with pytest.raises(ValueError, match="has ") as error:
        read(body, page)
    assert "\n" not in str(error.value)
    return str(error.value)


@pytest.mark.parametrize("flags", ["0 0 0 -2000 0", "0 00-2000 0", "0 00-2e3,0", "0,0,0,-2000,0", "0 0 0-2000 0"])
def test_flags_of_an_arc_need_no_separator(flags: str) -> None:
    drawn = read(f'<path d="M0 1200h2000V900a1000 1000 {flags}z"/>')
    assert area(drawn) == pytest.approx(0.6 + np.pi / 2.0, abs=np.pi * SAGITTA)


def test_repeated_arcs_have_their_own_flags() -> None:
    drawn = read('<path d="M0 900a500 500 0 011000 0 500 500 0 01-1000 0"/>')
    assert area(drawn) == pytest.approx(np.pi / 4.0, abs=np.pi * SAGITTA)


@pytest.mark.parametrize("body", ['<path d="M0 0a1e20 1e20 0 0 1 1e20 1e20z"/>', '<circle r="1e20"/>'])
def test_an_arc_far_larger_than_the_sagitta_has_few_chords(body: str) -> None:
    (outline,) = read(body).outlines
    assert len(outline.points) <= 1001


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ("0,0 1000,0 1000,abc 0,500", 'has a <polygon> with "abc 0,500" in its points, where a number is expected'),
        ("0,0 1000,0 1000,500 0", "has a <polygon> whose points have 7 numbers, where each point has two"),
    ],
)
def test_points_that_are_no_pairs_of_numbers_are_refused(points: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        read(f'<polygon points="{points}"/>')


@pytest.mark.parametrize("page", ['width="1e300mm" viewBox="0 0 1e-300 1"', 'width="1e-300mm" viewBox="0 0 1e300 1"'])
def test_a_page_out_of_all_sizes_says_no_unit(page: str) -> None:
    with pytest.raises(ValueError, match="does not say its unit"):
        read("", page)


BASE = "V 1000 H 0 Z"  # 1 m2 for a curve from (0, 500) to (2000, 500) that encloses nothing
SMOOTH = {  # a curve, and the area that it adds, m2
    "T after Q is reflected": ("Q500 100 1000 500 T2000 500", 0.0),
    "T after T is reflected": ("Q250 100 500 500 T1000 500 T1500 500 T2000 500", 0.0),
    "T after C is straight": ("C0 100 1000 100 1000 500 T2000 500", 0.6 * 1.0 * 0.4),
    "T after S is straight": ("S1000 100 1000 500 T2000 500", 0.3 * 1.0 * 0.4),
    "S after Q starts at its point": ("Q500 100 1000 500 S2000 100 2000 500", (1.0 / 3.0 + 0.3) * 1.0 * 0.4),
    "S after T starts at its point": ("T1000 500 S2000 100 2000 500", 0.3 * 1.0 * 0.4),
    "S after C is reflected": ("C0 100 1000 100 1000 500 S2000 900 2000 500", 0.0),
    "T after L is straight": ("L1000 500 T2000 500", 0.0),
}


@pytest.mark.parametrize("name", SMOOTH)
def test_smooth_curves_reflect_only_their_own_family(name: str) -> None:
    """Area under a curve over width times control height: 1/3 for a parabola, 0.6 for a cubic with two raised controls, 0.3 with one."""
    curve, added = SMOOTH[name]
    assert area(read(f'<path d="M0 500 {curve} {BASE}"/>')) == pytest.approx(1.0 + added, abs=2.0 * SAGITTA)


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("M0 0 A1 1 0 2 0 5 5", '"2 0 5 5" after the command A, where a flag of an arc, which is 0 or 1, is expected'),
        ("M0 0 L 10;\n10", '"; 10" after the command L, where a number is expected; correct the path'),
        ("12 M0 0", 'has a path that begins with "12"; a path begins with the command M'),
        ("M0 0 L 1 2 3", "has a path whose command L has 3 numbers; it takes 2 each time"),
        ("M0 0 Z 1", "has a path whose command Z has 1 numbers; it takes 0 each time"),
    ],
)
def test_a_path_that_breaks_the_grammar_is_refused(path: str, words: str) -> None:
    assert words in refusal(f'<path d="{path}"/>')


RECT = '<rect x="0" y="0" width="{0}" height="{1}"/>'


@pytest.mark.parametrize(
    ("length", "pixels"),
    [("96px", 96.0), ("1in", 96.0), ("2.54cm", 96.0), ("25.4mm", 96.0), ("101.6Q", 96.0), ("72pt", 96.0), ("6pc", 96.0), (" 96 ", 96.0)],
)
def test_lengths_have_the_units_of_css(length: str, pixels: float) -> None:
    """On a page with a view box a pixel is a user unit, here 1 mm."""
    assert box(read(RECT.format(length, "500"))) == pytest.approx([0.0, -0.5, pixels * 1e-3, 0.0], rel=ROUND_OFF)
    circle = box(read(f'<circle cx="{length}" cy="{length}" r="{length}"/>'))
    assert circle == pytest.approx([0.0, -2e-3 * pixels, 2e-3 * pixels, 0.0], abs=2.0 * SAGITTA)


@pytest.mark.parametrize("unit", [None, 1e-3])
def test_lengths_without_a_view_box_are_those_of_the_page(unit: float | None) -> None:
    drawn = read('<rect x="0" y="90cm" width="200cm" height="0.3m"/>', 'width="2000mm" height="1500mm"', unit)
    assert box(drawn) == pytest.approx([0.0, -1.2, 2.0, -0.9], rel=ROUND_OFF)


def test_percentages_are_shares_of_the_view_box() -> None:
    """The view box is 1400 mm by 200 mm. A radius refers to the root of half the sum of the squares of these sides, 1000 mm."""
    page = 'width="1400mm" height="200mm" viewBox="0 0 1400 200"'
    drawn = read('<rect x="10%" y="50%" width="50%" height="50%"/>', page)
    assert box(drawn) == pytest.approx([0.14, -0.2, 0.84, -0.1], rel=ROUND_OFF)
    assert box(read('<circle r="10%"/>', page)) == pytest.approx([-0.1, -0.1, 0.1, 0.1], abs=2.0 * SAGITTA)
    assert box(read(RECT.format("50%", "50%"), 'width="2m" height="1m"')) == pytest.approx([0.0, -0.5, 1.0, 0.0], rel=ROUND_OFF)
    inner = f'<svg x="50%" width="50%" height="100%">{RECT.format("50%", "100%")}</svg>'
    assert box(read(inner)) == pytest.approx([1.0, -1.5, 1.5, 0.0], rel=ROUND_OFF)


@pytest.mark.parametrize("length", ["wide", "12em", "3 4", "", "1e999", "auto", "5 %x"])
def test_a_wrong_length_is_refused(length: str) -> None:
    words = f'has a <rect> with width = "{length}", which is no number, alone or with a unit such as mm; write it so, as in "120mm"'
    assert refusal(RECT.format(length, "500")) == words


def test_a_percentage_of_nothing_is_refused() -> None:
    words = 'has a <rect> with width = "50%", but no view box or page size that it is a share of; give the drawing a viewBox'
    with pytest.raises(ValueError, match="has ") as error:
        read(RECT.format("50%", "500"), "", unit=1e-3)
    assert str(error.value) == words


MOVED = {  # transforms of a rectangle of 200 mm by 100 mm, and its least x and z and greatest x and z afterwards, m
    "translate(100px, 300px)": [0.1, -0.4, 0.3, -0.3],
    "translateX(100px) translateY(300px)": [0.1, -0.4, 0.3, -0.3],
    "rotate(90deg)": [-0.1, -0.2, 0.0, 0.0],
    "rotate(0.25turn)": [-0.1, -0.2, 0.0, 0.0],
    "rotate(100grad)": [-0.1, -0.2, 0.0, 0.0],
    "scale(2, 3)": [0.0, -0.3, 0.4, 0.0],
    "scaleY(3)": [0.0, -0.3, 0.2, 0.0],
    "skewX(45deg)": [0.0, -0.1, 0.3, 0.0],
    "matrix(1, 0, 0, 1, 100, 300)": [0.1, -0.4, 0.3, -0.3],
    "none": [0.0, -0.1, 0.2, 0.0],
}


@pytest.mark.parametrize("transform", MOVED)
def test_transforms_of_css(transform: str) -> None:
    for style in (f'<g style="transform: {transform}">', f"<style>.a {{transform: {transform}}}</style><g class='a' transform='scale(7)'>"):
        drawn = read(f"{style}{RECT.format(200, 100)}</g>")
        assert box(drawn) == pytest.approx(MOVED[transform], abs=ROUND_OFF)


def test_a_rotation_has_a_centre_and_numbers_need_no_comma() -> None:
    assert box(
        read(f'<g transform-origin="0 0px" transform="rotate(180 100 50)translate(10-20)">{RECT.format(200, 100)}</g>')
    ) == pytest.approx([-0.01, -0.12, 0.19, -0.02], abs=ROUND_OFF)


@pytest.mark.parametrize(("move", "value"), [("rotate", "30deg"), ("translate", "5px 1px"), ("scale", "2")])
def test_a_move_of_a_style_that_is_not_read_is_refused(move: str, value: str) -> None:
    assert f'has {move} = "{value}" in a style, which is not read' in refusal(f'<g style="{move}: {value}">{ONE}</g>')
    assert area(read(f'<g style="{move}: none">{ONE}</g>')) == pytest.approx(0.1, rel=ROUND_OFF)


@pytest.mark.parametrize(
    ("transform", "words"),
    [
        ("translate(50%)", 'has a transform translate with "50%"; its units may be px; write it as a plain number'),
        ("rotate3d(1, 1, 1, 45deg)", 'has a transform with "rotate3d(1, 1, 1, 45deg)", which is not read'),
        ("turn(45)", "has a transform turn, which is not read; apply it in the drawing program"),
        ("scale(2", 'has a transform with "scale(2", which is not read'),
        ("rotate(1 2)", "has a transform rotate with 2 numbers; it takes 1 or 3"),
        ("rotate(1e999)", "has a transform rotate whose numbers are too large; apply it in the drawing program"),
        (
            'rotate(45)" transform-origin="5 0',
            'has transform-origin = "5 0", which is not read; apply the transform in the drawing program',
        ),
        ("scale(1e200) scale(1e200)", "has a transform whose numbers are too large"),
    ],
)
def test_a_transform_that_is_not_read_is_refused(transform: str, words: str) -> None:
    assert words in refusal(f'<g transform="{transform}">{RECT.format(200, 100)}</g>')


FITTED = {  # page and the size of 1000 by 1000 units on it, m
    "meet": ('width="4000mm" height="1500mm" viewBox="0 0 2000 1500"', (1.0, 1.0)),
    "slice": ('width="4000mm" height="1500mm" viewBox="0 0 2000 1500" preserveAspectRatio="xMidYMid slice"', (2.0, 2.0)),
    "none": ('width="4000mm" height="1500mm" viewBox="0 0 2000 1500" preserveAspectRatio="none"', (2.0, 1.0)),
    "none, flat": ('width="2000mm" height="3000mm" viewBox="0 0 2000 1500" preserveAspectRatio="none"', (1.0, 2.0)),
    "width alone": ('width="4000mm" viewBox="0 0 2000 1500"', (2.0, 2.0)),
    "rounded": ('width="2000mm" height="1500.4mm" viewBox="0 0 2000 1500"', (1.0, 1.0)),
}


@pytest.mark.parametrize("name", FITTED)
def test_the_view_box_is_fitted_to_the_page(name: str) -> None:
    page, (width, height) = FITTED[name]
    drawn = read(RECT.format(1000, 1000), page)
    assert box(drawn) == pytest.approx([0.0, -height, width, 0.0], rel=ROUND_OFF)
    assert drawn.unit == min(width, height) * 1e-3


NESTED = {  # a nested drawing that shows 100 by 100 units, and where these lie, m
    "fitted": ('width="1000" height="1000" viewBox="0 0 100 100"', [0.2, -1.1, 1.2, -0.1]),
    "in the middle": ('width="1000" height="500" viewBox="0 0 100 100"', [0.45, -0.6, 0.95, -0.1]),
    "at the least": ('width="1000" height="500" viewBox="0 0 100 100" preserveAspectRatio="xMinYMin"', [0.2, -0.6, 0.7, -0.1]),
    "at the most": ('width="1000" height="500" viewBox="0 0 100 100" preserveAspectRatio="xMaxYMax meet"', [0.7, -0.6, 1.2, -0.1]),
    "slice": ('width="1000" height="500" viewBox="0 0 100 100" preserveAspectRatio="xMidYMid slice"', [0.2, -0.85, 1.2, 0.15]),
    "stretched": ('width="1000" height="500" viewBox="0 0 100 100" preserveAspectRatio="none"', [0.2, -0.6, 1.2, -0.1]),
    "box away from 0": ('width="1000" height="1000" viewBox="-50 50 100 100"', [0.7, -0.6, 1.7, 0.4]),
    "no box": ("", [0.2, -0.2, 0.3, -0.1]),
    "no size": ('viewBox="0 0 200 150"', [0.2, -1.1, 1.2, -0.1]),
}


@pytest.mark.parametrize("name", NESTED)
def test_a_nested_drawing_is_fitted_to_its_place(name: str) -> None:
    sides, place = NESTED[name]
    assert box(read(f'<svg x="200" y="100" {sides}>{RECT.format(100, 100)}</svg>')) == pytest.approx(place, abs=ROUND_OFF)


@pytest.mark.parametrize(
    ("sides", "words"),
    [
        ('width="0" height="5" viewBox="0 0 1 1"', "has a nested <svg> whose width or height is not positive"),
        ('viewBox="0 0 1"', 'has viewBox = "0 0 1", which is not x, y and a positive width and height'),
        ('viewBox="0 0 1 0"', 'has viewBox = "0 0 1 0", which is not x, y and a positive width and height'),
    ],
)
def test_a_nested_drawing_without_size_is_refused(sides: str, words: str) -> None:
    assert words in refusal(f"<svg {sides}>{RECT.format(100, 100)}</svg>")


ROUNDED = {  # attributes of a rectangle of 2000 mm by 300 mm, and the radii of its corners, mm
    'rx="100"': (100.0, 100.0),
    'ry="100"': (100.0, 100.0),
    'rx="200" ry="50"': (200.0, 50.0),
    'rx="5000" ry="100"': (1000.0, 100.0),
    'rx="5000"': (1000.0, 150.0),
    'rx="auto" ry="10%"': (150.0, 150.0),
    'rx="0" ry="50"': (0.0, 0.0),
    'rx="-5"': (0.0, 0.0),
}


@pytest.mark.parametrize("radii", ROUNDED)
def test_corners_of_a_rectangle_are_rounded(radii: str) -> None:
    """Four rounded corners remove (4 - pi) rx ry from the rectangle. Their chords remove at most their length times the sagitta more."""
    first, second = ROUNDED[radii]
    drawn = read(f'<rect x="100" y="900" width="2000" height="300" {radii}/>')
    lost = area(drawn) - (0.6 - (4.0 - np.pi) * first * second * 1e-6)
    assert -2.0 * np.pi * max(first, second) * 1e-3 * SAGITTA - ROUND_OFF <= lost <= ROUND_OFF
    assert box(drawn) == pytest.approx([0.1, -1.2, 2.1, -0.9], rel=ROUND_OFF)
    assert shapely.Polygon(drawn.outlines[0].points).is_valid


def test_a_corner_that_is_rounded_within_the_sagitta_stays_sharp() -> None:
    drawn = read('<rect width="200" height="100" rx="10"/>', sagitta=0.005)
    assert len(drawn.outlines[0].points) == 4
    assert len(read('<rect width="200" height="100" rx="20"/>', sagitta=0.005).outlines[0].points) == 4 * 3


def test_chords_of_an_oblique_curve_stay_within_the_sagitta() -> None:
    (outline,) = read('<path d="M0 0Q1000 0 1000 1000L0 1000z"/>', sagitta=1e-3).outlines
    share = np.linspace(0.0, 1.0, 3001)
    curve = shapely.points(1.0 - (1.0 - share) ** 2, -(share**2))  # m
    away = shapely.distance(curve, shapely.Polygon(outline.points).exterior)
    assert 0.5e-3 < away.max() <= 1e-3


ONE = RECT.format(1000, 100)
HIDING = {  # ways to hide one rectangle
    "display": f'<g display="none">{ONE}</g>',
    "display in a style": f'<g style="fill:red; display : none">{ONE}</g>',
    "visibility": f'<g visibility="hidden">{ONE}</g>',
    "collapsed": f'<g style="visibility:collapse">{ONE}</g>',
    "class": f'<style>.st0{{display:none;}} .st1{{fill:#C0C0C0}}</style><g class="st1 st0">{ONE}</g>',
    "id": f'<style>#old, #older {{ visibility: hidden }}</style><g id="older">{ONE}</g>',
    "element": f"<style>g{{display:none}}</style><g>{ONE}</g>",
    "any element of a class": f"<style>*.a{{display:none}}</style><g class='a'>{ONE}</g>",
    "element and class": f"<style>g.a{{display:none}}</style><g class='a'>{ONE}</g>",
    "sheet over attribute": f"<style>g{{display:none}}</style><g display='inline'>{ONE}</g>",
    "important": f"<style>g{{display:none !important}}</style><g style='display:inline'>{ONE}</g>",
    "later rule": f"<style>.a{{display:inline}} .a{{display:none}}</style><g class='a'>{ONE}</g>",
    "class over element": f"<style>.a{{display:none}} g{{display:inline}}</style><g class='a'>{ONE}</g>",
    "id over class": f"<style>#b{{display:none}} g.a{{display:inline}}</style><g class='a' id='b'>{ONE}</g>",
    "within what is shown": f'<g display="none"><g display="inline" visibility="visible">{ONE}</g></g>',
    "comment in the sheet": f"<style>/* {{ */ .a /* }} */ {{display:none}}</style><g class='a'>{ONE}</g>",
    "after other rules": f"<style>@import url(a.css); @media print {{.b{{fill:red}}}} .a{{display:none}}</style><g class='a'>{ONE}</g>",
    "sheet in defs": f"<defs><style><![CDATA[.a{{display:none}}]]></style></defs><g class='a'>{ONE}</g>",
    "with what is not read": f'<g display="none" transform="turn(1)"><svg width="0">{ONE}</svg></g>',
    "shape itself": '<rect width="1000" height="100" display="none"/>',
    "artboard": '<rect id="Artboard1" width="2000" height="1000" style="fill:none;"/>',
    "neither fill nor stroke": f'<g fill="none" stroke="none">{ONE}</g>',
    "no opacity": f'<g opacity="0"><g opacity="1">{ONE}</g></g>',
    "no opacity in a class": f'<style>.a{{opacity:0.0%}}</style><g class="a">{ONE}</g>',
    "fill without opacity": f'<g style="fill:#000;fill-opacity:0">{ONE}</g>',
    "default fill without opacity": f'<g fill-opacity=".0">{ONE}</g>',
    "stroke without opacity": f'<g fill="none" stroke="#000" stroke-opacity="0">{ONE}</g>',
    "stroke without opacity around": f'<g stroke-opacity="0"><g fill="none" stroke="#000">{ONE}</g></g>',
    "transparent": f'<g fill="transparent" stroke="rgba(0, 0, 0, 0)">{ONE}</g>',
    "rgb with an opacity": f'<g fill="rgb(255 255 255 / 0%)">{ONE}</g>',
    "hex with an opacity": f'<g fill="#FFF0" stroke="#12345600">{ONE}</g>',
    "colour of a space with an opacity": f'<g fill="color(srgb 1 0 0 / 0)" stroke="oklch(40% 0.2 20 / 0%)">{ONE}</g>',
    "current colour": f'<g style="color:transparent"><g fill="currentColor" stroke="currentColor">{ONE}</g></g>',
}
SHOWING = {  # styles that hide nothing
    "style over sheet": f"<style>.a{{display:none}}</style><g class='a' style='display:inline'>{ONE}</g>",
    "another class": f"<style>.a{{display:none}}</style><g class='aa b'>{ONE}</g>",
    "element of another class": f"<style>rect.a{{display:none}}</style><g class='a'>{ONE}</g>",
    "visible again": f'<g visibility="hidden"><g style="visibility:visible">{ONE}</g></g>',
    "on paper": f"<style>@media print {{.a{{display:none}}}}</style><g class='a'>{ONE}</g>",
    "under the pointer": f"<style>.a:hover{{display:none}}</style><g class='a'>{ONE}</g>",
    "comment": f"<style>/* .a{{display:none}} */</style><g class='a'>{ONE}</g>",
    "fill alone": f'<g stroke="none">{ONE}</g>',
    "stroke alone": f'<g fill="none" stroke="#000">{ONE}</g>',
    "little opacity": f'<g opacity="0.01" fill-opacity="1e-3" stroke="none">{ONE}</g>',
    "opacity again": f'<g fill-opacity="0"><g fill-opacity="0.5">{ONE}</g></g>',
    "stroke beside a fill without opacity": f'<g fill-opacity="0" stroke="#000">{ONE}</g>',
    "black": f'<g fill="rgb(0,0,0)" stroke="none">{ONE}</g>',
    "nearly clear": f'<g fill="rgba(0,0,0,0.05)">{ONE}</g>',
    "red of a colour space": f'<g fill="color(srgb 1 0 0)">{ONE}</g>',
    "current colour": f'<g color="transparent"><g color="red" fill="currentColor">{ONE}</g></g>',
    "yellow": f'<g fill="#ff00" stroke="#ff0000">{ONE}</g>',
}


@pytest.mark.parametrize("name", HIDING)
def test_what_is_hidden_is_counted_and_not_read(name: str) -> None:
    drawn = read(f'{HIDING[name]}<rect y="100" width="2000" height="100"/>')
    assert area(drawn) == pytest.approx(0.2, rel=ROUND_OFF)
    assert drawn.ignored == {"hidden entities": 1}


@pytest.mark.parametrize("name", SHOWING)
def test_what_is_not_hidden_is_read(name: str) -> None:
    drawn = read(SHOWING[name])
    assert area(drawn) == pytest.approx(0.1, rel=ROUND_OFF)
    assert drawn.ignored == {}


STILL = {  # styles that move nothing that is read
    "no move": f'<g style="translate: 0px 0; rotate: 0deg; scale: 1 100%">{ONE}</g>',
    "text": f'<style>text {{rotate: 30deg}}</style><text style="scale: 2; transform: rotateX(9deg)">a</text>{ONE}',
    "hidden": f'<g style="display: none; scale: 2">{ONE}</g>{ONE}',
    "taken back": f'<style>.a {{scale: 2}}</style><g class="a" style="scale: none">{ONE}</g>',
    "what no size of a style applies to": f'<g style="x: 9px; width: auto; r: 1em; d: none"><text style="width: 100%">a</text>{ONE}</g>',
}


@pytest.mark.parametrize("name", STILL)
def test_a_style_that_moves_nothing_that_is_read_is_no_reason_to_refuse(name: str) -> None:
    assert area(read(STILL[name])) == pytest.approx(0.1, rel=ROUND_OFF)


RED = "<rect class='a' x='50' y='50' width='7' height='7'/>"
STYLED = {  # sizes and places in styles, and the resulting box, m
    "sheet": (f"<style>rect {{width: 200px; height: 100px; x: 5%; y: 0}}</style>{RED}", [0.1, -0.1, 0.3, 0.0]),
    "style": ("<rect x='1' width='7' height='100' style='x: 100px; width: 20cm'/>", [0.1, -0.1, 0.1 + 0.2 * 96.0 / 25.4, 0.0]),
    "style over sheet": ("<style>.a {width: 1px}</style>" + RED.replace("/>", " style='width:50px'/>"), [0.05, -0.057, 0.1, -0.05]),
    "without a unit": ("<rect width='200' height='100' style='width: 300; height: -5.5; x: 0.0'/>", [0.0, -0.1, 0.2, 0.0]),
    "with an exponent": ("<rect width='200' height='100' style='width: 3e2; height: .5E+1; x: 1e-2'/>", [0.0, -0.1, 0.2, 0.0]),
    "circle": ("<circle cx='1' r='1' style='cx: 500px; cy: 50px; r: 50px'/>", [0.45, -0.1, 0.55, 0.0]),
    "ellipse": ("<style>#e {rx: 100px; ry: 50px}</style><ellipse id='e' cx='100' cy='50'/>", [0.0, -0.1, 0.2, 0.0]),
    "copy": (f"<style>use {{x: 100px}}</style><defs><g id='o'>{RED}</g></defs><use href='#o'/>", [0.15, -0.057, 0.157, -0.05]),
    "nested page": ("<svg viewBox='0 0 1 1' style='width: 100px; height: 100px'><rect width='1' height='1'/></svg>", [0.0, -0.1, 0.1, 0.0]),
}


@pytest.mark.parametrize("name", STYLED)
def test_sizes_and_places_of_styles_are_read(name: str) -> None:
    body, expected = STYLED[name]
    drawn = read(body)
    assert box(drawn) == pytest.approx(expected, abs=SAGITTA if name in ("circle", "ellipse") else ROUND_OFF)


def test_sizes_of_styles_that_are_not_read_are_refused() -> None:
    assert 'has a <rect> with width = "calc(10px + 1%)", which is no number' in refusal("<rect height='1' style='width: calc(10px + 1%)'/>")
    path = "<path d='M0 0h9v9z' style='d: path(&quot;M0 0h5v5z&quot;)'/>"
    assert "has a <path> whose d is in a style, which is not read" in refusal(path)


def test_an_unread_rule_about_sizes_and_moves_alone_paints_nothing() -> None:
    drawn = read(f"<style>g > rect {{width: 5px; scale: none}}</style><g fill='none'>{ONE}</g>{ONE}")
    assert area(drawn) == pytest.approx(0.1, rel=ROUND_OFF)
    assert drawn.ignored == {"hidden entities": 1, "rules of style sheets": 1}


HALF = "<clipPath id='half'><rect width='500' height='100'/></clipPath>"
SEEN_OTHERWISE = {  # shapes that are read whole, and the kind by which they are counted
    "attribute": (f"{HALF}<g clip-path='url(#half)'>{ONE}</g>", "clip paths"),
    "style": (f"{HALF}<g style='clip-path:url(#half)'>{ONE}</g>", "clip paths"),
    "sheet": (f"{HALF}<style>.cut{{clip-path:url(#half)}}</style><g class='cut'>{ONE}</g>", "clip paths"),
    "mask": (f"<mask id='half'/><g mask='url(#half)'>{ONE}</g>", "masks"),
    "markers": (f"<g style='marker-start:url(#a);marker-end:url(#a)'>{ONE}</g>", "markers"),
}


@pytest.mark.parametrize("name", SEEN_OTHERWISE)
def test_what_cuts_or_adds_something_is_counted_and_the_rest_read_whole(name: str) -> None:
    body, kind = SEEN_OTHERWISE[name]
    drawn = read(body)
    assert area(drawn) == pytest.approx(0.1, rel=ROUND_OFF)
    assert drawn.ignored == {kind: 1}


@pytest.mark.parametrize("body", [f"<g clip-path='none' style='mask:none;marker:none'>{ONE}</g>", f"{HALF}{ONE}"])
def test_what_cuts_nothing_is_not_counted(body: str) -> None:
    drawn = read(body)
    assert area(drawn) == pytest.approx(0.1, rel=ROUND_OFF) and drawn.ignored == {}


def test_a_rule_that_depends_on_other_elements_is_counted() -> None:
    """Such a rule may hide a shape that is read nevertheless."""
    drawn = read(f"<style>g .a{{display:none}} g > .b{{fill:red}} g .c{{font-size:3px}}</style><g><g class='a'>{ONE}</g></g>")
    assert drawn.ignored == {"rules of style sheets": 2}


@pytest.mark.parametrize("rule", [".a:not(.b){{display:none}}", "g:first-child{{display:none}}", "@media screen{{.a{{display:none}}}}"])
def test_a_rule_that_may_hold_on_a_screen_and_is_not_read_is_counted(rule: str) -> None:
    drawn = read(f"<style>{rule.format()}</style><g class='a'>{ONE}</g>")
    assert drawn.ignored == {"rules of style sheets": 1}


def test_what_lies_in_an_element_that_draws_nothing_is_no_stone() -> None:
    """Inkscape writes a frame around text as a rectangle."""
    text = '<flowRoot><flowRegion><rect width="100" height="50"/></flowRegion><flowPara>course 1</flowPara></flowRoot>'
    drawn = read(f"{text}<filter><feBlend/></filter>{ONE}")
    assert area(drawn) == pytest.approx(0.1, rel=ROUND_OFF)
    assert drawn.ignored == {"flowRoot": 1, "filter": 1}


def test_a_shape_that_an_unread_rule_may_stroke_is_read() -> None:
    assert area(read(f'<style>g rect{{stroke:#000}}</style><g fill="none">{ONE}</g>')) == pytest.approx(0.1, rel=ROUND_OFF)


def test_of_a_switch_the_first_part_that_asks_for_nothing_is_drawn() -> None:
    other = '<rect y="900" width="70" height="70"/>'
    drawn = read(f'<switch><g systemLanguage="xx">{other}</g><foreignObject requiredExtensions="a"/><g>{ONE}</g><g>{other}</g></switch>')
    assert area(drawn) == pytest.approx(0.1, rel=ROUND_OFF) and drawn.ignored == {}


def test_colours_come_from_styles() -> None:
    sheet = "<style>.a{fill:RED} .b{fill:none;stroke:#00F}</style>"
    given = ('class="a"', 'class="b"', 'class="a" style="fill:green"', "")
    shapes = "".join(f'<rect width="100" height="100" {one}/>' for one in given)
    drawn = read(f'{sheet}<g fill="grey">{shapes}</g>')
    assert [outline.colour for outline in drawn.outlines] == ["red", "#00f", "green", "grey"]


@pytest.mark.parametrize(
    ("count", "words"), [(1, "1 entity that the drawing hides is left out"), (2, "2 entities that the drawing hides are left out")]
)
def test_new_says_that_something_is_hidden(count: int, words: str, tmp_path: Path) -> None:
    shown = '<g id="wall"><rect width="1000" height="500"/><rect x="1000" width="1000" height="500"/></g>'
    old = f'<g id="old_survey" class="st0">{count * ONE}</g>'
    text = f"<svg {NAMES} {PAGE}><style>.st0{{display:none;}}</style>{shown}{old}</svg>"
    (tmp_path / "wall.svg").write_text(text, encoding="utf-8")
    written = scene_from_file(tmp_path / "wall.svg", tmp_path)
    assert f"# CHECK: {words}" in written
    assert "old_survey" not in written


OPEN = "M0 1200H2000V900H0"  # three sides of 2000 mm by 300 mm
FILLED = {
    "fill": f'<path fill="#ccc" d="{OPEN}"/>',
    "fill and stroke": f'<path fill="#ccc" stroke="black" d="{OPEN}"/>',
    "fill of a group": f'<g fill="#ccc" stroke="black"><path d="{OPEN}"/></g>',
    "fill of a sheet": f'<style>.a{{fill:#ccc;stroke:#000}}</style><path class="a" d="{OPEN}"/>',
    "polyline": '<polyline style="fill:#ccc;stroke:#000" points="0,1200 2000,1200 2000,900 0,900"/>',
    "no word of fill or stroke": f'<path d="{OPEN}"/>',
    "no word of fill and no stroke": f'<g stroke="black"><path stroke="none" d="{OPEN}"/></g>',
    "two parts": '<path fill="#ccc" d="M0 1200H1000V900H0M1000 1200H2000V900H1000"/>',
}
UNFILLED = {
    "stroke alone": f'<path stroke="black" d="{OPEN}"/>',
    "stroke of a group": f'<g stroke="black"><path d="{OPEN}"/></g>',
    "no fill": f'<g fill="#ccc" stroke="black"><path fill="none" d="{OPEN}"/></g>',
    "transparent": f'<path style="fill:transparent;stroke:#000" d="{OPEN}"/>',
    "fill without opacity": f'<path style="fill:red;fill-opacity:0;stroke:#000" d="{OPEN}"/>',
    "rgba": f'<path style="fill:rgba(0,0,0,0);stroke:#000" d="{OPEN}"/>',
    "a straight line": '<path fill="#ccc" d="M0 1200H1000H2000"/>',
    "a line": '<line fill="#ccc" x1="0" y1="1200" x2="2000" y2="1200"/>',
    "a crack that crosses its closing side": '<polyline fill="#ccc" stroke="#000" points="0,0 100,50 200,-50 300,50 400,0"/>',
}


@pytest.mark.parametrize("name", FILLED)
def test_a_filled_line_is_closed(name: str) -> None:
    drawn = read(FILLED[name])
    assert area(drawn) == pytest.approx(0.6, rel=ROUND_OFF)
    assert not drawn.lines


@pytest.mark.parametrize("name", UNFILLED)
def test_a_line_without_fill_stays_open(name: str) -> None:
    drawn = read(UNFILLED[name])
    assert not drawn.outlines
    assert [len(lines) for lines in drawn.lines.values()] == [1]


LAYER = 'inkscape:groupmode="layer"'
LAYERS = {  # groups around two rectangles, and the layer of these
    "id": ('<g id="BRICK">', "BRICK"),
    "Inkscape's layer": (f'<g {LAYER} inkscape:label="Stones" id="layer2">', "Stones"),
    "Inkscape's layer without label": (f'<g {LAYER} id="layer2">', "layer2"),
    "group in a layer": (f'<g {LAYER} inkscape:label="Stones" id="layer2"><g id="g99">', "Stones"),
    "group in a group": ('<g id="Layer_1"><g id="BRICK">', "BRICK"),
    "group with a label in a layer": (f'<g {LAYER} inkscape:label="Stones"><g id="g99" inkscape:label="Quoins">', "Quoins"),
    "layer in a layer": (f'<g {LAYER} inkscape:label="Stones"><g {LAYER} inkscape:label="Upper"><g id="g99">', "Upper"),
    "layer in a group": (f'<g id="g99"><g {LAYER} inkscape:label="Stones">', "Stones"),
    "group without a name": ("<g>", ""),
}


@pytest.mark.parametrize("shapes", [ONE, ONE + ONE], ids=["one shape", "two shapes"])
@pytest.mark.parametrize("name", LAYERS)
def test_layers_are_groups_that_are_meant_as_such(name: str, shapes: str) -> None:
    groups, layer = LAYERS[name]
    drawn = read(groups + shapes + "</g>" * groups.count("<g"))
    assert {outline.layer for outline in drawn.outlines} == {layer}


def line_groups(lines: list[tuple[int, int, int, int]]) -> str:
    """Every line in its own group, as Illustrator writes layers of single lines."""
    return "".join(f'<g id="LINE-{k}"><line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}"/></g>' for k, (x1, y1, x2, y2) in enumerate(lines, 1))


SIDES = [(0, 0, 1000, 0), (1000, 0, 1000, 500), (1000, 500, 0, 500), (0, 500, 0, 0), (400, 0, 400, 500)]  # two blocks with a common side


@pytest.mark.parametrize(("around", "layer"), [("<g>", ""), ('<g id="wall">', "wall"), ('<g id="all"><g id="wall">', "wall")])
def test_lines_in_groups_of_their_own_enclose_blocks_together(around: str, layer: str) -> None:
    drawn = read(around + line_groups(SIDES) + "</g>" * around.count("<g"))
    assert set(drawn.lines) == {(layer, "none")}
    clean = cleaned(drawn, 0.0)
    assert sorted(shapely.Polygon(outline.points).area for outline in clean.outlines) == pytest.approx([0.2, 0.3], rel=ROUND_OFF)


def test_a_group_of_one_line_with_a_label_is_a_layer() -> None:
    drawn = read('<g id="g1" inkscape:label="CRACK"><path stroke="red" fill="none" d="M0 0H100V100"/></g>')
    assert set(drawn.lines) == {("CRACK", "red")}


def test_a_group_of_one_outline_is_a_layer_however_it_is_closed() -> None:
    points = "0,0 100,0 100,100 0,100"
    shapes = [f'<polygon points="{points}"/>', f'<polyline stroke="red" points="{points} 0,0"/>']
    shapes.append(f'<polyline fill="red" points="{points}"/>')
    drawn = read("".join(f'<g id="L{k}">{shape}</g>' for k, shape in enumerate(shapes)))
    assert [outline.layer for outline in drawn.outlines] == ["L0", "L1", "L2"]
    assert not drawn.lines


@pytest.mark.parametrize("shape", ['<rect width="0" height="5"/>', '<circle r="0"/>', '<ellipse rx="3"/>'])
def test_a_shape_without_a_size_draws_nothing(shape: str) -> None:
    drawn = read(ONE + shape)
    assert len(drawn.outlines) == 1 and not drawn.lines


ILLUSTRATOR = f"""<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE svg PUBLIC "-//W3C//DTD SVG 1.1//EN" "http://www.w3.org/Graphics/SVG/1.1/DTD/svg11.dtd" [
  <!ENTITY ns_ai "http://ns.adobe.com/AdobeIllustrator/10.0/">
  <!ENTITY ns_svg "http://www.w3.org/2000/svg">
  <!ENTITY st0 'display:none;'>
]>
<svg xmlns:i="&ns_ai;" xmlns="&ns_svg;" width="2000mm" height="1000mm" viewBox="0 0 2000 1000"><switch>
  <foreignObject requiredExtensions="&ns_ai;" width="1" height="1"/>
  <g i:extraneous="self"><g id="Stones">{ONE}<g style="&st0;">{ONE}</g></g></g>
</switch></svg>""".encode()


def test_entities_of_illustrator_are_read() -> None:
    drawn = read_outlines(".svg", ILLUSTRATOR, None, 0.005)
    assert (area(drawn), drawn.places) == (pytest.approx(0.1, rel=ROUND_OFF), {("Stones", "none")})
    assert drawn.ignored == {"hidden entities": 1}


def test_entities_that_would_fill_the_memory_are_refused() -> None:
    content = b'<!DOCTYPE svg [<!ENTITY a "' + 5000 * b"b" + b'">]><svg width="1mm"><title>' + 3000 * b"&a;" + b"</title></svg>"
    with pytest.raises(ValueError, match="has entities of 15006000 characters where they are used, more than 10000000"):
        read_outlines(".svg", content, None, 0.005)
