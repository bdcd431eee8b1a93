"""Hard cases: known answers come out, unknown ones are named, and no wrong answer counts as agreement."""

from pathlib import Path

import pytest
from conftest import Silent
from hard_cases import FALLS, QUICK, REFUSED, HardCase, catalogue
from hard_cases_table import Outcome, outcome, row

CASES = list(catalogue())
IN_EVERY_RUN = ("pads, friction 0", "columns, friction 0.9", "lintel that overhangs", "support that slides away")  # seconds of YADE each
ONCE_ENDLESS = (  # before inertia was added to the fastest blocks and slow swings were taken into account
    "cube of 0.01 m on a block of 1 m", "cube of 0.001 m on a block of 1 m", "slab 100000 times as heavy above",
    "slab 100000 times as heavy below", "block 20 times as high", "block 200 times as high",
)  # fmt: skip
LARGE = "tower of 1,000 blocks"  # it takes as long as all others together; a tower of 100 is in every run
RESIDUAL = 1e-6  # of the mean block weight: largest residual of a solved answer


def of(cases: list[HardCase], in_every_run: tuple[str, ...]) -> pytest.MarkDecorator:
    """Parametrise a test by named cases. Cases that are not in every run are left to `make test-all`."""
    left = {case.name: pytest.mark.long if case.long else () if case.name in in_every_run else pytest.mark.slow for case in cases}
    marked = [pytest.param(case, marks=left[case.name], id=case.name) for case in cases]
    return pytest.mark.parametrize("case", marked)


def taken(case: HardCase, folder: Path, with_yade: bool) -> Outcome:
    return outcome(case, folder, Silent(), with_yade)  # type: ignore[arg-type]


@pytest.mark.parametrize("case", [pytest.param(case, marks=pytest.mark.slow if case.name == LARGE else (), id=case.name) for case in CASES])
def test_limit_analysis_says_what_is_known(case: HardCase, tmp_path: Path) -> None:
    found = taken(case, tmp_path, with_yade=False)
    assert found.is_right, row(found)
    if found.summary is None:
        assert case.known == REFUSED and found.refusal
        return
    assert found.others and all(other.agree for other in found.others), found.others
    answer = found.summary["limit_analysis"]["associated"]
    assert answer["status"] == ("infeasible" if case.known == FALLS else answer["status"])
    if answer["status"] == "solved":
        assert max(answer[name] for name in ("equilibrium_residual", "cone_violation", "duality_gap")) <= RESIDUAL


@pytest.mark.slow_after_first
@pytest.mark.yade
@of([case for case in CASES if case.yade and case.known != REFUSED], in_every_run=IN_EVERY_RUN)
def test_no_wrong_answer_is_called_agreement(case: HardCase, tmp_path: Path) -> None:
    found = taken(case, tmp_path, with_yade=True)
    assert found.summary is not None and found.summary["yade"] is not None
    yade, verdict = found.summary["yade"], found.summary["verdict"]
    assert verdict != "disagree", found.summary["reason"]
    if verdict in ("agree", "cannot stand") and case.known == FALLS:
        assert yade["status"] == "collapsed"
    elif verdict == "agree" and isinstance(case.known, float):
        off = abs(yade["reaction"] / found.summary["weight"] - case.known)
        assert off <= 0.015 * max(case.known, 0.01) + 2e-3  # the inset's share of the lever arms, and the judge's tolerance
    else:
        assert verdict == "agree" or found.summary["reason"]


@pytest.mark.yade
@pytest.mark.parametrize("name", [ONCE_ENDLESS[0], *(pytest.param(name, marks=pytest.mark.slow) for name in ONCE_ENDLESS[1:])])
def test_mixed_sizes_and_slender_blocks_come_to_their_plateau(name: str, tmp_path: Path) -> None:
    (case,) = [case for case in CASES if case.name == name]
    found = taken(case, tmp_path, with_yade=True)
    assert found.summary is not None
    yade, prediction = found.summary["yade"], found.summary["limit_analysis"]["coulomb"]
    assert yade["status"] == "plateau"
    assert abs(yade["reaction"] - prediction["reaction"]) <= yade["uncertainty"] + 1e-4 * found.summary["weight"]
    assert found.summary["verdict"] == "agree", found.summary["reason"]


def test_every_quick_case_is_a_case() -> None:
    names = [case.name for case in CASES]
    assert len(names) == len(set(names)) and {*QUICK, *ONCE_ENDLESS} <= set(names)
