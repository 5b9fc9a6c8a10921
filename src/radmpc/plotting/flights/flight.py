"""The picture of a flight: what was flown over what was planned, and the account beneath."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from radmpc.errors import ArgumentError
from radmpc.io.flights.record import FlightRecord, FlownMission
from radmpc.plotting.artists.flat import Color
from radmpc.plotting.canvas.extent import plan_extent
from radmpc.plotting.canvas.figure import new_figure, settle_axes
from radmpc.plotting.canvas.space_labels import board_of
from radmpc.plotting.canvas.style import (
    ALERT,
    COLUMN_WIDTH,
    LABEL_SIZE,
    MUTED,
    PALETTE,
    TICK_SIZE,
    TITLE_SIZE,
    vehicle_colors,
)
from radmpc.plotting.curves import ABOVE, confidence_ellipses, mean_path
from radmpc.plotting.flights.paths import chosen, flown, flown_extent
from radmpc.plotting.save import save_axes
from radmpc.plotting.scenario import draw_surroundings, name_vehicles

__all__ = ["Stage", "draw_account", "new_stage", "plot_flight", "save_flight"]

_ACCOUNT = 1.05
"""Height of the account's panel [in]."""

_AROUND = 0.95
"""Height of titles, ticks, labels and legends of both panels [in]."""

_MOST_PATHS = 200
"""Missions whose paths are drawn."""


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


def plot_flight(record: FlightRecord) -> Axes:
    """Draw a flight seen from above: paths over the plan, discs, what was hit, the account.

    Pale outlines are where the plan expected vehicles with three standard deviations, full discs
    where they were expected one step before they were there. Of several missions one is drawn
    strongly: the first that hit something, or else the first.

    Parameters
    ----------
    record : FlightRecord
        With at least one tick.

    Returns
    -------
    Axes
        The upper axes, in a figure of one column; nothing is shown and nothing saved.

    Raises
    ------
    ArgumentError
        If nothing was flown.
    """
    stage = new_stage(record)
    mission = _shown(record)
    _draw_plan(stage, record)
    others = [m for m in record.missions if m.number != mission.number][:_MOST_PATHS]
    for other in others:
        _draw_paths(stage, record, other, is_main=False)
    _draw_paths(stage, record, mission, is_main=True)
    for one in (*others, mission):
        _draw_contacts(stage, record, one)
    board = board_of(stage.above)
    pairs = zip(record.plan.scenario.vehicles, flown(record, mission), strict=True)
    board.avoid(*(mean_path(vehicle, path)[::2, :2] for vehicle, path in pairs))
    draw_surroundings(stage.above, record.plan.scenario, board, stage.colors, strength=0.4)
    name_vehicles(record.plan.scenario, board, stage.colors)
    _draw_legend(stage, bool(others), any(m.contacts for m in record.missions))
    draw_account(stage.account, record, mission)
    return stage.above


def save_flight(record: FlightRecord, path: str | os.PathLike[str]) -> None:
    """Write the picture of a flight; an interrupted write leaves an old file as it was.

    Parameters
    ----------
    record : FlightRecord
        What to draw.
    path : path
        Ends in ``.png``, ``.pdf`` or ``.svg``.

    Raises
    ------
    FileFormatError
        If the name ends otherwise.
    ArgumentError
        If nothing was flown.
    """
    save_axes(plot_flight(record), Path(path))


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
    _shown(record)
    scenario = record.plan.scenario
    paths = [flown(record, m) for m in record.missions[:_MOST_PATHS] if _is_measured(m)]
    extent = flown_extent(plan_extent(record.plan), scenario.vehicles, paths)
    width, height = (extent[1] - extent[0])[:2]
    map_height = (COLUMN_WIDTH - 0.4) * float(np.clip(height / width, 0.3, 1.6))
    figure = new_figure(COLUMN_WIDTH, map_height + _ACCOUNT + _AROUND)
    grid = figure.add_gridspec(2, 1, height_ratios=[map_height, _ACCOUNT])
    above, account = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    settle_axes(above, extent, ABOVE)
    above.set_title(scenario.name + "\n", loc="left", fontsize=TITLE_SIZE, fontweight="bold", pad=3)
    above.annotate(
        _facts(record), (0.0, 1.0), xycoords="axes fraction", xytext=(0.0, 3.0), gid="facts",
        textcoords="offset points", fontsize=LABEL_SIZE, color=MUTED, va="bottom",
        annotation_clip=False,
    )  # fmt: skip
    _settle_account(account, record)
    figure.draw_without_rendering()  # names are placed for the size that axes have from here on
    names = [vehicle.name for vehicle in scenario.vehicles]
    return Stage(figure, above, account, vehicle_colors(names, record.plan.sets))


