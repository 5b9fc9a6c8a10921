"""Films as files."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from PIL import Image

from radmpc.arguments import check_path
from radmpc.errors import FileFormatError
from radmpc.model.plan import Plan
from radmpc.plotting.film.animation import FRAMES_PER_STEP, SECONDS_PER_STEP, Film, make_film
from radmpc.plotting.save import beside

__all__ = ["FILM_SUFFIXES", "check_film_path", "save_animation"]

FILM_SUFFIXES = (".gif", ".mp4")

_DPI = 160


def check_film_path(path: Path) -> None:
    """Refuse a film that cannot be written here.

    Parameters
    ----------
    path : Path
        Where the film is to go.

    Raises
    ------
    FileFormatError
        If the name ends in none of `FILM_SUFFIXES`, or MP4 is asked for without ``ffmpeg``.
    """
    suffix = path.suffix.lower()
    if suffix not in FILM_SUFFIXES:
        raise FileFormatError(f"{path}: a film must end in {', '.join(FILM_SUFFIXES)}")
    if suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise FileFormatError(
            f"{path}: MP4 needs the program ffmpeg on the PATH, which is not there; use .gif"
        )


def save_animation(
    plan: Plan, path: str | os.PathLike[str], *, frames_per_step: int = FRAMES_PER_STEP
) -> None:
    """Write a plan as a film, in the manner of `save_figure`; see `animate_plan`.

    Parameters
    ----------
    plan : Plan
        With trajectories.
    path : path
        Ends in ``.gif``, or in ``.mp4`` where the program ``ffmpeg`` is on the PATH.
    frames_per_step : int
        Frames from one step to the next, 1 to 50.

    Raises
    ------
    FileFormatError
        If the name ends otherwise, or ``ffmpeg`` is missing.
    """
    check_path(path)
    target = Path(path)
    check_film_path(target)
    film = make_film(plan, None, frames_per_step)
    film.figure.set_dpi(_DPI)
    milliseconds = round(1000.0 * SECONDS_PER_STEP / frames_per_step)
    with beside(target) as name:
        if target.suffix.lower() == ".gif":
            _write_gif(film, name, milliseconds)
        else:
            _write_mp4(film, name, milliseconds)


def _write_gif(film: Film, name: str, milliseconds: int) -> None:
    """Write a GIF that starts over after a second."""
    canvas = FigureCanvasAgg(film.figure)
    images = []
    for frame in range(film.num_frames):
        film.show(frame)
        canvas.draw()  # type: ignore[no-untyped-call]
        # matplotlib's own writer would draw every frame three times.
        pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call]
        images.append(Image.fromarray(pixels).convert("RGB"))
    # One palette for all: colors that change from frame to frame would flicker.
    palette = images[len(images) // 2].quantize(255)
    images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    for image in images:
        _whiten(image)
    durations = [milliseconds] * (len(images) - 1) + [1000]
    images[0].save(name, save_all=True, append_images=images[1:], duration=durations, loop=0)


def _whiten(image: Image.Image) -> None:
    """Make the paper white again: as an average of its palette it would show on a white page."""
    colors = np.array(image.getpalette(), dtype=np.uint8).reshape(-1, 3)
    colors[np.asarray(image)[0, 0]] = 255
    image.putpalette(colors.tobytes())


def _write_mp4(film: Film, name: str, milliseconds: int) -> None:
    """Write an MP4 through ``ffmpeg``."""
    writer = FFMpegWriter(fps=max(1, round(1000.0 / milliseconds)))
    with writer.saving(film.figure, name, dpi=_DPI):
        for frame in range(film.num_frames):
            film.show(frame)
            writer.grab_frame()
