"""Remarks for the user about the lines and outlines of a drawing: sentences without full stops."""

import json
from collections.abc import Mapping, Sequence

from la_core.drawing.cleaning import Cleaned
from la_core.drawing.outlines import (
    ABSENT,
    AREAS,
    CLIPPED,
    ELSEWHERE,
    FILLINGS,
    HIDDEN,
    MISSING,
    REFERENCE,
    Drawn,
    LayerCount,
    OpenOutline,
    SharedAreas,
)
from la_core.text_table import number_text, place_text

MOST_NAMED = 3  # open outlines that a sentence names


def remarks(
    open_outlines: Sequence[OpenOutline],
    stray: Sequence[LayerCount],
    around: Sequence[LayerCount],
    across: Sequence[LayerCount],
    covered: Sequence[LayerCount] = (),
    edges: Sequence[LayerCount] = (),
    areas: Sequence[LayerCount] = (),
    shared: Sequence[SharedAreas] = (),
    of_two_kinds: Sequence[LayerCount] = (),
) -> list[str]:
    """Sentences about a drawing; an empty argument yields no sentence.

    Parameters
    ----------
    open_outlines : sequence of OpenOutline
        Lines that were meant as outlines.
    stray : sequence of LayerCount
        Lines that lie in blocks and divide no block.
    around : sequence of LayerCount
        Outlines that are left out because others lie within them.
    across : sequence of LayerCount
        Lines that divide blocks of other layers.
    covered : sequence of LayerCount
        Openings that blocks cover in part.
    edges : sequence of LayerCount
        Lines that may be edges of stones, and enclose nothing.
    areas : sequence of LayerCount
        Areas that lines and outlines enclose together, and that are no blocks.
    shared : sequence of SharedAreas
        Areas that lines of several layers or colours enclose together, and that are no blocks.
    of_two_kinds : sequence of LayerCount
        Outlines that are drawn again on a layer with another role, thickness or density, which counts instead.
    """
    left_out = (_stray_words(stray), _around_words(around), _across_words(across), _covered_words(covered))
    lost = (_edge_words(edges), _area_words(areas), *map(_shared_words, shared))
    told = (open_words(open_outlines), *left_out, *lost, _twice_words(of_two_kinds))
    return [words for words in told if words]


def unseen_words(ignored: Mapping[str, int]) -> list[str]:
    """Sentences about hidden entities, clip paths and missing parts of a drawing. ignored: number of unread entities by kind."""
    told = []
    if hidden := ignored.get(HIDDEN, 0):
        what = "1 entity that the drawing hides is left out" if hidden == 1 else f"{hidden} entities that the drawing hides are left out"
        told.append(f"{what}; show hidden layers to have them read")
    if clipped := ignored.get(CLIPPED, 0):
        told.append(f"clip paths are not read ({clipped}), so the parts that they cut off are read, too; delete these parts in the drawing")
    return [*told, *lacking_words(ignored)]


def lacking_words(ignored: Mapping[str, int]) -> list[str]:
    """Sentences about stones that other programs may show, but that are missing or misplaced here. ignored: as in `unseen_words`."""
    told = []
    if elsewhere := ignored.get(ELSEWHERE, 0):
        told.append(f"{ELSEWHERE} are not read ({elsewhere}); bind these external references into the drawing")
    if missing := ignored.get(MISSING, 0):
        told.append(f"{MISSING} show nothing ({missing}); save the drawing again with all its blocks")
    if absent := ignored.get(ABSENT, 0):
        told.append(f"copies by <use> of what the file does not hold show nothing ({absent}); save the drawing again with all its parts")
    if moved := ignored.get(REFERENCE, 0):
        told.append(f"{REFERENCE} are not read ({moved}), so copies of these symbols may stand beside their places; unlink them")
    if areas := ", ".join(f"{ignored[kind]} {kind}" for kind in AREAS if kind in ignored):
        told.append(f"entities that may be stones are not read ({areas}); where they are, draw them as closed polylines")
    return told


def why_none(clean: Cleaned, drawn: Drawn, taken: str = "") -> str:
    """Say why a drawing has no outline of a block: open outlines, idle lines, outlines in other lists, or entities that are not read.

    taken: words about the outlines that other lists take, "" if they take none.
    """
    if clean.open_outlines:
        return open_words(clean.open_outlines)
    if clean.specks and not (clean.outlines or taken):
        one = f"one unit of the file is {drawn.unit:g} m"
        what = "1 outline is" if clean.specks == 1 else f"{clean.specks} outlines are"
        return f"{what} thinner than the tolerance, where {one}; state another `unit`, or `scale` for a drawing to scale"
    unread = _unread_words(drawn.ignored)
    if not (drawn.outlines or drawn.lines or unread):
        return "nothing is drawn in it; make sure that the file is whole, and save it again"
    layers = sorted({layer for layer, _ in clean.idle})
    apart = f"; lines enclose blocks together on one layer, and these are on {', '.join(layers)}" if len(layers) > 1 else ""
    idle = f"it has {len(clean.idle)} lines that enclose nothing{apart}" if clean.idle or not taken else ""
    return "; ".join(words for words in (idle, taken, unread) if words)


