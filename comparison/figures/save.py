"""A figure as a file: PNG, SVG or PDF, with the same bytes for the same figure, whatever style the user has set in matplotlib."""

import io
import os
import threading
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from matplotlib import rc_context, rcParamsDefault
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from la_core.exchange import write_whole

DPI = 130  # of a PNG
SALT = "crosscheck"  # of the names of an SVG's parts, which would else be random
STYLE = {name: value for name, value in rcParamsDefault.items() if not name.startswith(("backend", "interactive"))} | {"svg.hashsalt": SALT}

_ONE_STYLE = threading.RLock()  # all threads share one style: the last of several to end would restore that of another


def _renew_lock() -> None:
    global _ONE_STYLE  # noqa: PLW0603 - no thread of a forked process would ever release the old one
    _ONE_STYLE = threading.RLock()


os.register_at_fork(after_in_child=_renew_lock)


@contextmanager
def own_style() -> Iterator[None]:
    """Set matplotlib's default style in the context, then restore the user's: a report is the same everywhere, and needs no LaTeX."""
    with _ONE_STYLE, rc_context(STYLE):
        yield


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the path's suffix: .png, .svg or .pdf. The file stores no date."""
    write_whole(path, rendered(figure, path.suffix))


def rendered(figure: Figure, suffix: str) -> bytes:
    """Return the content of a figure's file; `suffix` is ".png", ".svg" or ".pdf". The figure stays as it was."""
    metadata = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(suffix, {"Software": None})
    with own_style(), warnings.catch_warnings(), _unmoved(figure):  # all threads share the filters of warnings, too
        warnings.filterwarnings("ignore", "Glyph")  # a letter that the font lacks is drawn as a box
        content = io.BytesIO()
        if suffix == ".png":  # savefig draws twice; one drawing finds the same layout, unless a title has several lines
            before, canvas = figure.dpi, figure.canvas
            try:
                figure.set_dpi(DPI)
                if any("\n" in axes.get_title() for axes in figure.axes):
                    figure.draw_without_rendering()
                FigureCanvasAgg(figure).print_png(content, metadata=metadata)
            finally:
                figure.set_dpi(before)
                figure.set_canvas(canvas)
        else:
            figure.savefig(content, format=suffix[1:], dpi=DPI, metadata=metadata)
    return content.getvalue()


@contextmanager
def _unmoved(figure: Figure) -> Iterator[None]:
    """Restore the positions of axes and titles: each layout begins with that of the drawing before, and would drift."""
    places = [(axes, axes.get_position(original=True), axes.get_position(), axes.get_in_layout()) for axes in figure.axes]
    texts = [(text, text.get_position(), text.get_verticalalignment()) for text in figure.texts]
    try:
        yield
    finally:
        for axes, original, active, in_layout in places:
            axes.set_position(original, which="original")
            axes.set_position(active, which="active")
            axes.set_in_layout(in_layout)  # set_position takes the axes out of the layout
        for text, position, alignment in texts:
            text.set_position(position)
            text.set_verticalalignment(alignment)
