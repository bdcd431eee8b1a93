"""`crosscheck animate`: which results, and where the animation goes: into the run's folder, from where the report takes it."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console

from comparison import configuration, shipped
from comparison.ending import AGREE, TOOL
from comparison.files import ANIMATION, refuse_name
from comparison.narration import Narration
from comparison.plot_animation import Story, write_animation
from comparison.workflow import read_results, run_scene
from la_core.errors import SceneError
from la_core.scene import load_scene


def animation(options: argparse.Namespace, narrator: Console, out: Console, print_json: Callable[[Any], None]) -> int:
    """Animate finished results, or a scene's after running it, and print the file; the exit code is 3 where YADE was missing or failed.

    Raises SceneError where nothing moves, exchange.ExchangeError for broken results, FileNotFoundError without ffmpeg for an MP4.
    """
    code = AGREE
    with Narration(narrator) as narration:
        folder = finished(options.source)
        if folder is None:
            folder, code = _run(options.source, narration)
        scene, analysis, run = read_results(folder)
        path = options.output or folder / ANIMATION
        story = Story(scene, analysis, run)
        frames = write_animation(
            story, path, options.fps, lambda done, of: narration.fraction(scene.name, done / of, f"frame {done} of {of}")
        )
    if options.json:
        print_json({"scene": scene.name, "file": str(path), "frames": frames, "bytes": path.stat().st_size})
    else:
        out.print(str(path), markup=False)
    return code


def finished(source: str) -> Path | None:
    """Folder of a scene's results: the one given, or the only one in it; None where the source is no folder of results but a scene.

    Raises SceneError for a folder without results, or with those of several scenes.
    """
    folder = Path(source)
    if not folder.is_dir():
        return None
    runs = [folder] if (folder / "case.h5").is_file() else sorted(path.parent for path in folder.glob("*/case.h5"))
    if not runs and source in shipped.names():
        return None
    if not runs:
        raise SceneError(source, "holds no results of `crosscheck run`")
    if len(runs) > 1:
        names = ", ".join(run.name for run in runs)
        raise SceneError(source, "holds the results of several scenes", hint=f"name one of its folders: {names}")
    return runs[0]


def _run(source: str, narration: Narration) -> tuple[Path, int]:
    """Folder of a scene's results after running it, where `crosscheck run` puts them, and the exit code."""
    scene, settings = load_scene(shipped.find(source)), configuration.load().settings
    refuse_name(scene)
    folder = settings.output / scene.name
    summary = run_scene(scene, folder, narration, with_yade=True, time_limit=settings.time_limit)
    failed = summary["yade"] is not None and summary["yade"]["status"] in ("missing", "failed")
    return folder, TOOL if failed else AGREE
