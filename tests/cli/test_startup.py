"""A command loads only the modules that it uses, and computes nothing twice. Seconds are in comparison/gallery/startup.md."""

import gc
import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import scenes
from rich.console import Console

from comparison import __main__ as entry
from comparison import cli, progress
from comparison.progress import Narration
from comparison.yade import installation, process
from la_core.analysis import analyse
from la_core.geometry import Blocks, near_pairs, shapes
from la_core.model import Assembly
from la_core.scene import starter_text

ROOT = Path(__file__).parents[2]
EXTRAS = {"ezdxf", "trimesh", "pandas", "pyarrow", "distributed", "jsonschema", "hypothesis"}
DRAWS = {"matplotlib", "PIL", "jinja2", "vtk"}
OF_SCIPY = {"scipy.optimize", "scipy.spatial", "scipy.special", "scipy.interpolate", "scipy.integrate", "scipy.stats", "scipy.ndimage"}
OWN = {"comparison.report", "comparison.figures", "comparison.workflow", "comparison.studies", "comparison.campaign"}


def loaded_by(statement: str, folder: Path) -> set[str]:
    """Return the names of all modules that a process has loaded after a statement."""
    program = f"import sys\n{statement}\nprint('loaded', *sys.modules)"
    environment = {"PYTHONPATH": str(ROOT), "PATH": "/usr/bin:/bin"}
    ended = subprocess.run([sys.executable, "-c", program], cwd=folder, env=environment, capture_output=True, text=True, check=True)
    (line,) = [line for line in ended.stdout.splitlines() if line.startswith("loaded")]
    return set(line.split()[1:])


@pytest.mark.parametrize("package", ["la_core", "comparison"])
def test_a_package_loads_no_library_before_a_name_is_asked_for(package: str, tmp_path: Path) -> None:
    assert not loaded_by(f"import {package}", tmp_path) & {"numpy", "scipy", "pydantic", "h5py", "rich"}


def test_solving_a_small_scene_loads_only_what_it_uses(tmp_path: Path) -> None:
    loaded = loaded_by("from comparison.cli import main\nassert main(['solve', 'two_pads', '-q']) == 0", tmp_path)
    assert (tmp_path / "crosscheck-results" / "two_pads" / "case.h5").is_file()  # all of the command ran
    assert "scipy.sparse.linalg" in loaded
    assert not loaded & (EXTRAS | DRAWS | OF_SCIPY | OWN)


def test_the_search_for_mirrors_of_a_large_wall_loads_no_search_tree(tmp_path: Path) -> None:
    wall = "block = [0.6, 0.4, 0.3]\nper_course = 20\ncourses = 20\nfooting = { height = 0.3, settling = [9.0, 12.0] }"
    head = "stone.density = 2000.0\njoint.friction = 0.6\nsettlement.direction = [0.0, 0.0, -1.0]"
    (tmp_path / "wall.toml").write_text(f'{head}\n[[wall]]\nbond = "running"\norigin = [0.0, 0.0, 0.0]\n{wall}', encoding="utf-8")
    watched = "from la_core.model import mirrors\nfound, match = [], mirrors._matched\n"
    watched += "mirrors._matched = lambda *a: found.append(match(*a)) or found[-1]"
    solved = "from comparison.cli import main\nassert main(['solve', 'wall.toml', '--bounds', '-q']) == 0 and found[-1] is not None"
    assert not loaded_by(f"{watched}\n{solved}", tmp_path) & OF_SCIPY


def test_the_verb_run_loads_nothing_that_draws(tmp_path: Path) -> None:
    loaded = loaded_by("import comparison.cli.scene_verbs.run", tmp_path)
    assert "comparison.workflow.stages" in loaded
    assert not loaded & (EXTRAS | DRAWS)


