"""Colors and sizes shared by all pictures, chosen for a column of 3.5 inches."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.colors import to_rgb

Dashes = str | tuple[int, tuple[float, ...]]

__all__ = [
    "ALERT",
    "COLUMN_WIDTH",
    "HUES",
    "LABEL_SIZE",
    "MAX_LABELS",
    "MAX_PANEL_LABELS",
    "MUTED",
    "NUMBER_SIZE",
    "OBSTACLE_EDGE",
    "OBSTACLE_FILL",
    "PALETTE",
    "POST_SIZE",
    "STAR_SIZE",
    "TICK_SIZE",
    "TITLE_SIZE",
    "WALL_WIDTH",
    "Dashes",
    "numbered_steps",
    "vehicle_colors",
    "vehicle_dashes",
]

# Okabe and Ito, "Color universal design" (2008), less black, which means text here, and yellow,
# which is too pale for lines. Sky blue comes last: a tint of the first blue resembles it.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")

# Without sky blue, whose hue is that of the first blue.
HUES = (*PALETTE[:5], "#7B3FB0", "#73A800", "#D0129C")
"""Of the sets of a fleet: violet, lime and magenta where there are more than five."""

ALERT = "#C00000"
MUTED = "#555555"
OBSTACLE_FILL = "#DADADA"
OBSTACLE_EDGE = "#8A8A8A"

COLUMN_WIDTH = 3.5
"""Width of a figure in one column [in]."""

TITLE_SIZE = 8.0
"""Font size of headlines [pt]."""

LABEL_SIZE = 6.5
"""Font size of axes' labels, names and facts [pt]."""

TICK_SIZE = 6.0
"""Font size of ticks and legends [pt]."""

WALL_WIDTH = 1.4
"""Line width of obstacles without thickness [pt]."""

POST_SIZE = 3.0
"""Marker size of obstacles that are a point [pt]."""

NUMBER_SIZE = 4.8
"""Font size of step numbers [pt]."""

STAR_SIZE = 5.5
"""Marker size of goals [pt]."""

MAX_LABELS = 24
"""Vehicles, or obstacles, up to which names are written: more would cover the picture."""

MAX_PANEL_LABELS = 8
"""The same in the small panels from above and from the side of a picture in space."""

# What is mixed into a color, and its share: far apart in lightness, so that they differ in gray
# print, too. The fourth is grayish: by lightness alone it would resemble the first.
_SHADES = ((0.0, 0.0), (0.0, 0.55), (1.0, 0.42), (0.4, 0.6), (1.0, 0.2))
_DASHES: tuple[Dashes, ...] = ("solid", (0, (5, 1.2)), (0, (6, 1.2, 1.2, 1.2)), (0, (2, 1)))


def vehicle_colors(
    names: Sequence[str], sets: Sequence[Sequence[str]]
) -> dict[str, tuple[float, float, float]]:
    """Return a color per vehicle: one hue per set, one shade per vehicle in it.

    Where there are more sets than hues, vehicles planned alone share what sets of several leave,
    in other shades, and sets of several share hues last.

    Parameters
    ----------
    names : sequence of str
        All vehicles; those in no set count as sets of their own.
    sets : sequence of sequence of str
        Which vehicles were planned together.

    Returns
    -------
    dict
        Red, green and blue per name.
    """
    listed = {name for group in sets for name in group}
    groups = [*sets, *([name] for name in names if name not in listed)]
    colors = {}
    for group, (hue, turn) in zip(groups, _hues([len(group) > 1 for group in groups]), strict=True):
        for j, name in enumerate(group):
            colors[name] = _shade(hue, *_SHADES[(turn + j) % len(_SHADES)])
    return colors


def _hues(are_several: Sequence[bool]) -> list[tuple[str, int]]:
    """Return each set's hue, and how often hues were repeated before it is given."""
    count, several = len(are_several), sum(are_several)
    if count <= len(HUES) or several >= len(HUES):
        return [(HUES[i % len(HUES)], i // len(HUES)) for i in range(count)]
    own, shared, found = iter(HUES), HUES[several:], []
    for i, is_several in enumerate(are_several):
        k = i - sum(are_several[:i])
        found.append((next(own), 0) if is_several else (shared[k % len(shared)], k // len(shared)))
    return found


def vehicle_dashes(names: Sequence[str], sets: Sequence[Sequence[str]]) -> dict[str, Dashes]:
    """Return a line style per vehicle: they repeat from set to set, solid for the first of each.

    Parameters
    ----------
    names : sequence of str
        All vehicles; those in no set are solid.
    sets : sequence of sequence of str
        Which vehicles were planned together.

    Returns
    -------
    dict
        What matplotlib takes as ``linestyle``, per name.
    """
    dashes: dict[str, Dashes] = dict.fromkeys(names, "solid")
    for group in sets:
        dashes |= {name: _DASHES[j % len(_DASHES)] for j, name in enumerate(group)}
    return dashes


def numbered_steps(horizon: int) -> range:
    """Return the steps whose numbers are written: about three between start and end."""
    stride = max(1, round(horizon / 4))
    return range(stride, horizon, stride)


def _shade(color: str, target: float, share: float) -> tuple[float, float, float]:
    """Mix a color with a gray, of which 0 is black and 1 is white."""
    red, green, blue = to_rgb(color)
    return (
        red + share * (target - red),
        green + share * (target - green),
        blue + share * (target - blue),
    )
