"""YADE of another version or build runs with a word of caution. It is refused only where it lacks a needed name."""

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from displaced_blocks import buffer
from faulty_runs import TOOL

from comparison.cli.commands import main
from comparison.errors import YadeMissingError
from comparison.yade import installation


@pytest.fixture
def altered_yade(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """The YADE of this machine under another version and without some of its names, as another release or build would be."""

    def alter(version: str, *lacking: str) -> None:
        modules = tmp_path / "modules"
        (modules / "yade").mkdir(parents=True)
        (modules / "yade" / "__init__.py").write_text(f"""
import sys
sys.path[:] = [{str(installation.find_yade().modules)!r}, *(path for path in sys.path if path != {str(modules)!r})]
del sys.modules["yade"]
import yade, yade.config
yade.config.version = {version!r}
for name in {lacking!r}:
    delattr(yade, name)
""")
        monkeypatch.setenv("CROSSCHECK_YADE", str(modules))

    return alter


POLYHEDRA = ("Bo1_Polyhedra_Aabb", "Ig2_Sphere_Polyhedra_ScGeom", "Polyhedra")


@pytest.mark.slow
@pytest.mark.parametrize("version", ["2022.01a", "20301231-9999~abcdef~trixie1"])
def test_a_yade_of_a_version_never_tried_is_run_with_a_word(
    version: str, altered_yade: Callable[..., None], capsys: pytest.CaptureFixture[str]
) -> None:
    altered_yade(version)
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert f"YADE: {version} is not among the tested versions (2023.02a, 2025.2.0)" in said and "two_pads" in said


@pytest.mark.slow
def test_a_yade_without_polyhedra_is_told_by_the_check(altered_yade: Callable[..., None]) -> None:
    altered_yade("2025.2.0", *POLYHEDRA)
    yade = installation.find_yade()
    assert sorted(yade.lacks) == sorted(POLYHEDRA) and "without polyhedra" in yade.caution


@pytest.mark.slow
def test_a_name_that_a_room_of_the_scripts_needs_is_checked_too(altered_yade: Callable[..., None]) -> None:
    altered_yade("2025.2.0", "HelixEngine")
    with pytest.raises(YadeMissingError, match="lacks names that crosscheck uses: HelixEngine;"):
        installation.find_yade()


@pytest.mark.slow
def test_a_yade_without_polyhedra_takes_what_needs_none_and_says_what_it_cannot_take(
    altered_yade: Callable[..., None], tmp_path: Path, plain_figures: None, two_pads: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Debian 13 builds such a YADE. A block that is no box along the axes is refused once a sphere comes near a new face."""
    altered_yade("2025.2.0", *POLYHEDRA)
    out, box = tmp_path / "out", "box     = { from = [0.0, 0.0, 0.0], to = [1.0, 0.2, 0.5] }"
    assert box in two_pads
    trapezium = two_pads.replace(box, "prism = { profile = [[0.0, 0.0], [1.0, 0.0], [0.8, 0.5], [0.2, 0.5]], y = [0.0, 0.2] }")
    for displacement in ("small", "finite"):
        path = tmp_path / f"{displacement}.toml"
        path.write_text(f'{trapezium.split("[expected]")[0]}\n[effects]\ndisplacement = "{displacement}"\n')
    capsys.readouterr()
    assert main(["run", "two_pads", str(tmp_path / "small.toml"), str(tmp_path / "finite.toml"), "-o", str(out)]) == 0
    assert capsys.readouterr().err.count("running YADE 2025.2.0 (built without polyhedra, see `crosscheck doctor`)") == 3
    stop, slanted = buffer(), "prism = { profile = [[0.4002, 0.0], [0.8, 0.0], [0.7, 0.4], [0.4002, 0.4]], y = [-0.1, 0.3] }"
    upright = "box = { from = [0.4002, -0.1, 0.0], to = [0.8, 0.3, 0.4] }"
    assert upright in stop
    (tmp_path / "met.toml").write_text(stop.replace(upright, slanted))
    assert main(["run", str(tmp_path / "met.toml"), "-o", str(out)]) == TOOL
    said = capsys.readouterr().err
    assert "is not a box along the axes" in said and 'displacement = "small"' in said and said.count("YADE: failed") == 1
    assert "Debian 12" in said and "Traceback" not in said


@pytest.mark.slow
def test_yade_leaves_no_scratch_folder_behind() -> None:
    """YADE makes a folder in the system's temporary folder when it loads. A process that ends at once would never remove it."""
    yade = installation.find_yade()
    statement = f"""
import sys
from pathlib import Path
sys.path[:0] = [{str(installation.ROOT)!r}, {str(yade.modules)!r}]
from yade import Omega
from yade_scripts import run_case
folder = Path(Omega().tmpFilename()).parent
assert folder.is_dir() and folder.name.startswith("yade-")
run_case._remove_scratch_folder()
run_case._remove_scratch_folder()
print("left" if folder.exists() else "removed")
"""
    ended = subprocess.run(
        [yade.python, "-s", "-c", statement], env=installation.yade_environment(), capture_output=True, text=True, check=False
    )
    assert ended.stdout.splitlines()[-1:] == ["removed"], ended.stderr


def test_the_console_of_yade_is_loaded_only_where_more_than_its_version_is_asked() -> None:
    yade = installation.find_yade()
    statement = f"""
import sys
sys.path[:0] = [{str(installation.ROOT / "yade_scripts")!r}]
import run_case
run_case.defer_console()
import IPython
assert IPython.__version__[0].isdigit() and "IPython.core" not in sys.modules
assert callable(IPython.start_ipython) and "IPython.core" in sys.modules
assert sys.modules["IPython"] is not IPython and IPython.__path__
print("loaded")
"""
    ended = subprocess.run(
        [yade.python, "-s", "-c", statement], env=installation.yade_environment(), capture_output=True, text=True, check=False
    )
    assert ended.stdout.splitlines()[-1:] == ["loaded"], ended.stderr
