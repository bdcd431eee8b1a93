"""The digest of a result changes with every byte of the code that makes the result, so that no stale result counts as cached."""

import shutil
from pathlib import Path

import pytest

from comparison.workflow.stages import COMPARISON_CODE, stage_digest
from la_core.digests import code_digest

ROOT = Path(__file__).parent.parent
MODULES = [
    path.relative_to(ROOT) for package in ("la_core", "yade_scripts", "comparison") for path in sorted((ROOT / package).rglob("*.py"))
]
ROOMS = [path.relative_to(ROOT) for path in COMPARISON_CODE]
JUDGED = [module for module in MODULES if any(module.is_relative_to(place) for place in ROOMS)]
COMMAND_LINE = [module for module in MODULES if module.is_relative_to("comparison/cli")]


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("code")
    for module in MODULES:
        (folder / module).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / module, folder / module)
    return folder


@pytest.mark.parametrize("module", MODULES, ids=str)
def test_a_byte_changed_in_any_module_of_a_package_changes_its_digest(module: Path, copied: Path) -> None:
    package, path = copied / module.parts[0], copied / module
    before, content = code_digest(package), path.read_bytes()
    path.write_bytes(content + b"#")
    try:
        assert code_digest(package) != before
    finally:
        path.write_bytes(content)
    assert code_digest(package) == before


def comparison_digests(module: Path, copied: Path) -> set[str]:
    """Digests of comparison's stage in the copied code: before a module gets an additional byte, with the byte, and after its removal."""
    code, path = tuple(copied / place for place in ROOMS), copied / module
    content, digests = path.read_bytes(), []
    for changed in (content, content + b"#", content):
        path.write_bytes(changed)
        digests.append(stage_digest("inputs", code))
    assert digests[0] == digests[2]
    return set(digests)


@pytest.mark.parametrize("module", JUDGED, ids=str)
def test_a_byte_changed_in_a_room_that_makes_the_comparison_changes_its_stage(module: Path, copied: Path) -> None:
    assert len(comparison_digests(module, copied)) == 2


@pytest.mark.parametrize("module", COMMAND_LINE, ids=str)
def test_a_byte_changed_in_the_command_line_leaves_the_comparison_as_it_is(module: Path, copied: Path) -> None:
    assert len(comparison_digests(module, copied)) == 1


def test_every_place_that_makes_the_comparison_holds_modules() -> None:
    assert COMMAND_LINE and all(any(module.is_relative_to(place) for module in JUDGED) for place in ROOMS)


def test_a_module_that_moves_or_gives_bytes_to_another_changes_the_digest(tmp_path: Path) -> None:
    (tmp_path / "room").mkdir()
    first, second = tmp_path / "a.py", tmp_path / "room" / "b.py"
    first.write_text("1\n2\n")
    second.write_text("3\n")
    before = code_digest(tmp_path)
    first.write_text("1\n")
    second.write_text("2\n3\n")
    assert code_digest(tmp_path) != before
    first.write_text("1\n2\n")
    second.write_text("3\n")
    assert code_digest(tmp_path) == before
    second.rename(tmp_path / "b.py")
    assert code_digest(tmp_path) != before
    assert code_digest(tmp_path / "room") != before
