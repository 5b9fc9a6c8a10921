"""The two panels that a flight is shown in: the map, and the account beneath."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import ScaledTranslation

from radmpc.errors import ArgumentError
from radmpc.io.flight.record import FlightRecord, FlownMission
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.canvas.extent import plan_extent
from radmpc.plotting.canvas.figure import new_figure, settle_axes
from radmpc.plotting.canvas.headline import figure_headline
from radmpc.plotting.canvas.style import (
    COLUMN_WIDTH,
    LABEL_SIZE,
    MUTED,
    TICK_SIZE,
    TITLE_SIZE,
    vehicle_colors,
)
from radmpc.plotting.canvas.title import draw_headline
from radmpc.plotting.curves import ABOVE
from radmpc.plotting.flight.paths import chosen, flown, flown_extent
from radmpc.records import dataclass

__all__ = ["MOST_PATHS", "Stage", "is_measured", "new_stage", "shown_mission"]

MOST_PATHS = 200
"""Missions whose paths are drawn."""

_ACCOUNT = 1.05
"""Height of the account's panel [in]."""

_NUMBERS = 5
"""Intervals between the numbers beside the account, at most [-]."""

_AROUND = 1.25
"""Height of titles, ticks, labels and legends of both panels [in]."""

_LINE_CHARACTERS = 62
"""Letters in a line of facts."""

_ABOVE = 3.0
"""Space that a layout keeps free above headlines [pt]."""


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """A figure for a flight.

    Attributes
    ----------
    figure : Figure
        Of one column.
    above : Axes
        Seen from above; in space x and y.
    account : Axes
        Beneath, over time.
    colors : dict
        Color by vehicle.
    """

    figure: Figure
    above: Axes
    account: Axes
    colors: dict[str, Color]


def new_stage(record: FlightRecord) -> Stage:
    """Return a figure with both panels, titled, their sizes final.

    Parameters
    ----------
    record : FlightRecord
        What will be drawn.

    Raises
    ------
    ArgumentError
        If nothing was flown.
    """
    shown_mission(record)
    scenario = record.plan.scenario
    paths = [flown(record, m) for m in record.missions[:MOST_PATHS] if is_measured(m)]
    extent = flown_extent(plan_extent(record.plan), scenario.vehicles, paths)
    width, height = (extent[1] - extent[0])[:2]
    map_height = (COLUMN_WIDTH - 0.4) * float(np.clip(height / width, 0.3, 1.6))
    figure = new_figure(COLUMN_WIDTH, map_height + _ACCOUNT + _AROUND)
    grid = figure.add_gridspec(2, 1, height_ratios=[map_height, _ACCOUNT])
    above, account = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    settle_axes(above, extent, ABOVE)
    _draw_title(figure, scenario.name, _facts(record))
    _settle_account(account, record)
    figure.draw_without_rendering()  # names are placed for the size that axes have from here on
    names = [vehicle.name for vehicle in scenario.vehicles]
    return Stage(figure, above, account, vehicle_colors(names, record.plan.sets))


def _draw_title(figure: Figure, name: str, facts: str) -> None:
    """Write the headline and the facts below it."""
    draw_headline(figure, figure_headline(figure, name) + "\n" * len(facts.splitlines()))
    drop = _ABOVE + 1.35 * TITLE_SIZE
    lower = ScaledTranslation(0.0, -drop / 72.0, figure.dpi_scale_trans)
    figure.text(
        0.01, 1.0, facts, fontsize=LABEL_SIZE, color=MUTED, va="top", gid="facts",
        transform=figure.transFigure + lower,
    )  # fmt: skip


def shown_mission(record: FlightRecord) -> FlownMission:
    """Return the mission that is shown."""
    mission = chosen(record)
    if mission is None or not is_measured(mission):
        raise ArgumentError("record must hold at least one tick, got a flight that never began")
    return mission


def is_measured(mission: FlownMission) -> bool:
    """Whether anything was measured in a mission."""
    return any(row.states is not None for row in mission.rows)


def _facts(record: FlightRecord) -> str:
    """Return how it was flown and how many missions hit something."""
    settings, missions = record.settings, record.missions
    how = "as planned" if settings.replan is None else f"planned anew by {settings.replan}"
    over = [mission for mission in missions if mission.is_over]
    hits = sum(bool(mission.contacts) for mission in over)
    count = f"{hits} of {len(over)} missions hit something" if over else "not over"
    line = f"flown with {settings.backend}, {how}"
    both = f"{line} · {count}"
    return both if len(both) <= _LINE_CHARACTERS else f"{line}\n{count}"


def _settle_account(ax: Axes, record: FlightRecord) -> None:
    """Set limits and labels of the account's panel."""
    scenario = record.plan.scenario
    largest = max([scenario.risk_bound, *(row.wealth for row in record.rows)])
    ax.set_xlim(0.0, scenario.horizon * scenario.dt)
    ax.set_ylim(0.0, 1.12 * largest)
    # Else a layout is made for the ticks of another height, and may cut off the label beside them.
    locator = MaxNLocator(nbins=5, steps=[1, 2, 2.5, 5, 10])
    ticks = np.asarray(locator.tick_values(0.0, 1.12 * largest))
    ax.set_yticks(ticks[ticks <= 1.12 * largest])
    ax.set_xlabel("time [s]", fontsize=LABEL_SIZE, labelpad=1.0)
    ax.set_ylabel("risk [-]", fontsize=LABEL_SIZE, labelpad=1.0)
    ax.tick_params(labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
    # As many numbers at any height: a layout knows how wide they are before it gives the panel its.
    ax.yaxis.set_major_locator(MaxNLocator(_NUMBERS))
    for spine in ax.spines.values():
        spine.set_linewidth(0.5)
