"""What a person opens: HTML, Markdown and JSON pages, the 3D view, ParaView files."""

from comparison.report import viewer
from comparison.report.paraview import export
from comparison.report.report import VERDICTS, stored_report, write_report
from comparison.report.templating import flat, template_environment

__all__ = [
    "VERDICTS",
    "template_environment",
    "export",
    "flat",
    "stored_report",
    "viewer",
    "write_report",
]
