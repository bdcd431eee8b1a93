"""Figures of one scene; only this room, the studies and the campaign's figures import matplotlib."""

from comparison.figures import canvas
from comparison.figures.animation import Story, require_place, write_animation
from comparison.figures.canvas import FAINT, INK, LIMIT_ANALYSIS, ROLE_FACE, YADE, method_colour, push_arrow, tint
from comparison.figures.drawing_order import OuterFaces
from comparison.figures.motion import Motion, Motions, motions, shown_answer
from comparison.figures.reaction import reaction_figure
from comparison.figures.run_figures import report_figures, scene_figures
from comparison.figures.save import DPI, own_style, rendered, save
from comparison.figures.structure import ROLE_NAME, assembly_figure, push_name

__all__ = [
    "DPI",
    "FAINT",
    "INK",
    "LIMIT_ANALYSIS",
    "ROLE_FACE",
    "ROLE_NAME",
    "YADE",
    "Motion",
    "Motions",
    "OuterFaces",
    "Story",
    "assembly_figure",
    "canvas",
    "method_colour",
    "motions",
    "own_style",
    "push_arrow",
    "push_name",
    "reaction_figure",
    "rendered",
    "report_figures",
    "require_place",
    "save",
    "scene_figures",
    "shown_answer",
    "tint",
    "write_animation",
]
