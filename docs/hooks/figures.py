"""The pictures in docs/images, made anew by ``make pictures``: harbor, page, and examples.

They are kept small and committed: pages show them on a code host, too, and the site is built
without any planning. The gallery's page is written along with them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from PIL import Image, ImageSequence

from gallery import examples, page, picture
from making import ROOT
from screens import draw_screens

IMAGES = ROOT / "docs" / "images"

_WIDTHS = 900, 1150  # of a picture of one column, of two [px]
_ONE_COLUMN = 1500  # what is wider is two [px]
_COLORS = 144  # of its palette
_FILM_WIDTH, _FILM_COLORS, _EVERY = 420, 48, 2  # of a film, of which every second frame stays


@cache
def _harbor() -> Any:
    """Return the plan of the shipped scenario."""
    import radmpc  # noqa: PLC0415 - tests ask for names alone

    scenario = radmpc.load_scenario(ROOT / "src" / "radmpc" / "data" / "harbor.yaml")
    return radmpc.plan(scenario, rng=0).require()


def _draw_harbor(path: Path) -> None:
    """Draw the plan."""
    from radmpc.plotting import save_figure  # noqa: PLC0415 - as above

    save_figure(_harbor(), path)


def _draw_ledger(path: Path) -> None:
    """Draw where its risk goes."""
    from radmpc.plotting import save_ledger  # noqa: PLC0415 - as above

    save_ledger(_harbor(), path)


def _draw_view(view: str, path: Path) -> None:
    """Draw what the function of that name shows of the plan."""
    from radmpc import plotting  # noqa: PLC0415 - as above

    plotting.save_axes(getattr(plotting, f"plot_{view}")(_harbor()), path)


def _film_harbor(path: Path) -> None:
    """Film the plan."""
    from radmpc.plotting import save_animation  # noqa: PLC0415 - as above

    save_animation(_harbor(), path, frames_per_step=4)


@cache
def _flight() -> Any:
    """Return a flight of the plan, planned anew at every step."""
    import radmpc  # noqa: PLC0415 - as above

    return radmpc.begin_flight(_harbor(), radmpc.FlightSettings())


def _draw_flight(path: Path) -> None:
    """Draw the flight."""
    from radmpc.plotting import save_flight  # noqa: PLC0415 - as above

    save_flight(_flight(), path)


def _film_flight(path: Path) -> None:
    """Film the flight."""
    from radmpc.plotting import save_flight_film  # noqa: PLC0415 - as above

    save_flight_film(_flight(), path)


FIGURES: dict[str, Callable[[Path], None]] = {
    "harbor.png": _draw_harbor,
    "ledger.png": _draw_ledger,
    "couplings.png": partial(_draw_view, "couplings"),
    "distances.png": partial(_draw_view, "distances"),
    "risk.png": partial(_draw_view, "risk"),
    "flight.png": _draw_flight,
    "film.gif": _film_harbor,
    "flight.gif": _film_flight,
}


def write_small(source: Path, target: Path) -> None:
    """Write a picture or film with few pixels and colors."""
    with Image.open(source) as image:
        if source.suffix == ".gif":
            _write_film(image, target)
            return
        width = min(image.width, _WIDTHS[image.width > _ONE_COLUMN])
        size = width, round(image.height * width / image.width)
        small = image.convert("RGB").resize(size, Image.Resampling.LANCZOS)
    small.quantize(_COLORS, dither=Image.Dither.NONE).save(target, optimize=True)


def _write_film(image: Image.Image, target: Path) -> None:
    """Write every second frame, for twice as long."""
    size = _FILM_WIDTH, round(image.height * _FILM_WIDTH / image.width)
    frames, durations = [], []
    for number, frame in enumerate(ImageSequence.Iterator(image)):
        if number % _EVERY == 0:
            frames.append(frame.convert("RGB").resize(size, Image.Resampling.LANCZOS))
            durations.append(_EVERY * frame.info["duration"])
    # The colors that are farthest apart: means of many would give two vehicles one hue.
    palette = frames[len(frames) // 2].quantize(_FILM_COLORS, Image.Quantize.MAXCOVERAGE)
    frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    for frame in frames:
        # As an average of its palette the paper would show on a white page.
        colors = np.array(frame.getpalette(), dtype=np.uint8).reshape(-1, 3)
        colors[np.asarray(frame)[0, 0]] = 255
        frame.putpalette(colors.tobytes())
    frames[0].save(
        target, save_all=True, append_images=frames[1:], duration=durations, loop=0, optimize=True
    )


def main() -> None:
    """Write all pictures, and the gallery's page."""
    for folder in ("gallery", "page"):
        (IMAGES / folder).mkdir(exist_ok=True)
    with TemporaryDirectory() as folder:
        for name, draw in FIGURES.items():
            draw(Path(folder) / name)
            write_small(Path(folder) / name, IMAGES / name)
    draw_screens(IMAGES)
    for example in examples():
        made = picture(example)
        write_small(made, IMAGES / "gallery" / made.name)
    (ROOT / "docs" / "gallery.md").write_text(page(examples()), encoding="utf-8")


if __name__ == "__main__":
    main()