@pytest.mark.slow
def test_what_draws_is_loaded_in_a_thread_without_extras_and_windows(tmp_path: Path) -> None:
    wait = "[thread.join() for thread in threading.enumerate() if thread is not threading.current_thread()]"
    loaded = loaded_by(f"import threading\nfrom comparison.workflow import stages\nstages._load_drawing()\n{wait}", tmp_path)
    assert {"comparison.report", "comparison.figures", "matplotlib.figure"} <= loaded
    assert not loaded & (EXTRAS | {"matplotlib.pyplot", "scipy.optimize", "scipy.stats"})


def test_yade_s_process_runs_when_its_start_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A made-up YADE waits until the caller has been told, and only then writes its result."""
    scripts = tmp_path / "scripts"
    scripts.mkdir()
    waits = "import pathlib, sys, time\nwhile not pathlib.Path('told').exists():\n    time.sleep(0.01)\npathlib.Path(sys.argv[2]).touch()\n"
    (scripts / "run_case.py").write_text(waits, encoding="utf-8")
    monkeypatch.setattr(process, "SCRIPTS", scripts)
    yade = installation.Installation(Path(sys.executable), tmp_path)
    process.run_yade(yade, tmp_path, "", 60.0, lambda report: None, (tmp_path / "told").touch)
    assert (tmp_path / "run.h5").exists()


def test_the_collector_rests_while_the_program_loads_and_works_afterwards(monkeypatch: pytest.MonkeyPatch) -> None:
    worked = []
    monkeypatch.setattr(cli, "main", lambda: worked.append(gc.isenabled()) or 0)
    frozen = gc.get_freeze_count()
    try:
        assert entry.main() == 0
        assert worked == [True] and gc.get_freeze_count() > frozen
    finally:
        gc.unfreeze()


def test_reports_of_a_path_compute_nothing_anew_and_make_no_words_that_nobody_hears(monkeypatch: pytest.MonkeyPatch) -> None:
    speeds, words, reports = [], [], []
    relative_velocity, value_words, path = Assembly.relative_velocity, progress.value_words, Narration.path
    monkeypatch.setattr(Assembly, "relative_velocity", lambda self, twists: speeds.append(1) or relative_velocity(self, twists))
    monkeypatch.setattr(progress, "value_words", lambda *values: words.append(1) or value_words(*values))
    monkeypatch.setattr(Narration, "path", lambda self, report: reports.append(1) or path(self, report))
    monkeypatch.setattr(progress, "LINE_EVERY", np.inf)
    with Narration(Console(file=io.StringIO())) as narration:
        analysis = analyse(scenes.load(starter_text("wall")), listener=narration)
    assert analysis.coulomb is not None and len(reports) > 100
    assert len(speeds) < len(reports) / 2 and not words


@pytest.mark.parametrize("sizes", [(9.0, 1.0, 4.0), (1.0, 9.0, 4.0), (4.0, 4.0, 4.0)])
def test_pairs_of_near_blocks_are_those_of_a_comparison_of_all_with_all(sizes: tuple[float, float, float]) -> None:
    draw = np.random.default_rng(21)
    low = draw.uniform(0.0, sizes, (150, 3))
    high = low + draw.uniform(0.05, 1.0, (150, 3)) * np.where(np.arange(150) < 3, 5.0, 0.6)[:, None]
    low[10:20, 2] = high[0:10, 2]  # some blocks meet exactly
    high[10:20, 2] = low[10:20, 2] + 0.5
    bodies = [shapes.box(a, b) for a, b in zip(low.tolist(), high.tolist(), strict=True)]
    blocks = Blocks.gather([f"b{k}" for k in range(150)], ["free"] * 150, [1.0] * 150, bodies)
    margin = draw.uniform(0.0, 0.05, 150)
    below, above = blocks.low - margin[:, None], blocks.high + margin[:, None]
    meet = np.all((below[:, None] <= above[None]) & (below[None] <= above[:, None]), axis=2)
    expected = np.argwhere(np.triu(meet, 1))
    assert len(expected) > 50 and np.array_equal(near_pairs(blocks, margin), expected)
