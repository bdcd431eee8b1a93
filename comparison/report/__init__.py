"""Output for readers: HTML, Markdown and JSON pages, the interactive 3D view, and files for ParaView."""

from comparison.report import viewer
from comparison.report.facts import stone_density, structure_facts
from comparison.report.paraview import export_results
from comparison.report.pdf import find_browser, write_pdf
from comparison.report.plain_words import angle_words, notes_of, predicted_value
from comparison.report.report import chosen_head, stored_report, write_report
from comparison.report.templating import flat, image_address, template_environment

__all__ = [
    "angle_words",
    "chosen_head",
    "export_results",
    "find_browser",
    "flat",
    "image_address",
    "notes_of",
    "predicted_value",
    "stone_density",
    "stored_report",
    "structure_facts",
    "template_environment",
    "viewer",
    "write_pdf",
    "write_report",
]
