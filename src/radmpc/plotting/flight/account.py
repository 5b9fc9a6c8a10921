"""What was left of Δ over time, as areas."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes

from radmpc.io.flight.record import FlightRecord, FlownMission
from radmpc.plotting.canvas.style import ALERT, LABEL_SIZE, PALETTE, TICK_SIZE
from radmpc.plotting.flight.stage import MOST_PATHS

__all__ = ["draw_account"]


def draw_account(ax: Axes, record: FlightRecord, mission: FlownMission) -> None:
    """Draw what was left of Δ over time: unallocated risk, the tail on top of it, and new legs.

    Parameters
    ----------
    ax : Axes
        With limits.
    record : FlightRecord
        All missions, of which the remaining risk is drawn thinly.
    mission : FlownMission
        The one whose account is filled.
    """
    scenario = record.plan.scenario
    for other in record.missions[:MOST_PATHS]:
        if other.number != mission.number:
            at = [row.step * scenario.dt for row in other.rows]
            ax.step(at, [row.wealth for row in other.rows], where="post", color="#55555560",
                    linewidth=0.4, gid=f"wealth:{other.number}")  # fmt: skip
    times = np.array([row.step * scenario.dt for row in mission.rows])
    bank = np.array([row.bank for row in mission.rows])
    tail = np.array([row.tail for row in mission.rows])
    ax.fill_between(times, 0.0, bank, step="post", color=PALETTE[2], alpha=0.35, linewidth=0.0,
                    label="unallocated", gid="bank")  # fmt: skip
    ax.fill_between(times, bank, bank + tail, step="post", color=PALETTE[0], alpha=0.45,
                    linewidth=0.0, label="leg in the air", gid="tail")  # fmt: skip
    ax.step(times, bank + tail, where="post", color="#222222", linewidth=0.8,
            label="remaining risk", gid="wealth")  # fmt: skip
    adopted = [row for row in mission.rows if row.leg is not None]
    if adopted:
        remaining = [row.bank + row.tail for row in adopted]
        ax.plot([row.step * scenario.dt for row in adopted], remaining,
                linestyle="none", marker="o", markersize=2.6, color="#222222", label="new leg",
                gid="bought")  # fmt: skip
    ax.axhline(scenario.risk_bound, color=ALERT, linewidth=0.7, linestyle=(0, (4, 2)), gid="bound")
    ax.annotate("Δ", (1.0, scenario.risk_bound), xycoords=("axes fraction", "data"), ha="left",
                va="center", xytext=(2.0, 0.0), textcoords="offset points", fontsize=LABEL_SIZE,
                color=ALERT, annotation_clip=False)  # fmt: skip
    ax.legend(
        fontsize=TICK_SIZE, frameon=False, loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4,
        handlelength=1.4, columnspacing=1.0, handletextpad=0.4, borderaxespad=0.2,
    )  # fmt: skip
