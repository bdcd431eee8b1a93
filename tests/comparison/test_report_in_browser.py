"""The report in a real browser: it fits the screen of a phone, every text has contrast in light and dark colours, and it prints on A4."""

import re
import shutil
import zlib
from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

import pytest
from browser import Browser, find_browser
from campaigns import QUICK
from conftest import CrossChecked

from comparison.cli.commands import main
from comparison.report.pdf import write_pdf
from comparison.report.report import write_report
from la_core.scene.shipped import find

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(find_browser() is None, reason="neither Chromium nor Chrome is installed; `make test-browser` installs one"),
]
WIDTHS = (1400, 800, 390)  # pixels of a screen, a tablet, a phone
CONTRAST = 4.5  # of WCAG 2.1, success criterion 1.4.3, for text of any size

# Contrast of every visible text with the background of its nearest opaque parent element. Texts in pictures are not checked.
POOR = """(() => {
  const channel = (value) => (value <= 0.03928 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4);
  const parts = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const light = (colour) => parts(colour).slice(0, 3).reduce((sum, part, k) => sum + [0.2126, 0.7152, 0.0722][k] * channel(part / 255), 0);
  const behind = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const { backgroundColor } = getComputedStyle(e), alpha = parts(backgroundColor)[3] ?? 1;
      if (alpha > 0.7) return backgroundColor;
    }
    return getComputedStyle(document.body).backgroundColor;
  };
  const poor = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  let seen = 0;
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const element = node.parentElement;
    if (!node.data.trim() || !element.checkVisibility() || ['SCRIPT', 'STYLE'].includes(element.tagName)) continue;
    seen += 1;
    const [a, b] = [light(getComputedStyle(element).color), light(behind(element))].sort((x, y) => y - x);
    const ratio = (a + 0.05) / (b + 0.05);
    if (ratio < LEAST) poor.push([ratio.toFixed(2), element.className, node.data.trim().slice(0, 40)]);
  }
  return { seen, poor };
})()""".replace("LEAST", str(CONTRAST))
WIDE = "[...document.querySelectorAll('body *')].filter((e) => e.checkVisibility() && !e.closest('.wide, .picture, pre') && "
WIDE += "e.getBoundingClientRect().right > innerWidth + 1).map((e) => `${e.tagName}.${e.className}: ${e.textContent.slice(0, 40)}`)"
FRAMES = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(1))))"  # until the view fits its window
OPENED = "document.querySelectorAll('details').forEach((one) => { one.open = true; })"

PAPER = 695  # pixels, 184 mm: width of an A4 page within its margins; a wider page is printed smaller, with all its text
ORDINARY = 16  # most letters of a word that must stay whole, such as "interpenetration"
# Words of at most ORDINARY letters that are broken over two lines. A path or a name in one long word may break.
BROKEN = """(() => {
  const broken = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), range = document.createRange();
  let seen = 0;
  for (let node = walker.nextNode(); node; node = walker.nextNode()) {
    const element = node.parentElement;
    if (!element.checkVisibility() || element.closest('script, style, pre')) continue;
    for (const word of node.data.matchAll(/[^\\s-]+/g)) {
      if (word[0].length > ORDINARY) continue;
      seen += 1;
      range.setStart(node, word.index);
      range.setEnd(node, word.index + word[0].length);
      if (new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1) broken.push(word[0]);
    }
  }
  return { seen, broken };
})()""".replace("ORDINARY", str(ORDINARY))
TALL = """
title = "Tall wall on a table that is tilted"
[stone]
density = 2000.0
[joint]
friction = 0.6
[[wall]]
bond = "running"
origin = [0.0, 0.0, 0.0]
block = [0.12, 0.06, 0.06]
per_course = 3
courses = 10
footing = { height = 0.03 }
[tilt]
axis = [0.0, 1.0, 0.0]
"""
LONG = "pier_of_the_eastern_door_in_the_second_storey_below_the_lintel"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory, cross_checked: Callable[[str], CrossChecked]) -> Path:
    """A report of an arch and two pads by both methods."""
    folder = tmp_path_factory.mktemp("report")
    found = [cross_checked(name) for name in ("two_pads", "arch_spreading")]
    for one in found:
        shutil.copytree(one.folder, folder / one.folder.name)
    return write_report(folder, [one.summary for one in found], {}, {"project": "Town hall", "author": "A. Mason"})


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The page of a campaign of four cases, by limit analysis alone."""
    folder = tmp_path_factory.mktemp("campaign")
    (folder / "friction.toml").write_text(QUICK, encoding="utf-8")
    assert main(["campaign", str(folder / "friction.toml"), "-o", str(folder / "out"), "-q", "--workers", "1"]) == 0
    return folder / "out" / "report.html"


@pytest.fixture(scope="module")
def drives(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A report of a live load, a tilt, and a settlement under blocks with long names, by limit analysis alone."""
    folder = tmp_path_factory.mktemp("drives")
    named = find("two_pads").read_text(encoding="utf-8").replace('"settling pad"', f'"{LONG}"').replace('"fixed pad"', f'"{LONG}_2"')
    (folder / "long_names.toml").write_text(named, encoding="utf-8")
    (folder / "tall.toml").write_text(TALL, encoding="utf-8")
    scenes = ["ferris_tin_loi_1", str(folder / "tall.toml"), str(folder / "long_names.toml")]
    assert main(["run", *scenes, "--no-yade", "-o", str(folder / "out"), "-q"]) == 0
    return folder / "out" / "report.html"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser(find_browser() or "") as found:
        yield found