def _unread_words(ignored: Mapping[str, int]) -> str:
    """Words about the entities that are not read in a drawing without a block, with advice if they may be areas; "" for none.

    ignored: number of entities of each kind that are not read.
    """
    if not ignored:
        return ""
    hint = "; where these are stones, draw them as closed polylines" if any(kind in ignored for kind in (*AREAS, *FILLINGS)) else ""
    return f"not read: {', '.join(f'{count} {kind}' for kind, count in ignored.items())}{hint}"


def open_words(outlines: Sequence[OpenOutline]) -> str:
    """A sentence that says which outlines are open, where and by how much; "" for no outline."""
    if not outlines:
        return ""
    gap = number_text(1e3 * max(one.gap for one in outlines), 3)
    layers = ", ".join(_quoted(layer) for layer in dict.fromkeys(one.layer for one in outlines))
    places = ", ".join(place_text((one.x, one.z)) for one in outlines[:MOST_NAMED])
    if len(outlines) == 1:
        return f"the outline on layer {layers} that begins at {places} is open by {gap} mm, so it is left out; close it in the drawing"
    more = ", ..." if len(outlines) > MOST_NAMED else ""
    many = f"{len(outlines)} outlines on layer {layers} that begin at {places}{more}"
    return f"{many} are open by up to {gap} mm, so they are left out; close them in the drawing"


def _stray_words(lines: Sequence[LayerCount]) -> str:
    if not lines:
        return ""
    do, it = ("lies within a block and does", "it") if _is_one(lines) else ("lie within blocks and do", "them")
    hint = "a joint must run from edge to edge, and a layer without joints belongs in `ignore`"
    return f"{_listed(lines, 'line')} {do} not divide {it}; {hint}"


def _around_words(outlines: Sequence[LayerCount]) -> str:
    if not outlines:
        return ""
    are, block = ("is", "it is a block") if _is_one(outlines) else ("are", "they are blocks")
    hint = "draw the inner outlines on a layer of their own, and list that layer in `ignore`"
    return f"{_listed(outlines, 'outline')} around others {are} left out; if {block}, {hint}"


def _across_words(lines: Sequence[LayerCount]) -> str:
    if not lines:
        return ""
    hint = "a layer without joints belongs in `ignore`"
    return f"{_listed(lines, 'line')} from edge to edge of blocks on other layers {'divides' if _is_one(lines) else 'divide'} them; {hint}"


def _covered_words(openings: Sequence[LayerCount]) -> str:
    if not openings:
        return ""
    reaches, it = ("reaches", "it") if _is_one(openings) else ("reach", "them")
    return f"{_listed(openings, 'opening')} {reaches} into blocks, which stay whole; draw these blocks around {it}"


def _edge_words(lines: Sequence[LayerCount]) -> str:
    if not lines:
        return ""
    encloses, it, its = (
        ("encloses", "it is an edge", "its ends meet") if _is_one(lines) else ("enclose", "they are edges", "their ends meet")
    )
    return f"{_listed(lines, 'line')} {encloses} nothing, although {its} others, or nearly do; where {it} of a stone, close its outline"


def _area_words(areas: Sequence[LayerCount]) -> str:
    if not areas:
        return ""
    are, block = ("is", "is no block") if _is_one(areas) else ("are", "are no blocks")
    hint = "close the outline of each stone; a layer without stones belongs in `ignore`"
    return f"{_listed(areas, 'area')} {are} enclosed by lines and outlines together, but {block}; {hint}"


def _shared_words(areas: SharedAreas) -> str:
    *rest, last = map(_quoted, areas.layers)
    whose = f"layers {', '.join(rest)} and {last}" if rest else f"several colours on layer {last}"
    place = place_text((areas.x, areas.z))
    what, are, them = (f"1 area (near {place}) is", "is no block", "it is a stone")
    if areas.count > 1:
        what, are, them = (f"{areas.count} areas (the first near {place}) are", "are no blocks", "they are stones")
    hint = "draw these lines on one layer and in one colour; a layer without joints belongs in `ignore`"
    return f"{what} enclosed by lines of {whose} together, but {are}; where {them}, {hint}"


def _twice_words(outlines: Sequence[LayerCount]) -> str:
    if not outlines:
        return ""
    again, do = ("is drawn again on a layer", "does") if _is_one(outlines) else ("are drawn again on layers", "do")
    hint = "`ground` counts before `support`, and both before `blocks`; draw each stone on one layer"
    return f"{_listed(outlines, 'outline')} {again} of another role, thickness or density, and {do} not count: {hint}"


def _is_one(some: Sequence[LayerCount]) -> bool:
    return sum(one.count for one in some) == 1


def _listed(some: Sequence[LayerCount], word: str) -> str:
    """Number of lines, outlines or areas (`word`) on each layer, and place of the first one."""
    on_layers = ", ".join(f"{one.count} {word}{'' if one.count == 1 else 's'} on layer {_quoted(one.layer)}" for one in some)
    return f"{on_layers} (the first near {place_text((some[0].x, some[0].z))})"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
