"""A settlement as an animation: both methods' mechanisms grow while the record of the reaction is drawn."""

import errno
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib import animation
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from comparison.figures.canvas import FAINT, YADE, Canvas, canvases, method_colour, tint, window
from comparison.figures.motion import Motion, motions
from comparison.figures.reaction import draw_levels
from comparison.figures.save import own_style
from comparison.figures.structure import TITLE_WIDTH, legend_below, looks, wrapped
from comparison.numbers import format_number
from comparison.run_folder import MOVING_FORMATS, require_ending, require_folder_of
from comparison.yade import Results
from la_core.errors import CannotStandError, SceneError
from la_core.exchange import FREE, write_whole
from la_core.limit import Status
from la_core.measures import mechanism
from la_core.model import Assembly

SECONDS = 4.0  # from rest to the end
HOLD = 2.0  # s, the last frame
DPI = 100
COLOURS = 128  # of a GIF: enough for flat areas and the greys of letters
NEARLY_WHITE = 244  # of 255
ROW_BELOW = 0.135  # of the height of the axes below, which are 1.6 inches high: one row of text and its gap to the line
SLOW = 2.0  # power of the time: the settlement starts slowly, because the reaction falls at its beginning


class Story:
    """The figure of an animation, and the parts of it that change from frame to frame."""

    @own_style()
    def __init__(self, results: Results) -> None:
        """Draw everything that does not change; raises SceneError where nothing moves."""
        scene, analysis, run = results.scene, results.analysis, results.run
        self.shown = motions(results)
        if not self.shown.end > self.shown.start:
            reasons = "; ".join(f"{method.label}: {method.reason}" for method in self.shown.methods if method.reason)
            kind = CannotStandError if analysis.bounds[analysis.main].status is Status.INFEASIBLE else SceneError
            raise kind(str(scene.path), f"nothing moves, so there is no animation ({reasons})", hint="look at its figures instead")
        self.assembly, self.run, self.scene = analysis.assembly, run, scene
        low, high = window(self.assembly)
        count = len(self.shown.methods)
        top = float(np.clip(8.0 / count * (high - low)[1] / (high - low)[0], 1.8, 5.0))
        self.figure = Figure(figsize=(9.0, top + 3.9), layout="constrained")
        FigureCanvasAgg(self.figure)
        upper, lower = self.figure.subfigures(2, 1, squeeze=False, height_ratios=(top + 1.0, 2.9))[:, 0]
        self.figure.suptitle(wrapped(scene.title), fontsize=11, parse_math=False)
        self.canvases = canvases(upper, self.assembly, count)
        for canvas, method in zip(self.canvases, self.shown.methods, strict=True):
            heading = f"{method.label}\n{method.reason}" if method.reason else method.label
            canvas.axes.set_title(heading[:TITLE_WIDTH], parse_math=False, fontsize=10)
            if np.isfinite(method.twists).all():
                canvas.block_outlines(_moves(self.assembly, method) | np.any(self.assembly.support_twist, axis=1), FAINT)
        self.still = [len(canvas.axes.collections) for canvas in self.canvases]
        axes = lower.subplots()
        self.scales, written = draw_levels(axes, results, ROW_BELOW)
        (self.line,) = axes.plot([], [], color=YADE, linewidth=1.6, zorder=4, label="YADE, recorded" if run else "_none")
        (self.tip,) = axes.plot([], [], color=YADE, marker="o", markeredgecolor="black", markersize=6, zorder=6)
        handles = {name: handle for handle, name in zip(*axes.get_legend_handles_labels(), strict=True) if name not in written}
        legend_below(lower, list(handles.values()), 3)
        self.reading = axes.set_title("settlement", fontsize=9, loc="left", parse_math=False)
        self.draw(1.0)
        self.figure.draw_without_rendering()
        self.figure.set_layout_engine("none")  # the layout stays the same in all frames

    def draw(self, share: float) -> None:
        """Draw the frame at a share of the time, 0 at rest and 1 at the end."""
        start, end = self.shown.start, self.shown.end
        settlement = start + share**SLOW * (end - start)
        for canvas, method, still in zip(self.canvases, self.shown.methods, self.still, strict=True):
            for artist in list(canvas.axes.collections)[still:]:
                artist.remove()
            self._draw_blocks(canvas, method, settlement)
        title = self._words(settlement)
        if self.run is not None:
            at, reaction = self.run.settling("settlement"), self.run.settling("reaction")
            drawn = np.arange(len(at)) < max(1, np.searchsorted(np.maximum.accumulate(at), settlement, side="right"))
            at, reaction = at[drawn | (share == 1.0)] / self.scales.settlement, reaction[drawn | (share == 1.0)] / self.scales.reaction
            self.line.set_data(at, reaction)
            self.tip.set_data(at[-1:], reaction[-1:])
            value_name = "R" if self.scene.live is None else "multiplier"
            values = (f"{format_number(value, 4)} {self.scales.reaction_unit}".rstrip() for value in reaction[-1:])
            title += "".join(f"; YADE's {value_name} = {value}" for value in values)
        self.reading.set_text(title)

    def _draw_blocks(self, canvas: Canvas, method: Motion, settlement: float) -> None:
        blocks = self.assembly.blocks
        moved = self.shown.magnification * method.at(settlement)
        vertices = blocks.vertices + mechanism.point_velocity(blocks, moved, blocks.vertices, blocks.vertex_block)
        canvas.solids(vertices, *looks(self.assembly, _moves(self.assembly, method), tint(method_colour(method.label))))

    def _words(self, settlement: float) -> str:
        """Return the settlement, m or rad, with its unit and the magnification, as text."""
        if self.scene.live is not None:
            return f"mechanism at {100.0 * settlement / self.shown.end:.0f} % of its drawn size"
        unit, divisor = (
            (self.scales.settlement_unit, self.scales.settlement) if self.run else ("mrad" if self.scene.is_rotation else "mm", 1e-3)
        )
        magnified = (
            f", displacements drawn {format_number(self.shown.magnification, 3)} times as large" if self.shown.magnification != 1.0 else ""
        )
        motion = "rotation" if self.scene.is_rotation else "settlement"
        return f"{motion} {settlement / divisor:.3f} {unit}{magnified}"


