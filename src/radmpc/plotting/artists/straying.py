"""Where an obstacle may be whose place is not known exactly."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from mpl_toolkits.mplot3d.art3d import Line3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from radmpc.arrays import Matrix
from radmpc.geometry import hull
from radmpc.model.obstacle import Obstacle
from radmpc.plotting.canvas.style import MUTED, numbered_steps
from radmpc.plotting.curves import ABOVE, Plane
from radmpc.plotting.interpolation import moving_outline

__all__ = [
    "SPREAD_DASHES",
    "draw_spread",
    "draw_spread_3d",
    "drawn_steps",
    "grown_outline",
    "rings_artist",
    "spread_rings",
]

SPREAD_DASHES = (0, (3, 2))
"""Line style of where an obstacle is but for 3σ."""

_SIGMAS = 3.0
"""Size of regions that places are drawn with, as vehicles' are [standard deviations]."""

_TURN = np.linspace(0.0, 2.0 * np.pi, 49)
_CIRCLE = np.array([np.cos(_TURN), np.sin(_TURN)])


def drawn_steps(obstacle: Obstacle) -> list[int]:
    """Return the steps at which a spread is drawn: those with numbers, and the last."""
    last = len(obstacle.steps) - 1
    return [*numbered_steps(last), last]


def grown_outline(obstacle: Obstacle, time: float, plane: Plane = ABOVE) -> Matrix:
    """Return the outline with the 3σ ellipse of its place around every corner, (c, 2) [m].

    Parameters
    ----------
    obstacle : Obstacle
        With a spread.
    time : float
        Time since the start [steps].
    plane : (int, int)
        The two coordinates that are seen.
    """
    corners = moving_outline(obstacle, time)[:, list(plane)]
    ring = (_SIGMAS * _root(obstacle, time, plane) @ _CIRCLE).T
    return hull((corners[:, None] + ring[None]).reshape(-1, 2)).vertices


def draw_spread(ax: Axes, obstacle: Obstacle, plane: Plane = ABOVE) -> None:
    """Draw dashed where a moving obstacle is within 3σ at some steps, if it strays at all.

    Parameters
    ----------
    ax : Axes
        Axes to draw on.
    obstacle : Obstacle
        The obstacle.
    plane : (int, int)
        The two coordinates that are drawn.
    """
    if obstacle.spread is None:
        return
    for step in drawn_steps(obstacle):
        ring = grown_outline(obstacle, float(step), plane)
        ax.plot(
            *np.vstack([ring, ring[:1]]).T, color=MUTED, linewidth=0.6, linestyle=SPREAD_DASHES,
            zorder=2.3, gid=f"spread:{obstacle.name}:{step}",
        )  # fmt: skip


def draw_spread_3d(ax: Axes3D, obstacle: Obstacle) -> None:
    """Draw the rings of the 3σ ellipsoid of a moving obstacle's middle at some steps.

    Parameters
    ----------
    ax : Axes3D
        Axes to draw on.
    obstacle : Obstacle
        The obstacle.
    """
    if obstacle.spread is None:
        return
    for step in drawn_steps(obstacle):
        gid = f"spread:{obstacle.name}:{step}"
        ax.add_collection3d(rings_artist(spread_rings(obstacle, float(step)), gid))


def spread_rings(obstacle: Obstacle, time: float) -> list[Matrix]:
    """Return the three principal rings of the 3σ ellipsoid of an obstacle's middle in space.

    Parameters
    ----------
    obstacle : Obstacle
        In space; without a spread all rings are points.
    time : float
        Time since the start [steps].
    """
    middle = moving_outline(obstacle, time).mean(axis=0)
    root = _root(obstacle, time, (0, 1, 2))
    return [
        middle + _SIGMAS * (root[:, list(axes)] @ _CIRCLE).T for axes in ((0, 1), (0, 2), (1, 2))
    ]


def rings_artist(rings: list[Matrix], gid: str) -> Line3DCollection:
    """Return rings in space, dashed.

    Parameters
    ----------
    rings : list of (p, 3) array
        Their points [m].
    gid : str
        Of the artist.
    """
    return Line3DCollection(
        rings, colors=MUTED, linewidths=0.5, linestyles=[SPREAD_DASHES], gid=gid
    )


def _root(obstacle: Obstacle, time: float, axes: tuple[int, ...]) -> Matrix:
    """Return a square root of the covariance of an obstacle's place, axes as columns [m]."""
    if obstacle.spread is None:
        return np.zeros((len(axes), len(axes)))
    before = min(int(time), len(obstacle.steps) - 2)
    share = np.array([time - before])
    covariance = obstacle.spread.between(np.array([before]), share)[0]
    values, vectors = np.linalg.eigh(covariance[np.ix_(axes, axes)])
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))
