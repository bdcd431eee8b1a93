"""A contour drawn around stones is no stone. An outline around one mark, or around a few marks of another layer, is a stone."""

from pathlib import Path

import numpy as np
import pytest

from la_core.drawing import Cleaned, Drawn, cleaned
from la_core.drawing.outlines import Outline
from la_core.errors import SceneError
from la_core.geometry import Blocks
from la_core.scene.generators.drawings import drawing_blocks, read_drawing
from la_core.scene.generators.mesh import MeshFile
from la_core.scene.schema.drawing import Drawing

STONES = [((x, z), (x + 0.5, z + 0.25)) for z in (0.0, 0.25) for x in (0.0, 0.5)]
CONTOUR = ((0.0, 0.0), (1.0, 0.5))


def rectangle(ends: tuple[tuple[float, float], tuple[float, float]], layer: str = "STONES", colour: str = "7") -> Outline:
    (x0, z0), (x1, z1) = ends
    return Outline(np.array([(x0, z0), (x1, z0), (x1, z1), (x0, z1)]), layer, colour)


def clean(*outlines: Outline, tolerance: float = 0.0) -> Cleaned:
    return cleaned(Drawn(1.0, list(outlines)), tolerance)


@pytest.mark.parametrize("place", range(5))
@pytest.mark.parametrize("tolerance", [0.0, 0.003])
def test_a_contour_is_left_out_and_told(place: int, tolerance: float) -> None:
    outlines = [rectangle(stone) for stone in STONES]
    outlines.insert(place, rectangle(CONTOUR))
    found = clean(*outlines, tolerance=tolerance)
    assert len(found.outlines) == len(STONES)
    (told,) = found.around
    assert (told.layer, told.count, told.x, told.z) == ("STONES", 1, 0.5, 0.25)


@pytest.mark.parametrize("own", [{"layer": "CONTOUR"}, {"colour": "1"}])
def test_a_contour_may_have_a_layer_or_a_colour_of_its_own(own: dict[str, str]) -> None:
    found = clean(rectangle(CONTOUR, **own), rectangle(STONES[0], layer="OPENINGS"), *(rectangle(stone) for stone in STONES[1:]))
    assert len(found.outlines) == len(STONES)
    assert found.around[0].layer == own.get("layer", "STONES")


@pytest.mark.parametrize("slip", [-0.002, 0.002])
def test_a_contour_may_miss_the_edges_of_its_stones(slip: float) -> None:
    found = clean(rectangle(((slip, slip), (1.0 - slip, 0.5 - slip))), *(rectangle(stone) for stone in STONES))
    assert len(found.outlines) == len(STONES)


def test_contours_within_a_contour_are_left_out_with_it() -> None:
    bays = [rectangle(((x, 0.0), (x + 0.5, 0.5))) for x in (0.0, 0.5)]
    found = clean(rectangle(CONTOUR), *bays, *(rectangle(stone) for stone in STONES))
    assert len(found.outlines) == len(STONES)
    assert found.around[0].count == 3


@pytest.mark.parametrize(
    "others",
    [
        [rectangle(((0.1, 0.1), (0.9, 0.4)))],  # one bevel
        [rectangle(((0.1, 0.1), (0.2, 0.2))), rectangle(((0.7, 0.1), (0.8, 0.2)))],  # two holes for lifting
        [rectangle(((0.06, 0.06), (0.94, 0.44))), rectangle(((0.14, 0.14), (0.86, 0.36)))],  # a bevel in a bevel
        [rectangle(stone, layer="OPENINGS") for stone in STONES[:3]],
        [rectangle(stone, colour="1") for stone in STONES[:3]],
        [rectangle(((x, 0.0), (x + 1.0, 0.5))) for x in (-1.0, 1.0)],  # neighbours
    ],
)
def test_other_outlines_leave_a_stone_as_it_is(others: list[Outline]) -> None:
    found = clean(rectangle(CONTOUR), *others)
    assert len(found.outlines) == 1 + len(others)
    assert not found.around


