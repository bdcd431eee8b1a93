"""The benchmark of growth computes its page from its measurements. The driver's work grows with its rows, not with YADE's steps."""

import importlib
import pkgutil
from pathlib import Path
from subprocess import TimeoutExpired

import benchmark_effects as effects
import benchmark_growth
import growth_report as report
import numpy as np
import pytest
import scenes

from la_core.coulomb import path
from la_core.coulomb.path import implicit_step

SIZES = (60, 120, 250, 500, 1000, 2000, 5000)
NOISE = 0.05  # relative standard deviation of a measurement, like that of CPU seconds on a busy machine
DRAWS = 400
BIAS = 4.0 / np.sqrt(DRAWS)  # four standard errors of a mean over the draws
SAME_SPREAD = 0.25  # relative, of stated errors and observed scatter: 4 sizes give an error to some 50 %, 400 draws to far less
EXACT = 1e-12  # round-off
WHOLE_TRAVEL = {"stop_uncertainty": 1e-9}  # of a run in YADE: no reaction has this uncertainty, so that the run does not stop earlier


def test_every_step_of_a_path_counts_as_the_solver_s() -> None:
    """The solver's time includes every step of a path. The steps to rest were missing once, after they had moved to their own module."""
    modules = [importlib.import_module(f"{path.__name__}.{module.name}") for module in pkgutil.iter_modules(path.__path__)]
    stepping = {module.__name__ for module in modules if hasattr(module, "advance")} - {implicit_step.__name__}
    counted = {owner.__name__ for owner, name in benchmark_growth.SOLVER.values() if name == "advance"}
    assert counted == stepping


def noisy(exponent: float, seed: int) -> list[float]:
    noise = np.random.default_rng(seed).normal(0.0, NOISE, len(SIZES))
    return list(3e-4 * np.array(SIZES) ** exponent * np.exp(noise))


@pytest.mark.parametrize("exponent", [0.0, 1.0, 1.7])
def test_a_fit_finds_the_exponent_that_noise_hides_and_says_by_how_much_it_may_be_off(exponent: float) -> None:
    fits = [report.fit(SIZES, noisy(exponent, seed)) for seed in range(DRAWS)]
    found, stated = (np.array([getattr(one, name) for one in fits]) for name in ("exponent", "error"))
    assert abs(found.mean() - exponent) < BIAS * found.std()
    assert np.sqrt(np.mean(stated**2)) == pytest.approx(found.std(), rel=SAME_SPREAD)


def test_what_small_sizes_cost_beyond_the_law_does_not_touch_the_exponent() -> None:
    blocks = [20, 40, 500, 1000, 2000, 5000]
    seconds = [1.0, 1.0, *(1e-6 * np.array(blocks[2:]) ** 1.5)]
    growth = report.fit(blocks[::-1], seconds[::-1])
    assert growth is not None and growth.sizes == (500, 1000, 2000, 5000)
    assert (growth.exponent, growth.factor) == pytest.approx((1.5, 1e-6), rel=EXACT)
    assert growth.error < EXACT


def test_two_sizes_have_no_exponent_with_an_error() -> None:
    assert report.fit([100, 200], [1.0, 2.0]) is None
    assert report.fit([100, 200, 400], [0.0, 1.0, 2.0]) is None


def made_up() -> list[dict]:
    """Return measurements of two methods as the benchmark stores them. Time grows as N^1.5, memory as N."""
    measured: list[dict] = []
    for size in (100, 200, 400):
        shared = {"blocks": size, "asked": size, "seconds": 1e-3 * size**1.5, "memory": 0.1 * size, "peak": 140.0 + 0.1 * size}
        split = {"build": 1e-4 * size, "solver": 9e-4 * size**1.5, "rest": 1e-4 * size, "outside": 0.123, "status": "solved"}
        measured.append({"method": "associated", "dimension": "plane", **shared, **split})
        measured.append({"method": "YADE", "dimension": "3D", **shared, "steps": 7 * size, "status": "no plateau", "watched": 0.0321})
    spread = {"overhead": 0.0456, "least": 0.01, "most": 0.06, "constant": 0.07, "watched": 0.02, "bare": 2.0, "row": 0.3}
    measured.append({"method": "driver", "dimension": "arch", "asked": 0, "blocks": 13, "steps": 83865, "rows": 440, "poses": 18, **spread})
    return measured


def record() -> dict:
    return {"machine": "a machine", "measured": made_up()}


def percent(share: float) -> str:
    return benchmark_growth.share({"outside": share}, "outside")


@pytest.mark.slow_after_first
@pytest.mark.parametrize("method", ["associated", "Coulomb", "all of associated", "all of Coulomb"])
def test_what_is_timed_is_a_part_of_the_whole(method: str) -> None:
    measured = benchmark_growth.measure(method, True, 20)
    assert measured["status"] == "solved" and measured["build"] > 0.0 and measured["solver"] > 0.0 and measured["rest"] >= 0.0


def test_the_page_shows_what_was_measured() -> None:
    page = benchmark_growth.markdown(record())
    fits = [report.fit((100, 200, 400), [size**power for size in (100, 200, 400)]) for power in (1.5, 1.0, 1.5, 1.0, 1.0)]
    assert report.row(["associated", "plane", "100 to 400", *fits, None, None]) in page.splitlines()
    for row in (
        ["associated", "plane", 400, "solved", 8.0, 0.04, 7.2, 0.04, percent(0.123), 40.0, 180.0],
        ["YADE", "3D", 400, "no plateau", 2800, 8.0, percent(0.0321), 40.0, 180.0],
        ["arch", 13, 83865, 440, 18, 2.0, *map(percent, (0.0456, 0.01, 0.06, 0.07, 0.02)), 0.3],
    ):
        assert report.row(row) in page.splitlines()
    assert "a machine" in page