def _shown(record: FlightRecord) -> FlownMission:
    """Return the mission that is shown."""
    mission = chosen(record)
    if mission is None or not _is_measured(mission):
        raise ArgumentError("record must hold at least one tick, got a flight that never began")
    return mission


def _is_measured(mission: FlownMission) -> bool:
    """Whether anything was measured in a mission."""
    return any(row.states is not None for row in mission.rows)


def _facts(record: FlightRecord) -> str:
    """Return how it was flown and how many missions hit something."""
    settings, missions = record.settings, record.missions
    how = "as planned" if settings.replan is None else f"planned anew by {settings.replan}"
    over = [mission for mission in missions if mission.is_over]
    hits = sum(bool(mission.contacts) for mission in over)
    count = f"{hits} of {len(over)} missions hit something" if over else "not over"
    return f"flown with {settings.backend}, {how} · {count}"


def _draw_plan(stage: Stage, record: FlightRecord) -> None:
    """Draw the plan palely: mean paths, and the outlines of its 3σ ellipses."""
    for vehicle, trajectory in zip(
        record.plan.scenario.vehicles, record.plan.trajectories, strict=True
    ):
        color = stage.colors[vehicle.name]
        path = mean_path(vehicle, trajectory)
        stage.above.plot(
            path[:, 0], path[:, 1], color=(*color, 0.55), linewidth=0.7, linestyle=(0, (4, 2)),
            zorder=3.5, gid=f"planned:{vehicle.name}",
        )  # fmt: skip
        outlines = PolyCollection(
            confidence_ellipses(vehicle, trajectory), facecolors="none", zorder=3,
            edgecolors=[(*color, 0.45)], linewidths=0.4, gid=f"ellipses:{vehicle.name}",
        )  # fmt: skip
        stage.above.add_collection(outlines, autolim=False)


def _draw_paths(
    stage: Stage, record: FlightRecord, mission: FlownMission, *, is_main: bool
) -> None:
    """Draw where a mission went; of the main one steps and discs, too."""
    if not _is_measured(mission):
        return
    pairs = zip(record.plan.scenario.vehicles, flown(record, mission), strict=True)
    for vehicle, trajectory in pairs:
        color, name = stage.colors[vehicle.name], f"{mission.number}:{vehicle.name}"
        path = mean_path(vehicle, trajectory)
        looks = {"linewidth": 1.1, "zorder": 5.2} if is_main else {"linewidth": 0.4, "zorder": 4.5}
        stage.above.plot(
            path[:, 0], path[:, 1], color=(*color, 1.0 if is_main else 0.35), gid=f"flown:{name}",
            **looks,
        )  # fmt: skip
        if not is_main:
            continue
        discs = PolyCollection(
            confidence_ellipses(vehicle, trajectory), facecolors=[(*color, 0.30)], zorder=5,
            edgecolors="none", gid=f"discs:{name}",
        )  # fmt: skip
        stage.above.add_collection(discs, autolim=False)
        steps = trajectory.means[:, list(vehicle.system.position)]
        stage.above.plot(
            steps[:, 0], steps[:, 1], linestyle="none", marker=".", markersize=3.2, color=color,
            zorder=5.5, gid=f"steps:{name}",
        )  # fmt: skip


