"""A user's matplotlib style, set in Python or in a matplotlibrc, does not change the program's figures, and the program keeps it."""

import multiprocessing
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path

import matplotlib
import pytest

import comparison
import la_core
from comparison.figures import own_style, rendered

USERS = {"text.usetex": True, "font.size": 22.0, "axes.facecolor": "yellow", "savefig.facecolor": "red", "figure.dpi": 40.0}
SWEEP = '[[sweep]]\nscene = "two_pads"\nvary = { "joint.friction" = [0.3, 0.6] }\n'


@pytest.fixture(scope="module")
def answer() -> la_core.Answer:
    return la_core.solve("two_pads")


@pytest.fixture(scope="module")
def study() -> comparison.SensitivityResult:
    return comparison.sensitivity("two_pads", quiet=True)


@pytest.fixture(scope="module")
def cost() -> comparison.CostResult:
    return comparison.cost("two_pads", yade=False, quiet=True)


def drawn(draw: Callable[[], comparison.Picture]) -> list[bytes]:
    picture = draw()
    return [rendered(picture.figure, suffix) for suffix in (".png", ".svg", ".pdf")]


def is_the_same_in_a_users_style(make: Callable[[], object]) -> bool:
    """Return whether `make` has the same result under the own and the user's style, and leaves the user's style unchanged."""
    ours = make()
    with matplotlib.rc_context(USERS):
        before = dict(matplotlib.rcParams)
        theirs = make()
        return theirs == ours and dict(matplotlib.rcParams) == before


@pytest.mark.slow_after_first
@pytest.mark.parametrize("name", ["assembly", "mechanisms", "reaction", "forces", "dissipation"])
def test_figures_of_an_answer_have_their_own_style(name: str, answer: la_core.Answer) -> None:
    assert is_the_same_in_a_users_style(lambda: drawn(lambda: answer.plot(name)))


@pytest.mark.slow
def test_figures_of_a_scene_and_of_studies_have_their_own_style(
    answer: la_core.Answer, study: comparison.SensitivityResult, cost: comparison.CostResult
) -> None:
    for draw in (answer.scene.draw, study.plot, cost.plot):
        assert is_the_same_in_a_users_style(lambda draw=draw: drawn(draw))


@pytest.mark.slow
def test_an_animation_has_its_own_style(answer: la_core.Answer, tmp_path: Path) -> None:
    assert is_the_same_in_a_users_style(lambda: comparison.animate(answer, tmp_path / "moves.gif", fps=1, quiet=True).read_bytes())


@pytest.mark.slow
def test_figures_of_a_campaign_have_their_own_style(tmp_path: Path) -> None:
    (tmp_path / "sweep.toml").write_text(SWEEP, encoding="utf-8")
    folders = iter(("ours", "theirs"))

    def figures() -> dict[str, bytes]:
        folder = comparison.run_campaign(tmp_path / "sweep.toml", tmp_path / next(folders), yade=False, workers=1, quiet=True).folder
        return {path.name: path.read_bytes() for path in folder.rglob("*.png") if not path.name.startswith("costs")}  # their seconds vary

    assert is_the_same_in_a_users_style(figures)


@pytest.mark.slow
def test_figures_drawn_in_several_threads_leave_the_users_style(answer: la_core.Answer) -> None:
    with matplotlib.rc_context({"font.size": 22.0}):
        before = dict(matplotlib.rcParams)
        with ThreadPoolExecutor(4) as threads:
            figures = list(threads.map(lambda number: rendered(answer.plot("assembly").figure, ".png"), range(12)))
        assert dict(matplotlib.rcParams) == before and len(set(figures)) == 1


@contextmanager
def drawing_elsewhere() -> Iterator[None]:
    """Let another thread draw during the block of `with`."""
    begun, ended = threading.Event(), threading.Event()

    def draw() -> None:
        with own_style():
            begun.set()
            ended.wait()

    thread = threading.Thread(target=draw)
    thread.start()
    try:
        begun.wait()
        yield
    finally:
        ended.set()
        thread.join()


def test_a_process_forked_while_another_thread_draws_can_draw(answer: la_core.Answer) -> None:
    """The forked process once waited for ever for the lock of the style: the thread that held it does not exist there."""
    with drawing_elsewhere():
        process = multiprocessing.get_context("fork").Process(target=answer.plot, args=("assembly",))
        process.start()
        process.join(30.0)
        process.kill()
    assert process.exitcode == 0


def test_a_figure_that_waits_for_another_thread_leaves_the_users_warnings(answer: la_core.Answer) -> None:
    figure, filters = answer.plot("assembly").figure, warnings.filters
    with ThreadPoolExecutor(1) as threads, drawing_elsewhere():
        threads.submit(rendered, figure, ".png")
        time.sleep(0.2)
        assert warnings.filters is filters
