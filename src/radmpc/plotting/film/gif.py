"""Films as GIF."""

from __future__ import annotations

from typing import IO, Protocol

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

__all__ = ["FILM_DPI", "write_gif"]

FILM_DPI = 160
"""Resolution of films [1/in]."""


class Frames(Protocol):
    """A figure that shows one frame after the other."""

    @property
    def figure(self) -> Figure:
        """What the frames are drawn in."""
        ...

    @property
    def num_frames(self) -> int:
        """How many there are."""
        ...

    def show(self, frame: int) -> object:
        """Draw one of them."""
        ...


def write_gif(film: Frames, target: str | IO[bytes], milliseconds: int) -> None:
    """Write a GIF that starts over after a second; the figure keeps its last frame.

    Parameters
    ----------
    film : Frames
        What to write.
    target : str or binary file
        File to write.
    milliseconds : int
        From frame to frame.
    """
    film.figure.set_dpi(FILM_DPI)
    canvas = FigureCanvasAgg(film.figure)
    images = []
    for frame in range(film.num_frames):
        film.show(frame)
        canvas.draw()  # type: ignore[no-untyped-call] # of matplotlib
        # matplotlib's own writer would draw every frame three times.
        pixels = np.asarray(canvas.buffer_rgba())  # type: ignore[no-untyped-call] # of matplotlib
        images.append(Image.fromarray(pixels).convert("RGB"))
    # One palette for all: colors that change from frame to frame would flicker.
    palette = images[len(images) // 2].quantize(255)
    images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    for image in images:
        _whiten(image)
    durations = [milliseconds] * (len(images) - 1) + [1000]
    images[0].save(
        target, format="GIF", save_all=True, append_images=images[1:], duration=durations, loop=0
    )


def _whiten(image: Image.Image) -> None:
    """Make the paper white again: as an average of its palette it would show on a white page."""
    colors = np.array(image.getpalette(), dtype=np.uint8).reshape(-1, 3)
    colors[np.asarray(image)[0, 0]] = 255
    image.putpalette(colors.tobytes())
