"""The picture of risk over time."""

from __future__ import annotations

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from radmpc.arrays import Matrix
from radmpc.model.given import check_plan
from radmpc.model.ledger import CAUSES
from radmpc.model.plan import Plan
from radmpc.plotting.canvas.figure import check_axes, numbers_of
from radmpc.plotting.canvas.headline import PLAIN, write_headline
from radmpc.plotting.canvas.style import ALERT, LABEL_SIZE, MUTED, PALETTE, TICK_SIZE
from radmpc.plotting.risk.ledger_looks import draw_key, new_column, say_nothing, settle_part

__all__ = ["plot_risk"]

_HEIGHT = 2.1
"""Height of the figure [in]."""


@rc_context(PLAIN)
def plot_risk(plan: Plan, ax: Axes | None = None) -> Axes:
    """Draw risk over time: bars per step by cause, and their sum so far against Δ.

    Parameters
    ----------
    plan : Plan
        With a certificate; without one the axes say so.
    ax : Axes or None
        Where. None makes a figure of one column.

    Returns
    -------
    Axes
        The axes drawn on; nothing is shown and nothing saved.

    Examples
    --------
    >>> import radmpc
    >>> from radmpc.experiments.families import paper
    >>> plan = radmpc.plan(paper(2, seed=1), "distance", rng=0).require()
    >>> radmpc.plot_risk(plan).get_xlabel()
    'time [s]'
    """
    check_plan(plan)
    check_axes(ax, 2)
    axes = new_column(_HEIGHT).add_subplot() if ax is None else ax
    with numbers_of(axes):
        settle_part(axes, "", "time [s]")
    write_headline(axes, plan.scenario.name, ": risk over time")
    if plan.risk.certified is None or not plan.risk.ledger:
        return say_nothing(axes, plan)
    risks = _by_step(plan)
    scenario = plan.scenario
    times = scenario.dt * np.arange(risks.shape[1])
    below = np.zeros(risks.shape[1])
    for cause, color, row in zip(CAUSES, PALETTE, risks, strict=False):
        if row.sum() > 0.0:
            axes.bar(
                times, row, width=0.8 * scenario.dt, bottom=below, color=color, linewidth=0.0,
                label=cause, gid=f"risk:{cause}",
            )  # fmt: skip
        below += row
    sums = np.cumsum(below)
    edges = np.append(times - 0.5 * scenario.dt, times[-1] + 0.5 * scenario.dt)
    axes.stairs(
        sums, edges, baseline=None, color=MUTED, linewidth=1.1, label="sum so far", gid="sum"
    )
    bound = scenario.risk_bound
    axes.axhline(bound, color=ALERT, linewidth=0.8, linestyle=(0, (4, 2)), gid="bound")
    axes.annotate(
        f"Δ = {bound:g}", (0.0, bound), xycoords=("axes fraction", "data"), xytext=(2.0, -2.0),
        textcoords="offset points", fontsize=TICK_SIZE, color=ALERT, va="top",
    )  # fmt: skip
    axes.set_xlim(edges[0], edges[-1])
    axes.set_ylim(0.0, 1.08 * max(bound, float(sums[-1])))
    axes.set_ylabel("probability [-]", fontsize=LABEL_SIZE, labelpad=1.0)
    axes.yaxis.set_major_locator(MaxNLocator(5))
    draw_key(axes, 4)
    return axes


def _by_step(plan: Plan) -> Matrix:
    """Return the ledger by cause and step, (4, T+1)."""
    risks = np.zeros((len(CAUSES), plan.scenario.horizon + 1))
    for row in plan.risk.ledger:
        risks[CAUSES.index(row.cause), row.step] += row.risk
    return risks