def test_an_earlier_version_stands_beside_todays_for_the_sizes_that_both_measured() -> None:
    before = [one | {"seconds": 2.0 * one["seconds"] * one["blocks"] ** 0.5, "status": "failed"} for one in made_up()[:-2]]
    page = benchmark_growth.markdown(record() | {"before": {"version": "0.1", "measured": before}})
    fits = [report.fit((100, 200, 400), [size**power for size in (100, 200, 400)]) for power in (2.0, 1.5)]
    assert report.row(["associated", "plane", "100 to 400", *fits]) in page.splitlines()
    assert report.row(["associated", "plane", 400, "failed", "solved", 320.0, 8.0, 40.0]) in page.splitlines()
    assert report.row(["YADE", "3D", 200, "failed", "no plateau", 80.0, 2.828, 28.28]) in page.splitlines()
    assert "400 | failed | no plateau" not in page  # not measured by the earlier version
    assert "beside today's" not in benchmark_growth.markdown(record())


def test_a_run_that_did_not_end_has_its_row_and_no_part_in_the_exponents(monkeypatch: pytest.MonkeyPatch) -> None:
    def endless(*arguments: object) -> None:
        raise TimeoutExpired("yade", 600.0)

    monkeypatch.setattr(benchmark_growth, "yade_verdict", endless)
    late = {"method": "YADE", "dimension": "3D", "asked": 20} | benchmark_growth.taken("YADE", "3D", 20)
    before = [one | {"seconds": 2.0 * one["seconds"]} for one in made_up()[:-1]] + [late | {"status": "plateau", "seconds": 9.0}]
    page = benchmark_growth.markdown({"machine": "a", "measured": [*made_up(), late], "before": {"version": "0.1", "measured": before}})
    assert report.row(["YADE", "3D", late["blocks"], "not after 600 s", None, None, None, None, None]) in page.splitlines()
    assert report.row(["YADE", "3D", late["blocks"], "plateau", "not after 600 s", 9.0, None, None]) in page.splitlines()
    assert report.conclusions([*made_up(), late]) == report.conclusions(made_up())
    assert report.growth_figure({"seconds": ("seconds", benchmark_growth.by_series([*made_up(), late]))}).axes


def test_the_conclusions_quote_what_was_measured_and_leave_out_what_was_not() -> None:
    power = report.fit((100, 200, 400), [size**1.5 for size in (100, 200, 400)])
    words = report.conclusions(made_up())
    assert f"The time of one bound grows as N^({power}) in the plane." in words
    assert f"A whole run of YADE, to its verdict, grows as N^({power}) in space." in words
    assert "a bound 102 KiB (plane, 100 to 400 blocks); YADE 102 KiB (3D, 100 to 400 blocks)." in words  # 0.1 MiB
    assert "Coulomb" not in words and report.conclusions([]) == ""


def test_every_line_of_a_table_has_as_many_cells() -> None:
    for block in benchmark_growth.markdown(record()).split("\n\n"):
        if block.startswith("|"):
            assert len({line.count("|") for line in block.splitlines()}) == 1


def test_the_figure_names_methods_with_their_exponents_and_tells_them_apart_without_colour() -> None:
    series = benchmark_growth.by_series(made_up())
    axes = report.growth_figure({"seconds": ("seconds", series)}).axes[0]
    lines = [line for line in axes.lines if not line.get_label().startswith("_")]
    assert [line.get_label().split(":")[0] for line in lines] == ["associated, plane", "YADE, 3D"]
    assert all("1.50" in line.get_label() for line in lines)
    assert len({(line.get_marker(), line.get_linestyle()) for line in lines}) == len(lines)


@pytest.mark.slow
@pytest.mark.yade
def test_a_verdict_is_timed_to_its_plateau(tmp_path: Path) -> None:
    measured = benchmark_growth.yade_verdict(True, 20, tmp_path)
    assert measured["status"] == "plateau" and 0.0 < measured["watched"] < 1.0


@pytest.mark.yade
@pytest.mark.slow
def test_a_finer_time_step_gives_the_driver_no_more_work(tmp_path: Path) -> None:
    """The driver's rows and states follow the settlement, so that its share of the time falls as the number of steps grows."""
    counts = []
    for share in (0.6, 0.3):
        folder = tmp_path / str(share)
        folder.mkdir()
        settings = scenes.table("yade", time_step_share=share, **WHOLE_TRAVEL)
        scene = scenes.load(scenes.text(*scenes.wall(3, 2, split=0.8), inset=0.001) + settings + "\n", "wall")
        counts.append(effects.in_yade(benchmark_growth.PROTOCOL_COST, benchmark_growth.written(scene, folder)))
    coarse, fine = counts
    assert coarse["status"] == fine["status"] == "plateau"
    assert fine["steps"] > 1.5 * coarse["steps"]  # half the step gives twice as many steps, except for the ends of the stages
    # The number of steps between two rows is rounded.
    rounded = sum(0.5 * run["settling_rows"] / run["steps"] for run in counts)
    assert abs(fine["poses"] - coarse["poses"]) <= 1
    assert abs(fine["settling_rows"] - coarse["settling_rows"]) <= 1 + rounded * coarse["settling_rows"]
    assert 0.0 < fine["watching"][0] < fine["protocol"][0]
