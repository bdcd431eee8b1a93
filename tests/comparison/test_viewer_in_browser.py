"""The report's interactive view in a real browser: it turns, moves and shows on request, without errors and without a network."""

import itertools
import json
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from browser import Browser, find_browser
from conftest import CrossChecked

from comparison.cli.commands import main
from comparison.report import viewer
from comparison.report.report import write_report

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(find_browser() is None, reason="neither Chromium nor Chrome is installed; `make test-browser` installs one"),
]
CHANGED = 2e-3  # share of the pixels: far less than a block's face, far more than a rim of an edge
VIEW = "details.viewer"
CANVAS = f"{VIEW} .stage > canvas"
HOSTILE = "</script><script>document.title = 'obeyed'</script><img src=x onerror=\\\"document.title = 'obeyed'\\\"> {{ 7 * 7 }}"


@pytest.fixture(scope="module")
def report(tmp_path_factory: pytest.TempPathFactory, cross_checked: Callable[[str], CrossChecked], two_pads: str) -> Path:
    """A report of two pads by both methods, and of seven copies of a hostile scene."""
    folder = tmp_path_factory.mktemp("report")
    found = cross_checked("two_pads")
    shutil.copytree(found.folder, folder / "two_pads")
    scene = folder / "hostile.toml"
    load = f'[[load]]\nname = "{HOSTILE}"\nblocks = ["*"]\nmass = 100.0\n'
    tie = '[[tie]]\nname = "rod"\nblocks = ["*"]\nfrom = [1.0, 0.1, 0.4]\nto = [0.0, 0.1, -0.1]\nforce = 100.0\n'.replace("*", HOSTILE)
    text = (two_pads.split("[expected]", maxsplit=1)[0] + load + tie).replace('title   = "', f'title   = "{HOSTILE}', 1)
    scene.write_text(text.replace('name    = "block"', f'name    = "{HOSTILE}"'), encoding="utf-8")
    assert main(["run", str(scene), "-o", str(folder), "--no-yade", "-q"]) == 0
    hostile = json.loads((folder / "hostile" / "comparison.json").read_text(encoding="utf-8"))
    return write_report(folder, [found.summary, *[hostile] * 7], {})


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    with Browser(find_browser() or "") as found:
        yield found


@pytest.fixture
def view(browser: Browser, report: Path) -> Iterator[Browser]:
    """The page with its first view open. After every test the browser has reported no error and made no request to a network."""
    browser.open(report)
    browser.click(f"{VIEW} summary")
    browser.wait(f"document.querySelector('{CANVAS}')")
    yield browser
    assert browser.errors == []
    assert {url.partition(":")[0] for url in browser.requests} <= {"file", "data"}
    assert browser.value("document.title") != "obeyed"


def changed(before: np.ndarray, after: np.ndarray) -> bool:
    assert before.shape == after.shape
    return bool(np.mean(np.any(before != after, axis=2)) > CHANGED)


