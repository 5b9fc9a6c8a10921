"""Arrow heads on paths: narrow, so that they point, and between the dots of steps."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.markers import MarkerStyle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from radmpc.arrays import Matrix
from radmpc.plotting.canvas.figure import points_per_unit
from radmpc.plotting.curves import point_along

__all__ = ["draw_arrows"]

_LENGTH = 8.5
"""Of a head [pt]."""

_HEAD = Path([(1.0, 0.0), (-1.0, 0.48), (-0.75, 0.0), (-1.0, -0.48), (1.0, 0.0)], closed=True)
"""Of length 2, to the right."""

_SHARES = ((), (0.5,), (0.3, 0.7))
"""Where none, one and two heads are, about, as shares of a path's length [-]."""

_ROOM = 2.5
"""Length of a path for each of its heads at least, in lengths of a head [-]."""


def draw_arrows(
    ax: Axes, path: Matrix, steps: Matrix, color: tuple[float, float, float], name: str
) -> None:
    """Draw two arrow heads on a path, each halfway between two steps; fewer where it is short.

    Parameters
    ----------
    ax : Axes
        With equal scales, its limits set.
    path : (p, 2) array
        The path [m].
    steps : (s, 2) array
        Where it is at the steps, the start included [m].
    color : (float, float, float)
        Of the vehicle.
    name : str
        Of the vehicle.
    """
    lengths = np.linalg.norm(np.diff(steps, axis=0), axis=1)
    ends = np.cumsum(lengths)
    room = float(ends[-1]) * points_per_unit(ax) / (_ROOM * _LENGTH)
    for share in _SHARES[min(int(room), 2)]:
        k = min(int(np.searchsorted(ends, share * ends[-1])), len(ends) - 1)
        found = point_along(path, (ends[k] - 0.5 * lengths[k]) / max(float(ends[-1]), 1e-12))
        if found is None:
            return
        point, direction = found
        ax.plot(
            *point[:, None], linestyle="none", color=color, marker=_head(*direction),
            markersize=_LENGTH, markeredgecolor="white", markeredgewidth=0.3, zorder=6.5,
            gid=f"arrow:{name}",
        )  # fmt: skip


def _head(x: float, y: float) -> MarkerStyle:
    """Return a head that points in a direction."""
    return MarkerStyle(_HEAD, transform=Affine2D().rotate(float(np.arctan2(y, x))))
