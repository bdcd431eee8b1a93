"""What a person opens: HTML, Markdown and JSON pages, the 3D view, ParaView files."""

from comparison.report import viewer
from comparison.report.paraview import export
from comparison.report.report import VERDICTS, stored_report, write_report
from comparison.report.templating import environment, flat

__all__ = [
    "VERDICTS",
    "environment",
    "export",
    "flat",
    "stored_report",
    "viewer",
    "write_report",
]
