"""What users may type, write and read since version 0.2.0 is still there: the contract may grow, nothing in it may go or change."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from contract_list import contract

BEFORE = json.loads((Path(__file__).parent / "helpers" / "contract.json").read_text(encoding="utf-8"))


def missing(before: Any, now: Any, where: str) -> Iterator[str]:
    """Every entry of a list made before that is not there now, and every value that is another one."""
    if isinstance(before, dict) and isinstance(now, dict):
        for name, value in before.items():
            yield from missing(value, now[name], f"{where}: {name}") if name in now else [f"{where}: {name}"]
    elif isinstance(before, list) and isinstance(now, list):
        yield from (f"{where}: {entry}" for entry in before if entry not in now)
    elif before != now:
        yield f"{where}: {before} is now {now}"


@pytest.fixture(scope="module")
def today() -> dict[str, Any]:
    return contract()


@pytest.mark.parametrize("part", BEFORE)
def test_nothing_of_the_contract_is_gone(part: str, today: dict[str, Any]) -> None:
    assert not list(missing(BEFORE[part], today[part], part))


def test_the_comparison_of_contracts_sees_what_is_gone_and_what_changed() -> None:
    before = {"verbs": {"run": ["--json"]}, "exit codes": {"agree": 0}, "case.h5": {"scene/name": "str, "}}
    assert not list(missing(before, {**before, "verbs": {"run": ["--json", "--new"], "new": []}}, "all"))
    assert list(missing(before, {**before, "verbs": {"run": []}}, "all")) == ["all: verbs: run: --json"]
    assert list(missing(before, {**before, "verbs": {}}, "all")) == ["all: verbs: run"]
    assert list(missing(before["exit codes"], {"agree": 1}, "exit codes")) == ["exit codes: agree: 0 is now 1"]
    assert list(missing(before["case.h5"], {"scene/name": "f8, "}, "case.h5"))
