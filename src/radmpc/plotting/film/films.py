"""Films as files."""

from __future__ import annotations

import os
from pathlib import Path

from matplotlib.animation import FFMpegWriter

from radmpc.arguments import check_path
from radmpc.errors import FileFormatError
from radmpc.model.plan import Plan
from radmpc.plotting.film.animation import FRAMES_PER_STEP, SECONDS_PER_STEP, Film, make_film
from radmpc.plotting.film.gif import FILM_DPI, write_gif
from radmpc.plotting.save import beside

__all__ = ["FILM_SUFFIXES", "check_film_path", "save_animation", "write_film"]

FILM_SUFFIXES = (".gif", ".mp4")


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

    Examples
    --------
    >>> import radmpc
    >>> from pathlib import Path
    >>> from tempfile import TemporaryDirectory
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> with TemporaryDirectory() as folder:
    ...     radmpc.save_animation(plan, Path(folder) / "a.gif", frames_per_step=1)
    ...     [path.name for path in Path(folder).iterdir()]
    ['a.gif']
    """
    check_path(path)
    target = Path(path)
    check_film_path(target)
    write_film(make_film(plan, None, frames_per_step), target, frames_per_step)


def write_film(film: Film, target: Path, frames_per_step: int) -> None:
    """Write a film; an interrupted write leaves an old file as it was.

    Parameters
    ----------
    film : Film
        What to write.
    target : Path
        The file; its ending chooses the format.
    frames_per_step : int
        Frames from one step to the next, of which each takes half a second.
    """
    film.figure.set_dpi(FILM_DPI)
    milliseconds = round(1000.0 * SECONDS_PER_STEP / frames_per_step)
    with beside(target) as name:
        if target.suffix.lower() == ".gif":
            write_gif(film, name, milliseconds)
        else:
            _write_mp4(film, name, milliseconds)


def _write_mp4(film: Film, name: str, milliseconds: int) -> None:
    """Write an MP4 through ``ffmpeg``."""
    writer = FFMpegWriter(fps=max(1, round(1000.0 / milliseconds)))
    with writer.saving(film.figure, name, dpi=FILM_DPI):
        for frame in range(film.num_frames):
            film.show(frame)
            writer.grab_frame()