def _draw_contacts(stage: Stage, record: FlightRecord, mission: FlownMission) -> None:
    """Mark where something was hit."""
    numbers = {v.name: i for i, v in enumerate(record.plan.scenario.vehicles)}
    for row in mission.rows:
        for touch in row.contacts:
            if row.states is None or touch.vehicle not in numbers:
                continue
            number = numbers[touch.vehicle]
            axes = record.plan.scenario.vehicles[number].system.position
            x, y = (float(row.states[number][a]) for a in axes[:2])
            stage.above.plot(
                [x], [y], marker="x", color=ALERT, markersize=5.0, markeredgewidth=1.2, zorder=9,
                gid=f"contact:{mission.number}:{touch.vehicle}",
            )  # fmt: skip


def _draw_legend(stage: Stage, has_others: bool, has_contacts: bool) -> None:
    """Say below the map what the signs mean."""
    entries = {
        "planned, 3σ": Line2D([], [], color=MUTED, linewidth=0.7, linestyle=(0, (4, 2)),
                              marker="o", markersize=7.0, markerfacecolor="none"),
        "flown": Line2D([], [], color=MUTED, linewidth=1.1, marker=".", markersize=4.0),
        "3σ a step ahead": Line2D([], [], linestyle="none", marker="o", markersize=5.0,
                                  markerfacecolor="#5555554D", markeredgecolor="none"),
    }  # fmt: skip
    if has_others:
        entries["other missions"] = Line2D([], [], color="#55555580", linewidth=0.4)
    if has_contacts:
        entries["hit"] = Line2D([], [], linestyle="none", marker="x", color=ALERT, markersize=5.0)
    stage.above.legend(
        list(entries.values()), list(entries), loc="upper center", bbox_to_anchor=(0.5, -0.13),
        ncols=len(entries), fontsize=TICK_SIZE, frameon=False, handlelength=1.6,
        columnspacing=0.8, handletextpad=0.3, borderaxespad=0.0,
    )  # fmt: skip


def _settle_account(ax: Axes, record: FlightRecord) -> None:
    """Set limits and labels of the account's panel."""
    scenario = record.plan.scenario
    largest = max([scenario.risk_bound, *(row.wealth for row in record.rows)])
    ax.set_xlim(0.0, scenario.horizon * scenario.dt)
    ax.set_ylim(0.0, 1.12 * largest)
    ax.set_xlabel("time [s]", fontsize=LABEL_SIZE, labelpad=1.0)
    ax.set_ylabel("risk [-]", fontsize=LABEL_SIZE, labelpad=1.0)
    ax.tick_params(labelsize=TICK_SIZE, length=2.0, width=0.5, pad=1.5)
    for spine in ax.spines.values():
        spine.set_linewidth(0.5)


def draw_account(ax: Axes, record: FlightRecord, mission: FlownMission) -> None:
    """Draw what was left of Δ over time: the bank, the tail on top of it, and new legs.

    Parameters
    ----------
    ax : Axes
        With limits.
    record : FlightRecord
        All missions, whose wealth is drawn thinly.
    mission : FlownMission
        The one whose account is filled.
    """
    scenario = record.plan.scenario
    for other in record.missions[:_MOST_PATHS]:
        if other.number != mission.number:
            times = [row.step * scenario.dt for row in other.rows]
            ax.step(times, [row.wealth for row in other.rows], where="post", color="#55555560",
                    linewidth=0.4, gid=f"wealth:{other.number}")  # fmt: skip
    times = np.array([row.step * scenario.dt for row in mission.rows])
    bank = np.array([row.bank for row in mission.rows])
    tail = np.array([row.tail for row in mission.rows])
    ax.fill_between(times, 0.0, bank, step="post", color=PALETTE[2], alpha=0.35, linewidth=0.0,
                    label="bank", gid="bank")  # fmt: skip
    ax.fill_between(times, bank, bank + tail, step="post", color=PALETTE[0], alpha=0.45,
                    linewidth=0.0, label="the leg in the air", gid="tail")  # fmt: skip
    ax.step(times, bank + tail, where="post", color="#222222", linewidth=0.8, label="wealth",
            gid="wealth")  # fmt: skip
    bought = [row for row in mission.rows if row.leg is not None]
    if bought:
        ax.plot([row.step * scenario.dt for row in bought], [row.bank + row.tail for row in bought],
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
