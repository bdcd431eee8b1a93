"""What decides a result decides its digest: a changed byte anywhere in the code that makes it, so that nothing stale is called cached."""

import shutil
from pathlib import Path

import pytest

from la_core.digests import code_digest

ROOT = Path(__file__).parent.parent
MODULES = [
    path.relative_to(ROOT) for package in ("la_core", "yade_scripts", "comparison") for path in sorted((ROOT / package).rglob("*.py"))
]


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
