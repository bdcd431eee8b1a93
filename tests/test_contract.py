"""The contract since version 0.2.0 covers all that users type, write and read. It may grow, but no entry may vanish or change."""

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from contract_list import contract

from comparison.report import stored_report

TESTS = Path(__file__).parent
BEFORE = json.loads((TESTS / "helpers" / "contract.json").read_text(encoding="utf-8"))
JSON_PAGE = TESTS.parent / "comparison" / "json.md"
TOLD_IN_ONE_ROW = ("effects.table", "expected", "structure", "files", "limit_analysis.coulomb.curve")  # objects on the page of JSON keys


def missing(before: Any, now: Any, where: str) -> Iterator[str]:
    """Every entry of an earlier list that is missing now, and every value that has changed."""
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


def keys_on_the_page() -> Iterator[str]:
    """Dotted keys of the tables of the page. A heading in backticks names the object that its table describes."""
    path = ""
    for line in JSON_PAGE.read_text(encoding="utf-8").splitlines():
        if line.startswith("#"):
            path = "".join(f"{name}." for name in re.findall(r"^#+ `([\w.]+)`", line))
        elif key := re.match(r"\| `(\w+)` \|", line):
            yield path + key[1]


def row_of(key: str) -> str:
    """The row that describes a key. Multipliers share the row of reactions, and the measures of all mechanisms share one table."""
    whole = [one for one in TOLD_IN_ONE_ROW if key.startswith(f"{one}.") or key.startswith(f"{one}[")]
    key = re.sub(r"^(mechanism_measures)\.\w+", r"\1", (whole or [key.replace("[]", "")])[0])
    return re.sub(r"^(limit_analysis\.\w+)\.multiplier", r"\1.reaction", key)


def test_every_key_of_the_json_is_on_its_page_and_no_other(today: dict[str, Any]) -> None:
    rows = {row_of(key) for keys in (today["comparison.json"], *today["solve --json"].values()) for key in keys}
    values = {row for row in rows if not any(other.startswith(f"{row}.") for other in rows)}
    assert sorted(keys_on_the_page()) == sorted(row for row in values if not row.endswith("shared_inset"))  # it repeats the keys


def test_every_key_beside_the_scenes_of_a_report_is_on_the_page_of_json_keys() -> None:
    listed = re.findall(r"^- `(\w+)`:", JSON_PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert sorted(listed) == sorted(stored_report([], {}))