class GifWriter(animation.PillowWriter):
    """Writer of a GIF with one palette for all frames and no dithering, so that a frame stores only changed parts.

    The last frame stays for HOLD seconds.
    """

    _frames: list[Image.Image]

    def finish(self) -> None:
        """Write the file from the frames."""
        last = self._frames[-1].quantize(COLOURS, dither=Image.Dither.NONE)
        palette = np.array(last.getpalette()).reshape(-1, 3)
        palette[palette.min(axis=1) > NEARLY_WHITE] = 255  # the paper stays white
        last.putpalette(palette.ravel().tolist())
        frames = [frame.quantize(palette=last, dither=Image.Dither.NONE) for frame in self._frames]
        each = round(1000.0 / self.fps)
        durations = [each] * (len(frames) - 1) + [round(1000.0 * HOLD)]
        frames[0].save(self.outfile, save_all=True, append_images=frames[1:], duration=durations, loop=0)


def require_place(path: Path) -> None:
    """Raise an error for an animation that could not be written: SceneError for its name or folder, FileNotFoundError without ffmpeg."""
    require_ending(path, MOVING_FORMATS, "an animation")
    require_folder_of(path)
    if path.suffix == ".mp4" and shutil.which("ffmpeg") is None:
        raise FileNotFoundError(
            errno.ENOENT, "not installed, but MP4 needs it: apt-get install ffmpeg, or choose a name that ends in .gif", "ffmpeg"
        )


@own_style()
def write_animation(story: Story, path: Path, fps: int, progress: Callable[[int, int], None]) -> int:
    """Write a GIF, or an MP4 by ffmpeg, and return its number of frames.

    Raises errors as `require_place`, and OSError with the name of the file that cannot be written.

    Parameters
    ----------
    story : Story
        The figure to animate.
    path : Path
        File to write; its suffix, .gif or .mp4, is the format.
    fps : int
        Frames a second.
    progress : callable
        Called with the number of the drawn frame, from 1, and the number of frames.
    """
    require_place(path)
    count = round(SECONDS * fps) + 1
    shares = list(np.linspace(0.0, 1.0, count))
    if path.suffix == ".mp4":
        shares += [1.0] * round(HOLD * fps)
    writer = GifWriter(fps=fps) if path.suffix == ".gif" else animation.FFMpegWriter(fps=fps)
    with tempfile.TemporaryDirectory() as folder:
        unfinished = Path(folder) / f"animation{path.suffix}"
        try:
            with writer.saving(story.figure, str(unfinished), DPI):
                for drawn, share in enumerate(shares, 1):
                    story.draw(float(share))
                    writer.grab_frame()
                    progress(drawn, len(shares))
        except OSError as error:  # the error of a full disk does not name the file
            raise OSError(error.errno, error.strerror, error.filename or str(unfinished)) from error
        write_whole(path, unfinished.read_bytes())
    return len(shares)


def _moves(assembly: Assembly, method: Motion) -> np.ndarray:
    """Return the mask (B,) of the free blocks that move, or that fall where there is no mechanism."""
    if not np.isfinite(method.twists).all():
        return (assembly.blocks.role == FREE) & np.isin(assembly.blocks.names, method.falling)
    return mechanism.moving(assembly, method.twists)