def halves(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the left half of the picture, of limit analysis, and the right half, of YADE."""
    middle = picture.shape[1] // 2
    return picture[:, :middle], picture[:, -middle:]


def place(browser: Browser, across: float, down: float, selector: str = CANVAS) -> tuple[float, float]:
    """Return a place in an element, pixels, from shares of its width and height."""
    x, y, width, height = browser.box(selector)
    return x + across * width, y + down * height


def test_the_slider_drags_the_settlement_of_both_methods(view: Browser) -> None:
    slider, words = f"{VIEW} input[type=range]", f"document.querySelector('{VIEW} output').textContent"
    pictures, told = [view.picture(CANVAS)], [view.value(words)]
    for start, end in ((0.99, 0.5), (0.5, 0.01)):
        view.drag(place(view, start, 0.5, slider), place(view, end, 0.5, slider))
        pictures.append(view.picture(CANVAS))
        told.append(view.value(words))
    for before, after in itertools.pairwise(pictures):
        assert all(map(changed, halves(before), halves(after)))
    at = [float(text.split()[0]) for text in told]
    assert at[0] > 1.5 * at[1] > at[1] > at[2] == 0.0
    assert all("mm; displacements drawn" in text for text in told)


def test_the_mouse_turns_both_methods_alike_and_the_view_can_be_reset(view: Browser) -> None:
    first = view.picture(CANVAS)
    view.drag(place(view, 0.2, 0.5), place(view, 0.3, 0.6))
    turned = view.picture(CANVAS)
    assert all(map(changed, halves(first), halves(turned)))
    view.drag(place(view, 0.7, 0.5), place(view, 0.7, 0.7), "right")
    moved = view.picture(CANVAS)
    assert all(map(changed, halves(turned), halves(moved)))
    view.click(f"{VIEW} .controls:nth-of-type(3) button")
    assert np.array_equal(view.picture(CANVAS), first)


def test_one_finger_turns_and_two_zoom(view: Browser) -> None:
    view.send("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
    first = view.picture(CANVAS)
    view.swipe([place(view, 0.2, 0.5)], [place(view, 0.3, 0.6)])
    turned = view.picture(CANVAS)
    assert all(map(changed, halves(first), halves(turned)))
    view.swipe([place(view, 0.2, 0.5), place(view, 0.3, 0.5)], [place(view, 0.1, 0.5), place(view, 0.4, 0.5)])
    assert view.value("opened[0].camera.zoom") > 1.2
    assert changed(turned, view.picture(CANVAS))
    view.send("Emulation.setTouchEmulationEnabled", enabled=False)


def test_the_settlement_can_be_played(view: Browser) -> None:
    button, value = f"{VIEW} .controls > button", f"Number(document.querySelector('{VIEW} input[type=range]').value)"
    view.click(button)
    view.wait(f"{value} > 0 && {value} < 1000")
    before = view.value(value)
    view.wait(f"{value} > {before}")
    view.click(button)
    view.wait(f"document.querySelector('{button}').textContent === 'play'")  # a busy browser receives the click late
    stopped = view.value(value)
    view.picture(CANVAS)  # two frames later
    assert view.value(value) == stopped
    assert view.value(f"document.querySelector('{button}').textContent") == "play"


def test_a_click_picks_a_block_or_a_joint_and_a_click_beside_them_nothing(view: Browser) -> None:
    picked = f"document.querySelector('{VIEW} .picked').textContent"
    nothing, first = view.value(picked), view.picture(CANVAS)
    for k, method in enumerate(("limit analysis (Coulomb)", "YADE")):
        middle = place(view, 0.25 + 0.5 * k, 0.4)
        view.drag(middle, middle)
        assert view.value(picked).startswith(f'{method}: block "block", weight ')
        assert not np.array_equal(view.picture(CANVAS), first)  # the block's outline is drawn
        left, top, _, _ = view.box(CANVAS)
        pixel = view.value(f"opened[0].frame.pixel(new THREE.Vector3().fromArray(opened[0].methods[{k}].middle.array), {k})")
        mark = left + pixel[0], top + pixel[1]
        view.drag(mark, mark)
        assert view.value(picked).startswith(f'{method}: joint of "') and " normal force " in view.value(picked)
    corner = place(view, 0.02, 0.02)
    view.drag(corner, corner)
    assert view.value(picked) == nothing and np.array_equal(view.picture(CANVAS), first)


def test_keys_do_what_the_mouse_does(view: Browser) -> None:
    view.value(f"document.querySelector('{CANVAS}').focus()")
    first = view.picture(CANVAS)
    for key, shift in (("ArrowLeft", False), ("ArrowDown", False), ("ArrowRight", True), ("+", False)):
        before = view.picture(CANVAS)
        view.press(key, shift)
        assert changed(before, view.picture(CANVAS)), key
        view.press("0")
        assert np.array_equal(view.picture(CANVAS), first), key


def test_the_wheel_scrolls_the_page_until_the_picture_is_chosen(view: Browser) -> None:
    middle = place(view, 0.25, 0.5)
    before = view.value("scrollY")
    view.wheel(middle, -200.0)
    view.wait(f"scrollY < {before}")
    assert view.value("opened[0].camera.zoom") == 1.0
    view.value(f"document.querySelector('{CANVAS}').focus()")
    middle = place(view, 0.25, 0.5)
    first, before = view.picture(CANVAS), view.value("scrollY")
    view.wheel(middle, -200.0)
    view.wait("opened[0].camera.zoom > 1")
    assert view.value("scrollY") == before
    assert changed(first, view.picture(CANVAS))


def test_forces_points_and_stone_are_shown_on_request(view: Browser) -> None:
    for name in ("forces", "through", "points"):
        before = view.picture(CANVAS)
        view.click(f"{VIEW} .{name}")
        after = view.picture(CANVAS)
        assert not np.array_equal(before, after), name
        view.click(f"{VIEW} .{name}")
        assert np.array_equal(view.picture(CANVAS), before), name


def test_every_colour_has_its_words(view: Browser) -> None:
    words = view.value(f"[...document.querySelectorAll('{VIEW}[open] .legend > span')].map((key) => key.textContent)")
    for name in ("fixed (ground)", "support", "moves, limit analysis (Coulomb)", "moves, YADE", "before", "joint opens"):
        assert name in words
    assert len(words) == len(set(words))


def test_a_closed_view_is_released_and_few_are_open_at_once(view: Browser) -> None:
    views = view.value(f"document.querySelectorAll('{VIEW}').length")
    assert views == 8
    canvases = f"document.querySelectorAll('{CANVAS}').length"
    for number in range(1, views):
        view.value(f"document.querySelectorAll('{VIEW}')[{number}].open = true")
        view.wait(f"document.querySelectorAll('{VIEW}')[{number}].querySelector('.stage > canvas')")
    view.wait(f"{canvases} === 6")
    view.value(f"document.querySelectorAll('{VIEW}').forEach((one) => {{ one.open = false; }})")
    view.wait(f"{canvases} === 0")
    view.click(f"{VIEW} summary")
    view.wait(f"{canvases} === 1")
    assert np.ptp(view.picture(CANVAS)) > 0


def test_names_are_shown_and_not_obeyed(view: Browser) -> None:
    view.value(f"document.querySelectorAll('{VIEW}')[1].open = true")
    view.wait(f"document.querySelectorAll('{CANVAS}').length === 2")
    label = view.value(f"document.querySelectorAll('{CANVAS}')[1].getAttribute('aria-label')")
    assert "</script><script>document.title" in label and "{{ 7 * 7 }}" in label
    assert view.value(f"document.querySelectorAll('{VIEW} img').length") == 0


def test_loads_are_drawn_with_their_words_until_they_are_switched_off(view: Browser) -> None:
    second = "document.querySelectorAll('details.viewer')[1]"
    view.value(f"{second}.open = true; {second}.id = 'loaded'")
    view.wait(f"{second}.querySelector('.stage > canvas')")
    labels = "[...document.querySelectorAll('#loaded .labels span')].filter((one) => one.style.visibility === 'visible')"
    with_loads = view.picture("#loaded .stage > canvas")
    words = view.value(f"{labels}.map((one) => one.textContent)")
    assert words == [f"{HOSTILE.replace(chr(92), '')}: 0.981 kN", "rod: 0.100 kN"]
    tops = view.value(f"{labels}.map((one) => one.offsetTop)")
    assert abs(tops[0] - tops[1]) > 5
    legend = view.value("[...document.querySelectorAll('#loaded .legend > span')].map((key) => key.textContent)")
    assert legend[-2:] == ["dead load", "tie"]
    view.click("#loaded .loads")
    without = view.picture("#loaded .stage > canvas")
    assert not np.array_equal(with_loads, without)
    assert view.value(f"{labels}.length") == 0
    assert view.value("document.querySelectorAll('details.viewer')[0].querySelector('.loads')") is None
    view.click("#loaded .loads")
    assert np.array_equal(view.picture("#loaded .stage > canvas"), with_loads)


def test_without_webgl_a_sentence_says_so(browser: Browser, report: Path) -> None:
    script = "HTMLCanvasElement.prototype.getContext = () => null;"
    added = browser.send("Page.addScriptToEvaluateOnNewDocument", source=script)["identifier"]
    browser.open(report)
    browser.click(f"{VIEW} summary")
    browser.wait(f"document.querySelector('{VIEW} .fallback').textContent.includes('cannot be shown here')")
    assert browser.value(f"document.querySelector('{VIEW} .fallback').checkVisibility()")
    browser.send("Page.removeScriptToEvaluateOnNewDocument", identifier=added)


def test_a_view_on_a_narrow_screen_stands_in_one_column(view: Browser) -> None:
    wide = view.box(CANVAS)
    view.send("Emulation.setDeviceMetricsOverride", width=400, height=800, deviceScaleFactor=1, mobile=False)
    view.wait(f"document.querySelector('{VIEW} .stage').classList.contains('stacked')")
    narrow = view.box(CANVAS)
    assert narrow[2] < 400.0 < wide[2] and narrow[3] > wide[3] / 2.0
    view.send("Emulation.clearDeviceMetricsOverride")


def test_the_view_is_part_of_every_run(report: Path) -> None:
    assert (report.parent / "hostile" / viewer.FILE).is_file()
