"""`crosscheck animate`: animate the results of a run. By default the file lies in the run's folder, where the report finds it."""

from pathlib import Path

from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, TOOL
from comparison.figures import Story, write_animation
from comparison.progress import Narration
from comparison.run_folder import ANIMATION, refuse_name
from comparison.settings import load_settings
from comparison.workflow import run_scene
from comparison.yade import locate_results, read_results
from la_core.scene import load_scene, shipped


def execute(context: Context) -> int:
    """Animate stored results, or run a scene and animate it; print the path of the file. Exit code 3 if YADE was missing or failed.

    Raises SceneError if no block moves, exchange.ExchangeError for damaged results, FileNotFoundError for an MP4 without ffmpeg.
    """
    options, code = context.options, AGREE
    with Narration(context.narrator) as narration:
        folder = locate_results(options.source)
        if folder is None:
            folder, code = _run(options.source, narration)
        results = read_results(folder)
        scene = results.scene
        path = options.output or folder / ANIMATION
        story = Story(results)
        frames = write_animation(
            story, path, options.fps, lambda done, of: narration.fraction(scene.name, done / of, f"frame {done} of {of}")
        )
    if options.json:
        context.print_json({"scene": scene.name, "file": str(path), "frames": frames, "bytes": path.stat().st_size})
    else:
        context.out.print(str(path), markup=False)
    return code


def _run(source: str, narration: Narration) -> tuple[Path, int]:
    """Run a scene as `crosscheck run` does; returns the folder of its results and the exit code."""
    scene, settings = load_scene(shipped.find(source)), load_settings().settings
    refuse_name(scene)
    folder = settings.output / scene.name
    summary = run_scene(scene, folder, narration, with_yade=True, time_limit=settings.time_limit)
    failed = summary["yade"] is not None and summary["yade"]["status"] in ("missing", "failed")
    return folder, TOOL if failed else AGREE
