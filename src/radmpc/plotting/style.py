"""Colors and sizes shared by all pictures, chosen for a column of 3.5 inches."""

from __future__ import annotations

from collections.abc import Sequence

from matplotlib.colors import to_rgb

__all__ = [
    "ALERT",
    "COLUMN_WIDTH",
    "LABEL_SIZE",
    "MAX_LABELS",
    "MUTED",
    "OBSTACLE_EDGE",
    "OBSTACLE_FILL",
    "PALETTE",
    "TICK_SIZE",
    "TITLE_SIZE",
    "vehicle_colors",
]

# Okabe and Ito, "Color universal design" (2008), less black, which means text here, and yellow,
# which is too pale for lines. Sky blue comes last: a tint of the first blue resembles it.
PALETTE = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")

ALERT = "#C00000"
MUTED = "#555555"
OBSTACLE_FILL = "#DADADA"
OBSTACLE_EDGE = "#8A8A8A"

COLUMN_WIDTH = 3.5  # [in]
TITLE_SIZE = 8.0  # [pt]
LABEL_SIZE = 6.5  # [pt]
TICK_SIZE = 6.0  # [pt]

MAX_LABELS = 24  # with more vehicles their names would cover the picture

_SHADES = (0.0, -0.38, 0.30, -0.2, 0.45)


def vehicle_colors(
    names: Sequence[str], sets: Sequence[Sequence[str]]
) -> dict[str, tuple[float, float, float]]:
    """Return a color per vehicle: one hue per set, one shade per vehicle in it.

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
    for i, group in enumerate(groups):
        for j, name in enumerate(group):
            colors[name] = _shade(PALETTE[i % len(PALETTE)], _SHADES[j % len(_SHADES)])
    return colors


def _shade(color: str, amount: float) -> tuple[float, float, float]:
    """Mix a color with white (amount > 0) or black (amount < 0)."""
    target = 1.0 if amount > 0.0 else 0.0
    red, green, blue = to_rgb(color)
    share = abs(amount)
    return (
        red + share * (target - red),
        green + share * (target - green),
        blue + share * (target - blue),
    )
