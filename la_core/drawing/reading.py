"""Read a drawing by the ending of its name."""

from dataclasses import replace

from la_core.drawing.dxf import read_dxf
from la_core.drawing.outlines import Drawn
from la_core.drawing.svg import read_svg

DRAWING_FORMATS = (".dxf", ".svg")
ADVICE = {  # next step for a file of another format, by its ending
    ".pdf": "convert a PDF to SVG, such as by `pdftocairo -svg FILE.pdf FILE.svg`",
    ".dwg": "save a DWG file as DXF",
}


def read_outlines(suffix: str, content: bytes, unit: float | None, sagitta: float, scale: float = 1.0) -> Drawn:
    """Read the outlines of a drawing.

    Parameters
    ----------
    suffix : str
        Ending of the file's name, one of DRAWING_FORMATS.
    content : bytes
        Content of the file; other files that it names are not opened.
    unit : float or None
        Metres per unit of the drawing; None takes the file's own unit.
    sagitta : float
        Largest distance between a curve and the chords that replace it, m.
    scale : float
        Length in the structure over length in the drawing: 50 for a drawing to scale 1 : 50.

    Raises
    ------
    ValueError
        The content is damaged, has no unit, or is too large; the message names the fault.
    ImportError
        The reader of DXF files is not installed.
    """
    drawn = (read_svg if suffix.lower() == ".svg" else read_dxf)(content, unit, sagitta, scale)
    return replace(drawn, sagitta=sagitta)
