"""Where a plan that breaks its bound risks the most."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from mpl_toolkits.mplot3d import Axes3D

from radmpc.model.plan import LedgerRow, Plan
from radmpc.plotting.canvas.style import ALERT
from radmpc.plotting.curves import ABOVE, Plane, positions

__all__ = ["draw_worst", "worst_rows"]

_MOST_ROWS = 8
"""Rows of the ledger that are ringed, largest first."""

_LEAST_SHARE = 0.01
"""Share of the risk bound [-] below which a row is not ringed."""


def worst_rows(plan: Plan) -> tuple[LedgerRow, ...]:
    """Return the rows worth a mark, the largest first.

    Parameters
    ----------
    plan : Plan
        With its ledger.

    Returns
    -------
    tuple of LedgerRow
        At most eight, each above 1 % of the bound; none where the certificate keeps the bound.
    """
    risk = plan.risk
    if not plan.trajectories or risk.certified is None or risk.certified <= risk.bound:
        return ()
    large = [row for row in risk.ledger if row.risk > _LEAST_SHARE * risk.bound]
    return tuple(sorted(large, key=lambda row: row.risk, reverse=True)[:_MOST_ROWS])


def draw_worst(ax: Axes, plan: Plan, plane: Plane = ABOVE) -> None:
    """Draw a red ring around the means at the worst rows' steps, a line between a pair's two.

    Parameters
    ----------
    ax : Axes
        Where, flat or in space.
    plan : Plan
        Whose ledger counts.
    plane : (int, int)
        The two coordinates that are drawn in flat axes.
    """
    places = {
        trajectory.name: positions(vehicle, trajectory)
        for vehicle, trajectory in zip(plan.scenario.vehicles, plan.trajectories, strict=False)
    }
    for row in worst_rows(plan):
        names = [row.vehicle]
        if row.cause == "pair" and row.other is not None:
            names.append(row.other)
        points = np.array([places[name][row.step] for name in names])
        if not isinstance(ax, Axes3D):
            points = points[:, list(plane)]
        # In space, too, lines take as many coordinates as there are.
        ax.plot(
            *points.T,
            color=ALERT,
            linewidth=0.8,
            marker="o",
            markersize=7.5,
            markerfacecolor="none",
            markeredgewidth=1.0,
            zorder=60,
            gid=f"worst:{row.vehicle}:{row.step}",
        )