@pytest.mark.parametrize(("layer", "listed"), [("WINDOW", "openings"), ("BASE", "ground"), ("PAD", "support"), ("DETAIL", "ignore")])
def test_only_a_block_is_a_contour_and_only_of_what_is_read(layer: str, listed: str) -> None:
    """Outlines of windows contain panes, and ground is hatched, so they are no contours. Ignored outlines do not make a contour."""
    parts = [rectangle(((x, 0.03), (x + 0.46, 0.47)), layer="DETAIL") for x in (0.03, 0.51)]
    drawn = Drawn(1.0, [rectangle(CONTOUR, layer="STONES" if layer == "DETAIL" else layer), *parts])
    found = cleaned(drawn, 0.0, lambda name, _: listed if name == layer else "blocks")
    assert len(found.outlines) == 3
    assert not found.around
    assert cleaned(drawn, 0.0).around


def test_panes_in_a_listed_opening_become_no_blocks(tmp_path: Path) -> None:
    shapes = {"SILL": [(0, 500, 3000, 200)], "JAMBS": [(0, 0, 1000, 500), (2000, 0, 1000, 500)]}
    shapes |= {"WINDOW": [(1000, 0, 1000, 500)], "GLASS": [(1000, 0, 480, 500), (1520, 0, 480, 500)]}
    rows = [f'<rect x="{x}" y="{y}" width="{w}" height="{h}" class="{layer}"/>' for layer, some in shapes.items() for x, y, w, h in some]
    groups = [f'<g id="{layer}">{"".join(row for row in rows if layer in row)}</g>' for layer in shapes]
    (tmp_path / "wall.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="3000mm" height="700mm">{"".join(groups)}</svg>')
    table = Drawing(file="wall.svg", thickness=0.4, unit="mm", openings=("WINDOW",), ground=("SILL",))
    shapes_built, counts = drawing_blocks(table, read_drawing(table, tmp_path), 0.0)
    assert [len(shapes_built), counts.openings, counts.in_openings] == [3, 1, 2]


@pytest.mark.parametrize("opening", ["900 200 200 300", "150 150 100 100", "900 0 200 400", "900 600 200 150"])
def test_a_stone_around_an_opening_is_refused_since_it_would_be_built_solid(opening: str, tmp_path: Path) -> None:
    x, y, width, height = opening.split()
    rows = (
        f'<g id="STONE"><rect width="2000" height="700"/></g><g id="WINDOW"><rect x="{x}" y="{y}" width="{width}" height="{height}"/></g>'
    )
    (tmp_path / "pier.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="700mm">{rows}</svg>')
    table = Drawing(file="pier.svg", thickness=0.4, unit="mm", openings=("WINDOW",), shift=(10.0, 20.0))
    middle = 10.0 + (float(x) + float(width) / 2.0) / 1e3, 20.0 - (float(y) + float(height) / 2.0) / 1e3
    with pytest.raises(SceneError, match='lies in blocks on layer "STONE"') as refused:
        drawing_blocks(table, read_drawing(table, tmp_path), 0.0)
    assert f"near ({middle[0]:.4g}, {middle[1]:.4g}) m" in str(refused.value)


def _wall_of_two(opening: str, folder: Path, more: str = "") -> tuple[Drawing, MeshFile]:
    """Two stones side by side, together 2 by 0.7 m, and an opening across their joint."""
    layers = {"LEFT": "0 0 1000 700", "RIGHT": "1000 0 1000 700", "WINDOW": opening}
    rows = "".join(f'<g id="{layer}">{_rect(numbers)}</g>' for layer, numbers in layers.items())
    (folder / "wall.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="700mm">{rows}{more}</svg>')
    table = Drawing(file="wall.svg", thickness=0.4, unit="mm", openings=("WINDOW",), shift=(10.0, 20.0))
    return table, read_drawing(table, folder)


def test_an_opening_across_several_stones_is_refused_however_little_of_it_lies_in_each(tmp_path: Path) -> None:
    """A third of the opening lies in each stone, and a further stone touches the opening from outside."""
    table, file = _wall_of_two("900 500 200 300", tmp_path, f'<g id="BEYOND">{_rect("900 800 200 100")}</g>')
    with pytest.raises(SceneError, match='lies in blocks on layer "LEFT", "RIGHT", and'):
        drawing_blocks(table, file, 0.0)


@pytest.mark.parametrize(("reach", "is_told"), [(5, False), (40, False), (60, True), (200, True)])
def test_an_opening_that_reaches_into_stones_is_told_since_they_stay_whole(reach: int, is_told: bool, tmp_path: Path) -> None:
    """The opening, 500 mm high, reaches `reach` mm down into both stones."""
    table, file = _wall_of_two(f"600 {reach - 500} 900 500", tmp_path)
    shapes_built, counts = drawing_blocks(table, file, 0.0)
    blocks = Blocks.gather(["left", "right"], ["free"] * 2, [1.0] * 2, [named.shape for named in shapes_built])
    assert blocks.volume == pytest.approx([0.28, 0.28])
    place = f"(the first near (11.05, {20.25 - reach / 1e3:.4g}) m)"
    expected = (
        f'drawing "wall.svg": 1 opening on layer "WINDOW" {place} reaches into blocks, which stay whole; draw these blocks around it.'
    )
    assert counts.warnings() == ((expected,) if is_told else ())


@pytest.mark.parametrize(("share", "blocks"), [(0.7, 3), (0.9, 2)])
def test_an_outline_with_most_of_it_in_an_opening_is_no_block(share: float, blocks: int, tmp_path: Path) -> None:
    rows = f'<g id="STONE">{_rect("0 0 1000 700")}{_rect("1500 0 500 700")}{_rect(f"{1500 - 200 * share} 100 200 200")}</g>'
    rows += f'<g id="WINDOW">{_rect("1000 0 500 150")}{_rect("1000 150 500 550")}</g>'  # an opening of two lights
    (tmp_path / "wall.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="700mm">{rows}</svg>')
    table = Drawing(file="wall.svg", thickness=0.4, unit="mm", openings=("WINDOW",))
    assert len(drawing_blocks(table, read_drawing(table, tmp_path), 0.0)[0]) == blocks


@pytest.mark.parametrize("tolerance", [0.0, 0.005])
def test_a_stone_that_is_drawn_around_its_hole_with_a_slit_is_built(tolerance: float, tmp_path: Path) -> None:
    """The message and the pages advise this outline. A tolerance wider than the slit does not close it."""
    hole = "1000.5,700 1000.5,500 1200,500 1200,200 900,200 900,500 999.5,500 999.5,700"
    rows = f'<g id="STONE"><polygon points="0,0 2000,0 2000,700 {hole} 0,700"/></g><g id="WINDOW">{_rect("900 200 300 300")}</g>'
    (tmp_path / "pier.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="700mm">{rows}</svg>')
    table = Drawing(file="pier.svg", thickness=0.4, unit="mm", openings=("WINDOW",))
    (built,), _ = drawing_blocks(table, read_drawing(table, tmp_path), tolerance)
    assert Blocks.gather(["pier"], ["free"], [1.0], [built.shape]).volume == pytest.approx([0.4 * (2.0 * 0.7 - 0.3 * 0.3 - 0.001 * 0.2)])


def test_a_frame_in_an_opening_with_panes_of_their_own_is_no_stone_around_them(tmp_path: Path) -> None:
    shapes = {
        "SILL": ["0 1600 1400 100", "0 1700 1400 200"],
        "WINDOW": ["0 0 1200 1600", "300 300 600 1000"],
        "FRAME": ["100 100 1000 1400"],
    }
    rows = "".join(f'<g id="{layer}">{"".join(_rect(one) for one in some)}</g>' for layer, some in shapes.items())
    (tmp_path / "wall.svg").write_text(f'<svg xmlns="http://www.w3.org/2000/svg" width="2000mm" height="2000mm">{rows}</svg>')
    table = Drawing(file="wall.svg", thickness=0.4, unit="mm", openings=("WINDOW",), ground=("SILL",))
    shapes_built, counts = drawing_blocks(table, read_drawing(table, tmp_path), 0.0)
    assert [len(shapes_built), counts.openings, counts.in_openings] == [2, 2, 1]


def _rect(numbers: str) -> str:
    x, y, width, height = numbers.split()
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}"/>'
