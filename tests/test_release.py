"""A release: one version everywhere, a citation that readers of the format accept, and every file that the program needs."""

import re
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

from comparison.cli.arguments import parser

ROOT = Path(__file__).parent.parent
ROOMS = ("la_core", "yade_scripts", "comparison")
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CITATION = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
CHANGELOG = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
VERSION = PROJECT["project"]["version"]
SCRIPTS = "comparison/tutorials/"  # scripts that are read as text, in cells
REQUIRED_OF_A_CITATION = {"authors", "cff-version", "message", "title"}  # by the schema of the Citation File Format 1.2.0


def shipped_files() -> set[str]:
    """Every file of the packages that a user needs: all but the gallery and Python's compiled files."""
    files = (path.relative_to(ROOT) for room in ROOMS for path in (ROOT / room).rglob("*") if path.is_file())
    return {path.as_posix() for path in files if "gallery" not in path.parts and path.suffix != ".pyc"}


def test_version_changelog_and_citation_agree() -> None:
    releases = re.findall(r"^## \[(\d+\.\d+\.\d+)\] - (\d{4}-\d\d-\d\d)$", CHANGELOG, re.MULTILINE)
    cited = dict(re.findall(r"^(version|date-released): (\S+)$", CITATION, re.MULTILINE))
    assert releases[0] == (cited["version"], cited["date-released"])
    if VERSION.endswith(".dev0"):  # its stored results must not pass for results of the last release
        assert VERSION.removesuffix(".dev0") not in dict(releases)
        assert CHANGELOG.index("## [Unreleased]") < CHANGELOG.index(f"## [{cited['version']}]")
    else:
        assert cited["version"] == VERSION
    in_order = sorted(releases, key=lambda release: [int(part) for part in release[0].split(".")], reverse=True)
    assert releases == in_order and [date for _, date in releases] == sorted((date for _, date in releases), reverse=True)


def test_the_citation_has_what_its_format_requires_and_cites_the_paper() -> None:
    keys = set(re.findall(r"^([a-z-]+):", CITATION, re.MULTILINE))
    assert keys >= REQUIRED_OF_A_CITATION and "cff-version: 1.2.0" in CITATION
    assert "doi: 10.1016/j.engstruct.2016.02.002" in CITATION and "\t" not in CITATION


def test_the_changelog_tells_of_every_command() -> None:
    """The README lists all commands. The changelog must announce all but the plain ones of the first version."""
    plain = {"scenes", "show", "solve", "report"}
    (words,) = [action for action in parser()._actions if action.choices]
    assert all(f"`crosscheck {name}" in CHANGELOG for name in set(words.choices or ()) - plain)


def test_every_package_and_every_file_beside_its_code_is_declared() -> None:
    """A package that setuptools does not find, or a file without a pattern, would be missing only in an installed program."""
    settings = PROJECT["tool"]["setuptools"]
    assert {pattern.removesuffix("*") for pattern in settings["packages"]["find"]["include"]} == set(ROOMS)
    files = shipped_files()
    code = {name for name in files if name.endswith(".py") and not name.startswith(SCRIPTS)}
    folders = {Path(name).parent for name in code}
    assert all((ROOT / folder / "__init__.py").is_file() for folder in folders)
    data = settings["package-data"]
    declared = {
        path.relative_to(ROOT).as_posix()
        for folder in folders
        for pattern in [*data["*"], *data.get(folder.as_posix().replace("/", "."), [])]
        for path in (ROOT / folder).glob(pattern)
    }
    assert files - code <= declared


def lowest_versions() -> list[str]:
    """Every dependency of the program and of its extras, those of the tests included, in the lowest version that is declared."""
    project = PROJECT["project"]
    extras = (line for extra, lines in project["optional-dependencies"].items() if not extra.startswith("peers") for line in lines)
    bounds = [re.match(r"([\w-]+)>=([\d.]+)", line) for line in (*project["dependencies"], *extras)]
    return [f"{bound[1]}=={bound[2]}" for bound in bounds if bound]


@pytest.mark.long
@pytest.mark.skipif(sys.version_info[:2] != (3, 11), reason="the lowest versions have wheels for the lowest Python")
def test_the_lowest_declared_versions_carry_the_program(tmp_path: Path) -> None:
    """pip installs the newest versions, so that no other test tries a lower bound. A user may have older versions."""
    python = tmp_path / "lowest" / "bin" / "python"
    subprocess.run([sys.executable, "-m", "venv", tmp_path / "lowest"], check=True)
    subprocess.run([python, "-m", "pip", "install", "-q", "--only-binary", ":all:", *lowest_versions()], check=True)
    tests = [
        "inputs",
        "cli/test_security.py",
        "cli/test_texts_of_others.py",
        "cli/test_words.py",
        "cli/test_json.py",
        "comparison/test_export.py",
        "test_python_results.py",
    ]
    command = [python, "-m", "pytest", "-n", "1", "-m", "not slow and not long", *(ROOT / "tests" / name for name in tests)]
    ended = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stdout


@pytest.mark.long
def test_a_release_holds_the_program_alone_and_runs_where_it_is_installed(tmp_path: Path) -> None:
    """Built as `make release` does (which fetches setuptools), installed outside of the checkout, run through both methods."""
    build = [sys.executable, "-m", "build", "--outdir", str(tmp_path), str(ROOT)]
    built = subprocess.run(build, check=True, capture_output=True, text=True)
    assert "is absent from the `packages` configuration" not in built.stdout + built.stderr
    (wheel,), (source,) = tmp_path.glob("*.whl"), tmp_path.glob("*.tar.gz")
    assert all(VERSION in archive.name for archive in (wheel, source))
    with zipfile.ZipFile(wheel) as archive:
        assert {name for name in archive.namelist() if ".dist-info/" not in name} == shipped_files()
    with tarfile.open(source) as packed:
        names = {name.partition("/")[2] for name in packed.getnames()}
    assert names >= {*shipped_files(), "CHANGELOG.md", "CITATION.cff", "README.md", "pyproject.toml"}
    assert not any(name.startswith(("tests", "comparison/gallery")) for name in names)
    installed = tmp_path / "installed"
    subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", installed, wheel], check=True)
    command = [sys.executable, "-m", "comparison", "run", "two_pads", "-q", "-o", str(tmp_path / "results")]
    answer = subprocess.run(
        command, cwd=tmp_path, env={"PYTHONPATH": str(installed), "PATH": "/usr/bin:/bin"}, check=True, capture_output=True
    )
    assert b"agree" in answer.stdout and (tmp_path / "results" / "report.html").is_file()
