"""A figure as a file: PNG, SVG or PDF, with the same bytes for the same figure."""

import io
import warnings
from pathlib import Path

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from la_core.exchange import write_whole

DPI = 130  # of a PNG


def save(figure: Figure, path: Path) -> None:
    """Write a figure in the format of the path's suffix: .png, .svg or .pdf. The file stores no date."""
    write_whole(path, rendered(figure, path.suffix))


def rendered(figure: Figure, suffix: str) -> bytes:
    """Return the content of a figure's file; `suffix` is ".png", ".svg" or ".pdf"."""
    metadata = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(suffix, {"Software": None})
    with warnings.catch_warnings():
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