@pytest.mark.parametrize("page", ["report", "campaign"])
def test_every_text_has_contrast_and_nothing_runs_over_the_edge(page: str, browser: Browser, request: pytest.FixtureRequest) -> None:
    """One window changes its width and its colours. The page is loaded once, as by a reader who turns a phone."""
    path: Path = request.getfixturevalue(page)
    browser.send("Emulation.setDeviceMetricsOverride", width=WIDTHS[0], height=900, deviceScaleFactor=1, mobile=False)
    try:
        browser.open(path)
        browser.value(OPENED)
        if page == "report":
            browser.wait("document.querySelectorAll('.stage > canvas').length === 2")
        for scheme, width in product(("light", "dark"), WIDTHS):
            browser.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": scheme}])
            browser.send("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
            browser.wait(f"innerWidth === {width} && matchMedia('(prefers-color-scheme: {scheme})').matches")
            browser.send("Runtime.evaluate", expression=FRAMES, awaitPromise=True)
            assert browser.value("document.documentElement.scrollWidth") <= width, (scheme, width)
            assert browser.value(WIDE) == [], (scheme, width)
            found = browser.value(POOR)
            assert found["poor"] == [] and found["seen"] > 50, (scheme, width)
        assert browser.errors == []
    finally:
        browser.send("Emulation.clearDeviceMetricsOverride")
        browser.send("Emulation.setEmulatedMedia", features=[])


def test_a_long_verdict_fits_the_narrowest_window(browser: Browser, tmp_path: Path) -> None:
    """320 pixels are also a screen's width at a zoom of 400 %."""
    assert main(["run", "two_pads", "--no-yade", "-o", str(tmp_path), "-q"]) == 0
    browser.send("Emulation.setDeviceMetricsOverride", width=320, height=900, deviceScaleFactor=1, mobile=False)
    try:
        browser.open(tmp_path / "report.html")
        assert "expected value met (YADE not run)" in browser.value("document.body.textContent")
        assert browser.value("document.documentElement.scrollWidth") <= 320 and browser.value(WIDE) == []
    finally:
        browser.send("Emulation.clearDeviceMetricsOverride")


def test_a_long_word_does_not_widen_the_page(browser: Browser, report: Path) -> None:
    browser.send("Emulation.setDeviceMetricsOverride", width=WIDTHS[-1], height=900, deviceScaleFactor=1, mobile=False)
    try:
        browser.open(report)
        for place in ("nav a", "figcaption", "h2", ".sentence", "p.soft"):
            browser.value(f"document.querySelector('{place}').textContent = 'T'.repeat(300)")
        assert browser.value("document.documentElement.scrollWidth") <= WIDTHS[-1]
    finally:
        browser.send("Emulation.clearDeviceMetricsOverride")


def test_blocks_of_the_view_are_chosen_by_keys_alone(browser: Browser, report: Path) -> None:
    """Keys choose the blocks of one method after another, in a circle. A screen reader is told the chosen block."""
    browser.open(report)
    browser.value("document.querySelector('details.viewer').open = true")
    browser.wait("document.querySelector('.stage > canvas')")
    assert browser.value("document.querySelector('.stage > canvas').getAttribute('role')") == "application"
    browser.value("document.querySelector('.stage > canvas').focus()")
    said = []
    for key in "nnnnnnnp":
        browser.press(key)
        said.append(browser.value("document.querySelector('.picked').textContent"))
    chosen = [one.split(";")[0].split(",")[0] for one in said]
    assert all(': block "' in one for one in chosen)
    assert len(set(chosen[:6])) == 6 and chosen[6] == chosen[0] and chosen[7] == chosen[5]  # three blocks by two methods
    assert browser.errors == []


def test_the_measure_of_contrast_sees_a_pale_text(browser: Browser, report: Path) -> None:
    browser.open(report)
    browser.value("document.querySelector('h1').style.color = '#bbbbbb'")
    assert [words for _, _, words in browser.value(POOR)["poor"]] == ["Town hall"]


def test_the_report_prints_to_a4_without_half_empty_pages(report: Path, browser: Browser) -> None:
    pdf = write_pdf(report).read_bytes()
    pages = pdf.count(b"/Type /Page\n") + pdf.count(b"/Type /Page ") + pdf.count(b"/Type /Page/") + pdf.count(b"/Type /Page>")
    assert pdf.startswith(b"%PDF") and b"/MediaBox [0 0 594.95" in pdf
    assert 4 <= pages <= 14  # two scenes; each has five figures, its inputs, its scene file and its tables
    bookmarks = re.findall(rb"/Title \(([^)]*)\)", pdf)
    assert b"/Outlines" in pdf and b"What this comparison cannot say" in bookmarks and bookmarks.count(b"Checks") == 2


PAGES = ["report", "drives", "campaign"]


@pytest.mark.parametrize("page", PAGES)
def test_nothing_is_wider_than_a_sheet_of_a4(page: str, browser: Browser, request: pytest.FixtureRequest) -> None:
    """Chromium prints the whole of a page that is too wide smaller, with its text of 8.5 pt."""
    browser.send("Emulation.setDeviceMetricsOverride", width=PAPER, height=900, deviceScaleFactor=1, mobile=False)
    browser.send("Emulation.setEmulatedMedia", media="print")
    try:
        browser.open(request.getfixturevalue(page))
        browser.wait(f"innerWidth === {PAPER} && matchMedia('print').matches")
        assert browser.value("document.documentElement.scrollWidth") <= PAPER
        assert browser.value(WIDE.replace("'.wide, .picture, pre'", "'script'")) == []
        found = browser.value(BROKEN)
        assert found["broken"] == [] and found["seen"] > 300
    finally:
        browser.send("Emulation.setEmulatedMedia", media="")
        browser.send("Emulation.clearDeviceMetricsOverride")


def test_a_parameter_of_many_values_fits_a_sheet_of_a4(browser: Browser, campaign: Path) -> None:
    """The table of verdicts has one row for each scene and one column for each value. It gets 30 more columns."""
    browser.send("Emulation.setDeviceMetricsOverride", width=PAPER, height=900, deviceScaleFactor=1, mobile=False)
    browser.send("Emulation.setEmulatedMedia", media="print")
    try:
        browser.open(campaign)
        more = "for (let k = 0; k < 30; k++) row.append(row.lastElementChild.cloneNode(true))"
        browser.value(f"for (const row of document.querySelectorAll('.matrix tr:not(:has(th[colspan]))')) {{ {more} }}")
        assert browser.value("document.querySelector('.matrix tbody tr').cells.length") > 30
        assert browser.value("document.documentElement.scrollWidth") <= PAPER
    finally:
        browser.send("Emulation.setEmulatedMedia", media="")
        browser.send("Emulation.clearDeviceMetricsOverride")


@pytest.mark.parametrize("page", PAGES)
def test_text_is_printed_in_the_size_that_the_page_declares(page: str, request: pytest.FixtureRequest) -> None:
    """In a PDF a pixel is 3.125 units of 0.24 pt, and the text of tables, 8.5 pt, is 11.33 pixels high."""
    pdf, scales, sizes = write_pdf(request.getfixturevalue(page)).read_bytes(), set(), set()
    for packed in re.findall(rb"stream\r?\n(.*?)\r?\nendstream", pdf, re.DOTALL):
        try:
            drawn = zlib.decompress(packed)
        except zlib.error:
            continue  # not a compressed stream
        scales |= {float(found) for found in re.findall(rb"^([\d.]+) 0 0 \1 [1-9][\d.]* [1-9][\d.]* cm$", drawn, re.MULTILINE)}
        sizes |= {round(float(size), 2) for size in re.findall(rb"/F\d+ ([\d.]+) Tf", drawn)}
    assert scales == {3.125}
    assert 11.33 in sizes and min(sizes) == 10.0


@pytest.mark.parametrize("width", [1400, 1200, 1000])
def test_words_of_ordinary_length_stay_whole_on_a_screen(width: int, browser: Browser, report: Path, drives: Path) -> None:
    browser.send("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False)
    try:
        for page in (report, drives):
            browser.open(page)
            browser.value(OPENED)
            found = browser.value(BROKEN)
            assert found["broken"] == [] and found["seen"] > 300, page
    finally:
        browser.send("Emulation.clearDeviceMetricsOverride")
