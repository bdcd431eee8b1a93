"""`crosscheck animate`: animate the results of a run. By default the file lies in the run's folder, where the report finds it."""

from pathlib import Path
from typing import Any

from comparison.cli.conclude import code_of_comparison
from comparison.cli.context import Context
from comparison.cli.exit_codes import AGREE, SEVERITY, TOOL, USAGE, complain_of
from comparison.figures import Story, require_place, write_animation
from comparison.progress import Narration
from comparison.run_folder import ANIMATION, refuse_name
from comparison.settings import load_settings
from comparison.workflow import run_scene
from comparison.yade import locate_results, read_results
from la_core.errors import SceneError
from la_core.scene import load_scene, shipped


def execute(context: Context) -> int:
    """Animate stored results, or run a scene and animate it; print the path of the file. Exit code 3 if YADE was missing or failed, 2
    if it refused a setting of the scene.

    A scene that cannot move leaves the other scenes their animations; the exit code is that of the most severe error. Raises
    exchange.ExchangeError for damaged results, FileNotFoundError for an MP4 without ffmpeg.
    """
    options, code, made = context.options, AGREE, []
    if options.output is not None:  # an error in the file's name, its folder or ffmpeg is reported before the scene is run
        require_place(options.output)
    with Narration(context.narrator) as narration:
        folders = locate_results(options.source)
        if not folders:
            folder, code = _run(context, narration)
            folders = [folder]
        elif options.no_yade:
            context.warn_of("--no-yade", "without effect: the animation shows the stored results as they are")
        if options.output is not None and len(folders) > 1:
            names = ", ".join(folder.name for folder in folders)
            raise SceneError("-o", "one file cannot hold several animations", hint=f"leave it out, or name one of the folders: {names}")
        for folder in folders:
            try:
                made.append(_animated(folder, options.output or folder / ANIMATION, options.fps, narration))
            except SceneError as error:  # the scene cannot move, but another one may
                code = max(code, complain_of(error), key=SEVERITY.index)
    if not made:
        return code
    if options.json:
        context.print_json(made[0] if len(folders) == 1 else {"animations": made})
    else:
        context.out.print("\n".join(str(one["file"]) for one in made), markup=False)
    return code


def _animated(folder: Path, path: Path, fps: int, narration: Narration) -> dict[str, Any]:
    """Animate the stored results of one scene, and return the file with its numbers of frames and bytes."""
    results = read_results(folder)
    scene = results.scene
    frames = write_animation(Story(results), path, fps, lambda done, of: narration.fraction(scene.name, done / of, f"frame {done} of {of}"))
    return {"scene": scene.name, "file": str(path), "frames": frames, "bytes": path.stat().st_size}


def _run(context: Context, narration: Narration) -> tuple[Path, int]:
    """Run a scene as `crosscheck run` does; returns the folder of its results and the exit code."""
    options = context.options
    scene, settings = load_scene(shipped.find(options.source)), load_settings().settings
    refuse_name(scene)
    folder = settings.output / scene.name
    summary = run_scene(scene, folder, narration, with_yade=not options.no_yade, time_limit=options.time_limit)
    code = code_of_comparison(summary)
    return folder, code if code in (TOOL, USAGE) else AGREE
