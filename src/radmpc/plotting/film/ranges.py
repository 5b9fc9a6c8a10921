"""Lines between vehicles that keep a range, as they move."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from mpl_toolkits.mplot3d import Axes3D

from radmpc.arrays import Matrix
from radmpc.plotting.artists.relations import RANGE_DASHES
from radmpc.plotting.canvas.style import MUTED

__all__ = ["RangeLine"]


class RangeLine:
    """A line between the means of two.

    Parameters
    ----------
    ax : Axes
        Where, flat or in space.
    name : str
        Both names.
    one, two : (f, d) array
        Where they are at each frame [m].
    """

    def __init__(self, ax: Axes, name: str, one: Matrix, two: Matrix) -> None:
        self.ends = np.stack([one, two], axis=1)
        nowhere: list[Any] = [[]] * self.ends.shape[2]
        (self.line,) = ax.plot(
            *nowhere, color=MUTED, linewidth=0.8, linestyle=RANGE_DASHES, zorder=4.5,
            gid=f"range:{name}",
        )  # fmt: skip
        self.is_flat = not isinstance(ax, Axes3D)

    def show(self, frame: int, time: float) -> None:
        """Show it at a frame.

        Parameters
        ----------
        frame : int
            Which one.
        time : float
            Not needed [s].
        """
        del time
        places = self.ends[frame].T
        line: Any = self.line
        line.set_data(*places) if self.is_flat else line.set_data_3d(*places)
