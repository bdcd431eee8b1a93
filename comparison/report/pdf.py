"""A report as an A4 PDF, printed by Chromium or Chrome where one is installed."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from comparison.errors import PrinterMissingError
from la_core.exchange import write_whole

BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
PATIENCE = 300.0  # s for one page; a report of many scenes takes a few


def find_browser() -> str | None:
    """Return the path of an installed browser that prints pages; None if no such browser is installed."""
    return next((found for name in BROWSERS if (found := shutil.which(name))), None)


def write_pdf(page: Path) -> Path:
    """Print a report to a PDF file beside it and return its path.

    Raises PrinterMissingError where no browser is installed, or where it prints nothing.

    Parameters
    ----------
    page : Path
        The HTML page of a report.
    """
    program = find_browser()
    if program is None:
        rule = "needs Chromium or Chrome, which is not installed"
        raise PrinterMissingError(f"a PDF {rule}; `apt-get install chromium`, or open {page} in any browser and print it")
    with tempfile.TemporaryDirectory(prefix="crosscheck-pdf-") as folder:
        printed = Path(folder) / "report.pdf"
        command = [program, "--headless=new", "--disable-gpu", "--no-first-run", "--disable-extensions", "--disable-background-networking"]
        command += ["--no-sandbox"] if os.geteuid() == 0 else []  # as root its sandbox does not start; the page loads nothing
        command += [f"--user-data-dir={folder}/profile", "--no-pdf-header-footer", "--generate-pdf-document-outline"]  # bookmarks
        command += [f"--print-to-pdf={printed}", page.resolve().as_uri()]
        try:
            ended = subprocess.run(command, capture_output=True, timeout=PATIENCE, check=False)
        except subprocess.TimeoutExpired as error:
            raise PrinterMissingError(f"{program} did not print {page} within {PATIENCE:.0f} s; open the page and print it") from error
        if not printed.is_file() or not printed.stat().st_size:
            said = ended.stderr.decode(errors="replace").strip().splitlines()[-1:] or ["without a message"]
            raise PrinterMissingError(f"{program} did not print {page} ({said[0]}); open the page and print it")
        write_whole(page.with_suffix(".pdf"), printed.read_bytes())
    return page.with_suffix(".pdf")
