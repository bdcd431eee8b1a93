"""What SVG says and how drawing programs use it: areas, places and layers computed by hand."""

import numpy as np
import pytest
import shapely

from la_core.drawing import Drawn, read_outlines

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
    """Areas under curves of Bernstein polynomials: of a parabola 1/3 of width times control height; of cubics 0.6 and 0.3."""
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
